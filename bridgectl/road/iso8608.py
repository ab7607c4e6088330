"""Random roads with the spectrum of ISO 8608.

Two ways to one spectrum, the straight line of `bridgectl.road.psd`: a sum of waves of given
amplitudes and random phases, and white noise through a shaping filter, which is a linear system and
so serves covariance analysis and optimal control too (`bridgectl.road.filtered`).
"""

from __future__ import annotations

import numpy as np
from scipy.fft import irfft, next_fast_len

from bridgectl import _checks as check
from bridgectl._checks import FloatArray
from bridgectl._places import even_places, whole_pieces
from bridgectl._threads import on_one_thread
from bridgectl._work import Work, at_least, at_most, require_feasible
from bridgectl.road.filtered import filtered_noise
from bridgectl.road.profile import RoadProfile
from bridgectl.road.psd import REFERENCE
from bridgectl.road.spectrum import DEFAULT_BAND, Maker, requested

PERIODS = 4
"""A periodic sum of waves lasts this many of its longest ones, and twice the road."""

BLOCK = 4_000_000
"""Samples synthesised at once: bounds the memory of a batch."""

Seed = int | np.random.Generator | None


def iso8608_profile(
    roughness: str | float, length: float, step: float = 0.1, *, seed: Seed = None,
    start: float = 0.0, waviness: float = 2.0, band: tuple[float, float] = DEFAULT_BAND,
    level: str = "mean", method: str = "spectral",
) -> RoadProfile:  # fmt: skip
    """Make a random road of an ISO 8608 class, or of a given roughness.

    Parameters
    ----------
    roughness : {"A", ..., "H"} or float
        The ISO class, or G_d(n_0) [m^3] at n_0 = 0.1 cycles/m, one-sided. Conventions for
        "class A" differ between programs: here it is the geometric mean of the class,
        16e-6 m^3, unless `level` says otherwise.
    length : float
        Length of the road [m].
    step : float
        Distance between stations [m]. Waves shorter than two steps are left out.
    seed : int or numpy.random.Generator, optional
        The same seed gives the same road; a new one each time if omitted.
    start : float
        First station [m], negative for a road that begins before the bridge.
    waviness : float
        Exponent w of the spectrum, 1 to 3.
    band : pair of float
        Shortest and longest wave number [cycles/m] of the road.
    level : {"mean", "lower", "upper"}
        Which roughness of the class: its geometric mean or one of its limits.
    method : {"spectral", "filter"}
        A sum of waves with given amplitudes and random phases, or filtered white noise: see
        `bridgectl.road.shaping_filter`.

    Returns
    -------
    RoadProfile

    Raises
    ------
    TypeError, ValueError
        If an argument is not what is described above.

    References
    ----------
    ISO 8608:2016, Annex C. The class means are in `bridgectl.road.psd.class_roughness`.

    Examples
    --------
    >>> import bridgectl as bc
    >>> road = bc.iso8608_profile("A", 225, seed=1, start=-200)
    >>> road
    RoadProfile('ISO 8608 class A', 2251 points, x from -200 m to 25 m, elevation from -0.00816957 \
m to 0.0106422 m, step 0.1 m)
    """
    first = check.number("start", start, unit="m")
    elevation = iso8608_elevations(
        1, roughness, length, step,
        seed=seed, waviness=waviness, band=band, level=level, method=method,
    )[0]  # fmt: skip
    label = f"class {roughness}" if isinstance(roughness, str) else f"Gd = {roughness:g} m^3"
    x = even_places(first, step, elevation.size)
    road = RoadProfile(x, elevation, name=f"ISO 8608 {label}")
    return road._measured_as(float(step))


@on_one_thread
def iso8608_elevations(
    n_roads: int, roughness: str | float, length: float, step: float = 0.1, *, seed: Seed = None,
    waviness: float = 2.0, band: tuple[float, float] = DEFAULT_BAND, level: str = "mean",
    method: str = "spectral",
) -> FloatArray:  # fmt: skip
    """Make many random roads of an ISO 8608 class at once.

    Parameters
    ----------
    n_roads : int
        How many.
    roughness, length, step, seed, waviness, band, level, method
        As `iso8608_profile`.

    Returns
    -------
    ndarray, shape (n_roads, n)
        Elevations [m], positive up, at the stations ``step * arange(n)``.

    Raises
    ------
    TypeError, ValueError
        As `iso8608_profile`.

    Examples
    --------
    >>> from bridgectl.road import iso8608_elevations
    >>> iso8608_elevations(1000, "A", 235, seed=0).shape
    (1000, 2351)
    """
    count = check.integer("n_roads", n_roads, at_least=1)
    dx = check.positive("step", step, unit="m")
    n_steps = whole_pieces(check.positive("length", length, unit="m"), dx)
    if n_steps < 1:
        raise ValueError(f"length must be at least one step of {dx:g} m, got {length:g} m")
    check.choice("method", method, ("spectral", "filter"))
    level_gd, exponent, limits = requested(roughness, level, waviness, band, dx)
    _require_feasible(count, float(length), dx, limits)
    try:
        rng = np.random.default_rng(seed)
    except (TypeError, ValueError):
        raise TypeError(
            f"seed must be a whole number from 0, a numpy.random.Generator or None, got {seed!r}"
        ) from None
    if method == "spectral":
        size, make = _sum_of_waves(level_gd, exponent, limits, n_steps + 1, dx)
    else:
        size, make = filtered_noise(level_gd, exponent, limits, n_steps + 1, dx)
    roads = np.empty((count, n_steps + 1))
    block = max(1, BLOCK // size)
    for i in range(0, count, block):
        roads[i : i + block] = make(min(block, count - i), rng)
    return roads


def _require_feasible(n_roads: int, length: float, step: float, band: tuple[float, float]) -> None:
    """Refuse roads that would not fit in memory."""

    def work(n_roads: float, length: float, step: float, longest_wave: float) -> Work:
        points = length / step
        period = max(2 * points, PERIODS * longest_wave / step)
        samples = period * min(n_roads, max(1.0, BLOCK / period))
        return Work(8 * (n_roads * points + 5 * samples), 1e-7 * n_roads * period)

    wave = "a longest wave, 1 / band[0], of {value}"
    arguments = {
        "n_roads": at_most(n_roads, 1000),
        "length": at_most(length, 1000.0, "m"),
        "step": at_least(step, 0.1, "m"),
        "longest_wave": at_most(1 / band[0], 100.0, "m", wave),
    }
    require_feasible(work, arguments)


def _sum_of_waves(
    roughness: float, waviness: float, band: tuple[float, float], n_points: int, step: float
) -> Maker:
    """Roads as waves of the spectrum's amplitudes and random phases, over a longer period."""
    needed = max(2 * n_points, int(np.ceil(PERIODS / (band[0] * step))))
    period = next_fast_len(needed, real=True)
    variance = _variances(roughness, waviness, band, period, step)
    first, last = np.nonzero(variance)[0][[0, -1]]
    half_amplitude = np.sqrt(2 * variance[first : last + 1]) * period / 2

    def make(count: int, rng: np.random.Generator) -> FloatArray:
        waves = np.zeros((count, period // 2 + 1), dtype=complex)
        phase = 2 * np.pi * rng.random((count, half_amplitude.size))
        waves[:, first : last + 1] = half_amplitude * np.exp(1j * phase)
        return np.asarray(irfft(waves, period)[:, :n_points])

    return period, make


def _variances(
    roughness: float, waviness: float, band: tuple[float, float], period: int, step: float
) -> FloatArray:
    """Variances [m^2] of the waves that last a whole part of a period of so many steps."""
    between = 1 / (period * step)
    edges = np.clip(between * (np.arange(period // 2 + 2) - 0.5), *band)
    exponent = 1 - waviness
    primitive = np.log(edges) if exponent == 0 else edges**exponent / exponent
    return np.asarray(roughness * REFERENCE**waviness * np.diff(primitive))


def ramp_covariance(
    roughness: str | float, n_ramps: int, length: float = 0.1, *, waviness: float = 2.0,
    band: tuple[float, float] = DEFAULT_BAND, level: str = "mean",
) -> FloatArray:  # fmt: skip
    """Covariance [m^2] of the drops over ramps of a random road that are 0, 1, 2, ... ramps apart.

    With the spectrum G(n) it is the integral of G(n) 4 sin^2(pi n length) cos(2 pi n k length):
    exact for the roads of `iso8608_elevations` at steps of a ramp. The first is the variance.
    """
    count = check.integer("n_ramps", n_ramps, at_least=1)
    dx = check.positive("length", length, unit="m")
    level_gd, exponent, limits = requested(roughness, level, waviness, band, dx)
    needed = max(2 * count, int(np.ceil(PERIODS / (limits[0] * dx))))
    period = next_fast_len(needed, real=True)
    differences = 4 * np.sin(np.pi * np.arange(period // 2 + 1) / period) ** 2
    power = differences * _variances(level_gd, exponent, limits, period, dx)
    return np.asarray(irfft(power * period / 2, period)[:count])
