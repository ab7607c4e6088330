"""What stations and elevations must be: increasing, and in the unit they are said to be in."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from bridgectl._checks import FloatArray

MAX_SLOPE = 1.0  # [m/m]; no road climbs at 45 degrees, but millimetres read as metres do
TOLERANCE = 1e-9  # [m]; stations closer than this are one place, apart only by round-off


def first_unsorted(x: FloatArray) -> int | None:
    """Return the index of the first station that is not past the one before it, if any."""
    return _first(~(x[1:] > x[:-1]))


def first_too_steep(x: FloatArray, elevation: FloatArray) -> int | None:
    """Return the index of the first point that a slope above `MAX_SLOPE` leads to, if any."""
    with np.errstate(over="ignore"):
        return _first(~(np.abs(np.diff(elevation)) <= MAX_SLOPE * np.diff(x) + TOLERANCE))


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
    """Tell whether stations are evenly spaced, but for round-off."""
    steps = np.diff(x)
    return bool(np.ptp(steps) <= 1e-6 * steps.mean() + 2 * TOLERANCE)


def even_step(x: FloatArray, what: str) -> float:
    """Return the distance between evenly spaced stations [m], or say that `what` needs them so."""
    if not evenly_spaced(x):
        raise ValueError(
            f"the {what} needs evenly spaced stations: type road.resample(0.25) first, or the "
            "spacing at which the road was measured"
        )
    return float(np.diff(x).mean())
