"""Tire forces and surface at the stages of cells: the system of `bridgectl.linear.cells`."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from bridgectl._checks import FloatArray
from bridgectl.model.crossing import Crossing
from bridgectl.model.vehicle import Vehicle


def vehicle_matrices(vehicle: Vehicle, contact: NDArray[np.bool_]) -> tuple[FloatArray, FloatArray]:
    """State and input matrices on the tires in contact; the others' input is a force, R - W."""
    inputs = np.where(contact, vehicle.road_input, vehicle.tire_input)
    return vehicle.state_matrix_on_tires(contact), inputs


def vehicle_stages(
    crossing: Crossing, free: FloatArray, held: FloatArray, contact: NDArray[np.bool_]
) -> tuple[FloatArray, FloatArray]:
    """G and H of the module's docstring: tire forces from the vehicle and the surface."""
    vehicle = crossing.linear
    stage, tire = np.divmod(np.arange(held.shape[-1]), vehicle.n_tires)
    hubs = vehicle.leading_hubs[tire]
    stiffness = (contact * vehicle.tire_stiffnesses)[tire, np.newaxis]
    held = held[:, :, stage]
    from_vehicle = stiffness * np.einsum("qi,suqij->suqj", hubs, free[:, :, stage])
    from_surface = np.einsum("qi,suqij->suqj", hubs, held) - np.eye(len(stage))
    return from_vehicle, stiffness * from_surface


def solve_stages(
    crossing: Crossing,
    contact: NDArray[np.bool_],
    from_vehicle: FloatArray,
    spring: FloatArray,
    from_beam: FloatArray,
    compliance: FloatArray,
    climbed: FloatArray,
    pitches: bool,
) -> FloatArray:
    """Stage values [R, u] from states and road rows: the system of the module's docstring.

    `climbed` tells of the road at the stages by its rise in the cell (..., N_STAGES, n_tires).
    """
    vehicle, n_tires, n = crossing.linear, crossing.linear.n_tires, from_vehicle.shape[-1]
    stage, tire = np.divmod(np.arange(compliance.shape[-1]), n_tires)
    own, size = np.arange(len(stage)), from_beam.shape[-1]
    batch, count = compliance.shape[:2], len(stage)
    # What the surface is without the tire forces, from modal states and road rows.
    given = np.zeros((*batch, count, size + 2 * n_tires + 1 + pitches))
    given[..., :size] = from_beam
    given[:, :, own, size + tire] = 1.0
    given[:, :, own, size + n_tires + 1 + tire] = climbed[..., stage, tire]
    flying = np.nonzero(~contact[tire])[0]
    if flying.size:
        compliance = compliance.copy()
        compliance[:, :, flying] = given[:, :, flying] = 0.0
        given[:, :, flying, size + n_tires] = -crossing.linear.static_loads[tire[flying]]
    right = np.empty((*batch, count, n + given.shape[-1]))
    right[..., :n], right[..., n:] = from_vehicle, spring @ given
    right[..., n + size + n_tires] += (contact * vehicle.static_loads)[tire]
    if pitches:  # as the motion from the rest that the acceleration leads to
        spring_forces = vehicle.tire_stiffnesses * (vehicle.hubs @ vehicle.pitched)
        right[..., -1] += spring_forces[tire] - from_vehicle @ vehicle.pitched
    stages = np.empty((*batch, 2 * count, right.shape[-1]))
    forces, surface = stages[:, :, :count], stages[:, :, count:]
    forces[:] = np.linalg.solve(np.eye(count) - spring @ compliance, right)
    np.matmul(compliance, forces, out=surface)
    surface[..., n:] += given
    return stages
