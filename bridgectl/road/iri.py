"""The International Roughness Index (IRI): what a standard quarter-car feels of a road.

The golden car runs at 80 km/h over the road's slope, averaged over 250 mm; the IRI is the mean
rectified velocity of its suspension per speed, in m/km. Sayers (Transportation Research Record
1501, 1995) and ASTM E1926 define it; slopes are taken constant between samples, as in ramps.
"""

from __future__ import annotations

from typing import Any

import control
import numpy as np
from numpy.typing import ArrayLike
from scipy.signal import lfilter

from bridgectl import _checks
from bridgectl._checks import FloatArray
from bridgectl._units import from_kmh
from bridgectl._warn import warn
from bridgectl.road.limits import even_step

SPEED = from_kmh(80.0)
"""Speed of the golden car [m/s]."""

TIRE, SUSPENSION, DAMPING, UNSPRUNG = 653.0, 63.3, 6.0, 0.15
"""The golden car per sprung mass: k_t, k_s [1/s^2], c [1/s], m_u [-] (Sayers 1995)."""

BASE = 0.25
"""Length of the moving average that a tire stands for [m]."""

START = 11.0
"""Length over which the road's mean slope sets the car's initial state [m]: 0.5 s."""

GOOD = 7.0
"""Roads below this IRI [m/km] are good (Li, OBrien and Gonzalez 2006, Section 1)."""

AT_START = (1.0, 0.0, 1.0, 0.0)
"""State of the golden car on a slope of 1: both masses follow it."""

SHORT = 20.0
"""Windows shorter than this [m] hold little more than one of the waves that the IRI weighs."""

SHORTEST = 1.0
"""Windows shorter than this [m], or than a step, are a slip: the tire itself averages 0.25 m."""


def golden_car() -> control.StateSpace:
    """Return the golden car of the IRI (M. W. Sayers, Transp. Research Record 1501, 1995, 1-12).

    Input 'slope' [-] of the road, output 'suspension' [-], the suspension's velocity per speed.
    States: slopes of sprung and unsprung mass and their rates.
    """
    matrix = [
        [0, 1, 0, 0],
        [-SUSPENSION, -DAMPING, SUSPENSION, DAMPING],
        [0, 0, 0, 1],
        [SUSPENSION, DAMPING, -TIRE - SUSPENSION, -DAMPING],
    ]
    a = np.array(matrix, dtype=float)
    a[3] /= UNSPRUNG
    return control.ss(
        a, [[0], [0], [0], [TIRE / UNSPRUNG]], [[-1, 0, 1, 0]], 0,
        inputs=["slope"], outputs=["suspension"], name="golden car",
        states=["sprung", "sprung_rate", "unsprung", "unsprung_rate"],
    )  # fmt: skip


def rectified_slope(elevation: ArrayLike, step: float) -> FloatArray:
    """Rectified suspension motion [m/km] along evenly sampled roads; its mean is the IRI.

    Of elevations [m], shape (..., n), it has shape (..., n - k), one for each step;
    k = max(1, round(0.25 / step)) samples make the 250 mm base.
    """
    return np.abs(suspension_slope(elevation, step))


def suspension_slope(elevation: ArrayLike, step: float) -> FloatArray:
    """Suspension motion of the golden car with its sign, linear in the road: `rectified_slope`."""
    heights = np.asarray(elevation, dtype=np.float64)
    dx = _checks.positive("step", step, unit="m")
    slopes, mean_slope = input_slopes(heights, dx)
    output = np.zeros_like(slopes)
    # Exact for slopes constant over a step: the two pairs of complex modes are each a first-order
    # recursion.
    car = golden_car()
    poles, shapes = np.linalg.eig(car.A)
    gains = np.linalg.solve(shapes, car.B[:, 0]) * np.expm1(poles * dx / SPEED) / poles
    start = np.linalg.solve(shapes, AT_START)
    for i in np.nonzero(poles.imag > 0)[0]:
        decay = np.exp(poles[i] * dx / SPEED)
        initial = decay * start[i] * mean_slope[..., np.newaxis]
        mode, _ = lfilter([1.0], [1.0, -decay], gains[i] * slopes.astype(complex), zi=initial)
        output += 2 * ((car.C @ shapes)[0, i] * mode).real
    return 1e3 * output


def input_slopes(heights: Any, step: float) -> tuple[Any, Any]:
    """Slopes that the golden car meets, averaged over 250 mm, and the mean slope it starts on.

    `heights` may be an array (..., n), or a sparse one (m, n): then these are the linear maps.
    """
    # Sayers rounds halves up: 3 samples at 0.1 m, where round() would take 2. Stations that are
    # 0.1 m apart but for round-off must not take 2 either.
    base = max(1, int(np.floor(BASE / step + 0.5 + 1e-6)))
    n_heights = heights.shape[-1]
    if n_heights < base + 2:
        raise ValueError(
            f"elevation must reach over more than {BASE:g} m, got {n_heights} samples {step:g} m "
            "apart"
        )
    slopes = (heights[..., base:] - heights[..., :-base]) / (base * step)
    first = min(int(np.floor(START / step + 0.5)), n_heights - 1)
    return slopes, (heights[..., first] - heights[..., 0]) / (first * step)


def running_iri(
    x: FloatArray, elevation: FloatArray, window: float | None
) -> tuple[FloatArray, FloatArray]:
    """Stations and IRI [m/km] of the last `window` [m] before each, None for all before it."""
    step, length = even_step(x, "IRI"), float(x[-1] - x[0])
    sums = np.append(0.0, np.cumsum(rectified_slope(elevation, step)))
    if window is None:
        return x[1 : sums.size], sums[1:] / np.arange(1, sums.size)
    n = round(_window(window, "window", step, length) / step)
    n = max(1, min(n, sums.size - 1))  # the moving average takes its base off the road's end
    return x[n : sums.size], (sums[n:] - sums[:-n]) / n


def segment_iri(x: FloatArray, elevation: FloatArray, segment: float | None) -> FloatArray:
    """IRI [m/km] of each whole segment [m] of an evenly sampled road, None for all of it."""
    step, length = even_step(x, "IRI"), float(x[-1] - x[0])
    window = _window(segment, "segment", step, length)
    values = rectified_slope(elevation, step)
    n_segments = int((length + step / 2) / window)  # rounding may take that off the road
    edges = np.round(window / step * np.arange(n_segments + 1)).astype(int)
    # The last segment lacks the steps that the moving average needs beyond it.
    edges = np.minimum(edges, values.size)
    return np.asarray(np.add.reduceat(values[: edges[-1]], edges[:-1]) / np.diff(edges))


def _window(window: float | None, name: str, step: float, length: float) -> float:
    """Check the window [m] of an average, None for all of it, and warn of one too short."""
    size = length if window is None else _checks.positive(name, window, unit="m")
    if window is not None and size < max(SHORTEST, step):
        raise ValueError(
            f"{name} = {size:.10g} m is too short for an IRI at steps of {step:.4g} m: type "
            f"{max(SHORT, step):.10g} m or more"
        )
    if size > length + step / 2:
        raise ValueError(
            f"{name} = {size:.10g} m is longer than the road of {length:.10g} m: type a shorter one"
        )
    if size < SHORT:
        warn(
            f"an IRI over {size:g} m says little: the index weighs waves of up to 30 m; pass "
            f"{SHORT:g} m or more"
        )
    return size
