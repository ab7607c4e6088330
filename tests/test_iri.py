"""IRI against published check values and real files."""

from pathlib import Path

import control as ct
import numpy as np
import pytest

import bridgectl as bc
from bridgectl.road.iri import golden_car, rectified_slope, suspension_slope

SHARED = Path(__file__).parents[2] / "shared" / "profiles"


def pulse(x):
    """World Bank Technical Paper 46: up from 1 m to 3 m, down to 5 m, 10 mm/m."""
    return 0.01 * np.clip(np.minimum(x - 1, 5 - x), 0, None)


def test_the_running_iri_of_the_triangular_pulse_is_the_published_one():
    """All entries that the notes quote from pp. 41-42 of the paper, zero start, 0.25 m."""
    x = 0.25 * np.arange(121)
    values = rectified_slope(pulse(x), 0.25)
    running = np.cumsum(values) / np.arange(1, 121)
    published = {
        1.25: 0.44424, 2.00: 3.77380, 2.75: 4.85232, 4.75: 7.84294, 5.00: 7.82931,
        10.0: 5.08670, 15.0: 3.71304, 25.0: 2.41392, 30.0: 2.04955,
    }  # fmt: skip
    for station, expected in published.items():
        assert running[round(station / 0.25) - 1] == pytest.approx(expected, abs=1e-5)


def test_the_running_iri_of_a_road_is_the_mean_of_what_lies_before_each_station():
    road = bc.utia_road()
    slope = rectified_slope(road.elevation, 0.25)
    x, every = road.running_iri()
    assert x == pytest.approx(road.x[1 : slope.size + 1])
    assert every == pytest.approx(np.cumsum(slope) / np.arange(1, slope.size + 1), rel=1e-12)
    x, last = road.running_iri(window=100)
    assert x == pytest.approx(road.x[400 : slope.size + 1])
    expected = [slope[i - 400 : i].mean() for i in range(400, slope.size + 1)]
    assert last == pytest.approx(np.array(expected), rel=1e-9)


def test_a_window_as_long_as_its_road_leaves_one_running_value():
    road = bc.utia_road().crop(500, 600).resample(0.1)
    x, found = road.running_iri(window=100)
    assert found == pytest.approx([road.iri()], rel=1e-12)
    assert x == pytest.approx([599.8])  # the moving average needs two more steps
    with pytest.raises(ValueError, match=r"window = 100\.5 m is longer than the road of 100 m"):
        road.running_iri(window=100.5)


@pytest.mark.skipif(not SHARED.is_dir(), reason="the shared reference files are not here")
def test_all_120_running_values_of_the_pulse_are_the_published_ones():
    table = np.loadtxt(SHARED / "wtp46_pulse_check.csv", delimiter=",", skiprows=2)
    values = rectified_slope(np.append(0.0, table[:, 1]), 0.25)
    running = np.cumsum(values) / np.arange(1, 121)
    assert running == pytest.approx(table[:, 2], abs=1e-5)


def test_the_measured_road_has_the_iri_of_other_codes(cases):
    found = bc.utia_road().iri(segment=100)
    assert found == pytest.approx(cases["iri"]["utia_profile_1_100m"], abs=1e-3)
    assert bc.utia_road().iri() == pytest.approx(3.335, abs=1e-3)


@pytest.mark.skipif(not SHARED.is_dir(), reason="the shared reference files are not here")
def test_two_tracks_at_once_have_the_iri_that_their_file_states(cases):
    rows = (SHARED / "txdot_track_run_e1.erd").read_text().splitlines()
    end = next(i for i, row in enumerate(rows) if row.startswith("END"))
    data = [row.replace(",", " ").split() for row in rows[end + 1 :] if row.strip()]
    tracks = 0.3048 * np.array(data, dtype=float).T
    inches_per_mile = rectified_slope(tracks, 0.2069167 * 0.3048).mean(axis=1) * 63.36
    case = cases["iri"]["txdot_track_run_e1.erd"]
    assert inches_per_mile == pytest.approx(case["computed_in_per_mi"], abs=0.02)
    assert inches_per_mile.round().tolist() == case["header_in_per_mi"]


def test_the_gain_over_wavelength_peaks_where_it_should():
    """1.538 at 15.8 m and 1.677 at 2.29 m, without the moving average."""
    wavelength = np.geomspace(1, 40, 20001)
    gain = np.abs(golden_car()(2j * np.pi * (80 / 3.6) / wavelength))
    long_waves, short_waves = wavelength > 6, wavelength < 6
    assert gain[long_waves].max() == pytest.approx(1.538, rel=0.005)
    assert gain[short_waves].max() == pytest.approx(1.677, rel=0.005)
    at_long = wavelength[long_waves][np.argmax(gain[long_waves])]
    at_short = wavelength[short_waves][np.argmax(gain[short_waves])]
    assert [at_long, at_short] == pytest.approx([15.8, 2.29], rel=0.005)


@pytest.mark.parametrize("wavelength", [5.0, 10.0, 15.0])
def test_a_sine_has_the_iri_of_its_gain(wavelength):
    step, amplitude = 0.05, 1e-3
    x = np.arange(0, 2000, step)
    omega = 2 * np.pi * (80 / 3.6) / wavelength
    gain = abs(golden_car()(1j * omega)) * np.sinc(0.25 / wavelength)
    expected = 2 / np.pi * gain * 2 * np.pi * amplitude / wavelength * 1e3
    found = rectified_slope(amplitude * np.sin(2 * np.pi * x / wavelength), step)
    assert found[len(x) // 2 :].mean() == pytest.approx(expected, rel=2e-3)


def test_the_golden_cars_poles_are_the_published_ones():
    poles = np.sort_complex(golden_car().poles())
    expected = [
        -20.40992621332219 - 64.42262610541198j, -20.40992621332219 + 64.42262610541198j,
        -2.590073786677789 - 7.323397385729718j, -2.590073786677789 + 7.323397385729718j,
    ]  # fmt: skip
    assert poles == pytest.approx(np.array(expected), rel=1e-12)


def test_the_golden_car_can_be_connected_by_name():
    car = golden_car()
    assert (car.input_labels, car.output_labels) == (["slope"], ["suspension"])
    assert car.state_labels == ["sprung", "sprung_rate", "unsprung", "unsprung_rate"]


def test_two_slopes_of_a_road_are_enough_for_an_iri():
    """Five samples at 0.1 m: three steps make the base of 250 mm."""
    assert rectified_slope([0.0, 1e-3, 0.0, 1e-3, 0.0], 0.1).shape == (2,)


def test_the_recursion_is_the_plain_loop_over_the_discretised_car():
    """Sayers' algorithm, step by step, as in the published programs; 3 samples at 0.1 m."""
    rng, step = np.random.default_rng(0), 0.1
    z = np.cumsum(rng.normal(0, 1e-3, 2000))
    discrete = ct.c2d(golden_car(), step / (80 / 3.6), "zoh")
    slope = (z[110] - z[0]) / 11
    state, values = np.array([slope, 0, slope, 0]), []
    for i in range(len(z) - 3):
        state = discrete.A @ state + discrete.B[:, 0] * (z[i + 3] - z[i]) / 0.3
        values.append(1e3 * (state[2] - state[0]))
    assert suspension_slope(z, step) == pytest.approx(np.array(values), abs=1e-9)
    assert rectified_slope(z, step) == pytest.approx(np.abs(values), abs=1e-9)


@pytest.mark.parametrize("start", [0.0, -20.0, -200.0, 1e5 / 3])
def test_round_off_in_the_stations_does_not_change_the_base_of_the_average(start):
    """At 0.1 m the 250 mm base is 3 samples; a mean step 1e-17 m longer must not make it 2."""
    z = np.cumsum(np.random.default_rng(0).normal(0, 1e-3, 451))
    road = bc.RoadProfile(start + 0.1 * np.arange(451), z)
    assert road.iri() == pytest.approx(rectified_slope(z, 0.1).mean(), rel=1e-9)


def test_a_grade_has_no_roughness():
    assert bc.RoadProfile([0, 500], [0, 20]).resample(0.25).iri() == pytest.approx(0, abs=1e-9)


def test_the_iri_is_proportional_to_the_road():
    road = bc.utia_road().detrend()
    half = bc.RoadProfile(road.x, road.elevation / 2)
    assert half.iri() == pytest.approx(road.iri() / 2, rel=1e-9)


def test_uneven_stations_are_an_error_that_says_what_to_type():
    with pytest.raises(ValueError, match="IRI needs evenly spaced stations: type road"):
        bc.RoadProfile([0, 0.25, 0.6, 30], [0, 0, 0, 0]).iri()


def test_a_segment_longer_than_the_road_is_an_error():
    with pytest.raises(ValueError, match="segment = 600 m is longer than the road of 544 m"):
        bc.utia_road().iri(segment=600)
    with pytest.raises(ValueError, match=r"segment must be above 0 \[m\]"):
        bc.utia_road().iri(segment=0)


def test_a_road_shorter_than_the_moving_average_is_an_error():
    with pytest.raises(ValueError, match=r"more than 0\.25 m, got 3 samples 0\.1 m apart"):
        rectified_slope([0.0, 0.0, 0.0], 0.1)


def test_a_window_too_short_to_mean_anything_draws_a_warning():
    with pytest.warns(UserWarning, match="an IRI over 10 m says little"):
        values = bc.utia_road().iri(segment=10)
    assert len(values) == 54
