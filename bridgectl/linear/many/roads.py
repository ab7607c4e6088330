"""Roads of even stations under the tires of many vehicles: rows of the cells, see `maps`."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from bridgectl._checks import FloatArray
from bridgectl._places import SAME_PLACE
from bridgectl.road import RoadProfile

LEVEL_STEP = 0.1
"""Stations that a smooth road counts as having [m]."""


class EvenRoad(NamedTuple):
    """A road of even stations: drops, rises to the next station, and changes of these [m].

    Each with one more at both ends, where the road is level.
    """

    first: float
    step: float
    drops: FloatArray
    rises: FloatArray
    bends: FloatArray


def even_road(profile: RoadProfile | None, datum: float) -> EvenRoad | None:
    """The road as one of even stations, if it is one."""
    if profile is None:
        return EvenRoad(0.0, LEVEL_STEP, *np.zeros((3, 3)))
    x = profile.x
    step = float(x[-1] - x[0]) / (x.size - 1)
    if np.abs(x - (x[0] + step * np.arange(x.size))).max() > SAME_PLACE:
        return None
    drops = profile.drop(x, datum, level=False)
    rises = np.diff(drops)
    return EvenRoad(
        float(x[0]), step, np.concatenate([drops[:1], drops, drops[-1:]]),
        np.concatenate([[0.0], rises, [0.0, 0.0]]),
        np.concatenate([[0.0], rises[:1], np.diff(rises), -rises[-1:], [0.0]]),
    )  # fmt: skip


class Layout(NamedTuple):
    """How a road lies in cells: their width [m], and kinks a cell or cells a station."""

    width: float
    kinks: int
    parts: int


def layout(step: float, widest: float) -> Layout:
    """Cells no wider than asked for [m], in which stations of a step [m] are always alike."""
    if step <= widest:
        kinks = int(widest / step + SAME_PLACE)
        return Layout(kinks * step, kinks, 1)
    parts = int(np.ceil(step / widest - SAME_PLACE))
    return Layout(step / parts, 1, parts)


class Rows:
    """Road rows of the cells from a start on, for N vehicles of K tires: see `maps.Maps`."""

    def __init__(
        self, roads: list[EvenRoad], own: NDArray[np.intp], lie: Layout, tires: FloatArray
    ) -> None:
        """Of roads, that of each vehicle, and places of the tires at the start [m], (N, K)."""
        each = [_refined(road, lie) for road in roads]
        sizes = np.array([road.drops.size for road in each])
        bases = np.cumsum(sizes) - sizes
        self._drops, self._rises, self._bends = (
            np.concatenate([getattr(road, name) for road in each])
            for name in ("drops", "rises", "bends")
        )
        self._base, self._last = bases[own][:, np.newaxis], sizes[own][:, np.newaxis] - 1
        first = np.array([road.first for road in each])[own, np.newaxis]
        station = lie.width / lie.kinks
        behind = (tires - first) / station
        self._ahead = np.ceil(behind).astype(np.intp)
        self._kinks = lie.kinks
        share = (self._ahead - behind) / lie.kinks
        self.places = share[:, np.newaxis] + np.arange(lie.kinks)[:, np.newaxis] / lie.kinks
        """Where in the cells the kinks are, (N, P, K)."""
        self._left = 1 / lie.kinks - share

    def start(self) -> FloatArray:
        """Road under each tire at the start [m], (N, K)."""
        return self.of(0, 1)[:, 0, :, 0]

    def of(self, first: int, count: int) -> FloatArray:
        """Rows of cells from a first one on, (N, 2 + P, K, count)."""
        ahead = self._ahead[..., np.newaxis] + self._kinks * np.arange(first, first + count)
        base, last = self._base[..., np.newaxis], self._last[..., np.newaxis]
        rows = np.empty((len(ahead), 2 + self._kinks, ahead.shape[1], count))
        # One more, as the first of each array is of the level road before.
        before = base + np.clip(ahead, 0, last)
        rises = self._rises.take(before)
        rows[:, 0] = self._drops.take(before) + self._left[..., np.newaxis] * rises
        rows[:, 1] = rises
        for i in range(self._kinks):
            rows[:, 2 + i] = self._bends.take(base + np.clip(ahead + (i + 1), 0, last))
        return rows


def _refined(road: EvenRoad, lie: Layout) -> EvenRoad:
    """The road with stations at which it goes straight on, and rises by the cell."""
    by = lie.kinks / lie.parts
    if lie.parts == 1:
        return road._replace(rises=road.rises * by, bends=road.bends * by)
    inner = road.drops[1:-1]
    at = np.arange((inner.size - 1) * lie.parts + 1)
    station, part = at // lie.parts, at % lie.parts
    rises = road.rises[1 + station] * by
    drops = inner[station] + part * rises
    bends = np.where(part == 0, road.bends[1 + station] * by, 0.0)
    return EvenRoad(
        road.first, road.step / lie.parts, np.concatenate([drops[:1], drops, drops[-1:]]),
        np.concatenate([[0.0], rises, [0.0]]), np.concatenate([[0.0], bends, [0.0]]),
    )  # fmt: skip
