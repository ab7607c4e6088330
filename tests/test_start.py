"""Where a crossing starts: at rest on the road under each axle."""

import warnings

import numpy as np
import pytest
from helpers import rough_road
from reference_trucks import needs_reference, reference_case

import bridgectl as bc

BEAM = bc.Beam(25, 18358, 4.865e10, n_modes=3)
LEGS = np.array([[1.0, -2.0, -1.0, 0.0], [1.0, 3.0, 0.0, -1.0]])


def half_car(damping: float = 12e3) -> bc.Vehicle:
    return bc.Vehicle(
        np.diag([12000.0, 40000.0, 700.0, 900.0]),
        damping * LEGS.T @ LEGS,
        400e3 * LEGS.T @ LEGS,
        [1.8e6, 3.6e6],
        [0.0, 5.0],
        damper_map=LEGS,
        heave=[1.0, 0.0, 1.0, 1.0],
    )


STEP = bc.RoadProfile([-60, -43, -42.9, 25], [0.0, 0.0, 0.01, 0.01])
"""The rear axle is 10 mm lower than the front one where the front one is at -40 m."""


@needs_reference
@pytest.mark.parametrize(
    "name",
    ["a_T2_SS25_iso_20", "b_T5_SS25_isoL_25", "a_T2_SS25_ramp_25", "b_T5_SS25_smooth_20"],
)
def test_reference_cases_that_start_on_a_real_road_are_met_within_2e_4(name):
    given, expected = reference_case(name)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", bc.PlausibilityWarning)  # told below
        assert bc.daf(**given)[0] == pytest.approx(expected, abs=2e-4)


@pytest.mark.parametrize("method", ["propagator", "control"])
def test_a_vehicle_starts_at_rest_on_the_road_under_each_axle(method):
    found = bc.crossing_response(BEAM, half_car(), 25.0, STEP, start=-40, method=method)
    rates = [label for label in found.state_labels if label.endswith("_dot")]
    before = found.time < -1.53  # s, before the rear axle comes to the step
    assert found.inputs[:2, 0] == pytest.approx([0.0, 0.01])
    for name in rates:
        np.testing.assert_allclose(
            found.states[found.state_labels.index(name)][before], 0, atol=1e-9
        )
    forces = np.array([found.outputs[f"tire_force_{k}"][0] for k in (1, 2)])
    assert forces.sum() == pytest.approx(half_car().static_loads.sum())
    assert forces == pytest.approx(half_car().static_loads)  # two tires bear what they must


def test_a_twisted_road_shares_the_load_of_three_axles_anew():
    legs = np.column_stack([np.ones(3), [-3.0, 1.0, 2.5], -np.eye(3)])
    truck = bc.Vehicle(
        np.diag([15000.0, 60000.0, 700.0, 700.0, 700.0]), 10e3 * legs.T @ legs,
        900e3 * legs.T @ legs, [1.8e6] * 3, [0.0, 4.0, 5.5], heave=[1.0, 0, 1, 1, 1],
    )  # fmt: skip
    road = bc.RoadProfile([-60, -45, -44.9, -43, -42.9, 25], [0, 0, 0.005, 0.005, 0.0, 0.0])
    found = bc.crossing_response(BEAM, truck, 25.0, road, start=-40)
    forces = np.array([found.outputs[f"tire_force_{k}"][0] for k in (1, 2, 3)])
    assert forces.sum() == pytest.approx(truck.static_loads.sum())
    assert forces[1] > truck.static_loads[1] + 1000  # N: it stands on the bump
    np.testing.assert_allclose(found.outputs["y_1_ddot"][0], 0.0, atol=1e-9)  # m/s^2
    high = bc.RoadProfile([-60, -45.5, -44.5, -43.5, -42.5, 25], [0, 0, 0.4, 0.4, 0, 0])
    with pytest.raises(ValueError, match="at -40 m tire 3 would hang above it: type another start"):
        bc.daf(BEAM, truck, 25.0, high, start=-40)


def test_a_road_that_is_cropped_at_the_start_is_level_before_it():
    car, whole = half_car(), STEP
    cropped = whole.crop(-40, 25)
    found = bc.crossing_response(BEAM, car, 25.0, cropped, start=-40)
    assert not found.inputs[:2, 0].any()
    level = bc.daf(BEAM, car, [25.0], cropped, start=-40)
    np.testing.assert_allclose(level, bc.daf(BEAM, car, [25.0]), atol=1e-9)


def test_one_axle_starts_as_ever():
    road = rough_road(2, -60.0, 25.0, step=0.25)
    car = bc.li2006.car()
    found = bc.daf(BEAM, car, [20.0, 30.0], road, start=-30)
    np.testing.assert_array_equal(
        found, bc.daf(BEAM, car, [20.0, 30.0], road.crop(-30, 25), start=-30)
    )


def test_a_start_that_is_not_forgotten_is_told_with_the_length_that_would_do():
    road = rough_road(2, -400.0, 25.0, step=0.25, height=2e-3)
    with pytest.warns(bc.PlausibilityWarning) as told:
        bc.daf(BEAM, half_car(), [20.0, 30.0], road, start=-10)
    (text,) = [str(warning.message) for warning in told]
    assert "start = -10 m is not forgotten at the bridge" in text
    start = float(text.partition("type start=")[2].partition(" ")[0])
    bc.daf(BEAM, half_car(), [20.0, 30.0], road, start=start)  # no warning
    with pytest.warns(bc.PlausibilityWarning, match="nothing ends it without damping"):
        bc.daf(BEAM, half_car(0.0), [25.0], STEP, start=-40)


def test_a_level_start_or_none_is_not_told():
    level = bc.RoadProfile([-50, -5, -4.9, 25], [0, 0, 0.001, 0.001])
    bc.daf(BEAM, half_car(0.0), [25.0], level, start=-20)
    bc.daf(BEAM, half_car(0.0), [25.0], rough_road(2, 0.0, 25.0, step=0.25))
    bc.daf(BEAM, half_car(0.0), [25.0], start=-20)


def test_the_prediction_starts_there_too():
    car = half_car()
    known = bc.prediction_matrices(BEAM, car, 25.0, STEP, start=-40)
    state = known.initial
    assert state.any()
    for transition, offset in zip(known.transitions, known.offsets, strict=True):
        state = transition @ state + offset
    found = bc.crossing_response(BEAM, car, 25.0, STEP, start=-40)
    np.testing.assert_allclose(state, found.states[:, -1], atol=1e-9)  # m, m/s


@pytest.mark.slow
def test_a_tire_that_leaves_the_road_does_so_from_the_same_start():
    road = bc.RoadProfile([-60, -43, -42.9, -6, -5.5, 25], [0.0, 0.0, 0.01, 0.01, -0.11, -0.11])
    both = []
    for method in ("propagator", "control"):
        with pytest.warns(bc.LiftOffWarning):
            both.append(bc.daf(BEAM, half_car(), [30.0], road, start=-40, method=method))
    np.testing.assert_allclose(*both, atol=1e-5)
