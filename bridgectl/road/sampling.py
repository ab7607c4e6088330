"""How densely a road was measured, and what that is too coarse for.

A road is straight between its stations, and its bumps are as long as the pieces or longer. Where
it was measured every 2 m, the waves that shake a vehicle were never seen: its IRI and its dynamic
amplification come out too low, and interpolation at finer stations does not bring them back.
"""

from __future__ import annotations

from typing import Any, TypeAlias

import numpy as np

from bridgectl._checks import FloatArray
from bridgectl._places import SAME_PLACE
from bridgectl._warn import warn
from bridgectl.road.limits import evenly_spaced

RoadProfile: TypeAlias = Any  # its module imports this one

COARSE = 0.305
"""Longest step [m] that an IRI or a dynamic amplification bears: one foot.

World Bank Technical Paper 46 wants 250 mm for an IRI of its first class and 500 mm for the second;
profilers store a reading every foot or closer. Of random roads of ISO 8608 class A (12 roads of
225 m, stations of 50 mm, waves down to 0.1 m; 5 speeds on the paper's bridge), samples give (see
``tests/test_sampling.py``)

    step [m]               0.1    0.25   0.3    0.5    1      2      5
    IRI too low by [%]     1      0      1      7      7      69     87
    rms error of the DAF   0.001  0.004  0.005  0.007  0.011  0.020  0.028

and twice the error of the DAF for class B. Up to 0.3 m that is little beside the errors of up to
0.02 that a DAE is trusted with.
"""

FEWEST, SHORTEST = 12, 70.0
"""Pieces and length [m] of elevations that count as a measurement; shapes are drawn with less."""

DRAWN = 5
"""A file, too, may hold a shape, of fewer pieces than this."""

MOST = 0.4
"""A quantile: of the pieces of a measured road, most are as long as its step."""

FEW_BENDS, NO_BEND = 0.6, 0.3
"""An interpolated road bends at this share of its stations at most; elsewhere, by less than this of
the root mean square."""

EVEN = 0.6
"""Share of an interpolated road whose pieces are equally long, but for a station."""


def measured_step(x: FloatArray, elevation: FloatArray, *, record: bool = False) -> float:
    """Return the step [m] at which a road was measured, 0 for one that was drawn.

    `record` tells that it is known to be a measurement, from a file. Elevations of other origin may
    be a shape, such as one ramp on a level road: straight because it is meant to be.
    """
    if x.size <= DRAWN or not (record or x[-1] - x[0] >= SHORTEST):
        return 0.0
    pieces = _straight_pieces(x, elevation)
    if pieces.size < (DRAWN if record else FEWEST):
        return 0.0
    return float(np.quantile(pieces, MOST))


def _straight_pieces(x: FloatArray, elevation: FloatArray) -> FloatArray:
    """Lengths of what lies between stations, or between bends of an interpolated road."""
    if not evenly_spaced(x):
        return np.diff(x)
    step = float(x[-1] - x[0]) / (x.size - 1)
    bends = np.diff(elevation, 2)
    least = max(NO_BEND * float(np.sqrt(np.mean(bends**2))), SAME_PLACE)
    slight = np.abs(bends) < least
    # Slabs that curl are curved between their joints; there the slight bends add up.
    sharp = float(np.abs(bends[~slight]).sum())
    curved = abs(float(bends[slight].sum())) > max(NO_BEND * sharp, SAME_PLACE)
    bends[slight] = 0.0
    places = np.flatnonzero(bends) + 1
    # A bend between two stations is shared by both and of one sign there; in a rough road, or at
    # the ends of a joint, bends of neighbours are of opposite signs.
    opposed = float(bends[1:] @ bends[:-1]) < -0.05 * float(bends @ bends)
    if opposed or curved or places.size > FEW_BENDS * bends.size:
        return step * np.ones(x.size - 1)
    places = places[np.diff(places, prepend=-1) > 1]
    pieces = np.diff(places, prepend=0, append=x.size - 1)
    even = np.abs(pieces - np.median(pieces)) <= 1  # not so where a road bends at its potholes
    return step * (pieces if pieces[even].sum() >= EVEN * pieces.sum() else np.ones(x.size - 1))


def too_coarse(step: float, pieces: float = 0.0) -> bool:
    """Tell whether a road measured at a step [m] is too coarse, where it counts in `pieces` [m]."""
    return step > max(COARSE, pieces) * (1 + 1e-6)


def warn_if_coarse(road: RoadProfile, what: str, step: float = 0.0, pieces: float = 0.0) -> None:
    """Warn that what is made of a road means little, as it was measured too coarsely.

    `step` [m] is that of its stations where only a measured road makes sense, not a drawn one.
    """
    step = road.measured_step or step
    if too_coarse(step, pieces):
        warn(coarse(what, step, pieces, road.name))


def coarse(what: str, step: float, pieces: float = 0.0, name: str = "") -> str:
    """Say what is wrong with a road that is too coarse, and what to do."""
    label = f"{name}: " if name else ""
    return (
        f"{label}the road was measured every {step:.3g} m, too coarsely for {what}, which needs "
        f"{max(COARSE, pieces):.3g} m or less: shorter bumps are missing, and interpolation does "
        "not bring them back; pass a road measured every 0.25 m or closer"
    )
