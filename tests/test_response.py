import dataclasses

import control as ct
import numpy as np
import pytest
from helpers import random_case, rough_road
from scipy.integrate import solve_ivp

import bridgectl as bc
from bridgectl.linear.cells import build_cells
from bridgectl.linear.lift_off import fly
from bridgectl.linear.runs import first_flight, linear_contact, prepare, speed_batches

UM = 1e-6


@pytest.mark.filterwarnings("ignore:start = -12 m is not forgotten")
@pytest.mark.parametrize(
    "seed",
    [0, 1, 4, *(pytest.param(seed, marks=pytest.mark.slow) for seed in (2, 3, *range(5, 20)))],
)
def test_the_propagator_path_is_the_control_library_path(seed):
    """Moment histories within 1e-6 of M_0 on random beams, vehicles, speeds and roads."""
    case = random_case(seed)
    fast = bc.crossing_response(**case, method="propagator")
    reference = bc.crossing_response(**case, method="control")
    assert fast.time == pytest.approx(reference.time)
    assert fast.outputs["moment"] == pytest.approx(reference.outputs["moment"], abs=1e-6)
    force = "tire_force" if "tire_force" in fast.output_labels else "tire_force_1"
    assert fast.outputs[force] == pytest.approx(reference.outputs[force], abs=0.2)  # newtons
    assert fast.outputs["deflection"] == pytest.approx(
        reference.outputs["deflection"], abs=1e-3 * UM
    )


def test_the_response_is_labelled_control_data(bridge, truck):
    response = bc.crossing_response(bridge, truck, 30.0)
    assert isinstance(response, ct.TimeResponseData)
    assert response.params["speed"] == 30.0
    assert response.params["recovery"] == "exact"
    time, outputs = response
    assert outputs.shape == (len(response.output_labels), len(time))
    assert time[0] == 0.0
    assert time[-1] == pytest.approx(25 / 30.0)
    frame = response.to_pandas()
    assert {"time", "moment", "tire_force", "road"} <= set(frame.columns)


def test_the_response_plots_as_control_data_does(bridge, truck):
    import matplotlib.pyplot as plt

    plot = bc.crossing_response(bridge, truck, 30.0).plot()
    assert "moment" in plot.axes[0, 0].get_ylabel()
    plt.close("all")


def test_a_start_on_a_level_approach_changes_nothing(bridge, truck):
    at_bridge = bc.crossing_response(bridge, truck, 30.0)
    before = bc.crossing_response(bridge, truck, 30.0, start=-200)
    on_bridge = before.time >= -1e-12
    assert before.time[0] == pytest.approx(-200 / 30.0)
    assert before.outputs["moment"][on_bridge] == pytest.approx(at_bridge.outputs["moment"])
    assert np.all(before.outputs["moment"][~on_bridge] == 0.0)


def test_the_approach_matters_on_a_rough_road(bridge, truck):
    road = rough_road(2, -200, 25)
    near = bc.daf(bridge, truck, 25.0, road)
    far = bc.daf(bridge, truck, 25.0, road, start=-200)
    assert abs(near - far) > 1e-3


def test_an_approach_of_one_cell_shakes_the_vehicle_too(bridge, truck):
    road = bc.RoadProfile([-0.05, 0.0, 25.0], [0.0, 0.01, 0.01])
    fast, reference = (
        bc.daf(bridge, truck, 25.0, road, start=-0.05, method=method)
        for method in ("propagator", "control")
    )
    assert fast == pytest.approx(reference, abs=1e-6)  # what it gives to the vehicle is 4e-5


def test_the_vehicle_on_the_approach_is_the_vehicle_system_on_that_road(bridge, truck):
    road, speed = rough_road(4, -50, 25), 20.0
    x = np.linspace(-50, 0, 2001)
    response = bc.crossing_response(bridge, truck, speed, road, start=-50, timepts=x / speed)
    system = truck.system()
    alone = ct.forced_response(system, x / speed, np.vstack([road.drop(x, -50), 0 * x]))
    assert response.outputs["y_s"] == pytest.approx(alone.outputs[1], abs=1e-4 * UM)
    assert response.outputs["tire_force"] - 98100.0 == pytest.approx(alone.outputs[0], abs=1e-3)


def test_the_bridge_rings_freely_after_the_vehicle_has_left(truck):
    beam = bc.li2006.beam(damping_ratio=0.03)
    response = bc.crossing_response(beam, truck, 30.0, tail=2.0)
    after = response.time > 25 / 30.0 + 1e-9
    time = response.time[after]
    assert time[-1] == pytest.approx(25 / 30.0 + 2.0)
    start = np.asarray(response.states)[4:, np.argmax(after)]
    free = ct.initial_response(
        beam.system(sections=[0.5]), np.linspace(time[0], time[-1], 5001), start
    )
    expected = np.interp(time, free.time, free.outputs[0])
    assert response.outputs["deflection"][after] == pytest.approx(expected, abs=0.01 * UM)
    assert np.ptp(expected[-50:]) > 0.1 * UM  # it does ring


def test_asked_times_are_the_times_that_come_back(bridge, truck):
    time = np.array([0.1, 0.25, 0.7])
    few = bc.crossing_response(bridge, truck, 30.0, rough_road(6, 0, 25), timepts=time)
    many = bc.crossing_response(bridge, truck, 30.0, rough_road(6, 0, 25))
    assert few.time == pytest.approx(time)
    assert few.outputs["moment"] == pytest.approx(
        np.interp(time, many.time, many.outputs["moment"]), abs=1e-4
    )


def test_a_kink_of_the_moment_is_a_sample(bridge, truck):
    response = bc.crossing_response(bridge, truck, 20.0, section=0.37)
    assert np.abs(response.time * 20.0 - 0.37 * 25).min() < 1e-9


@pytest.mark.slow
@pytest.mark.filterwarnings("ignore:the first frequency of the beam is 4.09e")
def test_two_quarter_cars_on_a_nearly_rigid_beam_are_two_crossings_added(truck):
    stiff = bc.Beam(25.0, 18358.0, 4.865e10 * 1e6, n_modes=1)  # deflects 0.7 nm
    speed, road = 25.0, rough_road(9, 0, 25)
    convoy = bc.convoy([truck, truck], [0.0, 5.0])
    x = np.linspace(0, 30, 601)
    together = bc.crossing_response(stiff, convoy, speed, road, timepts=x / speed)
    first = bc.crossing_response(stiff, truck, speed, road, timepts=x / speed, tail=0.2)
    behind = x >= 5
    second = np.zeros_like(x)
    second[behind] = first.outputs["moment"][: behind.sum()]
    m0_alone = bc.Crossing(stiff, truck).static_peak
    m0_both = bc.Crossing(stiff, convoy).static_peak
    added = (first.outputs["moment"] + second) * m0_alone / m0_both
    assert together.outputs["moment"] == pytest.approx(added, abs=1e-6)


def test_two_quarter_cars_feel_each_other_through_a_soft_bridge(bridge, truck):
    together = bc.crossing_response(bridge, bc.convoy([truck, truck], [0, 5]), 25.0)
    alone = bc.crossing_response(bridge, truck, 25.0)
    x = np.linspace(5, 25, 50)
    behind = np.interp(x / 25, together.time, together.outputs["tire_force_2"])
    single = np.interp((x - 5) / 25, alone.time, alone.outputs["tire_force"])
    assert np.abs(behind - single).max() > 20.0  # newtons


def humped_road(height):
    """A hump with a sharp end: up over 1 m, down over 0.1 m."""
    return bc.RoadProfile([-20, -6, -5, -4.9, 25], [0, 0, height, 0, 0])


def flight(crossing, speed, road, start):
    """Contact and flight by event detection, independent of the package's simulation."""
    weight, kt = 98100.0, 1.8e6
    beam = crossing.beam
    j = np.arange(1, beam.n_modes + 1)

    def contact(t, z):
        x = speed * t
        shapes = np.where(0 <= x <= 25, np.sin(j * np.pi * x / 25), 0)
        return weight + kt * (z[2] - shapes @ z[4::2] - road.drop(x, start))

    def rate(t, z, touching):
        x = speed * t
        force = contact(t, z) if touching else 0.0
        shapes = np.where(0 <= x <= 25, np.sin(j * np.pi * x / 25), 0)
        spring = 80e3 * (z[0] - z[2]) + 7e3 * (z[1] - z[3])
        body, axle = -spring / 9000, (spring - (force - weight)) / 1000
        modes = -(beam.omega**2) * z[4::2] + 2 / beam.mass * shapes * force
        return np.concatenate([[z[1], body, z[3], axle], np.column_stack([z[5::2], modes]).ravel()])

    time, state, touching = start / speed, np.zeros(crossing.n_states), True
    corners = [*road.x[1:-1] / speed, 0.0, 25 / speed]
    flights = 0
    for corner in corners:
        while time < corner - 1e-12:
            part = _until(rate, contact, time, corner, state, touching)
            time, state = part.t[-1], part.y[:, -1]
            if part.status == 1:
                touching = not touching
                flights += not touching
    return state, flights


def _until(rate, contact, time, corner, state, touching):
    def event(t, z, _):
        return contact(t, z)

    event.terminal, event.direction = True, -1 if touching else 1
    return solve_ivp(
        rate, (time, corner), state, args=(touching,), method="DOP853", events=event,
        rtol=1e-10, atol=1e-13,
    )  # fmt: skip


@pytest.mark.quick_cases(1)
@pytest.mark.parametrize("method", ["propagator", "control"])
def test_a_tire_that_leaves_the_road_flies_and_lands(bridge, truck, method):
    road, speed = humped_road(0.09), 10.0
    with pytest.warns(bc.LiftOffWarning, match=r"leaves the road, first .* x = -4\.\d+ m"):
        response = bc.crossing_response(bridge, truck, speed, road, start=-20, method=method)
    assert response.outputs["tire_force"].min() == 0.0
    state, flights = flight(bc.Crossing(bridge, truck), speed, road, -20)
    assert flights >= 1
    assert np.asarray(response.states)[:, -1] == pytest.approx(state, abs=0.1 * UM)


def test_a_flight_goes_through_all_nodes_from_a_start_at_rest(bridge, truck):
    crossing = bc.Crossing(bridge, bc.convoy([truck, truck], [0.0, 4.0]))
    run = prepare(crossing, humped_road(0.09), -20.0)
    nodes = run.nodes(10.0)
    found = fly(run, 10.0, nodes)
    assert found.nodes[0] == -20.0
    assert np.isin(nodes, found.nodes).all()
    assert np.all(np.diff(found.nodes) > 0)
    assert len(found.nodes) > len(nodes)  # the events are among them
    assert found.effects.size == 6 * (len(found.nodes) - 1) + 1
    assert found.states[:, 0].tolist() == [0.0] * crossing.n_states
    assert found.forces[:, 0] == pytest.approx(crossing.linear.static_loads)


def test_where_a_tire_leaves_or_meets_the_road_its_force_is_nothing(bridge, truck):
    run = prepare(bc.Crossing(bridge, truck), humped_road(0.09), -20.0)
    nodes = run.nodes(10.0)
    found = fly(run, 10.0, nodes)
    events = ~np.isin(found.nodes, nodes)
    assert events.sum() >= 2
    assert found.forces[0, events] == pytest.approx(0.0, abs=0.01)  # newtons


def test_whether_all_tires_stay_on_the_road_is_told_for_each_speed(bridge, truck):
    speeds = np.array([25.0, 8.0, 30.0])
    convoy = bc.convoy([truck, truck], [0.0, 4.0])
    run = prepare(bc.Crossing(bridge, convoy), humped_road(0.06), -20.0)
    assert linear_contact(run, speeds).tolist() == [True, False, True]


@pytest.mark.parametrize("tires", [1, 2])
def test_the_maps_of_a_batch_of_speeds_fill_half_the_memory_or_more_and_not_more(
    bridge, truck, tires
):
    vehicle = bc.convoy([truck] * tires, [0.0, 4.0][:tires])
    run = prepare(bc.Crossing(bridge, vehicle), None, 0.0)
    speeds = np.linspace(25, 40, 100)
    cells = build_cells(run.crossing, speeds[:1], run.nodes(25.0), on_bridge=True)
    maps = (cells.gains, cells.to_stages)
    memory = 10 * sum(of_one.nbytes for of_one in maps)
    assert 5 <= next(speed_batches(run, speeds, memory)).stop <= 10


def test_speeds_are_treated_one_by_one_where_memory_holds_no_more(bridge, truck):
    run = prepare(bc.Crossing(bridge, truck), None, 0.0)
    speeds = np.array([25.0, 8.0, 30.0])
    assert list(speed_batches(run, speeds, 1.0)) == [slice(0, 1), slice(1, 2), slice(2, 3)]
    (every,) = speed_batches(run, speeds)
    assert speeds[every].size == 3


def test_the_first_flight_is_where_the_first_tire_loses_contact():
    x, down, up = np.arange(4.0), [5.0, 5.0, 0.0, 0.0], [5.0, 0.0, 5.0, 0.0]
    assert first_flight(x, np.array([down, up])) == 1.0
    assert first_flight(x, np.array([down])) == 2.0
    assert first_flight(x, np.array([[5.0, 5.0, 5.0, 0.0]])) == 3.0
    assert first_flight(x, np.full((2, 4), 1.0)) is None


@pytest.mark.slow
def test_two_trucks_that_fly_are_simulated_alike_by_both_routes(bridge, truck):
    convoy = bc.convoy([truck, truck], [0.0, 4.0])
    road, speed = humped_road(0.09), 10.0
    with pytest.warns(bc.LiftOffWarning):
        fast = bc.crossing_response(bridge, convoy, speed, road, start=-20)
    with pytest.warns(bc.LiftOffWarning):
        reference = bc.crossing_response(bridge, convoy, speed, road, start=-20, method="control")
    assert fast.time == pytest.approx(reference.time)
    assert fast.outputs["moment"] == pytest.approx(reference.outputs["moment"], abs=1e-6)
    for tire in ("tire_force_1", "tire_force_2"):
        assert fast.outputs[tire].min() == 0.0
        # A flight ends between samples: forces differ by what a kilonewton a millisecond brings.
        assert fast.outputs[tire] == pytest.approx(reference.outputs[tire], abs=1.0)


def test_a_tire_in_contact_draws_no_warning_and_never_pulls(bridge, truck, recwarn):
    response = bc.crossing_response(bridge, truck, 25.0, humped_road(0.004), start=-20)
    assert response.outputs["tire_force"].min() > 0.0
    assert not recwarn.list


@pytest.mark.slow
def test_daf_tells_at_which_speeds_a_tire_leaves_the_road(bridge, truck):
    road = humped_road(0.06)
    speeds = np.array([8.0, 25.0])
    with pytest.warns(bc.LiftOffWarning, match=r"at 1 of 2 speeds, the slowest 29 km/h"):
        values = bc.daf(bridge, truck, speeds, road, start=-20)
    with pytest.warns(bc.LiftOffWarning):
        reference = bc.daf(bridge, truck, speeds, road, start=-20, method="control")
    assert values == pytest.approx(reference, abs=1e-6)


@pytest.mark.parametrize(
    ("change", "error", "says"),
    [
        ({"start": 3.0}, ValueError, "start must be 0 m (the start of the bridge) or negative"),
        ({"start": "here"}, TypeError, "start must be one number [m]"),
        ({"tail": -1.0}, ValueError, "tail must be 0 or more [s]"),
        ({"method": "rk4"}, ValueError, "method must be one of 'propagator', 'control'"),
        ({"profile": np.zeros(10)}, TypeError, "profile must be a bridgectl.RoadProfile"),
        ({"timepts": [0.1]}, ValueError, "timepts must hold two or more increasing times"),
        ({"timepts": [0.2, 0.1]}, ValueError, "timepts must hold two or more increasing times"),
        ({"timepts": [0.0, 9.0]}, ValueError, "timepts must lie within the crossing, 0 s to"),
        ({"timepts": [[0.0, 1.0]]}, ValueError, "timepts must have shape (n,), got (1, 2)"),
    ],
)
def test_a_bad_argument_is_named(bridge, truck, change, error, says):
    with pytest.raises(error) as caught:
        bc.crossing_response(bridge, truck, 30.0, **change)
    assert says in str(caught.value)


def test_a_road_that_does_not_cover_approach_and_bridge_is_an_error(bridge, truck):
    short = bc.RoadProfile([-10, 20], [0, 0])
    with pytest.raises(ValueError, match=r"-10 m to 20 m .* -10 m to 25 m"):
        bc.crossing_response(bridge, truck, 30.0, short, start=-10)
    with pytest.raises(ValueError, match="-200 m"):
        bc.daf(bridge, truck, 30.0, bc.RoadProfile([-10, 25], [0, 0]), start=-200)


@pytest.mark.parametrize(
    ("speeds", "error", "says"),
    [
        ([], ValueError, "speeds must hold at least one speed"),
        ([30.0, 0.0], ValueError, "speeds must be above 0 m/s, got 0"),
        ([30.0, np.nan], ValueError, "speeds must be finite [m/s], got nan at index (1,)"),
        ([[30.0]], ValueError, "speeds must have shape (n,), got (1, 1)"),
        ("fast", TypeError, "speeds must be an array of numbers"),
        (None, TypeError, "speeds must be an array of numbers"),
    ],
)
def test_bad_speeds_are_named(bridge, truck, speeds, error, says):
    with pytest.raises(error) as caught:
        bc.daf(bridge, truck, speeds)
    assert says in str(caught.value)


def test_a_vehicle_with_several_coordinates_starts_level_on_all_its_tires(bridge, truck):
    """The road before the start is level, so every tire of a convoy begins in equilibrium."""
    convoy = bc.convoy([truck, dataclasses.replace(truck, damping=2e3)], [0, 6])
    response = bc.crossing_response(bridge, convoy, 20.0, rough_road(1, -5, 25), start=-5)
    assert np.asarray(response.states)[:, 0] == pytest.approx(0.0, abs=1e-15)
    assert response.outputs["tire_force_2"][: 4 * 50] == pytest.approx(98100.0)
