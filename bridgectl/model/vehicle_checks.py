"""What is given of a vehicle, checked, and what stands for what is left out."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import ArrayLike

from bridgectl import _checks
from bridgectl._checks import FloatArray


def check_matrices(mass: FloatArray, damping: FloatArray, stiffness: FloatArray) -> None:
    """Refuse matrices [kg, N s/m, N/m] that are not symmetric, or take energy from nowhere."""
    named = {"mass_matrix": mass, "damping_matrix": damping, "stiffness_matrix": stiffness}
    lowest = np.linalg.eigvalsh(np.stack(list(named.values())))[:, 0]
    for (name, matrix), least in zip(named.items(), lowest, strict=True):
        sizes = np.abs(matrix)
        largest = sizes.max()
        if (np.abs(matrix - matrix.T) > 1e-9 * (largest + sizes)).any():
            raise ValueError(f"{name} must be symmetric")
        # Round-off of a semi-definite matrix scales with its largest entry.
        if least < -1e-9 * largest:
            raise ValueError(f"{name} must not have negative eigenvalues")
    if lowest[0] <= 0:
        raise ValueError("mass_matrix must be positive definite: every mass above 0 kg")


def check_tires(stiffnesses: FloatArray, offsets: FloatArray) -> None:
    """Refuse tires without stiffness [N/m], or ahead [m] of the reference tire."""
    if stiffnesses.size == 0 or np.any(stiffnesses <= 0):
        raise ValueError(f"tire_stiffnesses must all be above 0 N/m, got {stiffnesses}")
    if np.min(offsets) != 0:
        raise ValueError(
            "tire_offsets must be distances behind the reference tire, 0 m for that one and "
            f"0 or more for the others, got {offsets}"
        )


def unique_names(what: str, prefix: str, names: Sequence[str] | None, n: int) -> tuple[str, ...]:
    """Return n different names, numbered ones if none are given."""
    result = tuple(f"{prefix}{i}" for i in range(1, n + 1)) if names is None else tuple(names)
    if len(result) != n or len(set(result)) != n or not all(isinstance(s, str) for s in result):
        raise ValueError(f"{what} must be {n} different names, got {names!r}")
    return result


def lower_ends(dampers: FloatArray, hubs: FloatArray) -> FloatArray:
    """Hubs of the tires under the dampers: each damper's travel is that of a body less a hub's."""
    if len(dampers) == len(hubs):
        return hubs
    return np.asarray(hubs[np.argmin(dampers @ hubs.T, axis=1)])


def damping_of_tires(damping: ArrayLike, n_tires: int) -> FloatArray:
    """Damping of each tire [N s/m], from one number for all or one a tire."""
    if np.ndim(damping) == 0:
        one = _checks.not_negative("tire_damping", damping, unit="N s/m")
        return _checks.array("tire_damping", np.full(n_tires, one), (n_tires,))
    each = _checks.array("tire_damping", damping, (n_tires,), unit="N s/m")
    if np.any(each < 0):
        raise ValueError(f"tire_damping must be 0 N s/m or more, got {each}")
    return each
