"""Clipped LQR over a whole vehicle: the best feedback of its state, told by all its legs."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest
from scipy.linalg import solve_continuous_lyapunov
from test_whole_vehicles import compare, five_axles, half_car, quarter_cars

import bridgectl as bc
from bridgectl.dampers import clipped_lqr, simulate_loop
from bridgectl.dampers.each_leg import at_each_leg, corners
from bridgectl.dampers.lqr import FEEDBACK, equal_weights
from bridgectl.dampers.regulator import of_signals, tells_state, whole_regulator

SOFT, STIFF = 1e3, 30e3
RECORD = ["tire_force", "body_acceleration", "suspension_travel"]


def problem_of(vehicle):
    cars = corners(vehicle)
    travel, deflection = np.array([equal_weights(car) for car in cars]).T
    masses = np.array([car.sprung_mass for car in cars])
    return whole_regulator(vehicle, masses, 1.0, 0.1 * travel, deflection, 0.0)


def cost(problem, k):
    """J after a random start, in the mean, by the Lyapunov equation of the closed loop."""
    closed = problem.state_matrix - problem.input_matrix @ k
    assert np.linalg.eigvals(closed).real.max() < 0
    cross = problem.cross_weight @ k
    weight = problem.state_weight + k.T @ problem.force_weight @ k - cross - cross.T
    return float(np.trace(solve_continuous_lyapunov(closed.T, -weight)))


def test_a_half_car_without_coupling_inertia_has_the_gains_of_two_quarter_cars():
    """To 1e-9 of the larger; those of the other axle are as small beside them."""
    half = half_car(np.random.default_rng(3))
    law = clipped_lqr(half, SOFT, STIFF)
    for leg, car in enumerate(quarter_cars(half), 1):
        own, other = law.for_leg(leg).gains, 3 - leg
        for name, gain in clipped_lqr(car, SOFT, STIFF).gains.items():
            if name == "dead_band":
                continue
            assert own[f"{name}_{leg}"] == pytest.approx(gain, rel=1e-9)
            if name in FEEDBACK:
                assert abs(own[f"{name}_{other}"]) < 1e-9 * abs(gain)


@pytest.mark.slow
@pytest.mark.filterwarnings("ignore::bridgectl.PlausibilityWarning")  # a bridge of rock
def test_on_rock_its_axles_move_as_those_of_the_quarter_cars():
    """Closed loop on a rough road: tire forces within 1e-6 of the static load."""
    rock = bc.Beam(25.0, 1e12, 1e19, n_modes=1)
    half = dataclasses.replace(half_car(np.random.default_rng(4)), tire_offsets=[0.0, 4.0])
    road = bc.iso8608_profile("A", 45, seed=1, start=-20)
    given = 25.0, road.x, road.elevation
    law = clipped_lqr(half, SOFT, STIFF)
    forces = simulate_loop(rock, half, law, *given, record=["tire_force"]).histories[0]
    for leg, car in enumerate(quarter_cars(half)):
        own = clipped_lqr(car, SOFT, STIFF)
        single = simulate_loop(rock, car, own, *given, record=["tire_force"]).histories[0]
        late = leg * 80  # samples of 2 ms
        alone = single["tire_force"][0]
        found = forces["tire_force"][leg, 0, late : late + alone.size]
        assert found == pytest.approx(alone, abs=0.06)  # newtons


@pytest.mark.parametrize("truck", [half_car, five_axles])
def test_no_other_feedback_of_the_state_costs_less(truck):
    vehicle = truck(np.random.default_rng(5)) if truck is five_axles else (
        truck(np.random.default_rng(5), 4e4)
    )  # fmt: skip
    problem = problem_of(vehicle)
    best = problem.feedbacks()
    least, rng = cost(problem, best), np.random.default_rng(0)
    for change in rng.normal(scale=0.01, size=(20, *best.shape)):
        assert cost(problem, best * (1 + change)) >= least * (1 - 1e-9)


@pytest.mark.parametrize("truck", [half_car, five_axles])
def test_the_legs_tell_the_feedback_of_the_state_on_a_level_road(truck):
    """Within 1e-9 of the largest force; on a plane road that falls, the state is about it."""
    vehicle = truck(np.random.default_rng(6))
    k = problem_of(vehicle).feedbacks()
    of_legs = of_signals(vehicle, k)
    rng = np.random.default_rng(1)
    y, rates = rng.normal(size=(2, vehicle.n_coordinates, 50)) * [[[0.01]], [[0.1]]]
    states = np.stack([y, rates], axis=1).reshape(-1, 50)
    want = k @ states
    body, axle = vehicle.damper_map + vehicle.damper_axles, vehicle.damper_axles
    signals = np.array([vehicle.damper_map @ y, body @ rates, vehicle.tire_map @ y, axle @ rates])
    found = np.einsum("dsl,slc->dc", of_legs, signals)
    assert found == pytest.approx(want, abs=1e-9 * abs(want).max())
    sunk = np.outer(vehicle.heave, np.full(50, 0.3)) + y  # 0.3 m lower, the road as well
    signals[0], signals[2] = vehicle.damper_map @ sunk, vehicle.tire_map @ sunk - 0.3
    again = np.einsum("dsl,slc->dc", of_legs, signals)
    assert again == pytest.approx(want, abs=1e-9 * abs(want).max())


def test_the_command_is_the_force_over_the_velocity_within_bounds():
    vehicle = half_car(np.random.default_rng(7), 3e4)
    law = clipped_lqr(vehicle, SOFT, STIFF).for_leg(2)
    k = of_signals(vehicle, problem_of(vehicle).feedbacks())[1]
    rng = np.random.default_rng(2)
    values = rng.normal(size=(4, 2, 500)) * np.array([0.01, 0.1, 0.003, 0.1])[:, None, None]
    press = vehicle.static_loads[:, None] + vehicle.tire_stiffnesses[:, None] * values[2]
    named = {
        f"{name}_{leg}": of[leg - 1]
        for name, of in (
            ("suspension_travel", values[0]), ("body_velocity", values[1]), ("tire_force", press),
            ("axle_velocity", values[3]),
        )
        for leg in (1, 2)
    }  # fmt: skip
    v = values[1, 1] - values[3, 1]
    found = law.command(**named, suspension_velocity=v)
    force = -np.einsum("sl,slc->c", k, values)
    assert found == pytest.approx(np.clip(force / v, SOFT, STIFF), rel=1e-9)
    inside = (found > SOFT) & (found < STIFF)
    assert 0.1 < inside.mean() < 0.9


@pytest.mark.slow
@pytest.mark.parametrize(
    ("truck", "seed"), [(half_car, 4), pytest.param(five_axles, 1, marks=pytest.mark.slow)]
)
def test_the_closed_loop_is_its_fine_integration(truck, seed):
    """DAF within 2e-5, with lags and force limits."""
    found, fine, _ = compare(seed, truck, "clipped LQR")
    assert found.daf[0, 0] == pytest.approx(fine.peak, abs=2e-5)


@pytest.mark.slow
@pytest.mark.parametrize(("truck", "share"), [(half_car, 0.8), (five_axles, 0.95)])
def test_on_a_rough_road_it_costs_less_than_any_constant_dampers(bridge, truck, share):
    """J over ten roads of class B; of a half-car less than with the laws of quarter-cars, too."""
    given_ = () if truck is five_axles else (3e4,)
    vehicle = truck(np.random.default_rng(4), *given_)
    roads = [bc.iso8608_profile("B", 65, seed=seed, start=-40) for seed in range(10)]
    z = np.array([road.elevation for road in roads])
    weights = np.array([equal_weights(car) for car in corners(vehicle)]).T

    def costs(law):
        kept = simulate_loop(bridge, vehicle, law, 25.0, roads[0].x, z, record=RECORD).histories[0]
        over = kept["tire_force"] - vehicle.static_loads[:, None, None]
        deflection = over / vehicle.tire_stiffnesses[:, None, None]
        parts = kept["body_acceleration"], kept["suspension_travel"], deflection
        a, d, e = (np.mean(part**2, axis=(1, 2)) for part in parts)
        return float((a + 0.1 * weights[0] * d + weights[1] * e).sum())

    best = min(costs(bc.dampers.passive(c)) for c in (9e3, 12e3, 15e3, 20e3, 25e3, 30e3))
    found = costs(clipped_lqr(vehicle, SOFT, STIFF))
    assert found < share * best
    if truck is half_car:
        alone = at_each_leg(lambda car: clipped_lqr(car, SOFT, STIFF), vehicle)
        assert found < 0.95 * costs(alone)


def test_where_the_legs_do_not_tell_the_state_each_has_the_law_of_its_quarter_car():
    vehicle = half_car(np.random.default_rng(7), 3e4)
    assert tells_state(vehicle)
    roll_bar = np.array([[0.0, 0.0, 1.0, -1.0]])  # a spring that is at no leg
    other = dataclasses.replace(
        vehicle, stiffness_matrix=vehicle.stiffness_matrix + 1e4 * roll_bar.T @ roll_bar
    )
    assert not tells_state(other)
    law = clipped_lqr(other, SOFT, STIFF)
    for leg, car in enumerate(corners(other), 1):
        assert law.for_leg(leg).gains == clipped_lqr(car, SOFT, STIFF).gains
    assert "travel_gain" in clipped_lqr(bc.li2006.car().linear, SOFT, STIFF).for_leg(1).gains


@pytest.mark.parametrize("name", ["suspension_travel", "tire_deflection"])
def test_each_mistake_is_named(name):
    vehicle = half_car(np.random.default_rng(7), 3e4)
    with pytest.raises(ValueError, match=rf"{name} must be above 0 \[1/s\^4\], got -1"):
        clipped_lqr(vehicle, SOFT, STIFF, **{name: -1.0})
    with pytest.raises(ValueError, match="must not both be 0"):
        clipped_lqr(vehicle, SOFT, STIFF, body_acceleration=0.0)
    given = {name: 3e3, "damper_force": 1e-8}
    weights = clipped_lqr(vehicle, SOFT, STIFF, **given).for_leg(1).gains
    assert weights != clipped_lqr(vehicle, SOFT, STIFF).for_leg(1).gains
