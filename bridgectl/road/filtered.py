"""Roads as white noise through a shaping filter, which is a linear system."""

from __future__ import annotations

import control
import numpy as np
from scipy.signal import firwin, lfilter, upfirdn

from bridgectl import _checks as check
from bridgectl._checks import FloatArray
from bridgectl.road.psd import REFERENCE
from bridgectl.road.spectrum import DEFAULT_BAND, Maker, requested

FINER = 4
"""The filter's noise is sampled so much finer: no short wave poses as a long one."""

MARGIN = 3.0
"""The shaping filter holds the line this factor beyond its band."""

SECTIONS_PER_OCTAVE = 0.6
"""First-order sections that give a waviness other than 2, within 5 % of the line."""


def shaping_filter(
    roughness: str | float, *, waviness: float = 2.0, band: tuple[float, float] = DEFAULT_BAND,
    speed: float = 1.0, level: str = "mean",
) -> control.StateSpace:  # fmt: skip
    """Return the filter that makes a road of ISO 8608 from white noise.

    For waviness 2 it is of first order::

        z' + 2 pi n_c V z = 2 pi n_0 sqrt(G_d(n_0) V) w(t),   n_c = band[0] / 3

    other wavinesses are a chain of first-order sections. The noise w has a *one-sided* spectral
    density of 1, that is, a covariance of delta(t) / 2: with 1 instead the road is sqrt(2) too
    rough.

    Parameters
    ----------
    roughness, waviness, level
        As `bridgectl.iso8608_profile`.
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
        As `bridgectl.iso8608_profile`.

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
    poles, gains = _modes(*requested(roughness, level, waviness, band))
    n = poles.size
    return control.ss(
        -rate * np.diag(poles), np.sqrt(rate) * np.ones((n, 1)), gains[np.newaxis], 0,
        inputs=["noise"], outputs=["elevation"], states=[f"road_{i}" for i in range(1, n + 1)],
        name="road",
    )  # fmt: skip


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


def filtered_noise(
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
