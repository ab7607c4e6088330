"""Clipped LQR: the feedback is optimal before it is clipped, and clipped as a damper must."""

import dataclasses

import control as ct
import numpy as np
import pytest
from helpers import NO_DAMPERS, without_dampers
from hypothesis import given
from hypothesis import strategies as st
from scipy.linalg import solve_continuous_lyapunov

import bridgectl as bc
from bridgectl import dampers
from bridgectl.dampers import SIGNALS
from bridgectl.dampers.lqr import FEEDBACK, equal_weights, regulator
from bridgectl.dampers.passive_theory import variances

SOFT, STIFF = 1e3, 30e3
TRUCK = bc.li2006.car()
LOAD, TIRE = 98.1e3, 1.8e6
LAW = dampers.clipped_lqr(TRUCK, SOFT, STIFF)
ROAD = np.array([[0.0], [0.0], [-1.0], [0.0]])  # where the velocity of the surface comes in
WEIGHTS = [
    {},
    {"body_acceleration": 3.0, "suspension_travel": 1e3, "tire_deflection": 1e5},
    {"body_acceleration": 0.0, "damper_force": 1e-8},
    {"damper_force": 1e-7},
]


def cost(problem, feedback):
    """J on white noise of intensity 1, by the Lyapunov equation of the closed loop."""
    k = np.atleast_2d(feedback)
    closed = problem.state_matrix - problem.input_matrix @ k
    assert np.linalg.eigvals(closed).real.max() < 0
    cross = problem.cross_weight @ k
    weight = problem.state_weight + k.T @ problem.force_weight @ k - cross - cross.T
    covariance = solve_continuous_lyapunov(closed, -ROAD @ ROAD.T)
    return float(np.trace(weight @ covariance))


@pytest.mark.parametrize("weights", WEIGHTS)
def test_no_other_linear_feedback_costs_less(weights):
    problem = regulator(TRUCK, **weights)
    best = problem.feedback()
    least = cost(problem, best)
    rng = np.random.default_rng(0)
    for change in rng.normal(scale=0.02, size=(50, 4)):
        assert cost(problem, best * (1 + change)) >= least * (1 - 1e-9)
    slopes = [
        (cost(problem, best + step) - cost(problem, best - step)) / least
        for step in 1e-3 * np.diag(best)
    ]
    assert slopes == pytest.approx(np.zeros(4), abs=1e-6)


def test_a_passive_damper_is_a_feedback_whose_cost_is_the_closed_form():
    """The problem is that of `variances`: its own damping as feedback gives its own variances."""
    c, q = 14e3, (500.0, 5000.0)
    problem = regulator(TRUCK, 1.0, *q)
    found = variances(TRUCK, "A", 25.0, c)
    white = bc.passive_theory.white_velocity("A", 25.0)
    expected = (
        found.body_acceleration + q[0] * found.suspension_travel + q[1] * found.tire_deflection
    )
    assert white * cost(problem, [0, -c, 0, c]) == pytest.approx(expected, rel=1e-9)


def test_the_free_motion_is_that_of_the_vehicle_without_damper():
    system = dataclasses.replace(TRUCK, damping=0.0).system()
    expected = np.sort(np.abs(ct.poles(system).imag))
    found = np.sort(np.abs(np.linalg.eigvals(regulator(TRUCK).state_matrix).imag))
    assert found == pytest.approx(expected, rel=1e-6)


def test_default_weights_make_the_tire_count_as_much_as_the_ride_and_the_travel_a_tenth():
    travel, tire = equal_weights(TRUCK)
    given_ = dampers.clipped_lqr(
        TRUCK, SOFT, STIFF, suspension_travel=0.1 * travel, tire_deflection=tire
    )
    assert given_.gains == pytest.approx(LAW.gains)
    undamped = dampers.clipped_lqr(dataclasses.replace(TRUCK, damping=0.0), SOFT, STIFF)
    assert undamped.gains == LAW.gains


def test_the_papers_truck_has_these_weights_and_gains():
    assert equal_weights(TRUCK) == pytest.approx([566, 5259], abs=0.5)  # 1/s^4
    found = regulator(TRUCK).feedback()
    assert found == pytest.approx([12.3e3, -35.9e3, 103.7e3, 14.9e3], abs=50)  # N/m, N s/m


def test_the_command_is_the_feedback_force_over_the_velocity_within_bounds():
    rng = np.random.default_rng(0)
    d, body, e, axle = rng.normal(size=(4, 2000)) * np.array([[0.01], [0.1], [0.003], [0.1]])
    v = body - axle
    v[np.abs(v) <= LAW.gains["dead_band"]] = 0.01
    found = LAW.command(
        suspension_travel=d, body_velocity=body, tire_force=LOAD + TIRE * e, axle_velocity=axle,
        suspension_velocity=v,
    )  # fmt: skip
    force = -regulator(TRUCK).feedback() @ [d, body, e, axle]
    assert found == pytest.approx(np.clip(force / v, SOFT, STIFF), rel=1e-9)
    inside = (found > SOFT) & (found < STIFF)
    assert 0.1 < inside.mean() < 0.9  # all three cases occur
    assert (found == SOFT).any()
    assert (found == STIFF).any()


@given(
    values=st.lists(st.floats(-1e100, 1e100), min_size=len(SIGNALS), max_size=len(SIGNALS)),
    slow=st.booleans(),
)
def test_every_command_is_within_its_bounds_whatever_is_measured(values, slow):
    signals = dict(zip(SIGNALS, values, strict=True))
    if slow:
        signals["suspension_velocity"] = 1.01e-4
    assert SOFT <= float(LAW.command(**signals)) <= STIFF


@pytest.mark.parametrize("velocity", [0.0, 1e-4, -1e-4])
def test_within_the_dead_band_the_law_is_soft(velocity):
    assert LAW.command(body_velocity=[1.0, -1.0], suspension_velocity=velocity) == (
        pytest.approx([SOFT, SOFT])
    )


def test_the_feedback_is_in_gains_that_can_be_changed(tmp_path):
    assert [LAW.gains[name] for name in FEEDBACK] == pytest.approx(regulator(TRUCK).feedback())
    bare = dict.fromkeys(FEEDBACK, 0.0)
    for name, signal, value in (
        ("travel_gain", "suspension_travel", 0.01), ("body_gain", "body_velocity", 0.01),
        ("deflection_gain", "tire_force", LOAD + 0.01 * TIRE), ("axle_gain", "axle_velocity", 0.01),
    ):  # fmt: skip
        law = LAW.with_gains(**{**bare, name: -50e3})
        signals = {"tire_force": LOAD, "suspension_velocity": 0.1, signal: value}
        assert law.command(**signals) == pytest.approx(5e3)
    assert "damping(" in LAW.to_c(tmp_path / "damping.c").read_text()


@pytest.mark.parametrize(
    ("options", "error", "message"),
    [
        ({"body_acceleration": -1}, ValueError, "body_acceleration must be 0 or more"),
        ({"body_acceleration": 0}, ValueError, "must not both be 0"),
        ({"suspension_travel": 0}, ValueError, "suspension_travel must be above 0"),
        ({"tire_deflection": 0}, ValueError, "tire_deflection must be above 0"),
        ({"damper_force": -1}, ValueError, "damper_force must be 0 or more"),
        ({"tire_deflection": "much"}, TypeError, "tire_deflection must be one number"),
        ({"dead_band": -1}, ValueError, "gain dead_band"),
        ({"vehicle": 3}, TypeError, "vehicle must be a QuarterCar"),
        ({"vehicle": without_dampers()}, ValueError, NO_DAMPERS),
        ({"c_min": STIFF, "c_max": SOFT}, ValueError, "c_min must not exceed c_max"),
    ],
)
def test_each_mistake_is_named(options, error, message):
    with pytest.raises(error, match=message):
        dampers.clipped_lqr(**{"vehicle": TRUCK, "c_min": SOFT, "c_max": STIFF, **options})
