"""Amplification of other effects than the moment, by the same factored histories."""

from dataclasses import replace

import numpy as np
import pytest
from helpers import random_case, rough_road

import bridgectl as bc
from bridgectl.linear.cells import sample_positions
from bridgectl.linear.reference import reference_effect
from bridgectl.linear.runs import prepare
from bridgectl.model.crossing import make_crossing

EFFECTS = ["deflection", "tire_force", "acceleration", "moment"]


def ask_for(effect):
    """What gives the peak of an effect: a factor, but of an acceleration."""
    return bc.peak_effect if effect == "acceleration" else bc.daf


def static_deflection(beam):
    """Largest static deflection at mid-span under 1 N, summed over the beam's modes."""
    return max(
        sum(
            2 / (beam.mass * w**2) * np.sin(j * np.pi * s) * np.sin(j * np.pi / 2)
            for j, w in enumerate(beam.omega, 1)
        )
        for s in np.linspace(0, 1, 4001)
    )


@pytest.mark.parametrize("effect", EFFECTS)
@pytest.mark.parametrize("section", [0.5, 0.3])
def test_superposed_effects_are_those_the_propagator_simulates(bridge, truck, effect, section):
    speeds = np.array([60, 90, 120]) / 3.6
    surface = bc.ramp_surface(bridge, truck, speeds, approach=20, section=section, effect=effect)
    road = rough_road(3, -20, 25, height=3e-4)
    simulated = ask_for(effect)(bridge, truck, speeds, road, start=-20, effect=surface.effect)
    scale = 1e-6 * np.abs(simulated)
    assert np.all(np.abs(surface.superposed_daf(road) - simulated) < scale)


@pytest.mark.quick_cases(2)
@pytest.mark.parametrize("effect", EFFECTS)
@pytest.mark.parametrize("seed", [1, 4])
def test_each_effect_is_that_of_the_control_library(effect, seed):
    case = random_case(seed)
    name = "tire_force_1" if effect == "tire_force" and seed % 5 == 4 else effect
    crossing = make_crossing(case["beam"], case["vehicle"], name, case["section"])
    run = prepare(crossing, case["profile"], case["start"])
    nodes = run.nodes(case["speed"])
    found = reference_effect(run, bc.Motion(case["speed"]), sample_positions(nodes[nodes >= -1e-9]))
    daf = ask_for(effect)(
        case["beam"], case["vehicle"], case["speed"], case["profile"], start=case["start"],
        effect=crossing.effect,
    )[0]  # fmt: skip
    # Between samples a peak rises above them by less than 1e-3 of the range.
    assert daf == pytest.approx(found.max(), abs=2e-3 * np.ptp(found))


@pytest.mark.quick_cases(1)
@pytest.mark.parametrize("method", ["propagator", "control"])
def test_the_outputs_of_a_response_have_the_same_peaks(bridge, truck, method):
    road, speed = rough_road(5, -10, 25, height=3e-4), 25.0
    response = bc.crossing_response(bridge, truck, speed, road, start=-10)
    on_bridge = response.time >= 0
    weight = 98100.0
    expected = {
        "tire_force": response.outputs["tire_force"][on_bridge].max() / weight,
        "acceleration": response.outputs["y_s_ddot"][on_bridge].max(),
        "deflection": response.outputs["deflection"].max() / weight / static_deflection(bridge),
    }
    for effect, value in expected.items():
        ask = ask_for(effect)
        daf = ask(bridge, truck, speed, road, start=-10, effect=effect, method=method)[0]
        assert daf == pytest.approx(value, rel=1e-3)  # the response has no sample at the peak


def test_a_creeping_truck_deflects_the_bridge_as_a_static_load(bridge, truck):
    damped = replace(bridge, damping_ratio=0.01)
    assert bc.daf(damped, truck, 0.5, effect="deflection") == pytest.approx(1, abs=1e-3)
    assert bc.daf(damped, truck, 0.5, effect="tire_force") == pytest.approx(1, abs=1e-3)
    assert bc.peak_effect(damped, truck, 0.5, effect="acceleration") == pytest.approx(0, abs=1e-3)


def test_the_static_peak_of_a_convoy_is_found_among_its_places(bridge, truck):
    convoy = bc.convoy([truck, truck], [0, 5.0]).linear
    effect = bc.Deflection(12.5)
    alone = effect.static_peak(bridge, truck.linear)
    assert alone < effect.static_peak(bridge, convoy) < 2 * alone


@pytest.mark.slow
def test_an_acceleration_has_no_smooth_road_in_proportion_and_its_ramps_superpose(bridge, truck):
    """A straight ramp of 1 mm at the start: the response is proportional to its height."""
    one = bc.ramp_surface(bridge, truck, 25.0, effect="acceleration", ramp_height=1e-3)
    two = bc.ramp_surface(bridge, truck, 25.0, effect="acceleration", ramp_height=2e-3)
    assert one.histories.moments(0, 1e-3) * 2 == pytest.approx(
        two.histories.moments(0, 2e-3), abs=1e-12
    )


def test_an_effect_that_is_none_is_an_error(bridge, truck):
    with pytest.raises(ValueError, match="effect must be one of 'moment', 'deflection'"):
        bc.ramp_surface(bridge, truck, 25.0, effect="stress")
    with pytest.raises(ValueError, match="tire_force_1"):
        bc.daf(bridge, bc.convoy([truck, truck], [0, 5.0]), 25.0, effect="tire_force")
