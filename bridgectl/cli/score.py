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
from bridgectl.cli.answer import checked_modulus, next_steps
from bridgectl.cli.effects import Asked, asked_effects
from bridgectl.model.bridge import BridgeModel

if TYPE_CHECKING:
    from bridgectl.dampers import Damper, Strategy
    from bridgectl.scoring.changes import Robustness

RANDOM_CLASSES = "AB"
"""ISO 8608 classes of the random roads."""

N_CONSTANT = 5
"""Constant dampers between the bounds, beside the vehicle's own."""

PASSIVE, CONSTANT, ROLLOUT = "passive", "constant", "rollout"
"""What --strategies calls the vehicle's own damper, the constant dampers together, and the strategy
that predicts peaks without preview."""

CAREFUL, SIMPLE = "careful bridgehook", "simple bridgehook"
"""Bridgehook made for errors, and the same without feedback."""

LAG, DEVIATION = 0.01, 1.5
"""The lag [s] and the deviation of the position [m] that they are made for."""

ROBUST = f"skyhook,continuous skyhook,groundhook,hybrid,clipped LQR,bridgehook,{CAREFUL},{SIMPLE}"
"""Strategies of --robust by default."""


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


def _tell_robustness(args: argparse.Namespace, asked: Asked, found: Robustness) -> None:
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
    """Score, and print the verdict as soon as it is known; DAE is found if it is asked for."""
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
        print(next_steps(args, modulus=modulus))

    def results() -> str:
        stresses = {} if modulus is None else {
            "mean_stress_N_per_m2": {
                row.strategy: row.daf * board.static_peak / modulus for row in board.rows()
            }
        }  # fmt: skip
        return _json(asked, board, **stresses)

    options.deliver(args, board.plot, results, show)


def _json(asked: Asked, found: bc.Scoreboard | Robustness, **more: Any) -> str:
    return json.dumps(json.loads(found.to_json()) | {"effect": asked.content, **more}, indent=1)


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
