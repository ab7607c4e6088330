"""Traffic: vehicles in lanes, from both ends, each by its own motion, and what they do together."""

import dataclasses
import re
import warnings

import numpy as np
import pytest
from helpers import rough_road
from reference_trucks import (
    needs_reference,
    random_bridge,
    random_truck,
    reference,
    reference_truck,
)

import bridgectl as bc

BEAM = bc.Beam(25, 18358, 4.865e10, n_modes=3, damping_ratio=0.01)
CAR = bc.QuarterCar(9000, 1000, 80e3, 1.8e6, 7e3)
LEGS = np.array([[1.0, -2.0, -1.0, 0.0], [1.0, 3.0, 0.0, -1.0]])
TRUCK = bc.Vehicle(
    np.diag([12000.0, 40000.0, 700.0, 900.0]),
    LEGS.T @ np.diag([12e3, 15e3]) @ LEGS,
    LEGS.T @ np.diag([400e3, 600e3]) @ LEGS,
    [1.8e6, 3.6e6],
    [0.0, 5.0],
    heave=[1.0, 0.0, 1.0, 1.0],
    tire_damping=[3e3, 5e3],
)
BRAKING = bc.Motion(22.0, [0.0, -3.0], [5.0])
QUICKER = bc.Motion(18.0, [1.5, 0.0], [12.0])
ROAD = rough_road(5, -60.0, 100.0, 0.25, 5e-4)


def mirrored(road: bc.RoadProfile, length: float = 25.0) -> bc.RoadProfile:
    return bc.RoadProfile(length - road.x[::-1], road.elevation[::-1])


def signals_of(response):
    return dict(zip(response.output_labels, np.asarray(response.outputs), strict=True))


@needs_reference
@pytest.mark.parametrize("method", ["propagator", pytest.param("control", marks=pytest.mark.slow)])
@pytest.mark.parametrize("name", ["e_2QC_follow8_SS25_smooth_25", "e_2QC_meet_SS25_smooth_25"])
def test_the_reference_cases_of_two_vehicles_are_met_within_2e_4(name, method):
    case, told = reference()["cases"][name], reference()["bridges"]["SS25"]
    beam = bc.Beam(25, told["mass_per_length_kg_m"], told["flexural_rigidity_N_m2"], n_modes=14)
    car, second = reference_truck("QC"), case["vehicles"][1]
    opposite = [False, second["speed_m_s"] < 0]
    start = second["front_axle_start_m"]
    offset = (start - 25 if opposite[1] else -start) - 1
    pair = bc.convoy([car, car], [0, offset], opposite=opposite)
    expected, at = case["sections"]["12.5"], np.array(case["samples"]["time_s"]) - 0.04
    found = bc.daf(beam, pair, 25.0, start=-1, effect=["moment", bc.Deflection()], method=method)
    assert found[0, 0] == pytest.approx(expected["daf_moment"], abs=2e-4)
    assert found[1, 0] == pytest.approx(expected["daf_deflection"], abs=2e-4)
    peak = bc.Crossing(beam, pair).static_peak
    assert peak == pytest.approx(expected["peak_moment_static_Nm"], rel=1e-9)
    response = bc.crossing_response(
        beam, pair, 25.0, start=-1, static=True, timepts=at, method=method
    )
    for label, name in (("moment", "moment_Nm"), ("static_moment", "moment_static_Nm")):
        history = signals_of(response)[label] * peak
        np.testing.assert_allclose(history, expected["samples"][name], rtol=0, atol=1e-6 * peak)


def random_traffic(rng: np.random.Generator, length: float, start: float) -> tuple:
    """Two or three random vehicles of lanes, ends and motions, and a motion of the first."""
    count, kind = int(rng.integers(2, 4)), int(rng.integers(3))
    vehicles = [random_truck(rng).linear for _ in range(count)]
    offsets = [0.0, *rng.uniform(0, 12, count - 1)]
    given = {
        "opposite": [bool(end) for end in rng.integers(0, 2, count)],
        "lane_factors": rng.uniform(0.3, 1, count),
        "lanes": [f"lane {i}" for i in range(count)],
    }
    if kind == 0:
        return bc.convoy(vehicles, offsets, **given), bc.Motion(rng.uniform(15, 30))
    speeds = rng.uniform(15, 30, count)
    if kind == 1:
        return bc.convoy(vehicles, offsets, **given, motions=speeds), bc.Motion(speeds[0])
    ways = [(-40.0, rng.uniform(0, length)) for _ in range(count)]
    motions = [
        bc.Motion(c, [0.0, *rng.uniform(-2, 2, 2)], way)
        for c, way in zip(speeds, ways, strict=True)
    ]
    level = [
        dataclasses.replace(vehicle, pitch_input=np.zeros(vehicle.n_coordinates))
        for vehicle in vehicles
    ]
    return bc.convoy(level, offsets, **given, motions=motions), motions[0]


def compared(seed: int) -> None:
    """Both routes give the same peaks of random traffic within 1e-6 of the static one."""
    rng = np.random.default_rng(seed)
    bridge, start = random_bridge(rng), -rng.uniform(2, 6)
    traffic, motion = random_traffic(rng, bridge.length, start)
    road = None if seed % 4 == 3 else rough_road(seed, -60, bridge.length + 60, 0.3, 5e-4)
    # Halfway on two spans several axles may hog throughout.
    moment = bc.Moment(sense="smallest" if isinstance(bridge, bc.Bridge) else "largest")
    effects = [moment, bc.Deflection(), bc.TireForce(traffic.n_tires, sense="smallest")]
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", bc.PlausibilityWarning)  # of short approaches
        fast, slow = (
            bc.daf(bridge, traffic, motion, road, start=start, effect=effects, method=method)
            for method in ("propagator", "control")
        )
        alone = bc.daf(bridge, traffic, motion, road, start=start, effect=moment)
    np.testing.assert_allclose(fast, slow, rtol=0, atol=1e-6)
    np.testing.assert_allclose(alone, fast[0], rtol=0, atol=2e-7)


@pytest.mark.parametrize("seed", [0, 2, 3, 5])
@pytest.mark.slow
def test_both_routes_agree_within_1e_6_on_random_traffic(seed):
    compared(seed)


@pytest.mark.slow
@pytest.mark.parametrize("seed", [1, 4, *range(6, 14)])
def test_both_routes_agree_within_1e_6_on_more_random_traffic(seed):
    compared(seed)


@pytest.mark.slow
@pytest.mark.filterwarnings("ignore::bridgectl.PlausibilityWarning")  # no bridge is so
def test_on_a_nearly_rigid_beam_traffic_does_what_its_vehicles_do_one_by_one():
    stiff = bc.Beam(25, 1e7, 4.865e16, n_modes=1)  # deflects by some nm
    vehicles, factors, opposite = [CAR, TRUCK, CAR], [1.0, 0.7, 0.4], [False, True, False]
    motions, offsets = [BRAKING, QUICKER, bc.Motion(30.0)], [0.0, 6.0, 9.0]
    traffic = bc.convoy(
        vehicles, offsets, opposite=opposite, lane_factors=factors, motions=motions
    )  # fmt: skip
    effect, t = bc.Moment(10.0), np.linspace(0, 1.1, 56)
    whole = signals_of(
        bc.crossing_response(stiff, traffic, BRAKING, ROAD, start=-12, timepts=t, effect=effect)
    )
    moments, tire = np.zeros_like(t), 0
    for i, vehicle in enumerate(vehicles):
        late, road = -motions[i].time(-offsets[i]), mirrored(ROAD) if opposite[i] else ROAD
        own = dataclasses.replace(effect, at=15.0) if opposite[i] else effect
        # Where it is when the first one starts.
        first = float(motions[i].position(BRAKING.time(-12.0) - late))
        given = {"start": first, "effect": own}
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", bc.PlausibilityWarning)  # of short approaches
            alone = signals_of(
                bc.crossing_response(
                    stiff, vehicle, motions[i], road, **given, timepts=t - late, tail=1.2
                )
            )
        moments += factors[i] * alone["moment"] * bc.Crossing(stiff, vehicle, own).static_peak
        for k in range(vehicle.linear.n_tires):
            tire += 1
            label = "tire_force" if vehicle is CAR else f"tire_force_{k + 1}"
            np.testing.assert_allclose(  # N
                whole[f"tire_force_{tire}"], alone[label], atol=1e-6 * 98100
            )
    peak = bc.Crossing(stiff, traffic, effect).static_peak
    np.testing.assert_allclose(whole["moment"] * peak, moments, atol=1e-6 * peak)


@pytest.mark.filterwarnings("ignore:start = -10 m is not forgotten")
@pytest.mark.parametrize("method", ["propagator", pytest.param("control", marks=pytest.mark.slow)])
@pytest.mark.parametrize("motions", [(), (24.0, 18.0), (BRAKING, QUICKER)])
def test_a_mirror_image_does_the_same_from_the_other_end(motions, method):
    ends, speed = np.array([False, True]), motions[0] if motions else 20.0
    found = [
        bc.daf(
            BEAM, bc.convoy([CAR, TRUCK], [0, 4], opposite=opposite, motions=motions), speed, road,
            start=-10, effect=[bc.Moment(at), bc.TireForce(3, sense="smallest")], method=method,
        )
        for opposite, road, at in ((ends, ROAD, 10.0), (~ends, mirrored(ROAD), 15.0))
    ]  # fmt: skip
    np.testing.assert_allclose(*found, rtol=0, atol=1e-9)


def test_one_vehicle_from_the_other_end_is_that_vehicle_on_the_mirrored_road():
    back = bc.convoy([CAR], [0], opposite=[True])
    there = bc.daf(BEAM, CAR, [15.0, 25.0], mirrored(ROAD), start=-10)
    np.testing.assert_allclose(bc.daf(BEAM, back, [15.0, 25.0], ROAD, start=-10), there, atol=1e-9)
    surface = bc.ramp_surface(BEAM, back, 25.0, approach=10, ramp_length=0.5)
    same = bc.ramp_surface(BEAM, CAR, 25.0, approach=10, ramp_length=0.5, both_ways=True)
    # A drop read backwards is a rise; behind the bridge there is nothing left to change.
    assert surface.positions[-1] == pytest.approx(34.5)
    np.testing.assert_allclose(surface.daf_unit[0, :19:-1], same.daf_rise[0], atol=1e-9)


@pytest.mark.parametrize("factor", [0.35, 0.8])
def test_a_lane_factor_is_a_beam_that_is_heavier_and_stiffer_by_its_square(factor):
    aside = bc.convoy([TRUCK], [0], lane_factors=[factor])
    heavier = bc.Beam(25, 18358 / factor**2, 4.865e10 / factor**2, n_modes=3, damping_ratio=0.01)
    given = {"start": -10, "effect": ["moment", bc.Deflection(), bc.TireForce(2), bc.Shear(5.0)]}
    found, expected = (
        bc.daf(beam, vehicle, [20.0, 30.0], ROAD, **given)
        for beam, vehicle in ((BEAM, aside), (heavier, TRUCK))
    )
    np.testing.assert_allclose(found, expected, rtol=0, atol=1e-9)
    beside, alone = (bc.Crossing(BEAM, each).static_peak for each in (aside, TRUCK))
    assert beside == pytest.approx(factor * alone, rel=1e-12)
    shake = bc.BridgeAcceleration(8.0)
    swings = bc.peak_effect(BEAM, aside, 25.0, ROAD, start=-10, effect=shake)
    swing = bc.peak_effect(heavier, TRUCK, 25.0, ROAD, start=-10, effect=shake)
    np.testing.assert_allclose(swings, swing / factor, rtol=1e-9)


@pytest.mark.slow
def test_vehicles_far_apart_cross_a_damped_beam_one_after_the_other():
    damped = dataclasses.replace(BEAM, damping_ratio=0.05)
    road = rough_road(3, -20.0, 26.0, 0.25, 3e-4)
    t = np.linspace(0.0, 1.0, 41)
    alone = signals_of(bc.crossing_response(damped, CAR, 25.0, road, start=0, timepts=t))
    second = bc.convoy([CAR, CAR], [0, 500.0], lanes=[1, 2])
    first = bc.crossing_response(damped, second, 25.0, road, start=0, timepts=t)
    np.testing.assert_allclose(signals_of(first)["moment"], alone["moment"], atol=1e-9)
    far = bc.convoy([CAR, CAR], [0, 500.0], motions=[25.0, 20.0])
    later = bc.crossing_response(damped, far, 25.0, timepts=t + 25.0)
    slower = bc.crossing_response(damped, CAR, 20.0, timepts=t)
    np.testing.assert_allclose(
        signals_of(later)["moment"], signals_of(slower)["moment"], atol=1e-7
    )  # fmt: skip


@pytest.mark.parametrize(
    ("motions", "offset"), [((), 3.0), ((15.0, 25.0), 8.0), ((BRAKING, QUICKER), 4.0)]
)
def test_the_static_effect_is_that_of_all_where_they_are(motions, offset):
    ends, factors = [False, True], [1.0, 0.6]
    pair = bc.convoy([CAR, TRUCK], [0, offset], opposite=ends, lane_factors=factors,
                     motions=motions)  # fmt: skip
    first = motions[0] if motions else 20.0
    motion = first if isinstance(first, bc.Motion) else bc.Motion(first)
    other = motion if not motions else bc.Motion(25.0) if motions[1] == 25.0 else motions[1]
    t = np.linspace(0, 1.9, 20001)
    late = 0.0 if not motions else -other.time(-offset)
    front = 25 - (other.position(t - late) - (0 if motions else offset))
    line, loads = bc.Moment(10.0).influence_line, TRUCK.static_loads
    own = CAR.linear.static_loads[0] * line(BEAM, motion.position(t))
    both = own + 0.6 * (loads[0] * line(BEAM, front) + loads[1] * line(BEAM, front + 5))
    crossing = bc.Crossing(BEAM, pair, bc.Moment(10.0))
    assert crossing.static_peak == pytest.approx(both.max(), rel=1e-4)
    assert crossing.static_peak >= both.max() * (1 - 1e-9)
    here = bc.Moment(10.0).static_values(BEAM, pair, motion.position(t[::1000]))
    np.testing.assert_allclose(here, both[::1000], atol=1e-6 * both.max())
    response = bc.crossing_response(BEAM, pair, first, static=True, effect=bc.Moment(10.0))
    assert signals_of(response)["static_moment"].max() == pytest.approx(1, abs=1e-3)


def test_who_overtakes_is_beside_the_other_halfway_when_both_come_there():
    # 10 m behind at 25 m/s, beside the other after 1 s at 15 m/s.
    pair = bc.convoy([CAR, CAR], [0, 10], motions=[15, 25], lane_factors=[1, 0.5])
    crossing = bc.Crossing(BEAM, pair)
    np.testing.assert_allclose(crossing.tire_positions(15.0), [15.0, 15.0])
    np.testing.assert_allclose(crossing.tire_paces(np.zeros(2)), [[1, 5 / 3], [1, 5 / 3]])
    assert crossing.exit == pytest.approx(25.0)
    slow = bc.convoy([CAR, CAR], [0, 10], motions=[25, 15], lanes=["left", "right"])
    assert bc.Crossing(BEAM, slow).exit == pytest.approx(35 / 15 * 25)


@pytest.mark.parametrize("approach", [0.0, 20.0])
@pytest.mark.parametrize("lanes", [[1.0, 1.0, 1.0], [1.0, 0.6, 0.8]])
def test_histories_of_ramps_superpose_to_those_of_traffic(approach, lanes):
    traffic = bc.convoy([CAR, TRUCK, CAR], [0, 3, 12], opposite=[False, True, False],
                        lane_factors=lanes)  # fmt: skip
    surface = bc.ramp_surface(BEAM, traffic, [15.0, 25.0], approach=approach, ramp_length=0.5)
    assert surface.stations[-1] == pytest.approx(25 + 3 + approach)
    assert f"m to {28 + approach:g} m, " in repr(surface)
    road = surface.road(surface.ramps(ROAD) * surface.ramp_height)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", bc.PlausibilityWarning)  # of short approaches
        simulated = bc.daf(BEAM, traffic, surface.speeds, road, start=-approach)
        np.testing.assert_allclose(surface.superposed_daf(ROAD), simulated, atol=1e-9)
        assert np.abs(surface.dae(ROAD) - simulated).max() < 0.02


@pytest.mark.slow
def test_ramps_by_the_control_library_do_the_same_to_traffic():
    pair = bc.convoy([CAR, CAR], [0, 3], opposite=[False, True], lane_factors=[1, 0.7])
    fast, slow = (
        bc.ramp_surface(BEAM, pair, 25.0, approach=2, ramp_length=5.0, method=method)
        for method in ("propagator", "control")
    )
    np.testing.assert_allclose(fast.daf_unit, slow.daf_unit, atol=1e-6)


@pytest.mark.slow
def test_a_tire_from_the_other_end_leaves_the_road_on_its_own():
    bump = bc.RoadProfile([-5, 27, 27.25, 27.5, 60], [0, 0, -0.08, 0, 0])
    pair = bc.convoy([CAR, CAR], [0, 5], opposite=[False, True])
    found = []
    for method in ("propagator", "control"):
        with pytest.warns(bc.LiftOffWarning, match="a tire leaves the road"):
            response = bc.crossing_response(
                BEAM, pair, 20.0, bump, method=method, timepts=np.linspace(0, 1.3, 261)
            )
        found.append(signals_of(response))
    assert found[0]["tire_force_2"].min() == 0
    assert found[0]["tire_force_1"].min() > 9e4  # N
    for label in ("moment", "deflection"):
        np.testing.assert_allclose(found[0][label], found[1][label], atol=1e-6)


def test_traffic_is_a_vehicle_that_tells_what_it_is():
    pair = bc.convoy([CAR, TRUCK], [0, 4], opposite=[False, True], motions=[20, 15])
    assert repr(pair) == (
        "Traffic(0 m before the start, lane factor 1; 4 m before the other end, lane factor 1, "
        "motions=(Motion(speed=20 m/s, acceleration=0 m/s^2), "
        "Motion(speed=15 m/s, acceleration=0 m/s^2)))"
    )
    again = bc.convoy([CAR, TRUCK], [0, 4], opposite=[False, True], motions=[20, 15])
    row = bc.convoy([CAR, TRUCK], [0, 4])
    assert (pair == again, pair == row, row == pair) == (True, False, False)
    assert hash(pair) == hash(again)
    assert pair.undamped.motions == pair.motions
    assert type(bc.convoy([CAR, TRUCK], [0, 4], lanes=[1, 1])) is bc.Vehicle
    system = bc.crossing_system(BEAM, pair, 20.0)
    assert system.input_labels[:3] == ["road_1", "road_2", "road_3"]
    envelope = bc.envelope(BEAM, pair, 20.0, at=[10.0])
    assert envelope.largest[0] == pytest.approx(
        bc.peak_effect(BEAM, pair, 20.0, effect=bc.Moment(10.0))[0], rel=1e-6
    )


TWO = [CAR, CAR]
LONG = bc.trucks.load("T2")
PITCHER = dataclasses.replace(TRUCK, pitch_input=[0, 2e4, 0, 0])


@pytest.mark.parametrize(
    ("arguments", "given", "says"),
    [
        ((TWO, [0, 0]), {}, "vehicles 1 and 2 overlap in their lane"),
        (([LONG, CAR], [0, 5]), {}, "vehicles 1 and 2 overlap in their lane"),
        ((TWO, [0, 5]), {"lane_factors": [1, 1.2]}, "lane_factors must be above 0 and at most 1"),
        ((TWO, [0, 5]), {"lane_factors": [1, 0]}, "got [1.0, 0.0]"),
        ((TWO, [0, 5]), {"lane_factors": [1]}, "one value for each of the 2 vehicles, got 1"),
        ((TWO, [3, 5]), {"opposite": [False, True]}, "whose offset is 0 m, got 3 m"),
        ((TWO, [0, 5]), {"opposite": [False, True], "lanes": [1, 1]}, "meet in one lane, 1"),
        ((TWO, [0, 5]), {"motions": [20, -20]}, "speed must be"),
        (
            ([PITCHER, CAR], [0, 9]),
            {"motions": [BRAKING, 20]},
            "vehicles that pitch as they brake",
        ),
        ((TWO, [0, -5]), {"lanes": [1, 2]}, "offsets must be distances behind"),
        (([], []), {}, "vehicles must hold at least one vehicle"),
    ],
)
def test_traffic_that_cannot_be_is_refused(arguments, given, says):
    with pytest.raises(ValueError, match=re.escape(says)):
        bc.convoy(*arguments, **given)


@pytest.mark.parametrize(
    ("given", "says"),
    [
        ({"opposite": True}, "opposite must be a list"),
        ({"opposite": [0, 1]}, "opposite must be True or False"),
        ({"lanes": "left"}, "lanes must be a list"),
        ({"motions": [20, "fast"]}, "speed must be one number"),
    ],
)
def test_what_is_no_list_is_refused(given, says):
    with pytest.raises(TypeError, match=re.escape(says)):
        bc.convoy(TWO, [0, 5], **given)
    with pytest.raises(TypeError, match="single ones"):
        bc.convoy([bc.convoy(TWO, [0, 5], lanes=[1, 2], lane_factors=[1, 0.5]), CAR], [0, 20])


@pytest.mark.parametrize("function", [bc.daf, bc.peak_effect, bc.crossing_response])
def test_crossings_that_traffic_cannot_make_are_refused(function):
    def refused(traffic, speed, says, *road, **given):
        with pytest.raises(ValueError, match=re.escape(says)):
            function(BEAM, traffic, speed, *road, **given)

    faster = bc.convoy(TWO, [0, 10], motions=[15, 25])
    refused(faster, 15.0, "vehicles 1 and 2 overlap in their lane with the first at x = 15")
    refused(faster, 20.0, "speed must be that of the first vehicle")
    standing = bc.convoy(TWO, [0, 10], motions=[15, bc.Motion(10, -3.0)], lanes=[1, 2])
    refused(standing, 15.0, "must not bring the vehicle to rest")
    meeting = bc.convoy(TWO, [0, 10], opposite=[False, True])
    short = bc.RoadProfile([-20, 25], [0, 0])
    refused(meeting, 20.0, "with vehicles from the other end, needs -5 m to 40 m", short, start=-5)
    refused(meeting, 20.0, "the other end, needs 0 m to 35 m", short)


def test_what_takes_one_row_or_one_speed_says_so():
    overtaking = bc.convoy(TWO, [0, 10], motions=[15, 25], lanes=[1, 2])
    braking = bc.convoy(TWO, [0, 10], motions=[BRAKING, 25], lanes=[1, 2])
    late_braking = bc.convoy(TWO, [0, 10], motions=[22, BRAKING], lanes=[1, 2])
    meeting = bc.convoy(TWO, [0, 0.01], opposite=[False, True])
    with pytest.raises(ValueError, match="motions must be left out of"):
        bc.ramp_surface(BEAM, overtaking, 15.0)
    with pytest.raises(ValueError, match="motions must be of constant speed here"):
        bc.envelope(BEAM, late_braking, 22.0)
    with pytest.raises(ValueError, match="speed must be that of the first vehicle"):
        bc.prediction_matrices(BEAM, overtaking, 20.0)
    with pytest.raises(ValueError, match="speed must be that of the first vehicle"):
        bc.crossing_system(BEAM, braking, 22.0)
    with pytest.raises(TypeError, match="a row of them in one lane, in crossings with a damper"):
        bc.daf(BEAM, meeting, 25.0, damper=bc.dampers.skyhook(1e3, 2e4))
    with pytest.raises(TypeError, match="in one lane, in crossings with a damper"):
        bc.score([bc.dampers.skyhook(1e3, 2e4)], BEAM, meeting, [ROAD], [25.0])
    with pytest.raises(TypeError, match="in one lane, in animations"):
        bc.crossing_animation(BEAM, meeting, 25.0)
    odd = dataclasses.replace(BEAM, length=25.03)
    with pytest.raises(ValueError, match=r"ramp_length must fit into the way of 25\.04 m"):
        bc.ramp_surface(odd, meeting, 25.0)
