"""What `bridgectl assess` prints, and `print(assessment)` shows."""

from __future__ import annotations

import math
from typing import Any, TypeAlias

import numpy as np
from rich.table import Table

from bridgectl._tables import make_console, make_table, printed
from bridgectl._units import to_kmh
from bridgectl.fleet.levels import Rule
from bridgectl.fleet.tails import CONFIDENCE, METHODS, Estimate

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
    """Return the tables of an assessment as text of 100 columns."""
    return printed(print_assessment, assessment, return_period, options)


def print_assessment(assessment: Assessed, return_period: float, options: dict[str, Any]) -> None:
    """Print the tables of an assessment and what they say."""
    console = make_console()
    console.print(_heading(assessment))
    damped = bool(assessment.columns["damped"].any())
    asked = options.get("quality"), options.get("effect")
    qualities = assessment.qualities if asked[0] is None else (asked[0],)
    effects = assessment.effects if asked[1] is None else (asked[1],)
    share = options.get("damper_share")
    console.print(_daf_table(assessment, qualities, effects, share))
    console.print(DAF_NOTE, soft_wrap=True)
    with_factor = [effect for effect in effects if np.any(assessment.columns[f"static {effect}"])]
    _print_tails(assessment, qualities, with_factor, return_period, options)
    if len(assessment.qualities) > 1 or damped:
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


def _daf_table(
    assessment: Assessed, qualities: Any, effects: Any, damper_share: float | None
) -> Table:
    columns = ["effect", "road", "crossings", "mean\nDAF", "5 %", "50 %", "95 %", "99 %",
               "largest", "least\nR"]  # fmt: skip
    table = make_table("Dynamic amplification", columns, ["effect", "road"])
    for effect in effects:
        for quality in qualities:
            rows = assessment._rows(quality, damper_share)
            daf = assessment.columns[f"daf {effect}"][rows]
            quantiles = np.quantile(daf, [0.05, 0.5, 0.95, 0.99])
            numbers = [daf.mean(), *quantiles, daf.max()]
            least = assessment.columns["least_tire_force"][rows].min()
            table.add_row(effect, quality, str(len(rows)), *(_known(each) for each in numbers),
                          _known(least, 2))  # fmt: skip
    return table


def _print_tails(
    assessment: Assessed, qualities: Any, effects: Any, return_period: float,
    options: dict[str, Any],
) -> None:  # fmt: skip
    """Print characteristic effects; where there can be none, why."""
    console = make_console()
    columns = ["effect", "road", "unit", "total", "static", "ADR", "p"]
    table = make_table(f"Effects of {return_period:g} years", columns, ["effect", "road", "unit"])
    why: dict[str, None] = {}
    rule: Rule | None = None
    for effect in effects:
        for quality in qualities:
            own = options | {"effect": effect, "quality": quality}
            try:
                read = assessment._read(return_period, **own)
                found = assessment.characteristic(return_period, **own)
                ratio = assessment.adr(return_period, **own)
            except ValueError as error:
                why[str(error)] = None
                continue
            rule = read.rule
            size, prefix = _size(found.total.value, read.unit)
            p = " ".join(
                "-" if fit is None or fit.scale == 0 else f"{fit.p_value():.2f}"
                for fit in (found.total_fit, found.static_fit)
            )
            table.add_row(effect, quality, prefix + read.unit, _told(found.total, size),
                          _told(found.static, size), _told(ratio), p)  # fmt: skip
    if rule is not None:
        console.print(table)
        console.print(_tail_note(rule), soft_wrap=True)
    for line in why:
        console.print(f"No effects of {return_period:g} years: {line}\n", soft_wrap=True)


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
