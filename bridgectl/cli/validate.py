"""`bridgectl validate`: DAE against DAF on good roads; tables for people, JSON for programs."""

from __future__ import annotations

import argparse
import json
from typing import Any

import bridgectl as bc
from bridgectl._tables import make_console, make_table
from bridgectl._units import from_kmh, to_kmh
from bridgectl._version import __version__
from bridgectl.cli import options
from bridgectl.cli.dampers import run_validate_dampers
from bridgectl.paper.good_roads import LAST, good_roads
from bridgectl.paper.validation import (
    PEAK_TOLERANCE,
    SUPERPOSED_TOLERANCE,
    Case,
    ValidationResults,
    validate,
)
from bridgectl.road.iri import GOOD

NOTE = """\
Peaks are over the speeds; difference: peak DAE minus peak DAF. rms, largest: DAE minus DAF at one
speed. exact: largest difference of superposed and simulated DAF where the tires stay down. off: at
how many speeds a tire leaves the road.
"""
"""What the columns of the validation are."""


def run_validate(args: argparse.Namespace) -> None:
    """Do what the command asks for."""
    if args.dampers:
        run_validate_dampers(args)
        return
    for option in ("pairs", "resume"):
        if getattr(args, option) is not None:
            raise ValueError(f"--{option} goes with --dampers: add it, or leave --{option} out")
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
        args, lambda: options.figure("validation.validation", results),
        lambda: json.dumps(validation_json(results), indent=1), lambda: print_validation(results),
    )  # fmt: skip


def print_validation(results: ValidationResults) -> None:
    """Print every case of the validation and its summary."""
    console = make_console()
    table = make_table("Roads", ["road", "from [m]", "to [m]", "IRI [m/km]", ""], ["road", ""])
    for road, iri in zip(results.roads, results.iri, strict=True):
        good = "good" if iri < GOOD else "not good"
        table.add_row(road.name, f"{road.x[0]:g}", f"{road.x[-1]:g}", f"{iri:.2f}", good)
    console.print(table)
    columns = ["road", "peak DAF", "km/h", "peak DAE", "km/h", "difference", "rms",
               "largest", "km/h", "exact", "off"]  # fmt: skip
    for cases in results.groups.values():
        table = make_table(_place(cases[0]), columns)
        for case in cases:
            table.add_row(str(case.road), *_case_cells(case))
        console.print(table)
    console.print(NOTE, soft_wrap=True)
    for line in _summary(results):
        console.print(line, soft_wrap=True)


def _case_cells(case: Case) -> list[str]:
    cells = []
    for peak in (case.daf_peak, case.dae_peak):
        cells += [f"{peak.value:.4f}", f"{to_kmh(peak.speed):g}"]
    # No negative zero.
    cells += [f"{round(case.peak_difference, 4) + 0.0:+.4f}", f"{case.rms_error:.4f}"]
    cells += [f"{case.largest_error.value:.4f}", f"{to_kmh(case.largest_error.speed):g}"]
    flying = int(case.flying.sum())
    return [*cells, f"{case.superposed_error:.0e}", str(flying) if flying else "-"]


def _summary(results: ValidationResults) -> list[str]:
    n_cases, peak, exact = len(results.cases), results.worst_peak, results.worst_superposed
    median, superposed = results.median_difference, exact.superposed_error
    close = sum(abs(case.peak_difference) < PEAK_TOLERANCE for case in results.cases)
    lines = [
        f"Peak DAE and peak DAF of {n_cases} cases, {len(results.speeds)} speeds: median "
        f"difference {median:.1e}, {_judged(median, PEAK_TOLERANCE)};",
        f"below {PEAK_TOLERANCE:g} in {close}; largest {peak.peak_difference:+.4f}, {_name(peak)}.",
        f"Superposed and simulated DAF: largest difference {superposed:.1e}, "
        f"{_judged(superposed, SUPERPOSED_TOLERANCE)}; {_name(exact)}.",
    ]
    spans = ", ".join(f"{span:g} m {v:.1e}" for span, v in results.median_differences.items())
    light = results.light
    lines += [
        f"Median difference of the peaks by span: {spans}.",
        f"Warning light of the DAE, {light.crossings} crossings of class A and B roads on 25 m: an "
        f"error above {light.tolerance:g} at {light.large / light.crossings:.0%}, told of with "
        f"precision {light.precision:.2f} and recall {light.recall:.2f}.",
    ]
    lines += [
        f"A tire leaves the road, first at x = {case.lift_off:.1f} m: {_name(case)}."
        for case in results.cases
        if case.lift_off is not None
    ]
    return lines


def _judged(value: float, limit: float) -> str:
    return f"required below {limit:g}: {'met' if value < limit else 'not met'}"


def _name(case: Case) -> str:
    return f"road {case.road}, {_place(case)}"


def _place(case: Case) -> str:
    where = f"{case.approach:g} m of approach" if case.approach else "at rest at its start"
    return f"{case.span:g} m bridge, {where}"


def validation_json(results: ValidationResults) -> dict[str, Any]:
    """Give every case of the validation at every speed, with units in the keys."""
    light = results.light
    return {
        "bridgectl": __version__,
        "speed_km_per_h": to_kmh(results.speeds).tolist(),
        "roads": [
            {"road": number, "name": road.name, "iri_m_per_km": float(iri)}
            for number, (road, iri) in enumerate(zip(results.roads, results.iri, strict=True), 1)
        ],
        "cases": [_case_json(case) for case in results.cases],
        "median_peak_difference": results.median_difference,
        "median_peak_difference_required_below": PEAK_TOLERANCE,
        "median_peak_difference_by_span_m": results.median_differences,
        "warning_light": {**light._asdict(), "precision": light.precision, "recall": light.recall},
        "largest_peak_difference": results.worst_peak.peak_difference,
        "largest_superposed_error": results.worst_superposed.superposed_error,
        "superposed_error_required_below": SUPERPOSED_TOLERANCE,
    }


def _case_json(case: Case) -> dict[str, Any]:
    return {
        "span_m": case.span, "approach_m": case.approach, "road": case.road,
        "daf_smooth": case.smooth.tolist(), "dae": case.dae.tolist(),
        "daf_superposed": case.superposed.tolist(), "daf_simulated": case.simulated.tolist(),
        "peak_daf": case.daf_peak.value, "peak_daf_speed_km_per_h": to_kmh(case.daf_peak.speed),
        "peak_dae": case.dae_peak.value, "peak_dae_speed_km_per_h": to_kmh(case.dae_peak.speed),
        "peak_difference": case.peak_difference, "dae_rms_error": case.rms_error,
        "dae_largest_error": case.largest_error.value,
        "dae_largest_error_speed_km_per_h": to_kmh(case.largest_error.speed),
        "superposed_error": case.superposed_error,
        "lift_off_speeds_km_per_h": to_kmh(case.speeds[case.flying]).tolist(),
        "lift_off_x_m": case.lift_off,
    }  # fmt: skip
