"""Traffic with and without dampers, differences by truck, and DAF by static effect."""

from __future__ import annotations

import math
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from bridgectl import _checks as check
from bridgectl._checks import FloatArray
from bridgectl.fleet.tails import CONFIDENCE, Estimate, same

GOLDEN = (math.sqrt(5) - 1) / 2
"""Multiples of it, less their whole part, fill 0 to 1 evenly: which trucks have dampers first."""

Rows = NDArray[Any]


class DafBins(NamedTuple):
    """DAF by static effect: of bins (n,) that hold a crossing."""

    low: FloatArray
    """Lower edges, in the unit of the effect."""
    high: FloatArray
    """Upper edges."""
    crossings: NDArray[np.integer[Any]]
    """Number of crossings."""
    mean: FloatArray
    """Mean DAF."""
    quantiles: FloatArray
    """DAF that 5, 50 and 95 % stay below, (3, n)."""


def bins_of(static: FloatArray, daf: FloatArray, n_bins: int) -> DafBins:
    """Return DAF in bins of one width of static effect."""
    edges = np.linspace(static.min(), static.max(), n_bins + 1)
    place = np.clip(np.searchsorted(edges, static, "right") - 1, 0, n_bins - 1)
    there = np.unique(place)
    parts = [daf[place == i] for i in there]
    return DafBins(
        edges[there], edges[there + 1], np.array([len(part) for part in parts]),
        np.array([part.mean() for part in parts]),
        np.transpose([np.quantile(part, (0.05, 0.5, 0.95)) for part in parts]),
    )  # fmt: skip


def traffic(truck: Rows, damped: NDArray[np.bool_], damper_share: float | None) -> Rows:
    """Tell which rows are those of traffic in which a share of the trucks has dampers.

    Trucks of both kinds of rows count once, and the same ones come first in every share.
    """
    having, lacking = np.unique(truck[damped]), np.unique(truck[~damped])
    both = np.intersect1d(having, lacking, assume_unique=True)
    n, n_must = len(having) + len(lacking) - len(both), len(having) - len(both)
    n_more = 0
    if damper_share is not None:
        n_more = round(check.not_negative("damper_share", damper_share) * n) - n_must
        if not 0 <= n_more <= len(both):
            raise ValueError(
                f"damper_share must lie between {n_must / n:.3g} and {len(having) / n:.3g}, the "
                f"trucks that were simulated with dampers, got {damper_share:g}"
            )
    first = both[np.argsort(both * GOLDEN % 1, kind="stable")[:n_more]]
    with_them = np.isin(truck, np.setdiff1d(having, lacking)) | np.isin(truck, first)
    return np.asarray(damped == with_them)


def means_by_truck(truck: Rows, values: FloatArray) -> tuple[Rows, FloatArray]:
    """Return trucks in order, and the mean of each one's crossings."""
    trucks, place = np.unique(truck, return_inverse=True)
    return trucks, np.bincount(place, values) / np.bincount(place)


def mean_of(first: tuple[Rows, FloatArray], other: tuple[Rows, FloatArray]) -> Estimate:
    """Return the mean of other less first, over the trucks of both, with its interval."""
    from scipy.stats import t

    _, i, j = np.intersect1d(first[0], other[0], assume_unique=True, return_indices=True)
    difference = other[1][j] - first[1][i]
    n = len(difference)
    if n == 0:
        return Estimate(math.nan, math.nan, math.nan)
    mean = float(difference.mean())
    if n < 2 or same(difference):
        end = (mean,) * 2 if n > 1 else (math.nan,) * 2
        return Estimate(mean, *end)
    error = difference.std(ddof=1) / math.sqrt(n)
    return Estimate(mean, *map(float, t.interval(CONFIDENCE, n - 1, mean, error)))
