"""Noise on measured velocities: a stream of its own for each crossing, told by what it is."""

from __future__ import annotations

import hashlib

import numpy as np

from bridgectl._checks import FloatArray
from bridgectl._places import SAME_PLACE
from bridgectl.dampers.loop.steps import Plan

PIECE = 0.1
"""Distance of the places by whose drops a road is told from others [m]."""

ROUND = 1e-8
"""Drops [m], and speeds [m/s], that differ by less are the same: far above round-off."""

ROUNDS = 64
"""Rounds whose noise is drawn at once."""


class Noise:
    """White noise of each sample, of a standard `deviation` [m/s], by round of a plan.

    A crossing's noise depends on the seed, the leg, its speed and its road from start to the `end`
    of the bridge [m]: it is the same alone and beside others. Speeds [m/s] have the shape (S,),
    stations and drops of the roads [m] the shapes (n,) and (n, R).
    """

    def __init__(
        self,
        seed: int,
        deviation: float,
        plan: Plan,
        speeds: FloatArray,
        stations: FloatArray,
        drops: FloatArray,
        end: float,
        leg: int = 0,
    ) -> None:
        self.deviation, self.plan = deviation, plan
        count = np.ceil((end - stations[0]) / PIECE - SAME_PLACE)  # not one more by round-off
        places = stations[0] + PIECE * np.arange(count)
        roads = [_digest(np.interp(places, stations, road)) for road in drops.T]
        other = [leg] if leg else []
        self.streams = [
            [np.random.default_rng([seed, _digest(speed), road, *other]) for road in roads]
            for speed in speeds
        ]
        self.drawn = np.zeros((0, 2, len(speeds), len(roads)))
        self.first = 0

    def at(self, k: int, shape: tuple[int, ...]) -> FloatArray:
        """Noise of body and axle velocity [m/s] in round k, (2, *shape)."""
        if not 0 <= k - self.first < len(self.drawn):
            self._draw(k)
        return self.drawn[k - self.first, :, : shape[0], : shape[1]]

    def _draw(self, k: int) -> None:
        """Draw the noise of the rounds from k on; rounds follow each other."""
        self.first = k
        self.drawn = np.zeros((ROUNDS, 2, len(self.streams), len(self.streams[0])))
        for i, streams in enumerate(self.streams):
            begin = max(int(self.plan.first[i]) - k, 0)
            count = min(int(self.plan.last[i]) - k, ROUNDS) - begin
            if count > 0:
                for j, stream in enumerate(streams):
                    own = stream.normal(0.0, self.deviation, (count, 2))
                    self.drawn[begin : begin + count, :, i, j] = own


def _digest(value: FloatArray) -> int:
    """A whole number that tells a value from others, but for round-off."""
    whole = np.round(value / ROUND).astype(np.int64)
    return int.from_bytes(hashlib.blake2b(whole.tobytes(), digest_size=16).digest(), "little")
