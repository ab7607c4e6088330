"""Where a vehicle is at a time, and when it is at a place."""

from __future__ import annotations

from dataclasses import dataclass
from typing import overload

import numpy as np

from bridgectl import _checks
from bridgectl._checks import FloatArray


@dataclass(frozen=True)
class Motion:
    """The way of the reference tire, x = c t + a t^2 / 2, at the start of the bridge at t = 0.

    Parameters
    ----------
    speed : float
        Speed c at the start of the bridge [m/s].
    acceleration : float, optional
        Acceleration a [m/s^2], negative for braking, before the bridge as on it. Not 0, it is
        simulated by ``method="control"`` alone.

    Raises
    ------
    TypeError, ValueError
        If an argument is no number, or the speed not above 0 m/s.

    Examples
    --------
    A truck that brakes by 3 m/s^2:

    >>> import bridgectl as bc
    >>> braking = bc.Motion(25.0, acceleration=-3.0)
    >>> x = braking.position(0.5)
    >>> print(f"at {x:.4g} m after {braking.time(x):.3f} s")
    at 12.12 m after 0.500 s
    """

    speed: float
    acceleration: float = 0.0

    def __post_init__(self) -> None:
        object.__setattr__(self, "speed", _checks.positive("speed", self.speed, unit="m/s"))
        a = _checks.number("acceleration", self.acceleration, unit="m/s^2")
        object.__setattr__(self, "acceleration", a)

    def __repr__(self) -> str:
        return f"Motion(speed={self.speed:g} m/s, acceleration={self.acceleration:g} m/s^2)"

    @property
    def uniform(self) -> bool:
        """Whether the speed is constant."""
        return self.acceleration == 0

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
        return self.speed * t if self.uniform else self.speed * t + self.acceleration / 2 * t**2

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
            If it comes to a stop before.
        """
        if self.uniform:
            return x / self.speed
        square = self.speed**2 + 2 * self.acceleration * np.asarray(x)
        if np.any(square <= 0):
            stop = -(self.speed**2) / 2 / self.acceleration
            raise ValueError(
                f"acceleration must not bring the vehicle to rest on its way: at "
                f"{self.acceleration:g} m/s^2 it stands at x = {stop:.4g} m"
            )
        # From 2 x / (c + sqrt(c^2 + 2 a x)), which has no cancellation.
        return 2 * x / (self.speed + np.sqrt(square))


def as_motion(speed: float | Motion) -> Motion:
    """Return the motion, or that of a constant speed [m/s]."""
    return speed if isinstance(speed, Motion) else Motion(speed)
