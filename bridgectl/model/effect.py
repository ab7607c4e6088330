"""What a load effect is: rows on states and tire forces, a static peak, and a sense."""

from __future__ import annotations

from abc import ABC, abstractmethod
from dataclasses import dataclass, field, fields
from typing import ClassVar, NamedTuple, Self

import numpy as np

from bridgectl import _checks
from bridgectl._checks import FloatArray
from bridgectl.model.bridge import BridgeModel
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
        return self._rows(bridge, vehicle, tires)

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
        values = self._static_values(bridge, vehicle)
        peak = float(values.max() if self.sense == "largest" else values.min())
        return peak if abs(peak) > NO_FACTOR * np.abs(values).max() else 0.0

    def _on(self, bridge: BridgeModel, vehicle: Vehicle) -> Self:
        return self

    def _kinks(self, bridge: BridgeModel) -> FloatArray:
        return bridge.kinks(0.5)

    @abstractmethod
    def _rows(self, bridge: BridgeModel, vehicle: Vehicle, tires: FloatArray) -> EffectRows:
        """See `rows`."""

    def _static_values(self, bridge: BridgeModel, vehicle: Vehicle) -> FloatArray:
        """Values as the vehicle creeps across, of what static loads give any."""
        raise NotImplementedError
