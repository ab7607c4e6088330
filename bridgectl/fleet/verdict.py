"""What an assessment says first: how much the road adds, what the bridge has to bear, what helps.

`bridgectl assess` opens with it, and so does `print(assessment)`.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, NamedTuple, TypeAlias

import numpy as np
from rich.table import Table

from bridgectl._tables import make_table
from bridgectl._units import readable
from bridgectl.fleet.levels import Characteristic, Rule
from bridgectl.fleet.tails import CONFIDENCE, Estimate
from bridgectl.model.words import Amounts

# Assessment, whose module imports this one.
Assessed: TypeAlias = Any


VAGUE = 0.5
"""Width of an interval, over the value, from which on the value is hardly known."""


class Cell(NamedTuple):
    """What is read of an effect on a road quality; why it has no characteristic values."""

    effect: str
    quality: str
    unit: str
    rows: Any
    daf: Any
    tail: tuple[Characteristic, Estimate, Rule] | None
    why: str


def cells_of(assessment: Assessed, return_period: float, options: dict[str, Any]) -> list[Cell]:
    """Read an assessment: of each effect and quality that is asked for."""
    options = dict(options)
    effect, quality = options.pop("effect", None), options.pop("quality", None)
    effects = assessment.effects if effect is None else (effect,)
    qualities = assessment.qualities if quality is None else (quality,)
    found = []
    for each in effects:
        for road in qualities:
            rows = assessment._rows(road, options.get("damper_share"))
            daf = assessment.columns[f"daf {each}"][rows]
            tail, why = None, ""
            if np.any(assessment.columns[f"static {each}"]):
                tail, why = _tail(assessment, return_period, options, each, road)
            found.append(Cell(each, road, assessment.effects[each], rows, daf, tail, why))
    return found


def _tail(
    assessment: Assessed, return_period: float, options: dict[str, Any], effect: str, quality: str
) -> tuple[tuple[Characteristic, Estimate, Rule] | None, str]:
    own = options | {"effect": effect, "quality": quality}
    try:
        rule = assessment._read(return_period, **own).rule
        found = assessment.characteristic(return_period, **own)
        return (found, assessment.adr(return_period, **own), rule), ""
    except ValueError as error:
        return None, str(error)


def verdict(
    assessment: Assessed, cells: Sequence[Cell], return_period: float, options: dict[str, Any]
) -> list[str]:
    """Return what is to be said first: three sentences of one effect; of several one of each."""
    effects = dict.fromkeys(cell.effect for cell in cells)
    lines = [
        _daf_sentence(assessment, [cell for cell in cells if cell.effect == effect], options)
        for effect in effects
    ]
    if len(effects) == 1:
        lines.append(_tail_sentence(cells, return_period))
        lines.append(_influence_sentence(assessment, cells[0].effect))
    flying = int((assessment.columns["least_tire_force"] <= 0).sum())
    if flying:
        lines.append(f"A tire leaves the road in {flying} of {len(assessment)} crossings.")
    return [line for line in lines if line]


def _daf_sentence(assessment: Assessed, cells: Sequence[Cell], options: dict[str, Any]) -> str:
    """Say which DAFs half of the crossings, and 95 % of them, stay below."""
    share = options.get("damper_share")
    each = []
    for cell in cells:
        own = {"effect": cell.effect, "quality": cell.quality, "damper_share": share}
        half, most = assessment.quantiles("daf", [0.5, 0.95], **own)
        ends = "" if np.isnan(most.low + most.high) else f" [{most.low:.3f}, {most.high:.3f}]"
        each.append(f"{half.value:.3f} and {most.value:.3f}{ends}{_on(cell)}")
    return (
        f"Half of the crossings and 95 % of them have a DAF of the {cells[0].effect} below "
        f"{'; '.join(each)}."
    )


def _on(cell: Cell) -> str:
    return f" on {cell.quality}" if cell.quality else ""


def _tail_sentence(cells: Sequence[Cell], return_period: float) -> str:
    """Say what is exceeded once in the return period."""
    told, vague = [], False
    for cell in cells:
        if cell.tail is None:
            continue
        found, ratio, _ = cell.tail
        total = found.total
        vague |= total.high - total.low > VAGUE * abs(total.value)
        low, high = (readable(each, cell.unit) for each in (total.low, total.high))
        told.append(
            f"{Amounts(cell.unit).told(total.value)} [{low}, {high}]{_on(cell)}, "
            f"{ratio.value:.3f} [{ratio.low:.3f}, {ratio.high:.3f}] times the static one"
        )
    if not told:
        return ""
    few = "; so few crossings hardly tell it" if vague else ""
    return (
        f"The {cells[0].effect} of {return_period:g} years is {'; '.join(told)} "
        f"(in brackets: {100 * CONFIDENCE:g} % intervals{few})."
    )


def _influence_sentence(assessment: Assessed, effect: str) -> str:
    """Say what other roads, and dampers, change over the same trucks."""
    if np.isnan(assessment.columns[f"daf {effect}"]).all():
        return ""
    first, told = assessment.qualities[0], []
    for quality, found in assessment.quality_influence(effect=effect).items():
        told.append(f"{quality} in place of {first} changes the mean DAF by {_change(found)}")
    if (share := assessment.most_damped) > 0:
        for quality, found in assessment.damper_influence(share, effect=effect).items():
            on = f" on {quality}" if quality else ""
            told.append(f"dampers in {100 * share:.3g} % of the trucks{on} by {_change(found)}")
    line = ", ".join(told)
    return f"{line[0].upper()}{line[1:]}, over the same trucks." if told else ""


def _change(found: Estimate) -> str:
    clear = "" if found.low > 0 or found.high < 0 else ", not clearly"
    return f"{found.value:+.3f} [{found.low:+.3f}, {found.high:+.3f}{clear}]"


def short_table(
    assessment: Assessed, cells: Sequence[Cell], return_period: float,
    section_modulus: float | None = None,
) -> Table:  # fmt: skip
    """Return the table that comes with the verdict."""
    with_tail = any(cell.tail for cell in cells)
    columns = ["effect", "road", "mean\nDAF", "95 %\nDAF", "static\n95 %", "total\n95 %"]
    columns += [f"total,\n{return_period:g} years", "ADR"] if with_tail else []
    table = make_table("What the bridge has to bear", columns, ["effect", "road"], short=True)
    for cell in cells:
        modulus = section_modulus if cell.unit == "N m" else None
        amounts = Amounts(cell.unit, modulus)
        static, total = (
            assessment.columns[f"{of} {cell.effect}"][cell.rows] for of in ("static", "total")
        )
        share = 0.05 if np.median(total) < 0 else 0.95  # of the worst
        row = [amounts.told(float(np.quantile(each, share))) for each in (static, total)]
        if cell.tail is not None:
            row += [amounts.told(cell.tail[0].total.value), f"{cell.tail[1].value:.3f}"]
        elif with_tail:
            row += ["-", "-"]
        table.add_row(cell.effect, cell.quality, f"{cell.daf.mean():.3f}",
                      f"{np.quantile(cell.daf, 0.95):.3f}", *row)  # fmt: skip
    return table
