"""The bridge: a simply supported Euler-Bernoulli beam in its first modes."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import control
import numpy as np
from numpy.typing import ArrayLike

from bridgectl import _checks
from bridgectl._checks import FloatArray
from bridgectl._places import SAME_PLACE
from bridgectl._plausible import judge_beam
from bridgectl.model.bridge import bridge_states, input_matrix, state_matrix


@dataclass(frozen=True)
class Beam:
    """A simply supported beam of constant section, truncated to its first modes.

    The deflection is v(x, t) = sum_j q_j(t) sin(j pi x / l), positive downward, and each
    modal coordinate follows Eq. (3) of Li, OBrien and Gonzalez (2006) projected on its
    mode shape::

        q_j'' + 2 zeta_j w_j q_j' + w_j^2 q_j = 2 / (mu l) sum_k R_k sin(j pi x_k / l)

    with tire forces R_k at x_k and w_j = (j pi / l)^2 sqrt(E J / mu).

    Parameters
    ----------
    length : float
        Span l [m].
    mass_per_length : float
        Mass per unit length mu [kg/m].
    flexural_rigidity : float
        Young's modulus times second moment of area, E J [N m^2].
    n_modes : int, optional
        Number of modes n.
    damping_ratio : float or sequence of float, optional
        One number: the damping ratio of mode 1. Eq. (3) has one circular damping
        frequency w_b = damping_ratio * w_1 for all modes, so mode j has the ratio w_b / w_j.
        A sequence of `n_modes` numbers: one ratio a mode.

    Raises
    ------
    TypeError
        If a parameter is not a number.
    ValueError
        If a parameter is out of range; the message names it.

    Warns
    -----
    PlausibilityWarning
        If no bridge of that length has such a mass, first frequency or damping.

    References
    ----------
    Y. Li, E. OBrien, A. Gonzalez, J. Sound Vib. 293 (2006) 125-137, Eq. (3).

    Examples
    --------
    >>> import bridgectl as bc
    >>> beam = bc.Beam(length=25.0, mass_per_length=18358.0, flexural_rigidity=4.86535e10)
    >>> beam.frequencies.round(4)
    array([ 4.0915, 16.3661, 36.8236])
    """

    length: float
    mass_per_length: float
    flexural_rigidity: float
    n_modes: int = 3
    damping_ratio: float | tuple[float, ...] = 0.0

    def __post_init__(self) -> None:
        checked: dict[str, object] = {
            "length": _checks.positive("length", self.length, unit="m"),
            "mass_per_length": _checks.positive(
                "mass_per_length", self.mass_per_length, unit="kg/m"
            ),
            "flexural_rigidity": _checks.positive(
                "flexural_rigidity", self.flexural_rigidity, unit="N m^2"
            ),
            "n_modes": _checks.integer("n_modes", self.n_modes, at_least=1),
            "damping_ratio": checked_damping(self.damping_ratio, self.n_modes),
        }
        for name, value in checked.items():
            object.__setattr__(self, name, value)
        judge_beam(self)

    def __repr__(self) -> str:
        return (
            f"Beam(length={self.length:g} m, mass_per_length={self.mass_per_length:g} kg/m, "
            f"flexural_rigidity={self.flexural_rigidity:g} N m^2, n_modes={self.n_modes}, "
            f"damping_ratio={self.damping_ratio}, f_1={self.frequencies[0]:.4g} Hz)"
        )

    @property
    def mass(self) -> float:
        """Mass of the whole span [kg]."""
        return self.mass_per_length * self.length

    @cached_property
    def wavenumbers(self) -> FloatArray:
        """Wave numbers j pi / l of the mode shapes [rad/m], shape (n_modes,)."""
        return np.arange(1, self.n_modes + 1) * np.pi / self.length

    @cached_property
    def omega(self) -> FloatArray:
        """Circular natural frequencies w_j [rad/s], shape (n_modes,)."""
        return self.wavenumbers**2 * np.sqrt(self.flexural_rigidity / self.mass_per_length)

    @property
    def frequencies(self) -> FloatArray:
        """Natural frequencies f_j [Hz], shape (n_modes,)."""
        return self.omega / (2 * np.pi)

    @cached_property
    def damping_ratios(self) -> FloatArray:
        """Damping ratio of each mode, shape (n_modes,)."""
        if isinstance(self.damping_ratio, tuple):
            return np.array(self.damping_ratio)
        return self.damping_ratio * self.omega[0] / self.omega

    @property
    def modal_masses(self) -> FloatArray:
        """Modal masses mu l / 2 [kg], shape (n_modes,)."""
        return np.full(self.n_modes, self.mass / 2)

    def kinks(self, section: float = 0.5) -> FloatArray:
        """Ends of the bridge, and the section between them [m], shape (3,).

        Parameters
        ----------
        section : float, optional
            The section, as a fraction of the span.

        Returns
        -------
        ndarray, shape (3,)
            Places [m] where mode shapes or the influence line are not smooth.
        """
        return np.array([0.0, section * self.length, self.length])

    def mode_shapes(self, x: ArrayLike) -> FloatArray:
        """Mode shapes sin(j pi x / l), zero off the bridge.

        Parameters
        ----------
        x : array_like
            Positions [m], any shape.

        Returns
        -------
        ndarray, shape (..., n_modes)
            Dimensionless.

        Raises
        ------
        ValueError
            If positions are masked.
        """
        _checks.refuse_masked("x", x)
        position = np.asarray(x, dtype=np.float64)[..., np.newaxis]
        # The shapes vanish at both supports: clipping to the span is zero off the bridge.
        on_bridge = np.minimum(np.maximum(position, 0.0), self.length)
        return np.asarray(np.sin(self.wavenumbers * on_bridge))

    def mode_slopes(self, x: ArrayLike) -> FloatArray:
        """Slopes of the mode shapes, zero off the bridge.

        Parameters
        ----------
        x : array_like
            Positions [m], any shape.

        Returns
        -------
        ndarray, shape (..., n_modes)
            [1/m]

        Raises
        ------
        ValueError
            If positions are masked.
        """
        _checks.refuse_masked("x", x)
        position = np.asarray(x, dtype=np.float64)[..., np.newaxis]
        on_bridge = (position >= -SAME_PLACE) & (position <= self.length + SAME_PLACE)
        slopes = self.wavenumbers * np.cos(self.wavenumbers * position)
        return np.where(on_bridge, slopes, 0.0)

    def influence_line(
        self, x: ArrayLike, section: float = 0.5, quantity: str = "moment"
    ) -> FloatArray:
        """Static effect at a section of a unit force at x [m], zero off the bridge.

        Parameters
        ----------
        x : array_like
            Positions of the force [m], any shape.
        section : float, optional
            The section, as a fraction of the span; of a reaction 0 or 1.
        quantity : {'moment', 'shear', 'deflection', 'reaction'}, optional
            Bending moment, shear (its derivative along the bridge; a force at the section is just
            beyond it), deflection downward, or force of a support on the bridge, upward.

        Returns
        -------
        ndarray
            Effect per force [N m / N], [m / N] or dimensionless, the shape of `x`.

        Raises
        ------
        TypeError, ValueError
            If `section` is not a fraction from 0 to 1, `quantity` is none of these, or positions
            are masked.
        """
        _checks.refuse_masked("x", x)
        position, length = np.asarray(x, dtype=np.float64), self.length
        at = self._section(section, quantity) * length
        rising = position * (1 - at / length)
        falling = at * (1 - position / length)
        if quantity == "moment":
            return np.maximum(np.minimum(rising, falling), 0.0)
        inside = (position >= 0) & (position <= length)
        if quantity == "deflection":
            near, far = np.minimum(position, at), length - np.maximum(position, at)
            bending = near * far * (length**2 - near**2 - far**2)
            return np.where(inside, bending / (6 * self.flexural_rigidity * length), 0.0)
        before = (position < at) | (at == length)
        shear = np.where(before, 0.0, 1.0) - position / length
        return np.where(inside, -shear if quantity == "reaction" and at else shear, 0.0)

    def modal_moments(self, section: float = 0.5) -> FloatArray:
        """Bending moment at a section per modal coordinate, E J (j pi / l)^2 sin(j pi s) [N].

        Parameters
        ----------
        section : float, optional
            The section s, as a fraction of the span.

        Returns
        -------
        ndarray, shape (n_modes,)
            Moment per modal coordinate [N m / m].

        Raises
        ------
        TypeError, ValueError
            If `section` is not a fraction from 0 to 1.
        """
        return self.modal_effects(section)

    def modal_effects(self, section: float = 0.5, quantity: str = "moment") -> FloatArray:
        """Effect at a section per modal coordinate: of a moment E J (j pi / l)^2 sin(j pi s).

        Parameters
        ----------
        section, quantity
            See `influence_line`.

        Returns
        -------
        ndarray, shape (n_modes,)
            Moment [N m / m], shear or reaction [N/m], or dimensionless shape.

        Raises
        ------
        TypeError, ValueError
            As `influence_line`.
        """
        phase = self.wavenumbers * (self._section(section, quantity) * self.length)
        if quantity == "moment":
            return np.asarray(self.flexural_rigidity * self.wavenumbers**2 * np.sin(phase))
        if quantity == "deflection":
            return np.sin(phase)
        shear: FloatArray = self.flexural_rigidity * self.wavenumbers**3 * np.cos(phase)
        return -shear if quantity == "reaction" and section else shear

    def _section(self, section: float, quantity: str) -> float:
        """Check a section, which may be an end if the quantity is no moment."""
        _checks.choice("quantity", quantity, ("moment", "shear", "deflection", "reaction"))
        at_end = _checks.number("section", section) in (0.0, 1.0)
        if quantity == "reaction" and not at_end:
            raise ValueError(
                "section must be the place of a support that has a reaction, 0 or 1 of the span, "
                f"got {section:g}"
            )
        if quantity != "moment" and at_end:
            return float(section)
        return _checks.fraction("section", section, self.length)

    @cached_property
    def state_matrix(self) -> FloatArray:
        """State matrix of the modes, states (q_1 [m], q_1' [m/s], q_2, ...), shape (2 n, 2 n)."""
        return state_matrix(self)

    @cached_property
    def input_matrix(self) -> FloatArray:
        """Input matrix of the modal forces [N], 2 / (mu l) on each q_j'', shape (2 n, n)."""
        return input_matrix(self)

    def system(
        self, loads: Sequence[float] | None = None, sections: Sequence[float] | None = None
    ) -> control.StateSpace:
        """Return the beam as a linear system.

        Parameters
        ----------
        loads : sequence of float, optional
            Positions of fixed vertical forces, as fractions of the span: inputs
            'force_1', ... [N]. Default: the modal forces 'modal_force_1', ... [N], which
            a moving tire force R at x feeds with R sin(j pi x / l).
        sections : sequence of float, optional
            Sections whose deflection is an output 'deflection_1', ... [m]. Default: the
            modal coordinates 'q_1', ... [m].

        Returns
        -------
        control.StateSpace
            States 'q_1' [m], 'q_1_dot' [m/s], 'q_2', ...

        Raises
        ------
        TypeError, ValueError
            If a load or section is not a fraction of the span from 0 to 1.

        Examples
        --------
        >>> import bridgectl as bc
        >>> sys = bc.li2006.beam().system(loads=[0.5], sections=[0.5])
        >>> sys.input_labels, sys.output_labels
        (['force_1'], ['deflection_1'])
        >>> print(f"{sys.dcgain() * 98100 * 1e3:.3f} mm under the truck at mid-span")
        0.655 mm under the truck at mid-span
        """
        select = np.kron(np.eye(self.n_modes), [1.0, 0.0])
        modes = range(1, self.n_modes + 1)
        input_map: FloatArray = np.eye(self.n_modes)
        output_map: FloatArray = np.eye(self.n_modes)
        inputs, outputs = [f"modal_force_{j}" for j in modes], [f"q_{j}" for j in modes]
        if loads is not None:
            inputs, input_map = self._fixed_points("loads", loads, "force")
        if sections is not None:
            outputs, output_map = self._fixed_points("sections", sections, "deflection")
        return control.ss(
            self.state_matrix,
            self.input_matrix @ input_map.T,
            output_map @ select,
            0,
            states=bridge_states(self),
            inputs=inputs,
            outputs=outputs,
            name="beam",
        )

    def _fixed_points(
        self, name: str, fractions: Sequence[float], signal: str
    ) -> tuple[list[str], FloatArray]:
        points = _checks.array(name, fractions, (None,))
        for point in points:
            _checks.fraction(name, float(point))
        labels = [f"{signal}_{i}" for i in range(1, points.size + 1)]
        return labels, self.mode_shapes(points * self.length)


def checked_damping(value: object, n_modes: int) -> float | tuple[float, ...]:
    """Check a damping ratio, or one a mode."""
    one_number = isinstance(value, str) or np.ndim(value) == 0  # type: ignore[arg-type]
    ratios = [value] if one_number else list(value)  # type: ignore[call-overload]
    if not one_number and len(ratios) != n_modes:
        raise ValueError(
            f"damping_ratio must be one number or {n_modes} numbers (one a mode), got {len(ratios)}"
        )
    checked = tuple(_checks.not_negative("damping_ratio", ratio) for ratio in ratios)
    if (largest := max(checked)) >= 1:
        raise ValueError(
            f"damping_ratio must be below 1, got {largest:g}; it is a ratio of critical damping: "
            f"for {largest:g} percent type {largest / 100:g}"
        )
    return checked[0] if one_number else checked
