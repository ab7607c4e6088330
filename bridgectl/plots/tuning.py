"""The figure of a tuning: the search, DAF by speed before and after, and a program over place."""

from __future__ import annotations

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator

from bridgectl._units import to_kmh
from bridgectl.plots.shown import TuningShown
from bridgectl.plots.style import (
    BLUE,
    BRIDGE_TINT,
    GREY,
    SPEED_LABEL,
    STATION_LABEL,
    VERMILLION,
    styled,
)


@styled
def tuning_figure(tuned: TuningShown) -> Figure:
    """Draw what tuning did: the objective, step by step, and the mean DAF over the speed.

    Of training roads and of those held out, before (dashed) and after; of a program the damping
    over the place, too.
    """
    count = 2 if tuned.positions is None else 3
    figure = Figure(figsize=(4.8 * count + 1.3, 3.8), layout="constrained")
    axes = figure.subplots(1, count)
    _draw_history(axes[0], tuned)
    _draw_speeds(axes[1], tuned)
    if count == 3:
        _draw_program(axes[2], tuned)
    return figure


def _draw_history(ax: Axes, tuned: TuningShown) -> None:
    ax.plot(np.arange(tuned.history.size), tuned.history, ".-", color=BLUE)
    ax.xaxis.set_major_locator(MaxNLocator(integer=True))
    what = "DAF, training roads" if tuned.objective == "daf" else "class DAE"
    over = "mean" if np.isinf(tuned.softness) else "soft maximum"
    steps = "generation" if tuned.method == "generations" else "gradient"
    ax.set(xlabel=f"{steps} [-]", ylabel=f"{over} {what} [-]", title=tuned.strategy.name)


def _draw_speeds(ax: Axes, tuned: TuningShown) -> None:
    order = np.argsort(tuned.speeds)
    kmh = to_kmh(tuned.speeds[order])
    for dafs, color, what in (
        (tuned.training, BLUE, "training"), (tuned.held_out, VERMILLION, "held out"),
    ):  # fmt: skip
        if dafs.size:
            before, after = dafs.mean(axis=2)[:, order]
            ax.plot(kmh, before, "o--", mfc="white", color=color, label=f"{what}, before")
            ax.plot(kmh, after, "o-", color=color, label=f"{what}, after")
    ax.set(xlabel=SPEED_LABEL, ylabel="mean DAF [-]", title="simulated DAF")
    ax.legend(fontsize=9, loc="upper left", bbox_to_anchor=(1.0, 1.0))


def _draw_program(ax: Axes, tuned: TuningShown) -> None:
    """The dampings, before and after, as they are between the places."""
    x, steps = tuned.positions, tuned.strategy.shape == "steps"
    gains = tuned.strategy.gains
    earlier = gains | dict(zip(tuned.names, tuned.before, strict=True))
    for own, color, line, label in ((earlier, GREY, "--", "before"), (gains, BLUE, "-", "after")):
        ax.plot(
            x, 1e-3 * np.array([*own.values()]), line, marker=".", color=color, label=label,
            drawstyle="steps-post" if steps else "default",
        )  # fmt: skip
    ax.axvspan(0, tuned.beam.length, color=BRIDGE_TINT, zorder=0)
    ax.set(xlabel=STATION_LABEL, ylabel="damping c [kN s/m]", title="the program")
    ax.margins(x=0.01)
    ax.legend(fontsize=9)
