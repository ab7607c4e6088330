"""The run of crossings with dampers in the loop, all speeds and roads side by side.

The dampings are held over a sample (or follow their lags exactly); between samples the crossing is
advanced by the exact steps of `bridgectl.dampers.loop.steps`, cut at the events of
`bridgectl.dampers.loop.events`.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable

import numpy as np
from numpy.typing import NDArray

from bridgectl._checks import FloatArray
from bridgectl._places import SAME_PLACE
from bridgectl.dampers.fitted import Fitted
from bridgectl.dampers.legs import Legs
from bridgectl.dampers.loop.advance import Ends, Stepper
from bridgectl.dampers.loop.batch_law import BatchLaw
from bridgectl.dampers.loop.controller import Controller
from bridgectl.dampers.loop.noise import Errors
from bridgectl.dampers.loop.result import LoopResult
from bridgectl.dampers.loop.steps import (
    Plan,
    Responses,
    Rows,
    longest_step,
    make_plan,
    times_within,
)
from bridgectl.dampers.signals import SIGNALS, others_of
from bridgectl.model.crossing import Crossing
from bridgectl.road.elevations import drops_of

BYTES = 32e6
"""Memory that the matrices of the steps made at once may take."""

RECORDED = (*SIGNALS[:-2], "damping")
"""Histories that can be recorded: what a strategy measures at each leg, and c [N s/m]; of the tire
force that of each tire."""


class Loop:
    """A run: speeds rise, and each road is level up to the station of `begins`.

    Until there a road is the same as the first, which must be level throughout if any `begins`
    lies beyond the first station; then `begins` must rise. Histories named by `record` are kept of
    the roads of the slice `recorded`.

    The vehicle starts at rest on the road under each axle, which is level before its first station;
    the reference tire at the first station, or further on at `start` [m].
    """

    def __init__(
        self,
        crossing: Crossing,
        dampers: Fitted,
        speeds: FloatArray,
        stations: FloatArray,
        elevations: FloatArray,
        record: tuple[str, ...] = (),
        recorded: slice = slice(None),
        begins: FloatArray | None = None,
        start: float | None = None,
    ) -> None:
        self.crossing, self.dampers, self.speeds = crossing, dampers, speeds
        self.legs, self.recorded = Legs(crossing.linear), recorded
        self.every_speed = np.tile(speeds[:, np.newaxis, np.newaxis], (1, len(dampers.legs), 1))
        stations, elevations = level_beyond(crossing, stations, elevations)
        self.drops, self.start = drops_of(elevations), stations[0] if start is None else start
        longest = longest_step(crossing, dampers.dampings, crossing.beam.n_modes)
        longest = min(longest, dampers.sample_time)
        responses = Responses(crossing, longest)
        self.stepper = Stepper(crossing, dampers, speeds, stations, self.drops, responses)
        lags = sorted({damper.lag for damper in dampers.dampers})
        within = [times_within(dampers.sample_time, longest, lag) for lag in lags]
        parts = within[0] if len(within) == 1 else np.unique(np.concatenate(within))
        self.plan: Plan = make_plan(
            crossing, speeds, stations, dampers.sample_time, parts, self.start
        )
        self.others = [  # what each law measures of other legs
            others_of(damper.strategy.name, damper.strategy.signals, self.legs.names)
            for damper in dampers.dampers
        ]
        self.controllers: list[Controller] = []
        self.errors: list[Errors] = []
        every = np.full(len(elevations), self.start)
        ahead = stations >= self.start - SAME_PLACE
        own = False
        for leg, damper in enumerate(dampers.dampers):
            gains = damper.strategy.gains_for(
                crossing, speeds, stations[ahead], elevations[:, ahead]
            )
            told = speeds * (1 + damper.speed_error)
            law = BatchLaw(damper.strategy, [*told], gains, damper.sample_time)
            roads, behind = (stations, self.drops, crossing.beam.length), self.legs.offsets[leg]
            of_leg = dampers.legs[leg], law.preview.shape[1], self.start - behind
            errors = Errors(damper, self.plan, speeds, *roads, *of_leg)
            if not damper.position_deviation:  # else each road has places of its own
                places = errors.told(self.plan.edges[..., 0] - behind) + errors.places
                law.foresee(places, told)
            self.controllers.append(law)
            self.errors.append(errors)
            # What is set once for each crossing, its noise, or what is seen ahead differs between
            # roads from the start.
            own |= bool(gains) or damper.noisy or law.preview.size > 0
        self.begins = every if begins is None or own else begins
        strategies = [damper.strategy for damper in dampers.dampers]
        self.middle = [(law.c_min + law.c_max) / 2 for law in strategies]
        self.kept: dict[str, list[FloatArray]] = {name: [] for name in record}

    def run(self, observe: Callable[[Ends, float], None] = lambda now, x: None) -> LoopResult:
        """Advance all speeds and roads from the first station to the last.

        `observe` is told the state after each step, and how far the fastest has come [m].
        """
        now, plan = self.at_start(), self.plan
        view = now  # of those under way, as they change: made anew where these do
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
                if view.peak.shape != (here, known):
                    view = now.view(here, known)
                self._sample(view, k)
                for step in range(per_round):
                    column = (k - rounds.start) * per_round + step
                    if steps.durations[:here, column].any():
                        edges = plan.edges[:here, k, step : step + 2]
                        self.stepper.advance(view, steps, column, edges, on_bridge=on_bridge)
                        observe(view, float(plan.edges[here - 1, k, step + 1]))
        self._follow(now, known, np.inf)
        least = (now.least / self.stepper.weights[:, np.newaxis]).min(axis=1)
        return LoopResult(
            self.crossing.orientation * now.peak, least, now.lift_off, now.energy.sum(axis=1),
            now.switches.sum(axis=1), self._histories(),
        )  # fmt: skip

    def at_start(self) -> Ends:
        """The vehicle at rest, before an unloaded bridge."""
        n_speeds, n_roads = shape = len(self.speeds), len(self.begins)
        states = np.zeros((n_speeds, 1 + self.crossing.n_states, n_roads))
        states[:, 0] = 1.0
        vehicle, places = self.crossing.linear, self.crossing.tire_positions(self.start)
        x = self.stepper.stations
        road = np.stack([np.interp(places, x, each) for each in self.drops.T], axis=1)
        stiffness = vehicle.tire_stiffnesses[:, np.newaxis]
        at_rest = vehicle.flexibility @ vehicle.tire_map.T @ (stiffness * road)
        states[:, 1 : 1 + len(at_rest)] = at_rest
        pushed = stiffness * (vehicle.hubs @ at_rest - road)
        weights = np.tile(self.stepper.weights[:, np.newaxis] + pushed, (n_speeds, 1, 1))
        of_dampers = n_speeds, len(self.controllers), n_roads
        memories = [controller.start(*shape) for controller in self.controllers]
        self.of_memory = np.cumsum([0, *(memory.shape[1] for memory in memories)])
        return Ends(
            states, weights, weights.copy(), np.zeros(shape), np.zeros(of_dampers),
            np.zeros(of_dampers), np.full(shape, -np.inf), np.full(weights.shape, np.inf),
            np.full(shape, np.inf), np.zeros(of_dampers), np.zeros(of_dampers, dtype=np.intp),
            np.concatenate(memories, axis=1),
        )  # fmt: skip

    def _enter(self, now: Ends) -> None:
        """Know the effect where the rounds on the bridge begin."""
        per_force, per_state, constant = self.crossing.rows(self.plan.edges[:, self.plan.entry, 0])
        of_states = np.einsum("n,snr->sr", per_state, now.states[:, 1:])
        of_forces = (per_force[..., np.newaxis] * now.force).sum(axis=1)
        now.moment[:] = of_forces + of_states + constant

    def _chunks(self) -> Iterable[tuple[slice, bool]]:
        """Rounds whose steps are made together, and whether they may reach the bridge."""
        n, (_, n_rounds, edges) = self.crossing.n_states, self.plan.edges.shape
        rows = Rows.of_crossing(self.crossing)
        per_round = 8 * len(self.speeds) * (edges - 1) * (rows.states + n)
        per_round *= rows.damper.stop + 1 + n
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
        """Measure, command, and record: the controllers' part of a round."""
        first = self.plan.first[: len(now.force)] == k
        measured = self._signals(now, k, first)
        told = [
            errors.added(k, {name: values[:, leg] for name, values in measured.items()})
            for leg, errors in enumerate(self.errors)
        ]
        for leg, (controller, damper) in enumerate(
            zip(self.controllers, self.dampers.dampers, strict=True)
        ):
            others = {name: told[of][signal] for name, signal, of in self.others[leg]}
            memory = now.memory[:, slice(*self.of_memory[leg : leg + 2])]
            ahead = self.errors[leg].ahead(k, self._ahead(k, now.peak.shape, leg))
            wanted, memory[:] = controller.command({**told[leg], **others}, memory, ahead, k)
            command = now.command[:, leg]
            switched = (wanted > self.middle[leg]) != (command > self.middle[leg])
            switched[first] = False
            now.switches[:, leg] += switched
            command[:] = wanted
            jumps = slice(None) if damper.lag == 0 else first
            now.damping[jumps, leg] = wanted[jumps]
        now.sampled_force[:] = now.force
        for name, kept in self.kept.items():
            of_all = {"tire_force": now.force, "damping": now.damping}.get(name)
            source = np.stack([own[name] for own in told], axis=1) if of_all is None else of_all
            source = source[..., self.recorded]
            values = np.zeros((len(self.speeds), *source.shape[1:]))
            values[: len(source)] = source
            kept.append(values)

    def _signals(self, now: Ends, k: int, first: NDArray[np.bool_]) -> dict[str, FloatArray]:
        """What happens at the legs, by name: arrays (S, D, R), or (S, D, 1) for all roads alike."""
        n, here, legs = self.crossing.n_vehicle, len(now.force), self.legs
        found = legs.reading @ now.states[:, 1 : n + 1]
        count = len(legs.rate)
        body, axle, velocity, travel = (found[:, i * count : (i + 1) * count] for i in range(4))
        rates, beyond = found[:, 4 * count :], now.force - self.stepper.weights[:, np.newaxis]
        rates += legs.per_tire @ beyond
        rates += legs.per_damper @ self.stepper.damper_force(now.damping, velocity)
        change = legs.under(now.force - now.sampled_force) / self.dampers.sample_time
        change[first] = 0.0
        place = self.plan.edges[:here, k, :1] - legs.offsets
        return {
            "body_velocity": body, "axle_velocity": axle, "suspension_travel": travel,
            "suspension_velocity": velocity,
            "body_acceleration": rates[:, :count], "axle_acceleration": rates[:, count:],
            "tire_force": legs.under(now.force), "tire_force_rate": change,
            "position": place[..., np.newaxis], "speed": self.every_speed[:here],
        }  # fmt: skip

    def _ahead(self, k: int, shape: tuple[int, ...], leg: int) -> FloatArray:
        """Elevations ahead less that under the tire [m], (S, n, R): drops are positive down.

        Where the tire was when they were seen.
        """
        distances, x = self.controllers[leg].preview, self.stepper.stations
        if distances.shape[1] == 0:
            return np.zeros((shape[0], 0, shape[1]))
        tire = self.plan.edges[: shape[0], k, :1] - self.legs.offsets[leg]
        tire = tire - self.errors[leg].delay * self.speeds[: shape[0], np.newaxis]
        places = np.concatenate([tire, tire + distances[: shape[0]]], axis=1)
        piece = np.clip(np.searchsorted(x, places, side="right") - 1, 0, x.size - 2)
        share = np.clip((places - x[piece]) / (x[piece + 1] - x[piece]), 0.0, 1.0)  # level beyond
        drops = self.drops[:, : shape[1]]
        found = drops[piece] + share[..., np.newaxis] * (drops[piece + 1] - drops[piece])
        return np.asarray(found[:, :1] - found[:, 1:])

    def _histories(self) -> tuple[dict[str, FloatArray], ...]:
        """Of each speed by name: (R, samples), of several legs or tires (D or T, R, samples)."""
        every = {name: np.moveaxis(np.array(kept), 0, -1) for name, kept in self.kept.items()}
        return tuple(
            {name: _one(values[i, ..., first:last]) for name, values in every.items()}
            for i, (first, last) in enumerate(zip(self.plan.first, self.plan.last, strict=True))
        )


def _one(values: FloatArray) -> FloatArray:
    """A copy of histories (D or T, R, samples); of the only one (R, samples)."""
    return np.array(values[0] if len(values) == 1 else values)


def level_beyond(
    crossing: Crossing, stations: FloatArray, elevations: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """Lengthen roads (n_roads, n) by a level piece to where the last tire leaves the bridge."""
    if stations[-1] >= crossing.exit - SAME_PLACE:
        return stations, elevations
    return np.append(stations, crossing.exit), np.hstack([elevations, elevations[:, -1:]])
