"""Hopeless work is refused before it begins, with its cause; long work is announced."""

import dataclasses
import io
import warnings

import numpy as np
import pytest
from helpers import run_command

import bridgectl as bc
from bridgectl import _progress, _work
from bridgectl._progress import track
from bridgectl.dampers import Damper, passive, simulate_loop, skyhook
from bridgectl.dampers.actuator import bare_vehicle
from bridgectl.dampers.fitted import fitted
from bridgectl.dampers.loop.work import require_loop
from bridgectl.linear.estimates import require_crossing, require_surface
from bridgectl.linear.runs import prepare
from bridgectl.road import iso8608_elevations

SKYHOOK = skyhook(1e3, 30e3)
DENSE, STIFF = Damper(SKYHOOK, sample_time=1e-9), skyhook(1e3, 1e11)
ROADS = [bc.iso8608_profile("A", 35, seed=seed, start=-10) for seed in range(2)]
STATIONS = np.linspace(0, 25, 251)
SPEEDS = np.arange(50, 150.001, 0.01) / 3.6


def many_modes(n_modes=500):
    return bc.li2006.beam(n_modes=n_modes)


HOPELESS = {
    "surface, speeds": (
        lambda b, c: bc.ramp_surface(b, c, SPEEDS, approach=200), "10001 speeds; 7100 speeds would",
    ),
    "surface, modes": (
        lambda b, c: bc.ramp_surface(many_modes(), c, 25), "n_modes = 500; n_modes = 76 would do",
    ),
    "surface, ramps": (
        lambda b, c: bc.ramp_surface(b, c, 25, ramp_length=1e-6, ramp_height=1e-7),
        "ramp_length = 1e-06 m; ramp_length = 0.00015 m would do",
    ),
    "surface, approach": (
        lambda b, c: bc.ramp_surface(b, c, 25, approach=1e6), "approach = 1e+06 m; approach = 3",
    ),
    "surface, reference": (
        lambda b, c: bc.ramp_surface(b, c, SPEEDS[::5], method="control"), "2001 speeds",
    ),
    "daf, modes": (lambda b, c: bc.daf(many_modes(), c, 25), "n_modes = 500; n_modes = 80 would"),
    "daf, start": (lambda b, c: bc.daf(b, c, 25, start=-1e6), "start = -1e+06 m; start = -3"),
    "daf, speed": (
        lambda b, c: bc.daf(b, c, 1e-4), "a speed of 0.0001 m/s; a speed of 0.0086 m/s would do",
    ),
    "daf, damping": (
        lambda b, c: bc.daf(b, dataclasses.replace(c, tire_stiffness=1e14), 25),
        "stiffnesses, damping and masses",
    ),
    "daf, sampling": (
        lambda b, c: bc.daf(b, c, 25, damper=DENSE), "sample_time = 1e-09 s; sample_time = 9",
    ),
    "response, modes": (
        lambda b, c: bc.crossing_response(many_modes(150), c, 25), "n_modes = 150; n_modes = 50 ",
    ),
    "response, tail": (
        lambda b, c: bc.crossing_response(b, c, 25, tail=1e6), "tail = 1e+06 s; tail = 3",
    ),
    "response, damper": (
        lambda b, c: bc.crossing_response(b, c, 25, damper=STIFF), "c_max = 1e+11 N s/m; c_max = ",
    ),
    "loop, roads": (
        lambda b, c: simulate_loop(
            b, c, SKYHOOK, np.linspace(10, 40, 1000), STATIONS,
            np.broadcast_to(0.0, (10**5, 251)), record=["tire_force"],
        ),
        "100000 roads",
    ),
    "score, sampling": (
        lambda b, c: bc.score([DENSE], b, c, ROADS, 25, approach=10), "sample_time = 1e-09 s",
    ),
    "score, damper": (
        lambda b, c: bc.score([passive(7e3), STIFF], b, c, ROADS, 25, approach=10), "c_max = 1e+11",
    ),
    "surface with a damper": (
        lambda b, c: bc.ramp_surface(b, c, 25, damper=DENSE), "sample_time = 1e-09 s",
    ),
    "road, step": (
        lambda b, c: bc.iso8608_profile("A", 225, step=1e-9), "step = 1e-09 m; step = ",
    ),
    "road, band": (
        lambda b, c: bc.iso8608_profile("A", 225, band=(1e-12, 4)), "a longest wave, 1 / band[0], ",
    ),
    "roads": (lambda b, c: iso8608_elevations(10**7, "A", 225), "n_roads = 1e+07; n_roads = "),
}  # fmt: skip


@pytest.mark.quick_cases(1)
@pytest.mark.filterwarnings("ignore:the axle moves at", "ignore:damper .* is a rigid link")
@pytest.mark.parametrize("case", HOPELESS)
def test_hopeless_work_is_refused_at_once_with_its_cause_and_what_would_do(bridge, truck, case):
    call, says = HOPELESS[case]
    with pytest.raises(ValueError, match="this would take about") as caught:
        call(bridge, truck)
    assert says in str(caught.value)
    assert "would do" in str(caught.value)


def test_what_would_do_does(truck):
    """The estimate of the value that is offered is within the limits, and not far from them."""
    for n_modes, done in ((80, True), (90, False)):
        run = prepare(bc.Crossing(many_modes(n_modes), truck), None, 0.0)
        if done:
            require_crossing(run, np.array([25.0]))
        else:
            with pytest.raises(ValueError, match="n_modes = 90; n_modes = 8"):
                require_crossing(run, np.array([25.0]))


def test_what_studies_need_is_not_refused_and_takes_no_word(truck):
    """The README's benchmarks, 20 modes, a thousand roads, crawling: all within the limits."""
    speeds = np.linspace(50, 150, 101) / 3.6
    for beam in (bc.li2006.beam(), many_modes(20)):
        crossing = bc.Crossing(beam, truck)
        require_crossing(prepare(crossing, None, -200.0), speeds)
        require_surface(crossing, speeds, 200.0, 0.1, "propagator")
    crossing = bc.Crossing(bc.li2006.beam(43), truck)
    run = prepare(crossing, None, 0.0)
    require_crossing(run, np.array([0.03, 1 / 3.6]))
    stations = -60 + 0.1 * np.arange(851)
    bare = bc.Crossing(bc.li2006.beam(), bare_vehicle(truck))
    require_loop(
        bare, [fitted(SKYHOOK, truck)] * 20, speeds[::10], stations, 1000, n_ramps=850,
        n_recorded=3, at_once=50, announced=False,
    )  # fmt: skip


def test_long_work_is_announced_with_the_callers_line():
    long = {"n": _work.at_most(4000.0, 10.0, "m")}
    with pytest.warns(UserWarning, match="about 67 minutes on one core.*n = 4000 m") as told:
        _work.require_feasible(lambda n: _work.Work(1e6, n), long)
    assert told[0].filename == __file__
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        _work.require_feasible(lambda n: _work.Work(1e6, n), long, announced=False)


def test_where_no_single_argument_is_the_cause_one_is_named_all_the_same():
    given = {"a": _work.at_most(1e3, 1e3), "b": _work.at_least(1e-3, 1e-3)}
    with pytest.raises(ValueError, match=r"800 GB of memory, 3 days.*cause is .*ask for less"):
        _work.require_feasible(lambda a, b: _work.Work(8e11, 260_000.0), given)


@pytest.mark.parametrize(
    ("command", "says"),
    [
        (["dae", "--speeds", "50:150:0.01"], "the cause is 10001 speeds"),
        (["dae", "--modes", "500"], "the cause is n_modes = 500"),
        (["dae", "--tire-stiffness", "1e18", "--speeds", "20"], "the vehicle's fastest motion"),
        (["score", "--sample-time", "1e-7"], "the cause is sample_time = 1e-07 s"),
        (["score", "--c-max", "1e11"], "the cause is c_max = 1e+11 N s/m"),
        (["score", "--random", "10000000"], "the cause is --random = 1e+07"),
    ],
)
@pytest.mark.filterwarnings("ignore::bridgectl.PlausibilityWarning")
def test_the_command_line_refuses_hopeless_work_in_a_line(capsys, command, says):
    status, out, err = run_command(capsys, *command)
    assert (status, out) == (2, "")
    assert err.splitlines()[-1].startswith("bridgectl: error: this would take about")
    assert says in err


def test_where_memory_runs_out_all_the_same_the_advice_is_of_the_estimate(
    capsys, monkeypatch, bridge, truck
):
    def too_large(*args, **kwargs):
        require_surface(bc.Crossing(bridge, truck), np.full(3000, 25.0), 10.0, 0.1, "propagator")
        raise MemoryError

    monkeypatch.setattr(bc, "ramp_surface", too_large)
    status, _, err = run_command(capsys, "dae", "--approach", "10", "--speeds", "80")
    assert status == 2
    assert err == (
        "bridgectl: error: not enough memory: the cause is 3000 speeds: change it, or ask for "
        "less at once\n"
    )
    monkeypatch.setattr(_work, "_latest", [])
    assert _work.memory_advice() == "not enough memory: ask for less at once"


class Terminal(io.StringIO):
    def isatty(self):
        return True


@pytest.mark.parametrize(("item_takes", "bar"), [(0.0, False), (1.5, True)])
def test_work_of_more_than_two_seconds_shows_progress(monkeypatch, item_takes, bar):
    now = iter(np.arange(100) * item_takes)
    monkeypatch.setattr(_progress, "monotonic", lambda: next(now))
    monkeypatch.setattr("sys.stderr", terminal := Terminal())
    assert list(track(range(5), "Counting", 5)) == [0, 1, 2, 3, 4]
    assert ("Counting" in terminal.getvalue()) is bar
