"""Estimate of the work of crossings with a damper in the loop: see `bridgectl._work`."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from bridgectl._checks import FloatArray
from bridgectl._work import Work, at_least, at_most, require_feasible
from bridgectl.dampers.fitted import Fitted
from bridgectl.dampers.loop.steps import longest_step
from bridgectl.linear.estimates import what_counts
from bridgectl.model.crossing import Crossing

STEP_SECONDS, ROAD_SECONDS = 2e-4, 3e-7
"""Time of a step, and more for each road and speed of 10 states, measured on one core of 2020."""


def require_loop(
    crossing: Crossing,
    dampers: Sequence[Fitted],
    speeds: FloatArray,
    stations: FloatArray,
    n_roads: int,
    *,
    n_ramps: int = 0,
    n_recorded: int = 0,
    at_once: int | None = None,
    announced: bool = True,
) -> None:
    """Refuse closed-loop crossings that are too much work, one run for each of `dampers`.

    The crossing is of the vehicle without what they replace, at speeds [m/s], over roads with
    stations [m]: so many roads, `at_once` in a run (by default all), unit ramps beside them once,
    and recorded histories of each road. `announced` tells whether long work needs a word.
    """
    dense = min(dampers, key=lambda damper: damper.sample_time)
    stiffest = max(float(damper.dampings.max()) for damper in dampers)
    spacing = float(np.ptp(stations) / (stations.size - 1))  # as a mean
    arguments = what_counts(crossing, speeds) | {
        "roads": at_most(n_roads, 100, what="{value} roads"),
        "approach": at_most(-float(stations[0]), 200.0, "m"),
        "departure": at_most(float(stations[-1]) - crossing.beam.length, 200.0, "m"),
        "spacing": at_least(spacing, 0.01, "m", "stations {value} apart"),
        "sample_time": at_least(dense.sample_time, 2e-3, "s"),
        "c_max": at_most(stiffest, 30e3, "N s/m"),
    }

    def work(
        n_modes: float, speeds: float, slowest: float, roads: float, approach: float,
        departure: float, spacing: float, sample_time: float, c_max: float,
    ) -> Work:  # fmt: skip
        n = crossing.n_vehicle + 2 * n_modes
        way = approach + crossing.beam.length + departure
        rounds = way / slowest / sample_time
        longest = min(longest_step(crossing, c_max, int(n_modes)), sample_time)
        steps = rounds * np.ceil(sample_time / longest)
        steps += way / spacing * _apart(crossing.linear.tire_offsets, spacing)
        together = min(roads, roads if at_once is None else at_once)
        runs = max(1.0, roads / together)
        columns = speeds * (roads + n_ramps / 2)  # a ramp counts from where it begins
        seconds = steps * (STEP_SECONDS * runs + ROAD_SECONDS * columns * n / 10)
        recorded = 2 * n_recorded * together * rounds
        at_work = 3 * (together + n_ramps) * (n + 20)
        memory = 8 * speeds * (6 * rounds + 3 * steps + recorded + at_work)
        return Work(memory + 16 * roads * way / spacing, seconds * len(dampers))

    require_feasible(work, arguments, announced=announced)


def _apart(offsets: FloatArray, spacing: float) -> int:
    """How often in a spacing of the stations [m] a tire meets one."""
    return np.unique(np.round(offsets / spacing % 1, 6) % 1).size
