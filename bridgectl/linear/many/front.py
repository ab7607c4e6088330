"""What the front door does with a sequence of vehicles: checks, simulates and tells."""

from __future__ import annotations

from typing import Any

import control
from numpy.typing import ArrayLike

from bridgectl import _checks
from bridgectl._warn import asker
from bridgectl.linear.many.crossings import Given, ManyCrossings, simulate
from bridgectl.linear.many.told import tell_flights, tell_found, tell_given
from bridgectl.linear.response import METHODS, as_response, linear_response, until
from bridgectl.linear.runs import Run
from bridgectl.linear.start import require_contact
from bridgectl.model.crossing import make_crossing, require_factor
from bridgectl.model.effects import NamedEffects
from bridgectl.model.motion import Motion

_ASKED_BY = 2
"""Functions between the user and `asker`: one of these here, and the public one."""


def peaks_of_many(
    many: Given, method: str, damper: Any, *, progress: bool, factor: bool
) -> ManyCrossings:
    """Peaks of crossings for the public function that calls this; `factor` over a static peak."""
    _checks.flag("progress", progress)
    _checks.choice("method", method, METHODS)
    _refuse(damper)
    if factor:
        for own in many.crossings:
            for i, crossing in enumerate(own):
                with many.of_vehicle(i):
                    require_factor(crossing)
    who = asker(_ASKED_BY)
    tell_given(many, who)
    found = simulate(many, method, progress=progress)
    tell_found(many, found, who)
    return found


def responses_of_many(
    many: Given,
    method: str,
    damper: Any,
    effects: NamedEffects,
    static: bool,
    tail: float,
    timepts: ArrayLike | None,
) -> list[control.TimeResponseData]:
    """Responses of crossings, one after the other, for the public function that calls this."""
    _checks.choice("method", method, METHODS)
    _refuse(damper)
    tell_given(many, asker(_ASKED_BY))
    responses, places = [], []
    for i, crossing in enumerate(many.crossings[0]):
        motion = Motion(float(many.speeds[i]))
        with many.of_vehicle(i):
            read = make_crossing(
                crossing.beam, crossing.vehicle, crossing.effect, effects=effects, static=static
            )
            run = Run(read, many.start, read.exit, many.roads[i])
            require_contact(run)
            run, asked = until(run, motion, tail, timepts)
            found, place = linear_response(run, motion, asked, method)
        responses.append(as_response(run, motion, *found))
        places.append(place)
    tell_flights(many, places)
    return responses


def _refuse(damper: Any) -> None:
    if damper is not None:
        raise ValueError(
            "damper goes with one vehicle at a time: type [bridgectl.daf(beam, one, ..., "
            "damper=damper) for one in vehicles]"
        )
