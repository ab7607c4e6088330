"""One step of crossings with a damper in the loop, all speeds and roads side by side.

A step is solved for all of them at once; those in which a tire leaves or meets the road, or a
damper's force its limit, go through it anew from event to event, each by steps of its own.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from bridgectl._checks import FloatArray
from bridgectl.dampers.fitted import Fitted
from bridgectl.dampers.loop.events import GRAZING, MOST, Bounds, Regime
from bridgectl.dampers.loop.steps import MOMENT, POINTS, STAGES, Responses, Rows, Steps, make_steps
from bridgectl.model.crossing import Crossing

SUBSTITUTIONS = 4
"""How often the forces of a step are put into its equations: each gains more than a digit."""

NO_LAG = 1e-12
"""Lag [s] of a damper without one, beside others: at the end of no step does it matter."""

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
    """A run at the end of a step, of S speeds, R roads, T tires and D dampers.

    States are (S, 1 + n, R), the first row ones; the controllers' memory is (S, m, R).
    """

    states: FloatArray
    force: FloatArray
    """Tire forces [N], (S, T, R)."""
    sampled_force: FloatArray
    """Tire forces at the last sample [N], (S, T, R)."""
    moment: FloatArray
    """(S, R)."""
    damping: FloatArray
    """(S, D, R)."""
    command: FloatArray
    """(S, D, R)."""
    peak: FloatArray
    """(S, R)."""
    least: FloatArray
    """Least tire forces [N], (S, T, R)."""
    lift_off: FloatArray
    """(S, R)."""
    energy: FloatArray
    """(S, D, R)."""
    switches: NDArray[np.intp]
    """(S, D, R)."""
    memory: FloatArray

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
    """Dampings at the stages [N s/m], (S, 2 D, R), or (S, 1, R) of one that does not change."""
    forces: FloatArray
    """R - W and F at the stages [N], within their bounds."""
    tires: FloatArray
    """Tire forces R at the points [N], (S, 4, T, R)."""
    least: FloatArray
    """The least of them, (S, T, R)."""
    moment: FloatArray
    """The states' share of the moment at the points, on the bridge."""
    states: FloatArray
    """States at the end."""
    damping: FloatArray
    """Dampings at the end [N s/m], (S, D, R)."""


class Stepper:
    """The steps of a run: speeds rise, drops of the roads (n, R) are positive down."""

    def __init__(
        self,
        crossing: Crossing,
        dampers: Fitted,
        speeds: FloatArray,
        stations: FloatArray,
        drops: FloatArray,
        responses: Responses,
    ) -> None:
        self.crossing, self.speeds = crossing, speeds
        self.stations, self.drops, self.responses = stations, drops, responses
        self.rows, linear = Rows.of_crossing(crossing), crossing.linear
        self.weights = linear.static_loads
        self.rates = linear.damper_map @ linear.velocities
        lags = [damper.lag or NO_LAG for damper in dampers.dampers]
        self.lags, self.lagging = np.array(lags)[:, np.newaxis], max(lags) > NO_LAG
        self.of_lags = (STAGES[:, np.newaxis] / lags).reshape(-1, 1)
        self.limits = np.array([damper.max_force for damper in dampers.dampers])
        self.stiffnesses = linear.tire_stiffnesses
        # What goes with rows of forces at the stages, one after the other.
        self.stiffness, self.at_rest, most = (
            _at_stages(each) for each in (self.stiffnesses, self.weights, self.limits)
        )
        self.limiting = bool((self.limits < np.inf).any())
        limit = most if self.limiting else None
        self.bounds = Bounds(-self.at_rest, None, limit if limit is None else -limit, limit)

    def velocity(self, states: FloatArray) -> FloatArray:
        """Suspension velocities y_s' - y_t' [m/s], (S, D, R), of states (S, n, R)."""
        return self.rates @ states[:, : self.rates.shape[1]]

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
        here, n_states, rows = len(now.force), steps.free.shape[-1], self.rows
        duration = steps.durations[:here, k, np.newaxis, np.newaxis]
        road = self._road(steps, k, now.force.shape, roads)
        free = steps.free[:here, k] @ now.states[:, :n_states]
        forced = steps.forced[:here, k]
        damping = self._at_stages(now, duration)
        known = free[:, : rows.damper.stop]
        known[:, rows.tire] -= road[:, rows.tire]
        values, forces = known, np.empty_like(known)
        for attempt in range(SUBSTITUTIONS):
            if attempt:
                values = forced[:, : rows.damper.stop] @ forces
                values += known
            np.multiply(values[:, rows.tire], self.stiffness, out=forces[:, rows.tire])
            np.multiply(values[:, rows.damper], damping, out=forces[:, rows.damper])
            bounds.apply(forces, rows)
        free[:, rows.damper.stop :] += forced[:, rows.damper.stop :] @ forces
        later = free[:, rows.later]
        later -= road[:, rows.tire.stop :]
        tires = np.empty((here, 2 * rows.tire.stop, forces.shape[2]))
        np.add(forces[:, rows.tire], self.at_rest, out=tires[:, rows.tire])
        pulling = tires[:, rows.tire.stop :]
        np.multiply(later, self.stiffness, out=pulling)
        pulling += self.at_rest
        np.maximum(tires, 0.0, out=tires)
        tires = tires.reshape(here, len(POINTS), -1, forces.shape[2])
        end = self._lagged(now, duration)
        return Taken(
            values, later, damping, forces, tires, _over_points(np.minimum, tires),
            free[:, MOMENT], free[:, rows.states : rows.states + n_states - 1], end,
        )  # fmt: skip

    def _accept(self, now: Ends, steps: Steps, k: int, taken: Taken, *, on_bridge: bool) -> None:
        """Let a step count: states, forces, moment and what is gathered of them."""
        here = len(now.force)
        now.states[:, 1 : 1 + taken.states.shape[1]] = taken.states
        now.force[:] = taken.tires[:, -1]
        np.minimum(now.least, taken.least, out=now.least)
        each, count = self.rows.damper, len(self.limits)
        power = taken.forces[:, each] * taken.stages[:, each]
        power = power[:, :count] + power[:, count:]
        now.energy += steps.durations[:here, k, np.newaxis, np.newaxis] / 2 * power
        now.damping[:] = taken.damping
        if on_bridge:
            moment, influence = taken.moment, steps.influence[:here, k]
            for tire in range(len(self.weights)):
                moment += taken.tires[:, :, tire] * influence[:, :, tire]
            counted = steps.counted[:here, k, np.newaxis]
            if counted.any():
                _raise_peak(now.peak, now.moment, moment, counted)
            now.moment[:] = moment[:, -1]

    def _through_events(
        self, now: Ends, cases: Cases, edges: FloatArray, *, on_bridge: bool
    ) -> None:
        """One step of some cases, from event to event."""
        x, end = edges.T
        of_dampers = now.damping * self.velocity(now.states[:, 1:])
        regime = Regime(now.force[..., 0] > 0, self._limited(of_dampers)[..., 0])
        for attempt in range(MOST):
            last = attempt == MOST - 1  # a force that grazes its bound has all of its bounds
            bounds = self.bounds if last else regime.bounds(self.weights, self.limits)
            steps, taken = self._case_step(now, cases, x, end, bounds, on_bridge=on_bridge)
            place = regime.next_event(
                self._tire_forces(taken)[..., 0], self._damper_forces(now, taken)[..., 0],
                self.limits,
            )  # fmt: skip
            share = 1.0 if last else np.clip(place.min(axis=1), GRAZING, 1.0)
            event = place <= np.reshape(share, (-1, 1))
            reach = np.where(share < 1, x + share * (end - x), end)
            if np.any(reach < end):
                steps, taken = self._case_step(now, cases, x, reach, bounds, on_bridge=on_bridge)
            self._accept(now, steps, 0, taken, on_bridge=on_bridge)
            leaves = (event[:, : regime.touching.shape[1]] & regime.touching).any(axis=1)
            now.lift_off[leaves, 0] = np.minimum(now.lift_off[:, 0], reach)[leaves]
            ends = now.damping * self.velocity(now.states[:, 1:])
            regime = regime.after(event, ends[..., 0])
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
        return steps, self._take(now, steps, 0, bounds, cases[1][:, np.newaxis, np.newaxis])

    def _with_events(self, now: Ends, taken: Taken) -> Cases:
        """Cases of which a tire leaves or meets the road, or a damper's force its limit."""
        turning = np.zeros(now.peak.shape, dtype=bool)
        if min(now.force.min(), taken.least.min()) <= 0:
            off = np.concatenate([now.force[:, np.newaxis], taken.tires], axis=1) <= 0
            turning |= np.any(off.any(axis=1) & ~off.all(axis=1), axis=1)
        if self.limiting:
            limited = self._limited(self._damper_forces(now, taken))
            turning |= (limited[:, 1:] != limited[:, :1]).any(axis=(1, 2))
        speeds, roads = np.nonzero(turning)
        return speeds, roads

    def _tire_forces(self, taken: Taken) -> FloatArray:
        """R at `TIRE_NODES` [N] if the tires could pull, (S, 4, T, R)."""
        stages, later = taken.stages[:, self.rows.tire], taken.later
        n_tires = len(self.weights)
        # In the order of places: a stage, the middle, the other stage, the end.
        closer = [of[:, i : i + n_tires] for i in (0, n_tires) for of in (stages, later)]
        found = self.stiffnesses[:, np.newaxis] * np.stack(closer, axis=1)
        return np.asarray(self.weights[:, np.newaxis] + found)

    def _damper_forces(self, now: Ends, taken: Taken) -> FloatArray:
        """F at `DAMPER_NODES` without their limits [N], (S, 4, D, R)."""
        stages, count = taken.coefficients * taken.stages[:, self.rows.damper], len(self.limits)
        start = now.damping * self.velocity(now.states[:, 1:])
        end = taken.damping * self.velocity(taken.states)
        return np.stack([start, stages[:, :count], stages[:, count:], end], axis=1)

    def _limited(self, forces: FloatArray) -> FloatArray:
        """Sign of dampers' forces (..., D, R) that are beyond the limit, 0 of others."""
        return np.where(np.abs(forces) > self.limits[:, np.newaxis], np.sign(forces), 0.0)

    def _road(
        self, steps: Steps, k: int, shape: tuple[int, ...], roads: NDArray[np.intp] | None
    ) -> FloatArray:
        """Road r under each tire at stages, middle and end, (S, 4 T, R)."""
        piece = steps.piece[: shape[0], k]
        which: Any = (piece[..., np.newaxis], roads)
        if roads is None:  # the first ones: a slice is quicker
            which = (piece, slice(shape[2]))
        before, after = self.drops[which], self.drops[1:][which]
        share = steps.share[: shape[0], k]
        found = before[:, np.newaxis] + share * (after - before)[:, np.newaxis]
        return found.reshape(len(found), -1, found.shape[3])

    def damper_force(self, damping: FloatArray, velocity: FloatArray) -> FloatArray:
        """Forces of the dampers (S, D, R) [N], kept within their limits."""
        force = damping * velocity
        limits = self.limits[:, np.newaxis]
        return np.clip(force, -limits, limits) if self.limiting else force

    def _at_stages(self, now: Ends, durations: FloatArray) -> FloatArray:
        """Dampings at the stages of steps, (S, 2 D, R), or (S, 1, R)."""
        damping, command = now.damping, now.command
        if damping.shape[1] > 1:
            damping, command = (np.concatenate([of, of], axis=1) for of in (damping, command))
        if not self.lagging:
            return damping
        return np.asarray(command + (damping - command) * np.exp(-durations * self.of_lags))

    def _lagged(self, now: Ends, durations: FloatArray) -> FloatArray:
        """Dampings some durations (S, 1, 1) after the last known ones, (S, D, R)."""
        if not self.lagging:
            return now.damping
        fading = np.exp(-durations / self.lags)
        return np.asarray(now.command + (now.damping - now.command) * fading)


def _at_stages(of: FloatArray) -> FloatArray:
    """Values of tires or dampers, a column for both stages; one number, quicker, if all are it."""
    same = np.all(of == of[0])
    return np.array(of[0]) if same else np.tile(of, 2)[:, np.newaxis]


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
    """Least or largest of values (S, 4, ...) at the points: quicker than a reduction of an axis."""
    return np.asarray(which(which(values[:, 0], values[:, 1]), which(values[:, 2], values[:, 3])))
