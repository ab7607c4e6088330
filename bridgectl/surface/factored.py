"""Moment histories as products of rows and states, block by block, and what is read from them.

The road's slope over one ramp, a pulse, leaves a free response behind. A crossing is cut
into blocks of cells: within a block the response to each of its few ramps is kept as it is;
beyond it, a ramp lives on in the states it leaves at the block's end, and every later
moment is a row times those states.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from bridgectl._checks import FloatArray
from bridgectl.linear.cells import SAMPLES
from bridgectl.linear.peaks import margins, raise_peaks, whole_cells

ALL = slice(None)


@dataclass(frozen=True)
class FactoredHistories:
    """Histories as products of rows and states, block by block.

    Axis names: S speeds, B blocks, T samples in a block, N ramps, L ramps at work in a block,
    n states: vehicle, beam, and the road under each tire.
    """

    nodes: FloatArray
    """Positions of the reference tire at the ends of the cells on the bridge [m]."""
    smooth: FloatArray
    """Normalized moment on a smooth road, (S, n_samples)."""
    entry: FloatArray
    """States as the reference tire reaches the bridge, (S, n, N)."""
    local: NDArray[np.intp]
    """The ramps at work in each block, (B, L); N where there are fewer."""
    carried: FloatArray
    """States at a block's end from those at its start, (S, B, n, n)."""
    added: FloatArray
    """And from its ramps, (S, B, n, L)."""
    rows: FloatArray
    """Moment at its samples, the last being the next one's first, from states, (S, B, T + 1, n)."""
    direct: FloatArray
    """And from its ramps, (S, B, T + 1, L)."""

    def moments(self, speed: int, drops: FloatArray | float) -> FloatArray:
        """See `bridgectl.surface.histories.Histories.moments`."""
        if isinstance(drops, np.ndarray):
            blocks = self._of_roads(speed, drops)
        else:
            ramps = RampsApart(self, speed, drops)
            blocks = (ramps.block(block) for block in range(len(self.local)))
        return joined(blocks)[: self.smooth.shape[1]]

    def peaks(self, speed: int, drops: float) -> FloatArray:
        """See `bridgectl.surface.histories.Histories.peaks`."""
        best = np.full(self.entry.shape[2], -np.inf)
        for first, histories in self.windows(speed, drops):
            del first
            raise_peaks(best, histories)
        return best

    def windows(
        self, speed: int, drops: float, waves: float = 1.0
    ) -> Iterator[tuple[int, FloatArray]]:
        """Histories with each ramp on its own where some ramp may have its peak: from which cell.

        Cells have samples on both sides of a peak that is as many margins above them as `waves`.
        """
        per_block, smooth = self.rows.shape[2] - 1, self.smooth[speed]
        ramps = RampsApart(self, speed, drops)
        top = min(int(smooth.argmax()), len(smooth) - 2)
        block, sample = divmod(top, per_block)
        best = (smooth[top] + ramps.block(block, slice(sample, sample + 1))[0]).min()
        # Between samples a moment rises above them by its margin, to which a ramp adds as much as
        # its reach.
        room = waves * (margins(smooth[:, np.newaxis])[0] + 2 * ramps.reach())
        starts = np.arange(0, len(smooth) - 1, per_block)
        tops = np.maximum.reduceat(smooth, starts)
        tops[:-1] = np.maximum(tops[:-1], smooth[starts[1:]])
        tops[-1] = max(tops[-1], smooth[-1])
        near = np.nonzero(tops + room[: len(starts)] >= best)[0]
        # From the highest on: fewer ramps have their peaks in the others.
        for block in near[np.argsort(-tops[near], kind="stable")].tolist():
            samples = smooth[block * per_block : (block + 1) * per_block + 1]
            high = np.nonzero(samples + room[block] >= best)[0]
            if high.size:
                cells = slice(*whole_cells(high[0], high[-1], len(samples)))
                moment = ramps.block(block, cells)
                moment += samples[cells, np.newaxis]
                yield (block * per_block + cells.start) // len(SAMPLES), moment

    def _of_roads(self, speed: int, drops: FloatArray) -> Iterator[FloatArray]:
        """Histories of roads, block by block."""
        here = np.pad(drops, ((0, 1), (0, 0)))[self.local]
        for block, states in enumerate(self.states(speed, drops)):
            yield self.rows[speed, block] @ states + self.direct[speed, block] @ here[block]

    def states(self, speed: int, drops: FloatArray) -> Iterator[FloatArray]:
        """States of roads at the start of each block beyond those of a smooth one, (n, n_roads)."""
        states = self.entry[speed] @ drops
        here = np.pad(drops, ((0, 1), (0, 0)))[self.local]
        for carried, added, own in zip(self.carried[speed], self.added[speed], here, strict=True):
            yield states
            states = carried @ states + added @ own


class RampsApart:
    """Histories of each ramp on its own, as high as `drop` [m], at one speed.

    Ramps that every tire has passed at the entry live on in the entry states alone: the rows of
    each block meet those, through the blocks before it. The others have states at each block.
    """

    def __init__(self, histories: FactoredHistories, speed: int, drop: float) -> None:
        self.local = histories.local
        carried, self.rows = histories.carried[speed], histories.rows[speed]
        entry, added = histories.entry[speed] * drop, histories.added[speed] * drop
        self.direct = histories.direct[speed] * drop
        self.n_passed = min(int(self.local.min()), entry.shape[1])
        self.passed = entry[:, : self.n_passed]
        self.from_entry = self.rows
        # One more column takes what the unused places of `local` bring.
        others = np.zeros((len(entry), entry.shape[1] - self.n_passed + 1))
        others[:, :-1] = entry[:, self.n_passed :]
        self.states = np.zeros((len(self.local), *others.shape))
        started = 1 + np.nonzero(others.any(axis=0))[0].max(initial=-1)
        for block, here in enumerate(self.local - self.n_passed):
            self.states[block, :, :started] = others[:, :started]
            others[:, :started] = carried[block] @ others[:, :started]
            others[:, here] += added[block]
            started = max(started, 1 + here[here < others.shape[1] - 1].max(initial=-1))
        if self.n_passed:
            through = np.eye(len(entry))
            self.from_entry = np.empty_like(self.rows)
            for block, rows in enumerate(self.rows):
                self.from_entry[block] = rows @ through
                through = carried[block] @ through

    def block(self, block: int, samples: slice = ALL) -> FloatArray:
        """Histories in a block, or at some samples of it, (T + 1, N)."""
        others = self.rows[block, samples] @ self.states[block]
        others[:, self.local[block] - self.n_passed] += self.direct[block, samples]
        if self.n_passed == 0:
            return others[:, :-1]
        return np.hstack([self.from_entry[block, samples] @ self.passed, others[:, :-1]])

    def reach(self) -> FloatArray:
        """What no ramp exceeds in a block, at samples: a bound, (B,)."""
        others = _largest(self.rows, 1) * _largest(self.states, 2)
        reach = others.sum(axis=1) + _largest(self.direct, (1, 2))
        if self.n_passed:
            passed = _largest(self.from_entry, 1) @ _largest(self.passed, 1)
            reach = np.maximum(reach, passed)
        return np.asarray(reach)


def _largest(values: FloatArray, axis: int | tuple[int, ...]) -> FloatArray:
    """Largest size along axes."""
    return np.asarray(np.maximum(values.max(axis=axis), -values.min(axis=axis)))


def joined(blocks: Iterable[FloatArray]) -> FloatArray:
    """Blocks of samples, each ending where the next begins, as one history."""
    first, *others = blocks
    return np.concatenate([first, *(block[1:] for block in others)])
