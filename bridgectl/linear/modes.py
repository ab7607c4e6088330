"""Modes under forces that are polynomials of time: exact responses, however fast they are.

In a cell of duration h, with s = t / h, a force s^p on a mode of stiffness m w^2 gives

    q = sum_k b_k s^k / (m w^2),
    b_k = delta_kp - 2 zeta (k + 1) b_{k+1} / (w h) - (k + 1) (k + 2) b_{k+2} / (w h)^2

from k = p downward, and the free motion that takes it to the state at the start. Where w h is small
the two nearly cancel: there the power series of their sum takes its place.
"""

from __future__ import annotations

import numpy as np
from scipy.linalg import expm

from bridgectl._checks import FloatArray
from bridgectl.model.bridge import BridgeModel
from bridgectl.model.crossing import Crossing

SLOW = 1.0
"""Phase of a cell w h [rad] up to which the power series is used."""

N_TERMS = 18
"""Terms of the power series, the last 1e-16 of the first at the phase `SLOW`."""


def mode_responses(
    bridge: BridgeModel, durations: FloatArray, stages: FloatArray, points: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """Responses of each mode to its state at the start of a cell and to modal forces [N].

    Parameters
    ----------
    bridge
        The modes.
    durations : ndarray, shape (S, U)
        Durations of the cells [s].
    stages, points : ndarray, shapes (q,) and (p,)
        Where the forces are given, as polynomials, and where states [m, m/s] are asked for, as
        fractions of a cell.

    Returns
    -------
    free, held : ndarray, shapes (S, U, modes, p, 2, 2) and (S, U, modes, p, 2, q)
    """
    phase, damping, duration = _phases(bridge, durations)
    free = _free(phase, damping, duration, points)
    polynomials = _particular(np.maximum(phase, SLOW), damping, len(stages))
    rest = _states(polynomials, np.zeros(1), duration)
    held = _states(polynomials, points, duration) - _each(free, rest)
    slow = phase < SLOW
    if slow.any():
        series = _series(phase[slow], damping[slow], len(stages))
        held[slow] = _states(series, points, duration[slow])
    return free, _each(held, _from_values(bridge, stages)[:, np.newaxis])


def _each(rows: FloatArray, matrix: FloatArray) -> FloatArray:
    """Rows at points (..., p, 2, k) times matrices (..., 1, k, q), all points in one product."""
    size = rows.shape[-3:]
    flat = rows.reshape(*rows.shape[:-3], size[0] * size[1], size[2])
    return np.asarray((flat @ matrix[..., 0, :, :]).reshape(*rows.shape[:-1], matrix.shape[-1]))


def _phases(
    bridge: BridgeModel, durations: FloatArray
) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Phase w h [rad], damping ratio and duration [s] of each cell and mode, (S, U, modes)."""
    # A cell cut at a place within round-off of its end has no duration.
    duration = np.repeat(np.maximum(durations, 1e-20)[..., np.newaxis], bridge.n_modes, axis=-1)
    phase = duration * bridge.omega
    return phase, np.broadcast_to(bridge.damping_ratios, phase.shape), duration


def _from_values(bridge: BridgeModel, stages: FloatArray) -> FloatArray:
    """Static responses to powers of s from the values of a modal force, (modes, q, q)."""
    stiffness = bridge.modal_masses * bridge.omega**2
    lagrange = np.linalg.inv(np.vander(stages, increasing=True))
    return np.asarray(lagrange / stiffness[:, np.newaxis, np.newaxis])


def _free(
    phase: FloatArray, damping: FloatArray, duration: FloatArray, points: FloatArray
) -> FloatArray:
    """Transition matrices at points (..., p, 2, 2)."""
    share = np.sqrt(1 - damping**2)[..., np.newaxis]
    phase, damping, duration = (of[..., np.newaxis] for of in (phase, damping, duration))
    decay = np.exp(-damping * phase * points)
    cosine = decay * np.cos(phase * share * points)
    sine = decay * np.sin(phase * share * points) / share
    rate = phase / duration
    rows = [cosine + damping * sine, sine / rate, -sine * rate, cosine - damping * sine]
    return np.stack(rows, axis=-1).reshape(*cosine.shape, 2, 2)


def _particular(phase: FloatArray, damping: FloatArray, count: int) -> FloatArray:
    """The b_k of the module's docstring for p < count, (..., k, p)."""
    b = np.zeros((*phase.shape, count + 2, count))
    flexibility = phase[..., np.newaxis] ** -2.0
    rate = 2 * (damping / phase)[..., np.newaxis]
    for k in range(count - 1, -1, -1):
        b[..., k, k] = 1.0
        b[..., k, :] -= (k + 1) * rate * b[..., k + 1, :]
        b[..., k, :] -= (k + 1) * (k + 2) * flexibility * b[..., k + 2, :]
    return b[..., :count, :]


def _series(phase: FloatArray, damping: FloatArray, count: int) -> FloatArray:
    """Power series in s of the responses from rest to s^p, times the stiffness, (..., k, p)."""
    c = np.zeros((N_TERMS, *phase.shape, count))
    stiffness = phase[..., np.newaxis] ** 2
    rate = 2 * (damping * phase)[..., np.newaxis]
    powers = np.eye(N_TERMS, count)
    for k in range(N_TERMS - 2):
        c[k + 2] = stiffness * (powers[k] - c[k]) / ((k + 1) * (k + 2)) - rate * c[k + 1] / (k + 2)
    return np.moveaxis(c, 0, -2)


def _states(series: FloatArray, points: FloatArray, duration: FloatArray) -> FloatArray:
    """Values and rates of power series (..., k, p) at points, (..., points, 2, p)."""
    powers = np.vander(points, series.shape[-2], increasing=True)
    values = powers @ series
    orders = np.arange(1, series.shape[-2])[:, np.newaxis]
    rates = powers[:, :-1] @ (orders * series[..., 1:, :]) / duration[..., np.newaxis, np.newaxis]
    return np.stack([values, rates], axis=-2)


def mode_matrices(crossing: Crossing, n_modes: int) -> tuple[FloatArray, FloatArray]:
    """State and input matrices of the modes on their own, shapes (modes, 2, 2), (modes, 2, 1)."""
    own = 2 * np.arange(n_modes)[:, np.newaxis] + np.arange(2)
    matrices = crossing.modal_matrix[own[:, :, np.newaxis], own[:, np.newaxis, :]]
    gains = crossing.modal_input[own, np.arange(n_modes)[:, np.newaxis]]
    return matrices, gains[..., np.newaxis]


def hold_responses(
    matrix: FloatArray,
    inputs: FloatArray,
    durations: FloatArray,
    stages: FloatArray,
    points: FloatArray,
) -> tuple[FloatArray, FloatArray]:
    """Responses of x' = A x + B u at points of cells, exactly, to states and inputs.

    A and B have the shapes (..., n, n) and (..., n, m), the durations of the cells [s] (S, U). The
    input is the polynomial through its values at the q `stages`; the states are asked for at the p
    `points`, both fractions of a cell: (S, U, ..., p, n, n) and (S, U, ..., p, n, q, m).
    """
    n, m = inputs.shape[-2:]
    batch, n_stages = matrix.shape[:-2], len(stages)
    size = n + n_stages * m
    scaled = durations.reshape(*durations.shape, *(1,) * (len(batch) + 2))
    # A chain of integrators drives the system with the powers s^p / p! of the time in cells.
    chain = np.zeros((*durations.shape, *batch, size, size))
    chain[..., :n, :n] = matrix * scaled
    chain[..., :n, n : n + m] = inputs * scaled
    upper = np.arange(n, size - m)
    chain[..., upper, upper + m] = 1.0
    response = expm(chain[..., np.newaxis, :, :] * points[:, np.newaxis, np.newaxis])
    powers = response[..., :n, n:].reshape(*response.shape[:-2], n, n_stages, m)
    factorials = np.cumprod([1.0, *range(1, n_stages)])
    lagrange = factorials[:, np.newaxis] * np.linalg.inv(np.vander(stages, increasing=True))
    return response[..., :n, :n], np.einsum("...ipm,pn->...inm", powers, lagrange)
