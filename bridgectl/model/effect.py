"""What a load effect is: rows on states and tire forces, a static peak, and a sense."""

from __future__ import annotations

from abc import ABC, abstractmethod
from dataclasses import dataclass, field, fields
from typing import ClassVar, NamedTuple, Self

import numpy as np
from numpy.typing import ArrayLike

from bridgectl import _checks
from bridgectl._checks import FloatArray
from bridgectl.model.bridge import BridgeModel
from bridgectl.model.quarter_car import QuarterCar
from bridgectl.model.traffic import paths_of
from bridgectl.model.vehicle import Vehicle

NO_FACTOR = 1e-9
"""Share of the largest static value, either way, below which a static peak is none: round-off."""

SENSES = {"largest": 1.0, "smallest": -1.0}


class EffectRows(NamedTuple):
    """An effect is ``per_force @ R + per_state @ x + constant``."""

    per_force: FloatArray
    """Gain on the tire forces [1/N], shape (..., n_tires)."""
    per_state: FloatArray
    """Gain on vehicle and beam states, the same everywhere, shape (n_states,)."""
    constant: float

    def scaled(self, factor: float) -> EffectRows:
        """Rows of `factor` times the effect."""
        return EffectRows(factor * self.per_force, factor * self.per_state, factor * self.constant)

    def values(self, states: FloatArray, forces: FloatArray) -> FloatArray:
        """Values (..., m) for states (..., m, n) and tire forces (..., m, n_tires)."""
        from_forces = np.einsum("mk,...mk->...m", self.per_force, forces)
        return np.asarray(from_forces + states @ self.per_state + self.constant)


@dataclass(frozen=True, repr=False)
class Effect(ABC):
    """A load effect; of its peaks the largest count, or the smallest."""

    sense: str = field(default="largest", kw_only=True)
    has_static: ClassVar[bool] = True
    """Whether static loads give it any value."""
    negligible: ClassVar[float] = 3e-5
    """Cells need not follow modes that yield less than this share of what a tire does: they hardly
    act back on it, nor does a peak show it by more than 1e-6."""
    felt_by_lane: ClassVar[bool] = False
    """Whether it has the share of tire forces that their lanes have."""
    unit: ClassVar[str]
    label: ClassVar[str]

    def __post_init__(self) -> None:
        _checks.choice("sense", self.sense, tuple(SENSES))

    def __repr__(self) -> str:
        usual = {"sense": "largest", "recovery": "exact", "at": None}
        own = {each.name: getattr(self, each.name) for each in fields(self)}
        said = [
            f"{name}={value:g} m" if name == "at" else f"{name}={value!r}"
            for name, value in sorted(own.items())
            if usual.get(name) != value
        ]
        return f"{type(self).__name__}({', '.join(said)})"

    def on(self, bridge: BridgeModel, vehicle: Vehicle) -> Self:
        """Return the effect with all that it leaves open, checked for a bridge and a vehicle.

        Parameters
        ----------
        bridge, vehicle
            See `bridgectl.Crossing`.

        Returns
        -------
        Effect
        """
        return self._on(bridge, vehicle)

    def rows(self, bridge: BridgeModel, vehicle: Vehicle, tires: FloatArray) -> EffectRows:
        """Rows of the effect with the tires at some places.

        Parameters
        ----------
        bridge, vehicle
            See `bridgectl.Crossing`.
        tires : ndarray, shape (..., n_tires)
            Positions of the tires [m].

        Returns
        -------
        EffectRows
        """
        rows, factors = self._rows(bridge, vehicle, tires), paths_of(vehicle).lane_factors
        if not self.felt_by_lane or np.all(factors == 1):
            return rows
        return rows._replace(per_force=rows.per_force * factors)

    def history(
        self,
        bridge: BridgeModel,
        vehicle: Vehicle,
        tires: FloatArray,
        states: FloatArray,
        forces: FloatArray,
        damper: FloatArray | float = 0.0,
        accelerations: FloatArray | float = 0.0,
    ) -> FloatArray:
        """Return the effect at m places of the vehicle.

        Parameters
        ----------
        bridge, vehicle
            See `bridgectl.Crossing`.
        tires : ndarray, shape (m, n_tires)
            Positions of the tires [m].
        states, forces, damper : ndarray, shapes (n, m), (n_tires, m), (n_dampers, m)
            States [m, m/s], tire forces [N] and forces of controlled dampers [N].
        accelerations : ndarray, shape (m,), optional
            Accelerations of the motion along the road [m/s^2].

        Returns
        -------
        ndarray, shape (m,)
            In the effect's unit [N m, m, N, ...].
        """
        values = self.rows(bridge, vehicle, tires).values(states.T, forces.T)
        values = values + self._per_acceleration(vehicle) * accelerations
        return values + np.dot(self._per_damper(vehicle), damper) if np.any(damper) else values

    def kinks(self, bridge: BridgeModel) -> FloatArray:
        """Return places where the shapes, or what a tire there does to the effect, are not smooth.

        Parameters
        ----------
        bridge
            See `bridgectl.Crossing`.

        Returns
        -------
        ndarray
            Places [m].
        """
        return self._kinks(bridge)

    def static_values(
        self, bridge: BridgeModel, vehicle: Vehicle | QuarterCar, x: ArrayLike
    ) -> FloatArray:
        """Effect of the vehicle's weight alone: what a crossing at a crawl would give.

        Parameters
        ----------
        bridge, vehicle
            See `bridgectl.Crossing`.
        x : array_like
            Positions of the reference tire [m], any shape.

        Returns
        -------
        ndarray
            In the effect's unit [N m, m, N, ...], the shape of `x`; 0 of an acceleration.

        Examples
        --------
        >>> import bridgectl as bc
        >>> hogging = bc.Moment(25.0, sense="smallest")
        >>> bridge = bc.Bridge([25, 25], 18358, 4.865e10)
        >>> hogging.static_values(bridge, bc.li2006.car(), [12.5, 25.0]).round(-2) + 0.0
        array([-229900.,       0.])
        """
        linear, places = vehicle.linear, np.asarray(x, dtype=np.float64)
        effect = self._on(bridge, linear)
        return effect._static(bridge, linear, paths_of(linear).places(places, bridge.length))

    def static_peak(self, bridge: BridgeModel, vehicle: Vehicle) -> float:
        """Largest or smallest value as the vehicle creeps across; 0 where there is none.

        Parameters
        ----------
        bridge, vehicle
            See `bridgectl.Crossing`.

        Returns
        -------
        float
            In the effect's unit [N m, m or N].
        """
        if not self.has_static:
            return 0.0
        values = self._static(bridge, vehicle, self._static_places(bridge, vehicle))
        peak = float(values.max() if self.sense == "largest" else values.min())
        return peak if abs(peak) > NO_FACTOR * np.abs(values).max() else 0.0

    def _on(self, bridge: BridgeModel, vehicle: Vehicle) -> Self:
        return self

    def _kinks(self, bridge: BridgeModel) -> FloatArray:
        return bridge.kinks(0.5)

    @abstractmethod
    def _rows(self, bridge: BridgeModel, vehicle: Vehicle, tires: FloatArray) -> EffectRows:
        """See `rows`."""

    def _static(self, bridge: BridgeModel, vehicle: Vehicle, tires: FloatArray) -> FloatArray:
        """Effect of the static loads with the tires at some places, (...) for (..., n_tires)."""
        return np.zeros(tires.shape[:-1])

    def _static_places(self, bridge: BridgeModel, vehicle: Vehicle) -> FloatArray:
        """Places of the tires, (n, n_tires), among which the static peak is."""
        return -vehicle.tire_offsets[np.newaxis]

    def _per_acceleration(self, vehicle: Vehicle) -> float:
        """What the vehicle's acceleration along the road adds [effect's unit per m/s^2]."""
        return 0.0

    def _per_damper(self, vehicle: Vehicle) -> FloatArray:
        """Gain on the forces of controlled dampers, shape (n_dampers,)."""
        return np.zeros(len(vehicle.damper_map))
