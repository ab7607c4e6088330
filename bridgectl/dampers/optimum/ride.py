"""A limit of ride that the clairvoyant optimum keeps: rms body acceleration over the crossing."""

from __future__ import annotations

from typing import NamedTuple

import casadi as ca
import numpy as np
from scipy import sparse

from bridgectl._checks import FloatArray
from bridgectl.dampers.optimum.steps import March, Steps

ALLOWED = 1e-3
"""Share of the limit that a solution may be above it: the solver's tolerance."""


class RideLimit(NamedTuple):
    """Largest rms acceleration of the body above each leg, each step having its mean one."""

    body: FloatArray
    """Velocities of the body above legs from the vehicle's states, (n_legs, n)."""
    most: float
    """[m/s^2]"""

    def of(self, steps: Steps, run: March) -> float:
        """Return the ride [m/s^2] of the worst leg."""
        n = self.body.shape[1]
        v = np.array([self.body @ state[:n] for state in run.states])
        times = steps.durations[:-1, np.newaxis]
        return float(np.sqrt((np.diff(v, axis=0) ** 2 / times).sum(axis=0) / times.sum()).max())

    def kept(self, steps: Steps, run: March) -> bool:
        """Tell whether a damping keeps it."""
        return self.of(steps, run) <= (1 + ALLOWED) * self.most

    def excess(self, steps: Steps, known: ca.MX, ends: FloatArray, sizes: FloatArray) -> ca.MX:
        """Mean squares of accelerations over that of the limit less 1, from the solver's states.

        States at ends of steps begin at `ends` in what is `known`, over their `sizes`.
        """
        found, n = [], self.body.shape[1]
        times = steps.durations[:-1]
        weights = 1 / np.sqrt(times * times.sum()) / self.most
        count = np.arange(len(times))
        for row in self.body:
            values = np.outer(weights, row * sizes[:n])
            columns = ends[:-1, np.newaxis].astype(int) + np.arange(n)
            rows = np.repeat(count, n)
            shape = len(times), known.shape[0]
            after = sparse.csc_matrix((values.ravel(), (rows, columns.ravel())), shape)
            before = sparse.csc_matrix(
                (values[1:].ravel(), (rows[n:], columns[:-1].ravel())), shape
            )
            start = np.zeros(len(times))
            start[0] = weights[0] * (row @ steps.initial[:n])
            found.append(ca.sumsqr(ca.DM(after - before) @ known - ca.DM(start)) - 1)
        return ca.vertcat(*found)
