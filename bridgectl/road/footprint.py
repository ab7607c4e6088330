"""The tire's contact length: a moving average of the road, for those who want it."""

from __future__ import annotations

import numpy as np

from bridgectl import _checks as check
from bridgectl._checks import FloatArray
from bridgectl._places import SAME_PLACE
from bridgectl._warn import warn
from bridgectl.road.events import require_road
from bridgectl.road.profile import RoadProfile


def tire_footprint(road: RoadProfile, length: float = 0.24) -> RoadProfile:
    """Return the road as a tire feels it: its moving average over the tire's contact length.

    The average at each station runs from ``x - length / 2`` to ``x + length / 2``. It is exact for
    a road that is straight between its stations, however uneven they are, and level beyond its
    ends. The stations stay the same, so a road must have them where its average bends: `resample`
    a road of few points first.

    Nothing in bridgectl applies this unless it is called: tires touch the road in one point by
    default. The IRI has its own base of 250 mm, so take it from the road itself.

    Parameters
    ----------
    road : RoadProfile
        The road.
    length : float, optional
        Contact length of the tire [m]; 0.24 m is the default of VBI-2D.

    Returns
    -------
    RoadProfile
        Of the same stations and name. Straight grades are unchanged farther than half of `length`
        from their ends.

    Raises
    ------
    TypeError
        If `road` is not a RoadProfile, or `length` not a number.
    ValueError
        If `length` is not positive.

    Warns
    -----
    UserWarning
        If the stations are too far apart to draw the average: between them it departs from
        straight lines by more than half of what the averaging changes.

    Examples
    --------
    The middle of a step stays, and its foot is lifted:

    >>> from bridgectl import RoadProfile
    >>> from bridgectl.road import add_events, step, tire_footprint
    >>> road = add_events(RoadProfile([-10, 25], [0, 0]).resample(0.05), step(0.0, 0.020))
    >>> tire_footprint(road).elevation_at([-0.2, 0, 0.05, 0.1, 0.3]).round(4)
    array([0.    , 0.0058, 0.01  , 0.0142, 0.02  ])
    """
    require_road(road)
    base = check.positive("length", length, unit="m")
    elevation = _moving_average(road, road.x, base)
    smooth = road._like(road.x, elevation)  # no steeper than the road
    _warn_if_coarse(road, smooth, base)
    return smooth


def _moving_average(road: RoadProfile, x: FloatArray, length: float) -> FloatArray:
    """Average elevation [m] over `length` about each x [m], to 1e-9 m on kilometres of road."""
    low, high = road.elevation.min(), road.elevation.max()
    datum = road.elevation.mean()  # keeps the integral small, and so its round-off
    heights = road.elevation - datum
    ahead = _integral(road.x, heights, x + length / 2)
    behind = _integral(road.x, heights, x - length / 2)
    # No average leaves the range of what it averages; only its round-off does.
    return np.clip(datum + (ahead - behind) / length, low, high)


def _integral(x: FloatArray, heights: FloatArray, stations: FloatArray) -> FloatArray:
    """Integral [m^2] of a road from its first station, level beyond its ends."""
    steps = np.diff(x)
    whole = np.concatenate([[0.0], np.cumsum(steps * (heights[1:] + heights[:-1]) / 2)])
    on_road = np.clip(stations, x[0], x[-1])
    piece = np.clip(np.searchsorted(x, on_road, side="right") - 1, 0, steps.size - 1)
    along, slope = on_road - x[piece], np.diff(heights)[piece] / steps[piece]
    inside = whole[piece] + along * (heights[piece] + slope * along / 2)
    return inside + (stations - on_road) * np.where(stations < x[0], heights[0], heights[-1])


def _warn_if_coarse(road: RoadProfile, smooth: RoadProfile, length: float) -> None:
    """Compare the average with its straight pieces where it bends, between the stations."""
    bends = np.concatenate([road.x - length / 2, road.x + length / 2])
    bends = bends[(bends > road.x[0]) & (bends < road.x[-1])]
    exact = _moving_average(road, bends, length)
    missed = np.abs(exact - smooth.elevation_at(bends)).max(initial=0.0)
    changed = np.abs(smooth.elevation - road.elevation).max()
    if missed > max(changed / 2, SAME_PLACE):
        warn(
            f"the road's stations are too far apart for a tire_footprint of {length:g} m: between "
            f"them the average differs from the result by up to {1e3 * missed:.3g} mm; pass "
            f"road.resample({length / 5:.2g})"
        )
