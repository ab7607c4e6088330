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
from bridgectl._checks import FloatArray
from bridgectl.recovery import RECOVERIES

RAMP_LENGTH = 0.1
"""Length of the ramps [m], as in the paper."""

SPEEDS_KMH = (1.0, 1000.0)
"""Speeds that make sense [km/h]: a crawling vehicle needs cells, and memory, without end."""

MAIN_HELP = """\
What a road does to a bridge: dynamic amplification of a vehicle's crossing.

  bridgectl dae      the dynamic amplification estimate (DAE) of a measured road
  bridgectl paper    every number of Li, OBrien and Gonzalez (2006) beside the computed one

`bridgectl dae` without a file takes a measured road that comes with the program."""

DAE_HELP = """\
Place a bridge in a road and say how much the road amplifies the bending moment of a truck's
crossing, at every speed:

  DAF smooth      dynamic amplification factor (DAF) of a smooth road
  DAE             that, plus what each 100 mm ramp of the road adds on its own: the dynamic
                  amplification estimate of Li, OBrien and Gonzalez (2006), Eq. (15)
  superposed DAF  the same ramps, superposed as moment histories: exact while tires stay down
  simulated DAF   the crossing itself

FILE is delimited text: stations and elevations (positive upward), whose units the header names
('x [m], z [mm]') or --units tells. Without FILE: a measured road of 544 m that comes with the
program.

examples:
  bridgectl dae
  bridgectl dae road.csv --units m,mm --station 1250 --span 35 --plot dae.png
  bridgectl dae road.txt --units m,m --speeds 60:120:2 --damping 12e3 --json > dae.json"""

PAPER_HELP = """\
Print every number that Li, OBrien and Gonzalez (2006) print, beside the computed one and with the
difference; --plot draws their Figs. 2, 5 and 6.

examples:
  bridgectl paper
  bridgectl paper --plot figures.png"""


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
    _add_road_options(dae)
    _add_bridge_options(dae)
    _add_vehicle_options(dae)
    paper = commands.add_parser(
        "paper", help="the paper's numbers", description=PAPER_HELP, formatter_class=look
    )
    paper.set_defaults(run=_run_paper)
    for command in (dae, paper):
        command.add_argument("--plot", metavar="FILE", type=Path, help="draw (png, pdf, svg)")
        command.add_argument("--json", action="store_true", help="print one JSON object instead")
    return parser


def _add_road_options(parser: _Parser) -> None:
    road = parser.add_argument_group("road")
    road.add_argument("file", nargs="?", metavar="FILE", help="delimited text")
    road.add_argument("--units", metavar="X,Z", help="units of station and elevation, as m,mm")
    road.add_argument(
        "--columns", metavar="I,J", default="0,1", help="columns of the two, from 0 (default 0,1)"
    )
    road.add_argument(
        "--station", type=float, metavar="M",
        help="station of the start of the bridge [m]; default: the first after the approach",
    )  # fmt: skip
    road.add_argument(
        "--approach", type=float, default=200.0, metavar="M",
        help="road before the bridge that counts [m]; the vehicle starts there (default 200)",
    )  # fmt: skip
    road.add_argument(
        "--no-detrend", action="store_true",
        help="keep the grade; by default the straight line through the road is taken off, "
        "as a vehicle that starts in equilibrium is not on a grade",
    )  # fmt: skip
    parser.add_argument(
        "--speeds", default="50:150:1", metavar="A:B:D",
        help="speeds [km/h], from A to B in steps of D, or a list A,B,C (default 50:150:1)",
    )  # fmt: skip


def _add_bridge_options(parser: _Parser) -> None:
    bridge = parser.add_argument_group("bridge (Li's thesis, 2006; default the paper's 25 m)")
    bridge.add_argument("--span", type=int, default=25, metavar="M", help="odd, 9 to 43 [m]")
    bridge.add_argument("--deck", help="solid, Y or super-Y, for spans that have several")
    bridge.add_argument("--modes", type=int, default=3, metavar="N", help="number (default 3)")
    bridge.add_argument(
        "--damping-ratio", default="0", metavar="Z", help="of mode 1, or A,B,C of each (default 0)"
    )
    bridge.add_argument(
        "--section", type=float, default=0.5, metavar="S",
        help="section of the moment, as a fraction of the span (default 0.5)",
    )  # fmt: skip
    bridge.add_argument(
        "--recovery", default="exact", metavar="HOW",
        help=f"of the moment from the modes: {', '.join(RECOVERIES)} (default exact)",
    )  # fmt: skip


def _add_vehicle_options(parser: _Parser) -> None:
    vehicle = parser.add_argument_group("quarter-car (default the paper's truck)")
    truck = bc.li2006.car()
    units = {"mass": "kg", "stiffness": "N/m", "damping": "N s/m"}
    for name in (
        "sprung_mass", "unsprung_mass", "suspension_stiffness", "tire_stiffness", "damping",
    ):  # fmt: skip
        unit, default = units[name.rpartition("_")[2]], getattr(truck, name)
        vehicle.add_argument(
            f"--{name.replace('_', '-')}", type=float, default=default, metavar="X",
            help=f"[{unit}] (default {default:g})",
        )  # fmt: skip


def _run_dae(args: argparse.Namespace) -> None:
    from bridgectl.report import DaeStudy, dae_json, print_dae

    speeds = _speeds(args.speeds) / 3.6
    _check_plot(args.plot)
    ratios = tuple(_numbers("--damping-ratio", args.damping_ratio, float))
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
        columns = _numbers("--columns", args.columns, int)
        whole = bc.read_profile(args.file, units=args.units, columns=tuple(columns))
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


def _speeds(text: str) -> FloatArray:
    """Speeds [km/h] from 'A:B:D' or 'A,B,C'."""
    if ":" not in text:
        speeds = np.array(_numbers("--speeds", text, float))
    else:
        parts = text.split(":")
        if len(parts) != 3:
            raise ValueError(f"--speeds must look like 50:150:1 or 80,90,100, got {text!r}")
        first, last, step = _numbers("--speeds", ",".join(parts), float)
        if not (0 < first <= last and step > 0 and np.isfinite([first, last, step]).all()):
            raise ValueError(f"--speeds must rise from above 0 km/h, as 50:150:1, got {text!r}")
        if (last - first) / step > 10_000:
            raise ValueError(f"--speeds must be at most 10000 speeds, got {text!r}")
        speeds = first + step * np.arange(int((last - first) / step + 1e-9) + 1)
    if not (np.isfinite(speeds).all() and (speeds > 0).all()):
        raise ValueError(f"--speeds must be above 0 km/h, got {text!r}")
    slowest, fastest = SPEEDS_KMH
    if speeds.min() < slowest or speeds.max() > fastest:
        raise ValueError(f"--speeds must be {slowest:g} to {fastest:g} km/h, got {text!r}")
    return np.unique(speeds)


def _numbers(option: str, text: str, kind: type) -> list[Any]:
    try:
        return [kind(part) for part in text.split(",")]
    except ValueError:
        raise ValueError(f"{option} must be numbers separated by commas, got {text!r}") from None


def _check_plot(path: Path | None) -> None:
    """Find out before the work that the figure cannot be written."""
    if path is None:
        return
    if path.suffix.lower() not in (".png", ".pdf", ".svg"):
        raise ValueError(f"--plot must end in .png, .pdf or .svg, got {str(path)!r}")
    if not path.absolute().parent.is_dir():
        raise ValueError(f"--plot: the folder {str(path.parent)!r} does not exist")
    if path.is_dir():
        raise ValueError(f"--plot must name a file, got the folder {str(path)!r}")
    if not os.access(path if path.exists() else path.absolute().parent, os.W_OK):
        raise ValueError(f"--plot: no permission to write {str(path)!r}")


def _tell_drawn(path: Path | None) -> None:
    if path is not None:
        print(f"Drawn: {path}")


def _working(what: str) -> Any:
    """A spinner on standard error, if that is a terminal."""
    from rich.console import Console

    return Console(stderr=True).status(what)


def _run_paper(args: argparse.Namespace) -> None:
    from bridgectl.paper import paper_results
    from bridgectl.report import paper_json, print_paper

    _check_plot(args.plot)
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
