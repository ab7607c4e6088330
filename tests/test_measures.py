"""Measures against closed forms, python-control, loops over samples and ISO's own numbers."""

import control as ct
import numpy as np
import pytest
from scipy.stats import norm

import bridgectl as bc
from bridgectl.measures import (
    aggregate_fourth_power,
    dynamic_load_coefficient,
)
from bridgectl.measures.history import largest, rms
from bridgectl.measures.loads import road_stress_factor
from bridgectl.measures.weighting import weighted_acceleration, weighted_rms, weighting_filter

W = 98.1e3
ONE_AXIS = [rms, largest]
OF_FORCES = [dynamic_load_coefficient, road_stress_factor]


def wave(amplitude, periods=3, n=3000):
    return amplitude * np.sin(2 * np.pi * periods * np.arange(n) / n)


# Plain measures


def test_the_measures_of_a_whole_sine_wave():
    assert rms(wave(2.0)) == pytest.approx(np.sqrt(2), rel=1e-12)
    assert largest(wave(2.0) - 0.5) == pytest.approx(2.5, rel=1e-6)


@pytest.mark.parametrize("measure", ONE_AXIS)
def test_many_histories_are_measured_one_by_one(measure):
    histories = np.random.default_rng(1).normal(size=(3, 4, 50))
    found = measure(histories)
    assert found.shape == (3, 4)
    assert found[2, 1] == measure(histories[2, 1])
    assert np.ndim(measure(histories[2, 1])) == 0


@pytest.mark.parametrize("measure", OF_FORCES)
def test_each_tire_has_its_own_static_load(measure):
    loads = np.array([40e3, 60e3])
    forces = loads[:, np.newaxis] * (1 + 0.2 * np.random.default_rng(2).normal(size=(5, 2, 200)))
    found = measure(forces, loads)
    assert found.shape == (5, 2)
    assert found[3, 1] == pytest.approx(measure(forces[3, 1], 60e3), rel=1e-12)
    assert found[3, 0] == pytest.approx(measure(forces[3, 0] / 40e3, 1.0), rel=1e-12)


def test_the_load_coefficient_is_that_of_the_static_load_not_of_the_mean():
    assert dynamic_load_coefficient(1.5 * W + wave(0.1 * W), W) == pytest.approx(0.1 / np.sqrt(2))


def test_a_constant_static_force_stresses_the_road_by_one_and_has_no_dynamic_load():
    force = np.full(100, W)
    assert road_stress_factor(force, W) == pytest.approx(1, abs=1e-12)
    assert dynamic_load_coefficient(force, W) == pytest.approx(0, abs=1e-12)


# Road stress


@pytest.mark.parametrize("dlc", [0.05, 0.1, 0.2, 0.3])
def test_the_road_stress_of_gaussian_forces_is_the_identity_of_eisenmann(dlc):
    """Quantiles of the normal distribution, evenly spaced: no chance in it."""
    quantiles = norm.ppf((np.arange(1_000_000) + 0.5) / 1_000_000)
    found = road_stress_factor(W * (1 + dlc * quantiles), W)
    assert found == pytest.approx(1 + 6 * dlc**2 + 3 * dlc**4, abs=2e-4)


def test_the_road_stress_of_random_forces_is_that_of_their_load_coefficient():
    forces = np.random.default_rng(3).normal(W, 0.2 * W, (50, 100_000))
    dlc = dynamic_load_coefficient(forces, W)
    expected = 1 + 6 * dlc**2 + 3 * dlc**4
    assert np.mean(road_stress_factor(forces, W) - expected) == pytest.approx(0, abs=2e-3)


def test_the_road_stress_of_a_wave_is_its_own_and_not_the_gaussian_one():
    """1 + 3 a^2 + 3/8 a^4 for amplitude a."""
    a = 0.3
    assert road_stress_factor(W + wave(a * W), W) == pytest.approx(1 + 3 * a**2 + 3 / 8 * a**4)


# Aggregate fourth power


def test_one_crossing_loads_each_place_by_the_fourth_power_of_its_force():
    x = np.arange(0, 50, 0.005)
    ratio = 1 + 0.2 * np.sin(2 * np.pi * x / 12.5)
    found = aggregate_fourth_power(W * ratio, W, x)
    assert found.places == pytest.approx(0.125 + 0.25 * np.arange(199), abs=1e-9)
    at_places = (1 + 0.2 * np.sin(2 * np.pi * found.places / 12.5)) ** 4
    assert found.values == pytest.approx(at_places, abs=0.005)
    assert found.mean == pytest.approx(road_stress_factor(W * ratio, W), abs=0.005)
    # 5 % of a sine lies above the sine of 81 degrees.
    assert found.percentile(95) == pytest.approx((1 + 0.2 * np.sin(0.45 * np.pi)) ** 4, abs=0.02)


def test_a_place_counts_whose_ends_are_the_ends_of_the_way():
    """0.3 m and 3 x 0.1 m are one place."""
    x = 0.1 * np.arange(3, 28)
    assert aggregate_fourth_power(np.full(25, W), W, x, 0.3).places[[0, -1]] == pytest.approx(
        [0.45, 2.55], abs=1e-9
    )


def test_the_aggregate_over_speeds_and_tires_is_that_of_a_loop():
    rng = np.random.default_rng(4)
    speeds, loads = np.array([15.0, 20.0, 25.0]), np.array([40e3, 60e3])
    x = speeds[:, None, None] * np.arange(0, 4, 0.004) - np.array([[0.0], [3.7]]) - 10.3137
    forces = loads[:, None] * rng.normal(1, 0.2, x.shape)
    found = aggregate_fourth_power(forces, loads, x, cell=0.5)
    for place, value in zip(found.places, found.values, strict=True):
        means = [
            [np.mean(forces[i, k, abs(x[i, k] - place) < 0.25] ** 4) for k in range(2)]
            for i in range(3)
        ]
        assert value == pytest.approx(np.sum(means) / np.sum(3 * loads**4), rel=1e-9)
    assert found.places[[0, -1]] == pytest.approx([-9.75, 45.25], abs=1e-9)


def test_crossings_that_repeat_their_wave_hurt_a_road_more_than_scattered_ones():
    x = np.arange(0, 100, 0.02)
    phases = 2 * np.pi * np.arange(8)[:, np.newaxis] / 8
    alike = W * (1 + 0.3 * np.sin(2 * np.pi * x / 10 + 0 * phases))
    scattered = W * (1 + 0.3 * np.sin(2 * np.pi * x / 10 + phases))
    repeated, spread = (aggregate_fourth_power(f, W, x) for f in (alike, scattered))
    assert repeated.mean == pytest.approx(spread.mean, abs=1e-3)
    assert repeated.percentile(95) > 1.5 * spread.percentile(95)
    assert spread.percentile(100) == pytest.approx(spread.mean, abs=1e-3)


# Weighting


@pytest.mark.parametrize(
    ("frequency", "gain"),
    [(1, 0.482), (2, 0.531), (4, 0.967), (5, 1.039), (6.3, 1.054), (8, 1.036), (16, 0.768),
     (80, 0.132)],
)  # fmt: skip
def test_the_weighting_is_that_of_the_table_of_iso_2631(frequency, gain):
    """Table 3 of ISO 2631-1:1997, within 0.5 %, at the nominal frequencies."""
    assert abs(weighting_filter()(2j * np.pi * frequency)) == pytest.approx(gain, rel=5e-3)


def test_the_state_space_is_the_product_of_the_four_sections():
    f = np.geomspace(0.01, 1000, 101)
    s = 2j * np.pi * f
    w1, w2, w4, w5, w6 = 2 * np.pi * np.array([0.4, 100, 12.5, 2.37, 3.35])
    expected = (
        1 / (1 + np.sqrt(2) * w1 / s + (w1 / s) ** 2)
        / (1 + np.sqrt(2) * s / w2 + (s / w2) ** 2)
        * (1 + s / w4) / (1 + s / (0.63 * w4) + (s / w4) ** 2)
        * (w5 / w6) ** 2
        * (1 + s / (0.91 * w5) + (s / w5) ** 2) / (1 + s / (0.91 * w6) + (s / w6) ** 2)
    )  # fmt: skip
    assert weighting_filter()(s) / expected == pytest.approx(np.ones(101), abs=1e-9)


def test_the_weighting_can_be_connected_by_name():
    system = weighting_filter()
    assert system.input_labels == ["acceleration"]
    assert system.output_labels == ["weighted"]
    assert system.name == "Wk"
    assert system.nstates == 8
    assert system.poles().real.max() == pytest.approx(-2 * np.pi * 0.4 / np.sqrt(2))


@pytest.mark.parametrize("sample_time", [1e-4, 1e-3, 5e-3])
def test_the_weighted_history_is_that_of_python_control(sample_time):
    """`forced_response` too is exact for an input that is linear between its samples."""
    acceleration = np.random.default_rng(5).normal(size=4000)
    time = sample_time * np.arange(4000)
    expected = ct.forced_response(weighting_filter(), time, acceleration).outputs
    found = weighted_acceleration(acceleration, sample_time)
    assert found == pytest.approx(expected, abs=1e-9)
    assert found[0] == 0


@pytest.mark.parametrize("frequency", [0.465, 1.0, 6.9, 20.0])
def test_the_weighted_rms_of_a_vibration_is_its_rms_times_the_gain(frequency):
    time = np.arange(0, 60, 1e-3)
    n = round(frequency * 40) / frequency  # whole periods counted
    vibration = np.sin(2 * np.pi * frequency * time)
    found = weighted_rms(vibration, 1e-3, skip=60 - n)
    gain = abs(weighting_filter()(2j * np.pi * frequency))
    assert found == pytest.approx(gain / np.sqrt(2), rel=2e-3)


def test_the_weighting_forgets_how_it_started_in_2_6_seconds():
    late = weighted_acceleration(np.ones(10_000), 1e-3)
    assert abs(late[2600:]).max() < 0.01
    assert abs(late[:500]).max() > 0.3


def test_many_histories_are_weighted_one_by_one():
    histories = np.random.default_rng(6).normal(size=(3, 2, 400))
    found = weighted_rms(histories, 2e-3, skip=0.2)
    assert found.shape == (3, 2)
    assert found[1, 1] == pytest.approx(weighted_rms(histories[1, 1], 2e-3, skip=0.2), rel=1e-12)
    history = weighted_acceleration(histories[1, 1], 2e-3)
    assert found[1, 1] == pytest.approx(rms(history[100:]), rel=1e-12)


# A crossing


def test_a_crossing_is_measured_in_the_units_of_its_response(bridge, truck):
    road = bc.iso8608_profile("A", 225, seed=1, start=-200)
    response = bc.crossing_response(bridge, truck, 25.0, road, start=-200)
    force = response.outputs[response.output_labels.index("tire_force")]
    assert 0.02 < dynamic_load_coefficient(force, truck.linear.static_loads[0]) < 0.07


# Errors


@pytest.mark.parametrize("measure", ONE_AXIS)
@pytest.mark.parametrize(
    ("history", "error", "message"),
    [
        ([], ValueError, "history must hold one sample or more"),
        ([1.0, np.nan], ValueError, "history must be finite, got nan at index"),
        (["a"], TypeError, "history must be an array of numbers"),
        ([[1.0], [1.0, 2.0]], TypeError, "history must be an array of numbers"),
        (1.0, ValueError, r"history must have shape \(n,\)"),
    ],
)
def test_what_is_not_a_history_is_an_error_that_names_it(measure, history, error, message):
    with pytest.raises(error, match=message):
        measure(history)


@pytest.mark.parametrize("measure", OF_FORCES)
def test_a_static_load_that_does_not_fit_is_an_error(measure):
    with pytest.raises(ValueError, match="static_load must be above 0 N, got 0"):
        measure([W], 0.0)
    with pytest.raises(ValueError, match=r"type car\.linear\.static_loads\[0\]"):
        measure([W], [W])


def test_a_force_without_its_static_load_draws_a_warning():
    with pytest.warns(UserWarning, match="is it R - W"):
        road_stress_factor(wave(0.1 * W), W)


def test_one_force_without_its_static_load_among_many_draws_a_warning():
    histories = W + np.array([[0], [0], [0], [-W]]) + wave(0.1 * W)
    with pytest.warns(UserWarning, match="the mean of force is .* of static_load"):
        road_stress_factor(histories, W)


@pytest.mark.parametrize(
    ("position", "cell", "message"),
    [
        ([0.0, 1.0, 1.0, 2.0], 0.25, "position must rise"),
        ([0.0, 1.0, 2.0], 0.25, r"position must have the shape of force, \(4,\)"),
        ([0.0, 1.0, 2.0, 3.0], 0.25, "type a longer one"),
        ([0.0, 1.0, 2.0, 3.0], 5.0, "no place of 5 m"),
        ([0.0, 1.0, 2.0, 3.0], 0.0, r"cell must be above 0 \[m\]"),
    ],
)
def test_places_that_cannot_be_aggregated_are_an_error(position, cell, message):
    with pytest.raises(ValueError, match=message):
        aggregate_fourth_power(np.full(4, W), W, position, cell)


def test_a_percentile_beyond_100_is_an_error():
    found = aggregate_fourth_power(np.full(4, W), W, [0.0, 1.0, 2.0, 3.0], 1.0)
    with pytest.raises(ValueError, match="q must lie between 0 and 100 %"):
        found.percentile(101)


def test_samples_too_far_apart_for_the_weighting_draw_a_warning():
    with pytest.warns(UserWarning, match="80 Hz"):
        weighted_rms(wave(1.0), 0.02)


def test_samples_just_close_enough_for_the_weighting_draw_none():
    assert weighted_rms(wave(1.0), 1 / 160) > 0.0


def test_all_of_a_history_counts_unless_it_is_skipped():
    found = weighted_rms(wave(1.0, n=600), 1e-3)
    assert found == pytest.approx(rms(weighted_acceleration(wave(1.0, n=600), 1e-3)))


def test_a_skip_that_leaves_nothing_is_an_error():
    with pytest.raises(ValueError, match="leaves nothing of 3 s"):
        weighted_rms(wave(1.0), 1e-3, skip=3.0)
