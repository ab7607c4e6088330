"""How sure a difference between strategies is, and whether an estimate orders them as simulation.

What is sampled are roads: differences are paired over them, and intervals come from drawing them
again.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from itertools import combinations
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from bridgectl import _checks as check
from bridgectl._checks import FloatArray

CONFIDENCE = 0.95

N_DRAWS, SEED = 500, 2006
"""How often the roads are drawn again, and the seed of that: the same study, the same interval."""


class Paired(NamedTuple):
    """A mean difference between two strategies over the same roads, made by `paired`."""

    mean: float
    """Mean over the roads, in the unit of the measure."""
    low: float
    """Lower end of its 95 % confidence interval (Student's t), in the unit of the measure."""
    high: float
    """Upper end, in the unit of the measure; NaN, as the lower one, for a single road."""

    def __repr__(self) -> str:
        return (
            f"Paired({self.mean:.4g}, {CONFIDENCE:.0%} between {self.low:.4g} and {self.high:.4g})"
        )

    @property
    def clear(self) -> bool:
        """Whether the interval leaves out 0."""
        return self.low > 0 or self.high < 0


def paired(differences: FloatArray) -> Paired:
    """Return the mean of differences (n_roads,) with its confidence interval (Student's t)."""
    from scipy.stats import t  # slow to load

    n, mean = len(differences), float(differences.mean())
    if n < 2:
        return Paired(mean, math.nan, math.nan)
    spread = float(differences.std(ddof=1)) / math.sqrt(n)
    reach = float(t.ppf((1 + CONFIDENCE) / 2, n - 1)) * spread
    return Paired(mean, mean - reach, mean + reach)


class GapClosed(NamedTuple):
    """How much of the way from one damper to the best one a strategy goes, made by `gap_closed`."""

    share: float
    """1 where it is as good as the best, 0 as the first [-]: a ratio of means over the roads.

    NaN where those two are too close.
    """
    low: float
    """Lower end of its 95 % interval, of roads drawn again."""
    high: float
    """Upper end of the 95 % interval; NaN, as the lower one, for a single road."""

    def __repr__(self) -> str:
        return (
            f"GapClosed({self.share:.3f}, {CONFIDENCE:.0%} from {self.low:.3f} to {self.high:.3f})"
        )


LEAST_GAP = 2e-3
"""Least difference of mean DAFs [-] of which shares mean something: optima are as sure as that."""


def gap_closed(first: FloatArray, own: FloatArray, best: FloatArray) -> GapClosed:
    """Return (first - own) / (first - best) of means over roads; all have shape (n_roads,)."""
    gains, gaps, n = first - own, first - best, len(first)
    if abs(gaps.mean()) < LEAST_GAP:
        return GapClosed(math.nan, math.nan, math.nan)
    share = float(gains.mean() / gaps.mean())
    if n < 2:
        return GapClosed(share, math.nan, math.nan)
    draws = _drawn_again(n)
    return GapClosed(share, *_ends(gains[draws].mean(axis=1) / gaps[draws].mean(axis=1)))


def _drawn_again(n: int) -> NDArray[np.intp]:
    """Roads drawn again from n, (N_DRAWS, n)."""
    return np.random.default_rng(SEED).integers(n, size=(N_DRAWS, n))


def _ends(values: Sequence[float] | FloatArray) -> tuple[float, float]:
    """Ends of the interval of what roads that are drawn again have, where it is known."""
    low, high = np.nanpercentile(values, [50 * (1 - CONFIDENCE), 50 * (1 + CONFIDENCE)])
    return float(low), float(high)


def rank_correlation(first: FloatArray, second: FloatArray) -> float:
    """Return Spearman's rank correlation; NaN where all values of one are the same."""
    from scipy.stats import spearmanr

    if np.ptp(first) == 0 or np.ptp(second) == 0:
        return math.nan
    return float(spearmanr(first, second).statistic)


class Agreement(NamedTuple):
    """Whether an estimate orders strategies as simulation does, made by `agreement`."""

    tau: float
    """Kendall's rank correlation: 1 in the same order, -1 reversed, 0 for none.

    NaN where all values are the same.
    """
    low: float
    """Lower end of its 95 % interval, of roads drawn again."""
    high: float
    """Upper end of the 95 % interval; NaN, as the lower one, for a single road."""

    def __repr__(self) -> str:
        ends = f"{CONFIDENCE:.0%} from {self.low:.2f} to {self.high:.2f}"
        return f"Agreement(tau {self.tau:.2f}, {ends})"


class Pairs(NamedTuple):
    """Pairs of strategies that an estimate has in the right order, found by `pairs_in_order`."""

    right: int
    """How many are in the right order."""
    number: int
    """How many there are."""

    @property
    def share(self) -> float:
        """Share of the right ones; NaN of none."""
        return self.right / self.number if self.number else math.nan


def over_roads(values: FloatArray, statistic: str = "mean") -> FloatArray:
    """Return the mean over roads and speeds of each strategy, (n_strategies,).

    Or the spread: the standard deviation over the roads, averaged over the speeds; of values of
    shape (n_strategies, n_roads, n_speeds).
    """
    check.choice("statistic", statistic, ("mean", "spread"))
    if statistic == "mean":
        return np.asarray(values.mean(axis=(1, 2)))
    if values.shape[1] < 2:
        return np.full(len(values), math.nan)
    return np.asarray(values.std(axis=1, ddof=1).mean(axis=1))


def agreement(estimate: FloatArray, simulated: FloatArray, statistic: str = "mean") -> Agreement:
    """Compare the order of strategies by an estimate with that by simulation.

    `simulated` has shape (n_strategies, n_roads, n_speeds), and so has `estimate`, or
    (n_strategies,) if there is nothing left to take a mean or spread of.
    """
    from scipy.stats import kendalltau

    def tau(roads: FloatArray | slice) -> float:
        first = over_roads(estimate[:, roads], statistic) if estimate.ndim == 3 else estimate
        second = over_roads(simulated[:, roads], statistic)
        if np.ptp(first) == 0 or np.ptp(second) == 0:
            return math.nan
        return float(kendalltau(first, second).statistic)

    whole, n = tau(slice(None)), simulated.shape[1]
    if n < 2 or math.isnan(whole):
        return Agreement(whole, math.nan, math.nan)
    return Agreement(whole, *_ends([tau(draw) for draw in _drawn_again(n)]))


def pairs_in_order(
    estimate: FloatArray, simulated: FloatArray, least: float | None = None
) -> Pairs:
    """Count the pairs of strategies that an estimate has in the order of the simulated means.

    The estimate has shape (n_strategies,), `simulated` (n_strategies, n_roads), the same roads for
    all. Pairs count whose means differ by more than `least`, or else with 95 % confidence, paired
    by road.
    """
    right = number = 0
    for i, j in combinations(range(len(simulated)), 2):
        difference = paired(simulated[i] - simulated[j])
        if difference.clear if least is None else abs(difference.mean) > least:
            number += 1
            right += bool(difference.mean * (estimate[i] - estimate[j]) > 0)
    return Pairs(right, number)
