"""What can hardly be meant is told once, on the caller's line; what exists is not."""

import dataclasses
import itertools
import json
import subprocess
import sys
import warnings
from pathlib import Path

import numpy as np
import pytest
from helpers import run_command

import bridgectl as bc
from bridgectl.dampers import Damper, groundhook, passive, simulate_loop, skyhook
from bridgectl.measures import weighted_rms
from bridgectl.measures.loads import road_stress_factor
from bridgectl.paper.li2006 import DECKS
from bridgectl.road.footprint import tire_footprint

BRIDGE = 25.0, 18358.0, 4.865e10
TRUCK = 9000.0, 1000.0, 80e3, 1.8e6, 7e3
VEHICLES = Path(__file__).parents[2] / "shared" / "reference" / "vehicles.json"


@pytest.fixture
def told():
    with warnings.catch_warnings(record=True) as found:
        warnings.simplefilter("always")
        yield found


@pytest.mark.parametrize("order", [p for p in itertools.permutations(BRIDGE) if p != BRIDGE])
def test_every_other_order_of_a_beams_arguments_is_told(order):
    with pytest.warns(bc.PlausibilityWarning, match="order"):
        bc.Beam(*order)


def test_other_orders_of_a_trucks_arguments_are_told_but_where_body_and_damping_look_alike(told):
    for order in itertools.permutations(TRUCK):
        told.clear()
        bc.QuarterCar(*order)
        # 7000 kg and 9000 N s/m are a truck too, and so is a damper of 1000 N s/m.
        alike = order[1:4] == TRUCK[1:4] or order == (9000.0, 7e3, 80e3, 1.8e6, 1000.0)
        assert len(told) == (0 if alike else 1), order


@pytest.mark.parametrize("length", [5, 9, 25, 43, 80, 200])
@pytest.mark.parametrize("ratio", [0.4, 1.0, 2.5])
def test_thousandfold_units_are_told_of_bridges_of_every_length(told, length, ratio):
    """Bridges whose frequency is 0.4 to 2.5 times 82 L^-0.9: no word; in kN or tonnes: one."""
    mass = 12e3
    omega = 2 * np.pi * ratio * 82 * length**-0.9
    rigidity = mass * omega**2 * (length / np.pi) ** 4
    bc.Beam(length, mass, rigidity)
    assert not told
    for slip in ((mass / 1e3, rigidity), (mass, rigidity / 1e3), (mass, rigidity / 1e6)):
        bc.Beam(length, *slip)
    assert len(told) == 3


def test_all_bridges_and_the_truck_of_the_thesis_pass():
    for deck, spans in DECKS.items():
        for span in spans:
            beam = bc.li2006.beam(span, deck)
            bc.Beam(beam.length, beam.mass_per_length, beam.flexural_rigidity)
            bc.crossing_system(beam, bc.li2006.car(), 59.9)


@pytest.mark.skipif(not VEHICLES.exists(), reason="the reference numbers are not shipped")
def test_the_reference_trucks_and_bridges_pass():
    given = json.loads(VEHICLES.read_text(encoding="utf-8"))
    for truck in given["vehicles"].values():
        bc.Vehicle(
            truck["mass_matrix"], truck["damping_matrix_without_tyres"],
            truck["stiffness_matrix_without_tyres"], truck["tyre_stiffness_N_m"],
            truck["axle_offsets_behind_first_m"], truck["tyre_map"],
            heave=[float(not name.startswith("th")) for name in truck["coordinates"]],
        )  # fmt: skip
    for bridge in given["bridges"].values():
        bc.Beam(
            bridge["length_m"], bridge["mass_per_length_kg_m"], bridge["flexural_rigidity_N_m2"]
        )


@pytest.mark.parametrize(
    "car",
    [
        (320, 40, 18e3, 190e3, 1200),  # a quarter of a passenger car
        (250, 50, 16e3, 160e3, 0.0),  # the golden car's proportions
        (5250, 900, 6e6, 1.75e6, 10e3),  # an axle of VBI-2D's truck
        (4500, 650, 1e6, 3.5e6, 40e3),  # leaf springs
        (1100, 1000, 1e6, 2e6, 20e3),  # an empty trailer
        (21e3, 1800, 1.2e6, 1.6e9, 60e3),  # a railway carriage on steel wheels
        (5750, 1, 1.595e6, 1e10, 0.0),  # the sprung mass of textbooks
        (180, 20, 15e3, 150e3, 1e3),  # a motorcycle
        (60e3, 4e3, 2e6, 8e6, 1e5),  # a crane
    ],
)
def test_vehicles_of_other_kinds_pass(car):
    bc.QuarterCar(*map(float, car))


def test_a_constant_force_may_have_any_speed(bridge):
    bc.daf(bridge, bc.Vehicle([[1000.0]], [[0.0]], [[0.0]], [1e-3]), 200.0)


def test_stiffness_in_kilonewtons_of_any_vehicle_is_told(truck):
    linear = truck.linear
    with pytest.warns(bc.PlausibilityWarning, match="lowest frequency.*for kN/m type 1e3"):
        bc.Vehicle(
            linear.mass_matrix, linear.damping_matrix, linear.stiffness_matrix / 1e3,
            linear.tire_stiffnesses / 1e3,
        )  # fmt: skip


@pytest.mark.parametrize(
    ("slip", "says"),
    [
        ({"sample_time": 2}, "sample_time = 2 s .*for 2 ms type 0.002"),
        ({"lag": 10}, "lag = 10 s .*for 10 ms type 0.01"),
        ({"max_force": 20}, "max_force = 20 N .*for 20 kN type 20000"),
        ({"velocity_noise": 5}, "velocity_noise = 5 m/s .*for 5 mm/s type 0.005"),
        ({"position_error": -500}, "position_error = -500 m .*for -500 mm type -0.5"),
        ({"position_deviation": 300}, "position_deviation = 300 m .*for 300 mm type 0.3"),
        ({"acceleration_noise": 80}, "acceleration_noise = 80 m/s.2 .*for 80 mm/s.2 type 0.08"),
        ({"travel_noise": 0.5}, "travel_noise = 0.5 m .*for 0.5 mm type 0.0005"),
        ({"preview_noise": 2}, "preview_noise = 2 m .*for 2 mm type 0.002"),
        ({"preview_delay": 20}, "preview_delay = 20 s .*for 20 ms type 0.02"),
    ],
)
def test_a_dampers_units_are_told(slip, says):
    with pytest.warns(bc.PlausibilityWarning, match=says):
        Damper(passive(7e3), **slip)


ROAD = bc.iso8608_profile("A", 35, seed=0, start=-10)
JUMP = bc.RoadProfile([-10, 2, 3, 3.1, 40], [0, 0, 0.09, 0, 0])
STATIONS = np.linspace(0, 25, 251)
SURFACE = bc.ramp_surface(bc.li2006.beam(), bc.li2006.car(), 25, ramp_length=0.5)
ALMOST_FLAT = bc.RoadProfile(0.5 * np.arange(51), 2e-4 * (np.arange(51) % 2))
STEEP = bc.RoadProfile(ALMOST_FLAT.x, 1000 * ALMOST_FLAT.elevation)
ENTRIES = {
    "daf": lambda b, c: bc.daf(b, c, 80),
    "daf, constant damper": lambda b, c: bc.daf(b, c, 80, damper=passive(7e3)),
    "daf, semi-active damper": lambda b, c: bc.daf(b, c, [20, 80], damper=skyhook(1e3, 30e3)),
    "daf by the control library": lambda b, c: bc.daf(b, c, 80, method="control"),
    "crossing_response": lambda b, c: bc.crossing_response(b, c, 80),
    "crossing_response, damper": lambda b, c: bc.crossing_response(
        b, c, 80, damper=groundhook(1e3, 30e3)
    ),
    "crossing_system": lambda b, c: bc.crossing_system(b, c, 80),
    "Crossing": lambda b, c: bc.Crossing(b, bc.convoy([c] * 50, range(50))),
    "replaced Crossing": lambda b, c: dataclasses.replace(
        bc.Crossing(b, c), vehicle=bc.convoy([c] * 50, range(50))
    ),
    "ramp_surface": lambda b, c: bc.ramp_surface(b, c, 80, ramp_length=5.0),
    "ramp_surface, constant damper": lambda b, c: bc.ramp_surface(
        b, c, 80, ramp_length=5.0, damper=passive(7e3)
    ),
    "ramp_surface, damper": lambda b, c: bc.ramp_surface(
        b, c, 80, ramp_length=5.0, damper=skyhook(1e3, 30e3)
    ),
    "simulate_loop": lambda b, c: simulate_loop(
        b, c, skyhook(1e3, 30e3), 80, STATIONS, 0 * STATIONS
    ),
    "score": lambda b, c: bc.score(
        [passive(7e3), skyhook(1e3, 30e3)], b, c, [ROAD], [20, 80], approach=10, workers=1
    ),
    "Beam": lambda b, c: bc.Beam(25.0, 18.358, 4.865e10),
    "replaced Beam": lambda b, c: dataclasses.replace(b, mass_per_length=18.358),
    "li2006.beam": lambda b, c: bc.li2006.beam(damping_ratio=0.5),
    "QuarterCar": lambda b, c: bc.QuarterCar(9.0, 1.0, 80.0, 1800.0, 7.0),
    "replaced QuarterCar": lambda b, c: dataclasses.replace(c, sprung_mass=9.0),
    "Vehicle": lambda b, c: bc.Vehicle([[9.0]], [[0.0]], [[0.0]], [1800.0]),
    "daf, lift-off": lambda b, c: bc.daf(b, c, [10, 12], JUMP, start=-10),
    "crossing_response, lift-off": lambda b, c: bc.crossing_response(b, c, 10, JUMP, start=-10),
    "Damper": lambda b, c: Damper(passive(7e3), sample_time=2),
    "daf, damper in kN": lambda b, c: bc.daf(b, c, 20, damper=passive(7)),
    "daf, damper in mN": lambda b, c: bc.daf(b, c, 20, damper=passive(3e6)),
    "crossing_response, damper in kN": lambda b, c: bc.crossing_response(
        b, c, 20, damper=skyhook(1, 30)
    ),
    "ramp_surface, damper in kN": lambda b, c: bc.ramp_surface(
        b, c, 20, ramp_length=5.0, damper=passive(7)
    ),
    "simulate_loop, damper in kN": lambda b, c: simulate_loop(
        b, c, skyhook(1, 30), 20, STATIONS, 0 * STATIONS
    ),
    "score, dampers in kN": lambda b, c: bc.score(
        [passive(7), skyhook(1, 30)], b, c, [ROAD], 20, approach=10, workers=1
    ),
    "dae, road in mm": lambda b, c: SURFACE.dae([ALMOST_FLAT, STEEP]),
    "contributions, road in mm": lambda b, c: SURFACE.contributions(STEEP),
    "footprint": lambda b, c: tire_footprint(JUMP, 0.2),
    "weighting": lambda b, c: weighted_rms(np.ones(50), 0.05),
    "measures": lambda b, c: road_stress_factor(np.zeros(9), 98100.0),
}


@pytest.mark.parametrize("entry", ENTRIES)
def test_each_slip_is_told_once_with_the_callers_line(told, bridge, truck, entry):
    call = ENTRIES[entry]
    call(bridge, truck)
    assert [str(each.message) for each in told][1:] == []
    assert told[0].filename == __file__
    first = call.__code__.co_firstlineno
    assert first <= told[0].lineno <= first + 3


@pytest.mark.parametrize("iso_class", "ABCDEF")
@pytest.mark.parametrize("grade", [0.0, 0.005])
def test_roads_of_every_class_and_above_the_sea_pass(told, bridge, iso_class, grade):
    road = bc.iso8608_profile(iso_class, 85, seed=1, start=-60)
    SURFACE.dae(bc.RoadProfile(road.x, road.elevation + grade * road.x + 500))
    assert not [each for each in told if each.category is bc.PlausibilityWarning]


@pytest.mark.parametrize("grade", [0.05, -0.05])
def test_a_grade_is_told_and_gone_when_taken_off(told, bridge, truck, grade):
    road = bc.iso8608_profile("A", 85, seed=1, start=-60)
    steep = bc.RoadProfile(road.x, road.elevation + grade * road.x)
    bc.daf(bridge, truck, 25, steep, start=-60)
    assert [f"grade of {grade:.1%}" in str(each.message) for each in told] == [True]
    bc.daf(bridge, truck, 25, steep.detrend(), start=-60)
    assert len(told) == 1


@pytest.mark.parametrize("names", [{}, {"__name__": "__main__"}])
def test_code_that_is_run_as_text_is_told_too(told, names):
    exec(compile("\nbc.QuarterCar(9, 1, 80, 1800, 7)", "cell 1", "exec"), {"bc": bc} | names)
    assert [(each.filename, each.lineno) for each in told] == [("cell 1", 2)]


def test_one_class_silences_them_all_and_nothing_else(bridge, truck):
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", bc.PlausibilityWarning)
        with pytest.warns(bc.LiftOffWarning):
            bc.daf(bridge, truck, [10, 80], JUMP, start=-10)


def test_a_beam_that_was_told_is_not_told_again_by_its_crossings(told, truck):
    light = bc.Beam(25.0, 18.358, 4.865e10)
    bc.daf(light, truck, 25)
    assert len(told) == 1


@pytest.mark.slow
def test_a_script_is_told_its_own_line(tmp_path):
    script = tmp_path / "study.py"
    script.write_text(
        "import bridgectl as bc\n\n"
        "for speeds in ([60, 80], [70, 90]):\n"
        "    bc.daf(bc.li2006.beam(), bc.li2006.car(), speeds)\n",
        encoding="utf-8",
    )
    run = subprocess.run(
        [sys.executable, "-W", "default", script], capture_output=True, text=True, check=True,
        cwd=Path(__file__).parents[1], env={"PYTHONPATH": str(Path(__file__).parents[1])},
    )  # fmt: skip
    lines = [line for line in run.stderr.splitlines() if "PlausibilityWarning" in line]
    assert [line.partition(": Plaus")[0] for line in lines] == [f"{script}:4"] * 2


@pytest.mark.parametrize(
    ("options", "says"),
    [
        (
            ["--sprung-mass", "9"],
            "sprung_mass = 9 kg (the body) is lighter than unsprung_mass = 1000 kg (the axle): "
            "for 9 t type --sprung-mass 9000",
        ),
        (["--speeds", "300"], "--speeds of 83.33 m/s (300 km/h) is faster than any road vehicle"),
        (["--damping-ratio", "0.5"], "damping_ratio = 0.5 is 50 percent of critical"),
    ],
)
def test_the_command_line_tells_a_slip_once_and_before_the_work(capsys, monkeypatch, options, says):
    def work(*_, **__):
        raise ValueError("the work")

    monkeypatch.setattr(bc, "ramp_surface", work)
    _, _, err = run_command(capsys, "dae", "--approach", "10", "--speeds", "80", *options)
    first, second = err.splitlines()
    assert first.startswith(f"bridgectl: warning: {says}")
    assert second == "bridgectl: error: the work"


def test_speeds_of_the_command_line_are_not_told_again_in_metres(capsys):
    _, _, err = run_command(capsys, "dae", "--approach", "10", "--speeds", "300")
    assert err.count("faster than any road vehicle") == 1
