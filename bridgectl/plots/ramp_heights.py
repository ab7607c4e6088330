"""The DAF against the height of one ramp, with the DAE of first and second order."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from bridgectl._units import to_kmh
from bridgectl.plots.shown import RampHeightsShown
from bridgectl.plots.style import BLACK, BLUE, GREY, SKY, VERMILLION, styled

IN_A_ROW = 3
"""Panels side by side."""


@styled
def ramp_height_figure(found: Sequence[RampHeightsShown]) -> Figure:
    """Draw the DAF of one ramp over its height, and what the DAE of both orders makes of it.

    One panel for each damper: the simulated DAF of a ramp that falls or rises, Eq. (15), which is
    the straight line of a 1 mm drop, and the DAE of order 2, the parabola through the smooth road
    and the points u+ and u- of a drop and a rise of height h. The even part e, what drop and rise
    have in common, is marked on the smooth road. Bridgehook has larger even effects at other
    places and speeds, and smaller ones.
    """
    place = _one_place(found)
    rows, columns = -(-len(found) // IN_A_ROW), min(len(found), IN_A_ROW)
    figure = Figure(figsize=(1.2 + 4.4 * columns, 0.9 + 3.7 * rows), layout="constrained")
    grid = figure.add_gridspec(rows, columns)
    first: Axes | None = None
    for k, one in enumerate(found):
        panel = figure.add_subplot(grid[divmod(k, columns)], sharey=first)
        first = first or panel
        _draw(panel, one)
        if k % columns == 0:
            panel.set_ylabel("dynamic amplification DAF, DAE [-]")
        else:
            panel.tick_params(labelleft=False)
    figure.suptitle(f"one ramp over 0.1 m at {place}")
    handles = {
        label: line
        for panel in figure.axes
        for line, label in zip(*panel.get_legend_handles_labels(), strict=True)
    }
    figure.legend(handles.values(), handles.keys(), loc="outside lower center", ncols=3)
    return figure


def _one_place(found: object) -> str:
    """Tell place and speed of the results; refuse what is none, and those that no title fits."""
    listed = found if isinstance(found, list | tuple) else []
    if not listed or not all(hasattr(one, "second_order") for one in listed):
        raise TypeError(
            f"found must be a list of RampHeights, one or more, got {found!r:.60}: type for "
            "example [bridgectl.ramp_heights(beam, vehicle, damper, speed, place)]"
        )
    first, *others = dict.fromkeys(
        f"x = {one.place:.4g} m from the start of the bridge, {to_kmh(one.speed):.4g} km/h"
        for one in listed
    )
    if others:
        raise ValueError(
            f"found must be of one place and speed, got {first} and {others[0]}: draw a figure "
            "for each"
        )
    return first


def _draw(ax: Axes, found: RampHeightsShown) -> None:
    """One damper: simulated DAF, both estimates, and the points that the second one meets."""
    mm, h = 1e3 * found.heights, 1e3 * found.ramp_height
    rise, smooth, drop = np.interp([-h, 0, h], mm, found.daf)
    odd, even = (drop - rise) / 2, (drop + rise) / 2 - smooth
    ax.axhline(smooth, color=GREY, ls=":", lw=1.6, label="DAF, smooth road")
    ax.plot(mm, found.daf, color=SKY, lw=5.0, solid_capstyle="round", label="simulated DAF")
    if found.lift_off.any():
        flying = found.lift_off
        ax.plot(mm[flying], found.daf[flying], "x", color=GREY, ms=5, label="tire leaves the road")
    ax.plot(
        mm, found.second_order, color=BLUE, lw=1.8,
        label="DAE of order 2: parabola through $u_-$, smooth, $u_+$",
    )  # fmt: skip
    ax.plot(
        mm, found.first_order, "--", color=VERMILLION, lw=1.8,
        label="DAE, Eq. (15): line of a 1 mm drop",
    )  # fmt: skip
    ax.plot([-h, h], [rise, drop], color=GREY, lw=0.9)
    ax.plot([0, 0], [smooth, smooth + even], color=BLACK, lw=2.4, label="even part e")
    ax.plot([-h, 0, h], [rise, smooth, drop], "o", color=BLACK, ms=5.5)
    for x, y, text in ((-h, rise, "$u_-$"), (h, drop, "$u_+$")):
        ax.annotate(text, (x, y), (0, -9), textcoords="offset points", ha="center", va="top")
    ax.set_title(f"{found.damper}\nodd part o = {odd:+.4f}, even part e = {even:+.4f}")
    ax.set_xlabel("height of the ramp, positive for a drop [mm]")
    ax.margins(x=0.02)
