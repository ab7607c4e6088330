"""What a scoreboard says first: which strategy is best for the bridge, how surely, at what price.

`bridgectl score` opens with it, and so does `print(board)`.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any, TypeAlias

from rich.table import Table

from bridgectl._tables import make_table
from bridgectl._units import to_kmh
from bridgectl.model.words import Amounts, effect_in_words
from bridgectl.scoring.agreement import CONFIDENCE
from bridgectl.scoring.rows import Row

# Scoreboard, whose module imports those of this one.
Board: TypeAlias = Any

FEW, BEST, NAMED = 8, 3, 3
"""Strategies that the short table has all of; of more it has so many of the best, the first and the
last; and how many a sentence names."""


def amounts_of(board: Board, section_modulus: float | None = None) -> Amounts:
    """Return how the effect of a board is told."""
    return Amounts(board.effect.unit, section_modulus)


def verdict(board: Board, amounts: Amounts) -> list[str]:
    """Return what is to be said first: three sentences, and a warning if there is one."""
    rows = board.rows()
    best, own = rows[0], next(row for row in rows if row.strategy == board.strategies[0])
    lines = [_first_sentence(board, best, own, amounts)]
    if len(rows) > 1:
        lines += [_price(best, own), _others(board, rows, own)]
    flying = [row.strategy for row in rows if row.least_force <= 0]
    if flying:
        lines.append(f"A tire leaves the road with {', '.join(flying)}.")
    return [line for line in lines if line]


def _first_sentence(board: Board, best: Row, own: Row, amounts: Amounts) -> str:
    """Say which strategy has the lowest mean DAF, how surely, and how much the effect then is."""
    static = board.static_peak
    of_best, of_own, at_rest = (
        amounts.told(daf * static, units=i == 0) for i, daf in enumerate((best.daf, own.daf, 1.0))
    )
    sizes = f"the {effect_in_words(board.effect)} is {of_best} on average"
    if len(board.strategies) == 1:
        return (
            f"{own.strategy} has a mean DAF of {own.daf:.3f}, and of {own.worst_daf:.3f} at the "
            f"worst speed, {to_kmh(own.worst_speed):g} km/h; {sizes}, static {at_rest}."
        )
    if best is own:
        return (
            f"No strategy has a lower mean DAF than {own.strategy}, {own.daf:.3f}; {sizes}, static "
            f"{at_rest}."
        )
    sizes += f" in place of {of_own}, static {at_rest}"
    low, high = sorted(-end for end in best.daf_difference[1:])
    less = -best.daf_difference.mean
    sure = "" if math.isnan(low) else (
        f" ({100 * CONFIDENCE:g} % confidence: {_plain(low)} to {_plain(high)})"
    )  # fmt: skip
    if best.daf_difference.clear or not sure:
        return (
            f"Lowest mean DAF: {best.strategy}, {best.daf:.3f}, {less:.3f} below {own.strategy}"
            f"{sure}; {sizes}."
        )
    return (
        f"No strategy is clearly better than {own.strategy}: {best.strategy} has the lowest mean "
        f"DAF, {best.daf:.3f}, {less:.3f} below it{sure}, but other roads may turn it round; "
        f"{sizes}."
    )


def _price(best: Row, own: Row) -> str:
    """Say what the best strategy does to ride and suspension."""
    if best is own:
        return ""
    return (
        f"With {best.strategy} the body accelerates by {best.body_acceleration:.2g} m/s^2 rms in "
        f"place of {own.body_acceleration:.2g}, and the suspension travels up to "
        f"{1e3 * best.suspension_travel:.0f} mm in place of {1e3 * own.suspension_travel:.0f}."
    )


def _others(board: Board, rows: Sequence[Row], own: Row) -> str:
    """Say how the others compare with the first, all at the same confidence."""
    if len(board.roads) == 1:
        return "A single road gives no confidence intervals: --random N adds roads."
    others = [row for row in rows[1:] if row is not own]
    if not others:
        return ""
    clear = [row for row in others if row.daf_difference.clear]
    groups = {
        "clearly better than": [row for row in clear if row.daf_difference.mean < 0],
        "clearly worse than": [row for row in clear if row.daf_difference.mean > 0],
        "not distinguishable from": [row for row in others if not row.daf_difference.clear],
    }
    told: list[str] = []
    for what, found in groups.items():
        if found:
            names = ", ".join(row.strategy for row in found) if len(found) <= NAMED else len(found)
            whom = "it" if told else own.strategy
            told.append(f"{names} {'is' if len(found) == 1 else 'are'} {what} {whom}")
    return f"Of the others, {', '.join(told)} on these roads."


def picked(board: Board, rows: Sequence[Row]) -> list[Row]:
    """Return the strategies of the short table, in order."""
    if len(rows) <= FEW:
        return list(rows)
    kept = {row.strategy for row in rows[:BEST]} | {board.strategies[0], rows[-1].strategy}
    return [row for row in rows if row.strategy in kept]


def short_table(board: Board, rows: Sequence[Row], amounts: Amounts) -> Table:
    """Return the table that comes with the verdict."""
    columns = ["strategy", "mean\nDAF", *(f"mean\n[{unit}]" for unit in amounts.units), "change",
               f"{100 * CONFIDENCE:g} % interval", "ride\n[m/s2]", "travel\n[mm]"]  # fmt: skip
    title = f"Dynamic amplification (DAF) of the {effect_in_words(board.effect)}"
    table = make_table(title, columns, ["strategy"], short=True)
    for row in rows:
        first = row.strategy == board.strategies[0]
        mean, low, high = row.daf_difference
        change = "-" if first else _signed(mean)
        ends = "-" if first or math.isnan(low) else f"{_signed(low)} {_signed(high)}"
        table.add_row(
            row.strategy, f"{row.daf:.3f}", *amounts.cells(row.daf * board.static_peak), change,
            ends, f"{row.body_acceleration:.3f}", f"{1e3 * row.suspension_travel:.0f}",
            style="bold" if first else None,
        )  # fmt: skip
    return table


def counted(number: int, one: str, many: str) -> str:
    """Return how many there are of something: '1 road', '2 roads'."""
    return f"{number} {one if number == 1 else many}"


def _signed(value: float) -> str:
    return f"{round(value, 3) + 0.0:+.3f}"  # no negative zero


def _plain(value: float) -> str:
    return f"{round(value, 3) + 0.0:.3f}"
