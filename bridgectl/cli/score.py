"""`bridgectl score`: its options, and what they ask for."""

from __future__ import annotations

import argparse
import json
import re
import sys
from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING, Any, cast

import numpy as np

import bridgectl as bc
from bridgectl import _checks as check
from bridgectl._units import from_kmh
from bridgectl.cli import bridges, options, roads
from bridgectl.cli.answer import (
    add_full_option,
    add_stress_option,
    checked_modulus,
    next_steps,
)
from bridgectl.cli.effects import Asked, asked_effects
from bridgectl.model.bridge import BridgeModel

if TYPE_CHECKING:
    from bridgectl.dampers import Damper, Strategy

RANDOM_CLASSES = "AB"
"""ISO 8608 classes of the random roads."""

N_CONSTANT = 5
"""Constant dampers between the bounds, beside the vehicle's own."""

PASSIVE, CONSTANT, ROLLOUT = "passive", "constant", "rollout"
"""What --strategies calls the vehicle's own damper, the constant dampers together, and the strategy
that predicts peaks without preview."""

ROBUST_STEP = "what errors do", "--robust"

CAREFUL, SIMPLE = "careful bridgehook", "simple bridgehook"
"""Bridgehook made for errors, and the same without feedback."""

LAG, DEVIATION = 0.01, 1.5
"""The lag [s] and the deviation of the position [m] that they are made for."""

ROBUST = f"skyhook,continuous skyhook,groundhook,hybrid,clipped LQR,bridgehook,{CAREFUL},{SIMPLE}"
"""Strategies of --robust by default."""

SCORE_HELP = """\
Score damper strategies for a bridge: the library of 14, and constant dampers between the same
bounds, over the same roads and speeds. Prints, for each strategy:

  the bridge      mean dynamic amplification factor (DAF) of the bending moment, its difference to
                  the vehicle's own passive damper with a 95 % confidence interval over the roads,
                  and the worst speed
  road and ride   dynamic load coefficient, fourth power of the tire force, least tire force, body
                  acceleration (plain and weighted by ISO 2631-1 W_k), suspension travel, switches
  the DAE         the dynamic amplification estimate (DAE) from the strategy's own unit ramps beside
                  the simulated DAF: of Eq. (15), and of second order over the class of the roads;
                  how either orders the strategies

The effect is the bending moment at --section alone; `bridgectl dae` takes others.

With --robust the study is another one: what each strategy, made for this bridge and vehicle, gains
or loses when something is wrong (frequency and damping of the bridge, load, the speed and position
that it is told, lag, samples, noise, filters for velocities, or all at once), for each road class
beside the vehicle's own damper; harm is marked. It takes two minutes on two cores. There are two
more strategies: careful bridgehook (made for 10 ms of lag and a position known to 1.5 m) and simple
bridgehook (the same without feedback).

The library: passive (the vehicle's own), preset, skyhook, continuous skyhook, groundhook, tire
groundhook, extended groundhook, selective groundhook, hybrid, ADD, SH-ADD, PDD, clipped LQR,
bridgehook. Slower ones by --strategies alone, of a quarter-car: rollout, which predicts the peak of
what it commands, and 'preview 10 m', which sees the road as far ahead.

ROAD is delimited text, ERD text or OpenCRG, whose units the file states ('x [m], z [mm]') or
--units tells; the file options hold for all of them. Without ROAD: a measured road that comes with
the program. Beside the files there are --random N roads of ISO 8608 class A and N of class B, the
same every time. Without options it takes a minute on two cores; --resume FILE keeps what is done
when it is interrupted.

examples:
  bridgectl score --plot score.png
  bridgectl score east.csv west.csv --units m,mm --station 1250 --span 35 --random 0
  bridgectl score --strategies skyhook,groundhook,bridgehook --lag 0.01 --max-force 20e3
  bridgectl score --spans 25,25 --mass-per-length 18e3 --frequency 4.1 --section 0.2
  bridgectl score --robust --plot robust.png
  bridgectl score --robust --strategies bridgehook,hybrid --errors position,lag --random 40
  bridgectl score --random 50 --resume score.jsonl --json > score.json"""


def add_score_options(parser: argparse.ArgumentParser) -> None:
    """Add every option but those of the output."""
    options.add_file_options(parser, many=True)
    options.add_place_options(parser, approach=60.0, speeds="60:120:10")
    text = "road after the bridge that is driven, for ride and tire force [m] (default 0)"
    options.add_option(parser, "--departure", "M", text, options.as_number, 0.0)
    text = "random roads of ISO 8608 class A, and as many of class B (default 6; --robust 20)"
    options.add_option(parser, "--random", "N", text, options.as_whole)
    text = "find the optimum with all of the road known, too, and the share of the gap to it that "
    text += "each strategy closes: some seconds for each; with --approach 0 a proven bound, too"
    parser.add_argument("--clairvoyant", action="store_true", help=text)
    _add_damper_options(parser)
    robust = parser.add_argument_group("robustness")
    text = "what is left of each strategy's gain when something is wrong"
    robust.add_argument("--robust", action="store_true", help=text)
    options.add_option(robust, "--errors", "KIND,KIND", "what is wrong, as 'position,lag' (default "
                       "all that are known)")  # fmt: skip
    bridges.add_bridge_options(parser)
    add_stress_option(parser)
    add_full_option(parser)
    options.add_vehicle_options(parser)
    work = parser.add_argument_group("work")
    options.add_resume_option(work)
    options.add_work_options(work)


def _add_damper_options(parser: argparse.ArgumentParser) -> None:
    group = parser.add_argument_group(
        "semi-active damper", "Force limit, lag and noise leave constant dampers as they are."
    )
    options.add_option(
        group, "--strategies", "NAME,NAME", "those of the library to score beside the vehicle's "
        "own damper; 'constant' for the constant dampers (default all)",
    )  # fmt: skip
    add_hardware_options(group)


def add_hardware_options(group: argparse._ArgumentGroup) -> None:
    """Add the damper's range, and what makes it less than ideal."""
    for option, default, text in (
        ("--c-min", 1e3, "least damping [N s/m] (default 1000)"),
        ("--c-max", 30e3, "largest damping [N s/m] (default 30000)"),
        ("--lag", 0.0, "time constant with which the damping follows [s] (default 0)"),
        ("--sample-time", 2e-3, "time between samples of the controller [s] (default 0.002)"),
        ("--max-force", np.inf, "largest damper force [N] (default none)"),
        ("--velocity-noise", 0.0, "noise on measured velocities, rms [m/s] (default 0)"),
    ):
        options.add_option(group, option, "X", text, options.as_number, default)
    options.add_option(group, "--seed", "N", "of the noise (default 0)", options.as_whole, 0)


def run_score(args: argparse.Namespace) -> None:
    """Do what the command asks for."""
    options.check_plot(args.plot)
    options.check_work(args)
    kinds = _checked_kinds(args)
    speeds = from_kmh(options.parse_speeds(args.speeds))
    beam, vehicle = bridges.make_bridge(args), cast(Any, options.make_vehicle(args))
    (asked,) = asked_effects(args, beam, vehicle)
    dampers = _dampers(args, beam, vehicle)
    driven, places = _roads(args, beam.length)
    case = dampers, beam, vehicle, driven, speeds
    work = {
        "approach": args.approach, "section": args.section, "recovery": args.recovery,
        "resume": args.resume, "workers": args.workers, "scheduler": args.scheduler,
    }  # fmt: skip
    with options.resumed(args.resume):
        if args.robust:
            _tell_robustness(args, asked, bc.robustness(*case, errors=kinds, **work))
        else:
            _score(args, asked, case, work, places)


def _tell_robustness(args: argparse.Namespace, asked: Asked, found: bc.Robustness) -> None:
    """Print or draw a study of robustness."""
    from bridgectl.scoring.robust_text import print_robust

    def show() -> None:
        print(f"Effect: {asked.told}")
        print_robust(found)

    options.deliver(args, found.plot, lambda: _json(asked, found), show)


def _score(
    args: argparse.Namespace, asked: Asked, case: tuple[Any, ...], work: dict[str, Any],
    places: list[str],
) -> None:  # fmt: skip
    """Score, and print the verdict as soon as it is known; DAE is found if something asks for it."""
    from bridgectl.scoring.text import print_full, print_short, print_verdict

    modulus = checked_modulus(args, [asked])

    def tell(board: bc.Scoreboard) -> None:
        print_verdict(board, modulus)
        if not args.full:
            print_short(board, modulus, places)
        sys.stdout.flush()  # the rest may take longer

    board = bc.score(
        *case, departure=args.departure, clairvoyant=args.clairvoyant, **work,
        dae=bool(args.full or args.json or args.plot or args.resume),
        on_simulated=None if args.json else tell,
    )  # fmt: skip

    def show() -> None:
        if args.full:
            print_full(board, modulus, places)
        print(next_steps(args, ROBUST_STEP))

    options.deliver(args, board.plot, lambda: _json(asked, board), show)


def _json(asked: Asked, found: bc.Scoreboard | bc.Robustness) -> str:
    return json.dumps(json.loads(found.to_json()) | {"effect": asked.content}, indent=1)


def _checked_kinds(args: argparse.Namespace) -> list[str] | None:
    """The kinds of errors that --errors names."""
    if not args.robust:
        if args.errors is not None:
            raise ValueError("--errors goes with --robust: add it, or leave --errors out")
        return None
    for option in ("full", "section_modulus"):
        if getattr(args, option):
            name = option.replace("_", "-")
            raise ValueError(f"--{name} goes with a score, and --robust prints all: leave it out")
    if args.departure:
        raise ValueError("--robust looks at the bridge alone: leave --departure out")
    if args.clairvoyant:
        raise ValueError("--clairvoyant goes with a score: leave it or --robust out")
    if args.errors is None:
        return None
    from bridgectl.scoring.errors import KINDS

    kinds = [" ".join(kind.split()) for kind in args.errors.split(",")]
    for kind in kinds:
        check.choice("--errors", kind, KINDS)
    return kinds


def _dampers(args: argparse.Namespace, beam: BridgeModel, vehicle: Any) -> list[Damper]:
    """The strategies that are asked for, each in a damper."""
    from bridgectl.dampers import Damper, library

    c_min, c_max, sample_time, hardware = checked_hardware(args, vehicle)
    own, *others = library(beam, vehicle, c_min, c_max, section=args.section)
    if args.robust:
        others += _made_for_errors(args, beam, vehicle)
    names = ROBUST if args.robust and args.strategies is None else args.strategies
    constants = _constants(c_min, c_max, set(vehicle.linear.damper_dampings.tolist()))

    def rollout(name: str) -> Strategy | None:
        return _rollout(name, beam, vehicle, c_min, c_max, section=args.section)

    return [
        Damper(strategy, sample_time, **({} if strategy.c_min == strategy.c_max else hardware))
        for strategy in [own, *_chosen(names, others, constants, rollout)]
    ]


def checked_hardware(
    args: argparse.Namespace, vehicle: Any
) -> tuple[float, float, float, dict[str, Any]]:
    """Bounds of the damping [N s/m], sample time [s], and arguments of `Damper` beside them."""
    c_min = check.positive("--c-min", args.c_min, unit="N s/m")
    c_max = check.positive("--c-max", args.c_max, unit="N s/m")
    if not c_min < c_max:
        raise ValueError(f"--c-min must be below --c-max, got {c_min:g} and {c_max:g} N s/m")
    if isinstance(vehicle, bc.QuarterCar):
        check.positive("--damping", vehicle.damping, unit="N s/m")
    hardware = {
        "lag": check.not_negative("--lag", args.lag, unit="s"),
        "velocity_noise": check.not_negative("--velocity-noise", args.velocity_noise, unit="m/s"),
        "max_force": args.max_force,
        "seed": check.integer("--seed", args.seed, at_least=0),
    }
    if not args.max_force > 0:
        raise ValueError(f"--max-force must be above 0 [N], got {args.max_force:g}")
    return c_min, c_max, check.positive("--sample-time", args.sample_time, unit="s"), hardware


def _made_for_errors(args: argparse.Namespace, beam: BridgeModel, vehicle: Any) -> list[Strategy]:
    """Bridgehook made for some lag and an unsure position, with feedback and without."""
    from bridgectl.dampers import bridgehook

    case = beam, vehicle, args.c_min, args.c_max
    return [
        bridgehook(
            *case, section=args.section, feedback=feedback, lag=LAG, position_deviation=DEVIATION
        ).renamed(name)
        for name, feedback in ((CAREFUL, True), (SIMPLE, False))
    ]


def _rollout(name: str, *case: Any, section: float) -> Strategy | None:
    """The strategy that predicts peaks of a name, with its preview; None of other names."""
    from bridgectl.dampers import preview_hook, rollout_hook

    if name == ROLLOUT:
        return rollout_hook(*case, section=section)
    found = re.fullmatch(r"preview (\d+(?:\.\d+)?) m", name)
    return preview_hook(*case, preview=float(found[1]), section=section) if found else None


def _constants(c_min: float, c_max: float, own: set[float]) -> list[Strategy]:
    """Constant dampers over the range, of round values between its ends, but for all legs' own."""
    from bridgectl.dampers import passive

    rounded = [float(f"{c:.2g}") for c in np.geomspace(c_min, c_max, N_CONSTANT)]
    between = [c for c in rounded if c_min < c < c_max]
    found = {each.name: each for each in map(passive, [c_min, *between, c_max])}
    for damping in own if len(own) == 1 else ():
        found.pop(passive(damping).name, None)
    return list(found.values())


def _chosen(
    text: str | None, others: Sequence[Strategy], constants: Sequence[Strategy],
    rollout: Callable[[str], Strategy | None],
) -> list[Strategy]:  # fmt: skip
    """The strategies that --strategies names, in its order."""
    if text is None:
        return [*others, *constants]
    known = {strategy.name.lower(): [strategy] for strategy in others}
    known |= {PASSIVE: [], CONSTANT: list(constants)}
    names = [" ".join(name.split()).lower() for name in text.split(",")]
    for name in names:
        if name not in known and (found := rollout(name)):
            known[name] = [found]
        if name not in known:
            library = (strategy.name for strategy in others)
            listed = ", ".join([PASSIVE, *library, CONSTANT, ROLLOUT, "preview 10 m"])
            raise ValueError(f"--strategies: there is no {name!r}; there are: {listed}")
        if names.count(name) > 1:
            raise ValueError(f"--strategies names {name!r} twice")
    return [strategy for name in names for strategy in known[name]]


def _roads(args: argparse.Namespace, span: float) -> tuple[list[bc.RoadProfile], list[str]]:
    """The files, or else the measured road, and the random roads; where the bridge is in files."""
    options.check_ramps("--approach", args.approach)
    options.check_ramps("--departure", args.departure)
    if args.random is not None:
        check.integer("--random", args.random, at_least=0)
    of_args = roads.file_roads if args.roads else roads.measured_road
    own, places = of_args(args, span, args.departure)
    length = args.approach + span + args.departure
    number = args.random if args.random is not None else 20 if args.robust else 6
    random = roads.random_roads(RANDOM_CLASSES, number, args.approach, length)
    return own + [road for of_class in random.values() for road in of_class], places
