"""Measures of any history: how large it is, and how often a command switches.

Histories are arrays (..., n) of samples evenly spaced in time, any number at once: crossings,
speeds, tires.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from bridgectl import _checks as check
from bridgectl._checks import FloatArray


def rms(history: ArrayLike) -> FloatArray:
    """Return the root mean square of histories.

    Parameters
    ----------
    history : array_like, shape (..., n)
        In any unit, as [m/s^2].

    Returns
    -------
    float or ndarray, shape (...)
        In the unit of the history.

    Raises
    ------
    TypeError, ValueError
        If the history is not an array of finite numbers with one sample or more.

    Examples
    --------
    >>> from bridgectl.measures import rms
    >>> print(rms([3.0, -4.0, 5.0, 0.0]).round(3))
    3.536
    """
    return np.sqrt(np.mean(histories("history", history) ** 2, axis=-1))


def largest(history: ArrayLike) -> FloatArray:
    """Return the largest absolute value of histories, as of suspension travel.

    Parameters
    ----------
    history : array_like, shape (..., n)
        For suspension travel, y_s - y_t [m] from static equilibrium.

    Returns
    -------
    float or ndarray, shape (...)
        In the unit of the history.

    Raises
    ------
    TypeError, ValueError
        As `rms`.

    Examples
    --------
    >>> from bridgectl.measures import largest
    >>> print(largest([0.01, -0.03, 0.02]))
    0.03
    """
    return np.max(np.abs(histories("history", history)), axis=-1)


def peak_to_peak(history: ArrayLike) -> FloatArray:
    """Return the largest less the smallest value of histories: the rattle space of a suspension.

    Parameters
    ----------
    history : array_like, shape (..., n)
        For suspension travel, y_s - y_t [m].

    Returns
    -------
    float or ndarray, shape (...)
        In the unit of the history.

    Raises
    ------
    TypeError, ValueError
        As `rms`.

    Examples
    --------
    >>> from bridgectl.measures import peak_to_peak
    >>> print(peak_to_peak([0.01, -0.03, 0.02]))
    0.05
    """
    return np.ptp(histories("history", history), axis=-1)


def switching_count(
    command: ArrayLike, limits: tuple[float, float], dead_band: float = 0.2
) -> NDArray[np.intp]:
    """Count how often a damper's command changes between the soft and the stiff half.

    The command counts as stiff once it rises above the middle of its range by half the dead
    band, and as soft once it falls as far below: what stays inside the dead band is no change.
    The `switches` of `bridgectl.dampers.simulate_loop`, and of scores, have no dead band.

    Parameters
    ----------
    command : array_like, shape (..., n)
        Damping coefficients c [N s/m].
    limits : pair of float
        c_min and c_max [N s/m], the ends of the range.
    dead_band : float
        Width of the dead band around the middle, as a fraction of the range, 0 to below 1.

    Returns
    -------
    int or ndarray of int, shape (...)

    Raises
    ------
    TypeError, ValueError
        If the commands are not finite numbers, the limits do not rise or the dead band is not
        such a fraction.

    Examples
    --------
    >>> from bridgectl.measures import switching_count
    >>> print(switching_count([2e3, 30e3, 15e3, 30e3, 2e3], limits=(2e3, 30e3)))
    2
    """
    low, high = check.array("limits", limits, (2,), unit="N s/m")
    if not low < high:
        raise ValueError(f"limits must rise, got {low:g} to {high:g}: type limits=(c_min, c_max)")
    band = check.not_negative("dead_band", dead_band)
    if band >= 1:
        raise ValueError(f"dead_band must be a fraction of the range below 1, got {band:g}")
    half = half_of_range(histories("command", command, "N s/m"), low, high, band)
    # Inside the dead band the last half holds; before the first, none does.
    last = np.maximum.accumulate(np.where(half != 0, np.arange(half.shape[-1]), 0), axis=-1)
    held = np.take_along_axis(half, last, axis=-1)
    return np.sum(held[..., 1:] * held[..., :-1] < 0, axis=-1)


def half_of_range(
    command: FloatArray, low: float, high: float, dead_band: float = 0.0
) -> FloatArray:
    """Return 1 for commands in the stiff half, -1 in the soft one, 0 in the dead band between."""
    from_middle = command - (low + high) / 2
    return np.sign(from_middle) * (np.abs(from_middle) > dead_band / 2 * (high - low))


def histories(name: str, value: ArrayLike, unit: str = "") -> FloatArray:
    """Check an array (..., n) of one sample or more."""
    given = check.floats(name, value, unit=unit)
    result = check.array(name, given, (None,) * max(1, given.ndim), unit=unit)
    if result.shape[-1] == 0:
        raise ValueError(f"{name} must hold one sample or more, got shape {result.shape}")
    return result
