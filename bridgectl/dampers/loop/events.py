"""Where within a step a tire leaves or meets the road, or a damper's force meets its limit.

Between such events the forces are smooth, and the Gauss points of a step give them exactly enough;
a step that has one is cut there. Tire and damper forces are continuous at an event, so that none
sets off another at once.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from bridgectl._checks import FloatArray
from bridgectl.dampers.loop.steps import STAGES, Rows

TIRE_NODES = np.array([STAGES[0], 0.5, STAGES[1], 1.0])
"""Fractions of a step where the tire force is known: stages, middle, end."""

DAMPER_NODES = np.array([0.0, *STAGES, 1.0])
"""Fractions of a step where the damper's force is known: start, stages, end."""

GRAZING = 1e-3
"""After an event the next one is looked for from this fraction of the rest of the step on."""

MOST = 50
"""Events of one step: a force that grazes its bound more often is left to the Gauss points."""

UNREACHED = 1e30
"""Limit [N] of a damper without one, beside others that have."""

HALVINGS = 40
"""Of the interval that an event is in: to the last digit."""

Bound = FloatArray | None
"""An array that goes with forces at the stages (S, 2 forces, R), or None for no bound."""


class Bounds(NamedTuple):
    """Least and largest R - W and F [N]."""

    tire_least: Bound
    tire_most: Bound
    damper_least: Bound
    damper_most: Bound

    def apply(self, forces: FloatArray, rows: Rows) -> None:
        """Put forces at the stages of a step within their bounds."""
        for each, least, most in (
            (forces[:, rows.tire], self.tire_least, self.tire_most),
            (forces[:, rows.damper], self.damper_least, self.damper_most),
        ):
            if least is not None:
                np.maximum(each, least, out=each)
            if most is not None:
                np.minimum(each, most, out=each)


class Regime(NamedTuple):
    """Which side of its bounds each force is on, until the next event, in n cases."""

    touching: NDArray[np.bool_]
    """Whether each tire is on the road, (n, T)."""
    limited: FloatArray
    """Sign of each damper's force where that is at its limit, else 0, (n, D)."""

    def bounds(self, weights: FloatArray, limits: FloatArray) -> Bounds:
        """Bounds within which forces go on as they do until the event."""
        held, at = self.limited != 0, np.copysign(limits, self.limited)
        return Bounds(
            *(
                np.tile(each, 2)[..., np.newaxis]
                for each in (
                    np.where(self.touching, -np.inf, -weights),
                    np.where(self.touching, np.inf, -weights),
                    np.where(held, at, -np.inf),
                    np.where(held, at, np.inf),
                )
            )
        )

    def next_event(self, tires: FloatArray, dampers: FloatArray, limits: FloatArray) -> FloatArray:
        """Fractions of a step of each tire's first landing or lift-off, each damper's limit.

        Infinity where there is none, (n, T + D); of R at `TIRE_NODES` and F at `DAMPER_NODES` [N],
        both without bounds, (n, 4, T) and (n, 4, D).
        """
        side = np.where(self.touching, 1.0, -1.0)[:, np.newaxis]
        found = _first_sign_changes(TIRE_NODES, side * tires)
        if np.all(limits == np.inf):
            return np.concatenate([found, np.full(self.limited.shape, np.inf)], axis=1)
        # Of a free force both limits: their lesser would have a kink where the force is zero.
        held, sign = (self.limited != 0)[:, np.newaxis], self.limited[:, np.newaxis]
        limits = np.minimum(limits, UNREACHED)
        below = np.where(held, sign * dampers - limits, limits - dampers)
        above = np.where(held, below, limits + dampers)
        meets = np.minimum(*(_first_sign_changes(DAMPER_NODES, m) for m in (below, above)))
        return np.concatenate([found, meets], axis=1)

    def after(self, event: NDArray[np.bool_], dampers: FloatArray) -> Regime:
        """The regime after events (n, T + D), with F at the end of the step, (n, D)."""
        turning, meeting = np.split(event, [self.touching.shape[1]], axis=1)
        entered = np.where(self.limited == 0, np.sign(dampers), 0.0)
        return Regime(self.touching ^ turning, np.where(meeting, entered, self.limited))


def _first_sign_changes(nodes: FloatArray, margins: FloatArray) -> FloatArray:
    """`first_sign_change` of margins (n, 4, forces), (n, forces)."""
    each = np.moveaxis(margins, 1, -1)
    return first_sign_change(nodes, each.reshape(-1, len(nodes))).reshape(each.shape[:-1])


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
