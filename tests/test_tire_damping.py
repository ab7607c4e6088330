"""Tires with damping, whose force feels the slopes of road and bridge as they roll."""

import dataclasses
import re

import control
import numpy as np
import pytest
from helpers import rough_road
from reference_trucks import needs_reference, reference_case
from scipy.integrate import solve_ivp

import bridgectl as bc
from bridgectl.linear.runs import prepare
from bridgectl.model.beam import Beam
from bridgectl.surface.tire_contact import TireContact

BEAM = bc.Beam(25, 18358, 4.865e10, n_modes=4, damping_ratio=0.01)
CAR = bc.QuarterCar(9000, 1000, 80e3, 1.8e6, 7e3, tire_damping=5e3)
ROAD = rough_road(3, -10.0, 25.0, step=0.5)
HALF = np.array([[1.0, -1.5, -1.0, 0.0], [1.0, 2.5, 0.0, -1.0]])
TRUCK = bc.Vehicle(
    np.diag([12000.0, 30000.0, 700.0, 900.0]),
    10e3 * HALF.T @ HALF,
    400e3 * HALF.T @ HALF,
    [1.8e6, 3.6e6],
    [0.0, 4.0],
    damper_map=HALF,
    heave=[1.0, 0.0, 1.0, 1.0],
    tire_damping=[5e3, 1.2e4],
)


@pytest.mark.quick_cases(1)
@needs_reference
@pytest.mark.parametrize("name", ["g_T5airct_SS25_smooth_25", "g_QCct_SS25_ramp_25"])
def test_reference_cases_are_met_within_2e_4(name):
    given, expected = reference_case(name)
    assert bc.daf(**given)[0] == pytest.approx(expected, abs=2e-4)


def by_own_integration(car: bc.QuarterCar, beam: bc.Beam, speed: float, convective: bool) -> float:
    """DAF at mid-span of a smooth road by scipy, from the equations as they are printed."""
    j = np.arange(1, beam.n_modes + 1)
    wave, mass = j * np.pi / beam.length, beam.mass_per_length * beam.length / 2
    omega = wave**2 * np.sqrt(beam.flexural_rigidity / beam.mass_per_length)
    weight = 9.81 * (car.sprung_mass + car.unsprung_mass)
    damping = 2 * beam.damping_ratio * omega[0]

    def force(t, x):
        shape, slope = np.sin(wave * speed * t), wave * np.cos(wave * speed * t)
        q, rate = x[4::2], x[5::2]
        moved = x[3] - shape @ rate - convective * speed * (slope @ q)
        return weight + car.tire_stiffness * (x[2] - shape @ q) + car.tire_damping * moved, shape

    def rates(t, x):
        tire, shape = force(t, x)
        leg = car.suspension_stiffness * (x[0] - x[2]) + car.damping * (x[1] - x[3])
        result = np.empty_like(x)
        result[::2] = x[1::2]
        result[1], result[3] = -leg / car.sprung_mass, (leg - tire + weight) / car.unsprung_mass
        result[5::2] = tire * shape / mass - damping * x[5::2] - omega**2 * x[4::2]
        return result

    peak = 0.0
    x, middle, end = np.zeros(4 + 2 * len(j)), beam.length / 2 / speed, beam.length / speed
    for first, last in ((0.0, middle), (middle, end)):
        times = np.linspace(first, last, 4001)
        found = solve_ivp(
            rates, (first, last), x, "DOP853", times, rtol=1e-10, atol=1e-14, max_step=2e-3
        )
        x = found.y[:, -1]
        for t, state in zip(times, found.y.T, strict=True):
            tire, shape = force(t, state)
            near = min(speed * t, beam.length - speed * t) / 2
            bend = tire * shape / mass - omega**2 * state[4::2]  # q'' + 2 zeta w q'
            inertia = beam.mass_per_length * bend / wave**2 * np.sin(wave * beam.length / 2)
            peak = max(peak, tire * near - inertia.sum())
    return peak / (weight * beam.length / 4)


class WithoutSlopes(Beam):
    """A beam under which tires feel no slope, as codes have it that leave the term out."""

    def mode_slopes(self, x):
        return 0.0 * self.mode_shapes(x)


def test_the_convective_term_is_that_of_an_own_integration_within_5e_6():
    rigid = dataclasses.replace(CAR, tire_damping=3e4)  # six times as much as tires have
    given = {field.name: getattr(BEAM, field.name) for field in dataclasses.fields(BEAM)}
    with_it, without = bc.daf(BEAM, rigid, 30.0)[0], bc.daf(WithoutSlopes(**given), rigid, 30.0)[0]
    own = [by_own_integration(rigid, BEAM, 30.0, convective) for convective in (True, False)]
    assert with_it == pytest.approx(own[0], abs=5e-6)
    assert with_it - without == pytest.approx(own[0] - own[1], abs=5e-6)
    assert abs(own[0] - own[1]) > 2e-5  # what is compared is there


@pytest.mark.slow
@pytest.mark.parametrize("vehicle", [CAR, TRUCK])
def test_both_routes_give_the_same_peaks(vehicle):
    road = rough_road(3, -14.0, 25.0, step=0.5)
    effects = [bc.Moment(10.0), bc.TireForce(), bc.TireForce(sense="smallest")]
    given = {"profile": road, "start": -10.0, "effect": effects}
    fast = bc.daf(BEAM, vehicle, [25.0], **given)
    slow = bc.daf(BEAM, vehicle, [25.0], **given, method="control")
    np.testing.assert_allclose(fast, slow, rtol=0, atol=1e-6)
    alone = bc.daf(BEAM, vehicle, [25.0], **{**given, "effect": effects[1]})
    np.testing.assert_allclose(alone, fast[1], rtol=0, atol=1e-9)


def test_a_response_tells_the_rate_of_the_road_and_forces_jump_with_it():
    road = bc.RoadProfile([-10, -5, -4, 25], [0, 0, 0.01, 0.01])
    found = bc.crossing_response(BEAM, CAR, 25.0, road, start=-10)
    jump = np.argmax(found.inputs[1] != 0)
    assert found.input_labels == ["road", "road_rate", "damper_force"]
    assert found.inputs[1, jump] == pytest.approx(-0.01 * 25)  # m/s, up
    force = found.outputs["tire_force"]
    assert force[jump] - force[jump - 1] == pytest.approx(5e3 * 0.25, rel=0.02)  # N


def test_the_dynamics_are_the_linear_map_of_place_and_speed():
    crossing, speed = bc.Crossing(BEAM, TRUCK), 25.0
    rng = np.random.default_rng(1)
    state = np.repeat([1e-3, 1e-2], crossing.n_states // 2) * rng.normal(size=crossing.n_states)
    road, rate, force = rng.normal(0, 1e-4, 2), rng.normal(0, 1e-2, 2), np.array([120.0, -80.0])
    for x in (2.0, 12.0, 27.0):
        linear = crossing.state_matrix(x, speed) @ state + crossing.load_vector(x)
        linear += crossing.road_matrix(x) @ (road + TRUCK.tire_lags * rate)
        linear += crossing.damper_matrix @ force
        given = road + TRUCK.tire_lags * rate, force, speed
        np.testing.assert_allclose(crossing.dynamics(x, state, *given), linear, rtol=1e-9)
        system = crossing.system(bc.Motion(speed))
        inputs = np.concatenate([road, rate, force])
        np.testing.assert_allclose(system.dynamics(x / speed, state, inputs), linear, rtol=1e-9)


def test_on_a_rigid_road_the_vehicles_system_is_the_crossings():
    times = np.linspace(0, 1, 401)
    rate = 0.02 * np.sin(9 * times)
    road = np.concatenate([[0.0], np.cumsum((rate[1:] + rate[:-1]) / 2 * np.diff(times))])

    found = control.forced_response(CAR.system(), times, [road, rate, 0 * times], squeeze=False)
    stiff = CAR.tire_stiffness * (found.outputs[2] - road)
    own = stiff + 5e3 * (np.gradient(found.outputs[2], times) - rate)
    np.testing.assert_allclose(found.outputs[0][2:-2], own[2:-2], atol=2.0)  # N of 98 kN


@pytest.mark.slow
def test_a_damped_tire_that_leaves_the_road_is_not_held_by_it():
    road = bc.RoadProfile([-10, -3, -2.5, 25], [0, 0, -0.12, -0.12])
    with pytest.warns(bc.LiftOffWarning):
        found = bc.crossing_response(BEAM, CAR, 30.0, road, start=-10)
    force = found.outputs["tire_force"]
    assert force.min() == 0.0
    with pytest.warns(bc.LiftOffWarning):
        peaks = bc.daf(BEAM, CAR, 30.0, road, start=-10)
    with pytest.warns(bc.LiftOffWarning):
        several = bc.daf(BEAM, CAR, 30.0, road, start=-10, effect=["moment", bc.TireForce()])
    assert peaks[0] == pytest.approx(found.outputs["moment"].max(), abs=1e-5)
    assert several[0] == pytest.approx(peaks, abs=1e-9)


@pytest.mark.parametrize(
    "bridge",
    [
        BEAM,
        bc.Bridge([12, 15], 18358, 4.865e10, n_modes=4),
        bc.ModalBridge(
            np.linspace(0, 25, 31), np.sin(np.pi * np.outer(np.linspace(0, 1, 31), [1, 2])),
            frequencies=[4.0, 16.0], modal_masses=2e5,
        ),
    ],
)  # fmt: skip
def test_slopes_are_those_of_the_shapes(bridge):
    x = np.linspace(0.1, bridge.length - 0.1, 57)
    step = 1e-5
    slopes = (bridge.mode_shapes(x + step) - bridge.mode_shapes(x - step)) / (2 * step)
    np.testing.assert_allclose(bridge.mode_slopes(x), slopes, atol=1e-7)  # 1/m
    assert not bridge.mode_slopes([-1.0, bridge.length + 1]).any()


def test_vehicles_carry_their_tires_into_a_convoy():
    row = bc.convoy([CAR, TRUCK], [0.0, 8.0])
    assert row.tire_damping.tolist() == [5e3, 5e3, 1.2e4]
    assert "tire_damping=5000 N s/m" in repr(CAR)


@pytest.mark.parametrize("vehicle", [CAR, TRUCK])
def test_predictions_and_envelopes_are_of_the_same_crossing(vehicle):
    given = {"profile": rough_road(3, -14.0, 25.0, step=0.5), "start": -10.0}
    known = bc.prediction_matrices(BEAM, vehicle, 25.0, **given)
    states = [known.initial]
    for transition, offset in zip(known.transitions, known.offsets, strict=True):
        states.append(transition @ states[-1] + offset)
    moments = (known.effect_rows * states).sum(axis=1) + known.effect_constants
    response = bc.crossing_response(BEAM, vehicle, 25.0, **given)
    at_nodes = np.interp(known.positions / 25, response.time, response.outputs["moment"])
    np.testing.assert_allclose(moments[known.entry :], at_nodes[known.entry :], atol=1e-8)
    envelope = bc.envelope(BEAM, vehicle, 25.0, **given, at=[5.0, 10.0])
    peaks = [bc.peak_effect(BEAM, vehicle, 25.0, **given, effect=bc.Moment(x)) for x in (5, 10)]
    np.testing.assert_allclose(envelope.largest, np.ravel(peaks), rtol=1e-9)


@pytest.mark.parametrize("vehicle", [CAR, TRUCK])
@pytest.mark.parametrize("effect", ["moment", bc.TireForce(sense="smallest")])
def test_ramps_superpose(vehicle, effect):
    surface = bc.ramp_surface(BEAM, vehicle, [20.0, 33.0], approach=40.0, effect=effect)
    rng, ramp = np.random.default_rng(1), 430  # on the bridge
    one, all_of_them = np.zeros(650), rng.normal(0, 3e-4, 650)
    one[ramp] = 1e-3
    for drops, found in ((one, surface.daf_unit[:, ramp]), (all_of_them, None)):
        road = surface.road(drops)
        simulated = bc.daf(BEAM, vehicle, surface.speeds, road, start=-40.0, effect=effect)
        superposed = surface.superposed_daf(road) if found is None else found
        np.testing.assert_allclose(superposed, simulated, rtol=0, atol=1e-8)


def test_a_surface_of_damped_tires_is_saved_and_loaded(tmp_path):
    surface = bc.ramp_surface(BEAM, CAR, [20.0])
    surface.save(tmp_path / "damped.npz")
    again = bc.load_surface(tmp_path / "damped.npz", vehicle=CAR)
    np.testing.assert_array_equal(again.daf_unit, surface.daf_unit)
    with pytest.raises(bc.SurfaceFileError, match="tire_damping is 5000"):
        bc.load_surface(tmp_path / "damped.npz", vehicle=dataclasses.replace(CAR, tire_damping=0))


def test_lift_off_is_looked_for_in_the_forces_of_damped_tires():
    edges = -40 + 0.1 * np.arange(651)
    drops = np.random.default_rng(2).normal(0, 6e-4, (650, 1))
    smooth = prepare(bc.Crossing(BEAM, CAR), bc.RoadProfile(edges, 0 * edges), -40.0)
    contact = TireContact(smooth, np.array([25.0]), 0.1, 650)
    least = 1 + contact._least_change(0.1 / 25, drops[: contact.n_before])[0]
    road = bc.RoadProfile(edges, -np.append(0.0, np.cumsum(drops)))
    found = bc.crossing_response(BEAM, CAR, 25.0, road, start=-40)
    here, x = found.time < 0, found.time * 25
    states, run = np.asarray(found.states).T[here], smooth._replace(profile=road)
    # A force is least just before a kink or just after it.
    forces = [run.forces(x[here], states, 25.0 + 0 * x[here], before=b) for b in (False, True)]
    assert least == pytest.approx(np.min(forces) / 98100, abs=2e-3)


def unknown_slopes() -> object:
    """A bridge that tells what a `BridgeModel` must, and no slopes."""

    class Plain:
        length, n_modes, influence_line = BEAM.length, BEAM.n_modes, BEAM.influence_line
        omega, damping_ratios, modal_masses = BEAM.omega, BEAM.damping_ratios, BEAM.modal_masses
        mode_shapes, modal_moments, kinks = BEAM.mode_shapes, BEAM.modal_moments, BEAM.kinks

    return Plain()


@pytest.mark.parametrize(
    ("call", "error", "says"),
    [
        (
            lambda: bc.ramp_surface(BEAM, CAR, 25.0, method="control"),
            ValueError,
            "tire_damping must be 0 in ramp surfaces",
        ),
        (
            lambda: bc.daf(BEAM, CAR, 25.0, damper=bc.dampers.passive(7e3)),
            ValueError,
            "tire_damping must be 0 in crossings with a damper",
        ),
        (lambda: bc.daf(unknown_slopes(), CAR, 25.0), TypeError, "give it a method mode_slopes(x)"),
        (
            lambda: bc.ModalBridge([0, 12, 25], [[0], [1], [0]], [4.0], 2e5).mode_slopes(3.0),
            ValueError,
            "x must hold 4 places or more for the slopes",
        ),
    ],
)
def test_what_takes_tires_as_springs_says_so(call, error, says):
    with pytest.raises(error, match=re.escape(says)):
        call()
