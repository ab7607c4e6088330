"""The clairvoyant optimum of several dampers: against quarter-cars, the closed loop, other laws."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest
from test_whole_vehicles import five_axles, half_car

import bridgectl as bc
from bridgectl.dampers import bridgehook, clairvoyant, passive, simulate_loop, skyhook
from bridgectl.dampers.optimum.steps import join, march
from bridgectl.linear.runs import prepare

SOFT, STIFF = 1e3, 30e3
SPEED, START, STEP = 25.0, -15.0, 0.05


@pytest.fixture(scope="module")
def road():
    return bc.iso8608_profile("B", 40, seed=2, start=START)


@pytest.fixture(scope="module")
def half():
    return half_car(np.random.default_rng(4), 3e4)


@pytest.fixture(scope="module")
def best(bridge, half, road):
    return clairvoyant(bridge, half, SPEED, road, SOFT, STIFF, start=START, step=STEP)


@pytest.mark.slow
def test_a_vehicle_of_one_damper_has_the_numbers_of_the_quarter_car(bridge, truck, road):
    given = SPEED, road, SOFT, STIFF
    one, other = (
        clairvoyant(bridge, car, *given, start=START, step=0.05)
        for car in (truck, bc.convoy([truck], [0]))
    )
    assert one.daf == pytest.approx(other.daf, abs=1e-6)
    assert one.damping == pytest.approx(other.damping, abs=1.0)  # N s/m
    assert one.damping.shape == one.positions.shape


@pytest.mark.slow
def test_the_optimum_beats_all_other_dampers(bridge, half, road, best):
    """At the same speed, on the same road: constant ones, bridgehook and skyhook at each leg."""
    others = [*map(passive, (SOFT, 4e3, 9e3, 16e3, STIFF)), skyhook(SOFT, STIFF)]
    others += [bridgehook(bridge, half, SOFT, STIFF)]
    dafs = [bc.daf(bridge, half, SPEED, road, start=START, damper=law)[0] for law in others]
    assert best.daf < min(dafs) - 0.02
    own = bc.daf(bridge, half, SPEED, road, start=START)[0]
    assert best.passive_daf == pytest.approx(own, abs=1e-4)


@pytest.mark.slow
def test_one_damper_alone_does_less(bridge, half, road, best):
    """Of a vehicle in which only the front, or only the rear, can be controlled."""
    for leg in (0, 1):
        single = dataclasses.replace(
            half, damper_map=half.damper_map[[leg]], damper_axles=half.damper_axles[[leg]],
            damper_dampings=half.damper_dampings[[leg]], damper_names=["one"],
        )  # fmt: skip
        found = clairvoyant(bridge, single, SPEED, road, SOFT, STIFF, start=START, step=STEP)
        assert best.daf < found.daf - 0.003 < found.passive_daf
        assert found.passive_daf == pytest.approx(best.passive_daf, abs=1e-4)
        own = bc.daf(bridge, single, SPEED, road, start=START, damper=found.damper)[0]
        assert own == pytest.approx(found.daf, abs=1e-5)


@pytest.mark.slow
def test_the_daf_is_that_of_the_closed_loop_with_a_program_at_each_leg(bridge, half, road, best):
    assert best.damping.shape == (2, best.positions.size)
    assert best.damping.min() >= SOFT
    assert best.damping.max() <= STIFF
    assert best.offsets == pytest.approx(half.tire_offsets)
    looped = simulate_loop(
        bridge, half, best.damper, SPEED, road.x, road.elevation, record=["damping"]
    )
    assert looped.daf[0, 0] == pytest.approx(best.daf, abs=1e-9)
    held = looped.histories[0]["damping"][:, 0]
    assert held == pytest.approx(best.damping, abs=1e-6)  # N s/m
    assert bc.daf(bridge, half, SPEED, road, start=START, damper=best.damper)[0] == (
        pytest.approx(best.daf, abs=1e-5)
    )
    assert f"{best.damping.size} dampings" in repr(best)


@pytest.mark.slow
def test_no_small_change_of_the_dampings_lowers_the_peak(bridge, half, road, best):
    """Random changes by 3 kN s/m within the bounds: none is 0.0005 lower."""
    rng = np.random.default_rng(0)
    for _ in range(50):
        other = np.clip(best.damping + rng.normal(0, 3e3, best.damping.shape), SOFT, STIFF)
        law = dataclasses.replace(best, damping=other).damper
        daf = simulate_loop(bridge, half, law, SPEED, road.x, road.elevation).daf[0, 0]
        assert daf > best.daf - 5e-4


@pytest.mark.quick_cases(1)
@pytest.mark.parametrize("truck", [half_car, five_axles])
def test_the_steps_tend_to_the_closed_loop_with_the_square_of_their_length(bridge, road, truck):
    vehicle = truck(np.random.default_rng(4))
    run = prepare(bc.Crossing(bridge, vehicle.undamped), road, START)
    exact = simulate_loop(bridge, vehicle, passive(STIFF), SPEED, road.x, road.elevation).daf[0, 0]
    errors = []
    for longest in (10e-3, 5e-3, 2.5e-3):
        steps = join(run, SPEED, STEP, longest, SOFT, STIFF)
        errors.append(abs(march(steps, steps.shares(STIFF)).peak - exact))
    assert errors[1] < 0.35 * errors[0] + 5e-5
    assert errors[2] < 0.35 * errors[1] + 5e-5


def test_dampings_of_each_damper_are_shares_and_back(bridge, half):
    run = prepare(bc.Crossing(bridge, half.undamped), None, 0.0)
    steps = join(run, SPEED, 0.1, 0.05, SOFT, STIFF)
    given = np.array([4e3, 16e3])
    found = steps.damping(steps.shares(given)).reshape(-1, 2)
    assert found == pytest.approx(np.tile(given, (len(found), 1)))


@pytest.mark.filterwarnings("ignore::bridgectl.PlausibilityWarning")  # its start is felt
@pytest.mark.slow
def test_five_axles_too(bridge, road):
    vehicle = five_axles(np.random.default_rng(4))
    best = clairvoyant(bridge, vehicle, SPEED, road, SOFT, STIFF, start=START, step=STEP)
    hook = bridgehook(bridge, vehicle, SOFT, STIFF)
    other = bc.daf(bridge, vehicle, SPEED, road, start=START, damper=hook)[0]
    assert best.daf < min(other, best.passive_daf) - 0.02
    found = bc.daf(bridge, vehicle, SPEED, road, start=START, damper=best.damper)[0]
    assert found == pytest.approx(best.daf, abs=1e-5)


@pytest.mark.slow
def test_the_steps_start_at_rest_on_the_road_under_each_axle(bridge, half):
    """On a road that is known behind the start: DAFs within 1e-3, at the steps of 2.5 ms."""
    road = bc.iso8608_profile("B", 55, seed=3, start=2 * START)
    run = prepare(bc.Crossing(bridge, half.undamped), road, START)
    steps = join(run, SPEED, STEP, 2.5e-3, SOFT, STIFF)
    assert abs(steps.initial).max() > 1e-4  # m
    exact = bc.daf(bridge, half, SPEED, road, start=START, damper=passive(STIFF))[0]
    assert march(steps, steps.shares(STIFF)).peak == pytest.approx(exact, abs=1e-3)
    best = clairvoyant(bridge, half, SPEED, road, SOFT, STIFF, start=START, step=0.05)
    found = bc.daf(bridge, half, SPEED, road, start=START, damper=best.damper)[0]
    assert found == pytest.approx(best.daf, abs=1e-5)
    assert best.daf < best.passive_daf - 0.02
