"""Motions of constant acceleration by pieces: where they are, and crossings by them."""

import json
import re
import warnings
from itertools import pairwise

import numpy as np
import pytest
from helpers import rough_road, run_command
from reference_trucks import (
    needs_reference,
    random_bridge,
    random_motion,
    random_truck,
    reference_case,
)

import bridgectl as bc

BEAM = bc.Beam(25, 18358, 4.865e10, n_modes=3, damping_ratio=0.01)
CAR = bc.QuarterCar(9000, 1000, 80e3, 1.8e6, 7e3)
STOPPING = bc.Motion(25.0, acceleration=[0, -3, 0], changes=[-5, 12])
LEGS = np.array([[1.0, -2.0, -1.0, 0.0], [1.0, 3.0, 0.0, -1.0]])
LEVER = 12000 * 1.4
TRUCK = bc.Vehicle(
    np.diag([12000.0, 40000.0, 700.0, 900.0]),
    LEGS.T @ np.diag([12e3, 15e3]) @ LEGS,
    LEGS.T @ np.diag([400e3, 600e3]) @ LEGS,
    [1.8e6, 3.6e6],
    [0.0, 5.0],
    damper_map=LEGS,
    heave=[1.0, 0.0, 1.0, 1.0],
    pitch_input=[0.0, LEVER, 0.0, 0.0],
)


@pytest.mark.parametrize("seed", range(20))
def test_places_and_times_of_a_motion_are_each_others_inverse(seed):
    motion = random_motion(np.random.default_rng(seed), -40.0, 50.0)
    x = np.linspace(-40, 50, 901)
    t = motion.time(x)
    assert np.all(np.diff(t) > 0)
    np.testing.assert_allclose(motion.position(t), x, atol=1e-9)  # m
    speeds = motion.speeds(x)
    middle = motion.speeds((x[1:] + x[:-1]) / 2)
    np.testing.assert_allclose(np.diff(x) / np.diff(t), middle, rtol=2e-3)
    np.testing.assert_allclose(
        np.diff(speeds**2), 2 * motion.accelerations(x[:-1]) * np.diff(x), atol=1.0
    )
    assert (motion.position(0.0), float(motion.speeds(0.0))) == (0.0, motion.speed)


def test_accelerations_change_where_they_are_told_to():
    assert STOPPING.accelerations(np.array([-9, -5, 11.9, 12])).tolist() == [0, -3, -3, 0]
    assert not STOPPING.uniform
    assert bc.Motion(25.0, [0, 0], [3]).uniform
    assert bc.Motion(25.0, [2.0]) == bc.Motion(25.0, 2.0)
    assert repr(STOPPING) == (
        "Motion(speed=25 m/s, acceleration=(0, -3, 0) m/s^2, changes at (-5, 12) m)"
    )


@pytest.mark.parametrize(
    ("arguments", "says"),
    [
        ((25.0, [0, -3]), "changes must be the places between the accelerations"),
        ((25.0, -3, [10]), "got 1 places for 1 accelerations"),
        ((25.0, [0, -3, 1], [10, 10]), "changes must increase [m], got [10.0, 10.0]"),
        ((25.0, [0, np.inf], [10]), "acceleration must be finite"),
    ],
)
def test_a_bad_motion_is_named(arguments, says):
    with pytest.raises(ValueError, match=re.escape(says)):
        bc.Motion(*arguments)


@pytest.mark.parametrize("function", [bc.daf, bc.peak_effect, bc.crossing_response])
@pytest.mark.parametrize(
    ("motion", "start", "says"),
    [
        (bc.Motion(10.0, [0, -3], [5.0]), 0.0, "at -3 m/s^2 it stands at x = 21.67 m"),
        (bc.Motion(10.0, [0, -6, 2], [5.0, 20.0]), 0.0, "it stands at x = 13.33 m"),
        (bc.Motion(10.0, 4.0), -20.0, "at 4 m/s^2 it comes from rest at x = -12.5 m"),
    ],
)
def test_a_vehicle_that_stands_still_on_its_way_is_refused_with_the_place(
    function, motion, start, says
):
    with pytest.raises(ValueError, match=re.escape(says)):
        function(BEAM, CAR, motion, start=start)


def test_a_tail_in_which_it_would_turn_round_is_refused():
    braking = bc.Motion(14.0, -3.0)
    assert bc.crossing_response(BEAM, CAR, braking, tail=0.5).time[-1] > braking.time(25.0) + 0.49
    with pytest.raises(ValueError, match="tail must end before the vehicle stands still, got 9 s"):
        bc.crossing_response(BEAM, CAR, braking, tail=9.0)


@needs_reference
def test_the_reference_case_of_braking_is_met_within_2e_4():
    given, expected = reference_case("f_QC_SS25_smooth_25_brake3")
    assert bc.daf(**given)[0] == pytest.approx(expected, abs=2e-4)


def compared(seed: int) -> None:
    """Both routes give the same peaks of a random truck, bridge, motion and road, within 1e-6."""
    rng = np.random.default_rng(seed)
    truck, bridge, start = random_truck(rng), random_bridge(rng), -rng.uniform(3, 10)
    motion = random_motion(rng, start, bridge.length + truck.linear.tire_offsets.max())
    road = None if seed % 3 == 0 else rough_road(seed, start - 12, bridge.length + 1, 0.7, 8e-4)
    given = {"start": start, "effect": ["moment", bc.Deflection(), bc.TireForce(sense="smallest")]}
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", bc.PlausibilityWarning)  # of short approaches
        fast = bc.daf(bridge, truck, [motion, 22.0], road, **given)
        slow = bc.daf(bridge, truck, [motion, 22.0], road, **given, method="control")
        np.testing.assert_allclose(fast, slow, rtol=0, atol=1e-6)
        alone = bc.daf(bridge, truck, motion, road, start=start)
        np.testing.assert_allclose(alone, fast[0, :1], rtol=0, atol=2e-7)


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(20))
def test_both_routes_agree_on_20_random_trucks_motions_and_bridges(seed):
    compared(seed)


@pytest.mark.slow
def test_accelerations_of_a_braking_truck_are_those_of_the_other_route():
    given = {"effect": bc.BodyAcceleration(2), "start": -10.0}
    fast = bc.peak_effect(BEAM, TRUCK, STOPPING, **given)
    slow = bc.peak_effect(BEAM, TRUCK, STOPPING, **given, method="control")
    np.testing.assert_allclose(fast, slow, atol=1e-6)  # rad/s^2
    together = bc.peak_effect(
        BEAM, TRUCK, STOPPING, start=-10.0, effect=[given["effect"], "moment"]
    )
    np.testing.assert_allclose(together[0], fast, atol=1e-6)


@pytest.mark.slow
def test_several_effects_of_a_braking_car_are_those_of_the_other_route():
    effects = ["moment", bc.Deflection(8.0), "tire_force"]
    fast = bc.daf(BEAM, CAR, [STOPPING, 20.0], start=-8.0, effect=effects)
    slow = bc.daf(BEAM, CAR, [STOPPING, 20.0], start=-8.0, effect=effects, method="control")
    np.testing.assert_allclose(fast, slow, rtol=0, atol=1e-7)
    np.testing.assert_allclose(bc.daf(BEAM, CAR, STOPPING, start=-8.0), fast[0, :1], atol=1e-8)


@pytest.mark.slow
def test_long_braking_moves_load_to_the_front_axle():
    braking = bc.Motion(30.0, acceleration=[0, -2], changes=[-300])
    found = bc.crossing_response(BEAM, TRUCK, braking, start=-310)
    loads = TRUCK.static_loads
    transfer = LEVER * 2 / 5  # m h a over the wheelbase [N]
    entry = np.argmax(found.time >= 0)
    last = [found.outputs[f"tire_force_{k}"][entry] for k in (1, 2)]
    assert last == pytest.approx([loads[0] + transfer, loads[1] - transfer], rel=1e-3)


def test_trucks_from_parts_pitch_by_the_heights_of_their_bodies_and_have_their_tires_damping():
    axles = [
        bc.trucks.Axle(-2.0, 700, 4e5, 1.8e6, damping=12e3, tire_damping=5e3),
        bc.trucks.Axle(3.0, 900, 6e5, 3.6e6, damping=15e3),
    ]
    trailer = [bc.trucks.Axle(x, 800, 6e5, 3.5e6, damping=1e4, tire_damping=1e4) for x in (2, 3.2)]
    one = bc.trucks.Body(12000, 4e4, axles, height=1.4)
    truck = bc.trucks.rigid(one)
    assert dict(zip(truck.coordinates, truck.pitch_input, strict=True))["thB"] == 12000 * 1.4
    assert truck.tire_damping.tolist() == [5e3, 0.0]
    both = bc.trucks.articulated(one, bc.trucks.Body(2e4, 1e5, trailer, height=2.0), (2.5, -4.0))
    pitch = dict(zip(both.coordinates, both.pitch_input, strict=True))
    assert (pitch["thB1"], pitch["thB2"], pitch["yB1"]) == (12000 * 1.4, 4e4, 0.0)
    assert both.tire_damping.tolist() == [5e3, 0.0, 1e4, 1e4]
    slowing = bc.Motion(20.0, -4.0)
    first = bc.TireForce()
    assert bc.daf(BEAM, truck, slowing, start=-5, effect=first) > 1.05  # it dives


def test_piecewise_motion_of_one_acceleration_is_the_motion_of_that():
    one = bc.daf(BEAM, TRUCK, bc.Motion(25.0, -2.0), start=-5)
    pieces = bc.Motion(25.0, [-2.0, -2.0, -2.0], [-2.0, 7.7])
    np.testing.assert_allclose(bc.daf(BEAM, TRUCK, pieces, start=-5), one, atol=1e-9)


@pytest.mark.parametrize("damped", [False, True])
def test_work_and_energy_balance_while_a_truck_brakes(damped):
    truck = bc.Vehicle(
        TRUCK.mass_matrix, TRUCK.damping_matrix, TRUCK.stiffness_matrix, TRUCK.tire_stiffnesses,
        TRUCK.tire_offsets, damper_map=LEGS, heave=TRUCK.heave, pitch_input=TRUCK.pitch_input,
        tire_damping=1e4 * damped,
    )  # fmt: skip
    motion, modes = bc.Motion(25.0, [0.0, -3.0], [0.0]), np.arange(1, BEAM.n_modes + 1)
    # Gauss points between what is not smooth: entries, exits and mid-span.
    ends = motion.time(np.unique([-1.0, 0, 5, 12.5, 17.5, 25, 30]))
    fine = np.concatenate([np.linspace(a, b, 61)[:-1] for a, b in pairwise(ends)] + [ends[-1:]])
    points, weights = np.polynomial.legendre.leggauss(4)
    half = np.diff(fine)[:, np.newaxis] / 2
    times = (fine[:-1, np.newaxis] + half * (1 + points)).ravel()
    every = np.concatenate([ends[:1], times, ends[-1:]])
    found = bc.crossing_response(BEAM, truck, motion, start=-1.0, timepts=every)
    states, n = np.asarray(found.states), 8
    y, rate, q, q_rate = states[:n:2], states[1:n:2], states[n::2], states[n + 1 :: 2]
    forces = np.array([found.outputs[f"tire_force_{k}"] for k in (1, 2)])
    mass = BEAM.mass / 2
    place = motion.position(every)
    tires = place - truck.tire_offsets[:, np.newaxis]
    shapes = BEAM.mode_shapes(tires)
    power = -np.einsum("it,ij,jt->t", rate, truck.damping_matrix, rate)
    power -= (truck.tire_map @ rate * (forces - truck.static_loads[:, np.newaxis])).sum(axis=0)
    power += LEVER * rate[1] * motion.accelerations(place)
    power += np.einsum("kt,ktj,jt->t", forces, shapes, q_rate)
    power -= mass * (2 * BEAM.damping_ratios * BEAM.omega) @ q_rate**2
    work = (weights * half * power[1:-1].reshape(-1, 4)).sum()
    energy = np.einsum("it,ij,jt->t", rate, truck.mass_matrix, rate) / 2
    energy += np.einsum("it,ij,jt->t", y, truck.stiffness_matrix, y) / 2
    energy += mass * (q_rate**2 + (BEAM.omega[:, np.newaxis] * q) ** 2).sum(axis=0) / 2
    assert len(modes) == len(q)
    assert energy[0] == 0
    assert work == pytest.approx(energy[-1], abs=1e-6 * energy.max())


@pytest.mark.slow
def test_a_braking_truck_that_leaves_the_road_is_simulated_with_the_tires_kept_from_pulling():
    road = bc.RoadProfile([-10, -3, -2.5, 25], [0, 0, -0.12, -0.12])
    motion = bc.Motion(30.0, -2.0)
    with pytest.warns(bc.LiftOffWarning):
        found = bc.crossing_response(BEAM, CAR, motion, road, start=-10)
    assert found.outputs["tire_force"].min() == 0.0
    with pytest.warns(bc.LiftOffWarning):
        peak = bc.daf(BEAM, CAR, motion, road, start=-10)
    assert peak[0] == pytest.approx(found.outputs["moment"].max(), abs=1e-5)


def test_dampers_go_with_a_constant_speed():
    with pytest.raises(ValueError, match="damper goes with a constant speed: got Motion"):
        bc.daf(BEAM, CAR, STOPPING, damper=bc.dampers.passive(5e3))
    with pytest.raises(ValueError, match="damper goes with a constant speed"):
        bc.crossing_response(BEAM, CAR, STOPPING, damper=bc.dampers.passive(5e3))
    uniform = bc.daf(BEAM, CAR, bc.Motion(25.0), damper=bc.dampers.passive(5e3))
    np.testing.assert_array_equal(uniform, bc.daf(BEAM, CAR, 25.0, damper=bc.dampers.passive(5e3)))


def test_the_command_line_simulates_trucks_that_brake(capsys):
    asked = ["dae", "--station", "678", "--speeds", "60,80", "--approach", "10", "--json"]
    status, out, err = run_command(capsys, *asked, "--acceleration", "-3")
    assert (status, err) == (0, "")
    braking, uniform = json.loads(out), json.loads(run_command(capsys, *asked)[1])
    assert braking["simulated_acceleration_m_per_s2"] == -3
    assert braking["daf_superposed"] == uniform["daf_superposed"]
    road = bc.utia_road().place_bridge(678).crop(-10, 25).detrend().resample(0.1)
    motions = [bc.Motion(kmh / 3.6, [0, -3], [0]) for kmh in (60, 80)]
    simulated = bc.daf(bc.li2006.beam(), bc.li2006.car(), motions, road, start=-10)
    assert braking["daf_simulated"] == pytest.approx(simulated, abs=1e-9)
    _, table, _ = run_command(capsys, *asked[:-1], "--acceleration", "-3")
    assert "Simulated with -3 m/s^2 from the start of the bridge on" in table
    status, _, err = run_command(capsys, *asked, "--acceleration", "-9")
    assert status != 0
    assert "acceleration must not bring the vehicle to rest on its way" in err
