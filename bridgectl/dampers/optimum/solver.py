"""The program of the clairvoyant optimum, as IPOPT solves it: `bridgectl.dampers.optimum`."""

from __future__ import annotations

from typing import Any, NamedTuple

import casadi as ca
import numpy as np
from numpy.typing import NDArray
from scipy import sparse

from bridgectl._checks import FloatArray
from bridgectl.dampers.optimum.ride import RideLimit
from bridgectl.dampers.optimum.steps import Steps, march

PULL = 1e-6
"""Weight of the mean square distance from passive, which decides what the peak leaves open."""

SMALLEST = 1e-6
"""Least size of a state [m, m/s] that it is divided by: on a smooth road some barely move."""

NOT_SOLVED = "not solved: a constant damping, or bridgehook, is the best found"
"""Status where no solution of the solver is lower."""

SOLVER: Any = {
    "print_time": False,
    "ipopt.print_level": 0,
    "ipopt.sb": "yes",
    "ipopt.max_iter": 300,
    # A thousand bounds share the gap to the optimum: at 1e-5 it would show in the DAF.
    "ipopt.tol": 1e-6,
    "ipopt.mu_strategy": "adaptive",
}
"""Options of the solver. Where it stops early its last point is still a damping to simulate."""


class Try(NamedTuple):
    """Dampings to compare, as shares of their range, and the solver's word: see `Steps`."""

    shares: FloatArray
    status: str


class Solver:
    """The bilinear program, for several starts.

    Its variables are states and impulses over their size in the passive crossing, the shares, and
    the peak t.
    """

    def __init__(self, steps: Steps, own: FloatArray, ride: RideLimit | None = None) -> None:
        self.steps, self.ride, passive = steps, ride, march(steps, own)
        n = max(len(state) for state in passive.states)
        largest = np.max([np.pad(abs(x), (0, n - len(x))) for x in passive.states], axis=0)
        self.sizes = np.maximum(largest, SMALLEST)
        self.rate_size = max(float(abs(passive.rates).max()), SMALLEST)
        self.impulse_size = self.rate_size * float(steps.phi(steps.c_max).max())
        self.ends = np.cumsum([0, *(len(state) for state in passive.states[1:])])
        self.n_dampers, self.n_impulses = len(steps.masses), len(steps.held)
        self.n_shares = len(own)
        self.solver, self.n_equal, self.n_below = self._program(own)

    def _program(self, own: FloatArray) -> tuple[Any, int, int]:
        steps = self.steps
        dynamics, always = self._assemble([step.end for step in steps.each[:-1]], 1)
        rates, rates_always = self._assemble([step.rate for step in steps.each], 0)
        moments, moments_always = self._assemble([step.moments for step in steps.each], 0)
        x, z = ca.MX.sym("x", int(self.ends[-1])), ca.MX.sym("z", self.n_impulses)
        share, t = ca.MX.sym("share", self.n_shares), ca.MX.sym("t")
        known = ca.vertcat(x, z)
        least, most = (steps.phi(c)[steps.held] for c in (steps.c_min, steps.c_max))
        which = np.arange(self.n_impulses), steps.held
        ranges = sparse.csc_matrix((most - least, which), (self.n_impulses, self.n_shares))
        phi = ca.DM(least) + ca.DM(ranges) @ share
        v = rates @ known + rates_always
        constraints = ca.vertcat(
            dynamics @ known + always, z - phi * v / self.impulse_size,
            moments @ known + moments_always - t,
        )  # fmt: skip
        if self.ride is not None:
            excess = self.ride.excess(steps, known, self.ends, self.sizes)
            constraints = ca.vertcat(constraints, excess)
        cost = t + PULL / self.n_shares * ca.sumsqr(share - ca.DM(own))
        program: Any = {"x": ca.vertcat(known, share, t), "f": cost, "g": constraints}
        n_equal = dynamics.shape[0] + self.n_impulses
        n_below = constraints.shape[0] - n_equal
        return ca.nlpsol("clairvoyant", "ipopt", program, SOLVER), n_equal, n_below

    def _assemble(self, blocks: list[FloatArray], ends: int) -> tuple[Any, Any]:
        """Stack maps of the steps into one of all states and impulses, and a constant.

        With `ends`, the maps lead to the states at the ends of steps, which are subtracted, and
        the rows are over the sizes of states.
        """
        entries: list[tuple[FloatArray, NDArray[np.intp], NDArray[np.intp]]] = []
        always, row = [], 0
        for k, block in enumerate(blocks):
            m, d = block.shape[0], self.n_dampers
            n = block.shape[1] - d - 1
            rows = row + np.arange(m)
            over = self.sizes[:m, np.newaxis] if ends else np.ones((m, 1))
            columns = self.ends[-1] + d * k + np.arange(d)
            entries.append(_entries(block[:, n:-1] * self.impulse_size / over, rows, columns))
            constant = block[:, -1]
            if k == 0:
                constant = constant + block[:, :n] @ self.steps.initial
            else:
                columns = self.ends[k - 1] + np.arange(n)
                entries.append(_entries(block[:, :n] * self.sizes[:n] / over, rows, columns))
            if ends:
                entries.append(_entries(-np.eye(m), rows, self.ends[k] + np.arange(m)))
            always.append(constant / over[:, 0])
            row += m
        values, i, j = (np.concatenate(part) for part in zip(*entries, strict=True))
        shape = row, int(self.ends[-1]) + self.n_impulses
        matrix = sparse.csc_matrix((values, (i, j)), shape)
        matrix.eliminate_zeros()
        return ca.DM(matrix), ca.DM(np.concatenate(always))

    def solve(self, shares: FloatArray) -> Try:
        """Look for the optimum from a damping."""
        run = march(self.steps, shares)
        states = [state / self.sizes[: len(state)] for state in run.states[1:]]
        guess = np.concatenate([*states, run.impulses / self.impulse_size, shares, [run.peak]])
        low, high = np.full(len(guess), -np.inf), np.full(len(guess), np.inf)
        low[-1 - self.n_shares : -1], high[-1 - self.n_shares : -1] = 0.0, 1.0
        lowest = np.append(np.zeros(self.n_equal), np.full(self.n_below, -np.inf))
        found = self.solver(x0=guess, lbx=low, ubx=high, lbg=lowest, ubg=0.0)
        best = np.clip(np.array(found["x"])[-1 - self.n_shares : -1, 0], 0.0, 1.0)
        if not np.all(np.isfinite(best)):
            return Try(shares, NOT_SOLVED)
        return Try(best, str(self.solver.stats()["return_status"]))


def _entries(
    block: FloatArray, rows: NDArray[np.intp], columns: NDArray[np.intp]
) -> tuple[FloatArray, NDArray[np.intp], NDArray[np.intp]]:
    """Values, rows and columns of a block of a sparse matrix."""
    return block.ravel(), np.repeat(rows, len(columns)), np.tile(columns, len(rows))
