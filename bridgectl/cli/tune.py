"""`bridgectl tune`: its options, and what they ask for."""

from __future__ import annotations

import argparse
from typing import TYPE_CHECKING, Any, cast

import numpy as np

import bridgectl as bc
from bridgectl import _checks as check
from bridgectl._units import from_kmh
from bridgectl.cli import bridges, options, roads
from bridgectl.cli.score import add_hardware_options, checked_hardware
from bridgectl.model.bridge import BridgeModel
from bridgectl.road.psd import CLASSES

if TYPE_CHECKING:
    from bridgectl.dampers import Strategy

PROGRAM = "program"
"""What --strategy calls a damping for each place."""

RANDOM = 50
"""Random training roads: with 25 a program fits them, and gains nothing elsewhere."""

REACH = 20.0
"""How far before the bridge the places of a program begin [m], if the approach is as long."""

TUNE_HELP = """\
Tune the gains of a damper strategy, or a program of dampings over the place, for a bridge: on the
simulated dynamic amplification factor (DAF) of training roads, or on the class DAE (--objective
class_dae). Prints the gains before and after, and the mean DAF of the training roads and of roads
held out, which the search does not see, with 95 % confidence intervals over the roads: gains that
fit the training roads alone do not help elsewhere, and a warning says so.

NAME is a strategy of the library with gains (skyhook, continuous skyhook, groundhook, tire
groundhook, extended groundhook, selective groundhook, hybrid, ADD, SH-ADD, PDD, clipped LQR), or
'program': dampings at --places places, from 20 m before the bridge to its end, with straight lines
between, that begin as the vehicle's own. A program is tuned by exact gradients, others by
differential evolution, for their DAF is rough.

Training roads are the files ROAD, read as by `bridgectl score`, and --random N roads of --class;
--held-out N more of the class are held out, the same every time. It takes a minute, of laws on the
class DAE some minutes; Ctrl-C ends the search and keeps the best so far.

examples:
  bridgectl tune --strategy hybrid --plot hybrid.png
  bridgectl tune --strategy program --places 12 --random 100 --json > program.json
  bridgectl tune --strategy "clipped LQR" --gains body_gain,axle_gain --objective class_dae
  bridgectl tune east.csv west.csv --units m,mm --random 0 --strategy "extended groundhook\""""


def add_tune_options(parser: argparse.ArgumentParser) -> None:
    """Add every option but those of the output."""
    options.add_file_options(parser, many=True)
    options.add_place_options(parser, approach=60.0, speeds="70,90,108")
    text = f"random training roads (default {RANDOM})"
    options.add_option(parser, "--random", "N", text, options.as_whole, RANDOM)
    text = "random roads that are held out (default 40)"
    options.add_option(parser, "--held-out", "N", text, options.as_whole, 40)
    options.add_option(
        parser, "--class", "A", "ISO 8608 class of the random roads (default A)", default="A"
    )
    _add_search_options(parser)
    group = parser.add_argument_group("semi-active damper")
    add_hardware_options(group)
    bridges.add_bridge_options(parser)
    options.add_vehicle_options(parser)
    work = parser.add_argument_group("work")
    text = "processes (default: one for each core)"
    options.add_option(work, "--workers", "N", text, options.as_whole)


def _add_search_options(parser: argparse.ArgumentParser) -> None:
    group = parser.add_argument_group("tuning")
    options.add_option(group, "--strategy", "NAME", "what is tuned: see above", default=None)
    text = "which gains vary, as share,gain (default all)"
    options.add_option(group, "--gains", "NAME,NAME", text)
    text = "places of a program (default 20)"
    options.add_option(group, "--places", "N", text, options.as_whole, 20)
    text = "daf, or class_dae (default daf)"
    options.add_option(group, "--objective", "WHAT", text, default="daf")
    text = "take the soft maximum over the speeds, of DAFs that far apart, as 0.01 (default mean)"
    options.add_option(group, "--softness", "X", text, options.as_number)
    text = "generations, or gradient (default: as the strategy needs)"
    options.add_option(group, "--method", "WHAT", text)
    text = "generations or gradients at most (default 30)"
    options.add_option(group, "--iterations", "N", text, options.as_whole, 30)


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
    own = roads.file_roads(args, span, 0.0)[0] if args.roads else []
    iso_class, number = getattr(args, "class"), args.random + args.held_out
    random = roads.random_roads(iso_class, number, args.approach, args.approach + span)[iso_class]
    return own + random[: args.random], random[args.random :]
