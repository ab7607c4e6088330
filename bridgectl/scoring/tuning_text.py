"""What `bridgectl tune` prints, and `print(tuning)` shows."""

from __future__ import annotations

from typing import Any, TypeAlias

import numpy as np
from rich.table import Table

from bridgectl._tables import make_console, make_table, printed
from bridgectl._units import to_kmh
from bridgectl.scoring.agreement import CONFIDENCE
from bridgectl.scoring.text import difference_cells
from bridgectl.scoring.verdict import counted

# Tuning, whose module imports this one.
Tuned: TypeAlias = Any

NOTE = """\
DAF: mean over roads and speeds of the peak bending moment over the static one; difference: of the
same roads, with its {confidence:g} % confidence interval; clear if that leaves out 0. Class DAE:
mean of the second-order DAE over all roads of the class, in closed form.
"""


def tuning_text(tuned: Tuned) -> str:
    """Return the tables of a tuning and what they say, as text of 100 columns."""
    return printed(print_tuning, tuned)


def print_tuning(tuned: Tuned) -> None:
    """Print the tables of a tuning and what they say."""
    console = make_console()
    console.print(_heading(tuned))
    console.print(_gain_table(tuned))
    console.print(_daf_table(tuned))
    console.print(NOTE.format(confidence=100 * CONFIDENCE), soft_wrap=True)
    for line in _sentences(tuned):
        console.print(line)


def _heading(tuned: Tuned) -> str:
    kmh = ", ".join(f"{speed:g}" for speed in to_kmh(tuned.speeds).round(6))
    what = "class DAE" if tuned.class_dae and tuned.objective != "daf" else "simulated DAF"
    over = "its mean over the speeds" if np.isinf(tuned.softness) else (
        f"its soft maximum over the speeds, of softness {tuned.softness:g}"
    )  # fmt: skip
    return (
        f"{tuned.strategy.name}, tuned for the {what}, {over}\n"
        f"{tuned.training.shape[2]} training roads, {tuned.held_out.shape[2]} held out, "
        f"at {kmh} km/h, {tuned.approach:g} m of approach\n"
        f"Bridge: {tuned.beam!r}\nVehicle: {tuned.vehicle!r}\n"
    )


def _gain_table(tuned: Tuned) -> Table:
    places = [] if tuned.positions is None else ["at x\n[m]"]
    columns = ["gain", *places, "before", "after", "least", "largest"]
    table = make_table("Gains", columns, ["gain"])
    for name, *values in zip(tuned.names, tuned.before, tuned.after, *tuned.bounds.T, strict=True):
        at = [f"{tuned.positions[[*tuned.strategy.gains].index(name)]:g}"] if places else []
        table.add_row(name, *at, *(f"{value:.5g}" for value in values))
    return table


def _daf_table(tuned: Tuned) -> Table:
    columns = ["", "before", "after", "difference", "from\n(95 %)", "to\n(95 %)", "clear"]
    table = make_table("Dynamic amplification (DAF)", columns, ["", "clear"])
    for what, dafs, roads in (
        ("training roads", tuned.training, "training"),
        ("roads held out", tuned.held_out, "held_out"),
    ):
        if dafs.size:
            cells = [f"{each.mean():.4f}" for each in dafs]
            table.add_row(what, *cells, *difference_cells(tuned.change(roads)))
    for name, dae in tuned.class_dae.items():
        before, after = dae.mean(axis=1)
        cells = [f"{before:.4f}", f"{after:.4f}", f"{after - before + 0.0:+.4f}"]
        table.add_row(f"class {name} DAE", *cells, "-", "-", "")
    return table


def _sentences(tuned: Tuned) -> list[str]:
    one, several = ("generation", "generations") if tuned.method == "generations" else (
        "gradient after the first", "gradients after the first"
    )  # fmt: skip
    lines = [f"{counted(tuned.history.size - 1, one, several)}, {tuned.seconds:.1f} s."]
    if tuned.interrupted:
        lines.append("Interrupted: these are the best gains so far.")
    if not tuned.held_out.size:
        lines.append(
            "No roads were held out: what the gains are worth elsewhere is not known. Gains that "
            "fit the training roads alone look as good."
        )
    elif tuned.overfitted:
        training, others = -tuned.change("training").mean, -tuned.change().mean
        lines.append(
            f"Warning: the gains fit the training roads: these gain {training:.4f}, roads held out "
            f"{others:.4f}, less than half of that. More training roads help, or fewer gains."
        )
    return lines
