"""What is set before a crossing: damping programs and presets, and what is refused."""

import dataclasses

import numpy as np
import pytest
from helpers import rough_road
from hypothesis import assume, given
from hypothesis import strategies as st

import bridgectl as bc
from bridgectl.dampers import preset, program
from bridgectl.model.crossing import make_crossing

PLACES, DAMPINGS = [-60.0, -10.0, 0.1, 5.0], [7e3, 1e3, 2.3e3 / 7, 30e3]


@pytest.mark.parametrize("shape", ["steps", "lines"])
def test_at_each_place_the_damping_is_the_one_given_to_the_last_digit(shape):
    found = program(PLACES, DAMPINGS, shape=shape).command(position=PLACES)
    assert found.tolist() == DAMPINGS


@pytest.mark.parametrize("shape", ["steps", "lines"])
def test_beyond_its_ends_a_program_goes_on_as_it_begins_and_ends(shape):
    found = program(PLACES, DAMPINGS, shape=shape).command(position=[-1e6, -60.1, 5.1, 1e6])
    assert found.tolist() == [DAMPINGS[0]] * 2 + [DAMPINGS[-1]] * 2


def test_steps_hold_a_damping_up_to_the_next_place():
    before = np.nextafter(PLACES, -np.inf)
    found = program(PLACES, DAMPINGS).command(position=before)
    assert found.tolist() == [DAMPINGS[0], *DAMPINGS[:-1]]


def test_lines_join_the_places():
    x = np.linspace(-70, 10, 1001)
    found = program(PLACES, DAMPINGS, shape="lines").command(position=x)
    assert found == pytest.approx(np.interp(x, PLACES, DAMPINGS), rel=1e-12)


@given(
    places=st.lists(st.floats(-1e3, 1e3), min_size=1, max_size=8, unique=True).map(sorted),
    shape=st.sampled_from(["steps", "lines"]),
    x=st.floats(-1e9, 1e9),
    data=st.data(),
)
def test_every_command_is_within_the_least_and_largest_damping(places, shape, x, data):
    count = len(places)
    assume(count == 1 or np.diff(places).min() > 1e-6)
    values = data.draw(st.lists(st.floats(1, 1e6), min_size=count, max_size=count))
    law = program(places, values, shape=shape)
    assert (law.c_min, law.c_max) == (min(values), max(values))
    assert law.c_min <= float(law.command(position=x)) <= law.c_max


@pytest.mark.parametrize("shape", ["steps", "lines"])
def test_one_value_is_a_constant_damper(shape):
    law = program([3], [7000], shape=shape)
    assert law.command(position=[-5.0, 0.0, 3.0, 50.0]).tolist() == [7e3] * 4
    assert (law.c_min, law.c_max) == (7e3, 7e3)


def test_a_program_measures_nothing_but_the_position(tmp_path):
    law = program(PLACES, DAMPINGS, name="soft on the approach")
    assert law.used == ["position"]
    assert (law.name, program([0], [1e3]).name) == ("soft on the approach", "program")
    assert law.gains == {}
    assert "damping(" in law.to_c(tmp_path / "damping.c").read_text()
    block = law.system(25.0)
    assert block.output(0.2, [], [0, 0, 0, 0.1]).tolist() == [3e3, 30e3]  # at 5 m


def test_a_closed_valve_somewhere_is_allowed():
    assert program([0, 1], [0, 1e3]).command(position=[0.5, 1.5]).tolist() == [0, 1e3]


@pytest.mark.parametrize(
    ("arguments", "error", "message"),
    [
        (([], []), ValueError, "positions must hold at least one position"),
        (([0, 1], [1e3]), ValueError, "dampings must have one value for each of the 2 positions"),
        (([0, 0], [1e3, 1e3]), ValueError, "positions must increase, got 0 m before 0 m"),
        (([0, 1, 1], [1e3] * 3), ValueError, "positions must increase, got 1 m before 1 m"),
        (([0, 2, 1], [1e3] * 3), ValueError, "positions must increase, got 2 m before 1 m"),
        (([0, 0.5, 0.2], [1e3] * 3), ValueError, "positions must increase, got 0.5 m before 0.2 m"),
        (([0, 1], [1e3, -1]), ValueError, "dampings must be 0 or more .*, got -1"),
        (([0, 1], [0, 0]), ValueError, "dampings must have a value above 0"),
        (([0, np.nan], [1e3, 1e3]), ValueError, "positions must be finite"),
        ((["a"], [1e3]), TypeError, "positions must be an array of numbers"),
        ((0.0, 1e3), ValueError, "positions must have shape"),
    ],
)
def test_each_mistake_is_named(arguments, error, message):
    with pytest.raises(error, match=message):
        program(*arguments)


def test_an_unknown_shape_and_a_missing_name_are_refused():
    with pytest.raises(ValueError, match="shape must be one of 'steps', 'lines', got 'curves'"):
        program([0], [1e3], shape="curves")
    with pytest.raises(TypeError, match="name must be a string"):
        program([0], [1e3], name="")


# Presets


@pytest.mark.quick_cases(2)
@pytest.mark.parametrize("stations", ["even", "uneven"])
@pytest.mark.parametrize("where", [{}, {"section": 0.3, "recovery": "li2006"}], ids=["", "else"])
def test_a_preset_has_the_damping_of_the_least_simulated_daf_of_each_road_and_speed(
    bridge, truck, stations, where
):
    law, speeds = preset(1e3, 30e3, n_dampings=3), np.array([18.0, 27.0])
    x = np.linspace(-10, 25.5, 72)
    if stations == "uneven":
        x = np.delete(x, [3, 30, 31])
    roads = [rough_road(seed, -10, 26, height=1e-3).elevation_at(x) for seed in range(3)]
    crossing = make_crossing(bridge, dataclasses.replace(truck, damping=0.0), **where)
    found = law.gains_for(crossing, speeds, x, np.array(roads))["damping"]
    cars = [dataclasses.replace(truck, damping=c) for c in law.dampings]
    dafs = [
        [bc.daf(bridge, car, speeds, bc.RoadProfile(x, z), start=-10, **where) for z in roads]
        for car in cars
    ]
    assert np.array_equal(found.T, law.dampings[np.argmin(dafs, axis=0)])
    assert len(np.unique(found)) > 1


def test_a_preset_without_a_crossing_is_soft_and_its_dampings_are_even_in_ratio():
    law = preset(1e3, 16e3, n_dampings=5)
    assert law.gains == {"damping": 1e3}
    assert law.dampings == pytest.approx([1e3, 2e3, 4e3, 8e3, 16e3])
