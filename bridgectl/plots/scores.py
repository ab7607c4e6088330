"""The figure of a scoreboard: bridge against ride and road, DAF over speed, and the DAE beside."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from typing import Any, NamedTuple

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from bridgectl._checks import FloatArray
from bridgectl._units import to_kmh
from bridgectl.plots.labels import label_points
from bridgectl.plots.shown import BoardShown
from bridgectl.plots.style import (
    BLACK,
    BLUE,
    BRIDGE_TINT,
    GREY,
    SPEED_LABEL,
    STATION_LABEL,
    TRACKS,
    VERMILLION,
    styled,
)

DAF_LABEL = "mean DAF [-]"

RIDE = ("body_acceleration", "body acceleration, rms [m/s²]")
WEIGHTED_RIDE = ("weighted_acceleration", "body acceleration weighted by W_k, rms [m/s²]")
TIRE_FORCE = ("dynamic_load_coefficient", "dynamic load coefficient [-]")

CONSTANT = "constant dampers"

CLAIRVOYANT = "clairvoyant"
"""What the optimum is called."""

PREVIEW = re.compile(r"preview.*?([\d.]+) m")
"""Names of strategies that see the road ahead, with how far [m]."""

FEW = 15
"""Curves of fewer points than this show them."""


OPTIMUM: Any = {"color": TRACKS[4], "ms": 9}


class _Look(NamedTuple):
    """How a strategy that stands out is drawn, and why it does."""

    color: str
    marker: str
    width: float
    role: str


@styled
def score_figure(board: BoardShown) -> Figure:
    """Draw what strategies do to a bridge, against what they do to ride and road.

    Above: mean DAF of each strategy against body acceleration and dynamic load coefficient, with
    the line of the constant dampers, as C. Poussot-Vassal, C. Spelta, O. Sename, S. M. Savaresi and
    L. Dugard draw it, Annual Reviews in Control 36 (2012) 148-160. Below: mean DAF over the speed;
    DAEs over the mean DAF, of each road class and by Eq. (15); and where along the road ramps of
    both signs raise or lower the DAF for the best, the first and the worst strategy: the area under
    a line is what the class adds to the DAF of a smooth road. If no class has a surface: Eq. (15)
    over the speed instead.

    If the clairvoyant optimum is known it is a point above and a line below; ride is then weighted
    by W_k. Strategies that differ in how far they see the road ahead are joined.
    """
    figure = Figure(figsize=(11.5, 9.8))
    looks = _looks(board)
    # Labels are placed beside points, so that no layout may move the axes afterwards.
    above = figure.subplots(1, 2, gridspec_kw={
        "left": 0.07, "right": 0.985, "top": 0.955, "bottom": 0.54, "wspace": 0.17})  # fmt: skip
    below = figure.subplots(1, 3 if board.surfaces else 2, gridspec_kw={
        "left": 0.07, "right": 0.985, "top": 0.38, "bottom": 0.06, "wspace": 0.27})  # fmt: skip
    ride = WEIGHTED_RIDE if board.optimum else RIDE
    for ax, (measure, label) in zip(above, (ride, TIRE_FORCE), strict=True):
        _draw_points(ax, board, measure, looks)
        ax.set_ylabel(label)
    above[0].set_title("bridge and ride: lower left is better")
    above[1].set_title("bridge and tire force: lower left is better")
    _draw_speeds(below[0], board, "daf", looks)
    if board.optimum:
        order = np.argsort(board.speeds)
        y = board.optimum["daf"].mean(axis=0)[order]
        below[0].plot(to_kmh(board.speeds[order]), y, "P:", label=CLAIRVOYANT, **OPTIMUM)
    below[0].set_title("simulated DAF, mean over the roads")
    below[0].set_ylabel("mean DAF [-]")
    if board.surfaces:
        _draw_second_order(below[1:], board, looks)
    else:
        _draw_speeds(below[1], board, "dae", looks)
        below[1].set_title("DAE by Eq. (15), mean over the roads")
        below[1].set_ylabel("mean DAE [-]")
    handles = [
        Line2D([], [], color=look.color, marker=look.marker, lw=look.width, ms=_size(look),
               label=f"{name}: {look.role}")
        for name, look in looks.items()
    ]  # fmt: skip
    if np.isfinite(board.dampings).sum() > 1:
        handles.append(Line2D([], [], color=GREY, lw=1.4, marker="o", ms=4, label=CONSTANT))
    if board.optimum:
        told = f"{CLAIRVOYANT}: the best that was found"
        handles.append(Line2D([], [], marker="P", ls=":", label=told, **OPTIMUM))
    if len(looks) < len(board.strategies):
        handles.append(Line2D([], [], color=GREY, lw=0.8, label="others"))
    figure.legend(handles=handles, loc="center", bbox_to_anchor=(0.52, 0.455), ncols=3,
                  fontsize=9.5)  # fmt: skip
    return figure


def _draw_second_order(axes: Sequence[Axes], board: BoardShown, looks: dict[str, _Look]) -> None:
    _draw_class_dae(axes[0], board, {name: look.color for name, look in looks.items()})
    axes[0].set_title("DAE beside simulated DAF")
    rows, roughest = board.rows(), max(board.surfaces)
    told = dict.fromkeys([rows[0].strategy, board.strategies[0], rows[-1].strategy])
    _draw_gains(axes[1], board, roughest, {name: looks[name].color for name in told})
    axes[1].set_title(f"where ramps of class {roughest} act")


def _looks(board: BoardShown) -> dict[str, _Look]:
    """What stands out: the first strategy, and those at the ends of each scale."""
    means = {name: values.mean(axis=(1, 2)) for name, values in board.values.items()}
    names = board.strategies
    roles = {names[0]: ["the baseline"]}
    for measure, what in (
        ("daf", "DAF"), (RIDE[0], "body acceleration"), (TIRE_FORCE[0], "load coefficient"),
    ):  # fmt: skip
        roles.setdefault(names[int(means[measure].argmin())], []).append(f"least {what}")
    roles.setdefault(names[int(means["daf"].argmax())], []).append("largest DAF")
    styles = [
        (BLACK, "*", 2.2), (VERMILLION, "o", 2.0), (BLUE, "s", 1.6), (TRACKS[2], "^", 1.6),
        (TRACKS[3], "D", 1.6),
    ]  # fmt: skip
    return {
        name: _Look(*style, ", ".join(why))
        for (name, why), style in zip(roles.items(), styles, strict=False)
    }


def _size(look: _Look) -> float:
    return 12.0 if look.marker == "*" else 6.0


def _draw_points(ax: Axes, board: BoardShown, measure: str, looks: dict[str, _Look]) -> None:
    """Strategies as points, and the line of the constant dampers."""
    means = (board.values[name].mean(axis=(1, 2)) for name in ("daf", measure))
    points = np.column_stack(list(means))
    constant = np.flatnonzero(np.isfinite(board.dampings))
    constant = constant[np.argsort(np.array(board.dampings)[constant])]
    locus = points[constant]
    if len(constant):
        ax.plot(*locus.T, "o-", color=GREY, lw=1.4, ms=4, label=CONSTANT, zorder=2)
    found = {i: PREVIEW.search(name) for i, name in enumerate(board.strategies)}
    ahead = sorted((float(seen[1]), i) for i, seen in found.items() if seen)
    if len(ahead) > 1:
        line = points[[i for _, i in ahead]]
        ax.plot(*line.T, "-", color=BLUE, lw=1.2, zorder=2, label="preview distances")
    others = [i for i, name in enumerate(board.strategies)
              if name not in looks and i not in constant]  # fmt: skip
    ax.plot(*points[others].T, "o", color=BLACK, mfc="white", ms=5.5, zorder=3, label="strategies")
    for name, look in looks.items():
        place = points[board.strategies.index(name)]
        ax.plot(*place, look.marker, color=look.color, ms=_size(look), zorder=4, label=name)
    if board.optimum:
        best = [board.optimum[name].mean() for name in ("daf", measure)]
        points = np.vstack([points, best])
        ax.plot(*best, "P", zorder=4, label=CLAIRVOYANT, **OPTIMUM)
    ax.margins(x=0.11, y=0.09)
    ax.set_xlabel(DAF_LABEL)
    # Limits that are fixed now: labels are placed by them.
    ax.set(xlim=ax.get_xlim(), ylim=ax.get_ylim())
    ends = {int(i) for i in constant[[0, -1]]} if len(constant) else set()
    told = [i for i, name in enumerate(board.strategies)
            if i not in constant or i in ends or name in looks]  # fmt: skip
    texts = [_label(board, i) for i in told]
    colors = [_color(board.strategies[i], looks) for i in told]
    if board.optimum:
        told, texts = [*told, len(points) - 1], [*texts, CLAIRVOYANT]
        colors.append(OPTIMUM["color"])
    label_points(ax, points[told], texts, obstacles=points, curve=locus, colors=colors)


def _label(board: BoardShown, i: int) -> str:
    """The name of a strategy; of a constant damper its damping."""
    c = board.dampings[i]
    return board.strategies[i] if i == 0 or np.isnan(c) else f"{c / 1e3:g} kN s/m"


def _color(name: str, looks: dict[str, _Look]) -> str:
    return looks[name].color if name in looks else BLACK


def _draw_speeds(ax: Axes, board: BoardShown, measure: str, looks: dict[str, _Look]) -> None:
    """A measure over the speed, averaged over the roads."""
    order = np.argsort(board.speeds)
    kmh: FloatArray = to_kmh(board.speeds[order])
    for name, values in zip(board.strategies, board.values[measure], strict=True):
        y = values.mean(axis=0)[order]
        look = looks.get(name)
        style: dict[str, Any] = {"color": GREY, "lw": 0.8, "alpha": 0.7, "zorder": 2}
        if look is not None:
            style = {"color": look.color, "lw": look.width, "zorder": 3}
        if kmh.size < FEW:
            style |= {"marker": look.marker, "ms": _size(look) * 0.7} if look else {
                "marker": ".", "ms": 3}  # fmt: skip
        ax.plot(kmh, y, label=name, **style)
    ax.margins(x=0.02)
    ax.set_xlabel(SPEED_LABEL)


MARKERS = "os^vD"
"""Of road classes."""

ENTRY = 0.058
"""Height of an entry of the legend, as a share of the panel's."""


def _draw_class_dae(ax: Axes, board: BoardShown, colors: Mapping[str, str]) -> None:
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
    # Above all points there is room for the legend.
    low, high = ax.get_ylim()
    room = ENTRY * 2 * len(board.surfaces)
    ax.set_ylim(low, low + (high - low) / (1 - room))
    ax.legend(loc="upper left", fontsize=8, handletextpad=0.2, borderaxespad=0.2)


def _draw_gains(ax: Axes, board: BoardShown, road_class: str, colors: Mapping[str, str]) -> None:
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
