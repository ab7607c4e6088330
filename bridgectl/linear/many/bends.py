"""Modes under forces with kinks, in cells that go through radians of the highest of them.

In a cell forces are parabolas of the same moments, the first three of them. What a kink does beyond
that is what it does by itself, less what its parabola does.
"""

from __future__ import annotations

import numpy as np

from bridgectl._checks import FloatArray
from bridgectl.linear.cells import GAUSS, N_STAGES
from bridgectl.model.bridge import BridgeModel

TERMS = 18
"""Of the power series of modes in a cell, the last 1e-11 of the first at a phase of 2."""

POINTS = np.append(GAUSS, 1.0)
"""Where modes are asked for: the stages, and the end."""


def moments(kinks: FloatArray) -> FloatArray:
    """Of (s - kink)+ the parabola of the same moments over the cell, at the stages.

    Shape (N_STAGES, ...).
    """
    left = 1 - kinks
    zeroth = left**2 / 2
    first = left**2 * kinks / 2 + left**3 / 3
    second = left**4 / 4 + 2 * kinks * left**3 / 3 + kinks**2 * left**2 / 2
    legendre = zeroth, 2 * first - zeroth, 6 * second - 6 * first + zeroth
    found = np.empty((N_STAGES, *kinks.shape))
    for stage, s in enumerate(GAUSS):
        values = 1.0, 3 * (2 * s - 1), 5 * (6 * s**2 - 6 * s + 1)
        found[stage] = values[0] * legendre[0] + values[1] * legendre[1] + values[2] * legendre[2]
    return found


def ramps(bridge: BridgeModel, durations: FloatArray) -> FloatArray:
    """Responses of modes from rest to a force s by powers of s, (TERMS, modes, n) [m/N].

    Of cells of n durations [s].
    """
    phase = np.multiply.outer(bridge.omega, durations)
    damping = bridge.damping_ratios[:, np.newaxis]
    powers = np.zeros((TERMS, *phase.shape))
    for p in range(TERMS - 2):
        given = -(phase**2) * powers[p] - 2 * damping * phase * (p + 1) * powers[p + 1]
        powers[p + 2] = (given + (p == 1)) / ((p + 1) * (p + 2))
    return powers * (durations**2 / bridge.modal_masses[:, np.newaxis])


def beyond(
    bridge: BridgeModel, durations: FloatArray, held: FloatArray, kinks: FloatArray
) -> FloatArray:
    """What forces (s - kink)+ do to modes beyond their parabolas, at `POINTS`.

    Displacements and rates, (2, modes, 4, n), of cells of n durations [s], and what modal forces at
    the stages do there, (N_STAGES, 2, modes, 4, n).
    """
    powers = ramps(bridge, durations)[:, :, np.newaxis]
    after = np.maximum(POINTS[:, np.newaxis] - kinks, 0.0)
    found = np.zeros(held.shape[1:])
    for p in range(TERMS - 1, 0, -1):
        found[0] = found[0] * after + powers[p]
        found[1] = found[1] * after + p * powers[p]
    found[0] *= after
    found[1] /= durations
    for stage, smooth in enumerate(moments(kinks)):
        found -= held[stage] * smooth
    return found
