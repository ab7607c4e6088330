"""What ramps both ways do, along the bridge."""

from __future__ import annotations

import numpy as np
from matplotlib.figure import Figure
from numpy.typing import ArrayLike

from bridgectl.plots.shown import RoadShown, SurfaceShown
from bridgectl.plots.style import PLACE_LABEL, styled
from bridgectl.plots.surface import draw_lines

TITLES = ("odd: changes its sign with the ramp", "even: drop and rise have it in common")


@styled
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
    values, label = (
        [surface.odd_effect, surface.even_effect],
        "change of the {} [{}]".format(*surface.quantity),
    )
    if road is not None:
        scales = surface.ramps(road)
        values = [np.cumsum(part, axis=1) for part in (values[0] * scales, values[1] * scales**2)]
        label = "DAE so far - smooth DAF [-]"
    figure = Figure(figsize=(9, 3.6), layout="constrained")
    for axes, part, title in zip(figure.subplots(1, 2), values, TITLES, strict=True):
        draw_lines(axes, surface, part, speeds)
        axes.set(xlabel=PLACE_LABEL, ylabel=label, title=title)
    figure.axes[0].legend()
    return figure
