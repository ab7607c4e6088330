"""The legs of a vehicle: what the controller of each damper sees of the motion.

A leg is a controlled damper with its two ends, the body's and the axle's, and the tires under it. A
law measures at its leg what it would at a quarter-car.
"""

from __future__ import annotations

from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from bridgectl._checks import FloatArray
from bridgectl.model.vehicle import Vehicle


class Legs:
    """Rows that read D controlled dampers and T tires of a vehicle from its n states."""

    def __init__(self, vehicle: Vehicle) -> None:
        self.vehicle = vehicle
        self.names = vehicle.damper_names
        self.body = (vehicle.damper_map + vehicle.damper_axles) @ vehicle.velocities
        """Velocity of each upper end [m/s], (D, n)."""
        self.axle = vehicle.damper_axles @ vehicle.velocities
        """Velocity of each lower end [m/s], (D, n)."""
        self.rate = vehicle.damper_map @ vehicle.velocities
        """Suspension velocity [m/s], (D, n)."""
        self.travel = vehicle.damper_map @ vehicle.displacements
        """Suspension travel [m], (D, n)."""

    @cached_property
    def tires(self) -> NDArray[np.bool_]:
        """Which tires are under each leg, (D, T): each is under the leg whose axle it moves with.

        Legs of one axle share its tires; a tire of an axle without a leg is under none.
        """
        axles, hubs = self.vehicle.damper_axles, self.vehicle.tire_map
        lengths = np.linalg.norm(axles, axis=1, keepdims=True)
        shared = axles @ hubs.T / np.maximum(lengths, np.finfo(float).tiny)
        nearest = shared.max(axis=0, initial=0.0)
        return np.asarray((shared > 0) & (shared >= nearest - 1e-9 * nearest))

    @cached_property
    def offsets(self) -> FloatArray:
        """How far behind the reference tire each leg is [m], (D,): its tires, as a mean."""
        count = np.maximum(self.tires.sum(axis=1), 1)
        return np.asarray(self.tires @ self.vehicle.tire_offsets / count)

    @property
    def measured(self) -> FloatArray:
        """Rows of both ends' velocities of each leg, (D, 2, n)."""
        return np.stack([self.body, self.axle], axis=1)

    @cached_property
    def loads(self) -> FloatArray:
        """Static load of the tires under each leg [N], (D,)."""
        return np.asarray(self.tires @ self.vehicle.static_loads)
