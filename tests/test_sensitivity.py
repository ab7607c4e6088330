"""The gradient of a program's DAF: against the closed loop, and against differences."""

import numpy as np
import pytest
from helpers import NO_DAMPERS, rough_road, without_dampers
from hypothesis import assume, given, settings
from hypothesis import strategies as st
from scipy.optimize import minimize
from test_closed_loop import random_loop

import bridgectl as bc
from bridgectl.dampers import program, program_sensitivity, simulate_loop
from bridgectl.road import iso8608_elevations
from bridgectl.scoring.agreement import paired

PLACES = np.array([-5.0, -1.0, 2.0, 6.0, 11.0])
DAMPINGS = np.array([7e3, 2e3, 25e3, 12e3, 4e3])
SPEED = 27.0


@pytest.fixture(scope="module")
def roads():
    """Stations, and three roads of pieces of 0.5 m with their mirror images."""
    some = [rough_road(seed, -10, 25, step=0.5, height=1e-3) for seed in range(3)]
    z = np.array([road.elevation for road in some])
    return some[0].x, np.vstack([z, -z])


def random_program(seed, n=4):
    """Places and dampings."""
    rng = np.random.default_rng((seed, 3))
    return np.sort(rng.uniform(-2, 8, n)), rng.uniform(1e3, 30e3, n)


@pytest.mark.slow
@settings(max_examples=20, deadline=None)
@given(seed=st.integers(0, 100_000), recovery=st.sampled_from(["exact", "li2006", "modal"]))
def test_the_daf_is_that_of_the_program_in_the_loop(seed, recovery):
    """Of random bridges, trucks, speeds, roads, sections and programs: within 1e-6."""
    beam, car, _, speed, road = random_loop(seed)
    places, dampings = random_program(seed)
    section = np.random.default_rng(seed).uniform(0.3, 0.7)
    case, options = (speed, road.x, road.elevation), {"section": section, "recovery": recovery}
    looped = simulate_loop(beam, car, program(places, dampings, shape="lines"), *case, **options)
    assume(looped.least_force.min() > 0)
    found = program_sensitivity(beam, car, speed, places, dampings, *case[1:], **options)
    assert found.daf == pytest.approx(looped.daf[0], abs=1e-6)


@pytest.mark.slow
def test_of_many_roads_each_is_the_crossing_of_that_road(bridge, truck, roads):
    """Within 1e-6 of `daf`, and to the last digits what it is on its own."""
    x, z = roads
    found = program_sensitivity(bridge, truck, SPEED, PLACES, DAMPINGS, x, z)
    law = program(PLACES, DAMPINGS, shape="lines")
    for k, elevation in enumerate(z):
        road = bc.RoadProfile(x, elevation)
        alone = program_sensitivity(bridge, truck, SPEED, PLACES, DAMPINGS, x, elevation)
        assert found.daf[k] == pytest.approx(
            bc.daf(bridge, truck, SPEED, road, start=-10, damper=law)[0], abs=1e-6
        )
        assert alone.daf[0] == pytest.approx(found.daf[k], abs=1e-12)
        assert alone.gradient[0] == pytest.approx(found.gradient[k], abs=1e-14)


def differences(beam, car, speed, places, dampings, x, z, **options):
    """Central differences of the DAF over 100 N s/m, (roads, places)."""
    columns = []
    for one in 50.0 * np.eye(len(places)):
        more, less = (
            program_sensitivity(beam, car, speed, places, c, x, z, **options).daf
            for c in (dampings + one, dampings - one)
        )
        columns.append((more - less) / 100)
    return np.array(columns).T


def test_the_gradient_is_that_of_differences(bridge, truck, roads):
    """Within 1e-6 per kN s/m; it is up to 2e-3 per kN s/m."""
    case = (bridge, truck, SPEED, PLACES, DAMPINGS, *roads)
    found = program_sensitivity(*case)
    assert found.gradient == pytest.approx(differences(*case), abs=1e-9)
    assert np.abs(found.gradient).max() > 1e-6


@pytest.mark.parametrize("seed", range(6))
def test_so_it_is_of_random_crossings(seed):
    """Sections and recoveries too: within 1e-5 per kN s/m; it is up to 5e-3 per kN s/m."""
    beam, car, _, speed, road = random_loop(seed)
    rng = np.random.default_rng(seed)
    options = {"section": rng.uniform(0.3, 0.7), "recovery": ["exact", "li2006"][seed % 2]}
    case = (beam, car, speed, *random_program(seed), road.x, road.elevation)
    found = program_sensitivity(*case, **options)
    assert found.gradient == pytest.approx(differences(*case, **options), abs=1e-8)


def test_what_comes_after_the_peak_is_worth_nothing(bridge, truck, roads):
    found = program_sensitivity(bridge, truck, SPEED, [-10, 0, 20, 24], [7e3] * 4, *roads)
    assert np.all(found.gradient[:, 3] == 0)
    assert np.all(found.gradient[:, 1] != 0)


def test_all_places_together_are_one_constant_damper(bridge, truck, roads):
    """The sum of a gradient is the change of the passive DAF: within 1e-6 per kN s/m."""
    found = program_sensitivity(bridge, truck, SPEED, PLACES, [7e3] * 5, *roads)
    one = program_sensitivity(bridge, truck, SPEED, [0.0], [7e3], *roads)
    assert found.gradient.sum(axis=1) == pytest.approx(one.gradient[:, 0], abs=1e-12)
    more, less = (
        program_sensitivity(bridge, truck, SPEED, [0.0], [c], *roads).daf for c in (7050, 6950)
    )
    assert one.gradient[:, 0] == pytest.approx((more - less) / 100, abs=1e-9)


def test_a_tire_that_leaves_the_road_is_told(bridge, truck):
    x = np.linspace(-10, 25, 351)
    bump = 0.06 * ((x > -5) & (x < -4))
    with pytest.warns(bc.LiftOffWarning, match="those of one that could pull"):
        program_sensitivity(bridge, truck, SPEED, PLACES, DAMPINGS, x, bump)


@pytest.mark.parametrize(
    ("changed", "error", "message"),
    [
        ({"speed": 0.0}, ValueError, "speed must be above 0"),
        ({"positions": [0, 0]}, ValueError, "positions must increase"),
        ({"dampings": [1e3]}, ValueError, "dampings must have one value for each of the 2"),
        ({"stations": [0, 25]}, ValueError, "elevations must have one value for each"),
        ({"vehicle": 3}, TypeError, "vehicle must be a bridgectl.Vehicle or QuarterCar"),
        ({"vehicle": without_dampers()}, ValueError, NO_DAMPERS),
    ],
)
def test_each_mistake_is_named(bridge, truck, changed, error, message):
    given = {
        "beam": bridge, "vehicle": truck, "speed": SPEED, "positions": [0, 5],
        "dampings": [7e3, 1e3], "stations": [0, 10, 25], "elevations": [0, 0, 0],
    }  # fmt: skip
    with pytest.raises(error, match=message):
        program_sensitivity(**given | changed)


def test_it_tells_of_itself(bridge, truck, roads):
    found = program_sensitivity(bridge, truck, SPEED, PLACES, DAMPINGS, *roads)
    assert repr(found).startswith("Sensitivity(6 roads, DAF from ")


def test_many_roads_are_taken_in_parts(bridge, truck, roads, monkeypatch):
    case = (bridge, truck, SPEED, PLACES, DAMPINGS, *roads)
    whole = program_sensitivity(*case)
    monkeypatch.setattr("bridgectl.dampers.sensitivity.ROADS_AT_ONCE", 4)
    parts = program_sensitivity(*case)
    assert parts.daf == pytest.approx(whole.daf, abs=1e-12)
    assert parts.gradient == pytest.approx(whole.gradient, abs=1e-14)


@pytest.mark.slow
def test_a_program_tuned_on_the_class_dae_lowers_the_daf_of_fresh_roads(bridge, truck):
    """Of class B: the mean DAF of ramps of sigma sqrt(N) both ways, one every metre, by 0.002, and
    with it that of 100 mirror pairs of roads at the same four speeds, by 0.0023 +- 0.0010.
    """
    speeds, knots = np.arange(60, 121, 20) / 3.6, np.array([-12, -6, -2, 1, 4, 7, 10, 13, 16, 20.0])
    surface = bc.ramp_surface(
        bridge, truck, speeds, approach=60, ramp_height="B", both_ways=True, every=10
    )
    starts = surface.positions[::10]
    x = np.sort([*starts, *(starts + 0.1), 25])
    ramps = surface.ramp_height * (x > starts[:, np.newaxis] + 0.05)

    def dafs(logarithms, stations, roads):
        found = [
            program_sensitivity(bridge, truck, c, knots, np.exp(logarithms), stations, roads)
            for c in speeds
        ]
        slope = np.mean([each.gradient for each in found], axis=(0, 1)) * np.exp(logarithms)
        return np.mean([each.daf for each in found], axis=0), slope

    def class_dae(logarithms):
        values, slope = dafs(logarithms, x, np.vstack([ramps, -ramps]))
        return values.mean(), slope

    start = np.full(knots.size, np.log(7e3))
    assert class_dae(start)[0] == pytest.approx(surface.class_dae("B").mean.mean(), abs=2e-4)
    best = minimize(
        class_dae, start, jac=True, method="L-BFGS-B", bounds=[np.log([1e3, 30e3])] * knots.size,
        options={"maxfun": 30},
    )  # fmt: skip
    assert best.fun < class_dae(start)[0] - 0.002
    fresh = iso8608_elevations(100, "B", 85, seed=1)
    stations, roads = -60 + 0.1 * np.arange(851), np.vstack([fresh, -fresh])
    change = dafs(best.x, stations, roads)[0] - dafs(start, stations, roads)[0]
    assert paired(change.reshape(2, -1).mean(axis=0)).high < -0.001
