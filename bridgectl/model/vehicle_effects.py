"""What a vehicle feels of a crossing: the forces of its tires, and accelerations."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar, Self

import numpy as np

from bridgectl import _checks
from bridgectl._checks import FloatArray
from bridgectl.model.bridge import BridgeModel
from bridgectl.model.effect import Effect, EffectRows
from bridgectl.model.vehicle import Vehicle


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
        return EffectRows(per_force, np.zeros(2 * (vehicle.n_coordinates + bridge.n_modes)), 0.0)

    def _static(self, bridge: BridgeModel, vehicle: Vehicle, tires: FloatArray) -> FloatArray:
        return np.full(tires.shape[:-1], vehicle.static_loads[self.tire - 1])


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
    has_static: ClassVar[bool] = False
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

    def _per_acceleration(self, vehicle: Vehicle) -> float:
        """What the vehicle's acceleration along the road adds to it [dimensionless]."""
        return float(vehicle.velocities[self.coordinate - 1] @ vehicle.pitching)

    def _per_damper(self, vehicle: Vehicle) -> FloatArray:
        return np.asarray(vehicle.velocities[self.coordinate - 1] @ vehicle.damper_input)
