"""Figures of crossings: DAF and DAE over speed, ramp surfaces, and the paper's figures."""

from __future__ import annotations

from itertools import cycle
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.colors import CenteredNorm
from matplotlib.figure import Figure
from matplotlib.markers import CARETUP
from matplotlib.ticker import MaxNLocator
from numpy.typing import ArrayLike

from bridgectl._checks import FloatArray
from bridgectl.paper import li2006
from bridgectl.paper.printed import EXAMPLE_KMH, PaperResults
from bridgectl.plots.style import (
    BLACK,
    BLUE,
    BRIDGE_TINT,
    DECK,
    GREY,
    GROUND,
    PAVEMENT,
    PLACE_LABEL,
    SKY,
    SPEED_LABEL,
    STATION_LABEL,
    TRACKS,
    VERMILLION,
    new_axes,
    styled,
)
from bridgectl.road import RoadProfile
from bridgectl.surface.surface import RampSurface

MARKED = 10
"""How many of the largest contributions are marked."""

N_LINES = 5
"""Lines of a plot that is not told its speeds."""

FEW = 15
"""Curves of fewer points than this show them."""


@styled
def dae_figure(
    surface: RampSurface,
    road: RoadProfile,
    *,
    superposed: ArrayLike | None = None,
    simulated: ArrayLike | None = None,
) -> Figure:
    """Draw what a road does to a bridge: DAF and DAE over speed, the road, and its ramps.

    Parameters
    ----------
    surface : RampSurface
        The ramp surface of bridge and vehicle.
    road : RoadProfile
        A road that covers the approach and the bridge.
    superposed : array_like, optional
        DAF of the superposed histories at the surface's speeds; computed if omitted.
    simulated : array_like, optional
        Simulated DAF at the same speeds; not drawn if omitted. Its maximum, or else that of
        the superposed DAF, is at the critical speed, whose contributions are shown.

    Returns
    -------
    matplotlib.figure.Figure

    Raises
    ------
    TypeError, ValueError
        If the road does not suit the surface: see `RampSurface.ramps`.

    Examples
    --------
    >>> import bridgectl as bc
    >>> from bridgectl.plots import dae_figure
    >>> surface = bc.ramp_surface(bc.li2006.beam(), bc.li2006.car(), [25.0, 30.0])
    >>> figure = dae_figure(surface, bc.li2006.fig7_road())
    >>> [axes.get_xlabel() for axes in figure.axes]
    ['speed [km/h]', '', 'x from the start of the bridge [m]']
    """
    exact = np.asarray(surface.superposed_daf(road) if superposed is None else superposed)
    known = exact if simulated is None else np.asarray(simulated)
    critical = int(known.argmax())
    kmh, effects = surface.speeds[critical] * 3.6, surface.contributions(road)[critical]
    figure = Figure(figsize=(10.0, 9.2), layout="constrained")
    # A dollar sign in the name of a file is no formula.
    title = f"{road.name or 'road'}: amplification on a bridge of {_span(surface)}"
    figure.suptitle(title, parse_math=False)
    windows = _windows(surface)
    grid = figure.add_gridspec(3, len(windows), height_ratios=(1.4, 0.9, 1.0))
    _draw_speeds(figure.add_subplot(grid[0, :]), surface, road, exact, simulated, critical)
    for column, (window, title) in enumerate(windows.items()):
        above = figure.add_subplot(grid[1, column])
        _draw_road(above, surface, road, window)
        below = figure.add_subplot(grid[2, column], sharex=above)
        _draw_contributions(below, surface, effects, window)
        above.set_title(title)
        above.set_ylabel("elevation [mm]")
        below.set_ylabel("contribution to DAE [-]")
        below.set_title(f"at {kmh:.4g} km/h, each ramp's contribution")
    equation = _sum(surface.daf_smooth[critical], effects)
    below.set_title(equation if len(windows) > 1 else f"at {kmh:.4g} km/h: {equation}")
    # The right half of a bridge is nearly free: ramps there come after the peak.
    below.legend(loc="upper right")
    return figure


@styled
def smooth_daf_plot(surface: RampSurface, ax: Axes | None = None) -> Axes:
    """Draw the DAF of a smooth road over the speed, Fig. 2 of the paper.

    Parameters
    ----------
    surface : RampSurface
        The ramp surface of bridge and vehicle.
    ax : matplotlib.axes.Axes, optional
        Where to draw; a new figure if omitted.

    Returns
    -------
    matplotlib.axes.Axes

    References
    ----------
    Y. Li, E. OBrien, A. Gonzalez, J. Sound Vib. 293 (2006) 125-137, Fig. 2.

    Examples
    --------
    >>> import bridgectl as bc
    >>> from bridgectl.plots import smooth_daf_plot
    >>> surface = bc.ramp_surface(bc.li2006.beam(), bc.li2006.car(), [25.0, 30.0])
    >>> smooth_daf_plot(surface).get_ylabel()
    'DAF, smooth road [-]'
    """
    ax = new_axes(ax)
    ax.plot(*_curve(surface, surface.daf_smooth), color=BLACK, **_dots(surface))
    ax.set(xlabel=SPEED_LABEL, ylabel="DAF, smooth road [-]")
    return ax


@styled
def surface_plot(surface: RampSurface, *, difference: bool = False, ax: Axes | None = None) -> Axes:
    """Draw the DAF of a ramp over its place and the speed: Figs. 5 and 6 of the paper.

    Parameters
    ----------
    surface : RampSurface
        A ramp surface of two speeds or more.
    difference : bool, optional
        Draw what the ramp changes, DAF_unit - DAF_smooth (Figs. 5(b) and 6(b)), in place of
        DAF_unit itself (Figs. 5(a) and 6(a)).
    ax : matplotlib.axes.Axes, optional
        Where to draw; a new figure if omitted.

    Returns
    -------
    matplotlib.axes.Axes

    Raises
    ------
    ValueError
        If the surface has one speed only.

    Examples
    --------
    >>> import bridgectl as bc
    >>> from bridgectl.plots import surface_plot
    >>> surface = bc.ramp_surface(bc.li2006.beam(), bc.li2006.car(), [25.0, 30.0])
    >>> surface_plot(surface).get_title(loc="left")
    'DAF with a 1 mm drop over 0.1 m'
    """
    if len(surface.speeds) < 2:
        raise ValueError("surface must have two speeds or more to be drawn, got one")
    ax = new_axes(ax)
    ramp = f"a {surface.ramp_height * 1e3:g} mm drop over {surface.ramp_length:g} m"
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
        ax.set_title(f"DAF with {ramp}")
    places, kmh = surface.positions / surface.beam.length, surface.speeds * 3.6
    filled = ax.contourf(places, kmh, values, **look)
    ax.contour(filled, colors=BLACK, linewidths=0.25, alpha=0.5)
    label = "change of the DAF [-]" if difference else "DAF [-]"
    ax.figure.colorbar(filled, ax=ax, label=label, ticks=ticks, pad=0.02)
    ax.set(xlabel=PLACE_LABEL, ylabel=SPEED_LABEL)
    return ax


@styled
def lines_plot(
    surface: RampSurface,
    speeds: ArrayLike | None = None,
    *,
    difference: bool = False,
    ax: Axes | None = None,
) -> Axes:
    """Draw the DAF of a ramp over its place, one line a speed: cuts through Figs. 5 and 6.

    Parameters
    ----------
    surface : RampSurface
        The ramp surface of bridge and vehicle.
    speeds : array_like, optional
        Speeds [m/s], of which the surface's nearest are drawn; five across its range if omitted.
    difference : bool, optional
        Draw what the ramp changes, DAF_unit - DAF_smooth, in place of DAF_unit itself.
    ax : matplotlib.axes.Axes, optional
        Where to draw; a new figure if omitted.

    Returns
    -------
    matplotlib.axes.Axes

    Examples
    --------
    >>> import bridgectl as bc
    >>> from bridgectl.plots import lines_plot
    >>> surface = bc.ramp_surface(bc.li2006.beam(), bc.li2006.car(), [25.0, 30.0])
    >>> [line.get_label() for line in lines_plot(surface).lines]
    ['90 km/h', '108 km/h']
    """
    ax = new_axes(ax)
    draw_lines(ax, surface, surface.daf_difference if difference else surface.daf_unit, speeds)
    ax.set(xlabel=PLACE_LABEL, ylabel="change of the DAF [-]" if difference else "DAF [-]")
    ax.legend()
    return ax


def draw_lines(
    ax: Axes, surface: RampSurface, values: FloatArray, speeds: ArrayLike | None
) -> None:
    """Draw values (n_speeds, n_ramps) over the places, one line a speed: see `lines_plot`."""
    ends = surface.speeds.min(), surface.speeds.max()
    wanted = np.linspace(*ends, N_LINES) if speeds is None else np.atleast_1d(np.asarray(speeds))
    nearest = np.unique(np.abs(surface.speeds - wanted[:, np.newaxis]).argmin(axis=1))
    for i, color in zip(nearest, cycle(TRACKS), strict=False):
        label = f"{surface.speeds[i] * 3.6:.4g} km/h"
        ax.plot(surface.positions / surface.beam.length, values[i], color=color, label=label)


@styled
def paper_figure(results: PaperResults) -> Figure:
    """Draw Figs. 2, 5(a), 5(b), 6(a) and 6(b) of the paper as computed.

    Parameters
    ----------
    results : PaperResults
        See `bridgectl.paper.printed.paper_results`.

    Returns
    -------
    matplotlib.figure.Figure

    References
    ----------
    Y. Li, E. OBrien, A. Gonzalez, J. Sound Vib. 293 (2006) 125-137, Figs. 2, 5 and 6.

    Examples
    --------
    >>> from bridgectl.paper.printed import paper_results
    >>> from bridgectl.plots import paper_figure
    >>> paper_figure(paper_results()).axes[0].get_title(loc="left")
    'Fig. 2: DAF of a smooth road'
    """
    figure = Figure(figsize=(10.0, 10.5), layout="constrained")
    panels = figure.subplot_mosaic([["2", "2"], ["5(a)", "5(b)"], ["6(a)", "6(b)"]])
    top = smooth_daf_plot(results.unit, panels["2"])
    top.set_title("DAF of a smooth road")
    printed = li2006.PRINTED["daf_smooth_110"]
    top.plot(EXAMPLE_KMH, printed, "o", color=VERMILLION, label=f"printed: {printed:g}")
    top.margins(x=0)
    top.legend()
    for name, surface in (("5", results.unit), ("6", results.tall)):
        surface_plot(surface, ax=panels[f"{name}(a)"])
        surface_plot(surface, difference=True, ax=panels[f"{name}(b)"])
    for name, panel in panels.items():
        panel.set_title(f"Fig. {name}: {panel.get_title(loc='left')}")
    return figure


def _curve(surface: RampSurface, values: ArrayLike) -> tuple[FloatArray, FloatArray]:
    """Speeds [km/h] in increasing order, and values."""
    order = np.argsort(surface.speeds)
    return surface.speeds[order] * 3.6, np.asarray(values)[order]


def _dots(surface: RampSurface) -> dict[str, Any]:
    return {"marker": "o"} if len(surface.speeds) < FEW else {}


def _draw_speeds(
    ax: Axes,
    surface: RampSurface,
    road: RoadProfile,
    superposed: FloatArray,
    simulated: ArrayLike | None,
    critical: int,
) -> None:
    def curve(values: ArrayLike, label: str, color: str, style: str, width: float) -> None:
        x, y = _curve(surface, values)
        ax.plot(x, y, style, color=color, lw=width, label=label, ms=width + 2, **_dots(surface))

    known = superposed if simulated is None else np.asarray(simulated)
    curve(surface.daf_smooth, "DAF, smooth road", GREY, ":", 1.8)
    curve(superposed, "superposed DAF", SKY, "-", 5.0)
    if simulated is not None:
        curve(simulated, "simulated DAF", BLACK, "-", 1.3)
    dae = surface.dae(road)
    curve(dae, "DAE", VERMILLION, "--", 1.8)
    kmh, peak = surface.speeds[critical] * 3.6, known[critical]
    in_left_half = kmh <= 3.6 * (surface.speeds.min() + surface.speeds.max()) / 2
    ax.axvline(kmh, color=GREY, lw=0.9, zorder=1)
    ax.annotate(
        f"critical speed {kmh:.4g} km/h, DAF {peak:.3f}",
        (kmh, max(peak, dae.max(), surface.daf_smooth.max())),
        (7 if in_left_half else -7, 7),
        textcoords="offset points",
        ha="left" if in_left_half else "right",
    )
    ax.margins(x=0.01, y=0.1)
    ax.set(xlabel=SPEED_LABEL, ylabel="amplification DAF, DAE [-]")
    ax.legend(loc="lower left", bbox_to_anchor=(0, 1), ncols=4)


def _draw_road(
    ax: Axes, surface: RampSurface, road: RoadProfile, window: tuple[float, float]
) -> None:
    """The road in mm, with the ground and the bridge below it."""
    span = surface.beam.length
    inner = road.x[(road.x > window[0]) & (road.x < window[1])]
    x = np.unique(np.concatenate([inner, [*window, 0.0, span]]))
    # Level before and after the road, as the crossing takes it.
    z = 1e3 * road.elevation_at(np.clip(x, road.x[0], road.x[-1]))
    height = max(float(np.ptp(z)), 1.0)
    on = (x >= 0) & (x <= span)
    deck = z[on].min() - 0.04 * height
    under_deck, bottom = deck - 0.09 * height, min(z.min(), deck) - 0.45 * height
    ax.axvspan(0, span, color=BRIDGE_TINT, zorder=0)
    for side in (x <= 0, x >= span):
        ax.fill_between(x[side], z[side], bottom, color=GROUND, lw=0)
    ax.fill_between(x[on], z[on], deck, color=PAVEMENT, lw=0)
    ax.fill_between([0, span], deck, under_deck, color=DECK, lw=0)
    ax.plot([0, span], [under_deck] * 2, ls="none", marker=CARETUP, ms=9, color=DECK)
    ax.plot(x, z, color=BLACK, lw=1.1)
    ax.set(xlim=window, ylim=(bottom, z.max() + 0.1 * height))
    ax.tick_params(labelbottom=False)


def _draw_contributions(
    ax: Axes, surface: RampSurface, effects: FloatArray, window: tuple[float, float]
) -> None:
    """What each ramp adds to the DAE, as a line at its middle."""
    x = surface.positions + surface.ramp_length / 2
    ax.axvspan(0, surface.beam.length, color=BRIDGE_TINT, zorder=0)
    for sign, color, label in ((1, VERMILLION, "raises it"), (-1, BLUE, "lowers it")):
        of_sign = sign * effects > 0
        ax.vlines(x[of_sign], 0, effects[of_sign], color=color, lw=1.1, label=label)
    largest = np.argsort(-np.abs(effects), kind="stable")[:MARKED]
    seen = largest[(x[largest] > window[0]) & (effects[largest] != 0)]
    ax.plot(x[seen], effects[seen], "o", ms=4, color=BLACK, label=f"{MARKED} largest")
    ax.axhline(0, color=GREY, lw=0.8)
    ax.set_xlabel(STATION_LABEL)
    ax.margins(y=0.12)


def _windows(surface: RampSurface) -> dict[tuple[float, float], str]:
    """What each column shows: the approach and the bridge, or each on its own scale."""
    span, approach = surface.beam.length, surface.approach
    margin = 0.08 * span
    alone = (-approach - margin, span + margin)
    if approach == 0:
        return {alone: f"the road on the bridge of {_span(surface)}"}
    title = f"the road: {approach:g} m of approach, then the bridge"
    if approach <= span:
        return {alone: title}
    wider = 0.03 * (approach + span)
    return {
        (-approach - wider, span + wider): title,
        (-margin, span + margin): f"the {_span(surface)} of the bridge, enlarged",
    }


def _span(surface: RampSurface) -> str:
    return f"{surface.beam.length:g} m"


def _sum(smooth: float, effects: FloatArray) -> str:
    added = float(effects.sum())
    sign = "+" if added >= 0 else "-"
    return f"smooth {smooth:.3f} {sign} ramps {abs(added):.3f} = DAE {smooth + added:.3f}"
