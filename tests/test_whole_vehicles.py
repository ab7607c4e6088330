"""Dampers at every axle: against a fine integration, quarter-cars, and the linear crossing."""

from __future__ import annotations

import dataclasses

import control as ct
import numpy as np
import pytest
from fine_loop import FineLoop
from helpers import rough_road

import bridgectl as bc
from bridgectl import dampers
from bridgectl.dampers import Damper, passive, simulate_loop, skyhook

SOFT, STIFF = 1e3, 30e3

LAWS = {
    law.name: law
    for law in (
        dampers.skyhook(SOFT, STIFF), dampers.continuous_skyhook(SOFT, STIFF),
        dampers.groundhook(SOFT, STIFF), dampers.hybrid(SOFT, STIFF), dampers.add(SOFT, STIFF),
        dampers.sh_add(SOFT, STIFF), dampers.pdd(SOFT, STIFF, stiffness=2e5),
    )
}  # fmt: skip
"""Laws that know no vehicle; the eighth, bridgehook, is made for it."""


def half_car(rng, inertia=None):
    """A truck of two axles with bounce and pitch; without coupling inertia if none is given."""
    a, b = rng.uniform(1, 3, 2)
    legs = np.array([[1, -a, -1, 0], [1, b, 0, -1]])
    mass, springs, dashpots = rng.uniform(8e3, 14e3), rng.uniform(1e5, 4e5, 2), [8e3, 11e3]
    return bc.Vehicle(
        np.diag([mass, mass * a * b if inertia is None else inertia, *rng.uniform(500, 1e3, 2)]),
        legs.T @ np.diag(dashpots) @ legs, legs.T @ np.diag(springs) @ legs,
        rng.uniform(1.2e6, 2.5e6, 2), [0, a + b], damper_map=legs, damper_dampings=dashpots,
        damper_names=["front", "rear"], heave=[1, 0, 1, 1],
    )  # fmt: skip


def quarter_cars(car):
    """The quarter-cars that a half-car without coupling inertia is."""
    mass, (a, b) = car.mass_matrix[0, 0], (-car.damper_map[0, 1], car.damper_map[1, 1])
    shares = mass * b / (a + b), mass * a / (a + b)
    springs = -car.stiffness_matrix[0, 2], -car.stiffness_matrix[0, 3]
    return [
        bc.QuarterCar(share, car.mass_matrix[2 + i, 2 + i], spring, tire, damping)
        for i, (share, spring, tire, damping) in enumerate(
            zip(shares, springs, car.tire_stiffnesses, car.damper_dampings, strict=True)
        )
    ]


def five_axles(rng):
    """A tractor of two axles and a semi-trailer of three, hinged, on soft springs."""
    springs, dashpots = rng.uniform(3e5, 8e5, 5), rng.uniform(5e3, 2e4, 5)
    arms = np.array([[1, -1, 0], [1, 3.5, 0], [1, 3, 7], [1, 3, 8.2], [1, 3, 9.4]])
    legs, bodies = np.hstack([arms, -np.eye(5)]), np.array([[1, 0, 0], [1, 3, 5]])
    mass = np.diag([0.0, 0.0, 0.0, 750, 750, 1100, 1100, 1100])
    mass[:3, :3] = bodies.T @ np.diag([5e3, rng.uniform(15e3, 25e3)]) @ bodies
    mass[1, 1] += 5e3
    mass[2, 2] += 12e4
    stiffness, damping = (legs.T @ np.diag(of) @ legs for of in (springs, dashpots))
    return bc.Vehicle(
        mass, damping, stiffness, [1.75e6, 1.75e6, 3.5e6, 3.5e6, 3.5e6],
        [0, 4.5, 11, 12.2, 13.4], heave=[1, 0, 0, 1, 1, 1, 1, 1], damper_map=legs,
        damper_dampings=dashpots,
    )  # fmt: skip


def random_case(seed, truck):
    """A short bridge, a vehicle, dampers, a speed and a road: lift-off of every third."""
    rng = np.random.default_rng(seed)
    length = rng.uniform(6, 10)
    rigidity = 15e3 * (2 * np.pi * rng.uniform(6, 9)) ** 2 * (length / np.pi) ** 4
    beam = bc.Beam(length, 15e3, rigidity, n_modes=2, damping_ratio=rng.choice([0.0, 0.02]))
    car = truck(rng) if truck is five_axles else truck(rng, rng.uniform(1e4, 5e4))
    lift_off = seed % 3 == 0
    limits = [[np.inf, 2e3], [1e3, 4e3], [np.inf]][seed % 3]
    clock = rng.choice([2e-3, rng.uniform(5e-3, 2e-2)])
    options = [
        {
            "sample_time": clock,
            "lag": rng.choice([0.0, rng.uniform(2e-3, 2e-2)]),
            "max_force": float(rng.choice(limits)),
        }
        for _ in car.damper_map
    ]
    height = 4e-2 if lift_off else 1e-3
    road = rough_road(seed, -2, np.ceil(length), 0.5, height=height)
    return beam, car, options, rng.uniform(20, 40), road, lift_off


def compare(seed, truck, name):
    """The loop's result and the fine integration of the same crossing."""
    beam, car, *_ = random_case(seed, truck)
    made = {"bridgehook": lambda: dampers.bridgehook(beam, car, SOFT, STIFF),
            "clipped LQR": lambda: dampers.clipped_lqr(car, SOFT, STIFF)}  # fmt: skip
    return compare_law(seed, truck, LAWS[name] if name in LAWS else made[name]())


def compare_law(seed, truck, law):
    """The same of a law."""
    beam, car, options, speed, road, lift_off = random_case(seed, truck)
    each = [Damper(law, **own) for own in options]
    found = simulate_loop(beam, car, each, speed, road.x, road.elevation)
    return found, FineLoop(beam, car, each, speed, road), lift_off


@pytest.mark.slow
@pytest.mark.parametrize("name", [*LAWS, "bridgehook", "clipped LQR"])
@pytest.mark.parametrize(
    ("truck", "seed"), [*((half_car, seed) for seed in range(5)), (five_axles, 1), (five_axles, 3)]
)
def test_every_law_at_every_axle_is_its_fine_integration(truck, name, seed):
    """Random crossings of each law, with lift-off, force limits, lags: within 2e-5."""
    found, fine, lift_off = compare(seed, truck, name)
    assert found.daf[0, 0] == pytest.approx(fine.peak, abs=2e-5)
    assert (found.least_force[0, 0] == 0) == (fine.least == 0) == lift_off


@pytest.mark.quick_cases(1)
@pytest.mark.parametrize(
    ("truck", "seed", "name"), [(half_car, 3, "skyhook"), (five_axles, 1, "groundhook")]
)
def test_a_law_at_every_axle_is_its_fine_integration(truck, seed, name):
    found, fine, _ = compare(seed, truck, name)
    assert found.daf[0, 0] == pytest.approx(fine.peak, abs=2e-5)


# Against quarter-cars


def quick_and_slow(laws):
    """One law after the other, those from the second on as slow tests."""
    first, *others = laws
    return [first, *(pytest.param(law, marks=pytest.mark.slow) for law in others)]


@pytest.fixture(scope="module")
def roads():
    """Stations and two roads of class A, from 20 m before the bridge on."""
    some = [bc.iso8608_profile("A", 45, seed=seed, start=-20) for seed in (1, 2)]
    return some[0].x, np.array([road.elevation for road in some])


@pytest.mark.parametrize("name", ["passive", *quick_and_slow([*LAWS, "bridgehook", "clipped LQR"])])
@pytest.mark.slow
def test_a_half_car_without_coupling_inertia_is_two_quarter_cars(bridge, roads, name):
    """In open and closed loop, with a lag and a force limit, DAFs within 1e-9."""
    half = half_car(np.random.default_rng(3))
    cars = quarter_cars(half)
    two = bc.convoy(cars, [0, half.tire_offsets[1]])
    found = []
    for vehicle in (half, two):
        law = {
            **LAWS, "passive": passive(9e3),
            "bridgehook": dampers.bridgehook(bridge, vehicle, SOFT, STIFF),
            "clipped LQR": dampers.clipped_lqr(vehicle, SOFT, STIFF),
        }[name]  # fmt: skip
        given = Damper(law, lag=0.0 if name == "bridgehook" else 0.01, max_force=3e3)
        found.append(simulate_loop(bridge, vehicle, given, [20.0, 30.0], *roads).daf)
    # Bridgehook has no dead band: what it commands a damper that is still, which counts in the
    # sample in which that begins to move, is up to round-off.
    assert found[0] == pytest.approx(found[1], abs=1e-6 if name == "bridgehook" else 1e-9)


@pytest.mark.slow
@pytest.mark.filterwarnings("ignore::bridgectl.PlausibilityWarning")  # a bridge of rock
@pytest.mark.parametrize("law", [skyhook(SOFT, STIFF), dampers.tire_groundhook(SOFT, STIFF)])
def test_on_rock_the_tires_of_a_half_car_have_the_forces_of_quarter_cars_on_their_own(roads, law):
    """Within 1e-6 of the static load: the steps are cut at other places."""
    rock = bc.Beam(25.0, 1e12, 1e19, n_modes=1)
    half = dataclasses.replace(half_car(np.random.default_rng(4)), tire_offsets=[0.0, 4.0])
    x, z = roads[0], roads[1][0]
    together = simulate_loop(rock, half, law, 25.0, x, z, record=["tire_force"])
    for leg, car in enumerate(quarter_cars(half)):
        alone = simulate_loop(rock, car, law, 25.0, x, z, record=["tire_force"])
        own = together.histories[0]["tire_force"][leg, 0]
        single = alone.histories[0]["tire_force"][0]
        late = leg * 80  # samples of 2 ms
        assert own[late : late + single.size] == pytest.approx(single, abs=0.06)  # newtons
        assert own[:late] == pytest.approx(np.full(late, half.static_loads[leg]), abs=0.06)


# Against the linear crossing


@pytest.mark.quick_cases(1)
@pytest.mark.filterwarnings("ignore:start = :bridgectl.PlausibilityWarning")
@pytest.mark.parametrize("effect", ["moment", "tire_force_2", bc.Moment(8.0), bc.Deflection()])
@pytest.mark.parametrize("truck", [half_car, five_axles])
def test_constant_dampers_in_the_loop_are_the_linear_crossing(bridge, roads, truck, effect):
    """A force limit that is never met keeps them in the loop: DAFs within 1e-5."""
    vehicle = truck(np.random.default_rng(5))
    road = bc.RoadProfile(roads[0], roads[1][0])
    case = {"start": -20, "effect": effect}
    each = [Damper(passive(c), max_force=1e9) for c in vehicle.damper_dampings]
    looped = bc.daf(bridge, vehicle, [20.0, 30.0], road, damper=each, **case)
    assert looped == pytest.approx(bc.daf(bridge, vehicle, [20.0, 30.0], road, **case), abs=1e-5)


@pytest.mark.filterwarnings("ignore:start = :bridgectl.PlausibilityWarning")
@pytest.mark.slow
def test_with_dampers_too_a_vehicle_starts_at_rest_on_the_road_under_each_axle(bridge):
    """DAFs within 1e-5 of the linear crossing's, the tires' forces within 1 N at the start."""
    vehicle = five_axles(np.random.default_rng(8))
    road = bc.iso8608_profile("A", 120, seed=3, start=-80)
    case = bridge, vehicle, 25.0, road
    held = [Damper(passive(c), max_force=1e9) for c in vehicle.damper_dampings]
    for effect in ("moment", "tire_force_5"):
        looped, linear = (
            bc.daf(*case, start=-20, effect=effect, damper=damper) for damper in (held, None)
        )
        assert looped == pytest.approx(linear, abs=1e-5)
        level = bc.daf(*case[:3], road.crop(-20, 40), start=-20, effect=effect, damper=held)
        assert abs(level - linear) > 1e-4
    first, other = (
        bc.crossing_response(*case, start=-20, damper=damper).outputs for damper in (held, None)
    )
    for k in range(1, 6):
        name = f"tire_force_{k}"
        assert first[name][0] == pytest.approx(other[name][0], abs=1.0)  # newtons


def test_constant_dampers_become_part_of_the_vehicle(bridge):
    """Given by name, in a list, or for all legs: as a vehicle that was built with them."""
    vehicle = half_car(np.random.default_rng(6), 3e4)
    legs, before = vehicle.damper_map, np.diag(vehicle.damper_dampings)
    other = dataclasses.replace(
        vehicle, damping_matrix=vehicle.damping_matrix + legs.T @ (2e4 * np.eye(2) - before) @ legs
    )
    want = bc.daf(bridge, other, 25.0)
    for given in (passive(2e4), [passive(2e4)] * 2, {"front": passive(2e4), "rear": passive(2e4)}):
        assert bc.daf(bridge, vehicle, 25.0, damper=given) == pytest.approx(want, abs=1e-12)
    surface = bc.ramp_surface(bridge, vehicle, 25.0, damper=passive(2e4))
    assert surface.daf_smooth == pytest.approx(want, abs=1e-6)


@pytest.mark.slow
def test_a_leg_without_a_damper_of_its_own_keeps_its_passive_one(bridge, roads):
    vehicle = half_car(np.random.default_rng(7), 3e4)
    road = bc.RoadProfile(roads[0], roads[1][1])
    front = {"start": -20, "damper": {"front": skyhook(SOFT, STIFF)}}
    listed = {"start": -20, "damper": [skyhook(SOFT, STIFF), None]}
    rear = Damper(passive(vehicle.damper_dampings[1]), max_force=1e9)
    whole = {"start": -20, "damper": [skyhook(SOFT, STIFF), rear]}
    one, two, three = (bc.daf(bridge, vehicle, 25.0, road, **of) for of in (front, listed, whole))
    assert np.array_equal(one, two)
    assert one == pytest.approx(three, abs=1e-6)
    response = bc.crossing_response(bridge, vehicle, 25.0, road, **front)
    forces = dict(zip(response.input_labels, response.inputs, strict=True))
    assert np.ptp(forces["damper_force_1"]) > 0
    assert not forces["damper_force_2"].any()
    assert response.outputs["moment"].max() == pytest.approx(one[0], abs=1e-3)  # its samples


# What users ask


@pytest.mark.slow
def test_a_surface_and_a_score_are_of_all_tires_and_legs(bridge):
    vehicle = half_car(np.random.default_rng(8), 3e4)
    roads = [bc.iso8608_profile("A", 35, seed=seed, start=-10) for seed in (1, 2)]
    mixed = [skyhook(SOFT, STIFF), passive(9e3)]
    board = bc.score(
        [passive(9e3), mixed, dampers.bridgehook(bridge, vehicle, SOFT, STIFF)], bridge, vehicle,
        roads, 25.0, approach=10, workers=1, progress=False,
    )  # fmt: skip
    assert board.strategies == ("passive 9 kN s/m", "skyhook, passive 9 kN s/m", "bridgehook")
    want = [bc.daf(bridge, vehicle, 25.0, road, start=-10, damper=mixed)[0] for road in roads]
    assert board.values["daf"][1, :, 0] == pytest.approx(want, abs=1e-6)
    x = roads[0].x
    each = simulate_loop(
        bridge, vehicle, mixed, 25.0, x, roads[0].elevation,
        record=["body_acceleration", "tire_force"],
    ).histories[0]  # fmt: skip
    worst = np.sqrt(np.mean(each["body_acceleration"][:, 0] ** 2, axis=1)).max()
    assert board.values["body_acceleration"][1, 0, 0] == pytest.approx(worst, rel=0.01)
    assert each["tire_force"].shape[0] == 2
    surface = bc.ramp_surface(bridge, vehicle, 25.0, approach=10, every=50, damper=mixed)
    drop = bc.RoadProfile([-10, -5, -4.9, 25], [0, 0, -1e-3, -1e-3])
    unit = bc.daf(bridge, vehicle, 25.0, drop, start=-10, damper=mixed)
    assert surface.daf_unit[0, 50] == pytest.approx(unit[0], abs=1e-6)


@pytest.mark.parametrize(
    ("damper", "error", "message"),
    [
        ([skyhook(SOFT, STIFF)], ValueError, "one for all 2 dampers of the vehicle, or a list"),
        ([None, None], ValueError, "type None in the list where the passive one stays"),
        ({"middle": skyhook(SOFT, STIFF)}, ValueError, "'front', 'rear', got 'middle'"),
        ({}, ValueError, "'front', 'rear', got none"),
        ([skyhook(SOFT, STIFF), 7e3], TypeError, "type bridgectl.dampers.passive"),
        ([Damper(skyhook(SOFT, STIFF), sample_time=1e-3), skyhook(SOFT, STIFF)], ValueError,
         r"the same sample_time, got \[0.001, 0.002\] s"),
        ([dampers.preset(SOFT, STIFF), skyhook(SOFT, STIFF)], ValueError,
         "type the same preset for all of them"),
    ],
)  # fmt: skip
def test_each_mistake_is_named(bridge, damper, error, message):
    vehicle = half_car(np.random.default_rng(9))
    with pytest.raises(error, match=message):
        bc.daf(bridge, vehicle, 25.0, damper=damper)


def test_a_law_made_for_quarter_cars_refuses_a_leg_that_is_none(bridge):
    """The lower end of the second damper is the body, as of a cab's."""
    vehicle = half_car(np.random.default_rng(9))
    cab = dataclasses.replace(vehicle, damper_axles=vehicle.damper_axles[[0, 0]] * [[1], [0]])
    with pytest.raises(ValueError, match="damper 'rear' of the vehicle must carry a body"):
        dampers.clipped_lqr(cab, SOFT, STIFF)
    assert bc.daf(bridge, cab, 25.0, damper=skyhook(SOFT, STIFF)).shape == (1,)


@pytest.mark.slow
def test_blocks_of_all_legs_in_the_control_library_are_the_loop(bridge):
    """A crossing and a block a leg, interconnected; sampled 20 times as often: within 2e-4."""
    vehicle = half_car(np.random.default_rng(10), 3e4)
    law = dampers.continuous_skyhook(SOFT, STIFF, gain=15e3)
    blocks = [law.system(25.0, vehicle=vehicle, leg=leg) for leg in (1, 2)]
    crossing = bc.crossing_system(bridge, vehicle.undamped, 25.0)
    loop = ct.interconnect(
        [crossing, *blocks], inputs=["road_1", "road_2"], outputs=["moment", "damping_2"],
        check_unused=False,
    )  # fmt: skip
    times = np.linspace(0, (25 + vehicle.tire_offsets[1]) / 25, 1201)
    road = bc.RoadProfile([0, 5, 5.1, 30], [0, 0, -4e-3, -4e-3])
    drops = np.array([road.drop(25 * times - d, 0.0) for d in vehicle.tire_offsets])
    found = ct.input_output_response(
        loop, times, drops, solve_ivp_kwargs={"rtol": 1e-7, "atol": 1e-10, "max_step": 1e-3}
    )
    fast = Damper(law, sample_time=1e-4)
    want = bc.daf(bridge, vehicle, 25.0, road, damper=fast)[0]
    assert found.outputs[0].max() == pytest.approx(want, abs=2e-4)
    with pytest.raises(ValueError, match="leg must be one of the 2 dampers"):
        law.system(25.0, vehicle=vehicle, leg=3)
    groundhook = dampers.tire_groundhook(SOFT, STIFF).system(25.0, vehicle=vehicle, leg=2)
    assert groundhook.output_labels == ["damper_force_2", "damping_2"]
    assert "tire_force_2" in groundhook.input_labels


def test_dampers_that_keep_their_damping_are_the_same_at_many_speeds_as_at_each():
    """Many speeds go side by side in arrays, which must have the truck with its new dampers."""
    bridge, truck = bc.li2006.beam(), half_car(np.random.default_rng(5))
    speeds, new = np.linspace(15.0, 30.0, 5), passive(4e3)
    over = {"profile": bc.iso8608_profile("A", 125, seed=1, start=-100), "start": -100}
    for damper in (new, {"front": new}):
        together = bc.daf(bridge, truck, speeds, damper=damper, **over)
        each = [bc.daf(bridge, truck, speed, damper=damper, **over)[0] for speed in speeds]
        assert np.abs(together - each).max() < 1e-6
        assert np.abs(together - bc.daf(bridge, truck, speeds, **over)).max() > 1e-3
