"""Any straight beam bridge: continuous spans, elastic supports, stiffness and mass in steps."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import KW_ONLY, dataclass
from functools import cached_property
from types import SimpleNamespace
from typing import cast

import numpy as np
from numpy.typing import ArrayLike

from bridgectl import _checks
from bridgectl._checks import FloatArray
from bridgectl._places import SAME_PLACE, merge_places
from bridgectl._plausible import judge_beam
from bridgectl.model.beam import checked_damping
from bridgectl.model.elements import Modes, Pieces, derivative, to_chebyshev
from bridgectl.model.sections import (
    along,
    line_at_section,
    line_of_reaction,
    modes_at_section,
    modes_of_reaction,
)
from bridgectl.model.supports import (
    KINDS,
    Along,
    Support,
    checked_along,
    checked_rayleigh,
    checked_spans,
    checked_supports,
    merged,
    rayleigh,
    steps,
)

MODES_A_SPAN = 6
"""DAFs of moments at 20 to 30 m/s on spans of 25 m are then within 6e-4 of those of 24 modes
(``tests/test_spans.py``)."""

QUANTITIES = ("moment", "deflection", "shear", "reaction")


@dataclass(frozen=True)
class Bridge:
    """A straight beam bridge of any spans and supports, in its first modes.

    An Euler-Bernoulli beam, deflecting downward. Static influence lines are exact; frequencies and
    mode shapes with their moments are those of the continuous beam but for round-off
    (`bridgectl.model.elements`). Shapes are scaled so that each modal mass is half the mass of the
    bridge, as that of sines of amplitude 1; they begin downward.

    Parameters
    ----------
    spans : float or sequence of float
        Length of the span, or of each [m].
    mass_per_length, flexural_rigidity : float or sequence
        Mass per length [kg/m] and E J [N m^2]: one number, one a span, or pieces
        ``[(length, value), ...]`` [m] from the start of the bridge to its end.
    supports : sequence, optional
        One at each end of a span, ``len(spans) + 1`` in all: 'simple' (rigid, free to rotate:
        the default), 'clamped', 'free' (none: the tip of a cantilever), or stiffnesses
        ``{"vertical": ..., "rotational": ...}`` [N/m, N m/rad], infinite where rigid.
    n_modes : int, optional
        Number of modes. Default: 6 a span, with which DAFs of moments on spans of 25 m are within
        6e-4. Vertical springs, at which a tire meets the bridge with a jolt, want more.
    damping_ratio : float, sequence or mapping, optional
        One number for *all* modes (of a `Beam` it is that of mode 1), one a mode, or those of two
        modes as ``{1: 0.02, 3: 0.03}``: the others have a / w + b w (Rayleigh damping).

    Raises
    ------
    TypeError
        If a parameter has the wrong kind.
    ValueError
        If a parameter is out of range, its pieces do not cover the bridge, or the supports leave
        it free to move; the message names it.

    Warns
    -----
    PlausibilityWarning
        If no bridge of its longest span has such a mass, first frequency or damping.

    Notes
    -----
    A section at a support or step is just before it, at the start of the bridge just after it.
    Shear jumps as a force passes its section: a force right there is just beyond it, at the end of
    the bridge just before it.

    Examples
    --------
    Two spans, and the lowest moment over the middle support under 1 kN in the first one:

    >>> import bridgectl as bc
    >>> bridge = bc.Bridge([25, 25], mass_per_length=18358, flexural_rigidity=4.86535e10, n_modes=4)
    >>> bridge.frequencies.round(3)
    array([ 4.092,  6.392, 16.366, 20.713])
    >>> round(float(bridge.influence_line(25 / 3**0.5, section=0.5)), 3)
    -2.406
    >>> bc.daf(bridge, bc.li2006.car(), [25.0], section=0.2).round(3)
    array([1.064])
    """

    spans: float | Sequence[float]
    mass_per_length: float | Sequence[float] | Sequence[tuple[float, float]]
    flexural_rigidity: float | Sequence[float] | Sequence[tuple[float, float]]
    _: KW_ONLY
    supports: Sequence[str | Support | Mapping[str, float]] | None = None
    n_modes: int = cast(int, None)  # until checked
    damping_ratio: float | Sequence[float] | Mapping[int, float] = 0.0

    def __post_init__(self) -> None:
        spans = checked_spans(self.spans)
        n_modes = MODES_A_SPAN * len(spans) if self.n_modes is None else self.n_modes
        n_modes = _checks.integer("n_modes", n_modes, at_least=1)
        mass, rigidity = self.mass_per_length, self.flexural_rigidity
        damping = checked_rayleigh(self.damping_ratio, n_modes)
        checked: dict[str, object] = {
            "spans": spans,
            "mass_per_length": checked_along("mass_per_length", mass, spans, "kg/m"),
            "flexural_rigidity": checked_along("flexural_rigidity", rigidity, spans, "N m^2"),
            "supports": checked_supports(self.supports, len(spans)),
            "n_modes": n_modes,
            "damping_ratio": damping or checked_damping(self.damping_ratio, n_modes),
        }
        for name, value in checked.items():
            object.__setattr__(self, name, value)
        judge_beam(self._usual)

    def __repr__(self) -> str:
        lowest, highest = self._pieces.rigidity.min(), self._pieces.rigidity.max()
        rigidity = f"{lowest:g}" if lowest == highest else f"{lowest:g} to {highest:g}"
        spans = " + ".join(f"{span:g}" for span in self._spans)
        supports = ", ".join(map(str, cast(tuple[str | Support, ...], self.supports)))
        return (
            f"Bridge({spans} m, supports {supports}, mass={self.mass:g} kg, "
            f"flexural_rigidity={rigidity} N m^2, n_modes={self.n_modes}, "
            f"damping_ratio={self.damping_ratio}, f_1={self.frequencies[0]:.4g} Hz)"
        )

    @property
    def _usual(self) -> SimpleNamespace:
        """What is judged beside other bridges: the longest span of the average deck."""
        return SimpleNamespace(
            length=max(self._spans),
            mass_per_length=self.mass / self.length,
            flexural_rigidity=float(self._pieces.rigidity @ self._pieces.lengths) / self.length,
            frequencies=self.frequencies,
            damping_ratios=self.damping_ratios,
        )

    @property
    def _spans(self) -> tuple[float, ...]:
        return cast(tuple[float, ...], self.spans)

    @property
    def _supports(self) -> list[Support]:
        given = cast(tuple[str | Support, ...], self.supports)
        return [KINDS[support] if isinstance(support, str) else support for support in given]

    @property
    def length(self) -> float:
        """Length of the bridge [m]."""
        return float(self._pieces.edges[-1])

    @property
    def mass(self) -> float:
        """Mass of the whole bridge [kg]."""
        return float(self._pieces.mass @ self._pieces.lengths)

    @cached_property
    def support_places(self) -> FloatArray:
        """Places of the supports [m], shape (n_spans + 1,)."""
        return np.concatenate([[0.0], np.cumsum(self._spans)])

    @cached_property
    def _pieces(self) -> Pieces:
        """The bridge as prismatic pieces between supports and steps."""
        ends_of_mass, mass = steps(cast(Along, self.mass_per_length), self._spans)
        ends_of_rigidity, rigidity = steps(cast(Along, self.flexural_rigidity), self._spans)
        edges = merged(self.support_places[1:], ends_of_mass, ends_of_rigidity)
        middles = (edges[:-1] + edges[1:]) / 2
        springs = np.zeros((edges.size, 2))
        nodes = np.searchsorted(edges, self.support_places)
        springs[nodes] = [(support.vertical, support.rotational) for support in self._supports]
        return Pieces(
            edges,
            mass[np.searchsorted(ends_of_mass[:-1], middles)],
            rigidity[np.searchsorted(ends_of_rigidity[:-1], middles)],
            springs,
        )

    @cached_property
    def _modes(self) -> Modes:
        """Modes with half the mass of the bridge as modal mass."""
        return self._pieces.modes(self.n_modes).scaled(self.mass / 2)

    @property
    def omega(self) -> FloatArray:
        """Circular natural frequencies w_j [rad/s], ascending, shape (n_modes,)."""
        return self._modes.omega

    @property
    def frequencies(self) -> FloatArray:
        """Natural frequencies f_j [Hz], ascending, shape (n_modes,)."""
        return self.omega / (2 * np.pi)

    @cached_property
    def damping_ratios(self) -> FloatArray:
        """Damping ratio of each mode, shape (n_modes,)."""
        given = self.damping_ratio
        if not isinstance(given, tuple):
            return np.full(self.n_modes, given)
        if isinstance(given[0], tuple):
            return rayleigh(given, self.omega)
        return np.array(given)

    @property
    def modal_masses(self) -> FloatArray:
        """Modal masses [kg], half the mass of the bridge, shape (n_modes,)."""
        return np.full(self.n_modes, self.mass / 2)

    def kinks(self, section: float = 0.5) -> FloatArray:
        """Ends, supports, steps of the deck and the section [m], ascending.

        Parameters
        ----------
        section : float, optional
            The section, as a fraction of the length.

        Returns
        -------
        ndarray, shape (n,)
            Places [m] where mode shapes or influence lines are not smooth.

        Raises
        ------
        TypeError, ValueError
            If `section` is not a fraction from 0 to 1.
        """
        return merge_places(np.append(self._pieces.edges, self._place(section)))

    def mode_shapes(self, x: ArrayLike) -> FloatArray:
        """Mode shapes, zero off the bridge.

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
        return along(self._pieces, x, self._modes.chebyshev)

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
        return along(self._pieces, x, self._slopes)

    @cached_property
    def _slopes(self) -> tuple[FloatArray, ...]:
        """Chebyshev series of the slopes in each piece."""
        each = zip(self._modes.shapes, self._pieces.lengths, strict=True)
        return tuple(to_chebyshev(derivative(series, length, 1)) for series, length in each)

    def influence_line(
        self, x: ArrayLike, section: float = 0.5, quantity: str = "moment"
    ) -> FloatArray:
        """Static effect at a section of a unit force at x, zero off the bridge.

        Parameters
        ----------
        x : array_like
            Positions of the force [m], any shape.
        section : float, optional
            The section, as a fraction of the length; of a reaction the place of its support.
        quantity : {'moment', 'deflection', 'shear', 'reaction'}, optional
            Bending moment (sagging positive), deflection (downward), shear (derivative of the
            moment along the bridge), or force of a support on the bridge (upward).

        Returns
        -------
        ndarray
            Effect per force [N m / N], [m/N] or dimensionless, the shape of `x`.

        Raises
        ------
        TypeError, ValueError
            If `section` is not a fraction from 0 to 1, `quantity` is none of these, no support
            holds the bridge where a reaction is asked for, or positions are masked.

        Examples
        --------
        >>> import bridgectl as bc
        >>> bridge = bc.Bridge([20, 20], 18358, 4.865e10, n_modes=4)
        >>> bridge.influence_line([10, 20, 30], section=0.5, quantity="reaction").round(4)
        array([0.6875, 1.    , 0.6875])
        """
        _checks.refuse_masked("x", x)
        position = np.asarray(x, dtype=np.float64)
        at, node = self._asked(section, quantity)
        if node is not None:
            line = line_of_reaction(self._pieces, position.ravel(), node)
        else:
            line = line_at_section(self._pieces, position.ravel(), at, quantity)
        return line.reshape(position.shape)

    def modal_effects(self, section: float = 0.5, quantity: str = "moment") -> FloatArray:
        """Effect at a section per modal coordinate.

        Parameters
        ----------
        section, quantity
            See `influence_line`.

        Returns
        -------
        ndarray, shape (n_modes,)
            Moment, shear or reaction per modal coordinate [N m / m, N/m], or the shapes there.

        Raises
        ------
        TypeError, ValueError
            As `influence_line`.
        """
        at, node = self._asked(section, quantity)
        if node is not None:
            return modes_of_reaction(self._pieces, self._modes, node)
        return modes_at_section(self._pieces, self._modes, at, quantity)

    def modal_moments(self, section: float = 0.5) -> FloatArray:
        """Bending moment at a section per modal coordinate [N]: see `modal_effects`.

        Parameters
        ----------
        section : float, optional
            The section, as a fraction of the length.

        Returns
        -------
        ndarray, shape (n_modes,)
            Moment per modal coordinate [N m / m].

        Raises
        ------
        TypeError, ValueError
            If `section` is not a fraction from 0 to 1.
        """
        return self.modal_effects(section, "moment")

    def _place(self, section: float) -> float:
        """Place of a section [m], which may be an end of the bridge."""
        if _checks.number("section", section) not in (0.0, 1.0):
            _checks.fraction("section", section, self.length)
        return float(section) * self.length

    def _asked(self, section: float, quantity: str) -> tuple[float, int | None]:
        """Place of a section, and the node of the support if a reaction is asked for."""
        at = self._place(section)
        if _checks.choice("quantity", quantity, QUANTITIES) != "reaction":
            return at, None
        holding = [support.vertical > 0 for support in self._supports]
        places = self.support_places[holding]
        nearest = float(places[np.argmin(np.abs(places - at))])
        if abs(nearest - at) > SAME_PLACE * max(self.length, 1.0):
            fractions = ", ".join(f"{place / self.length:.6g}" for place in places)
            raise ValueError(
                f"section must be the place of a support that has a reaction, one of {fractions} "
                f"of the length, got {section:g}: type section={nearest / self.length!r}"
            )
        return at, int(np.searchsorted(self._pieces.edges, nearest - SAME_PLACE))
