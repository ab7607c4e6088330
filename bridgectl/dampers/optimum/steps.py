"""A crossing in short steps that are linear in the impulses of its damper.

The clairvoyant optimum is sought over them.

A step is the exact motion of the crossing without its damper, whose work is gathered in the middle
(Strang's splitting). There it changes the suspension velocity v by its own exact law::

    x+ = x + B_F z,   z = phi v,   phi = (1 - exp(-m c h)) / m,   m = -dv/dz
"""

from __future__ import annotations

from collections.abc import Callable
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
    """Linear maps from [states at its start, impulse in its middle, 1] of one step."""

    end: FloatArray
    """To the states at its end: T_k, Z_k and g_k. On the approach they are the vehicle's alone."""
    rate: FloatArray
    """To v_k, the suspension velocity before the impulse."""
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
    mass: float
    """1 / m of the module's docstring [kg]: body and axle in series."""
    c_min: float
    c_max: float

    @property
    def first(self) -> NDArray[np.intp]:
        """First step of each interval; its other steps are as long."""
        return np.searchsorted(self.interval, np.arange(len(self.positions)))

    def phi(self, damping: float) -> FloatArray:
        """Impulse per suspension velocity [kg] of a damping, in each interval."""
        return -self.mass * np.expm1(-damping * self.durations[self.first] / self.mass)

    def shares(self, damping: float) -> FloatArray:
        """Shares of the range of phi, 0 at c_min and 1 at c_max, that a damping is."""
        least, most = self.phi(self.c_min), self.phi(self.c_max)
        return np.divide(
            self.phi(damping) - least, most - least, out=np.zeros_like(most), where=most > least
        )

    def damping(self, shares: FloatArray) -> FloatArray:
        """Damping of every interval [N s/m], from shares."""
        least, most = self.phi(self.c_min), self.phi(self.c_max)
        phi = least + shares * (most - least)
        c = -self.mass * np.log1p(-phi / self.mass) / self.durations[self.first]
        return np.clip(c, self.c_min, self.c_max)


def _grid(
    run: Run, speed: float, held: float, longest: float
) -> tuple[FloatArray, FloatArray, NDArray[np.intp]]:
    """Starts of the intervals, ends of the steps [m], and the interval of each step."""
    length = run.end - run.start
    count = np.ceil(length / (speed * held) - SAME_PLACE)
    if count > MOST_INTERVALS:
        raise ValueError(
            f"step = {held:g} s makes {count:.0f} intervals, more than {MOST_INTERVALS}: type for "
            f"example step={length / speed / 500:.1g}"
        )
    starts = run.start + speed * held * np.arange(int(count))
    lengths = np.diff(np.append(starts, run.end))
    pieces = np.maximum(np.ceil(lengths / speed / longest - SAME_PLACE), 1).astype(int)
    interval = np.repeat(np.arange(len(starts)), pieces)
    within = np.arange(len(interval)) - np.searchsorted(interval, interval)
    firsts = starts[interval] + within * (lengths / pieces)[interval]
    return starts, np.append(firsts, run.end), interval


def join(run: Run, speed: float, held: float, longest: float, c_min: float, c_max: float) -> Steps:
    """Join the exact cells of the crossing into steps."""
    crossing = run.crossing
    starts, ends, interval = _grid(run, speed, held, longest)
    middles = (ends[1:] + ends[:-1]) / 2
    kinks = merge_places(np.concatenate([run.kinks(), ends, middles]))
    nodes = cell_nodes(crossing, speed, kinks)
    known = predict(run, speed, nodes)
    rate, of_force = known.velocity_rows[0], known.damper_input[:, 0]
    first = np.searchsorted(nodes, ends - SAME_PLACE)
    # The bridge is at rest when the tire comes.
    sizes = np.where(first > known.entry, crossing.n_states, crossing.n_vehicle)
    steps = []
    for k, middle in enumerate(np.searchsorted(nodes, middles - SAME_PLACE)):
        seen: list[FloatArray] = []
        at: FloatArray = np.eye(crossing.n_states, sizes[k] + 2)
        at[:, -2:] = 0.0
        at = _through(at, known, range(first[k], middle), seen)
        v = rate @ at
        at[:, -2] = of_force
        at = _through(at, known, range(middle, first[k + 1]), seen)
        steps.append(Step(at[: sizes[k + 1]], v, np.array(seen).reshape(-1, at.shape[1])))
    mass = -1 / float(rate @ of_force)
    return Steps(steps, starts, interval, np.diff(ends) / speed, mass, c_min, c_max)


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
    """Suspension velocities v_k [m/s]."""
    impulses: FloatArray
    """z_k [N s]."""


def march(steps: Steps, shares: FloatArray | Callable[[int, float], float]) -> March:
    """Run through the steps with given shares, or with those chosen from interval and v."""
    taken = np.zeros(len(steps.positions)) if callable(shares) else shares
    least, most = steps.phi(steps.c_min), steps.phi(steps.c_max)
    peak, previous, states = -np.inf, -1, list[FloatArray]()
    rates, impulses = np.empty(len(steps.each)), np.empty(len(steps.each))
    state: FloatArray = np.zeros(len(steps.each[0].rate) - 2)
    for k, (step, i) in enumerate(zip(steps.each, steps.interval, strict=True)):
        given = np.append(state, [0.0, 1.0])
        rates[k] = step.rate @ given
        if callable(shares) and i != previous:
            taken[i], previous = shares(i, rates[k]), i
        given[-2] = impulses[k] = rates[k] * (least[i] + taken[i] * (most[i] - least[i]))
        peak = max(peak, (step.moments @ given).max(initial=-np.inf))
        states.append(state)
        state = step.end @ given
    return March(float(peak), taken, states, rates, impulses)
