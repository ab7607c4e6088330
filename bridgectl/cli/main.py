"""The command line: parse, call, print."""

from __future__ import annotations

import argparse
import json
import os
import sys
import warnings
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager, redirect_stdout
from importlib import import_module
from typing import Any, NoReturn

import bridgectl as bc
from bridgectl import _checks as check
from bridgectl._units import from_kmh
from bridgectl._work import memory_advice
from bridgectl.cli import options
from bridgectl.cli.assess import ASSESS_HELP, add_assess_options, run_assess
from bridgectl.cli.dae import DAE_HELP, add_dae_options, run_dae
from bridgectl.cli.score import SCORE_HELP, add_score_options, run_score
from bridgectl.cli.trucks import TRUCKS_HELP, add_trucks_options, run_trucks
from bridgectl.cli.tune import TUNE_HELP, add_tune_options, run_tune

SEGMENT = 100.0
"""Segments of a road that get an IRI each [m]."""

OUTPUT = "standard output"

MAIN_HELP = """\
What a road does to a bridge, and what dampers can do about it: dynamic amplification of a vehicle's
crossing.

  bridgectl score     damper strategies, scored for a bridge: amplification, road wear, ride
  bridgectl tune      gains of a damper strategy, tuned for a bridge and judged on other roads
  bridgectl dae       the dynamic amplification estimate (DAE) of a measured road
  bridgectl assess    what random traffic does to a bridge: amplification, characteristic effects
  bridgectl profile   roughness (IRI), spectrum and ISO 8608 class of a road file
  bridgectl trucks    the catalog of trucks: axle loads, distances, natural frequencies
  bridgectl paper     every number of Li, OBrien and Gonzalez (2006) beside the computed one
  bridgectl validate  its Section 4 again: DAE against DAF on eight good roads and three spans;
                      with --dampers whether DAE orders dampers

Without a road file, score, dae and profile take a measured road that comes with the program."""

PROFILE_HELP = """\
Measure the tracks of a road file:

  IRI             International Roughness Index (ASTM E1926), of all and of each segment;
                  a road is good, in the sense of Li, OBrien and Gonzalez (2006), below 7 m/km
  G_d(n0), w      line of ISO 8608 through the spectrum: roughness at n0 = 0.1 cycles/m, waviness
  class           ISO 8608 class of that roughness, A to H
  coarse          measured at steps above one foot: the IRI is too low, and there is no class

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

With --dampers: does the DAE of second order, over a road class, order dampers as simulation does?
34 of them, 11 of which had no part in finding its formula, cross the same bridges after 60 m of
approach, on 60 random roads of class A and of class B and on their mirror images. It takes some ten
minutes on two cores; --resume FILE keeps what is done (in files with the span in their names).

examples:
  bridgectl validate --plot validation.png
  bridgectl validate --dampers --resume dampers.jsonl --plot dampers.png
  bridgectl validate --spans 25 --speeds 60:120:5 --json"""


class _Parser(argparse.ArgumentParser):
    """A parser whose complaint is one line."""

    def error(self, message: str) -> NoReturn:
        raise ValueError(f"{message} (see {self.prog} --help)")


def main(argv: Sequence[str] | None = None) -> int:
    """Run a command, of this process by default; 2 after a mistake, which is told in one line."""
    try:
        with warnings.catch_warnings(), redirect_stdout(_Output()):
            warnings.simplefilter("always", UserWarning)
            warnings.showwarning = _show_each_once()
            try:
                args = _parser().parse_args(argv)
                args.run(args)
            finally:
                sys.stdout.flush()
    except BrokenPipeError:  # a reader such as `head` has seen enough
        _drop_output()
        return 0
    except KeyboardInterrupt:
        return 130
    except (ValueError, TypeError, NotImplementedError) as error:
        _tell("error", error)
        return 2
    except OSError as error:
        if error.filename == OUTPUT:
            _drop_output()
        _tell("error", error)
        return 2
    except MemoryError:  # the estimate let it through, and knows the cause
        _tell("error", memory_advice())
        return 2
    return 0


class _Output:
    """Standard output, with its name in errors of writing."""

    def __init__(self) -> None:
        self.stream = sys.stdout

    def __getattr__(self, name: str) -> Any:
        return getattr(self.stream, name)

    def write(self, text: str) -> int:
        """Write text."""
        with _named_output():
            return self.stream.write(text)

    def flush(self) -> None:
        """Write what waits."""
        with _named_output():
            self.stream.flush()


@contextmanager
def _named_output() -> Iterator[None]:
    try:
        yield
    except OSError as error:
        raise OSError(error.errno, error.strerror, OUTPUT) from None


def _drop_output() -> None:
    """Drop what is not written, which Python would complain of at its end."""
    os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())


def _tell(kind: str, message: object) -> None:
    line = "".join(c if c.isprintable() else " " for c in str(message))
    print(f"bridgectl: {kind}: {' '.join(line.split())}", file=sys.stderr)


def _show_each_once() -> Callable[..., None]:
    told: set[str] = set()

    def show(message: Warning | str, *_: Any, **__: Any) -> None:
        if str(message) not in told:
            told.add(str(message))
            _tell("warning", options.as_options(str(message)))

    return show


def _parser() -> _Parser:
    look = argparse.RawDescriptionHelpFormatter
    parser = _Parser(prog="bridgectl", description=MAIN_HELP, formatter_class=look)
    parser.add_argument("--version", action="version", version=f"bridgectl {bc.__version__}")
    commands = parser.add_subparsers(required=True, metavar="COMMAND")

    def command(
        name: str, run: Callable[[argparse.Namespace], None], brief: str, description: str
    ) -> argparse.ArgumentParser:
        made = commands.add_parser(name, help=brief, description=description, formatter_class=look)
        made.set_defaults(run=run)
        return made

    score = command("score", run_score, "damper strategies, scored for a bridge", SCORE_HELP)
    add_score_options(score)
    brief = "gains of a damper strategy, tuned for a bridge"
    add_tune_options(command("tune", run_tune, brief, TUNE_HELP))
    brief = "what random traffic does to a bridge"
    add_assess_options(command("assess", run_assess, brief, ASSESS_HELP))
    add_dae_options(command("dae", run_dae, "DAE and DAF of a measured road", DAE_HELP))
    brief = "IRI, spectrum and ISO class of a road file"
    profile = command("profile", _run_profile, brief, PROFILE_HELP)
    options.add_file_options(profile)
    text = f"length over which IRIs are taken [m] (default {SEGMENT:g})"
    options.add_option(profile, "--segment", "M", text, options.as_number, SEGMENT)
    add_trucks_options(command("trucks", run_trucks, "the catalog of trucks", TRUCKS_HELP))
    command("paper", _run_paper, "the paper's numbers", PAPER_HELP)
    validate = command("validate", _run_validate, "DAE against DAF on good roads", VALIDATE_HELP)
    options.add_validation_options(validate)
    for made in commands.choices.values():
        options.add_output_options(made)
    return parser


def _json(results: dict[str, Any]) -> str:
    return json.dumps(results, indent=1)


def _figure(name: str) -> Any:
    """A figure's function, by module and name, that is loaded when it is drawn."""
    module, _, what = name.partition(".")
    return getattr(import_module(f"bridgectl.plots.{module}"), f"{what}_figure")


def _run_profile(args: argparse.Namespace) -> None:
    from bridgectl.cli.tables import measure_track, print_profile, profile_json

    options.check_plot(args.plot)
    if args.file is None:
        options.refuse_file_options(args)
        roads = [bc.utia_road()]
    elif args.track is not None:
        roads = [bc.read_profile(args.file, track=args.track, **options.file_arguments(args))]
    else:
        roads = bc.read_tracks(args.file, **options.file_arguments(args))
    tracks = [measure_track(road, args.segment) for road in roads]
    first, *others = (track.road for track in tracks)
    options.deliver(
        args, lambda: first.plot_roughness(*others, segment=args.segment),
        lambda: _json(profile_json(tracks, args.segment)),
        lambda: print_profile(tracks, args.segment),
    )  # fmt: skip


def _run_paper(args: argparse.Namespace) -> None:
    from bridgectl.cli.tables import paper_json, print_paper
    from bridgectl.paper.printed import paper_results

    options.check_plot(args.plot)
    with options.working("computing the paper's surfaces"):
        results = paper_results()
    options.deliver(
        args, lambda: _figure("surface.paper")(results),
        lambda: _json(paper_json(results)), lambda: print_paper(results),
    )  # fmt: skip


def _run_validate(args: argparse.Namespace) -> None:
    if args.dampers:
        _run_validate_dampers(args)
        return
    for option in ("pairs", "resume"):
        if getattr(args, option) is not None:
            raise ValueError(f"--{option} goes with --dampers: add it, or leave --{option} out")
    from bridgectl.cli.validation import print_validation, validation_json
    from bridgectl.paper.good_roads import LAST, good_roads
    from bridgectl.paper.validation import validate

    options.check_plot(args.plot)
    options.check_work(args)
    spans = list(dict.fromkeys(options.numbers("--spans", args.spans, int)))
    if max(spans) > LAST:
        raise ValueError(f"--spans must be {LAST:g} m at most, as the roads, got {args.spans}")
    speeds = from_kmh(options.parse_speeds(args.speeds or "50:150:1"))
    for span in spans:  # of a span that there is not, before the work
        bc.li2006.beam(span)
    with options.working("making the roads"):
        roads = good_roads()
    results = validate(speeds, spans, roads=roads, workers=args.workers, scheduler=args.scheduler)
    options.deliver(
        args, lambda: _figure("validation.validation")(results),
        lambda: _json(validation_json(results)), lambda: print_validation(results),
    )  # fmt: skip


def _run_validate_dampers(args: argparse.Namespace) -> None:
    from bridgectl.cli.dampers import damper_validation_json, print_damper_validation
    from bridgectl.paper.damper_validation import N_PAIRS, validate_dampers

    options.check_plot(args.plot)
    options.check_work(args)
    spans = list(dict.fromkeys(options.numbers("--spans", args.spans, int)))
    speeds = from_kmh(options.parse_speeds(args.speeds or "60:120:5"))
    pairs = check.integer("--pairs", N_PAIRS if args.pairs is None else args.pairs, at_least=2)
    with options.resumed(args.resume):
        cases = validate_dampers(
            speeds, spans, pairs, resume=args.resume, workers=args.workers,
            scheduler=args.scheduler,
        )  # fmt: skip
    options.deliver(
        args, lambda: _figure("validation.damper_validation")(cases),
        lambda: _json(damper_validation_json(cases)), lambda: print_damper_validation(cases),
    )  # fmt: skip
