"""The DAF against the height of one ramp: simulated, by the DAE of both orders, and drawn."""

import numpy as np
import pytest
from helpers import NO_DAMPERS, loop_of_the_control_library, without_dampers
from test_closed_loop import LAWS, random_loop

import bridgectl as bc
from bridgectl import ramp_heights
from bridgectl.dampers import Damper, bridgehook, passive
from bridgectl.plots.ramp_heights import ramp_height_figure

SPEED, PLACE = 25.0, -35.0


@pytest.fixture(scope="module")
def found(bridge, truck):
    """Of a passive damper, bridgehook and preset."""
    return {
        name: ramp_heights(bridge, truck, LAWS[name], SPEED, PLACE)
        for name in ("passive", "bridgehook", "PDD")
    }


def one_ramp(place, drop, start=-60.0, end=25.0):
    return bc.RoadProfile([start, place, place + 0.1, end], [0, 0, -drop, -drop])


@pytest.mark.slow
def test_a_linear_daf_is_that_of_the_control_library(bridge, truck):
    """Of ramps on the bridge and before it, down and up: within 1e-4 of the static moment."""
    for place, drop in ((-5.0, 0.02), (6.0, -0.01)):
        at = ramp_heights(bridge, truck, passive(truck.damping), 30.0, place, approach=10.0)
        road = one_ramp(place, drop, start=-10.0)
        expected = bc.daf(bridge, truck, 30.0, road, start=-10, method="control")[0]
        assert np.interp(drop, at.heights, at.daf) == pytest.approx(expected, abs=1e-4)


@pytest.mark.quick_cases(1)
@pytest.mark.parametrize("name", ["passive", "bridgehook", "PDD"])
def test_every_daf_is_that_of_the_road_of_one_ramp(bridge, truck, found, name):
    """Simulated alone, within 1e-4 of the static moment."""
    at = found[name]
    for k in (0, 25, 41, 60, -1):
        road = one_ramp(PLACE, at.heights[k])
        alone = bc.daf(bridge, truck, SPEED, road, start=-60, damper=LAWS[name])[0]
        assert at.daf[k] == pytest.approx(alone, abs=1e-4)


@pytest.mark.parametrize("seed", [0, *(pytest.param(s, marks=pytest.mark.slow) for s in (1, 2, 3))])
def test_a_switching_daf_is_that_of_the_control_library(seed):
    """Of random short bridges and trucks, skyhook with sampling: within 1e-4."""
    beam, car, options, speed, _ = random_loop(seed)
    damper = Damper(LAWS["skyhook"], **{**options, "max_force": np.inf})
    at = ramp_heights(beam, car, damper, speed, 1.0, approach=1.0, largest=5e-3, ramp_height=5e-3)
    for k in (0, -1):
        road = one_ramp(1.0, at.heights[k], start=-1.0, end=beam.length)
        expected = loop_of_the_control_library(beam, car, damper, speed, road)
        assert at.daf[k] == pytest.approx(expected, abs=1e-4)


@pytest.mark.parametrize("name", ["passive", "bridgehook", "PDD"])
def test_the_parabola_meets_the_daf_at_both_heights_and_on_the_smooth_road(found, name):
    """Within 1e-4; between them it is a parabola, whose third differences are none."""
    at = found[name]
    nodes = np.searchsorted(at.heights, [-at.ramp_height, 0.0, at.ramp_height])
    assert at.heights[nodes].tolist() == [-at.ramp_height, 0.0, at.ramp_height]
    assert at.second_order[nodes] == pytest.approx(at.daf[nodes], abs=1e-4)
    parabola = np.polynomial.Polynomial.fit(at.heights, at.second_order, 2)
    assert at.second_order == pytest.approx(parabola(at.heights), abs=1e-12)


@pytest.mark.quick_cases(1)
@pytest.mark.parametrize("name", ["passive", "bridgehook", "PDD"])
def test_the_line_has_the_slope_of_a_drop_of_1_mm(bridge, truck, found, name):
    """Eq. (15), from two simulated roads: within 1e-4 for each mm."""
    at = found[name]
    smooth, drop = (
        bc.daf(bridge, truck, SPEED, one_ramp(PLACE, d), start=-60, damper=LAWS[name])[0]
        for d in (0.0, 1e-3)
    )
    assert at.first_order == pytest.approx(smooth + (drop - smooth) * at.heights / 1e-3, abs=2e-3)
    steps = np.diff(at.first_order) / np.diff(at.heights)
    assert steps == pytest.approx((drop - smooth) / 1e-3, abs=0.1)  # 1/m


@pytest.mark.slow
def test_a_passive_damper_has_a_convex_daf_and_a_switching_one_has_not(bridge, truck):
    """Where the peak moves to another time, on the bridge too; the simulation's own error apart."""
    for place in (PLACE, 8.0):
        bends = [
            np.diff(np.diff(at.daf) / np.diff(at.heights))
            for at in (
                ramp_heights(bridge, truck, LAWS[name], SPEED, place)
                for name in ("passive", "bridgehook")
            )
        ]
        assert bends[0].min() > -0.02  # 1/m, of slopes of some 1/m
        assert bends[1].min() < -0.5


def test_the_even_part_of_the_bridgehook_is_a_gain_that_the_line_does_not_have(found):
    """At the place of the figure: 0.025 of the static moment, at drops and rises alike."""
    errors = {
        name: [
            np.sqrt(np.mean((estimate - at.daf) ** 2))
            for estimate in (at.first_order, at.second_order)
        ]
        for name, at in found.items()
    }
    assert max(errors["passive"]) < 1e-4
    assert errors["bridgehook"][0] > 3 * errors["bridgehook"][1]
    at = found["bridgehook"]
    rise, smooth, drop = np.interp([-at.ramp_height, 0, at.ramp_height], at.heights, at.daf)
    assert max(rise, drop) < smooth - 0.01
    assert (rise + drop) / 2 - smooth == pytest.approx(-0.025, abs=0.002)


def test_heights_reach_both_ways_and_hold_that_of_the_class(bridge, truck, found):
    at = found["passive"]
    assert at.heights.size == 83
    assert at.heights == pytest.approx(-at.heights[::-1], abs=0)
    assert np.all(np.diff(at.heights) > 0)
    assert at.ramp_height == pytest.approx(13.45e-3, abs=0.01e-3)
    assert repr(at) == (
        "RampHeights('passive 7 kN s/m', 83 heights up to 20 mm at x = -35 m and 90 km/h, DAF from "
        f"{at.daf.min():.4f} to {at.daf.max():.4f})"
    )
    tall = ramp_heights(bridge, truck, LAWS["passive"], SPEED, PLACE, ramp_height="B")
    assert tall.heights[-1] == tall.ramp_height == pytest.approx(26.9e-3, abs=0.02e-3)


@pytest.mark.parametrize(("place", "nearest"), [(-5, -5.0), (24.9, 24.9), (3.04, 3.0)])
def test_the_first_and_the_last_place_and_those_between_are_taken(bridge, truck, place, nearest):
    at = ramp_heights(bridge, truck, passive(7e3), 30.0, place, approach=5.0)
    assert at.place == pytest.approx(nearest)
    road = one_ramp(nearest, 0.02, start=-5.1, end=25.1)
    alone = bc.daf(bridge, truck, 30.0, road, start=-5)[0]
    assert at.daf[-1] == pytest.approx(alone, abs=1e-4)


# The figure


@pytest.fixture(scope="module")
def figure(bridge, truck):
    laws = [passive(7e3), bridgehook(bridge, truck, 1e3, 30e3)]
    first, *others = (ramp_heights(bridge, truck, law, SPEED, PLACE) for law in laws)
    return first.plot(*others)


def lines_of(axes):
    return {line.get_label(): line for line in axes.lines}


def test_the_figure_has_a_panel_for_each_damper_with_units(figure):
    assert len(figure.axes) == 2
    for axes in figure.axes:
        assert axes.get_xlabel() == "height of the ramp, positive for a drop [mm]"
        assert not lines_of(axes).keys() & {"tire leaves the road"}
    assert figure.axes[0].get_ylabel() == "dynamic amplification DAF, DAE [-]"
    assert "x = -35 m from the start of the bridge, 90 km/h" in figure.get_suptitle()
    assert "bridgehook" in figure.axes[1].get_title(loc="left")
    assert len(figure.legends[0].get_texts()) == 5


def test_the_figure_draws_the_numbers(figure, found):
    for axes, name in zip(figure.axes, ("passive", "bridgehook"), strict=True):
        at, lines = found[name], lines_of(axes)
        assert np.array_equal(lines["simulated DAF"].get_ydata(), at.daf)
        assert np.array_equal(
            lines["DAE, Eq. (15): line of a 1 mm drop"].get_ydata(), at.first_order
        )
        order_2 = next(line for label, line in lines.items() if label.startswith("DAE of order 2"))
        assert np.array_equal(order_2.get_ydata(), at.second_order)
        points = axes.lines[-1].get_xydata()
        h = 1e3 * at.ramp_height
        assert points[:, 0] == pytest.approx([-h, 0, h])
        assert points[:, 1] == pytest.approx(np.interp(points[:, 0], 1e3 * at.heights, at.daf))


@pytest.mark.slow
def test_four_dampers_take_two_rows_and_flights_are_marked(bridge, truck):
    laws = [passive(c) for c in (3e3, 7e3, 12e3, 20e3)]
    figure = ramp_height_figure(
        [ramp_heights(bridge, truck, law, 22.0, 8.0, approach=5.0, largest=0.08) for law in laws]
    )
    assert len(figure.axes) == 4
    rows = {axes.get_subplotspec().rowspan.start for axes in figure.axes}
    assert rows == {0, 1}
    flying = lines_of(figure.axes[0])["tire leaves the road"].get_xdata()
    assert np.abs(flying).min() > 40  # mm


# Bad input


@pytest.mark.parametrize(
    ("changed", "error", "message"),
    [
        ({"place": -70.0}, ValueError, r"place must lie .* -60 m,.* 24\.9 m, got -70.*approach=70"),
        ({"place": 25.0}, ValueError, "place must lie between"),
        ({"place": "5"}, TypeError, "place must be one number .*type 5, without quotes"),
        ({"place": np.nan}, ValueError, "place must be finite"),
        ({"speed": [20.0, 25.0]}, TypeError, "speed must be one number"),
        ({"speed": [25.0]}, TypeError, "type 25, without brackets"),
        ({"speed": -25.0}, ValueError, "speed must be above 0"),
        ({"approach": -60.0}, ValueError, "approach must be 0 or more"),
        ({"largest": 20.0}, ValueError, "largest must not exceed the ramp's length .* type 0.02"),
        ({"largest": 0.0}, ValueError, "largest must be above 0"),
        ({"ramp_height": "Z"}, ValueError, "one of 'A'"),
        ({"ramp_height": 13.0}, ValueError, "ramp_height must not exceed"),
        ({"damper": 7e3}, TypeError, r"type bridgectl\.dampers\.passive\(7e3\)"),
        ({"vehicle": None}, TypeError, "vehicle must be a bridgectl.Vehicle or QuarterCar"),
        ({"vehicle": without_dampers()}, ValueError, NO_DAMPERS),
        ({"beam": 25.0}, TypeError, "beam"),
    ],
)  # fmt: skip
def test_each_mistake_is_named(bridge, truck, changed, error, message):
    given = {"beam": bridge, "vehicle": truck, "damper": passive(7e3), "speed": SPEED}
    given |= {"place": PLACE} | changed
    with pytest.raises(error, match=message):
        ramp_heights(**given)


@pytest.mark.parametrize("given", [passive(7e3), [], "skyhook", [passive(7e3)]])
def test_what_is_no_list_of_results_is_not_drawn(given):
    with pytest.raises(TypeError, match=r"found must be a list .* type .*\.ramp_heights\(beam"):
        ramp_height_figure(given)


def test_one_figure_is_of_one_place_and_speed(bridge, truck, found):
    other = ramp_heights(bridge, truck, passive(7e3), 20.0, 5.0, approach=0.0)
    with pytest.raises(ValueError, match=r"got x = -35 m .* 90 km/h and x = 5 m .* 72 km/h"):
        ramp_height_figure([found["passive"], found["PDD"], other])


def test_a_speed_in_kmh_is_told_once(bridge, truck):
    with pytest.warns(bc.PlausibilityWarning, match="for 90 km/h type 90 / 3.6") as told:
        ramp_heights(bridge, truck, passive(7e3), 90.0, 5.0, approach=0.0)
    assert len(told) == 1
