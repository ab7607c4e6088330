"""The dynamic amplification estimate over a class of random roads."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike
from scipy.linalg import matmul_toeplitz
from scipy.stats import norm

from bridgectl import _checks
from bridgectl._checks import FloatArray


@dataclass(frozen=True, eq=False)
class ClassDae:
    """Mean and spread of the DAE over a road class, by speed: see `RampSurface.class_dae`.

    Attributes
    ----------
    speeds : ndarray, shape (n_speeds,)
        Speeds c [m/s].
    mean, sd : ndarray, shape (n_speeds,)
        Mean and standard deviation over the roads [-].
    order : int
        2 with ramps both ways, else 1: the mean in closed form is then that of a smooth road.
    mirror_pairs : int
        0 if `mean` is in closed form, as `sd` always is. Else the number of roads that were
        simulated, each with its mirror image, and `mean` is the mean of their DAFs and no estimate
        by DAE.
    standard_error : ndarray, shape (n_speeds,), or None
        Standard error of a simulated mean, the pairs being independent [-].
    """

    speeds: FloatArray
    mean: FloatArray
    sd: FloatArray
    order: int
    mirror_pairs: int = 0
    standard_error: FloatArray | None = None

    def __repr__(self) -> str:
        how, error = "", ""
        if self.standard_error is not None:
            how = f" simulated on {self.mirror_pairs} mirror pairs of roads"
            error = f" (standard error up to {self.standard_error.max():.4f})"
        return (
            f"ClassDae(order {self.order}, {self.speeds.size} speeds, mean{how} from "
            f"{self.mean.min():.4f} to {self.mean.max():.4f}{error}, sd up to "
            f"{self.sd.max():.4f})"
        )

    def percentile(self, percent: ArrayLike) -> FloatArray:
        """What so many percent of the roads stay below, as of a normal distribution."""
        share = _checks.floats("percent", percent) / 100
        if not np.all((share > 0) & (share < 1)):
            raise ValueError(f"percent must lie between 0 and 100, got {percent!r}: type 95")
        return np.asarray(self.mean + norm.ppf(share)[..., np.newaxis] * self.sd)


def over_class(
    speeds: FloatArray,
    smooth: FloatArray,
    odd: FloatArray,
    even: FloatArray | None,
    covariance: FloatArray,
) -> ClassDae:
    """Mean and standard deviation of DAF_smooth + o s + e s^2 for normal ramps s.

    With S = `covariance` by the ramps between them: mean = smooth + sum_i e_i S_ii, variance =
    o' S o + 2 tr((E S)^2). Ramps are in units of the unit ramp; `even` is None for the first order.
    """
    variance = np.einsum("si,is->s", odd, matmul_toeplitz(covariance, odd.T))
    mean = smooth.copy()
    if even is not None:
        mean += even.sum(axis=1) * covariance[0]
        variance += 2 * np.einsum("si,is->s", even, matmul_toeplitz(covariance**2, even.T))
    return ClassDae(speeds, mean, np.sqrt(variance), 1 if even is None else 2)
