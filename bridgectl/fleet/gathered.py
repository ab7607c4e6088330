"""Shares of an assessment put together as columns: a row for each crossing."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from bridgectl.fleet.share import Part
from bridgectl.fleet.study import Study
from bridgectl.fleet.words import OF_EFFECT

TYPES = {"damped": bool, "meeting": bool, "n_axles": np.int16, "crossing": np.int64,
         "truck": np.int64}  # fmt: skip
"""Of the columns that are not floats."""


class Gathered:
    """Columns of an `Assessment`: quality by quality, last those with semi-active dampers."""

    def __init__(self, study: Study, names: Sequence[str], n: int) -> None:
        self.study, self.names, self.n = study, names, n
        self.damped = study.damped(range(n))
        size, count = len(self), len(study.roads)
        self.columns: dict[str, Any] = {
            name: np.full(size, np.nan if name not in TYPES else 0, TYPES.get(name, float))
            for name in ("crossing", "truck", "speed", "gross_weight", "n_axles", "damped",
                         "meeting", "least_tire_force",
                         *(f"{of} {effect}" for effect in names for of in OF_EFFECT))
        }  # fmt: skip
        self.columns["damped"][count * n :] = True
        qualities = np.repeat(np.tile(np.arange(count, dtype=np.int16), 2), self._repeats)
        self.columns["quality"] = qualities, tuple(study.roads)
        self.columns["kind"] = np.zeros(size, np.int16), study.kinds
        names = [name for quality in study.roads for name in _names(study, quality)]
        self.columns["road"] = np.zeros(size, np.int32), tuple(names)

    @property
    def _repeats(self) -> list[int]:
        count = len(self.study.roads)
        return [self.n] * count + [len(self.damped)] * count

    def __len__(self) -> int:
        return sum(self._repeats)

    @property
    def flights(self) -> int:
        """Crossings in which a tire leaves the road, but for those with semi-active dampers."""
        return int(np.count_nonzero(self.columns["least_tire_force"] <= 0))

    def take(self, crossings: range, part: Part) -> None:
        """Take what was found of some crossings, one after the other."""
        first, last = np.searchsorted(self.damped, [crossings.start, crossings.stop])
        which = self.damped[first:last] - crossings.start
        before = 0
        for quality, own in enumerate(self.study.roads.values()):
            plain = slice(quality * self.n + crossings.start, quality * self.n + crossings.stop)
            start = len(self.study.roads) * self.n + quality * len(self.damped)
            self._rows(plain, crossings, part, quality, before, slice(None))
            self.columns["least_tire_force"][plain] = part["least_tire_force"][quality]
            damped = slice(start + first, start + last)
            self._rows(damped, crossings, part, quality, before, which)
            for e, name in enumerate(self.names):
                self._effect(name, plain, part, (e, quality))
                if which.size:
                    factors = part["damped"][e, quality]
                    static = part["static_peaks"][e, quality, which]
                    self.columns[f"static {name}"][damped] = static
                    self.columns[f"daf {name}"][damped] = factors
                    self.columns[f"total {name}"][damped] = factors * static
            before += len(own)

    def _rows(
        self, rows: slice, crossings: range, part: Part, quality: int, before: int, which: Any
    ) -> None:
        """What is told of trucks and roads, on rows; `which` of the crossings they are."""
        numbers = np.array(crossings)[which]
        self.columns["crossing"][rows] = numbers
        self.columns["truck"][rows] = numbers
        for name in ("speed", "gross_weight", "n_axles", "meeting"):
            self.columns[name][rows] = part[name][which]
        self.columns["kind"][0][rows] = part["kind"][which]
        self.columns["road"][0][rows] = before + part["road"][quality][which]

    def _effect(self, name: str, rows: slice, part: Part, which: tuple[int, int]) -> None:
        """What is told of an effect, without semi-active dampers."""
        static, factors = part["static_peaks"][which], part["factors"][which]
        values = static, static * factors, factors, part["places"][which], part["times"][which]
        for of, value in zip(OF_EFFECT, values, strict=True):
            self.columns[f"{of} {name}"][rows] = value


def _names(study: Study, quality: str) -> list[str]:
    """Names of the roads of a quality, with numbers where several have one name."""
    roads = study.roads[quality]
    names = [quality if road is None else road.name for road in roads.values()]
    if len(set(names)) == len(names):
        return names
    return [f"{name} {number + 1}".strip() for number, name in enumerate(names)]
