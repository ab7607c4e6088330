"""Bridgehook at every axle of a truck: each damper counts on what the others take off."""

import numpy as np
import pytest
from scipy.optimize import minimize
from scipy.special import logsumexp

import bridgectl as bc
from bridgectl.dampers import bridgehook, library, simulate_loop
from bridgectl.dampers.costate import smooth_crossing
from bridgectl.dampers.peak_value import _backward, _weights
from bridgectl.linear.cells import SAMPLES
from bridgectl.linear.runs import effect_samples
from bridgectl.road import iso8608_elevations

SOFT, STIFF = 2e3, 30e3
BETA, SPEED = 10.0, 20.0


@pytest.fixture(scope="module")
def semitrailer():
    return bc.trucks.load("T5air")


@pytest.fixture(scope="module")
def two_axles(bridge):
    """A smooth crossing of a truck of two legs: prediction, and moments over the static peak."""
    crossing = bc.Crossing(bridge, bc.trucks.load("T2"))
    known, on_bridge = smooth_crossing(crossing, SPEED, 20.0)
    return known, effect_samples(crossing, on_bridge)[0, :: len(SAMPLES)]


def shares(weights):
    return weights / weights.sum(axis=-1, keepdims=True)


def test_dampers_without_a_range_leave_the_soft_maximum_of_the_smooth_road(two_axles):
    known, moments = two_axles
    expected = shares(np.gradient(known.positions[known.entry :]) * np.exp(BETA * moments))
    found = shares(_weights(known, moments, BETA, np.zeros(known.positions.size)))
    assert found == pytest.approx(np.array([expected] * 2), abs=1e-12)


@pytest.mark.parametrize("leg", [0, 1])
def test_the_moments_that_count_are_those_that_the_best_of_the_other_damper_leaves(two_axles, leg):
    """Against a quasi-Newton method with bounds; forces of up to 20 kN, which change much."""
    known, moments = two_axles
    impulses = 20e3 * np.gradient(known.positions) / SPEED
    worth = np.array([rows @ known.damper_input[:, 1 - leg] for _, rows in _backward(known)]).T
    worth *= impulses[::-1]  # nodes from the last one on
    widths = np.gradient(known.positions[known.entry :])

    def soft(pushes):
        exponents = np.log(widths) + BETA * (moments + worth @ pushes)
        slope = worth.T @ np.exp(exponents - logsumexp(exponents))
        return logsumexp(exponents) / BETA, slope

    start = np.zeros(impulses.size)
    best = minimize(soft, start, jac=True, bounds=[(-1, 1)] * start.size, method="L-BFGS-B")
    assert best.fun < soft(start)[0] - 0.05  # of the static moment: it matters
    expected = shares(widths * np.exp(BETA * (moments + worth @ best.x)))
    found = shares(_weights(known, moments, BETA, impulses))[leg]
    assert np.abs(found - expected).sum() < 0.02 * 2  # of what two distributions may differ by


@pytest.mark.slow
@pytest.mark.parametrize("iso_class", ["A", "B"])
def test_at_five_axles_it_lowers_the_mean_daf_at_every_speed(bridge, semitrailer, iso_class):
    """More than it does at any one of them, and than passive dampers at the middle of its range."""
    speeds, x = np.array([60, 80, 100]) / 3.6, -60 + 0.1 * np.arange(851)
    roads = iso8608_elevations(30, iso_class, 85, seed=41)

    def daf(damper):
        return simulate_loop(bridge, semitrailer, damper, speeds, x, roads).daf.mean(axis=1)

    own = daf(library(bridge, semitrailer, SOFT, STIFF)[0])
    hook = bridgehook(bridge, semitrailer, SOFT, STIFF)
    every = daf(hook)
    assert np.all(every < own - 0.03)
    for leg in range(5):
        one = daf([hook if k == leg else None for k in range(5)])
        assert one.mean() < own.mean() - 0.005
        assert every.mean() < one.mean() - 0.02
