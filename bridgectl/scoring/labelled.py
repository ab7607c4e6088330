"""Scores as labelled arrays, for tables and datasets."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from bridgectl._checks import FloatArray
from bridgectl._labelled import Labelled
from bridgectl.scoring.agreement import LEAST_GAP
from bridgectl.scoring.rows import MEASURES

UNITS = {
    name: told.rpartition("[")[2].rstrip("]").replace("-", "1") for name, told in MEASURES.items()
} | dict.fromkeys(("daf_optimum", "gap_closed", "daf_bound"), "1")


def labelled_scores(
    axes: Mapping[str, Any], values: Mapping[str, FloatArray], optimum: Mapping[str, FloatArray]
) -> Labelled:
    """Return what a `bridgectl.Scoreboard` knows of each strategy, road and speed, its axes."""
    arrays: dict[str, Any] = dict(values)
    if optimum:
        daf, best = values["daf"], optimum["daf"]
        gap = np.where(abs(daf[0] - best) < LEAST_GAP, np.nan, daf[0] - best)
        arrays["daf_optimum"] = ("road", "speed"), best
        arrays["gap_closed"] = (daf[0] - daf) / gap
        if "daf_bound" in optimum:
            arrays["daf_bound"] = ("road", "speed"), optimum["daf_bound"]
    return Labelled(axes, arrays, UNITS)
