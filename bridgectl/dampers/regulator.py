"""Linear-quadratic regulators of damper forces, and how legs' signals tell a vehicle's state.

The state of a whole vehicle is its motion about the equilibrium on the road as it is under its
tires now: y less what the vehicle would sink to there, and y'. With K = S' X S the stiffness of
springs at the legs, whose travels are d = S y, and f the tire forces beyond the static ones::

    (K + T' K_t T) (y - y_road) = S' X d + T' f
"""

from __future__ import annotations

from typing import NamedTuple

import control
import numpy as np

from bridgectl._checks import FloatArray
from bridgectl.dampers.legs import Legs
from bridgectl.model.vehicle import Vehicle

TOLD = 1e-9
"""What a matrix may miss of another that it is to be, relative to that one's largest entry."""


class Regulator(NamedTuple):
    """A linear-quadratic problem x' = A x + B F, J = x' Q x + 2 x' N F + F' R F."""

    state_matrix: FloatArray
    """A, shape (n, n)."""
    input_matrix: FloatArray
    """B, shape (n, m)."""
    state_weight: FloatArray
    """Q, shape (n, n)."""
    force_weight: FloatArray
    """R, shape (m, m)."""
    cross_weight: FloatArray
    """N, shape (n, m)."""

    def feedbacks(self) -> FloatArray:
        """Return K of the forces F = -K x [N] with the least J, shape (m, n)."""
        # Forces in units of 1 / sqrt(R): numbers of the same size in the Riccati equation.
        units = np.linalg.inv(np.linalg.cholesky(self.force_weight)).T
        gain, _, _ = control.lqr(
            self.state_matrix, self.input_matrix @ units, self.state_weight, np.eye(len(units)),
            self.cross_weight @ units,
        )  # fmt: skip
        return units @ np.asarray(gain, dtype=np.float64)

    def feedback(self) -> FloatArray:
        """Return K of the only force, shape (n,)."""
        return self.feedbacks()[0]


def whole_regulator(
    vehicle: Vehicle,
    masses: FloatArray,
    body_acceleration: float,
    suspension_travel: FloatArray,
    tire_deflection: FloatArray,
    damper_force: float,
) -> Regulator:
    """Return the problem of all dampers of a vehicle, its states (y_1, y_1', y_2, ...).

    J is the sum over the legs. Forces of several legs that move no body together would be free:
    they count as the acceleration of the mass [kg] that each carries. Weights as of `clipped_lqr`,
    of travels and deflections one a leg.
    """
    free = vehicle.undamped
    legs = Legs(free)
    stiffness = legs.tires * free.tire_stiffnesses
    deflection = stiffness / stiffness.sum(axis=1, keepdims=True) @ free.hubs
    moving = legs.body @ free.damper_input
    # Accelerations of the masses alone are -(X d + F) / m; of bodies they are this times those.
    shared = -moving * masses
    idle = np.eye(len(masses)) - np.linalg.pinv(shared, rcond=TOLD) @ shared
    alone = -idle / masses
    of_force = np.vstack([moving, alone])
    of_state = np.vstack(
        [legs.body @ free.state_matrix_on_tires(), alone @ springs_at_legs(free) @ legs.travel]
    )
    cost = body_acceleration * of_state.T @ of_state
    for q, rows in ((suspension_travel, legs.travel), (tire_deflection, deflection)):
        cost = cost + rows.T @ (q[:, np.newaxis] * rows)
    return Regulator(
        free.state_matrix_on_tires(), free.damper_input,
        (cost + cost.T) / 2,  # else symmetric but for round-off, which is refused
        body_acceleration * of_force.T @ of_force + damper_force * np.eye(len(masses)),
        body_acceleration * of_state.T @ of_force,
    )  # fmt: skip


def springs_at_legs(vehicle: Vehicle) -> FloatArray:
    """X [N/m] of the module's docstring, (D, D): forces of the legs' springs from their travels."""
    across = np.linalg.pinv(vehicle.damper_map)
    return np.asarray(across.T @ vehicle.stiffness_matrix @ across)


def tells_state(vehicle: Vehicle) -> bool:
    """Whether the signals of its legs tell a vehicle's state, with its springs at the legs alone.

    All springs are at the legs, each tire is under one leg, those of a leg move alike, and no body
    moves that no leg ends at.
    """
    legs, travels, springs = Legs(vehicle), vehicle.damper_map, vehicle.stiffness_matrix
    missed = abs(travels.T @ springs_at_legs(vehicle) @ travels - springs).max()
    hubs = legs.tires.T @ _hubs(legs)
    ends = np.vstack([travels + vehicle.damper_axles, vehicle.damper_axles])
    return bool(
        missed <= TOLD * abs(springs).max()
        and (legs.tires.sum(axis=0) == 1).all()
        and legs.tires.any(axis=1).all()
        and np.allclose(hubs, vehicle.tire_map, rtol=0, atol=TOLD)
        and np.linalg.matrix_rank(ends) == vehicle.n_coordinates
    )


def _hubs(legs: Legs) -> FloatArray:
    """Mean displacement of the hubs under each leg from the coordinates, (D, n)."""
    count = np.maximum(legs.tires.sum(axis=1, keepdims=True), 1)
    return np.asarray(legs.tires @ legs.vehicle.tire_map / count)


def of_signals(vehicle: Vehicle, feedbacks: FloatArray) -> FloatArray:
    """Return feedbacks (D, 2 n) of the states as those of the legs' signals, (D, 4, D).

    Signals are travels, body velocities, tire deflections and axle velocities, each of all legs.
    """
    legs, hubs = Legs(vehicle), vehicle.tire_map
    tires = vehicle.tire_stiffnesses[:, np.newaxis] * hubs
    held = np.linalg.solve(vehicle.stiffness_matrix + hubs.T @ tires, feedbacks[:, ::2].T).T
    ends = np.vstack([vehicle.damper_map + vehicle.damper_axles, vehicle.damper_axles])
    body, axle = np.split(feedbacks[:, 1::2] @ np.linalg.pinv(ends), 2, axis=1)
    travel = held @ vehicle.damper_map.T @ springs_at_legs(vehicle)
    deflection = held @ _hubs(legs).T * (legs.tires @ vehicle.tire_stiffnesses)
    return np.stack([travel, body, deflection, axle], axis=1)
