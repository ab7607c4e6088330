"""What tuning minimises: DAFs of some roads, each with its weight, for many values of gains.

The class DAE is of that form, too. With the effects e of ramps up and down at N places, each of
height h = sigma sqrt(N), it is DAF_smooth + (sigma / h)^2 sum_i e_i, the mean of the DAFs of all
these ramps; at places without a ramp they lie on straight lines between those of others.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from contextlib import closing
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from bridgectl._checks import FloatArray
from bridgectl._workers import in_processes
from bridgectl.dampers.fitted import Fitted
from bridgectl.dampers.loop.closed_loop import run_loop
from bridgectl.dampers.many_gains import with_many_gains
from bridgectl.dampers.program import Program
from bridgectl.dampers.sensitivity import program_sensitivity
from bridgectl.model.crossing import Crossing
from bridgectl.scoring.classes import EVERY
from bridgectl.scoring.study import Study
from bridgectl.surface.compute import RAMP_LENGTH, class_height

AT_ONCE = 2000
"""Roads of a run, over all values of gains: more are shared out among the workers."""


class Driven(NamedTuple):
    """Roads, and the weight of each one's DAF."""

    stations: FloatArray
    """Shape (n,) [m]."""
    elevations: FloatArray
    """Shape (n_roads, n) [m]."""
    weights: FloatArray
    """Shape (n_roads,), of sum 1."""


def all_roads(study: Study) -> Driven:
    """Return the roads of a study, whose DAFs count alike."""
    n = len(study.elevations)
    return Driven(study.stations, study.elevations, np.full(n, 1 / n))


def class_ramps(study: Study, classes: Sequence[str]) -> Driven:
    """Return ramps whose weighted DAF is the class DAE, or the mean of those of some classes."""
    n = study.n_ramps
    starts = np.arange(0, n, EVERY)
    kept = np.unique([*starts, *(starts + 1), n])
    after = kept > starts[:, np.newaxis]
    heights = [class_height(each, RAMP_LENGTH, n) for each in classes]
    ramps = np.vstack([sign * height * after for height in heights for sign in (-1, 1)])
    shares = [np.interp(np.arange(n), starts, one).mean() for one in np.eye(starts.size)]
    weights = np.tile(shares, 2 * len(heights)) / (2 * len(heights))
    return Driven(study.stations[kept], ramps, weights)


@dataclass(frozen=True)
class Objective:
    """The mean over the speeds of a weighted DAF, or their soft maximum, as a function of gains."""

    crossing: Crossing
    """With the vehicle's own dampers."""
    dampers: Fitted
    names: tuple[str, ...]
    """Of the gains that vary."""
    speeds: FloatArray
    driven: Driven
    softness: float
    """Of the maximum over speeds, DAFs that count alike [-]; infinity for the mean."""
    workers: int | None

    def dafs(self, gains: FloatArray, driven: Driven | None = None) -> FloatArray:
        """DAFs for gains (n_values, n_gains), of shape (n_values, n_speeds, n_roads)."""
        roads = self.driven if driven is None else driven
        most = max(1, AT_ONCE // len(roads.elevations))
        parts = [gains[i : i + most] for i in range(0, len(gains), most)]
        jobs = [
            (self.crossing, self.dampers, self.names, part, self.speeds, roads) for part in parts
        ]
        with closing(in_processes(_dafs, jobs, self.workers)) as found:
            done = dict(found)
        return np.concatenate([done[i] for i in range(len(jobs))])

    def values(self, gains: FloatArray) -> FloatArray:
        """Return the objective [-] for gains (n_values, n_gains)."""
        return self._over_speeds(self.dafs(gains) @ self.driven.weights)[0]

    def _over_speeds(self, of_speeds: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Objectives of DAFs by speed (n_values, n_speeds), and their slopes."""
        highest = of_speeds.max(axis=1, keepdims=True)
        powers = np.exp((of_speeds - highest) / self.softness)
        mean = powers.mean(axis=1, keepdims=True)
        if np.isinf(self.softness):
            return of_speeds.mean(axis=1), powers / powers.shape[1]
        soft = highest + self.softness * np.log(mean)
        return soft[:, 0], powers / (mean * powers.shape[1])

    def by_adjoint(self, program: Program, gains: FloatArray) -> tuple[float, FloatArray]:
        """Return the objective and its slopes [m/(N s)] for the dampings of a program."""
        found = [
            program_sensitivity(
                self.crossing.beam, self.crossing.vehicle, float(speed), program.positions, gains,
                *self.driven[:2], section=self.crossing.section, recovery=self.crossing.recovery,
            )
            for speed in self.speeds
        ]  # fmt: skip
        dafs = np.array([[self.driven.weights @ each.daf for each in found]])
        value, shares = self._over_speeds(dafs)
        slopes = [self.driven.weights @ each.gradient for each in found]
        return float(value[0]), shares[0] @ slopes


def by_differences(
    values: Callable[[FloatArray], FloatArray], at: FloatArray, ends: FloatArray, step: float
) -> tuple[float, FloatArray]:
    """Return a function's value and slopes, from central differences within `ends`, all at once.

    The function takes (n_values, n), `at` has shape (n,), the ends (n, 2).
    """
    steps = step * np.eye(at.size)
    above, below = np.minimum(at + steps, ends[:, 1]), np.maximum(at - steps, ends[:, 0])
    found = values(np.vstack([at, above, below]))
    more, less = np.split(found[1:], 2)
    return float(found[0]), (more - less) / np.diag(above - below)


def _dafs(
    crossing: Crossing, dampers: Fitted, names: Sequence[str], gains: FloatArray,
    speeds: FloatArray, driven: Driven,
) -> FloatArray:  # fmt: skip
    """DAFs of all roads, for each of some values of gains."""
    many = with_many_gains(dampers, names, gains)
    roads = np.tile(driven.elevations, (len(gains), 1))
    found = run_loop(many.bare(crossing), many, speeds, driven.stations, roads)
    return np.moveaxis(found.daf.reshape(len(speeds), len(gains), -1), 1, 0)
