"""A crossing as affine maps of the impulses of its dampers, without its states in between.

An impulse is w = z / phi(c_max), of z in `bridgectl.dampers.optimum.steps`: w = rho v, with rho
between phi(c_min) / phi(c_max) and 1.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from bridgectl._checks import FloatArray
from bridgectl.dampers.optimum.steps import Steps, acting, march

LENGTHS = (1, 2, 3, 4, 6, 8, 11, 16, 23, 32, 45, 64, 90, 128, 180, 256)
"""Lengths of blocks [steps] in a descent."""


class Impulses:
    """Maps from [w, 1], with the n free impulses w [m/s] in the order in which they act.

    Dampings are as their shares: see `Steps`. Each is held for one step.
    """

    def __init__(self, steps: Steps, own: FloatArray, known: int) -> None:
        """Of all dampings `own`, by number, the first `known` stay as they are."""
        d, first = len(steps.masses), int(np.searchsorted(steps.held, known)) // len(steps.masses)
        at = [d * k + j for k in range(first, len(steps.each)) for j in acting(k, d)]
        self.which: NDArray[np.intp] = steps.held[at]
        """Of each impulse the damping that it has, by number."""
        self.leg = self.which % d
        """The damper of each."""
        n, most = len(at), steps.phi(steps.c_max)[self.which]
        self.least: FloatArray = steps.phi(steps.c_min)[self.which] / most
        """Smallest rho of each."""
        start = march(steps, own).states[first]
        state = np.zeros((len(start), n + 1))
        state[:, -1] = start
        rates, moments = np.zeros((n, n + 1)), []
        for k, step in enumerate(steps.each[first:]):
            order, own_rows = [*acting(first + k, d)], slice(d * k, d * k + d)
            given = np.vstack([state, np.zeros((d + 1, n + 1))])
            given[-1, -1] = 1.0
            given[len(state) + np.array(order), np.arange(n)[own_rows]] = most[own_rows]
            rates[own_rows] = step.rate[order] @ given
            moments.append(step.moments @ given)
            state = step.end @ given
        self.rates: FloatArray = rates
        """To velocities v [m/s] before each impulse, (n, n + 1)."""
        self.moments: FloatArray = np.vstack(moments)
        """To moments, over the peak static one, (m, n + 1)."""

    def shares(self, w: FloatArray) -> FloatArray:
        """Shares that impulses are, or the nearest that there are, (n,)."""
        v = self.rates[:, :-1] @ w + self.rates[:, -1]
        rho = np.divide(w, v, out=np.ones_like(v), where=v != 0)
        room = np.where(self.least < 1, 1 - self.least, 1.0)
        return np.clip((rho - self.least) / room, 0.0, 1.0)

    def peaks(self, shares: FloatArray) -> FloatArray:
        """Peak moment of dampings (n, count)."""
        least = self.least[:, np.newaxis]
        rho, w = least + (1 - least) * shares, np.zeros_like(shares)
        for k, rate in enumerate(self.rates):
            w[k] = rho[k] * (rate[:k] @ w[:k] + rate[-1])
        peaks: FloatArray = (self.moments[:, :-1] @ w + self.moments[:, -1:]).max(axis=0)
        return peaks

    def lower(self, shares: FloatArray) -> tuple[float, FloatArray]:
        """Descend: the block of one damper and bound that lowers the peak most, until none does."""
        steps = (self.which - self.which.min()) // (self.leg.max() + 1)
        first, last = np.triu_indices(steps.max() + 1)
        common = np.isin(last - first + 1, LENGTHS)
        first, last = first[common], last[common]
        within = (steps[:, np.newaxis] >= first) & (steps[:, np.newaxis] <= last)
        blocks = np.hstack(
            [within & (self.leg == leg)[:, np.newaxis] for leg in range(self.leg.max() + 1)]
        )
        peak = float(self.peaks(shares[:, np.newaxis])[0])
        while True:
            tries = np.hstack([np.where(blocks, c, shares[:, np.newaxis]) for c in (0.0, 1.0)])
            peaks = self.peaks(tries)
            best = int(np.argmin(peaks))
            if peaks[best] >= peak:
                return peak, shares
            peak, shares = float(peaks[best]), tries[:, best]
