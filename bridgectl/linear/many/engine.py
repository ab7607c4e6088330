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
from bridgectl.linear.many.places import table
from bridgectl.linear.many.roads import EvenRoad, Layout, Rows, even_road, layout
from bridgectl.linear.many.tops import Read, find_tops
from bridgectl.linear.nodes import MAX_WIDTH
from bridgectl.model.bridge import BridgeModel
from bridgectl.model.bridge_effects import Deflection, Moment, Reaction, Shear, Stress
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
"""Largest change of a tire force by the last pass, over its static load, as on bridges as light as
the vehicle: factors and tire forces are then within 3e-7 (``tests/test_many.py``), and tens of
times as far off at 2e-3."""

WIDEST_PIECE = 0.25
"""Widest piece [m] of the tables of places, which are as many as there are waves at least."""

ON_SUPPORTS = 1e-9
"""Share of its largest value that a shape may have at an end: a tire comes on without a blow."""


READ = (Moment, Stress, Deflection, Shear, Reaction)
"""Effects of tire forces and modes by the place of the tires."""


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
        self.n_effects = len(effects)
        found = [_read(effect, bridge, widest) for effect in effects]
        self.reads = [read for read in found if read is not None]
        supported = bool(np.all(ends <= ON_SUPPORTS * largest))
        self.fits = supported and len(self.reads) == self.n_effects

    def run(
        self,
        vehicles: Sequence[Vehicle],
        speeds: FloatArray,
        roads: Sequence[RoadProfile | None],
        pays: float = 0.0,
    ) -> Found:
        """Peaks of all crossings that arrays take.

        Of those alike it takes as many tires times the width of their cells as `pays` [m].
        """
        count = len(vehicles)
        peaks, places = np.full((2, self.n_effects, count), np.nan)
        least, felt = np.full((2, count), np.nan)
        found = Found(peaks, places, least, felt, np.zeros(count, dtype=bool))
        if not self.fits:
            return found
        each_once = {id(road): road for road in roads}
        even = {key: self._even(road) for key, road in each_once.items()}
        alike = defaultdict(list)
        for i, vehicle in enumerate(vehicles):
            road = even[id(roads[i])]
            if not (road is None or isinstance(vehicle, Traffic) or vehicle.tire_damping.any()):
                alike[vehicle.n_tires, vehicle.n_coordinates].append((i, road))
        for each in alike.values():
            which, own = np.array([i for i, _ in each]), [road for _, road in each]
            fleet = fleet_of([vehicles[i] for i in which])
            together = max(1, TOGETHER // (2 * fleet.hubs.shape[-1]))
            for lie, parts in self._layouts(fleet, speeds[which], own).items():
                if len(parts) * fleet.tires.shape[1] * lie.width < pays:
                    continue
                for first in range(0, len(parts), together):
                    part = np.array(parts[first : first + together])
                    group = self._group(
                        fleet.of(part), speeds[which[part]], lie, [own[i] for i in part]
                    )
                    self._march(found, which[part], group)
        return found

    def _even(self, road: RoadProfile | None) -> EvenRoad | None:
        return even_road(road, 0.0 if road is None else max(self.start, float(road.x[0])))

    def _layouts(
        self, fleet: Fleet, speeds: FloatArray, roads: Sequence[EvenRoad]
    ) -> dict[Layout, list[int]]:
        """Crossings by the cells that each needs."""
        highest = float(self.bridge.omega.max())
        phases = np.maximum(fleet.fastest / MOST_PHASE, highest / MOST_MODE_PHASE)
        groups: dict[Layout, list[int]] = defaultdict(list)
        for i, widest in enumerate(np.minimum(WIDEST, speeds / phases)):
            if widest >= NARROWEST:
                groups[layout(roads[i].step, float(widest))].append(i)
        return groups

    def _group(
        self, fleet: Fleet, speeds: FloatArray, lie: Layout, roads: Sequence[EvenRoad]
    ) -> Group:
        """Crossings of one shape and one width of cells."""
        each = {id(road): road for road in roads}
        number = {key: i for i, key in enumerate(each)}
        own = np.array([number[id(road)] for road in roads])
        rows = Rows(list(each.values()), own, lie, self.start - fleet.offsets)
        maps = maps_of(fleet, lie.width / speeds, rows.places)
        return Group(self.bridge, self.shapes, fleet, maps, rows, self.start, lie.width, speeds)

    def _march(self, found: Found, which: NDArray[np.intp], group: Group) -> None:
        """Simulate a group, and keep what is found of it."""
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
    if type(effect) not in READ:
        return None
    one = Vehicle([[1e4]], [[0.0]], [[0.0]], [1e6])

    def gains(x: FloatArray) -> FloatArray:
        return effect.rows(bridge, one, x[:, np.newaxis]).per_force

    kinks = effect.kinks(bridge)
    rows = effect.rows(bridge, one, np.zeros((1, 1)))
    values, rates = rows.per_state[2:].reshape(-1, 2).T
    return Read(table(gains, kinks, bridge.length, widest), 0, kinks, values, rates, sense)
