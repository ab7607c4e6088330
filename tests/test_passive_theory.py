"""Closed forms of a passive quarter-car against Lyapunov, quadrature, search and a long drive."""

import dataclasses

import control as ct
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.optimize import minimize_scalar

import bridgectl as bc
from bridgectl.dampers.passive_theory import (
    comfort_damping,
    invariant_frequencies,
    road_damping,
    variances,
    white_velocity,
)
from bridgectl.measures import dynamic_load_coefficient
from bridgectl.road import iso8608_elevations, shaping_filter

# Closed forms hold for every quarter-car: of any masses and damping, such as no vehicle has.
pytestmark = pytest.mark.filterwarnings("ignore::bridgectl.PlausibilityWarning")

CARS = st.builds(
    bc.QuarterCar,
    sprung_mass=st.floats(200, 12e3),
    unsprung_mass=st.floats(30, 1500),
    suspension_stiffness=st.floats(2e4, 1e6),
    tire_stiffness=st.floats(1.5e5, 4e6),
    damping=st.floats(1e3, 6e4),
)
RESTING = np.array([1.0, 0.0, 1.0, 0.0])  # the states that follow a road of height 1


def responses(car):
    """Body acceleration, travel, tire deflection and tire force, of the states; road apart."""
    system = car.system()
    force = system.C[0]
    return np.array([system.A[1], [1, 0, -1, 0], force / car.tire_stiffness, force])


def with_damping(car, damping):
    return dataclasses.replace(car, damping=float(damping))


def sizes(car, damping, frequencies):
    """Body acceleration, travel and tire force per metre of road, shape (3, n)."""
    system = with_damping(car, damping).system()
    s = 2j * np.pi * np.atleast_1d(frequencies)
    shifted = s[:, None, None] * np.eye(4) - system.A
    relative = -s[:, None] * np.linalg.solve(shifted, RESTING[:, None])[..., 0]
    return np.abs(relative @ responses(with_damping(car, damping))[[0, 1, 3]].T).T


# Variances


@given(CARS, st.floats(5, 40))
def test_the_variances_are_those_of_the_lyapunov_equation(car, speed):
    """Masses relative to the road: white velocity w drives x - r e, for A e + B = 0."""
    system = car.system()
    assert system.A @ RESTING + system.B[:, 0] == pytest.approx(0, abs=1e-6 * abs(system.A).max())
    # r' = 2 pi n_0 sqrt(G_d V) w, and w of one-sided density 1 has a covariance of delta / 2.
    drive = 2 * np.pi * 0.1 * np.sqrt(16e-6 * speed) * RESTING
    covariance = ct.lyap(system.A, 0.5 * np.outer(drive, drive))
    expected = [row @ covariance @ row for row in responses(car)]
    assert list(variances(car, "A", speed)) == pytest.approx(expected, rel=1e-6)


def test_the_variances_are_those_behind_the_packages_shaping_filter(truck):
    """Road and car in one Lyapunov equation; the filter levels off below 1e-6 / 3 cycles/m."""
    road = shaping_filter("B", speed=20.0, band=(1e-6, 4.0))
    car = truck.system()
    a = np.block([[road.A, np.zeros((1, 4))], [car.B[:, :1] @ road.C, car.A]])
    b = np.append(road.B, np.zeros(4))
    covariance = ct.lyap(a, 0.5 * np.outer(b, b))
    # Each response is one of the states relative to the road.
    outputs = [np.append(-(row @ RESTING) * road.C, row) for row in responses(truck)]
    expected = [row @ covariance @ row for row in outputs]
    assert list(variances(truck, "B", 20.0)) == pytest.approx(expected, rel=2e-3)


def test_the_variances_are_the_integrals_of_the_spectrum(truck):
    """One-sided: G(f) = G_d(n_0) n_0^2 V / f^2 times the squared frequency response."""
    f = np.geomspace(1e-4, 1e5, 100_001)
    spectra = 256e-6 * 0.1**2 * 25.0 / f**2 * sizes(truck, truck.damping, f) ** 2
    found = variances(truck, "C", 25.0)
    expected = [found.body_acceleration, found.suspension_travel, found.tire_force]
    assert np.trapezoid(spectra, f) == pytest.approx(expected, rel=1e-4)


@pytest.mark.slow
def test_the_load_coefficients_of_a_long_drive_are_those_of_theory(truck):
    """Road, vehicle and measure end to end: 10 km of class A at 25 m/s, waves to 300 m."""
    step = 0.1
    elevation = iso8608_elevations(1, "A", 10_000, step, seed=3, band=(1 / 300, 4.0))[0]
    time = step / 25.0 * np.arange(elevation.size)
    for damping in (truck.damping, road_damping(truck)):
        car = with_damping(truck, damping)
        force = ct.forced_response(car.system()[0, 0], time, -elevation).outputs
        measured = dynamic_load_coefficient(force[2000:], 98.1e3)
        expected = np.sqrt(variances(car, "A", 25.0).tire_force) / 98.1e3
        assert measured == pytest.approx(expected, rel=0.03)


@pytest.mark.parametrize(
    ("iso_class", "as_it_is", "best"),
    [
        ("A", (0.038, 0.043), (0.023, 0.026)),
        ("B", (0.076, 0.085), (0.046, 0.052)),
        ("C", (0.153, 0.171), (0.093, 0.104)),
    ],
)
def test_the_papers_truck_has_these_load_coefficients_at_20_and_25_metres_per_second(
    truck, iso_class, as_it_is, best
):
    dampings = np.array([[truck.damping], [road_damping(truck)]])
    found = variances(truck, iso_class, [20.0, 25.0], dampings)
    coefficients = np.sqrt(found.tire_force) / truck.linear.static_loads
    assert coefficients == pytest.approx(np.array([as_it_is, best]), abs=6e-4)


def test_the_papers_truck_lies_this_far_above_its_best_damping(truck):
    at = np.sqrt(variances(truck, "A", 25.0, [7e3, 20e3, road_damping(truck)]).tire_force)
    assert at[:2] / at[2] == pytest.approx([1.65, 1.09], abs=0.005)


def test_variances_grow_with_roughness_and_speed_alike(truck):
    one, rough, fast = (
        np.array(variances(truck, *case)) for case in [("A", 10.0), ("B", 10.0), ("A", 40.0)]
    )
    assert rough == pytest.approx(4 * one)
    assert fast == pytest.approx(4 * one)
    assert np.array(variances(truck, 16e-6, 10.0)) == pytest.approx(one)
    upper = np.array(variances(truck, "A", 10.0, level="upper"))
    assert upper == pytest.approx(2 * one)


def test_a_table_of_speeds_and_dampings_holds_each_pair(truck):
    speeds, dampings = np.array([10.0, 25.0, 30.0]), np.array([[5e3], [20e3]])
    table = variances(truck, "A", speeds, dampings)
    for name, values in table._asdict().items():
        assert values.shape == (2, 3), name
        one = getattr(variances(with_damping(truck, 20e3), "A", 25.0), name)
        assert values[1, 1] == pytest.approx(one, rel=1e-12)
        assert np.ndim(one) == 0


def test_the_velocity_of_synthesised_roads_has_the_white_intensity():
    """The rise over T of a road of white velocity has the variance W T."""
    roads = iso8608_elevations(400, "A", 200, 0.5, seed=1, method="filter", band=(1e-4, 1.0))
    rises = roads[:, 20:] - roads[:, :-20]  # 10 m, 0.5 s at 20 m/s
    # The band's end at 1 cycle/m takes 0.5 % of it: 1 / (2 pi^2 n L), as a share.
    assert np.mean(rises**2) == pytest.approx(white_velocity("A", 20.0) * 0.5, rel=0.03)


# Best dampings


@settings(max_examples=20)
@given(CARS)
def test_the_best_dampings_are_those_a_search_finds(car):
    for best, name in ((comfort_damping, "body_acceleration"), (road_damping, "tire_force")):
        closed = best(car)
        found = minimize_scalar(
            lambda c, name=name: np.log(getattr(variances(car, "A", 20.0, np.exp(c)), name)),
            bracket=(np.log(1e3), np.log(1e4)),
        )
        assert np.exp(found.x) == pytest.approx(closed, rel=1e-5)


def test_the_best_dampings_of_the_papers_truck(truck):
    assert comfort_damping(truck) == pytest.approx(5.96e3, abs=5)
    assert road_damping(truck) == pytest.approx(36.7e3, abs=50)


def test_the_best_dampings_are_the_least_of_the_lyapunov_equation_too(truck):
    def variance(damping, row):
        car = with_damping(truck, damping)
        covariance = ct.lyap(car.system().A, np.outer(RESTING, RESTING))
        output = responses(car)[row]
        return output @ covariance @ output

    for closed, row in ((comfort_damping(truck), 0), (road_damping(truck), 3)):
        found = minimize_scalar(variance, bounds=(1e3, 2e5), args=(row,), options={"xatol": 1e-2})
        assert found.x == pytest.approx(closed, rel=1e-4)


# Invariant frequencies


@settings(max_examples=30)
@given(CARS)
def test_no_damping_changes_the_response_at_the_invariant_frequencies(car):
    for row, frequencies in enumerate(invariant_frequencies(car)):
        found = np.array([sizes(car, c, frequencies)[row] for c in (1e2, 7e3, 3e4, 3e5)])
        assert found / found[0] == pytest.approx(np.ones_like(found), rel=1e-6)


def test_the_invariant_frequencies_of_the_papers_truck(truck):
    found = invariant_frequencies(truck)
    assert found.body_acceleration == pytest.approx([0.643, 6.752, 7.049], abs=5e-4)
    assert found.suspension_travel == pytest.approx([2.135], abs=5e-4)
    assert found.tire_force == pytest.approx([0.617, 5.191], abs=5e-4)


@settings(max_examples=10)
@given(CARS)
def test_nowhere_else_are_two_dampings_alike(car):
    """Sign changes between a soft and a stiff damper over a fine sweep, one for each root."""
    low, high = 0.1, 1000.0
    f = np.geomspace(low, high, 10_001)
    softer = sizes(car, 5e3, f) - sizes(car, 6e3, f)
    assert np.all(softer[1] > -1e-9)  # more damping, less travel, but for the one frequency
    found = invariant_frequencies(car)
    for row, roots in ((0, found.body_acceleration), (2, found.tire_force)):
        changes = np.nonzero(np.diff(np.sign(softer[row])))[0]
        roots = roots[(roots > low) & (roots < high)]
        if np.all(np.diff(np.log(roots)) > 0.004):  # else two of them share a step of the sweep
            assert changes.size == roots.size
            assert np.sqrt(f[changes] * f[changes + 1]) == pytest.approx(roots, rel=2e-3)


@pytest.mark.parametrize(
    ("frequency", "better"), [(0.5, "stiff"), (0.7, "soft"), (4.9, "soft"), (5.5, "stiff")]
)
def test_stiff_is_better_for_the_tire_force_outside_the_two_frequencies(truck, frequency, better):
    soft, stiff = (sizes(truck, c, frequency)[2, 0] for c in (3e3, 30e3))
    assert (stiff < soft) == (better == "stiff")


# Errors


@pytest.mark.parametrize(
    "function",
    [comfort_damping, road_damping, invariant_frequencies, lambda c: variances(c, "A", 1)],
)
def test_another_vehicle_is_an_error_that_names_what_to_pass(function, truck):
    text = r"car must be a QuarterCar, got Vehicle: .* bridgectl\.li2006\.car\(\)"
    with pytest.raises(TypeError, match=text):
        function(truck.linear)


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (("I", 20.0), "roughness must be one of 'A'"),
        ((0.0, 20.0), "roughness must be above 0"),
        (("A", 0.0), "speed must be above 0 m/s, got 0"),
        (("A", [10.0, -1.0]), "speed must be above 0 m/s, got -1"),
        (("A", 20.0, 0.0), "damping must be above 0 N s/m"),
        (("A", [1.0, 2.0], [1.0, 2.0, 3.0]), r"type speed\[:, np.newaxis\]"),
    ],
)
def test_an_argument_out_of_range_is_an_error_that_names_it(truck, arguments, message):
    with pytest.raises(ValueError, match=message):
        variances(truck, *arguments)


def test_ragged_speeds_are_an_error(truck):
    with pytest.raises(TypeError, match="speed must be an array of numbers"):
        variances(truck, "A", [[1.0, 2.0], [3.0]])


def test_an_undamped_car_has_no_variance_but_has_best_dampings(truck):
    undamped = with_damping(truck, 0)
    with pytest.raises(ValueError, match="type damping=7e3"):
        variances(undamped, "A", 20.0)
    assert comfort_damping(undamped) == comfort_damping(truck)
    assert variances(undamped, "A", 20.0, 7e3) == variances(truck, "A", 20.0)
