import numpy as np
import pytest
from hypothesis import example, given
from hypothesis import strategies as st

from bridgectl.linear.cells import sample_positions
from bridgectl.linear.peaks import find_peaks, margins, raise_peaks, whole_cells

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


@pytest.mark.parametrize("place", [0.0, 0.12, 9.88, 10.0])
def test_peaks_in_the_first_and_in_the_last_cell_count(place):
    history = 1 - 0.1 * (X - place) ** 2
    peaks = find_peaks(np.column_stack([history, -X]))
    assert peaks.values == pytest.approx([1.0, 0.0], abs=1e-9)
    assert peaks.positions(NODES) == pytest.approx([place, 0.0], abs=1e-6)


def test_a_level_history_has_its_height_for_a_peak():
    assert find_peaks(np.zeros((X.size, 2))).values.tolist() == [0.0, 0.0]


def test_the_margin_is_twice_what_a_parabola_rises_between_three_gauss_points():
    curvatures = np.array([1.0, 3.0])
    apart = (X[3] - X[1]) ** 2
    assert margins(-curvatures * X[:, np.newaxis] ** 2) == pytest.approx(curvatures * apart / 2)
    assert margins(2 + 3 * X[:, np.newaxis]) == pytest.approx(0.0, abs=1e-12)


def test_peaks_are_raised_by_a_further_stretch_and_never_lowered():
    best = np.array([0.5, 2.0, 1.0])
    raise_peaks(best, np.column_stack([np.sin(X), np.sin(X), np.cos(X / 3)]))
    assert best == pytest.approx([1.0, 2.0, 1.0], abs=1e-7)


@pytest.mark.parametrize(
    ("first", "last", "whole"),
    [(1, 5, (0, 7)), (6, 6, (0, 13)), (7, 11, (6, 13)), (0, 0, (0, 7)), (12, 18, (6, 19))],
)
def test_the_cells_around_samples_are_whole_and_a_node_has_two(first, last, whole):
    """Of three cells, 19 samples: 6 a cell and the last node."""
    assert whole_cells(first, last, 19) == whole
