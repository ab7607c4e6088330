"""Extreme values of many crossings: the effect that is exceeded once in a return period.

Either the largest effects of blocks of crossings follow a generalized extreme value distribution,
or what exceeds a high threshold a generalized Pareto distribution (S. Coles, An Introduction to
Statistical Modeling of Extreme Values, Springer 2001, chapters 3 and 4). Both have a shape xi,
as Coles has it: below zero if there is a largest possible value. (`scipy.stats.genextreme` has
c = -xi.) Both tell the same: the value that one crossing in N exceeds, N being the crossings of
the return period.

Intervals are those of the profile likelihood (Coles, sections 3.3.4 and 4.3.3), whose ends lie as
unevenly about the value as the data have it. They are of scale and shape together, that is of all
return periods at once, and so hold as well of values that reach their limit slowly: see `DEGREES`.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from typing import Any, NamedTuple

import numpy as np

from bridgectl._checks import FloatArray

METHODS = ("block maxima", "peaks over threshold")

CONFIDENCE = 0.95
"""Of every interval."""

DEGREES = 2
"""Of freedom of the chi-square that a profile may fall by.

Of 100 samples of 10 000 crossings of exponential, Gumbel, Weibull and Pareto parents, intervals of
one crossing in 2.5e8 held the value in 95 and more; those of one degree hold it less often.
"""

DAYS_A_YEAR = 250.0
"""Working days, on which trucks drive: as C. C. Caprani's simulations of traffic count them."""

LEAST = 30
"""Blocks or exceedances that a fit needs."""

N_BLOCKS = 50
"""Blocks where the crossings do not fill as many days."""

SHAPES = (-1.0, 1.0)
"""Shapes that are looked among: likelihoods of smaller ones have no maximum."""

TINY, SAME = 1e-9, 1e-12
"""Shapes that are none; values, over the largest, that differ by rounding alone."""

FAR = 1e9
"""A cost that nothing reaches."""

N_DRAWS, SEED = 200, 2009
"""How often samples are drawn for a p-value, and the seed of that."""


class Estimate(NamedTuple):
    """A value with its 95 % interval."""

    value: float
    low: float
    high: float

    def __repr__(self) -> str:
        ends = f"{CONFIDENCE:.0%} between {self.low:.4g} and {self.high:.4g}"
        return f"Estimate({self.value:.4g}, {ends})"

    def times(self, sign: int) -> Estimate:
        """Return it with a sign, 1 or -1."""
        return self if sign > 0 else Estimate(-self.value, -self.high, -self.low)


@dataclass(frozen=True, eq=False)
class Tail:
    """A fitted tail: `peaks` (m,) in rising order are block maxima, or what exceeds `location`."""

    method: str
    location: float
    scale: float
    shape: float
    peaks: FloatArray
    n: int
    """Crossings, of which each peak stands for `n / m`."""

    @property
    def share(self) -> float:
        """Crossings for each peak."""
        return self.n / len(self.peaks)

    @property
    def of_blocks(self) -> bool:
        """Whether peaks are block maxima."""
        return self.method == METHODS[0]

    @cached_property
    def distribution(self) -> Any:
        """What `scipy.stats` has for the peaks."""
        from scipy import stats  # slow to load

        if self.of_blocks:
            return stats.genextreme(-self.shape, self.location, self.scale)
        return stats.genpareto(self.shape, self.location, self.scale)

    def reduced(self, crossings: Any) -> Any:
        """Reduced variate of what one crossing in so many exceeds: log(N / share) of many."""
        if self.of_blocks:
            return -np.log(-self.share * np.log1p(-1 / np.asarray(crossings)))
        return np.log(crossings / self.share)

    def value(self, crossings: Any) -> Any:
        """Return what one crossing in so many exceeds."""
        return self.location + self.scale * _growth(self.reduced(crossings), self.shape)

    def level(self, crossings: float) -> Estimate:
        """Return what one crossing in so many exceeds, with its interval."""
        value = float(self.value(crossings))
        if self.scale == 0:
            return Estimate(value, value, value)
        return Estimate(value, *_profile_ends(self, float(self.reduced(crossings))))

    def quantiles(self) -> FloatArray:
        """Quantiles of the fit beside `peaks`."""
        m = len(self.peaks)
        return np.asarray(self.distribution.ppf((np.arange(m) + 0.5) / m))

    def periods(self) -> FloatArray:
        """Crossings one of which exceeds each of `peaks`, by their ranks."""
        m = len(self.peaks)
        below = (np.arange(m) + 0.5) / m
        if self.of_blocks:
            return -1 / np.expm1(np.log(below) / self.share)
        return self.share / (1 - below)

    def p_value(self) -> float:
        """Return how often a sample of the fit, fitted, lies as far off (Anderson-Darling)."""
        rng, m = np.random.default_rng(SEED), len(self.peaks)
        drawn = [np.sort(self.distribution.rvs(m, random_state=rng)) for _ in range(N_DRAWS)]
        beyond = sum(_distance(self.fitted_to(own, self.n)) >= _distance(self) for own in drawn)
        return (beyond + 1) / (N_DRAWS + 1)

    def fitted_to(self, peaks: FloatArray, n: int) -> Tail:
        """Return the tail of other peaks, in rising order, of the same blocks or threshold."""
        return _fit(self.method, peaks, n, None if self.of_blocks else self.location)


def _distance(tail: Tail) -> float:
    """Anderson and Darling's A^2 of the fit."""
    m = len(tail.peaks)
    y = _inverse_growth((tail.peaks - tail.location) / tail.scale, tail.shape)
    above = np.log(-np.expm1(-np.exp(-y))) if tail.of_blocks else -y
    below = -np.exp(-y) if tail.of_blocks else np.log(-np.expm1(-y))
    return float(-m - (2 * np.arange(m) + 1) @ (below + above[::-1]) / m)


def block_maxima(values: FloatArray, block: int) -> Tail:
    """Return the tail of the largest values of blocks (a last part of one is left out)."""
    n, m = len(values), len(values) // block
    if same(values):
        return Tail(METHODS[0], float(values[0]), 0.0, 0.0, values[:1], n)
    if m < LEAST:
        raise ValueError(
            f"block must leave at least {LEAST} blocks, and {n} crossings have {m} of {block}: "
            + (f"type block={n // LEAST}" if n // LEAST > 1 else _more(n))
        )
    peaks = np.sort(values[: m * block].reshape(m, block).max(axis=1))
    return _fit(METHODS[0], peaks, m * block)


def mean_excess(values: FloatArray, n: int = 40) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Return thresholds, mean excesses and their standard errors: a straight line of a tail.

    Thresholds from the median to what ten values exceed.
    """
    ranked = np.sort(values)
    thresholds = np.linspace(np.median(ranked), ranked[-min(11, len(ranked))], n)
    counts = len(ranked) - np.searchsorted(ranked, thresholds, "right")
    thresholds, counts = thresholds[counts > 1], counts[counts > 1]
    parts = [ranked[-count:] - u for u, count in zip(thresholds, counts, strict=True)]
    errors = [part.std() / math.sqrt(len(part)) for part in parts]
    return thresholds, np.array([part.mean() for part in parts]), np.array(errors)


def usual_block(n: int, crossings_a_day: float) -> int:
    """Return the crossings of a day; fewer, if so there would be fewer than `N_BLOCKS` blocks."""
    return max(min(round(crossings_a_day), n // N_BLOCKS), 1)


def peaks_over_threshold(values: FloatArray, threshold: float | None = None, sign: int = 1) -> Tail:
    """Return the tail of the values above a threshold; left out: see `usual_exceedances`.

    The values are a user's own, and so the threshold, times the sign.
    """
    ranked, n = np.sort(values), len(values)
    if threshold is None:
        threshold = ranked[-min(usual_exceedances(n) + 1, n)]
    peaks = ranked[np.searchsorted(ranked, threshold, "right") :]
    if same(ranked) or (len(peaks) == 0 and threshold == ranked[-1]):
        # So often is the largest value met.
        return Tail(METHODS[1], float(ranked[-1]), 0.0, 0.0, ranked[-1:], n)
    if len(peaks) < LEAST:
        below = ranked[ranked < ranked[-min(LEAST, n)]]
        raise ValueError(
            f"threshold must be exceeded by at least {LEAST} crossings, and {sign * threshold:g} "
            f"is by {len(peaks)} of {n}: "
            + (f"type threshold={sign * below[-1]:.10g}" if len(below) else _more(n))
        )
    return _fit(METHODS[1], peaks, n, float(threshold))


def usual_exceedances(n: int) -> int:
    """Return how many of n values are taken for the tail: n^(2/3) / log(log n).

    One of the rules in C. Scarrott, A. MacDonald, REVSTAT 10 (2012) 33-60.
    """
    return max(round(n ** (2 / 3) / math.log(math.log(max(n, 16)))), LEAST)


def same(values: FloatArray) -> bool:
    """Tell whether values differ by rounding alone."""
    return bool(np.ptp(values) <= SAME * np.abs(values).max())


def _more(n: int) -> str:
    return f"simulate more crossings than {n}"


def _fit(method: str, peaks: FloatArray, n: int, threshold: float | None = None) -> Tail:
    """Fit the distribution by maximum likelihood, from where L-moments are."""
    if same(peaks):
        return Tail(method, float(peaks[-1]), 0.0, 0.0, peaks, n)
    location, scale, shape = _by_l_moments(peaks, threshold)

    def cost(x: FloatArray) -> float:
        there = location + scale * x[2] if threshold is None else threshold
        return _cost((peaks - there) / scale, math.exp(x[0]), x[1], threshold is None)

    start = [0.0, shape, 0.0][: 3 if threshold is None else 2]
    if not math.isfinite(cost(np.array(start))):
        start[1] = 0.1  # of which nothing is too large
    x = _least(cost, start)
    if threshold is None:
        location += scale * float(x[2])
    return Tail(method, location, scale * math.exp(x[0]), float(x[1]), peaks, n)


def _by_l_moments(peaks: FloatArray, threshold: float | None) -> tuple[float, float, float]:
    """Location, scale and shape by L-moments of values in rising order.

    J. R. M. Hosking, J. Royal Statistical Society B 52 (1990) 105-124.
    """
    m = len(peaks)
    rank = np.arange(m)
    b0, b1 = peaks.mean(), peaks @ rank / (m * (m - 1))
    b2 = peaks @ (rank * (rank - 1)) / (m * (m - 1) * (m - 2))
    second, third = 2 * b1 - b0, 6 * b2 - 6 * b1 + b0
    if threshold is not None:
        shape = 2 - (b0 - threshold) / second
        return threshold, (b0 - threshold) * (1 - shape), float(np.clip(shape, -0.9, 0.9))
    c = 2 / (3 + third / second) - math.log(2) / math.log(3)
    k = float(np.clip(7.8590 * c + 2.9554 * c * c, -0.9, 0.9)) or 1e-9
    gamma = math.gamma(1 + k)
    scale = second * k / ((1 - 2.0**-k) * gamma)
    return float(b0 - scale * (1 - gamma) / k), float(scale), -k


def _cost(x: FloatArray, scale: float, shape: float, of_blocks: bool) -> float:
    """Negative logarithm of the likelihood of values beyond the location."""
    if not SHAPES[0] <= shape <= SHAPES[1]:
        return math.inf
    z = x / scale
    if min(z[0], z[-1]) * shape <= -1 or z[-1] * shape <= -1:
        return math.inf
    y = _inverse_growth(z, shape)
    cost = len(x) * math.log(scale) + (1 + shape) * float(y.sum())
    return cost + float(np.exp(-y).sum()) if of_blocks else cost


def _growth(w: Any, shape: float) -> Any:
    """Value over the scale, at a reduced variate: (e^(xi w) - 1) / xi."""
    return w * (1 + shape * w / 2) if abs(shape) < TINY else np.expm1(shape * w) / shape


def _inverse_growth(z: FloatArray, shape: float) -> FloatArray:
    return z * (1 - shape * z / 2) if abs(shape) < TINY else np.log1p(shape * z) / shape


def _least(cost: Callable[[FloatArray], float], start: Any, step: float = 0.2) -> FloatArray:
    """Where a cost is least, by a simplex: it need not be finite everywhere."""
    from scipy.optimize import minimize  # slow to load

    simplex = np.vstack([start, start + step * np.eye(len(start))])
    options = {"initial_simplex": simplex, "xatol": 1e-5, "fatol": 1e-8}
    # Differences of what is infinite would not be numbers.
    found = minimize(lambda x: min(cost(x), FAR), simplex[0], method="Nelder-Mead", options=options)
    return found.x


def _profile_ends(tail: Tail, w: float) -> tuple[float, float]:
    """Ends of the values, at a reduced variate, that the data do not speak against."""
    from scipy.optimize import brentq
    from scipy.stats import chi2

    x = (tail.peaks - tail.location) / tail.scale
    best = _cost(x, 1.0, tail.shape, tail.of_blocks)
    reach = float(chi2.ppf(CONFIDENCE, DEGREES)) / 2
    at = float(_growth(w, tail.shape))
    profile = _profile(x, w, tail)

    def beyond(value: float) -> float:
        return min(profile(value) - best, FAR) - reach

    ends = []
    for sign in (-1, 1):
        inner, step = at, 0.1 * max(abs(at), 1.0)
        outer = inner + sign * step
        while beyond(outer) < 0:
            inner, step = outer, 1.5 * step
            outer += sign * step
        ends.append(tail.location + tail.scale * brentq(beyond, inner, outer, rtol=1e-6))
    return ends[0], ends[1]


def _profile(x: FloatArray, w: float, tail: Tail) -> Callable[[float], float]:
    """Return the least cost if the value at a reduced variate is given.

    Over scale and location, in which it is well conditioned; they leave one shape.
    """
    # Where it is least beside values that were asked for: the next one is near.
    start: FloatArray = np.zeros(2 if tail.of_blocks else 1)
    found = {float(_growth(w, tail.shape)): start}

    def least(value: float) -> float:
        def cost(p: FloatArray) -> float:
            location, scale = float(p[1:].sum()), math.exp(p[0])
            shape = _shape((value - location) / scale, w)
            return _cost(x - location, scale, shape, tail.of_blocks)

        nearest = min(found, key=lambda other: abs(other - value))
        p = _least(cost, found[nearest])
        if math.isfinite(result := cost(p)):
            found[value] = p
        return result

    return least


def _shape(growth: float, w: float) -> float:
    """Shape of which values grow so much up to a reduced variate; infinite if there is none."""
    from scipy.optimize import brentq

    def more(shape: float) -> float:
        return float(_growth(w, shape)) - growth

    if more(SHAPES[0]) > 0 or more(SHAPES[1]) < 0:
        return math.inf
    return float(brentq(more, *SHAPES))
