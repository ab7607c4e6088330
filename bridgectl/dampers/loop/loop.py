"""The run of crossings with a damper in the loop, all speeds and roads side by side.

The damping is held over a sample (or follows its lag exactly); between samples the crossing is
advanced by the exact steps of `bridgectl.dampers.loop.steps`, cut at the events of
`bridgectl.dampers.loop.events`.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping

import numpy as np
from numpy.typing import NDArray

from bridgectl._checks import FloatArray
from bridgectl.dampers.actuator import Damper
from bridgectl.dampers.loop.advance import Ends, Stepper
from bridgectl.dampers.loop.batch_law import BatchLaw
from bridgectl.dampers.loop.controller import Controller
from bridgectl.dampers.loop.noise import Errors
from bridgectl.dampers.loop.result import LoopResult
from bridgectl.dampers.loop.steps import (
    AXLE,
    BODY,
    STATES,
    Plan,
    Responses,
    longest_step,
    make_plan,
    times_within,
)
from bridgectl.dampers.strategy import SIGNALS
from bridgectl.model.crossing import Crossing
from bridgectl.road.elevations import drops_of

BYTES = 32e6
"""Memory that the matrices of the steps made at once may take."""

RECORDED = (*SIGNALS[:-2], "damping")
"""Histories that can be recorded: what a strategy measures, and c [N s/m]."""


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
        self.recorded = recorded
        self.drops = drops_of(elevations)
        longest = longest_step(crossing, damper.strategy.c_max, crossing.beam.n_modes)
        longest = min(longest, damper.sample_time)
        responses = Responses(crossing, longest)
        self.stepper = Stepper(crossing, damper, speeds, stations, self.drops, responses)
        parts = times_within(damper.sample_time, longest, damper.lag)
        self.plan: Plan = make_plan(crossing, speeds, stations, damper.sample_time, parts)
        gains = damper.strategy.gains_for(crossing, speeds, stations, elevations)
        every = np.full(len(elevations), stations[0])
        law = BatchLaw(damper.strategy, [*speeds], gains, damper.sample_time)
        roads = stations, self.drops, crossing.beam.length
        self.errors = Errors(damper, self.plan, speeds, *roads)
        if not damper.position_deviation:  # else each road has places of its own
            law.foresee(self.plan.edges[..., 0] + self.errors.places, speeds)
        self.controller: Controller = law
        # What is set once for each crossing, its noise, or what is seen ahead differs between roads
        # from the start.
        own = bool(gains) or damper.noisy or law.preview.size > 0
        self.begins = every if begins is None or own else begins
        self.middle = (damper.strategy.c_min + damper.strategy.c_max) / 2
        self.kept: dict[str, list[FloatArray]] = {name: [] for name in record}

    def run(self, observe: Callable[[Ends, float], None] = lambda now, x: None) -> LoopResult:
        """Advance all speeds and roads from the first station to the last.

        `observe` is told the state after each step, and how far the fastest has come [m].
        """
        now, plan = self._start(), self.plan
        known = 1  # roads whose first ramp has been reached: they follow the first until then
        for rounds, on_bridge in self._chunks():
            if on_bridge and rounds.start == plan.entry:
                self._enter(now)
            here = plan.at_work(rounds)
            edges = plan.edges[:here, rounds]
            steps = self.stepper.steps(self.speeds[:here], edges, on_bridge=on_bridge)
            per_round = plan.edges.shape[2] - 1
            for k in range(rounds.start, rounds.stop):
                here = plan.at_work(slice(k, k + 1))
                known = self._follow(now, known, plan.edges[:here, k, -1].max())
                view = now.view(here, known)
                self._sample(view, k)
                for step in range(per_round):
                    column = (k - rounds.start) * per_round + step
                    if steps.durations[:here, column].any():
                        edges = plan.edges[:here, k, step : step + 2]
                        self.stepper.advance(view, steps, column, edges, on_bridge=on_bridge)
                        observe(view, float(plan.edges[here - 1, k, step + 1]))
        self._follow(now, known, np.inf)
        return LoopResult(
            self.crossing.orientation * now.peak, now.least / self.stepper.weight, now.lift_off,
            now.energy, now.switches, self._histories(),
        )  # fmt: skip

    def _start(self) -> Ends:
        shape = len(self.speeds), len(self.begins)
        states = np.zeros((shape[0], 1 + self.crossing.n_states, shape[1]))
        states[:, 0] = 1.0
        weight, zeros = np.full(shape, self.stepper.weight), np.zeros(shape)
        return Ends(
            states, weight, weight.copy(), zeros, zeros.copy(), zeros.copy(),
            np.full(shape, -np.inf), np.full(shape, np.inf), np.full(shape, np.inf), zeros.copy(),
            np.zeros(shape, dtype=np.intp), self.controller.start(*shape),
        )  # fmt: skip

    def _enter(self, now: Ends) -> None:
        """Know the effect where the rounds on the bridge begin."""
        per_force, per_state, constant = self.crossing.rows(self.plan.edges[:, self.plan.entry, 0])
        of_states = np.einsum("n,snr->sr", per_state, now.states[:, 1:])
        now.moment[:] = per_force * now.force + of_states + constant

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
        ahead = self._ahead(k, now.force.shape)
        wanted, now.memory[:] = self.controller.command(signals, now.memory, ahead, k)
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
        vehicle, linear, velocity = now.states[:, 1 : n + 1], self.crossing.linear, now.velocity
        damper = self.stepper.damper_force(now.damping, velocity)
        beyond = now.force - self.stepper.weight
        rates = {
            row: linear.state_matrix[row] @ vehicle
            + linear.tire_input[row, 0] * beyond
            + linear.damper_input[row, 0] * damper
            for row in (BODY, AXLE)
        }
        body, axle = vehicle[:, BODY], vehicle[:, AXLE]
        change = (now.force - now.sampled_force) / self.damper.sample_time
        change[first] = 0.0
        return self.errors.added(k, {
            "body_velocity": body, "axle_velocity": axle,
            "suspension_travel": vehicle[:, BODY - 1] - vehicle[:, AXLE - 1],
            "suspension_velocity": velocity,
            "body_acceleration": rates[BODY], "axle_acceleration": rates[AXLE],
            "tire_force": now.force, "tire_force_rate": change,
            "position": self.plan.edges[:here, k, :1], "speed": self.speeds[:here, np.newaxis],
        })  # fmt: skip

    def _ahead(self, k: int, shape: tuple[int, ...]) -> FloatArray:
        """Elevations ahead less that under the tire [m], (S, n, R): drops are positive down."""
        distances, x = self.controller.preview, self.stepper.stations
        if distances.shape[1] == 0:
            return np.zeros((shape[0], 0, shape[1]))
        tire = self.plan.edges[: shape[0], k, :1]
        places = np.concatenate([tire, tire + distances[: shape[0]]], axis=1)
        piece = np.clip(np.searchsorted(x, places, side="right") - 1, 0, x.size - 2)
        share = np.minimum((places - x[piece]) / (x[piece + 1] - x[piece]), 1.0)  # level beyond
        drops = self.drops[:, : shape[1]]
        found = drops[piece] + share[..., np.newaxis] * (drops[piece + 1] - drops[piece])
        return np.asarray(found[:, :1] - found[:, 1:])

    def _histories(self) -> tuple[dict[str, FloatArray], ...]:
        every = {name: np.array(kept) for name, kept in self.kept.items()}
        return tuple(
            {name: values[first:last, i].T.copy() for name, values in every.items()}
            for i, (first, last) in enumerate(zip(self.plan.first, self.plan.last, strict=True))
        )
