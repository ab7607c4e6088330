"""How cells are passed through: at several constant speeds, or by one motion that accelerates."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from bridgectl._checks import FloatArray
from bridgectl.linear.modes import hold_responses
from bridgectl.model.motion import Motion
from bridgectl.model.paths import Paths

DEGREE = 14
"""Of the polynomials in the duration of a cell that stand for its responses where durations are
many. No motion advances by more than `bridgectl.linear.nodes.MAX_VEHICLE_PHASE` in a cell."""


class Pace:
    """Durations of cells between nodes, and where in a cell a vehicle is at a part of its time.

    Axis names: S speeds, 1 of a motion; C cells; U kinds of cells, of one duration each.
    """

    def __init__(self, nodes: FloatArray, speeds: FloatArray, motion: Motion | None) -> None:
        self._nodes, self._speeds, self._motion = nodes, speeds, motion
        widths = np.diff(nodes)
        self.kind: NDArray[np.intp] = np.arange(len(widths))
        if motion is None:
            # Widths that differ by round-off only share their matrix exponentials.
            widths, self.kind = np.unique(np.round(widths, 10), return_inverse=True)
            self.durations: FloatArray = widths / speeds[:, np.newaxis]
        else:
            self.durations = np.diff(motion.time(nodes))[np.newaxis]
        self.widths = widths
        """Of the kinds [m], (U,); `durations` [s] are (S, U), `kind` is that of each cell (C,)."""

    def shares(self, points: FloatArray) -> FloatArray:
        """Shares of a cell's width that are behind after parts of its duration, (1 or C, p)."""
        if self._motion is None:
            return points[np.newaxis]
        starts = self._nodes[:-1, np.newaxis]
        times = self._motion.time(starts) + self.durations[0][:, np.newaxis] * points
        return np.asarray((self._motion.position(times) - starts) / self.widths[:, np.newaxis])

    def speeds(self, points: FloatArray) -> FloatArray:
        """Speeds [m/s] after parts of a cell's duration, (S, 1 or C, p)."""
        if self._motion is None:
            return np.repeat(self._speeds[:, np.newaxis, np.newaxis], len(points), axis=2)
        starts, widths = self._nodes[:-1, np.newaxis], self.widths[:, np.newaxis]
        return self._motion.speeds(starts + widths * self.shares(points))[np.newaxis]

    def climbed(self, points: FloatArray, lags: FloatArray, widths: FloatArray) -> FloatArray:
        """Road under tires after parts of a cell over its rise in it, (1 or S, 1 or M, p, tires).

        With tire damping, of lags [s], with the rate of that: widths [m] are those of the M maps.
        """
        shares = self.shares(points)[np.newaxis, :, :, np.newaxis] + np.zeros(len(lags))
        if not lags.any():
            return shares
        rates = self.speeds(points) / widths[:, np.newaxis]
        return np.asarray(shares + lags * rates[..., np.newaxis])


def climbed_each(
    pace: Pace, points: FloatArray, lags: FloatArray, paths: Paths, nodes: FloatArray
) -> FloatArray:
    """`Pace.climbed` where each tire has a motion of its own, (1, C, p, tires)."""
    starts, widths = nodes[:-1, np.newaxis], np.diff(nodes)[:, np.newaxis]
    x, ends = starts + widths * pace.shares(points), paths.ways(nodes)
    ways = np.diff(ends, axis=0)[:, np.newaxis]
    shares = (paths.ways(x) - ends[:-1, np.newaxis]) / ways
    rates = pace.speeds(points)[0][..., np.newaxis] * paths.paces(x) / ways
    return np.asarray(shares + lags * rates)[np.newaxis]


def speeds_at(x: FloatArray, speeds: FloatArray, motion: Motion | None) -> FloatArray:
    """Speeds [m/s] at places [m], (S, m)."""
    if motion is None:
        return np.repeat(speeds[:, np.newaxis], len(x), axis=1)
    return motion.speeds(x)[np.newaxis]


def responses(
    matrix: FloatArray,
    inputs: FloatArray,
    durations: FloatArray,
    stages: FloatArray,
    points: FloatArray,
) -> tuple[FloatArray, FloatArray]:
    """Return `hold_responses`, of many durations from polynomials in them."""
    if durations.shape[1] <= 2 * DEGREE:
        return hold_responses(matrix, inputs, durations, stages, points)
    longest = durations.max(axis=1)
    knots = np.polynomial.chebyshev.chebpts1(DEGREE + 1)
    to_series = np.linalg.inv(np.polynomial.chebyshev.chebvander(knots, DEGREE))
    known = hold_responses(matrix, inputs, np.outer(longest, (1 + knots) / 2), stages, points)
    at = np.polynomial.chebyshev.chebvander(2 * durations / longest[:, np.newaxis] - 1, DEGREE)
    free, held = (np.einsum("suk,sk...->su...", at @ to_series, of) for of in known)
    return free, held
