"""Where tires are for a place of the first vehicle: in which lane, from which end, how fast."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike, NDArray

from bridgectl._checks import FloatArray
from bridgectl.model.motion import Motion, Speeds, given_speeds

LOOKED_AT = 2001
"""Places of the first vehicle at which it is looked how fast others are, and how far apart."""


@dataclass(frozen=True, eq=False)
class Paths:
    """Paths of q tires of m vehicles, told by the place x of the first one's reference tire.

    Each vehicle has a way of its own, 0 m where it comes on the bridge. Without motions of their
    own all are as fast as the first at every time.
    """

    offsets: FloatArray
    """Distance of each tire behind the first of its vehicle [m], (q,)."""
    vehicle: NDArray[np.intp]
    """The vehicle of each tire, (q,)."""
    distances: FloatArray
    """How far each vehicle is from the bridge when the first enters it [m], (m,)."""
    opposite: NDArray[np.bool_]
    """Whether it comes from the other end, (m,)."""
    lane_factors: FloatArray
    """Share of a tire's force that the modes feel, and of their shapes that it feels, (q,)."""
    motions: Sequence[Motion] = ()

    @classmethod
    def of(cls, offsets: FloatArray) -> Paths:
        """Paths of one vehicle."""
        one = np.zeros(1)
        return cls(offsets, np.zeros(offsets.size, np.intp), one, one > 0, np.ones(offsets.size))

    @cached_property
    def steady(self) -> bool:
        """Whether all speeds are in the same proportion throughout."""
        return all(motion.uniform for motion in self.motions)

    @cached_property
    def signs(self) -> FloatArray:
        """Directions of the tires along the bridge, 1 or -1, (q,)."""
        return np.where(self.opposite, -1.0, 1.0)[self.vehicle]

    @cached_property
    def _ratios(self) -> FloatArray:
        """Speeds over that of the first vehicle, if they are steady, (q,)."""
        if not self.motions:
            return np.ones(self.offsets.size)
        return np.array([one.speed / self.motions[0].speed for one in self.motions])[self.vehicle]

    @cached_property
    def _behind(self) -> FloatArray:
        """How far tires are from the bridge when the first vehicle enters it [m], (q,)."""
        return self.distances[self.vehicle] + self.offsets

    @cached_property
    def _late(self) -> list[float]:
        """How long after the first each vehicle enters the bridge by its motion [s]."""
        each = zip(self.motions, self.distances, strict=True)
        return [-motion.time(-float(way)) for motion, way in each]

    def ways(self, x: ArrayLike) -> FloatArray:
        """How far tires are beyond where they come on the bridge [m], (..., q)."""
        places = np.asarray(x, dtype=np.float64)
        if self.steady:
            return places[..., np.newaxis] * self._ratios - self._behind
        return np.stack(self._each(places), axis=-1)[..., self.vehicle] - self.offsets

    def _each(self, x: FloatArray) -> list[FloatArray]:
        """Ways of the vehicles by their motions [m]."""
        t = self.motions[0].time(x)
        others = zip(self.motions[1:], self._late[1:], strict=True)
        return [x, *(np.asarray(motion.position(t - late)) for motion, late in others)]

    def places(self, x: ArrayLike, length: float) -> FloatArray:
        """Places of the tires along a bridge so long [m], (..., q)."""
        ways = self.ways(x)
        return np.where(self.signs > 0, ways, length - ways) if self.opposite.any() else ways

    def paces(self, x: FloatArray) -> FloatArray:
        """Speeds of the tires on their ways over that of the first vehicle, (..., q)."""
        if self.steady:
            return np.broadcast_to(self._ratios, (*np.shape(x), self.offsets.size))
        each = zip(self.motions, self._each(x), strict=True)
        speeds = np.stack([motion.speeds(way) for motion, way in each], axis=-1)
        return np.asarray((speeds / speeds[..., :1])[..., self.vehicle])

    def fastest(self, first: float, last: float) -> float:
        """The largest of them on a stretch of the first vehicle's way [m], 1 or more."""
        count = 1 if self.steady else LOOKED_AT
        return float(self.paces(np.linspace(first, last, count)).max())

    def passing(self, places: ArrayLike, length: float, first: float, last: float) -> FloatArray:
        """Where the first vehicle is, on a stretch of its way, as tires pass places [m]."""
        along = np.asarray(places, dtype=np.float64)[:, np.newaxis]
        ways = np.where(self.signs > 0, along, length - along) if self.opposite.any() else along
        if not self.motions:
            return np.asarray((ways + self._behind).ravel())
        ends = self.ways(np.array([first, last]))
        ways = np.broadcast_to(ways, (len(along), self.offsets.size))
        inside = (ways >= ends[0]) & (ways <= ends[1])
        found = [self._when(tire, ways[inside[:, tire], tire]) for tire in range(ways.shape[1])]
        return np.concatenate(found)

    def _when(self, tire: int, ways: FloatArray) -> FloatArray:
        """Where the first vehicle is when a tire is so far on its way [m]."""
        if self.steady:
            return np.asarray((ways + self._behind[tire]) / self._ratios[tire])
        own, fronts = self.vehicle[tire], ways + self.offsets[tire]
        if own == 0:
            return fronts
        return self.motions[0].position(self.motions[own].time(fronts) + self._late[own])

    def exit(self, length: float) -> float:
        """Where the first vehicle is when the last tire leaves a bridge so long [m]."""
        end = np.array([length])
        return max(float(self._when(tire, end)[0]) for tire in range(self.offsets.size))

    def changes(self, first: float, last: float) -> FloatArray:
        """Where the first vehicle is as others' accelerations change, on a stretch of its way."""
        found: list[FloatArray] = [np.zeros(0)]
        for own, motion in enumerate(self.motions):
            front = int(np.flatnonzero((self.vehicle == own) & (self.offsets == 0))[0])
            ends, places = self.ways(np.array([first, last]))[:, front], np.array(motion.changes)
            found.append(self._when(front, places[(places > ends[0]) & (places < ends[1])]))
        return np.concatenate(found)

    def covered(self, x: float, length: float) -> tuple[float, float]:
        """The road that first tires need from a start on, and that on a bridge so long [m]."""
        fronts = self.places(x, length)[(self.offsets == 0) & (self.signs < 0)]
        return 0.0 if self.opposite.all() else x, max([length, *fronts.tolist()])

    def beyond(self) -> float | None:
        """How far from the bridge vehicles from the other end are as the first enters it [m]."""
        return float(self.distances[self.opposite].max()) if self.opposite.any() else None

    def require_alike(self) -> None:
        """Refuse vehicles with motions of their own."""
        if self.motions:
            raise ValueError(
                "motions must be left out of convoy(...) in ramp surfaces, where all vehicles are "
                "as fast as the first"
            )

    def require(self, motion: Motion) -> None:
        """Refuse another motion than that of the first vehicle, if vehicles have their own."""
        if self.motions and motion != self.motions[0]:
            own = self.motions[0]
            asked = f"{own.speed:g}" if own.uniform else repr(own)
            raise ValueError(
                "speed must be that of the first vehicle where vehicles have motions of their "
                f"own, got {motion!r}: type {asked}, or leave out motions in convoy(...)"
            )

    def require_steady(self, speeds: FloatArray) -> None:
        """Refuse motions that are not told by one speed [m/s]."""
        for speed in speeds:
            self.require(Motion(float(speed)))
        if not self.steady:
            raise ValueError(
                "motions must be of constant speed here: those that are not go with "
                "crossing_response, daf and peak_effect"
            )

    def given(self, speeds: Speeds) -> tuple[FloatArray, list[Motion]]:
        """Speeds [m/s], and the motions if there are any but of steady speeds."""
        c, motions = given_speeds(speeds)
        each = motions or [Motion(float(speed)) for speed in c]
        for motion in each if self.motions else ():
            self.require(motion)
        return c, motions if self.steady else each
