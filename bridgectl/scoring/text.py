"""What `bridgectl score` prints, and `print(board)` shows."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any, TypeAlias

import numpy as np
from rich.table import Table

from bridgectl._tables import make_console, make_table, printed
from bridgectl._units import to_kmh
from bridgectl.model.words import Amounts, crossing_in_words, effect_in_words
from bridgectl.scoring.agreement import CONFIDENCE, Paired
from bridgectl.scoring.rows import CLASS_DAE, ClassRow, Ranking, Row
from bridgectl.scoring.verdict import amounts_of, counted, picked, short_table, verdict

# Scoreboard, whose module imports this one.
Board: TypeAlias = Any

NAMED_ROADS = 4
"""Roads that the heading names."""

BRIDGE_NOTE = """\
DAF: {effect}, over the static one; its mean, and that of the worst speed.
difference: to {first}, over the same roads, with its {confidence:g} % confidence interval;
clear if that leaves out 0.
"""

ROAD_NOTE = """\
Means over roads and speeds, but for least R and travel, the worst of all. DLC: dynamic load
coefficient; R: tire force over the static load; R^4: what 95 % of the places stay below; ride: rms
body acceleration, plain and weighted by ISO 2631-1 W_k.
"""

OPTIMUM_NOTE = """\
gap closed: how far the mean DAF goes from {first} to the clairvoyant,
with its {confidence:g} % interval of roads drawn again; - where the two are within 0.002. The
clairvoyant knows all of the road: no controller, but the best damping that was found for each road
and speed.
"""

BOUND_NOTE = """\
Proven for {known} of {number} crossings: no damping that is held 10 ms has a mean DAF below
{low:.4f}; the best found has {high:.4f} (held 5 ms: it may be a few thousandths below the bound).
"""

NO_BOUND_NOTE = """\
No bound is proven: it says something only where control begins at the bridge, by an approach of 0.
"""

DAE_NOTE = """\
DAE: from the strategy's own unit ramps; Eq. (15): of 1 mm, down; second order: down and up, of the
height of the road's class. rms error: of DAE - DAF over roads and speeds; rank: Spearman's
correlation of the two.
"""

CLASS_NOTE = """\
Class DAE: mean and standard deviation of the second-order DAE over all roads of the class, in
closed form; DAF: the same of the simulated roads with ramps as of that class.
"""

RANKING_NOTE = """\
tau: Kendall's, with the simulated mean DAF unless said otherwise, and its {confidence:g} % interval
of roads drawn again. clear pairs: of the pairs of strategies whose mean DAFs differ clearly over
the same roads, those that the estimate has in the right order.
"""


def score_text(board: Board) -> str:
    """Return the verdict and the tables of a scoreboard, as text of 100 columns."""
    return printed(_print_all, board)


def _print_all(board: Board) -> None:
    print_verdict(board)
    print_full(board)


def print_verdict(board: Board, section_modulus: float | None = None) -> None:
    """Print what is to be said first; of moments the stress, too, if there is a modulus [m^3]."""
    console = make_console()
    for line in verdict(board, amounts_of(board, section_modulus)):
        console.print(line)
    console.print()


def print_short(
    board: Board, section_modulus: float | None = None, notes: Sequence[str] = ()
) -> None:
    """Print the table that comes with the verdict, and what was simulated, with notes."""
    console, rows = make_console(), board.rows()
    few = picked(board, rows)
    console.print(short_table(board, few, amounts_of(board, section_modulus)), "")
    if board.optimum:
        console.print(_optimum_table(board, few))
    more = len(rows) - len(few)
    left_out = f"; the table leaves out {more} strategies" if more else ""
    console.print(_studied(board) + left_out)
    console.print(crossing_in_words(board.beam, board.vehicle), *notes, sep="\n")


def print_full(
    board: Board, section_modulus: float | None = None, notes: Sequence[str] = ()
) -> None:
    """Print what was simulated, with notes, and every table."""
    make_console().print(_heading(board), *notes, "", sep="\n")
    _print_tables(board, board.rows(), amounts_of(board, section_modulus))


def _print_tables(board: Board, rows: Sequence[Row], amounts: Amounts) -> None:
    """Print every table, and what it says."""
    console, first = make_console(), board.strategies[0]
    console.print(_bridge_table(board, rows, amounts))
    note = BRIDGE_NOTE.format(
        effect=effect_in_words(board.effect), first=first, confidence=100 * CONFIDENCE
    )
    console.print(note, soft_wrap=True)
    if board.optimum:
        console.print(_optimum_table(board, rows))
        note = OPTIMUM_NOTE.format(first=first, confidence=100 * CONFIDENCE)
        console.print(note + _bound_note(board), soft_wrap=True)
    console.print(_road_table(rows, first))
    console.print(ROAD_NOTE, soft_wrap=True)
    rankings = board.rankings()
    if not rankings:
        return
    console.print(_dae_table(rows, first))
    console.print(DAE_NOTE, soft_wrap=True)
    if board.surfaces:
        names = list(board.surfaces)
        for i in range(0, len(names), 2):
            console.print(_class_table(board, names[i : i + 2]))
        console.print(CLASS_NOTE, soft_wrap=True)
    if len(rows) > 1:
        console.print(_ranking_table(rankings))
        console.print(RANKING_NOTE.format(confidence=100 * CONFIDENCE), soft_wrap=True)
    for line in dae_sentences(board, rankings):
        console.print(line)


def dae_sentences(board: Board, rankings: Sequence[Ranking]) -> list[str]:
    """Say what DAE can rank, and what it cannot."""
    rows = board.rows()
    if len(rows) == 1:
        return []
    of_all, *others = rankings
    # Eq. (15) is linear in the ramps, which a mirrored road has with the other sign.
    lines = [
        "The mean of Eq. (15) tells roads apart, not dampers: over a road and its mirror image it "
        f"is the DAF of the smooth road, whatever the damper (on these roads, by "
        f"their chance, tau {_tau(of_all)})."
    ]
    of_class = [each for each in others if each.estimate == CLASS_DAE]
    if not of_class:
        return [*lines, f"There is no DAE of second order: {_why_no_class(board)}."]
    told = "; ".join(
        f"on {each.roads} with tau {_tau(each)}"
        + (f", {each.pairs.right} of {each.pairs.number} clear pairs" if each.pairs else "")
        for each in of_class
    )
    lines.append(f"The class DAE, of ramps down and up, orders the strategies {told}.")
    firsts = {name: min(board.class_rows(name), key=lambda row: row.dae) for name in board.surfaces}
    lines += [_first_sentence(rows[0].strategy, firsts), _level_sentence(rows)]
    lines.append(
        "It screens strategies and shows where along the bridge they gain; the judge is the "
        "simulated DAF."
    )
    return lines


def _tau(ranking: Ranking) -> str:
    tau, low, high = ranking.agreement
    if math.isnan(tau):
        return "-"
    return f"{tau:.2f}" + ("" if math.isnan(low) else f" [{low:.2f}, {high:.2f}]")


def _why_no_class(board: Board) -> str:
    classes = " and ".join(sorted(set(board.road_classes)))
    return f"the roads are of class {classes}, whose unit ramp would be higher than long"


def _first_sentence(best: str, firsts: dict[str, ClassRow]) -> str:
    """Say which strategy comes first by class, and whether simulation has it so."""
    other = [f"{row.strategy} on class {name}" for name, row in firsts.items()
             if row.strategy != best]  # fmt: skip
    if not other:
        return f"Both the class DAE and the simulated DAF put {best} first."
    return f"Simulation puts {best} first, the class DAE {', '.join(other)}."


def _level_sentence(rows: Sequence[Row]) -> str:
    """Say how far off DAEs are of single roads."""
    known = [row for row in rows if not math.isnan(row.dae_2)]
    if not known:
        return "Some roads are of a class without a surface: they have no DAE of second order."
    first, second = (
        math.sqrt(sum(getattr(row, name) ** 2 for row in known) / len(known))
        for name in ("dae_error", "dae_2_error")
    )
    worst = max(known, key=lambda row: abs(row.dae_2 - row.daf))
    return (
        f"On single roads its rms error is {second:.3f} ({first:.3f} of Eq. (15)); its level is "
        f"furthest off for {worst.strategy}, mean {worst.dae_2:.3f} for a DAF of {worst.daf:.3f}."
    )


def _studied(board: Board) -> str:
    """What was simulated."""
    kmh = to_kmh(board.speeds)
    names = list(board.roads)
    if len(names) > NAMED_ROADS:
        names = [*names[: NAMED_ROADS - 1], "...", names[-1]]
    speeds = f"{kmh.min():g} km/h" if kmh.size == 1 else (
        f"{kmh.size} speeds from {kmh.min():g} to {kmh.max():g} km/h"
    )  # fmt: skip
    return (
        f"{counted(len(board.strategies), 'strategy', 'strategies')} on "
        f"{counted(len(board.roads), 'road', 'roads')} ({'; '.join(names)}),\n"
        f"{speeds}, {board.approach:g} m of approach"
    )


def _heading(board: Board) -> str:
    """What was simulated, to the last parameter."""
    return f"{_studied(board)}\nBridge: {board.beam!r}\nVehicle: {board.vehicle!r}"


def _bridge_table(board: Board, rows: Sequence[Row], amounts: Amounts) -> Table:
    columns = ["strategy", "mean DAF", "difference", "from\n(95 %)", "to\n(95 %)", "clear",
               *(f"mean\n[{unit}]" for unit in amounts.units), "worst\nDAF",
               "at\nkm/h"]  # fmt: skip
    table = make_table("The bridge: dynamic amplification", columns, ["strategy", "clear"])
    first = board.strategies[0]
    for row in rows:
        cells = (
            ["-", "-", "-", ""] if row.strategy == first else difference_cells(row.daf_difference)
        )
        mean = amounts.cells(row.daf * board.static_peak)
        worst = f"{row.worst_daf:.3f}", f"{to_kmh(row.worst_speed):g}"
        style = "bold" if row.strategy == first else None
        table.add_row(row.strategy, f"{row.daf:.4f}", *cells, *mean, *worst, style=style)
    return table


def difference_cells(difference: Paired) -> list[str]:
    """Return a difference, the ends of its interval, and what is clear of it, as text."""
    word = ("lower" if difference.mean < 0 else "higher") if difference.clear else ""
    return [*map(_signed, difference), word]


def _signed(value: float) -> str:
    # No negative zero.
    return "-" if math.isnan(value) else f"{round(value, 4) + 0.0:+.4f}"


def _optimum_table(board: Board, rows: Sequence[Row]) -> Table:
    columns = ["strategy", "mean DAF", "gap\nclosed", "from\n(95 %)", "to\n(95 %)", "least",
               "at\nkm/h"]  # fmt: skip
    table = make_table("How near the clairvoyant optimum", columns, ["strategy"])
    best = float(board.optimum["daf"].mean())
    table.add_row("clairvoyant", f"{best:.4f}", *["-"] * 5)
    for row in rows:
        first = row.strategy == board.strategies[0]
        shares = [(board.gap_closed(row.strategy, c).share, c) for c in board.speeds]
        known = [each for each in shares if not math.isnan(each[0])]
        least, speed = min(known, default=(math.nan, math.nan))
        cells = [_known(value, 2) for value in (*row.gap_closed, least)]
        cells = ["-"] * 5 if first else [*cells, f"{to_kmh(speed):g}" if known else "-"]
        table.add_row(row.strategy, f"{row.daf:.4f}", *cells, style="bold" if first else None)
    return table


def _bound_note(board: Board) -> str:
    """What is proven of the optimum, or why nothing is."""
    daf = board.optimum["daf"]
    bound = board.optimum.get("daf_bound", np.full(daf.shape, np.nan))
    known = ~np.isnan(bound)
    if not known.any():
        return NO_BOUND_NOTE
    low, high = bound[known].mean(), daf[known].mean()
    return BOUND_NOTE.format(known=known.sum(), number=known.size, low=low, high=high)


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


def _dae_table(rows: Sequence[Row], first: str) -> Table:
    columns = ["strategy", "mean DAF", "Eq. (15)\nmean", "rms\nerror", "rank",
               "second\norder", "rms\nerror"]  # fmt: skip
    table = make_table("The dynamic amplification estimate (DAE)", columns, ["strategy"])
    for row in rows:
        table.add_row(
            row.strategy, f"{row.daf:.4f}", f"{row.dae:.4f}", f"{row.dae_error:.4f}",
            _known(row.dae_rank, 2), _known(row.dae_2, 4), _known(row.dae_2_error, 4),
            style="bold" if row.strategy == first else None,
        )  # fmt: skip
    return table


def _known(value: float, digits: int) -> str:
    return "-" if math.isnan(value) else f"{value:.{digits}f}"


def _class_table(board: Board, names: Sequence[str]) -> Table:
    columns = ["strategy"]
    for name in names:
        columns += [f"class {name}\nDAE", "spread", "DAF", "spread"]
    table = make_table("The DAE over the road class", columns, ["strategy"])
    for rows in zip(*(board.class_rows(name) for name in names), strict=True):
        cells = [_known(value, 4) for row in rows for value in row[1:]]
        own = rows[0].strategy == board.strategies[0]
        table.add_row(rows[0].strategy, *cells, style="bold" if own else None)
    return table


def _ranking_table(rankings: Sequence[Ranking]) -> Table:
    columns = ["roads", "estimate", "tau", "from\n(95 %)", "to\n(95 %)", "clear\npairs"]
    table = make_table("How DAE orders the strategies", columns, ["roads", "estimate"])
    for each in rankings:
        pairs = "-" if each.pairs is None else f"{each.pairs.right} of {each.pairs.number}"
        table.add_row(
            each.roads, each.estimate, *(_known(value, 2) for value in each.agreement), pairs
        )
    return table
