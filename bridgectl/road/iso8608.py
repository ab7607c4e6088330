"""Random roads with the spectrum of ISO 8608.

Two ways to one spectrum, the straight line of `bridgectl.road.psd`: a sum of waves of given
amplitudes and random phases, and white noise through a shaping filter, which is a linear system and
so serves covariance analysis and optimal control too.
"""

from __future__ import annotations

from collections.abc import Callable

import control
import numpy as np
from scipy.fft import irfft, next_fast_len
from scipy.signal import firwin, lfilter, upfirdn

from bridgectl import _checks as check
from bridgectl._checks import FloatArray
from bridgectl._threads import on_one_thread
from bridgectl._work import Work, at_least, at_most, require_feasible
from bridgectl.road.profile import RoadProfile
from bridgectl.road.psd import CLASSES, REFERENCE, class_roughness

DEFAULT_BAND = (0.01, 4.0)
"""Wave numbers [cycles/m] of the synthesised waves: 100 m to 0.25 m long, as in VBI-2D."""

PERIODS = 4
"""A periodic sum of waves lasts this many of its longest ones, and twice the road."""

FINER = 4
"""The filter's noise is sampled so much finer: no short wave poses as a long one."""

MARGIN = 3.0
"""The shaping filter holds the line this factor beyond its band."""

SECTIONS_PER_OCTAVE = 0.6
"""First-order sections that give a waviness other than 2, within 5 % of the line."""

BLOCK = 4_000_000
"""Samples synthesised at once: bounds the memory of a batch."""

Seed = int | np.random.Generator | None

Maker = tuple[int, Callable[[int, np.random.Generator], FloatArray]]
"""Samples of work for one road, and what makes a number of roads."""


def iso8608_profile(
    roughness: str | float,
    length: float,
    step: float = 0.1,
    *,
    seed: Seed = None,
    start: float = 0.0,
    waviness: float = 2.0,
    band: tuple[float, float] = DEFAULT_BAND,
    level: str = "mean",
    method: str = "spectral",
) -> RoadProfile:
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
        `shaping_filter`.

    Returns
    -------
    RoadProfile

    Raises
    ------
    TypeError, ValueError
        If an argument is not what is described above.

    References
    ----------
    ISO 8608:2016, Annex C. The class means are in `bridgectl.road.class_roughness`.

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
    x = first + step * np.arange(elevation.size)
    road = RoadProfile(x, elevation, name=f"ISO 8608 {label}")
    return road._measured_as(float(step))


@on_one_thread
def iso8608_elevations(
    n_roads: int,
    roughness: str | float,
    length: float,
    step: float = 0.1,
    *,
    seed: Seed = None,
    waviness: float = 2.0,
    band: tuple[float, float] = DEFAULT_BAND,
    level: str = "mean",
    method: str = "spectral",
) -> FloatArray:
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
    n_steps = int(check.positive("length", length, unit="m") / dx + 1e-9)
    if n_steps < 1:
        raise ValueError(f"length must be at least one step of {dx:g} m, got {length:g} m")
    check.choice("method", method, ("spectral", "filter"))
    level_gd, exponent = requested_roughness(roughness, level), _waviness(waviness)
    limits = _band(band, dx)
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
        size, make = _filtered_noise(level_gd, exponent, limits, n_steps + 1, dx)
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


def shaping_filter(
    roughness: str | float,
    *,
    waviness: float = 2.0,
    band: tuple[float, float] = DEFAULT_BAND,
    speed: float = 1.0,
    level: str = "mean",
) -> control.StateSpace:
    """Return the filter that makes a road of ISO 8608 from white noise.

    For waviness 2 it is of first order::

        z' + 2 pi n_c V z = 2 pi n_0 sqrt(G_d(n_0) V) w(t),   n_c = band[0] / 3

    other wavinesses are a chain of first-order sections. The noise w has a *one-sided* spectral
    density of 1, that is, a covariance of delta(t) / 2: with 1 instead the road is sqrt(2) too
    rough.

    Parameters
    ----------
    roughness, waviness, level
        As `iso8608_profile`.
    band : pair of float
        Wave numbers [cycles/m] over which the spectrum follows the line; below, it levels off.
    speed : float
        Speed V [m/s] at which the road is met; with 1, time stands for distance.

    Returns
    -------
    control.StateSpace
        Input 'noise', output 'elevation' [m].

    Raises
    ------
    TypeError, ValueError
        As `iso8608_profile`.

    References
    ----------
    Recursive sections for a power of s: A. Oustaloup et al., IEEE Trans. Circuits Syst. I 47
    (2000) 25-39.

    Examples
    --------
    >>> import numpy as np
    >>> from bridgectl.road import shaping_filter
    >>> gain = abs(shaping_filter("A")(2j * np.pi * 0.1))  # at n_0 = 0.1 cycles/m
    >>> print(f"{gain**2:.2e} m^3")
    1.60e-05 m^3
    """
    rate = check.positive("speed", speed, unit="m/s")
    low, high = _band(band)
    poles, gains = _modes(requested_roughness(roughness, level), _waviness(waviness), (low, high))
    n = poles.size
    return control.ss(
        -rate * np.diag(poles),
        np.sqrt(rate) * np.ones((n, 1)),
        gains[np.newaxis],
        0,
        inputs=["noise"],
        outputs=["elevation"],
        states=[f"road_{i}" for i in range(1, n + 1)],
        name="road",
    )


def _modes(
    roughness: float, waviness: float, band: tuple[float, float]
) -> tuple[FloatArray, FloatArray]:
    """Poles -p_i [rad/m] and gains r_i of sum r_i / (s + p_i), whose square is the spectrum."""
    low, high = 2 * np.pi * band[0] / MARGIN, 2 * np.pi * band[1] * MARGIN
    poles, zeros = np.array([low]), np.array([])
    power = 1 - waviness / 2  # what the first pole, s^-1, leaves to the sections
    if power != 0:
        n = int(np.ceil(SECTIONS_PER_OCTAVE * np.log2(high / low)))
        place = np.arange(n) + 0.5
        zeros = low * (high / low) ** ((place - power / 2) / n)
        poles = np.append(poles, low * (high / low) ** ((place + power / 2) / n))
    at = 2j * np.pi * REFERENCE
    gain = np.sqrt(roughness) / abs(np.prod(at + zeros) / np.prod(at + poles))
    residues = [np.prod(zeros - p) / np.prod(np.delete(poles, i) - p) for i, p in enumerate(poles)]
    return poles, gain * np.array(residues)


def _filtered_noise(
    roughness: float, waviness: float, band: tuple[float, float], n_points: int, step: float
) -> Maker:
    """Roads from the shaping filter, sampled exactly at a finer step, then cut at the band."""
    poles, gains = _modes(roughness, waviness, band)
    h = step / FINER
    # A low-pass of linear phase whose edge is a quarter of the band wide (Hamming: 3.3 / taps).
    n_taps = 2 * int(3.3 * 4 / (2 * h * band[1])) + 1
    low_pass = firwin(n_taps, band[1], fs=1 / h)
    n_fine = FINER * (n_points - 1) + n_taps
    sums = poles[:, np.newaxis] + poles
    # Covariance of the modes, and of what the noise adds to them over a step (intensity 1/2).
    stationary = _root(0.5 / sums)
    added = _root(-0.5 * np.expm1(-sums * h) / sums)

    def make(count: int, rng: np.random.Generator) -> FloatArray:
        noise = added @ rng.standard_normal((added.shape[1], count * n_fine))
        noise = noise.reshape(poles.size, count, n_fine)
        noise[..., 0] = stationary @ rng.standard_normal((stationary.shape[1], count))
        fine = np.zeros((count, n_fine))
        for mode, pole, gain in zip(noise, poles, gains, strict=True):
            fine += gain * lfilter([1.0], [1.0, -np.exp(-pole * h)], mode)
        kept = upfirdn(low_pass, fine, down=FINER, axis=-1)
        skip = -(-(n_taps - 1) // FINER)
        return np.asarray(kept[:, skip : skip + n_points])

    return n_fine * poles.size, make


def _root(covariance: FloatArray) -> FloatArray:
    """Factor L with L L' = covariance, without the directions that round-off alone fills."""
    values, vectors = np.linalg.eigh(covariance)
    real = values > 1e-13 * values[-1]
    return np.asarray(vectors[:, real] * np.sqrt(values[real]))


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
    roughness: str | float,
    n_ramps: int,
    length: float = 0.1,
    *,
    waviness: float = 2.0,
    band: tuple[float, float] = DEFAULT_BAND,
    level: str = "mean",
) -> FloatArray:
    """Covariance of the drops over the ramps of a random road, by the ramps between them.

    With the spectrum G(n) it is the integral of G(n) 4 sin^2(pi n length) cos(2 pi n k length):
    exact for the roads of `iso8608_elevations` at steps of a ramp.

    Parameters
    ----------
    roughness, waviness, band, level
        As `iso8608_profile`.
    n_ramps : int
        How many ramps.
    length : float, optional
        Length of a ramp [m].

    Returns
    -------
    ndarray, shape (n_ramps,)
        Covariance [m^2] of ramps 0, 1, 2, ... ramps apart; the first is the variance.

    Raises
    ------
    TypeError, ValueError
        As `iso8608_profile`.

    Examples
    --------
    Drops over 100 mm of class A: 0.46 mm, and those of neighbours go together.

    >>> from bridgectl.road import ramp_covariance
    >>> s = ramp_covariance("A", 3)
    >>> (1e3 * s[0] ** 0.5).round(3), (s[1] / s[0]).round(2)
    (np.float64(0.461), np.float64(0.32))
    """
    count = check.integer("n_ramps", n_ramps, at_least=1)
    dx = check.positive("length", length, unit="m")
    level_gd, exponent = requested_roughness(roughness, level), _waviness(waviness)
    limits = _band(band, dx)
    needed = max(2 * count, int(np.ceil(PERIODS / (limits[0] * dx))))
    period = next_fast_len(needed, real=True)
    differences = 4 * np.sin(np.pi * np.arange(period // 2 + 1) / period) ** 2
    power = differences * _variances(level_gd, exponent, limits, period, dx)
    return np.asarray(irfft(power * period / 2, period)[:count])


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


def _waviness(waviness: float) -> float:
    value = check.number("waviness", waviness)
    if not 1 <= value <= 3:
        raise ValueError(f"waviness must lie between 1 and 3 (2 in ISO 8608), got {value:g}")
    return value


def _band(band: tuple[float, float], step: float | None = None) -> tuple[float, float]:
    low, high = check.array("band", band, (2,), unit="cycles/m")
    highest = np.inf if step is None else 0.5 / step
    if not 0 < low < min(high, highest):
        raise ValueError(
            f"band must rise from above 0 cycles/m and begin below {highest:g} (waves of two "
            f"steps), got {low:g} to {high:g}: type band={DEFAULT_BAND}"
        )
    return float(low), float(min(high, highest))
