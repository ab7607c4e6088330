"""`bridgectl validate --dampers`: does DAE order dampers; tables for people, JSON for programs."""

from __future__ import annotations

import argparse
import json
import math
from collections.abc import Sequence
from typing import Any

import numpy as np

from bridgectl import _checks as check
from bridgectl._tables import make_console, make_table
from bridgectl._units import from_kmh
from bridgectl._version import __version__
from bridgectl.cli import options
from bridgectl.paper.damper_validation import FAR, N_PAIRS, DamperCase, validate_dampers
from bridgectl.scoring.agreement import CONFIDENCE, Pairs

CLEAR_REQUIRED, SHORT_SPAN, SHORT_REQUIRED = 0.90, 15.0, 0.95
"""Share of the clear pairs to be in the right order, and that on bridges up to a span [m]."""

FAR_REQUIRED = 0.97
"""Share of the pairs more than 0.005 apart to be in the right order."""

N_WRONG = 5
"""Pairs in the wrong order that are listed of each bridge and class."""

NOTE = """\
tau: Kendall's, of class DAE and simulated mean DAF, with its {confidence:g} % interval of roads
drawn again; known: of the {known} dampers that the formula was found with, and of the mean of
Eq. (15) over the same roads. clear pairs: of the pairs of dampers whose mean DAFs differ clearly,
over pairs of road and mirror image, those that the class DAE has in the right order; far pairs:
of those more than {far:g} apart.
"""

SINGLE_NOTE = """\
share: of what the roads add to the smooth DAF, how much the class DAE has, by a line through all
dampers; r: their correlation about it. Then rms of DAE - DAF over roads, mirror images and speeds.
"""


def run_validate_dampers(args: argparse.Namespace) -> None:
    """Do what the command asks for with --dampers."""
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
        args, lambda: options.figure("validation.damper_validation", cases),
        lambda: json.dumps(damper_validation_json(cases), indent=1),
        lambda: print_damper_validation(cases),
    )  # fmt: skip


def print_damper_validation(cases: Sequence[DamperCase]) -> None:
    """Print what the class DAE has right of dampers, bridge by bridge, and what it has wrong."""
    console = make_console()
    first = cases[0]
    n_roads, n_speeds = 2 * first.daf.shape[2], first.daf.shape[3]
    console.print(
        f"{len(first.dampers)} dampers on {n_roads} roads of each class, half of them mirror "
        f"images, {n_speeds} speeds\n"
    )
    console.print(_order_table(cases))
    note = NOTE.format(confidence=100 * CONFIDENCE, known=first.n_known, far=FAR)
    console.print(note, soft_wrap=True)
    console.print(_error_table(cases))
    console.print(SINGLE_NOTE, soft_wrap=True)
    console.print(_wrong_table(cases))
    for line in _sentences(cases):
        console.print(line)


def _order_table(cases: Sequence[DamperCase]) -> Any:
    columns = ["bridge", "class", "tau", "from", "to", "known\ntau", "Eq. (15)\ntau",
               "clear\npairs", "share", "far\npairs", "share"]  # fmt: skip
    table = make_table("The order of the dampers", columns, ["class"])
    for case in cases:
        table.add_row(
            f"{case.span:g} m", case.road_class, *(f"{value:.2f}" for value in case.tau),
            f"{case.tau_known.tau:.2f}", f"{case.tau_eq_15.tau:.2f}", *_pairs(case.clear_pairs),
            *_pairs(case.far_pairs),
        )  # fmt: skip
    return table


def _pairs(pairs: Pairs) -> tuple[str, str]:
    share = "-" if math.isnan(pairs.share) else f"{pairs.share:.3f}"
    return f"{pairs.right} of {pairs.number}", share


def _error_table(cases: Sequence[DamperCase]) -> Any:
    columns = ["bridge", "class", "share", "r", "all:\nEq. (15)", "second\norder", "ratio",
               "passive:\nEq. (15)", "second\norder", "ratio"]  # fmt: skip
    table = make_table("The level, and errors on single roads", columns, ["class"])
    for case in cases:
        cells = [f"{case.share[0]:.2f}", f"{case.share[1]:.3f}"]
        for rows in (slice(None), slice(1)):  # all, and the vehicle's own damper
            first, second = (float(np.sqrt(np.mean(each[rows] ** 2))) for each in case.errors)
            cells += [f"{first:.4f}", f"{second:.4f}", f"{second / first:.2f}"]
        table.add_row(f"{case.span:g} m", case.road_class, *cells)
    return table


def _wrong_table(cases: Sequence[DamperCase]) -> Any:
    columns = ["bridge", "class", "lower DAF", "higher DAF", "DAF\ndifference", "DAE\ndifference"]
    words = ["class", "lower DAF", "higher DAF"]
    table = make_table(
        f"Clear pairs in the wrong order, the {N_WRONG} furthest apart", columns, words
    )
    for case in cases:
        for each in case.wrong[:N_WRONG]:
            table.add_row(
                f"{case.span:g} m", case.road_class, each.lower, each.higher,
                f"{each.daf_difference:+.4f}", f"{each.dae_difference:+.4f}",
            )  # fmt: skip
    return table


def _sentences(cases: Sequence[DamperCase]) -> list[str]:
    lines = []
    for what, name in (("clear", "clear_pairs"), (f"more than {FAR:g} apart", "far_pairs")):
        worst = min(cases, key=lambda case: _share(getattr(case, name)))
        pairs = getattr(worst, name)
        lines.append(
            f"Pairs that are {what}: {pairs.right} of {pairs.number} in the right order at worst, "
            f"{worst.span:g} m, class {worst.road_class}."
        )
    shares, alike = zip(*(case.share for case in cases), strict=True)
    lines.append(
        f"Of what a road adds to the smooth DAF the class DAE has {min(shares):.2f} to "
        f"{max(shares):.2f}, nearly the same share for all dampers of a case (correlation "
        f"{min(alike):.3f} or more): it takes ramps one at a time, so that order is kept and level "
        "is not."
    )
    short = [
        f"{case.span:g} m, class {case.road_class}: {pairs.right} of {pairs.number} {what} pairs, "
        f"{least:g} required"
        for case in cases
        for what, pairs, least in (
            ("clear", case.clear_pairs, required_share(case.span)),
            ("far", case.far_pairs, FAR_REQUIRED),
        )
        if _share(pairs) < least
    ]
    lines.append("Fewer than required: " + "; ".join(short) + "." if short else
                 "As many as required in every case.")  # fmt: skip
    return lines


def required_share(span: float) -> float:
    """Share of the clear pairs that is to be in the right order on a bridge so long [m]."""
    return SHORT_REQUIRED if span <= SHORT_SPAN else CLEAR_REQUIRED


def _share(pairs: Pairs) -> float:
    return 1.0 if math.isnan(pairs.share) else pairs.share


def damper_validation_json(cases: Sequence[DamperCase]) -> dict[str, Any]:
    """Give every damper's means and errors, and what is made of them, with units in the keys."""
    return {"bridgectl": __version__, "cases": [_case_json(case) for case in cases]}


def _case_json(case: DamperCase) -> dict[str, Any]:
    first, second = case.errors
    return {
        "span_m": case.span, "road_class": case.road_class,
        "roads_and_mirror_images": 2 * case.daf.shape[2],
        "dampers": [
            {
                "name": name, "known": i < case.n_known, "mean_daf": float(case.mean_daf[i]),
                "class_dae": float(case.class_dae[i]), "mean_eq_15": float(case.mean_eq_15[i]),
                "rms_error_eq_15": float(first[i]), "rms_error_second_order": float(second[i]),
            }
            for i, name in enumerate(case.dampers)
        ],
        "tau": case.tau._asdict(), "tau_known": case.tau_known._asdict(),
        "tau_known_eq_15": case.tau_eq_15._asdict(), "clear_pairs": case.clear_pairs._asdict(),
        "clear_pairs_required_share": required_share(case.span),
        "far_pairs": case.far_pairs._asdict(), "far_pairs_required_share": FAR_REQUIRED,
        "share_of_what_roads_add": case.share[0], "share_correlation": case.share[1],
        "rms_error_ratio": case.error_ratio, "wrong_pairs": [each._asdict() for each in case.wrong],
    }  # fmt: skip
