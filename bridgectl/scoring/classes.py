"""Ramp surfaces both ways, of the classes that roads are of: what `bridgectl.score` adds to DAFs.

The roads of a study are put to classes by their ramps, whose variance is what the DAE of second
order takes from a class.
"""

from __future__ import annotations

import math
import warnings
from collections.abc import Iterable

import numpy as np

from bridgectl._checks import FloatArray
from bridgectl.dampers.fitted import Fitted
from bridgectl.linear.lift_off import LiftOffWarning
from bridgectl.model.crossing import Crossing
from bridgectl.road.iso8608 import ramp_covariance
from bridgectl.road.psd import CLASSES
from bridgectl.simulate import ramp_surface
from bridgectl.surface.compute import RAMP_LENGTH, RampGrid, class_height
from bridgectl.surface.histories import FeedbackHistories
from bridgectl.surface.surface import RampSurface

EVERY = 10
"""Ramps lie at every so many-th place: all places give the same order of strategies."""


def classes_of(elevations: FloatArray) -> tuple[str, ...]:
    """Return the class of each road (n_roads, n) [m] whose ramps have the nearest spread."""
    variances = np.diff(elevations, axis=1).var(axis=1)
    least = ramp_covariance(CLASSES[0], 1, RAMP_LENGTH)[0]
    with np.errstate(divide="ignore"):  # a smooth road is of the first class
        steps = np.log(variances / least) / math.log(4)  # each class has four times the roughness
    return tuple(CLASSES[int(i)] for i in np.clip(np.round(steps), 0, len(CLASSES) - 1))


def with_surface(classes: Iterable[str], n_ramps: int) -> tuple[str, ...]:
    """Return the different ones, in order, whose unit ramp is no higher than long."""
    return tuple(
        each
        for each in sorted(set(classes))
        if class_height(each, RAMP_LENGTH, n_ramps) <= RAMP_LENGTH
    )


def n_class_ramps(n_ramps: int) -> int:
    """Ramps that a surface simulates, of so many places: drops and rises."""
    return 2 * len(range(0, n_ramps, EVERY))


def class_part(
    crossing: Crossing, damper: Fitted, speeds: FloatArray, approach: float, road_class: str
) -> dict[str, FloatArray]:
    """Compute the DAFs of a surface of the class, at the places where it has ramps."""
    # R >= 0 is simulated, and the roads tell of lift-off.
    with warnings.catch_warnings(action="ignore", category=LiftOffWarning):
        surface = ramp_surface(
            crossing.beam, crossing.vehicle, speeds, approach=approach, ramp_height=road_class,
            both_ways=True, every=EVERY, effect=crossing.effect,
            damper=damper, progress=False,
        )  # fmt: skip
    return {
        "daf_smooth": surface.daf_smooth,
        "daf_unit": surface.daf_unit[:, ::EVERY],
        "daf_rise": np.asarray(surface.daf_rise)[:, ::EVERY],
    }


def class_shapes(n_speeds: int, n_ramps: int) -> dict[str, tuple[int, ...]]:
    """Names and shapes of what `class_part` returns."""
    n_places = n_class_ramps(n_ramps) // 2
    return {
        "daf_smooth": (n_speeds,),
        **dict.fromkeys(("daf_unit", "daf_rise"), (n_speeds, n_places)),
    }


def class_surface(
    crossing: Crossing,
    strategy: str,
    speeds: FloatArray,
    positions: FloatArray,
    road_class: str,
    part: dict[str, FloatArray],
) -> RampSurface:
    """Make the surface of what `class_part` returned."""
    height = class_height(road_class, RAMP_LENGTH, len(positions))
    grid = RampGrid(-float(positions[0]), RAMP_LENGTH, height, len(positions), True, EVERY)
    ramps = np.array([part["daf_unit"], part["daf_rise"]])
    return grid.surface(crossing, speeds, part["daf_smooth"], ramps, FeedbackHistories(strategy))
