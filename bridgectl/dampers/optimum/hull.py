"""The relaxed crossing: impulses of dampers in the hull of what dampings can do.

An impulse is w = rho v with a <= rho <= 1. Where v is known to lie in [l, u], (v, w) lies in the
hull of two cones, which is linear. So a linear program bounds the peak moment, or the range of any
v, which makes hulls smaller; they are exact where l and u have one sign.

No tolerance of the solver is in a bound. Of min c x, A x <= b, lo <= x <= hi, any prices y >= 0,
however rough, prove::

    c x >= sum_i min(r_i lo_i, r_i hi_i) - b y,   r = c + A' y

Subtracted is what the round-off of this sum can be. That nothing solves A x <= b is proven
likewise, by the prices of the least violation, with c = 0: the sum is above 0.

References
----------
G. P. McCormick, Math. Program. 10 (1976) 147-175, for hulls of products; A. Neumaier and
O. Shcherbina, Math. Program. 99 (2004) 283-296, for safe bounds.
"""

from __future__ import annotations

from collections.abc import Callable
from copy import copy
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import linprog

from bridgectl._checks import FloatArray
from bridgectl.dampers.optimum.impulses import Impulses

EPS = float(np.finfo(float).eps)

LOOSE = 1e-12
"""What hulls are widened by, over the size of their velocities: their slopes are rounded."""

NARROW = 0.02
"""Share of an interval: a solution with a v so near to its end proves that it hardly moves."""

INFEASIBLE = 2
"""Of `scipy.optimize.linprog`."""

OPTIONS: Any = {"presolve": False}
"""Of the solver HiGHS: programs are small and dense, and take longer with presolve."""


class Program(NamedTuple):
    """Rows A x <= b of variables between bounds."""

    rows: FloatArray
    limits: FloatArray
    low: FloatArray
    high: FloatArray

    def least(self, cost: FloatArray) -> tuple[float, FloatArray | None, FloatArray]:
        """Bound of the least cost, a solution, and prices of the rows; infinite without one."""
        found = self._solve(cost)
        if found.status == INFEASIBLE:
            return np.inf if self._void() else -np.inf, None, np.zeros(len(self.limits))
        if found.x is None or found.ineqlin.marginals is None:  # numerical trouble: nothing known
            return -np.inf, None, np.zeros(len(self.limits))
        prices = -found.ineqlin.marginals
        return self.safe(cost, prices), found.x, prices

    def _solve(self, cost: FloatArray) -> Any:
        bounds = np.stack([self.low, self.high], axis=1)
        return linprog(cost, self.rows, self.limits, bounds=bounds, options=OPTIONS)

    def safe(self, cost: FloatArray, prices: FloatArray) -> float:
        """Return the bound that prices prove: see the module's docstring."""
        y = np.maximum(prices, 0.0)
        rest, size = cost + y @ self.rows, np.abs(cost) + y @ np.abs(self.rows)
        largest = np.maximum(np.abs(self.low), np.abs(self.high))
        bound = np.minimum(rest * self.low, rest * self.high).sum() - self.limits @ y
        terms = sum(self.rows.shape) + 4
        return float(bound - 2 * terms * EPS * (size @ largest + np.abs(self.limits) @ y))

    def _void(self) -> bool:
        """Whether it is proven that there is no solution."""
        m, n = self.rows.shape
        eased = Program(
            np.column_stack([self.rows, -np.ones(m)]), self.limits,
            np.append(self.low, 0.0), np.append(self.high, 1e9),
        )  # fmt: skip
        found = eased._solve(np.eye(n + 1)[-1])
        return found.x is not None and self.safe(np.zeros(n), -found.ineqlin.marginals) > 0


class Relaxed(NamedTuple):
    """A solution of a relaxed crossing, if there is one; what counts for nothing in it is 0."""

    impulses: FloatArray
    worth: FloatArray
    """How much of the bound each hull is to blame for: its price times how far w is outside."""


class Hull:
    """Intervals [low, high] of the velocities v of all dampings whose peak is at most `cut`."""

    def __init__(self, crossing: Impulses, cut: float) -> None:
        self.crossing, self.cut, n = crossing, cut, len(crossing.least)
        self.low, self.high = np.zeros(n), np.zeros(n)
        box = np.zeros((2, n))
        for k, rate in enumerate(crossing.rates):
            self.low[k], self.high[k] = _range(rate, box)
            box[:, k] = self._box()[:, k]
        self.floor = _range(crossing.moments, box)[0].max()
        """A bound of the peak; infinite if none is at most the cut."""

    def branch(self, k: int) -> tuple[Hull, Hull]:
        """Both signs of a velocity."""
        halves = copy(self), copy(self)
        for half, low, high in zip(halves, (-np.inf, 0.0), (0.0, np.inf), strict=True):
            half.low, half.high = self.low.copy(), self.high.copy()
            half.low[k], half.high[k] = max(self.low[k], low), min(self.high[k], high)
        return halves

    @property
    def open(self) -> NDArray[np.bool_]:
        """Whether the sign of each v is not known."""
        return (self.low < 0) & (self.high > 0)

    def least_peak(self) -> Relaxed:
        """Raise `floor` to the bound of the peak, infinite if it cannot be at most the cut."""
        nothing = np.zeros(len(self.low))
        if self.floor == np.inf:
            return Relaxed(nothing, nothing)
        n, moments, rows = self._program(self.floor)
        if n == 0:  # no moment is above the floor
            return Relaxed(nothing, nothing)
        of_peak = np.append(np.zeros(len(rows.limits)), -np.ones(len(moments)))
        program = Program(
            np.column_stack([np.vstack([rows.rows, moments[:, :n]]), of_peak]),
            np.append(rows.limits, -moments[:, -1]),
            np.append(rows.low, self.floor), np.append(rows.high, self.cut),
        )  # fmt: skip
        bound, found, prices = program.least(np.eye(n + 1)[-1])
        self.floor = max(self.floor, bound)
        if found is None:
            return Relaxed(nothing, nothing)
        w = nothing.copy()
        w[:n] = found[:n]
        v = self.crossing.rates[:, :-1] @ w + self.crossing.rates[:, -1]
        ends = np.sort([v, self.crossing.least * v], axis=0)
        outside = np.maximum(np.maximum(ends[0] - w, w - ends[1]), 0.0)
        price = np.zeros(len(w))
        price[:n] = prices[: 2 * n].reshape(2, n).sum(axis=0)
        return Relaxed(w, np.where(self.open, outside * (price + EPS), 0.0))

    def tighten(self, late: Callable[[], bool]) -> None:
        """Narrow the intervals of velocities whose sign is not known, one after the other.

        Another sign is only possible while the peak is at most the cut; if nothing is, `floor` is
        infinite.
        """
        seen = np.full((2, len(self.low)), [[np.inf], [-np.inf]])
        for k in np.flatnonzero(self.open):
            n, moments, hulls = self._program(self.cut)
            if k >= n or late():
                return
            rates = self.crossing.rates[:n]
            program = Program(
                np.vstack([hulls.rows, moments[:, :n]]),
                np.append(hulls.limits, self.cut - moments[:, -1]), hulls.low, hulls.high,
            )  # fmt: skip
            near = NARROW * (self.high[k] - self.low[k])
            for sign, ends, held in ((1.0, self.low, seen[0]), (-1.0, self.high, seen[1])):
                if sign * (held[k] - ends[k]) < near:
                    continue
                bound, found, _ = program.least(sign * rates[k, :n])
                ends[k] = sign * max(sign * ends[k], bound + sign * rates[k, -1])
                if found is not None:
                    v = rates[:, :n] @ found + rates[:, -1]
                    seen[0, :n] = np.minimum(seen[0, :n], v)
                    seen[1, :n] = np.maximum(seen[1, :n], v)
            if self.low[k] > self.high[k]:
                self.floor = np.inf
                return

    def _box(self) -> FloatArray:
        """Least and largest impulses, (2, n)."""
        least = self.crossing.least
        return np.stack([
            np.minimum(self.low, least * self.low), np.maximum(self.high, least * self.high)
        ])  # fmt: skip

    def _program(self, level: float) -> tuple[int, FloatArray, Program]:
        """Count of impulses that matter, moments that can be above a level, and rows of hulls."""
        box = self._box()
        moments = self.crossing.moments
        moments = moments[_range(moments, box)[1] > level]
        n = int(np.flatnonzero(moments[:, :-1].any(axis=0)).max(initial=-1)) + 1
        low, high, a = self.low[:n], self.high[:n], self.crossing.least[:n]
        rates = self.crossing.rates[:n]
        size = np.abs(rates) @ np.append(np.abs(box).max(axis=0), 1.0) + high - low
        wide = np.where(self.open[:n], high - low, 1.0)
        least, most = a * low, a * high  # of the cone at the ends
        upper = np.where(self.open[:n], (high - least) / wide, np.where(low >= 0, 1.0, a))
        lower = np.where(self.open[:n], (most - low) / wide, np.where(low >= 0, a, 1.0))
        over = np.where(self.open[:n], least - upper * low, 0.0)
        under = np.where(self.open[:n], low - lower * low, 0.0)
        v, always = rates[:, :n], rates[:, -1]
        rows = np.vstack([
            np.eye(n) - upper[:, np.newaxis] * v, lower[:, np.newaxis] * v - np.eye(n), v, -v
        ])  # fmt: skip
        limits = [over + upper * always, -under - lower * always, high - always, always - low]
        return n, moments, Program(rows, np.ravel(limits + LOOSE * size), box[0, :n], box[1, :n])


def _range(maps: FloatArray, box: FloatArray) -> FloatArray:
    """Least and largest values of affine maps (..., n + 1) over a box (2, n), (2, ...)."""
    ends = maps[..., np.newaxis, :-1] * box
    size = LOOSE * (np.abs(ends).max(axis=-2).sum(axis=-1) + np.abs(maps[..., -1]))
    low, high = ends.min(axis=-2).sum(axis=-1), ends.max(axis=-2).sum(axis=-1)
    return np.stack([low - size, high + size]) + maps[..., -1]
