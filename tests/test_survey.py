"""A road from surveyed points is the road that was surveyed, however the points come."""

import numpy as np
import pytest

import bridgectl as bc
from bridgectl.road import tire_footprint

from_survey = bc.RoadProfile.from_survey
RADIUS, BRIDGE = 400.0, 200.0
ROAD = bc.iso8608_profile("A", 280, seed=3, step=0.05)
PLACES = np.arange(-195.0, 75.0, 0.25)


def points(s, spread=0.0, seed=0):
    """Points of a left turn by 40 degrees [m], at ways along it, that scatter sideways."""
    noise = np.random.default_rng(seed).normal(0, spread, (2, s.size))
    return np.array([RADIUS * np.sin(s / RADIUS), RADIUS * (1 - np.cos(s / RADIUS))]) + noise


ABUTMENT = tuple(points(np.array([BRIDGE]))[:, 0])


def test_stations_of_a_bend_are_ways_along_it_within_2_mm():
    s = np.arange(0.0, 280.0, 0.07)
    road = from_survey(*points(s), 0.03 * s, bridge=ABUTMENT)  # a grade of 3 %
    ways = road.elevation_at(PLACES) / 0.03 - BRIDGE
    assert ways == pytest.approx(PLACES, abs=2e-3)


def test_a_bend_of_90_degrees_is_as_long_as_its_closed_form_within_1e_6():
    """A parabola whose slope t goes from -1 to 1, of the way (t sqrt(1 + t^2) + asinh(t)) R / 2."""
    east = np.linspace(-150.0, 150.0, 2001)
    t = east / 150
    way = 75 * (t * np.hypot(1, t) + np.arcsinh(t))
    road = from_survey(east, east**2 / 300, 0.03 * (way - way[0]))
    assert road.x[-1] == 344.0
    assert road.elevation_at(344.0) / 0.03 == pytest.approx(344.0, rel=1e-6)


def test_a_stop_and_the_noise_of_the_receiver_do_not_stretch_the_road():
    """By less than 0.1 m, where adding up distances makes it 25 m longer."""
    s = np.concatenate([np.arange(0, 70, 0.07), np.full(600, 70.0), np.arange(70, 280, 0.07)])
    east, north = points(s, spread=0.015, seed=1)
    added = np.hypot(np.diff(east), np.diff(north)).sum()
    road = from_survey(east, north, ROAD.elevation_at(s))
    assert added > 280 + 20
    assert road.x[[0, -1]] == pytest.approx([0, 280], abs=0.3)
    averaged = tire_footprint(ROAD, 0.25).resample(0.25)
    assert road.iri() == pytest.approx(averaged.iri(), abs=0.05)  # m/km


def test_the_order_of_driving_tells_the_direction():
    s = np.arange(0.0, 280.0, 0.07)
    there = from_survey(*points(s), s / 100, bridge=ABUTMENT)
    back = from_survey(*points(s)[:, ::-1], s[::-1] / 100, bridge=ABUTMENT)
    assert there.elevation_at(50.0) == pytest.approx((BRIDGE + 50) / 100, abs=1e-4)
    assert back.elevation_at(50.0) == pytest.approx((BRIDGE - 50) / 100, abs=1e-4)


def test_noise_of_heights_falls_with_the_square_root_of_points_in_a_step():
    """From 1 mm at 25 points a step to 0.2 mm, within 10 %; and 1 mm is an IRI of 1.6 m/km."""
    rng, s = np.random.default_rng(2), np.arange(0.0, 500.0, 0.01)
    road = from_survey(s, 0 * s, rng.normal(0, 1e-3, s.size), name="noise")
    assert road.name == "noise"
    assert 1e3 * road.elevation.std() == pytest.approx(0.2, rel=0.1)
    coarse = bc.RoadProfile(0.25 * np.arange(4000), rng.normal(0, 1e-3, 4000))
    assert coarse.iri() == pytest.approx(1.6, abs=0.1)


def test_a_grade_stays_one_wherever_in_a_step_its_points_lie():
    s = np.sort(np.random.default_rng(4).uniform(0, 100, 900))
    with pytest.warns(UserWarning, match="the road has no point from x = "):
        road = from_survey(s, 2 * s, 0.1 * s, bridge=(0, 0), step=0.3)
    assert road.elevation == pytest.approx(0.1 * road.x / 5**0.5, abs=1e-9)


def test_stretches_without_points_draw_a_warning():
    s = np.concatenate([np.arange(0, 40, 0.1), np.arange(43, 80, 0.1)])
    with pytest.warns(UserWarning, match=r"no point from x = 39\.9 to 43 m, and counts as straigh"):
        from_survey(s, 0 * s, 0 * s)


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"north": [0.0, 1.0]}, "must have one length of at least 3, got 50, 2 and 50 values"),
        ({"east": 14 + np.arange(50) / 1e6, "north": np.full(50, 50.0)}, r"radians\(latitude -"),
        (
            {"east": np.arange(50.0), "north": 9.0 * (-1) ** np.arange(50)},
            r"stray from it by (8\.\d|9) m",
        ),
        ({"step": 0.0}, "step must be above 0"),
        ({"bridge": [1.0]}, r"bridge must have shape \(2,\)"),
        ({"elevation": 1e3 * (-1) ** np.arange(50)}, "looks like millimetres"),
    ],
)
def test_what_is_no_survey_is_refused_with_what_to_pass(change, message):
    line = {"east": np.arange(50) / 4, "north": np.zeros(50), "elevation": np.zeros(50)}
    with pytest.raises(ValueError, match=message):
        from_survey(**(line | change))
