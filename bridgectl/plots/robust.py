"""The figure of a robustness study: change of the DAF over the size of each error, harm shaded."""

from __future__ import annotations

from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from bridgectl.plots.shown import RobustShown
from bridgectl.plots.style import BLACK, GREY, TRACKS, styled

HARM_TINT = "#fbe3dc"
COLUMNS = 4
MARKERS = "osD^vP*X"

CHANGE_LABEL = "change of mean DAF [-]"


@styled
def robust_figure(found: RobustShown) -> Figure:
    """Draw what is left of each strategy's gain over the size of each error.

    A panel for each kind of error and road class, strategies as lines with the 95 % intervals of
    their means over roads and speeds. Above the zero line, where it is shaded, they do harm.
    """
    kinds = list(dict.fromkeys(each.kind for each in found.errors[1:]))
    across = min(COLUMNS, len(kinds))
    down = -(-len(kinds) // across)
    figure = Figure(figsize=(3.1 * across + 0.9, 2.5 * down * len(found.classes) + 1.1),
                    layout="constrained")  # fmt: skip
    blocks = np.atleast_1d(np.array(figure.subfigures(len(found.classes), 1), dtype=object))
    for block, road_class in zip(blocks, found.classes, strict=True):
        block.suptitle(f"roads of class {road_class}", x=0.01, ha="left", fontsize=11)
        axes = block.subplots(down, across, sharey=True, squeeze=False)
        for ax, kind in zip(axes.flat, kinds, strict=False):
            _draw_kind(ax, found, kind, road_class)
        for ax in axes.flat[len(kinds) :]:
            ax.set_visible(False)
        for ax in axes[:, 0]:
            ax.set_ylabel(CHANGE_LABEL)
        for ax in axes.flat[: len(kinds)]:  # as high as all of them
            low, high = ax.get_ylim()
            ax.axhspan(0, max(high, 0.005), color=HARM_TINT, zorder=0, lw=0)
            ax.set_ylim(low, max(high, 0.005))
    figure.legend(handles=_handles(found), loc="outside lower center", ncols=4, fontsize=9)
    return figure


def _draw_kind(ax: Axes, found: RobustShown, kind: str, road_class: str) -> None:
    """Lines over the sizes of a kind, through that of nothing wrong; of names marks alone."""
    own = [each for each in found.errors if each.kind == kind]
    named = any(np.isnan(each.size) for each in own)
    right = [] if named or kind == "sample time" else [found.errors[0]]  # samples take a time
    told = own if named else sorted([*right, *own], key=lambda each: each.size)
    places = np.arange(len(told)) if named else np.array([each.size for each in told])
    for i, name in enumerate(found.strategies):
        changes = [found.change(name, str(each), road_class) for each in told]
        y = np.array([each.mean for each in changes])
        reach = np.array([each.high - each.mean for each in changes])
        shift = 0.07 * (i - (len(found.strategies) - 1) / 2) if named else 0.0
        ax.errorbar(places + shift, y, np.nan_to_num(reach), ls="none" if named else "-",
                    lw=1.3, elinewidth=0.8, ms=4, zorder=3, **_look(i))  # fmt: skip
    ax.axhline(0, color=BLACK, lw=1.0, zorder=2)
    ax.set_title(kind)
    if named:
        labels = [each.name.replace(", ", "\n").replace(" ", "\n", 1) for each in told]
        ax.set_xticks(places, labels, fontsize=7)
        ax.grid(visible=False, axis="x")
    else:
        ax.set_xlabel(f"{kind} [{own[0].unit}]")


def _look(i: int) -> dict[str, Any]:
    colors = (*TRACKS, BLACK, GREY, "#56B4E9")
    return {"color": colors[i % len(colors)], "marker": MARKERS[i % len(MARKERS)]}


def _handles(found: RobustShown) -> list[Line2D]:
    handles = [
        Line2D([], [], lw=1.3, ms=4, label=name, **_look(i))
        for i, name in enumerate(found.strategies)
    ]
    shade = Line2D([], [], color=HARM_TINT, lw=8, label=f"harm: worse than {found.baseline}")
    return [*handles, shade]
