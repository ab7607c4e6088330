"""Roads and cases that several tests share."""

from __future__ import annotations

import numpy as np

import bridgectl as bc


def rough_road(
    seed: int, start: float, stop: float, step: float = 0.1, height: float = 5e-4
) -> bc.RoadProfile:
    """A random road of ramps: heights in metres, normally distributed."""
    rng = np.random.default_rng(seed)
    x = start + step * np.arange(round((stop - start) / step) + 1)
    return bc.RoadProfile(x, np.cumsum(rng.normal(0.0, height, x.size)))
