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
        self.table = -np.interp(plant.nodes, road.x, road.elevation)[np.newaxis]
        self.most = max(1, round(preview / plant.width))
        self.elevations = ca.MX.sym("elevations", 0)

    def drops(self, index: Any, share: Any, begin: int, size: int) -> Any:
        """Drops [m], (1, size)."""
        here = read(self.table, index, share, 1)
        if begin + 1 >= self.most:
            return ca.repmat(read(self.table, index + self.most, share, 1) - here, 1, size)
        drops = read(self.table, index + begin + 1, share, size)
        known = np.minimum(np.arange(size), self.most - begin - 1)
        return drops[:, known.tolist()] - here
