"""What is told of many crossings: each doubt once, with how many it is of, and which."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import NamedTuple

import numpy as np

from bridgectl._plausible import (
    FASTEST,
    MOVING_FORCE,
    PlausibilityWarning,
    load_doubts,
    road_doubts,
    speed_doubts,
)
from bridgectl._warn import warn
from bridgectl.linear.lift_off import LiftOffWarning
from bridgectl.linear.many.crossings import Given, ManyCrossings
from bridgectl.linear.start import LEFT, start_doubt
from bridgectl.road.sampling import coarse, too_coarse

MOST_NAMED = 5
"""Vehicles that are named by their numbers."""


class Doubt(NamedTuple):
    """What is doubtful of one vehicle of a sequence."""

    vehicle: int
    text: str


def tell_given(many: Given, asker: str) -> None:
    """Tell of speeds, loads and roads that can hardly be meant, unless the package asks."""
    for doubts, category in (
        (_speeds(many) if asker == "user" else iter(()), PlausibilityWarning),
        (_loads(many), PlausibilityWarning),
        (_roads(many), PlausibilityWarning),
    ):
        if asker != "package":
            _tell(list(doubts), many, category)
    _tell(list(_coarse(many)), many, UserWarning)


def tell_found(many: Given, found: ManyCrossings, asker: str) -> None:
    """Tell of starts that are felt, unless the package asks, and of tires that leave the road."""
    if asker != "package":
        _tell(list(_starts(many, found)), many, PlausibilityWarning)
    tell_flights(many, found.flights.tolist())


def tell_flights(many: Given, places: Sequence[float | None]) -> None:
    """Tell whose tires leave the road, and where first [m]; None or not a number is nowhere."""
    flights = [
        Doubt(
            i, f"a tire leaves the road, first with the reference tire at x = {place:.2f} m: "
            "simulated with R >= 0; the crossing is not linear there",
        )
        for i, place in enumerate(places) if place is not None and not np.isnan(place)
    ]  # fmt: skip
    _tell(flights, many, LiftOffWarning)


def _tell(doubts: list[Doubt], many: Given, category: type[Warning]) -> None:
    if not doubts:
        return
    which = ", ".join(str(doubt.vehicle) for doubt in doubts[:MOST_NAMED])
    count, total = len(doubts), len(many.speeds)
    named = which + ", ..." * (count > MOST_NAMED)
    more = f" ({count} of {total}: {named})" * (count > 1)
    warn(f"vehicle[{doubts[0].vehicle}]{more}: {doubts[0].text}", category)


def _speeds(many: Given) -> Iterator[Doubt]:
    for i in np.flatnonzero(many.speeds >= FASTEST):
        fastest = float(many.speeds[i])
        if many.crossings[0][i].linear.frequencies[0] > MOVING_FORCE:
            remedy = f"for {fastest:.4g} km/h type {fastest:.4g} / 3.6"
            yield from (Doubt(int(i), text) for text in speed_doubts("speeds", fastest, remedy))


def _loads(many: Given) -> Iterator[Doubt]:
    for i, crossing in enumerate(many.crossings[0]):
        yield from (Doubt(i, text) for text in load_doubts(crossing))


def _roads(many: Given) -> Iterator[Doubt]:
    known: dict[int, str | None] = {}
    for i, road in enumerate(many.roads):
        if road is None:
            continue
        if id(road) not in known:
            known[id(road)] = next(road_doubts(road), None)
        text = known[id(road)]
        if text is not None:
            yield Doubt(i, text)


def _coarse(many: Given) -> Iterator[Doubt]:
    for i, road in enumerate(many.roads):
        if road is not None and too_coarse(road.measured_step):
            yield Doubt(i, coarse("dynamic amplification", road.measured_step, name=road.name))


def _starts(many: Given, found: ManyCrossings) -> Iterator[Doubt]:
    known: dict[int, float] = {}
    for i, road in enumerate(many.roads):
        if road is None:
            continue
        if id(road) not in known:
            known[id(road)] = float(np.ptp(road.elevation))
        if found.felt[i] * known[id(road)] <= LEFT:
            continue
        text = start_doubt(many.run(i), float(many.speeds[i]))
        if text is not None:
            yield Doubt(i, text)
