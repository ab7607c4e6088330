"""Peaks of superposed histories, between their samples too."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from bridgectl._checks import FloatArray
from bridgectl.linear.cells import bridge_entry, build_cells
from bridgectl.linear.fine import fine_maps, pieces_of
from bridgectl.linear.peaks import find_peaks
from bridgectl.linear.runs import Run, propagate
from bridgectl.surface.factored import FactoredHistories
from bridgectl.surface.histories import Histories, superposed


@dataclass(frozen=True)
class HistoryPeaks:
    """Peaks of histories of a crossing over ramps: the run is that of the smooth road."""

    run: Run
    speeds: FloatArray
    ramp_length: float
    n_ramps: int
    histories: Histories

    @cached_property
    def pieces(self) -> int:
        """Pieces of a cell that histories are smooth in."""
        return pieces_of(self.run.crossing, float(self.speeds.min()), self.histories.nodes)

    def of_ramps(self, speed: int, drop: float) -> tuple[float, FloatArray]:
        """Peak of the smooth road, and with each ramp on its own, so high [m], at one speed."""
        if self.pieces == 1:
            smooth = find_peaks(self.histories.smooth[speed, :, np.newaxis]).values
            return float(smooth[0]), self.histories.peaks(speed, drop)
        smooth, *ramps = self.of_roads(speed, drop * np.eye(self.n_ramps, self.n_ramps + 1, 1))
        return float(smooth), np.array(ramps)

    def of_roads(
        self, speed: int, drops: FloatArray, histories: FloatArray | None = None
    ) -> FloatArray:
        """Peaks of roads of drops [m], (n_ramps, n_roads); the histories if they are known."""
        known = superposed(self.histories, speed, drops) if histories is None else histories
        between = _Between(self, speed, drops) if self.pieces > 1 else None
        return find_peaks(known, between).values

    @cached_property
    def smooth_states(self) -> FloatArray:
        """States on the smooth road at the nodes on the bridge, (S, C + 1, n)."""
        nodes, approach = self.histories.nodes, self.run.nodes(float(self.speeds.min()), wide=True)
        before = approach[: bridge_entry(approach)]
        return propagate(self.run, self.speeds, np.concatenate([before, nodes]), wide=True)[
            -1
        ].states


@dataclass(frozen=True)
class _Between:
    """What is between the samples of roads at one speed."""

    peaks: HistoryPeaks
    speed: int
    drops: FloatArray

    @property
    def pieces(self) -> int:
        return self.peaks.pieces

    def __call__(self, cells: NDArray[np.intp], columns: NDArray[np.intp]) -> Iterator[FloatArray]:
        """See `Between`; cells rise in each column."""
        histories = self.peaks.histories
        assert isinstance(histories, FactoredHistories)
        per_block = -(-(len(histories.nodes) - 1) // len(histories.local))
        found = np.empty((6 * self.pieces + 1, len(cells)))
        states = dict(enumerate(histories.states(self.speed, self.drops)))
        blocks = cells // per_block
        for block in np.unique(blocks).tolist():
            here = np.flatnonzero(blocks == block)
            self._within(block * per_block, states[block], cells[here], columns[here], found, here)
        yield found

    def _within(
        self, first: int, beyond: FloatArray, cells: NDArray[np.intp], columns: NDArray[np.intp],
        found: FloatArray, places: NDArray[np.intp],
    ) -> None:  # fmt: skip
        """Samples of the cells of a block from its states."""
        peaks, crossing = self.peaks, self.peaks.run.crossing
        last, n, q = int(cells.max()) + 1, crossing.n_states, 3 * crossing.linear.n_tires
        nodes = peaks.histories.nodes[first : last + 1]
        speeds = peaks.speeds[self.speed : self.speed + 1]
        run = build_cells(crossing, speeds, nodes, on_bridge=True)
        passed = crossing.tire_positions(nodes)[..., np.newaxis] - (
            peaks.run.start + peaks.ramp_length * np.arange(peaks.n_ramps)
        )
        road = np.clip(passed / peaks.ramp_length, 0.0, 1.0) @ self.drops
        rows = np.concatenate([road[:-1], np.ones_like(road[:-1, :1]), np.diff(road, axis=0)], 1)
        state = beyond[:n] + peaks.smooth_states[self.speed, first, :, np.newaxis]
        maps = {}
        wanted = np.unique(cells)
        every = fine_maps(
            crossing,
            np.full(len(wanted), speeds[0]),
            peaks.histories.nodes[wanted],
            peaks.histories.nodes[wanted + 1],
            self.pieces,
        )
        maps = dict(zip(wanted.tolist(), every.maps))
        for c in range(last - first):
            stages = run.to_stages[0, c] @ np.vstack([state, rows[c]])
            if first + c in maps:
                own = cells == first + c
                known = np.vstack([state[crossing.n_vehicle :], stages[:q]])[:, columns[own]]
                found[:, places[own]] = maps[first + c] @ known + every.constant
            state = run.free[0, run.kind[c]] @ state + run.inputs[0, c] @ stages
