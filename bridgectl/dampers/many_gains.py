"""A strategy with many values of its gains at once, side by side in one run.

Most of the time of a run of few roads goes into the matrices of its steps, which all crossings
share: 64 values of the gains take far less than 64 times the time of one.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np

from bridgectl._checks import FloatArray
from bridgectl.dampers.fitted import Fitted
from bridgectl.dampers.strategy import Strategy
from bridgectl.model.crossing import Crossing


class ManyGains(Strategy):
    """A law whose gains have a value for each road: see `with_many_gains`."""

    def __init__(self, law: Strategy, names: Sequence[str], values: FloatArray) -> None:
        vars(self).update(vars(law))
        self.one, self.names, self.values = law, tuple(names), values

    def for_speed(self, speed: float) -> Strategy:
        """Return the law at a speed: see `Strategy`."""
        own = self.one.for_speed(speed)
        return self if own is self.one else own

    def gains_for(
        self, crossing: Crossing, speeds: FloatArray, stations: FloatArray, elevations: FloatArray
    ) -> Mapping[str, FloatArray]:
        """Return the gains of each road, the same at all speeds."""
        each = np.repeat(self.values, len(elevations) // len(self.values), axis=0)
        shape = len(speeds), len(elevations)
        return {k: np.broadcast_to(v, shape) for k, v in zip(self.names, each.T, strict=True)}


def with_many_gains(dampers: Fitted, names: Sequence[str], values: FloatArray) -> Fitted:
    """Return dampers for as many repetitions of the roads as there are rows of gain values."""
    laws = [ManyGains(damper.strategy, names, values) for damper in dampers.dampers]
    return Fitted(dampers.legs, tuple(
        replace(damper, strategy=law) for damper, law in zip(dampers.dampers, laws, strict=True)
    ))  # fmt: skip
