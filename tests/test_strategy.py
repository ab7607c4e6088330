"""Strategies: where each switches, what is refused, and the same law as a block and in C."""

import ctypes
import dataclasses
import shutil
import subprocess

import casadi as ca
import control as ct
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import bridgectl as bc
from bridgectl import dampers
from bridgectl.dampers import SIGNALS, Damper, Strategy
from bridgectl.dampers.actuator import bare_vehicle

SOFT, STIFF = 1e3, 30e3
LAWS = {
    law.name: law.for_speed(25.0)
    for law in dampers.library(bc.li2006.beam(), bc.li2006.car(), SOFT, STIFF)
}
LAWS["passive"] = LAWS.pop("passive 7 kN s/m")
LAWS["program"] = dampers.program([-10, 3, 20], [7e3, STIFF, SOFT])
LAWS["program of lines"] = dampers.program([-10, 3, 20], [7e3, STIFF, SOFT], shape="lines")
SET_BEFORE = {"passive", "preset", "program", "program of lines"}
"""Laws that measure no motion."""
finite = st.floats(-10, 10)


@pytest.mark.parametrize("name", LAWS)
@given(values=st.lists(finite, min_size=len(SIGNALS), max_size=len(SIGNALS)))
def test_every_command_is_within_its_bounds_whatever_is_measured(name, values):
    law = LAWS[name]
    c = float(law.command(**dict(zip(SIGNALS, values, strict=True))))
    assert law.c_min <= c <= law.c_max


@pytest.mark.parametrize("name", sorted(set(LAWS) - SET_BEFORE - {"bridgehook"}))
def test_without_suspension_velocity_a_law_is_soft(name):
    assert LAWS[name].command(body_velocity=1.0, axle_velocity=-1.0, body_acceleration=1.0) == SOFT


@pytest.mark.parametrize(
    ("law", "signal", "sign"),
    [("skyhook", "body_velocity", 1), ("groundhook", "axle_velocity", -1),
     ("ADD", "body_acceleration", 1)],
)  # fmt: skip
def test_an_on_off_law_is_stiff_where_its_signal_and_the_velocity_agree(law, signal, sign):
    measured, velocity = np.meshgrid([-0.3, 0.3], [-0.2, 0.2])
    found = LAWS[law].command(**{signal: measured, "suspension_velocity": velocity})
    assert np.array_equal(found, np.where(sign * measured * velocity > 0, STIFF, SOFT))


def test_sh_add_is_skyhook_for_slow_motion_and_add_for_fast():
    slow = {"body_velocity": 0.1, "body_acceleration": -0.3}  # 4.04 rad/s x 0.1 m/s = 0.404
    fast = {"body_velocity": 0.1, "body_acceleration": -0.5}
    assert LAWS["SH-ADD"].command(**slow, suspension_velocity=0.2) == STIFF
    assert LAWS["SH-ADD"].command(**fast, suspension_velocity=0.2) == SOFT


@pytest.mark.parametrize(
    ("body", "axle", "c"),
    [(0.1, -0.3, 11e3), (0.1, 0.3, 2e3), (-0.1, -0.3, 9e3), (-0.1, 0.3, SOFT)],
    ids=["both agree", "the sky agrees", "the ground agrees", "none agrees"],
)
def test_the_hybrid_takes_of_sky_and_ground_what_agrees_with_the_velocity(body, axle, c):
    """With b to both: F = b (share y_s' - (1 - share) y_t'), c = F / v."""
    law = dampers.hybrid(SOFT, STIFF, share=0.4, gain=10e3)
    for sign in (-1, 1):
        measured = {"body_velocity": sign * body, "axle_velocity": sign * axle}
        measured["suspension_velocity"] = sign * 0.2
        assert law.command(**measured) == pytest.approx(c, rel=1e-12)


@pytest.mark.parametrize("name", sorted(n for n, law in LAWS.items() if "dead_band" in law.gains))
def test_a_dead_band_is_one_metre_a_second_at_most(name):
    assert LAWS[name].with_gains(dead_band=1.0).gains["dead_band"] == 1.0
    with pytest.raises(ValueError, match=r"dead_band = 1\.1 is outside its bounds, 0 to 1"):
        LAWS[name].with_gains(dead_band=1.1)


def test_pdd_lets_neither_spring_nor_damper_drive_the_body():
    """Between its bounds the power of spring and damper is zero: K_s d v + c v^2 = 0."""
    v, travel = 0.1, -0.02
    c = float(LAWS["PDD"].command(suspension_travel=travel, suspension_velocity=v))
    assert 80e3 * travel * v + c * v**2 == pytest.approx(0, abs=1e-9)


def test_bridgehook_pushes_against_the_costate_and_rests_after_the_peak():
    """Without feedback; tests/test_bridgehook.py has the law with it."""
    beam, car = bc.li2006.beam(), bc.li2006.car()
    law = dampers.bridgehook(beam, car, SOFT, STIFF, feedback=False).for_speed(25.0)
    found = dampers.costate(beam, car, 25.0)
    inside = slice(2, -2)
    x, sigma = found.positions[inside], found.sigma[inside]
    clear = np.abs(sigma) > 1e-3 * np.abs(sigma).max()
    for v in (-0.1, 0.1):
        c = law.command(position=x[clear], suspension_velocity=v)
        assert np.array_equal(c, np.where(sigma[clear] * v < 0, STIFF, SOFT))
    assert law.command(position=[-80.0, 20.0], suspension_velocity=0.1) == pytest.approx([7e3, 7e3])


@pytest.mark.slow
def test_the_costate_is_what_a_small_force_changes_in_the_peak_moment(bridge, truck):
    """A pulse of 100 N over 10 mm at one place, through the control library."""
    speed, width, force = 25.0, 0.01, 100.0
    found = dampers.costate(bridge, truck, speed)
    top = found.positions[-1]
    crossing = bc.crossing_system(bridge, truck, speed)
    for place in (2.0, 6.0, 9.0, 11.5):
        x = np.unique(np.concatenate([np.linspace(0, top, 2001), place + width * np.arange(-2, 3)]))
        pulse = force * np.clip(2 - np.abs(x - place) / width, 0, 1)  # 3 widths long in the mean
        ends = [
            ct.input_output_response(
                crossing, x / speed, np.vstack([0 * x, f]), 0,
                solve_ivp_method="DOP853", solve_ivp_kwargs={"rtol": 1e-10, "atol": 1e-14},
            ).outputs[0][-1]
            for f in (pulse, 0 * x)
        ]  # fmt: skip
        impulse = np.trapezoid(pulse, x / speed)
        expected = np.interp(place, found.positions, found.sigma) * impulse
        assert ends[0] - ends[1] == pytest.approx(expected, rel=0.01, abs=1e-9)


# Dampers and the library


def test_a_damper_is_constant_if_its_strategy_keeps_one_damping_and_no_force_is_cut():
    assert Damper(dampers.passive(7e3)).constant == 7e3
    with pytest.warns(bc.PlausibilityWarning, match=r"for 0\.5 kN type 500"):
        assert Damper(dampers.passive(7e3), max_force=0.5).constant is None
    assert Damper(dampers.preset(SOFT, STIFF, n_dampings=2)).constant is None
    assert Damper(LAWS["skyhook"]).constant is None


def test_a_damper_takes_the_place_of_the_vehicles_own(truck):
    assert bare_vehicle(truck) == dataclasses.replace(truck, damping=0.0)


def test_the_librarys_bridgehook_is_for_the_bridge_the_vehicle_and_the_section(bridge, truck):
    hook = dampers.library(bridge, truck, SOFT, STIFF, section=0.3)[-1]
    assert (hook.beam, hook.vehicle, hook.effect) == (bridge, truck, bc.Moment(7.5))
    assert dampers.library(bridge, truck, SOFT, STIFF)[-1].effect.at == 12.5


def test_the_library_needs_a_damping_to_compare_with_however_small(bridge, truck):
    with pytest.warns(bc.PlausibilityWarning, match="damping = 1 N s/m"):
        least = dampers.library(bridge, dataclasses.replace(truck, damping=1.0), SOFT, STIFF)
    assert least[0].c_min == 1.0
    with pytest.raises(ValueError, match="vehicle must have a damping above 0"):
        dampers.library(bridge, dataclasses.replace(truck, damping=0.0), SOFT, STIFF)


# Your own law, as a block, and in C


def test_a_law_of_ones_own_takes_named_gains_and_they_can_be_changed():
    def law(s, g):
        return g.base + g.slope * ca.fabs(s.suspension_velocity)

    own = Strategy("own", law, SOFT, STIFF, {"base": (2e3, 0, 1e4), "slope": (1e4, 0, 1e6)})
    assert own.command(suspension_velocity=[0.0, 0.5, 10.0]) == pytest.approx([2e3, 7e3, STIFF])
    assert own.with_gains(base=3e3).command(suspension_velocity=0.0) == 3e3
    assert own.gains == {"base": 2e3, "slope": 1e4}
    assert "slope=10000" in repr(own)
    assert own.used == ["suspension_velocity"]


@pytest.mark.slow
def test_a_strategy_as_a_block_closes_the_loop_around_a_crossing(bridge, truck):
    """A constant damper through `interconnect` is the passive crossing."""
    bare = dataclasses.replace(truck, damping=0.0)
    crossing = bc.crossing_system(bridge, bare, 25.0)
    loop = ct.interconnect(
        [crossing, dampers.passive(7e3).system(25.0)], inputs=["road"], outputs=["moment"],
        check_unused=False,
    )  # fmt: skip
    t = np.linspace(0, 1, 501)
    options = {"solve_ivp_method": "DOP853", "solve_ivp_kwargs": {"rtol": 1e-9, "atol": 1e-12}}
    moment = ct.input_output_response(loop, t, 0 * t, 0, **options).outputs
    expected = bc.crossing_response(bridge, truck, 25.0, timepts=t).outputs["moment"]
    assert moment == pytest.approx(expected, abs=1e-7)


def test_a_law_of_accelerations_makes_no_block_without_delay():
    with pytest.raises(ValueError, match="ADD measures body_acceleration, which the damper force"):
        LAWS["ADD"].system(25.0)


@pytest.mark.skipif(shutil.which("cc") is None, reason="there is no C compiler")
@pytest.mark.parametrize("name", LAWS)
def test_the_c_export_is_the_law(name, tmp_path):
    law = LAWS[name]
    source = law.to_c(tmp_path / "damping.c")
    library = tmp_path / "damping.so"
    subprocess.run(["cc", "-O1", "-shared", "-fPIC", source, "-o", library, "-lm"], check=True)
    damping = ctypes.CDLL(str(library)).damping
    doubles = ctypes.POINTER(ctypes.c_double)
    rng = np.random.default_rng(0)
    signals = rng.normal(0, 1, (10_000, len(SIGNALS)))
    gains, out = np.array([*law.gains.values(), 0.0]), np.zeros(1)
    found = np.empty(len(signals))
    arguments = (doubles * 2)(signals.ctypes.data_as(doubles), gains.ctypes.data_as(doubles))
    results, work = (doubles * 1)(out.ctypes.data_as(doubles)), (ctypes.c_double * 1000)()
    for i, row in enumerate(signals):
        arguments[0] = row.ctypes.data_as(doubles)
        damping(arguments, results, None, work, 0)
        found[i] = out[0]
    expected = law.evaluate(signals.T)
    assert found == pytest.approx(expected, rel=1e-12)


NAMES = ["my law.c", "a-b.c", "2nd.law.c", "dämpfung ☂.c", "int.c", "with (brackets).c"]


@pytest.mark.skipif(shutil.which("gcc") is None, reason="there is no gcc")
@pytest.mark.parametrize("name", NAMES)
def test_a_c_file_of_any_name_compiles_and_gives_the_same_numbers(name, tmp_path):
    """CasADi makes names in C of that of its file; a string and a Path do alike."""
    law = LAWS["continuous skyhook"]
    for path in (tmp_path / name, str(tmp_path / name)):
        assert law.to_c(path) == tmp_path / name
    damping = compiled(tmp_path / name, tmp_path / "law.so", "gcc")
    v = {"body_velocity": 0.1, "suspension_velocity": 0.2}
    found = damping(np.array([v.get(signal, 0.0) for signal in SIGNALS]), [*law.gains.values()])
    assert found == float(law.command(**v)) == 15e3


@pytest.mark.skipif(shutil.which("cc") is None, reason="there is no C compiler")
def test_in_c_a_large_command_is_clipped_and_what_is_no_number_stays_so(tmp_path):
    law = Strategy("own", lambda s, g: (5e3 + s.body_velocity) / s.speed, SOFT, STIFF)
    damping = compiled(law.to_c(tmp_path / "own.c"), tmp_path / "own.so", "cc")
    signals = np.zeros(len(SIGNALS))
    for speed, body_velocity, expected in (
        (1e-9, 0.0, STIFF), (-1e-9, 0.0, SOFT), (0.0, 0.0, np.inf), (0.0, -5e3, np.nan)
    ):  # fmt: skip
        signals[SIGNALS.index("speed")] = speed
        signals[SIGNALS.index("body_velocity")] = body_velocity
        assert damping(signals, []) == pytest.approx(expected, nan_ok=True)


def compiled(source, library, compiler):
    """The function of an exported file, of signals and gains."""
    subprocess.run([compiler, "-O1", "-shared", "-fPIC", source, "-o", library, "-lm"], check=True)
    function = ctypes.CDLL(str(library)).damping
    doubles = ctypes.POINTER(ctypes.c_double)

    def damping(signals, gains):
        given = [(ctypes.c_double * (len(values) + 1))(*values) for values in (signals, gains)]
        out = (ctypes.c_double * 1)()
        arguments = (doubles * 2)(*(ctypes.cast(values, doubles) for values in given))
        results = (doubles * 1)(ctypes.cast(out, doubles))
        function(arguments, results, None, (ctypes.c_double * 1000)(), 0)
        return out[0]

    return damping


@pytest.mark.parametrize(
    ("path", "error", "message"),
    [
        ("law.txt", ValueError, r"path must end in \.c, got 'law.txt'"),
        (".c", ValueError, r"path must end in \.c"),
        (3, TypeError, "path must be a string or Path, got 3"),
        ("missing/law.c", FileNotFoundError, "missing/law.c"),
        ("folder.c", IsADirectoryError, "folder.c"),
    ],
)
def test_a_path_that_takes_no_c_file_is_named(path, error, message, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "folder.c").mkdir()
    with pytest.raises(error, match=message):
        LAWS["skyhook"].to_c(path)
    assert [file.name for file in tmp_path.iterdir()] == ["folder.c"]


# What is refused


@pytest.mark.parametrize(
    ("make", "error", "message"),
    [
        (lambda: Strategy("", lambda s, g: 0, 1, 2), TypeError, "name must be a string"),
        (lambda: Strategy("a", 3, 1, 2), TypeError, "law must be a function"),
        (lambda: dampers.skyhook(STIFF, SOFT), ValueError, "c_min must not exceed c_max"),
        (lambda: dampers.skyhook(-1, SOFT), ValueError, "c_min must be 0 or more"),
        (
            lambda: Strategy("a", lambda s, g: s.sped, 1, 2),
            ValueError,
            "unknown name .*'sped'",
        ),
        (lambda: Strategy("a", lambda s, g: g.k, 1, 2), ValueError, "gains: c_min, c_max"),
        (lambda: Strategy("a", lambda s, g: 1, 1, 2, {"k": 3}), TypeError, "gain k must be"),
        (lambda: Strategy("a", lambda s, g: 1, 1, 2, {"k": (3, 0, 1)}), ValueError, "k = 3 is out"),
        (lambda: LAWS["skyhook"].with_gains(x=1), ValueError, "no gain 'x', its gains: dead_band"),
        (lambda: LAWS["hybrid"].with_gains(share=2), ValueError, "share = 2 is outside its bounds"),
        (lambda: LAWS["skyhook"].command(velocity=1), ValueError, "unknown signal 'velocity'"),
        (
            lambda: LAWS["skyhook"].command(body_velocity=[[1.0], [1.0, 2.0]]),
            TypeError,
            "body_velocity must be an array of numbers",
        ),
        (lambda: LAWS["skyhook"].to_c("law.txt"), ValueError, r"path must end in \.c"),
        (lambda: Damper("skyhook"), TypeError, "strategy must be a Strategy"),
        (lambda: Damper(LAWS["skyhook"], sample_time=0), ValueError, "sample_time must be above 0"),
        (lambda: Damper(LAWS["skyhook"], lag=-1), ValueError, "lag must be 0 or more"),
        (lambda: Damper(LAWS["skyhook"], max_force=0), ValueError, "max_force must be above 0"),
        (lambda: dampers.passive(0), ValueError, "damping must be above 0"),
    ],
)
def test_each_mistake_is_named(make, error, message):
    with pytest.raises(error, match=message):
        make()


def test_a_law_that_returns_nan_is_told_to_guard_its_divisions():
    law = Strategy("careless", lambda s, g: s.body_velocity / s.suspension_velocity, 1, 2)
    with pytest.raises(ValueError, match="careless returned NaN: guard divisions"):
        law.command(body_velocity=0.0, suspension_velocity=0.0)


def test_a_law_of_several_numbers_is_refused():
    with pytest.raises(ValueError, match="must return one number"):
        Strategy("two", lambda s, g: ca.vertcat(1, 2), 1, 2)
