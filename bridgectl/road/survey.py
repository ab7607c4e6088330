"""A road from surveyed points: a satellite receiver, a total station, a cloud of laser points.

Points come uneven, with noise, and pile up where the surveyor stood still. Adding up the distances
from point to point adds up their noise, and a stop of a minute makes the road longer by metres. So
stations are counted along one smooth line through all points, and heights are means over steps.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.polynomial import Polynomial
from numpy.typing import ArrayLike

from bridgectl import _checks as check
from bridgectl._checks import FloatArray
from bridgectl._warn import warn
from bridgectl.road.sampling import COARSE, too_coarse

BENDS = 5
"""Order of the polynomial that the line is, over its own longest direction: two bends and more."""

ASIDE = 0.5
"""How far points may lie beside the line [m], root mean square: half a wheel path's width."""

FINE = 1001
"""Places among which the length of the line is added up: within 1e-6 for bends of 90 degrees."""

DEGREES = 0.1
"""Readings within less [m] both ways can only be degrees."""


def means_along(
    east: ArrayLike,
    north: ArrayLike,
    elevation: ArrayLike,
    bridge: Sequence[float] | None,
    step: float,
) -> tuple[FloatArray, FloatArray]:
    """Mean station and elevation [m] of the points in each step: `RoadProfile.from_survey`."""
    given = ("east", east), ("north", north), ("elevation", elevation)
    e, n, z = (check.array(label, values, (None,), unit="m") for label, values in given)
    if not 2 < e.size == n.size == z.size:
        raise ValueError(
            "east, north and elevation must have one length of at least 3, got "
            f"{e.size}, {n.size} and {z.size} values"
        )
    if max(np.ptp(e), np.ptp(n)) < DEGREES:
        raise ValueError(
            "east and north must be metres, got what looks like degrees: type for example "
            "north = numpy.radians(latitude - latitude[0]) * 6.371e6, and for east longitudes, "
            "times numpy.cos(numpy.radians(latitude[0]))"
        )
    origin = np.array([e[0], n[0]]) if bridge is None else check.array("bridge", bridge, (2,))
    s = _stations(np.column_stack([e, n]), origin)
    _warn_of_gaps(np.sort(s))
    _, which, count = np.unique(np.rint(s / step), return_inverse=True, return_counts=True)
    # Of place and height alike, so that a grade stays a grade wherever in its step a point lies.
    x, heights = (np.bincount(which, values) / count for values in (s, z))
    return x, heights


def _stations(points: FloatArray, origin: FloatArray) -> FloatArray:
    """Stations [m] of points (n, 2) along a smooth line through them, from the origin on."""
    middle = points.mean(axis=0)
    axes = np.linalg.svd(points - middle, full_matrices=False)[2]
    axes *= np.copysign(1.0, (points[-1] - points[0]) @ axes[0])
    along, aside = axes @ (points - middle).T
    line = Polynomial.fit(along, aside, min(BENDS, along.size - 1))
    stray = float(np.sqrt(np.mean((aside - line(along)) ** 2)))
    if stray > ASIDE:
        raise ValueError(
            f"east and north must lie on one smooth line, but stray from it by {stray:.2g} m (root "
            "mean square): pass one wheel path, once, and a few hundred metres about the bridge "
            "alone"
        )
    start = float((origin - middle) @ axes[0])
    places = np.linspace(min(along.min(), start), max(along.max(), start), FINE)
    slopes = line.deriv()((places[1:] + places[:-1]) / 2)
    way = np.append(0.0, np.cumsum(np.diff(places) * np.hypot(1, slopes)))
    return np.asarray(np.interp(along, places, way) - np.interp(start, places, way))


def _warn_of_gaps(x: FloatArray) -> None:
    """Tell of the longest stretch without a point, if there are any."""
    gaps = np.diff(x)
    if too_coarse(float(gaps.max())):
        longest = int(gaps.argmax())
        warn(
            f"the road has no point from x = {x[longest]:.4g} to {x[longest + 1]:.4g} m, and "
            f"counts as straight wherever there is none for {COARSE:g} m: pass denser points, or "
            "the part of the road that has them"
        )
