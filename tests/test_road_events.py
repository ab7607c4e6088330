"""Local road events: their shapes, adding them to a road, and the tire's contact length."""

import dataclasses
import pickle
import warnings
from collections.abc import Callable
from itertools import pairwise

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st
from scipy.integrate import quad

import bridgectl as bc
from bridgectl._places import SAME_PLACE
from bridgectl.road import (
    RoadProfile,
    add_events,
    bump,
    plank,
    ramp,
    settlement,
    step,
    tire_footprint,
    utia_road,
)
from bridgectl.road.events import RoadEvent

ROUND_OFF = 1e-12  # [m]
NANOMETRE = 1e-9

millimetres = st.integers(-40_000, 20_000).map(lambda i: 1e-3 * i)
heights = st.floats(-0.045, 0.045)
depths = st.floats(0, 0.045)
lengths = st.integers(200, 3000).map(lambda i: 1e-3 * i)

MAKERS: list[Callable[..., RoadEvent]] = [
    lambda x, length, height: step(x, height),
    ramp,
    plank,
    bump,
    lambda x, length, height: bump(x, length, -abs(height)),
    lambda x, length, height: settlement(length, abs(height), x=x),
    lambda x, length, height: settlement(length, abs(height), x=x, shape="parabolic"),
]


@st.composite
def events(draw: st.DrawFn) -> RoadEvent:
    """Events of every kind between -43 and 23 m, up to 45 mm high, slopes below 0.91 m/m."""
    return draw(st.sampled_from(MAKERS))(draw(millimetres), draw(lengths), draw(heights))


@st.composite
def roads(draw: st.DrawFn) -> RoadProfile:
    """Uneven roads from -50 to 30 m, slopes up to 0.02 m/m, elevations up to some 100 m."""
    inside = draw(st.sets(st.integers(-49_990, 29_990), max_size=30))
    x = 1e-3 * np.array(sorted({-50_000, *inside, 30_000}))
    slopes = draw(st.lists(st.floats(-0.02, 0.02), min_size=x.size - 1, max_size=x.size - 1))
    datum = draw(st.floats(-100, 100))
    return RoadProfile(x, datum + np.cumsum([0.0, *np.diff(x) * slopes]), name="drawn")


def level_road(step: float = 0.01) -> RoadProfile:
    return RoadProfile([-20, 25], [0, 0], name="level").resample(step)


def added(road: RoadProfile, *some: RoadEvent) -> RoadProfile:
    """The road with events, unless several on one place make it too steep."""
    try:
        return add_events(road, *some)
    except ValueError as error:
        assume("is steeper than 1 m/m" not in str(error))
        raise


# What an event is


def test_an_event_is_nothing_before_its_start_and_stays_after_its_end() -> None:
    event = RoadEvent([1, 2, 4], [0, 0.02, -0.01], label="rut")
    assert event.rise_at([-9, 1, 1.5, 2, 3, 4, 99]) == pytest.approx(
        [0, 0, 0.01, 0.02, 0.005, -0.01, -0.01], abs=ROUND_OFF
    )


def test_an_event_keeps_read_only_copies_and_cannot_be_changed() -> None:
    x = np.array([0.0, 1.0])
    event = RoadEvent(x, [0, 0.01])
    x[0] = -5
    assert event.x.tolist() == [0.0, 1.0]
    with pytest.raises(ValueError, match="read-only"):
        event.rise[1] = 1.0
    with pytest.raises(dataclasses.FrozenInstanceError):
        event.label = "other"  # type: ignore[misc]


def test_events_are_equal_when_their_stations_and_rises_are() -> None:
    event, twin = step(0, 0.02), RoadEvent([0, 0.1], [0, 0.02], label="joint")
    assert event == twin
    assert hash(event) == hash(twin)
    assert event != step(0, 0.01)
    assert event != step(0.1, 0.02)
    assert event != "step"


def test_a_pickled_event_is_equal_and_read_only() -> None:
    event = bump(0, 1, 0.03)
    twin = pickle.loads(pickle.dumps(event))
    assert twin == event
    assert twin.label == event.label
    assert not twin.rise.flags.writeable


def test_the_repr_is_one_short_line() -> None:
    assert len(repr(bump(-5, 1, 0.03))) < 100
    assert "bump of 30 mm at -5 m" in repr(bump(-5, 1, 0.03))


@pytest.mark.parametrize(
    ("x", "rise", "message"),
    [
        ([0], [0], "one length of at least 2, got 1 and 1"),
        ([0, 1], [0, 0.1, 0], "got 2 and 3"),
        ([0, 0], [0, 0], r"x must increase .* x\[1\] = 0 m"),
        ([0, 1, 0.5], [0, 0, 0], r"x\[2\] = 0.5 m"),
        ([0, 1e-10], [0, 0], "more than 1e-09 m"),
        ([0, 1], [0.01, 0], "rise must begin with 0"),
        ([0, 1, 2], [0, 20, 20], r"rise\[1\] = 20 m .* slope above 1 m/m"),
        ([0, np.nan], [0, 0], "x must be finite"),
        ([0, 1], [0, np.inf], "rise must be finite"),
    ],
)
def test_an_event_that_is_no_piece_of_road_is_refused(x: list, rise: list, message: str) -> None:
    with pytest.raises(ValueError, match=message):
        RoadEvent(x, rise)


def test_a_label_is_a_string() -> None:
    with pytest.raises(TypeError, match="label must be a string, got 3"):
        RoadEvent([0, 1], [0, 0], label=3)  # type: ignore[arg-type]


# The shapes


@given(millimetres, heights)
def test_a_step_reaches_its_height_over_its_length_and_stays(x: float, height: float) -> None:
    rise = step(x, height, over=0.2).rise_at([x - 1, x, x + 0.1, x + 0.2, x + 50])
    assert rise == pytest.approx([0, 0, height / 2, height, height], abs=ROUND_OFF)


def test_a_step_is_a_short_ramp() -> None:
    assert step(3, -0.02) == ramp(3, 0.1, -0.02)


def test_a_plank_is_flat_between_its_edges_and_leaves_nothing_behind() -> None:
    rise = plank(2, 0.3, 0.04).rise_at([2, 2.025, 2.05, 2.15, 2.25, 2.275, 2.3, 9])
    assert rise == pytest.approx([0, 0.02, 0.04, 0.04, 0.04, 0.02, 0, 0], abs=ROUND_OFF)


@given(millimetres, lengths, heights)
def test_a_bump_has_its_peak_its_area_and_its_curve(x: float, length: float, height: float) -> None:
    event = bump(x, length, height)
    assert event.rise_at(x + length / 2) == pytest.approx(height, abs=ROUND_OFF)
    assert np.trapezoid(event.rise, event.x) == pytest.approx(height * length / 2, abs=ROUND_OFF)
    s = np.linspace(0, length, 2001)
    curve = height / 2 * (1 - np.cos(2 * np.pi * s / length))
    assert np.abs(event.rise_at(x + s) - curve).max() <= 1e-3 * abs(height) + ROUND_OFF
    assert event.rise[0] == event.rise[-1] == 0


def test_a_linear_settlement_is_a_ramp_up_to_the_abutment() -> None:
    assert settlement(12, 0.04) == ramp(-12, 12, 0.04)
    assert settlement(6, 0.04, x=25).x.tolist() == [19, 25]


@pytest.mark.slow
@given(st.integers(1, 12), depths)
def test_a_parabolic_settlement_follows_its_formula(length: int, depth: float) -> None:
    event = settlement(length, depth, shape="parabolic")
    s = np.linspace(0, length, 2001)  # distance before the abutment
    too_low = depth * (1 - (1 - s / length) ** 2)
    assert event.rise_at(-s) - depth == pytest.approx(-too_low, abs=1e-3 * depth + ROUND_OFF)
    assert event.rise_at(-length / 2) == pytest.approx(0.25 * depth, abs=ROUND_OFF)
    assert np.all(np.diff(event.rise, 2) >= -ROUND_OFF)  # steepest at the abutment


def test_a_settled_approach_differs_from_a_sunken_road_only_by_the_datum() -> None:
    event = settlement(12, 0.04)
    risen = add_events(level_road(), event)
    sunken = RoadProfile(risen.x, risen.elevation - 0.04)
    at = np.linspace(-20, 25, 500)
    assert risen.drop(at, -20) == pytest.approx(sunken.drop(at, -20), abs=ROUND_OFF)


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda: step(0, 0.2), "height = 0.2 m .* over = 0.1 m .* type over=0.2 or more"),
        (lambda: step(0, -20), "type over=20 or more, or height=-0.02 if it was in millimetres"),
        (lambda: ramp(0, 1, 1.5), "type length=1.5 or more"),
        (lambda: plank(0, 0.3, 0.06), "type over=0.06 or more"),
        (lambda: plank(0, 0.1, 0.04), "over = 0.05 m twice .* type over=0.025, or bump"),
        (lambda: bump(0, 0.1, 0.05), "type length=0.158 or more"),
        (lambda: bump(0, 0.1, -0.05), "height = -0.05 m .* type length=0.158 or more"),
        (lambda: settlement(6, 4, shape="parabolic"), "type length=8 or more"),
        (lambda: settlement(6, 0.04, shape="round"), "shape must be one of 'linear', 'parabolic'"),
        (lambda: settlement(6, -0.04), "depth must be 0 or more"),
        (lambda: step(0, 0.02, over=0), "over must be above 0"),
        (lambda: ramp(0, -1, 0.02), "length must be above 0"),
        (lambda: bump(np.nan, 1, 0.02), "x must be finite"),
        (lambda: step(0, np.inf), "height must be finite"),
    ],
)
def test_a_shape_no_tire_could_follow_is_refused(
    make: Callable[[], RoadEvent], message: str
) -> None:
    with pytest.raises(ValueError, match=message):
        make()


def test_the_length_that_a_refusal_suggests_is_accepted() -> None:
    bump(0, 0.158, 0.05)
    settlement(8, 4, shape="parabolic")
    step(0, 0.2, over=0.2)


@pytest.mark.parametrize("make", [lambda: step("0", 0.02), lambda: bump(0, [1], 0.02)])
def test_what_is_no_number_is_refused(make: Callable[[], RoadEvent]) -> None:
    with pytest.raises(TypeError, match="must be one number"):
        make()


# Adding events to a road


@given(roads(), st.lists(events(), min_size=1, max_size=4), st.lists(st.floats(-50, 30)))
def test_a_road_with_events_is_the_road_plus_the_events(
    road: RoadProfile, some: list[RoadEvent], extra: list[float]
) -> None:
    result = added(road, *some)
    at = np.concatenate([result.x, (result.x[1:] + result.x[:-1]) / 2, extra])
    expected = road.elevation_at(at) + sum(event.rise_at(at) for event in some)
    assert result.elevation_at(at) == pytest.approx(expected, abs=ROUND_OFF)
    assert result.name == road.name
    assert set(road.x) <= set(result.x)
    assert np.diff(result.x).min() > SAME_PLACE


@given(roads(), events(), events())
def test_the_order_of_events_does_not_matter(
    road: RoadProfile, one: RoadEvent, other: RoadEvent
) -> None:
    together = added(road, one, other)
    swapped = add_events(road, other, one)
    in_turn = add_events(add_events(road, other), one)
    assert swapped.x.tolist() == together.x.tolist()
    assert swapped.elevation == pytest.approx(together.elevation, abs=ROUND_OFF)
    assert in_turn.elevation_at(together.x) == pytest.approx(together.elevation, abs=ROUND_OFF)


@pytest.mark.slow
@given(roads(), events())
def test_the_difference_to_the_road_is_the_event(road: RoadProfile, event: RoadEvent) -> None:
    at = np.linspace(-50, 30, 4001)
    added = add_events(road, event).elevation_at(at) - road.elevation_at(at)
    assert added == pytest.approx(event.rise_at(at), abs=ROUND_OFF)


@given(roads())
def test_adding_nothing_changes_nothing(road: RoadProfile) -> None:
    assert add_events(road) == road


@pytest.mark.parametrize("apart", [0.0, 1e-16, -5e-10, 5e-10])
def test_points_closer_than_round_off_are_one_station(apart: float) -> None:
    road = RoadProfile([-1, 0, 1], [0, 0, 0])
    merged = add_events(road, RoadEvent([apart, 0.5], [0, 0.02]), step(0.5 + apart, 0.01))
    assert merged.x.size == 5
    assert merged.x[1] == 0
    far = add_events(road, RoadEvent([3e-9, 0.5], [0, 0.02]))
    assert far.x.size == 5


def test_an_event_may_reach_from_end_to_end_of_the_road() -> None:
    road = RoadProfile([0, 10], [0, 0])
    assert add_events(road, ramp(0, 10, 0.1)) == RoadProfile([0, 10], [0, 0.1])


@pytest.mark.parametrize("x", [-20.5, 24.5])
def test_an_event_off_the_road_is_refused_by_name(x: float) -> None:
    message = f"bump of 30 mm at {x:g} m lies at .* the road covers x from -20 m to 25 m"
    with pytest.raises(ValueError, match=message):
        add_events(level_road(), step(0, 0.02), bump(x, 1, 0.03))
    with pytest.raises(ValueError, match="event 2 lies at"):
        add_events(level_road(), step(0, 0.02), RoadEvent([90, 91], [0, 0]))


def test_events_that_add_up_too_steep_are_refused_by_name() -> None:
    message = r"from x = 0 m to 0.01 m \(step of 60 mm at 0 m, ramp of 60 mm at 0 m\)"
    with pytest.raises(ValueError, match=message):
        add_events(level_road(), step(0, 0.06), ramp(0, 0.1, 0.06), bump(5, 1, 0.03))


def test_a_list_of_events_is_refused_with_the_way_to_pass_it() -> None:
    with pytest.raises(TypeError, match=r"got list: .* add_events\(road, \*events\)"):
        add_events(level_road(), [step(0, 0.02)])  # type: ignore[arg-type]


@pytest.mark.parametrize("apply", [add_events, tire_footprint])
def test_what_is_no_road_is_refused(apply: Callable[[object], RoadProfile]) -> None:
    with pytest.raises(TypeError, match="road must be a RoadProfile, got list"):
        apply([0, 1])


# The tire's contact length


@given(roads(), st.floats(0.05, 3.0))
@pytest.mark.filterwarnings("ignore:the road's stations are too far apart")
def test_the_footprint_is_the_mean_elevation_under_the_tire(
    road: RoadProfile, length: float
) -> None:
    smooth = tire_footprint(road, length)
    assert smooth.x.tolist() == road.x.tolist()
    assert smooth.name == road.name
    for x, height in list(zip(smooth.x, smooth.elevation, strict=True))[
        :: max(1, road.x.size // 5)
    ]:
        ends = [x - length / 2, x + length / 2]
        bends = [*ends, *road.x[(road.x > ends[0]) & (road.x < ends[1])]]
        pieces = pairwise(sorted(bends))
        area = sum(quad(np.interp, a, b, args=(road.x, road.elevation))[0] for a, b in pieces)
        assert height == pytest.approx(area / length, abs=NANOMETRE)


@given(roads(), st.floats(0.01, 100.0))
@pytest.mark.filterwarnings("ignore:the road's stations are too far apart")
def test_the_footprint_never_increases_the_range(road: RoadProfile, length: float) -> None:
    smooth = tire_footprint(road, length)
    assert smooth.elevation.min() >= road.elevation.min()
    assert smooth.elevation.max() <= road.elevation.max()


@given(st.floats(-3000, 3000), st.floats(0.01, 100.0))
def test_a_level_road_is_unchanged(elevation: float, length: float) -> None:
    road = RoadProfile([-10, 0, 3, 25], [elevation] * 4)
    assert tire_footprint(road, length) == road


@given(st.sets(st.integers(1, 999), max_size=50), st.floats(-0.1, 0.1))
def test_a_grade_is_unchanged_away_from_its_ends(inside: set[int], slope: float) -> None:
    x = np.array(sorted({0, 0.12, 0.24, *inside, 999.76, 999.88, 1000}))
    road = RoadProfile(x, 500 + slope * x)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", UserWarning)  # it bends at both ends
        smooth = tire_footprint(road)
    middle = (x > 0.12 - 1e-9) & (x < 1000 - 0.12 + 1e-9)
    assert smooth.elevation[middle] == pytest.approx(road.elevation[middle], abs=NANOMETRE)


@given(st.integers(1, 100), st.lists(st.floats(-0.005, 0.005), min_size=1, max_size=50))
def test_the_footprint_keeps_the_mean(pieces: int, ripples: list[float]) -> None:
    """The contact length is a whole number of steps, and the road level near its ends."""
    road = RoadProfile(0.01 * np.arange(251), [*[0] * 100, *ripples, *[0] * (151 - len(ripples))])
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", UserWarning)  # of a step or two it is short for ripples
        smooth = tire_footprint(road, 0.01 * pieces)
    area = np.trapezoid(road.elevation, road.x)
    assert np.trapezoid(smooth.elevation, smooth.x) == pytest.approx(area, abs=ROUND_OFF)


@pytest.mark.parametrize("wavelength", [0.24, 0.5, 1.0, 3.0])
def test_the_footprint_of_a_wave_is_the_wave_times_a_sinc(wavelength: float) -> None:
    x, step_length = np.linspace(0, 20, 4001), 0.005
    amplitude = 0.005 * wavelength
    road = RoadProfile(x, amplitude * np.sin(2 * np.pi * x / wavelength))
    smooth = tire_footprint(road)
    interpolation = amplitude * (2 * np.pi * step_length / wavelength) ** 2 / 8
    inside = (x > 0.13) & (x < 19.87)
    expected = np.sinc(0.24 / wavelength) * road.elevation
    assert np.abs(smooth.elevation - expected)[inside].max() <= interpolation + ROUND_OFF


@given(st.integers(2, 40), st.integers(2, 100))
def test_the_footprint_of_a_step_is_a_ramp_longer_by_the_contact_length(
    over: int, length: int
) -> None:
    over_m, length_m = 0.01 * over, 0.01 * length
    event = step(0, 0.02, over=over_m)
    smooth = tire_footprint(add_events(level_road(0.005), event), length_m)
    before, after = -length_m / 2, over_m + length_m / 2
    assert np.all(np.abs(smooth.elevation[smooth.x <= before + 1e-9]) < ROUND_OFF)
    assert np.all(np.abs(smooth.elevation[smooth.x >= after - 1e-9] - 0.02) < ROUND_OFF)
    rising = (smooth.x >= before - 1e-9) & (smooth.x <= after + 1e-9)
    assert np.all(np.diff(smooth.elevation[rising]) > 0)
    middle = smooth.elevation_at([before + 0.005, over_m / 2, after - 0.005])
    assert middle[1] == pytest.approx(0.01, abs=ROUND_OFF)
    steepest = 0.02 / max(over_m, length_m)
    assert np.diff(smooth.elevation).max() <= steepest * 0.005 + ROUND_OFF


def test_a_road_too_coarse_for_its_footprint_is_warned_of() -> None:
    road = add_events(RoadProfile([-20, 25], [0, 0]), step(0, 0.02))
    with pytest.warns(UserWarning, match=r"too far apart .* road.resample\(0.048\)"):
        tire_footprint(road)
    fine = tire_footprint(road.resample(0.048))
    assert fine.elevation_at(-1) == 0


def test_the_footprint_of_a_measured_road_changes_millimetres() -> None:
    road = utia_road()
    assert 0.5e-3 < np.abs(tire_footprint(road).elevation - road.elevation).max() < 10e-3


@pytest.mark.parametrize("length", [0, -0.24, np.nan])
def test_a_contact_length_is_positive(length: float) -> None:
    with pytest.raises(ValueError, match="length must be"):
        tire_footprint(level_road(), length)


# What a crossing feels


def test_a_step_at_the_bridge_start_raises_the_daf_and_the_footprint_eases_the_tire(
    bridge: bc.Beam, truck: bc.QuarterCar
) -> None:
    level = level_road(0.02)
    stepped = add_events(level, step(0.0, 0.020))
    eased = tire_footprint(stepped)
    speed = 90 / 3.6
    smooth_daf, stepped_daf = (
        float(bc.daf(bridge, truck, speed, road, start=-10)[0]) for road in (level, stepped)
    )
    assert stepped_daf > smooth_daf + 0.01
    peaks = [
        bc.crossing_response(bridge, truck, speed, road, start=-10).outputs["tire_force"].max()
        for road in (level, stepped, eased)
    ]
    assert peaks[1] > peaks[0] + 20e3  # newtons
    assert peaks[0] + 20e3 < peaks[2] < peaks[1] - 500
