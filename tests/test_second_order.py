"""Ramps both ways: odd and even effects, the DAE of second order, and that of a road class."""

import dataclasses
import warnings

import numpy as np
import pytest
from helpers import loop_of_the_control_library, rough_road
from scipy.stats import kendalltau
from test_closed_loop import LAWS, SOFT, STIFF, laws, random_loop

import bridgectl as bc
from bridgectl import dampers
from bridgectl.dampers import Damper, simulate_loop
from bridgectl.plots import effects_figure
from bridgectl.road import iso8608_elevations
from bridgectl.road.iso8608 import ramp_covariance

SPEEDS = np.array([60, 90, 108]) / 3.6
EVERY = 25


@pytest.fixture(scope="module")
def surface(bridge, truck):
    """A linear one, of class A."""
    return bc.ramp_surface(bridge, truck, SPEEDS, approach=20, ramp_height="A", both_ways=True)


@pytest.fixture(scope="module")
def hooked(bridge, truck):
    law = LAWS["bridgehook"]
    return bc.ramp_surface(
        bridge, truck, SPEEDS, approach=20, ramp_height="A", both_ways=True, every=EVERY, damper=law
    )


# The surface


def test_the_height_of_a_class_is_that_of_one_ramp_for_all(bridge, truck):
    """Sigma is 0.461 mm for class A, and twice that for B of four times the roughness."""
    for iso_class, sigma in (("A", 0.4614e-3), ("B", 0.9228e-3)):
        found = bc.ramp_surface(bridge, truck, 25.0, approach=60, ramp_height=iso_class)
        assert found.ramp_height == pytest.approx(sigma * np.sqrt(850), rel=1e-3)


@pytest.mark.slow
@pytest.mark.parametrize(("ramp", "sign"), [(160, 1), (60, -1), (230, -1)])
def test_a_drop_and_a_rise_are_that_road_simulated(surface, bridge, truck, ramp, sign):
    """By the control library, within 1e-4 of the static moment."""
    drops = np.zeros(len(surface.positions))
    drops[ramp] = sign * surface.ramp_height
    road = surface.road(drops)
    expected = bc.daf(bridge, truck, SPEEDS, road, start=-20, method="control")
    found = surface.daf_unit if sign > 0 else surface.daf_rise
    assert found[:, ramp] == pytest.approx(expected, abs=1e-4)


def ramp_of_a_law(name, seed):
    """DAFs of a ramp by the surface and by the control library, down and up."""
    beam, car, options, speed, _ = random_loop(seed)
    rng = np.random.default_rng((seed, 11))
    damper = Damper(laws(beam, car)[name], **{**options, "max_force": np.inf})
    surface = bc.ramp_surface(
        beam, car, speed, approach=1.0, ramp_length=0.5, ramp_height=5e-3, both_ways=True,
        damper=damper,
    )  # fmt: skip
    ramp = int(rng.integers(0, len(surface.positions)))
    found, expected = [surface.daf_unit[0, ramp], surface.daf_rise[0, ramp]], []
    for drop in (5e-3, -5e-3):
        z = -drop * (surface.stations > surface.positions[ramp] + 0.1)
        road = bc.RoadProfile(surface.stations, z)
        expected.append(loop_of_the_control_library(beam, car, damper, speed, road))
    return found, expected


@pytest.mark.parametrize(
    ("name", "seed"),
    [
        pytest.param(name, seed, marks=() if seed == 0 and name == "skyhook" else pytest.mark.slow)
        for name in ("skyhook", "groundhook", "clipped LQR", "bridgehook", "PDD", "program")
        for seed in range(5)
    ],
)
def test_odd_and_even_effects_of_a_law_are_those_of_the_control_library(name, seed):
    """Thirty random bridges, trucks, speeds and places: within 1e-4 of the static moment."""
    found, expected = ramp_of_a_law(name, seed)
    assert found == pytest.approx(expected, abs=1e-4)


@pytest.mark.slow
@pytest.mark.parametrize("height", [0.03, 0.08])
@pytest.mark.parametrize("damper", [None, "passive"])
def test_a_ramp_that_lifts_the_tire_is_simulated_with_flight(bridge, truck, height, damper):
    """30 mm do not, and pass without a word; of 80 mm the linear crossing would be 0.1 off."""
    options = {"approach": 10, "ramp_height": height, "both_ways": True, "every": 50}
    options["damper"] = None if damper is None else LAWS[damper]
    with warnings.catch_warnings(record=True) as told:
        warnings.simplefilter("always")
        found = bc.ramp_surface(bridge, truck, SPEEDS[1:], **options)
        lifts = [bool(told)]
        for ramp in (50, 150, 200):
            for sign, dafs in ((1, found.daf_unit), (-1, found.daf_rise)):
                drops = np.zeros(len(found.positions))
                drops[ramp] = sign * height
                road = found.road(drops)
                simulated = bc.daf(bridge, truck, SPEEDS[1:], road, start=-10)
                assert dafs[:, ramp] == pytest.approx(simulated, abs=1e-12)
        assert lifts == [height > 0.05]
    if height > 0.05:
        assert issubclass(told[0].category, bc.LiftOffWarning)
        assert "ramps of 0.08 m" in str(told[0].message)
        assert told[0].filename == __file__


def test_effects_are_the_odd_and_the_even_part(surface):
    drop = surface.daf_smooth[:, np.newaxis] + surface.even_effect + surface.odd_effect
    rise = surface.daf_smooth[:, np.newaxis] + surface.even_effect - surface.odd_effect
    assert drop == pytest.approx(surface.daf_unit, abs=1e-15)
    assert rise == pytest.approx(surface.daf_rise, abs=1e-15)


def test_the_even_part_of_a_linear_crossing_is_not_negative(surface):
    """The maximum of histories that go with the ramp is convex in it."""
    assert surface.even_effect.min() > -1e-6
    assert surface.even_effect.max() > 0.01


def test_places_between_are_on_straight_lines(bridge, truck, surface):
    options = {"approach": 20, "ramp_height": "A", "both_ways": True}
    thin = bc.ramp_surface(bridge, truck, SPEEDS, every=EVERY, **options)
    assert np.array_equal(thin.daf_rise[:, ::EVERY], surface.daf_rise[:, ::EVERY])
    middle = (thin.daf_unit[:, 100] + thin.daf_unit[:, 100 + EVERY]) / 2
    assert (thin.daf_unit[:, 112] + thin.daf_unit[:, 113]) / 2 == pytest.approx(middle, abs=1e-12)
    assert "computed at one place in 25" in repr(thin)
    assert "both ways" in repr(thin)


def test_a_constant_and_a_preset_damper_have_both_ways_too(bridge, truck):
    options = {"approach": 5, "ramp_height": 5e-3, "both_ways": True}
    own = bc.ramp_surface(bridge, truck, SPEEDS, **options)
    constant = bc.ramp_surface(bridge, truck, SPEEDS, damper=LAWS["passive"], **options)
    assert np.array_equal(constant.daf_rise, own.daf_rise)
    best = bc.ramp_surface(bridge, truck, SPEEDS, damper=LAWS["preset"], every=2, **options)
    each = [
        bc.ramp_surface(bridge, dataclasses.replace(truck, damping=c), SPEEDS, **options).daf_rise
        for c in LAWS["preset"].kept
    ]
    assert best.daf_rise[:, ::2] == pytest.approx(np.min(each, axis=0)[:, ::2], abs=1e-12)


def test_a_surface_both_ways_is_saved_and_loaded(hooked, surface, tmp_path):
    surface.save(tmp_path / "both.npz")
    loaded = bc.load_surface(tmp_path / "both.npz")
    assert np.array_equal(loaded.daf_rise, surface.daf_rise)
    road = iso8608_elevations(1, "A", 45, seed=1)
    assert np.array_equal(loaded.dae(road, order=2), surface.dae(road, order=2))


# The estimate


def test_the_second_order_is_its_formula(surface):
    road = rough_road(1, -20, 25)
    s = surface.ramps(road)
    first, second = surface.odd_effect @ s, surface.even_effect @ s**2
    found = surface.dae(road, order=2)
    assert found == pytest.approx(surface.daf_smooth + first + second, abs=1e-13)
    parts = surface.contributions(road, order=2).sum(axis=1)
    assert parts == pytest.approx(first + second, abs=1e-13)
    assert surface.dae(road) == pytest.approx(surface.daf_smooth + surface.daf_difference @ s)


@pytest.mark.slow
@pytest.mark.parametrize("iso_class", ["A", "B"])
def test_the_second_order_estimates_single_roads_better(bridge, truck, iso_class):
    """The rms error on 60 fresh roads at 13 speeds of 60 to 120 km/h, over five strategies, is at
    most 0.65 of that of Eq. (15): 0.64 and 0.62. Of the passive damper alone it is 0.7.
    """
    speeds, x = np.linspace(60, 120, 13) / 3.6, -60 + 0.1 * np.arange(851)
    roads = iso8608_elevations(60, iso_class, 85, seed=5)
    squares = np.zeros(2)
    for name in ("passive", "skyhook", "groundhook", "PDD", "bridgehook"):
        law = LAWS[name]
        exact = simulate_loop(bridge, truck, law, speeds, x, roads).daf.T
        options = {"approach": 60, "damper": law}
        one = bc.ramp_surface(bridge, truck, speeds, **options)
        both = bc.ramp_surface(
            bridge, truck, speeds, ramp_height=iso_class, both_ways=True, every=5, **options
        )
        errors = one.dae(roads) - exact, both.dae(roads, order=2) - exact
        squares += [np.mean(error**2) for error in errors]
    assert np.sqrt(squares[1] / squares[0]) < 0.65


# Road classes


def test_the_covariance_of_ramps_is_that_of_synthesised_roads():
    """Of 4000 roads of 850 ramps, by neighbours: within 1 % of the variance."""
    elevations = iso8608_elevations(4000, "A", 85, seed=0)
    drops = elevations[:, :-1] - elevations[:, 1:]
    found = [np.mean(drops[:, : 850 - k] * drops[:, k:]) for k in range(6)]
    expected = ramp_covariance("A", 850)
    assert found == pytest.approx(expected[:6], abs=0.01 * expected[0])


def test_the_covariance_of_ramps_is_the_integral_over_the_spectrum():
    """G(n) = G_0 (n / n_0)^-w times 4 sin^2(pi n l) cos(2 pi n k l), w = 2.5, 0.25 m."""
    n = np.linspace(0.01, 2.0, 400_001)
    found = ramp_covariance(20e-6, 4, 0.25, waviness=2.5, band=(0.01, 2.0))
    power = 20e-6 * (n / 0.1) ** -2.5 * 4 * np.sin(np.pi * n * 0.25) ** 2
    for k in range(4):
        whole = np.trapezoid(power * np.cos(2 * np.pi * n * k * 0.25), n)
        assert found[k] == pytest.approx(whole, abs=5e-3 * found[0])


@pytest.mark.parametrize("which", ["surface", "hooked"])
def test_mean_and_spread_over_a_class_are_those_of_its_roads(request, which):
    """Of 3000 roads: means within 0.002, standard deviations within 6 %, percentiles 0.004."""
    found = request.getfixturevalue(which)
    closed = found.class_dae("A")
    sampled = found.dae(iso8608_elevations(3000, "A", 45, seed=3), order=2)
    assert closed.order == 2
    assert closed.mean == pytest.approx(sampled.mean(axis=0), abs=0.002)
    assert closed.sd == pytest.approx(sampled.std(axis=0), rel=0.06)
    percentiles = np.percentile(sampled, [5, 95], axis=0)
    assert closed.percentile([5, 95]) == pytest.approx(percentiles, abs=0.004)
    assert closed.percentile(50) == pytest.approx(closed.mean)
    assert repr(closed).startswith("ClassDae(order 2, 3 speeds, mean from ")


def test_of_one_way_the_mean_is_that_of_a_smooth_road(bridge, truck):
    one = bc.ramp_surface(bridge, truck, SPEEDS, approach=20)
    closed = one.class_dae("B")
    assert np.array_equal(closed.mean, one.daf_smooth)
    sampled = one.dae(iso8608_elevations(3000, "B", 45, seed=3)).std(axis=0)
    assert closed.sd == pytest.approx(sampled, rel=0.06)
    assert one.class_dae(4 * 16e-6).sd == pytest.approx(closed.sd)


@pytest.mark.slow
def test_a_class_tells_the_bridgehook_from_the_passive_damper_as_simulation_does(
    bridge, truck, hooked, surface
):
    """Eq. (15) does not: of first order both have the smooth DAF, 0.003 apart at most."""
    gain = surface.class_dae("A").mean - hooked.class_dae("A").mean
    x, roads = -20 + 0.1 * np.arange(451), iso8608_elevations(60, "A", 45, seed=9)
    dafs = [
        simulate_loop(bridge, truck, law, SPEEDS, x, np.vstack([roads, -roads])).daf.mean(axis=1)
        for law in (LAWS["passive"], LAWS["bridgehook"])
    ]
    assert np.all(gain > 0.005)
    assert np.all(dafs[0] - dafs[1] > 0.02)
    assert hooked.daf_smooth == pytest.approx(surface.daf_smooth, abs=0.003)


@pytest.mark.slow
@pytest.mark.parametrize(("iso_class", "least"), [("A", 0.80), ("B", 0.85)])
def test_the_mean_over_a_class_ranks_dampers_as_simulation_does(bridge, truck, iso_class, least):
    """Of 23 strategies, on 60 roads and their mirror images at 13 speeds of 60 to 120 km/h:
    Kendall's tau is 0.82 (A) and 0.89 (B), and at least 97 of 100 pairs whose mean DAFs are more
    than 0.005 apart are in the right order.
    """
    speeds, x = np.linspace(60, 120, 13) / 3.6, -60 + 0.1 * np.arange(851)
    roads = iso8608_elevations(60, iso_class, 85, seed=77)
    roads = np.vstack([roads, -roads])
    strategies = [
        *dampers.library(bridge, truck, SOFT, STIFF),
        *(dampers.passive(c) for c in (1e3, 2e3, 4e3, 12e3, 20e3, 30e3)),
        dampers.program([0, 8, 16], [7e3, STIFF, SOFT]),
        dampers.program([0, 6, 12], [SOFT, STIFF, SOFT]),
        dampers.bridgehook(bridge, truck, SOFT, STIFF, feedback=False),
    ]
    means = np.empty((2, len(strategies)))
    for k, law in enumerate(strategies):
        means[0, k] = simulate_loop(bridge, truck, law, speeds, x, roads).daf.mean()
        surface = bc.ramp_surface(
            bridge, truck, speeds, approach=60, ramp_height=iso_class, both_ways=True, every=10,
            damper=law,
        )  # fmt: skip
        means[1, k] = surface.class_dae(iso_class).mean.mean()
    assert kendalltau(*means).statistic >= least
    daf, dae = (row[:, np.newaxis] - row for row in means)
    apart = daf > 0.005
    assert np.mean(dae[apart] > 0) >= 0.97


# Bad input


@pytest.mark.parametrize(
    ("call", "error", "message"),
    [
        (lambda s, b, c: bc.ramp_surface(b, c, 25.0, ramp_height="Z"), ValueError, "one of 'A'"),
        (lambda s, b, c: bc.ramp_surface(b, c, 25.0, ramp_height=0.0), ValueError, "above 0"),
        (lambda s, b, c: bc.ramp_surface(b, c, 25.0, ramp_height="H"), ValueError, "not exceed"),
        (lambda s, b, c: bc.ramp_surface(b, c, 25.0, every=0), ValueError, "every must be 1"),
        (lambda s, b, c: bc.ramp_surface(b, c, 25.0, both_ways="yes"), TypeError, "both_ways must"),
        (lambda s, b, c: s.dae(s.road(0 * s.positions), order=3), ValueError, "order must be 1 or"),
        (lambda s, b, c: s.dae([0.0, 0.1], order=2), ValueError, "451 stations"),
        (lambda s, b, c: s.class_dae("Z"), ValueError, "roughness must be one of 'A'"),
        (lambda s, b, c: s.class_dae("A").percentile(100), ValueError, "between 0 and 100"),
    ],
)  # fmt: skip
def test_each_mistake_is_named(surface, bridge, truck, call, error, message):
    with pytest.raises(error, match=message):
        call(surface, bridge, truck)


def test_a_surface_of_ramps_down_alone_has_no_second_order(surface, bridge, truck):
    one = dataclasses.replace(surface, daf_rise=None)
    for call in (lambda: one.odd_effect, lambda: one.dae(one.road(0 * one.positions), order=2)):
        with pytest.raises(ValueError, match=r"ramps down alone.*both_ways=True"):
            call()


def test_the_figure_of_effects_has_both_parts_with_units(surface):
    figure = effects_figure(surface, [25.0, 30.0])
    assert [axes.get_xlabel() for axes in figure.axes] == ["start of the ramp, x/l [-]"] * 2
    odd = figure.axes[0].lines[0].get_ydata()
    assert np.array_equal(odd, surface.odd_effect[1])
    road = iso8608_elevations(1, "A", 45, seed=2)[0]
    along = effects_figure(surface, [30.0], road=road)
    ends = [axes.lines[0].get_ydata()[-1] for axes in along.axes]
    assert sum(ends) == pytest.approx((surface.dae(road, order=2) - surface.daf_smooth)[2])
