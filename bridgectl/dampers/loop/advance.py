"""One step of crossings with a damper in the loop, all speeds and roads side by side.

A step is solved for all of them at once; those in which a tire leaves or meets the road, or the
damper's force its limit, go through it anew from event to event, each by steps of its own.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from bridgectl._checks import FloatArray
from bridgectl.dampers.actuator import Damper
from bridgectl.dampers.loop.events import GRAZING, MOST, Bounds, Regime
from bridgectl.dampers.loop.steps import (
    AXLE,
    BODY,
    DAMPER,
    MOMENT,
    POINTS,
    STAGES,
    STATES,
    TIRE,
    TIRE_LATER,
    Responses,
    Steps,
    make_steps,
)
from bridgectl.model.crossing import Crossing

SUBSTITUTIONS = 4
"""How often the forces of a step are put into its equations: each gains more than a digit."""

CLOSE = 3e-3
"""How far below the largest moment a step's samples may lie and its peak above it, as its share."""

QUARTIC = np.linalg.inv(np.vander([0.0, *POINTS], increasing=True)).T
"""From the moments at start and points of a step to the quartic through them, its coefficients."""

SLOPE_AT_END = QUARTIC @ np.arange(5.0)
"""From the same moments to the slope of the quartic at the end; that at the start is a coefficient.
"""

BETWEEN = QUARTIC @ np.vander(np.linspace(0, 1, 65), 5, increasing=True).T
"""From the same moments to those at 65 places of the step."""


@dataclass
class Ends:
    """A run at the end of a step: arrays (S, R); states (S, 1 + n, R), the first row ones.

    The controller's memory is of shape (S, m, R).
    """

    states: FloatArray
    force: FloatArray
    """Tire force [N]."""
    sampled_force: FloatArray
    """Tire force at the last sample [N]."""
    moment: FloatArray
    damping: FloatArray
    command: FloatArray
    peak: FloatArray
    least: FloatArray
    lift_off: FloatArray
    energy: FloatArray
    switches: NDArray[np.intp]
    memory: FloatArray

    @property
    def velocity(self) -> FloatArray:
        """y_s' - y_t' [m/s], (S, R)."""
        return np.asarray(self.states[:, 1 + BODY] - self.states[:, 1 + AXLE])

    def view(self, n_speeds: int, n_roads: int) -> Ends:
        """The slowest speeds and the first roads, as they change."""
        return Ends(**{k: v[:n_speeds, ..., :n_roads] for k, v in vars(self).items()})

    def of_cases(self, cases: Cases) -> Ends:
        """A copy of some cases, in place of speeds, of one road each."""
        return Ends(
            **{k: v[cases[0], ..., cases[1]][..., np.newaxis] for k, v in vars(self).items()}
        )

    def put_back(self, cases: Cases, found: Ends) -> None:
        """Replace some cases, as `of_cases` gave them."""
        for name, array in vars(self).items():
            array[cases[0], ..., cases[1]] = vars(found)[name][..., 0]


Cases = tuple[NDArray[np.intp], NDArray[np.intp]]
"""Numbers of speeds and of roads, one of each for every case."""


class Taken(NamedTuple):
    """What a step leads to: arrays (S, rows, R) unless it is said."""

    stages: FloatArray
    """u - r [m] and w [m/s] at the stages."""
    later: FloatArray
    """u - r at middle and end [m]."""
    coefficients: FloatArray
    """Dampings at the stages [N s/m], (S, 1 or 2, R)."""
    forces: FloatArray
    """R - W and F at the stages [N], within their bounds."""
    tires: FloatArray
    """Tire force R at the points [N]."""
    least: FloatArray
    """The least of them, (S, R)."""
    moment: FloatArray
    """The states' share of the moment at the points, on the bridge."""
    states: FloatArray
    """States at the end."""
    damping: FloatArray
    """Damping at the end [N s/m], (S, R)."""


class Stepper:
    """The steps of a run: speeds rise, drops of the roads (n, R) are positive down."""

    def __init__(
        self,
        crossing: Crossing,
        damper: Damper,
        speeds: FloatArray,
        stations: FloatArray,
        drops: FloatArray,
        responses: Responses,
    ) -> None:
        self.crossing, self.damper, self.speeds = crossing, damper, speeds
        self.stations, self.drops, self.responses = stations, drops, responses
        linear = crossing.linear
        self.weight, self.stiffness = linear.static_loads[0], linear.tire_stiffnesses[0]
        limit = None if damper.max_force == np.inf else damper.max_force
        self.bounds = Bounds(-self.weight, None, limit and -limit, limit)

    def steps(self, speeds: FloatArray, edges: FloatArray, *, on_bridge: bool) -> Steps:
        """Matrices of steps: see `make_steps`."""
        return make_steps(
            self.crossing, self.responses, speeds, edges, self.stations, on_bridge=on_bridge
        )

    def advance(
        self, now: Ends, steps: Steps, k: int, edges: FloatArray, *, on_bridge: bool
    ) -> None:
        """One step between edges (S, 2) [m], cut where a case has an event in it."""
        taken = self._take(now, steps, k, self.bounds)
        cases = self._with_events(now, taken)
        if cases[0].size:
            cut = now.of_cases(cases)
            self._through_events(cut, cases, edges[cases[0]], on_bridge=on_bridge)
        self._accept(now, steps, k, taken, on_bridge=on_bridge)
        if cases[0].size:
            now.put_back(cases, cut)

    def _take(
        self, now: Ends, steps: Steps, k: int, bounds: Bounds, roads: NDArray[np.intp] | None = None
    ) -> Taken:
        """Solve a step; of cases, `roads` tells the road of each."""
        here, n_states = len(now.force), steps.free.shape[-1]
        duration = steps.durations[:here, k, np.newaxis, np.newaxis]
        road = self._road(steps, k, now.force.shape, roads)
        free = steps.free[:here, k] @ now.states[:, :n_states]
        forced = steps.forced[:here, k]
        damping = self._lagged(now, duration * STAGES[:, np.newaxis])
        known = free[:, : DAMPER.stop]
        known[:, TIRE] -= road[:, TIRE]
        values, forces = known, np.empty_like(known)
        for attempt in range(SUBSTITUTIONS):
            if attempt:
                values = forced[:, : DAMPER.stop] @ forces
                values += known
            np.multiply(values[:, TIRE], self.stiffness, out=forces[:, TIRE])
            np.multiply(values[:, DAMPER], damping, out=forces[:, DAMPER])
            bounds.apply(forces)
        free[:, DAMPER.stop :] += forced[:, DAMPER.stop :] @ forces
        later = free[:, TIRE_LATER]
        later -= road[:, 2:]
        tires = np.empty_like(forces)
        np.add(forces[:, TIRE], self.weight, out=tires[:, :2])
        np.multiply(later, self.stiffness, out=tires[:, 2:])
        tires[:, 2:] += self.weight
        np.maximum(tires, 0.0, out=tires)
        end = self._lagged(now, duration)[:, 0]
        return Taken(
            values, later, damping, forces, tires, _over_points(np.minimum, tires),
            free[:, MOMENT], free[:, STATES : STATES + n_states - 1], end,
        )  # fmt: skip

    def _accept(self, now: Ends, steps: Steps, k: int, taken: Taken, *, on_bridge: bool) -> None:
        """Let a step count: states, forces, moment and what is gathered of them."""
        here = len(now.force)
        now.states[:, 1 : 1 + taken.states.shape[1]] = taken.states
        now.force[:] = taken.tires[:, -1]
        np.minimum(now.least, taken.least, out=now.least)
        power = np.einsum("sir,sir->sr", taken.forces[:, DAMPER], taken.stages[:, DAMPER])
        now.energy += steps.durations[:here, k, np.newaxis] / 2 * power
        now.damping[:] = taken.damping
        if on_bridge:
            moment = taken.tires
            moment *= steps.influence[:here, k]
            moment += taken.moment
            counted = steps.counted[:here, k, np.newaxis]
            if counted.any():
                _raise_peak(now.peak, now.moment, moment, counted)
            now.moment[:] = moment[:, -1]

    def _through_events(
        self, now: Ends, cases: Cases, edges: FloatArray, *, on_bridge: bool
    ) -> None:
        """One step of some cases, from event to event."""
        x, end = edges.T
        regime = Regime(now.force > 0, self._limited(now.damping * now.velocity))
        for attempt in range(MOST):
            last = attempt == MOST - 1  # a force that grazes its bound has all of its bounds
            bounds = self.bounds if last else regime.bounds(self.weight, self.damper.max_force)
            steps, taken = self._case_step(now, cases, x, end, bounds, on_bridge=on_bridge)
            place = regime.next_event(
                self._tire_forces(taken)[..., 0], self._damper_forces(now, taken)[..., 0],
                self.damper.max_force,
            )  # fmt: skip
            share = 1.0 if last else np.clip(place.min(axis=1), GRAZING, 1.0)
            event = place <= np.reshape(share, (-1, 1))
            reach = np.where(share < 1, x + share * (end - x), end)
            if np.any(reach < end):
                steps, taken = self._case_step(now, cases, x, reach, bounds, on_bridge=on_bridge)
            self._accept(now, steps, 0, taken, on_bridge=on_bridge)
            leaves = event[:, :1] & regime.touching
            now.lift_off[leaves] = np.minimum(now.lift_off, reach[:, np.newaxis])[leaves]
            regime = regime.after(event, now.damping * now.velocity)
            x = reach
            if np.all(x >= end):
                break

    def _case_step(
        self,
        now: Ends,
        cases: Cases,
        x: FloatArray,
        end: FloatArray,
        bounds: Bounds,
        *,
        on_bridge: bool,
    ) -> tuple[Steps, Taken]:
        """One step of each case, from x to end [m]."""
        edges = np.stack([x, end], axis=1)[:, np.newaxis]
        steps = self.steps(self.speeds[cases[0]], edges, on_bridge=on_bridge)
        return steps, self._take(now, steps, 0, bounds, cases[1][:, np.newaxis])

    def _with_events(self, now: Ends, taken: Taken) -> Cases:
        """Cases whose tire leaves or meets the road, or whose damper's force its limit."""
        turning = np.zeros(now.force.shape, dtype=bool)
        if min(now.force.min(), taken.least.min()) <= 0:
            off = np.concatenate([now.force[:, np.newaxis], taken.tires], axis=1) <= 0
            turning |= off.any(axis=1) & ~off.all(axis=1)
        if self.damper.max_force < np.inf:
            limited = self._limited(self._damper_forces(now, taken))
            turning |= (limited[:, 1:] != limited[:, :1]).any(axis=1)
        speeds, roads = np.nonzero(turning)
        return speeds, roads

    def _tire_forces(self, taken: Taken) -> FloatArray:
        """R at `TIRE_NODES` [N] if the tire could pull, (S, 4, R)."""
        closer = np.stack([taken.stages[:, TIRE], taken.later], axis=2)  # in the order of places
        return self.weight + self.stiffness * closer.reshape(len(closer), 4, -1)

    def _damper_forces(self, now: Ends, taken: Taken) -> FloatArray:
        """F at `DAMPER_NODES` without its limit [N], (S, 4, R)."""
        stages = taken.coefficients * taken.stages[:, DAMPER]
        end = taken.damping * (taken.states[:, BODY] - taken.states[:, AXLE])
        return np.stack([now.damping * now.velocity, *np.moveaxis(stages, 1, 0), end], axis=1)

    def _limited(self, force: FloatArray) -> FloatArray:
        """Sign of the damper's forces that are beyond the limit, 0 of others."""
        return np.where(np.abs(force) > self.damper.max_force, np.sign(force), 0.0)

    def _road(
        self, steps: Steps, k: int, shape: tuple[int, ...], roads: NDArray[np.intp] | None
    ) -> FloatArray:
        """Road r at stages, middle and end, (S, 4, R)."""
        piece = steps.piece[: shape[0], k]
        which: Any = (piece[:, np.newaxis], roads)
        if roads is None:  # the first ones: a slice is quicker
            which = (piece, slice(shape[1]))
        before, after = self.drops[which], self.drops[1:][which]
        share = steps.share[: shape[0], k]
        return before[:, np.newaxis] + share * (after - before)[:, np.newaxis]

    def damper_force(self, damping: FloatArray, velocity: FloatArray) -> FloatArray:
        """Force of the damper [N], kept within its limit."""
        force = damping * velocity
        limit = self.damper.max_force
        return force if limit == np.inf else np.clip(force, -limit, limit)

    def _lagged(self, now: Ends, durations: FloatArray) -> FloatArray:
        """Damping some durations (S, m, 1) after the last known one, (S, m or 1, R)."""
        damping = now.damping[:, np.newaxis]
        if self.damper.lag == 0:
            return damping
        command = now.command[:, np.newaxis]
        return command + (damping - command) * np.exp(-durations / self.damper.lag)


def _raise_peak(
    peak: FloatArray, start: FloatArray, after: FloatArray, counted: NDArray[np.bool_]
) -> None:
    """Raise the largest moments (S, R) by those of a step at its start and `POINTS`, (S, 4, R)."""
    largest = np.maximum(_over_points(np.maximum, after), start)
    if not counted.all():
        largest = np.where(counted, largest, -np.inf)
    np.maximum(peak, largest, out=peak)
    near = largest > peak - CLOSE * np.abs(peak)
    if near.any():
        samples = np.stack([start[near], *(after[:, i][near] for i in range(len(POINTS)))], axis=1)
        turns = (samples @ QUARTIC[:, 1] > 0) & (samples @ SLOPE_AT_END < 0)
        within = np.flatnonzero(near)[turns]
        peak.flat[within] = np.maximum(peak.flat[within], (samples[turns] @ BETWEEN).max(axis=1))


def _over_points(which: np.ufunc, values: FloatArray) -> FloatArray:
    """Least or largest of values (S, 4, R) at the points: quicker than a reduction of an axis."""
    return np.asarray(which(which(values[:, 0], values[:, 1]), which(values[:, 2], values[:, 3])))
