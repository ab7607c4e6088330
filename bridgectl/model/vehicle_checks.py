"""Whether matrices, tires and dampers make a vehicle that stands on its tires."""

from __future__ import annotations

from typing import Any, TypeAlias

import numpy as np

from bridgectl._checks import FloatArray

Vehicle: TypeAlias = Any  # its module imports this one


class UnloadedTireError(ValueError):
    """A tire that would have to be held down; `loads` are those of all tires [N]."""

    def __init__(self, loads: FloatArray) -> None:
        super().__init__(
            f"every tire must carry a static load above 0 N, got {loads} N; check mass_matrix, "
            "tire_map and heave"
        )
        self.loads = loads


def require_matrices(vehicle: Vehicle) -> None:
    """Refuse matrices that are not symmetric, or of negative masses, springs or dampers."""
    for name in ("mass_matrix", "damping_matrix", "stiffness_matrix"):
        matrix = getattr(vehicle, name)
        if not np.allclose(matrix, matrix.T, rtol=1e-9, atol=1e-9 * np.abs(matrix).max()):
            raise ValueError(f"{name} must be symmetric")
        # Round-off of a semi-definite matrix scales with its largest entry.
        if np.linalg.eigvalsh(matrix).min() < -1e-9 * np.abs(matrix).max():
            raise ValueError(f"{name} must not have negative eigenvalues")
    if np.linalg.eigvalsh(vehicle.mass_matrix).min() <= 0:
        raise ValueError("mass_matrix must be positive definite: every mass above 0 kg")
    if np.any(vehicle.damper_dampings < 0):
        raise ValueError(f"damper_dampings must be 0 N s/m or more, got {vehicle.damper_dampings}")


def require_loads(vehicle: Vehicle) -> None:
    """Refuse tires without stiffness, reference tire or load, and coordinates without support."""
    tires, offsets = vehicle.tire_stiffnesses, vehicle.tire_offsets
    if tires.size == 0 or np.any(tires <= 0):
        raise ValueError(f"tire_stiffnesses must all be above 0 N/m, got {tires}")
    if np.min(offsets) != 0:
        raise ValueError(
            "tire_offsets must be distances behind the reference tire, 0 m for that one and "
            f"0 or more for the others, got {offsets}"
        )
    if np.linalg.matrix_rank(vehicle.supported_stiffness) < vehicle.n_coordinates:
        raise ValueError(
            "stiffness_matrix and tire_map leave a coordinate without support: no static "
            "equilibrium exists"
        )
    if np.any(vehicle.static_loads <= 0):
        raise UnloadedTireError(vehicle.static_loads)
