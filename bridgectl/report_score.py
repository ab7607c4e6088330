"""What `bridgectl score` prints, and `print(board)` shows."""

from __future__ import annotations

import contextlib
import io
import math
from collections.abc import Sequence
from typing import NamedTuple

from rich.table import Table

from bridgectl.report import make_console, make_table
from bridgectl.scoreboard import CONFIDENCE, Paired, Row, Scoreboard, rank_correlation

NAMED_ROADS = 4
"""Roads that the heading names."""

BRIDGE_NOTE = """\
DAF: peak bending moment over the static one; its mean, and that of the worst speed. difference: to
{first}, over the same roads, with its {confidence:g} % confidence interval; clear
if that leaves out 0.
"""

ROAD_NOTE = """\
Means over roads and speeds, but for least R and travel, the worst of all. DLC: dynamic load
coefficient; R: tire force over the static load; R^4: what 95 % of the places stay below; ride: rms
body acceleration, plain and weighted by ISO 2631-1 W_k.
"""

DAE_NOTE = """\
DAE: from the strategy's own 1 mm ramps. rms error: of DAE - DAF over roads and speeds; rank:
Spearman's correlation of the two. sign: of a clear difference in DAF, whether DAE has it too.
"""


class Verdict(NamedTuple):
    """Whether DAE ranks a strategy as DAF does, against the first."""

    strategy: str
    daf_difference: Paired
    dae_difference: float

    @property
    def right(self) -> bool:
        """Whether both have one sign."""
        return self.daf_difference.mean * self.dae_difference > 0


def score_text(board: Scoreboard) -> str:
    """Return the tables of a scoreboard and what they say, as text of 100 columns."""
    text = io.StringIO()
    with contextlib.redirect_stdout(text):
        print_score(board)
    return text.getvalue()


def print_score(board: Scoreboard) -> None:
    """Print the tables of a scoreboard and what they say."""
    console, rows, first = make_console(), board.rows(), board.strategies[0]
    console.print(_heading(board))
    console.print(_bridge_table(rows, first))
    note = BRIDGE_NOTE.format(first=first, confidence=100 * CONFIDENCE)
    console.print(note, soft_wrap=True)
    console.print(_road_table(rows, first))
    console.print(ROAD_NOTE, soft_wrap=True)
    console.print(_dae_table(board, rows))
    console.print(DAE_NOTE, soft_wrap=True)
    for line in [*_daf_sentences(board, rows), *dae_sentences(board)]:
        console.print(line)


def dae_verdicts(board: Scoreboard) -> list[Verdict]:
    """Return what DAE says of each strategy whose mean DAF differs clearly from the first's."""
    found = []
    for strategy in board.strategies[1:]:
        difference = board.difference(strategy)
        if difference.clear:
            dae = board.difference(strategy, "dae").mean
            found.append(Verdict(strategy, difference, dae))
    return found


def dae_sentences(board: Scoreboard) -> list[str]:
    """Say for which strategies DAE ranks as the simulated DAF does, and for which not."""
    first, others = board.strategies[0], len(board.strategies) - 1
    if not others:
        return []
    verdicts = dae_verdicts(board)
    if not verdicts:
        return [f"DAE has nothing to rank: no strategy's mean DAF differs clearly from {first}'s."]
    right = [each.strategy for each in verdicts if each.right]
    wrong = [
        f"{each.strategy} (DAF {each.daf_difference.mean:+.3f}, DAE {each.dae_difference:+.3f})"
        for each in verdicts
        if not each.right
    ]
    lines = [
        f"DAE puts {len(right)} of the {len(verdicts)} strategies with a clear difference in DAF "
        f"on the right side of {first}" + (f": {', '.join(right)}." if right else ".")
    ]
    if wrong:
        lines.append(f"It puts on the wrong side: {', '.join(wrong)}.")
    worst = max(board.rows(), key=lambda row: row.dae_error)
    lines.append(
        f"It is furthest from the DAF for {worst.strategy}: rms error {worst.dae_error:.3f}, "
        f"mean {worst.dae:.3f} for {worst.daf:.3f}."
    )
    if others > 1:
        means = [board.values[name].mean(axis=(1, 2)) for name in ("dae", "daf")]
        lines.append(
            f"Rank correlation of mean DAE and mean DAF over the {others + 1} strategies: "
            f"{rank_correlation(*means):.2f}."
        )
    # Eq. (15) is linear in the ramps, which a mirrored road has with the other sign.
    lines.append(
        "Over a road and its mirror image the mean DAE is the DAF of the smooth road, whatever the "
        "damper: mean DAEs tell the roads apart, not the dampers."
    )
    return lines


def _daf_sentences(board: Scoreboard, rows: Sequence[Row]) -> list[str]:
    best, first = rows[0], board.strategies[0]
    if len(rows) == 1:
        return []
    if len(board.roads) == 1:
        return ["A single road gives no confidence intervals: --random N adds roads."]
    if best.strategy == first:
        return [f"No strategy has a lower mean DAF than {first}."]
    low, high = sorted(abs(end) for end in best.daf_difference[1:])
    sure = (
        f"{100 * CONFIDENCE:g} % confidence: {low:.3f} to {high:.3f}"
        if best.daf_difference.clear
        else "not clearly: other roads may turn it round"
    )
    lines = [
        f"Lowest mean DAF: {best.strategy}, {best.daf:.3f}, {-best.daf_difference.mean:.3f} below "
        f"{first} ({sure})."
    ]
    flying = [row.strategy for row in rows if row.least_force <= 0]
    if flying:
        lines.append(f"A tire leaves the road with {', '.join(flying)}.")
    return lines


def _heading(board: Scoreboard) -> str:
    """What was simulated."""
    kmh = board.speeds * 3.6
    names = list(board.roads)
    if len(names) > NAMED_ROADS:
        names = [*names[: NAMED_ROADS - 1], "...", names[-1]]
    speeds = f"{kmh.min():g} km/h" if kmh.size == 1 else (
        f"{kmh.size} speeds from {kmh.min():g} to {kmh.max():g} km/h"
    )  # fmt: skip
    return (
        f"{_count(len(board.strategies), 'strategy', 'strategies')} on "
        f"{_count(len(board.roads), 'road', 'roads')} ({'; '.join(names)}),\n"
        f"{speeds}, {board.approach:g} m of approach\n"
        f"Bridge: {board.beam!r}\nVehicle: {board.vehicle!r}\n"
    )


def _count(number: int, one: str, many: str) -> str:
    return f"{number} {one if number == 1 else many}"


def _bridge_table(rows: Sequence[Row], first: str) -> Table:
    columns = ["strategy", "mean DAF", "difference", "from\n(95 %)", "to\n(95 %)",
               "clear", "worst\nDAF", "at\nkm/h"]  # fmt: skip
    table = make_table("The bridge: dynamic amplification", columns, ["strategy", "clear"])
    for row in rows:
        cells = ["-", "-", "-", ""] if row.strategy == first else _difference(row.daf_difference)
        worst = f"{row.worst_daf:.3f}", f"{row.worst_speed * 3.6:g}"
        style = "bold" if row.strategy == first else None
        table.add_row(row.strategy, f"{row.daf:.4f}", *cells, *worst, style=style)
    return table


def _difference(difference: Paired) -> list[str]:
    word = ("lower" if difference.mean < 0 else "higher") if difference.clear else ""
    return [*map(_signed, difference), word]


def _signed(value: float) -> str:
    # No negative zero.
    return "-" if math.isnan(value) else f"{round(value, 4) + 0.0:+.4f}"


def _road_table(rows: Sequence[Row], first: str) -> Table:
    columns = ["strategy", "DLC", "R^4\n95 %", "least\nR", "ride\n[m/s2]", "ride W_k\n[m/s2]",
               "travel\n[mm]", "switches\n[1/s]"]  # fmt: skip
    table = make_table("Road, ride and suspension", columns, ["strategy"])
    for row in rows:
        table.add_row(
            row.strategy, f"{row.dynamic_load_coefficient:.4f}", f"{row.fourth_power_95:.3f}",
            f"{row.least_force:.2f}", f"{row.body_acceleration:.3f}",
            f"{row.weighted_acceleration:.3f}", f"{1e3 * row.suspension_travel:.1f}",
            f"{row.switching_rate:.1f}", style="bold" if row.strategy == first else None,
        )  # fmt: skip
    return table


def _dae_table(board: Scoreboard, rows: Sequence[Row]) -> Table:
    columns = ["strategy", "mean DAF", "mean DAE", "rms\nerror", "rank",
               "DAF\ndifference", "DAE\ndifference", "sign"]  # fmt: skip
    table = make_table("The dynamic amplification estimate (DAE)", columns, ["strategy", "sign"])
    first = board.strategies[0]
    signs = {each.strategy: "right" if each.right else "wrong" for each in dae_verdicts(board)}
    for row in rows:
        differences = [row.daf_difference.mean, board.difference(row.strategy, "dae").mean]
        own = row.strategy == first
        table.add_row(
            row.strategy, f"{row.daf:.4f}", f"{row.dae:.4f}", f"{row.dae_error:.4f}",
            "-" if math.isnan(row.dae_rank) else f"{row.dae_rank:.2f}",
            *(["-", "-"] if own else map(_signed, differences)), signs.get(row.strategy, ""),
            style="bold" if own else None,
        )  # fmt: skip
    return table
