"""The road profile: what it refuses, what its methods keep, and the sign of its drops."""

import copy
import pickle

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from matplotlib.figure import Figure

from bridgectl.road import RoadProfile, utia_road
from bridgectl.road.limits import MAX_SLOPE

ROUND_OFF = 1e-9  # [m]


@st.composite
def roads(draw: st.DrawFn) -> RoadProfile:
    """Roads of 2 to 60 points at steps of 10 mm to 1 m, slopes up to 0.5 m/m."""
    steps = draw(st.lists(st.floats(0.01, 1.0), min_size=1, max_size=59))
    slopes = draw(st.lists(st.floats(-0.5, 0.5), min_size=len(steps), max_size=len(steps)))
    x = draw(st.floats(-1000, 1000)) + np.cumsum([0.0, *steps])
    z = draw(st.floats(-100, 3000)) + np.cumsum([0.0, *np.multiply(steps, slopes)])
    return RoadProfile(x, z, name="drawn")


def slope_of_one_millimetre_per_metre() -> RoadProfile:
    return RoadProfile([-10.0, 0.0, 25.0], [0.010, 0.0, -0.025], name="downhill")


# What a profile is


def test_a_profile_keeps_read_only_float_copies() -> None:
    x = np.array([0, 1, 2])
    road = RoadProfile(x, [0, 0, 0])
    x[0] = -5
    assert road.x.tolist() == [0.0, 1.0, 2.0]
    assert road.x.dtype == road.elevation.dtype == np.float64
    with pytest.raises(ValueError, match="read-only"):
        road.x[0] = 1.0
    with pytest.raises(ValueError, match="read-only"):
        road.elevation[0] = 1.0


@pytest.mark.parametrize("attribute", ["x", "elevation", "name", "anything"])
def test_no_attribute_can_be_set(attribute: str) -> None:
    with pytest.raises(AttributeError):
        setattr(slope_of_one_millimetre_per_metre(), attribute, 1)


def test_profiles_are_equal_when_their_stations_and_elevations_are() -> None:
    road = RoadProfile([0, 1], [0, 0.1], name="a")
    twin = RoadProfile([0.0, 1.0], [-0.0, 0.1], name="b")
    assert road == twin
    assert hash(road) == hash(twin)
    assert road != RoadProfile([0, 1], [0, 0.2])
    assert road != RoadProfile([0, 2], [0, 0.1])
    assert road != RoadProfile([0, 1, 2], [0, 0.1, 0.1])
    assert road != "a road"


def test_the_repr_tells_name_size_ranges_and_step() -> None:
    assert repr(utia_road()) == (
        "RoadProfile('UTIA road', 2177 points, x from 478 m to 1022 m, "
        "elevation from 582.002 m to 583.143 m, step 0.25 m)"
    )
    assert "steps 10 to 25 m" in repr(slope_of_one_millimetre_per_metre())


@pytest.mark.parametrize(
    "clone", [copy.copy, copy.deepcopy, lambda r: pickle.loads(pickle.dumps(r))]
)
def test_a_copy_or_a_pickle_is_equal_named_and_read_only(clone) -> None:  # type: ignore[no-untyped-def]
    road = slope_of_one_millimetre_per_metre()
    twin = clone(road)
    assert twin == road
    assert twin.name == "downhill"
    assert not twin.x.flags.writeable
    assert not twin.elevation.flags.writeable


def test_a_road_steepened_by_detrending_can_still_be_pickled() -> None:
    road = RoadProfile(np.arange(6), [0, -0.9, -1.8, -1.0, -1.9, -2.8]).detrend()
    assert np.abs(np.diff(road.elevation)).max() > MAX_SLOPE
    assert pickle.loads(pickle.dumps(road)) == road


# What it refuses


@pytest.mark.parametrize("values", [["a", "b"], [1 + 2j, 3], [[0, 1], [2]], [object(), 1]])
def test_stations_and_elevations_that_are_not_numbers_are_type_errors(values: list[object]) -> None:
    with pytest.raises(TypeError, match=r"^x must be"):
        RoadProfile(values, [0, 0])  # type: ignore[arg-type]
    with pytest.raises(TypeError, match=r"^elevation must be"):
        RoadProfile([0, 1], values)  # type: ignore[arg-type]


def test_a_name_that_is_not_a_string_is_a_type_error() -> None:
    with pytest.raises(TypeError, match=r"^name must be a string, got 5: type for example name="):
        RoadProfile([0, 1], [0, 0], name=5)  # type: ignore[arg-type]


def test_arrays_of_two_dimensions_are_refused_by_name() -> None:
    with pytest.raises(ValueError, match=r"^x must have shape \(n,\)"):
        RoadProfile([[0, 1]], [0, 1])
    with pytest.raises(ValueError, match=r"^elevation must have shape \(n,\)"):
        RoadProfile([0, 1], [[0, 1]])


@pytest.mark.parametrize(("x", "z"), [([0, 1, 2], [0, 0]), ([0], [0]), ([], [])])
def test_lengths_that_differ_or_are_too_short_are_refused(x: list[int], z: list[int]) -> None:
    with pytest.raises(ValueError, match=r"one length of at least 2.*give one elevation"):
        RoadProfile(x, z)


@pytest.mark.parametrize("bad", [np.nan, np.inf, -np.inf])
def test_numbers_that_are_not_finite_are_refused_with_their_index(bad: float) -> None:
    with pytest.raises(ValueError, match=r"^x must be finite.*index \(1,\)"):
        RoadProfile([0, bad, 2], [0, 0, 0])
    with pytest.raises(ValueError, match=r"^elevation must be finite.*index \(2,\)"):
        RoadProfile([0, 1, 2], [0, 0, bad])


def test_stations_out_of_order_are_refused_with_index_and_values() -> None:
    with pytest.raises(ValueError, match=r"x\[2\] = 0.5 m lies before x\[1\] = 1 m: sort"):
        RoadProfile([0, 1, 0.5], [0, 0, 0])
    with pytest.raises(ValueError, match=r"x\[1\] = 0 m repeats x\[0\] = 0 m: remove one"):
        RoadProfile([0, 0, 1], [0, 0, 0])


def test_elevations_in_millimetres_are_refused_with_the_way_out() -> None:
    expected = r"elevation\[2\] = 8 m.*steeper than 1 m/m.*divide by 1000.*units=\"m,mm\""
    with pytest.raises(ValueError, match=expected):
        RoadProfile([0, 0.1, 0.2], [0, 0, 8])


def test_a_slope_of_45_degrees_is_the_last_one_accepted() -> None:
    steps = 1000.0 + 0.1 * np.arange(50)
    assert RoadProfile(steps, steps).x.size == 50
    with pytest.raises(ValueError, match="steeper"):
        RoadProfile(steps, 1.001 * steps)


def test_elevations_that_overflow_are_refused_without_a_warning() -> None:
    with pytest.raises(ValueError, match="steeper"):
        RoadProfile([0, 1], [-1e308, 1e308])


# Resampling, detrending, cropping, placing, levelling


def test_resampling_interpolates_and_keeps_the_last_station() -> None:
    road = utia_road().resample(0.1)
    assert road.name == "UTIA road"
    assert road.x.size == 5441
    assert road.x[-1] == pytest.approx(1022.0, abs=ROUND_OFF)
    assert road.elevation_at(700.1) == pytest.approx(utia_road().elevation_at(700.1), abs=ROUND_OFF)


def test_resampling_a_stretch_starts_at_its_start() -> None:
    road = slope_of_one_millimetre_per_metre().resample(3, start=-1, stop=10)
    assert road.x.tolist() == [-1.0, 2.0, 5.0, 8.0]
    np.testing.assert_allclose(road.elevation, [1e-3, -2e-3, -5e-3, -8e-3], atol=ROUND_OFF)


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ({"step": 0.0}, "^step must be above 0"),
        ({"step": np.nan}, "^step must be finite"),
        ({"step": 40.0}, "^step = 40 m is longer than the road .* type a smaller step"),
        ({"start": -11.0}, "^start = -11 m is outside the road, which covers x from -10 m to 25 m"),
        ({"stop": 26.0}, "^stop = 26 m is outside the road.*pass a longer road"),
        ({"start": 5.0, "stop": 5.0}, "^stop must be past start = 5 m, got 5 m"),
    ],
)
def test_resampling_refuses_by_name(arguments: dict[str, float], message: str) -> None:
    with pytest.raises(ValueError, match=message):
        slope_of_one_millimetre_per_metre().resample(**arguments)


@given(road=roads(), step=st.floats(0.01, 0.5))
@settings(max_examples=100, deadline=None)
def test_a_resampled_road_has_the_same_drops(road: RoadProfile, step: float) -> None:
    step = min(step, (road.x[-1] - road.x[0]) / 1.5)
    fine = road.resample(step)
    start = fine.x[0]
    np.testing.assert_allclose(
        fine.drop(fine.x, start), road.drop(fine.x, start), rtol=0, atol=ROUND_OFF
    )


@given(road=roads(), order=st.integers(0, 3))
@settings(max_examples=100, deadline=None)
def test_detrending_leaves_nothing_of_the_polynomial(road: RoadProfile, order: int) -> None:
    order = min(order, road.x.size - 1)
    rest = road.detrend(order)
    assert abs(rest.elevation.mean()) < 1e-8
    np.testing.assert_allclose(rest.detrend(order).elevation, rest.elevation, rtol=0, atol=1e-8)


def test_detrending_takes_out_the_grade() -> None:
    np.testing.assert_allclose(
        RoadProfile([0, 1, 2], [5.0, 5.1, 5.2]).detrend().elevation, 0.0, atol=1e-12
    )


@pytest.mark.parametrize("order", [-1, 1.5, 3, 21])
def test_a_bad_order_is_refused(order: int) -> None:
    message = f"^order must be a whole number from 0 to 2 for 3 points, not {order}: type order=1"
    with pytest.raises(ValueError, match=message):
        slope_of_one_millimetre_per_metre().detrend(order)


def test_cropping_interpolates_at_both_ends() -> None:
    road = slope_of_one_millimetre_per_metre().crop(-5, 10)
    assert road.x.tolist() == [-5.0, 0.0, 10.0]
    np.testing.assert_allclose(road.elevation, [5e-3, 0.0, -10e-3], atol=ROUND_OFF)
    assert road.name == "downhill"


@given(road=roads())
@settings(max_examples=50, deadline=None)
def test_cropping_to_the_whole_road_changes_nothing(road: RoadProfile) -> None:
    assert road.crop(road.x[0], road.x[-1]) == road


def test_cropping_outside_the_road_is_refused() -> None:
    with pytest.raises(ValueError, match=r"^stop = 30 m is outside the road"):
        slope_of_one_millimetre_per_metre().crop(0, 30)


def test_placing_the_bridge_moves_the_origin_of_the_stations() -> None:
    road = utia_road().place_bridge(700)
    assert road.x[[0, -1]].tolist() == [-222.0, 322.0]
    assert road.elevation_at(0.0) == utia_road().elevation_at(700.0)
    with pytest.raises(ValueError, match=r"^station = 5 m is outside the road"):
        utia_road().place_bridge(5)


def test_a_levelled_road_starts_at_zero() -> None:
    road = utia_road().place_bridge(700).level(-100.05)
    assert road.elevation_at(-100.05) == pytest.approx(0.0, abs=ROUND_OFF)
    with pytest.raises(ValueError, match=r"^x = 0 m is outside the road, which covers x from 478"):
        utia_road().level()


# Elevations and drops


def test_elevations_keep_the_shape_of_the_stations() -> None:
    road = slope_of_one_millimetre_per_metre()
    assert road.elevation_at(5.0).shape == ()
    assert road.elevation_at([[0.0, 5.0]]).shape == (1, 2)
    assert road.elevation_at([25.0 + 5e-10, -10.0 - 5e-10]).tolist() == [-0.025, 0.010]


@pytest.mark.parametrize("bad", [25.001, -10.001, np.nan])
def test_elevations_outside_the_road_are_refused(bad: float) -> None:
    with pytest.raises(ValueError, match=r"^x (= .* is outside the road|must be finite)"):
        slope_of_one_millimetre_per_metre().elevation_at([0.0, bad])


def test_a_drop_is_positive_where_the_road_falls() -> None:
    road = slope_of_one_millimetre_per_metre()
    drops = road.drop([[-10.0, -5.0, 0.0], [5.0, 25.0, 100.0]], start=-5.0)
    np.testing.assert_allclose(drops, [[0, 0, 5e-3], [10e-3, 30e-3, 30e-3]], atol=ROUND_OFF)
    assert road.drop(5.0, start=0.0).shape == ()


def test_a_drop_from_outside_the_road_is_refused() -> None:
    with pytest.raises(ValueError, match=r"^start = -11 m is outside the road.*from -10 m"):
        slope_of_one_millimetre_per_metre().drop(0.0, start=-11.0)


def test_a_road_covers_what_lies_on_it_to_within_a_nanometre() -> None:
    road = slope_of_one_millimetre_per_metre()
    assert road.covers(-10 - 5e-10, 25 + 5e-10)
    assert not road.covers(-10.1, 25)
    assert not road.covers(-10, 25.1)
    assert not road.covers(20, 10)


@pytest.mark.parametrize(
    ("stretch", "way_out"),
    [
        ((-200, 25), "pass a longer road or start=-10"),
        ((-200, 30), "pass a longer road"),
        ((0, 30), r"pass a longer road or place_bridge\(-10 to -5\)"),
    ],
)
def test_a_road_too_short_is_refused_with_the_way_out(
    stretch: tuple[int, int], way_out: str
) -> None:
    message = (
        f"the road covers x from -10 m to 25 m but the surface needs {stretch[0]} m to "
        rf"{stretch[1]} m \(approach plus bridge\): {way_out}$"
    )
    with pytest.raises(ValueError, match=message):
        slope_of_one_millimetre_per_metre().require(*stretch, what="the surface")


def test_a_road_long_enough_is_not_refused() -> None:
    slope_of_one_millimetre_per_metre().require(-10, 25)


# Ramps


def test_ramps_of_a_falling_road_are_positive() -> None:
    ramps = slope_of_one_millimetre_per_metre().ramps(start=0.0, stop=25.0)
    assert ramps.positions.size == 250
    np.testing.assert_allclose(ramps.positions, 0.1 * np.arange(250), atol=ROUND_OFF)
    np.testing.assert_allclose(ramps.heights, 1e-4, rtol=0, atol=ROUND_OFF)


def test_the_last_ramp_may_reach_past_the_end_where_the_road_is_level() -> None:
    ramps = slope_of_one_millimetre_per_metre().ramps(2.0, start=22.0)
    assert ramps.positions.tolist() == [22.0, 24.0]
    np.testing.assert_allclose(ramps.heights, [2e-3, 1e-3], atol=ROUND_OFF)


def test_a_ramp_longer_than_the_road_is_one_ramp() -> None:
    assert slope_of_one_millimetre_per_metre().ramps(100.0).heights == pytest.approx(0.035)


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ({"length": -0.1}, "^length must be above 0"),
        ({"start": -11.0}, "^start = -11 m is outside the road"),
        ({"stop": 26.0}, "^stop = 26 m is outside the road"),
    ],
)
def test_ramps_refuse_by_name(arguments: dict[str, float], message: str) -> None:
    with pytest.raises(ValueError, match=message):
        slope_of_one_millimetre_per_metre().ramps(**arguments)


@given(road=roads(), length=st.floats(0.01, 2.0))
@settings(max_examples=100, deadline=None)
def test_ramps_sum_to_the_total_drop(road: RoadProfile, length: float) -> None:
    ramps = road.ramps(length)
    total = road.elevation[0] - road.elevation[-1]
    assert ramps.positions[-1] < road.x[-1] + ROUND_OFF
    assert ramps.positions[-1] + length > road.x[-1] - ROUND_OFF
    # The last ramp may stop 1e-9 of its length short of the end.
    assert ramps.heights.sum() == pytest.approx(total, abs=1e-8)


# Plotting


def test_a_plot_shows_millimetres_over_metres() -> None:
    axes = Figure().add_subplot()
    assert slope_of_one_millimetre_per_metre().plot(axes) is axes
    (line,) = axes.get_lines()
    assert np.asarray(line.get_ydata()).tolist() == pytest.approx([10.0, 0.0, -25.0])
    assert line.get_label() == "downhill"
    assert axes.get_xlabel() == "station x [m]"
    assert axes.get_ylabel() == "elevation, up [mm]"


def test_a_plot_makes_its_own_axes(monkeypatch: pytest.MonkeyPatch) -> None:
    pyplot = pytest.importorskip("matplotlib.pyplot")
    monkeypatch.setattr(pyplot, "show", lambda: pytest.fail("plots must not be shown"))
    axes = slope_of_one_millimetre_per_metre().plot()
    assert len(axes.get_lines()) == 1
    pyplot.close(axes.figure)
