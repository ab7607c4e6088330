"""Many crossings at once: what is given, checked; arrays where they fit, else one by one.

The single route (`bridgectl.linear.samples.peaks_of_effects`) takes what arrays do not: tires with
damping, several vehicles, roads of uneven stations, stiff vehicles or many modes, effects that are
not of the tire forces and modes alone, and tires that leave the road or come near it. Whether it
does is a matter of that crossing alone.

One vehicle at many speeds has arrays too, where enough of them have cells of one width.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import AbstractContextManager, contextmanager, nullcontext
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from bridgectl import _checks
from bridgectl._checks import FloatArray
from bridgectl._progress import track
from bridgectl._threads import on_one_thread
from bridgectl.linear.estimates import require_crossing
from bridgectl.linear.many.engine import Engine, Found
from bridgectl.linear.response import Crossed
from bridgectl.linear.runs import Run, covered, require_beyond
from bridgectl.linear.samples import crossings_of, peaks_of_effects
from bridgectl.linear.start import require_contact
from bridgectl.model.bridge import BridgeModel
from bridgectl.model.crossing import Crossing
from bridgectl.model.effect import Effect
from bridgectl.model.motion import Motion
from bridgectl.model.quarter_car import QuarterCar
from bridgectl.model.vehicle import Vehicle
from bridgectl.road import RoadProfile

PAYS = 0.7
"""Tires side by side times the width of their cells [m] from which on arrays are quicker than one
speed after the other: 2 speeds of a five-axle truck in the widest, 14 in those of 1 cm."""


class ManyCrossings(NamedTuple):
    """What is kept of N crossings, effects first."""

    static_peaks: FloatArray
    """Largest or smallest effect of the weight alone, in its unit, 0 if none, (n_effects, N)."""
    factors: FloatArray
    """Peaks over the static ones; in the effect's unit where there is none, (n_effects, N)."""
    places: FloatArray
    """Of the reference tire at the peaks [m], (n_effects, N)."""
    times: FloatArray
    """The same [s], 0 where it comes on the bridge, (n_effects, N)."""
    least: FloatArray
    """Least tire force over its static load on approach and bridge, (N,): of a tire that stays down
    within some percent, for it is looked for at places some 5 cm apart."""
    flights: FloatArray
    """Where a tire first leaves the road [m], not a number where none does, (N,)."""
    felt: FloatArray
    """Most that a tire force at the bridge changes over its static load by another road at the
    start [1/m], (N,); not a number of those alone."""
    alone: NDArray[np.bool_]
    """Which crossings the single route took, (N,)."""

    @property
    def peaks(self) -> FloatArray:
        """Largest or smallest effect in its unit, (n_effects, N)."""
        return self.factors * _scales(self.static_peaks)

    @property
    def lifts_off(self) -> NDArray[np.bool_]:
        """Whether a tire leaves the road, (N,)."""
        return ~np.isnan(self.flights)


def is_sequence(value: object) -> bool:
    """Whether vehicles or roads are given as a sequence of them."""
    return isinstance(value, list | tuple)


def alone(vehicle: Any, profile: Any) -> tuple[Vehicle | QuarterCar, RoadProfile | None]:
    """A vehicle and a road that are no sequences: what else they are is checked later."""
    return vehicle, profile


class Given(NamedTuple):
    """Crossings of vehicles at speeds on roads, one each, checked."""

    beam: BridgeModel
    crossings: list[list[Crossing]]
    """By effect and vehicle."""
    speeds: FloatArray
    roads: list[RoadProfile | None]
    start: float

    def run(self, i: int) -> Run:
        """A crossing by itself, of the first effect."""
        crossing = self.crossings[0][i]
        return Run(crossing, self.start, crossing.exit, self.roads[i])

    def of_vehicle(self, i: int) -> AbstractContextManager[None]:
        """Tells which vehicle an error in it is of."""
        return _named(f"vehicle[{i}]")


def given(
    beam: BridgeModel,
    vehicles: Any,
    speeds: Any,
    profiles: Any,
    start: float,
    effect: Effect | str | Sequence[Effect | str],
    section: float = 0.5,
    recovery: str = "exact",
) -> Given:
    """Check many crossings: speeds and roads are one for all, or one each."""
    count = len(vehicles)
    c = _paired_speeds(speeds, count)
    roads = _paired_roads(profiles, count)
    each = []
    for i, vehicle in enumerate(vehicles):
        with _named(f"vehicle[{i}]"):
            each.append(crossings_of(effect, beam, vehicle, section, recovery))
    count = len(effect) if isinstance(effect, list | tuple) else 1
    crossings = [[own[i] for own in each] for i in range(count)]
    every = Given(beam, crossings, c, roads, _checks.number("start", start, unit="m"))
    checked = set()
    for i, crossing in enumerate(crossings[0]):
        road, paths = roads[i], crossing.paths
        plain = not paths.opposite.any() and not paths.motions
        if plain and id(road) in checked:
            continue
        with _named(f"profile[{i}]") if is_sequence(profiles) else nullcontext():
            require_beyond(covered(crossing, road, start))
        if plain:
            checked.add(id(road))
        with every.of_vehicle(i):
            paths.require(Motion(float(c[i])))
    return every


@contextmanager
def _named(which: str) -> Iterator[None]:
    """Tells which of a sequence an error is of."""
    try:
        yield
    except (TypeError, ValueError) as error:
        raise type(error)(f"{which}: {error}") from None


def _paired_speeds(speeds: Any, count: int) -> FloatArray:
    """A speed [m/s] for each vehicle, from one for all or one each."""
    each = list(speeds) if is_sequence(speeds) else [speeds]
    bent = [one for one in each if isinstance(one, Motion) and not one.uniform]
    if bent:
        raise ValueError(
            f"speeds must be constant with a sequence of vehicles, got {bent[0]!r}: type its speed "
            "in m/s, or pass one vehicle at a time"
        )
    if any(isinstance(one, Motion) for one in each):
        speeds = [one.speed if isinstance(one, Motion) else one for one in each]
    c = _checks.speeds(speeds) if count or np.size(speeds) else np.zeros(0)
    if c.size not in (1, count):
        raise ValueError(
            f"speeds must be one for all {count} vehicles, or one each, got {c.size}: for every "
            "vehicle at every speed pass vehicles one at a time"
        )
    return np.repeat(c, count) if c.size == 1 else c


def _paired_roads(profiles: Any, count: int) -> list[RoadProfile | None]:
    """A road for each vehicle, from one for all or one each."""
    if not is_sequence(profiles):
        return [profiles] * count
    if len(profiles) != count:
        raise ValueError(
            f"profile must be one road for all {count} vehicles, or one each, got {len(profiles)}: "
            "for every vehicle on every road pass vehicles one at a time"
        )
    return list(profiles)


@on_one_thread
def many_crossings(
    beam: BridgeModel,
    vehicles: Sequence[Vehicle | QuarterCar],
    speeds: ArrayLike,
    profiles: RoadProfile | Sequence[RoadProfile | None] | None = None,
    *,
    start: float = 0.0,
    effects: Effect | str | Sequence[Effect | str] = "moment",
    progress: bool = False,
) -> ManyCrossings:
    """Simulate crossings of vehicles at speeds on roads, one each or one for all, without a word.

    The numbers of a crossing are its own to the bit, whatever the others are.
    """
    return simulate(given(beam, vehicles, speeds, profiles, start, effects), progress=progress)


def dafs_at_speeds(
    run: Run, crossings: Sequence[Crossing], speeds: FloatArray, method: str, progress: bool
) -> FloatArray:
    """DAFs of one vehicle for each effect, (n_effects, n_speeds): in arrays where these pay."""
    vehicle, count = run.crossing.linear, speeds.size
    result, left = Crossed.of_none(len(crossings), count), np.ones(count, dtype=bool)
    if run.plain and method == "propagator" and vehicle.n_tires > 1 and count > 1:
        require_crossing(run, speeds)
        engine = Engine(run.crossing.beam, run.start, [crossing.effect for crossing in crossings])
        found = engine.run([vehicle] * count, speeds, [run.profile] * count, PAYS)
        left = ~found.taken
        statics = np.array([[crossing.static_peak] for crossing in crossings])
        _keep(result, found, statics)
    if left.any():
        rest = peaks_of_effects(run, crossings, speeds[left], method, progress)
        for every, own in zip(result, rest, strict=True):
            every[..., left] = own
    result.tell(speeds)
    return result.factors


def simulate(many: Given, method: str = "propagator", *, progress: bool = False) -> ManyCrossings:
    """Simulate what was given."""
    n_effects, count = len(many.crossings), len(many.speeds)
    statics = np.array([[crossing.static_peak for crossing in own] for own in many.crossings])
    statics = statics.reshape(n_effects, count)
    factors, places, times = np.full((3, n_effects, count), np.nan)
    least, flights, felt = np.full((3, count), np.nan)
    every = np.ones(count, dtype=bool)
    result = ManyCrossings(statics, factors, places, times, least, flights, felt, every)
    if method == "propagator" and count:
        effects = [own[0].effect for own in many.crossings]
        vehicles = [crossing.linear for crossing in many.crossings[0]]
        found = Engine(many.beam, many.start, effects).run(vehicles, many.speeds, many.roads)
        _keep(result, found, statics)
        result.felt[found.taken], result.alone[found.taken] = found.felt[found.taken], False
    left = np.flatnonzero(result.alone).tolist()
    for i in track(left, "Simulating crossings one by one", len(left), show=progress):
        own = [of[i] for of in many.crossings]
        with many.of_vehicle(i):
            require_contact(run := many.run(i))
            one = peaks_of_effects(run, own, many.speeds[[i]], method, progress=False)
        result.factors[:, i], result.places[:, i] = one.factors[:, 0], one.places[:, 0]
        result.least[i], result.flights[i] = one.least[0], one.flights[0]
    return result._replace(times=result.places / many.speeds)


def _keep(result: ManyCrossings | Crossed, found: Found, statics: FloatArray) -> None:
    """Keep what arrays found of crossings that they take."""
    taken = found.taken
    result.factors[:, taken] = (found.peaks / _scales(statics))[:, taken]
    result.places[:, taken], result.least[taken] = found.places[:, taken], found.least[taken]


def _scales(statics: FloatArray) -> FloatArray:
    """What factors are of: static peaks, or the unit where there are none."""
    return np.where(statics == 0, 1.0, statics)
