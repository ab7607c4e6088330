"""What is read from a crossing: load effects of the bridge, and what the vehicle feels.

Each effect is a row of the states and tire forces, over the largest value that the same static
loads give it. The acceleration, which has no static value, stays in m/s^2.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from bridgectl._checks import FloatArray
from bridgectl.model.bridge import BridgeModel
from bridgectl.model.recovery import recover_moment
from bridgectl.model.vehicle import Vehicle, signals

FINE = 2001
"""Places of a vehicle among which the largest static deflection is looked for."""


def known_effects(vehicle: Vehicle) -> tuple[str, ...]:
    """Return the names of the effects that a vehicle's crossing has."""
    return ("moment", "deflection", *signals("tire_force", vehicle.n_tires), "acceleration")


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


def effect_rows(
    beam: BridgeModel,
    vehicle: Vehicle,
    section: float,
    recovery: str,
    effect: str,
    tires: FloatArray,
) -> EffectRows:
    """Rows of an effect with the tires at some places.

    Parameters
    ----------
    beam, vehicle, section, recovery
        See `bridgectl.Crossing`.
    effect : {'moment', 'deflection', 'tire_force', 'acceleration'}
        Bending moment [N m] or modal deflection [m] at the section, tire force [N] ('tire_force_1',
        ... of several tires), acceleration of the first vehicle coordinate [m/s^2].
    tires : ndarray, shape (..., n_tires)
        Positions of the tires [m].

    Returns
    -------
    EffectRows
    """
    n_vehicle = 2 * vehicle.n_coordinates
    per_force = np.zeros_like(tires)
    per_state = np.zeros(n_vehicle + 2 * beam.n_modes)
    constant = 0.0
    if effect == "moment":
        per_force, per_state[n_vehicle:] = recover_moment(beam, section, recovery, tires)
    elif effect == "deflection":
        per_state[n_vehicle::2] = beam.mode_shapes(section * beam.length)
    elif effect.startswith("tire_force"):
        per_force[..., _tire(effect)] = 1.0
    else:
        rate = vehicle.velocities[0]
        per_state[:n_vehicle] = rate @ vehicle.state_matrix
        per_force = per_force + rate @ vehicle.tire_input
        constant = -float(rate @ vehicle.tire_input @ vehicle.static_loads)
    return EffectRows(per_force, per_state, constant)


def static_peak(beam: BridgeModel, vehicle: Vehicle, section: float, effect: str) -> float:
    """Largest value of an effect as the vehicle creeps across; 1 where there is none.

    The moment is piecewise linear in the place of the vehicle: its peak has a tire at the
    section. The deflection is that of the same modes.
    """
    offsets, at = vehicle.tire_offsets, section * beam.length
    if effect == "moment":
        tires = at + offsets[:, np.newaxis] - offsets[np.newaxis, :]
        return float(np.max(beam.influence_line(tires, section) @ vehicle.static_loads))
    if effect == "deflection":
        x = np.linspace(0.0, beam.length + offsets.max(), FINE)
        # Deflection at the section per force on the crest of each mode.
        flexibility = beam.mode_shapes(at) / (beam.modal_masses * beam.omega**2)
        line = beam.mode_shapes(x[:, np.newaxis] - offsets) @ flexibility
        return float(np.max(line @ vehicle.static_loads))
    if effect.startswith("tire_force"):
        return float(vehicle.static_loads[_tire(effect)])
    return 1.0


def _tire(effect: str) -> int:
    """Index of the tire that 'tire_force' or 'tire_force_2' names."""
    number = effect.removeprefix("tire_force").lstrip("_")
    return int(number) - 1 if number else 0
