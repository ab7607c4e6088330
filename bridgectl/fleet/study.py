"""What is assessed: crossings of random trucks on roads, and what is drawn for each of them.

Crossing i of a seed is the same whoever computes it, in any order: what is drawn for it stands in
row i of a table of random numbers that is never made as a whole.
"""

from __future__ import annotations

import json
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from hashlib import sha256
from typing import Any, NamedTuple, TypeAlias

import numpy as np
from numpy.typing import NDArray

from bridgectl import _checks as check
from bridgectl._checks import FloatArray
from bridgectl.dampers.fitted import Dampers, fitted
from bridgectl.dampers.told import told_of
from bridgectl.fleet.fleet import Fleet
from bridgectl.fleet.sources import Passing
from bridgectl.model.bridge import BridgeModel, described
from bridgectl.model.effect import Effect
from bridgectl.model.vehicle import Vehicle
from bridgectl.road import RoadProfile

DamperOf = Callable[[BridgeModel, Vehicle], Dampers]
"""What chooses a damper for a bridge and a truck."""

Road = RoadProfile | None
Roads: TypeAlias = Road | Sequence[Road] | Mapping[str, Road | Sequence[Road]]
"""A road, or a smooth one."""

DRAWN = 8
"""Random numbers of a crossing: see `Draws`."""

SHARE, DAMPED_SHARE = 500, 50
"""Crossings of one share of the work, what an interruption may cost; where some of them are with
semi-active dampers, which take a second each."""

SPEEDS = np.array([10.0, 40.0])
"""At which dampers are told from others [m/s]."""

TOLD = 3
"""Trucks whose dampers are told."""

HOUR = 3600.0

FAR_ON = 2**32
"""By how many numbers trucks from the other end are further on in a fleet without end."""


class Draws(NamedTuple):
    """What is drawn for crossings, each of shape (n,)."""

    road: FloatArray
    """Which of the roads of a quality, as a fraction."""
    damper: FloatArray
    """Below the share of the fleet with dampers: the truck has them."""
    meeting: FloatArray
    """Below the probability of a meeting: another truck comes from the other end."""
    partner: FloatArray
    """Which truck that is, as a fraction."""
    when: FloatArray
    """When it comes: a fraction of the time in which they meet."""

    @classmethod
    def of(cls, seed: int, crossings: range) -> Draws:
        """Draw what belongs to some crossings, one after the other."""
        numbers = np.random.Philox(key=seed)
        numbers.advance(crossings.start * DRAWN // 4)  # it makes four at a time
        table = np.random.Generator(numbers).random((len(crossings), DRAWN))
        return cls(*table.T[: len(cls._fields)])


class Share(NamedTuple):
    """Some crossings, one after the other."""

    study: Study
    """With no more than the trucks that cross, then those that they may meet, and their roads."""
    crossings: range
    numbers: NDArray[np.intp]
    """Of the road of each quality, (qualities, n)."""


@dataclass(frozen=True)
class Study:
    """What all shares of the work have in common."""

    bridge: BridgeModel
    fleet: Fleet
    kinds: tuple[str, ...]
    """Of all trucks."""
    roads: Mapping[str, Mapping[int, Road]]
    """Roads by the name of their quality, and by number."""
    effects: tuple[Effect, ...]
    approach: float
    seed: int
    damper: Dampers | DamperOf | None
    damper_share: float
    meeting_rate: float
    """Trucks an hour that come from the other end."""
    lane_factor: float

    def shares(self, n: int) -> list[range]:
        """The first n crossings in shares."""
        size = SHARE if self.damper is None else DAMPED_SHARE
        return [range(i, min(i + size, n)) for i in range(0, n, size)]

    def damper_of(self, vehicle: Vehicle) -> Dampers:
        """The damper of a truck that has one."""
        if callable(self.damper):
            return self.damper(self.bridge, vehicle)
        assert self.damper is not None  # or no truck has one
        return self.damper

    def partners(self, crossings: range, draws: Draws) -> NDArray[np.intp]:
        """Which trucks of the fleet meet those of some crossings, where one does."""
        if not self.fleet.is_finite:
            return FAR_ON + np.array(crossings)
        return np.floor(draws.partner * len(self.fleet)).astype(int)

    def share(self, crossings: range) -> Share:
        """Some crossings, with what they need and no more."""
        draws = Draws.of(self.seed, crossings)
        trucks = np.array(crossings)
        if self.meeting_rate:
            trucks = np.append(trucks, self.partners(crossings, draws))
        numbers = [np.floor(draws.road * len(own)).astype(int) for own in self.roads.values()]
        used = {
            quality: {number: own[number] for number in np.unique(of).tolist()}
            for (quality, own), of in zip(self.roads.items(), numbers, strict=True)
        }
        alone = replace(self, fleet=self.fleet.part(trucks), roads=used)
        return Share(alone, crossings, np.array(numbers))

    def damped(self, crossings: range) -> NDArray[np.intp]:
        """Which of some crossings, counted from their first, are made with the damper, too."""
        if self.damper is None:
            return np.zeros(0, dtype=np.intp)
        return np.flatnonzero(Draws.of(self.seed, crossings).damper < self.damper_share)

    def _told_damper(self) -> str:
        """A short text that only the same dampers have, as far as the first trucks show."""
        if self.damper is None:
            return ""
        first = [
            self.fleet.passing(i).vehicle
            for i in range(TOLD if not self.fleet.is_finite else min(TOLD, len(self.fleet)))
        ]
        each = [told_of(fitted(self.damper_of(truck), truck), SPEEDS) for truck in first]
        return sha256(json.dumps(each).encode()).hexdigest()[:16]

    def header(self, names: Sequence[str]) -> dict[str, Any]:
        """What two studies share if their parts fit together."""
        import joblib  # late, as it is slow to load

        of_roads = {
            quality: [None if road is None else (road.x, road.elevation) for road in roads.values()]
            for quality, roads in self.roads.items()
        }
        return {
            "bridge": described(self.bridge),
            "fleet": [repr(self.fleet), self.fleet.digest()],
            "roads": [list(self.roads), joblib.hash(of_roads)],
            "effects": dict(zip(names, map(repr, self.effects), strict=True)),
            "approach": self.approach,
            "seed": self.seed,
            "damper": self._told_damper(),
            "damper_share": self.damper_share,
            "meeting_rate": self.meeting_rate,
            "lane_factor": self.lane_factor,
        }


def checked_roads(roads: Roads, start: float, length: float) -> dict[str, dict[int, Road]]:
    """Roads by the name of their quality, which cover approach and bridge."""
    given = roads if isinstance(roads, Mapping) else {"": roads}
    if not given:
        raise ValueError("roads must hold a road, got none: type None for a smooth one")
    found = {}
    for quality, own in given.items():
        if not isinstance(quality, str):
            raise TypeError(f"roads must have names of qualities for keys, got {quality!r}")
        listed = [own] if own is None or isinstance(own, RoadProfile) else own
        if not isinstance(listed, Sequence) or not all(
            road is None or isinstance(road, RoadProfile) for road in listed
        ):
            raise TypeError(
                f"roads must be RoadProfile, a list of them, or such by the name of a quality, got "
                f"{own!r:.60}: type for example {{'A': [bridgectl.iso8608_profile('A', 125, "
                "seed=1, start=-100)]}"
            )
        if not listed:
            raise ValueError(f"roads must hold a road of each quality, got none of {quality!r}")
        for number, road in enumerate(listed, 1):
            if road is not None:
                named = f" of {quality}" if quality else ""
                road.require(start, length, f"the crossing, of road {number}{named},", "approach")
        found[quality] = dict(enumerate(listed))
    return found


def checked_share(name: str, value: float) -> float:
    """A share from 0 to 1."""
    share = check.not_negative(name, value)
    if share > 1:
        raise ValueError(f"{name} must be at most 1, got {share:g}: type {share / 100:g}")
    return share


def time_on_bridge(passing: Passing, length: float) -> float:
    """Time from a truck's first tire on the bridge to its last one off it [s]."""
    return (length + float(passing.vehicle.linear.tire_offsets.max())) / passing.speed
