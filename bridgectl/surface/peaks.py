"""Peaks of superposed histories, between their samples too."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from bridgectl._checks import FloatArray
from bridgectl.linear.cells import SAMPLES, Cells, bridge_entry, build_cells
from bridgectl.linear.fine import fine_maps, pieces_of
from bridgectl.linear.peaks import WAVES, find_peaks, highest
from bridgectl.linear.runs import Run, prepare, propagate, speed_batches
from bridgectl.surface.factored import FactoredHistories
from bridgectl.surface.histories import Histories, Kept, superposed, under_tires
from bridgectl.surface.ramps import UnitRamps


@dataclass(frozen=True)
class HistoryPeaks:
    """Peaks of histories of a crossing over ramps: the run is that of the smooth road."""

    run: Run
    speeds: FloatArray
    ramp_length: float
    n_ramps: int
    histories: Histories
    kept: Kept = field(default_factory=lambda: Kept({}, []))
    """What is made already."""

    @cached_property
    def pieces(self) -> int:
        """Pieces of a cell that histories are smooth in."""
        return pieces_of(self.run.crossing, float(self.speeds.min()), self.histories.nodes)

    def of_ramps(self, speed: int, drop: float) -> tuple[float, FloatArray]:
        """Peak of the smooth road, and with each ramp on its own, so high [m], at one speed."""
        histories, smooth = self.histories, self.histories.smooth[speed]
        if self.pieces == 1 or not isinstance(histories, FactoredHistories):
            return float(find_peaks(smooth[:, np.newaxis]).values[0]), histories.peaks(speed, drop)
        windows = []
        for first, ramps in histories.windows(speed, drop, WAVES):
            of_smooth = smooth[len(SAMPLES) * first :][: len(ramps), np.newaxis]
            windows.append((first, np.hstack([of_smooth, ramps])))
        # Ramps that no tire has met leave the smooth road's history as it is.
        met = np.any([(each != each[:, :1]).any(axis=0) for _, each in windows], axis=0)
        met[0] = True
        drops = drop * np.eye(self.n_ramps, self.n_ramps + 1, 1)[:, met]
        windows = [(first, each[:, met]) for first, each in windows]
        found = highest(windows, _Between(self, speed, drops))
        peaks = np.full(self.n_ramps, found[0])
        peaks[met[1:]] = found[1:]
        return float(found[0]), peaks

    def of_roads(
        self, speed: int, drops: FloatArray, histories: FloatArray | None = None
    ) -> FloatArray:
        """Peaks of roads of drops [m], (n_ramps, n_roads); the histories if they are known."""
        known = superposed(self.histories, speed, drops) if histories is None else histories
        between = _Between(self, speed, drops) if self.pieces > 1 else None
        return find_peaks(known, between).values

    @cached_property
    def smooth_starts(self) -> FloatArray:
        """States on the smooth road at the start of each block, (S, B, n)."""
        if self.kept.smooth:
            return np.concatenate(self.kept.smooth)
        nodes, approach = self.histories.nodes, self.run.nodes(float(self.speeds.min()), wide=True)
        every = np.concatenate([approach[: bridge_entry(approach)], nodes])
        batches = speed_batches(self.run, self.speeds)
        return np.concatenate(
            [propagate(self.run, self.speeds[batch], every)[-1].states for batch in batches]
        )[:, : -1 : self.per_block]

    @property
    def per_block(self) -> int:
        """Cells of a block."""
        assert isinstance(self.histories, FactoredHistories)
        return -(-(len(self.histories.nodes) - 1) // len(self.histories.local))

    def cells_of(self, speed: int, first: int, last: int) -> tuple[Cells, int, int]:
        """Cells from the first to before the last, among others: from which on, and their speed."""
        kept = self.kept.cells
        begin = max((at for at in kept if at <= speed), default=None)
        if begin is not None and speed - begin < len(kept[begin].free):
            return kept[begin], 0, speed - begin
        nodes, speeds = self.histories.nodes[first : last + 1], self.speeds[speed : speed + 1]
        return build_cells(self.run.crossing, speeds, nodes, on_bridge=True), first, 0


def peaks_of(ramps: UnitRamps, histories: Histories) -> HistoryPeaks:
    """Peaks of the histories of a surface."""
    smooth = ramps.road(np.zeros(len(ramps.positions)))
    run = prepare(ramps._crossing, smooth, -ramps.approach)
    return HistoryPeaks(run, ramps.speeds, ramps.ramp_length, len(ramps.positions), histories)


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
        blocks = cells // self.peaks.per_block
        found = np.empty((len(SAMPLES) * self.pieces + 1, len(cells)))
        for block, states in enumerate(histories.states(self.speed, self.drops)):
            here = np.flatnonzero(blocks == block)
            if here.size:
                found[:, here] = self._within(block, states, cells[here], columns[here])
            if block == blocks.max():
                break
        yield found

    def _within(
        self,
        block: int,
        beyond: FloatArray,
        cells: NDArray[np.intp],
        columns: NDArray[np.intp],
    ) -> FloatArray:
        """Samples of some cells of a block from states at its start."""
        peaks, crossing, nodes = self.peaks, self.peaks.run.crossing, self.peaks.histories.nodes
        first = block * peaks.per_block
        last, forces = int(cells.max()) + 1, 3 * crossing.linear.n_tires
        own, offset, which = peaks.cells_of(self.speed, first, last)
        used, columns = np.unique(columns, return_inverse=True)
        road = self._road(nodes[first : last + 1], used)
        shapes = crossing.tire_shapes(nodes[first : last + 1])
        loads = np.ones_like(road[:-1, :1])
        rows = np.concatenate([road[:-1], loads, np.diff(road, axis=0)], axis=1)
        smooth = peaks.smooth_starts[self.speed, block, :, np.newaxis]
        state = beyond[: crossing.n_states, used] + smooth
        wanted = np.unique(cells)
        speeds = np.full(len(wanted), peaks.speeds[self.speed])
        maps, constant = fine_maps(crossing, speeds, nodes[wanted], nodes[wanted + 1], self.pieces)
        found = np.empty((maps.shape[1], len(cells)))
        for cell in range(first, last):
            c, before = cell - offset, state
            stages = own.to_stages[which, c] @ np.vstack([state, rows[cell - first]])
            state = own.free[which, own.kind[c]] @ state + own.inputs[which, c] @ stages
            if cell in wanted:
                here = np.flatnonzero(cells == cell)
                roads, at = columns[here], cell - first
                ends = (before, state), shapes[at : at + 2], road[at : at + 2]
                known = np.vstack(
                    [
                        before[crossing.n_vehicle :, roads],
                        stages[:forces, roads],
                        *(
                            self._forces(shape, of[:, roads], r[:, roads])
                            for of, shape, r in zip(*ends, strict=True)
                        ),
                    ]
                )
                found[:, here] = maps[np.searchsorted(wanted, cell)] @ known + constant
        return found

    def _forces(self, shapes: FloatArray, states: FloatArray, road: FloatArray) -> FloatArray:
        """Tire forces at a node, (n_tires, n_roads)."""
        crossing, n = self.peaks.run.crossing, self.peaks.run.crossing.n_vehicle
        deflections = shapes @ states[n::2]
        hubs = crossing.linear.hubs @ states[:n]
        return crossing.tire_forces(hubs.T, deflections.T, road.T).T

    def _road(self, nodes: FloatArray, which: NDArray[np.intp]) -> FloatArray:
        """Road of some under the tires at nodes, positive down [m], (C + 1, n_tires, ...)."""
        run, length = self.peaks.run, self.peaks.ramp_length
        starts = run.start + length * np.arange(self.peaks.n_ramps)
        passed = (run.crossing.tire_positions(nodes)[..., np.newaxis] - starts) / length
        return np.asarray(under_tires(run.crossing, passed) @ self.drops[:, which])
