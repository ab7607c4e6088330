"""One share of the work: some crossings of random trucks, on a road of each quality."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from bridgectl.fleet.fleet import Passing
from bridgectl.linear.many import many_crossings
from numpy.typing import NDArray

from bridgectl._checks import FloatArray
from bridgectl._threads import on_one_thread
from bridgectl.fleet.study import HOUR, Draws, Road, Study, time_on_bridge
from bridgectl.model.quarter_car import QuarterCar
from bridgectl.model.traffic import convoy
from bridgectl.model.vehicle import Vehicle
from bridgectl.simulate import daf

OF_TRUCKS = ("truck", "kind", "speed", "gross_weight", "n_axles", "meeting")
"""What is told of each crossing, whatever the road; `OF_CROSSINGS` of each road, too."""

OF_CROSSINGS = ("road", "least_tire_force")

OF_EFFECTS = ("static", "total", "place")
"""What is told of each crossing and effect; times follow from places."""

Part = dict[str, FloatArray]
"""Arrays of a share: (n,) of trucks, (qualities, n) of crossings, (effects, qualities, n)."""


def shapes(study: Study, crossings: range) -> dict[str, tuple[int, ...]]:
    """Names and shapes of what `simulate_share` returns."""
    n, n_damped = len(crossings), len(study.damped(crossings))
    by_road, effects = len(study.roads), len(study.effects)
    found: dict[str, tuple[int, ...]] = dict.fromkeys(OF_TRUCKS, (n,))
    found |= dict.fromkeys(OF_CROSSINGS, (by_road, n))
    found |= dict.fromkeys(OF_EFFECTS, (effects, by_road, n))
    return found | ({"damped": (effects, by_road, n_damped)} if n_damped else {})


class _Meant(NamedTuple):
    """A crossing that is meant: who drives, how fast the first does, and whether two meet."""

    passing: Passing
    vehicle: Vehicle | QuarterCar
    speed: float
    start: float
    meeting: bool


@on_one_thread
def simulate_share(study: Study, crossings: range) -> Part:
    """Simulate some crossings, one after the other: see `Part`."""
    draws = Draws.of(study.seed, crossings)
    meant = [_meant(study, i, draws, k) for k, i in enumerate(crossings)]
    passings = [each.passing for each in meant]
    kinds = {kind: code for code, kind in enumerate(study.fleet.kinds)}
    roads = [np.floor(draws.road * len(own)).astype(int) for own in study.roads.values()]
    part = {
        "truck": np.array(crossings, float) % (study.fleet.size or np.inf),
        "kind": np.array([kinds[each.kind] for each in passings], float),
        "speed": np.array([each.speed for each in passings]),
        "gross_weight": np.array([each.vehicle.linear.static_loads.sum() for each in passings]),
        "n_axles": np.array([each.vehicle.linear.n_tires for each in passings], float),
        "meeting": np.array([each.meeting for each in meant], float),
        "road": np.array(roads, float),
        **_simulated(study, meant, roads),
    }
    damped = study.damped(crossings)
    return part | ({"damped": _damped(study, meant, roads, damped)} if damped.size else {})


def _meant(study: Study, i: int, draws: Draws, k: int) -> _Meant:
    """Crossing i, row k of what is drawn."""
    own = study.fleet.passing(i)
    alone = _Meant(own, own.vehicle, own.speed, -study.approach, False)
    if not study.meeting_rate:
        return alone
    other = study.fleet.passing(study.partner(i, draws.partner[k]))
    mine, theirs = (time_on_bridge(each, study.bridge.length) for each in (own, other))
    # Trucks that come at random: whether one does while both would be on the bridge.
    if draws.meeting[k] >= -np.expm1(-study.meeting_rate / HOUR * (mine + theirs)):
        return alone
    later = draws.when[k] * (mine + theirs) - theirs  # than this truck the other comes [s]
    first, second = (own, other) if later >= 0 else (other, own)
    vehicle = convoy(
        [first.vehicle, second.vehicle], [0.0, abs(later) * second.speed],
        opposite=[first is other, second is other], lanes=[first is other, second is other],
        lane_factors=[1.0 if each is own else study.lane_factor for each in (first, second)],
        motions=[first.speed, second.speed],
    )  # fmt: skip
    start = _start(study, i, abs(later) * second.speed, second.speed / first.speed)
    return _Meant(own, vehicle, first.speed, start, True)


def _start(study: Study, i: int, behind: float, faster: float) -> float:
    """Where the first of two starts so that the second has room on its approach, too [m]."""
    if behind > study.approach:
        raise ValueError(
            f"approach must be {np.ceil(behind):g} m or more for truck {i} and the one it meets, "
            f"which is {behind:.4g} m from the bridge as the first enters it, got "
            f"{study.approach:g}: type a longer one, with roads that reach so far before and "
            "behind the bridge"
        )
    return -min(study.approach, (study.approach - behind) / faster)


def _simulated(study: Study, meant: Sequence[_Meant], roads: Sequence[NDArray[np.intp]]) -> Part:
    """What `OF_EFFECTS` and the least tire force are, without semi-active dampers."""
    n, by_road, effects = len(meant), len(roads), len(study.effects)
    found: Part = {name: np.empty((effects, by_road, n)) for name in OF_EFFECTS}
    found["least_tire_force"] = np.empty((by_road, n))
    alone = np.flatnonzero([not each.meeting for each in meant])
    for own in [alone, *np.flatnonzero([each.meeting for each in meant])[:, np.newaxis]]:
        if not own.size:
            continue
        many = many_crossings(
            study.bridge,
            [meant[i].vehicle for i in own] * by_road,
            np.tile([meant[i].speed for i in own], by_road),
            [road for q in range(by_road) for road in _roads(study, q, roads[q][own])],
            meant[own[0]].start, study.effects,
        )  # fmt: skip
        for name in OF_EFFECTS:
            found[name][..., own] = getattr(many, name).reshape(effects, by_road, -1)
        found["least_tire_force"][:, own] = many.least_force.reshape(by_road, -1)
    return found


def _damped(
    study: Study, meant: Sequence[_Meant], roads: Sequence[NDArray[np.intp]],
    damped: NDArray[np.intp],
) -> FloatArray:  # fmt: skip
    """Factors of some crossings with semi-active dampers."""
    found = np.empty((len(study.effects), len(roads), len(damped)))
    for q, own in enumerate(roads):
        for k, (i, road) in enumerate(zip(damped, _roads(study, q, own[damped]), strict=True)):
            found[:, q, k] = daf(
                study.bridge, meant[i].vehicle, meant[i].speed, road, start=meant[i].start,
                effect=list(study.effects), damper=study.damper, progress=False,
            )[:, 0]  # fmt: skip
    return found


def _roads(study: Study, quality: int, numbers: NDArray[np.intp]) -> list[Road]:
    """Roads of a quality, by number of quality and roads."""
    own = list(study.roads.values())[quality]
    return [own[number] for number in numbers]
