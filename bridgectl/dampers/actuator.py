"""The damper that a strategy commands: range, force limit, lag, sampling and errors."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from numbers import Real
from typing import Any

import numpy as np

from bridgectl import _checks as check
from bridgectl._checks import FloatArray
from bridgectl._plausible import judge_damper
from bridgectl.dampers.legs import require_dampers
from bridgectl.dampers.strategy import Strategy
from bridgectl.model.quarter_car import QuarterCar, require_springs
from bridgectl.model.traffic import require_row
from bridgectl.model.vehicle import Vehicle, with_dampings


@dataclass(frozen=True)
class Damper:
    """A semi-active damper and the strategy in its controller.

    The controller samples its signals, computes c and holds it; the damper follows with a
    first-order lag *on c*, so that its force c (y_s' - y_t') never drives the suspension.

    Parameters
    ----------
    strategy : Strategy
        Commands c within its bounds.
    sample_time : float, optional
        Time between samples [s].
    lag : float, optional
        Time constant of c [s]; 0 for none.
    max_force : float, optional
        Largest force [N], either way.
    velocity_noise : float, optional
        Standard deviation of white noise on the measured velocities [m/s].
    seed : int, optional
        Seed of the noise, and of the errors of position that are drawn.
    position_error : float, optional
        How far the position that the strategy is told is beyond the true one [m], as of an
        odometer; that of a clairvoyant or constant damper does not matter.
    position_deviation : float, optional
        Standard deviation of a further such error [m]: each crossing has one, drawn once.
    acceleration_noise, travel_noise : float, optional
        Standard deviations of white noise on the measured accelerations [m/s^2] and on the
        suspension travel [m].
    position_drift : float, optional
        Share of the way since the start by which the position told runs ahead, 0.01 for a metre in
        100 m: the error of scale of an odometer.
    speed_error : float, optional
        Share by which the speed told is above the true one, 0.1 for 10 %: a strategy with a law for
        each speed then has that of another one.
    preview_noise : float, optional
        Standard deviation of white noise on each elevation that is seen ahead [m], of every sample.
    preview_delay : float, optional
        How old what is seen ahead is [s]: elevations are those that were ahead, and less that which
        was under the tire, so long ago. The strategy does not know.

    Raises
    ------
    TypeError, ValueError
        If an argument is not what is described above.

    Warns
    -----
    PlausibilityWarning
        If times look like ms, the force like kN, or the noise like mm/s.

    Examples
    --------
    >>> from bridgectl.dampers import Damper, skyhook
    >>> Damper(skyhook(1e3, 30e3), lag=0.01, max_force=15e3)
    Damper(Strategy('skyhook', c from 1000 to 30000 N s/m, dead_band=0.0001), sample_time=0.002 s, \
lag=0.01 s, max_force=15000 N, velocity_noise=0 m/s, seed=0, \
position_error=0 m, position_deviation=0 m, position_drift=0, speed_error=0, \
acceleration_noise=0 m/s^2, travel_noise=0 m, preview_noise=0 m, preview_delay=0 s)
    """

    strategy: Strategy
    sample_time: float = 2e-3
    lag: float = 0.0
    max_force: float = np.inf
    velocity_noise: float = 0.0
    seed: int = 0
    position_error: float = 0.0
    position_deviation: float = 0.0
    acceleration_noise: float = 0.0
    travel_noise: float = 0.0
    position_drift: float = 0.0
    speed_error: float = 0.0
    preview_noise: float = 0.0
    preview_delay: float = 0.0

    def __post_init__(self) -> None:
        if not isinstance(self.strategy, Strategy):
            raise TypeError(
                f"strategy must be a Strategy, got {type(self.strategy).__name__}: type for "
                "example bridgectl.dampers.skyhook(1e3, 30e3)"
            )
        check.positive("sample_time", self.sample_time, unit="s")
        check.not_negative("lag", self.lag, unit="s")
        limit: Any = self.max_force
        if not (isinstance(limit, Real) and limit == np.inf):
            check.positive("max_force", limit, unit="N")
        check.not_negative("velocity_noise", self.velocity_noise, unit="m/s")
        check.integer("seed", self.seed, at_least=0)
        check.number("position_error", self.position_error, unit="m")
        check.not_negative("position_deviation", self.position_deviation, unit="m")
        check.not_negative("acceleration_noise", self.acceleration_noise, unit="m/s^2")
        check.not_negative("travel_noise", self.travel_noise, unit="m")
        for name in ("position_drift", "speed_error"):
            if check.number(name, share := getattr(self, name)) <= -1:
                raise ValueError(
                    f"{name} must be above -1, as a share, got {share:g}: for {share:g} % type "
                    f"{share / 100:g}"
                )
        check.not_negative("preview_noise", self.preview_noise, unit="m")
        check.not_negative("preview_delay", self.preview_delay, unit="s")
        judge_damper(self)

    @property
    def noisy(self) -> bool:
        """Whether what is measured has random errors, other ones in each crossing."""
        return any((
            self.velocity_noise, self.acceleration_noise, self.travel_noise,
            self.position_deviation, self.preview_noise,
        ))  # fmt: skip

    @property
    def constant(self) -> float | None:
        """Damping [N s/m] of a damper that never changes it, and so is linear; None of others."""
        return None if self.kept is None or len(self.kept) > 1 else float(self.kept[0])

    @property
    def kept(self) -> FloatArray | None:
        """Dampings [N s/m], the best of which a crossing keeps, and so is linear; None of others.

        One of a constant damper, several of `preset`.
        """
        return self.strategy.kept if self.max_force == np.inf else None

    def __repr__(self) -> str:
        return (
            f"Damper({self.strategy!r}, sample_time={self.sample_time:g} s, lag={self.lag:g} s, "
            f"max_force={self.max_force:g} N, velocity_noise={self.velocity_noise:g} m/s, "
            f"seed={self.seed}, position_error={self.position_error:g} m, "
            f"position_deviation={self.position_deviation:g} m, "
            f"position_drift={self.position_drift:g}, speed_error={self.speed_error:g}, "
            f"acceleration_noise={self.acceleration_noise:g} m/s^2, "
            f"travel_noise={self.travel_noise:g} m, preview_noise={self.preview_noise:g} m, "
            f"preview_delay={self.preview_delay:g} s)"
        )


def as_damper(damper: object) -> Damper:
    """Return the damper, one of the default kind around a strategy alone."""
    if isinstance(damper, Damper):
        return damper
    if isinstance(damper, Strategy):
        return Damper(damper)
    example = "bridgectl.dampers.skyhook(1e3, 30e3)"
    if isinstance(damper, int | float | np.number) and damper is not True:
        example = f"bridgectl.dampers.passive({float(damper) / 1e3:g}e3)"
    elif callable(damper):
        name = getattr(damper, "__name__", "law").replace("<lambda>", "law")
        example = (
            f'{name}(1e3, 30e3), or of a law of your own Strategy("{name}", {name}, 1e3, 30e3)'
        )
    raise TypeError(
        "damper must be a bridgectl.dampers.Damper, or its strategy must be a Strategy, got "
        f"{type(damper).__name__}: type {example}"
    )


def bare_vehicle(
    vehicle: Vehicle | QuarterCar, legs: Sequence[int] | None = None
) -> Vehicle | QuarterCar:
    """Return a vehicle with some controlled dampers, by default all, in place of passive ones."""
    require_dampers(vehicle)
    require_row(vehicle, "closed loops and scores")
    require_springs(vehicle, "closed loops and scores")
    if isinstance(vehicle, QuarterCar):
        return replace(vehicle, damping=0.0)
    some = list(range(len(vehicle.damper_map)) if legs is None else legs)
    bare = with_damping(vehicle, 0.0, some).linear
    return replace(
        bare, damper_map=bare.damper_map[some], damper_axles=bare.damper_axles[some],
        damper_dampings=np.zeros(len(some)), damper_names=tuple(bare.damper_names[k] for k in some),
    )  # fmt: skip


def with_damping(
    vehicle: Vehicle | QuarterCar, damping: float, legs: Sequence[int] | None = None
) -> Vehicle | QuarterCar:
    """Return a vehicle whose passive dampers at some legs, by default all, have a damping."""
    if isinstance(vehicle, QuarterCar):
        return replace(vehicle, damping=damping)
    new = vehicle.damper_dampings.copy()
    new[slice(None) if legs is None else list(legs)] = damping
    return with_dampings(vehicle, new)
