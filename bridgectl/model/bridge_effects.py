"""Load effects of a bridge at a place: moment, deflection, shear, reaction, stress, acceleration.

Each is that of the tire forces through its static influence line, less what the inertia and damping
forces of the modes take off it (`bridgectl.model.recovery`).
"""

from __future__ import annotations

from abc import abstractmethod
from dataclasses import dataclass, field, replace
from typing import ClassVar, Self

import numpy as np
from numpy.typing import ArrayLike

from bridgectl import _checks
from bridgectl._checks import FloatArray
from bridgectl.model.bridge import BridgeModel, TellsEffects
from bridgectl.model.effect import NO_FACTOR, Effect, EffectRows
from bridgectl.model.recovery import RECOVERIES, recover, recover_moment
from bridgectl.model.traffic import paths_of
from bridgectl.model.vehicle import Vehicle

JUMP = 1e-6
"""Half the way [m] over which an influence line that jumps is drawn straight."""

FINE = 2001
"""Places of a vehicle among which the peak of a static effect is looked for, beside the kinks."""


@dataclass(frozen=True, repr=False)
class AtSection(Effect):
    """An effect at a place of the bridge; halfway if it is left open."""

    at: float | None = None
    felt_by_lane: ClassVar[bool] = True

    def __post_init__(self) -> None:
        super().__post_init__()
        if self.at is not None:
            object.__setattr__(self, "at", _checks.not_negative("at", self.at, unit="m"))

    def _on(self, bridge: BridgeModel, vehicle: Vehicle) -> Self:
        if self.at is None:
            return replace(self, at=bridge.length / 2)
        if self.at > bridge.length:
            raise ValueError(
                f"at must be a place on the bridge, from 0 to {bridge.length:g} m, got "
                f"{self.at:g} m: for halfway type at={bridge.length / 2:g}"
            )
        return self

    def section(self, bridge: BridgeModel) -> float:
        """Return the place as a fraction of the bridge's length.

        Parameters
        ----------
        bridge
            See `bridgectl.Crossing`.

        Returns
        -------
        float
            A fraction.
        """
        return 0.5 if self.at is None else self.at / bridge.length

    def influence_line(self, bridge: BridgeModel, x: ArrayLike) -> FloatArray:
        """Static effect of a force of 1 N at places, zero off the bridge.

        Parameters
        ----------
        bridge
            See `bridgectl.Crossing`.
        x : array_like
            Places of the force [m], any shape.

        Returns
        -------
        ndarray
            Effect per force [N m / N], [m / N], ..., the shape of `x`. Deflection is of the modes.

        Examples
        --------
        >>> import bridgectl as bc
        >>> bc.Moment(5.0).influence_line(bc.li2006.beam(), [5.0, 15.0])
        array([4., 2.])
        """
        return self._line(bridge, np.asarray(x, dtype=np.float64))

    @abstractmethod
    def _line(self, bridge: BridgeModel, x: FloatArray) -> FloatArray:
        """See `influence_line`."""

    def _kinks(self, bridge: BridgeModel) -> FloatArray:
        return bridge.kinks(self.section(bridge))

    def _static(self, bridge: BridgeModel, vehicle: Vehicle, tires: FloatArray) -> FloatArray:
        loads = paths_of(vehicle).lane_factors * vehicle.static_loads
        return np.asarray(self._line(bridge, tires) @ loads)

    def _static_places(self, bridge: BridgeModel, vehicle: Vehicle) -> FloatArray:
        """Places of the tires as the vehicle creeps across, shape (n, n_tires).

        Where a tire is at a kink of the influence line is the peak of one of straight pieces.
        """
        paths, length = paths_of(vehicle), bridge.length
        x = np.linspace(0.0, paths.exit(length), FINE)
        at_kinks = paths.passing(self._kinks(bridge), length, 0.0, x[-1])
        return paths.places(np.concatenate([at_kinks, x]), length)


@dataclass(frozen=True, repr=False)
class Moment(AtSection):
    """Bending moment of the bridge at a place [N m], sagging positive.

    Parameters
    ----------
    at : float, optional
        The place, from the start of the bridge [m]; halfway if omitted.
    recovery : {'exact', 'li2006', 'modal'}, optional
        How it is recovered from the truncated modes.

        - 'exact': tire forces through the static influence line plus the inertia and
          damping forces of the modes. A few modes suffice.
        - 'li2006': Eqs. (5)-(8) as printed, for the paper's own numbers.
        - 'modal': curvature of the modes. Converges as 1 / n: for comparison only.

        `bridgectl.model.recovery` has the formulas.
    sense : {'largest', 'smallest'}, optional
        Which peak counts: sagging or hogging.

    Raises
    ------
    TypeError, ValueError
        If an argument is not what is described above.

    References
    ----------
    Y. Li, E. OBrien, A. Gonzalez, J. Sound Vib. 293 (2006) 125-137, Eqs. (5)-(8).

    Examples
    --------
    >>> import bridgectl as bc
    >>> bc.daf(bc.li2006.beam(), bc.li2006.car(), 30.0, effect=bc.Moment(at=10.0)).round(3)
    array([0.981])
    """

    recovery: str = field(default="exact", kw_only=True)
    unit: ClassVar[str] = "N m"
    label: ClassVar[str] = "bending moment"

    def __post_init__(self) -> None:
        super().__post_init__()
        _checks.choice("recovery", self.recovery, RECOVERIES)

    def _rows(self, bridge: BridgeModel, vehicle: Vehicle, tires: FloatArray) -> EffectRows:
        per_force, of_beam = recover_moment(bridge, self.section(bridge), self.recovery, tires)
        return EffectRows(per_force, _of_states(vehicle, of_beam), 0.0)

    def _line(self, bridge: BridgeModel, x: FloatArray) -> FloatArray:
        return bridge.influence_line(x, self.section(bridge))


@dataclass(frozen=True, repr=False)
class Deflection(AtSection):
    """Deflection of the bridge at a place, that of its modes [m], positive downward.

    Parameters
    ----------
    at : float, optional
        The place, from the start of the bridge [m]; halfway if omitted.
    sense : {'largest', 'smallest'}, optional
        Which peak counts: down or up.

    Raises
    ------
    TypeError, ValueError
        If an argument is not what is described above.

    Examples
    --------
    >>> import bridgectl as bc
    >>> bc.daf(bc.li2006.beam(), bc.li2006.car(), 30.0, effect=bc.Deflection()).round(3)
    array([1.166])
    """

    unit: ClassVar[str] = "m"
    label: ClassVar[str] = "deflection"

    def _rows(self, bridge: BridgeModel, vehicle: Vehicle, tires: FloatArray) -> EffectRows:
        shape = bridge.mode_shapes(self.section(bridge) * bridge.length)
        return EffectRows(
            np.zeros_like(tires), _of_states(vehicle, np.kron(shape, [1.0, 0.0])), 0.0
        )

    def _line(self, bridge: BridgeModel, x: FloatArray) -> FloatArray:
        shapes, here = (
            bridge.mode_shapes(x),
            bridge.mode_shapes(self.section(bridge) * bridge.length),
        )
        if np.abs(here).max() < NO_FACTOR * np.abs(shapes).max():  # a rigid support, but round-off
            return np.zeros_like(x)
        # Deflection at the section per force on the crest of each mode.
        return np.asarray(shapes @ (here / (bridge.modal_masses * bridge.omega**2)))


@dataclass(frozen=True, repr=False)
class _Told(AtSection):
    """An effect whose influence line, which may jump, and modal values a bridge tells by a name."""

    quantity: ClassVar[str]

    def _on(self, bridge: BridgeModel, vehicle: Vehicle) -> Self:
        if not isinstance(bridge, TellsEffects):
            raise TypeError(
                f"beam must tell its {self.label} for {self!r}: a bridgectl.Beam, Bridge or "
                f"ModalBridge, got {type(bridge).__name__}"
            )
        return super()._on(bridge, vehicle)

    @abstractmethod
    def _jumps(self, bridge: BridgeModel) -> FloatArray:
        """Places [m] where the influence line jumps."""

    def _kinks(self, bridge: BridgeModel) -> FloatArray:
        jumps = self._jumps(bridge)
        return np.concatenate([super()._kinks(bridge), jumps - JUMP, jumps + JUMP])

    def _line(self, bridge: BridgeModel, x: FloatArray) -> FloatArray:
        """Influence line, straight from one side of a jump to the other."""
        assert isinstance(bridge, TellsEffects)
        section = self.section(bridge)
        line = bridge.influence_line(x, section, self.quantity)
        for jump in self._jumps(bridge):
            here = np.abs(x - jump) < JUMP
            if here.any():
                ends = [jump - JUMP, jump + JUMP]
                sides = bridge.influence_line(ends, section, self.quantity)
                line = np.where(here, np.interp(x, ends, sides), line)
        return np.asarray(line)

    def _rows(self, bridge: BridgeModel, vehicle: Vehicle, tires: FloatArray) -> EffectRows:
        assert isinstance(bridge, TellsEffects)
        of_modes = bridge.modal_effects(self.section(bridge), self.quantity)
        per_force, of_beam = recover(bridge, self._line(bridge, tires), of_modes, tires)
        return EffectRows(per_force, _of_states(vehicle, of_beam), 0.0)


@dataclass(frozen=True, repr=False)
class Shear(_Told):
    """Shear force of the bridge at a place [N], the derivative of the moment along the bridge.

    It jumps as a tire passes: the largest and smallest values are those on either side.

    Parameters
    ----------
    at : float, optional
        The place, from the start of the bridge [m]; halfway if omitted.
    sense : {'largest', 'smallest'}, optional
        Which peak counts.

    Raises
    ------
    TypeError, ValueError
        If an argument is not what is described above.

    Examples
    --------
    >>> import bridgectl as bc
    >>> bc.peak_effect(bc.li2006.beam(), bc.li2006.car(), 20.0, effect=bc.Shear(0.0)).round(-2)
    array([98100.])
    """

    quantity: ClassVar[str] = "shear"
    unit: ClassVar[str] = "N"
    label: ClassVar[str] = "shear force"
    negligible: ClassVar[float] = 3e-6

    def _jumps(self, bridge: BridgeModel) -> FloatArray:
        return np.array([self.section(bridge) * bridge.length])


@dataclass(frozen=True, repr=False)
class Reaction(_Told):
    """Force of a support on the bridge [N], upward.

    Parameters
    ----------
    at : float, optional
        The place of the support, from the start of the bridge [m]; halfway if omitted.
    sense : {'largest', 'smallest'}, optional
        Which peak counts: the smallest may be an uplift.

    Raises
    ------
    TypeError, ValueError
        If an argument is not what is described above.

    Examples
    --------
    The middle support of two spans:

    >>> import bridgectl as bc
    >>> bridge = bc.Bridge([25, 25], 18358, 4.865e10)
    >>> bc.daf(bridge, bc.li2006.car(), 20.0, effect=bc.Reaction(25.0)).round(2)
    array([1.08])
    """

    quantity: ClassVar[str] = "reaction"
    unit: ClassVar[str] = "N"
    label: ClassVar[str] = "support reaction"
    negligible: ClassVar[float] = 3e-6

    def _jumps(self, bridge: BridgeModel) -> FloatArray:
        place = self.section(bridge) * bridge.length
        return np.array([end for end in (0.0, bridge.length) if abs(place - end) < JUMP])


@dataclass(frozen=True, repr=False)
class Stress(Moment):
    """Bending stress of the bridge at a place [N/m^2], tension below positive: M / W.

    Parameters
    ----------
    at : float, optional
        The place, from the start of the bridge [m]; halfway if omitted.
    section_modulus : float
        Elastic section modulus W of the fibre [m^3]; W E of the fibre makes it a strain.
    recovery, sense
        See `Moment`.

    Raises
    ------
    TypeError, ValueError
        If an argument is not what is described above.

    Examples
    --------
    >>> import bridgectl as bc
    >>> stress = bc.Stress(12.5, section_modulus=1.1)
    >>> mpa = bc.peak_effect(bc.li2006.beam(), bc.li2006.car(), 30.0, effect=stress) / 1e6
    >>> print(f"{mpa[0]:.2f} MPa")
    0.63 MPa
    """

    section_modulus: float = field(default=np.nan, kw_only=True)
    unit: ClassVar[str] = "N/m^2"
    label: ClassVar[str] = "bending stress"

    def __post_init__(self) -> None:
        super().__post_init__()
        _checks.positive("section_modulus", self.section_modulus, unit="m^3")

    def _rows(self, bridge: BridgeModel, vehicle: Vehicle, tires: FloatArray) -> EffectRows:
        return super()._rows(bridge, vehicle, tires).scaled(1 / self.section_modulus)

    def _line(self, bridge: BridgeModel, x: FloatArray) -> FloatArray:
        return super()._line(bridge, x) / self.section_modulus


@dataclass(frozen=True, repr=False)
class BridgeAcceleration(AtSection):
    """Acceleration of the bridge at a place, that of its modes [m/s^2], downward.

    Parameters
    ----------
    at : float, optional
        The place, from the start of the bridge [m]; halfway if omitted.
    sense : {'largest', 'smallest'}, optional
        Which peak counts: down or up.

    Raises
    ------
    TypeError, ValueError
        If an argument is not what is described above.

    Examples
    --------
    >>> import bridgectl as bc
    >>> effect = bc.BridgeAcceleration()
    >>> bc.peak_effect(bc.li2006.beam(), bc.li2006.car(), 30.0, effect=effect).round(2)
    array([0.08])
    """

    has_static: ClassVar[bool] = False
    unit: ClassVar[str] = "m/s^2"
    label: ClassVar[str] = "acceleration of the bridge"
    negligible: ClassVar[float] = 0.0  # it is the fastest modes that it shows

    def _rows(self, bridge: BridgeModel, vehicle: Vehicle, tires: FloatArray) -> EffectRows:
        shape = bridge.mode_shapes(self.section(bridge) * bridge.length)
        # q_j'' by the modal equation, of q_j, q_j' and the tire forces.
        rates = [-shape * bridge.omega**2, -2 * shape * bridge.damping_ratios * bridge.omega]
        per_force = bridge.mode_shapes(tires) @ (shape / bridge.modal_masses)
        return EffectRows(per_force, _of_states(vehicle, np.column_stack(rates).ravel()), 0.0)

    def _line(self, bridge: BridgeModel, x: FloatArray) -> FloatArray:
        return np.zeros_like(x)


def _of_states(vehicle: Vehicle, of_beam: FloatArray) -> FloatArray:
    """A row of the beam's states as one of all states."""
    return np.append(np.zeros(2 * vehicle.n_coordinates), of_beam)
