"""A damper that is told where it is with an error, alone or in company."""

import numpy as np
import pytest

import bridgectl as bc
from bridgectl.dampers import (
    Damper,
    Strategy,
    bridgehook,
    passive,
    program,
    simulate_loop,
)
from bridgectl.road import iso8608_elevations

X = -10 + 0.1 * np.arange(351)
SPEEDS = np.array([30.0, 17.0, 25.0])
PLACES, DAMPINGS = np.array([-5.0, 2, 6, 9, 14, 20]), np.array([2e3, 20e3, 1e3, 30e3, 5e3, 9e3])
# The law of place, and one whose command tells the place that it is told: c = 1000 + 10 x.
SWITCHED = program(PLACES, DAMPINGS)
TELLING = Strategy("telling", lambda s, g: 1e3 + 10 * s.position, 0, 1e4)


@pytest.fixture(scope="module")
def roads():
    return iso8608_elevations(6, "B", 35, seed=2)


def told(damper, bridge, truck, speeds, roads):
    """Errors of the positions told [m], (S, R), from the commands at the first sample."""
    found = simulate_loop(bridge, truck, damper, speeds, X, roads, record=["damping"])
    first = np.array([history["damping"][:, :2] for history in found.histories])
    assert np.ptp(first - 10 * np.multiply.outer(speeds, [0, 2e-3])[:, None], axis=2).max() < 1e-8
    return (first[..., 0] - 1e3) / 10 - X[0]


@pytest.mark.slow
@pytest.mark.parametrize("error", [-2.5, 0.3])
def test_a_program_told_of_a_place_ahead_is_one_with_its_places_behind(bridge, truck, roads, error):
    lost = Damper(SWITCHED, position_error=error)
    shifted = Damper(program(PLACES - error, DAMPINGS))
    one, other = (
        simulate_loop(bridge, truck, damper, SPEEDS, X, roads).daf for damper in (lost, shifted)
    )
    assert one == pytest.approx(other, abs=1e-12)
    right = simulate_loop(bridge, truck, SWITCHED, SPEEDS, X, roads).daf
    assert np.abs(one - right).max() > 1e-3


def test_the_error_is_that_told_less_the_true_place(bridge, truck, roads):
    damper = Damper(TELLING, position_error=0.75)
    assert told(damper, bridge, truck, SPEEDS, roads) == pytest.approx(0.75, abs=1e-9)  # [m]


@pytest.mark.slow
def test_a_crossing_has_one_error_of_its_own_alone_and_in_a_batch(bridge, truck, roads):
    damper = Damper(TELLING, position_error=2.0, position_deviation=0.5, seed=3)
    errors = told(damper, bridge, truck, SPEEDS, roads)
    assert np.unique(errors.round(6)).size == errors.size
    for i, j in np.ndindex(errors.shape):
        alone = told(damper, bridge, truck, SPEEDS[[i]], roads[[j]])
        assert alone[0, 0] == pytest.approx(errors[i, j], abs=1e-9)  # [m]
    other = Damper(TELLING, position_error=2.0, position_deviation=0.5, seed=4)
    assert np.abs(told(other, bridge, truck, SPEEDS, roads) - errors).min() > 1e-6


@pytest.mark.slow
def test_errors_have_their_mean_and_deviation(bridge, truck):
    speeds, roads = np.linspace(20, 30, 20), iso8608_elevations(20, "A", 35, seed=5)
    damper = Damper(TELLING, position_error=1.0, position_deviation=0.5)
    errors = told(damper, bridge, truck, speeds, roads)
    assert errors.mean() == pytest.approx(1.0, abs=3 * 0.5 / 20)  # three standard errors
    assert errors.std() == pytest.approx(0.5, abs=3 * 0.5 / np.sqrt(800))


def test_errors_of_position_leave_the_noise_of_velocities_as_it_is(bridge, truck, roads):
    law = Strategy("still", lambda s, g: 7e3 + 0 * s.position, 0, 1e4)
    one, other = (
        simulate_loop(bridge, truck, Damper(law, velocity_noise=0.05, **more), 25.0, X, roads,
                      record=["body_velocity"]).histories[0]["body_velocity"]
        for more in ({}, {"position_deviation": 1.0})
    )  # fmt: skip
    assert one == pytest.approx(other, abs=1e-12)


@pytest.mark.slow
def test_a_crossing_with_an_error_of_position_is_the_same_by_every_route(bridge, truck, roads):
    damper, road = Damper(SWITCHED, position_deviation=1.0), bc.RoadProfile(X, roads[4])
    together = simulate_loop(bridge, truck, damper, SPEEDS, X, roads).daf
    by_daf = bc.daf(bridge, truck, SPEEDS, road, start=-10, damper=damper)
    assert by_daf == pytest.approx(together[:, 4], abs=1e-12)
    board = bc.score([passive(7e3), damper], bridge, truck, [road], SPEEDS, approach=10, workers=1)
    assert board.values["daf"][1, 0] == pytest.approx(together[:, 4], abs=1e-12)


@pytest.mark.slow
def test_every_ramp_of_a_surface_has_an_error_of_its_own(bridge, truck):
    damper = Damper(SWITCHED, position_deviation=1.0)
    surface = bc.ramp_surface(
        bridge, truck, 25.0, approach=10, every=50, ramp_height=1e-3, damper=damper
    )
    starts = surface.positions[::50]
    assert starts.size == 7
    for start, unit in zip(starts, surface.daf_unit[0, ::50], strict=True):
        ramp = bc.RoadProfile(X, np.where(X - start > 0.05, -1e-3, 0.0))
        assert unit == pytest.approx(
            bc.daf(bridge, truck, 25.0, ramp, start=-10, damper=damper)[0], abs=1e-9
        )


def test_a_constant_damper_needs_no_position(bridge, truck):
    lost = Damper(passive(7e3), position_error=3.0, position_deviation=2.0)
    assert np.array_equal(
        bc.daf(bridge, truck, SPEEDS, damper=lost),
        bc.daf(bridge, truck, SPEEDS, damper=passive(7e3)),
    )


def places_told(damper, beam, vehicle, roads):
    """Positions told at each sample at 25 m/s [m], from the commands, (roads, samples)."""
    found = simulate_loop(beam, vehicle, damper, 25.0, X, roads, record=["damping"])
    return (found.histories[0]["damping"] - 1e3) / 10


def test_a_drift_is_a_share_of_the_way_since_the_start(bridge, truck, roads):
    """Told 2 % more of it, beside errors that are the same everywhere."""
    told = places_told(
        Damper(TELLING, position_error=0.5, position_drift=0.02), bridge, truck, roads
    )
    way = 25.0 * 2e-3 * np.arange(told.shape[1])
    assert told == pytest.approx(np.tile(X[0] + 1.02 * way + 0.5, (len(roads), 1)), abs=1e-9)
    drawn = Damper(TELLING, position_deviation=0.5, position_drift=0.02)
    beyond = places_told(drawn, bridge, truck, roads) - X[0] - 1.02 * way
    assert np.ptp(beyond, axis=1) == pytest.approx(0.0, abs=1e-9)
    assert np.ptp(beyond[:, 0]) > 0.1


def test_legs_of_a_truck_have_one_odometer(bridge):
    """All legs are told of the same way; each is behind the first tire as it is."""
    truck = bc.trucks.load("T2")
    front, rear = places_told(Damper(TELLING, position_drift=0.1), bridge, truck, np.zeros(X.size))
    assert front[0] - rear[0] == pytest.approx(truck.tire_offsets[1] - truck.tire_offsets[0])
    assert np.ptp(front[0] - rear[0]) < 1e-9


@pytest.mark.slow
def test_told_another_speed_a_damper_has_the_law_of_that_speed(bridge, truck, roads):
    law = bridgehook(bridge, truck, 1e3, 30e3)
    wrong = simulate_loop(bridge, truck, Damper(law, speed_error=0.1), 30.0, X, roads).daf
    other = simulate_loop(bridge, truck, law.for_speed(1.1 * 30.0), 30.0, X, roads).daf
    assert wrong == pytest.approx(other, abs=1e-12)
    fast = Strategy("fast", lambda s, g: 100 * s.speed, 0, 1e4)
    found = simulate_loop(
        bridge, truck, Damper(fast, speed_error=-0.2), SPEEDS, X, roads, record=["damping"]
    )
    for c, history in zip(SPEEDS, found.histories, strict=True):
        assert history["damping"] == pytest.approx(80 * c, abs=1e-9)  # [N s/m]


@pytest.mark.parametrize("name", ["position_drift", "speed_error"])
def test_shares_in_percent_are_told(name):
    with pytest.raises(ValueError, match=f"{name} must be above -1, as a share, got -5: for -5 %"):
        Damper(SWITCHED, **{name: -5})
    with pytest.warns(bc.PlausibilityWarning, match=f"{name} = 5 is more than any: for 5 % type"):
        Damper(SWITCHED, **{name: 5})
