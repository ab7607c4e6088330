"""Many vehicles at once: the numbers of the single crossing, whatever is beside it."""

import re
import warnings
from dataclasses import replace

import numpy as np
import pytest
from helpers import rough_road
from hypothesis import given, settings
from hypothesis import strategies as st
from reference_trucks import random_bridge, random_truck

import bridgectl as bc
from bridgectl.linear import nodes
from bridgectl.linear.many import crossings as many
from bridgectl.linear.many.crossings import many_crossings
from bridgectl.linear.many.places import table
from bridgectl.model.trucks import Axle, Body, articulated, half_car

START = -40.0
pytestmark = pytest.mark.filterwarnings("ignore:.*not forgotten:bridgectl.PlausibilityWarning")


def five_axle(rng: np.random.Generator) -> bc.Vehicle:
    """A truck around `trucks.load("T5air")`: single steer and drive axles, three behind."""

    def axle(place: float, stiffness: float, tire: float, damping: float) -> Axle:
        by = rng.uniform(0.7, 1.3, 4)
        return Axle(place, 900 * by[0], stiffness * by[1], tire * by[2], damping=damping * by[3])

    tractor = Body(
        rng.uniform(4e3, 6.5e3), rng.uniform(1e4, 2.5e4),
        [axle(-1.0, 6e5, 1.75e6, 1.2e4), axle(rng.uniform(1.8, 2.6), 1e6, 3.5e6, 3e4)],
    )  # fmt: skip
    first = rng.uniform(1.9, 2.3)
    rear = [axle(first + 1.2 * i, 8e5, 3.5e6, 2e4) for i in range(3)]
    trailer = Body(rng.uniform(1.2e4, 3e4), rng.uniform(1e5, 2.5e5), rear)
    return articulated(tractor, trailer, hinge=(rng.uniform(1.2, 1.6), rng.uniform(-6, -4)))


def two_axle(rng: np.random.Generator) -> bc.Vehicle:
    return half_car(
        rng.uniform(8e3, 1.4e4), rng.uniform(3e4, 8e4), (-2.5, rng.uniform(1.5, 3.0)),
        rng.uniform(500, 1200), rng.uniform(1e6, 6e6), rng.uniform(1e6, 3e6),
        damping=rng.uniform(1e4, 4e4),
    )  # fmt: skip


def quarter_car(rng: np.random.Generator) -> bc.QuarterCar:
    return bc.QuarterCar(
        rng.uniform(5e3, 1.5e4), rng.uniform(500, 1500), rng.uniform(1e5, 5e5),
        rng.uniform(1e6, 3e6), rng.uniform(8e3, 5e4),
    )  # fmt: skip


KINDS = (five_axle, two_axle, quarter_car)


def fleet(seed: int, count: int, kinds=KINDS):
    """Vehicles of some kinds in turn, their speeds [m/s] and roads."""
    rng = np.random.default_rng(seed)
    vehicles = [kinds[i % len(kinds)](rng) for i in range(count)]
    roads = [rough_road(seed + i, START, 30.0, height=1.5e-4) for i in range(count)]
    return vehicles, rng.uniform(15, 33, count), roads


def one_by_one(beam, vehicles, speeds, roads, start=START, effect="moment"):
    """Factors of single crossings, vehicles last."""
    each = zip(vehicles, speeds, roads, strict=True)
    found = [bc.daf(beam, *one, start=start, effect=effect)[..., 0] for one in each]
    return np.stack(found, axis=-1)


def same(first, second) -> bool:
    """Whether all that is kept of crossings is the same to the bit."""
    return all(np.array_equal(a, b, equal_nan=True) for a, b in zip(first, second, strict=True))


def some(found, which):
    """What is kept of some crossings."""
    return [kept[..., which] for kept in found]


@pytest.mark.parametrize("kind", KINDS)
def test_factors_are_those_of_single_crossings_within_1e_6(bridge, kind):
    vehicles, speeds, roads = fleet(1, 8, [kind])
    found = bc.daf(bridge, vehicles, speeds, roads, start=START)
    assert found == pytest.approx(one_by_one(bridge, vehicles, speeds, roads), abs=1e-6)


@pytest.mark.slow
def test_200_five_axle_trucks_have_the_factors_of_single_crossings_within_1e_6(bridge):
    rng = np.random.default_rng(2)
    vehicles, speeds = [five_axle(rng) for _ in range(200)], rng.uniform(15, 33, 200)
    roads = [bc.iso8608_profile("A", 125.1, seed=i, start=-100) for i in range(200)]
    roads = [bc.RoadProfile(road.x, 0.4 * road.elevation) for road in roads]
    found = many_crossings(bridge, vehicles, speeds, roads, start=-100.0)
    assert not found.alone.any()
    single = one_by_one(bridge, vehicles, speeds, roads, start=-100.0)
    assert found.factors[0] == pytest.approx(single, abs=1e-6)
    order = rng.permutation(200)
    shuffled = [[of[i] for i in order] for of in (vehicles, speeds, roads)]
    assert same(some(found, order), many_crossings(bridge, *shuffled, start=-100.0))


EFFECTS = [
    "moment", "deflection", bc.Moment(8.0), bc.Moment(10.0, recovery="li2006"), bc.Shear(6.0),
    bc.Reaction(0.0), bc.Stress(9.0, section_modulus=1.1), bc.Moment(5.0, recovery="modal"),
]  # fmt: skip


@pytest.mark.slow
def test_several_effects_are_read_of_one_propagation(bridge):
    vehicles, speeds, roads = fleet(3, 6)
    found = bc.daf(bridge, vehicles, speeds, roads, start=START, effect=EFFECTS)
    single = one_by_one(bridge, vehicles, speeds, roads, effect=EFFECTS)
    assert found.shape == (len(EFFECTS), 6)
    assert found == pytest.approx(single, abs=1e-6)
    alone = [bc.daf(bridge, vehicles, speeds, roads, start=START, effect=of) for of in EFFECTS]
    assert np.array_equal(found, alone)


@pytest.mark.slow
def test_hogging_over_a_pier_and_its_reaction():
    two_spans = bc.Bridge([20, 25], 18358, 4.865e10)
    effects = [bc.Moment(20.0, sense="smallest"), bc.Moment(8.0), bc.Reaction(20.0), "deflection"]
    vehicles, speeds, _ = fleet(4, 3)
    road = rough_road(4, START, 50.0, height=1.5e-4)
    found = bc.daf(two_spans, vehicles, speeds, road, start=START, effect=effects)
    single = one_by_one(two_spans, vehicles, speeds, [road] * 3, effect=effects)
    assert found == pytest.approx(single, abs=1e-6)


@pytest.mark.parametrize("places", [31, 3])  # of three places shapes are straight lines
def test_a_bridge_that_is_known_by_its_modes(places):
    x = np.linspace(0, 30, places)
    shape = np.sin(np.pi * x / 30)
    shape[[0, -1]] = 0.0
    bridge = bc.ModalBridge(x, shape[:, np.newaxis], [3.5], modal_masses=2e5, damping_ratio=0.02)
    vehicles, speeds, _ = fleet(5, 3)
    road = rough_road(5, START, 40.0, height=1.5e-4)
    found = many_crossings(bridge, vehicles, speeds, road, start=START, effects="deflection")
    assert not found.alone.any()
    single = one_by_one(bridge, vehicles, speeds, [road] * 3, effect="deflection")
    assert found.factors[0] == pytest.approx(single, abs=1e-6)


@pytest.mark.parametrize(
    ("step", "start"), [(0.25, -20.0), (0.1016, -33.333), (0.05, -7.77), (0.02, 0.0), (None, -10.0)]
)
def test_stations_may_be_as_far_apart_as_they_like_and_anywhere(bridge, step, start):
    vehicles, speeds, _ = fleet(6, 3)
    road = None
    if step is not None:
        x = -41.23 + step * np.arange(int(75 / step))
        rough = rough_road(6, -45.0, 40.0, height=2e-4)
        road = bc.RoadProfile(x, rough.elevation_at(x))
    found = many_crossings(bridge, vehicles, speeds, road, start=start)
    assert not found.alone.any()
    single = one_by_one(bridge, vehicles, speeds, [road] * 3, start=start)
    assert found.factors[0] == pytest.approx(single, abs=1e-6)


def test_tire_forces_are_those_of_single_crossings_of_narrow_cells(bridge, monkeypatch):
    effects = [bc.TireForce(1), bc.TireForce(1, sense="smallest")]
    vehicles, speeds, roads = fleet(7, 3)
    found = bc.daf(bridge, vehicles, speeds, roads, start=START, effect=effects)
    monkeypatch.setattr(nodes, "MAX_WIDTH", 0.02)
    single = one_by_one(bridge, vehicles, speeds, roads, effect=effects)
    assert found == pytest.approx(single, abs=3e-7)


@pytest.mark.slow
@pytest.mark.filterwarnings("ignore:the road was measured", "ignore:vehicle.*the road was measured")
def test_the_control_library_finds_the_same(bridge):
    vehicles, speeds, roads = fleet(8, 2, [two_axle])
    roads = [road.crop(-3.0, 30.0).resample(0.5) for road in roads]
    given = bridge, vehicles, speeds, roads
    assert bc.daf(*given, start=-3.0) == pytest.approx(
        bc.daf(*given, start=-3.0, method="control"), abs=2e-6
    )


MIXED = fleet(9, 9)


@pytest.fixture(scope="module")
def mixed(bridge):
    """What is kept of crossings of three kinds of vehicles."""
    return many_crossings(bridge, *MIXED, start=START, effects=["moment", bc.Shear(4.0)])


@settings(max_examples=15)
@given(st.permutations(range(9)), st.integers(1, 9))
def test_a_crossing_has_its_own_numbers_to_the_bit_whatever_is_beside_it(mixed, bridge, order, n):
    which = list(order[:n])
    chosen = [[of[i] for i in which] for of in MIXED]
    found = many_crossings(bridge, *chosen, start=START, effects=["moment", bc.Shear(4.0)])
    assert same(some(mixed, which), found)


@pytest.mark.quick_cases(1)
@pytest.mark.parametrize("count", [2, 7, 64, 200])
def test_copies_of_a_crossing_are_the_same_to_the_bit_in_batches_of_any_size(bridge, mixed, count):
    for i in range(3):
        copies = [[of[i]] * count for of in MIXED]
        found = many_crossings(bridge, *copies, start=START)
        assert np.all(found.factors == mixed.factors[:1, [i]])
        assert np.all(found.least == mixed.least[i])


def test_places_times_and_least_forces_are_those_of_the_response(bridge):
    vehicles, speeds, roads = fleet(10, 3)
    found = many_crossings(bridge, vehicles, speeds, roads, start=START)
    responses = bc.crossing_response(bridge, vehicles, speeds, roads, start=START)
    for i, response in enumerate(responses):
        moment, load = response.outputs[0], vehicles[i].linear.static_loads
        on_bridge = response.time >= 0
        at = response.time[on_bridge][moment[on_bridge].argmax()]
        assert found.times[0, i] == pytest.approx(at, abs=2e-3)
        assert found.places[0, i] == pytest.approx(speeds[i] * found.times[0, i])
        forces = response.outputs[2 : 2 + load.size] / load[:, np.newaxis]
        assert found.least[i] == pytest.approx(forces.min(), abs=0.02)
        assert found.peaks[0, i] == found.factors[0, i] * found.static_peaks[0, i]
    assert not found.lifts_off.any()


@pytest.mark.slow
def test_a_tire_that_leaves_the_road_has_the_single_route_and_leaves_the_others_alone(bridge):
    vehicles, speeds, roads = fleet(11, 6)
    calm = many_crossings(bridge, vehicles, speeds, roads, start=START)
    roads[2] = rough_road(3, START, 30.0, height=8e-3)
    with pytest.warns(bc.LiftOffWarning, match=r"vehicle\[2\]: a tire leaves the road, first"):
        found = bc.daf(bridge, vehicles, speeds, roads, start=START)
    with pytest.warns(bc.LiftOffWarning):
        single = bc.daf(bridge, vehicles[2], speeds[2], roads[2], start=START)
    assert found[2] == single[0]
    others = [0, 1, 3, 4, 5]
    assert np.array_equal(found[others], calm.factors[0, others])
    kept = many_crossings(bridge, vehicles, speeds, roads, start=START)
    assert kept.alone.tolist() == kept.lifts_off.tolist() == [i == 2 for i in range(6)]
    assert kept.least[2] == 0.0


def test_several_that_leave_the_road_are_told_once(bridge):
    vehicles, speeds, _ = fleet(12, 3)
    rough = rough_road(3, START, 30.0, height=2e-2)
    told = r"vehicle\[0\] \(7 of 7: 0, 1, 2, 3, 4, ...\): a tire leaves the road"
    with pytest.warns(bc.LiftOffWarning, match=told) as caught:
        bc.daf(bridge, [vehicles[2]] * 7, speeds[2], rough, start=START)
    assert len(caught) == 1


def beside_others(odd, bridge, speed=20.0, road=None, effect="moment", start=-5.0):
    """An odd vehicle between two plain ones, by the arrays' way in and by itself."""
    rng = np.random.default_rng(13)
    vehicles = [quarter_car(rng), odd, quarter_car(rng)]
    found = many_crossings(bridge, vehicles, speed, road, start=start, effects=effect)
    return found, bc.daf(bridge, odd, speed, road, start=start, effect=effect)


ODD = {
    "tires with damping": lambda: half_car(1e4, 5e4, (-2, 2), 900, 1e6, 2e6, 1e4, 2e3),
    "several vehicles": lambda: bc.convoy([bc.li2006.car()] * 2, [0, 6.0], opposite=[False, True]),
    "stiff wheels": lambda: bc.QuarterCar(1e4, 50.0, 1e5, 5e7, 1e4),
}


@pytest.mark.filterwarnings("ignore:the axle moves at:bridgectl.PlausibilityWarning")
@pytest.mark.parametrize("odd", ODD)
def test_what_does_not_fit_arrays_has_exactly_the_numbers_of_the_single_route(bridge, odd):
    found, single = beside_others(ODD[odd](), bridge, speed=8.0)
    assert found.alone.tolist() == [False, True, False]
    assert found.factors[0, 1] == single[0]


def test_meeting_vehicles_with_motions_of_their_own(bridge):
    meeting = bc.convoy(
        [bc.li2006.car()] * 2, [0, 3.0], opposite=[False, True],
        motions=[bc.Motion(20.0), bc.Motion(18.0)],
    )  # fmt: skip
    found, single = beside_others(meeting, bridge)
    assert found.factors[0, 1] == single[0]
    with pytest.raises(ValueError, match=r"vehicle\[0\]: speed must be that of the first vehicle"):
        bc.daf(bridge, [meeting], 19.0)


@pytest.mark.parametrize("effect", [bc.BodyAcceleration(), bc.BridgeAcceleration()])
def test_effects_that_arrays_do_not_read_have_the_single_route(bridge, effect):
    vehicles, speeds, roads = fleet(14, 2)
    found = bc.peak_effect(bridge, vehicles, speeds, roads, start=START, effect=[effect, "moment"])
    for i in range(2):
        one = bridge, vehicles[i], speeds[i], roads[i]
        single = bc.peak_effect(*one, start=START, effect=[effect, "moment"])
        assert np.array_equal(found[:, i], single[:, 0])


def test_several_effects_are_found_if_arrays_read_some_of_them_alone(bridge):
    effects = ["moment", "deflection", bc.BridgeAcceleration(12.0)]
    car = quarter_car(np.random.default_rng(25))
    found = bc.peak_effect(bridge, [car, car], 20.0, effect=effects)
    assert np.array_equal(found[:, 0], bc.peak_effect(bridge, car, 20.0, effect=effects)[:, 0])


@pytest.mark.parametrize("effect", ["moment", ["moment", bc.Reaction(0.0)]])
def test_many_speeds_of_a_truck_go_side_by_side_within_1e_6(bridge, effect, monkeypatch):
    """That is where it is quicker: a single speed and a quarter-car have exact cells."""
    rng = np.random.default_rng(26)
    road = rough_road(26, START, 30.0, height=1e-4)
    truck, speeds = five_axle(rng), np.linspace(18, 33, 5)
    single = one_by_one(bridge, [truck] * 5, speeds, [road] * 5, effect=effect)
    asked = []

    def counted(run, crossings, c, *rest):
        asked.append(len(c))
        return one_road(run, crossings, c, *rest)

    one_road = many.peaks_of_effects
    monkeypatch.setattr(many, "peaks_of_effects", counted)
    found = bc.daf(bridge, truck, speeds, road, start=START, effect=effect)
    assert asked == []
    assert found == pytest.approx(single, abs=1e-6)
    bc.daf(bridge, truck, 20.0, road, start=START)
    bc.daf(bridge, quarter_car(rng), speeds, road, start=START)
    assert asked == [1, 5]


def test_speeds_at_which_a_tire_leaves_the_road_are_flown_and_told(bridge):
    truck, speeds = two_axle(np.random.default_rng(27)), np.array([15, 17, 19, 21, 23, 25.0])
    bump = bc.RoadProfile(np.arange(-10, 31), np.where(np.arange(-10, 31) == -3, 0.03, 0.0))
    with pytest.warns(bc.LiftOffWarning, match="at 2 of 6 speeds"):
        found = bc.daf(bridge, truck, speeds, bump, start=-10)
    with pytest.warns(bc.LiftOffWarning, match="leaves the road"):
        single = [bc.daf(bridge, truck, c, bump, start=-10)[0] for c in speeds]
    assert np.array_equal(found[:2], single[:2])
    assert found == pytest.approx(single, abs=1e-6)


def test_uneven_stations_and_many_modes_have_the_single_route(bridge):
    uneven = bc.RoadProfile([-5, 3, 3.13, 30], [0, 0, 1e-3, 0])
    rng = np.random.default_rng(15)
    car = quarter_car(rng)
    found = many_crossings(bridge, [car, car], 20.0, [uneven, None], start=-5.0)
    assert found.alone.tolist() == [True, False]
    assert found.factors[0, 0] == bc.daf(bridge, car, 20.0, uneven, start=-5.0)[0]
    slender = bc.Beam(25.0, 18358.0, 4.865e10, n_modes=16)
    many = many_crossings(slender, [car], 20.0)
    assert many.alone.all()
    assert many.factors[0] == bc.daf(slender, car, 20.0)


@pytest.mark.parametrize(("mass", "alone"), [(1000.0, False), (100.0, True)])
def test_a_bridge_that_yields_at_once_has_the_single_route(mass, alone, monkeypatch):
    """One that is lighter than what crosses it gives way within a cell; that of narrow ones."""
    monkeypatch.setattr(nodes, "MAX_WIDTH", 0.0125)
    light = bc.Beam(15.0, mass, mass * (2 * np.pi * 3) ** 2 * (15 / np.pi) ** 4, damping_ratio=0.02)
    car = bc.QuarterCar(540.0, 60.0, 19e3, 1.8e6, 1.7e3)
    road = rough_road(23, -10.0, 16.0, height=1e-4)
    found = many_crossings(light, [car], 15.0, road, start=-10.0)
    single = bc.daf(light, car, 15.0, road, start=-10.0)
    assert found.alone[0] == alone
    assert found.factors[0] == pytest.approx(single, abs=0.0 if alone else 1e-6)


def test_printed_equations_of_a_damped_bridge_read_the_rates_of_modes():
    damped = bc.Beam(25.0, 18358.0, 4.865e10, damping_ratio=0.05)
    effects = [bc.Moment(11.0, recovery="li2006"), "moment"]
    vehicles, speeds, roads = fleet(24, 3)
    found = bc.daf(damped, vehicles, speeds, roads, start=START, effect=effects)
    single = one_by_one(damped, vehicles, speeds, roads, effect=effects)
    assert found == pytest.approx(single, abs=1e-6)


def test_a_bridge_whose_ends_move_has_the_single_route():
    x = np.linspace(0, 30, 31)
    shape = 0.2 + np.sin(np.pi * x / 30)
    bridge = bc.ModalBridge(x, shape[:, np.newaxis], [3.5], modal_masses=2e5)
    car = quarter_car(np.random.default_rng(16))
    found = many_crossings(bridge, [car], 20.0, effects="deflection")
    assert found.alone.all()
    assert found.factors[0] == bc.daf(bridge, car, 20.0, effect="deflection")


def test_peaks_are_factors_times_static_peaks_and_one_speed_and_road_stand_for_all(bridge):
    vehicles, _, roads = fleet(17, 3)
    effects = ["moment", bc.Deflection(sense="smallest")]
    found = bc.peak_effect(bridge, vehicles, 22.0, roads[0], start=START, effect=effects)
    for i, vehicle in enumerate(vehicles):
        one = bc.peak_effect(bridge, vehicle, 22.0, roads[0], start=START, effect=effects)
        moment = bc.Crossing(bridge, vehicle).static_peak
        assert found[0, i] == pytest.approx(one[0, 0], abs=1e-6 * moment)
        assert found[1, i] == pytest.approx(one[1, 0], abs=1e-9)
    factors = bc.daf(bridge, vehicles, [bc.Motion(22.0)], [roads[0]] * 3, start=START)
    moments = [bc.Crossing(bridge, vehicle).static_peak for vehicle in vehicles]
    assert found[0] == pytest.approx(factors * moments)


@pytest.mark.slow
def test_responses_of_a_sequence_are_those_of_each(bridge):
    vehicles, speeds, roads = fleet(18, 3)
    options = {"start": START, "effects": {"quarter": bc.Moment(6.0)}, "tail": 0.1}
    found = bc.crossing_response(bridge, vehicles, speeds, roads, **options)
    for response, *one in zip(found, vehicles, speeds, roads, strict=True):
        single = bc.crossing_response(bridge, *one, **options)
        assert np.array_equal(response.outputs, single.outputs)
        assert response.output_labels == single.output_labels
    rough = rough_road(3, START, 30.0, height=2e-2)
    with pytest.warns(bc.LiftOffWarning, match=r"vehicle\[0\] \(2 of 2: 0, 1\)") as caught:
        bc.crossing_response(bridge, [vehicles[2]] * 2, 20.0, rough, start=START)
    assert len(caught) == 1


def test_no_vehicles_have_no_factors(bridge):
    assert bc.daf(bridge, [], []).shape == (0,)
    assert bc.peak_effect(bridge, [], 20.0, effect=["moment", "deflection"]).shape == (2, 0)
    assert bc.crossing_response(bridge, [], 20.0) == []


@pytest.mark.parametrize(
    ("change", "error", "told"),
    [
        ({"speeds": [20, 25]}, ValueError, "speeds must be one for all 3 vehicles, or one each, "
         "got 2"),
        ({"speeds": -20.0}, ValueError, "speeds must be above 0 m/s"),
        ({"speeds": []}, ValueError, "speeds must hold at least one"),
        ({"speeds": bc.Motion(20.0, [1.0, 0.0], [5.0])}, ValueError, "speeds must be constant"),
        ({"profile": [None]}, ValueError, "profile must be one road for all 3 vehicles"),
        ({"profile": [None, 3, None]}, TypeError, r"profile\[1\]: profile must be a bridgectl"),
        ({"profile": bc.RoadProfile([0, 9], [0, 0])}, ValueError, "the road covers x from 0 m"),
        ({"start": 5.0}, ValueError, "start must be 0 m"),
        ({"effect": "tire_force_2"}, ValueError, r"vehicle\[0\]: effect must be one of 'moment'"),
        ({"effect": "acceleration"}, ValueError, r"vehicle\[0\]: effect must have a static peak"),
        ({"effect": []}, ValueError, "effect must be one effect or more"),
        ({"method": "guess"}, ValueError, "method must be one of"),
        ({"progress": 1}, TypeError, "progress must be True or False"),
        ({"damper": bc.li2006.car()}, ValueError, "damper goes with one vehicle at a time"),
    ],
)  # fmt: skip
def test_mistakes_are_told_by_the_argument_and_the_vehicle(bridge, change, error, told):
    given = {"speeds": 20.0} | change
    with pytest.raises(error, match=told):
        bc.daf(bridge, [bc.li2006.car()] * 3, **given)


def test_what_is_no_vehicle_is_told_by_its_place(bridge):
    with pytest.raises(TypeError, match=r"vehicle\[1\]: vehicle must be a bridgectl.Vehicle"):
        bc.daf(bridge, [bc.li2006.car(), 9000.0], 20.0)


def test_a_start_in_the_air_is_told_of_its_vehicle(bridge):
    x = -20 + 0.1 * np.arange(501)
    wave = bc.RoadProfile(x, 0.45 * np.sin(x))
    with pytest.raises(ValueError, match=r"vehicle\[1\]: start must be where all tires stand"):
        bc.daf(
            bridge, [bc.li2006.car(), five_axle(np.random.default_rng(19))], 20.0, wave, start=-4
        )


@pytest.mark.filterwarnings("default")
def test_doubts_are_told_once_with_how_many_and_which(bridge):
    rng = np.random.default_rng(20)
    trucks = [two_axle(rng) for _ in range(3)]
    road = bc.RoadProfile(-100 + 1.0 * np.arange(131), 2e-3 * rng.normal(size=131))
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        bc.daf(bridge, trucks, [20.0, 80.0, 90.0], road, start=-6.0)
    told = [str(one.message) for one in caught]
    for pattern in (
        r"vehicle\[1\] \(2 of 3: 1, 2\): speeds of 80 m/s .* for 80 km/h type 80 / 3.6",
        r"vehicle\[0\] \(3 of 3: 0, 1, 2\): start = -6 m is not forgotten",
        r"vehicle\[0\] \(3 of 3: 0, 1, 2\): the road was measured every 1 m, too coarsely",
    ):
        assert len([text for text in told if re.match(pattern, text)]) == 1, told
    assert all(one.filename == __file__ for one in caught)


@pytest.mark.filterwarnings("default")
def test_loads_and_roads_that_can_hardly_be_meant_are_told(bridge):
    heavy = bc.QuarterCar(6e5, 3e4, 6e6, 1e8, 5e5)
    steep = bc.RoadProfile(-5 + 0.1 * np.arange(351), 3e-3 * np.arange(351))
    cars = [bc.li2006.car(), heavy, heavy]
    with pytest.warns(bc.PlausibilityWarning) as caught:
        bc.daf(bridge, cars, 20.0, [None, None, steep], start=-5.0)
    told = " ".join(str(one.message) for one in caught)
    assert re.search(r"vehicle\[1\] \(2 of 3: 1, 2\): the vehicle .* is heavier than the br", told)
    assert re.search(r"vehicle\[2\]: the road has a grade of 3.0%", told)


def test_a_start_that_is_forgotten_is_not_told(bridge):
    vehicles, speeds, roads = fleet(21, 1)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        bc.daf(bridge, vehicles, speeds, roads[0].crop(-40.0, 25.0), start=-40.0)


def test_tables_of_places_are_those_functions_and_zero_off_the_bridge():
    kinks = np.array([0.0, 3.0 - 1e-6, 3.0, 3.0 + 1e-6, 10.0])
    bent = table(
        lambda x: np.abs(x - 3)[:, np.newaxis] + 2 * np.sin(x)[:, np.newaxis], kinks, 10.0, 0.2
    )
    x = np.random.default_rng(22).uniform(0.01, 9.99, (50, 4))
    assert bent(x)[0] == pytest.approx(np.abs(x - 3) + 2 * np.sin(x), abs=3e-8)
    assert np.all(bent(np.array([-1.0, 0.0, 10.0, 12.0])) == 0)
    places, jumps = bent.slope_jumps()
    assert places == pytest.approx([0.0, 3.0, 10.0], abs=1e-12)
    assert jumps[1] == pytest.approx([2.0], abs=1e-6)


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(20))
def test_random_trucks_on_random_bridges_have_the_factors_of_single_crossings(seed):
    rng = np.random.default_rng(seed)
    bridge = random_bridge(rng)
    vehicles = [replace(random_truck(rng), tire_damping=0.0) for _ in range(4)]
    speeds, start = rng.uniform(12, 33, 4), -float(rng.uniform(0, 30))
    road = rough_road(seed, start - 5.0, bridge.length + 1.0, height=2e-4)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        found = bc.daf(bridge, vehicles, speeds, road, start=start, effect="deflection")
        single = one_by_one(bridge, vehicles, speeds, [road] * 4, start, "deflection")
    assert found == pytest.approx(single, abs=1e-6)
