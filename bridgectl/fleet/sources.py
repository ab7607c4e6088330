"""Where the trucks of a fleet come from: drawn from distributions, or weighed on a road."""

from __future__ import annotations

from bisect import bisect_right
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from bridgectl._checks import FloatArray
from bridgectl.fleet.distributions import key_of, uniforms
from bridgectl.fleet.kinds import Kind, shares
from bridgectl.fleet.table import Rows
from bridgectl.fleet.weighed import Unweighed, kind_of, truck
from bridgectl.model.vehicle import Vehicle


class Passing(NamedTuple):
    """A truck of a fleet as it comes to a bridge."""

    vehicle: Vehicle
    speed: float
    """[m/s]"""
    kind: str
    """Name of its kind; of a weighed truck the axles of its groups, as '1+1+3'."""
    time: float
    """After the first truck [s]; NaN where it is not known."""


@dataclass(frozen=True)
class Drawn:
    """Trucks without end, of kinds."""

    kinds: tuple[Kind, ...]
    seed: int

    size = None

    @property
    def kind_names(self) -> tuple[str, ...]:
        """Names of the kinds."""
        return tuple(kind.name for kind in self.kinds)

    def told(self) -> str:
        """All that the trucks depend on."""
        return f"{self.kinds!r} {self.seed}"

    @cached_property
    def _key(self) -> NDArray[np.uint64]:
        return key_of(self.seed)

    @cached_property
    def _shares(self) -> list[float]:
        return shares(self.kinds)

    @cached_property
    def _most(self) -> int:
        return 2 + max(len(kind.parameters) for kind in self.kinds)

    def passing(self, i: int) -> Passing:
        """Truck i."""
        share, *drawn = uniforms(self._key, i, self._most)
        kind = self.kinds[bisect_right(self._shares, share)]
        try:
            vehicle, speed = kind.drawn(drawn)
        except ValueError as error:
            raise ValueError(f"truck {i} of the fleet, of kind {kind.name!r}: {error}") from None
        return Passing(vehicle, speed, kind.name, np.nan)

    def __str__(self) -> str:
        ends = [0.0, *self._shares]
        each = [
            f"{100 * (high - low):.3g} % {kind.name}"
            for kind, low, high in zip(self.kinds[:6], ends, ends[1:], strict=False)
        ]
        more = len(self.kinds) - len(each)
        each += [f"{more} more"] * (more > 0)
        low = min(kind.speed.low for kind in self.kinds)
        high = max(kind.speed.high for kind in self.kinds)
        return f"{', '.join(each)}, {low:.4g} to {high:.4g} m/s, seed={self.seed}"


@dataclass(frozen=True, eq=False)
class Weighed:
    """Trucks of a table, in its order."""

    rows: Rows
    duration: float
    """Of the whole table, from its first to its last truck [s], NaN without times."""
    per_day: float
    unweighed: Unweighed
    seed: int

    @property
    def size(self) -> int:
        """How many there are."""
        return int(self.rows.speed.size)

    @property
    def kind_names(self) -> tuple[str, ...]:
        """Names of the kinds."""
        return tuple(sorted({kind_of(row[~np.isnan(row)]) for row in self.rows.spacings}))

    def told(self) -> str:
        """All that the trucks depend on."""
        table = [array.tobytes().hex() for array in self._arrays]
        return f"{table} {self.unweighed!r} {self.seed}"

    @cached_property
    def _key(self) -> NDArray[np.uint64]:
        return key_of(self.seed)

    def passing(self, i: int) -> Passing:
        """Truck i."""
        rows, n = self.rows, int(np.count_nonzero(~np.isnan(self.rows.loads[i])))
        loads, spacings = rows.loads[i, :n], rows.spacings[i, : n - 1]
        drawn = uniforms(self._key, int(rows.numbers[i]), len(self.unweighed.numbers))
        vehicle = truck(loads, spacings, self.unweighed.drawn(drawn))
        return Passing(
            vehicle, float(rows.speed[i]), kind_of(spacings.tolist()), float(rows.time[i])
        )

    def part(self, indices: Any) -> Weighed:
        """Some of the trucks."""
        rows = self.rows
        some = Rows(*(getattr(rows, name)[indices] for name in Rows.ARRAYS))
        return replace(self, rows=some)

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, Weighed):
            return NotImplemented
        return (self.unweighed, self.seed) == (other.unweighed, other.seed) and all(
            np.array_equal(a, b, equal_nan=True)
            for a, b in zip(self._arrays, other._arrays, strict=True)
        )

    @property
    def _arrays(self) -> list[FloatArray]:
        return [getattr(self.rows, name) for name in Rows.ARRAYS]

    def __str__(self) -> str:
        counts = np.count_nonzero(~np.isnan(self.rows.loads), axis=1)
        speeds = self.rows.speed
        a_day = f", {self.per_day:.4g} a day" if np.isfinite(self.per_day) else ""
        return (
            f"{self.size} weighed trucks of {counts.min()} to {counts.max()} axles{a_day}, "
            f"{speeds.min():.4g} to {speeds.max():.4g} m/s, seed={self.seed}"
        )
