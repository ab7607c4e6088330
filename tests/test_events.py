"""Closed loops with lift-off, landing and force limits, against a fine integration."""

import dataclasses
import itertools

import numpy as np
import pytest
from fine_loop import FineLoop
from test_closed_loop import LAWS, SOFT, STIFF, laws, random_loop

import bridgectl as bc
from bridgectl.dampers import Damper, passive, preset, simulate_loop, skyhook
from bridgectl.dampers.loop.events import Regime, first_sign_change

ROUGH = 40
"""How many times steeper a road is made for a tire to leave it."""


def eventful_loop(seed):
    """A random crossing of every third kind: with lift-off, with a force limit, with neither."""
    beam, car, options, speed, road = random_loop(seed)
    rng = np.random.default_rng((seed, 7))
    limits = [[np.inf, 2e3, 20e3], [2e3, 20e3], [np.inf]][seed % 3]
    options["max_force"] = float(rng.choice(limits))
    options["sample_time"] = float(rng.choice([2e-3, 5e-3, options["sample_time"]]))
    if seed % 3 == 0:
        road = bc.RoadProfile(road.x, ROUGH * road.elevation)
    return beam, car, options, speed, road


def compare(beam, car, damper, speed, road):
    """The loop's result, and the fine integration of the same crossing."""
    found = simulate_loop(beam, car, damper, speed, road.x, road.elevation)
    return found, FineLoop(beam, car, damper, speed, road)


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(10))
@pytest.mark.parametrize("name", [name for name in LAWS if not name.startswith("program")])
def test_every_law_is_its_fine_integration(name, seed):
    """Fourteen laws, ten random crossings each, a third of them with lift-off: DAFs within 2e-5."""
    beam, car, options, speed, road = eventful_loop(seed)
    found, fine = compare(beam, car, Damper(laws(beam, car)[name], **options), speed, road)
    assert found.daf[0, 0] == pytest.approx(fine.peak, abs=2e-5)
    assert (found.least_force[0, 0] == 0) == (fine.least == 0) == (seed % 3 == 0)


@pytest.mark.quick_cases(1)
@pytest.mark.parametrize(("seed", "name"), [(3, "groundhook"), (6, "skyhook"), (1, "clipped LQR")])
def test_a_law_with_lift_off_or_a_force_limit_is_its_fine_integration(seed, name):
    beam, car, options, speed, road = eventful_loop(seed)
    found, fine = compare(beam, car, Damper(laws(beam, car)[name], **options), speed, road)
    assert found.daf[0, 0] == pytest.approx(fine.peak, abs=2e-5)


@pytest.mark.slow
def test_a_force_limit_flips_no_command(bridge, truck):
    """The paper's truck, skyhook limited to 2 kN, class B, 25 m/s: 500 commands, all the same."""
    road = bc.iso8608_profile("B", 25, seed=5, start=0)
    damper = Damper(skyhook(SOFT, STIFF), max_force=2e3)
    found = simulate_loop(bridge, truck, damper, 25.0, road.x, road.elevation, record=["damping"])
    fine = FineLoop(bridge, truck, damper, 25.0, road)
    assert found.histories[0]["damping"][0] == pytest.approx(fine.commands, rel=1e-12)
    assert found.daf[0, 0] == pytest.approx(fine.peak, abs=1e-6)


@pytest.mark.slow
def test_a_limit_and_a_lift_off_in_one_batch_leave_the_other_roads_as_they_are(bridge, truck):
    x = np.array([-10.0, -1.0, -0.9, 25.0])
    roads = np.array([[0, 0, 0, 0], [0, 0, -0.08, -0.08], [0, 0, 0.03, 0.03]])
    damper = Damper(skyhook(SOFT, STIFF), max_force=2e3)
    speeds = [20.0, 30.0]
    together = simulate_loop(bridge, truck, damper, speeds, x, roads)
    for (i, speed), (j, road) in itertools.product(enumerate(speeds), enumerate(roads)):
        alone = simulate_loop(bridge, truck, damper, speed, x, road)
        assert together.daf[i, j] == pytest.approx(alone.daf[0, 0], abs=1e-12)
        assert together.lift_off[i, j] == pytest.approx(alone.lift_off[0, 0], abs=1e-9)


def test_the_place_where_a_tire_leaves_the_road_is_told(bridge, truck):
    """A drop of 80 mm over 0.1 m; the passive crossing, solved exactly, has the same place."""
    x, z = np.array([-10.0, -1.0, -0.9, 25.0]), [0, 0, -0.08, -0.08]
    found = simulate_loop(bridge, truck, passive(truck.damping), 30.0, x, z)
    with pytest.warns(bc.LiftOffWarning):
        response = bc.crossing_response(bridge, truck, 30.0, bc.RoadProfile(x, z), start=-10)
    flying = response.outputs["tire_force"] <= 0
    first = 30.0 * response.time[np.argmax(flying)]
    assert found.lift_off[0, 0] == pytest.approx(first, abs=0.02)  # a sample of the response
    smooth = simulate_loop(bridge, truck, passive(truck.damping), 30.0, x, [0, 0, 0, 0])
    assert np.isinf(smooth.lift_off[0, 0])


@pytest.mark.slow
def test_a_landing_with_a_stiff_tire_has_the_peak_force_of_a_fine_integration(bridge):
    car = bc.QuarterCar(9e3, 700, 4e5, 4e6, 1e4)
    road = bc.RoadProfile([-4.0, -3.0, -2.9, 25.0], [0, 0, -0.08, -0.08])
    times = np.linspace(-0.1, 0.1, 801)
    with pytest.warns(bc.LiftOffWarning):
        found = bc.crossing_response(
            bridge, car, 25.0, road, start=-4, damper=skyhook(SOFT, STIFF), timepts=times
        )
    fine = FineLoop(bridge, car, Damper(skyhook(SOFT, STIFF)), 25.0, road)
    force = found.outputs["tire_force"]
    assert force.max() == pytest.approx(fine.largest, rel=1e-5)


def test_an_event_turns_contact_and_takes_the_damper_to_its_limit_and_back():
    column = np.array([[True], [True], [False], [True]])
    before = Regime(column, np.array([[0.0], [1.0], [0.0], [-1.0]]))
    event = np.array([[False, True], [False, True], [True, False], [False, False]])
    after = before.after(event, np.array([[-2e3], [2e3], [5.0], [-2e3]]))
    assert after.touching.ravel().tolist() == [True, True, True, True]
    assert after.limited.ravel().tolist() == [-1.0, 0.0, 0.0, -1.0]


def test_the_first_sign_change_of_a_cubic_is_found():
    nodes = np.array([0.0, 0.25, 0.5, 1.0])
    places = np.array([0.1, 0.3, 0.9])
    falling = places[:, np.newaxis] - nodes
    bent = falling * (1 + nodes**2)
    assert first_sign_change(nodes, falling) == pytest.approx(places, abs=1e-9)
    assert first_sign_change(nodes, bent) == pytest.approx(places, abs=1e-9)
    assert np.isinf(first_sign_change(nodes, np.ones((1, 4))))


@pytest.mark.quick_cases(1)
@pytest.mark.parametrize("section", [0.2, 0.5])
def test_the_peak_of_a_beam_with_many_modes_is_found(truck, section):
    """Eight modes of 11 m, the last at 490 Hz: as the passive crossing, solved exactly."""
    beam = dataclasses.replace(bc.li2006.beam(11), n_modes=8)
    road = bc.iso8608_profile("B", 11, seed=2)
    speeds = np.linspace(10, 40, 7)
    damper = Damper(passive(truck.damping), max_force=1e9)
    where = {"start": 0, "section": section}
    found = bc.daf(beam, truck, speeds, road, damper=damper, **where)
    assert found == pytest.approx(bc.daf(beam, truck, speeds, road, **where), abs=2e-5)


def test_a_preset_damper_tells_of_a_lift_off_once(bridge, truck):
    """Of the damping that it takes, not of those it tries."""
    x, z = np.array([-10.0, -1.0, -0.9, 25.0]), [0, 0, -0.08, -0.08]
    with pytest.warns(bc.LiftOffWarning) as told:
        bc.daf(bridge, truck, 25.0, bc.RoadProfile(x, z), start=-10, damper=preset(SOFT, STIFF))
    assert len(told) == 1
