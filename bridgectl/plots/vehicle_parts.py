"""What a picture of a vehicle consists of, found from its maps: bodies, legs, hinges, tires.

A leg stands on a weighted mean of the tires' hubs, and its place is the same mean of theirs: of one
axle its own tire, of a group what is between. It belongs to the body whose line, from end to end,
passes through its top. Over a tire that carries no such body there is a box.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from bridgectl._checks import FloatArray
from bridgectl.plots.shown import VehicleShown

BOX = 0.8
"""Width of a box at a tire, of what is free between it and the next, at most."""


SHARED = 1e-6
"""Share of a leg that a tire has, at least."""


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
    lines = list(zip(vehicle.body_places, vehicle.body_map, strict=True))
    bodies = [
        DrawnBody(float(ends[0]), float(ends[1]), _carrier(ends[0], rows[0], lines[:i]), None)
        for i, (ends, rows) in enumerate(lines)
    ]
    legs = []
    for travel, foot in zip(vehicle.damper_map, vehicle.damper_axles, strict=True):
        shares = np.linalg.lstsq(hubs.T, foot, rcond=None)[0]
        place = float(shares @ tires)
        legs.append(Leg(place, shares, _carrier(place, travel + foot, lines)))
    carried = [np.abs(leg.shares) > SHARED for leg in legs if leg.body is not None]
    bare = np.flatnonzero(~np.any([np.zeros(tires.size, dtype=bool), *carried], axis=0)).tolist()
    boxes = []
    for i in bare:
        apart = np.abs(tires - tires[i])
        half = float(min([box, *BOX * apart[apart > 0]])) / 2
        boxes.append(DrawnBody(float(tires[i]) - half, float(tires[i]) + half, None, i))
    on = {i: len(bodies) + number for number, i in enumerate(bare)}
    legs = [leg if leg.body is not None else leg._replace(body=on.get(int(leg.shares.argmax())))
            for leg in legs]  # fmt: skip
    return Parts(tires, bodies + boxes, legs)


def _carrier(
    place: float, row: FloatArray, lines: list[tuple[FloatArray, FloatArray]]
) -> int | None:
    """The body that moves at a place as a row says."""
    for i, (ends, rows) in enumerate(lines):
        there = rows[0] + (place - ends[0]) / (ends[1] - ends[0]) * (rows[1] - rows[0])
        if np.allclose(there, row, rtol=0, atol=1e-6):
            return i
    return None
