"""Many crossings, cell by cell, side by side: the approach, and then the bridge.

On the approach vehicles run on a rigid road, where cells are exact. On the bridge the deflections
under the tires at the stages of a cell are first guessed: the modes go on alone, and are moved as
in the cell before. The tire forces that this leads to give the deflections, and these the forces
that count. How far the two are apart tells how far these may be off: far less, for the bridge
hardly yields within a cell.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from bridgectl._checks import FloatArray
from bridgectl.linear.cells import GAUSS, N_STAGES
from bridgectl.linear.many.bends import POINTS, beyond, moments
from bridgectl.linear.many.maps import Fleet, Maps
from bridgectl.linear.many.places import Table
from bridgectl.linear.many.roads import Rows
from bridgectl.linear.modes import mode_responses
from bridgectl.model.bridge import BridgeModel

BLOCK = 64
"""Cells whose road rows are made together: products of matrices have a fixed shape by it."""


class Group(NamedTuple):
    """Crossings that go through cells of one width together, N of vehicles of one shape."""

    bridge: BridgeModel
    shapes: Table
    fleet: Fleet
    maps: Maps
    rows: Rows
    start: float
    width: float
    speeds: FloatArray

    @property
    def ahead(self) -> int:
        """Cells before that in which the bridge begins."""
        return int(-self.start / self.width + 1e-9)

    @property
    def last(self) -> FloatArray:
        """Where the last tires leave the bridge [m], (N,)."""
        return self.bridge.length + self.fleet.offsets.max(axis=1)

    def places(self, cells: FloatArray) -> FloatArray:
        """Places of the tires for places in cells of the bridge, (..., K, N) of (..., 1, N)."""
        x = self.start + (self.ahead + cells) * self.width
        return np.asarray(x - self.fleet.offsets.T)


class Marched(NamedTuple):
    """Crossings of the bridge in C cells, arrays with the crossing last."""

    states: FloatArray
    """Of the vehicles at the ends of cells, (C + 1, N, 2 n)."""
    modes: FloatArray
    """Displacements and rates at the ends of cells [m, m/s], (C + 1, 2, modes, N)."""
    loads: FloatArray
    """Modal forces at the stages [N], (C, modes, 3, N)."""
    surface: FloatArray
    """Deflections under the tires there [m], (C, 3, K, N)."""
    forces: FloatArray
    """Tire forces there [N], (C, 3, K, N)."""
    rows: FloatArray
    """Road rows, (C, 2 + P, K, N)."""
    free: FloatArray
    """Displacements and rates at stages and end from those at the start, (2, 2, modes, 4, N)."""
    held: FloatArray
    """The same from modal forces at the stages, (3, 2, modes, 4, N)."""
    least: FloatArray
    """Least tire force over its static load on approach and bridge, (N,)."""
    apart: FloatArray
    """Largest change of a tire force over its static load by the last pass, (N,)."""


def march(group: Group) -> Marched:
    """Go through approach and bridge."""
    fleet, rows = group.fleet, group.rows
    n = fleet.hubs.shape[-1]
    state = np.zeros((len(fleet.tires), 2 * n))
    state[:, :n] = (fleet.rest @ rows.start()[..., np.newaxis])[..., 0]
    state, least = _approach(group, state)
    return _bridge(group, state, least)


def start_felt(group: Group) -> FloatArray:
    """Most that a tire force at the bridge changes over its static load by the start [1/m], (N,).

    By another road under each tire there, of up to 1 m.
    """
    fleet, maps = group.fleet, group.maps
    n, size = fleet.rest.shape[1], maps.step.shape[2]
    step = np.linalg.matrix_power(maps.step[:, -size:], group.ahead)
    swings = np.abs(maps.rows[0] @ (step[:, :, :n] @ fleet.rest))
    total = swings[..., 0].copy()
    for tire in range(1, swings.shape[2]):
        total += swings[..., tire]
    return np.asarray((fleet.tires / fleet.loads * total).max(axis=1))


def _blocks(count: int) -> range:
    return range(0, count, BLOCK)


def _approach(group: Group, state: FloatArray) -> tuple[FloatArray, FloatArray]:
    """States at the end of the approach, and the least tire forces over static loads."""
    fleet, maps = group.fleet, group.maps
    count, n_tires = fleet.tires.shape
    q, share = N_STAGES * n_tires, fleet.tires / fleet.loads
    step, drive = (np.ascontiguousarray(of[:, q:]) for of in (maps.step, maps.drive))
    watch = np.concatenate([maps.rows[0], maps.watch], axis=1)
    least = np.full(fleet.tires.shape, np.inf)
    for first in _blocks(group.ahead):
        rows = group.rows.of(first, BLOCK)
        flat = rows.reshape(count, -1, BLOCK)
        pushes = np.ascontiguousarray(np.moveaxis(drive @ flat, -1, 0))
        steps = min(BLOCK, group.ahead - first)
        states = np.zeros((BLOCK, *state.shape))
        for i in range(steps):
            states[i] = state
            state = np.matmul(step, state[..., np.newaxis])[..., 0]
            state += pushes[i]
        seen = watch @ np.ascontiguousarray(np.moveaxis(states, 0, -1))
        seen[:, :n_tires] -= rows[:, 0]
        seen[:, n_tires:] += maps.watch_road @ flat
        lowest = seen[..., :steps].min(axis=-1).reshape(count, 2, n_tires).min(axis=1)
        least = np.minimum(least, 1 + share * lowest)
    return state, least.min(axis=1)


def _bridge(group: Group, state: FloatArray, least: FloatArray) -> Marched:
    fleet, maps, bridge = group.fleet, group.maps, group.bridge
    (count, n_tires), n_modes = fleet.tires.shape, bridge.n_modes
    q, size = N_STAGES * n_tires, state.shape[1]
    durations = (group.width / group.speeds)[:, np.newaxis]
    free, held = (
        np.ascontiguousarray(np.moveaxis(of[:, 0], (0, 1, 2, 3, 4), (4, 2, 3, 1, 0)))
        for of in mode_responses(bridge, durations, GAUSS, POINTS)
    )
    # Made of (state or stage, value or rate, modes, point, N).
    cells = int(np.ceil((group.last.max() - group.start) / group.width - 1e-9)) - group.ahead
    padded = BLOCK * len(_blocks(cells))
    states = np.empty((padded + 1, count, size))
    modes = np.zeros((padded + 1, 2, n_modes, count))
    loads = np.empty((padded, n_modes, N_STAGES, count))
    surface, forces = np.empty((2, padded, N_STAGES, n_tires, count))
    road = np.empty((padded, maps.kinks.shape[1] + 2, n_tires, count))
    states[0] = state
    apart, moved = np.zeros((count, q)), np.zeros((n_modes, N_STAGES, count))
    static = np.tile(fleet.loads, N_STAGES)
    bends = _Bends(group, held)
    to_forces, at_end = np.ascontiguousarray(maps.surface[:, :q]), slice(q, None)
    free_q, held_q = free[:, 0, :, :N_STAGES], held[:, 0, :, :N_STAGES]
    free_end, held_end = free[:, :, :, N_STAGES], held[:, :, :, N_STAGES]
    for first in _blocks(cells):
        rows = group.rows.of(group.ahead + first, BLOCK)
        road[first : first + BLOCK] = np.moveaxis(rows, (3, 0), (0, 3))
        pushes = maps.drive @ rows.reshape(count, -1, BLOCK)
        pushes[:, :q] += static[..., np.newaxis]
        pushes = np.ascontiguousarray(np.moveaxis(pushes, -1, 0))
        shapes, inside, at_ends = _shapes(group, first, held)
        bends.add(shapes, road[first : first + BLOCK, 2:], inside, at_ends)
        for i in range(BLOCK):
            c, shape, own = first + i, shapes[i], modes[first + i]
            given = np.matmul(maps.step, states[c][..., np.newaxis])[..., 0]
            given += pushes[i]
            alone = free_q[0] * own[0][:, np.newaxis]
            alone += free_q[1] * own[1][:, np.newaxis]
            alone += inside[i]
            under = _by_vehicle(_deflections(shape, alone + moved))
            guess = given[:, :q] + np.matmul(to_forces, under)[..., 0]
            load = _modal(shape, guess)
            moved = held_q[0] * load[:, 0, np.newaxis]
            for stage in range(1, N_STAGES):
                moved += held_q[stage] * load[:, stage, np.newaxis]
            deflections = _deflections(shape, alone + moved)
            given += np.matmul(maps.surface, _by_vehicle(deflections))[..., 0]
            states[c + 1] = given[:, at_end]
            guess -= given[:, :q]
            np.maximum(apart, np.abs(guess), out=apart)
            surface[c] = deflections
            forces[c] = np.ascontiguousarray(given[:, :q].T).reshape(forces[c].shape)
            load = loads[c] = _modal(shape, given[:, :q])
            after = modes[c + 1]
            after += at_ends[i]
            after += free_end[0] * own[0]
            after += free_end[1] * own[1]
            for stage in range(N_STAGES):
                after += held_end[stage] * load[:, stage]
    smooth = np.moveaxis(maps.smoothed, 0, -1)  # stages, kinks, tires, N
    for kink in range(maps.kinks.shape[1]):
        forces -= smooth[:, kink] * road[:, np.newaxis, 2 + kink]
    x = group.places(
        np.arange(cells)[:, np.newaxis, np.newaxis, np.newaxis] + GAUSS[:, np.newaxis, np.newaxis]
    )
    on_way = x[..., :1, :] + fleet.offsets.T[:1] <= group.last
    low = np.where(on_way, forces[:cells] / fleet.loads.T, np.inf).min(axis=0)
    least = np.minimum(least, low.min(axis=0).min(axis=0))
    return Marched(
        states, modes, loads, surface, forces, road, free, held, least,
        (apart / static).max(axis=1),
    )  # fmt: skip


class _Bends:
    """What the road's kinks do to the modes beyond their parabolas."""

    def __init__(self, group: Group, held: FloatArray) -> None:
        kinks = np.moveaxis(group.maps.kinks, 0, -1)  # kinks, tires, N
        count = kinks[..., 0].size
        durations = np.tile(group.width / group.speeds, count)
        found = beyond(group.bridge, durations, np.tile(held, count), kinks.ravel())
        found *= -np.tile(group.fleet.tires.T, (kinks.shape[0], 1)).ravel()
        found = found.reshape(*found.shape[:-1], *kinks.shape)
        self.inside = np.ascontiguousarray(np.moveaxis(found[0, :, :N_STAGES], (2, 3), (0, 1)))
        self.at_ends = np.ascontiguousarray(np.moveaxis(found[:, :, N_STAGES], (2, 3), (0, 1)))
        powers = np.linalg.inv(np.vander(GAUSS, increasing=True))
        self.shares = [
            powers[0, stage] + kinks * (powers[1, stage] + kinks * powers[2, stage])
            for stage in range(N_STAGES)
        ]
        """Parts of shapes at the stages in that at the kink."""

    def add(
        self, shapes: FloatArray, kinks: FloatArray, inside: FloatArray, at_ends: FloatArray
    ) -> None:
        """Add them to those of a block of cells, from its road rows of kinks."""
        for i in range(kinks.shape[1]):
            bent = self.shares[0][i] * shapes[:, :, 0]
            for stage in range(1, N_STAGES):
                bent += self.shares[stage][i] * shapes[:, :, stage]
            bent *= kinks[:, np.newaxis, i]
            for tire in range(bent.shape[2]):
                own = bent[:, :, tire]
                inside += self.inside[i, tire] * own[:, :, np.newaxis]
                at_ends += self.at_ends[i, tire] * own[:, np.newaxis]


def _shapes(
    group: Group, first: int, held: FloatArray
) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Mode shapes under the tires at the stages of a block of cells, (BLOCK, modes, 3, K, N).

    Where a shape has a kink they are those of the parabola of the same moments. What the static
    loads do to the modes beyond that: displacements at the stages (BLOCK, modes, 3, N), and states
    at the end (BLOCK, 2, modes, N).
    """
    cells = np.arange(first, first + BLOCK)[:, np.newaxis, np.newaxis, np.newaxis]
    x = group.places(cells + GAUSS[:, np.newaxis, np.newaxis])
    shapes = group.shapes(x)
    count, n_modes = len(group.speeds), len(shapes)
    inside = np.zeros((BLOCK, n_modes, N_STAGES, count))
    at_ends = np.zeros((BLOCK, 2, n_modes, count))
    for place, jump in zip(*group.shapes.slope_jumps(), strict=True):
        way = (place + group.fleet.offsets - group.start) / group.width - group.ahead
        cell = np.floor(way)
        at, tire = np.nonzero((cell >= first) & (cell < first + BLOCK))
        kinks = way[at, tire] - cell[at, tire]
        bent = group.width * (moments(kinks) - np.maximum(GAUSS[:, np.newaxis] - kinks, 0.0)).T
        own = (cell[at, tire] - first).astype(np.intp)
        more = beyond(group.bridge, group.width / group.speeds[at], held[..., at], kinks)
        more *= group.width * group.fleet.loads[at, tire]
        for j, by in enumerate(jump):
            shapes[j, own, :, tire, at] += by * bent
            _add(inside[:, j], own, at, by * more[0, j, :N_STAGES].T)
            _add(at_ends[:, :, j], own, at, by * more[:, j, N_STAGES].T)
    return np.ascontiguousarray(np.moveaxis(shapes, 0, 1)), inside, at_ends


def _add(
    total: FloatArray, cells: NDArray[np.intp], own: NDArray[np.intp], values: FloatArray
) -> None:
    """Add values (n, some) to those (C, some, N) of n cells and vehicles, maybe the same ones."""
    for i in range(values.shape[1]):
        np.add.at(total[:, i], (cells, own), values[:, i])


def _by_vehicle(deflections: FloatArray) -> FloatArray:
    """A column for each vehicle, (N, 3 K, 1), of (3, K, N)."""
    flat = deflections.reshape(-1, deflections.shape[-1])
    return np.ascontiguousarray(flat.T)[..., np.newaxis]


def _deflections(shapes: FloatArray, modes: FloatArray) -> FloatArray:
    """Under the tires, (3, K, N), of shapes (modes, 3, K, N) and displacements (modes, 3, N)."""
    each = shapes * modes[:, :, np.newaxis]
    total = each[0]
    for j in range(1, len(each)):
        total += each[j]
    return total


def _modal(shapes: FloatArray, forces: FloatArray) -> FloatArray:
    """Modal forces (modes, 3, N) of tire forces (N, 3 K)."""
    by_tire = np.ascontiguousarray(forces.T).reshape(shapes.shape[1:])
    each = shapes * by_tire
    total = each[:, :, 0].copy()
    for tire in range(1, each.shape[2]):
        total += each[:, :, tire]
    return total
