"""Damping programs: what is commanded at, between and beyond the places, and what is refused."""

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

from bridgectl.dampers import program

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
    assert law.command(position=[-5.0, 3.0, 50.0]).tolist() == [7e3] * 3
    assert (law.c_min, law.c_max) == (7e3, 7e3)


def test_a_program_measures_nothing_but_the_position(tmp_path):
    law = program(PLACES, DAMPINGS, name="soft on the approach")
    assert law.used == ["position"]
    assert law.name == "soft on the approach"
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
        (([0, 2, 1], [1e3] * 3), ValueError, "positions must increase, got 2 m before 1 m"),
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
