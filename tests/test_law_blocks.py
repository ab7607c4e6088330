"""Laws as blocks of the control library: which can be, and that they are the same laws."""

import dataclasses

import casadi as ca
import control as ct
import numpy as np
import pytest

import bridgectl as bc
from bridgectl import dampers
from bridgectl.dampers import Damper, Strategy, simulate_loop

SOFT, STIFF, SPEED = 1e3, 30e3, 30.0
BEAM = bc.Beam(8.0, 15e3, 15e3 * (2 * np.pi * 7) ** 2 * (8.0 / np.pi) ** 4, 2, 0.02)
CAR = bc.QuarterCar(8e3, 800.0, 1.5e5, 1.8e6, 7e3)
X = -1 + 0.5 * np.arange(19)
Z = np.cumsum(np.random.default_rng(0).normal(0, 1e-3, X.size))
LAWS = {law.name: law for law in dampers.library(BEAM, CAR, SOFT, STIFF)}
LAWS["program"] = dampers.program([0, 3, 6], [7e3, STIFF, SOFT])
LAWS["program of lines"] = dampers.program([0, 3, 6], [7e3, STIFF, SOFT], shape="lines")
RATES = ("tire groundhook", "selective groundhook")
"""Laws on the rate of the tire force."""

SAMPLED = {"ADD": "body_acceleration", "SH-ADD": "body_acceleration"}
"""Laws that need a sample time, and what they measure."""


def closed(law, **options):
    """The law in the loop around a crossing of the bridge."""
    crossing = bc.crossing_system(BEAM, dataclasses.replace(CAR, damping=0.0), SPEED)
    return ct.interconnect(
        [crossing, law.system(SPEED, **options)], inputs=["road"], outputs=["moment", "damping"],
        check_unused=False,
    )  # fmt: skip


def daf_of_blocks(law, method="RK45", rtol=1e-6, atol=1e-9, max_step=4e-3, **options):
    t, loop = np.linspace(X[0], X[-1], 1801) / SPEED, closed(law, **options)
    at_rest = [CAR.linear.static_loads[0] * name.endswith("force") for name in loop.state_labels]
    found = ct.input_output_response(
        loop, X / SPEED, Z[0] - Z, at_rest, t_eval=t, solve_ivp_method=method,
        solve_ivp_kwargs={"rtol": rtol, "atol": atol, "max_step": max_step},
    )  # fmt: skip
    return float(np.max(found.outputs[0][t * SPEED <= BEAM.length]))


def daf_of_samples(law, sample_time):
    damper = Damper(law, sample_time=sample_time)
    return simulate_loop(BEAM, CAR, damper, SPEED, X, Z).daf[0, 0]


@pytest.mark.parametrize(
    "name",
    [
        pytest.param(name, marks=pytest.mark.slow)
        for name in LAWS
        if name not in {*SAMPLED, *RATES, "preset", "skyhook"}
    ],
)
def test_a_block_of_the_control_library_is_the_law_with_a_small_sample_time(name):
    """A sampled law is late by up to a sample. That is worth up to 6e-5 of the DAF at the usual
    2 ms, and at 0.25 ms below 2e-5; the grid of moments holds the peak within 2e-6.
    """
    law = LAWS[name]
    assert daf_of_samples(law, 0.25e-3) == pytest.approx(daf_of_blocks(law), abs=2e-5)


@pytest.mark.slow
@pytest.mark.parametrize("name", RATES)
def test_a_law_on_the_rate_of_the_tire_force_is_a_block_with_a_filter(name):
    """It switches as late as a filter and a sample are, each half a millisecond: 1.5e-4."""
    found = daf_of_blocks(LAWS[name], "RK23", 1e-4, 1e-4, max_step=1e-3, rate_time=0.5e-3)
    assert daf_of_samples(LAWS[name], 0.5e-3) == pytest.approx(found, abs=1.5e-4)


def test_the_filter_of_a_block_gives_the_rate_of_a_steady_change():
    """Of R = 100 kN + 2 MN/s t, after many time constants: the command of that rate."""
    law = Strategy("rate", lambda s, g: ca.fabs(s.tire_force_rate) / 400, SOFT, STIFF)
    t = np.linspace(0, 0.05, 501)
    forces = np.vstack([np.zeros((4, t.size)), 100e3 + 2e6 * t])
    block = law.system(SPEED, rate_time=2e-3)
    found = ct.input_output_response(block, t, forces, [100e3], solve_ivp_kwargs={"rtol": 1e-8})
    assert found.outputs[1][-1] == pytest.approx(2e6 / 400, rel=1e-6)
    with pytest.raises(ValueError, match="rate_time must be above 0"):
        law.system(SPEED, rate_time=0.0)


@pytest.mark.slow
def test_skyhook_as_a_block_slides_along_a_body_at_rest():
    """The body stops where stiff and soft drive it to and fro: the solver's steps of a
    millisecond, not its tolerance, then say how long a damping is held: 3e-5 of the DAF.
    """
    found = daf_of_blocks(LAWS["skyhook"], "RK23", rtol=1e-3, atol=1e-3, max_step=1e-3)
    assert daf_of_samples(LAWS["skyhook"], 1e-3) == pytest.approx(found, abs=3e-5)


@pytest.mark.slow
def test_the_sampled_law_comes_to_the_block_as_its_sample_time_is_halved():
    """The error falls with the sample time: by a factor of 1.4 or more at each halving."""
    law = LAWS["extended groundhook"]
    exact = daf_of_blocks(law)
    errors = [abs(daf_of_samples(law, 2e-3 / 2**k) - exact) for k in range(4)]
    assert errors[0] > 2e-5
    assert np.all(np.array(errors[1:]) < np.array(errors[:-1]) / 1.4)


def test_the_tire_force_of_a_crossing_is_no_matter_of_the_damper_force():
    """Nor are the motions that a block may measure, but accelerations are: +-1 MN changes them."""
    crossing = bc.crossing_system(BEAM, CAR, SPEED)
    state = np.random.default_rng(1).normal(0, 1e-3, crossing.nstates)
    outputs = [crossing.output(0.1, state, [1e-3, force]) for force in (-1e6, 1e6)]
    changed = {
        label for label, a, b in zip(crossing.output_labels, *outputs, strict=True) if a != b
    }
    assert changed == {"y_s_ddot", "y_t_ddot"}


@pytest.mark.parametrize("name", SAMPLED)
def test_a_law_that_needs_a_sample_time_is_refused_and_told_of_one(name):
    measured = SAMPLED[name]
    with pytest.raises(ValueError, match=f"{name} measures .*{measured}.*sample_time=2e-3"):
        LAWS[name].system(SPEED)


def test_every_signal_that_needs_a_sample_time_is_named():
    law = Strategy(
        "two",
        lambda s, g: ca.fabs(s.body_acceleration + s.axle_acceleration),
        SOFT, STIFF,
    )  # fmt: skip
    with pytest.raises(ValueError, match="two measures body_acceleration and axle_acceleration, "):
        law.system(SPEED)


def test_a_gain_of_zero_takes_a_signal_out_of_the_law():
    """The extended groundhook measures the rate of the tire force only with a tire damper."""
    law = LAWS["extended groundhook"]
    assert "tire_force_rate" not in law.used
    assert "tire_force" in law.used
    assert law.system(SPEED).nstates == 0
    assert law.with_gains(tire_damping=1e3).system(SPEED).state_labels == ["lagged_tire_force"]


def test_a_block_takes_the_tire_force_only_if_its_law_does():
    motion = ["y_s_dot", "y_t_dot", "suspension_travel", "suspension_velocity"]
    assert LAWS["skyhook"].system(SPEED).input_labels == motion
    assert LAWS["clipped LQR"].system(SPEED).input_labels == [*motion, "tire_force"]


def test_a_law_may_divide_by_the_tire_force():
    """Which no block knows when it is first asked for its output: all its inputs are 0 then."""
    law = Strategy("per load", lambda s, g: 7e8 / s.tire_force, SOFT, STIFF)
    weight = CAR.linear.static_loads[0]
    assert closed(law).output(-0.01, np.zeros(8), [0.0])[1] == pytest.approx(7e8 / weight)
    assert LAWS["clipped LQR"].system(SPEED).output(0.0, [], np.zeros(5))[1] == SOFT
    with pytest.raises(ValueError, match="per load returned infinity"):
        law.system(SPEED).output(0.0, [], [0, 0, 0, 0.1, 0])  # a tire in the air


@pytest.mark.parametrize("name", ["passive 16.5 kN s/m", "a.b", "-", "-x", "ümlaut [2]"])
def test_a_strategy_of_any_name_is_a_block(name):
    assert (
        closed(dampers.passive(16.5e3).renamed(name)).output(0.0, np.zeros(8), [0.0])[1] == 16.5e3
    )
