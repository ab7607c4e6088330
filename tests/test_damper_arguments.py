"""Every argument of what is public in `bridgectl.dampers`, given what it cannot be."""

import numpy as np
import pytest

import bridgectl as bc
from bridgectl import dampers
from bridgectl.dampers import Damper, Strategy, simulate_loop
from bridgectl.dampers.peak_value import peak_value

BEAM, CAR = bc.li2006.beam(), bc.li2006.car()
X, LEVEL = np.array([-1.0, 10.0, 25.0]), np.zeros(3)
LAW = dampers.skyhook(1e3, 30e3)
WRONG = ["20 kN", None, np.nan, -np.inf, 1j, True, [], {}, [1.0, "a"]]
BOUNDS = {"c_min": 1e3, "c_max": 30e3}
CASE = {"beam": BEAM, "vehicle": CAR}
CALLS = {
    "simulate_loop": (
        simulate_loop,
        CASE | {"damper": LAW, "speeds": 25.0, "stations": X, "elevations": LEVEL,
                "section": 0.5, "recovery": "exact"},
        {},
    ),
    "Damper": (
        Damper,
        {"strategy": LAW, "sample_time": 2e-3, "lag": 0.0, "max_force": 2e4,
         "velocity_noise": 0.0, "seed": 0, "position_error": -0.5, "position_deviation": 0.0,
         "acceleration_noise": 0.0, "travel_noise": 0.0, "position_drift": 0.01,
         "speed_error": -0.1, "preview_noise": 0.0, "preview_delay": 0.0},
        {},
    ),
    "Strategy": (Strategy, {"name": "own", "law": lambda s, g: 5e3, **BOUNDS},
                 {"name": ["20 kN"]}),
    "gains": (lambda gains: Strategy("own", lambda s, g: 5e3, **BOUNDS, gains=gains),
              {"gains": {}}, {"gains": [None, {}]}),
    "a gain": (lambda gain: Strategy("own", lambda s, g: 5e3, **BOUNDS, gains={"k": gain}),
               {"gain": (1, 0, 2)}, {}),
    "with_gains": (LAW.with_gains, {"dead_band": 0.1}, {}),
    "renamed": (LAW.renamed, {"name": "b"}, {"name": ["20 kN"]}),
    "command": (LAW.command, {"body_velocity": 0.1, "speed": 25.0},
                {"body_velocity": [[]], "speed": [[]]}),
    "evaluate": (LAW.evaluate, {"rows": np.zeros((10, 1)), "gains": np.zeros((1, 1))},
                 {"gains": [None]}),
    "system": (LAW.system, {"speed": 25.0}, {}),
    "to_c": (LAW.to_c, {"path": "law.c"}, {}),
    "clairvoyant": (
        dampers.clairvoyant,
        CASE | BOUNDS | {"speed": 25.0, "road": bc.RoadProfile(X, LEVEL), "start": 0.0,
                         "step": 0.1, "section": 0.5, "recovery": "exact", "ride": 1.0},
        {"ride": [None]},
    ),
    "damper_bound": (
        dampers.damper_bound,
        CASE | BOUNDS | {"speed": 25.0, "road": bc.RoadProfile(X, LEVEL), "free_from": 0.0,
                         "start": 0.0, "step": 0.1, "seconds": 10.0, "section": 0.5,
                         "recovery": "exact"},
        {},
    ),
    "program": (dampers.program, {"positions": [0.0], "dampings": [1e3], "shape": "steps"}, {}),
    "preset": (dampers.preset, BOUNDS | {"n_dampings": 3}, {}),
    "bridgehook": (dampers.bridgehook,
                   CASE | BOUNDS | {"section": 0.5, "feedback": True, "lag": 0.0,
                                     "position_deviation": 0.0},
                   {"feedback": [True]}),
    "rollout_hook": (dampers.rollout_hook,
                     CASE | BOUNDS | {"section": 0.5, "hold": 4e-3, "ride": 0.0,
                                       "travel": 0.0, "tire_force": 0.0}, {}),
    "preview_hook": (dampers.preview_hook,
                     CASE | BOUNDS | {"preview": 10.0, "section": 0.5, "hold": 4e-3,
                                       "ride": 0.0, "travel": 0.0, "tire_force": 0.0}, {}),
    "bridgehook's speed": (dampers.bridgehook(BEAM, CAR, 1e3, 30e3).for_speed, {"speed": 25.0}, {}),
    "bridgehook's block": (dampers.bridgehook(BEAM, CAR, 1e3, 30e3).system, {"speed": 25.0}, {}),
    "peak_value": (
        peak_value,
        CASE | BOUNDS | {"speed": 25.0, "section": 0.5, "reach": 10.0, "sharpness": 8.0,
                         "yield_speed": 0.1},
        {},
    ),
    "measured": (dampers.measured,
                 {"strategy": LAW, "sensors": dampers.Sensors.accelerometers(),
                  "delays": {"body_acceleration": 2}},
                 {"sensors": [None], "delays": [None, {}]}),
    "accelerometers": (dampers.Sensors.accelerometers, {"corner": 0.5}, {}),
    "complementary": (dampers.Sensors.complementary, {"corner": 0.5, "crossover": 10.0}, {}),
    "kalman": (dampers.Sensors.kalman,
               {"vehicle": CAR, "acceleration_noise": 0.1, "travel_noise": 1e-3, "roughness": "A",
                "speed": 25.0, "sample_time": 2e-3}, {}),
    "costate": (dampers.costate, CASE | {"speed": 25.0, "section": 0.5, "reach": 10.0}, {}),
    "library": (dampers.library, CASE | BOUNDS | {"section": 0.5}, {}),
    "passive": (dampers.passive, {"damping": 7e3}, {}),
    "skyhook": (dampers.skyhook, BOUNDS | {"dead_band": 0.0}, {}),
    "continuous_skyhook": (dampers.continuous_skyhook, BOUNDS | {"gain": 1e3}, {}),
    "hybrid": (dampers.hybrid, BOUNDS | {"share": 0.5, "gain": 1e3}, {}),
    "sh_add": (dampers.sh_add, BOUNDS | {"crossover": 4.0}, {}),
    "pdd": (dampers.pdd, BOUNDS | {"stiffness": 80e3}, {}),
    "extended_groundhook": (
        dampers.extended_groundhook,
        BOUNDS | {"vehicle": CAR, "tire_damping": 0.0, "sky_damping": 0.0,
                  "suspension_damping": 0.0, "tire_stiffness_change": 0.0},
        {},
    ),
    "selective_groundhook": (dampers.selective_groundhook,
                             BOUNDS | {"vehicle": CAR, "crossover": 1.0}, {"crossover": [None]}),
    "clipped_lqr": (
        dampers.clipped_lqr,
        BOUNDS | {"vehicle": CAR, "body_acceleration": 1.0, "suspension_travel": 1.0,
                  "tire_deflection": 1.0, "damper_force": 0.0},
        {"suspension_travel": [None], "tire_deflection": [None]},
    ),
}  # fmt: skip
"""What is called, its arguments, and what of `WRONG` an argument may be all the same."""


@pytest.mark.parametrize(
    ("call", "argument"), [(call, name) for call, (_, every, _) in CALLS.items() for name in every]
)
def test_a_wrong_argument_is_an_error_that_names_it(call, argument):
    function, right, allowed = CALLS[call]
    for wrong in WRONG:
        if any(wrong is fine or wrong == fine for fine in allowed.get(argument, [])):
            continue
        with pytest.raises((TypeError, ValueError)) as caught:
            function(**{**right, argument: wrong})
        told = str(caught.value)
        assert argument in told, f"{wrong!r}: {told}"
        assert len(told) < 400


@pytest.mark.parametrize(
    ("change", "error", "message"),
    [
        ({"elevations": [0, np.nan, 0]}, ValueError, r"elevations must be finite \[m\], got nan"),
        ({"elevations": [0, 1j, 0]}, TypeError, "elevations must be an array of numbers"),
        ({"elevations": ["0", "1", "0"]}, TypeError, "elevations must be an array of numbers"),
        ({"elevations": [[0, 0, 0], [0, 0]]}, TypeError, "elevations must be an array of numbers"),
        (
            {"elevations": [LEVEL, [0, 0, 40]]},
            ValueError,
            r"elevations of road 1: elevation\[2\] = 40 m at x = 25 m.*steeper than 1 m/m.*millim",
        ),
        ({"elevations": np.zeros((0, 3))}, ValueError, "one value for each of the 3 stations"),
        ({"elevations": np.zeros((1, 1, 3))}, ValueError, "elevations must have shape"),
        ({"stations": [-1, np.nan, 25]}, ValueError, r"stations must be finite \[m\], got nan"),
        ({"record": "tire_force"}, TypeError, r'record must be a list.*record=\["tire_force"\]'),
        ({"record": 5}, TypeError, "record must be a list of names, got 5"),
        ({"record": ["tire_force", 5]}, TypeError, "record must be a list of names"),
        ({"record": ["tyre_force"]}, ValueError, "record has an unknown name, 'tyre_force'"),
        ({"beam": "bridge"}, TypeError, "beam must be a bridgectl.Beam, got str"),
    ],
)
def test_a_loop_names_what_it_cannot_simulate(change, error, message):
    arguments = CASE | {"damper": LAW, "speeds": 25.0, "stations": X, "elevations": LEVEL}
    with pytest.raises(error, match=message):
        simulate_loop(**{**arguments, **change})


def test_names_to_record_may_come_from_anywhere():
    names = (name for name in ["damping", "tire_force"])
    found = simulate_loop(BEAM, CAR, LAW, 25.0, X, LEVEL, record=names)
    assert [*found.histories[0]] == ["damping", "tire_force"]


@pytest.mark.parametrize("name", ["c_min", "a gain", 3])
def test_a_gain_that_no_law_could_name_is_refused(name):
    with pytest.raises(ValueError, match=f"a gain cannot be called {name!r}"):
        Strategy("own", lambda s, g: 5e3, 1e3, 30e3, {name: (1, 0, 2)})


def test_signals_of_shapes_that_do_not_fit_are_named():
    with pytest.raises(ValueError, match=r"got body_velocity \(2,\), axle_velocity \(3,\)"):
        LAW.command(body_velocity=[1, 2], axle_velocity=[1, 2, 3])


def test_a_signal_of_rows_of_different_lengths_is_named():
    with pytest.raises(TypeError, match="body_velocity must be an array of numbers"):
        LAW.command(body_velocity=[[1.0], [1.0, 2.0]])


def test_a_signal_that_is_nan_is_named_and_not_taken_for_a_soft_damper():
    with pytest.raises(ValueError, match="body_velocity must be finite, got nan"):
        LAW.command(body_velocity=np.nan, suspension_velocity=0.1)
    with pytest.raises(ValueError, match="rows must be finite"):
        LAW.evaluate(np.full((10, 1), np.nan))


def test_no_cases_are_no_commands():
    assert LAW.command(body_velocity=[]).shape == (0,)


@pytest.mark.parametrize("limit", [np.inf, float("inf"), np.float64(np.inf), 20_000])
def test_a_force_limit_may_be_infinite(limit):
    assert Damper(LAW, max_force=limit).max_force == limit
