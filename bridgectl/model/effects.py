"""What is read from a crossing: load effects of the bridge, and what the vehicle feels.

An effect is a value: what, where, and of which sense its peak counts, largest or smallest.
"""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from typing import ClassVar, Self

import numpy as np

from bridgectl import _checks
from bridgectl._checks import FloatArray
from bridgectl.model.bridge import BridgeModel
from bridgectl.model.effect import Effect, EffectRows
from bridgectl.model.recovery import RECOVERIES, recover_moment
from bridgectl.model.vehicle import Vehicle, signals

FINE = 2001
"""Places of a vehicle among which the peak of a static effect is looked for, beside the kinks."""


@dataclass(frozen=True, repr=False)
class _AtSection(Effect):
    """An effect at a place of the bridge; halfway if it is left open."""

    at: float | None = None

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


@dataclass(frozen=True, repr=False)
class Moment(_AtSection):
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

    def _static_values(self, bridge: BridgeModel, vehicle: Vehicle) -> FloatArray:
        section = self.section(bridge)
        line = bridge.influence_line(_static_places(bridge, vehicle, section), section)
        return np.asarray(line @ vehicle.static_loads)


@dataclass(frozen=True, repr=False)
class Deflection(_AtSection):
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

    def _static_values(self, bridge: BridgeModel, vehicle: Vehicle) -> FloatArray:
        section = self.section(bridge)
        # Deflection at the section per force on the crest of each mode.
        flexibility = bridge.mode_shapes(section * bridge.length)
        flexibility = flexibility / (bridge.modal_masses * bridge.omega**2)
        shapes = bridge.mode_shapes(_static_places(bridge, vehicle, section))
        return np.asarray((shapes @ flexibility) @ vehicle.static_loads)


@dataclass(frozen=True, repr=False)
class TireForce(Effect):
    """Force of a tire on the road [N].

    Parameters
    ----------
    tire : int, optional
        Which tire, counted from 1.
    sense : {'largest', 'smallest'}, optional
        Which peak counts.

    Raises
    ------
    TypeError, ValueError
        If an argument is not what is described above.

    Examples
    --------
    The least tire force over the static one:

    >>> import bridgectl as bc
    >>> road = bc.utia_road().place_bridge(678).crop(-200, 25).detrend().resample(0.1)
    >>> effect = bc.TireForce(sense="smallest")
    >>> bc.daf(bc.li2006.beam(), bc.li2006.car(), 25.0, road, start=-200, effect=effect).round(2)
    array([0.72])
    """

    tire: int = 1
    unit: ClassVar[str] = "N"
    label: ClassVar[str] = "tire force"

    def __post_init__(self) -> None:
        super().__post_init__()
        _checks.integer("tire", self.tire, at_least=1)

    def _on(self, bridge: BridgeModel, vehicle: Vehicle) -> Self:
        if self.tire > vehicle.n_tires:
            raise ValueError(f"tire must be one of the {vehicle.n_tires} tires, got {self.tire}")
        return self

    def _rows(self, bridge: BridgeModel, vehicle: Vehicle, tires: FloatArray) -> EffectRows:
        per_force = np.zeros_like(tires)
        per_force[..., self.tire - 1] = 1.0
        return EffectRows(per_force, _of_states(vehicle, np.zeros(2 * bridge.n_modes)), 0.0)

    def _static_values(self, bridge: BridgeModel, vehicle: Vehicle) -> FloatArray:
        return vehicle.static_loads[self.tire - 1 : self.tire]


@dataclass(frozen=True, repr=False)
class BodyAcceleration(Effect):
    """Acceleration of a coordinate of the vehicle [m/s^2], downward: no static load gives any.

    Parameters
    ----------
    coordinate : int, optional
        Which coordinate, counted from 1: of a quarter-car the body, then the axle.
    sense : {'largest', 'smallest'}, optional
        Which peak counts: down or up.

    Raises
    ------
    TypeError, ValueError
        If an argument is not what is described above.

    Examples
    --------
    >>> import bridgectl as bc
    >>> effect = bc.BodyAcceleration()
    >>> bc.peak_effect(bc.li2006.beam(), bc.li2006.car(), 30.0, effect=effect).round(3)
    array([0.007])
    """

    coordinate: int = 1
    unit: ClassVar[str] = "m/s^2"
    label: ClassVar[str] = "acceleration"

    def __post_init__(self) -> None:
        super().__post_init__()
        _checks.integer("coordinate", self.coordinate, at_least=1)

    def _on(self, bridge: BridgeModel, vehicle: Vehicle) -> Self:
        if self.coordinate > vehicle.n_coordinates:
            known = ", ".join(f"{i} for {name}" for i, name in enumerate(vehicle.coordinates, 1))
            raise ValueError(f"coordinate must be {known}, got {self.coordinate}")
        return self

    def _rows(self, bridge: BridgeModel, vehicle: Vehicle, tires: FloatArray) -> EffectRows:
        rate = vehicle.velocities[self.coordinate - 1]
        own, per_force = rate @ vehicle.state_matrix, rate @ vehicle.tire_input
        constant = -float(per_force @ vehicle.static_loads)
        per_state = np.append(own, np.zeros(2 * bridge.n_modes))
        return EffectRows(np.zeros_like(tires) + per_force, per_state, constant)

    def _static_values(self, bridge: BridgeModel, vehicle: Vehicle) -> FloatArray:
        return np.zeros(0)


def as_effect(
    effect: Effect | str,
    bridge: BridgeModel,
    vehicle: Vehicle,
    section: float = 0.5,
    recovery: str = "exact",
) -> Effect:
    """Return the effect that a value, or a name with a section and a recovery, stands for."""
    place = _checks.fraction("section", section, bridge.length)
    _checks.choice("recovery", recovery, RECOVERIES)
    if isinstance(effect, Effect):
        if place != 0.5:
            raise ValueError(
                f"section goes with the name of an effect, got {effect!r} and section={place:g}: "
                f"type for example Moment(at={place * bridge.length:g})"
            )
        if recovery == "exact" or not isinstance(effect, Moment):
            return effect.on(bridge, vehicle)
        if effect.recovery not in ("exact", recovery):
            raise ValueError(f"recovery is {recovery!r} and that of {effect!r}: leave one out")
        return replace(effect, recovery=recovery).on(bridge, vehicle)
    at = place * bridge.length
    named: dict[str, Effect] = {
        "moment": Moment(at, recovery=recovery),
        "deflection": Deflection(at),
        **{
            name: TireForce(tire)
            for tire, name in enumerate(signals("tire_force", vehicle.n_tires), 1)
        },
        "acceleration": BodyAcceleration(),
    }
    if not isinstance(effect, str):
        raise TypeError(
            f"effect must be one of {', '.join(map(repr, named))}, or as Moment(at=12.5), got "
            f"{effect!r}; speeds go with daf(...), crossing_system(...) and others"
        )
    return named[_checks.choice("effect", effect, tuple(named))]


def _of_states(vehicle: Vehicle, of_beam: FloatArray) -> FloatArray:
    """A row of the beam's states as one of all states."""
    return np.append(np.zeros(2 * vehicle.n_coordinates), of_beam)


def _static_places(bridge: BridgeModel, vehicle: Vehicle, section: float) -> FloatArray:
    """Places of the tires as the vehicle creeps across, shape (n, n_tires).

    Where a tire is at a kink of the influence line is the peak of one of straight pieces.
    """
    offsets = vehicle.tire_offsets
    at_kinks = np.add.outer(bridge.kinks(section), offsets).ravel()
    x = np.concatenate([at_kinks, np.linspace(0.0, bridge.length + offsets.max(), FINE)])
    return np.asarray(x[:, np.newaxis] - offsets)
