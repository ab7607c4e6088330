"""How an estimate orders strategies beside simulation."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.stats import kendalltau

from bridgectl.scoring.agreement import (
    Agreement,
    Pairs,
    agreement,
    over_roads,
    paired,
    pairs_in_order,
)

RNG = np.random.default_rng(1)
SIMULATED = RNG.normal(size=(6, 1, 1)) + 0.2 * RNG.normal(size=(6, 9, 4))


def test_tau_is_kendalls_of_the_means():
    estimate = RNG.normal(size=6)
    expected = kendalltau(estimate, SIMULATED.mean(axis=(1, 2))).statistic
    assert agreement(estimate, SIMULATED).tau == pytest.approx(expected)
    of_roads = agreement(SIMULATED + 0.3 * RNG.normal(size=(6, 1, 1)), SIMULATED)
    assert -1 <= of_roads.low <= of_roads.high <= 1


def test_the_spread_is_compared_where_it_is_asked_for():
    sd = SIMULATED.std(axis=1, ddof=1).mean(axis=1)
    assert over_roads(SIMULATED, "spread") == pytest.approx(sd)
    assert agreement(sd, SIMULATED, "spread").tau == pytest.approx(1)
    assert agreement(-sd, SIMULATED, "spread").tau == pytest.approx(-1)


@pytest.mark.slow
def test_the_interval_holds_tau_as_often_as_it_says():
    """Of 40 samples of 12 roads, the intervals of at least 32 hold the tau of all roads.

    Percentiles of few roads drawn again are known to be narrow: 19 of 20 are not reached.
    """
    rng = np.random.default_rng(3)
    level, estimate = np.linspace(0, 0.3, 8), np.linspace(0, 1, 8) + 0.2 * rng.normal(size=8)
    true = kendalltau(estimate, level).statistic
    inside = 0
    for _ in range(40):
        found = agreement(estimate, level[:, None, None] + 0.2 * rng.normal(size=(8, 12, 1)))
        inside += found.low <= true <= found.high
    assert inside >= 32


def test_one_road_has_no_interval_and_equal_values_no_order():
    single = agreement(np.arange(6.0), SIMULATED[:, :1])
    assert np.isnan([single.low, single.high]).all()
    assert not np.isnan(single.tau)
    assert np.isnan(agreement(np.ones(6), SIMULATED)).all()
    assert repr(Agreement(0.5, 0.25, 0.75)) == "Agreement(tau 0.50, 95% from 0.25 to 0.75)"


@settings(deadline=None, max_examples=30)
@given(seed=st.integers(0, 10_000))
def test_pairs_are_counted_one_by_one(seed):
    rng = np.random.default_rng(seed)
    per_road, estimate = rng.normal(size=(5, 7)) + rng.normal(size=(5, 1)), rng.normal(size=5)
    right = clear = far = right_far = 0
    for i in range(5):
        for j in range(i):
            found = paired(per_road[i] - per_road[j])
            same = np.sign(found.mean) == np.sign(estimate[i] - estimate[j])
            clear, right = clear + found.clear, right + (found.clear and same)
            if abs(per_road[i].mean() - per_road[j].mean()) > 0.5:
                far, right_far = far + 1, right_far + same
    assert pairs_in_order(estimate, per_road) == (right, clear)
    assert pairs_in_order(estimate, per_road, least=0.5) == (right_far, far)


def test_a_share_is_of_all_pairs_and_nan_of_none():
    assert Pairs(3, 4).share == 0.75
    assert np.isnan(Pairs(0, 0).share)
    assert over_roads(SIMULATED) == pytest.approx(SIMULATED.mean(axis=(1, 2)))
