"""A bridge known by its modes alone: measured ones, or those of another program."""

from __future__ import annotations

import hashlib
import os
from collections.abc import Mapping
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from bridgectl import _checks
from bridgectl._checks import FloatArray
from bridgectl._places import SAME_PLACE, merge_places
from bridgectl.model.beam import checked_damping
from bridgectl.model.modal_table import read_modes
from bridgectl.model.told import (
    EffectName,
    ToldEffect,
    checked_effect,
    checked_name,
    checked_places,
    checked_shapes,
    interpolation,
    judge_coupling,
    judge_masses,
    positive,
    require_slopes,
    told,
)


class ModalBridge:
    """A bridge of modes that were measured or come from another program.

    Shapes are told at places along the wheel path; between them they are cubic splines
    (not-a-knot), or straight lines of fewer than four places. Immutable.

    Parameters
    ----------
    x : array_like, shape (n_places,)
        Places along the wheel path [m], from 0 at the start of the bridge to its end.
    mode_shapes : array_like, shape (n_places, n_modes)
        Deflection of each mode there, downward positive, of any scale [m per modal coordinate].
    frequencies : array_like, shape (n_modes,)
        Natural frequencies [Hz], above 0.
    modal_masses : float or array_like, shape (n_modes,), optional
        Modal masses [kg] of shapes of this scale; 1 for mass-normalised shapes. May be left out
        where `mass_per_length` is given, which then makes them.
    damping_ratio : float or array_like, shape (n_modes,), optional
        Damping ratio of all modes, or of each.
    effects : mapping, optional
        Load effects besides deflection: of ``("moment", 0.5)`` (a quantity and its section, as a
        fraction of the length) or of a name such as ``"strain_gauge_1"`` the places [m] of a force,
        the static effect of 1 N at each (linear between them: tell its kinks), and the effect of
        each mode's shape, shape (n_modes,).
    mass_per_length : float or array_like, shape (n_places,), optional
        Mass per length [kg/m] of a bridge that moves as one line, by which shapes are judged.

    Raises
    ------
    TypeError
        If a parameter has the wrong kind.
    ValueError
        If shapes do not fit together, there are no modal masses, or numbers are out of range.

    Warns
    -----
    PlausibilityWarning
        If `mass_per_length` couples two modes by more than 0.1, or a modal mass is off by 20 %.

    Examples
    --------
    >>> import numpy as np
    >>> import bridgectl as bc
    >>> x = np.linspace(0, 25, 51)
    >>> bridge = bc.ModalBridge(
    ...     x, np.sin(np.pi * np.outer(x, [1, 2]) / 25), frequencies=[4.09, 16.4],
    ...     modal_masses=229e3, damping_ratio=0.01,
    ...     effects={("moment", 0.5): ([0, 12.5, 25], [0, 6.25, 0], [7.68e8, 0])},
    ... )
    >>> bc.daf(bridge, bc.li2006.car(), [25.0]).round(2)
    array([1.])
    """

    def __init__(
        self,
        x: ArrayLike,
        mode_shapes: ArrayLike,
        frequencies: ArrayLike,
        modal_masses: ArrayLike | None = None,
        damping_ratio: ArrayLike = 0.0,
        *,
        effects: Mapping[EffectName, tuple[ArrayLike, ArrayLike, ArrayLike]] | None = None,
        mass_per_length: ArrayLike | None = None,
    ) -> None:
        self._x = checked_places(x)
        self._frequencies = positive("frequencies", frequencies, (None,), "Hz")
        self._shapes = checked_shapes(mode_shapes, self._x.size, self._frequencies.size)
        self._interpolate = interpolation(self._x, self._shapes)
        damping = checked_damping(damping_ratio, self.n_modes)
        self._damping = np.broadcast_to(np.array(damping, dtype=np.float64), (self.n_modes,))
        self._masses = self._checked_masses(modal_masses, mass_per_length)
        self._effects = {
            checked_name(name): checked_effect(name, value, self._x, self.n_modes)
            for name, value in (effects or {}).items()
        }

    @classmethod
    def from_csv(cls, path: str | os.PathLike[str], **options: Any) -> ModalBridge:
        """Return a bridge from a text file with a column a mode, separated by commas.

        Lines that begin with 'frequency', 'modal mass' and 'damping ratio' have those [Hz, kg];
        the others begin with a place [m] and have the shapes there. A first line of names, which
        begins with 'x', units in brackets and semicolons for commas are understood.

        Parameters
        ----------
        path : str or path-like
            Name of the file.
        **options
            Other arguments of `ModalBridge`, such as `effects`; they come before the file's.

        Returns
        -------
        ModalBridge

        Raises
        ------
        OSError
            If there is no such file.
        TypeError, ValueError
            If the file is no such table, with its line, or as `ModalBridge`.

        Warns
        -----
        PlausibilityWarning
            As `ModalBridge`.
        """
        return cls(**(read_modes(path) | options))

    def __repr__(self) -> str:
        lowest, highest = self._frequencies.min(), self._frequencies.max()
        names = ", ".join(map(told, self._effects)) or "none"
        return (
            f"ModalBridge({self.length:g} m, n_modes={self.n_modes} of {lowest:.4g} to "
            f"{highest:.4g} Hz, effects {names}, data {self._fingerprint[:12]})"
        )

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, ModalBridge):
            return NotImplemented
        return self._fingerprint == other._fingerprint

    def __hash__(self) -> int:
        return hash(self._fingerprint)

    @cached_property
    def _fingerprint(self) -> str:
        """What tells the numbers of a bridge from others."""
        arrays = [self._x, self._shapes, self._frequencies, self._masses, self._damping]
        whole = hashlib.sha256()
        for name, effect in sorted(self._effects.items(), key=lambda item: told(item[0])):
            whole.update(told(name).encode())
            arrays.extend(effect)
        for array in arrays:
            whole.update(f"{array.shape}".encode() + np.ascontiguousarray(array).tobytes())
        return whole.hexdigest()

    @property
    def length(self) -> float:
        """Length of the wheel path on the bridge [m]."""
        return float(self._x[-1])

    @property
    def n_modes(self) -> int:
        """Number of modes."""
        return self._frequencies.size

    @property
    def frequencies(self) -> FloatArray:
        """Natural frequencies [Hz], shape (n_modes,)."""
        return self._frequencies

    @property
    def omega(self) -> FloatArray:
        """Circular natural frequencies [rad/s], shape (n_modes,)."""
        return 2 * np.pi * self._frequencies

    @property
    def damping_ratios(self) -> FloatArray:
        """Damping ratio of each mode, shape (n_modes,)."""
        return self._damping

    @property
    def modal_masses(self) -> FloatArray:
        """Modal masses [kg], shape (n_modes,)."""
        return self._masses

    @property
    def effects(self) -> list[EffectName]:
        """Names of the load effects that are told, dimensionless: see `influence_line`."""
        return list(self._effects)

    def mode_shapes(self, x: ArrayLike) -> FloatArray:
        """Mode shapes, interpolated, zero off the bridge.

        Parameters
        ----------
        x : array_like
            Positions [m], any shape.

        Returns
        -------
        ndarray, shape (..., n_modes)
            As given [m per modal coordinate].

        Raises
        ------
        ValueError
            If positions are masked.
        """
        position, on_bridge = self._positions(x)
        return np.where(on_bridge[..., np.newaxis], self._interpolate(position), 0.0)

    def mode_slopes(self, x: ArrayLike) -> FloatArray:
        """Slopes of the mode shapes, zero off the bridge.

        Parameters
        ----------
        x : array_like
            Positions [m], any shape.

        Returns
        -------
        ndarray, shape (..., n_modes)
            Per metre [1/m], as given.

        Raises
        ------
        ValueError
            If positions are masked, or there are but three places of shapes.
        """
        require_slopes(self._x)
        position, on_bridge = self._positions(x)
        return np.where(on_bridge[..., np.newaxis], self._interpolate(position, 1), 0.0)

    def influence_line(
        self, x: ArrayLike, section: float = 0.5, quantity: str = "moment"
    ) -> FloatArray:
        """Static effect of a unit force at x, zero off the bridge.

        Parameters
        ----------
        x : array_like
            Positions of the force [m], any shape.
        section : float, optional
            The section, as a fraction of the length. Of a named effect it does not matter.
        quantity : str, optional
            'moment' or another quantity that is told at the section, the name of an effect, or
            'deflection', which is that of the modes where it is not told.

        Returns
        -------
        ndarray
            Effect per force [N m / N] or as told, the shape of `x`.

        Raises
        ------
        TypeError, ValueError
            If no such effect is told, or positions are masked.
        """
        position, on_bridge = self._positions(x)
        effect = self._effect(section, quantity)
        if effect is None:
            flexibility = self._shapes_at(section) / (self.modal_masses * self.omega**2)
            return np.where(on_bridge, self._interpolate(position) @ flexibility, 0.0)
        line = np.interp(position, effect.places, effect.influence, left=0.0, right=0.0)
        return np.where(on_bridge, line, 0.0)

    def modal_effects(self, section: float = 0.5, quantity: str = "moment") -> FloatArray:
        """Effect of each mode's shape.

        Parameters
        ----------
        section, quantity
            See `influence_line`.

        Returns
        -------
        ndarray, shape (n_modes,)
            Per modal coordinate, [N m / m] or as told.

        Raises
        ------
        TypeError, ValueError
            As `influence_line`.
        """
        effect = self._effect(section, quantity)
        return self._shapes_at(section) if effect is None else effect.modal

    def modal_moments(self, section: float = 0.5) -> FloatArray:
        """Moment at a section of each mode's shape [N]: see `modal_effects`.

        Parameters
        ----------
        section : float, optional
            The section, as a fraction of the length.

        Returns
        -------
        ndarray, shape (n_modes,)
            Per modal coordinate [N m / m].

        Raises
        ------
        TypeError, ValueError
            If no moment is told at the section.
        """
        return self.modal_effects(section, "moment")

    def kinks(self, section: float = 0.5) -> FloatArray:
        """Ends, the section, and where a force has most of each effect [m], ascending.

        Parameters
        ----------
        section : float, optional
            The section, as a fraction of the length.

        Returns
        -------
        ndarray, shape (n,)
            Places [m] where influence lines are not smooth.
        """
        crests = [e.places[np.argmax(np.abs(e.influence))] for e in self._effects.values()]
        return merge_places(np.array([0.0, self.length, section * self.length, *crests]))

    def _positions(self, x: ArrayLike) -> tuple[FloatArray, Any]:
        """Positions held on the bridge, and whether they are on it."""
        _checks.refuse_masked("x", x)
        position = np.asarray(x, dtype=np.float64)
        on_bridge = (position >= -SAME_PLACE) & (position <= self.length + SAME_PLACE)
        return np.minimum(np.maximum(position, 0.0), self.length), on_bridge

    def _shapes_at(self, section: float) -> FloatArray:
        if _checks.number("section", section) not in (0.0, 1.0):
            _checks.fraction("section", section, self.length)
        return self.mode_shapes(section * self.length)

    def _effect(self, section: float, quantity: str) -> ToldEffect | None:
        """What is told of an effect, or None of a deflection that is not."""
        if quantity in self._effects:
            return self._effects[quantity]
        at = _checks.number("section", section)
        for name, effect in self._effects.items():
            if (
                not isinstance(name, str)
                and name[0] == quantity
                and abs(float(name[1]) - at) < SAME_PLACE
            ):
                return effect
        if quantity == "deflection":
            return None
        names = ", ".join(map(told, self._effects)) or "none"
        raise ValueError(
            f"the bridge tells no {quantity!r} at section {at:g}, its effects are {names}: type "
            f"effects={{({quantity!r}, {at:g}): (places, influence, modal)}}, or ask for what it "
            "tells without, as effect=bridgectl.Deflection()"
        )

    def _checked_masses(self, given: ArrayLike | None, per_length: ArrayLike | None) -> FloatArray:
        shape = (self.n_modes,)
        if per_length is None:
            if given is None:
                raise ValueError(
                    "modal_masses are missing, without which shapes have no scale: pass kg, as "
                    "modal_masses=[2.3e5, ...], or modal_masses=1 if shapes are mass-normalised"
                )
            return positive("modal_masses", given, shape, "kg")
        gram = self._mass_matrix(positive("mass_per_length", per_length, self._x.shape, "kg/m"))
        own = np.diag(gram)
        judge_coupling(np.abs(gram) / np.sqrt(np.outer(own, own)))
        if given is None:
            return np.array(own)
        masses = positive("modal_masses", given, shape, "kg")
        judge_masses(masses, own)
        return masses

    def _mass_matrix(self, mass: FloatArray) -> FloatArray:
        """Integrals of mass times two shapes, exact for splines and mass linear between places."""
        t, weight = np.polynomial.legendre.leggauss(4)
        half = np.diff(self._x)[:, np.newaxis] / 2
        x = (self._x[:-1, np.newaxis] + half * (1 + t)).ravel()
        weights = (half * weight).ravel() * np.interp(x, self._x, mass)
        shapes = self._interpolate(x)
        return np.asarray(shapes.T @ (shapes * weights[:, np.newaxis]))
