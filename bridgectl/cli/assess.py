"""`bridgectl assess`: its options, and what they ask for."""

from __future__ import annotations

import argparse
import json
import re
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

import bridgectl as bc
from bridgectl import _checks as check
from bridgectl._version import __version__
from bridgectl.cli import bridges, options, roads
from bridgectl.cli.answer import checked_modulus, next_steps
from bridgectl.cli.commands.assess import CLASSES
from bridgectl.cli.effects import asked_effects
from bridgectl.fleet.assessment import QUANTITIES, SHARES
from bridgectl.fleet.study import checked_share
from bridgectl.fleet.tails import METHODS, Estimate
from bridgectl.fleet.text import print_assessment
from bridgectl.model.bridge import BridgeModel

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from bridgectl.dampers import Strategy

PERIOD_STEP = "what is borne", "--trucks-a-day 1500"
TRUCKS_STEP = "your trucks", "--weighed station.csv"

MEASURED = "measured"
"""Quality of the roads in files."""


def run_assess(args: argparse.Namespace) -> None:
    """Do what the command asks for."""
    options.check_plot(args.plot)
    options.check_work(args)
    _check_table(args.table)
    _check_period(args)
    _check_traffic(args)
    bridge, fleet = bridges.make_bridge(args), _fleet(args)
    asked = asked_effects(args, bridge, fleet.passing(0).vehicle)
    modulus = checked_modulus(args, asked)
    driven, places = _roads(args, bridge.length)
    with options.resumed(args.resume):
        found = bc.assess(
            bridge, fleet, driven,
            effects={each.name: each.effect for each in asked}, n=_count(args, fleet),
            approach=args.approach, damper=_damper(args), damper_share=args.damper_share,
            meeting_rate=args.meeting, lane_factor=args.lane_factor, trucks_a_day=args.trucks_a_day,
            seed=args.seed, resume=args.resume, workers=args.workers, scheduler=args.scheduler,
        )  # fmt: skip
    if args.table is not None:
        write = found.to_csv if args.table.suffix.lower() == ".csv" else found.to_parquet
        write(str(args.table))
    rule = {"method": args.method, "days_a_year": args.days_a_year}

    steps = [] if found.trucks_a_day else [PERIOD_STEP]
    steps += [] if args.weighed or args.fleet else [TRUCKS_STEP]

    def show() -> None:
        print_assessment(found, args.return_period, rule, full=args.full, section_modulus=modulus)
        print(*places, sep="\n", end="\n" * bool(places))
        if args.table is not None:
            print(f"Table: {args.table}")
        print(next_steps(args, *steps, modulus=modulus))

    def draw() -> dict[Path, Figure]:
        return {
            path: found.plot(args.return_period, effect=effect, quality=quality, **rule)
            for path, (effect, quality) in _pictures(args.plot, found).items()
        }

    try:
        options.deliver(
            args,
            draw,
            lambda: json.dumps(assessment_json(found, args, rule, modulus), indent=1),
            show,
        )
    except ValueError:  # where there is no tail there is no figure, but all else
        if not args.json:
            show()
        raise


def _pictures(path: Path, found: bc.Assessment) -> dict[Path, tuple[str, str]]:
    """The file of the figure of each effect and quality; with their names of several."""
    each = [(effect, quality) for effect in found.effects for quality in found.qualities]
    if len(each) == 1:
        return {path: each[0]}
    more = len(found.effects) > 1
    return {
        path.with_name(
            f"{path.stem}_{f'{effect}_' * more}{quality}{path.suffix}".replace("@", "_")
        ): (effect, quality)
        for effect, quality in each
    }


def assessment_json(
    found: bc.Assessment, args: argparse.Namespace, rule: dict[str, Any],
    modulus: float | None = None,
) -> dict[str, Any]:  # fmt: skip
    """Give what was found of each effect and quality, with units in the keys."""
    return {
        "bridgectl": __version__,
        "bridge": found.bridge,
        "crossings": len(found),
        "trucks_a_day": found.trucks_a_day,
        "return_period_years": args.return_period,
        **rule,
        "effects": [
            _effect_json(found, effect, quality, args.return_period, rule)
            | _stress_json(found, effect, quality, modulus)
            for effect in found.effects for quality in found.qualities
        ],
    }  # fmt: skip


def _effect_json(
    found: bc.Assessment, effect: str, quality: str, return_period: float, rule: dict[str, Any]
) -> dict[str, Any]:
    """Give quantiles, characteristic effects and ADR; what there is none of is null, and why."""
    own: dict[str, Any] = {"effect": effect, "quality": quality}
    told = own | {"unit": found.effects[effect], "quantiles": SHARES}
    for quantity in QUANTITIES:
        told[quantity] = [_estimate_json(each) for each in found.quantiles(quantity, SHARES, **own)]
    try:
        characteristic = found.characteristic(return_period, **own, **rule)
        told["characteristic_total"] = _estimate_json(characteristic.total)
        told["characteristic_static"] = _estimate_json(characteristic.static)
        told["adr"] = _estimate_json(found.adr(return_period, **own, **rule))
    except ValueError as error:
        why = ("characteristic_total", "characteristic_static", "adr")
        told |= dict.fromkeys(why) | {"why_none": str(error)}
    return told


def _stress_json(
    found: bc.Assessment, effect: str, quality: str, modulus: float | None
) -> dict[str, Any]:
    """Give quantiles of the stress beside those of a moment."""
    if modulus is None or found.effects[effect] != "N m":
        return {}
    return {
        f"{of}_stress_N_per_m2": [
            _estimate_json(Estimate(*(end / modulus for end in each)))
            for each in found.quantiles(of, SHARES, effect=effect, quality=quality)
        ]
        for of in ("static", "total")
    }


def _estimate_json(estimate: Estimate) -> list[float | None]:
    """Value, and the ends of its 95 % interval; null where they are not known."""
    return [None if np.isnan(each) else each for each in estimate]


def _check_period(args: argparse.Namespace) -> None:
    """Refuse before the work what no characteristic value can be found by."""
    check.choice("--method", args.method, METHODS)
    check.positive("--return-period", args.return_period, unit="years")
    check.positive("--days-a-year", args.days_a_year)
    if args.trucks_a_day is not None:
        check.positive("--trucks-a-day", args.trucks_a_day)


def _check_traffic(args: argparse.Namespace) -> None:
    """Check what the trucks do and have."""
    check.not_negative("--meeting", args.meeting, unit="1/h")
    checked_share("--lane-factor", args.lane_factor)
    checked_share("--damper-share", args.damper_share)
    if args.damper is not None and args.meeting:
        raise ValueError("--damper and --meeting exclude each other: dampers go with one truck")


def _check_table(path: Path | None) -> None:
    if path is not None and path.suffix.lower() not in (".csv", ".parquet"):
        raise ValueError(f"--table must end in .csv or .parquet, got {str(path)!r}")
    options.check_output("--table", path)


def _fleet(args: argparse.Namespace) -> bc.Fleet:
    if args.weighed is None:
        if args.weighed_units is not None or args.leave_out_bad:
            option = "--weighed-units" if args.weighed_units is not None else "--leave-out-bad"
            raise ValueError(f"{option} goes with --weighed: type it, or leave {option} out")
        return bc.Fleet.load(args.fleet or "air_sprung", seed=args.seed)
    if args.fleet is not None:
        raise ValueError("--fleet and --weighed exclude each other: leave one out")
    bad = "leave out" if args.leave_out_bad else "error"
    units = _units(args.weighed_units)
    try:
        return bc.Fleet.from_table(args.weighed, units=units, bad=bad, seed=args.seed)
    except ValueError as error:  # what to type there is for Python
        text = re.sub(r'units=\{"(\w+)": "([^"]+)"\}', r"--weighed-units \1=\2", str(error))
        raise ValueError(text.replace('bad="leave out"', "--leave-out-bad")) from None


def _units(text: str | None) -> dict[str, str] | None:
    """Units by columns, from 'speed=km/h,load=kN'."""
    if text is None:
        return None
    pairs = [part.partition("=") for part in text.split(",")]
    if not all(mark for _, mark, _ in pairs):
        raise ValueError(f"--weighed-units must look like speed=km/h,load=kN, got {text!r}")
    return {name.strip(): unit.strip() for name, _, unit in pairs}


def _count(args: argparse.Namespace, fleet: bc.Fleet) -> int | None:
    if args.trucks is None:
        return None if fleet.is_finite else 2000
    return check.integer("--trucks", args.trucks, at_least=1)


def _roads(
    args: argparse.Namespace, length: float
) -> tuple[dict[str, list[bc.RoadProfile]], list[str]]:
    """Roads by quality, those of the files and random ones; where the bridge is in the files."""
    options.check_ramps("--approach", args.approach)
    check.integer("--random", args.random, at_least=1)
    departure = args.approach if args.meeting else 0.0
    found: dict[str, list[bc.RoadProfile]] = {}
    places: list[str] = []
    if args.roads:
        found[MEASURED], places = roads.file_roads(args, length, departure)
    if not args.roads:
        options.refuse_file_options(args)
    text = args.classes or ("" if args.roads else CLASSES)
    classes = [each.strip().upper() for each in text.split(",") if each.strip()]
    for each in classes:
        if each not in tuple("ABCDEFGH") or classes.count(each) > 1:
            raise ValueError(f"--classes must be different ones of A to H, as A,B, got {text!r}")
    whole = args.approach + length + departure
    return found | roads.random_roads(classes, args.random, args.approach, whole), places


def _damper(args: argparse.Namespace) -> Any:
    """What makes the strategy of --damper for each truck."""
    if args.damper is None:
        return None
    return partial(_of_library, " ".join(args.damper.split()).lower())


def _of_library(name: str, bridge: BridgeModel, truck: bc.Vehicle) -> Strategy:
    """The strategy of a name for a bridge and a truck, in the range of `bridgectl score`."""
    from bridgectl.dampers import library

    known = {strategy.name.lower(): strategy for strategy in library(bridge, truck, 1e3, 30e3)[1:]}
    if name not in known:
        raise ValueError(f"--damper: there is no {name!r}; there are: {', '.join(known)}")
    return known[name]
