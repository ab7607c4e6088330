"""The road that a prediction goes over: what is known of it ahead, and level beyond.

Each kind gives the drops [m] at the ends of steps, less that under the tire, which are places from
the vehicle on: a whole number of steps, `begin` and more, and one.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import casadi as ca
import numpy as np

from bridgectl.dampers.rollout.plant import Plant
from bridgectl.dampers.rollout.table import read
from bridgectl.road import RoadProfile

FINER = 4
"""Places of a map for each step: its stations, which a step is as long as, are seen so."""


class Seen:
    """Of elevations that are seen at distances ahead [m], straight between them; of none, level."""

    def __init__(self, plant: Plant, distances: Sequence[float]) -> None:
        self.known, self.width = [0.0, *distances], plant.width
        self.elevations = ca.MX.sym("elevations", len(distances))
        """Less that under the tire [m]: an input of the prediction."""

    def drops(self, index: Any, share: Any, begin: int, size: int) -> Any:
        """Drops [m], (1, size)."""
        if len(self.known) == 1:
            return ca.MX(1, size)
        places = self.width * (begin + 1 + np.arange(size))
        if places[0] >= self.known[-1]:
            return ca.repmat(-self.elevations[-1], 1, size)
        shares = np.array([np.interp(places, self.known, unit) for unit in np.eye(len(self.known))])
        return -ca.mtimes(self.elevations.T, ca.sparsify(ca.DM(shares[1:])))


class Mapped:
    """Of a road that is known by its places, so far ahead [m]."""

    def __init__(self, plant: Plant, road: RoadProfile, preview: float) -> None:
        count = len(plant.nodes)
        places = np.interp(np.arange(FINER * count) / FINER, np.arange(count), plant.nodes)
        self.table = -np.interp(places, road.x, road.elevation)[np.newaxis]
        self.steps = preview / plant.width
        self.elevations = ca.MX.sym("elevations", 0)

    def drops(self, index: Any, share: Any, begin: int, size: int) -> Any:
        """Drops [m], (1, size)."""
        known, place = min(max(int(self.steps) - begin, 0), size), index + share
        beyond = ca.repmat(self._drops(place + self.steps, 1), 1, size - known)
        return ca.horzcat(self._drops(place + begin + 1, known), beyond) - self._drops(place, 1)

    def _drops(self, place: Any, size: int) -> Any:
        """Of places, in steps behind the first node, from one on."""
        if size == 0:
            return ca.MX(1, 0)
        first = ca.floor(FINER * place)
        return read(self.table, first, FINER * place - first, size, FINER)
