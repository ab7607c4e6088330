"""What stations and elevations must be: increasing, and in the unit they are said to be in."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from bridgectl._checks import FloatArray
from bridgectl._places import SAME_PLACE

MAX_SLOPE = 1.0  # [m/m]; no road climbs at 45 degrees, but millimetres read as metres do
TEXTURE = 0.005  # [m]; stones are so high
JITTER = 0.1  # of a step; stations that stray no farther change an IRI by less than 1 %
ROUNDED = 0.55  # of a step; rounded stations stray no farther
ROUND_OFF = 1.5  # of the last decimal; stations rounded by half of it either way stray no farther
DECIMAL_UNITS = (1.0, 0.3048, 0.0254)  # [m]; units whose decimals stations are rounded to


def first_unsorted(x: FloatArray) -> int | None:
    """Return the index of the first station that is not past the one before it, if any."""
    return _first(~(x[1:] > x[:-1]))


def first_too_steep(x: FloatArray, elevation: FloatArray) -> int | None:
    """Return the index of the first point that a slope above `MAX_SLOPE` leads to, if any.

    Texture is no slope: a stone may rise by `TEXTURE` over any length.
    """
    with np.errstate(over="ignore"):
        highest = MAX_SLOPE * np.maximum(np.diff(x), TEXTURE) + SAME_PLACE
        return _first(~(np.abs(np.diff(elevation)) <= highest))


def _first(bad: NDArray[np.bool_]) -> int | None:
    return int(np.argmax(bad)) + 1 if bad.any() else None


def require_increasing(x: FloatArray) -> None:
    """Raise a ValueError that names the first station out of order."""
    if (i := first_unsorted(x)) is None:
        return
    repeated = x[i] == x[i - 1]
    slip, remedy = ("repeats", "remove one") if repeated else ("lies before", "sort the points")
    raise ValueError(
        f"x must increase, but x[{i}] = {x[i]:.10g} m {slip} x[{i - 1}] = {x[i - 1]:.10g} m: "
        f"{remedy}"
    )


def require_gentle(x: FloatArray, elevation: FloatArray) -> None:
    """Raise a ValueError that names the first slope above `MAX_SLOPE`."""
    if (i := first_too_steep(x, elevation)) is None:
        return
    raise ValueError(
        f"elevation[{i}] = {elevation[i]:.6g} m at x = {x[i]:.10g} m, after {elevation[i - 1]:.6g} "
        f"m at {x[i - 1]:.10g} m, is steeper than {MAX_SLOPE:g} m/m: it looks like millimetres (or "
        "another unit) read as metres: divide by 1000, or pass "
        'units="m,mm" to read_profile'
    )


def evenly_spaced(x: FloatArray) -> bool:
    """Tell whether stations are evenly spaced, but for round-off and for rounding in a file."""
    step, places = mean_step(x), np.arange(x.size) - (x.size - 1) / 2
    # From the line of least squares: the one through the ends strays as these do.
    slope = float(places @ (x - x[0]) / (places @ places))
    spread = float(np.ptp(x - slope * places))
    return spread <= JITTER * step or _are_rounded(x, spread, step)


def _are_rounded(x: FloatArray, spread: float, step: float) -> bool:
    """Tell whether stations stray from even ones by rounding to a decimal of a unit of length.

    Where a reading is missing they stray by a step, and other slips by more than the decimal.
    """
    if spread > ROUNDED * step:
        return False
    for unit in DECIMAL_UNITS:
        digit = unit * 10 ** np.ceil(np.log10(spread / ROUND_OFF / unit))
        places = (x - x[0]) / digit
        if digit <= step / 2 and np.abs(places - np.rint(places)).max() < 1e-3:
            return True
    return False


def even_step(x: FloatArray, what: str) -> float:
    """Return the distance between evenly spaced stations [m], or say that `what` needs them so."""
    if not evenly_spaced(x):
        raise ValueError(
            f"the {what} needs evenly spaced stations: type road.resample(0.25) first, or the "
            "spacing at which the road was measured"
        )
    return mean_step(x)


def mean_step(x: FloatArray) -> float:
    """Return the mean distance between stations [m]."""
    return float(x[-1] - x[0]) / (x.size - 1)
