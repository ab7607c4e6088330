"""Local road events, such as a bump or a joint: changes of elevation that add to a road.

An event is a piecewise linear change of elevation, positive *up* like the road's, so that adding it
to a road is exact. `bridgectl.road.shapes` makes the usual ones.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from bridgectl import _checks as check
from bridgectl._checks import FloatArray
from bridgectl._places import SAME_PLACE
from bridgectl.road.limits import MAX_SLOPE, first_too_steep
from bridgectl.road.profile import RoadProfile


@dataclass(frozen=True, init=False, repr=False, eq=False)
class RoadEvent:
    """A local change of a road's elevation: 0 before it, straight between its stations.

    Events are equal when their stations and rises are; the label is only for messages.

    Attributes
    ----------
    x : ndarray, shape (n,)
        Two stations [m] or more, each more than 1e-9 m past the one before it.
    rise : ndarray, shape (n,)
        Change of elevation [m], positive up; it begins with 0 and stays as it is after the last.
    """

    x: FloatArray
    rise: FloatArray
    label: str = ""

    def __init__(self, x: ArrayLike, rise: ArrayLike, label: str = "") -> None:
        if not isinstance(label, str):
            raise TypeError(f'label must be a string, got {label!r}: type for example "joint"')
        stations = check.array("x", x, (None,), unit="m")
        rises = check.array("rise", rise, (None,), unit="m")
        _require_event(stations, rises)
        object.__setattr__(self, "x", stations)
        object.__setattr__(self, "rise", rises)
        object.__setattr__(self, "label", label)

    def __reduce__(self) -> tuple[Callable[..., RoadEvent], tuple[FloatArray, FloatArray, str]]:
        """Pickle by rebuilding, since unpickled arrays would be writable."""
        return type(self), (self.x, self.rise, self.label)

    def __repr__(self) -> str:
        return (
            f"RoadEvent({self.label!r}, {self.x.size} points, {_range(self.x)}, rise from "
            f"{self.rise.min():.6g} m to {self.rise.max():.6g} m)"
        )

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, RoadEvent):
            return NotImplemented
        return np.array_equal(self.x, other.x) and np.array_equal(self.rise, other.rise)

    def __hash__(self) -> int:
        return hash((self.x.size, *self.x[[0, -1]], float(self.rise.sum())))

    def rise_at(self, x: ArrayLike) -> FloatArray:
        """Return the change of elevation [m], positive up, at stations [m] of any shape."""
        return np.asarray(np.interp(np.asarray(x, dtype=np.float64), self.x, self.rise))


def add_events(road: RoadProfile, *events: RoadEvent) -> RoadProfile:
    """Return the road with events on it.

    Its stations are those of the road and of the events, and at each of them the elevation is the
    sum, so that the result is road plus events everywhere. A point of an event within 1e-9 m of a
    station is merged into that station.

    Parameters
    ----------
    road : RoadProfile
        The road without the events; it gives the name.
    events : RoadEvent
        The events, in any order. They may overlap.

    Returns
    -------
    RoadProfile

    Raises
    ------
    TypeError
        If `road` is not a RoadProfile, or one of `events` not a RoadEvent.
    ValueError
        If an event is not on the road from its first point to its last, or the sum is anywhere
        steeper than 1 m/m.

    Examples
    --------
    >>> from bridgectl import RoadProfile
    >>> from bridgectl.road import add_events, bump, step
    >>> smooth = RoadProfile([-100, 25], [0, 0], name="smooth")
    >>> add_events(smooth, step(0.0, 0.020), bump(-5.0, length=1.0, height=0.030))
    RoadProfile('smooth', 55 points, x from -100 m to 25 m, elevation from 0 m to 0.03 m, steps \
0.02 to 95 m)
    """
    require_road(road)
    for i, event in enumerate(events):
        _require_on_road(road, event, i)
    if not events:
        return road
    stations = _union(road.x, np.concatenate([event.x for event in events]))
    elevation = road.elevation_at(stations) + sum(event.rise_at(stations) for event in events)
    _require_gentle_sum(stations, elevation, events)
    return road._like(stations, np.asarray(elevation))


def require_road(road: object) -> None:
    """Raise a TypeError for what is no road."""
    if not isinstance(road, RoadProfile):
        raise TypeError(
            f"road must be a RoadProfile, got {type(road).__name__}: type for example "
            "RoadProfile([-100, 25], [0, 0])"
        )


def _range(x: FloatArray) -> str:
    return f"x from {x[0]:.10g} m to {x[-1]:.10g} m"


def _require_event(x: FloatArray, rise: FloatArray) -> None:
    if x.size < 2 or x.size != rise.size:
        raise ValueError(
            f"x and rise must have one length of at least 2, got {x.size} and {rise.size} values: "
            "give one rise [m] for every station [m]"
        )
    if not np.all(np.diff(x) > SAME_PLACE):
        i = int(np.argmin(np.diff(x) > SAME_PLACE)) + 1
        raise ValueError(
            f"x must increase by more than {SAME_PLACE:g} m, but x[{i}] = {x[i]:.10g} m follows "
            f"x[{i - 1}] = {x[i - 1]:.10g} m: sort the points and remove repeated ones"
        )
    if rise[0] != 0:
        raise ValueError(
            f"rise must begin with 0, got rise[0] = {rise[0]:g} m: the road has no vertical face, "
            "so add a station before it where the event begins"
        )
    if (i_steep := first_too_steep(x, rise)) is not None:
        raise ValueError(
            f"rise[{i_steep}] = {rise[i_steep]:.6g} m at x = {x[i_steep]:.10g} m is reached by a "
            f"slope above {MAX_SLOPE:g} m/m: move the stations apart, or type the rises in metres"
        )


def _require_on_road(road: RoadProfile, event: object, i: int) -> None:
    if not isinstance(event, RoadEvent):
        raise TypeError(
            f"events must each be a RoadEvent, got {type(event).__name__}: type for example "
            "add_events(road, step(0.0, 0.020)), or add_events(road, *events) for a list"
        )
    first, last = float(event.x[0]), float(event.x[-1])
    if not road.covers(first, last):
        name = event.label or f"event {i + 1}"
        raise ValueError(
            f"{name} lies at {_range(event.x)}, but the road covers {_range(road.x)}: place the "
            "event in this range or pass a longer road"
        )


def _require_gentle_sum(
    x: FloatArray, elevation: FloatArray, events: tuple[RoadEvent, ...]
) -> None:
    if (i := first_too_steep(x, elevation)) is None:
        return
    here = [e.label for e in events if e.label and e.x[0] < x[i] and e.x[-1] > x[i - 1]]
    raise ValueError(
        f"the road with its events is steeper than {MAX_SLOPE:g} m/m from x = {x[i - 1]:.10g} m to "
        f"{x[i]:.10g} m{' (' + ', '.join(here) + ')' if here else ''}: place the events apart, or "
        "make them lower or longer"
    )


def _union(stations: FloatArray, points: FloatArray) -> FloatArray:
    """Stations and the points farther than SAME_PLACE from each of them, each point once."""
    points = np.unique(points)
    after = np.searchsorted(stations, points)
    to_next = np.abs(stations[np.minimum(after, stations.size - 1)] - points)
    to_last = np.abs(points - stations[np.maximum(after - 1, 0)])
    points = points[np.minimum(to_next, to_last) > SAME_PLACE]
    points = points[np.diff(points, prepend=-np.inf) > SAME_PLACE]
    return np.sort(np.concatenate([stations, points]))
