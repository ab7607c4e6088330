"""Measures of any history: how large it is.

Histories are arrays (..., n) of samples evenly spaced in time, any number at once: crossings,
speeds, tires.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from bridgectl import _checks as check
from bridgectl._checks import FloatArray


def rms(history: ArrayLike) -> FloatArray:
    """Return the root mean square of histories."""
    return np.sqrt(np.mean(histories("history", history) ** 2, axis=-1))


def largest(history: ArrayLike) -> FloatArray:
    """Return the largest absolute value of histories, as of suspension travel."""
    return np.max(np.abs(histories("history", history)), axis=-1)


def histories(name: str, value: ArrayLike, unit: str = "") -> FloatArray:
    """Check an array (..., n) of one sample or more."""
    given = check.floats(name, value, unit=unit)
    result = check.array(name, given, (None,) * max(1, given.ndim), unit=unit)
    if result.shape[-1] == 0:
        raise ValueError(f"{name} must hold one sample or more, got shape {result.shape}")
    return result
