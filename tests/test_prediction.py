"""Prediction matrices, against simulated crossings and against the equations of motion."""

import dataclasses
from itertools import pairwise

import numpy as np
import pytest
from helpers import random_case, rough_road
from scipy.integrate import solve_ivp

import bridgectl as bc
from bridgectl.linear.prediction import predict
from bridgectl.linear.runs import prepare
from bridgectl.model.crossing import make_crossing

SPEED = 25.0


def predicted(known, impulses=()):
    """States at the nodes, with impulses of the first damper {node: z [N s]} just after them."""
    given, states = dict(impulses), [np.zeros(known.transitions.shape[1])]
    for k, (transition, offset) in enumerate(zip(known.transitions, known.offsets, strict=True)):
        after = states[-1] + (known.damper_input[:, 0] * given[k] if k in given else 0)
        states.append(transition @ after + offset)
    return np.array(states)


def moments(known, states):
    return (known.effect_rows * states).sum(axis=1) + known.effect_constants


def fine(case):
    """Prediction at the nodes that `crossing_response` takes."""
    model = {name: case[name] for name in ("beam", "vehicle", "section", "recovery")}
    run = prepare(make_crossing(**model), case["profile"], case["start"])
    return predict(run, case["speed"], run.nodes(case["speed"], refine=4))


def assert_simulated_alike(case):
    """States to 1e-10 of each one's range, moments to 1e-10 of the static peak."""
    known, response = fine(case), bc.crossing_response(**case)
    states = predicted(known)
    assert known.positions == pytest.approx(response.time * case["speed"], abs=1e-9)
    assert known.durations == pytest.approx(np.diff(response.time), abs=1e-12)
    for mine, other in zip(states.T, np.array(response.states), strict=True):
        assert mine == pytest.approx(other, abs=1e-10 * float(np.ptp(other)))
    assert moments(known, states) == pytest.approx(response.outputs["moment"], abs=1e-10)


# Against simulations


@pytest.mark.quick_cases(2)
@pytest.mark.parametrize("seed", [1, 2, 3, 4, 9])
def test_states_and_moments_are_those_of_a_crossing_of_a_rough_road(seed):
    """Random bridges, sections and recoveries; seeds 4 and 9 have two vehicles."""
    assert_simulated_alike(random_case(seed))


@pytest.mark.parametrize("start", [0.0, -12.3])
def test_a_smooth_road_from_an_approach_is_predicted_too(bridge, truck, start):
    case = {
        "beam": bridge, "vehicle": truck, "speed": SPEED, "profile": None, "start": start,
        "section": 0.4, "recovery": "exact",
    }  # fmt: skip
    assert_simulated_alike(case)
    before = slice(0, fine(case).entry)
    assert np.all(predicted(fine(case))[before] == 0)


def test_the_nodes_of_the_public_function_are_coarser_and_right_to_1e_7(bridge, truck):
    road = rough_road(5, -8, 25)
    known = bc.prediction_matrices(bridge, truck, SPEED, road, start=-8, recovery="li2006")
    response = bc.crossing_response(
        bridge, truck, SPEED, road, start=-8, recovery="li2006", timepts=known.positions / SPEED
    )
    states = predicted(known)
    assert moments(known, states) == pytest.approx(response.outputs["moment"], abs=1e-7)
    velocity = states @ known.velocity_rows[0]
    assert velocity == pytest.approx(response.outputs["suspension_velocity"], abs=1e-6)
    assert known.positions[known.entry] == 0
    assert np.diff(known.positions) == pytest.approx(SPEED * known.durations)


def test_on_the_approach_the_bridge_rests(bridge, truck):
    known = bc.prediction_matrices(bridge, truck, SPEED, rough_road(5, -8, 25), start=-8)
    states, before = predicted(known), slice(0, known.entry)
    assert np.all(known.effect_rows[before] == 0)
    assert np.all(known.effect_constants[before] == 0)
    assert np.all(states[: known.entry + 1, 4:] == 0)
    assert np.any(states[known.entry, :4] != 0)


# Against the equations of motion


def end_of_motion(crossing, places, begin, push):
    """State at the last place [m] from rest at the first; `push` [N] acts on the piece at `begin`.

    The damper force jumps at places alone, and the beam's input has its kink at one.
    """
    state = np.zeros(crossing.n_states)
    for first, last in pairwise(places):
        force = np.array([push if first == begin else 0.0])
        state = solve_ivp(
            lambda t, x, force=force: crossing.dynamics(SPEED * t, x, np.zeros(1), force),
            np.array([first, last]) / SPEED, state,
            method="DOP853", rtol=1e-11, atol=1e-14,
        ).y[:, -1]  # fmt: skip
    return state


@pytest.mark.quick_cases(2)
@pytest.mark.parametrize(("at", "to"), [(-4.0, 6.0), (3.0, 9.0), (8.0, 12.5), (10.0, 20.0)])
def test_an_impulse_changes_states_and_moment_as_a_short_push_does(bridge, truck, at, to):
    """100 N s within 0.1 ms, by the equations of motion; within 1e-4 of the largest change."""
    known, impulse, half = bc.prediction_matrices(bridge, truck, SPEED, start=-8), 100.0, 5e-5
    k, j = (int(np.argmin(abs(known.positions - place))) for place in (at, to))
    plain, hit = predicted(known), predicted(known, {k: impulse})

    crossing, last = bc.Crossing(bridge, truck), float(known.positions[j])
    begin, end = known.positions[k] + SPEED * half * np.array([-1, 1])
    places = sorted([-8.0, 0.0, begin, end, last])
    motions = [end_of_motion(crossing, places, begin, f) for f in (impulse / 2 / half, 0.0)]
    for part in (slice(0, 4, 2), slice(1, 4, 2), slice(4, None, 2), slice(5, None, 2)):
        change = (hit[j] - plain[j])[part]
        expected = (motions[0] - motions[1])[part]
        assert change == pytest.approx(expected, abs=1e-4 * abs(expected).max())

    line = known.effect_rows[j]
    for transition in known.transitions[k:j][::-1]:
        line = line @ transition
    change = float(line @ known.damper_input[:, 0]) * impulse
    forces = [crossing.tire_rows(last) @ x + crossing.linear.static_loads for x in motions]
    values = crossing.values(np.full(2, last), np.array(motions), np.array(forces))
    assert change == pytest.approx(values[0] - values[1], rel=2e-4)
    assert (moments(known, hit) - moments(known, plain))[j] == pytest.approx(change)


@pytest.mark.parametrize("seed", [2, 4])
def test_the_rows_are_those_of_the_moment_with_the_tires_on_the_road(seed):
    """Each by the rows on tire forces and states and by Eq. (2), to 1e-12 of the largest."""
    case = random_case(seed)
    known = fine(case)
    crossing = make_crossing(
        **{name: case[name] for name in ("beam", "vehicle", "section", "recovery")}
    )
    vehicle = crossing.linear
    for k in range(known.entry, len(known.positions), 97):
        x = float(known.positions[k])
        rows, tires = crossing.rows(x), crossing.tire_positions(x)
        expected = rows.per_state + rows.per_force @ crossing.tire_rows(x)
        size = abs(expected).max()
        assert known.effect_rows[k] == pytest.approx(expected, abs=1e-12 * size)
        road = case["profile"].drop(tires, case["start"])
        level = rows.per_force @ (vehicle.static_loads - vehicle.tire_stiffnesses * road)
        assert known.effect_constants[k] == pytest.approx(level + rows.constant, abs=1e-12)


def test_impulses_at_every_node_are_a_constant_damper_in_the_limit(bridge, truck):
    """The error of impulses c v h [N s] falls with the length h of the cells."""
    road, bare = rough_road(3, 0, 25), dataclasses.replace(truck, damping=0.0)
    exact = bc.crossing_response(bridge, truck, SPEED, road)
    run, errors = prepare(bc.Crossing(bridge, bare), road, 0.0), []
    for refine in (1, 2, 4):
        known, state, found = predict(run, SPEED, run.nodes(SPEED, refine)), np.zeros(10), []
        for k, duration in enumerate(known.durations):
            found.append(known.effect_rows[k] @ state + known.effect_constants[k])
            push = known.damper_input @ (truck.damping * known.velocity_rows @ state) * duration
            state = known.transitions[k] @ (state + push) + known.offsets[k]
        expected = np.interp(known.positions[:-1], SPEED * exact.time, exact.outputs["moment"])
        errors.append(abs(np.array(found) - expected).max())
    assert errors[0] < 0.02
    assert errors[1] < 0.6 * errors[0]
    assert errors[2] < 0.6 * errors[1]


# Shapes and mistakes


def test_two_vehicles_have_two_dampers_and_a_plain_one_none(bridge, truck):
    known = bc.prediction_matrices(bridge, bc.convoy([truck, truck], [0, 6.0]), SPEED)
    assert known.damper_input.shape == (14, 2)
    assert known.velocity_rows.shape == (2, 14)
    assert known.positions[-1] == pytest.approx(31.0)
    force = bc.Vehicle([[1e4]], [[1e3]], [[1e4]], [1e6])
    plain = bc.prediction_matrices(bridge, force, SPEED)
    assert plain.damper_input.shape == (8, 0)
    assert repr(plain).startswith("Prediction(250 cells from x = 0 m to 25 m, 8 states, 0 dampers")


def test_a_tire_that_leaves_the_road_is_told(bridge, truck):
    kerb = bc.RoadProfile([-10, -1, -0.9, 25], [0, 0, -0.08, -0.08])
    with pytest.warns(bc.LiftOffWarning, match="a tire leaves the road: the prediction is of one"):
        bc.prediction_matrices(bridge, truck, 30.0, kerb, start=-10)


def test_hopeless_work_is_refused_at_once(bridge, truck):
    with pytest.raises(ValueError, match="this would take about"):
        bc.prediction_matrices(bridge, truck, SPEED, start=-1e9)
