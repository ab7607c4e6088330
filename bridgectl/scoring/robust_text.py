"""What `bridgectl score --robust` prints, and `print(found)` shows: gain and harm side by side."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any, TypeAlias

from rich.table import Table

from bridgectl._tables import make_console, make_table, printed
from bridgectl._units import to_kmh
from bridgectl.scoring.agreement import CONFIDENCE, Paired
from bridgectl.scoring.errors import RIGHT, TOGETHER

# Robustness, whose module imports this one.
Found: TypeAlias = Any

AT_ONCE = 4
"""Strategies side by side in a table."""

HARM, UNCLEAR = "!", "?"
"""What marks a change that is clearly above 0, and one whose interval has 0 in it."""

NOTE = """\
Change of the mean DAF over roads and speeds from {baseline}, with the half-width of its
{confidence:g} % confidence interval over the roads. {harm} harm: clearly worse than {baseline};
{unclear} the interval has 0 in it; - sensors do not tell what the strategy needs.
"""

SUMMARY_NOTE = """\
worst: the error, of those tried, with which the mean over roads and speeds is highest; at any
speed: the highest mean over roads of all errors and speeds; harm: errors that make it clearly
worse than {baseline}, of so many.
"""


def robust_text(found: Found) -> str:
    """Return the tables of a robustness study as text of 100 columns."""
    return printed(print_robust, found)


def print_robust(found: Found) -> None:
    """Print a summary, and the change of each strategy with each error, by road class."""
    console = make_console()
    console.print(_heading(found))
    told = {"baseline": found.baseline, "confidence": 100 * CONFIDENCE}
    for road_class in found.classes:
        console.print(_summary(found, road_class))
    console.print(SUMMARY_NOTE.format(**told), soft_wrap=True)
    for road_class in found.classes:
        for first in range(0, len(found.strategies), AT_ONCE):
            console.print(_table(found, road_class, found.strategies[first : first + AT_ONCE]))
    console.print(NOTE.format(harm=HARM, unclear=UNCLEAR, **told), soft_wrap=True)


def _heading(found: Found) -> str:
    """What was simulated."""
    kmh, classes = to_kmh(found.speeds), found.road_classes
    roads = ", ".join(f"{classes.count(each)} of class {each}" for each in found.classes)
    return (
        f"{len(found.strategies)} strategies with {len(found.errors) - 1} errors; roads: {roads};\n"
        f"{kmh.size} speeds from {kmh.min():g} to {kmh.max():g} km/h, {found.approach:g} m of "
        f"approach\nMade for the bridge {found.beam!r}\nand the vehicle {found.vehicle!r}\n"
    )


def _summary(found: Found, road_class: str) -> Table:
    """Each strategy in a line: right, all wrong at once, the worst error, the number of harms."""
    columns = ["strategy", "nothing\nwrong", f"{TOGETHER}\n(mean)", "worst", "with",
               "at any\nspeed", "harm"]  # fmt: skip
    table = make_table(f"Class {road_class}: change of the mean DAF", columns, ["strategy", "with"])
    for name in found.strategies:
        rows = [row for row in found.rows() if (row.strategy, row.road_class) == (name, road_class)]
        known = [row for row in rows if not math.isnan(row.daf.mean)]
        worst = max(known, key=lambda row: row.daf.mean)
        wrong = [row for row in known if row.error.kind != RIGHT]
        kinds = {row.error.kind for row in rows}
        together = _marked(found.change(name, TOGETHER, road_class)) if TOGETHER in kinds else "-"
        table.add_row(
            name, _marked(found.change(name, road_class=road_class)), together,
            f"{worst.daf.mean:+.3f}", str(worst.error),
            f"{max(row.worst.mean for row in known):+.3f}",
            f"{sum(row.harmful for row in wrong)} of {len(wrong)}",
        )  # fmt: skip
    return table


def _table(found: Found, road_class: str, strategies: Sequence[str]) -> Table:
    """Errors down, strategies across."""
    columns = [f"class {road_class}", *strategies]
    table = make_table(f"Class {road_class}: each error", columns, columns[:1])
    for error in map(str, found.errors):
        changes = (found.change(name, error, road_class) for name in strategies)
        table.add_row(error, *map(_marked, changes))
    return table


def _marked(change: Paired) -> str:
    """Change and half-width, with the mark of harm or doubt."""
    if math.isnan(change.mean):
        return "-  "
    mark = HARM if change.clear and change.mean > 0 else " " if change.clear else UNCLEAR
    spread = "" if math.isnan(change.high) else f" ±{change.high - change.mean:.3f}"
    return f"{round(change.mean, 4) + 0.0:+.3f}{spread}{mark}"
