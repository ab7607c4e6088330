"""Whether the tire stays on many roads: its force in the linear crossing, from their ramps.

Tire forces superpose as moments do. On the bridge they come from histories of their own; on the
rigid road of the approach every block of ramps acts alike. What comes near to lift-off is left to
a simulation of its own.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import expm

from bridgectl._checks import FloatArray
from bridgectl._places import count_pieces
from bridgectl.linear.nodes import MAX_VEHICLE_PHASE
from bridgectl.linear.runs import Run
from bridgectl.model.traffic import Traffic
from bridgectl.model.vehicle import Vehicle
from bridgectl.model.vehicle_effects import TireForce
from bridgectl.surface.histories import factor_histories, superposed

DOUBTFUL = 0.05
"""Fraction of the static load below which a tire force is looked at more closely.

Between samples, at most 0.4 rad of the vehicle's fastest motion apart, a force that swings by its
static load falls by 0.4^2 / 8 = 0.02 of it.
"""

BLOCK = 64
"""Ramps of the approach treated at once."""


def is_plain(vehicle: Vehicle) -> bool:
    """Whether a vehicle has one tire alone, from the start of the bridge."""
    return vehicle.n_tires == 1 and not isinstance(vehicle, Traffic)


class TireContact:
    """The tire force of a vehicle of one tire, on an approach and a bridge of ramps.

    The ramps are `n_ramps` of one length [m] from ``run.start`` on, and the smooth road of the run
    has stations at their ends; speeds [m/s] have the shape (S,).
    """

    def __init__(self, run: Run, speeds: FloatArray, ramp_length: float, n_ramps: int) -> None:
        self.vehicle, self.durations = run.crossing.linear, ramp_length / speeds
        self.n_before = min(n_ramps, count_pieces(-run.start, ramp_length))
        of_tire = run._replace(crossing=replace(run.crossing, effect=TireForce()))
        self.on_bridge = factor_histories(of_tire, speeds, ramp_length, n_ramps)

    def doubtful(self, speed: int, drops: FloatArray) -> NDArray[np.bool_]:
        """Tell which roads, drops [m] (n_ramps, n_roads), may lift a tire at a speed, by index."""
        least = superposed(self.on_bridge, speed, drops).min(axis=0)
        if self.n_before:
            before = 1 + self._least_change(self.durations[speed], drops[: self.n_before])
            least = np.minimum(least, before)
        return np.asarray(least < DOUBTFUL)

    def doubtful_ramps(self, speed: int, height: float) -> NDArray[np.bool_]:
        """Tell which ramps, each on its own, may lift the tire at one speed, shape (n_ramps,).

        Of ramps on the approach all may if the first may, which acts for the longest time.
        """
        least = superposed(self.on_bridge, speed, height).min(axis=0)
        if self.n_before:
            first = np.zeros((self.n_before, 1))
            first[0] = height
            before = 1 + self._least_change(self.durations[speed], first)
            least[: self.n_before] = np.minimum(least[: self.n_before], before)
        return np.asarray(least < DOUBTFUL)

    def _least_change(self, duration: float, drops: FloatArray) -> FloatArray:
        """Least change of the tire force on the approach, over its static load, (n_roads,)."""
        n_blocks = -(-len(drops) // BLOCK)
        drops = np.pad(drops, ((0, n_blocks * BLOCK - len(drops)), (0, 0)))
        from_state, from_drops, step, added = self._block(duration)
        state = np.zeros((len(step), drops.shape[1]))
        least = np.full(drops.shape[1], np.inf)
        for here in drops.reshape(n_blocks, BLOCK, -1):
            force = from_state @ state
            force += from_drops @ here
            np.minimum(least, force.min(axis=0), out=least)
            state = step @ state + added @ here
        return least

    def _block(self, duration: float) -> tuple[FloatArray, FloatArray, FloatArray, FloatArray]:
        """Maps of a block of ramps: force at samples, and state at its end.

        From the state [vehicle, road under the tire] at its start and from its drops.
        """
        vehicle = self.vehicle
        n = 2 * vehicle.n_coordinates
        chain = np.zeros((n + 2, n + 2))  # vehicle, road under the tire, its rate
        chain[:n, :n] = vehicle.state_matrix_on_tires()
        chain[:n, n] = vehicle.road_input[:, 0]
        chain[n, n + 1] = 1 / duration
        chain[:n, n + 1] = vehicle.road_input[:, 0] * vehicle.tire_lags[0] / duration
        fastest = np.abs(np.linalg.eigvals(chain)).max()
        n_samples = max(1, int(np.ceil(fastest * duration / MAX_VEHICLE_PHASE)))
        # With tire damping forces jump as a ramp begins.
        first = 0 if vehicle.tire_lags[0] else 1
        parts = np.arange(first, n_samples + 1) / n_samples * duration
        within = expm(chain * parts[:, np.newaxis, np.newaxis])[:, : n + 1]
        scale = float(vehicle.tire_stiffnesses[0] / vehicle.static_loads[0])
        read = scale * np.append(vehicle.leading_hubs, -1.0)
        step, ramp = within[-1, :, : n + 1], within[-1, :, n + 1]
        powers = [np.eye(n + 1)]
        for _ in range(BLOCK):
            powers.append(step @ powers[-1])
        after = np.array(powers)
        from_state = (read @ within[:, :, : n + 1]) @ after[:-1]  # (BLOCK, n_samples, n + 1)
        late = from_state @ ramp  # at samples of the ramps that follow one
        own = read @ within[:, :, n + 1].T - scale * vehicle.tire_lags[0] / duration
        response = np.vstack([own, late[:-1]])
        lag = np.subtract.outer(np.arange(BLOCK), np.arange(BLOCK))
        from_drops = np.where(lag[..., np.newaxis] >= 0, response[lag], 0.0).swapaxes(1, 2)
        added = (after[BLOCK - 1 :: -1] @ ramp).T
        return from_state.reshape(-1, n + 1), from_drops.reshape(-1, BLOCK), after[-1], added
