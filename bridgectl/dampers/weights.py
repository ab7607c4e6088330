"""What ride, travel and tire forces cost beside the peak: one square of states and damper forces.

Bridgehook, and whatever else looks for the least peak, may count them in. With weights, the cost of
a crossing is its peak over the static peak and, in the mean over its time and over the legs (tires)
of the vehicle::

    J = DAF + E[ride (y_s'' / a)^2 + travel (d / b)^2 + tire_force (R / W - 1)^2]

y_s'' is the acceleration of the body at a leg, d the travel of its suspension, R the force of a
tire and W its static load; a = 1 m/s^2 and b = 10 mm make all of one size: what a truck on a good
road feels is some 0.1 to 0.5 of each. A weight is the DAF that one is ready to give up for that.
The mean is over the time T from `REACH` before the bridge to its end, in which bridgehook acts.

All of it is one square of the vehicle's states z and the damper forces F, which y_s'' holds::

    |S z + G F + H u|^2 / T  per time,  z' = A z + B F + ...

u is the drop of the surface, bridge and road, under each tire; 0 where z is measured from it.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from scipy.linalg import solve_continuous_lyapunov

from bridgectl import _checks as check
from bridgectl._checks import FloatArray
from bridgectl.dampers.costate import REACH
from bridgectl.dampers.legs import Legs
from bridgectl.model.bridge import BridgeModel
from bridgectl.model.quarter_car import QuarterCar
from bridgectl.model.vehicle import Vehicle

ACCELERATION = 1.0
"""a [m/s^2]."""

TRAVEL = 0.01
"""b [m]."""


class Weights(NamedTuple):
    """Weights of ride, travel and tire force, in DAF; all 0 for the peak alone."""

    ride: float = 0.0
    travel: float = 0.0
    tire_force: float = 0.0


def checked_weights(ride: float, travel: float, tire_force: float) -> Weights:
    """Check weights by the names of arguments."""
    given = {"ride": ride, "travel": travel, "tire_force": tire_force}
    return Weights(*(check.not_negative(name, value) for name, value in given.items()))


class SideCost(NamedTuple):
    """The square |states z + forces F + drops u|^2 of n states, D damper forces and T tires."""

    states: FloatArray
    """S, shape (K, n)."""
    forces: FloatArray
    """G, shape (K, D) [1/N]."""
    drops: FloatArray
    """H, shape (K, T) [1/m]."""

    def rate(
        self, states: FloatArray, forces: FloatArray, drops: FloatArray | None = None
    ) -> FloatArray:
        """Return the square: of arrays (..., n), (..., D) and (..., T) one of shape (...)."""
        parts = states @ self.states.T + forces @ self.forces.T
        if drops is not None:
            parts = parts + drops @ self.drops.T
        return np.asarray((parts**2).sum(axis=-1))

    def with_dampings(self, vehicle: Vehicle, dampings: FloatArray) -> FloatArray:
        """Return S + G C V, (K, n): with forces of dampings C [N s/m], (D,), of velocities V z."""
        return self.states + self.forces @ (dampings[:, np.newaxis] * Legs(vehicle).rate)


def side_cost(vehicle: Vehicle | QuarterCar, weights: Weights) -> SideCost:
    """Return the square of a vehicle whose controlled dampers give nothing but the forces F.

    >>> import numpy as np
    >>> import bridgectl as bc
    >>> from bridgectl.dampers.weights import Weights, side_cost
    >>> cost = side_cost(bc.li2006.car(), Weights(ride=1.0, travel=0.5))
    >>> sunk = np.array([0.01, 0, 0, 0])  # (80 kN/m x 10 mm / 9 t)^2 + 0.5
    >>> print(cost.rate(sunk, np.zeros(1)).round(3))
    0.508
    """
    free = vehicle.linear.undamped
    legs, a = Legs(free), free.state_matrix_on_tires()
    relative = free.tire_stiffnesses / free.static_loads
    none, n_tires = np.zeros((len(legs.travel), len(legs.travel))), free.n_tires
    parts = [
        (weights.ride / ACCELERATION**2, legs.body @ a, legs.body @ free.damper_input,
         legs.body @ free.road_input),
        (weights.travel / TRAVEL**2, legs.travel, none, np.zeros((len(none), n_tires))),
        (weights.tire_force, relative[:, np.newaxis] * free.leading_hubs,
         np.zeros((n_tires, len(none))), -np.diag(relative)),
    ]  # fmt: skip
    scales = [np.sqrt(weight / len(rows)) for weight, rows, *_ in parts]
    return SideCost(*(
        np.vstack([scale * part[k] for scale, part in zip(scales, parts, strict=True)])
        for k in (1, 2, 3)
    ))  # fmt: skip


def crossing_time(beam: BridgeModel, speed: float) -> float:
    """Time T [s] over which the square counts, at a speed [m/s]."""
    return (REACH + beam.length) / speed


def cost_to_go(vehicle: Vehicle, cost: SideCost, dampings: FloatArray) -> FloatArray:
    """Return X [s], (n, n): z' X z is what the square adds up to from z on with dampings (D,).

    On a rigid level road, from which z is measured, for all time::

        A' X + X A + S' S = 0,  A and S with the dampings [N s/m]
    """
    legs, free = Legs(vehicle), vehicle.undamped
    a = free.state_matrix_on_tires() + free.damper_input @ (dampings[:, np.newaxis] * legs.rate)
    s = cost.with_dampings(vehicle, dampings)
    return np.asarray(solve_continuous_lyapunov(a.T, -s.T @ s))
