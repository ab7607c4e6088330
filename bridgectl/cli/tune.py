"""`bridgectl tune`: its options, and what they ask for."""

from __future__ import annotations

import argparse
from typing import TYPE_CHECKING, Any, cast

import numpy as np

import bridgectl as bc
from bridgectl import _checks as check
from bridgectl._units import from_kmh
from bridgectl.cli import bridges, options, roads
from bridgectl.cli.commands.tune import RANDOM
from bridgectl.cli.score import checked_hardware
from bridgectl.model.bridge import BridgeModel
from bridgectl.road.psd import CLASSES

if TYPE_CHECKING:
    from bridgectl.dampers import Strategy

PROGRAM = "program"
"""What --strategy calls a damping for each place."""

REACH = 20.0
"""How far before the bridge the places of a program begin [m], if the approach is as long."""


def run_tune(args: argparse.Namespace) -> None:
    """Do what the command asks for."""
    from bridgectl.dampers import Damper

    options.check_plot(args.plot)
    _check_numbers(args)
    speeds = from_kmh(options.parse_speeds(args.speeds))
    beam, vehicle = bridges.make_bridge(args), cast(Any, options.make_vehicle(args))
    c_min, c_max, sample_time, hardware = checked_hardware(args, vehicle)
    strategy = _strategy(args, beam, vehicle, c_min, c_max)
    training, held_out = _roads(args, beam.length)
    tuned = bc.tune(
        Damper(strategy, sample_time, **hardware), beam, vehicle, training, speeds,
        held_out=held_out, gains=None if args.gains is None else args.gains.split(","),
        objective=args.objective, softness=args.softness, method=args.method,
        iterations=args.iterations, approach=args.approach, section=args.section,
        recovery=args.recovery, workers=args.workers,
    )  # fmt: skip
    from bridgectl.scoring.tuning_text import print_tuning

    options.deliver(args, tuned.plot, tuned.to_json, lambda: print_tuning(tuned))


def _check_numbers(args: argparse.Namespace) -> None:
    """Check what has other names in the library."""
    for name, least in (("random", 0), ("held_out", 0), ("places", 2), ("iterations", 1)):
        check.integer(f"--{name.replace('_', '-')}", getattr(args, name), at_least=least)
    if args.workers is not None:
        check.integer("--workers", args.workers, at_least=1)
    if args.softness is not None:
        check.positive("--softness", args.softness)
    check.choice("--class", getattr(args, "class"), tuple(CLASSES))
    if not args.roads and args.random == 0:
        raise ValueError(
            f"--random 0 leaves no training roads: name files, or type --random {RANDOM}"
        )


def _strategy(
    args: argparse.Namespace, beam: BridgeModel, vehicle: Any, c_min: float, c_max: float
) -> Strategy:
    """The strategy that is asked for, with the gains where the search starts."""
    from bridgectl.dampers import library, program

    known = {each.name.lower(): each
             for each in library(beam, vehicle, c_min, c_max, section=args.section)[1:]
             if each.gains and each.kept is None}  # fmt: skip
    name = None if args.strategy is None else " ".join(args.strategy.split()).lower()
    if name == PROGRAM:
        places = np.linspace(-min(args.approach, REACH), beam.length, args.places)
        own = float(np.clip(np.mean(vehicle.linear.damper_dampings), c_min, c_max))
        return program(places, [own] * args.places, shape="lines", bounds=(c_min, c_max))
    if name not in known:
        listed = ", ".join([*(each.name for each in known.values()), PROGRAM])
        told = "--strategy is needed" if name is None else f"--strategy: there is no {name!r}"
        raise ValueError(f"{told}; there are: {listed}")
    return known[name]


def _roads(
    args: argparse.Namespace, span: float
) -> tuple[list[bc.RoadProfile], list[bc.RoadProfile]]:
    """Training roads, and those held out."""
    options.check_ramps("--approach", args.approach)
    if not args.roads:
        options.refuse_file_options(args)
    own = roads.file_roads(args, span, 0.0) if args.roads else []
    iso_class, number = getattr(args, "class"), args.random + args.held_out
    random = roads.random_roads(iso_class, number, args.approach, args.approach + span)[iso_class]
    return own + random[: args.random], random[args.random :]
