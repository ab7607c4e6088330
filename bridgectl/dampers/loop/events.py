"""Where within a step a tire leaves or meets the road, or the damper's force meets its limit.

Between such events the forces are smooth, and the Gauss points of a step give them exactly enough;
a step that has one is cut there. Tire and damper force are continuous at an event, so that none
sets off another at once.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from bridgectl._checks import FloatArray
from bridgectl.dampers.loop.steps import DAMPER, STAGES, TIRE

TIRE_NODES = np.array([STAGES[0], 0.5, STAGES[1], 1.0])
"""Fractions of a step where the tire force is known: stages, middle, end."""

DAMPER_NODES = np.array([0.0, *STAGES, 1.0])
"""Fractions of a step where the damper's force is known: start, stages, end."""

GRAZING = 1e-3
"""After an event the next one is looked for from this fraction of the rest of the step on."""

MOST = 50
"""Events of one step: a force that grazes its bound more often is left to the Gauss points."""

HALVINGS = 40
"""Of the interval that an event is in: to the last digit."""

Bound = FloatArray | float | None
"""A number, an array (S, 1, R), or None for no bound."""


class Bounds(NamedTuple):
    """Least and largest R - W and F [N]."""

    tire_least: Bound
    tire_most: Bound
    damper_least: Bound
    damper_most: Bound

    def apply(self, forces: FloatArray) -> None:
        """Put forces at the stages of a step within their bounds."""
        for rows, least, most in (
            (forces[:, TIRE], self.tire_least, self.tire_most),
            (forces[:, DAMPER], self.damper_least, self.damper_most),
        ):
            if least is not None:
                np.maximum(rows, least, out=rows)
            if most is not None:
                np.minimum(rows, most, out=rows)


class Regime(NamedTuple):
    """Which side of its bounds each force is on, until the next event: arrays (n, 1)."""

    touching: NDArray[np.bool_]
    """Whether the tire is on the road."""
    limited: FloatArray
    """Sign of the damper's force where that is at its limit, else 0."""

    def bounds(self, weight: float, limit: float) -> Bounds:
        """Bounds within which forces go on as they do until the event."""
        touching = self.touching[:, np.newaxis]
        held = (self.limited != 0)[:, np.newaxis]
        at = np.copysign(limit, self.limited[:, np.newaxis])
        free = np.full(touching.shape, np.inf)
        return Bounds(
            np.where(touching, -free, -weight), np.where(touching, free, -weight),
            np.where(held, at, -free), np.where(held, at, free),
        )  # fmt: skip

    def next_event(self, tire: FloatArray, damper: FloatArray, limit: float) -> FloatArray:
        """Fractions of a step of the first landing or lift-off and of the first limit, (n, 2).

        Infinity where there is none; of R at `TIRE_NODES` and F at `DAMPER_NODES` [N], both
        without bounds, (n, 4).
        """
        side = np.where(self.touching, 1.0, -1.0)
        found = [first_sign_change(TIRE_NODES, side * tire), np.full(len(tire), np.inf)]
        if limit < np.inf:
            # Of a free force both limits: their lesser would have a kink where the force is zero.
            held = self.limited != 0
            below = np.where(held, self.limited * damper - limit, limit - damper)
            above = np.where(held, below, limit + damper)
            found[1] = np.minimum(*(first_sign_change(DAMPER_NODES, m) for m in (below, above)))
        return np.stack(found, axis=1)

    def after(self, event: NDArray[np.bool_], damper: FloatArray) -> Regime:
        """The regime after events (n, 2), with F at the end of the step, (n, 1)."""
        entered = np.where(self.limited == 0, np.sign(damper), 0.0)
        return Regime(self.touching ^ event[:, :1], np.where(event[:, 1:], entered, self.limited))


def first_sign_change(nodes: FloatArray, margins: FloatArray) -> FloatArray:
    """Where in [0, 1] the cubics through margins (n, 4) first fall below 0, else infinity.

    At 0 a margin is that after the event before, and its sign is round-off.
    """
    late = (margins < 0) & (nodes > 0)
    first = np.argmax(late, axis=1)
    high = np.where(late.any(axis=1), nodes[first], 1.0)
    low = np.where(first > 0, nodes[first - 1], 0.0)
    series = np.linalg.inv(np.vander(nodes)) @ margins.T
    for _ in range(HALVINGS):
        middle = (low + high) / 2
        below = np.polyval(series, middle) < 0
        low, high = np.where(below, low, middle), np.where(below, middle, high)
    return np.where(late.any(axis=1), high, np.inf)
