"""Synthesised roads: their spectrum, their IRI, and both ways alike."""

import control as ct
import numpy as np
import pytest

import bridgectl as bc
from bridgectl.road import iso8608_elevations, shaping_filter
from bridgectl.road.iri import golden_car, rectified_slope
from bridgectl.road.psd import RoadPsd, class_roughness, elevation_psd

METHODS = ["spectral", "filter"]
SEEDS = 200


def fits(elevations, step=0.1):
    """Fitted G_d(n_0) and waviness of each road."""
    n, densities, averages = elevation_psd(elevations, step)
    return np.array([RoadPsd(n, density, averages).fit() for density in densities]).T


@pytest.mark.quick_cases(1)
@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize("waviness", [1.0, 1.5, 2.0, 3.0])
def test_the_fitted_line_is_the_one_asked_for_in_the_mean_of_200_roads(method, waviness):
    roads = iso8608_elevations(SEEDS, 16e-6, 1000, seed=1, waviness=waviness, method=method)
    roughness, found = fits(roads)
    assert roughness.mean() == pytest.approx(16e-6, rel=0.05)
    assert found.mean() == pytest.approx(waviness, abs=0.05)


@pytest.mark.slow
@pytest.mark.parametrize("method", METHODS)
def test_every_one_of_200_long_roads_has_the_line_asked_for(method):
    """20 km each, so that one road's own scatter is 1.3 % of G_d(n_0)."""
    worst = np.zeros(2)
    for seed in range(10):  # 20 roads at a time: 32 MB
        roads = iso8608_elevations(SEEDS // 10, "A", 20_000, seed=seed, method=method)
        roughness, waviness = fits(roads)
        off = np.abs(roughness / 16e-6 - 1).max(), np.abs(waviness - 2).max()
        worst = np.maximum(worst, off)
    assert worst[0] < 0.05
    assert worst[1] < 0.05


@pytest.mark.quick_cases(1)
@pytest.mark.parametrize("method", METHODS)
def test_the_iri_of_200_gaussian_roads_is_that_of_theory(method):
    """IRI = 0.543 sqrt(G_d(n_0) / 1e-6 m^3) m/km, within 2 %."""
    roads = iso8608_elevations(SEEDS, "B", 1000, 0.05, seed=2, method=method)
    iri = rectified_slope(roads, 0.05).mean()
    assert iri == pytest.approx(0.543 * np.sqrt(64), rel=0.02)


def test_the_covariance_of_the_filtered_golden_car_is_the_same_iri():
    """One Lyapunov equation: IRI = sqrt(2 / pi) sigma, 0.5547 without the moving average."""
    speed = 80 / 3.6
    road = shaping_filter("A", speed=speed)
    slope = ct.ss(road.A, road.B, road.C @ road.A / speed, 0)  # dz/dx; its noise is added below
    car = golden_car()
    a = np.block([[road.A, np.zeros((1, 4))], [car.B @ slope.C, car.A]])
    b = np.vstack([road.B, car.B @ (road.C @ road.B) / speed])
    covariance = ct.lyap(a, 0.5 * b @ b.T)
    output = np.append(0, car.C)
    iri = 1e3 * np.sqrt(2 / np.pi * output @ covariance @ output)
    assert iri == pytest.approx(0.55472 * 4, rel=1e-3)


@pytest.mark.parametrize("waviness", [1.0, 1.3, 2.0, 2.6, 3.0])
def test_the_filters_gain_squared_is_the_line_within_five_percent_in_its_band(waviness):
    n = np.geomspace(0.02, 4, 200)
    gain = np.abs(shaping_filter(16e-6, waviness=waviness)(2j * np.pi * n))
    line = 16e-6 * (n / 0.1) ** -waviness
    assert gain**2 / line == pytest.approx(np.ones_like(n), abs=0.05)


def test_the_filter_is_that_of_waviness_two_at_1_m_s_and_can_be_connected_by_name():
    road = shaping_filter("A")
    assert (road.input_labels, road.output_labels) == (["noise"], ["elevation"])
    same = shaping_filter("A", waviness=2.0, speed=1.0)
    assert road(0.3j) == pytest.approx(same(0.3j), rel=1e-12)


def test_the_filter_met_at_a_speed_is_the_same_road():
    n = np.geomspace(0.01, 4, 50)
    still, moving = shaping_filter("C", waviness=1.7), shaping_filter("C", waviness=1.7, speed=25.0)
    # White noise of density 1 in time is of density V per cycle/m.
    found = np.abs(moving(2j * np.pi * n * 25)) ** 2 * 25
    assert found == pytest.approx(np.abs(still(2j * np.pi * n)) ** 2, rel=1e-9)


def test_the_filters_road_is_stationary_from_its_first_station():
    roads = iso8608_elevations(4000, "A", 20, 0.5, seed=3, method="filter")
    sigma = roads.std(axis=0)
    expected = np.sqrt(16e-6 * 0.01 * np.pi / 2 / (0.01 / 3))  # integral of the first-order line
    assert sigma == pytest.approx(np.full_like(sigma, expected), rel=0.06)


def test_the_spectral_roads_variance_is_the_integral_of_the_line():
    roads = iso8608_elevations(2000, "A", 100, seed=4)
    expected = np.sqrt(16e-6 * 0.01 * (1 / 0.01 - 1 / 4))
    assert roads.std() == pytest.approx(expected, rel=0.02)


def test_a_short_spectral_road_has_the_slopes_of_waves_far_longer_than_it():
    roads = iso8608_elevations(1000, "A", 5, seed=8)
    n = np.geomspace(0.01, 4, 100_000)
    rise = 2 * (1 - np.cos(2 * np.pi * n * 5)) * 16e-6 * (n / 0.1) ** -2
    expected = np.sqrt(np.trapezoid(rise, n))
    assert (roads[:, -1] - roads[:, 0]).std() == pytest.approx(expected, rel=0.08)


def test_waves_down_to_two_steps_are_there_if_the_band_asks_for_them():
    roads = iso8608_elevations(200, "A", 200, 0.25, seed=9)
    slopes = np.diff(roads) / 0.25
    n = np.geomspace(0.01, 2, 100_000)
    density = 16e-6 * (n / 0.1) ** -2 * (2 * np.sin(np.pi * n * 0.25) / 0.25) ** 2
    assert slopes.std() == pytest.approx(np.sqrt(np.trapezoid(density, n)), rel=0.01)


def test_a_spectral_road_does_not_repeat_itself():
    road = iso8608_elevations(1, "A", 1000, seed=5)[0]
    half = road.size // 2
    alike = np.corrcoef(np.diff(road[:half]), np.diff(road[half : 2 * half]))[0, 1]
    assert abs(alike) < 0.05


@pytest.mark.parametrize("method", METHODS)
def test_the_same_seed_gives_the_same_road_and_another_seed_another(method):
    def make(seed):
        return bc.iso8608_profile("A", 50, seed=seed, start=-25, method=method)

    assert make(7) == make(7)
    assert make(7) == make(np.random.default_rng(7))
    assert make(7) != make(8)
    assert make(None) != make(None)


def test_the_stations_run_from_start_over_the_length():
    road = bc.iso8608_profile("B", 225, seed=0, start=-200)
    assert road.x.size == 2251
    assert road.x[[0, -1]] == pytest.approx([-200, 25], abs=1e-9)
    assert road.name == "ISO 8608 class B"
    assert bc.iso8608_profile(1e-5, 10, seed=0).name == "ISO 8608 Gd = 1e-05 m^3"


def test_roughness_scales_the_road_and_the_level_chooses_the_limit():
    mean = iso8608_elevations(2, "A", 50, seed=1)
    assert iso8608_elevations(2, "A", 50, seed=1, level="upper") == pytest.approx(mean * 2**0.5)
    assert iso8608_elevations(2, "A", 50, seed=1, level="lower") == pytest.approx(mean / 2**0.5)
    assert iso8608_elevations(2, 64e-6, 50, seed=1) == pytest.approx(mean * 2, rel=1e-12)


def test_waves_outside_the_band_are_left_out():
    roads = iso8608_elevations(20, "A", 1000, seed=6, band=(0.05, 1.0))
    n, density, _ = elevation_psd(roads, 0.1)
    inside, outside = (n > 0.1) & (n < 0.9), n > 1.1
    line = 16e-6 * (n / 0.1) ** -2.0
    assert (density.mean(axis=0) / line)[inside].mean() == pytest.approx(1, rel=0.05)
    assert (density.mean(axis=0) / line)[outside].max() < 1e-2


def test_a_road_as_rough_as_the_limit_of_class_h_can_be_made():
    limit = class_roughness("H", "upper")
    found = iso8608_elevations(1, limit, 25, seed=1)
    assert found == pytest.approx(iso8608_elevations(1, "H", 25, seed=1, level="upper"))


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ({"roughness": "J"}, "roughness must be one of 'A', 'B'"),
        ({"roughness": 0.0}, "roughness must be above 0"),
        ({"roughness": 16.0}, "roughness = 16 m\\^3 is beyond class H: type 16e-6"),
        ({"roughness": 16e-6, "level": "upper"}, "level = 'upper' goes with an ISO class"),
        ({"level": "middle"}, "level must be one of"),
        ({"length": 0.05}, "length must be at least one step of 0.1 m, got 0.05 m"),
        ({"step": -1}, "step must be above 0"),
        ({"waviness": 4}, "waviness must lie between 1 and 3"),
        ({"band": (1, 0.5)}, "band must rise from above 0 cycles/m and begin below 5"),
        ({"band": (0, 0.5)}, "band must rise from above 0"),
        ({"method": "fft"}, "method must be one of 'spectral', 'filter'"),
    ],
)
def test_each_bad_argument_is_named(arguments, message):
    with pytest.raises(ValueError, match=message):
        bc.iso8608_profile(**{"roughness": "A", "length": 25, **arguments})


@pytest.mark.parametrize("method", METHODS)
def test_a_road_may_be_one_step_long(method):
    assert iso8608_elevations(3, "A", 0.1, seed=1, method=method).shape == (3, 2)


def test_a_batch_needs_a_whole_number_of_roads():
    with pytest.raises(ValueError, match="n_roads must be 1 or more"):
        iso8608_elevations(0, "A", 25)
