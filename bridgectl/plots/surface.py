"""Figures of ramp surfaces: DAFs by place and speed, Figs. 2, 5 and 6 of the paper, effects."""

from __future__ import annotations

from itertools import cycle
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.colors import CenteredNorm
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator
from numpy.typing import ArrayLike

from bridgectl._checks import FloatArray
from bridgectl._units import to_kmh
from bridgectl.plots import style
from bridgectl.plots.shown import PaperShown, RoadShown, SurfaceShown

N_LINES = 5
"""Lines of a plot that is not told its speeds."""

FEW = 15
"""Curves of fewer points than this show them."""


@style.styled
def smooth_daf_plot(surface: SurfaceShown, ax: Axes | None = None) -> Axes:
    """Draw the DAF of a smooth road over the speed, Fig. 2 of the paper."""
    ax = style.new_axes(ax)
    ax.plot(*curve_of(surface, surface.daf_smooth), color=style.BLACK, **dots_of(surface))
    ax.set(xlabel=style.SPEED_LABEL, ylabel="{}, smooth road [{}]".format(*surface.quantity))
    return ax


@style.styled
def surface_plot(
    surface: SurfaceShown, *, difference: bool = False, ax: Axes | None = None
) -> Axes:
    """Draw the DAF of a ramp over its place and the speed, Figs. 5(a) and 6(a) of the paper.

    Or what the ramp changes, DAF_unit - DAF_smooth, Figs. 5(b) and 6(b).
    """
    if len(surface.speeds) < 2:
        raise ValueError("surface must have two speeds or more to be drawn, got one")
    ax = style.new_axes(ax)
    ramp = f"a {surface.ramp_height * 1e3:.3g} mm drop over {surface.ramp_length:g} m"
    values: FloatArray = surface.daf_unit
    ticks: FloatArray | None = None
    look: dict[str, Any] = {"levels": 16, "cmap": "cividis"}
    if difference:
        values = surface.daf_difference
        # No change is the middle of a band of one colour, not the edge between two.
        bands = MaxNLocator(12, symmetric=True).tick_values(values.min(), values.max())
        middles = np.asarray(bands)
        step = middles[1] - middles[0]
        levels = np.append(middles - step / 2, middles[-1] + step / 2)
        look = {"levels": levels, "cmap": "RdBu_r", "norm": CenteredNorm()}
        ticks = middles[middles.size // 2 % 2 :: 2]  # every other one, with 0 among them
        ax.set_title(f"what {ramp} changes")
    else:
        ax.set_title(f"{surface.quantity[0]} with {ramp}")
    places, kmh = surface.positions / surface.beam.length, to_kmh(surface.speeds)
    filled = ax.contourf(places, kmh, values, **look)
    ax.contour(filled, colors=style.BLACK, linewidths=0.25, alpha=0.5)
    label = _label(surface, difference)
    ax.figure.colorbar(filled, ax=ax, label=label, ticks=ticks, pad=0.02)
    ax.set(xlabel=style.PLACE_LABEL, ylabel=style.SPEED_LABEL)
    return ax


def draw_lines(
    ax: Axes, surface: SurfaceShown, values: FloatArray, speeds: ArrayLike | None
) -> None:
    """Draw values (n_speeds, n_ramps) over the places, one line a speed."""
    ends = surface.speeds.min(), surface.speeds.max()
    wanted = np.linspace(*ends, N_LINES) if speeds is None else np.atleast_1d(np.asarray(speeds))
    nearest = np.unique(np.abs(surface.speeds - wanted[:, np.newaxis]).argmin(axis=1))
    for i, color in zip(nearest, cycle(style.TRACKS), strict=False):
        label = f"{to_kmh(surface.speeds[i]):.4g} km/h"
        ax.plot(surface.positions / surface.beam.length, values[i], color=color, label=label)


def curve_of(surface: SurfaceShown, values: ArrayLike) -> tuple[FloatArray, FloatArray]:
    """Speeds [km/h] in increasing order, and values."""
    order = np.argsort(surface.speeds)
    return to_kmh(surface.speeds[order]), np.asarray(values)[order]


def dots_of(surface: SurfaceShown) -> dict[str, Any]:
    """Markers of a curve of few points."""
    return {"marker": "o"} if len(surface.speeds) < FEW else {}


def _label(surface: SurfaceShown, difference: bool) -> str:
    """What a surface's ramps give, or change."""
    name, unit = surface.quantity
    return f"change of the {name} [{unit}]" if difference else f"{name} [{unit}]"


TITLES = ("odd: changes its sign with the ramp", "even: drop and rise have it in common")


@style.styled
def effects_figure(
    surface: SurfaceShown,
    speeds: ArrayLike | None = None,
    *,
    road: RoadShown | ArrayLike | None = None,
) -> Figure:
    """Draw odd and even effects of ramps over their place, one line a speed.

    Parameters
    ----------
    surface : RampSurface
        A surface of ramps both ways.
    speeds : array_like, optional
        Speeds [m/s], of which the surface's nearest are drawn; five across its range if omitted.
    road : RoadProfile or array_like, optional
        A road, whose terms o s and e s^2 of the DAE of order 2 are drawn, summed up along it, in
        place of those of the unit ramp: see `RampSurface.dae`.

    Returns
    -------
    matplotlib.figure.Figure

    Raises
    ------
    TypeError, ValueError
        If the surface has ramps down alone, or the road does not fit it.

    Examples
    --------
    >>> import bridgectl as bc
    >>> from bridgectl.plots import effects_figure
    >>> surface = bc.ramp_surface(
    ...     bc.li2006.beam(), bc.li2006.car(), 25.0, ramp_height="A", both_ways=True)
    >>> [axes.get_ylabel() for axes in effects_figure(surface).axes]
    ['change of the DAF [-]', 'change of the DAF [-]']
    """
    values = [surface.odd_effect, surface.even_effect]
    label = "change of the {} [{}]".format(*surface.quantity)
    if road is not None:
        scales = surface.ramps(road)
        values = [np.cumsum(part, axis=1) for part in (values[0] * scales, values[1] * scales**2)]
        label = "DAE so far - smooth DAF [-]"
    figure = Figure(figsize=(9, 3.6), layout="constrained")
    for axes, part, title in zip(figure.subplots(1, 2), values, TITLES, strict=True):
        draw_lines(axes, surface, part, speeds)
        axes.set(xlabel=style.PLACE_LABEL, ylabel=label, title=title)
    figure.axes[0].legend()
    return figure


@style.styled
def paper_figure(results: PaperShown) -> Figure:
    """Draw Figs. 2, 5(a), 5(b), 6(a) and 6(b) of the paper as computed."""
    figure = Figure(figsize=(10.0, 10.5), layout="constrained")
    panels = figure.subplot_mosaic([["2", "2"], ["5(a)", "5(b)"], ["6(a)", "6(b)"]])
    top = smooth_daf_plot(results.unit, panels["2"])
    top.set_title("DAF of a smooth road")
    kmh, printed = results.printed_smooth
    top.plot(kmh, printed, "o", color=style.VERMILLION, label=f"printed: {printed:g}")
    top.margins(x=0)
    top.legend()
    for name, surface in (("5", results.unit), ("6", results.tall)):
        surface_plot(surface, ax=panels[f"{name}(a)"])
        surface_plot(surface, difference=True, ax=panels[f"{name}(b)"])
    for name, panel in panels.items():
        panel.set_title(f"Fig. {name}: {panel.get_title(loc='left')}")
    return figure
