"""Strategies with states and preview: in closed loops, as blocks, in C, and what is refused."""

import ctypes
import dataclasses
import shutil
import subprocess

import casadi as ca
import control as ct
import numpy as np
import pytest

import bridgectl as bc
from bridgectl.dampers import SIGNALS, Damper, Strategy, passive, simulate_loop
from bridgectl.dampers.actuator import bare_vehicle
from bridgectl.dampers.fitted import fitted
from bridgectl.dampers.loop.batch_law import BatchLaw
from bridgectl.dampers.loop.loop import Loop
from bridgectl.road import iso8608_elevations

SOFT, STIFF, SPEED, STEP = 1e3, 30e3, 30.0, 2e-3
BEAM = bc.Beam(8.0, 15e3, 15e3 * (2 * np.pi * 7) ** 2 * (8.0 / np.pi) ** 4, 2, 0.02)
CAR = bc.QuarterCar(8e3, 800.0, 1.5e5, 1.8e6, 7e3)
X = -4 + 0.1 * np.arange(121)
ROADS = iso8608_elevations(4, "C", 12, seed=2)
ROUGH = 4 * ROADS
"""Roads that tires leave."""

HISTORIES = ("body_velocity", "damping")


def filtered_law(s, g):
    return g.base + g.slope * ca.fabs(s.filtered)


def filter_update(s, g):
    share = 1 - ca.exp(-g.rate * s.sample_time)
    return {"filtered": s.filtered + share * (s.body_velocity - s.filtered)}


def filtered(kind=Strategy, **changed):
    """A damping that grows with the body's velocity, less what is faster than 20 rad/s."""
    gains = {"base": (2e3, 0, 1e5), "slope": (4e5, 0, 1e7), "rate": (20.0, 0, 1e3)}
    given = {"states": {"filtered": 0.01}, "update": filter_update} | changed
    return kind("filtered", filtered_law, SOFT, STIFF, gains, **given)


def delayed(n):
    """The body's velocity as a damping, n samples late by a line of states."""
    names = [f"last_{i + 1}" for i in range(n)]

    def wanted(s):
        return 5e3 + 2e5 * ca.fabs(s.body_velocity)

    def update(s, g):
        return dict(zip(names, [wanted(s), *(getattr(s, name) for name in names)], strict=False))

    return Strategy(
        f"{n} late", lambda s, g: getattr(s, names[-1]), SOFT, STIFF,
        states=dict.fromkeys(names, 7e3), update=update,
    )  # fmt: skip


def looking(preview=(1.0, 2.5), **options):
    """Stiff ahead of a rise, soft ahead of a drop."""
    return Strategy(
        "looking", lambda s, g: 7e3 + 4e5 * (s.ahead[0] + s.ahead[-1]), SOFT, STIFF,
        preview=preview, **options,
    )  # fmt: skip


def both(s, g):
    """A law with states and preview."""
    return 7e3 + 2e5 * ca.fabs(s.filtered) + 4e5 * s.ahead[1]


def seeing_filter():
    return Strategy(
        "both", both, SOFT, STIFF, {"rate": (20.0, 0, 1e3)}, states={"filtered": 0.0},
        update=filter_update, preview=[0.5, 1.5],
    )  # fmt: skip


def run(law, speeds=SPEED, roads=ROADS, record=HISTORIES, **options):
    return simulate_loop(BEAM, CAR, Damper(law, **options), speeds, X, roads, record=record)


# In closed loops


@pytest.mark.parametrize(
    ("roads", "options"),
    [(ROADS, {}), (ROUGH, {}), (ROADS, {"velocity_noise": 0.02}), (ROADS, {"sample_time": 5e-3})],
    ids=["on the road", "off the road", "with noise", "at 5 ms"],
)
def test_a_filter_in_a_law_is_the_filter_written_by_hand(roads, options):
    """Of what was measured, noise included; dampings within 1e-9 N s/m of some thousand."""
    found = run(filtered(), [SPEED, 20.0], roads, **options)
    assert np.isfinite(found.lift_off).any() == (roads is ROUGH)
    for histories in found.histories:
        state, share = np.full(len(roads), 0.01), 1 - np.exp(-20 * options.get("sample_time", STEP))
        for velocity, damping in zip(*(histories[name].T for name in HISTORIES), strict=True):
            expected = np.clip(2e3 + 4e5 * np.abs(state), SOFT, STIFF)
            assert damping == pytest.approx(expected, rel=0, abs=1e-9)
            state += share * (velocity - state)


@pytest.mark.parametrize("late", [1, 3])
def test_a_line_of_states_delays_the_command_by_exactly_as_many_samples(late):
    histories = run(delayed(late)).histories[0]
    now = np.clip(5e3 + 2e5 * np.abs(histories["body_velocity"]), SOFT, STIFF)
    assert np.array_equal(histories["damping"][:, late:], now[:, :-late])
    assert np.all(histories["damping"][:, :late] == 7e3)
    assert np.ptp(now) > 1e3


LAWS = {law.name: law for law in (filtered(), delayed(2), looking(), seeing_filter())}


@pytest.mark.parametrize("name", LAWS)
def test_alone_or_beside_others_in_any_order_a_controller_does_the_same_to_the_bit(name):
    """Three samples of three speeds and 40 roads, against the same turned and one by one."""
    law, rng, speeds = LAWS[name], np.random.default_rng(0), [20.0, 25.0, SPEED]
    batch, alone = BatchLaw(law, speeds), BatchLaw(law, speeds[1:2])
    memory = batch.start(3, 40)
    turned, one = memory[::-1, :, ::-1], alone.start(1, 1)
    for _ in range(3):
        signals = {key: rng.normal(0, 0.1, (3, 40)) for key in SIGNALS}
        ahead = rng.normal(0, 0.01, (3, len(law.preview), 40))
        c, memory = batch.command(signals, memory, ahead)
        backward = {key: values[::-1, ::-1] for key, values in signals.items()}
        other, turned = batch.command(backward, turned, ahead[::-1, :, ::-1])
        assert np.array_equal(other[::-1, ::-1], c)
        assert np.array_equal(turned[::-1, :, ::-1], memory)
        single = {key: values[1:2, 7:8] for key, values in signals.items()}
        other, one = alone.command(single, one, ahead[1:2, :, 7:8])
        assert np.array_equal(other, c[1:2, 7:8])
        assert np.array_equal(one, memory[1:2, :, 7:8])


@pytest.mark.quick_cases(1)
@pytest.mark.parametrize("name", LAWS)
def test_alone_or_beside_others_in_any_order_a_crossing_is_the_same(name):
    """Of speeds to the bit; products of matrices round by how many roads there are: 1e-12."""
    law, speeds = LAWS[name], np.array([27.0, 20.0, 33.0])
    for roads in (ROADS, ROUGH):
        together, other = run(law, speeds, roads), run(law, speeds[[2, 0, 1]], roads)
        assert np.array_equal(together.daf[[2, 0, 1]], other.daf)
        turned, alone = run(law, speeds[0], roads[::-1]), run(law, speeds[0], roads[2])
        assert turned.daf[0, ::-1] == pytest.approx(together.daf[0], rel=0, abs=1e-12)
        assert alone.daf[0, 0] == pytest.approx(together.daf[0, 2], rel=0, abs=1e-12)
        every = together.histories[0]["damping"]
        assert np.array_equal(every, other.histories[1]["damping"])
        assert alone.histories[0]["damping"][0] == pytest.approx(every[2], rel=1e-9)


@pytest.mark.slow
def test_the_fast_way_of_roads_alike_until_their_ramp_is_that_of_roads_each_on_its_own():
    """Until a ramp begins its road has the memory of the level one, filled by the smooth bridge."""
    crossing = bc.Crossing(BEAM, bare_vehicle(CAR))
    crossing = bc.Crossing(BEAM, bare_vehicle(CAR))
    places = np.array([20, 60, 90])
    level = np.zeros((1, X.size))
    roads = np.vstack([level, 5e-3 * (np.arange(X.size) > places[:, np.newaxis])])
    speeds = np.array([20.0, SPEED])
    begins = np.concatenate([[X[0]], X[places]])
    for law in (filtered(), delayed(3)):
        run_of = (crossing, fitted(law, CAR), speeds, X, roads, HISTORIES, slice(0, 1))
        fast, slow = (Loop(*run_of, begins=given).run() for given in (begins, None))
        for name in ("daf", "least_force", "dissipated", "switches"):
            assert np.array_equal(getattr(fast, name), getattr(slow, name))
        assert np.ptp(fast.daf[1]) > 1e-4


def test_with_preview_a_road_with_a_ramp_is_not_the_level_one_before_it():
    crossing = bc.Crossing(BEAM, bare_vehicle(CAR))
    crossing = bc.Crossing(BEAM, bare_vehicle(CAR))
    roads = np.vstack([np.zeros((1, X.size)), 5e-3 * (X > 6)])
    found = [
        Loop(
            crossing,
            fitted(looking(), CAR),
            np.array([SPEED]),
            X,
            roads,
            ("damping",),
            begins=begins,
        )
        for begins in (np.array([X[0], 6.0]), None)
    ]
    fast, slow = (loop.run() for loop in found)
    assert np.array_equal(fast.daf, slow.daf)
    level, stepped = fast.histories[0]["damping"]
    assert np.all(level == 7e3)
    assert np.max(stepped) == 7e3 + 4e5 * 2 * 5e-3


def test_a_bump_ahead_is_seen_at_its_place_and_positive_up():
    """A triangle of 10 mm at 3 m: from 2.5 and 1 m before it, and on it as a drop all around."""
    bump = np.interp(X, [2.5, 3.0, 3.5], [0, 0.01, 0])
    preview = [1.0, 2.5, 30.0]
    seen = Strategy(
        "seen", lambda s, g: 15e3 + 1e4 * (s.ahead[0] + 10 * s.ahead[1] + 100 * s.ahead[2]),
        SOFT, STIFF, preview=preview,
    )  # fmt: skip
    damping = run(seen, SPEED, bump, record=["damping"]).histories[0]["damping"][0]
    x = X[0] + SPEED * STEP * np.arange(damping.size)
    z = [np.interp(x + d, X, bump) - np.interp(x, X, bump) for d in preview]
    assert damping == pytest.approx(15e3 + 1e4 * (z[0] + 10 * z[1] + 100 * z[2]), abs=1e-6)
    there = [damping[np.argmin(np.abs(x + d - 3.0))] - 15e3 for d in (*preview[:2], 0)]
    assert there == pytest.approx([100, 1e3, -11.1e3], rel=0.06)  # of samples 3 cm from its top


def test_beyond_its_end_the_road_is_level():
    slope = 1e-3 * (X - X[0])
    law = Strategy("end", lambda s, g: 1e3 + 1e6 * s.ahead[0], 0.0, STIFF, preview=[2.0])
    damping = run(law, SPEED, slope, record=["damping"]).histories[0]["damping"][0]
    x = X[0] + SPEED * STEP * np.arange(damping.size)
    assert damping == pytest.approx(1e3 + 1e3 * np.minimum(2.0, X[-1] - x), abs=1e-6)


def test_a_preview_of_a_level_road_is_none():
    level = np.full_like(X, 0.3)
    seeing = run(looking(), [20.0, SPEED], level)
    blind = run(passive(7e3), [20.0, SPEED], level)
    assert np.array_equal(seeing.daf, blind.daf)
    assert all(np.all(h["damping"] == 7e3) for h in seeing.histories)


def test_a_controller_of_ones_own_is_asked_at_every_sample_of_its_crossing():
    """The protocol: it counts its samples in its memory, and sees the road 1 m ahead."""

    class Counting:
        preview = np.array([[1.0]])

        def start(self, n_speeds, n_roads):
            return np.zeros((n_speeds, 1, n_roads))

        def command(self, signals, memory, ahead, sample):
            assert ahead.shape == memory.shape
            return 2e3 + memory[:, 0] + 0 * signals["body_velocity"], memory + 1

    speeds = np.array([20.0, SPEED])
    crossing = bc.Crossing(BEAM, bare_vehicle(CAR))
    crossing = bc.Crossing(BEAM, bare_vehicle(CAR))
    loop = Loop(crossing, fitted(passive(7e3), CAR), speeds, X, ROADS, ("damping",))
    loop.controllers = [Counting()]
    for histories in loop.run().histories:
        count = histories["damping"].shape[1]
        assert np.array_equal(histories["damping"], np.tile(2e3 + np.arange(count), (4, 1)))


# On arrays


def test_arrays_are_casadi_case_by_case_for_states_and_preview_too():
    """Also what is left to CasADi, as the error function is, and laws that differ by speed."""

    def soft_law(s, g):
        return both(s, g) + 100 * ca.erf(s.filtered)

    class Faster(Strategy):
        def for_speed(self, speed):
            def update(s, g):
                return {"filtered": speed * s.filtered + s.body_velocity * s.sample_time}

            states = {"filtered": speed / 1e3}
            return Strategy("at", law, SOFT, STIFF, states=states, update=update, preview=[1, 2])

    rng, shape = np.random.default_rng(0), (3, 50)
    signals = {name: rng.normal(0, 1, shape) for name in SIGNALS}
    memory, ahead = rng.normal(0, 0.05, (3, 1, 50)), rng.normal(0, 0.01, (3, 2, 50))
    speeds = [20.0, 25.0, SPEED]
    for law, apart in ((both, False), (soft_law, True)):
        given = {"states": {"filtered": 0.0}, "preview": [0.5, 1.5]}
        own = Strategy(
            "own", law, SOFT, STIFF, {"rate": (20.0, 0, 1e3)}, update=filter_update, **given
        )
        share = 1 - np.exp(-20 * 4e-3)
        after = memory[:, 0] + share * (signals["body_velocity"] - memory[:, 0])
        batch = BatchLaw(own, speeds, sample_time=4e-3)
        assert (batch.steps is None) is apart
        c, following = batch.command(signals, memory, ahead)
        each = own.command(filtered=memory[:, 0], ahead=np.moveaxis(ahead, 1, -1), **signals)
        assert c == pytest.approx(each, rel=1e-13)
        assert following[:, 0] == pytest.approx(after, rel=1e-13)
        faster = Faster("own", law, SOFT, STIFF, **given, update=lambda s, g: {"filtered": 0})
        several = BatchLaw(faster, speeds)
        assert several.start(3, 2)[:, 0, 1] == pytest.approx([0.02, 0.025, 0.03])
        assert np.array_equal(several.preview, [[1, 2]] * 3)
        c, following = several.command(signals, memory, ahead)
        assert c == pytest.approx(each, rel=1e-13)
        after = np.reshape(speeds, (3, 1)) * memory[:, 0] + signals["body_velocity"] * STEP
        assert following[:, 0] == pytest.approx(after, rel=1e-13)


def test_a_state_that_is_kept_or_passed_on_needs_no_operation():
    law = Strategy(
        "passed", lambda s, g: 2e3 + ca.fabs(s.b), SOFT, STIFF, states={"a": 1.0, "b": 2.0, "k": 3},
        update=lambda s, g: {"k": s.k, "b": s.a, "a": 5},
    )  # fmt: skip
    batch, zeros = BatchLaw(law, [SPEED]), dict.fromkeys(SIGNALS, np.zeros((1, 2)))
    memory = batch.start(1, 2)
    for expected in ([1, 2, 3], [5, 1, 3], [5, 5, 3]):
        assert np.array_equal(memory[0, :, 1], expected)
        c, memory = batch.command(zeros, memory)
        assert np.array_equal(c, [[2e3 + expected[1]] * 2])


# As a block of the control library, and in C


@pytest.mark.slow
def test_a_law_with_states_in_a_block_is_the_sampled_one_better_the_shorter_the_sample_time():
    """DAFs differ by 1.2e-3, 7e-4 and 4e-4 at 4, 2 and 1 ms: a held damping is late by half."""
    errors, bare = [], dataclasses.replace(CAR, damping=0.0)
    for step in (4e-3, 2e-3, 1e-3):
        loop = ct.interconnect(
            [bc.crossing_system(BEAM, bare, SPEED), filtered().system(SPEED, sample_time=step)],
            inputs=["road"], outputs=["moment"], check_unused=False,
        )  # fmt: skip
        t = np.linspace(X[0], X[-1], 2401) / SPEED
        x0 = [0.01 if name.endswith("filtered") else 0.0 for name in loop.state_labels]
        found = ct.input_output_response(
            loop, X / SPEED, ROADS[0, 0] - ROADS[0], x0, t_eval=t,
            solve_ivp_kwargs={"rtol": 1e-6, "atol": 1e-9, "max_step": 4e-3},
        )  # fmt: skip
        daf = np.max(np.asarray(found.outputs)[t * SPEED <= BEAM.length])
        errors.append(abs(run(filtered(), roads=ROADS[:1], sample_time=step).daf[0, 0] - daf))
    assert errors == pytest.approx([1.22e-3, 7.1e-4, 3.9e-4], rel=0.1)
    assert np.all(np.array(errors[1:]) < np.array(errors[:-1]) / 1.6)


@pytest.mark.slow
def test_the_states_of_a_block_move_as_samples_do_better_the_shorter_the_sample_time():
    """Of a velocity of 5 Hz and 0.1 m/s: 3 mm/s at 4 ms, half of it at 2 ms, and so on."""
    law, errors = filtered(), []
    for step in (4e-3, 2e-3, 1e-3):
        block, t = law.system(SPEED, sample_time=step), step * np.arange(round(0.4 / step) + 1)
        velocity = 0.1 * np.sin(2 * np.pi * 5 * t)
        inputs = np.vstack([velocity, np.zeros((3, t.size))])
        found = ct.input_output_response(
            block, t, inputs, [0.01], solve_ivp_kwargs={"rtol": 1e-8, "atol": 1e-10}
        )
        batch = BatchLaw(law, [SPEED], sample_time=step)
        memory, signals = batch.start(1, 1), dict.fromkeys(SIGNALS, np.zeros((1, 1)))
        sampled = []
        for now in velocity:
            sampled.append(memory[0, 0, 0])
            _, memory = batch.command(signals | {"body_velocity": np.full((1, 1), now)}, memory)
        errors.append(float(np.abs(np.asarray(found.states[0]) - sampled).max()))
    assert errors[0] == pytest.approx(3e-3, rel=0.05)
    assert np.all(np.array(errors[1:]) < np.array(errors[:-1]) / 1.9)
    assert block.state_labels == ["filtered"]


def test_a_block_has_what_is_seen_ahead_as_inputs():
    block = seeing_filter().system(SPEED)
    assert block.input_labels[-2:] == ["ahead_1", "ahead_2"]
    given = {"suspension_velocity": 0.5, "ahead_2": 0.01}
    inputs = [given.get(label, 0.0) for label in block.input_labels]
    expected = 7e3 + 2e5 * 0.02 + 4e5 * 0.01
    assert block.output(0.0, [0.02], inputs) == pytest.approx([0.5 * expected, expected])
    pull = (1 - np.exp(-20 * STEP)) * (0 - 0.02) / STEP
    assert block.dynamics(0.0, [0.02], inputs) == pytest.approx([pull])


def test_a_block_may_have_a_lagged_tire_force_beside_states():
    law = Strategy(
        "rates", lambda s, g: 1e3 + ca.fabs(s.low) + 0 * s.tire_force_rate, SOFT, STIFF,
        states={"low": 0.0}, update=lambda s, g: {"low": s.tire_force_rate},
    )  # fmt: skip
    block = law.system(SPEED, rate_time=1e-2, sample_time=1e-3)
    assert block.state_labels == ["lagged_tire_force", "low"]
    moves = block.dynamics(0.0, [1e5, 100.0], [0, 0, 0, 0, 1e5 + 20])
    assert moves == pytest.approx([2e3, (2e3 - 100) / 1e-3])


@pytest.mark.skipif(shutil.which("cc") is None, reason="there is no C compiler")
@pytest.mark.parametrize("name", LAWS)
def test_in_c_a_law_with_states_or_preview_is_that_on_arrays(name, tmp_path):
    """Over 200 samples, to 1e-12: signals, gains, states, sample time and ahead to c and states."""
    law, doubles = LAWS[name], ctypes.POINTER(ctypes.c_double)
    source, library = law.to_c(tmp_path / "law.c"), tmp_path / "law.so"
    subprocess.run(["cc", "-O1", "-shared", "-fPIC", source, "-o", library, "-lm"], check=True)
    damping, work = ctypes.CDLL(str(library)).damping, (ctypes.c_double * 1000)()
    batch, rng = BatchLaw(law, [SPEED], sample_time=4e-3), np.random.default_rng(0)
    memory, state = batch.start(1, 1), np.array([*law.states.values(), 0.0])
    for _ in range(200):
        values = rng.normal(0, 0.1, len(SIGNALS))
        ahead = rng.normal(0, 0.01, len(law.preview))
        c, after = np.zeros(1), np.zeros_like(state)
        given = [values, np.array([*law.gains.values(), 0.0]), state, np.array([4e-3]), ahead]
        arguments = (doubles * 5)(*(value.ctypes.data_as(doubles) for value in given))
        results = (doubles * 2)(*(value.ctypes.data_as(doubles) for value in (c, after)))
        damping(arguments, results, None, work, 0)
        signals = dict(zip(SIGNALS, values.reshape(-1, 1, 1), strict=True))
        expected, memory = batch.command(signals, memory, ahead.reshape(1, -1, 1))
        assert c == pytest.approx(expected[0], rel=1e-12)
        assert after[:-1] == pytest.approx(memory[0, :, 0], rel=1e-12)
        state = after


# What is asked of any strategy


def test_states_are_given_by_name_as_signals_are_and_start_at_their_initial_values():
    law = seeing_filter()
    assert law.command() == 7e3
    assert law.command(filtered=[0.01, -0.02]) == pytest.approx([9e3, 11e3])
    assert law.command(ahead=[[0, 0.01], [0, 0.02]], filtered=0.01) == pytest.approx([13e3, 17e3])
    rows = np.zeros((len(SIGNALS), 2))
    ahead = [[0, 0.01], [0, 0.02]]
    assert law.evaluate(rows, filtered=0.01, ahead=ahead) == pytest.approx([13e3, 17e3])
    timed = Strategy("timed", lambda s, g: 1e6 * s.sample_time, 0, STIFF, states={"a": 0.0},
                     update=lambda s, g: {"a": 0.0})  # fmt: skip
    assert timed.command() == 2e3
    assert timed.command(sample_time=5e-3) == 5e3
    assert law.command(body_velocity=[]).shape == (0,)


def test_gains_name_and_used_signals_are_those_of_law_and_update():
    law = seeing_filter()
    assert law.used == ["body_velocity"]
    assert looking().used == []
    assert law.for_speed(20.0) is law
    assert law.renamed("other").states == {"filtered": 0.0}
    slower = law.with_gains(rate=0.0)
    assert (slower.preview, slower.states, slower.gains) == ([0.5, 1.5], law.states, {"rate": 0.0})
    assert repr(law) == (
        "Strategy('both', c from 1000 to 30000 N s/m, rate=20, states={'filtered': 0.0}, "
        "preview=[0.5, 1.5] m)"
    )
    memory = run(slower).histories[0]["damping"] - run(law).histories[0]["damping"]
    assert np.abs(memory).max() > 100


def test_a_law_with_states_between_equal_bounds_is_a_constant_damper():
    law = Strategy("constant", lambda s, g: s.a, 7e3, 7e3, states={"a": 0.0},
                   update=lambda s, g: {"a": s.a})  # fmt: skip
    assert Damper(law).constant == 7e3
    road = bc.RoadProfile(X, ROADS[0])
    expected = bc.daf(BEAM, CAR, [SPEED], road, start=-4)
    assert np.array_equal(bc.daf(BEAM, CAR, [SPEED], road, start=-4, damper=law), expected)


@pytest.mark.parametrize("law", [filtered(), seeing_filter()], ids=lambda law: law.name)
def test_a_law_with_states_goes_through_the_front_door(law):
    road = bc.RoadProfile(X, ROADS[0])
    expected = run(law, [20.0, SPEED], ROADS[:1], record=["damping"])
    daf = bc.daf(BEAM, CAR, [20.0, SPEED], road, start=-4, damper=law)
    assert np.array_equal(daf, expected.daf[:, 0])
    response = bc.crossing_response(BEAM, CAR, SPEED, road, start=-4, damper=law)
    assert response.outputs["moment"].max() == pytest.approx(expected.daf[1, 0], abs=1e-3)


@pytest.mark.parametrize("law", [filtered(), seeing_filter()], ids=lambda law: law.name)
def test_a_ramp_surface_of_a_law_with_states_is_of_crossings_one_by_one(law):
    surface = bc.ramp_surface(
        BEAM, CAR, [SPEED], approach=2.0, ramp_height=5e-3, every=10, damper=law
    )
    x = -2 + 0.1 * np.arange(101)
    for k in (0, 10, 50):
        roads = [0 * x, -5e-3 * (np.arange(x.size) > k)]
        found = simulate_loop(BEAM, CAR, law, SPEED, x, roads).daf[0]
        expected = [surface.daf_smooth[0], surface.daf_unit[0, k]]
        assert found == pytest.approx(expected, abs=1e-7)
        assert abs(found[1] - found[0]) > 1e-3


@pytest.mark.slow
def test_laws_with_states_are_scored_and_told_apart_by_their_initial_values(tmp_path):
    """By a file that keeps the work, too; DAFs are those of the crossings one by one."""
    roads = [bc.RoadProfile(X, z, name=str(i)) for i, z in enumerate(ROADS)]
    for start in (0.01, 0.05):
        laws = [seeing_filter(), filtered(states={"filtered": start})]
        board = bc.score(laws, BEAM, CAR, roads, [SPEED], approach=4, workers=1,
                         resume=tmp_path / "kept.jsonl")  # fmt: skip
        expected = [run(law).daf[0] for law in laws]
        assert board.values["daf"][..., 0] == pytest.approx(np.array(expected), abs=1e-9)


# What is refused


@pytest.mark.parametrize(
    ("changed", "error", "message"),
    [
        ({"states": [0.0]}, TypeError, r"states must be a mapping, got \[0.0\]: .*states={"),
        ({"states": {"a b": 0.0}}, ValueError, "a state cannot be called 'a b': type a word"),
        ({"states": {3: 0.0}}, ValueError, "a state cannot be called 3"),
        ({"states": {"speed": 0.0}}, ValueError, "cannot be called 'speed'.*than those of signals"),
        ({"states": {"slope": 0.0}}, ValueError, "a state cannot be called 'slope'"),
        ({"states": {"c_max": 0.0}}, ValueError, "a state cannot be called 'c_max'"),
        ({"states": {"sample_time": 0.0}}, ValueError, "a state cannot be called 'sample_time'"),
        ({"states": {"ahead": 0.0}}, ValueError, "a state cannot be called 'ahead'"),
        ({"states": {"filtered": np.inf}}, ValueError, "state filtered must be finite, got inf"),
        ({"states": {"filtered": "0"}}, TypeError, "state filtered must be one number"),
        ({"update": None}, TypeError, r"update must be a function update\(s, g\).*got NoneType"),
        ({"update": {"filtered": 0}}, TypeError, "update must be a function .*got dict"),
        ({"states": {}}, ValueError, "update needs states that it gives: type .*states={"),
        ({"update": lambda s: {}}, TypeError, r"the update of filtered must be .*update\(s, g\)"),
        ({"update": lambda s, g: s.filtered}, ValueError,
         'next value of every state by name, got .*: type return {"filtered": ...}'),
        ({"update": lambda s, g: None}, ValueError, "the update of filtered .*got None"),
        ({"update": lambda s, g: {}}, ValueError, r"every state by name, got \[\]"),
        ({"update": lambda s, g: {"filtered": 0, "b": 1}}, ValueError, r"got \['filtered', 'b'\]"),
        ({"update": lambda s, g: {"filtered": None}}, ValueError,
         "update of filtered, for state filtered, must return one number or expression, got None"),
        ({"update": lambda s, g: {"filtered": "0"}}, ValueError, "must return one number"),
        ({"update": lambda s, g: {"filtered": ca.vertcat(s.speed, 1)}}, ValueError,
         r"for state filtered, must return one number, got \(2, 1\)"),
        ({"update": lambda s, g: {"filtered": s.low}}, ValueError,
         "update of filtered uses an unknown name .*'low'.*filtered, sample_time; gains: c_min"),
        ({"update": lambda s, g: {"filtered": g.low}}, ValueError, "unknown name .*'low'"),
        ({"update": lambda s, g: {"filtered": s.ahead[0]}}, ValueError, "s.ahead, preview=..."),
        ({"update": lambda s, g: {"filtered": 1 if s.filtered > 0 else 0}}, ValueError,
         "the update of filtered fails: .*ca.if_else"),
        ({"update": lambda s, g: {"filtered": float(s.filtered)}}, ValueError, r"no float\(\)"),
        ({"update": lambda s, g: {"filtered": ca.SX.sym("own")}}, ValueError,
         "the update of filtered has a symbol of its own"),
        ({"preview": 2.0}, ValueError, r"preview must have shape \(n,\).*type \[2\]"),
        ({"preview": [2.0, 2.0]}, ValueError, r"rise and are above 0 m, got \[2.0, 2.0\]: type"),
        ({"preview": [0.0, 2.0]}, ValueError, "preview must be distances ahead that rise"),
        ({"preview": [np.nan]}, ValueError, r"preview must be finite \[m\]"),
        ({"preview": ["2"]}, TypeError, "preview must be an array of numbers"),
    ],
)  # fmt: skip
def test_what_is_no_state_update_or_preview_is_told_with_what_to_type(changed, error, message):
    with pytest.raises(error, match=message):
        filtered(**changed)


@pytest.mark.parametrize(
    ("given", "error", "message"),
    [
        ({"low": 1.0}, ValueError, "unknown signal 'low', known: .*filtered, sample_time, ahead"),
        ({"filtered": np.nan}, ValueError, "filtered must be finite, got nan"),
        ({"filtered": "0"}, TypeError, "filtered must be an array of numbers"),
        ({"ahead": [1.0]}, ValueError, r"ahead must have 2 elevations in its last axis.*\(1,\)"),
        ({"ahead": 1.0}, ValueError, r"ahead must have 2 elevations in its last axis.*\(\)"),
        ({"ahead": np.zeros((3, 2)), "filtered": [1, 2]}, ValueError, r"filtered \(2,\), ahead"),
        ({"sample_time": 0.0}, ValueError, r"sample_time must be above 0 \[s\]"),
    ],
)
def test_what_a_command_is_given_by_the_wrong_name_or_shape_is_told(given, error, message):
    with pytest.raises(error, match=message):
        seeing_filter().command(**given)
    rows = np.zeros((len(SIGNALS), 3))
    with pytest.raises(error, match=message):
        seeing_filter().evaluate(rows, **given)


def test_a_state_that_is_no_number_any_more_is_told_where_it_arises():
    law = filtered(update=lambda s, g: {"filtered": s.body_velocity / s.axle_velocity})
    zeros = dict.fromkeys(SIGNALS, np.zeros((1, 1)))
    with pytest.raises(ValueError, match="the update of filtered returned NaN: guard divisions"):
        BatchLaw(law, [SPEED]).command(zeros, np.zeros((1, 1, 1)))


def test_a_law_must_have_the_same_states_at_every_speed():
    class Odd(Strategy):
        def for_speed(self, speed):
            return delayed(1 if speed < 25 else 2)

    odd = Odd("odd", lambda s, g: g.c_max, SOFT, STIFF)
    with pytest.raises(ValueError, match="odd must have the same states at every speed, and as"):
        BatchLaw(odd, [20.0, SPEED])


def test_a_block_is_told_its_sample_time_is_no_time():
    with pytest.raises(ValueError, match=r"sample_time must be above 0 \[s\]"):
        filtered().system(SPEED, sample_time=0.0)


def test_a_force_by_what_is_seen_ahead_is_warned_of():
    with pytest.warns(UserWarning, match="its sign with the motion, as a force"):
        Strategy("force", lambda s, g: 1e6 * s.ahead[0], SOFT, STIFF, preview=[1.0])
