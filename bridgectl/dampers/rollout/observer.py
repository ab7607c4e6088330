"""The motion of a bridge, followed from sample to sample by the measured tire force.

Between two samples what a tire force does to a mode changes straight from f_0 to f_1, and so

    q'' + 2 zeta w q' + w^2 q = (f_0 + (f_1 - f_0) t / T) / m

has the solution a + b t and a free motion beside it. A bridge is at rest when the tire comes to it.
"""

from __future__ import annotations

from typing import Any

import casadi as ca
import numpy as np

from bridgectl.dampers.rollout.plant import Plant
from bridgectl.dampers.rollout.table import APART, read
from bridgectl.dampers.sensors import exact
from bridgectl.model.bridge import state_matrix

PARTS = ("displacement", "rate", "force")
"""States of each mode: q [m], q' [m/s] and, as it was at the last sample, f [N]."""


class Observer:
    """The bridge of a plant, as states of a law."""

    def __init__(self, plant: Plant) -> None:
        self.plant, self.beam = plant, plant.crossing.beam
        names = [f"mode_{j + 1}_{part}" for j in range(self.beam.n_modes) for part in PARTS]
        self.states = dict.fromkeys(names, 0.0)
        place = ca.MX.sym("place")
        index = ca.floor(place)
        found = read(plant.shapes, index, place - index, 1)
        self.shapes = ca.Function("shapes", [place], [found], APART)

    def moved(self, s: Any) -> list[Any]:
        """States as they are at this sample, in their order, and the deflection under the tire."""
        shapes, time = self.shapes(self.plant.place(s.position)), s.sample_time
        every = state_matrix(self.beam)
        found, under = [], 0
        for j, mass in enumerate(self.beam.modal_masses):
            q, p, before = (getattr(s, f"mode_{j + 1}_{part}") for part in PARTS)
            now = shapes[j] * s.tire_force
            rate, ratio = float(self.beam.omega[j]), float(self.beam.damping_ratios[j])
            own = every[2 * j : 2 * j + 2, 2 * j : 2 * j + 2]
            grown = exact(own, np.zeros((2, 0)), time)[0]
            b = (now - before) / (time * float(mass) * rate**2)
            a = before / (float(mass) * rate**2) - 2 * ratio / rate * b
            free = ca.mtimes(grown, ca.vertcat(q - a, p - b))
            found += [free[0] + a + b * time, free[1] + b, now]
            under += shapes[j] * found[-3]
        return [found, under]
