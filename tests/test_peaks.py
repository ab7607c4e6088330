import numpy as np
import pytest
from hypothesis import example, given
from hypothesis import strategies as st

from bridgectl.peaks import find_peaks
from bridgectl.propagator import sample_positions

NODES = np.linspace(0, 10, 41)
X = sample_positions(NODES)


@example(1.9965628464461576, 2.0)
@given(st.floats(0.2, 9.8), st.floats(1.5, 3.0))
def test_a_smooth_peak_between_samples_is_found(place, width):
    def hump(x):
        return np.exp(-(((x - place) / width) ** 2))

    peaks = find_peaks(hump(X)[:, np.newaxis])
    assert peaks.values[0] == pytest.approx(1.0, abs=1e-6)
    assert peaks.positions(NODES)[0] == pytest.approx(place, abs=5e-3)


@given(st.integers(0, 40))
def test_a_kink_at_a_node_is_its_peak_exactly(node):
    peaks = find_peaks(1 - 0.1 * np.abs(X - NODES[node])[:, np.newaxis])
    assert peaks.values[0] == pytest.approx(1.0, abs=1e-12)
    assert peaks.positions(NODES)[0] == pytest.approx(NODES[node], abs=1e-9)


def test_the_higher_of_two_close_peaks_wins_even_if_its_samples_are_lower():
    # The first peak is at a node and shows all of its height; the second, between samples.
    def history(x):
        return np.exp(-((x - 2.5) ** 2)) + 1.0002 * np.exp(-((x - 7.5524) ** 2))

    samples = history(X)
    assert samples[X < 5].max() > samples[X > 5].max()
    assert find_peaks(samples[:, np.newaxis]).values[0] == pytest.approx(1.0002, abs=1e-5)


def test_each_history_has_its_own_peak():
    histories = np.column_stack([np.sin(X), np.cos(X / 3), -X])
    peaks = find_peaks(histories)
    assert peaks.values == pytest.approx([1.0, 1.0, 0.0], abs=1e-7)
    # Both maxima of the sine are equal: either is right.
    assert np.sin(peaks.positions(NODES)[0]) == pytest.approx(1.0, abs=1e-6)
    assert peaks.positions(NODES)[1:] == pytest.approx([0.0, 0.0], abs=1e-9)
