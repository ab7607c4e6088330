"""A quarter-car on a bridge at one speed, as numbers: what predictions step with.

Steps are of one length h, a whole number of them from the start to the end of the bridge, so that
a prediction is always the same share of a step behind the nodes of its table.
"""

from __future__ import annotations

from functools import cached_property
from typing import Any

import casadi as ca
import numpy as np
from scipy.linalg import expm

from bridgectl._checks import FloatArray
from bridgectl.dampers.costate import REACH
from bridgectl.dampers.peak_value import PeakValue
from bridgectl.model.bridge import state_matrix
from bridgectl.model.crossing import Crossing

STEP = 4e-3
"""Longest step [s]: an axle hop takes 36 of them."""

NEVER = -1e9
"""Added to the effect where it does not count."""

BEHIND = 96
"""Nodes behind the end of the bridge that a step may read."""


class Plant:
    """The numbers of a crossing at a speed [m/s], with the worth of a damper force there."""

    def __init__(self, crossing: Crossing, speed: float, worth: PeakValue) -> None:
        self.crossing, self._worth = crossing, worth
        self.car: Any = crossing.vehicle
        self.load = float(crossing.linear.static_loads[0])
        on_bridge = int(np.ceil(crossing.beam.length / (speed * STEP)))
        self.width = crossing.beam.length / on_bridge
        """Way of a step [m]."""
        self.step = self.width / speed
        """Time of a step [s]."""
        self.entry = int(np.ceil(REACH / self.width))
        """Node at the start of the bridge."""
        self.last = self.entry + on_bridge
        """And at its end."""

    @cached_property
    def nodes(self) -> FloatArray:
        """Places of the nodes [m], which go on behind the end of the bridge."""
        nodes = self.width * (np.arange(self.last + BEHIND) - self.entry)
        nodes[self.last] = self.crossing.beam.length  # to the bit: there it still is
        return np.asarray(nodes)

    @property
    def shapes(self) -> FloatArray:
        """Mode shapes at the nodes, (n_modes, nodes)."""
        return self.crossing.beam.mode_shapes(self.nodes).T

    @cached_property
    def table(self) -> FloatArray:
        """What a step reads, a column for each: at its start, then (from row 3) at its end.

        The worth of a damper force, constant and per velocity of body and axle; the mode shapes,
        and the effect per tire force [1/N] and beside it.
        """
        end, x = self.crossing.beam.length, self.nodes
        on = (x >= 0) & (x <= end)
        rows = self.crossing.rows(np.clip(x, 0.0, end))
        per_force, beside = np.where(
            on, [rows.per_force[:, 0], 0 * x + rows.constant], [[0.0], [NEVER]]
        )
        at_end = np.vstack([self.shapes, per_force, beside])
        return np.vstack([self.worth[:, :-1], at_end[:, 1:]])

    @cached_property
    def worth(self) -> FloatArray:
        """Worth of a damper force, constant and per velocity of body and axle, (3, nodes)."""
        places, *found = self._worth
        return np.array([np.interp(self.nodes, places, each, right=0.0) for each in found])

    @cached_property
    def per_state(self) -> FloatArray:
        """Effect per displacement and velocity of each mode, (n_modes, 2)."""
        return self.crossing.rows(0.0).per_state[self.crossing.n_vehicle :].reshape(-1, 2)

    @cached_property
    def modes(self) -> list[tuple[FloatArray, FloatArray, FloatArray]]:
        """Of each mode what a step makes of its state, and of the force on it at start and end.

        That changes straight between.
        """
        beam, h = self.crossing.beam, self.step
        every = state_matrix(beam)
        found = []
        for j, mass in enumerate(beam.modal_masses):
            straight = np.zeros((4, 4))
            straight[:2, :2] = every[2 * j : 2 * j + 2, 2 * j : 2 * j + 2]
            straight[1, 2], straight[2, 3] = 1 / mass, 1 / h
            moved = expm(straight * h)[:2]
            found.append((moved[:, :2], moved[:, 2] - moved[:, 3], moved[:, 3]))
        return found

    def place(self, position: Any) -> Any:
        """A position [m] in steps behind the first node."""
        return position / self.width + self.entry

    def impulse(self, damping: Any) -> Any:
        """Impulse of a damper in a step per suspension velocity [kg]."""
        body, axle = self.car.sprung_mass, self.car.unsprung_mass
        mass = body * axle / (body + axle)
        return -mass * ca.expm1(-damping * self.step / mass)
