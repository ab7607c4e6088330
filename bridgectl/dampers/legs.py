"""The legs of a vehicle: what the controller of each damper sees of the motion.

A leg is a controlled damper with its two ends, the body's and the axle's, and the tires under it. A
law measures at its leg what it would at a quarter-car.
"""

from __future__ import annotations

from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from bridgectl import _checks as check
from bridgectl._checks import FloatArray
from bridgectl.model.quarter_car import QuarterCar
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

    @cached_property
    def reading(self) -> FloatArray:
        """Body, axle and suspension velocity, travel, and what accelerations owe to the states.

        One after the other, each of all legs, the accelerations of bodies and axles: (6 D, n).
        """
        free = np.vstack([self.body, self.axle]) @ self.vehicle.state_matrix
        return np.vstack([self.body, self.axle, self.rate, self.travel, free])

    @cached_property
    def per_tire(self) -> FloatArray:
        """Accelerations of bodies, then axles, per tire force [1/kg], (2 D, T)."""
        return np.asarray(np.vstack([self.body, self.axle]) @ self.vehicle.tire_input)

    @cached_property
    def per_damper(self) -> FloatArray:
        """Accelerations of bodies, then axles, per damper force [1/kg], (2 D, D)."""
        return np.asarray(np.vstack([self.body, self.axle]) @ self.vehicle.damper_input)

    @cached_property
    def _sums(self) -> FloatArray | None:
        """Sums over the tires of each leg, (D, T); None where each leg has its own."""
        return None if np.array_equal(self.tires, np.eye(*self.tires.shape)) else 1.0 * self.tires

    def under(self, tires: FloatArray) -> FloatArray:
        """Of values of tires (S, T, R) the sum over those under each leg, (S, D, R)."""
        return tires if self._sums is None else self._sums @ tires

    @property
    def measured(self) -> FloatArray:
        """Rows of both ends' velocities of each leg, (D, 2, n)."""
        return np.stack([self.body, self.axle], axis=1)

    @cached_property
    def loads(self) -> FloatArray:
        """Static load of the tires under each leg [N], (D,)."""
        return np.asarray(self.tires @ self.vehicle.static_loads)


def require_dampers(vehicle: Vehicle | QuarterCar) -> None:
    """Refuse a vehicle that has no place for a controlled damper."""
    if not isinstance(vehicle, Vehicle | QuarterCar):
        raise TypeError(
            "vehicle must be a bridgectl.Vehicle or QuarterCar, got "
            f"{type(vehicle).__name__}: type for example bridgectl.li2006.car()"
        )
    if not len(vehicle.linear.damper_map):
        raise ValueError(
            "vehicle must have dampers that can be controlled: type damper_map=..., one row each, "
            "its travel by coordinates, and damper_dampings=... for passive ones that are part of "
            "damping_matrix"
        )


def checked_leg(vehicle: Vehicle | QuarterCar, leg: int) -> int:
    """Check which damper of a vehicle is meant, counted from 1."""
    require_dampers(vehicle)
    count = len(vehicle.linear.damper_map)
    if check.integer("leg", leg, at_least=1) > count:
        raise ValueError(f"leg must be one of the {count} dampers of the vehicle, got {leg}")
    return leg
