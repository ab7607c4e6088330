"""Modes under forces that are polynomials of time."""

import numpy as np
import pytest

import bridgectl as bc
from bridgectl.linear.cells import FORCE_POINTS
from bridgectl.linear.modes import SLOW, hold_responses, mode_matrices, mode_responses

POINTS = np.array([0.3, 1.0])


@pytest.mark.parametrize("phase", [0.0, 0.1, 0.99 * SLOW, 1.01 * SLOW, 6.0])
@pytest.mark.parametrize("damping", [0.0, 0.3])
@pytest.mark.filterwarnings("ignore::bridgectl.PlausibilityWarning")
def test_responses_in_closed_form_are_those_of_matrix_exponentials(phase, damping):
    """To states and forces, within 1e-11 of the largest response of its kind."""
    beam = bc.li2006.beam(n_modes=2, damping_ratio=(damping, damping))
    durations = np.array([[phase / beam.omega[0], phase / beam.omega[1]]])
    crossing = bc.Crossing(beam, bc.li2006.car())
    found = mode_responses(beam, durations, FORCE_POINTS, POINTS)
    free, held = hold_responses(*mode_matrices(crossing, 2), durations, FORCE_POINTS, POINTS)
    for given, expected in zip(found, (free, held[..., 0]), strict=True):
        scale = np.abs(expected).max(axis=(0, 1, 2, 3, -1), keepdims=True) + 1e-12
        assert given / scale == pytest.approx(expected / scale, abs=1e-11)
