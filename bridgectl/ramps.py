"""Moment histories of unit ramps, in factored form.

The road's slope over one ramp, a pulse, leaves a free response behind. A crossing is cut
into blocks of cells: within a block the response to each of its few ramps is kept as it is;
beyond it, a ramp lives on in the states it leaves at the block's end, and every later
moment is a row times those states. All histories of a speed come from one propagation, and
no transition matrix is ever inverted, so stiff or heavily damped vehicles are no different.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from bridgectl._checks import FloatArray
from bridgectl.peaks import find_peaks, raise_peaks
from bridgectl.propagator import N_STAGES, SAME_PLACE, SAMPLES, Cells, build_cells
from bridgectl.simulation import Run, speed_batches


class Histories(Protocol):
    """Moment histories of a smooth road and of ramps, which superpose."""

    @property
    def nodes(self) -> FloatArray:
        """Positions of the reference tire at the ends of the cells on the bridge [m]."""
        ...

    @property
    def smooth(self) -> FloatArray:
        """Normalized moment on a smooth road at the samples, shape (n_speeds, n_samples)."""
        ...

    def peaks(self, speed: int, drops: float) -> FloatArray:
        """Peak moment with each ramp on its own, so high [m], at one speed, shape (n_ramps,)."""
        ...

    def moments(self, speed: int, drops: FloatArray | float) -> FloatArray:
        """Normalized moment beyond the smooth road's at one speed, at the samples.

        Parameters
        ----------
        speed : int
            Index of the speed.
        drops : ndarray, shape (n_ramps, n_roads), or float
            Height of every ramp of each road, positive for a drop [m]. One number: each ramp
            on its own, that high.

        Returns
        -------
        ndarray, shape (n_samples, n_roads) or (n_samples, n_ramps)
        """
        ...


@dataclass(frozen=True)
class DenseHistories:
    """Histories kept one by one, as simulating every ramp gives them.

    `smooth` has shape (n_speeds, n_samples), `unit` (n_speeds, n_samples, n_ramps) for ramps
    1 m high.
    """

    nodes: FloatArray
    smooth: FloatArray
    unit: FloatArray

    def peaks(self, speed: int, drops: float) -> FloatArray:
        """See `Histories.peaks`."""
        return find_peaks(self.moments(speed, drops) + self.smooth[speed][:, np.newaxis]).values

    def moments(self, speed: int, drops: FloatArray | float) -> FloatArray:
        """See `Histories.moments`."""
        unit = self.unit[speed]
        return unit @ drops if isinstance(drops, np.ndarray) else unit * drops


@dataclass(frozen=True)
class FactoredHistories:
    """Histories as products of rows and states, block by block.

    Axis names: S speeds, B blocks, T samples in a block, N ramps, L ramps at work in a block,
    n states: vehicle, beam, and the road under each tire.

    Attributes
    ----------
    nodes : ndarray
        Positions of the reference tire at the ends of the cells on the bridge [m].
    smooth : ndarray, shape (S, n_samples)
        Normalized moment on a smooth road.
    entry : ndarray, shape (S, n, N)
        States as the reference tire reaches the bridge.
    local : ndarray of int, shape (B, L)
        The ramps at work in each block; N where there are fewer.
    carried, added : ndarray, shapes (S, B, n, n) and (S, B, n, L)
        States at a block's end from those at its start and from its ramps.
    rows, direct : ndarray, shapes (S, B, T + 1, n) and (S, B, T + 1, L)
        Normalized moment at the samples of a block, likewise; the last sample is the first of
        the next block.
    """

    nodes: FloatArray
    smooth: FloatArray
    entry: FloatArray
    local: NDArray[np.intp]
    carried: FloatArray
    added: FloatArray
    rows: FloatArray
    direct: FloatArray

    def moments(self, speed: int, drops: FloatArray | float) -> FloatArray:
        """See `Histories.moments`."""
        if isinstance(drops, np.ndarray):
            blocks = self._of_roads(speed, drops)
        else:
            states = self._states_of_ramps(speed, drops)
            blocks = (
                self._block_of_ramps(speed, drops, block, at_start)
                for block, at_start in enumerate(states)
            )
        return np.concatenate([block[:-1] for block in blocks])[: self.smooth.shape[1]]

    def peaks(self, speed: int, drops: float) -> FloatArray:
        """See `Histories.peaks`. Block by block: the histories are never held whole."""
        per_block, smooth = self.rows.shape[2] - 1, self.smooth[speed]
        states = self._states_of_ramps(speed, drops)
        best = np.full(self.entry.shape[-1], -np.inf)
        blocks = [smooth[i : i + per_block + 1] for i in range(0, len(smooth), per_block)]
        # The highest first: most of the others then hold no peak.
        for block in np.argsort([-samples.max() for samples in blocks]):
            samples = blocks[block]
            if len(samples) > 1:
                moment = self._block_of_ramps(speed, drops, block, states[block])[: len(samples)]
                moment += samples[:, np.newaxis]
                raise_peaks(best, moment)
        return best

    def _states_of_ramps(self, speed: int, drop: float) -> FloatArray:
        """States at the start of each block, of each ramp on its own, (B, n, N + 1)."""
        # One more column takes what the unused places of `local` bring.
        states = np.empty((len(self.local), self.entry.shape[1], self.entry.shape[2] + 1))
        states[0] = np.pad(self.entry[speed] * drop, ((0, 0), (0, 1)))
        for block in range(len(self.local) - 1):
            np.matmul(self.carried[speed, block], states[block], out=states[block + 1])
            states[block + 1][:, self.local[block]] += self.added[speed, block] * drop
        return states

    def _block_of_ramps(
        self, speed: int, drop: float, block: int, states: FloatArray
    ) -> FloatArray:
        """History in a block of each ramp on its own, (T + 1, N)."""
        moment = self.rows[speed, block] @ states
        moment[:, self.local[block]] += self.direct[speed, block] * drop
        return moment[:, :-1]

    def _of_roads(self, speed: int, drops: FloatArray) -> Iterator[FloatArray]:
        """Histories of roads, block by block."""
        states = self.entry[speed] @ drops
        drops = np.pad(drops, ((0, 1), (0, 0)))
        for block, local in enumerate(self.local):
            here = drops[local]
            yield self.rows[speed, block] @ states + self.direct[speed, block] @ here
            states = self.carried[speed, block] @ states + self.added[speed, block] @ here


def factor_histories(
    run: Run, speeds: FloatArray, ramp_length: float, n_ramps: int
) -> FactoredHistories:
    """Propagate all ramps of a crossing at once.

    The ramps start at ``run.start``, `ramp_length` apart.
    """
    nodes = run.nodes(float(speeds.min()))
    entry = int(np.searchsorted(nodes, -SAME_PLACE))
    before, nodes = nodes[: entry + 1], nodes[entry:]
    # About as many blocks as cells in a block: both loops are then short. One cell more than
    # there are holds the last node's sample.
    per_block = max(1, round(np.sqrt(len(nodes))))
    n_blocks = -(-len(nodes) // per_block)
    nodes = np.pad(nodes, (0, n_blocks * per_block + 1 - len(nodes)), mode="edge")
    at_work = _ramps_of_cells(run, nodes, ramp_length, n_ramps)
    local, place = _local_ramps(at_work.reshape(n_blocks, -1), n_ramps)
    share = np.diff(nodes) / ramp_length
    rises = _block_rises(place.reshape(n_blocks, per_block, -1), share, local.shape[1] + 1)

    parts = []
    for batch in speed_batches(run, speeds):
        cells = build_cells(run.crossing, speeds[batch], nodes, on_bridge=True)
        arrived = _entry_states(run, speeds[batch], before, ramp_length, n_ramps)
        parts.append(_factor_blocks(run, cells, rises, arrived))
    smooth, entries, carried, added, rows, direct = (
        np.concatenate(arrays) for arrays in zip(*parts, strict=True)
    )
    n_samples = len(SAMPLES) * (len(nodes) - 2) + 1
    return FactoredHistories(
        nodes[:-1], smooth[:, :n_samples], entries, local, carried, added, rows, direct
    )


def _ramps_of_cells(
    run: Run, nodes: FloatArray, ramp_length: float, n_ramps: int
) -> NDArray[np.intp]:
    """Index of the ramp under each tire in each cell; n_ramps where there is none, (C, tires)."""
    middles = run.crossing.tire_positions((nodes[:-1] + nodes[1:]) / 2)
    index = np.floor((middles - run.start) / ramp_length).astype(np.intp)
    none = (index < 0) | (index >= n_ramps) | (np.diff(nodes) == 0)[:, np.newaxis]
    return np.where(none, n_ramps, index)


def _local_ramps(
    at_work: NDArray[np.intp], n_ramps: int
) -> tuple[NDArray[np.intp], NDArray[np.intp]]:
    """The different ramps of each block (B, L), and where in them each entry of it is.

    Entries without a ramp point past the end, to place L.
    """
    ramps = [np.setdiff1d(row, [n_ramps]) for row in at_work]
    width = max(1, *(len(row) for row in ramps))
    local = np.full((len(ramps), width), n_ramps)
    place = np.full(at_work.shape, width)
    for block, (row, found) in enumerate(zip(at_work, ramps, strict=True)):
        local[block, : len(found)] = found
        real = row < n_ramps
        place[block, real] = np.searchsorted(found, row[real])
    return local, place


def _block_rises(place: NDArray[np.intp], share: FloatArray, n_places: int) -> FloatArray:
    """Rise under each tire in each cell per height of the block's ramps.

    `place` has shape (B, K, tires), the result (B, K, tires, n_places - 1).
    """
    rises = np.zeros((*place.shape, n_places))
    share = np.broadcast_to(share.reshape(*place.shape[:2], 1, 1), (*place.shape, 1))
    np.put_along_axis(rises, place[..., np.newaxis], share, axis=-1)
    return rises[..., :-1]


def _entry_states(
    run: Run, speeds: FloatArray, nodes: FloatArray, ramp_length: float, n_ramps: int
) -> FloatArray:
    """States and road under the tires at the bridge, per height of each ramp before it."""
    crossing, n = run.crossing, run.crossing.n_vehicle
    n_tires = crossing.linear.n_tires
    states = np.zeros((len(speeds), crossing.n_states + n_tires, n_ramps + 1))
    if len(nodes) == 1:
        return states[..., :-1]
    cells = build_cells(crossing, speeds, nodes, on_bridge=False)
    step, from_road = cells.transition()
    at_work = _ramps_of_cells(run, nodes, ramp_length, n_ramps)
    share = np.diff(nodes) / ramp_length
    # Backwards from the bridge: what follows a cell acts on the vehicle states that the cell
    # adds, and on the road that it leaves under the tires.
    after = np.broadcast_to(np.eye(n, n + n_tires), (len(speeds), n, n + n_tires))
    for c in range(len(share) - 1, -1, -1):
        kind, on_states, on_road = cells.map_of[c], after[..., :n], after[..., n:]
        added = on_states @ from_road[:, kind, :, n_tires + 1 :] + on_road
        for tire, ramp in enumerate(at_work[c]):
            states[:, :n, ramp] += share[c] * added[..., tire]
            states[:, crossing.n_states + tire, ramp] += share[c]
        on_road = on_states @ from_road[:, kind, :, :n_tires] + on_road
        after = np.concatenate([on_states @ step[:, kind], on_road], axis=-1)
    return states[..., :-1]


def _factor_blocks(
    run: Run, cells: Cells, rises: FloatArray, entry: FloatArray
) -> tuple[FloatArray, ...]:
    """Run through all blocks at once, from unit states, unit ramps and the static loads.

    The columns of what is propagated are [states, road under the tires, ramps of the block,
    static loads].
    """
    n, n_speeds = cells.n_states, len(cells.free)
    n_blocks, per_block, n_tires, n_local = rises.shape
    carried = slice(n + n_tires)
    ramps = slice(n + n_tires, n + n_tires + n_local)
    road = _block_road_rows(rises, n)
    states = np.zeros((n_speeds, n_blocks, n, road.shape[-1]))
    states[:, :, np.arange(n), np.arange(n)] = 1.0
    n_samples = per_block * len(SAMPLES)
    by_sample = np.empty((n_speeds, n_blocks, n_samples + 1, road.shape[-1]))
    moments = np.empty((n_speeds, n_blocks, per_block, len(SAMPLES), road.shape[-1]))
    node_rows, node_road = _node_moment_rows(run, cells)
    by_block = np.arange(n_blocks * per_block).reshape(n_blocks, per_block)
    beam, q = run.crossing.n_vehicle, N_STAGES * n_tires
    for k in range(per_block):
        cell, kind = by_block[:, k], cells.kind[by_block[:, k]]
        stages = cells.from_states[:, cell] @ states + cells.from_road[:, cell] @ road[:, k]
        moments[:, :, k, 0] = np.einsum("bi,sbiz->sbz", node_rows[cell], states)
        moments[:, :, k, 0] += np.einsum("bi,biz->bz", node_road[cell], road[:, k])
        moments[:, :, k, 1:] = cells.moment_from_states[:, kind] @ states[:, :, beam:]
        moments[:, :, k, 1:] += cells.moment_from_forces[:, cell] @ stages[:, :, :q]
        states = cells.free[:, kind, N_STAGES] @ states + cells.inputs[:, cell] @ stages

    ends = np.zeros((n_speeds, n_blocks, n + n_tires, road.shape[-1]))
    ends[:, :, :n] = states
    ends[:, :, n:, n : n + n_tires] = np.eye(n_tires)
    ends[:, :, n:, ramps] = rises.sum(axis=1)
    by_sample[:, :, :-1] = moments.reshape(n_speeds, n_blocks, n_samples, -1)
    after = by_block[:, -1] + 1
    end_road = road[:, -1].copy()
    end_road[:, :n_tires] += road[:, -1, n_tires + 1 :]
    by_sample[:, :, -1] = np.einsum("bi,sbiz->sbz", node_rows[after], states)
    by_sample[:, :, -1] += np.einsum("bi,biz->bz", node_road[after], end_road)
    smooth, now = [], np.zeros((n_speeds, n + n_tires))
    for rows, end in zip(by_sample.swapaxes(0, 1), ends.swapaxes(0, 1), strict=True):
        smooth.append(rows[:, :-1, -1] + np.einsum("sti,si->st", rows[:, :-1, carried], now))
        now = np.einsum("sij,sj->si", end[..., carried], now) + end[..., -1]
    return (
        np.concatenate(smooth, axis=1),
        entry,
        ends[..., carried],
        ends[..., ramps],
        by_sample[..., carried],
        by_sample[..., ramps],
    )


def _block_road_rows(rises: FloatArray, n_states: int) -> FloatArray:
    """Road rows of the cells (B, K, 2 tires + 1, columns) for the columns of a block."""
    n_tires, n_local = rises.shape[2:]
    first = n_states + n_tires
    tires = np.arange(n_tires)
    rows = np.zeros((*rises.shape[:2], 2 * n_tires + 1, first + n_local + 1))
    rows[:, :, tires, n_states + tires] = 1.0
    rows[:, 1:, :n_tires, first:-1] = np.cumsum(rises, axis=1)[:, :-1]
    rows[:, :, n_tires, -1] = 1.0
    rows[:, :, n_tires + 1 :, first:-1] = rises
    return rows


def _node_moment_rows(run: Run, cells: Cells) -> tuple[FloatArray, FloatArray]:
    """Moment at each node from the states and from the road rows."""
    crossing, vehicle = run.crossing, run.crossing.linear
    starts = cells.nodes
    gain, row = crossing.moment_rows(starts)
    spring = gain * vehicle.tire_stiffnesses
    from_states = np.zeros((len(starts), cells.n_states))
    from_states[:, : crossing.n_vehicle] = spring @ vehicle.hubs
    deflections = np.einsum("ck,ckj->cj", spring, crossing.tire_shapes(starts))
    from_states[:, crossing.n_vehicle :] = row
    from_states[:, crossing.n_vehicle :: 2] -= deflections
    from_road = np.zeros((len(starts), 2 * vehicle.n_tires + 1))
    from_road[:, : vehicle.n_tires] = -spring
    from_road[:, vehicle.n_tires] = gain @ vehicle.static_loads
    return from_states, from_road
