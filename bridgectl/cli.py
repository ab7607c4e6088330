"""The command line: parse, call, print."""

from __future__ import annotations

import argparse
import json
import os
import sys
import warnings
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any, NoReturn

import numpy as np

import bridgectl as bc
from bridgectl.options import (
    add_bridge_options,
    add_file_options,
    add_place_options,
    add_validation_options,
    add_vehicle_options,
    check_plot,
    file_arguments,
    numbers,
    parse_speeds,
)

RAMP_LENGTH = 0.1
"""Length of the ramps [m], as in the paper."""

SEGMENT = 100.0
"""Segments of a road that get an IRI each [m]."""

MAIN_HELP = """\
What a road does to a bridge: dynamic amplification of a vehicle's crossing.

  bridgectl dae       the dynamic amplification estimate (DAE) of a measured road
  bridgectl profile   roughness (IRI), spectrum and ISO 8608 class of a road file
  bridgectl paper     every number of Li, OBrien and Gonzalez (2006) beside the computed one
  bridgectl validate  its Section 4 again: DAE against DAF on eight good roads and three spans

`bridgectl dae` without a file takes a measured road that comes with the program."""

DAE_HELP = """\
Place a bridge in a road and say how much the road amplifies the bending moment of a truck's
crossing, at every speed:

  DAF smooth      dynamic amplification factor (DAF) of a smooth road
  DAE             that, plus what each 100 mm ramp of the road adds on its own: the dynamic
                  amplification estimate of Li, OBrien and Gonzalez (2006), Eq. (15)
  superposed DAF  the same ramps, superposed as moment histories: exact while tires stay down
  simulated DAF   the crossing itself

FILE is delimited text, ERD text or OpenCRG: stations and elevations (positive upward), whose units
the file states ('x [m], z [mm]') or --units tells. Of several tracks the first counts, or --track.
Without FILE: a measured road of 544 m that comes with the program.

examples:
  bridgectl dae
  bridgectl dae road.csv --units m,mm --station 1250 --span 35 --plot dae.png
  bridgectl dae survey.erd --track RElev.
  bridgectl dae road.txt --units m,m --speeds 60:120:2 --damping 12e3 --json > dae.json"""

PROFILE_HELP = """\
Measure the tracks of a road file:

  IRI             International Roughness Index (ASTM E1926), of all and of each segment;
                  a road is good, in the sense of Li, OBrien and Gonzalez (2006), below 7 m/km
  G_d(n0), w      line of ISO 8608 through the spectrum: roughness at n0 = 0.1 cycles/m, waviness
  class           ISO 8608 class of that roughness, A to H

FILE is delimited text, ERD text or OpenCRG; all its tracks are measured, or the one of --track.
Without FILE: a measured road of 544 m that comes with the program.

examples:
  bridgectl profile
  bridgectl profile survey.erd --plot survey.png
  bridgectl profile levels.csv --step 0.25 --units mm --segment 50 --json"""

PAPER_HELP = """\
Print every number that Li, OBrien and Gonzalez (2006) print, beside the computed one and with the
difference; --plot draws their Figs. 2, 5 and 6.

examples:
  bridgectl paper
  bridgectl paper --plot figures.png"""

VALIDATE_HELP = """\
Do Section 4 of Li, OBrien and Gonzalez (2006) again: compare DAE and superposed DAF with the
simulated DAF of eight good roads (IRI below 7 m/km) on bridges of 15, 25 and 35 m. The truck starts
at rest where the bridge begins (Figs. 8 and 9) or 200 m before it (Fig. 11). Roads 1 and 2 are
measured, 3 to 6 random, 7 and 8 made for the largest and smallest DAF. It takes a minute.

examples:
  bridgectl validate --plot validation.png
  bridgectl validate --spans 25 --speeds 60:120:5 --json"""


class _Parser(argparse.ArgumentParser):
    """A parser whose complaint is one line."""

    def error(self, message: str) -> NoReturn:
        raise ValueError(f"{message} (see {self.prog} --help)")


def main(argv: Sequence[str] | None = None) -> int:
    """Run a command.

    Parameters
    ----------
    argv : sequence of str, optional
        Arguments after the program's name. Default: those of the process.

    Returns
    -------
    int
        Exit status: 0, or 2 for a mistake in what was asked, told in one line.
    """
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("always", UserWarning)
            warnings.showwarning = _show_each_once()
            args = _parser().parse_args(argv)
            args.run(args)
            sys.stdout.flush()
    except BrokenPipeError:  # a reader such as `head` has seen enough
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        return 0
    except KeyboardInterrupt:
        return 130
    except (ValueError, TypeError, NotImplementedError, OSError) as error:
        _tell("error", error)
        return 2
    except MemoryError:  # so many modes, or a vehicle so stiff, take steps without end
        _tell("error", "not enough memory: type fewer --modes, or check stiffnesses and damping")
        return 2
    return 0


def _tell(kind: str, message: object) -> None:
    line = "".join(c if c.isprintable() else " " for c in str(message))
    print(f"bridgectl: {kind}: {' '.join(line.split())}", file=sys.stderr)


def _show_each_once() -> Callable[..., None]:
    told: set[str] = set()

    def show(message: Warning | str, *_: Any, **__: Any) -> None:
        if str(message) not in told:
            told.add(str(message))
            _tell("warning", message)

    return show


def _parser() -> _Parser:
    look = argparse.RawDescriptionHelpFormatter
    parser = _Parser(prog="bridgectl", description=MAIN_HELP, formatter_class=look)
    parser.add_argument("--version", action="version", version=f"bridgectl {bc.__version__}")
    commands = parser.add_subparsers(required=True, metavar="COMMAND")
    dae = commands.add_parser(
        "dae", help="DAE and DAF of a measured road", description=DAE_HELP, formatter_class=look
    )
    dae.set_defaults(run=_run_dae)
    add_file_options(dae)
    add_place_options(dae)
    add_bridge_options(dae)
    add_vehicle_options(dae)
    profile = commands.add_parser(
        "profile", help="IRI, spectrum and ISO class of a road file", description=PROFILE_HELP,
        formatter_class=look,
    )  # fmt: skip
    profile.set_defaults(run=_run_profile)
    add_file_options(profile)
    profile.add_argument(
        "--segment", type=float, default=SEGMENT, metavar="M",
        help=f"length over which IRIs are taken [m] (default {SEGMENT:g})",
    )  # fmt: skip
    paper = commands.add_parser(
        "paper", help="the paper's numbers", description=PAPER_HELP, formatter_class=look
    )
    paper.set_defaults(run=_run_paper)
    validate = commands.add_parser(
        "validate", help="DAE against DAF on good roads", description=VALIDATE_HELP,
        formatter_class=look,
    )  # fmt: skip
    validate.set_defaults(run=_run_validate)
    add_validation_options(validate)
    for command in (dae, profile, paper, validate):
        command.add_argument("--plot", metavar="FILE", type=Path, help="draw (png, pdf, svg)")
        command.add_argument("--json", action="store_true", help="print one JSON object instead")
    return parser


def _run_dae(args: argparse.Namespace) -> None:
    from bridgectl.report import DaeStudy, dae_json, print_dae

    speeds = parse_speeds(args.speeds) / 3.6
    check_plot(args.plot)
    ratios = tuple(numbers("--damping-ratio", args.damping_ratio, float))
    damping_ratio = ratios if len(ratios) > 1 else ratios[0]
    beam = bc.li2006.beam(args.span, args.deck, n_modes=args.modes, damping_ratio=damping_ratio)
    vehicle = bc.QuarterCar(
        args.sprung_mass,
        args.unsprung_mass,
        args.suspension_stiffness,
        args.tire_stiffness,
        args.damping,
    )
    road, station = _road(args, beam.length)
    with _working("computing the ramp surface"):
        surface = bc.ramp_surface(
            beam, vehicle, speeds, approach=args.approach, ramp_length=RAMP_LENGTH,
            section=args.section, recovery=args.recovery,
        )  # fmt: skip
    with _working("superposing and simulating"):
        simulated = bc.daf(
            beam, vehicle, speeds, road, start=-args.approach,
            section=args.section, recovery=args.recovery,
        )  # fmt: skip
        with warnings.catch_warnings():  # the simulation has told of tires that leave the road
            warnings.simplefilter("ignore", bc.LiftOffWarning)
            superposed = surface.superposed_daf(road)
    study = DaeStudy(surface, vehicle, road, station, surface.dae(road), superposed, simulated)
    if args.plot is not None:
        from bridgectl.plots import dae_figure

        figure = dae_figure(surface, road, superposed=superposed, simulated=simulated)
        figure.savefig(args.plot)
    if args.json:
        print(json.dumps(dae_json(study), indent=1))
    else:
        print_dae(study)
        _tell_drawn(args.plot)


def _road(args: argparse.Namespace, span: float) -> tuple[bc.RoadProfile, float]:
    """The road under approach and bridge, in ramps, and the station of the bridge."""
    if not 0 <= args.approach < np.inf:
        raise ValueError(f"--approach must be 0 m or more, got {args.approach:g}")
    if not np.isclose(args.approach, round(args.approach / RAMP_LENGTH) * RAMP_LENGTH, 0, 1e-9):
        raise ValueError(
            f"--approach must be a whole number of {RAMP_LENGTH:g} m ramps, "
            f"got {args.approach:.10g}"
        )
    if args.file is None:
        whole = bc.utia_road()
    else:
        whole = bc.read_profile(args.file, track=args.track, **file_arguments(args))
    station = float(whole.x[0]) + args.approach if args.station is None else args.station
    first, last = float(whole.x[0]) + args.approach, float(whole.x[-1]) - span
    if not first - 1e-9 <= station <= last + 1e-9:
        room = (
            f"--station must lie between {first:g} and {last:g} m"
            if first <= last
            else f"{args.approach + span:g} m are needed: pass a smaller --approach or --span"
        )
        raise ValueError(
            f"the road ({whole.x[0]:g} to {whole.x[-1]:g} m) does not hold {args.approach:g} m of "
            f"approach and {span:g} m of bridge at station {station:g} m: {room}"
        )
    road = whole.place_bridge(station)
    # Station arithmetic must not lose the ends to round-off.
    start, stop = max(-args.approach, float(road.x[0])), min(span, float(road.x[-1]))
    road = road.crop(start, stop)
    if not args.no_detrend:
        road = road.detrend()
    return road.resample(RAMP_LENGTH).level(start), station


def _tell_drawn(path: Path | None) -> None:
    if path is not None:
        print(f"Drawn: {path}")


def _working(what: str) -> Any:
    """A spinner on standard error, if that is a terminal."""
    from rich.console import Console

    return Console(stderr=True).status(what)


def _run_profile(args: argparse.Namespace) -> None:
    from bridgectl.report import measure_track, print_profile, profile_json

    check_plot(args.plot)
    if args.file is None:
        roads = [bc.utia_road()]
    elif args.track is not None:
        roads = [bc.read_profile(args.file, track=args.track, **file_arguments(args))]
    else:
        roads = bc.read_tracks(args.file, **file_arguments(args))
    tracks = [measure_track(road, args.segment) for road in roads]
    if args.plot is not None:
        from bridgectl.plots import profile_figure

        profile_figure([track.road for track in tracks], args.segment).savefig(args.plot)
    if args.json:
        print(json.dumps(profile_json(tracks, args.segment), indent=1))
    else:
        print_profile(tracks, args.segment)
        _tell_drawn(args.plot)


def _run_paper(args: argparse.Namespace) -> None:
    from bridgectl.paper import paper_results
    from bridgectl.report import paper_json, print_paper

    check_plot(args.plot)
    with _working("computing the paper's surfaces"):
        results = paper_results()
    if args.plot is not None:
        from bridgectl.plots import paper_figure

        paper_figure(results).savefig(args.plot)
    if args.json:
        print(json.dumps(paper_json(results), indent=1))
    else:
        print_paper(results)
        _tell_drawn(args.plot)


def _run_validate(args: argparse.Namespace) -> None:
    from bridgectl.good_roads import LAST, good_roads
    from bridgectl.report_validation import print_validation, validation_json
    from bridgectl.validation import validate

    check_plot(args.plot)
    spans = list(dict.fromkeys(numbers("--spans", args.spans, int)))
    if max(spans) > LAST:
        raise ValueError(f"--spans must be {LAST:g} m at most, as the roads, got {args.spans}")
    speeds = parse_speeds(args.speeds) / 3.6
    for span in spans:  # of a span that there is not, before the work
        bc.li2006.beam(span)
    with _working("making the roads"):
        roads = good_roads()
    results = validate(speeds, spans, roads=roads)
    if args.plot is not None:
        from bridgectl.plots import validation_figure

        with _working("drawing"):
            validation_figure(results).savefig(args.plot)
    if args.json:
        print(json.dumps(validation_json(results), indent=1))
    else:
        print_validation(results)
        _tell_drawn(args.plot)
