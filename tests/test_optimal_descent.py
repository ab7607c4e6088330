"""The descent over blocks beside IPOPT, and the optima of many crossings at once."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from test_whole_vehicles import half_car

import bridgectl as bc
from bridgectl.dampers import clairvoyant, passive, simulate_loop
from bridgectl.dampers.optimum import descent as room
from bridgectl.dampers.optimum.clairvoyant import _calmed
from bridgectl.dampers.optimum.descent import Descent
from bridgectl.dampers.optimum.solver import NOT_SOLVED, Try
from bridgectl.dampers.optimum.steps import join, march
from bridgectl.linear.runs import prepare

SOFT, STIFF = 1e3, 30e3
START = -15.0


@pytest.fixture(scope="module")
def roads():
    return [bc.iso8608_profile("A", 40, seed=seed, start=START) for seed in (5, 6)]


def steps_of(bridge, vehicle, road, held, longest):
    crossing = bc.Crossing(bridge, vehicle)
    return join(prepare(crossing, road, START), 25.0, held, longest, SOFT, STIFF)


@pytest.fixture(scope="module")
def coarse(bridge, truck, roads):
    """A crossing of 33 intervals of 50 ms, each of five steps."""
    return steps_of(bridge, replace(truck, damping=0.0), roads[0], 0.05, 0.01)


def test_the_intervals_have_the_peak_of_the_steps_with_any_damping_of_several_legs(bridge, roads):
    half = half_car(np.random.default_rng(4), 3e4)
    steps = steps_of(bridge, half.undamped, roads[0], 0.03, 0.01)
    descent, rng = Descent(steps), np.random.default_rng(0)
    for _ in range(3):
        shares = rng.random(2 * len(steps.positions))
        peak = room._Round(descent, shares.reshape(-1, 2)).peak
        assert peak == pytest.approx(march(steps, shares).peak, abs=1e-12)


def test_no_block_at_a_bound_lowers_the_peak_that_the_descent_comes_to(coarse):
    """All blocks of all lengths up to 11 intervals, by the march through the steps."""
    own = coarse.shares(7e3)
    found = Descent(coarse).lower(Try(own, NOT_SOLVED))
    peak = march(coarse, found.shares).peak
    assert peak < march(coarse, own).peak - 0.02
    assert found.status == room.LOWERED
    n = len(own)
    for share in (0.0, 1.0):
        for length in (1, 2, 3, 4, 6, 8, 11):
            for start in range(n - length + 1):
                changed = found.shares.copy()
                changed[start : start + length] = share
                assert march(coarse, changed).peak > peak - 1e-6


def test_behind_the_peak_the_damping_of_a_descent_returns_to_passive(coarse):
    own = coarse.shares(7e3)
    lowered = Descent(coarse).lower(Try(own, NOT_SOLVED))
    found = lowered._replace(shares=np.where(coarse.positions > 15, 1.0, lowered.shares))
    calm = _calmed(coarse, found, own)
    assert march(coarse, calm.shares).peak <= march(coarse, found.shares).peak
    changed = np.flatnonzero(calm.shares != found.shares)
    assert calm.shares[changed[0] :].tolist() == own[changed[0] :].tolist()
    assert coarse.positions[changed[0]] > 5  # m, with a peak near mid-span
    solved = found._replace(status="Solve_Succeeded")
    assert _calmed(coarse, solved, own) is solved


def test_a_descent_that_begins_at_its_end_keeps_the_damping_and_its_status(coarse):
    descent = Descent(coarse)
    found = descent.lower(Try(coarse.shares(7e3), NOT_SOLVED))
    again = descent.lower(found._replace(status="as it was"))
    assert again.status == "as it was"
    assert again.shares is found.shares


def test_a_descent_that_is_stopped_early_is_kept(coarse, monkeypatch):
    monkeypatch.setattr(room, "MOST_ROUNDS", 1)
    own = coarse.shares(7e3)
    found = Descent(coarse).lower(Try(own, NOT_SOLVED))
    changed = np.flatnonzero(found.shares != own)
    assert np.ptp(changed) < room.LENGTHS[-1]
    assert march(coarse, found.shares).peak < march(coarse, own).peak


def test_blocks_that_raise_other_moments_are_found_out(coarse, monkeypatch):
    """With but one moment to try blocks with, the descent still never raises the peak."""
    monkeypatch.setattr(room, "MOST_NEAR", 1)
    descent, shares = Descent(coarse), coarse.shares(7e3)
    monkeypatch.setattr(room, "MOST_ROUNDS", 1)
    peaks = [march(coarse, shares).peak]
    for _ in range(12):
        shares = descent.lower(Try(shares, NOT_SOLVED)).shares
        peaks.append(march(coarse, shares).peak)
    assert np.all(np.diff(peaks) <= 0)
    assert peaks[-1] < peaks[0] - 0.02


@pytest.mark.slow
def test_many_crossings_have_the_numbers_that_each_has_alone(bridge, truck, roads):
    given = {"c_min": SOFT, "c_max": STIFF, "start": -1.0, "step": 0.1}
    found = clairvoyant(bridge, truck, [25.0, 30.0], roads[1:], **given, workers=1)
    assert found.shape == (2, 1)
    alone = clairvoyant(bridge, truck, 30.0, roads[1], **given)
    assert alone.daf == found[1, 0].daf
    assert alone.damping.tolist() == found[1, 0].damping.tolist()
    for best in found.flat:
        assert best.daf == min(best.ipopt_daf, best.descent_daf, best.passive_daf)


@pytest.mark.slow
def test_processes_find_the_numbers_of_one(bridge, truck, roads):
    given = {"c_min": SOFT, "c_max": STIFF, "start": START, "step": 0.05}
    one, two = (
        clairvoyant(bridge, truck, 25.0, roads, **given, workers=n, progress=False) for n in (1, 2)
    )
    assert one.shape == two.shape == (1, 2)
    assert [best.daf for best in one.flat] == [best.daf for best in two.flat]
    assert clairvoyant(bridge, truck, [25.0], roads[0], **given)[0, 0].daf == one[0, 0].daf


@pytest.mark.slow
def test_the_descent_leaves_a_poor_optimum_that_the_solver_stays_at(bridge, truck):
    road = bc.iso8608_profile("A", 85, seed=2002, start=-60)
    best = clairvoyant(bridge, truck, 30.0, road, SOFT, STIFF, start=-60)
    assert best.daf < best.ipopt_daf - 0.05
    again = bc.daf(bridge, truck, 30.0, road, start=-60, damper=best.damper)[0]
    assert again == pytest.approx(best.daf, abs=1e-9)


@pytest.mark.slow
def test_tires_that_leave_the_road_are_counted(bridge, truck):
    kerb = bc.RoadProfile([-10, -1, -0.9, 25], [0, 0, -0.08, -0.08])
    level = bc.RoadProfile([-10, 25], [0, 0])
    with pytest.warns(bc.LiftOffWarning, match="leaves the road in 1 of 2 crossings"):
        clairvoyant(bridge, truck, 30.0, [kerb, level], SOFT, STIFF, start=-10, step=0.1, workers=1)


def test_without_a_range_all_numbers_are_those_of_the_passive_damper(bridge, truck, roads):
    best = clairvoyant(bridge, truck, 25.0, roads[0], 7e3, 7e3, start=START, step=0.05)
    assert best.daf == best.passive_daf == best.ipopt_daf == best.descent_daf
    exact = bc.daf(bridge, truck, 25.0, roads[0], start=START, damper=passive(7e3))[0]
    assert best.daf == pytest.approx(exact, abs=1e-4)


def test_a_list_with_what_is_no_road_is_refused(bridge, truck, roads):
    with pytest.raises(TypeError, match="road must be a RoadProfile, got int"):
        clairvoyant(bridge, truck, 25.0, [roads[0], 3], SOFT, STIFF)
    with pytest.raises(ValueError, match="speeds must be above 0 m/s, got -1"):
        clairvoyant(bridge, truck, [25.0, -1.0], roads, SOFT, STIFF)


def ride_of(bridge, vehicle, best, road):
    """Largest rms body acceleration of the legs [m/s^2], by the closed loop at every 1 ms."""
    dampers = best.damper if isinstance(best.damper, list) else [best.damper]
    loop = simulate_loop(
        bridge, vehicle, [replace(each, sample_time=1e-3) for each in dampers], 25.0, road.x,
        road.elevation, record=["body_acceleration"],
    )  # fmt: skip
    assert loop.daf[0, 0] == pytest.approx(best.daf, abs=1e-5)
    history = loop.histories[0]["body_acceleration"]
    return np.sqrt((history**2).mean(axis=-1)).max()


@pytest.mark.parametrize("several", [False, pytest.param(True, marks=pytest.mark.slow)])
@pytest.mark.slow
def test_a_limited_ride_is_kept_and_costs_some_of_the_gain(bridge, truck, roads, several):
    """Within 1 % of the limit by the closed loop, whose accelerations are no means of steps."""
    vehicle = half_car(np.random.default_rng(4), 3e4) if several else truck
    given = bridge, vehicle, 25.0, roads[0], SOFT, STIFF
    best = clairvoyant(*given, start=START, step=0.02)
    whole = ride_of(bridge, vehicle, best, roads[0])
    limited = clairvoyant(*given, start=START, step=0.02, ride=0.8 * whole)
    assert ride_of(bridge, vehicle, limited, roads[0]) < 0.8 * whole * 1.01
    assert best.daf + 1e-4 < limited.daf < limited.passive_daf
    if several:
        loose = clairvoyant(*given, start=START, step=0.02, ride=10 * whole)
        assert loose.daf == pytest.approx(best.ipopt_daf, abs=1e-3)


def test_a_ride_that_no_damping_keeps_is_refused(bridge, truck, roads):
    given = bridge, truck, 25.0, roads[0]
    with pytest.raises(ValueError, match=r"ride must be one that .* got 1e-06 m/s\^2: type for"):
        clairvoyant(*given, 7e3, 7e3, start=START, step=0.1, ride=1e-6)
    with pytest.raises(ValueError, match="ride must be above 0"):
        clairvoyant(*given, SOFT, STIFF, ride=0.0)
