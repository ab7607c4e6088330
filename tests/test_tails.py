"""Extreme values of samples whose distribution is known."""

import math

import numpy as np
import pytest
from scipy import stats

from bridgectl.fleet import levels, tails
from bridgectl.fleet.levels import Rule, quantile, ratio
from bridgectl.fleet.tails import (
    METHODS,
    block_maxima,
    mean_excess,
    peaks_over_threshold,
    usual_block,
    usual_exceedances,
)

THOUSAND_YEARS = 1000 * 250 * 1000
"""Crossings of 1000 years of 250 days with 1000 trucks each."""

PARENTS = {
    "exponential": stats.expon(),
    "Gumbel": stats.gumbel_r(10, 2),
    "Weibull": stats.weibull_min(2, scale=300.0),
    "bounded Pareto": stats.genpareto(-0.2, 5.0, 2.0),
}


THRESHOLD_FIRST = [METHODS[1], pytest.param(METHODS[0], marks=pytest.mark.slow)]


def sample(parent, n, seed):
    return parent.rvs(n, random_state=np.random.default_rng(seed))


def fitted(method, values):
    if method == METHODS[0]:
        return block_maxima(values, usual_block(len(values), 1000))
    return peaks_over_threshold(values)


@pytest.mark.slow
@pytest.mark.parametrize("parent", PARENTS)
@pytest.mark.parametrize("method", METHODS)
def test_known_distributions_are_recovered_within_their_intervals(method, parent):
    """At least 95 of 100 samples of 10 000 crossings, whose data are of 10 days, for 1000 years."""
    known = PARENTS[parent].isf(1 / THOUSAND_YEARS)
    levels = [
        fitted(method, sample(PARENTS[parent], 10_000, seed)).level(THOUSAND_YEARS)
        for seed in range(100)
    ]
    assert sum(level.low <= known <= level.high for level in levels) >= 95


@pytest.mark.parametrize("method", METHODS)
def test_a_million_crossings_tell_the_shape_and_the_level(method):
    """Of a Pareto distribution with shape -0.2 and its largest value at 15."""
    parent = PARENTS["bounded Pareto"]
    tail = fitted(method, sample(parent, 1_000_000, 1))
    assert tail.shape == pytest.approx(-0.2, abs=0.08)
    level = tail.level(THOUSAND_YEARS)
    known = parent.isf(1 / THOUSAND_YEARS)
    assert level.low < known < level.high
    assert level.value == pytest.approx(known, abs=0.4)


@pytest.mark.parametrize("shape", [-0.3, 0.0, 0.2])
def test_fits_are_as_likely_as_those_of_scipy(shape):
    """Which start from the answer; their likelihoods differ by less than 1e-6."""
    values = sample(stats.genpareto(shape, 100.0, 20.0), 20_000, 3)
    tail = peaks_over_threshold(values)
    own = tail.distribution.args
    c, _, scale = stats.genpareto.fit(tail.peaks, own[0], floc=tail.location, scale=own[2])
    assert stats.genpareto.nnlf(own, tail.peaks) == pytest.approx(
        stats.genpareto.nnlf((c, tail.location, scale), tail.peaks), abs=1e-6
    )
    assert (tail.shape, tail.scale) == pytest.approx((c, scale), rel=1e-2, abs=1e-3)
    blocks = block_maxima(values, 200)
    own = blocks.distribution.args
    best = stats.genextreme.fit(blocks.peaks, own[0], loc=own[1], scale=own[2])
    assert stats.genextreme.nnlf(own, blocks.peaks) == pytest.approx(
        stats.genextreme.nnlf(best, blocks.peaks), abs=1e-6
    )
    assert -blocks.shape == own[0]


def test_the_start_by_l_moments_is_near_the_parameters():
    peaks = np.sort(sample(stats.genextreme(0.15, 50.0, 4.0), 50_000, 5))
    assert tails._by_l_moments(peaks, None) == pytest.approx((50.0, 4.0, -0.15), rel=0.01, abs=0.01)
    peaks = np.sort(sample(stats.genpareto(0.1, 7.0, 2.0), 50_000, 5))
    assert tails._by_l_moments(peaks, 7.0) == pytest.approx((7.0, 2.0, 0.1), rel=0.05, abs=0.01)


def test_a_start_that_is_impossible_is_not_kept():
    """L-moments may put the end of a distribution below the largest value."""
    peaks = np.concatenate([np.linspace(1, 2, 60), [2.9]])
    tail = peaks_over_threshold(np.concatenate([np.zeros(10), peaks]), 0.9)
    assert tail.distribution.sf(2.9) > 0
    assert math.isfinite(tail.distribution.logpdf(tail.peaks).sum())


@pytest.mark.parametrize("method", METHODS)
def test_both_methods_ask_for_the_value_that_one_crossing_in_so_many_exceeds(method):
    tail = fitted(method, sample(PARENTS["exponential"], 100_000, 7))
    for crossings in (5e3, 1e6, THOUSAND_YEARS):
        level = tail.value(crossings)
        exceeded = tail.distribution.sf(level) / tail.share
        if method == METHODS[0]:
            exceeded = 1 - tail.distribution.cdf(level) ** (1 / tail.share)
        assert exceeded == pytest.approx(1 / crossings, rel=1e-6)


@pytest.mark.parametrize("method", METHODS)
def test_the_scale_of_the_values_does_not_matter(method):
    """Newton metres or meganewton metres."""
    values = sample(PARENTS["Weibull"], 10_000, 2)
    one, other = (fitted(method, size * values).level(1e7) for size in (1.0, 1e6))
    assert np.array(other) / 1e6 == pytest.approx(np.array(one), rel=1e-4)


@pytest.mark.parametrize("method", THRESHOLD_FIRST)
def test_ends_of_the_interval_are_where_the_likelihood_has_fallen(method):
    """By half the 95 % point of a chi-square of two degrees of freedom, 2.996."""
    tail = fitted(method, sample(PARENTS["Gumbel"], 10_000, 4))
    level, w = tail.level(1e6), float(tail.reduced(1e6))

    def cost(p, end):
        """Of scale and shape, and a location that gives the level its value."""
        location = tail.location
        scale = math.exp(p[0])
        growth = float(np.expm1(p[1] * w) / p[1])
        if method == METHODS[0]:
            location = end - scale * growth
            return stats.genextreme.nnlf((-p[1], location, scale), tail.peaks)
        return stats.genpareto.nnlf((p[1], location, (end - location) / growth), tail.peaks)

    best = -tail.distribution.logpdf(tail.peaks).sum()
    for end in level[1:]:
        grid = [
            cost((math.log(scale), shape), end)
            for shape in np.linspace(-0.4, 0.5, 181) + 1e-7
            for scale in (tail.scale * np.geomspace(0.6, 1.7, 60) if method == METHODS[0] else [1])
        ]
        assert min(grid) - best == pytest.approx(stats.chi2.ppf(0.95, 2) / 2, abs=0.03)


@pytest.mark.parametrize("method", METHODS)
def test_values_that_are_all_the_same_are_their_own_extreme(method):
    tail = fitted(method, np.full(10, 7.25e5))
    assert tail.level(THOUSAND_YEARS) == (7.25e5, 7.25e5, 7.25e5)


def test_the_most_usual_value_may_be_the_largest():
    """Of two kinds of trucks each of one weight, the heavier ones are the extreme."""
    values = np.repeat([1.0, 2.0], 500)
    assert peaks_over_threshold(values).level(1e6) == (2.0, 2.0, 2.0)
    assert peaks_over_threshold(values, 1.5).level(1e6) == (2.0, 2.0, 2.0)
    mixed = np.random.default_rng(0).permutation(values)
    assert block_maxima(mixed, 20).level(1e6) == (2.0, 2.0, 2.0)


def test_too_few_exceedances_are_told_with_a_threshold_that_would_do():
    values = np.arange(1000.0)
    says = "threshold must be exceeded by at least 30 crossings, and 990 is by 9 of 1000: type"
    with pytest.raises(ValueError, match=says + " threshold=969$"):
        peaks_over_threshold(values, 990.0)
    assert len(peaks_over_threshold(values, 969.0).peaks) == 30
    with pytest.raises(ValueError, match=r"is by 0 of 20: simulate more crossings than 20$"):
        peaks_over_threshold(np.arange(20.0), 30.0)


def test_a_threshold_that_is_told_does_where_values_are_the_same():
    values = np.concatenate([np.arange(100.0), np.full(40, 200.0), [300.0]])
    with pytest.raises(ValueError, match=r"by 1 of 141: type threshold=99$"):
        peaks_over_threshold(values, 250.0)
    assert len(peaks_over_threshold(values, 99.0).peaks) == 41


def test_too_few_blocks_are_told_with_a_block_that_would_do():
    with pytest.raises(ValueError, match=r"at least 30 blocks, and 1000 .* have 10 of 100: type"):
        block_maxima(np.arange(1000.0), 100)
    assert len(block_maxima(np.arange(1000.0), 33).peaks) == 30
    with pytest.raises(ValueError, match=r"simulate more crossings than 40$"):
        block_maxima(np.arange(40.0), 20)


def test_blocks_are_days_if_there_are_enough_of_them():
    assert usual_block(1_000_000, 1000.4) == 1000
    assert usual_block(10_000, 1000) == 200
    assert usual_block(3, 1000) == 1


def test_the_usual_tail_is_a_small_part_of_many_crossings():
    assert [usual_exceedances(n) for n in (10, 1000, 10_000, 1_000_000)] == [30, 52, 209, 3808]


@pytest.mark.quick_cases(1)
@pytest.mark.parametrize("method", THRESHOLD_FIRST)
def test_a_fit_of_the_right_kind_is_seldom_found_far_off(method):
    """p values of right fits are spread from 0 to 1."""
    seen = [fitted(method, sample(PARENTS["bounded Pareto"], 2000, seed)).p_value()
            for seed in range(4)]  # fmt: skip
    assert min(seen) > 0.005
    assert max(seen) > 0.3


def test_the_distance_of_a_fit_is_that_of_anderson_and_darling():
    """As scipy has it where the distribution is known: 1e-9 of it."""
    peaks = np.sort(sample(stats.genpareto(0.1, 3.0, 2.0), 200, 1))
    for tail in (tails.Tail(METHODS[1], 3.0, 2.0, 0.1, peaks, 1000),
                 tails.Tail(METHODS[0], 5.0, 2.0, 0.1, peaks, 1000)):  # fmt: skip
        below, above = tail.distribution.logcdf(peaks), tail.distribution.logsf(peaks)[::-1]
        known = -200 - np.mean((2 * np.arange(200) + 1) * (below + above))
        assert tails._distance(tail) == pytest.approx(known, rel=1e-9)


def test_a_mixture_is_found_far_off():
    """Trucks of two weights with nothing between them are no single tail."""
    rng = np.random.default_rng(0)
    values = np.concatenate([rng.normal(100, 2, 900), rng.normal(200, 1, 100)])
    assert peaks_over_threshold(values, 101.0).p_value() < 0.01


def test_quantiles_and_periods_are_beside_the_peaks():
    """Of a sample as it should be, on the fit: within 2 % of the largest."""
    parent = stats.genpareto(-0.1, 0.0, 1.0)
    values = parent.ppf((np.arange(20_000) + 0.5) / 20_000)
    tail = peaks_over_threshold(values)
    assert tail.quantiles() == pytest.approx(tail.peaks, abs=0.02 * values.max())
    assert tail.value(tail.periods()) == pytest.approx(tail.quantiles(), rel=1e-6)
    blocks = block_maxima(sample(parent, 20_000, 1), 100)
    assert blocks.value(blocks.periods()) == pytest.approx(blocks.quantiles(), rel=1e-6)


def test_mean_excesses_of_an_exponential_distribution_are_its_mean():
    thresholds, means, errors = mean_excess(sample(stats.expon(scale=3.0), 100_000, 8))
    assert np.all(np.abs(means - 3.0) < 4 * errors)
    assert np.all(np.diff(thresholds) > 0)


def test_quantiles_of_crossings_have_intervals_of_ranks():
    """95 % of them hold the value, whatever the distribution: of 200 samples 91 to 99 %."""
    parent = stats.lognorm(0.5)
    hits = 0
    for seed in range(200):
        found = quantile(sample(parent, 400, seed), 0.9)
        hits += found.low <= parent.ppf(0.9) <= found.high
    assert 0.91 * 200 <= hits <= 0.99 * 200
    few = quantile(np.arange(10.0), 0.99)
    assert math.isnan(few.high)


@pytest.mark.parametrize("method", METHODS)
def test_the_ratio_of_a_multiple_is_the_multiple(method, monkeypatch):
    """Total effects 1.2 times the static ones: within 0.001, the accuracy of the fits."""
    monkeypatch.setattr(levels, "N_PAIRS", 50)  # in every sample drawn again the ratio is the same
    static = sample(PARENTS["Weibull"], 10_000, 6)
    rule = Rule(method, 1000.0, 1000.0, 250.0)
    found = ratio(rule.reading(1.2 * static), rule.reading(static))
    assert np.array(found) == pytest.approx(1.2, abs=1e-3)


def test_the_ratio_of_short_periods_is_that_of_the_ranks():
    rng = np.random.default_rng(1)
    static = rng.exponential(1.0, 5000)
    total = static * rng.uniform(1.0, 1.3, 5000)
    rule = Rule(METHODS[1], 1e-3, 1000.0, 250.0)  # 250 crossings
    found = ratio(rule.reading(total), rule.reading(static))
    share = 1 - 1 / 250
    assert found.value == pytest.approx(np.quantile(total, share) / np.quantile(static, share))
    assert found.low < found.value < found.high
