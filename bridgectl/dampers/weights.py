"""What ride, travel and tire forces cost beside the peak: one square of states and damper forces.

With weights, the cost of a crossing is its peak over the static peak and, in the mean over its time
T, its dampers' legs and its tires::

    J = DAF + E[ride (y_s'' / a)^2 + travel (d / b)^2 + tire_force (R / W - 1)^2]

y_s'' is the acceleration of the body at a leg, d the travel of the suspension there, R the force of
a tire and W its static load; a = 1 m/s^2 and b = 10 mm make all of a size: on a good road they are
some 0.1, 0.5 and 0.05. A weight is the DAF that one is ready to give up for one unit. T begins
`REACH` before the bridge and ends with it: there bridgehook acts.

With z the states of the vehicle, F the forces of its dampers, which y_s'' holds, and u the drop of
the surface under each tire, 0 where z is measured from it, that is one square::

    |S z + G F + H u|^2 / T per time,   z' = A z + B F + ...

What a force is worth to it is seen from the passive vehicle, F = C v, v = V z. From z on that
would come to z' X z / T, on a level road::

    (A + B C V)' X + X (A + B C V) + P' P = 0,   P = S + G C V

A damper that goes on choosing leaves less of it than the passive one, and more than an active force
would, which for the ride alone leaves nothing: `SHARE` of it. A force that now is f beyond the
passive damper's changes the cost, per time, by::

    r z f + q f^2,   r = (2 / T) (SHARE B' X + G' P),   q = G' G / T

and r z, as is to be expected of z, adds to sigma, what a force is worth to the peak. In all the
best damping is the least of a parabola, within the bounds, c_p that of the passive damper::

    c = c_p - sigma / (2 q v)

With no weight on the ride q is 0, and c at one of its bounds: c_max where sigma v < 0. With one, c
that were always at a bound would have, at the same ride, higher mean DAFs. The road is
white as in `bridgectl.dampers.peak_value`, z is its deviation from a smooth road's crossing, and
the other legs have their passive dampings. The velocities of its own leg tell a damper enough of
z: with the travel measured too, hardly a mean DAF at the same ride was lower.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import casadi as ca
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

SHARE = 0.5
"""Of what the passive vehicle's motion would yet cost, what it costs with a damper that chooses.

Chosen for the mean DAF at the same ride, some 1.3 times the passive one, on roads of class A and B,
where 1 has a higher one, and for J: with large weights on rough roads more than a half is left.
"""


class Weights(NamedTuple):
    """Weights of ride, travel and tire force, in DAF; all 0 for the peak alone."""

    ride: float = 0.0
    travel: float = 0.0
    tire_force: float = 0.0


PEAK_ALONE = Weights()


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
    legs, n_tires = Legs(free), free.n_tires
    relative, none = free.tire_stiffnesses / free.static_loads, np.zeros((len(legs.travel),) * 2)
    parts = [
        (weights.ride / ACCELERATION**2, legs.body @ free.state_matrix_on_tires(),
         legs.body @ free.damper_input, legs.body @ free.road_input),
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


class SideWorth(NamedTuple):
    """What a force f beyond the passive one costs per time, r z f + q f^2, of each damper."""

    states: FloatArray
    """r, shape (D, n) [1/(N s)] per state."""
    squares: FloatArray
    """q, shape (D,) [1/(N^2 s)]."""


def side_worth(
    vehicle: Vehicle | QuarterCar, weights: Weights, c_min: float, c_max: float, time: float
) -> SideWorth:
    """Return it for dampings within bounds [N s/m], of a crossing that takes a time T [s]."""
    cost, free = side_cost(vehicle, weights), vehicle.linear.undamped
    dampings = np.clip(vehicle.linear.damper_dampings, c_min, c_max)
    passive = dampings[:, np.newaxis] * Legs(free).rate
    p, a = cost.states + cost.forces @ passive, free.state_matrix_on_tires()
    x = cost_to_go(a + free.damper_input @ passive, p)
    rows = 2 / time * (SHARE * free.damper_input.T @ x + cost.forces.T @ p)
    return SideWorth(rows, (cost.forces**2).sum(axis=0) / time)


def cost_to_go(a: FloatArray, p: FloatArray) -> FloatArray:
    """Return X [s], (n, n): |P z|^2 adds up to z' X z from z on, where z' = A z."""
    if not p.any():
        return np.zeros_like(a)
    if np.linalg.eigvals(a).real.max() >= 0:
        raise ValueError(
            "vehicle must come to rest with its own dampings, within c_min and c_max, for ride, "
            "travel and tire_force to have a cost: type c_min=1e3, or damper_dampings above 0"
        )
    return np.asarray(solve_continuous_lyapunov(a.T, -p.T @ p))


def best_damping(worth: Any, square: float, passive: float, v: Any, g: Any) -> Any:
    """Return the c in [c_min, c_max] with the least worth f + square f^2, f = (c - passive) v."""
    if square == 0:
        return ca.if_else(worth * v < 0, g.c_max, g.c_min)
    steep = 2 * square * v * v
    wanted = passive * steep - worth * v  # c times steep: v may be 0
    within = ca.if_else(wanted < g.c_max * steep, wanted / steep, g.c_max)
    return ca.if_else(wanted > g.c_min * steep, within, g.c_min)
