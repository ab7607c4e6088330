"""Ride, travel and tire forces in bridgehook: what a force costs them, and what the law does."""

from dataclasses import replace

import casadi as ca
import control as ct
import numpy as np
import pytest

import bridgectl as bc
from bridgectl.dampers import Damper, bridgehook, passive, simulate_loop
from bridgectl.dampers import weights as module
from bridgectl.dampers.block import CROSSING_OUTPUTS
from bridgectl.dampers.peak_value import peak_values
from bridgectl.dampers.weights import (
    PEAK_ALONE,
    Weights,
    best_damping,
    crossing_time,
    side_cost,
    side_worth,
)
from bridgectl.road import iso8608_elevations

SOFT, STIFF, SPEED = 1e3, 30e3, 25.0
EVERY = Weights(ride=2.0, travel=0.3, tire_force=5.0)
X = -60 + 0.1 * np.arange(851)
RECORDED = ("body_acceleration", "suspension_travel", "tire_force")


@pytest.fixture(scope="module")
def semitrailer():
    return bc.trucks.load("T5air")


def squares(vehicle, history, weights):
    """J without the DAF of recorded crossings, (roads,), from its definition."""
    a, d, r = (np.reshape(h, (-1, *h.shape[-2:])) for h in (history[name] for name in RECORDED))
    loads = vehicle.linear.static_loads[:, np.newaxis, np.newaxis]
    parts = a**2, (d / 0.01) ** 2, (r / loads - 1) ** 2
    return sum(w * part.mean(axis=(0, 2)) for w, part in zip(weights, parts, strict=True))


# What ride, travel and tire forces are


def test_the_square_is_that_of_the_equations_of_motion(semitrailer):
    """Accelerations at the legs, travels and tire forces of random states, forces and drops."""
    rng = np.random.default_rng(2)
    for vehicle in (bc.li2006.car().linear, semitrailer):
        free = vehicle.undamped
        y, rate = rng.normal(0, [[0.01], [0.1]], (2, free.n_coordinates))
        forces, drops = rng.normal(0, 1e3, len(free.damper_map)), rng.normal(0, 0.01, free.n_tires)
        tires = free.tire_stiffnesses * (free.tire_map @ y - drops)
        pushes = (
            -free.stiffness_matrix @ y - free.damping_matrix @ rate
            - free.tire_map.T @ tires - free.damper_map.T @ forces
        )  # fmt: skip
        upper = (free.damper_map + free.damper_axles) @ np.linalg.solve(free.mass_matrix, pushes)
        expected = (
            EVERY.ride * np.mean(upper**2)
            + EVERY.travel * np.mean((free.damper_map @ y / 0.01) ** 2)
            + EVERY.tire_force * np.mean((tires / free.static_loads) ** 2)
        )
        states = np.stack([y, rate], axis=1).ravel()
        found = side_cost(vehicle, EVERY).rate(states, forces, drops)
        assert found == pytest.approx(expected, rel=1e-9)


def test_it_adds_up_to_what_is_measured_along_a_crossing(bridge, truck):
    """On the road before the bridge, whose drop is under the tire: within 1e-3, at 2 ms samples."""
    road = iso8608_elevations(1, "A", 85, seed=3)
    names = (*RECORDED, "body_velocity", "axle_velocity", "suspension_velocity")
    run = simulate_loop(bridge, truck, passive(7e3), SPEED, X, road, record=names)
    history = {name: each[0] for name, each in run.histories[0].items()}
    n = int(60 / SPEED / 2e-3)
    drops = -np.interp(-60 + SPEED * 2e-3 * np.arange(n), X, road[0])
    axle = drops + (history["tire_force"][:n] / truck.linear.static_loads[0] - 1) * (
        truck.linear.static_loads[0] / truck.tire_stiffness
    )
    body = axle + history["suspension_travel"][:n]
    states = np.column_stack(
        [body, history["body_velocity"][:n], axle, history["axle_velocity"][:n]]
    )
    forces = 7e3 * history["suspension_velocity"][:n, np.newaxis]
    rate = side_cost(truck, EVERY).rate(states, forces, drops[:, np.newaxis])
    measured = squares(truck, {k: v[np.newaxis, :n] for k, v in history.items()}, EVERY)
    assert rate.mean() == pytest.approx(measured[0], rel=1e-3)


# What a force costs


@pytest.fixture(scope="module")
def motions(truck):
    """Of the passive truck, by the control library: from some states, and after a push of 1 N s.

    States (n, 4) and damper forces (n, 1) over 15 s, every 0.25 ms; the push is a triangle.
    """
    time = np.arange(0, 15, 2.5e-4)
    push = np.zeros((2, time.size))
    push[1, 0] = 2 / time[1]
    found, damped = [], truck.damping * np.array([0.0, 1.0, 0.0, -1.0])
    for start, inputs in ((np.array([0.004, -0.06, 0.001, 0.1]), 0 * push), (np.zeros(4), push)):
        x = ct.forced_response(truck.system(), time, inputs, start).states
        found.append((x.T, (damped @ x + inputs[1])[:, np.newaxis]))
    return time, *found


@pytest.mark.parametrize("weights", [Weights(ride=1.0), Weights(travel=1.0), EVERY])
def test_a_push_costs_what_it_changes_of_the_motion(truck, motions, monkeypatch, weights):
    """The simulated mixed term of the square, within 0.5 %, if the truck then stays passive."""
    monkeypatch.setattr(module, "SHARE", 1.0)
    time, (z, f), (by_push, forced) = motions
    duration, cost = crossing_time(bc.li2006.beam(), SPEED), side_cost(truck, weights)
    rates = [cost.rate(z + way * by_push, f + way * forced) for way in (1, -1)]
    mixed = np.trapezoid(rates[0] - rates[1], time) / 2 / duration
    found = side_worth(truck, weights, SOFT, STIFF, duration)
    assert found.states[0] @ z[0] == pytest.approx(mixed, rel=5e-3)
    of_force = cost.rate(np.zeros(4), np.array([100.0]))
    assert found.squares[0] == pytest.approx(of_force / 100**2 / duration, rel=1e-9)


def test_a_share_of_what_the_passive_truck_leaves_counts(truck, monkeypatch):
    found = {}
    for share in (0.0, module.SHARE, 1.0):
        monkeypatch.setattr(module, "SHARE", share)
        found[share] = side_worth(truck, EVERY, SOFT, STIFF, 3.4).states
    none, some, whole = found.values()
    assert some == pytest.approx(none + 0.5 * (whole - none), rel=1e-9)
    assert np.abs(whole - none).max() > 0.1 * np.abs(none).max()


def test_the_law_counts_what_is_to_be_expected_of_its_velocities(bridge, truck, monkeypatch):
    """Of the ride at once, 2 a G / T: slopes of a on both velocities, over 300 random roads."""
    monkeypatch.setattr(module, "SHARE", 0.0)
    middle = replace(truck, damping=(SOFT + STIFF) / 2)
    names = ("body_velocity", "axle_velocity", "body_acceleration")
    roads = iso8608_elevations(300, "A", 85, seed=6)
    damper = passive(middle.damping)
    run = simulate_loop(bridge, middle, damper, SPEED, X, roads, record=names)
    body, axle, a = (run.histories[0][name][:, round(59 / SPEED / 2e-3)] for name in names)
    slopes = np.linalg.lstsq(np.column_stack([body, axle, np.ones(300)]), a, rcond=None)[0][:2]
    case = bridge, middle, SPEED, SOFT, STIFF
    (alone,), (ride,) = (peak_values(*case, beside=w) for w in (PEAK_ALONE, Weights(ride=2.0)))
    time = crossing_time(bridge, SPEED)
    for values, of_all, slope, v in zip(ride[2:], alone[2:], slopes, (body, axle), strict=True):
        change = np.interp(-1.0, ride.positions, values - of_all)
        noise = np.std(a) / np.std(v) / np.sqrt(300)
        expected = -2 * 2.0 / truck.sprung_mass / time
        assert change / expected == pytest.approx(slope, abs=3 * noise)


# The damping


def test_it_is_the_least_of_a_parabola_within_the_bounds():
    rng = np.random.default_rng(5)
    worth, v = rng.normal(0, 1e-5, 300), rng.normal(0, 0.1, 300)
    sym, g = ca.SX.sym("x", 2), ca.SX.sym("g", 2)
    bounds = type("Bounds", (), {"c_min": g[0], "c_max": g[1]})
    c = np.linspace(SOFT, STIFF, 2901)
    for square in (1e-8, 0.0):
        best = ca.Function("c", [sym, g], [best_damping(sym[0], square, 7e3, sym[1], bounds)])
        found = best.map(300)(np.array([worth, v]), np.array([SOFT, STIFF])).full()[0]
        force = (c - 7e3) * v[:, np.newaxis]
        cost = worth[:, np.newaxis] * force + square * force**2
        assert found == pytest.approx(c[np.argmin(cost, axis=1)], abs=10.0)
        inside = (found > SOFT + 1) & (found < STIFF - 1)
        assert (0.2 < inside.mean() < 0.9) if square else not inside.any()
        assert best([1e-5, 0.0], [SOFT, STIFF]) == SOFT


def test_without_weights_it_is_bridgehook_as_it_was(bridge, truck):
    plain, zero = bridgehook(bridge, truck, SOFT, STIFF), bridgehook(
        bridge, truck, SOFT, STIFF, ride=0, travel=0, tire_force=0)  # fmt: skip
    assert repr(plain) == repr(zero)
    assert "Weights" not in repr(plain)
    functions = [law.for_speed(SPEED).function.serialize() for law in (plain, zero)]
    assert functions[0] == functions[1]
    side = side_worth(truck, PEAK_ALONE, SOFT, STIFF, 3.4)
    assert not np.any(side.states)
    assert not np.any(side.squares)
    told = repr(bridgehook(bridge, truck, SOFT, STIFF, ride=0.5))
    assert told.endswith("Weights(ride=0.5, travel=0.0, tire_force=0.0))")


def test_with_weights_it_measures_what_it_did_and_is_one_law_for_batch_and_block(bridge, truck):
    hook = bridgehook(bridge, truck, SOFT, STIFF, ride=0.5, tire_force=1.0)
    law = hook.for_speed(SPEED)
    assert law.used == bridgehook(bridge, truck, SOFT, STIFF).for_speed(SPEED).used
    measured = {"body_velocity": 0.05, "axle_velocity": -0.02, "suspension_velocity": 0.07}
    x = np.linspace(-60, 25, 200)
    c = law.command(position=x, **measured)
    assert np.mean((c > SOFT) & (c < STIFF)) > 0.2
    assert np.array_equal(law.command(position=[-60.1, 25.1], **measured), [7e3, 7e3])
    block = hook.system(SPEED)
    values = {CROSSING_OUTPUTS[name]: value for name, value in measured.items()}
    inputs = [values.get(label, 0.0) for label in block.input_labels]
    now = float(law.command(position=5.0, **measured))
    assert block.output(5 / SPEED, [], inputs) == pytest.approx([now * 0.07, now])


# What it does to a crossing


@pytest.fixture(scope="module")
def crossings(bridge, truck):
    """Of 15 roads of class B: mean DAF, and mean squares of ride, travel and tire force."""
    roads = iso8608_elevations(15, "B", 85, seed=8)

    def run(law):
        damper = Damper(law, sample_time=5e-3)
        found = simulate_loop(bridge, truck, damper, SPEED, X, roads, record=RECORDED)
        each = [squares(truck, found.histories[0], w).mean() for w in np.eye(3)]
        return found.daf.mean(), *each

    return {
        "passive": run(passive(7e3)),
        **{key: run(bridgehook(bridge, truck, SOFT, STIFF, **weights)) for key, weights in (
            ("alone", {}), ("ride", {"ride": 0.5}), ("travel", {"travel": 0.02}),
            ("tire_force", {"tire_force": 40.0}), ("most", {"ride": 50.0}),
        )},
    }  # fmt: skip


@pytest.mark.parametrize(
    ("key", "weights"),
    [("ride", (0.5, 0, 0)), ("travel", (0, 0.02, 0)), ("tire_force", (0, 0, 40.0))],
)
def test_what_has_a_weight_is_less_and_so_is_the_cost(crossings, key, weights):
    """By more than a hundredth of DAF against the peak alone, and passive."""
    costs = {name: daf + np.dot(weights, rest) for name, (daf, *rest) in crossings.items()}
    column = np.argmax(weights) + 1
    assert crossings[key][column] < 0.8 * crossings["alone"][column]
    assert costs[key] < min(costs["alone"], costs["passive"]) - 0.01
    assert crossings["alone"][0] < crossings[key][0] < crossings["passive"][0] - 0.02


def test_with_much_weight_the_ride_is_better_than_the_passive_one(crossings):
    assert crossings["most"][1] < 0.7 * crossings["passive"][1]


@pytest.mark.slow
def test_at_every_axle_of_a_truck_the_ride_is_spared(bridge, semitrailer):
    """Five axles, 2 to 30 kN s/m, three roads."""
    roads, x = iso8608_elevations(3, "B", 100, seed=9), -60 + 0.1 * np.arange(1001)
    found = []
    for ride in (0.0, 1.0):
        hook = bridgehook(bridge, semitrailer, 2e3, STIFF, ride=ride)
        run = simulate_loop(bridge, semitrailer, hook, 20.0, x, roads, record=RECORDED)
        found.append((run.daf.mean(), squares(semitrailer, run.histories[0], (1, 0, 0)).mean()))
    (daf, alone), (weighed, spared) = found
    assert spared < 0.7 * alone
    assert daf + alone > weighed + spared


@pytest.mark.parametrize(
    ("changes", "says"),
    [
        ({"ride": -1.0}, "ride must be 0 or more"),
        ({"travel": np.inf}, "travel must be"),
        ({"tire_force": -0.1}, "tire_force must be 0 or more"),
        ({"ride": 1.0, "feedback": False}, "must be 0 without feedback.*leave out feedback=False"),
    ],
)
def test_weights_that_cannot_be_are_refused(bridge, truck, changes, says):
    with pytest.raises(ValueError, match=says):
        bridgehook(bridge, truck, SOFT, STIFF, **changes)


def test_a_vehicle_that_never_rests_has_no_cost_of_its_ride(bridge, truck):
    free = bridgehook(bridge, replace(truck, damping=0.0), 0.0, STIFF, ride=1.0)
    with pytest.raises(ValueError, match=r"come to rest.*type c_min=1e3"):
        free.for_speed(SPEED)
