"""What may be wrong when a damper works: bridge, vehicle, its sensors and itself.

A strategy is made for a bridge and a vehicle, knows speed and position, and commands at once. Each
error changes one of these, or several; the crossing is that of the true bridge and vehicle.
"""

from __future__ import annotations

import dataclasses
import warnings
from collections.abc import Iterable, Mapping
from types import MappingProxyType
from typing import Any, NamedTuple

from bridgectl import _checks as check
from bridgectl._plausible import PlausibilityWarning
from bridgectl.dampers.actuator import Damper
from bridgectl.dampers.fitted import Fitted
from bridgectl.dampers.measured import measured
from bridgectl.dampers.sensors import Sensors
from bridgectl.dampers.strategy import Strategy
from bridgectl.model.crossing import Crossing
from bridgectl.model.quarter_car import QuarterCar

RIGHT = "nothing"
"""The kind of the case in which nothing is wrong."""

FILTER, TOGETHER = "filter", "all at once"
"""Kinds whose cases have names instead of sizes."""

FILTERS = "accelerometers", "complementary filter", "Kalman filter"
"""See `bridgectl.dampers.Sensors`."""

SENSOR_NOISE = {"acceleration_noise": 0.05, "travel_noise": 0.5e-3}
"""Noise behind filters [m/s^2] and [m], for which `Sensors.kalman` is made."""

NONE: Mapping[str, float] = MappingProxyType({})


class Error(NamedTuple):
    """One thing that is wrong, or several: what `bridgectl.robustness` tries."""

    kind: str
    """What is wrong: errors of one kind differ in their size."""
    size: float = 0.0
    """How much, in `unit`; NaN of what has a `name` instead."""
    unit: str = ""
    """Unit of the size."""
    name: str = ""
    """What a case without a size is called."""
    damper: Mapping[str, float] = NONE
    """Fields of the damper that are other ones, in their own units."""
    frequency: float = 1.0
    """Frequencies of the bridge over those known, a ratio: by its flexural rigidity."""
    bridge_damping: float = 0.0
    """Damping ratio of the bridge beside that known."""
    load: float = 1.0
    """Sprung mass over that known, a ratio."""
    noise: float = 0.0
    """Noise of the velocities, a share of the RMS suspension velocity of the first damper."""
    sensors: str = ""
    """What velocities are estimated by: one of `FILTERS`."""

    def __str__(self) -> str:
        if self.kind == RIGHT:
            return "nothing wrong"
        if self.name:
            return f"{self.kind}: {self.name}"
        sign = "+" if self.unit in ("%", "m") and self.kind != "velocity noise" else ""
        return f"{self.kind} {self.size:{sign}g} {self.unit}"


def _together(times: float = 1.0, kind: str = TOGETHER) -> list[Error]:
    """10 ms of lag, 5 % noise, 10 % and a metre either way, at 2 ms: so many times."""
    late = {"lag": 0.01 * times, "sample_time": 2e-3}
    return [
        Error(
            kind, float("nan"), name=f"bridge {100 * f:+g} %, {x:+g} m", frequency=1 + f,
            damper=late | {"position_error": x}, noise=0.05 * times,
        )
        for f in (-0.1 * times, 0.1 * times)
        for x in (-times, times)
    ]  # fmt: skip


def _sized(kind: str, unit: str, sizes: Iterable[float], what: str, per_unit: float) -> list[Error]:
    """Errors in one thing: a field of its own, or one of the damper, which has `per_unit` more."""
    own = {"frequency": 1.0, "load": 1.0, "bridge_damping": 0.0, "noise": 0.0}
    found = []
    for size in sizes:
        value = own.get(what, 0.0) + size * per_unit
        fields: Any = {what: value} if what in own else {"damper": {what: value}}
        found.append(Error(kind, size, unit, **fields))
    return found


ERRORS: tuple[Error, ...] = (
    Error(RIGHT),
    *_sized("bridge frequency", "%", (-20, -10, 10, 20), "frequency", 0.01),
    *_sized("bridge damping", "%", (1, 3, 5), "bridge_damping", 0.01),
    *_sized("load", "%", (-20, 20), "load", 0.01),
    *_sized("speed told", "%", (-10, -5, 5, 10), "speed_error", 0.01),
    *_sized("position", "m", (-3, -1, -0.3, 0.3, 1, 3), "position_error", 1.0),
    *_sized("position drift", "%", (-3, -1, 1, 3), "position_drift", 0.01),
    *_sized("lag", "ms", (5, 10, 20, 50), "lag", 1e-3),
    *_sized("sample time", "ms", (1, 2, 5, 10), "sample_time", 1e-3),
    *_sized("velocity noise", "%", (5, 10, 20), "noise", 0.01),
    *(Error(FILTER, float("nan"), name=name, sensors=name, damper=SENSOR_NOISE)
      for name in FILTERS),
    *_together(),
)  # fmt: skip
"""What is tried by default, nothing first: sizes are of the true bridge and load beside those that
the strategies are made for, and of what is told beside the truth."""

KINDS = tuple(dict.fromkeys(error.kind for error in ERRORS if error.kind != RIGHT))
"""What may be wrong."""


def errors_of(kinds: Iterable[str] | None) -> tuple[Error, ...]:
    """Return the errors of some kinds, by default all, after that of nothing."""
    if kinds is None:
        return ERRORS
    if isinstance(kinds, str):
        raise TypeError(f"errors must be a list of kinds, got {kinds!r}: type [{kinds!r}]")
    wanted = [check.choice("errors", kind, KINDS) for kind in kinds]
    return tuple(error for error in ERRORS if error.kind in (RIGHT, *wanted))


def true_crossing(crossing: Crossing, error: Error) -> Crossing:
    """Return the crossing of the true bridge and vehicle, for one of those known."""
    beam: Any = crossing.beam
    vehicle = crossing.vehicle
    with warnings.catch_warnings(action="ignore", category=PlausibilityWarning):  # wrong on purpose
        if error.frequency != 1:
            rigidity = _each(beam.flexural_rigidity, lambda value: value * error.frequency**2)
            beam = dataclasses.replace(beam, flexural_rigidity=rigidity)
        if error.bridge_damping:
            ratio = _each(beam.damping_ratio, lambda value: value + error.bridge_damping)
            beam = dataclasses.replace(beam, damping_ratio=ratio)
        if error.load != 1 and isinstance(vehicle, QuarterCar):
            mass = vehicle.sprung_mass * error.load
            vehicle = dataclasses.replace(vehicle, sprung_mass=mass)
        return dataclasses.replace(crossing, beam=beam, vehicle=vehicle)


def applies(error: Error, crossing: Crossing) -> bool:
    """Tell whether bridge and vehicle have what the error changes."""
    stiff = hasattr(crossing.beam, "flexural_rigidity") and hasattr(crossing.beam, "damping_ratio")
    bridge = error.frequency == 1 and not error.bridge_damping
    quarter_car = isinstance(crossing.vehicle, QuarterCar)
    filtered = error.sensors != FILTERS[-1]
    return (stiff or bridge) and (quarter_car or (error.load == 1 and filtered))


def _each(value: Any, change: Any) -> Any:
    """Change a number, each of several, or the last of each pair."""
    if isinstance(value, Mapping):
        return {key: change(each) for key, each in value.items()}
    if isinstance(value, tuple | list):
        return tuple(
            (*each[:-1], change(each[-1])) if isinstance(each, tuple | list) else change(each)
            for each in value
        )
    return change(value)


def with_error(devices: Fitted, error: Error, known: Crossing, speed: float) -> Fitted | None:
    """Return the dampers as they are then, without what does not matter to them at a speed [m/s].

    `error.noise` must have become one of `error.damper`; None where no sensor tells what they need.
    """
    if devices.kept is not None:
        return Fitted(devices.legs, tuple(Damper(each.strategy) for each in devices.dampers))
    try:
        return Fitted(
            devices.legs, tuple(_with(each, error, known, speed) for each in devices.dampers)
        )
    except _UntoldError:
        return None


class _UntoldError(ValueError):
    """A strategy needs what sensors do not tell."""


def _with(damper: Damper, error: Error, known: Crossing, speed: float) -> Damper:
    if damper.constant is not None:
        clock = error.damper.get("sample_time", damper.sample_time)
        return Damper(damper.strategy, sample_time=clock)
    law = damper.strategy
    if error.sensors:
        try:
            law = measured(law, _sensors(error.sensors, known), name=law.name)
            law.for_speed(speed)
        except ValueError as reason:
            raise _UntoldError from reason
    fields: dict[str, Any] = {**error.damper, **dict.fromkeys(_idle(law, speed), 0.0)}
    return dataclasses.replace(damper, strategy=law, **fields)


def _sensors(name: str, known: Crossing) -> Sensors:
    """The filter of that name, for the vehicle that is known."""
    if name == FILTERS[-1]:
        return Sensors.kalman(known.vehicle, **SENSOR_NOISE)  # type: ignore[arg-type]
    return Sensors.accelerometers() if name == FILTERS[0] else Sensors.complementary()


NEEDS = {
    "position_error": "position", "position_deviation": "position", "position_drift": "position",
    "velocity_noise": "velocity", "acceleration_noise": "acceleration", "travel_noise": "travel",
}  # fmt: skip
"""What a strategy measures to which an error of its damper matters: part of the signal's name."""


def _idle(law: Strategy, speed: float) -> list[str]:
    """Fields of a damper that are errors of what its strategy does not measure."""
    at_speed = law.for_speed(speed)
    used = at_speed.used
    idle = [name for name, signal in NEEDS.items() if not any(signal in each for each in used)]
    return idle + (["speed_error"] if at_speed is law and "speed" not in used else [])
