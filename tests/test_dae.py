import dataclasses

import numpy as np
import pytest
from helpers import rough_road

import bridgectl as bc
from bridgectl.linear.peaks import find_peaks
from bridgectl.surface.factored import RampsApart
from bridgectl.surface.histories import DenseHistories

SPEED = 110 / 3.6
SWEEP = np.arange(50, 151, 10) / 3.6


@pytest.fixture(scope="module")
def paper(bridge, truck):
    """The paper's surface at 110 km/h."""
    return bc.ramp_surface(bridge, truck, SPEED, recovery="li2006")


def difference(surface, start):
    # Fig. 7's drop at 18.75 m lies across two ramps: either will do, neither has an effect.
    ramp = np.argmin(np.abs(surface.positions - start))
    assert surface.positions[ramp] == pytest.approx(start, abs=0.051)
    return surface.daf_unit[0, ramp] - surface.daf_smooth[0]


def test_unit_ramps_at_110_kmh_change_the_daf_as_computed_independently(paper, cases):
    case = cases["li2006"]["computed_ramps_110_kmh"]
    found = [difference(paper, start) for start in case["start_m"]]
    assert found == pytest.approx(case["daf_minus_smooth_1mm"], abs=case["tolerance"])


def test_ramps_in_the_right_half_do_not_change_the_peak(paper):
    right = paper.positions > 12.5 + 1e-9
    assert np.abs(paper.daf_unit[:, right] - paper.daf_smooth[:, None]).max() < 1e-9


def test_figure_7_dae_and_daf(paper, bridge, truck, cases):
    case = cases["li2006"]["computed_fig7"]
    road = bc.li2006.fig7_road()
    assert paper.dae(road)[0] == pytest.approx(case["dae"], abs=case["tolerance"])
    assert paper.superposed_daf(road)[0] == pytest.approx(case["daf"], abs=case["tolerance"])
    simulated = bc.daf(bridge, truck, SPEED, road, recovery="li2006")
    assert simulated[0] == pytest.approx(case["daf"], abs=case["tolerance"])
    earlier = paper.dae(bc.li2006.fig7_road(earlier=0.1))
    assert earlier[0] == pytest.approx(1.0666, abs=5e-5)


def test_the_sum_of_equation_15_by_hand_is_the_dae(paper):
    by_hand = paper.daf_smooth[0] + sum(
        scale * difference(paper, place * 25) for place, scale in bc.li2006.FIG7_RAMPS.items()
    )
    assert paper.dae(bc.li2006.fig7_road())[0] == pytest.approx(by_hand, abs=1e-9)


def test_a_road_fed_upside_down_gives_the_mirrored_daf(paper):
    """The sign trap: elevation taken for r turns 1.066 into 1.195."""
    road = bc.li2006.fig7_road()
    mirrored = bc.RoadProfile(road.x, -road.elevation)
    assert paper.superposed_daf(mirrored)[0] == pytest.approx(1.195, abs=5e-4)


def test_the_10_mm_ramp_lowers_the_daf_most_near_a_quarter_of_the_span(bridge, truck):
    """The paper: 'low (e.g., 0.23 l) at 105 km/h'. Ours: 1.051 at 0.216 l, 1.063 near 0.24 l."""
    surface = bc.ramp_surface(bridge, truck, 105 / 3.6, ramp_height=0.01, recovery="li2006")
    lowest = np.argmin(surface.daf_unit[0])
    assert surface.positions[lowest] == pytest.approx(5.4)
    place = surface.positions[lowest]
    road = bc.RoadProfile([0, place, place + 0.1, 25], [0, 0, -0.01, -0.01])
    simulated = bc.daf(bridge, truck, 105 / 3.6, road, recovery="li2006", method="control")
    assert surface.daf_unit[0, lowest] == pytest.approx(simulated[0], abs=1e-6)
    assert surface.daf_unit[0, lowest] == pytest.approx(1.0510, abs=1e-4)
    near = np.abs(surface.positions / 25 - 0.24) < 0.01
    assert surface.daf_unit[0, near].min() == pytest.approx(1.064, abs=1e-3)


@pytest.mark.slow
def test_the_surface_is_that_of_control_library_simulations_of_every_ramp(truck):
    beam = bc.Beam(9.0, 16875.0, 3.5e10 * 0.1139)
    study = {"approach": 1.5, "ramp_length": 1.5}
    speeds = np.array([15.0, 31.0])
    fast = bc.ramp_surface(beam, truck, speeds, **study)
    slow = bc.ramp_surface(beam, truck, speeds, method="control", **study)
    assert fast.daf_smooth == pytest.approx(slow.daf_smooth, abs=1e-7)
    # A unit ramp's whole effect is 4e-3: this is 2e-5 of it.
    assert fast.daf_unit == pytest.approx(slow.daf_unit, abs=1e-7)
    road = rough_road(3, -1.5, 9, 1.5, height=1e-3)
    assert fast.superposed_daf(road) == pytest.approx(slow.superposed_daf(road), abs=1e-6)
    assert fast.dae(road) == pytest.approx(slow.dae(road), abs=1e-6)


@pytest.mark.parametrize("seed", range(4))
def test_superposed_daf_is_the_simulated_daf_on_random_roads(bridge, truck, seed):
    road = rough_road(seed, -60, 25)
    surface = bc.ramp_surface(bridge, truck, SWEEP, approach=60)
    simulated = bc.daf(bridge, truck, SWEEP, road, start=-60)
    assert surface.superposed_daf(road) == pytest.approx(simulated, abs=1e-6)


@pytest.mark.slow
def test_superposed_daf_is_what_the_control_library_simulates(bridge, truck):
    road = rough_road(11, -60, 25)
    speeds = np.array([70, 110]) / 3.6
    surface = bc.ramp_surface(bridge, truck, speeds, approach=60)
    simulated = bc.daf(bridge, truck, speeds, road, start=-60, method="control")
    assert surface.superposed_daf(road) == pytest.approx(simulated, abs=1e-6)


@pytest.mark.parametrize(
    "vehicle",
    [
        pytest.param(lambda car: dataclasses.replace(car, damping=2e5), id="heavily damped"),
        pytest.param(lambda car: dataclasses.replace(car, damping=0.0), id="undamped"),
        pytest.param(lambda car: dataclasses.replace(car, tire_stiffness=4e7), id="stiff"),
        pytest.param(lambda car: bc.convoy([car, car], [0, 3.33]), id="two trucks"),
    ],
)
def test_superposition_is_exact_for_extreme_vehicles_too(bridge, truck, vehicle):
    car, road = vehicle(truck), rough_road(5, -40, 25, height=1e-4)
    speeds = np.array([15.0, 40.0])
    surface = bc.ramp_surface(bridge, car, speeds, approach=40, recovery="li2006")
    simulated = bc.daf(bridge, car, speeds, road, start=-40, recovery="li2006")
    assert surface.superposed_daf(road) == pytest.approx(simulated, abs=1e-6)


@pytest.mark.parametrize("approach", [0.03, 7.77, 100.0, 400.0])
@pytest.mark.filterwarnings("ignore:start = -0.03 m is not forgotten")
def test_ramps_before_a_bridge_superpose_for_several_tires(bridge, truck, approach):
    """Tires 3.33 m apart stand within ramps as the first one reaches the bridge."""
    convoy = bc.convoy([truck, truck, truck], [0, 3.33, 4.7])
    surface = bc.ramp_surface(bridge, convoy, [20.0, 33.0], approach=approach)
    road = surface.road(np.random.default_rng(1).normal(0, 3e-4, len(surface.positions)))
    simulated = bc.daf(bridge, convoy, surface.speeds, road, start=-approach)
    assert surface.superposed_daf(road) == pytest.approx(simulated, abs=1e-6)


def test_a_beam_of_many_modes_superposes_too(truck):
    beam = bc.li2006.beam(n_modes=9, damping_ratio=0.01)
    surface = bc.ramp_surface(beam, truck, 30.0, approach=30)
    road = rough_road(2, -30, 25)
    simulated = bc.daf(beam, truck, 30.0, road, start=-30)
    assert surface.superposed_daf(road) == pytest.approx(simulated, abs=1e-6)


def test_ramps_scale_and_add(bridge, truck):
    """Homogeneity and additivity of the histories, which python-control's defaults break."""
    surface = bc.ramp_surface(bridge, truck, SPEED, ramp_length=1.0)
    histories, rng = surface.histories, np.random.default_rng(0)
    one, other = rng.normal(size=(2, 25, 1))
    left = histories.moments(0, 3 * one - 2 * other)
    right = 3 * histories.moments(0, one) - 2 * histories.moments(0, other)
    assert left == pytest.approx(right, abs=1e-12)
    every = histories.moments(0, 1.0) @ one
    assert every == pytest.approx(histories.moments(0, one), abs=1e-12)


@pytest.mark.parametrize("approach", [0.0, 7.77])
@pytest.mark.parametrize("tires", [1, 2])
def test_peaks_of_ramps_of_any_height_are_those_of_all_of_their_histories(
    bridge, truck, approach, tires
):
    """Only stretches that may hold a peak are looked at: the rest must not hold one."""
    convoy = bc.convoy([truck] * tires, [0.0, 3.33][:tires])
    surface = bc.ramp_surface(bridge, convoy, [15.0, 30.0], approach=approach, ramp_length=0.5)
    for speed, smooth in enumerate(surface.histories.smooth):
        for drop in (1e-3, -1e-3, 2.0, -2.0):
            each = surface.histories.moments(speed, drop * np.eye(len(surface.positions)))
            every = each + smooth[:, np.newaxis]
            found = surface.histories.peaks(speed, drop)
            assert found == pytest.approx(find_peaks(every).values, abs=1e-9)


@pytest.mark.parametrize("approach", [0.0, 7.77])
def test_no_ramp_exceeds_its_reach_in_a_block(bridge, truck, approach):
    surface = bc.ramp_surface(bridge, truck, 30.0, approach=approach)
    apart = RampsApart(surface.histories, 0, 1e-3)
    for block, bound in enumerate(apart.reach()):
        assert np.abs(apart.block(block)).max() <= bound


def test_histories_kept_one_by_one_scale_and_add_too():
    rng = np.random.default_rng(0)
    unit, smooth = rng.normal(size=(1, 13, 3)), rng.normal(size=(1, 13))
    dense = DenseHistories(np.arange(3.0), smooth, unit)
    assert dense.moments(0, 2e-3) == pytest.approx(2e-3 * unit[0], rel=1e-12)
    drops = rng.normal(size=(3, 5))
    assert dense.moments(0, drops) == pytest.approx(unit[0] @ drops, rel=1e-12)
    one = find_peaks((smooth[0] + 2e-3 * unit[0, :, 1])[:, np.newaxis])
    assert dense.peaks(0, 2e-3)[1] == pytest.approx(one.values[0], abs=1e-12)


def test_an_effect_that_is_largest_as_the_vehicle_leaves_has_its_peaks_there(truck):
    """On 256 cells, of which blocks of 16 leave none over."""
    surface = bc.ramp_surface(bc.Beam(25.6, 18358.0, 4.865e10), truck, 30.0, ramp_length=0.8)
    rising = np.linspace(0.0, 100.0, surface.histories.smooth.size)
    histories = dataclasses.replace(surface.histories, smooth=rising[np.newaxis])
    at_exit = histories.moments(0, 1e-3)[-1]
    assert len(histories.nodes) == 257
    assert histories.peaks(0, 1e-3) == pytest.approx(100.0 + at_exit, abs=1e-9)


def test_a_span_that_is_no_multiple_of_the_ramp_length_ends_in_a_cut_ramp(truck):
    beam = bc.Beam(10.04, 18000.0, 8e9)
    surface = bc.ramp_surface(beam, truck, [20.0, 30.0], approach=5.03)
    assert len(surface.positions) == 151
    road = rough_road(8, -5.03, 10.2)
    simulated = bc.daf(beam, truck, [20.0, 30.0], road, start=-5.03)
    assert surface.superposed_daf(road) == pytest.approx(simulated, abs=1e-6)


@pytest.mark.parametrize(
    "case", [{}, {"recovery": "li2006"}, {"section": 0.4}, {"effect": "deflection"}], ids=str
)
def test_lift_off_is_simulated_where_superposition_no_longer_holds(bridge, truck, case):
    # Each end of this hump is one ramp 0.5 m long, 60 mm high.
    road = bc.RoadProfile([-20, -6, -5.5, -5, -4.5, 25], [0, 0, 0.06, 0.06, 0, 0])
    speeds = np.array([3.0, 12.0])
    surface = bc.ramp_surface(bridge, truck, speeds, approach=20, ramp_length=0.5, **case)
    with pytest.warns(bc.LiftOffWarning):
        superposed = surface.superposed_daf(road)
    with pytest.warns(bc.LiftOffWarning):
        simulated = bc.daf(bridge, truck, speeds, road, start=-20, **case)
    assert superposed == pytest.approx(simulated, abs=1e-6)


def test_contributions_add_up_to_the_dae(bridge, truck):
    surface = bc.ramp_surface(bridge, truck, SWEEP)
    road = rough_road(2, 0, 25)
    parts = surface.contributions(road)
    assert parts.shape == (11, 250)
    assert surface.daf_smooth + parts.sum(axis=1) == pytest.approx(surface.dae(road))


def test_a_road_of_ramps_falls_by_them_and_has_the_name_it_is_given(paper):
    drops = np.random.default_rng(1).normal(0, 1e-3, len(paper.positions))
    road = paper.road(drops)
    assert road.elevation[0] == 0.0
    assert paper.ramps(road) * paper.ramp_height == pytest.approx(drops, abs=1e-12)
    assert (road.name, paper.road(drops, "mine").name) == ("", "mine")


def test_ramp_scale_factors_are_positive_for_a_drop(paper):
    factors = paper.ramps(bc.li2006.fig7_road())
    at = {round(x, 2): s for x, s in zip(paper.positions, factors, strict=True) if abs(s) > 1e-9}
    assert at == pytest.approx({3.0: -5.0, 7.5: -7.0, 18.75: 5.0, 18.8: 5.0}, abs=1e-6) or (
        sum(at.values()) == pytest.approx(-2.0)
    )


def test_a_surface_tells_its_parameters(paper):
    assert repr(paper) == (
        "RampSurface(1 speeds from 110 to 110 km/h, 250 ramps of 1 mm over 100 mm "
        "from x = 0 m to 25 m, recovery='li2006')"
    )


@pytest.mark.parametrize(
    ("change", "error", "says"),
    [
        ({"approach": -5.0}, ValueError, "approach must be 0 or more [m]"),
        ({"ramp_length": 0.0}, ValueError, "ramp_length must be above 0 [m]"),
        ({"ramp_height": -1e-3}, ValueError, "ramp_height must be above 0 [m]"),
        ({"ramp_height": 1.0}, ValueError, "for a ramp of 1 mm type 1e-3"),
        ({"method": "fast"}, ValueError, "method must be one of"),
        ({"section": 2}, ValueError, "section must lie between 0 and 1"),
    ],
)
def test_a_bad_argument_is_named(bridge, truck, change, error, says):
    with pytest.raises(error) as caught:
        bc.ramp_surface(bridge, truck, SPEED, **change)
    assert says in str(caught.value)


def test_a_road_that_is_none_or_too_short_is_an_error(paper):
    with pytest.raises(TypeError, match="roads must be a RoadProfile, a list of them, or elev"):
        paper.dae("road.csv")
    with pytest.raises(ValueError, match=r"elevations at the 251 stations .* got \(250,\)"):
        paper.dae(np.zeros(250))
    with pytest.raises(ValueError, match=r"elevations at the 251 stations .* got \(2, 2, 251\)"):
        paper.superposed_daf(np.zeros((2, 2, 251)))
    with pytest.raises(ValueError, match="roads must be finite"):
        paper.dae(np.full(251, np.nan))
    with pytest.raises(ValueError, match="road must be one road, got 2"):
        paper.contributions(np.zeros((2, 251)))
    with pytest.raises(ValueError, match="0 m to 20 m"):
        paper.superposed_daf(bc.RoadProfile([0, 20], [0, 0]))
