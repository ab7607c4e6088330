"""What a picture of a vehicle consists of, found from its maps: bodies, legs, hinges, tires.

A leg stands on a weighted mean of the tires' hubs, and its place is the same mean of theirs: of one
axle its own tire, of a group what is between. It belongs to the body whose line, from end to end,
passes through its top. Where a vehicle tells no bodies, there is a box at each tire.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from bridgectl._checks import FloatArray
from bridgectl.plots.shown import VehicleShown

BOX = 0.8
"""Width of a box at a tire, of what is free between it and the next, at most."""


class Leg(NamedTuple):
    """A suspension: its place behind the reference tire [m], shares of the tires, and its body."""

    place: float
    shares: FloatArray
    body: int | None


class DrawnBody(NamedTuple):
    """A body from front to rear [m behind the reference tire], and that on which it is hinged."""

    front: float
    rear: float
    on: int | None
    tire: int | None
    """The tire of a box."""


class Parts(NamedTuple):
    """Everything of a vehicle that is drawn."""

    tires: FloatArray
    bodies: list[DrawnBody]
    legs: list[Leg]


def parts_of(vehicle: VehicleShown, box: float) -> Parts:
    """Find the parts of a vehicle; boxes at tires are at most so wide [m]."""
    hubs, tires = vehicle.tire_map, vehicle.tire_offsets
    shares = [np.linalg.lstsq(hubs.T, row, rcond=None)[0] for row in vehicle.damper_axles]
    places = [float(share @ tires) for share in shares]
    if not len(vehicle.body_places):
        apart = np.diff(np.unique(tires))
        half = min(box, BOX * float(apart.min())) / 2 if apart.size else box / 2
        bodies = [DrawnBody(d - half, d + half, None, i) for i, d in enumerate(tires.tolist())]
        on = [int(np.argmax(share)) for share in shares]
        return Parts(tires, bodies, list(map(Leg, places, shares, on)))
    lines = list(zip(vehicle.body_places, vehicle.body_map, strict=True))
    tops = vehicle.damper_map + vehicle.damper_axles
    legs = [
        Leg(place, share, _carrier(place, top, lines))
        for place, share, top in zip(places, shares, tops, strict=True)
    ]
    bodies = [
        DrawnBody(*ends.tolist(), _carrier(ends[0], rows[0], lines[:i]), None)
        for i, (ends, rows) in enumerate(lines)
    ]
    return Parts(tires, bodies, legs)


def _carrier(
    place: float, row: FloatArray, lines: list[tuple[FloatArray, FloatArray]]
) -> int | None:
    """The body that moves at a place as a row says."""
    for i, (ends, rows) in enumerate(lines):
        there = rows[0] + (place - ends[0]) / (ends[1] - ends[0]) * (rows[1] - rows[0])
        if np.allclose(there, row, rtol=0, atol=1e-6):
            return i
    return None
