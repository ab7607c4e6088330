"""What sensors tell beside the truth: noise, and errors of position.

Each crossing has a stream of its own, told by what it is.
"""

from __future__ import annotations

import hashlib
from collections.abc import Mapping, Sequence

import numpy as np

from bridgectl._checks import FloatArray
from bridgectl._places import SAME_PLACE
from bridgectl.dampers.actuator import Damper
from bridgectl.dampers.loop.steps import Plan

PIECE = 0.1
"""Distance of the places by whose drops a road is told from others [m]."""

ROUND = 1e-8
"""Drops [m], and speeds [m/s], that differ by less are the same: far above round-off."""

OF_POSITION, OF_SENSORS, OF_PREVIEW, OF_LEG = 1, 2, 3, 100
"""What tells random numbers for errors of position, for the noise of accelerometers and travel
sensors, and for that of what is seen ahead, from those for velocities; and those at a leg, by its
number, from the first one's. A vehicle has one odometer, and no leg an error of position of its
own."""

ROUNDS = 64
"""Rounds whose noise is drawn at once: fewer of more than two signals."""


NOISY = ("body_velocity", "axle_velocity")
"""Signals with the noise of velocities; that of the suspension is their difference."""

SENSED = ("body_acceleration", "axle_acceleration", "suspension_travel")
"""Signals with that of accelerometers and of a travel sensor."""


class Errors:
    """What the sensors of the damper of a leg tell beside the truth; arguments as of `Noise`.

    The leg is at `start` [m] when the odometer begins to count.
    """

    def __init__(
        self,
        damper: Damper,
        plan: Plan,
        speeds: FloatArray,
        stations: FloatArray,
        drops: FloatArray,
        end: float,
        leg: int = 0,
        n_ahead: int = 0,
        start: float = 0.0,
    ) -> None:
        crossings, other = (speeds, stations, drops, end), [OF_LEG + leg] if leg else []
        self.start, self.drift = start, damper.position_drift
        self.told_speed = 1.0 + damper.speed_error  # over the true one
        self.places = np.full((len(speeds), 1), damper.position_error)
        """How far the positions told are beyond the true ones [m], (S, R), or (S, 1) of all roads.
        """
        if damper.position_deviation:
            drawn = position_errors(damper.seed, damper.position_deviation, *crossings)
            self.places = self.places + drawn
        a, d = damper.acceleration_noise, damper.travel_noise
        kinds = (NOISY, [damper.velocity_noise] * 2, ()), (SENSED, [a, a, d], (OF_SENSORS,))
        self.noises = [
            (names, Noise(damper.seed, deviations, plan, *crossings, *kind, *other))
            for names, deviations, kind in kinds
            if any(deviations)
        ]
        self.delay, deviations = damper.preview_delay, [damper.preview_noise] * n_ahead
        """How old what is seen ahead is [s]."""
        self.seen = (
            Noise(damper.seed, deviations, plan, *crossings, OF_PREVIEW, *other)
            if any(deviations)
            else None
        )

    def told(self, places: FloatArray) -> FloatArray:
        """Positions told [m] at true places (S, n), but for the error of a crossing."""
        return places + self.drift * (places - self.start)

    def added(self, k: int, signals: Mapping[str, FloatArray]) -> dict[str, FloatArray]:
        """Signals of round k by name, (S, R) or (S, 1), with the errors."""
        found = dict(signals)
        here, known = found["body_velocity"].shape
        found["position"] = self.told(found["position"]) + self.places[:here, :known]
        found["speed"] = found["speed"] * self.told_speed
        for names, noise in self.noises:
            drawn = noise.at(k, (here, known))
            found |= {name: found[name] + drawn[i] for i, name in enumerate(names)}
            if names is NOISY:
                found["suspension_velocity"] = found[names[0]] - found[names[1]]
        return found

    def ahead(self, k: int, elevations: FloatArray) -> FloatArray:
        """Elevations seen ahead in round k [m], (S, n, R), with their noise."""
        if self.seen is None:
            return elevations
        drawn = self.seen.at(k, elevations[:, 0].shape)
        return np.asarray(elevations + np.moveaxis(drawn, 0, 1))


class Noise:
    """White noise of each sample, of standard `deviations` in their units, by round of a plan.

    A crossing's noise depends on the seed, the leg, its speed and its road from start to the `end`
    of the bridge [m]: it is the same alone and beside others. Speeds [m/s] have the shape (S,),
    stations and drops of the roads [m] the shapes (n,) and (n, R).
    """

    def __init__(
        self,
        seed: int,
        deviations: Sequence[float],
        plan: Plan,
        speeds: FloatArray,
        stations: FloatArray,
        drops: FloatArray,
        end: float,
        *kind: int,
    ) -> None:
        self.deviations, self.plan = deviations, plan
        self.rounds = max(1, min(ROUNDS, 2 * ROUNDS // len(deviations)))
        self.streams = _streams(seed, speeds, stations, drops, end, *kind)
        self.drawn = np.zeros((0, len(deviations), len(speeds), drops.shape[1]))
        self.first = 0

    def at(self, k: int, shape: tuple[int, ...]) -> FloatArray:
        """Noise in round k, (n, *shape), of as many signals as there are deviations."""
        if not 0 <= k - self.first < len(self.drawn):
            self._draw(k)
        return self.drawn[k - self.first, :, : shape[0], : shape[1]]

    def _draw(self, k: int) -> None:
        """Draw the noise of the rounds from k on; rounds follow each other."""
        self.first = k
        n = len(self.deviations)
        self.drawn = np.zeros((self.rounds, n, len(self.streams), len(self.streams[0])))
        for i, streams in enumerate(self.streams):
            begin = max(int(self.plan.first[i]) - k, 0)
            count = min(int(self.plan.last[i]) - k, self.rounds) - begin
            if count > 0:
                for j, stream in enumerate(streams):
                    own = stream.normal(0.0, self.deviations, (count, n))
                    self.drawn[begin : begin + count, :, i, j] = own


def position_errors(
    seed: int,
    deviation: float,
    speeds: FloatArray,
    stations: FloatArray,
    drops: FloatArray,
    end: float,
) -> FloatArray:
    """Errors of position [m] of a standard `deviation`, one a crossing, (S, R): see `Noise`."""
    every = _streams(seed, speeds, stations, drops, end, OF_POSITION)
    return np.array([[stream.normal(0.0, deviation) for stream in streams] for streams in every])


def _streams(
    seed: int,
    speeds: FloatArray,
    stations: FloatArray,
    drops: FloatArray,
    end: float,
    *kind: int,
) -> list[list[np.random.Generator]]:
    """Random numbers of each crossing, by speed and road."""
    count = np.ceil((end - stations[0]) / PIECE - SAME_PLACE)  # not one more by round-off
    places = stations[0] + PIECE * np.arange(count)
    roads = [_digest(np.interp(places, stations, road)) for road in drops.T]
    return [
        [np.random.default_rng([seed, _digest(speed), road, *kind]) for road in roads]
        for speed in speeds
    ]


def _digest(value: FloatArray) -> int:
    """A whole number that tells a value from others, but for round-off."""
    whole = np.round(value / ROUND).astype(np.int64)
    return int.from_bytes(hashlib.blake2b(whole.tobytes(), digest_size=16).digest(), "little")
