"""A descent over blocks of intervals: the optimum's other search, `bridgectl.dampers.optimum`.

The best damping is at one or the other of its bounds, and a solver that follows gradients stays
with the switches that it once has. Here a damper takes a bound over a block of intervals, and the
block that lowers the peak moment most is kept, until none does.

All blocks are tried at once: from the states that the crossing has where they begin, states go
through them side by side; what a block changes of them at its end goes on to the highest moments
through their adjoints. That is exact, but for moments which are not among the highest: the best
blocks are checked with all of them, and those that rise too high are of the highest from then on.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from bridgectl._checks import FloatArray
from bridgectl.dampers.optimum.solver import Try
from bridgectl.dampers.optimum.steps import Steps

LENGTHS = (1, 2, 3, 4, 6, 8, 11, 16, 23, 32, 45, 64)
"""Lengths of blocks [intervals]."""

LEAST_GAIN = 1e-6
"""What a block must lower the peak by [-] to be kept."""

NEAR = 0.02
"""How far below the peak [-] the moments are that blocks are tried with from the first."""

CHECKED = 24
"""Blocks that are checked at once with all moments."""

MOST_ROUNDS = 300
"""Rounds that a descent has at most: it is kept wherever it stops."""

MOST_NEAR = 100
"""Moments that blocks are tried with from the first, at most."""

LOWERED = "not solved: a descent over blocks of intervals is the best found"
"""Status where it is lower than all solutions of the solver."""

FLOOR = -1e6
"""A moment where there is none [-]."""


class Closed(NamedTuple):
    """Maps of intervals whose dampings are known, from [states at their start, 1]."""

    end: FloatArray
    """To those at their end, (intervals, n + 1, n + 1)."""
    moments: FloatArray
    """To their moments, (intervals, rows, n + 1)."""


class Blocks(NamedTuple):
    """Blocks that may lower the peak, the best first."""

    bound: FloatArray
    """What the peak is with the highest moments alone."""
    damper: NDArray[np.intp]
    share: FloatArray
    """Of the range of phi: 0 or 1."""
    start: NDArray[np.intp]
    length: NDArray[np.intp]


class Descent:
    """The descent over the steps of a crossing, from several dampings."""

    def __init__(self, steps: Steps) -> None:
        self.steps, n = steps, len(steps.each[-1].end)
        d, most = len(steps.masses), max(len(step.moments) for step in steps.each)
        shape = n + d + 1
        self.end = np.zeros((len(steps.each), n + 1, shape))
        self.end[:, n, -1] = 1.0
        self.rate = np.zeros((len(steps.each), d, shape))
        self.moments = np.zeros((len(steps.each), most, shape))
        self.moments[:, :, -1] = FLOOR
        for k, step in enumerate(steps.each):
            # States of the bridge, which is at rest on the approach, come after the vehicle's.
            own = np.arange(step.end.shape[1])
            own[-d - 1 :] = n + np.arange(d + 1)
            self.end[k, : len(step.end), own] = step.end.T
            self.rate[k][:, own] = step.rate
            self.moments[k, : len(step.moments)] = 0.0
            self.moments[k, : len(step.moments), own] = step.moments.T
        self.initial = np.zeros(n + 1)
        self.initial[: len(steps.initial)], self.initial[-1] = steps.initial, 1.0

    def close(self, shares: FloatArray) -> Closed:
        """Join the steps of each interval, with its dampings."""
        steps, (n_steps, d, shape) = self.steps, self.rate.shape
        least, most = steps.phi(steps.c_min), steps.phi(steps.c_max)
        phi = (least + shares * (most - least))[steps.held].reshape(n_steps, d)
        n, every = shape - d - 1, np.arange(n_steps)
        given = np.zeros((n_steps, shape, n + 1))
        given[:, np.r_[:n, shape - 1], np.arange(n + 1)] = 1.0
        for i in range(d):
            j = np.where(every % 2, d - 1 - i, i)  # the order of `acting`
            v = np.einsum("ks,ksn->kn", self.rate[every, j], given)
            given[every, n + j] = phi[every, j, np.newaxis] * v
        ends, moments = self.end @ given, self.moments @ given
        first = steps.first
        pieces = np.diff(np.append(first, n_steps))
        whole, rows = ends[first], [moments[first]]
        for i in range(1, pieces.max()):
            has = np.flatnonzero(pieces > i)
            more = np.zeros_like(rows[0])
            more[:, :, -1] = FLOOR
            more[has] = moments[first[has] + i] @ whole[has]
            whole[has] = ends[first[has] + i] @ whole[has]
            rows.append(more)
        return Closed(whole, np.concatenate(rows, axis=1))

    def march(self, closed: Closed) -> FloatArray:
        """States at the start of each interval, and at the end."""
        states = [self.initial]
        for end in closed.end:
            states.append(end @ states[-1])
        return np.array(states)

    def lower(self, given: Try) -> Try:
        """Return what the descent comes to from some dampings."""
        grid = given.shares.reshape(-1, len(self.steps.masses)).copy()
        for k in range(MOST_ROUNDS):
            block = _Round(self, grid).best()
            if block is None:
                return Try(grid.ravel(), LOWERED) if k else given
            damper, share, start, length = block
            grid[start : start + length, damper] = share
        return Try(grid.ravel(), LOWERED)


class _Round:
    """All blocks that a damping may be changed in, once."""

    def __init__(self, descent: Descent, grid: FloatArray) -> None:
        self.descent, self.grid = descent, grid
        self.closed = descent.close(grid.ravel())
        self.states = descent.march(self.closed)
        self.moments = _times(self.closed.moments, self.states[:-1])
        self.peak = float(self.moments.max())
        self.others = {
            (damper, share): descent.close(self._with(damper, share).ravel())
            for damper in range(grid.shape[1])
            for share in (0.0, 1.0)
        }

    def _with(self, damper: int, share: float) -> FloatArray:
        grid = self.grid.copy()
        grid[:, damper] = share
        return grid

    def best(self) -> tuple[int, float, int, int] | None:
        """Return the block that lowers the peak most: damper, share, start and length."""
        least = np.sort(self.moments, axis=None)[-min(MOST_NEAR, self.moments.size)]
        high = self.moments >= max(self.peak - NEAR, least)
        while True:
            blocks = self._try(*np.nonzero(high))
            if not len(blocks.bound):
                return None
            peaks, where = self._check(blocks)
            k = int(np.argmin(peaks))
            if peaks[k] < self.peak - LEAST_GAIN:
                return (
                    int(blocks.damper[k]), float(blocks.share[k]), int(blocks.start[k]),
                    int(blocks.length[k]),
                )  # fmt: skip
            high.flat[where] = True

    def _try(self, interval: NDArray[np.intp], row: NDArray[np.intp]) -> Blocks:
        """Try all blocks with some of the moments, in rising order."""
        found = []
        last = int(interval.max()) + 1  # later blocks leave the highest moments as they are
        adjoint = self._adjoint(interval, row, last)
        usual = self.moments[interval, row]
        states = self.states[:last]
        bridge = int(np.argmax(self.moments.max(axis=1) > FLOOR / 2))
        for (damper, share), other in self.others.items():
            end, moments = _places_last(other.end[:last]), _places_last(other.moments[:last])
            now, inside = _places_last(states), np.full(last, -np.inf)
            for length in range(1, min(LENGTHS[-1], last) + 1):
                at = slice(length - 1, last)
                now, inside = now[:, : last - length + 1], inside[: last - length + 1]
                skipped = max(bridge - length + 1, 0)
                rows = _times_last(moments[..., at][..., skipped:], now[:, skipped:]).max(axis=0)
                inside[skipped:] = np.maximum(inside[skipped:], rows)
                now = _times_last(end[..., at], now)
                if length not in LENGTHS:
                    continue
                start = np.arange(now.shape[1])[:, np.newaxis]
                changed = now.T - self.states[length : last + 1]
                after = usual + (adjoint[length : last + 1] @ changed[..., np.newaxis])[..., 0]
                after[(interval >= start) & (interval < start + length)] = FLOOR
                bound = np.maximum(after.max(axis=1), inside)
                keep = np.flatnonzero(bound < self.peak - LEAST_GAIN)
                found.append((bound[keep], damper, share, keep, length))
        bounds = np.concatenate([each[0] for each in found])
        order = np.argsort(bounds, kind="stable")[:CHECKED]
        sizes = [len(each[0]) for each in found]
        parts = [np.repeat([each[i] for each in found], sizes)[order] for i in (1, 2, 4)]
        starts = np.concatenate([each[3] for each in found])[order]
        return Blocks(bounds[order], parts[0], parts[1], starts, parts[2])

    def _adjoint(self, interval: NDArray[np.intp], row: NDArray[np.intp], last: int) -> FloatArray:
        """What a change of states at the start of intervals makes of some later moments."""
        found = np.zeros((last + 1, len(interval), self.states.shape[1]))
        firsts = np.searchsorted(interval, np.arange(last + 1))
        for k in range(last - 1, -1, -1):
            own, later = slice(firsts[k], firsts[k + 1]), slice(firsts[k + 1], None)
            found[k, later] = found[k + 1, later] @ self.closed.end[k]
            found[k, own] = self.closed.moments[k, row[own]]
        return found

    def _check(self, blocks: Blocks) -> tuple[FloatArray, NDArray[np.intp]]:
        """Peaks with all moments, and which moment is the highest of each block."""
        n, count = len(self.closed.end), len(blocks.start)
        states, rows = np.tile(self.descent.initial, (count, 1)), []
        begin = int(blocks.start.min())
        states = np.tile(self.states[begin], (count, 1))
        ends = blocks.start + blocks.length
        for k in range(begin, n):
            end, moments = self.closed.end[k], self.closed.moments[k]
            inside = np.flatnonzero((blocks.start <= k) & (k < ends))
            seen, now = states @ moments.T, states @ end.T
            for i in inside:
                other = self.others[int(blocks.damper[i]), float(blocks.share[i])]
                seen[i], now[i] = other.moments[k] @ states[i], other.end[k] @ states[i]
            rows.append(seen)
            states = now
        before = np.tile(self.moments[:begin, np.newaxis], (1, count, 1))
        every = np.concatenate([before, np.array(rows)])
        flat = np.swapaxes(every, 0, 1).reshape(count, -1)
        where = flat.argmax(axis=1)
        return flat[np.arange(count), where], where


def _places_last(values: FloatArray) -> FloatArray:
    """With places last, products of many small matrices take half the time."""
    return np.ascontiguousarray(np.moveaxis(values, 0, -1))


def _times_last(maps: FloatArray, states: FloatArray) -> FloatArray:
    """Maps (m, n, k) of states (n, k)."""
    return np.einsum("mnk,nk->mk", maps, states)


def _times(maps: FloatArray, states: FloatArray) -> FloatArray:
    """Maps (k, m, n) of states (k, n)."""
    return np.einsum("kmn,kn->km", maps, states)
