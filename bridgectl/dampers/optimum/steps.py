"""A crossing in short steps that are linear in the impulses of its dampers.

The clairvoyant optimum is sought over them.

A step is the exact motion of the crossing without its damper, whose work is gathered in the middle
(Strang's splitting). There it changes the suspension velocity v by its own exact law::

    x+ = x + B_F z,   z = phi v,   phi = (1 - exp(-m c h)) / m,   m = -dv/dz

Several dampers do so one after the other, in every other step in the opposite order, so that the
error still falls with the square of the steps. What there is one of for each interval (or step) and
damper is in one row, the dampers of an interval side by side.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from bridgectl._checks import FloatArray
from bridgectl._places import SAME_PLACE, merge_places
from bridgectl.linear.nodes import cell_nodes
from bridgectl.linear.prediction import Prediction, predict
from bridgectl.linear.runs import Run

MOST_INTERVALS = 5_000
"""Most intervals: beyond, the solver takes minutes, and the optimum is no lower."""


class Step(NamedTuple):
    """Linear maps from [states at its start, impulses in its middle, 1] of one step."""

    end: FloatArray
    """To the states at its end: T_k, Z_k and g_k. On the approach they are the vehicle's alone."""
    rate: FloatArray
    """To v_k, the suspension velocity of each damper before its impulse."""
    moments: FloatArray
    """To the moments during the step."""


@dataclass(frozen=True)
class Steps:
    """A crossing as steps k, several in an interval in which the damping is held."""

    each: list[Step]
    positions: FloatArray
    """Where the intervals start [m]."""
    interval: NDArray[np.intp]
    """Interval of each step."""
    durations: FloatArray
    """Time of each step [s]."""
    masses: FloatArray
    """1 / m of the module's docstring [kg], of each damper: body and axle in series."""
    c_min: float
    c_max: float
    initial: FloatArray
    """States at the start."""

    @property
    def first(self) -> NDArray[np.intp]:
        """First step of each interval; its other steps are as long."""
        return np.searchsorted(self.interval, np.arange(len(self.positions)))

    @property
    def held(self) -> NDArray[np.intp]:
        """Of each step and damper the damping that it has, by number."""
        n = len(self.masses)
        return (n * self.interval[:, np.newaxis] + np.arange(n)).ravel()

    @property
    def _times(self) -> FloatArray:
        """Time of a step [s] in each interval, (n, 1)."""
        return self.durations[self.first][:, np.newaxis]

    def phi(self, damping: float | FloatArray) -> FloatArray:
        """Impulse per suspension velocity [kg] of a damping, or of one for each damper."""
        return np.ravel(-self.masses * np.expm1(-damping * self._times / self.masses))

    def shares(self, damping: float | FloatArray) -> FloatArray:
        """Shares of the range of phi, 0 at c_min and 1 at c_max, that dampings are."""
        least, most = self.phi(self.c_min), self.phi(self.c_max)
        return np.divide(
            self.phi(damping) - least, most - least, out=np.zeros_like(most), where=most > least
        )

    def damping(self, shares: FloatArray) -> FloatArray:
        """Damping of every interval [N s/m], from shares."""
        least, most = self.phi(self.c_min), self.phi(self.c_max)
        phi = (least + shares * (most - least)).reshape(-1, len(self.masses))
        c = -self.masses * np.log1p(-phi / self.masses) / self._times
        return np.clip(c.ravel(), self.c_min, self.c_max)


def acting(k: int, n_dampers: int) -> Sequence[int]:
    """In which order dampers act in a step."""
    return range(n_dampers) if k % 2 == 0 else range(n_dampers)[::-1]


def _grid(
    run: Run, speed: float, held: float, longest: float, free_from: float
) -> tuple[FloatArray, FloatArray, NDArray[np.intp]]:
    """Starts of the intervals, ends of the steps [m], and the interval of each step."""
    length = run.end - free_from
    count = np.ceil(length / (speed * held) - SAME_PLACE)
    if count > MOST_INTERVALS:
        raise ValueError(
            f"step = {held:g} s makes {count:.0f} intervals, more than {MOST_INTERVALS}: type for "
            f"example step={length / speed / 500:.1g}"
        )
    starts = free_from + speed * held * np.arange(int(count))
    if free_from > run.start:
        starts = np.append(run.start, starts)
    lengths = np.diff(np.append(starts, run.end))
    pieces = np.maximum(np.ceil(lengths / speed / longest - SAME_PLACE), 1).astype(int)
    interval = np.repeat(np.arange(len(starts)), pieces)
    within = np.arange(len(interval)) - np.searchsorted(interval, interval)
    firsts = starts[interval] + within * (lengths / pieces)[interval]
    return starts, np.append(firsts, run.end), interval


def join(
    run: Run, speed: float, held: float, longest: float, c_min: float, c_max: float,
    free_from: float | None = None,
) -> Steps:  # fmt: skip
    """Join the exact cells of the crossing into steps.

    All that lies before `free_from` [m], if it is given, is one interval.
    """
    crossing = run.crossing
    begins = run.start if free_from is None else free_from
    starts, ends, interval = _grid(run, speed, held, longest, begins)
    middles = (ends[1:] + ends[:-1]) / 2
    kinks = merge_places(np.concatenate([run.kinks(), ends, middles]))
    nodes = cell_nodes(crossing, speed, kinks)
    known = predict(run, speed, nodes)
    rates, of_force = known.velocity_rows, known.damper_input
    n = len(rates)
    first = np.searchsorted(nodes, ends - SAME_PLACE)
    # The bridge is at rest when the tire comes.
    sizes = np.where(first > known.entry, crossing.n_states, crossing.n_vehicle)
    steps = []
    for k, middle in enumerate(np.searchsorted(nodes, middles - SAME_PLACE)):
        seen: list[FloatArray] = []
        at: FloatArray = np.eye(crossing.n_states, sizes[k] + n + 1)
        at[:, -n - 1 :] = 0.0
        at = _through(at, known, range(first[k], middle), seen)
        v = np.empty((n, at.shape[1]))
        for i in acting(k, n):
            v[i] = rates[i] @ at
            at[:, sizes[k] + i] = of_force[:, i]
        at = _through(at, known, range(middle, first[k + 1]), seen)
        steps.append(Step(at[: sizes[k + 1]], v, np.array(seen).reshape(-1, at.shape[1])))
    masses = -1 / np.einsum("dn,nd->d", rates, of_force)
    initial = known.initial[: sizes[0]]
    return Steps(steps, starts, interval, np.diff(ends) / speed, masses, c_min, c_max, initial)


def _through(at: FloatArray, known: Prediction, which: range, seen: list[FloatArray]) -> FloatArray:
    """Take states, as maps from a step's start, through some cells, and note the moments."""
    for k in which:
        if k >= known.entry:
            seen.append(known.effect_rows[k] @ at)
            seen[-1][-1] += known.effect_constants[k]
        at = known.transitions[k] @ at
        at[:, -1] += known.offsets[k]
    return at


class March(NamedTuple):
    """What the steps give for a damping."""

    peak: float
    shares: FloatArray
    states: list[FloatArray]
    """At the start of each step."""
    rates: FloatArray
    """Suspension velocities v_k [m/s], of each step and damper."""
    impulses: FloatArray
    """z_k [N s], likewise."""


def march(steps: Steps, shares: FloatArray | Callable[[int, float], float]) -> March:
    """Run through the steps with given shares, or with those chosen from their number and v."""
    least, most = steps.phi(steps.c_min), steps.phi(steps.c_max)
    taken = np.zeros(len(least)) if callable(shares) else shares
    n, held, known = len(steps.masses), steps.held, np.zeros(len(least), dtype=bool)
    peak, states = -np.inf, list[FloatArray]()
    rates, impulses = np.empty(len(held)), np.empty(len(held))
    state = steps.initial
    for k, step in enumerate(steps.each):
        given = np.append(state, [*np.zeros(n), 1.0])
        for j in acting(k, n):
            at, i = n * k + j, held[n * k + j]
            rates[at] = step.rate[j] @ given
            if callable(shares) and not known[i]:
                taken[i], known[i] = shares(i, rates[at]), True
            impulses[at] = rates[at] * (least[i] + taken[i] * (most[i] - least[i]))
            given[j - n - 1] = impulses[at]
        peak = max(peak, (step.moments @ given).max(initial=-np.inf))
        states.append(state)
        state = step.end @ given
    return March(float(peak), taken, states, rates, impulses)
