"""All that dampers depend on, told: files of studies know by it whether they are the same."""

from __future__ import annotations

from typing import Any

from bridgectl._checks import FloatArray
from bridgectl.dampers.actuator import Damper
from bridgectl.dampers.fitted import Fitted
from bridgectl.dampers.signals import SIGNALS


def told_of(dampers: Fitted, speeds: FloatArray) -> list[list[Any]]:
    """Tell each damper, which may be another at every speed [m/s]: at the first and the last."""
    return [_told(damper, speeds) for damper in dampers.dampers]


def _told(damper: Damper, speeds: FloatArray) -> list[Any]:
    told = speeds[[0, -1]] * (1 + damper.speed_error)
    ends = [damper.strategy.for_speed(float(c)) for c in told]
    return [
        repr(damper.strategy),  # what a strategy chooses gains from is in no function
        [law.function.serialize() for law in ends],
        *([damper.strategy.signals] if damper.strategy.signals != SIGNALS else []),
        damper.strategy.gains,
        [damper.sample_time, damper.lag, damper.max_force, damper.velocity_noise, damper.seed],
        [damper.position_error, damper.position_deviation],
        [damper.position_drift, damper.speed_error],
        [damper.acceleration_noise, damper.travel_noise],
        *([seeing] if any(seeing := [damper.preview_noise, damper.preview_delay]) else []),
    ]
