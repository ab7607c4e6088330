"""One share of the work: some crossings of random trucks, on a road of each quality."""

from __future__ import annotations

import warnings
from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from bridgectl._checks import FloatArray
from bridgectl.fleet.sources import Passing
from bridgectl.fleet.study import HOUR, Draws, Road, Share, Study, time_on_bridge
from bridgectl.linear.lift_off import LiftOffWarning
from bridgectl.linear.many.crossings import many_crossings
from bridgectl.model.quarter_car import QuarterCar
from bridgectl.model.traffic import convoy
from bridgectl.model.vehicle import Vehicle
from bridgectl.simulate import daf

OF_TRUCKS = ("kind", "speed", "gross_weight", "n_axles", "meeting")
"""What is told of each crossing, whatever the road; `OF_CROSSINGS` of each road, too."""

OF_CROSSINGS = ("road", "least_tire_force")

OF_EFFECTS = ("static_peaks", "factors", "places", "times")
"""What is told of each crossing and effect: see `ManyCrossings`."""

Part = dict[str, NDArray[Any]]
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


def simulate_share(share: Share) -> Part:
    """Simulate some crossings: see `Part`."""
    study, draws = share.study, Draws.of(share.study.seed, share.crossings)
    with warnings.catch_warnings(action="ignore", category=LiftOffWarning):  # the least force tells
        meant = [_meant(share, k, draws) for k in range(len(share.crossings))]
        part = _told(share, [each.passing for each in meant])
        part["meeting"] = np.array([each.meeting for each in meant])
        part |= _simulated(share, meant)
        damped = study.damped(share.crossings)
        return part | ({"damped": _damped(share, meant, damped)} if damped.size else {})


def _told(share: Share, passings: Sequence[Passing]) -> Part:
    """What is told of each truck, and of the roads."""
    kinds = {kind: code for code, kind in enumerate(share.study.kinds)}
    vehicles = [each.vehicle.linear for each in passings]
    return {
        "kind": np.array([kinds[each.kind] for each in passings]),
        "speed": np.array([each.speed for each in passings]),
        "gross_weight": np.array([vehicle.static_loads.sum() for vehicle in vehicles]),
        "n_axles": np.array([vehicle.n_tires for vehicle in vehicles]),
        "road": share.numbers,
    }


def _meant(share: Share, k: int, draws: Draws) -> _Meant:
    """Crossing k of a share."""
    study, own = share.study, share.study.fleet.passing(k)
    alone = _Meant(own, own.vehicle, own.speed, -study.approach, False)
    if not study.meeting_rate:
        return alone
    other = study.fleet.passing(len(share.crossings) + k)
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
    behind, faster = abs(later) * second.speed, second.speed / first.speed
    start = _start(study, share.crossings[k], behind, faster)
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


def _simulated(share: Share, meant: Sequence[_Meant]) -> Part:
    """What `OF_EFFECTS` and the least tire force are, without semi-active dampers."""
    study, n = share.study, len(meant)
    by_road, effects = len(study.roads), len(study.effects)
    found: Part = {name: np.empty((effects, by_road, n)) for name in OF_EFFECTS}
    found["least_tire_force"] = np.empty((by_road, n))
    meeting = np.array([each.meeting for each in meant])
    for own in [np.flatnonzero(~meeting), *np.flatnonzero(meeting)[:, np.newaxis]]:
        if not own.size:
            continue
        many = many_crossings(
            study.bridge,
            [meant[k].vehicle for k in own] * by_road,
            np.tile([meant[k].speed for k in own], by_road),
            [road for roads in _roads(share, own) for road in roads],
            start=meant[own[0]].start, effects=study.effects,
        )  # fmt: skip
        for name in OF_EFFECTS:
            found[name][..., own] = getattr(many, name).reshape(effects, by_road, -1)
        found["least_tire_force"][:, own] = many.least.reshape(by_road, -1)
    return found


def _damped(share: Share, meant: Sequence[_Meant], damped: NDArray[np.intp]) -> FloatArray:
    """Factors of some crossings with semi-active dampers, (effects, qualities, n)."""
    study = share.study
    dampers = {k: study.damper_of(meant[k].passing.vehicle) for k in damped.tolist()}
    factors = [
        daf(
            study.bridge, meant[k].vehicle, meant[k].speed, road, start=meant[k].start,
            effect=list(study.effects), damper=dampers[k], progress=False,
        )[:, 0]
        for roads in _roads(share, damped) for k, road in zip(damped.tolist(), roads, strict=True)
    ]  # fmt: skip
    return np.moveaxis(np.reshape(factors, (len(study.roads), len(damped), -1)), -1, 0)


def _roads(share: Share, own: NDArray[np.intp]) -> list[list[Road]]:
    """Roads of some crossings, by quality."""
    each = zip(share.study.roads.values(), share.numbers[:, own].tolist(), strict=True)
    return [[roads[number] for number in numbers] for roads, numbers in each]
