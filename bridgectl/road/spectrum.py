"""The spectrum of ISO 8608 that is asked for: its level, its slope and its band."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from bridgectl import _checks as check
from bridgectl._checks import FloatArray
from bridgectl.road.psd import CLASSES, class_roughness

DEFAULT_BAND = (0.01, 4.0)
"""Wave numbers [cycles/m] of the synthesised waves: 100 m to 0.25 m long, as in VBI-2D."""

Band = tuple[float, float]

Maker = tuple[int, Callable[[int, np.random.Generator], FloatArray]]
"""Samples of work for one road, and what makes a number of roads."""


def requested(
    roughness: str | float, level: str, waviness: float, band: Band, step: float | None = None
) -> tuple[float, float, Band]:
    """Return G_d(n0) [m^3], waviness and band [cycles/m]; see the functions below for each."""
    level_gd, exponent = requested_roughness(roughness, level), _requested_waviness(waviness)
    return level_gd, exponent, _requested_band(band, step)


def requested_roughness(roughness: str | float, level: str) -> float:
    """Return G_d(n0) [m^3] of an ISO class, or the number itself."""
    if isinstance(roughness, str):
        check.choice("roughness", roughness, tuple(CLASSES))
        return class_roughness(roughness, level)
    if level != "mean":
        raise ValueError(f'level = {level!r} goes with an ISO class: type roughness="A"')
    value = check.positive("roughness", roughness, unit="m^3")
    if value > class_roughness("H", "upper"):
        raise ValueError(
            f"roughness = {value:g} m^3 is beyond class H: type 16e-6 for the mean of class A"
        )
    return value


def _requested_waviness(waviness: float) -> float:
    """Check the exponent of the spectrum."""
    value = check.number("waviness", waviness)
    if not 1 <= value <= 3:
        raise ValueError(f"waviness must lie between 1 and 3 (2 in ISO 8608), got {value:g}")
    return value


def _requested_band(band: Band, step: float | None) -> Band:
    """Check a band [cycles/m]; at a step [m], without waves shorter than two steps."""
    low, high = check.array("band", band, (2,), unit="cycles/m")
    highest = np.inf if step is None else 0.5 / step
    if not 0 < low < min(high, highest):
        raise ValueError(
            f"band must rise from above 0 cycles/m and begin below {highest:g} (waves of two "
            f"steps), got {low:g} to {high:g}: type band={DEFAULT_BAND}"
        )
    return float(low), float(min(high, highest))
