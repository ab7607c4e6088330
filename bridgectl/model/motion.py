"""Where a vehicle is at a time, and when it is at a place."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple, TypeAlias, cast, overload

import numpy as np
from numpy.typing import ArrayLike, NDArray

from bridgectl import _checks
from bridgectl._checks import FloatArray


@dataclass(frozen=True)
class Motion:
    """The way of the reference tire, at the start of the bridge at t = 0, by constant acceleration.

    Parameters
    ----------
    speed : float
        Speed c at the start of the bridge [m/s].
    acceleration : float or sequence of float, optional
        Acceleration a [m/s^2], negative for braking, before the bridge as on it; of several pieces
        one number each.
    changes : sequence of float, optional
        Places of the reference tire where the acceleration changes [m], increasing: one less than
        there are accelerations.

    Raises
    ------
    TypeError, ValueError
        If an argument is no number, the speed not above 0 m/s, or the places do not increase or do
        not fit the accelerations.

    Notes
    -----
    Braking puts load on the front axles of trucks that tell how high their bodies are, by `height`
    of `bridgectl.trucks.Body` or `half_car`; those of the catalog do not.

    Examples
    --------
    A truck that brakes by 3 m/s^2:

    >>> import bridgectl as bc
    >>> braking = bc.Motion(25.0, acceleration=-3.0)
    >>> x = braking.position(0.5)
    >>> print(f"at {x:.4g} m after {braking.time(x):.3f} s")
    at 12.12 m after 0.500 s

    From 10 m on the bridge to 20 m alone:

    >>> bc.Motion(25.0, acceleration=[0, -3, 0], changes=[10, 20])
    Motion(speed=25 m/s, acceleration=(0, -3, 0) m/s^2, changes at (10, 20) m)
    """

    speed: float
    acceleration: float | Sequence[float] = 0.0
    changes: Sequence[float] = ()

    def __post_init__(self) -> None:
        object.__setattr__(self, "speed", _checks.positive("speed", self.speed, unit="m/s"))
        given: ArrayLike = self.acceleration
        if isinstance(given, str) or np.ndim(given) == 0:
            given = [_checks.number("acceleration", given, unit="m/s^2")]
        each = _checks.array("acceleration", given, (None,), unit="m/s^2")
        places = _checks.array("changes", self.changes, (None,), unit="m")
        if len(each) != len(places) + 1:
            raise ValueError(
                "changes must be the places between the accelerations, one less than these: got "
                f"{len(places)} places for {len(each)} accelerations; type for example "
                "Motion(25.0, acceleration=[0, -3], changes=[10])"
            )
        if np.any(np.diff(places) <= 0):
            raise ValueError(f"changes must increase [m], got {places.tolist()}")
        values = tuple(float(a) for a in each)
        object.__setattr__(self, "acceleration", values if len(values) > 1 else values[0])
        object.__setattr__(self, "changes", tuple(float(x) for x in places))

    def __repr__(self) -> str:
        each = ", ".join(f"{a:g}" for a in self._accelerations)
        if not self.changes:
            return f"Motion(speed={self.speed:g} m/s, acceleration={each} m/s^2)"
        places = ", ".join(f"{x:g}" for x in self.changes)
        return (
            f"Motion(speed={self.speed:g} m/s, acceleration=({each}) m/s^2, changes at "
            f"({places}) m)"
        )

    @property
    def uniform(self) -> bool:
        """Whether the speed is constant."""
        return not any(self._accelerations)

    @property
    def _accelerations(self) -> tuple[float, ...]:
        given = self.acceleration
        return given if isinstance(given, tuple) else (given,)

    @cached_property
    def _pieces(self) -> _Pieces:
        """The pieces, of which one ends and one begins at the start of the bridge, too."""
        places, each = np.array(self.changes), np.array(self._accelerations)
        zero = int(np.searchsorted(places, 0.0))
        if zero == len(places) or places[zero] != 0:
            places, each = np.insert(places, zero, 0.0), np.insert(each, zero, each[zero])
        squares, times = np.full((2, len(places)), [[self.speed**2], [0.0]])
        outward = [(k, k + 1, k + 1) for k in range(zero, len(places) - 1)]
        outward += [(k, k - 1, k) for k in range(zero, 0, -1)]
        for here, there, piece in outward:
            way = places[there] - places[here]
            # Beyond a standstill there is no speed, and no time.
            left = squares[here] + 2 * each[piece] * way
            squares[there] = left if left > 0 else np.nan
            times[there] = times[here] + 2 * way / np.sqrt(squares[[here, there]]).sum()
        anchor = np.append(np.arange(zero + 1), np.arange(zero, len(places)))
        return _Pieces(places, times, each, places[anchor], np.sqrt(squares[anchor]), times[anchor])

    @overload
    def position(self, t: float) -> float: ...
    @overload
    def position(self, t: FloatArray) -> FloatArray: ...
    def position(self, t: float | FloatArray) -> float | FloatArray:
        """Place [m] at a time [s].

        Parameters
        ----------
        t : float or ndarray
            Times [s].

        Returns
        -------
        float or ndarray
            x [m], of the shape of `t`.
        """
        if self.uniform:
            return self.speed * t
        pieces = self._pieces
        # Times of places that are never come to are no numbers, and sort as the latest.
        at = np.searchsorted(np.nan_to_num(pieces.times, nan=np.inf), t, side="right")
        since = t - pieces.time[at]
        return pieces.place[at] + (pieces.speed[at] + pieces.each[at] / 2 * since) * since

    @overload
    def time(self, x: float) -> float: ...
    @overload
    def time(self, x: FloatArray) -> FloatArray: ...
    def time(self, x: float | FloatArray) -> float | FloatArray:
        """Time [s] when it first comes to a place [m].

        Parameters
        ----------
        x : float or ndarray
            Places [m].

        Returns
        -------
        float or ndarray
            t [s], of the shape of `x`.

        Raises
        ------
        ValueError
            If it comes to a stop before, or from a standstill after it.
        """
        if self.uniform:
            return x / self.speed
        pieces, at, way = self._pieces, *self._within(x)
        # From 2 x / (c + sqrt(c^2 + 2 a x)), which has no cancellation.
        return pieces.time[at] + 2 * way / (pieces.speed[at] + self.speeds(x))

    def speeds(self, x: float | FloatArray) -> FloatArray:
        """Speeds [m/s] at places [m].

        Parameters
        ----------
        x : float or ndarray
            Places [m].

        Returns
        -------
        ndarray
            Of the shape of `x`.

        Raises
        ------
        ValueError
            As `time`.
        """
        if self.uniform:
            return np.full(np.shape(x), self.speed)
        pieces, at, way = self._pieces, *self._within(x)
        square = pieces.speed[at] ** 2 + 2 * pieces.each[at] * way
        if not np.all(square > 0):
            raise ValueError(self._standstill(float(np.ravel(x)[np.argmin(np.ravel(square > 0))])))
        return np.asarray(np.sqrt(square))

    def accelerations(self, x: float | FloatArray) -> FloatArray:
        """Accelerations [m/s^2] at places [m], of where they change the later one.

        Parameters
        ----------
        x : float or ndarray
            Places [m].

        Returns
        -------
        ndarray
            Of the shape of `x`.
        """
        if self.uniform:
            return np.zeros(np.shape(x))
        return np.asarray(self._pieces.each[self._within(x)[0]])

    def _within(self, x: float | FloatArray) -> tuple[NDArray[np.intp], FloatArray]:
        """The piece of each place, and how far it is from where that one is known [m]."""
        at = np.searchsorted(self._pieces.places, x, side="right")
        return at, np.asarray(x - self._pieces.place[at])

    def _standstill(self, x: float) -> str:
        """Where it stands on the way to a place [m], in words."""
        pieces = self._pieces
        speeds, ends = pieces.speed, np.array([-np.inf, *pieces.places, np.inf])
        with np.errstate(divide="ignore", invalid="ignore"):
            stops = pieces.place - speeds**2 / 2 / pieces.each
        inside = (stops >= ends[:-1]) & (stops <= ends[1:]) & ((stops > 0) == (x > 0))
        stop, a = next(
            (stop, a) for stop, a, known in zip(stops, pieces.each, inside, strict=True) if known
        )
        how = "it stands at" if x > 0 else "it comes from rest at"
        return (
            f"acceleration must not bring the vehicle to rest on its way: at {a:g} m/s^2 {how} "
            f"x = {stop:.4g} m"
        )


class _Pieces(NamedTuple):
    """Pieces of constant acceleration, n + 1 between n places; `each` is that acceleration.

    Of every piece place, speed and time are known at one end.
    """

    places: FloatArray
    times: FloatArray
    each: FloatArray
    place: FloatArray
    speed: FloatArray
    time: FloatArray


Speeds: TypeAlias = ArrayLike | Motion | Sequence[float | Motion]
"""One or several speeds [m/s], or motions."""


def as_motion(speed: float | Motion) -> Motion:
    """Return the motion, or that of a constant speed [m/s]."""
    return speed if isinstance(speed, Motion) else Motion(speed)


def given_speeds(given: Speeds) -> tuple[FloatArray, list[Motion]]:
    """Return speeds [m/s], and the motions, none if all are uniform."""
    each = list(given) if isinstance(given, list | tuple) else [given]
    if not any(isinstance(one, Motion) for one in each):
        return _checks.speeds(cast(ArrayLike, given)), []
    motions = [as_motion(cast(float | Motion, one)) for one in each]
    c = _checks.speeds([motion.speed for motion in motions])
    return c, [] if all(motion.uniform for motion in motions) else motions
