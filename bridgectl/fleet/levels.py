"""What a return period asks of crossings: total and static effect, and the ratio of the two.

The assessment dynamic ratio (ADR) is the characteristic total effect over the characteristic static
one of the same return period, which are not of the same crossing: E. J. OBrien, P. Rattigan,
A. Gonzalez, J. Dowling, A. Znidaric, Engineering Structures 31 (2009) 1607-1612; C. C. Caprani,
A. Gonzalez, P. H. Rattigan, E. J. OBrien, Struct. Infrastruct. Eng. 8 (2012) 1053-1067.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property
from typing import Any, NamedTuple

import numpy as np

from bridgectl import _checks as check
from bridgectl._checks import FloatArray
from bridgectl._plausible import PlausibilityWarning
from bridgectl._warn import warn
from bridgectl.fleet.tails import (
    CONFIDENCE,
    DEGREES,
    METHODS,
    SEED,
    Estimate,
    Tail,
    block_maxima,
    mean_excess,
    peaks_over_threshold,
    same,
    usual_block,
)

N_PAIRS = 500
"""How often crossings are drawn again."""


class Characteristic(NamedTuple):
    """Characteristic effects, and the tails they are of; None where there is no fit."""

    total: Estimate
    static: Estimate
    total_fit: Tail | None
    static_fit: Tail | None

    def __repr__(self) -> str:
        return f"Characteristic(total={self.total}, static={self.static})"


class Rule(NamedTuple):
    """How a characteristic value is found."""

    method: str
    return_period: float
    crossings_a_day: float
    days_a_year: float
    block: int | None = None
    threshold: float | None = None
    sign: int = 1

    @property
    def crossings(self) -> float:
        """Crossings of the return period."""
        return self.return_period * self.days_a_year * self.crossings_a_day

    def years(self, crossings: Any) -> Any:
        """Return the years of so many crossings."""
        return crossings / (self.days_a_year * self.crossings_a_day)

    def checked(self) -> Rule:
        """Refuse what is no rule."""
        check.choice("method", self.method, METHODS)
        check.positive("return_period", self.return_period, unit="years")
        check.positive("trucks_a_day", self.crossings_a_day)
        check.positive("days_a_year", self.days_a_year)
        if self.days_a_year > 366:
            raise ValueError(f"days_a_year must be at most 366, got {self.days_a_year:g}")
        if self.block is not None:
            check.integer("block", self.block, at_least=2)
        if self.threshold is not None:
            check.number("threshold", self.threshold)
        if self.crossings <= 1:
            raise ValueError(
                f"return_period must have more than one crossing, and {self.return_period:g} years "
                f"have {self.crossings:.2g}: type return_period={2 * self.years(1):.2g} or more"
            )
        return self

    def reading(self, values: FloatArray) -> Reading:
        """Return what a return period asks of values by crossing."""
        if self.crossings <= len(values):
            return Reading(values, self.crossings)
        if self.method == METHODS[0]:
            block = self.block or usual_block(len(values), self.crossings_a_day)
            return Reading(values, self.crossings, block_maxima(values, block), block)
        return Reading(
            values, self.crossings, peaks_over_threshold(values, self.threshold, self.sign)
        )

    def warn_if_short(self, n: int) -> None:
        """Warn that a return period is shorter than what was simulated."""
        if self.crossings <= n:
            warn(
                f"return_period has {self.crossings:.0f} crossings, no more than the {n} that "
                "there are: the value is that of the crossings themselves, without a fit; one "
                f"beyond them is of more than {self.years(n):.3g} years",
                PlausibilityWarning,
            )


@dataclass(frozen=True, eq=False)
class Reading:
    """The value that one crossing in so many exceeds, by a tail or by the values themselves."""

    values: FloatArray
    crossings: float
    tail: Tail | None = None
    block: int | None = None

    @property
    def value(self) -> float:
        """The value."""
        if self.tail is not None:
            return float(self.tail.value(self.crossings))
        return self._ranked(self.values)

    @cached_property
    def estimate(self) -> Estimate:
        """The value with its interval."""
        if self.tail is not None:
            return self.tail.level(self.crossings)
        return quantile(self.values, 1 - 1 / self.crossings)

    @property
    def mean_excess(self) -> tuple[FloatArray, FloatArray, FloatArray]:
        """See `bridgectl.fleet.tails.mean_excess`."""
        return mean_excess(self.values)

    @cached_property
    def counting(self) -> FloatArray:
        """What of the values counts, in their order: peaks of blocks, or what is large enough."""
        if self.block is None:
            return self.values
        whole = self.values[: len(self.values) // self.block * self.block]
        return whole.reshape(-1, self.block).max(axis=1)

    @cached_property
    def least(self) -> float:
        """Values that are no larger do not count."""
        if self.tail is not None:
            return -math.inf if self.tail.of_blocks else self.tail.location
        rank = len(self.values) / self.crossings
        within = min(math.ceil(rank + 10 * math.sqrt(rank) + 20), len(self.values))
        return float(np.nextafter(np.partition(self.values, -within)[-within], -math.inf))

    def again(self, counting: FloatArray) -> float:
        """Return the value if these counted."""
        if self.tail is None:
            return self._ranked(counting)
        if self.tail.scale == 0:
            return self.value
        peaks = np.sort(counting[counting > self.least])
        return float(self.tail.fitted_to(peaks, self.tail.n).value(self.crossings))

    def _ranked(self, counting: FloatArray) -> float:
        """Value of the rank that one in so many has."""
        rank = (len(self.values) - 1) / self.crossings
        return float(np.interp(rank, np.arange(len(counting)), np.sort(counting)[::-1]))


def ratio(total: Reading, static: Reading) -> Estimate:
    """Return the ratio of the two, its interval of crossings (or blocks) drawn again in pairs.

    It is as wide as those of the two, see `DEGREES`, and holds less often than they do the ratio of
    1000 years of bounded static effects with unbounded, independent amplification: such a tail
    changes its shape beyond what was seen.
    """
    from scipy.stats import chi2

    value = total.value / static.value
    if same(total.values) and same(static.values):
        return Estimate(value, value, value)
    pairs = np.column_stack([total.counting, static.counting])
    n = len(pairs)
    pairs = pairs[(pairs[:, 0] > total.least) | (pairs[:, 1] > static.least)]
    rng, found = np.random.default_rng(SEED), []
    for _ in range(N_PAIRS):
        # Of those that count: the others only take their places in the sample.
        m = n if len(pairs) == n else rng.binomial(n, len(pairs) / n)
        drawn = pairs[rng.integers(len(pairs), size=m)]
        found.append(total.again(drawn[:, 0]) / static.again(drawn[:, 1]))
    confidence = chi2.cdf(chi2.ppf(CONFIDENCE, DEGREES), 1)
    ends = np.quantile(found, [(1 - confidence) / 2, (1 + confidence) / 2])
    return Estimate(value, *map(float, ends))


def quantile(values: FloatArray, share: float) -> Estimate:
    """Return the value that a share stays below, with its interval whatever the distribution.

    The interval's ends are values themselves, by the binomial distribution of how many stay below
    (W. J. Conover, Practical Nonparametric Statistics, Wiley 1999, section 3.2); NaN where there
    are too few.
    """
    from scipy.stats import quantile_test

    value = float(np.quantile(values, share))
    ends = quantile_test(values, q=value, p=share).confidence_interval(CONFIDENCE)
    return Estimate(value, float(ends.low), float(ends.high))
