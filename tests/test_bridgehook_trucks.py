"""Bridgehook at every axle of a truck: each damper counts on what the others take off."""

import numpy as np
import pytest
from scipy.optimize import minimize
from scipy.special import logsumexp

import bridgectl as bc
from bridgectl.dampers import bridgehook, library, simulate_loop
from bridgectl.dampers.actuator import with_damping
from bridgectl.dampers.costate import smooth_crossing
from bridgectl.dampers.peak_value import OTHERS_SPEED, _backward, _weights
from bridgectl.linear.cells import SAMPLES
from bridgectl.linear.runs import effect_samples
from bridgectl.road import iso8608_elevations

SOFT, STIFF = 2e3, 30e3
BETA, SPEED = 10.0, 20.0


@pytest.fixture(scope="module")
def semitrailer():
    return bc.trucks.load("T5air")


@pytest.fixture(scope="module")
def smooth(bridge, semitrailer):
    """A smooth crossing: prediction, and moments over the static peak at its nodes."""
    crossing = bc.Crossing(bridge, with_damping(semitrailer, (SOFT + STIFF) / 2))
    known, on_bridge = smooth_crossing(crossing, SPEED, 20.0)
    return known, effect_samples(crossing, on_bridge)[0, :: len(SAMPLES)]


def shares(weights):
    return weights / weights.sum(axis=-1, keepdims=True)


def test_dampers_without_a_range_leave_the_soft_maximum_of_the_smooth_road(smooth):
    known, moments = smooth
    expected = shares(np.gradient(known.positions[known.entry :]) * np.exp(BETA * moments))
    found = shares(_weights(known, moments, BETA, np.zeros(known.positions.size)))
    assert found == pytest.approx(np.array([expected] * 5), abs=1e-12)


@pytest.mark.parametrize("leg", [0, 3])
def test_the_moments_that_count_are_those_that_the_others_leave_at_their_best(smooth, leg):
    """Against a quasi-Newton method with bounds.

    The weights alone give the value of the dual problem, which is below that of any forces.
    """
    known, moments = smooth
    impulses = (STIFF - SOFT) / 2 * OTHERS_SPEED * np.gradient(known.positions) / SPEED
    forces = np.delete(known.damper_input, leg, axis=1)
    worth = np.hstack([impulses[k] * rows @ forces for k, rows in _backward(known)])
    widths = np.gradient(known.positions[known.entry :])

    def soft(pushes):
        exponents = np.log(widths) + BETA * (moments + worth @ pushes)
        slope = worth.T @ np.exp(exponents - logsumexp(exponents))
        return logsumexp(exponents) / BETA, slope

    start = np.zeros(worth.shape[1])
    best = minimize(soft, start, jac=True, bounds=[(-1, 1)] * start.size, tol=1e-14)
    assert best.fun < soft(start)[0] - 0.02  # of the static moment: it matters
    found = shares(_weights(known, moments, BETA, impulses))[leg]
    dual = found @ (moments + np.log(widths / found) / BETA) - np.abs(found @ worth).sum()
    assert best.fun - 1e-5 < dual < best.fun + 1e-9


@pytest.mark.slow
@pytest.mark.parametrize("iso_class", ["A", "B"])
def test_at_five_axles_it_lowers_the_mean_daf_at_every_speed(bridge, semitrailer, iso_class):
    """By more than at any one of them."""
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
