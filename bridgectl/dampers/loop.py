"""The run of crossings with a damper in the loop, all speeds and roads side by side.

The damping is held over a sample (or follows its lag exactly); between samples the crossing is
advanced by the exact steps of `bridgectl.dampers.steps`.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from bridgectl._checks import FloatArray
from bridgectl.crossing import Crossing

from . import steps as st
from .actuator import Damper
from .batch_law import BatchLaw
from .steps import (
    AXLE,
    BODY,
    STAGES,
    STATES,
    TIRE,
    Plan,
    Responses,
    Steps,
    longest_step,
    make_plan,
    make_steps,
)
from .strategy import SIGNALS

SUBSTITUTIONS = 4
"""How often the forces of a step are put into its equations: each gains more than a digit."""

CLOSE = 3e-3
"""How far below the largest moment so far a step's samples may lie and its peak above it."""

BYTES = 32e6
"""Memory that the matrices of the steps made at once may take."""

RECORDED = (*SIGNALS[:-2], "damping")
"""Histories that can be recorded: what a strategy measures, and c [N s/m]."""


@dataclass(frozen=True, eq=False)
class LoopResult:
    """A crossing of each speed and road, found by `simulate_loop`: shapes (n_speeds, n_roads).

    Attributes
    ----------
    daf : ndarray
        Peak moment over the peak static one [-].
    least_force : ndarray
        Least tire force over its static load [-], from the first station to the last.
    dissipated : ndarray
        Energy that the damper has taken out [J].
    switches : ndarray
        Number of times that the command crosses the middle of its range.
    histories : tuple of dict
        For each speed, what was recorded by name, shape (n_roads, n_samples): samples of the
        controller, the first at the first station. See `simulate_loop` for their units.
    """

    daf: FloatArray
    least_force: FloatArray
    dissipated: FloatArray
    switches: NDArray[np.intp]
    histories: tuple[dict[str, FloatArray], ...] = ()

    def __repr__(self) -> str:
        recorded = ", ".join(self.histories[0]) if self.histories else "nothing"
        return (
            f"LoopResult({self.daf.shape[0]} speeds, {self.daf.shape[1]} roads, DAF from "
            f"{self.daf.min():.4f} to {self.daf.max():.4f}, least force "
            f"{self.least_force.min():.3f} of the static load, up to {self.dissipated.max():.3g} J "
            f"dissipated and {self.switches.max()} switches, recorded: {recorded})"
        )

    def of_speeds(self, order: NDArray[np.intp]) -> LoopResult:
        """Return the speeds in another order.

        Parameters
        ----------
        order : ndarray of int, shape (n_speeds,)
            Which speeds, by number from 0.

        Returns
        -------
        LoopResult
        """
        return LoopResult(
            self.daf[order], self.least_force[order], self.dissipated[order], self.switches[order],
            tuple(self.histories[i] for i in order) if self.histories else (),
        )  # fmt: skip

    def of_roads(self, roads: slice) -> LoopResult:
        """Return some of the roads; the histories are as they were recorded.

        Parameters
        ----------
        roads : slice
            Which roads, by number from 0.

        Returns
        -------
        LoopResult
        """
        return LoopResult(
            self.daf[:, roads], self.least_force[:, roads], self.dissipated[:, roads],
            self.switches[:, roads], self.histories,
        )  # fmt: skip


@dataclass
class Ends:
    """A run at the end of a step: arrays (S, R); states (S, 1 + n, R), the first row ones."""

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
    energy: FloatArray
    switches: NDArray[np.intp]


class Loop:
    """A run: speeds rise, and each road is level up to the station of `begins`.

    Until there a road is the same as the first, which must be level throughout if any `begins`
    lies beyond the first station; then `begins` must rise. Histories named by `record` are kept of
    the roads of the slice `recorded`.
    """

    def __init__(
        self,
        crossing: Crossing,
        damper: Damper,
        speeds: FloatArray,
        stations: FloatArray,
        elevations: FloatArray,
        record: tuple[str, ...] = (),
        recorded: slice = slice(None),
        begins: FloatArray | None = None,
    ) -> None:
        self.crossing, self.damper, self.speeds = crossing, damper, speeds
        self.stations, self.recorded = stations, recorded
        # Positive down, one row a station.
        self.drops = np.ascontiguousarray((elevations[:, :1] - elevations).T)
        linear = crossing.linear
        self.weight, self.stiffness = linear.static_loads[0], linear.tire_stiffnesses[0]
        longest = min(longest_step(crossing, damper.strategy.c_max), damper.sample_time)
        self.responses = Responses(crossing, longest)
        self.plan: Plan = make_plan(crossing, speeds, stations, damper.sample_time, longest)
        gains = damper.strategy.gains_for(crossing, speeds, stations, elevations)
        # What is set once for each crossing differs between roads from the start.
        every = np.full(len(elevations), stations[0])
        self.begins = every if begins is None or gains else begins
        self.law = BatchLaw(damper.strategy, [*speeds], gains)
        self.law.foresee(self.plan.edges[..., 0], speeds)
        self.middle = (damper.strategy.c_min + damper.strategy.c_max) / 2
        self.rng = np.random.default_rng(damper.seed)
        self.kept: dict[str, list[FloatArray]] = {name: [] for name in record}

    def run(self, observe: Callable[[Ends, float], None] = lambda now, x: None) -> LoopResult:
        """Advance all speeds and roads from the first station to the last.

        `observe` is told the state after each step, and how far the fastest has come [m].
        """
        now, plan = self._start(), self.plan
        known = 1  # roads whose first ramp has been reached: they follow the first until then
        for rounds, on_bridge in self._chunks():
            here = plan.at_work(rounds)
            steps = make_steps(
                self.crossing, self.responses, self.speeds[:here], plan.edges[:here, rounds],
                self.stations, on_bridge=on_bridge,
            )  # fmt: skip
            per_round = plan.edges.shape[2] - 1
            for k in range(rounds.start, rounds.stop):
                here = plan.at_work(slice(k, k + 1))
                known = self._follow(now, known, plan.edges[:here, k, -1].max())
                view = _view(now, here, known)
                self._sample(view, k)
                for step in range(per_round):
                    column = (k - rounds.start) * per_round + step
                    if steps.durations[:here, column].any():
                        self._advance(view, steps, column, on_bridge=on_bridge)
                        observe(view, float(plan.edges[here - 1, k, step + 1]))
        self._follow(now, known, np.inf)
        return LoopResult(
            now.peak, now.least / self.weight, now.energy, now.switches, self._histories()
        )

    def _start(self) -> Ends:
        shape = len(self.speeds), len(self.begins)
        states = np.zeros((shape[0], 1 + self.crossing.n_states, shape[1]))
        states[:, 0] = 1.0
        weight, zeros = np.full(shape, self.weight), np.zeros(shape)
        return Ends(
            states, weight, weight.copy(), zeros, zeros.copy(), zeros.copy(),
            np.full(shape, -np.inf), np.full(shape, np.inf), zeros.copy(),
            np.zeros(shape, dtype=np.intp),
        )  # fmt: skip

    def _chunks(self) -> Iterable[tuple[slice, bool]]:
        """Rounds whose steps are made together, and whether they may reach the bridge."""
        n, (_, n_rounds, edges) = self.crossing.n_states, self.plan.edges.shape
        per_round = 8 * len(self.speeds) * (edges - 1) * (STATES + n) * (5 + n)
        size = max(1, int(BYTES / per_round))
        ends = [0, self.plan.entry, n_rounds]
        for first, last, on_bridge in ((*ends[:2], False), (*ends[1:], True)):
            for k in range(first, last, size):
                yield slice(k, min(k + size, last)), on_bridge

    def _follow(self, now: Ends, known: int, place: float) -> int:
        """Let the roads that have a ramp before a place begin as the first road is by now."""
        reached = max(known, int(np.searchsorted(self.begins, place)))
        if reached > known:
            for array in vars(now).values():
                array[..., known:reached] = array[..., :1]
        return reached

    def _sample(self, now: Ends, k: int) -> None:
        """Measure, command, and record: the controller's part of a round."""
        first = self.plan.first[: len(now.force)] == k
        signals = self._signals(now, k, first)
        wanted = self.law(signals, k)
        if wanted.shape != now.command.shape:
            wanted = np.broadcast_to(wanted, now.command.shape)
        switched = (wanted > self.middle) != (now.command > self.middle)
        switched[first] = False
        now.switches += switched
        now.command[:] = wanted
        jumps = np.ones_like(first) if self.damper.lag == 0 else first
        now.damping[jumps] = wanted[jumps]
        now.sampled_force[:] = now.force
        for name, kept in self.kept.items():
            source = (now.damping if name == "damping" else signals[name])[:, self.recorded]
            values = np.zeros((len(self.speeds), source.shape[1]))
            values[: len(source)] = source
            kept.append(values)

    def _signals(self, now: Ends, k: int, first: NDArray[np.bool_]) -> Mapping[str, FloatArray]:
        """What the controller measures, by name: arrays (S, R), or (S, 1) for all roads alike."""
        n, here = self.crossing.n_vehicle, len(now.force)
        vehicle, linear = now.states[:, 1 : n + 1], self.crossing.linear
        velocity = vehicle[:, BODY] - vehicle[:, AXLE]
        damper = self.damper_force(now.damping, velocity)
        beyond = now.force - self.weight
        rates = {
            row: np.tensordot(vehicle, linear.state_matrix[row], (1, 0))
            + linear.tire_input[row, 0] * beyond
            + linear.damper_input[row, 0] * damper
            for row in (BODY, AXLE)
        }
        body, axle = vehicle[:, BODY], vehicle[:, AXLE]
        if self.damper.velocity_noise:
            noise = self.rng.normal(0.0, self.damper.velocity_noise, (2, *velocity.shape))
            body, axle = body + noise[0], axle + noise[1]
            velocity = body - axle
        change = (now.force - now.sampled_force) / self.damper.sample_time
        change[first] = 0.0
        return {
            "body_velocity": body, "axle_velocity": axle,
            "suspension_travel": vehicle[:, BODY - 1] - vehicle[:, AXLE - 1],
            "suspension_velocity": velocity,
            "body_acceleration": rates[BODY], "axle_acceleration": rates[AXLE],
            "tire_force": now.force, "tire_force_rate": change,
            "position": self.plan.edges[:here, k, :1], "speed": self.speeds[:here, np.newaxis],
        }  # fmt: skip

    def _advance(self, now: Ends, steps: Steps, k: int, *, on_bridge: bool) -> None:
        """One step: states, forces, moment and what is gathered of them."""
        here, n_states = len(now.force), steps.free.shape[-1]
        duration = steps.durations[:here, k, np.newaxis]
        road = self._road(steps, k, now.force.shape)
        free = steps.free[:here, k] @ now.states[:, :n_states]
        forced = steps.forced[:here, k]
        damping = self._lagged(now, duration[..., np.newaxis] * STAGES[:, np.newaxis])
        known = free[:, : st.DAMPER.stop]
        known[:, TIRE] -= road[:, TIRE]
        values, forces = known, np.empty_like(known)
        for attempt in range(SUBSTITUTIONS):
            if attempt:
                values = forced[:, : st.DAMPER.stop] @ forces
                values += known
            self._tire_force(values[:, TIRE], forces[:, TIRE])
            forces[:, st.DAMPER] = self.damper_force(damping, values[:, st.DAMPER])
        free[:, st.DAMPER.stop :] += forced[:, st.DAMPER.stop :] @ forces
        now.states[:, 1:n_states] = free[:, STATES:]
        tire = free[:, st.TIRE_LATER]
        tire -= road[:, 2:]
        middle, end = np.moveaxis(self._tire_force(tire, tire), 1, 0)
        now.force[:] = end
        np.minimum(now.least, np.minimum(middle, end), out=now.least)
        power = forces[:, st.DAMPER] * values[:, st.DAMPER]
        now.energy += duration * power.mean(axis=1)
        now.damping[:] = self._lagged(now, duration[..., np.newaxis])[:, 0]
        if on_bridge:
            moment = free[:, st.MOMENT]
            moment += steps.influence[:here, k] * tire
            _raise_peak(now.peak, now.moment, *np.moveaxis(moment, 1, 0))
            now.moment[:] = moment[:, 1]

    def _road(self, steps: Steps, k: int, shape: tuple[int, ...]) -> FloatArray:
        """Road r at stages, middle and end, (S, 4, R)."""
        piece = steps.piece[: shape[0], k]
        before = self.drops[piece, : shape[1]][:, np.newaxis]
        after = self.drops[piece + 1, : shape[1]][:, np.newaxis]
        return before + steps.share[: shape[0], k] * (after - before)

    def _tire_force(self, closer: FloatArray, out: FloatArray) -> FloatArray:
        """R = W + K_t (y_t - v - r) >= 0, Eq. (2), of y_t - v - r."""
        np.multiply(closer, self.stiffness, out=out)
        out += self.weight
        return np.maximum(out, 0.0, out=out)

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

    def _histories(self) -> tuple[dict[str, FloatArray], ...]:
        every = {name: np.array(kept) for name, kept in self.kept.items()}
        return tuple(
            {name: values[first:last, i].T.copy() for name, values in every.items()}
            for i, (first, last) in enumerate(zip(self.plan.first, self.plan.last, strict=True))
        )


def _view(now: Ends, n_speeds: int, n_roads: int) -> Ends:
    """The slowest speeds and the first roads of a state."""
    return Ends(**{k: v[:n_speeds, ..., :n_roads] for k, v in vars(now).items()})


def _raise_peak(peak: FloatArray, start: FloatArray, middle: FloatArray, end: FloatArray) -> None:
    """Raise the largest moments by the parabolas through a step's start, middle and end."""
    np.maximum(peak, middle, out=peak)
    np.maximum(peak, end, out=peak)
    near = middle > peak - CLOSE
    if near.any():
        first, at, last = start[near], middle[near], end[near]
        bend, slope = 2 * at - first - last, last - first
        inside = np.abs(slope) < 2 * bend
        rise = np.divide(slope**2, 8 * bend, out=np.zeros_like(bend), where=inside)
        peak[near] = np.maximum(peak[near], np.where(inside, at + rise, at))
