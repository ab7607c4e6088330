"""Peaks of histories that are sampled at the cells' starts and stages."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from bridgectl._checks import FloatArray
from bridgectl.linear.cells import SAMPLES
from bridgectl.linear.modes import ComplexArray

_PER_CELL = len(SAMPLES)
_KNOTS = np.append(SAMPLES, 1.0)
_TO_POLYNOMIAL = np.linalg.inv(np.vander(_KNOTS))
_FINE = np.linspace(0.0, 1.0, 33)
# Values on the fine grid of the polynomial through a cell's samples and its end.
_TO_FINE = np.vander(_FINE, len(_KNOTS)) @ _TO_POLYNOMIAL

FINE_PHASE = 0.6
"""Phase of what rings between such values [rad]: parabolas then find 0.997 of its peak."""


class Ringing(NamedTuple):
    """What rings in cells faster than their samples tell: the real part of a e^(b s).

    With s the fraction of the cell; `amplitudes` a and `exponents` b have the shape
    (n_cells, n_modes, n_histories), or 1 for the last where all histories ring alike.
    """

    amplitudes: ComplexArray
    exponents: ComplexArray

    def values(
        self, fractions: FloatArray, cells: NDArray[np.intp], histories: NDArray[np.intp]
    ) -> FloatArray:
        """Values at fractions (m,) of one cell of each of some histories (n,), shape (m, n)."""
        if self.amplitudes.shape[-1] == 1:  # of few cells, then
            cells, place = np.unique(cells, return_inverse=True)
            histories = np.zeros_like(cells)
        else:
            place = np.arange(len(cells))
        amplitudes, exponents = (of[cells, :, histories] for of in self)
        waves = np.exp(np.multiply.outer(fractions, exponents))
        return np.asarray((amplitudes * waves).real.sum(axis=-1)[:, place])

    def swing(self) -> FloatArray:
        """How far a history may rise above its samples by its ringing, (n_histories,)."""
        return np.asarray(2 * np.abs(self.amplitudes).sum(axis=1).max(axis=0))

    def shared(self, history: int, cells: slice) -> Ringing:
        """Ringing of one history in some cells, for others that ring alike."""
        return Ringing(*(of[cells, :, history, np.newaxis] for of in self))


class Peaks(NamedTuple):
    """Largest values of some histories and where they are."""

    values: FloatArray
    cells: np.ndarray
    fractions: FloatArray

    def positions(self, nodes: FloatArray) -> FloatArray:
        """Position of each peak, for the nodes of the cells [m]."""
        return np.asarray(
            nodes[self.cells] + self.fractions * (nodes[self.cells + 1] - nodes[self.cells])
        )


def find_peaks(histories: FloatArray, ringing: Ringing | None = None) -> Peaks:
    """Find the largest value of each history, (6 n_cells + 1, n_histories), between samples too.

    They are values at `bridgectl.linear.cells.sample_positions`. A history may have kinks at the
    nodes. Within a cell the polynomial through its seven samples stands for it, or for what it is
    beyond its `ringing`.
    """
    # Within the margin of the largest sample another cell may hold the peak.
    enough = histories.max(axis=0) - _room(histories, ringing)
    # Few samples come near any history's peak: look for those of each history among them.
    high = np.nonzero(histories.max(axis=1) >= enough.min())[0]
    samples, columns = np.nonzero(histories[high] >= enough)
    samples = high[samples]
    cells = samples // _PER_CELL
    n_cells = (len(histories) - 1) // _PER_CELL
    # A sample at a node belongs to the cells on both its sides.
    at_node = samples % _PER_CELL == 0
    cells = np.concatenate([cells, cells[at_node] - 1])
    columns = np.concatenate([columns, columns[at_node]])
    inside = (cells >= 0) & (cells < n_cells)
    cells, columns = cells[inside], columns[inside]

    around = histories[_PER_CELL * cells + np.arange(_PER_CELL + 1)[:, np.newaxis], columns]
    values, fractions = _peaks_of_cells(around, ringing, cells, columns)
    order = np.lexsort((values, columns))
    best = order[np.searchsorted(columns[order], np.arange(histories.shape[1]), side="right") - 1]
    return Peaks(values[best], cells[best], fractions[best])


def raise_peaks(best: FloatArray, histories: FloatArray, ringing: Ringing | None = None) -> None:
    """Raise, in place, the largest values of histories so far by those of a further stretch.

    Shapes (n_histories,) and, as in `find_peaks`, (6 n_cells + 1, n_histories); all ring alike.
    """
    columns = np.nonzero(histories.max(axis=0) + _room(histories, ringing) >= best)[0]
    if columns.size:
        if columns.size < len(best):
            histories = histories[:, columns]
        higher = find_peaks(histories, ringing).values
        best[columns] = np.maximum(best[columns], higher)


def whole_cells(first: int, last: int, n_samples: int) -> tuple[int, int]:
    """Bounds of the samples of the whole cells that samples from `first` to `last` lie in."""
    start = _PER_CELL * max(0, (int(first) - 1) // _PER_CELL)
    return start, min(n_samples, _PER_CELL * (int(last) // _PER_CELL + 1) + 1)


def margins(histories: FloatArray) -> FloatArray:
    """How far a history may rise above its samples, (n_histories,).

    Between samples a smooth history rises above them by an eighth of its second difference;
    this is twice that, and the difference of every other sample.
    """
    first, middle, last = (histories[i::_PER_CELL] for i in range(1, _PER_CELL, 2))
    return np.asarray(np.abs(first - 2 * middle + last).max(axis=0) / 4)


def _room(histories: FloatArray, ringing: Ringing | None) -> FloatArray:
    """How far a history may rise above its samples with what rings in it, (n_histories,)."""
    room = margins(histories)
    return room if ringing is None else room + ringing.swing()


def _peaks_of_cells(
    samples: FloatArray,
    ringing: Ringing | None,
    cells: NDArray[np.intp],
    columns: NDArray[np.intp],
) -> tuple[FloatArray, FloatArray]:
    """Peak and its place in [0, 1] of one cell (n,) of each history, with its samples (7, n)."""
    grid: FloatArray = _FINE
    fine: FloatArray = np.asarray(_TO_FINE @ samples)
    tops = fine
    if ringing is not None:
        n_fine = max(len(_FINE), int(np.abs(ringing.exponents).max() / FINE_PHASE) + 2)
        grid = np.asarray(np.linspace(0.0, 1.0, n_fine), dtype=np.float64)
        beyond = ringing.values(_KNOTS, cells, columns)
        smooth = np.vander(grid, len(_KNOTS)) @ (_TO_POLYNOMIAL @ (samples - beyond))
        fine = np.asarray(smooth + ringing.values(grid, cells, columns))
        tops = _raised(fine)
    top, each = tops.argmax(axis=0), np.arange(samples.shape[1])
    inner = np.clip(top, 1, len(grid) - 2)
    before, at, after = (fine[inner + shift, each] for shift in (-1, 0, 1))
    bend = before - 2 * at + after
    shift = np.divide(before - after, 2 * bend, out=np.full_like(bend, np.inf), where=bend < 0)
    # The parabola's top counts inside the cell: near its ends the cell next door has it.
    inside = np.abs(shift) <= 1
    shift = np.where(inside, shift, top - inner)
    values = np.where(inside, at - (before - after) * shift / 4, fine[top, each])
    return values, (inner + shift) * grid[1]


def _raised(fine: FloatArray) -> FloatArray:
    """Values, and where a parabola through three of them has its top between, that."""
    tops, slope = fine.copy(), (fine[2:] - fine[:-2]) / 2
    bend = fine[2:] - 2 * fine[1:-1] + fine[:-2]
    peak = np.abs(slope) < -bend
    tops[1:-1][peak] -= slope[peak] ** 2 / bend[peak] / 2
    return tops
