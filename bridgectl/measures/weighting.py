"""ISO 2631-1: vertical vibration as a seated person feels it, weighted by W_k."""

from __future__ import annotations

import control
import numpy as np
from numpy.typing import ArrayLike
from scipy.signal import lfilter, tf2ss

from bridgectl import _checks as check
from bridgectl._checks import FloatArray
from bridgectl._warn import warn
from bridgectl.measures.history import histories, rms

HIGH_PASS, LOW_PASS = 0.4, 100.0
"""Band limits f_1 and f_2 of W_k [Hz], both Butterworth of second order."""

TRANSITION, TRANSITION_Q = 12.5, 0.63
"""f_3 = f_4 [Hz] and Q_4 of W_k: acceleration below, velocity above."""

STEP_FROM, STEP_FROM_Q, STEP_TO, STEP_TO_Q = 2.37, 0.91, 3.35, 0.91
"""f_5 [Hz], Q_5, f_6 [Hz] and Q_6 of W_k: the upward step."""

LONGEST_SAMPLE = 1 / 160
"""Samples further apart [s] cannot hold the 80 Hz up to which W_k weighs vibration."""


def weighting_filter() -> control.StateSpace:
    """Return the weighting W_k of vertical vibration of a seated person, of 8 states.

    Four sections in a row, w_i = 2 pi f_i (ISO 2631-1:1997, Annex A)::

        high pass   1 / (1 + sqrt(2) w_1 / s + (w_1 / s)^2)               f_1 = 0.4 Hz
        low pass    1 / (1 + sqrt(2) s / w_2 + (s / w_2)^2)               f_2 = 100 Hz
        transition  (1 + s / w_3) / (1 + s / (Q_4 w_4) + (s / w_4)^2)     f_3 = f_4 = 12.5 Hz
        step        (w_5 / w_6)^2 (1 + s / (Q_5 w_5) + (s / w_5)^2)       f_5 = 2.37 Hz
                    / (1 + s / (Q_6 w_6) + (s / w_6)^2)                   f_6 = 3.35 Hz

    with Q_4 = 0.63 and Q_5 = Q_6 = 0.91.
    """
    low, high, middle, before, after = (
        2 * np.pi * np.array([HIGH_PASS, LOW_PASS, TRANSITION, STEP_FROM, STEP_TO])
    )
    sections = [
        ([1, 0, 0], [1, np.sqrt(2) * low, low**2]),
        ([high**2], [1, np.sqrt(2) * high, high**2]),
        ([middle, middle**2], [1, middle / TRANSITION_Q, middle**2]),
        ([1, before / STEP_FROM_Q, before**2], [1, after / STEP_TO_Q, after**2]),
    ]
    chain = control.series(*(control.ss(*tf2ss(*section)) for section in sections))
    return control.ss(
        chain.A, chain.B, chain.C, chain.D,
        inputs=["acceleration"], outputs=["weighted"], name="Wk",
    )  # fmt: skip


def weighted_acceleration(acceleration: ArrayLike, sample_time: float) -> FloatArray:
    """Return histories of an acceleration [m/s^2] weighted by W_k, from rest.

    Exact for an acceleration that is linear between its samples, `sample_time` [s] apart.
    """
    history = histories("acceleration", acceleration, "m/s^2")
    step = _sample_time(sample_time)
    system = weighting_filter()
    poles, shapes = np.linalg.eig(system.A)
    residues = (system.C @ shapes)[0] * np.linalg.solve(shapes, system.B[:, 0])
    weighted = np.zeros_like(history)
    # The poles are four complex pairs; each pair is a recursion of first order.
    for pole, residue in zip(poles[poles.imag > 0], residues[poles.imag > 0], strict=True):
        decay, grown = np.exp(pole * step), np.expm1(pole * step)
        new = residue * (grown - pole * step) / (pole**2 * step)  # of this sample
        old = residue * grown / pole - new  # of the one before
        rest = -new * history[..., :1].astype(complex)
        mode, _ = lfilter([new, old], [1.0, -decay], history.astype(complex), zi=rest)
        weighted += 2 * mode.real
    return weighted


def weighted_rms(acceleration: ArrayLike, sample_time: float, *, skip: float = 0.0) -> FloatArray:
    """Return the root mean square of an acceleration weighted by W_k.

    The weighting starts at rest, and its 0.4 Hz high pass needs 2.6 s to forget 99 % of how it
    started; a crossing lasts 1 or 2 s. Pass the approach too, 3 s or more of it, and `skip` it:
    it then runs through the filter without being counted. The body of a truck bounces near
    that 0.4 Hz, so report the plain root mean square of the same history beside it.

    Parameters
    ----------
    acceleration : array_like, shape (..., n)
        Vertical accelerations [m/s^2], linear between samples.
    sample_time : float
        Time between samples [s].
    skip : float
        Time at the beginning that does not count [s].

    Returns
    -------
    float or ndarray, shape (...)
        In m/s^2.

    Raises
    ------
    TypeError, ValueError
        If the accelerations are not finite numbers, `sample_time` is not above 0 s, or `skip`
        leaves no sample.

    Warns
    -----
    UserWarning
        If the samples are too far apart for 80 Hz.

    References
    ----------
    ISO 2631-1:1997, Section 6.1 and Annex A.

    Examples
    --------
    >>> import numpy as np
    >>> from bridgectl.measures import weighted_rms
    >>> hop = np.sin(2 * np.pi * 6.3 * np.arange(0, 10, 0.001))
    >>> print(weighted_rms(hop, 0.001, skip=5.0).round(3))
    0.745
    """
    weighted = weighted_acceleration(acceleration, sample_time)
    n = round(check.not_negative("skip", skip, unit="s") / sample_time)
    if n >= weighted.shape[-1]:
        raise ValueError(
            f"skip = {skip:g} s leaves nothing of {weighted.shape[-1] * sample_time:g} s: type "
            "a shorter one"
        )
    return rms(weighted[..., n:])


def _sample_time(value: float) -> float:
    step = check.positive("sample_time", value, unit="s")
    if step > LONGEST_SAMPLE:
        warn(
            f"samples {step:g} s apart cannot hold the 80 Hz that W_k weighs: pass "
            f"{LONGEST_SAMPLE:g} s or less"
        )
    return step
