"""What a bridge has to tell: its modes along the wheel path, and what a load does to a section.

With modal coordinates q_j, tire forces R_k at x_k, modal masses m_j and mode shapes phi_j

    q_j'' + 2 zeta_j w_j q_j' + w_j^2 q_j = (1 / m_j) sum_k R_k phi_j(x_k)

and a moment at a section is that of the tire forces through the influence line, less what the
inertia and damping forces of the modes take off it (`bridgectl.model.recovery`). Nothing else is
asked of a bridge, whose shapes may have any scale and order: `Beam` is one.
"""

from __future__ import annotations

import dataclasses
from collections.abc import Callable
from typing import Any, Protocol, cast, runtime_checkable

import numpy as np
from numpy.typing import ArrayLike

from bridgectl._checks import FloatArray


@runtime_checkable
class BridgeModel(Protocol):
    """A bridge of n modes; an immutable value, best a frozen dataclass."""

    @property
    def length(self) -> float:
        """Length of the wheel path on the bridge [m]."""
        ...

    @property
    def n_modes(self) -> int:
        """Number of modes."""
        ...

    @property
    def omega(self) -> FloatArray:
        """Circular natural frequencies w_j [rad/s], shape (n_modes,), in any order."""
        ...

    @property
    def damping_ratios(self) -> FloatArray:
        """Damping ratio of each mode, shape (n_modes,)."""
        ...

    @property
    def modal_masses(self) -> FloatArray:
        """Modal masses m_j [kg], of the shapes' scale, shape (n_modes,)."""
        ...

    def mode_shapes(self, x: ArrayLike) -> FloatArray:
        """Mode shapes at places [m], zero off the bridge, shape (..., n_modes)."""
        ...

    def influence_line(self, x: ArrayLike, section: float = 0.5) -> FloatArray:
        """Static moment [N m / N] at a section, a fraction of the length, of a force at x [m]."""
        ...

    def modal_moments(self, section: float = 0.5) -> FloatArray:
        """Moment at a section per modal coordinate [N], shape (n_modes,)."""
        ...

    def kinks(self, section: float) -> FloatArray:
        """Places [m] where shapes or the section's influence line are not smooth, with the ends."""
        ...


@runtime_checkable
class TellsEffects(BridgeModel, Protocol):
    """A bridge that tells more than moments: shear, reactions, or what was measured."""

    def influence_line(
        self, x: ArrayLike, section: float = 0.5, quantity: str = "moment"
    ) -> FloatArray:
        """Static effect [its unit / N] at a section of a force at x [m]."""
        ...

    def modal_effects(self, section: float = 0.5, quantity: str = "moment") -> FloatArray:
        """Effect at a section per modal coordinate, shape (n_modes,)."""
        ...


def slopes_of(bridge: BridgeModel) -> Callable[[ArrayLike], FloatArray]:
    """The method of a bridge that tells the slopes of its shapes [1/m], as `mode_shapes`."""
    found = getattr(bridge, "mode_slopes", None)
    if found is None:
        raise TypeError(
            "tire_damping must be 0 on a bridge that does not tell the slopes of its mode shapes, "
            f"got {type(bridge).__name__}: give it a method mode_slopes(x) like mode_shapes(x)"
        )
    return cast(Callable[[ArrayLike], FloatArray], found)


def state_matrix(bridge: BridgeModel) -> FloatArray:
    """State matrix of the modes, states (q_1 [m], q_1' [m/s], q_2, ...), shape (2 n, 2 n)."""
    n = bridge.n_modes
    matrix = np.zeros((2 * n, 2 * n))
    displacement = 2 * np.arange(n)
    matrix[displacement, displacement + 1] = 1.0
    matrix[displacement + 1, displacement] = -(bridge.omega**2)
    matrix[displacement + 1, displacement + 1] = -2 * bridge.damping_ratios * bridge.omega
    return matrix


def input_matrix(bridge: BridgeModel) -> FloatArray:
    """Input matrix of the modal forces [N], 1 / m_j on each q_j'', shape (2 n, n)."""
    modes = np.arange(bridge.n_modes)
    matrix = np.zeros((2 * bridge.n_modes, bridge.n_modes))
    matrix[2 * modes + 1, modes] = 1 / bridge.modal_masses
    return matrix


def bridge_states(bridge: BridgeModel) -> list[str]:
    """Names of the bridge's states, in order."""
    return [f"q_{j}{dot}" for j in range(1, bridge.n_modes + 1) for dot in ("", "_dot")]


def described(bridge: BridgeModel) -> dict[str, Any]:
    """What tells a bridge from others, for files."""
    value: Any = bridge
    known = dataclasses.is_dataclass(value) and not isinstance(value, type)
    return dataclasses.asdict(value, dict_factory=_finite) if known else {"bridge": repr(value)}


def _finite(pairs: list[tuple[str, Any]]) -> dict[str, Any]:
    """Values by name; JSON has no infinite ones, as of supports."""
    return {
        name: "rigid" if isinstance(value, float) and np.isinf(value) else value
        for name, value in pairs
    }
