"""What `bridgectl assess` prints, and `print(assessment)` shows."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any, TypeAlias

import numpy as np
from rich.table import Table

from bridgectl._tables import make_console, make_table, printed
from bridgectl._units import to_kmh
from bridgectl.fleet.levels import Rule
from bridgectl.fleet.tails import CONFIDENCE, METHODS, Estimate
from bridgectl.fleet.verdict import Cell, cells_of, short_table, verdict

# Assessment, whose module imports this one.
Assessed: TypeAlias = Any

DAF_NOTE = """\
DAF: peak of the total effect over that of the static one. R: tire force over the static load, the
least of all crossings.
"""

TAIL_NOTE = """\
Characteristic effects are what one crossing in {crossings:.3g} exceeds: one in {years:g} years
of {days:g} days with {trucks:g} trucks, by {method}. ADR, the assessment dynamic ratio:
total over static one. In brackets: {confidence:g} % intervals. p: how often a sample of the fits to
the total and the static effect lies as far off them as these (Anderson-Darling).
"""

INFLUENCE_NOTE = """\
Differences of mean DAFs over the same trucks, with their {confidence:g} % intervals.
"""


def assessment_text(assessment: Assessed, return_period: float, options: dict[str, Any]) -> str:
    """Return the verdict and the tables of an assessment as text of 100 columns."""
    return printed(print_assessment, assessment, return_period, options)


def print_assessment(
    assessment: Assessed, return_period: float, options: dict[str, Any], *, full: bool = True,
    section_modulus: float | None = None,
) -> None:  # fmt: skip
    """Print the verdict on an assessment, and its tables or a short one.

    Of moments the stress is told there, too, if there is a section modulus [m^3].
    """
    console, cells = make_console(), cells_of(assessment, return_period, options)
    for line in verdict(assessment, cells, return_period, options):
        console.print(line)
    console.print()
    if full:
        _print_tables(assessment, cells, return_period)
        return
    console.print(short_table(assessment, cells, return_period, section_modulus), "")
    _print_reasons(cells, return_period)
    console.print(_heading(assessment).rstrip())


def _print_tables(assessment: Assessed, cells: Sequence[Cell], return_period: float) -> None:
    """Print the tables of an assessment and what they say."""
    console = make_console()
    console.print(_heading(assessment))
    damped = bool(assessment.columns["damped"].any())
    console.print(_daf_table(assessment, cells))
    console.print(DAF_NOTE, soft_wrap=True)
    _print_tails(cells, return_period)
    if len(assessment.qualities) > 1 or damped:
        with_factor = dict.fromkeys(
            cell.effect for cell in cells if np.any(assessment.columns[f"static {cell.effect}"])
        )
        console.print(_influence_table(assessment, with_factor))
        console.print(INFLUENCE_NOTE.format(confidence=100 * CONFIDENCE), soft_wrap=True)


def _heading(assessment: Assessed) -> str:
    columns = assessment.columns
    kmh, weight = to_kmh(columns["speed"]), columns["gross_weight"] / 1e3
    trucks = len(np.unique(columns["truck"]))
    kinds = columns["kind"]
    share = np.bincount(kinds.codes, minlength=len(kinds.names)) / len(kinds.codes)
    told = ", ".join(
        f"{100 * part:.0f} % {name}" for name, part in zip(kinds.names, share, strict=True) if name
    )
    meeting = columns["meeting"].mean()
    return (
        f"{len(assessment)} crossings of {trucks} trucks of {weight.min():.0f} to "
        f"{weight.max():.0f} kN, {kmh.min():.0f} to {kmh.max():.0f} km/h"
        + (f", {100 * meeting:.1f} % meet another" if meeting else "")
        + (f"\nTrucks: {told}" if told else "")
        + (f"\nBridge: {assessment.bridge}" if assessment.bridge else "")
        + "\n"
    )


def _daf_table(assessment: Assessed, cells: Sequence[Cell]) -> Table:
    columns = ["effect", "road", "crossings", "mean\nDAF", "5 %", "50 %", "95 %", "99 %",
               "largest", "least\nR"]  # fmt: skip
    table = make_table("Dynamic amplification", columns, ["effect", "road"])
    for cell in cells:
        quantiles = np.quantile(cell.daf, [0.05, 0.5, 0.95, 0.99])
        numbers = [cell.daf.mean(), *quantiles, cell.daf.max()]
        least = assessment.columns["least_tire_force"][cell.rows].min()
        table.add_row(cell.effect, cell.quality, str(len(cell.rows)),
                      *(_known(each) for each in numbers), _known(least, 2))  # fmt: skip
    return table


def _print_tails(cells: Sequence[Cell], return_period: float) -> None:
    """Print characteristic effects; where there can be none, why."""
    console = make_console()
    with_tail = [(cell, *cell.tail) for cell in cells if cell.tail is not None]
    columns = ["effect", "road", "unit", "total", "static", "ADR", "p"]
    if with_tail:
        title = f"Effects of {return_period:g} years"
        table = make_table(title, columns, ["effect", "road", "unit"])
        for cell, found, ratio, _ in with_tail:
            size, prefix = _size(found.total.value, cell.unit)
            p = " ".join(
                "-" if fit is None or fit.scale == 0 else f"{fit.p_value():.2f}"
                for fit in (found.total_fit, found.static_fit)
            )
            table.add_row(cell.effect, cell.quality, prefix + cell.unit, _told(found.total, size),
                          _told(found.static, size), _told(ratio), p)  # fmt: skip
        console.print(table)
        console.print(_tail_note(with_tail[-1][-1]), soft_wrap=True)
    _print_reasons(cells, return_period)


def _print_reasons(cells: Sequence[Cell], return_period: float) -> None:
    """Print why there are no characteristic effects."""
    for line in dict.fromkeys(cell.why for cell in cells if cell.why):
        make_console().print(f"No effects of {return_period:g} years: {line}\n", soft_wrap=True)


def _tail_note(rule: Rule) -> str:
    how = {METHODS[0]: "the largest of blocks", METHODS[1]: "exceedances of a threshold"}
    return TAIL_NOTE.format(
        crossings=rule.crossings, years=rule.return_period, days=rule.days_a_year,
        trucks=rule.crossings_a_day, method=how[rule.method], confidence=100 * CONFIDENCE,
    )  # fmt: skip


def _influence_table(assessment: Assessed, effects: Any) -> Table:
    columns = ["effect", "road", "what changes", "mean DAF"]
    table = make_table("What changes the amplification", columns, columns[:3])
    first = assessment.qualities[0]
    for effect in effects:
        for quality, found in assessment.quality_influence(effect=effect).items():
            table.add_row(effect, quality, f"instead of {first}", _told(found, signed=True))
        share = assessment.most_damped
        if share > 0:
            for quality, found in assessment.damper_influence(share, effect=effect).items():
                what = f"dampers in {100 * share:.3g} %"
                table.add_row(effect, quality, what, _told(found, signed=True))
    return table


def _size(value: float, unit: str) -> tuple[float, str]:
    """Size and prefix of a unit in which a value has few digits."""
    if abs(value) >= 1e4 and unit[:1] in ("N", "P"):
        return (1e6, "M") if unit == "Pa" else (1e3, "k")
    return (1e-3, "m") if abs(value) < 1 and unit == "m" else (1.0, "")


def _told(estimate: Estimate, size: float = 1.0, *, signed: bool = False) -> str:
    sign = "+" if signed else ""
    value, low, high = (each / size for each in estimate)
    digits = 3 if size == 1 else max(0, 3 - math.floor(math.log10(max(abs(value), 1e-9))))
    ends = "" if math.isnan(low + high) else f" [{low:{sign}.{digits}f}, {high:{sign}.{digits}f}]"
    return f"{value:{sign}.{digits}f}{ends}"


def _known(value: float, digits: int = 3) -> str:
    return "-" if math.isnan(value) else f"{value:.{digits}f}"
