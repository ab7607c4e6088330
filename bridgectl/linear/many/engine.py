"""Which crossings go side by side in arrays, and how: the groups, and what is read of them."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from bridgectl._checks import FloatArray
from bridgectl.linear.many.maps import Fleet, fleet_of, maps_of
from bridgectl.linear.many.march import Group, march, start_felt
from bridgectl.linear.many.places import Table, table
from bridgectl.linear.many.roads import EvenRoad, Layout, Rows, even_road, layout
from bridgectl.linear.many.tops import Read, find_tops
from bridgectl.linear.nodes import MAX_WIDTH
from bridgectl.model.bridge import BridgeModel
from bridgectl.model.bridge_effects import AtSection
from bridgectl.model.effect import SENSES, Effect
from bridgectl.model.traffic import Traffic
from bridgectl.model.vehicle import Vehicle
from bridgectl.model.vehicle_effects import TireForce
from bridgectl.road import RoadProfile

WIDEST = 1.1 * MAX_WIDTH
"""Widest cell [m], with room for stations of 4 inches."""

NARROWEST = 0.01
"""Crossings that need narrower cells [m] go alone."""

MOST_PHASE, MOST_MODE_PHASE = 0.7, 1.7
"""Largest advance of phase in a cell [rad] of the vehicle's fastest motion and the highest mode."""

TOGETHER = 3000
"""States of the vehicles that go together: some 190 five-axle trucks, 750 quarter-cars."""

LOW = 0.1
"""Least tire force over its static load below which a tire may leave the road between samples."""

APART = 3e-4
"""Largest change of a tire force by the last pass, over its static load: the next one's would be
less than its square."""

WIDEST_PIECE = 0.25
"""Widest piece [m] of the tables of places, which are as many as there are waves at least."""

ON_SUPPORTS = 1e-9
"""Share of its largest value that a shape may have at an end: a tire comes on without a blow."""


class Found(NamedTuple):
    """What arrays tell of crossings, effects first; nothing of those that they do not take."""

    peaks: FloatArray
    """In the unit of each effect, (n_effects, N)."""
    places: FloatArray
    """Of the reference tire then [m], (n_effects, N)."""
    least: FloatArray
    """Least tire force over its static load, (N,)."""
    felt: FloatArray
    """Most that a tire force at the bridge changes over its static load by another road at the
    start [1/m], (N,)."""
    taken: NDArray[np.bool_]
    """Which crossings arrays take, (N,)."""


class Engine:
    """Many crossings of a bridge, and the effects that are read of each."""

    def __init__(self, bridge: BridgeModel, start: float, effects: Sequence[Effect]) -> None:
        self.bridge, self.start = bridge, start
        widest = min(WIDEST_PIECE, bridge.length / (24 * bridge.n_modes))
        ends = np.abs(bridge.mode_shapes(np.array([0.0, bridge.length])))
        self.shapes = table(bridge.mode_shapes, bridge.kinks(0.5), bridge.length, widest)
        largest = np.abs(self.shapes.powers[0]).max(axis=1)
        self.reads = [_read(effect, bridge, widest) for effect in effects]
        self.fits = bool(np.all(ends <= ON_SUPPORTS * largest)) and None not in self.reads

    def run(
        self, vehicles: Sequence[Vehicle], speeds: FloatArray, roads: Sequence[RoadProfile | None]
    ) -> Found:
        """Peaks of all crossings that arrays take."""
        count = len(vehicles)
        found = Found(
            *np.full((2, len(self.reads), count), np.nan), *np.full((2, count), np.nan),
            np.zeros(count, bool),
        )  # fmt: skip
        if not self.fits:
            return found
        known: dict[int, EvenRoad | None] = {}
        for road in roads:
            if id(road) not in known:
                datum = 0.0 if road is None else max(self.start, float(road.x[0]))
                known[id(road)] = even_road(road, datum)
        shapes = defaultdict(list)
        for i, vehicle in enumerate(vehicles):
            plain = not isinstance(vehicle, Traffic) and not vehicle.tire_damping.any()
            if plain and known[id(roads[i])] is not None:
                shapes[vehicle.n_tires, vehicle.n_coordinates].append(i)
        for alike in shapes.values():
            fleet = fleet_of([vehicles[i] for i in alike])
            for lie, own in self._layouts(fleet, speeds[alike], [known[id(roads[i])] for i in alike]).items():
                together = max(1, TOGETHER // fleet.hubs.shape[-1] // 2)
                for first in range(0, len(own), together):
                    part = own[first : first + together]
                    which = np.array(alike)[part]
                    self._group(found, which, fleet.of(part), speeds[which], lie, [known[id(roads[i])] for i in which])
        return found

    def _layouts(
        self, fleet: Fleet, speeds: FloatArray, roads: Sequence[EvenRoad]
    ) -> dict[Layout, list[int]]:
        """Crossings by the cells that each needs."""
        highest = float(self.bridge.omega.max())
        phases = np.maximum(fleet.fastest / MOST_PHASE, highest / MOST_MODE_PHASE)
        groups = defaultdict(list)
        for i, widest in enumerate(np.minimum(WIDEST, speeds / phases)):
            if widest >= NARROWEST:
                groups[layout(roads[i].step, float(widest))].append(i)
        return groups

    def _group(self, found: Found, which: NDArray[np.intp], fleet: Fleet, speeds: FloatArray, lie: Layout, roads: Sequence[EvenRoad]) -> None:
        """Crossings of one shape and one width of cells."""
        each = {id(road): road for road in roads}
        number = {key: i for i, key in enumerate(each)}
        own = np.array([number[id(road)] for road in roads])
        rows = Rows(list(each.values()), own, lie, self.start - fleet.offsets)
        maps = maps_of(fleet, lie.width / speeds, rows.places)
        group = Group(self.bridge, self.shapes, fleet, maps, rows, self.start, lie.width, speeds)
        marched = march(group)
        found.least[which], found.felt[which] = marched.least, start_felt(group)
        found.taken[which] = (marched.least >= LOW) & (marched.apart <= APART)
        for i, read in enumerate(self.reads):
            found.peaks[i, which], found.places[i, which] = find_tops(group, marched, read)


def _read(effect: Effect, bridge: BridgeModel, widest: float) -> Read | None:
    """How arrays read an effect, if they do."""
    sense, still = SENSES[effect.sense], np.zeros(bridge.n_modes)
    if type(effect) is TireForce:
        return Read(None, effect.tire - 1, np.zeros(0), still, still, sense)
    if not isinstance(effect, AtSection) or not effect.has_static:
        return None
    one = Vehicle([[1e4]], [[0.0]], [[0.0]], [1e6])

    def gains(x: FloatArray) -> FloatArray:
        return effect.rows(bridge, one, x[:, np.newaxis]).per_force

    kinks = effect.kinks(bridge)
    rows = effect.rows(bridge, one, np.zeros((1, 1)))
    modes = rows.per_state[2:].reshape(-1, 2).T
    return Read(table(gains, kinks, bridge.length, widest), 0, kinks, *modes, sense)
