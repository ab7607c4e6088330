"""Vehicles from bodies and axles: every matrix is a sum of outer products of what is displaced.

With the displacement p of a place as a row over the coordinates, a mass there adds m p' p to M, and
a spring or damper between two places k p' p or c p' p of the difference of theirs.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from bridgectl import _checks
from bridgectl._checks import FloatArray
from bridgectl._plausible import judge_truck
from bridgectl.model.trucks.parts import Axle, Body
from bridgectl.model.vehicle import Vehicle

OVERHANG = 0.8
"""How far a body is drawn beyond its first and last axle, at most [m]."""


def rigid(body: Body) -> Vehicle:
    """Return a truck of one body on two axles or more.

    Parameters
    ----------
    body : Body
        The body with its axles, or groups of axles.

    Returns
    -------
    Vehicle
        Coordinates: 'yB' [m] of the body's centre of gravity, 'thB' [rad], positive where the rear
        goes down, 'yG1', ... of the axles and groups, and 'thG1', ... of groups.

    Raises
    ------
    TypeError, ValueError
        If there are fewer than two axles or groups, or one would have to be held down.

    Warns
    -----
    PlausibilityWarning
        If no truck moves so fast or slowly on its axles.

    Examples
    --------
    >>> import bridgectl as bc
    >>> front = bc.trucks.Axle(-3.0, 700, 4e5, 1.75e6, damping=1e4)
    >>> tandem = bc.trucks.Axle(
    ...     1.5, 2000, 1.6e6, 3.5e6, damping=3e4, spread=(-0.65, 0.65), inertia=300
    ... )
    >>> truck = bc.trucks.rigid(bc.trucks.Body(18e3, 6e4, [front, tandem]))
    >>> truck.coordinates, truck.damper_names
    (('yB', 'thB', 'yG1', 'yG2', 'thG2'), ('front', 'rear'))
    >>> (truck.static_loads / 1e3).round(1)
    array([65.7, 68.7, 68.7])
    """
    _require_body("body", body, 2)
    truck = _assembled([body], ())
    judge_truck(truck)
    return truck


def articulated(tractor: Body, trailer: Body, hinge: Sequence[float]) -> Vehicle:
    """Return a tractor and its semi-trailer, which rests on it.

    Parameters
    ----------
    tractor, trailer : Body
        The bodies with their axles; the tractor has two or more.
    hinge : (float, float)
        Place of the hinge on the tractor and on the trailer [m], each in the coordinate of that
        body's axles: (3, -5) is 3 m behind the one's origin and 5 m ahead of the other's.

    Returns
    -------
    Vehicle
        Coordinates: 'yB1', 'thB1' and 'thB2' of the bodies, then as in `rigid`.

    Raises
    ------
    TypeError, ValueError
        If the hinge is ahead of the tractor or behind the trailer's first axle, or an axle would
        have to be held down.

    Warns
    -----
    PlausibilityWarning
        If no truck moves so fast or slowly on its axles.

    Examples
    --------
    >>> import bridgectl as bc
    >>> steer = bc.trucks.Axle(-1, 750, 6e6, 1.75e6, damping=1e4, name="steer")
    >>> drive = bc.trucks.Axle(3.5, 750, 6e6, 1.75e6, damping=1e4, name="drive")
    >>> rear = [bc.trucks.Axle(d, 1100, 1e7, 3.5e6, damping=2e4) for d in (2, 3.2, 4.4)]
    >>> tractor = bc.trucks.Body(3100, 5e3, [steer, drive])
    >>> trailer = bc.trucks.Body(2e4, 12e4, rear)
    >>> truck = bc.trucks.articulated(tractor, trailer, hinge=(3, -5))
    >>> (truck.static_loads / 1e3).round(1)
    array([39.1, 78.8, 65.1, 52. , 38.8])
    """
    _require_body("tractor", tractor, 2)
    _require_body("trailer", trailer, 1)
    places = _checks.array("hinge", hinge, (2,), unit="m").tolist()
    first, behind = tractor.tire_places[0], trailer.tire_places[0]
    if places[0] <= first:
        raise ValueError(
            f"hinge must be behind the tractor's first axle, which is at {first:g} m, got "
            f"hinge[0] = {places[0]:g} m: places are positive backward"
        )
    if places[1] >= behind:
        raise ValueError(
            f"hinge must be ahead of the trailer's first axle, which is at {behind:g} m, got "
            f"hinge[1] = {places[1]:g} m: places are positive backward, for 5 m ahead type -5"
        )
    truck = _assembled([tractor, trailer], tuple(places))
    judge_truck(truck)
    return truck


def half_car(
    body_mass: float,
    inertia: float,
    places: ArrayLike,
    axle_mass: ArrayLike,
    suspension_stiffness: ArrayLike,
    tire_stiffness: ArrayLike,
    damping: ArrayLike = 0.0,
    tire_damping: ArrayLike = 0.0,
    height: float = 0.0,
) -> Vehicle:
    """Return a truck of two axles from numbers: heave and pitch of the body, bounce of the axles.

    Parameters
    ----------
    body_mass, inertia : float
        Of the body: mass [kg] and pitch moment of inertia [kg m^2].
    places : array_like, shape (2,)
        Of the axles behind the body's centre of gravity [m], as (-2.5, 2.5).
    axle_mass, suspension_stiffness, tire_stiffness, damping, tire_damping : float or array_like
        Of both axles, or of the front one and the rear one, shape (2,): [kg], [N/m], [N/m],
        [N s/m] and [N s/m]. Default: no damping.
    height : float, optional
        Of the body's centre of gravity above the road [m]. Without one a truck does not pitch as it
        brakes.

    Returns
    -------
    Vehicle
        See `rigid`.

    Raises
    ------
    TypeError, ValueError
        If a number is out of range, or an axle would have to be held down.

    Warns
    -----
    PlausibilityWarning
        If no truck moves so fast or slowly on its axles.

    Examples
    --------
    >>> import bridgectl as bc
    >>> truck = bc.trucks.half_car(10500, 5e4, (-2.5, 2.5), 900, 6e6, 1.75e6, damping=1e4)
    >>> truck.frequencies.round(2)
    array([ 2.43,  2.74, 15.53, 15.77])
    """
    where = _checks.array("places", places, (2,), unit="m").tolist()
    given = {
        "mass": ("axle_mass", axle_mass, "kg"),
        "suspension_stiffness": ("suspension_stiffness", suspension_stiffness, "N/m"),
        "tire_stiffness": ("tire_stiffness", tire_stiffness, "N/m"),
        "damping": ("damping", damping, "N s/m"),
        "tire_damping": ("tire_damping", tire_damping, "N s/m"),
    }
    numbers: dict[str, Any] = {key: _two(*value) for key, value in given.items()}
    axles = [
        Axle(place, **{key: values[i] for key, values in numbers.items()})
        for i, place in enumerate(where)
    ]
    truck = rigid(Body(body_mass, inertia, axles, height=height))
    judge_truck(truck)
    return truck


def _two(name: str, value: ArrayLike, unit: str) -> list[float]:
    """A number for each of two axles, from one for both or two."""
    if np.ndim(value) == 0:
        return [_checks.number(name, value, unit=unit)] * 2
    return _checks.array(name, value, (2,), unit=unit).tolist()


def _require_body(name: str, body: Any, least: int) -> None:
    if not isinstance(body, Body):
        raise TypeError(
            f"{name} must be a bridgectl.trucks.Body, got {type(body).__name__}: type "
            "Body(mass, inertia, [front, rear])"
        )
    if len(body.axles) < least:
        raise ValueError(
            f"{name} must have two axles or groups of axles, or it has nothing to stand on, got "
            f"{len(body.axles)}; for one wheel type bridgectl.QuarterCar"
        )


class _Frame:
    """Coordinates of a truck of bodies, and what is displaced as rows over them."""

    def __init__(self, bodies: Sequence[Body], hinge: Sequence[float]) -> None:
        self.bodies, self.hinge = bodies, hinge
        self.axles = [axle for body in bodies for axle in body.axles]
        self.places = [body.tire_places for body in bodies]
        tags = [""] if len(bodies) == 1 else [str(i + 1) for i in range(len(bodies))]
        self.names = ["yB" + tags[0], *("thB" + tag for tag in tags)]
        for i, axle in enumerate(self.axles, start=1):
            self.names += [f"yG{i}", *([f"thG{i}"] if axle.inertia else [])]
        self._units = dict(zip(self.names, np.eye(len(self.names)), strict=True))
        # Of each body a place and its row: the trailer hangs on the tractor's hinge.
        self._known = [(bodies[0].centre, self.unit(self.names[0]))]
        if hinge:
            self._known.append((hinge[1], self.at(0, hinge[0])))

    def unit(self, name: str) -> FloatArray:
        """The row of a coordinate."""
        return self._units[name]

    def pitch(self, i: int) -> FloatArray:
        """The row of the pitch of a body."""
        return self.unit(self.names[1 + i])

    def at(self, i: int, place: float) -> FloatArray:
        """The row of a place of a body."""
        known, row = self._known[i]
        return row + (place - known) * self.pitch(i)

    def behind(self, i: int, place: float) -> float:
        """How far a place of a body is behind the first axle [m]."""
        first = self.places[0][0]
        return place - first if i == 0 else self.hinge[0] - first + place - self.hinge[1]

    def hubs(self, number: int) -> list[FloatArray]:
        """The rows of the hubs of an axle or group, counted from 1."""
        axle, centre = self.axles[number - 1], self.unit(f"yG{number}")
        if not axle.inertia:
            return [centre]
        return [centre + apart * self.unit(f"thG{number}") for apart in axle.spread]

    def ends(self, i: int) -> tuple[float, float]:
        """Places where a body is drawn to begin and end [m]; a trailer begins at the hinge."""
        places = self.places[i]
        first = places[0] - OVERHANG if i == 0 else self.hinge[1]
        last = places[-1] + OVERHANG
        return first, max(last, self.hinge[0]) if i == 0 and self.hinge else last


def _assembled(bodies: Sequence[Body], hinge: Sequence[float]) -> Vehicle:
    """Put the vehicle together; a tire without load is told by the name of its axle."""
    frame = _Frame(bodies, hinge)
    under = [i for i, body in enumerate(bodies) for _ in body.axles]
    numbers = range(1, len(under) + 1)
    tops = np.array([frame.at(i, axle.place) for i, axle in zip(under, frame.axles, strict=True)])
    feet = np.array([frame.unit(f"yG{number}") for number in numbers])
    legs = tops - feet
    masses = [(body.mass, frame.at(i, body.centre)) for i, body in enumerate(bodies)]
    masses += [(body.inertia, frame.pitch(i)) for i, body in enumerate(bodies)]
    masses += [(axle.mass, foot) for axle, foot in zip(frame.axles, feet, strict=True)]
    masses += [
        (axle.inertia, frame.unit(f"thG{number}"))
        for number, axle in zip(numbers, frame.axles, strict=True) if axle.inertia
    ]  # fmt: skip
    dampings = [axle.damping for axle in frame.axles]
    stiffnesses = [axle.suspension_stiffness for axle in frame.axles]
    offsets = [frame.behind(i, place) for i, places in enumerate(frame.places) for place in places]
    order = np.flatnonzero(np.diff(offsets) <= 0)
    if order.size:
        raise ValueError(
            f"hinge puts the trailer's first axle {-np.diff(offsets)[order[0]]:g} m ahead of the "
            "tractor's last one: move it back on the tractor, or forward on the trailer"
        )
    names = _damper_names(frame.axles)
    drawn = [frame.ends(i) for i in range(len(bodies))]
    try:
        return Vehicle(
            mass_matrix=_sum(*zip(*masses, strict=True)),
            damping_matrix=_sum(dampings, legs),
            stiffness_matrix=_sum(stiffnesses, legs),
            tire_stiffnesses=[each for axle in frame.axles for each in axle.tire_stiffnesses],
            tire_offsets=offsets,
            tire_map=[hub for number in numbers for hub in frame.hubs(number)],
            damper_map=legs,
            heave=[float(name.startswith("y")) for name in frame.names],
            coordinates=frame.names,
            damper_axles=feet,
            damper_dampings=dampings,
            damper_names=names,
            tire_damping=[each for axle in frame.axles for each in axle.tire_dampings],
            pitch_input=sum(b.mass * b.height * frame.pitch(i) for i, b in enumerate(bodies)),
            body_places=[[frame.behind(i, end) for end in ends] for i, ends in enumerate(drawn)],
            body_map=[[frame.at(i, end) for end in ends] for i, ends in enumerate(drawn)],
        )
    except _checks.UnloadedTireError as error:
        raise ValueError(_unloaded(error.loads, names, frame.axles, bool(hinge))) from None


def _sum(values: Sequence[float], rows: Sequence[FloatArray] | FloatArray) -> FloatArray:
    """Sum of outer products of rows, each times a value."""
    stacked = np.array(rows)
    return np.asarray(stacked.T @ (np.array(values)[:, np.newaxis] * stacked))


def _damper_names(axles: Sequence[Axle]) -> list[str]:
    usual = ["front", "rear"] if len(axles) == 2 else [f"axle_{i + 1}" for i in range(len(axles))]
    names = [axle.name or name for axle, name in zip(axles, usual, strict=True)]
    for name in names:
        if names.count(name) > 1:
            raise ValueError(f"axles must have different names, got {name!r} twice: rename one")
    return names


def _unloaded(loads: FloatArray, names: list[str], axles: Sequence[Axle], hinged: bool) -> str:
    """Tell which axle would be lifted, and what decides it."""
    of = [name for name, axle in zip(names, axles, strict=True) for _ in axle.spread]
    worst = int(loads.argmin())
    remedy = "the hinge, or the centre of gravity of a body" if hinged else "the centre of gravity"
    return (
        f"axle {of[worst]!r} would carry {loads[worst] / 1e3:.4g} kN, and every tire needs a load "
        f"above 0: move {remedy}"
    )
