"""The figure of a road on a bridge: DAF and DAE over speed, the road, and what its ramps add."""

from __future__ import annotations

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.markers import CARETUP
from numpy.typing import ArrayLike

from bridgectl._checks import FloatArray
from bridgectl._units import to_kmh
from bridgectl.plots import style
from bridgectl.plots.shown import RoadShown, SurfaceShown
from bridgectl.plots.surface import curve_of, dots_of

MARKED = 10
"""How many of the largest contributions are marked."""


@style.styled
def dae_figure(
    surface: SurfaceShown, road: RoadShown, *, superposed: ArrayLike | None = None,
    simulated: ArrayLike | None = None,
) -> Figure:  # fmt: skip
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
    kmh, effects = to_kmh(surface.speeds[critical]), surface.contributions(road)[critical]
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
    if np.any(effects):
        below.legend(loc="upper right")
    return figure


def _draw_speeds(
    ax: Axes, surface: SurfaceShown, road: RoadShown, superposed: FloatArray,
    simulated: ArrayLike | None, critical: int,
) -> None:  # fmt: skip
    def curve(values: ArrayLike, label: str, color: str, dashes: str, width: float) -> None:
        x, y = curve_of(surface, values)
        ax.plot(x, y, dashes, color=color, lw=width, label=label, ms=width + 2, **dots_of(surface))

    known = superposed if simulated is None else np.asarray(simulated)
    curve(surface.daf_smooth, "DAF, smooth road", style.GREY, ":", 1.8)
    curve(superposed, "superposed DAF", style.SKY, "-", 5.0)
    if simulated is not None:
        curve(simulated, "simulated DAF", style.BLACK, "-", 1.3)
    dae = surface.dae(road)
    curve(dae, "DAE", style.VERMILLION, "--", 1.8)
    kmh, peak = to_kmh(surface.speeds[critical]), known[critical]
    in_left_half = kmh <= to_kmh((surface.speeds.min() + surface.speeds.max()) / 2)
    ax.axvline(kmh, color=style.GREY, lw=0.9, zorder=1)
    ax.annotate(
        f"critical speed {kmh:.4g} km/h, DAF {peak:.3f}",
        (kmh, max(peak, dae.max(), surface.daf_smooth.max())),
        (7 if in_left_half else -7, 7),
        textcoords="offset points",
        ha="left" if in_left_half else "right",
    )
    ax.margins(x=0.01, y=0.1)
    ax.set(xlabel=style.SPEED_LABEL, ylabel="amplification DAF, DAE [-]")
    ax.legend(loc="lower left", bbox_to_anchor=(0, 1), ncols=4)


def _draw_road(
    ax: Axes, surface: SurfaceShown, road: RoadShown, window: tuple[float, float]
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
    ax.axvspan(0, span, color=style.BRIDGE_TINT, zorder=0)
    for side in (x <= 0, x >= span):
        ax.fill_between(x[side], z[side], bottom, color=style.GROUND, lw=0)
    ax.fill_between(x[on], z[on], deck, color=style.PAVEMENT, lw=0)
    ax.fill_between([0, span], deck, under_deck, color=style.DECK, lw=0)
    ax.plot([0, span], [under_deck] * 2, ls="none", marker=CARETUP, ms=9, color=style.DECK)
    ax.plot(x, z, color=style.BLACK, lw=1.1)
    ax.set(xlim=window, ylim=(bottom, z.max() + 0.1 * height))
    ax.tick_params(labelbottom=False)


def _draw_contributions(
    ax: Axes, surface: SurfaceShown, effects: FloatArray, window: tuple[float, float]
) -> None:
    """What each ramp adds to the DAE, as a line at its middle."""
    x = surface.positions + surface.ramp_length / 2
    ax.axvspan(0, surface.beam.length, color=style.BRIDGE_TINT, zorder=0)
    for sign, color, label in ((1, style.VERMILLION, "raises it"), (-1, style.BLUE, "lowers it")):
        of_sign = sign * effects > 0
        if of_sign.any():
            ax.vlines(x[of_sign], 0, effects[of_sign], color=color, lw=1.1, label=label)
    if marked := min(MARKED, np.count_nonzero(effects)):
        largest = np.argsort(-np.abs(effects), kind="stable")[:marked]
        seen = largest[x[largest] > window[0]]
        ax.plot(x[seen], effects[seen], "o", ms=4, color=style.BLACK, label=f"{marked} largest")
    ax.axhline(0, color=style.GREY, lw=0.8)
    ax.set_xlabel(style.STATION_LABEL)
    ax.margins(y=0.12)


def _windows(surface: SurfaceShown) -> dict[tuple[float, float], str]:
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


def _span(surface: SurfaceShown) -> str:
    return f"{surface.beam.length:g} m"


def _sum(smooth: float, effects: FloatArray) -> str:
    added = float(effects.sum())
    sign = "+" if added >= 0 else "-"
    return f"smooth {smooth:.3f} {sign} ramps {abs(added):.3f} = DAE {smooth + added:.3f}"
