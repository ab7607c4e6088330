"""Moment histories of unit ramps: what superposes, and the propagation that gives all of them.

All histories of a speed come from one propagation, in the factored form of
`bridgectl.surface.factored`, and no transition matrix is ever inverted, so stiff or heavily damped
vehicles are no different.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, NamedTuple, Protocol

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import expm

from bridgectl._checks import FloatArray
from bridgectl._places import SAME_PLACE, even_places
from bridgectl.linear.cells import SAMPLES, Cells, bridge_entry, build_cells
from bridgectl.linear.peaks import find_peaks
from bridgectl.linear.runs import BESIDE, Run, speed_batches
from bridgectl.model.crossing import Crossing
from bridgectl.model.vehicle import Vehicle
from bridgectl.surface.factored import FactoredHistories, joined

BATCH_BYTES = 16e6
"""Memory of the maps of the speeds treated at once: as much again goes into their products."""


KEPT_BYTES = 64e6
"""Memory of the maps that are kept until the peaks are found."""


class Kept(NamedTuple):
    """What is kept of making histories until their peaks are found."""

    cells: dict[int, Cells]
    """By the first of their speeds, as far as they take little memory."""
    smooth: list[FloatArray]
    """States on the smooth road at the start of each block, (S, B, n), of all speeds in order."""


class Histories(Protocol):
    """Moment histories of a smooth road and of ramps, which superpose."""

    @property
    def nodes(self) -> FloatArray:
        """Positions of the reference tire at the ends of the cells on the bridge [m]."""

    @property
    def smooth(self) -> FloatArray:
        """Normalized moment on a smooth road at the samples, shape (n_speeds, n_samples)."""

    def peaks(self, speed: int, drops: float) -> FloatArray:
        """Peak moment with each ramp on its own, so high [m], at one speed, shape (n_ramps,)."""

    def moments(self, speed: int, drops: FloatArray | float) -> FloatArray:
        """Normalized moment beyond the smooth road's at one speed, by its index, at the samples.

        Drops [m], the heights of every ramp of each road, have the shape (n_ramps, n_roads), what
        is returned (n_samples, n_roads). With one number each ramp is on its own, that high:
        (n_samples, n_ramps).
        """


def superposed(histories: Histories, speed: int, drops: FloatArray | float) -> FloatArray:
    """Return `Histories.moments` with the smooth road's: the histories of whole roads."""
    history = histories.moments(speed, drops)
    history += histories.smooth[speed][:, np.newaxis]
    return history


class FeedbackHistories:
    """What stands for the histories of a semi-active damper, whose responses do not superpose."""

    def __init__(self, damper: str) -> None:
        self.damper = damper

    @property
    def nodes(self) -> FloatArray:
        """See `smooth`."""
        return self.smooth

    @property
    def smooth(self) -> FloatArray:
        """None are kept: superposing them would be wrong."""
        raise ValueError(
            f"the histories of a crossing with {self.damper} do not superpose: estimate its DAF by "
            "surface.dae(road), or simulate it, bridgectl.daf(beam, vehicle, speeds, road, "
            "damper=...)"
        )

    def peaks(self, speed: int, drops: float) -> FloatArray:
        """See `smooth`."""
        return self.smooth

    def moments(self, speed: int, drops: FloatArray | float) -> FloatArray:
        """See `smooth`."""
        return self.smooth


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
        return find_peaks(superposed(self, speed, drops)).values

    def moments(self, speed: int, drops: FloatArray | float) -> FloatArray:
        """See `Histories.moments`."""
        unit = self.unit[speed]
        return unit @ drops if isinstance(drops, np.ndarray) else unit * drops


def factor_histories(
    run: Run,
    speeds: FloatArray,
    ramp_length: float,
    n_ramps: int,
    kept: Kept | None = None,
) -> FactoredHistories:
    """Propagate all ramps of a crossing at once.

    The ramps start at ``run.start``, `ramp_length` apart.
    """
    nodes = run.nodes(float(speeds.min()), wide=True)
    entry = bridge_entry(nodes)
    nodes = nodes[entry:]
    # About as many blocks as cells in a block: both loops are then short. Cells beyond the exit
    # fill the last block; nothing reads them.
    n_cells = len(nodes) - 1
    per_block = max(1, round(np.sqrt(n_cells)))
    n_blocks = -(-n_cells // per_block)
    beyond = np.arange(1, n_blocks * per_block - n_cells + 1) * (nodes[-1] - nodes[-2])
    nodes = np.append(nodes, nodes[-1] + beyond)
    at_work = _ramps_of_cells(run, nodes, ramp_length, n_ramps)
    at_work = at_work.reshape(n_blocks, per_block, -1)
    share = np.diff(nodes)[:, np.newaxis] / ramp_length * run.crossing.paths.signs
    share = share.reshape(at_work.shape)
    if run.jumps:
        at_work, share = _with_next(at_work), _with_next(share)
    local, place = _local_ramps(at_work.reshape(n_blocks, -1), n_ramps)
    rises = _block_rises(place.reshape(at_work.shape), share, local.shape[1] + 1)

    parts = []
    for batch in speed_batches(run, speeds, BATCH_BYTES):
        cells = build_cells(run.crossing, speeds[batch], nodes, on_bridge=True)
        arrived = _entry_states(run, speeds[batch], ramp_length, n_ramps)
        starts, *part = _factor_blocks(run, speeds[batch], cells, rises, arrived)
        parts.append(part)
        if kept is not None:
            kept.smooth.append(starts)
            if batch.stop * cells.size / len(cells.free) < KEPT_BYTES:
                kept.cells[batch.start] = cells
    smooth, entries, carried, added, rows, direct = (
        np.concatenate(arrays) for arrays in zip(*parts, strict=True)
    )
    nodes = nodes[: n_cells + 1]
    if run.jumps:  # there are cells in between: see `runs.connected`
        nodes = np.repeat(nodes, 2)[1:-1]
    n_samples = len(SAMPLES) * (len(nodes) - 1) + 1
    smooth = np.array([joined(blocks)[:n_samples] for blocks in smooth])
    return FactoredHistories(nodes, smooth, entries, local, carried, added, rows, direct)


def _ramps_of_cells(
    run: Run, nodes: FloatArray, ramp_length: float, n_ramps: int
) -> NDArray[np.intp]:
    """Index of the ramp under each tire in each cell; n_ramps where there is none, (C, tires)."""
    middles = run.crossing.tire_positions((nodes[:-1] + nodes[1:]) / 2)
    index = np.floor((middles - run.start) / ramp_length).astype(np.intp)
    none = (index < 0) | (index >= n_ramps)
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

    `place` and `share` have shape (B, K, tires), the result (B, K, tires, n_places - 1).
    """
    rises = np.zeros((*place.shape, n_places))
    np.put_along_axis(rises, place[..., np.newaxis], share[..., np.newaxis], axis=-1)
    return rises[..., :-1]


def _entry_states(run: Run, speeds: FloatArray, ramp_length: float, n_ramps: int) -> FloatArray:
    """States and road under the tires at the bridge, per height of each ramp before it.

    On the rigid road of the approach the vehicle is time-invariant: what a ramp leaves behind
    goes on alike, wherever it lies.
    """
    crossing, n = run.crossing, run.crossing.n_vehicle
    vehicle = crossing.linear
    states = np.zeros((len(speeds), crossing.n_states + vehicle.n_tires, n_ramps))
    starts = even_places(run.start, ramp_length, n_ramps)
    past = (crossing.tire_positions(0.0)[:, np.newaxis] - starts) / ramp_length
    # Ends of ramps under a tire at the entry are passed, but for round-off.
    past = np.where(np.abs(past - np.round(past)) * ramp_length < SAME_PLACE, np.round(past), past)
    states[:, crossing.n_states :] = under_tires(crossing, past)
    duration = ramp_length / speeds
    for tire, (ramps, sign) in enumerate(zip(past, crossing.paths.signs, strict=True)):
        # From the other end the last ramp is met first, and rises where others fall.
        if sign < 0:
            ramps = 1 - ramps[::-1]
        left = _left_by_ramps(vehicle, tire, ramps, duration)
        states[:, :n] += sign * left[..., :: int(sign)]
    return states


def _left_by_ramps(
    vehicle: Vehicle, tire: int, ramps: FloatArray, duration: FloatArray
) -> FloatArray:
    """States of the vehicle per height of ramps that a tire has met, (S, n, n_ramps).

    It is past so much of each of the `ramps`, of which one takes it so long [s], (S,).
    """
    n = 2 * vehicle.n_coordinates
    states = np.zeros((len(duration), n, len(ramps)))
    # Vehicle, road under the tire and its rate of climb: a ramp is a unit of the last.
    chain = np.zeros((n + 2, n + 2))
    chain[:n, :n] = vehicle.state_matrix_on_tires()
    chain[:n, n] = vehicle.road_input[:, tire]
    on_ramp = chain.copy()
    on_ramp[n, n + 1] = 1.0
    on_ramp[:n, n + 1] = vehicle.road_input[:, tire] * vehicle.tire_lags[tire]
    climbed = np.nonzero(ramps >= 1)[0]
    if climbed.size:
        left = _expm(on_ramp, duration)[..., n + 1 :] / duration[:, np.newaxis, np.newaxis]
        last = _expm(chain, duration * (ramps[climbed[-1]] - 1)) @ left
        states[..., : climbed.size] = _repeated(last, _expm(chain, duration), climbed.size)[:, :n]
    for ramp in np.nonzero((ramps > 0) & (ramps < 1))[0]:
        part = _expm(on_ramp, duration * ramps[ramp])[:, :n, n + 1]
        states[..., ramp] = part / duration[:, np.newaxis]
    return states


def under_tires(crossing: Crossing, past: FloatArray) -> FloatArray:
    """Road under tires per height of ramps of which they are past so much, (..., tires, ramps).

    Tires from the other end have all ramps ahead of them, and count from beyond.
    """
    beyond = crossing.paths.signs[:, np.newaxis] < 0
    return np.clip(past, 0.0, 1.0) - beyond


def _expm(matrix: FloatArray, durations: FloatArray) -> FloatArray:
    """Matrix exponential for each duration, (S, n, n)."""
    return np.asarray(expm(matrix * durations[:, np.newaxis, np.newaxis]))


def _repeated(last: FloatArray, step: FloatArray, count: int) -> FloatArray:
    """States (S, n, count) of which each is `step` times the one after it, and the last given."""
    states = np.empty((*last.shape[:2], count))
    states[..., -1:] = last
    known = 1
    while known < count:  # twice as many with each product
        more = min(known, count - known)
        states[..., count - known - more : count - known] = step @ states[..., count - more :]
        step = step @ step
        known += more
    return states


def _factor_blocks(
    run: Run, speeds: FloatArray, cells: Cells, rises: FloatArray, entry: FloatArray
) -> tuple[FloatArray, ...]:
    """Run through all blocks at once, from unit states, unit ramps and the static loads.

    The columns of what is propagated are [states, road under the tires, ramps of the block,
    static loads], its rows [states, road rows].
    """
    n, n_speeds = cells.n_states, len(cells.free)
    n_blocks, per_block, n_tires, n_local = rises.shape
    per_block -= run.jumps
    own, road, beyond = slice(n), slice(n, n + n_tires), slice(n, None)
    carried, ramps, loads = slice(n + n_tires), slice(n + n_tires, n + n_tires + n_local), -1
    road_rows = _block_road_rows(rises, n)
    n_columns = road_rows.shape[-1]
    states = np.zeros((n_speeds, n_blocks, n + road_rows.shape[-2], n_columns))
    states[:, :, own, own] = np.eye(n)
    per_cell = len(SAMPLES) * (1 + run.jumps)
    effects = np.empty((n_speeds, n_blocks, per_block * per_cell + 1, n_columns))
    at_nodes = _node_rows(run, speeds, cells)
    at_ends = _node_rows(run, speeds, cells, before=True) if run.jumps else None
    through = cells.transitions()
    by_block = np.arange(n_blocks * per_block).reshape(n_blocks, per_block)
    for k in range(per_block):
        states[:, :, beyond] = road_rows[:, k]
        cell, sample = by_block[:, k], per_cell * k
        after = through[:, cell] @ states  # rows: states, effect at the samples of the cell
        effects[:, :, sample] = (at_nodes[:, cell, np.newaxis] @ states)[:, :, 0]
        effects[:, :, sample + 1 : sample + len(SAMPLES)] = after[:, :, beyond]
        states[:, :, own] = after[:, :, own]
        if at_ends is not None:
            end = (at_ends[:, cell + 1, np.newaxis] @ states)[:, :, 0]
            effects[:, :, sample + len(SAMPLES)] = end

    ends = np.zeros((n_speeds, n_blocks, n + n_tires, n_columns))
    ends[:, :, own] = states[:, :, own]
    ends[:, :, road, road] = np.eye(n_tires)
    ends[:, :, road, ramps] = rises[:, :per_block].sum(axis=1)
    # The road that the last cell of a block ends on, or the cell after it.
    if at_ends is None:
        states[:, :, road] += road_rows[:, -1, n_tires + 1 :]
    else:
        states[:, :, beyond] = road_rows[:, -1]
    effects[:, :, -1] = (at_nodes[:, by_block[:, -1] + 1, np.newaxis] @ states)[:, :, 0]
    if at_ends is not None:
        _connect(effects)
    smooth, starts, now = [], [], np.zeros((n_speeds, n + n_tires))
    for rows, end in zip(effects.swapaxes(0, 1), ends.swapaxes(0, 1), strict=True):
        starts.append(now[:, own])
        smooth.append(rows[..., loads] + np.einsum("sti,si->st", rows[..., carried], now))
        now = np.einsum("sij,sj->si", end[..., carried], now) + end[..., loads]
    maps = [part[..., columns] for part in (ends, effects) for columns in (carried, ramps)]
    return np.stack(starts, axis=1), np.stack(smooth, axis=1), entry, *maps


def _connect(effects: FloatArray) -> None:
    """Fill cells between those of blocks (..., samples, columns) with straight lines, in place."""
    ends, after = effects[:, :, len(SAMPLES) : -1 : 2 * len(SAMPLES)], 2 * len(SAMPLES)
    steps = effects[:, :, after::after] - ends
    for i in range(1, len(SAMPLES)):
        effects[:, :, len(SAMPLES) + i : -1 : after] = ends + steps * (i / len(SAMPLES))


def _with_next(cells: NDArray[Any]) -> NDArray[Any]:
    """Cells of blocks (B, K, ...), each with the first of the next block after them."""
    after = np.concatenate([cells[1:, :1], cells[-1:, -1:]])
    return np.concatenate([cells, after], axis=1)


def _block_road_rows(rises: FloatArray, n_states: int) -> FloatArray:
    """Road rows of the cells (B, K, 2 tires + 1, columns) for the columns of a block."""
    n_tires, n_local = rises.shape[2:]
    first = n_states + n_tires
    road, ramps, loads = slice(n_states, first), slice(first, first + n_local), -1
    at_start, of_loads, rise = slice(n_tires), n_tires, slice(n_tires + 1, None)
    rows = np.zeros((*rises.shape[:2], 2 * n_tires + 1, first + n_local + 1))
    rows[:, :, at_start, road] = np.eye(n_tires)
    rows[:, 1:, at_start, ramps] = np.cumsum(rises, axis=1)[:, :-1]
    rows[:, :, of_loads, loads] = 1.0
    rows[:, :, rise, ramps] = rises
    return rows


def _node_rows(run: Run, speeds: FloatArray, cells: Cells, *, before: bool = False) -> FloatArray:
    """The crossing's effect at each node from the states and the road rows, (1 or S, C + 1, ...).

    Just after the node, from the road rows of the cell after it; or just before, from those of the
    cell before it. With tire damping speeds [m/s] count.
    """
    crossing, vehicle, n = run.crossing, run.crossing.linear, cells.n_states
    x, damped = cells.nodes, bool(vehicle.tire_damping.any())
    if damped:
        x = x + (-BESIDE if before else BESIDE)
    gain, per_state, constant = crossing.rows(x)
    spring = gain * vehicle.tire_stiffnesses
    of_speeds = speeds[:, np.newaxis] if damped else speeds[:1, np.newaxis]
    read = crossing.deflection_rows(np.broadcast_to(x, (len(of_speeds), len(x))), of_speeds)
    at_start, of_loads = slice(n, n + vehicle.n_tires), n + vehicle.n_tires
    rows = np.zeros((len(of_speeds), len(x), n + 2 * vehicle.n_tires + 1))
    rows[..., :n] = per_state
    rows[..., : crossing.n_vehicle] += spring @ vehicle.leading_hubs
    rows[..., crossing.n_vehicle : n] -= np.einsum("ck,sckj->scj", spring, read)
    rows[..., at_start] = -spring
    rows[..., of_loads] = gain @ vehicle.static_loads + constant
    if damped:
        widths = np.diff(x)
        own = np.append(widths[:1], widths) if before else np.append(widths, widths[-1:])
        rates = (of_speeds / own)[..., np.newaxis] * vehicle.tire_lags
        rows[..., of_loads + 1 :] = -spring * (rates + before)
    return rows
