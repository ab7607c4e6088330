import dataclasses

import control as ct
import numpy as np
import pytest
from helpers import rough_road
from scipy.integrate import simpson

import bridgectl as bc

TIGHT = {"rtol": 1e-9, "atol": 1e-13}
MOTION = bc.Motion(110 / 3.6)


@pytest.fixture
def crossing(bridge, truck):
    return bc.Crossing(bridge, truck)


def random_state(crossing, seed=1):
    rng = np.random.default_rng(seed)
    return rng.normal(size=crossing.n_states) * 1e-4


def test_signals_carry_the_papers_names(bridge, truck):
    system = bc.crossing_system(bridge, truck, 30.0)
    assert system.input_labels == ["road", "damper_force"]
    assert system.state_labels[:6] == ["y_s", "y_s_dot", "y_t", "y_t_dot", "q_1", "q_1_dot"]
    assert system.output_labels == [
        "moment", "deflection", "tire_force", "y_s", "y_s_dot", "y_t", "y_t_dot",
        "y_s_ddot", "y_t_ddot", "suspension_travel", "suspension_velocity",
    ]  # fmt: skip


def test_two_tires_number_their_signals(bridge, truck):
    system = bc.crossing_system(bridge, bc.convoy([truck, truck], [0, 5]), 30.0)
    assert system.input_labels == ["road_1", "road_2", "damper_force_1", "damper_force_2"]
    assert {"tire_force_1", "tire_force_2", "y_s_2_dot"} <= set(system.output_labels)


@pytest.mark.parametrize("t", [0.0, 0.3, 0.41, 0.8])
def test_the_dynamics_are_the_linear_map_while_the_tires_are_in_contact(crossing, t):
    state, road, force = random_state(crossing), np.array([3e-4]), np.array([120.0])
    linear = (
        crossing.state_matrix(MOTION.position(t)) @ state
        + crossing.road_matrix(MOTION.position(t)) @ road
        + crossing.damper_matrix @ force
        + crossing.load_vector(MOTION.position(t))
    )
    by_place = crossing.dynamics(MOTION.position(t), state, road, force)
    assert by_place == pytest.approx(linear, rel=1e-9, abs=1e-9)


@pytest.mark.parametrize("t", [0.05, 0.41, 0.7])
def test_linearize_gives_the_frozen_time_system(crossing, t):
    frozen = ct.linearize(crossing.system(MOTION), 0, t=t)
    # Finite differences of 1e-6 in states that carry forces of 1e5 N: 1e-6 of the largest entry.
    scale = np.abs(crossing.state_matrix(MOTION.position(t))).max()
    assert pytest.approx(crossing.state_matrix(MOTION.position(t)), abs=1e-6 * scale) == frozen.A
    assert frozen.B[:, :1] == pytest.approx(crossing.road_matrix(MOTION.position(t)), abs=1e-3)
    assert frozen.B[:, 1:] == pytest.approx(crossing.damper_matrix, abs=1e-9)
    named = ct.linearize(crossing.system(MOTION), 0, t=t, copy_names=True)
    assert named.input_labels == ["road", "damper_force"]


def test_frozen_time_poles_are_those_of_truck_and_bridge_apart_before_the_bridge(crossing):
    before = ct.linearize(crossing.system(MOTION), 0, t=-0.1)
    apart = np.concatenate([crossing.vehicle.system().poles(), crossing.beam.system().poles()])
    assert np.sort(np.abs(before.poles())) == pytest.approx(np.sort(np.abs(apart)), rel=1e-5)


def test_the_truck_at_mid_span_shifts_the_first_frequency_and_damps_it(crossing, bridge):
    frozen = ct.linearize(crossing.system(MOTION), 0, t=12.5 / MOTION.speed)
    poles = frozen.poles()
    first = poles[np.argmin(np.abs(np.abs(poles) - bridge.omega[0]))]
    # A light oscillator above its own frequency acts as a mass: the bridge slows a little.
    assert 0.98 < np.abs(first) / bridge.omega[0] < 1.0
    assert 1e-4 < -first.real / np.abs(first) < 0.01


def test_a_bode_plot_of_the_frozen_system_has_the_bridges_resonance(crossing, bridge):
    frozen = ct.linearize(crossing.system(MOTION), 0, t=12.5 / MOTION.speed)
    omega = np.linspace(10, 60, 2001)
    road_to_moment = ct.frequency_response(frozen[0, 0], omega)
    peak = omega[np.argmax(road_to_moment.magnitude)]
    assert peak == pytest.approx(bridge.omega[0], rel=0.02)


def test_python_control_simulates_the_crossing_to_the_papers_1_1302(bridge, truck):
    system = bc.crossing_system(bridge, truck, 110 / 3.6, recovery="li2006")
    time = np.linspace(0, 25 / (110 / 3.6), 1001)
    response = ct.input_output_response(
        system, time, 0, 0, solve_ivp_method="DOP853", solve_ivp_kwargs=TIGHT
    )
    # Samples 0.8 ms apart miss up to 1e-5 of the peak.
    assert response.outputs["moment"].max() == pytest.approx(1.13023, abs=3e-5)


@pytest.mark.slow
def test_a_users_skyhook_closes_around_the_crossing(bridge, truck):
    """Continuous skyhook on top of the passive damper, as an nlsys in interconnect."""
    speed, skyhook_damping, most = 25.0, 30e3, 20e3

    def force(t, x, u, params):
        body, relative = u
        bounds = sorted([0.0, most * relative])  # what a passive damper can do
        return np.clip(skyhook_damping * body, *bounds)

    skyhook = ct.nlsys(
        None,
        force,
        inputs=["y_s_dot", "suspension_velocity"],
        outputs=["damper_force"],
        name="skyhook",
    )
    plant = bc.crossing_system(bridge, truck, speed)
    loop = ct.interconnect(
        [plant, skyhook],
        inputs=["road"],
        outputs=["moment", "y_s_dot", "damper_force"],
        check_unused=False,
    )
    road = rough_road(3, -10, 25)
    x = np.linspace(-10, 25, 351)
    inputs = road.drop(x, -10)
    closed = ct.input_output_response(
        loop, x / speed, inputs, 0, solve_ivp_kwargs={"rtol": 1e-6, "atol": 1e-9, "max_step": 0.004}
    )
    passive = bc.crossing_response(bridge, truck, speed, road, start=-10, timepts=x / speed)
    # The law does what it is for: a slower body, and a moment that differs.
    closed_rms = np.sqrt(np.mean(closed.outputs[1] ** 2))
    passive_rms = np.sqrt(np.mean(passive.outputs["y_s_dot"] ** 2))
    assert closed_rms < passive_rms
    assert np.abs(closed.outputs[0] - passive.outputs["moment"]).max() > 1e-3
    # And the loop's derivative is the crossing's with the law's force put in by hand.
    crossing, middle = bc.Crossing(bridge, truck), 200
    state = np.asarray(closed.states)[:, middle]
    by_hand = crossing.dynamics(
        x[middle],
        state,
        inputs[middle : middle + 1],
        np.array([force(0, None, (state[1], state[1] - state[3]), None)]),
    )
    assert loop.dynamics(x[middle] / speed, state, [inputs[middle]]) == pytest.approx(by_hand)


@pytest.mark.slow
def test_a_damper_added_through_the_input_is_a_larger_passive_damper(bridge, truck):
    speed, extra = 30.0, 5e3
    damper = ct.ss([], [], [], [[extra]], inputs=["suspension_velocity"], outputs=["damper_force"])
    plant = bc.crossing_system(bridge, truck, speed)
    loop = ct.interconnect([plant, damper], inputs=["road"], outputs=["moment"], check_unused=False)
    road = rough_road(5, 0, 25)
    x = np.linspace(0, 25, 251)
    closed = ct.input_output_response(
        loop, x / speed, road.drop(x, 0), 0, solve_ivp_kwargs={"rtol": 1e-6, "atol": 1e-10}
    )
    stiffer = dataclasses.replace(truck, damping=truck.damping + extra)
    built_in = bc.crossing_response(bridge, stiffer, speed, road, timepts=x / speed)
    assert closed.outputs == pytest.approx(built_in.outputs["moment"], abs=1e-5)


@pytest.mark.parametrize("damping_ratio", [0.0, 0.03])
def test_the_work_of_the_tires_is_the_beams_energy_and_what_damping_took(truck, damping_ratio):
    beam = bc.li2006.beam(damping_ratio=damping_ratio)
    speed = 25.0
    response = bc.crossing_response(beam, truck, speed, rough_road(7, -20, 25), start=-20, tail=0.5)
    time, states = response.time, np.asarray(response.states)[4:]
    q, rates = states[::2], states[1::2]
    shapes = beam.mode_shapes(speed * time)
    power = response.outputs["tire_force"] * np.einsum("mj,jm->m", shapes, rates)
    modal_mass = beam.mass / 2
    losses = modal_mass * np.einsum("j,jm->m", 2 * beam.damping_ratios * beam.omega, rates**2)
    energy = modal_mass / 2 * (rates[:, -1] ** 2 + (beam.omega * q[:, -1]) ** 2).sum()
    work = simpson(power, x=time)
    assert work == pytest.approx(energy + simpson(losses, x=time), rel=1e-6)


def test_the_truck_loses_no_energy_but_in_its_damper_and_to_the_bridge(bridge, truck):
    """The same balance for the vehicle: tire work in, springs and masses, damper losses."""
    speed = 25.0
    response = bc.crossing_response(bridge, truck, speed, rough_road(8, -20, 25), start=-20)
    ys, vs, yt, vt = np.asarray(response.states)[:4]
    beyond = response.outputs["tire_force"] - 98100.0
    work = simpson(-beyond * vt, x=response.time)  # the tire pushes the axle up
    stored = (9000 * vs**2 + 1000 * vt**2 + 80e3 * (ys - yt) ** 2)[-1] / 2
    lost = simpson(7e3 * (vs - vt) ** 2, x=response.time)
    assert work == pytest.approx(stored + lost, rel=1e-6)


@pytest.mark.parametrize("recovery", ["exact", "li2006", "modal"])
@pytest.mark.parametrize("section", [0.5, 0.3])
def test_the_recoveries_are_equations_5_to_8_written_out(recovery, section):
    """Moment from accelerations, as printed, against the rows on states and forces."""
    beam, truck = bc.li2006.beam(damping_ratio=0.02), bc.li2006.car()
    crossing = bc.Crossing(beam, truck, bc.Moment(25 * section, recovery=recovery))
    t, state = 0.37, random_state(crossing, 4)
    shapes = crossing.tire_shapes(30.0 * t)
    force = crossing.contact_forces(state, np.zeros(1), shapes)
    rate = crossing.dynamics(30.0 * t, state, np.zeros(1), np.zeros(1))
    q, velocity, acceleration = state[4::2], state[5::2], rate[5::2]
    j, length, mu = np.arange(1, 4), 25.0, 18358.0
    at_section = np.sin(j * np.pi * section)
    static = 98100.0 * length * section * (1 - section)
    from_force = force[0] * beam.influence_line(30.0 * t, section)
    inertia = -mu * (length / j / np.pi) ** 2 * at_section
    damping = 2 * 0.02 * beam.omega[0] * velocity  # 2 w_b q' of Eq. (3)
    expected = {
        "exact": from_force + inertia @ (acceleration + damping),
        "li2006": from_force + np.pi**4 / 96 * inertia @ acceleration,
        "modal": beam.flexural_rigidity * (j * np.pi / length) ** 2 * at_section @ q,
    }[recovery]
    per_force, per_state, constant = crossing.rows(30.0 * t)
    assert constant == 0
    assert not per_state[:4].any()
    per_state = per_state[4:]
    assert per_force @ force + per_state @ state[4:] == pytest.approx(expected / static, rel=1e-9)


def test_the_printed_twelfth_is_the_scale_of_the_inertial_moment():
    """Eq. (8) with Eq. (5)'s v_0, over the exact inertial moment of mode 1."""
    length, rigidity, mu, weight = 25.0, 3.5e10 * 1.3901, 18358.0, 98100.0
    speed, m0 = 30.0, weight * length / 4
    v0 = 2 * weight * length**3 / (np.pi**4 * rigidity)
    first = (np.pi / length) ** 2 * np.sqrt(rigidity / mu) / (2 * np.pi)
    alpha = speed / (2 * first * length)
    acceleration = 1.7  # of q_1 [m/s^2]; normalized: q / v_0, time c t / l
    normalized = acceleration / v0 * (length / speed) ** 2
    printed = -(alpha**2) / 12 * normalized
    exact = -mu * (length / np.pi) ** 2 * acceleration / m0
    assert printed / exact == pytest.approx(np.pi**4 / 96)


def test_the_peak_static_moment_of_a_train_of_axles_is_found(bridge, truck):
    convoy = bc.convoy([truck, truck, truck], [0, 3, 8])
    crossing = bc.Crossing(bridge, convoy, bc.Moment(10.0))
    creeping = np.linspace(0, 33, 33001)
    lines = bridge.influence_line(crossing.tire_positions(creeping), 0.4)
    assert crossing.static_peak == pytest.approx((lines @ convoy.static_loads).max())


@pytest.mark.parametrize(
    ("change", "error", "says"),
    [
        ({"speed": 0}, ValueError, "speed must be above 0 [m/s], got 0"),
        ({"speed": -20.0}, ValueError, "speed must be above 0 [m/s]"),
        ({"speed": np.array([1.0, 2.0])}, TypeError, "speed must be one number [m/s]"),
        ({"section": 1.0}, ValueError, "section must lie between 0 and 1"),
        ({"recovery": "fryba"}, ValueError, "recovery must be one of 'exact', 'li2006', 'modal'"),
        ({"beam": 25.0}, TypeError, "beam must be a bridgectl.Beam, got float"),
        ({"vehicle": "truck"}, TypeError, "vehicle must be a bridgectl.Vehicle or QuarterCar"),
    ],
)
def test_a_bad_crossing_parameter_is_named(bridge, truck, change, error, says):
    good = {"beam": bridge, "vehicle": truck, "speed": 30.0}
    with pytest.raises(error) as caught:
        bc.crossing_system(**{**good, **change})
    assert says in str(caught.value)


def test_a_truck_heavier_than_the_bridge_draws_a_warning(truck):
    footbridge = bc.Beam(length=12.0, mass_per_length=500.0, flexural_rigidity=1e8)
    with pytest.warns(UserWarning, match="heavier than the bridge .* mass_per_length in tonnes"):
        bc.crossing_system(footbridge, truck, 30.0)


@pytest.mark.slow
def test_at_its_default_tolerances_the_control_library_is_off_by_more_than_a_unit_ramp(
    bridge, truck
):
    """1.136 where the paper prints 1.1302, to which tight ones come within 5e-5."""
    system = bc.crossing_system(bridge, truck, 110 / 3.6, recovery="li2006")
    time = np.linspace(0, 25 / (110 / 3.6), 1001)
    tight = {"solve_ivp_kwargs": {"rtol": 1e-9, "atol": 1e-12}}
    for options, daf in (({}, 1.136), (tight, 1.1302)):
        moment = ct.input_output_response(system, time, 0, **options).outputs[0]
        assert moment.max() == pytest.approx(daf, abs=5e-4 if daf == 1.136 else 5e-5)
