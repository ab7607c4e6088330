"""Numbers come in many containers: each is either right or one clear error."""

import warnings
from decimal import Decimal
from fractions import Fraction

import numpy as np
import pandas as pd
import pytest
from helpers import run_command

import bridgectl as bc
from bridgectl import _checks as check
from bridgectl.measures.history import rms

WHOLE = [0, 2, 1, 3]
RIGHT = {
    "list": WHOLE,
    "tuple": tuple(WHOLE),
    "range": range(4),
    "integers": np.array(WHOLE),
    "small unsigned integers": np.array(WHOLE, dtype=np.uint8),
    "single precision": np.array(WHOLE, dtype=np.float32),
    "half precision": np.array(WHOLE, dtype=np.float16),
    "Fortran order": np.asfortranarray(WHOLE),
    "every other": np.array([0, 9, 2, 9, 1, 9, 3])[::2],
    "read-only": np.frombuffer(np.array(WHOLE, dtype=float).tobytes()),
    "series": pd.Series(WHOLE, index=[7, 7, 8, 9]),
    "nullable series": pd.Series(WHOLE, dtype="Int64"),
    "a mask that masks nothing": np.ma.masked_array(WHOLE, mask=False),
}
WRONG = {
    "strings": ["0", "2", "1", "3"],
    "objects": np.array(WHOLE, dtype=object),
    "truth": [True, False, True, True],
    "complex": np.array(WHOLE) * 1j,
    "None among them": [0, None, 1, 3],
    "a generator": (i for i in WHOLE),
    "a set": set(WHOLE),
    "a dictionary": dict.fromkeys(WHOLE),
    "dates": np.array(WHOLE, dtype="datetime64[D]"),
    "one string": "0, 2, 1, 3",
}
MASKS = {
    "an array": np.ma.masked_equal(WHOLE, 2),
    "integers": np.ma.masked_equal(np.array(WHOLE), 2),
    "a list with one masked": [0.0, np.ma.masked, 1.0, 3.0],
    "a full mask": np.ma.masked_all(4),
}


@pytest.mark.parametrize("kind", RIGHT)
def test_what_is_right_is_the_same_numbers(kind):
    given = RIGHT[kind]
    expected = [0, 1, 2, 3] if kind == "range" else WHOLE
    assert check.array("x", given, (4,)).tolist() == expected
    road = bc.RoadProfile([0, 10, 20, 30], given)
    assert road.elevation.tolist() == expected


@pytest.mark.parametrize("kind", WRONG)
def test_what_is_wrong_is_one_error_that_names_the_argument(kind):
    for make in (
        lambda value: bc.RoadProfile([0, 10, 20, 30], value),
        lambda value: bc.RoadProfile([0, 10, 20, 30], [0, 0, 0, 0]).elevation_at(value),
        lambda value: check.speeds(value),
    ):
        with pytest.raises(TypeError, match="must be an array of numbers"):
            make(WRONG[kind])


def test_what_is_missing_in_a_series_is_told_with_its_place():
    with pytest.raises(ValueError, match=r"x must be finite, got nan at index \(2,\)"):
        check.array("x", pd.Series([0, 2, None, 3], dtype="Int64"), (4,))


def test_rows_of_different_lengths_are_told_as_such():
    with pytest.raises(TypeError, match="x must be an array of numbers"):
        check.array("x", [np.ma.masked_equal([1, 2], 2), [1, 2, 3]], (None, None))


@pytest.mark.parametrize("kind", MASKS)
def test_a_masked_value_is_never_unmasked(bridge, truck, kind):
    masked = MASKS[kind]
    flat = bc.RoadProfile([0, 10, 20, 30], [0, 0, 0, 0])
    for call in (
        lambda: bc.RoadProfile(masked, [0, 0, 0, 0]),
        lambda: bc.RoadProfile([0, 10, 20, 30], masked),
        lambda: flat.elevation_at(masked),
        lambda: bc.daf(bridge, truck, masked),
        lambda: bc.ramp_surface(bridge, truck, masked),
        lambda: bc.crossing_response(bridge, truck, 25, timepts=masked),
        lambda: bridge.mode_shapes(masked),
        lambda: bridge.influence_line(masked),
        lambda: rms(masked),
        lambda: bc.convoy([truck] * 4, masked),
    ):
        with pytest.raises(ValueError, match=r"[a-z]+ has \d masked value.*type keep = ~np.ma"):
            call()


def test_rows_with_a_mask_are_seen_and_the_place_is_told(bridge, truck):
    surface = bc.ramp_surface(bridge, truck, 25, ramp_length=5.0)
    rows = [np.zeros(6), np.ma.masked_less([0.0, 0.0, -99.0, 0.0, 0.0, 0.0], -9)]
    for roads in (rows, np.ma.vstack(rows)):
        with pytest.raises(ValueError, match=r"roads has 1 masked value.*index \(1, 2\)"):
            surface.dae(roads)


def test_elevations_of_any_kind_of_number_give_one_dae(bridge, truck):
    surface = bc.ramp_surface(bridge, truck, [20, 25], ramp_length=5.0)
    heights = [0, 1, 3, 2, 2, 1]
    expected = surface.dae(np.array(heights, dtype=float))
    for kind in (int, np.int8, np.uint8, np.float32):
        given = np.array(heights, dtype=kind)
        assert surface.dae(given) == pytest.approx(expected, abs=1e-12)
        assert surface.dae([given, given]) == pytest.approx(np.array([expected] * 2), abs=1e-12)
    assert surface.dae(heights) == pytest.approx(expected, abs=1e-12)
    assert surface.dae(pd.Series(heights)) == pytest.approx(expected, abs=1e-12)
    for wrong in ([True] * 6, ["0"] * 6, np.zeros(6) * 1j, None):
        with pytest.raises(TypeError, match="roads must be a RoadProfile, a list of them, or"):
            surface.dae(wrong)
    with pytest.raises(ValueError, match="roads must be finite"):
        surface.dae([0, 0, np.nan, 0, 0, 0])


@pytest.mark.parametrize(
    "value", [3, 3.0, np.float32(3), np.int8(3), np.array(3), np.array(3.0), Fraction(3)]
)
def test_one_number_may_be_of_any_real_kind(value):
    assert check.number("x", value) == 3.0


@pytest.mark.parametrize(
    "value",
    ["3", np.array("3"), True, np.bool_(True), np.array(True), 3j, np.array(3j), [3], np.array([3]),
     None, Decimal(3), np.datetime64(3, "s"), np.array(3, dtype=object)],
)  # fmt: skip
def test_one_number_is_nothing_else(value):
    with pytest.raises(TypeError, match="x must be one number"):
        check.number("x", value)


def test_one_masked_number_is_told():
    for value in (np.ma.masked, np.ma.masked_array(3.0, mask=True)):
        with pytest.raises(ValueError, match=r"x has 1 masked values: leave"):
            check.number("x", value)


def test_a_road_counts_once_whatever_its_name_stations_or_datum(bridge, truck):
    road = bc.iso8608_profile("A", 35, seed=0, start=-10)
    finer = road.resample(0.05)
    higher = bc.RoadProfile(road.x, road.elevation + 583.0, name="above sea level")
    mirrored = bc.RoadProfile(road.x, -road.elevation)
    laws = [bc.dampers.passive(7e3)]
    for twin in (road, finer, higher):
        with pytest.raises(ValueError, match=r"roads 1 \('ISO 8608 class A'\) and 3 .* the same"):
            bc.score(laws, bridge, truck, [road, mirrored, twin], 25, approach=10, workers=1)


def test_flat_roads_up_and_down_are_one_road(bridge, truck):
    flat = [bc.RoadProfile([-10, 25], [0.0, 0.0]), bc.RoadProfile([-10, 0, 25], [-0.0] * 3)]
    with pytest.raises(ValueError, match=r"roads 1 \(''\) and 2 \(''\) are the same"):
        bc.score([bc.dampers.passive(7e3)], bridge, truck, flat, 25, approach=10, workers=1)


def test_a_copied_file_counts_once_on_the_command_line(capsys, tmp_path):
    road = bc.iso8608_profile("A", 40, seed=0)
    first, copy, link = (tmp_path / f"{name}.csv" for name in ("first", "copy", "link"))
    bc.write_profile(first, road)
    copy.write_bytes(first.read_bytes())
    link.symlink_to(first)
    options = ["--approach", "10", "--speeds", "90", "--random", "0", "--strategies", "passive"]
    _, _, err = run_command(capsys, "score", first, copy, *options)
    assert "roads 1 ('first') and 2 ('copy') are the same" in err
    _, _, err = run_command(capsys, "score", first, link, *options)
    assert ".csv is given twice" in err


def test_conversions_make_no_warning_of_numpy():
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        with pytest.raises(ValueError, match="masked"):
            check.array("x", [1.0, np.ma.masked], (2,))
