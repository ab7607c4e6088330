"""Strategies behind sensors: what the filters estimate, and that they are the same everywhere."""

from dataclasses import replace

import casadi as ca
import control as ct
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.linalg import expm

import bridgectl as bc
from bridgectl.dampers import (
    SIGNALS,
    Damper,
    Sensors,
    Strategy,
    add,
    bridgehook,
    continuous_skyhook,
    groundhook,
    library,
    measured,
    passive,
    preset,
    simulate_loop,
    skyhook,
    tire_groundhook,
)
from bridgectl.dampers.block import CROSSING_OUTPUTS
from bridgectl.dampers.loop.batch_law import BatchLaw
from bridgectl.dampers.lqr import regulator
from bridgectl.dampers.passive_theory import white_velocity
from bridgectl.dampers.sensors import estimates, exact, moved, states_of
from bridgectl.road import iso8608_elevations

BEAM, TRUCK = bc.li2006.beam(), bc.li2006.car()
SOFT, STIFF, TIME = 1e3, 30e3, 2e-3
X = -20 + 0.1 * np.arange(451)
SPEEDS = np.array([22.0, 30.0])
FILTERS = {
    "accelerometers": Sensors.accelerometers(),
    "complementary": Sensors.complementary(),
    "kalman": Sensors.kalman(TRUCK),
}
HOOK = bridgehook(BEAM, TRUCK, SOFT, STIFF)
EARLY = bridgehook(BEAM, TRUCK, SOFT, STIFF, lag=0.01)
MOTION = [*SIGNALS[:-2], "damping"]


@pytest.fixture(scope="module")
def roads():
    return iso8608_elevations(3, "B", 45, seed=4)


def stepped(law, history, speed, start=X[0]):
    """Commands of a law, sample by sample in CasADi, for what was measured of one crossing."""
    own = law.for_speed(speed)
    states, commands = np.array([[value] for value in own.states.values()]), []
    for k in range(history["damping"].shape[1]):
        told = {name: history[name][0, k] for name in MOTION if name != "damping"}
        told |= {"position": start + speed * TIME * k, "speed": speed}
        signals = np.array([[told[name]] for name in SIGNALS])
        gains = np.reshape([*own.gains.values()], (-1, 1))
        c, states = (np.array(v) for v in own.function(signals, gains, states, TIME, []))
        commands.append(c[0, 0])
    return np.array(commands)


def response(sensors, rates):
    """From inputs to estimates at frequencies [rad/s], (frequencies, p, m)."""
    n = len(sensors.state_matrix)
    return np.array([
        sensors.output_matrix
        @ np.linalg.solve(1j * w * np.eye(n) - sensors.state_matrix, sensors.input_matrix)
        for w in rates
    ])  # fmt: skip


# The filters


@given(st.integers(0, 200), st.sampled_from([1e-4, 2e-3, 0.05]))
def test_a_filter_moves_exactly_over_any_sample_time(seed, time):
    """Against the exponential of a matrix; every second one has an integrator in it."""
    rng = np.random.default_rng(seed)
    a, b = rng.normal(0, 3, (4, 4)), rng.normal(0, 1, (4, 2))
    if seed % 2:
        a[:, 0] = 0.0
    whole = expm(time * np.block([[a, b], [np.zeros((2, 6))]]))
    grown, held = (np.array(ca.evalf(matrix)) for matrix in exact(a, b, time))
    assert grown == pytest.approx(whole[:4, :4], abs=1e-11)
    assert held == pytest.approx(whole[:4, 4:], abs=1e-11)


RATES = np.geomspace(0.01, 300, 40)
LEAK = 1j * RATES / (1j * RATES + 0.5)


def test_an_accelerometer_tells_a_velocity_above_its_corner():
    """At w [rad/s] the share i w / (i w + corner) of it: 1.2 % off where a body bounces fast."""
    found = response(FILTERS["accelerometers"], RATES)
    body = found[:, 0, 0] * 1j * RATES
    assert body == pytest.approx(LEAK, abs=1e-12)
    assert found[:, 2, 0] == pytest.approx(found[:, 0, 0], abs=1e-12)
    assert found[:, 2, 1] == pytest.approx(-found[:, 1, 1], abs=1e-12)


def test_the_halves_of_a_complementary_filter_are_one_suspension_velocity():
    """From what fits together, v, at each frequency: acceleration i w v and travel v / (i w)."""
    found = response(FILTERS["complementary"], RATES)
    of_body = found[..., 0] * 1j * RATES[:, None]
    of_travel = found[..., 2] / (1j * RATES[:, None])
    assert of_body[:, 2] + of_travel[:, 2] == pytest.approx(1.0, abs=1e-10)
    assert of_body[:, 0] == pytest.approx(LEAK, abs=1e-12)
    assert found[..., 2, :] == pytest.approx(found[..., 0, :] - found[..., 1, :], abs=1e-12)


def test_a_drift_of_an_accelerometer_moves_no_suspension_velocity_for_long():
    steady = response(FILTERS["complementary"], [1e-9])[0].real
    assert abs(steady[2, 0]) < 1e-9 + 1.5 / 12  # [m/s] per m/s^2: sqrt(2) over the crossover
    assert steady[0, 0] == pytest.approx(2.0, abs=1e-9)


def filtered(sensors, measurements, dampings, start=(0.0,) * 4):
    """Estimates by name, each (samples,), of measurements (m, samples) and dampings [N s/m]."""
    x, m, c = (
        ca.SX.sym("x", len(states_of(sensors))),
        ca.SX.sym("m", len(measurements)),
        ca.SX.sym("c"),
    )
    told = ca.vertcat(*estimates(sensors, x).values())
    step = ca.Function("step", [x, m, c], [moved(sensors, x, m, c, TIME), told])
    state, found = np.append(start, dampings[0]), []
    for k, damping in enumerate(dampings):
        state, now = step(state, measurements[:, k], damping)
        found.append(np.array(now)[:, 0])
    return dict(zip(sensors.outputs, np.transpose(found), strict=True))


def nominal():
    """A of the quarter-car with the damping that the Kalman filter was made for, and n."""
    problem, row = regulator(TRUCK), np.array([0.0, 1.0, 0.0, -1.0])
    return problem, problem.state_matrix + FILTERS["kalman"].model.damping * np.outer(
        problem.input_matrix, row
    )


@pytest.mark.slow
def test_a_kalman_filter_errs_as_its_covariance_says():
    """On eight roads of class A, with its own noise and damping: within 8 % of the standard
    deviations of tire force and axle velocity that the Riccati equation gives, 1.7 kN and 15 mm/s,
    three standard errors of what lasts for a tenth of a second on 80 s of road. (Errors of the body
    last for seconds, too long to tell.)
    """
    sensors, (_, a) = FILTERS["kalman"], nominal()
    _, covariance, _ = ct.lqe(
        a, [[0.0], [0], [-1], [0]], [a[1], [1.0, 0, 0, 0]], [[white_velocity("A", 25.0)]],
        TIME * np.diag([0.05**2, 0.5e-3**2]),
    )  # fmt: skip
    x, roads = -300 + 0.1 * np.arange(3251), iso8608_elevations(8, "A", 325, seed=1)
    damper = Damper(
        passive(sensors.model.damping), acceleration_noise=0.05, travel_noise=0.5e-3, max_force=1e9
    )
    (found,) = simulate_loop(BEAM, TRUCK, damper, 25.0, x, roads, record=MOTION).histories
    deviations = {
        "tire_force": TRUCK.tire_stiffness * np.sqrt(covariance[2, 2]),
        "axle_velocity": np.sqrt(covariance[3, 3]),
    }
    squares = dict.fromkeys(deviations, 0.0)
    for road in range(8):
        measurements = np.array([found[name][road] for name in sensors.inputs])
        told = filtered(sensors, measurements, found["damping"][road])
        for name in deviations:
            error = (told[name] - found[name][road])[1000:6000]  # from 50 m on to the bridge
            squares[name] += np.mean(error**2) / 8
    for name, expected in deviations.items():
        assert np.sqrt(squares[name]) == pytest.approx(expected, rel=0.08)


@pytest.mark.parametrize("damping", [SOFT, STIFF])
def test_a_kalman_filter_knows_the_damping_that_it_commands(damping):
    """A truck let go on a level road with an axle velocity of 0.5 m/s, which it knows: 5 mm/s are
    of the force that is held over a sample; without the knowledge it is ten times as wrong."""
    sensors, (problem, _) = FILTERS["kalman"], nominal()
    a = problem.state_matrix + damping * np.outer(problem.input_matrix, [0.0, 1, 0, -1])
    step, states = expm(TIME * a), [np.array([0.0, 0.0, 0.0, 0.5])]
    for _ in range(499):
        states.append(step @ states[-1])
    true = np.transpose(states)
    measurements, dampings = np.array([a[1] @ true, true[0]]), np.full(500, damping)
    error, other = (
        np.abs(filtered(sensors, measurements, told, true[:, 0])["axle_velocity"] - true[3]).max()
        for told in (dampings, np.full(500, sensors.model.damping))
    )
    assert error < 5e-3
    assert other > 0.05


# The strategies behind them


@pytest.mark.quick_cases(1)
@pytest.mark.parametrize("kind", FILTERS)
@pytest.mark.parametrize("law", [skyhook(SOFT, STIFF), groundhook(SOFT, STIFF), HOOK])
def test_a_strategy_behind_sensors_is_the_same_in_batch_as_in_casadi(roads, kind, law):
    behind = measured(law, FILTERS[kind])
    damper = Damper(behind, acceleration_noise=0.05, travel_noise=0.5e-3)
    found = simulate_loop(BEAM, TRUCK, damper, SPEEDS, X, roads, record=MOTION)
    for speed, history in zip(SPEEDS, found.histories, strict=True):
        commands = stepped(behind, history, speed)
        assert commands == pytest.approx(history["damping"][0], abs=1e-6)  # [N s/m], of 30 000
        assert np.ptp(commands[: int(40 / speed / TIME)]) > 1e3
    assert BatchLaw(behind, [*SPEEDS]).steps is not None  # on arrays, not case by case


@pytest.mark.slow
def test_a_score_has_a_strategy_ideal_and_as_measured(roads):
    ideal = skyhook(SOFT, STIFF)
    behind = Damper(
        measured(ideal, FILTERS["complementary"]), acceleration_noise=0.05, travel_noise=1e-3
    )
    dampers = [passive(7e3), ideal, behind]
    road = bc.RoadProfile(X, roads[0])
    board = bc.score(dampers, BEAM, TRUCK, [road], 25.0, approach=20, workers=1)
    assert board.strategies[1:] == ("skyhook", "skyhook (complementary filter)")
    for damper, found in zip(dampers, board.values["daf"], strict=True):
        expected = simulate_loop(BEAM, TRUCK, damper, 25.0, X, roads[:1]).daf
        assert found == pytest.approx(expected, abs=1e-9)


@pytest.mark.parametrize("kind", FILTERS)
def test_as_a_block_it_commands_the_same_and_moves_its_states_the_same(kind):
    """For the same signals and states; x' = (x+ - x) / T of the states that a sample leads to."""
    law, rng = measured(skyhook(SOFT, STIFF), FILTERS[kind]), np.random.default_rng(0)
    block = law.system(25.0, sample_time=TIME)
    assert {"y_s_ddot"} <= {*block.input_labels} <= {*CROSSING_OUTPUTS.values()}
    names = {output: name for name, output in CROSSING_OUTPUTS.items()}
    for _ in range(20):
        u, x = rng.normal(0, 1, block.ninputs), rng.normal(0, 0.1, block.nstates)
        told = dict(zip((names[label] for label in block.input_labels), u, strict=True))
        states = dict(zip(block.state_labels, x, strict=True))
        c = law.command(**told, **states, position=25.0 * 0.1, speed=25.0)
        force, damping = block.output(0.1, x, u)
        assert damping == pytest.approx(float(c), abs=1e-9)
        assert force == pytest.approx(float(c) * told["suspension_velocity"], abs=1e-9)
        signals = [told.get(name, 0.0) for name in SIGNALS[:-2]] + [2.5, 25.0]
        _, after = law.function(signals, [*law.gains.values()], x, TIME, [])
        assert block.dynamics(0.1, x, u) == pytest.approx(
            (np.array(after)[:, 0] - x) / TIME, abs=1e-9
        )


@pytest.mark.slow
def test_in_the_loop_of_the_control_library_it_gives_the_dafs_of_samples():
    """With a quick sensor of its own between crossing and law; one is late by it, the other by its
    sample time, each a quarter of a millisecond: 1e-4 of the DAF."""
    law, speed = measured(continuous_skyhook(SOFT, STIFF), FILTERS["accelerometers"]), 25.0
    crossing = bc.crossing_system(BEAM, replace(TRUCK, damping=0.0), speed)
    rng = np.random.default_rng(0)
    x = -1 + 0.5 * np.arange(53)
    z = np.cumsum(rng.normal(0, 1e-3, x.size))
    late, block = 0.25e-3, law.system(speed, sample_time=0.25e-3)
    quick = ct.ss(
        -np.eye(2) / late, np.eye(2) / late, np.eye(2), 0, inputs=["y_s_ddot", "y_t_ddot"],
        outputs=["body", "axle"], name="sensor",
    )  # fmt: skip
    block.update_names(inputs=[
        {"y_s_ddot": "body", "y_t_ddot": "axle"}.get(label, label) for label in block.input_labels
    ])  # fmt: skip
    loop = ct.interconnect(
        [crossing, quick, block], inputs=["road"], outputs=["moment"], check_unused=False
    )
    t = np.linspace(x[0], x[-1], 1301) / speed
    found = ct.input_output_response(
        loop, x / speed, z[0] - z, 0, t_eval=t, solve_ivp_kwargs={"rtol": 1e-6, "max_step": 1e-3}
    )
    daf = found.outputs[(t >= 0) & (t * speed <= BEAM.length)].max()
    damper = Damper(law, sample_time=0.25e-3)
    assert simulate_loop(BEAM, TRUCK, damper, speed, x, z).daf[0, 0] == pytest.approx(daf, abs=1e-4)


def run(law, signals):
    """Commands of a law for signals by name, each (samples,), through a batch of one."""
    batch = BatchLaw(law, [25.0])
    memory, commands = batch.start(1, 1), []
    for k in range(len(next(iter(signals.values())))):
        now = {name: np.array([[signals[name][k] if name in signals else 0.0]]) for name in SIGNALS}
        c, memory = batch.command(now, memory)
        commands.append(c[0, 0])
    return np.array(commands)


TELLING = Strategy(
    "telling", lambda s, g: 5e3 + 1e3 * s.body_velocity + 10 * s.suspension_travel, 0, 1e6
)
NOISE = {name: np.random.default_rng(k).normal(0, 1, 40) for k, name in enumerate(SIGNALS)}


@pytest.mark.parametrize("late", [1, 5])
def test_a_late_velocity_is_that_of_some_samples_ago_and_before_that_0(late):
    behind = measured(TELLING, delays={"body_velocity": late})
    velocity = NOISE["body_velocity"]
    old = np.concatenate([np.zeros(late), velocity[:-late]])
    expected = run(TELLING, NOISE | {"body_velocity": old})
    assert run(behind, NOISE) == pytest.approx(expected, abs=1e-9)
    assert behind.name == "telling (delayed)"


def test_a_late_position_is_that_of_some_samples_ago_and_before_that_the_first():
    law = Strategy("place", lambda s, g: 5e3 + 1e3 * s.position, 0, 1e6)
    place = 0.05 * np.arange(40)
    old = np.concatenate([place[:1], place[:1], place[:-2]])
    behind = measured(law, delays={"position": 2})
    assert run(behind, {"position": place}) == pytest.approx(5e3 + 1e3 * old, abs=1e-9)


@pytest.mark.parametrize("late", [1, 5])
def test_a_late_command_is_that_of_some_samples_ago_and_before_that_the_first(late):
    behind = measured(TELLING, delays={"command": late}, name="slow")
    prompt = run(TELLING, NOISE)
    expected = np.concatenate([np.full(late, prompt[0]), prompt[:-late]])
    assert run(behind, NOISE) == pytest.approx(expected, abs=1e-9)
    assert behind.name == "slow"


def test_filters_hear_late_measurements_late():
    late = measured(
        skyhook(SOFT, STIFF), FILTERS["accelerometers"], delays={"body_acceleration": 3}
    )
    prompt = measured(skyhook(SOFT, STIFF), FILTERS["accelerometers"])
    before = NOISE["body_acceleration"]
    old = np.concatenate([np.zeros(3), before[:-3]])
    assert np.array_equal(run(late, NOISE), run(prompt, NOISE | {"body_acceleration": old}))


def test_a_law_with_states_keeps_them_behind_sensors():
    def law(s, g):
        return 5e3 + g.gain * s.low

    smooth = Strategy(
        "smooth", law, 0, 1e6, {"gain": (1e3, 0, 1e4)}, {"low": 0.5},
        lambda s, g: {"low": 0.9 * s.low + 0.1 * s.body_velocity},
    )  # fmt: skip
    behind = measured(smooth, delays={"body_velocity": 1}).with_gains(gain=2e3)
    velocity = NOISE["body_velocity"]
    old = np.concatenate([[0.0], velocity[:-1]])
    expected = run(smooth.with_gains(gain=2e3), {"body_velocity": old})
    assert run(behind, {"body_velocity": velocity}) == pytest.approx(expected, abs=1e-9)


def test_a_law_of_the_acceleration_is_a_block_once_its_measurement_is_late():
    with pytest.raises(ValueError, match=r"ADD .accelerometers. measures body_acceleration"):
        measured(add(SOFT, STIFF), FILTERS["accelerometers"]).system(25.0)
    late = measured(add(SOFT, STIFF), FILTERS["accelerometers"], delays={"body_acceleration": 1})
    assert "y_s_ddot" in late.system(25.0).input_labels


def test_a_law_for_each_speed_stays_one(tmp_path):
    behind = measured(HOOK, FILTERS["kalman"])
    signals = {"position": 3.0, "body_acceleration": 0.1, "filter_4": 0.2}
    at = behind.for_speed(25.0)
    assert behind.for_speed(25.0) is at
    assert behind.command(speed=25.0, **signals) == at.command(speed=25.0, **signals)
    for call in (behind.command, lambda: behind.command(speed=[20.0, 25.0])):
        with pytest.raises(ValueError, match="a law for each speed: type for example command"):
            call()
    with pytest.raises(ValueError, match=r"type for example law\.for_speed"):
        behind.to_c(tmp_path / "law.c")
    assert "filter" not in behind.for_speed(25.0).to_c(tmp_path / "law.c").name
    assert measured(skyhook(SOFT, STIFF), FILTERS["kalman"]).to_c(tmp_path / "sky.c").stat().st_size


@pytest.mark.slow
def test_constant_and_preset_dampers_stay_what_they_are_behind_sensors(roads):
    still = measured(passive(7e3), FILTERS["accelerometers"])
    assert Damper(still).constant == 7e3
    chosen, behind = preset(SOFT, STIFF), measured(preset(SOFT, STIFF), FILTERS["accelerometers"])
    assert np.array_equal(Damper(behind).kept, Damper(chosen).kept)
    one, other = (simulate_loop(BEAM, TRUCK, law, 25.0, X, roads).daf for law in (chosen, behind))
    assert one == pytest.approx(other, abs=1e-12)


def test_the_kalman_filter_serves_every_strategy_of_the_library():
    for law in library(BEAM, TRUCK, SOFT, STIFF):
        assert measured(law, FILTERS["kalman"]).used is not None


@pytest.mark.parametrize(
    ("call", "error", "says"),
    [
        (lambda: measured(7e3, FILTERS["kalman"]), TypeError, "strategy must be a Strategy, got"),
        (lambda: measured(HOOK, "kalman"), TypeError, "sensors must be Sensors, got str: type"),
        (lambda: measured(EARLY, FILTERS["kalman"]).for_speed(25.0), ValueError,
         "bridgehook measures axle_acceleration, of which Kalman filter tell nothing, but of"),
        (lambda: measured(HOOK), ValueError, "measured needs sensors, or delays: type for"),
        (lambda: measured(HOOK, delays={}), ValueError, "measured needs sensors, or delays"),
        (lambda: measured(HOOK, delays=3), TypeError, "delays must be a mapping, got 3: type"),
        (lambda: measured(HOOK, delays={"speed": 0}), ValueError, "delays.*speed.* 1 or more"),
        (lambda: measured(HOOK, delays={"spede": 1}), ValueError, "has 'spede', which is not me"),
        (lambda: measured(HOOK, FILTERS["kalman"], delays={"axle_velocity": 1}), ValueError,
         "has 'axle_velocity', which is not measured; what is: body_acceleration"),
        (lambda: measured(tire_groundhook(SOFT, STIFF), FILTERS["complementary"]), ValueError,
         "tire groundhook measures tire_force_rate, of which complementary filter tell nothing"),
        (lambda: measured(measured(HOOK, FILTERS["kalman"]).for_speed(25.0), FILTERS["kalman"]),
         ValueError, "has a state 'filter_1' already: put all"),
        (lambda: Sensors.kalman(bc.convoy([TRUCK], [0])), TypeError, "must be a QuarterCar"),
    ],
)  # fmt: skip
def test_what_cannot_be_measured_is_told(call, error, says):
    with pytest.raises(error, match=says):
        call()


def test_sensors_of_ones_own_are_a_filter(roads):
    """A travel sensor whose rate is the travel less what it was, over 20 ms."""
    lag = 0.02
    own = Sensors(
        "rate", ("suspension_travel",), ("suspension_velocity",), np.array([[-1 / lag]]),
        np.array([[1 / lag]]), np.array([[1.0]]), np.zeros(1),
    )  # fmt: skip
    law = Strategy("stiffer", lambda s, g: 1e3 + 1e5 * ca.fabs(s.suspension_velocity), SOFT, STIFF)
    travel = {"suspension_travel": np.full(40, 0.1)}
    expected = 1e3 + 1e5 * 0.1 * (1 - np.exp(-np.arange(40) * TIME / lag))
    assert run(measured(law, own), travel) == pytest.approx(expected, abs=1e-8)
