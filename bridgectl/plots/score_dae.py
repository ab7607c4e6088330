"""Panels of a scoreboard's figure: the DAE beside the DAF, and where along the road it changes."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from matplotlib.axes import Axes

from bridgectl.plots.shown import BoardShown
from bridgectl.plots.style import BLACK, BRIDGE_TINT, GREY, STATION_LABEL

MARKERS = "os^vD"
"""Of road classes."""


def draw_class_dae(ax: Axes, board: BoardShown, colors: Mapping[str, str]) -> None:
    """Draw every strategy's class DAE, and mean of Eq. (15), over its simulated mean DAF."""
    rankings, classes = board.rankings(), np.array(board.road_classes)
    for name, marker in zip(board.surfaces, MARKERS, strict=False):
        rows = {row.strategy: row for row in board.class_rows(name)}
        daf, dae = np.array([(rows[each].daf, rows[each].dae) for each in board.strategies]).T
        eq_15 = board.values["dae"][:, classes == name].mean(axis=(1, 2))
        # Of a class these two are ranked first, and then the spread.
        ranked = (each for each in rankings if each.roads == f"class {name}")
        for fill, (values, ranking) in enumerate(zip((eq_15, dae), ranked, strict=False)):
            told, tau = f"{ranking.estimate}, class {name}", ranking.agreement.tau
            told += "" if np.isnan(tau) else f": tau {tau:.2f}"
            ax.plot([], [], marker, color=GREY, mfc=GREY if fill else "white", ms=5, label=told)
            for each, x, y in zip(board.strategies, daf, values, strict=True):
                color = colors.get(each, GREY)
                face = color if fill else "white"
                ax.plot(x, y, marker, color=color, mfc=face, ms=6 if fill else 4.5, zorder=2 + fill)
    ends = np.array([ax.dataLim.intervalx, ax.dataLim.intervaly])
    ends = np.array([ends.min(), ends.max()])
    ax.plot(ends, ends, color=BLACK, lw=0.8, ls=":", zorder=1)
    ax.set(xlabel="mean DAF [-]", ylabel="mean DAE [-]")
    ax.margins(0.06)
    ax.locator_params(axis="x", nbins=5)
    ax.legend(loc="upper left", fontsize=8, handletextpad=0.2, borderaxespad=0.2)


def draw_gains(ax: Axes, board: BoardShown, road_class: str, colors: Mapping[str, str]) -> None:
    """Draw what a class adds to the DAE for each metre of road: the area is all it adds."""
    for name, color in colors.items():
        surface = board.surfaces[road_class][board.strategies.index(name)]
        x = surface.positions[:: surface.every]
        # The unit ramp has the variance of all ramps together: each has its share of that.
        length = len(surface.positions) * surface.ramp_length
        density = surface.even_effect[:, :: surface.every].mean(axis=0) / length
        ax.plot(x, 1e3 * density, color=color, lw=1.6, label=name)
    ax.axhline(0, color=BLACK, lw=0.8)
    ax.axvspan(0, board.beam.length, color=BRIDGE_TINT, zorder=0)
    ax.set(xlabel=STATION_LABEL, ylabel="added to the DAF by a metre of road [0.001/m]")
    ax.margins(x=0.01)
