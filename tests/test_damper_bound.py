"""The proven bound of all dampings: every one of a small grid, random ones, closed loops."""

from __future__ import annotations

import dataclasses
from fractions import Fraction
from itertools import product

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from test_whole_vehicles import half_car

import bridgectl as bc
from bridgectl.dampers import Damper, damper_bound, passive, simulate_loop, skyhook
from bridgectl.dampers.actuator import with_damping
from bridgectl.dampers.optimum import bound as room
from bridgectl.dampers.optimum.hull import Hull, Program
from bridgectl.dampers.optimum.impulses import Impulses
from bridgectl.dampers.optimum.steps import join, march
from bridgectl.linear.runs import prepare

SOFT, STIFF = 1e3, 30e3
SPEED, START = 30.0, -6.0
COARSE = 0.085
"""Ten dampings from one end of the bridge to the other."""


def road(seed, roughness="A"):
    return bc.iso8608_profile(roughness, 25 - START, start=START, seed=seed)


def grid(bridge, vehicle, profile, step, free_from=0.0):
    """The steps, and the shares of passive."""
    crossing = bc.Crossing(bridge, dataclasses.replace(vehicle, damping=0.0))
    run = prepare(crossing, profile, START)
    steps = join(run, SPEED, step, step, SOFT, STIFF, free_from)
    return steps, steps.shares(vehicle.damping)


def peaks(steps, own, shares):
    """Peaks by the steps alone, of shares on the bridge."""
    known = len(own) - len(shares[0])
    return np.array([march(steps, np.append(own[:known], each)).peak for each in shares])


def test_no_damping_switched_between_its_bounds_is_below_and_the_best_is_found(bridge, truck):
    profile = road(2, "B")
    found = damper_bound(bridge, truck, SPEED, profile, SOFT, STIFF, start=START, step=COARSE)
    steps, own = grid(bridge, truck, profile, COARSE)
    every = peaks(steps, own, [*product((0.0, 1.0), repeat=10)])
    assert found.bound <= every.min() <= found.bound + 2 * room.CLOSED
    assert found.lowest == pytest.approx(every.min(), abs=1e-12)
    assert found.passive > found.lowest + 0.01
    assert found.interval == (found.bound, found.lowest)


@pytest.mark.slow
def test_no_damping_of_two_dampers_is_below(bridge):
    half = half_car(np.random.default_rng(4), 3e4)
    case = bridge, half, SPEED, bc.iso8608_profile("B", 40, seed=2, start=-15), SOFT, STIFF
    found = damper_bound(*case, free_from=5, start=-15, step=0.2)
    bare = with_damping(half, 0.0)
    run = prepare(bc.Crossing(bridge, bare), case[3], -15.0)
    steps = join(run, SPEED, 0.2, 0.2, SOFT, STIFF, 5.0)
    own = steps.shares(half.damper_dampings)
    every = peaks(steps, own, [*product((0.0, 1.0), repeat=len(own) - 2)])
    assert found.bound <= every.min() <= found.bound + 2 * room.CLOSED
    assert found.best.damping.shape == (2, len(own) // 2)
    assert found.best.damping[:, 0] == pytest.approx(half.damper_dampings)


@pytest.mark.slow
@settings(max_examples=8, deadline=None)
@given(seed=st.integers(0, 10**6), roughness=st.sampled_from("AC"), dampings=st.integers(0, 10**6))
def test_no_random_damping_on_a_random_road_is_below(bridge, truck, seed, roughness, dampings):
    profile = road(seed, roughness)
    found = damper_bound(
        bridge, truck, SPEED, profile, SOFT, STIFF, free_from=START, start=START, step=COARSE
    )
    steps, own = grid(bridge, truck, profile, COARSE, START)
    shares = np.random.default_rng(dampings).beta(0.3, 0.3, (50, len(own)))
    assert found.bound <= peaks(steps, own, shares).min()
    assert found.gap >= 0


def test_of_a_damper_with_no_choice_it_is_the_passive_daf(bridge, truck):
    stiff, profile = dataclasses.replace(truck, damping=20e3), road(3)
    found = damper_bound(bridge, stiff, SPEED, profile, 20e3, 20e3, start=START, step=0.02)
    exact = bc.daf(bridge, stiff, SPEED, profile, start=START)[0]
    assert found.bound == pytest.approx(found.lowest - room.CLOSED, abs=1e-9)
    assert found.lowest == pytest.approx(found.passive, abs=1e-12)
    assert found.lowest == pytest.approx(exact, abs=1e-3)
    assert found.best.daf == pytest.approx(exact, abs=1e-4)


def test_strategies_on_the_same_grid_are_above(bridge, truck):
    profile, step = road(4), 0.04
    found = damper_bound(bridge, truck, SPEED, profile, SOFT, STIFF, start=0.0, step=step)
    on_bridge = profile.crop(0, 25)
    for law in (passive(SOFT), passive(STIFF), skyhook(SOFT, STIFF)):
        damper = Damper(law, sample_time=step)
        daf = simulate_loop(bridge, truck, damper, SPEED, on_bridge.x, on_bridge.elevation).daf
        assert daf[0, 0] > found.bound


@pytest.mark.slow
def test_control_from_further_before_the_bridge_can_do_more(bridge, truck):
    case = bridge, truck, SPEED, road(5), SOFT, STIFF
    late, early = (damper_bound(*case, free_from=x, start=START, step=0.05) for x in (0, -4.5))
    assert early.bound <= early.lowest <= late.lowest
    assert early.free_from == early.best.positions[1] == -4.5
    assert early.best.damping[0] == pytest.approx(7e3)


@pytest.mark.slow
def test_the_best_damping_has_in_the_closed_loop_the_daf_that_is_told(bridge, truck):
    profile = road(6)
    coarse, fine = (
        damper_bound(bridge, truck, SPEED, profile, SOFT, STIFF, start=START, step=step)
        for step in (0.05, 0.025)
    )
    again = simulate_loop(bridge, truck, fine.best.damper, SPEED, profile.x, profile.elevation)
    assert fine.best.daf == pytest.approx(again.daf[0, 0], abs=1e-6)
    assert fine.splitting == fine.best.daf - fine.lowest
    assert abs(fine.splitting) < 0.5 * abs(coarse.splitting)
    assert fine.best.passive_daf == pytest.approx(
        bc.daf(bridge, truck, SPEED, profile, start=START)[0], abs=1e-4
    )


def test_out_of_time_it_still_holds_and_says_that_it_says_nothing(bridge, truck):
    case = bridge, truck, SPEED, road(7), SOFT, STIFF
    with pytest.warns(UserWarning, match="the bound says nothing: .* or a free_from nearer"):
        hasty = damper_bound(*case, free_from=START, start=START, step=0.04, seconds=1e-3)
    assert not hasty.meaningful
    assert "which says nothing" in repr(hasty)
    assert hasty.bound < damper_bound(*case, free_from=START, start=START, step=0.05).lowest


def test_its_repr_is_one_line(bridge, truck):
    found = damper_bound(bridge, truck, SPEED, road(7), SOFT, STIFF, start=START, step=COARSE)
    assert found.meaningful
    assert repr(found).startswith(f"DamperBound(DAF {found.bound:.4f} to {found.lowest:.4f}, pass")
    assert "\n" not in repr(found)


def test_branches_close_a_gap_that_narrowing_leaves(bridge, truck, monkeypatch):
    monkeypatch.setattr(room, "PAYS", 100.0)
    found = damper_bound(
        bridge, truck, SPEED, road(2, "B"), SOFT, STIFF, start=START, step=0.05, free_from=START
    )
    assert found.branches > 0
    assert found.gap <= 1.01 * room.CLOSED


def test_what_counts_by_its_smallest_value_is_bounded_from_above(bridge, truck):
    bump = bc.RoadProfile([-20, 5, 5.5, 6, 25], [0, 0, 0.01, 0, 0])
    effect = bc.TireForce(sense="smallest")
    found = damper_bound(bridge, truck, 25.0, bump, SOFT, STIFF, step=0.1, effect=effect)
    assert found.passive < found.lowest <= found.bound
    assert found.interval == (found.lowest, found.bound)


def test_a_tire_that_leaves_the_road_is_told(bridge, truck):
    kerb = bc.RoadProfile([-10, -1, -0.9, 25], [0, 0, -0.08, -0.08])
    with pytest.warns(bc.LiftOffWarning, match="the bound is that of a crossing without lift-off"):
        damper_bound(bridge, truck, SPEED, kerb, SOFT, STIFF, start=-10, step=COARSE)


@pytest.mark.parametrize(
    ("wrong", "told"),
    [
        ({"free_from": -7}, "free_from must lie between the start at -6 m and .* 25 m, got -7"),
        ({"free_from": 25}, "type free_from=0"),
        ({"step": 0.0005}, "makes 1667 dampings to choose, more than 400: type .* step=0.0023"),
        ({"seconds": 0}, "seconds must be above 0 .s."),
        ({"step": -0.02}, "step must be above 0 .s."),
    ],
)
def test_wrong_arguments_are_told(bridge, truck, wrong, told):
    with pytest.raises(ValueError, match=told):
        damper_bound(bridge, truck, SPEED, road(1), SOFT, STIFF, **{"start": START} | wrong)


def test_hulls_hold_all_that_dampings_do(bridge, truck):
    """Intervals that random dampings stay in hold their impulses, too, whatever the signs."""
    steps, own = grid(bridge, truck, road(8), COARSE)
    impulses = Impulses(steps, own, 1)
    hull = Hull(impulses, 2.0)
    rng = np.random.default_rng(1)
    for shares in rng.beta(0.3, 0.3, (100, 10)):
        run = march(steps, np.append(own[:1], shares))
        w = run.impulses[-10:] / steps.phi(STIFF)[1:]
        n, moments, program = hull._program(0.0)
        assert np.all(program.rows @ w[:n] <= program.limits)
        assert impulses.shares(w) == pytest.approx(shares, abs=1e-9)
        assert (moments[:, :-1] @ w + moments[:, -1]).max() == pytest.approx(run.peak, abs=1e-12)
        assert impulses.peaks(shares[:, np.newaxis])[0] == pytest.approx(run.peak, abs=1e-12)


@given(seed=st.integers(0, 10**6))
@settings(max_examples=20, deadline=None)
def test_any_prices_prove_a_bound_and_those_of_the_solver_the_least_cost(seed):
    rng = np.random.default_rng(seed)
    rows, cost, inside = rng.normal(size=(12, 4)), rng.normal(size=4), rng.uniform(-1, 1, 4)
    program = Program(rows, rows @ inside + rng.uniform(0, 1, 12), -np.ones(4), np.ones(4))
    bound, found, prices = program.least(cost)
    assert bound <= cost @ found <= bound + 1e-9
    assert program.safe(cost, prices + rng.normal(size=12)) <= cost @ found
    b, y = np.vectorize(Fraction)(program.limits), np.vectorize(Fraction)(prices + 1)
    rest = np.vectorize(Fraction)(cost) + np.vectorize(Fraction)(rows).T @ y
    exact = -sum(map(abs, rest)) - b @ y
    assert exact - Fraction(1, 10**11) < Fraction(program.safe(cost, prices + 1)) <= exact
    assert program.safe(cost, 0 * prices) == pytest.approx(-np.abs(cost).sum())


def test_what_has_no_solution_is_proven_to_have_none():
    apart = Program(np.array([[1.0], [-1.0]]), np.array([-0.5, -0.5]), -np.ones(1), np.ones(1))
    assert apart.least(np.ones(1))[0] == np.inf
    hair = Program(np.array([[1.0], [-1.0]]), np.array([0.0, -1e-20]), -np.ones(1), np.ones(1))
    assert hair.least(np.ones(1))[0] <= 0  # within round-off: nothing is proven
