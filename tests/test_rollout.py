"""Dampers that predict the peak of what they command: their predictions, laws and routes."""

import ctypes
import dataclasses
import shutil
import subprocess

import casadi as ca
import numpy as np
import pytest

import bridgectl as bc
from bridgectl.dampers import (
    SIGNALS,
    Damper,
    Strategy,
    bridgehook,
    preview_hook,
    rollout_hook,
    simulate_loop,
)
from bridgectl.dampers import compiled as machine
from bridgectl.dampers.block import CROSSING_OUTPUTS
from bridgectl.dampers.loop.batch_law import BatchLaw
from bridgectl.dampers.peak_value import peak_values
from bridgectl.dampers.rollout import plant as plants
from bridgectl.dampers.rollout import predict as predictions
from bridgectl.dampers.rollout.ahead import Mapped, Seen
from bridgectl.dampers.rollout.predict import MARGIN, SQUARINGS, Policy, best_function
from bridgectl.dampers.weights import PEAK_ALONE, Weights, crossing_time, side_cost
from bridgectl.model.crossing import make_crossing
from bridgectl.road import iso8608_elevations

SOFT, STIFF, SPEED = 1e3, 30e3, 30.0
BEAM = bc.Beam(8.0, 15e3, 15e3 * (2 * np.pi * 7) ** 2 * (8.0 / np.pi) ** 4, 2, 0.02)
CAR = bc.QuarterCar(8e3, 800.0, 1.5e5, 1.8e6, 7e3)
CASE = BEAM, CAR, SOFT, STIFF
X = -8 + 0.1 * np.arange(161)
ROADS = iso8608_elevations(4, "B", 16, seed=5)
SMOOTH = "deflection"
"""An effect whose influence line has no kink, which steps would miss by some 0.004."""


def soft_maximum(effects):
    return np.log(np.sum(np.maximum(effects, 0) ** 2**SQUARINGS)) / 2**SQUARINGS


class Known:
    """A crossing at a constant damping by the public prediction matrices, over a rough road."""

    def __init__(self, damping, beam=BEAM, effect=SMOOTH):
        self.beam, self.damping = beam, damping
        ramps = np.random.default_rng(3).normal(0, 3e-4, X.size - 1)
        self.road = bc.RoadProfile(X, np.append(0, np.cumsum(ramps)))  # states are from its start
        car = dataclasses.replace(CAR, damping=damping)
        self.known = bc.prediction_matrices(beam, car, SPEED, self.road, start=X[0], effect=effect)
        states = [self.known.initial]
        for transition, offset in zip(self.known.transitions, self.known.offsets, strict=True):
            states.append(transition @ states[-1] + offset)
        self.states = np.array(states)
        self.effects = (self.known.effect_rows * states).sum(axis=1) + self.known.effect_constants

    def given(self, k, distances):
        """State and road of a prediction from node k."""
        x, (body, up, axle, low), modes = (
            self.known.positions[k], self.states[k, :4], self.states[k, 4:].reshape(-1, 2)
        )  # fmt: skip
        z = np.interp(x + np.append(0, distances), self.road.x, self.road.elevation)
        shapes = self.beam.mode_shapes(x)
        force = CAR.linear.static_loads[0] + CAR.tire_stiffness * (
            axle - shapes @ modes[:, 0] + z[0]
        )
        parts = np.column_stack([modes, shapes * force]).ravel()
        return x, np.array([body - axle, axle + z[0], up, low, force, *parts]), z[1:] - z[0]

    def after(self, x, width):
        """Effects that come after a place, a step apart."""
        places = x + width * np.arange(1, 1000)
        on = (places >= 0) & (places <= self.beam.length)
        bridge = slice(self.known.entry, None)
        return np.interp(places[on], self.known.positions[bridge], self.effects[bridge])


def function(distances=(), c=None, weights=PEAK_ALONE, effect=SMOOTH, hold=4e-3):
    """A plant, and the prediction of its held dampings; of one damping c if it is given."""
    low, high = (SOFT, STIFF) if c is None else (c, c)
    law = bridgehook(BEAM, CAR, SOFT, STIFF, effect=effect, **weights._asdict())
    plant = plants.Plant(make_crossing(BEAM, CAR, effect), SPEED, law._worth(SPEED))
    policy = Policy(low, high, 7e3, law._square(SPEED))
    return plant, best_function(plant, policy, weights, hold, Seen(plant, distances))


# Predictions


@pytest.mark.parametrize("damping", [SOFT, STIFF])
def test_predicted_peaks_are_those_of_the_prediction_matrices(monkeypatch, damping):
    """From places where the road's stations are those that are seen; in shares of the static peak.

    Within 0.0012 with steps of up to 4 ms, and with twice as long ones some four times further.
    """
    known, distances, errors = Known(damping), list(0.1 * np.arange(1, 161)), []
    at = [np.argmin(np.abs(known.known.positions - x)) for x in (-8, -5.5, -1, 2, 3)]
    for step in (4e-3, 8e-3):
        monkeypatch.setattr(plants, "STEP", step)
        plant, predict = function(distances, damping)
        found = []
        for k in at:
            x, state, ahead = known.given(k, distances)
            costs = predict(plant.place(x), state, ahead)[2]
            found.append(float(costs[0]) - soft_maximum(known.after(x, plant.width)))
        errors.append(np.abs(found).max())
    assert errors[0] < 1.2e-3
    assert 2.5 * errors[0] < errors[1] < 5e-3


def test_ride_travel_and_tire_force_cost_what_they_do_by_the_prediction_matrices():
    """At a constant damping, from 6 m before the bridge: within 5 %, as of samples 0.1 m apart."""
    weights, known, distances = Weights(6.0, 4.0, 100.0), Known(7e3), list(0.1 * np.arange(1, 161))
    k = int(np.argmin(np.abs(known.known.positions + 6)))
    x, state, ahead = known.given(k, distances)
    costs = []
    for each in (weights, PEAK_ALONE):
        plant, predict = function(distances, 7e3, each)
        costs.append(float(predict(plant.place(x), state, ahead)[2][0]))
    z, places = known.states[k:], known.known.positions[k:]
    drops = -np.interp(places, known.road.x, known.road.elevation)
    sunk = drops + (BEAM.mode_shapes(places) * z[:, 4::2]).sum(axis=1)
    force = 7e3 * (z[:, 1] - z[:, 3])
    rate = side_cost(CAR, weights).rate(z[:, :4], force[:, np.newaxis], sunk[:, np.newaxis])
    expected = np.trapezoid(rate, places / SPEED) / crossing_time(BEAM, SPEED)
    assert costs[0] - costs[1] == pytest.approx(expected, rel=0.05)
    assert expected > 0.01


def test_a_tire_never_pulls_in_a_prediction():
    """Held up 40 mm above the bridge near its end, nothing is on it until there."""
    plant, predict = function()
    low, high = np.zeros((2, 5 + 3 * BEAM.n_modes))
    low[4], high[1] = plant.load, -0.04
    heavy, light = (predict(plant.place(7.0), state, [])[2].full() for state in (low, high))
    assert np.all(light < heavy - 0.1)


def random_states(plant, count, seed):
    rng = np.random.default_rng(seed)
    states = np.zeros((5 + 3 * BEAM.n_modes, count))
    states[:4] = rng.normal(0, [[0.01], [5e-3], [0.1], [0.3]], (4, count))
    states[4] = plant.load + CAR.tire_stiffness * states[1]
    return rng.uniform(-20, 7.8, count), states


def test_what_is_tried_is_what_a_force_is_worth_and_the_other_bound():
    (worth,) = peak_values(BEAM, CAR, SPEED, SOFT, STIFF)
    plant, predict = function(effect="moment")
    places, states = random_states(plant, 300, 1)
    tried = predict.map(300)(plant.place(places)[np.newaxis], states, np.zeros((0, 300)))[1]
    own, other = tried.full().reshape(-1, 2).T
    constant, body, axle = (np.interp(places, worth.positions, each) for each in worth[1:])
    parts = np.array([constant, body * states[2], axle * states[3]])
    sigma, clear = parts.sum(axis=0), np.abs(parts).max(axis=0)
    clear = np.abs(sigma) > 0.02 * clear  # straight between 0.12 m as it is between others
    stiff = sigma * (states[2] - states[3]) < 0
    assert np.array_equal(own[clear], np.where(stiff, STIFF, SOFT)[clear])
    assert clear.sum() > 280
    assert np.array_equal(own + other, np.full(300, SOFT + STIFF))


def test_with_a_weight_on_the_ride_its_own_damping_is_between_the_bounds_and_both_are_tried():
    weights = Weights(ride=0.5)
    plant, predict = function(effect="moment", weights=weights)
    places, states = random_states(plant, 100, 3)
    tried = predict.map(100)(plant.place(places)[np.newaxis], states, np.zeros((0, 100)))[1]
    own, *bounds = tried.full().reshape(-1, 3).T
    assert np.array_equal(bounds, np.tile([[SOFT], [STIFF]], 100))
    assert np.sum((own > SOFT) & (own < STIFF)) > 15


def test_the_lower_prediction_is_commanded_unless_bridgehooks_own_is_as_good():
    """Of 200 states; and it is not always bridgehook's own."""
    plant, predict = function(effect="moment")
    places, states = random_states(plant, 200, 2)
    found = predict.map(200)(plant.place(places)[np.newaxis], states, np.zeros((0, 200)))
    (c,), tried, costs = (each.full() for each in found)
    tried, costs = tried.reshape(-1, 2), costs.reshape(-1, 2)
    other = costs[:, 1] < costs[:, 0] - MARGIN
    assert np.array_equal(c, np.where(other, tried[:, 1], tried[:, 0]))
    assert 10 < other.sum() < 190


def scripted(x, c, end):
    """Passive up to a place, then a damping held up to another, and bridgehook after it."""
    hook = bridgehook(*CASE).for_speed(SPEED)

    def law(s, g):
        after = ca.if_else(s.position < end - 1e-6, c, hook.law(s, g))
        return ca.if_else(s.position < x - 1e-6, 7e3, after)

    return Strategy("scripted", law, SOFT, STIFF)


@pytest.mark.quick_cases(1)
@pytest.mark.parametrize("x", [0.5, 2.0])
def test_what_another_damping_changes_is_predicted_as_closed_loops_have_it(monkeypatch, x):
    """Held for 20 ms, over a known road: within 0.003 of the static moment, of some 0.012."""
    monkeypatch.setattr(predictions, "SQUARINGS", 10)  # nearer to the maximum itself
    distances, road = list(0.1 * np.arange(1, 161)), ROADS[0] - ROADS[0, 0]
    plant, predict = function(distances, effect="moment", hold=0.02)
    k = round((x - X[0]) / plant.width)
    x, end = X[0] + k * plant.width, X[0] + (k + 5) * plant.width
    names = ["suspension_travel", "body_velocity", "axle_velocity", "tire_force"]
    soft, stiff = (
        simulate_loop(
            BEAM, CAR, Damper(scripted(x, c, end), sample_time=plant.step), SPEED, X, road,
            record=names,
        )
        for c in (SOFT, STIFF)
    )  # fmt: skip
    travel, up, low, forces = (soft.histories[0][name][0, : k + 1] for name in names)
    modes = followed(X[0] + plant.width * np.arange(k + 1), forces, plant.step)[-1]
    under = BEAM.mode_shapes(x) @ modes[::3] + (forces[k] - plant.load) / CAR.tire_stiffness
    state = [travel[k], under, up[k], low[k], forces[k], *modes]
    ahead = np.interp(x + np.array(distances), X, road) - np.interp(x, X, road)
    _, tried, costs = predict(plant.place(x), state, ahead)
    order = np.argsort(tried.full()[0])
    change = float(np.diff(costs.full()[0][order])[0])
    true = stiff.daf[0, 0] - soft.daf[0, 0]
    assert change == pytest.approx(true, abs=3e-3)
    assert abs(true) > 1e-2


# The bridge, followed


def followed(places, forces, time):
    """States of the law at samples of the tire force."""
    law = rollout_hook(*CASE).for_speed(SPEED)
    memory, found, row = np.zeros(len(law.states)), [], dict.fromkeys(SIGNALS, 0.0)
    for place, force in zip(places, forces, strict=True):
        values = [*(row | {"position": place, "tire_force": force}).values()]
        memory = law.function(values, [], memory, time, [])[1].full()[:, 0]
        found.append(memory)
    return np.array(found)


def test_a_bridge_is_followed_by_the_tire_force():
    """Displacements within 1 % of their largest, with samples 2 ms apart, over a rough road."""
    road = bc.RoadProfile(X, ROADS[0])
    t = np.arange(round(16 / SPEED / 2e-3)) * 2e-3 + X[0] / SPEED
    response = bc.crossing_response(BEAM, CAR, SPEED, road, start=X[0], timepts=t)
    found = followed(SPEED * t, response.outputs["tire_force"], 2e-3)
    for j, mine in enumerate(found[:, ::3].T):
        true = np.asarray(response.states[f"q_{j + 1}"])
        assert mine == pytest.approx(true, abs=0.01 * np.abs(true).max())


# The law, by every route


@pytest.fixture(scope="module")
def law():
    return preview_hook(*CASE, preview=3.0).for_speed(SPEED)


def samples(law, count=60):
    """Signals (n, count), states and what is seen ahead."""
    rng = np.random.default_rng(0)
    sizes = {"tire_force": 1e4, "position": 12.0, "suspension_travel": 0.01}
    values = np.array([rng.normal(0, sizes.get(name, 0.2), count) for name in SIGNALS])
    values[SIGNALS.index("tire_force")] += 86e3
    values[SIGNALS.index("speed")] = SPEED
    memory = rng.normal(0, np.tile([1e-4, 1e-2, 1e4], 2)[:, np.newaxis], (6, count))
    return values, memory, rng.normal(0, 3e-3, (len(law.preview), count))


def by_casadi(law, values, memory, ahead):
    found = [
        law.function(v, [], x, 4e-3, a) for v, x, a in zip(values.T, memory.T, ahead.T, strict=True)
    ]
    return np.array([float(c) for c, _ in found]), np.array([x.full()[:, 0] for _, x in found]).T


def test_in_batches_the_law_is_casadis_own_compiled_or_not(monkeypatch, law):
    """To the bit."""
    values, memory, ahead = samples(law)
    c, after = by_casadi(law, values, memory, ahead)
    assert {SOFT, STIFF, 7e3} == set(c)
    signals = {name: row[np.newaxis] for name, row in zip(SIGNALS, values, strict=True)}
    given = signals, memory[np.newaxis], ahead[np.newaxis]
    batch = BatchLaw(law, [SPEED], sample_time=4e-3)
    compiles = shutil.which("cc") is not None
    assert (batch.functions[0] is not law.function) is compiles
    monkeypatch.setattr(machine, "_made", {})
    monkeypatch.setattr(machine, "COMPILERS", ())
    plain = BatchLaw(law, [SPEED], sample_time=4e-3)
    assert plain.functions[0] is law.function
    for each in (batch, plain):
        found, following = each.command(*given)
        assert np.array_equal(found[0], c)
        assert np.array_equal(following[0], after)


def test_a_compiler_that_fails_is_as_none(monkeypatch, law):
    monkeypatch.setattr(machine, "_made", {})
    monkeypatch.setattr(machine, "FLAGS", ("--no-such-option",))
    assert machine.compiled(law.function) is law.function


def test_a_law_without_long_functions_is_not_compiled():
    plain = bridgehook(*CASE).for_speed(SPEED)
    assert machine.compiled(plain.function) is plain.function


def test_in_a_block_the_law_is_that_on_arrays(law):
    """Force and damping, and where the states go, to 1e-9 of them."""
    values, memory, ahead = samples(law)
    c, after = by_casadi(law, values, memory, ahead)
    block = law.system(SPEED, sample_time=4e-3)
    outputs = [*CROSSING_OUTPUTS.values()]
    for k in range(20):
        known = dict(zip(outputs, (values[SIGNALS.index(n), k] for n in CROSSING_OUTPUTS),
                         strict=True))  # fmt: skip
        known |= {f"ahead_{i + 1}": z for i, z in enumerate(ahead[:, k])}
        inputs, t = [known[name] for name in block.input_labels], values[8, k] / SPEED
        v = known["suspension_velocity"]
        assert block.output(t, memory[:, k], inputs) == pytest.approx([c[k] * v, c[k]], rel=1e-9)
        moves = (after[:, k] - memory[:, k]) / 4e-3
        assert block.dynamics(t, memory[:, k], inputs) == pytest.approx(moves, rel=1e-9, abs=1e-9)


@pytest.mark.skipif(shutil.which("cc") is None, reason="there is no C compiler")
def test_in_c_the_law_is_that_on_arrays(law, tmp_path):
    """To 1e-9, with the work space that the file tells."""
    values, memory, ahead = samples(law)
    c, after = by_casadi(law, values, memory, ahead)
    source, library = law.to_c(tmp_path / "law.c"), tmp_path / "law.so"
    subprocess.run(["cc", "-O1", "-shared", "-fPIC", source, "-o", library, "-lm"], check=True)
    compiled, sizes = ctypes.CDLL(str(library)), (ctypes.c_longlong * 4)()
    places = [ctypes.byref(sizes, 8 * i) for i in range(4)]
    compiled.damping_work(*places)
    doubles = ctypes.POINTER(ctypes.c_double)
    integers, work = (ctypes.c_longlong * (sizes[2] + 1))(), (ctypes.c_double * sizes[3])()
    for k in range(values.shape[1]):
        given = [np.array(v) for v in (values[:, k], [0.0], memory[:, k], [4e-3], ahead[:, k])]
        results = [np.zeros(1), np.zeros(len(memory))]
        arg, res = (
            (doubles * size)(*(each.ctypes.data_as(doubles) for each in arrays))
            for size, arrays in ((sizes[0], given), (sizes[1], results))
        )
        assert compiled.damping(arg, res, integers, work, 0) == 0
        assert results[0] == pytest.approx(c[k], rel=1e-9)
        assert results[1] == pytest.approx(after[:, k], rel=1e-9)


def test_a_strategy_goes_to_other_processes_with_the_laws_that_it_has_made():
    cloudpickle = pytest.importorskip("cloudpickle")
    law = rollout_hook(*CASE)
    made = law.for_speed(SPEED)
    other = cloudpickle.loads(cloudpickle.dumps(law)).for_speed(SPEED)
    given = {"position": [-5.0, 3.0], "axle_velocity": 0.2, "tire_force": [8e4, 9e4]}
    assert np.array_equal(other.command(**given), made.command(**given))


# In closed loops


def test_off_its_reach_the_damper_is_passive():
    law = rollout_hook(*CASE).for_speed(SPEED)
    found = law.command(position=[-60.1, -1e3, 8.01, 50.0], axle_velocity=0.1, tire_force=86e3)
    assert np.all(found == 7e3)


def test_of_a_map_as_much_is_known_as_is_seen_of_as_much():
    """Costs are those of 3 m seen, within 0.0015: of a map corners are cut by up to 15 mm."""
    distances, x = list(0.1 * np.arange(1, 31)), -2.5
    road, known = bc.RoadProfile(X, ROADS[3]), Known(7e3)
    k = int(np.argmin(np.abs(known.known.positions - x)))
    _, state, _ = known.given(k, distances)
    ahead = np.interp(x + np.array(distances), X, ROADS[3]) - np.interp(x, X, ROADS[3])
    plant, seen = function(distances)
    _, level = function()
    mapped = best_function(
        plant, Policy(SOFT, STIFF, 7e3, 0.0), PEAK_ALONE, 4e-3, Mapped(plant, road, 3.0)
    )
    at = plant.place(x)
    costs = [
        each[2].full()
        for each in (seen(at, state, ahead), mapped(at, state, []), level(at, state, []))
    ]
    assert costs[1] == pytest.approx(costs[0], abs=1.5e-3)
    assert np.abs(costs[2] - costs[0]).max() > 5e-3


def test_with_a_map_no_sensor_looks_ahead():
    law = preview_hook(*CASE, road_map=bc.RoadProfile(X, ROADS[3]))
    assert law.name == "map 10 m"
    assert law.for_speed(SPEED).preview == []


@pytest.mark.slow
def test_rollouts_are_below_bridgehook_and_preview_below_those_without(bridge, truck):
    """Mean DAF over six roads of class B at two speeds: by 0.01 each."""
    x, roads = -20 + 0.1 * np.arange(451), iso8608_elevations(6, "B", 45, seed=7)
    case = bridge, truck, SOFT, STIFF
    means = [
        simulate_loop(
            bridge, truck, Damper(law, sample_time=4e-3), [20.0, SPEED], x, roads
        ).daf.mean()
        for law in (bridgehook(*case), rollout_hook(*case), preview_hook(*case))
    ]
    assert means[1] < means[0] - 0.01
    assert means[2] < means[1] - 0.01
