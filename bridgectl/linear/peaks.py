"""Peaks of histories that are sampled at the cells' starts and stages."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import NamedTuple, Protocol

import numpy as np
from numpy.typing import NDArray

from bridgectl._checks import FloatArray
from bridgectl.linear.cells import SAMPLES

_PER_CELL = len(SAMPLES)
_FINE = np.linspace(0.0, 1.0, 33)
KNOTS = np.append(SAMPLES, 1.0)
# Values on the fine grid of the polynomial through a cell's samples and its end.
TO_FINE = np.vander(_FINE, len(KNOTS)) @ np.linalg.inv(np.vander(KNOTS))


WAVES = 3.0
"""Margins of histories below the largest sample that cells count in whose samples miss waves."""


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


class Between(Protocol):
    """Samples of histories in between: `pieces` cells in the place of each."""

    @property
    def pieces(self) -> int:
        """How many; 1 where histories are smooth in each cell."""

    def __call__(self, cells: NDArray[np.intp], columns: NDArray[np.intp]) -> Iterator[FloatArray]:
        """Samples (6 pieces + 1, some) of cells of some columns, a part of them after the other."""


def find_peaks(histories: FloatArray, between: Between | None = None) -> Peaks:
    """Find the largest value of each history, (6 n_cells + 1, n_histories), between samples too.

    They are values at `bridgectl.linear.cells.sample_positions`. A history may have kinks at the
    nodes and is smooth within a cell, where the polynomial through its seven samples stands for it;
    or `between` tells what is between.
    """
    fine = between is not None and between.pieces > 1
    # Within the margin of the largest sample another cell may hold the peak.
    room = (WAVES if fine else 1.0) * margins(histories)
    cells, columns = candidates(histories, histories.max(axis=0) - room)
    if between is not None and fine:
        columns, cells = _once(columns, cells)
        values, fractions = _fine_peaks(between, cells, columns)
    else:
        values, fractions = _polynomial_peaks(_around(histories, cells, columns))
    best = _best(values, columns, histories.shape[1])
    return Peaks(values[best], cells[best], fractions[best])


def highest(windows: Sequence[tuple[int, FloatArray]], between: Between) -> FloatArray:
    """Largest values of histories that are known in windows: cells from a first one on."""
    tops, rooms = (
        np.max([of(histories) for _, histories in windows], axis=0)
        for of in (lambda histories: histories.max(axis=0), margins)
    )
    found = []
    for first, histories in windows:
        cells, columns = candidates(histories, tops - WAVES * rooms)
        found.append((columns, cells + first))
    columns, cells = _once(*np.concatenate(found, axis=1))
    values, _ = _fine_peaks(between, cells, columns)
    return values[_best(values, columns, len(tops))]


def _once(
    columns: NDArray[np.intp], cells: NDArray[np.intp]
) -> tuple[NDArray[np.intp], NDArray[np.intp]]:
    """Each pair once, in rising order."""
    width = cells.max() + 1
    return np.divmod(np.unique(columns * width + cells), width)


def _best(values: FloatArray, columns: NDArray[np.intp], count: int) -> NDArray[np.intp]:
    """Which of the values is the largest of each column."""
    order = np.lexsort((values, columns))
    return order[np.searchsorted(columns[order], np.arange(count), side="right") - 1]


def _fine_peaks(
    between: Between, cells: NDArray[np.intp], columns: NDArray[np.intp]
) -> tuple[FloatArray, FloatArray]:
    """Peaks of cells, and by where in each, from what is between its samples."""
    found = [find_peaks(samples) for samples in between(cells, columns)]
    values, pieces, fractions = (np.concatenate(of) for of in zip(*found, strict=True))
    return values, (pieces + fractions) / between.pieces


def candidates(
    histories: FloatArray, enough: FloatArray
) -> tuple[NDArray[np.intp], NDArray[np.intp]]:
    """Cells that have enough to hold the peak of a history, and its column."""
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
    return cells[inside], columns[inside]


def _around(
    histories: FloatArray, cells: NDArray[np.intp], columns: NDArray[np.intp]
) -> FloatArray:
    """Samples of cells and the next one's first, (7, n)."""
    return histories[_PER_CELL * cells + np.arange(_PER_CELL + 1)[:, np.newaxis], columns]


def raise_peaks(best: FloatArray, histories: FloatArray) -> None:
    """Raise, in place, the largest values of histories so far by those of a further stretch.

    Shapes (n_histories,) and, as in `find_peaks`, (6 n_cells + 1, n_histories).
    """
    enough = np.maximum(histories.max(axis=0), best) - margins(histories)
    cells, columns = candidates(histories, enough)
    if cells.size:
        np.maximum.at(best, columns, _polynomial_peaks(_around(histories, cells, columns))[0])


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


def _polynomial_peaks(samples: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Peak and its place in [0, 1] of polynomials given by their samples, shape (7, n)."""
    return tops(TO_FINE @ samples)


def tops(fine: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Peak and its place in [0, 1] of polynomials given by values at even steps, (33, n)."""
    top, each = fine.argmax(axis=0), np.arange(fine.shape[1])
    inner = np.clip(top, 1, len(_FINE) - 2)
    before, at, after = (fine[inner + shift, each] for shift in (-1, 0, 1))
    bend = before - 2 * at + after
    shift = np.divide(before - after, 2 * bend, out=np.full_like(bend, np.inf), where=bend < 0)
    # The parabola's top counts inside the cell: near its ends the cell next door has it.
    inside = np.abs(shift) <= 1
    shift = np.where(inside, shift, top - inner)
    values = np.where(inside, at - (before - after) * shift / 4, fine[top, each])
    return values, (inner + shift) * _FINE[1]
