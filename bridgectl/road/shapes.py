"""The shapes of local road events: step, ramp, plank, bump and settlement."""

from __future__ import annotations

import math

import numpy as np

from bridgectl import _checks as check
from bridgectl._docs import filled
from bridgectl._places import SAME_PLACE
from bridgectl.road.events import RoadEvent
from bridgectl.road.limits import MAX_SLOPE

COSINE_PIECES = 50  # n chords miss a 1-cosine hump by pi^2 / (4 n^2) = 0.99e-3 of its height
PARABOLA_PIECES = 16  # n chords miss a parabola by 1 / (4 n^2) = 0.98e-3 of its rise

documented = filled(
    event="""\
Returns
-------
RoadEvent

Raises
------
TypeError, ValueError
    If an argument is not what is described above, or the event is steeper than 1 m/m."""
)


@documented
def step(x: float, height: float, *, over: float = 0.1) -> RoadEvent:
    """Return a permanent change of level over a short length, as faulting makes at a joint.

    Parameters
    ----------
    x : float
        Station where the step begins [m]; it ends at ``x + over``.
    height : float
        Change of level [m], positive up, negative for a step down.
    over : float, optional
        Length of the step [m]; 0.1 m is the ramp of Li, OBrien and Gonzalez (2006).

    {event}

    Examples
    --------
    A deck 20 mm higher than its approach:

    >>> from bridgectl.road import step
    >>> step(0.0, 0.020)
    RoadEvent('step of 20 mm at 0 m', 2 points, x from 0 m to 0.1 m, rise from 0 m to 0.02 m)
    """
    return _rise("step", x, height, ("over", over))


@documented
def ramp(x: float, length: float, height: float) -> RoadEvent:
    """Return a permanent change of level by a straight ramp.

    Parameters
    ----------
    x : float
        Station where the ramp begins [m].
    length : float
        Length of the ramp [m].
    height : float
        Change of level [m], positive up, negative for a ramp down.

    {event}

    Examples
    --------
    >>> from bridgectl.road import ramp
    >>> ramp(-6.0, length=6.0, height=0.030).rise_at([-6, -3, 0, 25])
    array([0.   , 0.015, 0.03 , 0.03 ])
    """
    return _rise("ramp", x, height, ("length", length))


@documented
def plank(x: float, length: float, height: float, *, over: float = 0.05) -> RoadEvent:
    """Return a plank on the road: up, flat, and down again.

    Cai, Shi, Araujo and Chen laid a wooden plank at the end of a deck for a large faulting.

    Parameters
    ----------
    x : float
        Station where the plank begins [m].
    length : float
        Length along the road [m], both edges included.
    height : float
        Thickness [m], positive up, negative for a slot.
    over : float, optional
        Length of each of the two edges [m], below half of `length`.

    {event}

    References
    ----------
    C. S. Cai, X. M. Shi, M. Araujo, S. R. Chen, Effect of approach span condition on
    vehicle-induced dynamic response of slab-on-girder road bridges, Engineering Structures 29
    (2007) 3210-3226.

    Examples
    --------
    >>> from bridgectl.road import plank
    >>> plank(0.0, length=0.3, height=0.04).x
    array([0.  , 0.05, 0.25, 0.3 ])
    """
    start = check.number("x", x, unit="m")
    whole = check.positive("length", length, unit="m")
    edge = check.positive("over", over, unit="m")
    rise = check.number("height", height, unit="m")
    if whole - 2 * edge <= SAME_PLACE:
        raise ValueError(
            f"over = {edge:g} m twice must be shorter than length = {whole:g} m: type "
            f"over={whole / 4:g}, or bump() for a plank without a flat top"
        )
    _require_length(("height", rise), ("over", edge), MAX_SLOPE)
    stations = [start, start + edge, start + whole - edge, start + whole]
    return RoadEvent(stations, [0.0, rise, rise, 0.0], _label("plank", rise, start))


@documented
def bump(x: float, length: float, height: float) -> RoadEvent:
    """Return a 1-cosine hump, height / 2 (1 - cos(2 pi s / length)).

    Its steepest slope is pi height / length. It has 51 points: the 50 chords between them stay
    within pi^2 / (4 * 50^2) = 0.99e-3 of the height from the curve, the peak is one of the points,
    and the area is exact.

    Parameters
    ----------
    x : float
        Station where the hump begins [m].
    length : float
        Length of the hump [m].
    height : float
        Height of its middle [m], positive up; negative for a pothole, as Pesterev et al. use.

    {event}

    References
    ----------
    A. V. Pesterev, L. A. Bergman, C. A. Tan, Journal of Sound and Vibration 275 (2004) 127-149.

    Examples
    --------
    >>> from bridgectl.road import bump
    >>> bump(-5.0, length=1.0, height=0.030).rise_at([-5, -4.75, -4.5, -4]).round(4)
    array([0.   , 0.015, 0.03 , 0.   ])
    """
    rise = check.number("height", height, unit="m")
    return _cosine("bump", x, length, ("height", rise), rise)


@documented
def settlement(length: float, depth: float, *, x: float = 0.0, shape: str = "linear") -> RoadEvent:
    """Return the settlement of an approach: the embankment has sunk by `depth`, the bridge has not.

    The approach slab of `length` climbs from the embankment to the abutment at `x`. The event is 0
    before the slab, rises to `depth` at the abutment and stays there. Only the datum differs from a
    road that sinks by `depth` before the slab: a crossing starts level wherever it starts.

    Parameters
    ----------
    length : float
        Length of the approach slab [m], typically 6 to 12 m.
    depth : float
        Settlement of the embankment [m], 0 or more.
    x : float, optional
        Station of the abutment, where the slab ends [m].
    shape : {'linear', 'parabolic'}, optional
        'linear': a rigid slab that has tilted. 'parabolic': at a distance s before the abutment
        the road lies depth (1 - (1 - s / length)^2) too low. This is steepest at the abutment, with
        75 % of the settlement in the half of the slab nearest to it, and drawn with 17 points,
        within 1e-3 of the depth.

    {event}

    References
    ----------
    J.-L. Briaud, R. W. James, S. B. Hoffman, Settlement of bridge approaches (the bump at the end
    of the bridge), NCHRP Synthesis 234, Transportation Research Board, 1997.

    Examples
    --------
    >>> from bridgectl.road import settlement
    >>> settlement(12.0, 0.040, shape="parabolic").rise_at([-12, -6, 0, 25])
    array([0.  , 0.01, 0.04, 0.04])
    """
    parabolic = check.choice("shape", shape, ("linear", "parabolic")) == "parabolic"
    abutment = check.number("x", x, unit="m")
    slab = check.positive("length", length, unit="m")
    fall = check.not_negative("depth", depth, unit="m")
    order, pieces = (2, PARABOLA_PIECES) if parabolic else (1, 1)
    _require_length(("depth", fall), ("length", slab), MAX_SLOPE / order)
    along = np.linspace(0.0, 1.0, pieces + 1)
    stations = abutment - slab * (1.0 - along)
    return RoadEvent(stations, fall * along**order, _label("settlement", fall, abutment))


def _rise(what: str, x: float, height: float, over: tuple[str, float]) -> RoadEvent:
    start = check.number("x", x, unit="m")
    rise = check.number("height", height, unit="m")
    length = check.positive(*over, unit="m")
    _require_length(("height", rise), over, MAX_SLOPE)
    return RoadEvent([start, start + length], [0.0, rise], _label(what, rise, start))


def _cosine(what: str, x: float, length: float, named: tuple[str, float], rise: float) -> RoadEvent:
    start = check.number("x", x, unit="m")
    whole = check.positive("length", length, unit="m")
    _require_length(named, ("length", whole), MAX_SLOPE / np.pi)
    along = np.linspace(0.0, 1.0, COSINE_PIECES + 1)
    heights = rise * np.sin(np.pi * along) ** 2
    heights[-1] = 0.0  # not the round-off of sin(pi)
    return RoadEvent(start + whole * along, heights, _label(what, named[1], start))


def _label(what: str, height: float, x: float) -> str:
    return f"{what} of {1e3 * height:.6g} mm at {x:.6g} m"


def _require_length(height: tuple[str, float], over: tuple[str, float], ratio: float) -> None:
    """Refuse more height [m] than `ratio` of the length [m] it is reached over."""
    if abs(height[1]) <= ratio * over[1] + SAME_PLACE:
        return
    enough = math.ceil(1e3 * abs(height[1]) / ratio) / 1e3
    raise ValueError(
        f"{height[0]} = {height[1]:g} m with {over[0]} = {over[1]:g} m is steeper than "
        f"{MAX_SLOPE:g} m/m: type {over[0]}={enough:.10g} or more, or {height[0]}="
        f"{1e-3 * height[1]:g} if it was in millimetres"
    )
