"""A crossing simulated by two routes: the propagator, and the control library.

The propagator (`bridgectl.linear.cells`) solves the linear crossing for many speeds at once. The
reference is `control.input_output_response` on the crossing's control system, with tight
tolerances and with the tires kept from pulling. Both give states and tire forces at the same
places.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from bridgectl import _checks
from bridgectl._checks import FloatArray
from bridgectl._places import SAME_PLACE, merge_places
from bridgectl.linear.cells import (
    N_STAGES,
    SAMPLES,
    Cells,
    bridge_entry,
    build_cells,
    road_rows,
)
from bridgectl.linear.nodes import cell_nodes, kink_positions
from bridgectl.linear.pace import speeds_at
from bridgectl.model.crossing import Crossing
from bridgectl.model.motion import Motion
from bridgectl.model.paths import LOOKED_AT
from bridgectl.model.traffic import Traffic
from bridgectl.road import RoadProfile
from bridgectl.road.elevations import falls_of
from bridgectl.road.sampling import warn_if_coarse

BESIDE = 2 * SAME_PLACE
"""How far from a place [m] what is just before or just after it is looked for."""

LIFT_OFF = 1e-9
"""Fraction of its static load by which a tire force may be negative through round-off."""

BATCH_BYTES = 64e6
"""Memory that the maps of the speeds treated at once may take."""


class Run(NamedTuple):
    """A crossing to simulate: where it starts and ends, the road, and motions but uniform ones."""

    crossing: Crossing
    start: float
    end: float
    profile: RoadProfile | None
    motion: Motion | None = None

    def kinks(self) -> FloatArray:
        """Where the motion is not smooth: see `kink_positions`."""
        stations = np.zeros(0) if self.profile is None else self.profile.x
        kinks = kink_positions(self.crossing, self.start, self.end, stations)
        if self.motion is None:
            return kinks
        changes = np.array(self.motion.changes)
        inside = (changes > self.start) & (changes < self.end)
        return merge_places(np.append(kinks, changes[inside]))

    def nodes(self, slowest: float, refine: int = 1, *, wide: bool = False) -> FloatArray:
        """Nodes of the cells: see `cell_nodes`."""
        slowest, wide = self.slowest(slowest), wide and self.plain
        return cell_nodes(self.crossing, slowest, self.kinks(), refine, wide=wide)

    def road(self, x: FloatArray) -> FloatArray:
        """Road r under each tire for the reference tire at x, positive downward [m]."""
        tires = self.crossing.tire_positions(x)
        if self.profile is None:
            return np.zeros_like(tires)
        return self.profile.drop(tires, self.datum, level=False)

    @property
    def datum(self) -> float:
        """Where the road counts as 0 m high: the start, if it is not one from the other end [m]."""
        return self.start if self.profile is None else max(self.start, float(self.profile.x[0]))

    def initial(self) -> FloatArray:
        """States at the start: the vehicle at rest on the road under each axle, the bridge too."""
        vehicle, state = self.crossing.linear, np.zeros(self.crossing.n_states)
        if self.profile is None or (vehicle.n_tires == 1 and not self.crossing.paths.opposite[0]):
            return state
        road = self.road(np.array(self.start))
        forces = vehicle.tire_map.T @ (vehicle.tire_stiffnesses * road)
        state[: self.crossing.n_vehicle] = vehicle.flexibility @ forces
        return state

    def road_inputs(self, motion: Motion, x: FloatArray) -> FloatArray:
        """Inputs of the crossing's system for the road at places, (n_inputs, m)."""
        inputs = [self.road(x).T]
        if self.crossing.linear.tire_damping.any():
            inputs.append(self._falls(x).T * motion.speeds(x) * self.crossing.tire_paces(x).T)
        return np.vstack(inputs)

    def forces(
        self, x: FloatArray, states: FloatArray, speeds: FloatArray, *, before: bool = False
    ) -> FloatArray:
        """Tire forces at places from states there, as if tires could pull, (..., m, n_tires).

        Of states (..., m, n), which may be those of the vehicle alone, and speeds (..., m). Tires
        with damping feel a kink with a jump: forces are those just after it, or just before.
        """
        crossing, n = self.crossing, self.crossing.n_vehicle
        beside, road = x, self.road(x)
        if crossing.linear.tire_damping.any():
            beside = x + (-BESIDE if before else BESIDE)
            along = speeds[..., np.newaxis] * crossing.tire_paces(beside)
            road = road + crossing.linear.tire_lags * self._falls(beside) * along
        deflections: FloatArray = np.zeros(1)
        if states.shape[-1] > n:
            shapes, rates = crossing.tire_shapes(beside), crossing.shape_rates(beside, speeds)
            deflections = crossing.leading_deflections(states[..., n:], shapes, rates)
        hubs = states[..., :n] @ crossing.linear.leading_hubs.T
        return crossing.tire_forces(hubs, deflections, road)

    def _falls(self, x: FloatArray) -> FloatArray:
        """Slope of the road under each tire just after places, (m, n_tires)."""
        tires = self.crossing.tire_positions(x)
        return np.zeros_like(tires) if self.profile is None else falls_of(self.profile, tires)

    def end_of_tail(self, motion: Motion, tail: float) -> float:
        """Where the reference tire is a time [s] after the end [m]."""
        if tail == 0:
            return self.end
        last = motion.time(self.end) + tail
        end = motion.position(last)
        # A vehicle that turns round is there at two times.
        if end < self.end or motion.time(end) < last - SAME_PLACE:
            raise ValueError(f"tail must end before the vehicle stands still, got {tail:g} s")
        return end

    def slowest(self, speed: float) -> float:
        """The lowest speed of the motion [m/s], or the constant one."""
        if self.motion is None:
            return speed
        places = [x for x in self.motion.changes if self.start < x < self.end]
        return float(self.motion.speeds(np.array([self.start, *places, self.end])).min())

    def pitched(self, nodes: FloatArray) -> FloatArray:
        """States of the vehicle at rest under the acceleration in each cell, (C, n_vehicle)."""
        at_rest = self.crossing.linear.pitched
        if self.motion is None:
            return np.zeros((1, len(at_rest)))
        return np.outer(self.motion.accelerations((nodes[:-1] + nodes[1:]) / 2), at_rest)

    @property
    def plain(self) -> bool:
        """Whether the speed is constant and the tires are springs alone."""
        return self.motion is None and not self.crossing.linear.tire_damping.any()

    @property
    def jumps(self) -> bool:
        """Whether what is looked at may jump at the nodes."""
        vehicle = self.crossing.linear
        return bool(vehicle.tire_damping.any()) or (
            self.motion is not None and bool(vehicle.pitch_input.any())
        )


class Stretch(NamedTuple):
    """The approach or the bridge, simulated: `Cells.propagate` for one road.

    `states` have the shape (S, C + 1, n), `stages` (S, C, 2 q), `speeds` at the nodes (S, C + 1).
    """

    run: Run
    cells: Cells
    speeds: FloatArray
    states: FloatArray
    stages: FloatArray

    @property
    def forces(self) -> FloatArray:
        """Tire forces at the stages [N], (S, C, q)."""
        return self.stages[..., : self.stages.shape[-1] // 2]


def prepare(
    crossing: Crossing, profile: RoadProfile | None, start: float, pieces: float = 0.0
) -> Run:
    """Check where a crossing starts and that its road covers it, and is not too coarse.

    `pieces` is the length [m] of the straight pieces that the road counts in, if any.
    """
    run = covered(crossing, profile, start)
    if profile is not None:
        warn_if_coarse(profile, "dynamic amplification", pieces=pieces)
    return run


def covered(crossing: Crossing, profile: RoadProfile | None, start: float) -> Run:
    """Check where a crossing starts and that its road covers it."""
    start = _checks.number("start", start, unit="m")
    if start > 0:
        raise ValueError(
            "start must be 0 m (the start of the bridge) or negative (the approach), got "
            f"{start:g}: type {-start:g}"
        )
    if profile is not None:
        if not isinstance(profile, RoadProfile):
            raise TypeError(
                f"profile must be a bridgectl.RoadProfile, got {type(profile).__name__}: "
                "type RoadProfile(x, elevation) or read_profile(path), and one road at a time"
            )
        first = crossing.paths.covered(start, crossing.beam.length)[0]
        profile.require(first, crossing.beam.length, "the crossing")
    if isinstance(crossing.linear, Traffic) and crossing.paths.motions:
        x = np.linspace(start, crossing.exit, LOOKED_AT)
        crossing.linear.require_apart(x, crossing.beam.length)
    return Run(crossing, start, crossing.exit, profile)


def require_beyond(run: Run) -> None:
    """Refuse a road that does not reach to where vehicles from the other end start."""
    if run.profile is not None:
        needed = run.crossing.paths.covered(run.start, run.crossing.beam.length)
        run.profile.require(*needed, "the crossing, with vehicles from the other end,")


def moving(run: Run, motion: Motion) -> Run:
    """The crossing with a motion, which must take the vehicle to its end."""
    motion.time(np.array([run.start, run.end]))
    steady = motion.uniform and run.crossing.paths.steady
    return run._replace(motion=None if steady else motion)


def speed_batches(run: Run, speeds: FloatArray, memory: float = BATCH_BYTES) -> Iterator[slice]:
    """Slices of the speeds whose maps fit in memory together."""
    stages = 2 * N_STAGES * run.crossing.linear.n_tires
    nodes, n = run.nodes(float(speeds.min()), wide=True), run.crossing.n_states
    # Before the bridge cells share their maps.
    cells = len(nodes) - bridge_entry(nodes)
    bytes_per_speed = 8 * cells * stages * (4 * n + stages)
    size = max(1, int(memory / bytes_per_speed))
    return (slice(i, i + size) for i in range(0, len(speeds), size))


def propagate(run: Run, speeds: FloatArray, nodes: FloatArray) -> list[Stretch]:
    """Simulate the linear crossing: the approach if there is one, then the bridge.

    At the speeds [m/s], or with the run's motion, whatever speed is given then.
    """
    crossing, entry = run.crossing, bridge_entry(nodes)
    initial = np.repeat(run.initial()[np.newaxis, :, np.newaxis], len(speeds), axis=0)
    stretches = []
    if entry > 0:
        approach = _through(run, speeds, nodes[: entry + 1], initial[:, : crossing.n_vehicle])
        initial[:, : crossing.n_vehicle, 0] = approach.states[:, -1]
        stretches.append(approach)
    return [*stretches, _through(run, speeds, nodes[entry:], initial)]


def _through(run: Run, speeds: FloatArray, nodes: FloatArray, initial: FloatArray) -> Stretch:
    crossing, motion = run.crossing, run.motion
    on_bridge = initial.shape[1] > crossing.n_vehicle
    cells = build_cells(crossing, speeds, nodes, on_bridge=on_bridge, motion=motion)
    accelerations = None
    if motion is not None and cells.pitched is not None:
        accelerations = motion.accelerations((nodes[:-1] + nodes[1:]) / 2)
    rows = road_rows(run.road(nodes), accelerations)[..., np.newaxis]
    states, stages = cells.propagate(rows, initial)
    return Stretch(run, cells, speeds_at(nodes, speeds, motion), states[..., 0], stages[..., 0])


def effect_samples(crossing: Crossing, bridge: Stretch) -> FloatArray:
    """The crossing's effect at `sample_positions` of the bridge's cells, (S, n_samples).

    Where it may jump at the nodes there are cells in between, as `connected` makes them.
    """
    run, nodes, states = bridge.run._replace(crossing=crossing), bridge.cells.nodes, bridge.states
    at_nodes = effect_at(run, nodes, states, node_forces(crossing, bridge))
    inner = bridge.cells.inner_effects(states[:, :-1], bridge.stages)
    if run.motion is not None and bridge.cells.pitched is not None:
        a = run.motion.accelerations((nodes[:-1] + nodes[1:]) / 2)[:, np.newaxis]
        moved = bridge.cells.effect_from_states @ bridge.cells.pitched
        rows = run.crossing.rows(nodes[0]).per_state @ bridge.cells.pitched
        inner += a * (rows - moved[:, bridge.cells.kind] + run.crossing.per_acceleration)
    inner = np.concatenate([at_nodes[:, :-1, np.newaxis], inner], axis=2)
    if not run.jumps:
        return np.concatenate([inner.reshape(len(inner), -1), at_nodes[:, -1:]], axis=1)
    ends = effect_at(run, nodes, states, node_forces(crossing, bridge, before=True), before=True)
    return connected(inner, ends[:, 1:])


def effect_at(
    run: Run, x: FloatArray, states: FloatArray, forces: FloatArray, *, before: bool = False
) -> FloatArray:
    """The crossing's effect at places, just after them or just before."""
    a: FloatArray | float = 0.0
    if run.motion is not None:
        a = run.motion.accelerations(x + (-BESIDE if before else BESIDE))
    return run.crossing.values(x, states, forces, a)


def connected(samples: FloatArray, ends: FloatArray) -> FloatArray:
    """Samples with cells between those of the bridge, on which what jumps there is straight.

    Of cells with a jump at their ends: samples (..., C, 6), and what is just before the ends,
    (..., C), become (..., 12 C - 5).
    """
    after = np.concatenate([samples[..., 1:, 0], ends[..., -1:]], axis=-1)
    steps = np.arange(len(SAMPLES)) / len(SAMPLES)
    jumps = ends[..., np.newaxis] + (after - ends)[..., np.newaxis] * steps
    every = np.stack([samples, jumps], axis=-2)
    return every.reshape(*samples.shape[:-2], -1)[..., : 1 - len(SAMPLES)]


def twice(nodes: FloatArray) -> FloatArray:
    """Nodes of the cells that `connected` makes [m]."""
    return np.repeat(nodes, 2)[1:-1]


def least_forces(crossing: Crossing, stretches: list[Stretch]) -> FloatArray:
    """Least tire force at each speed over its static load, as if tires could pull, shape (S,)."""
    least = np.full(len(stretches[0].states), np.inf)
    for stretch in stretches:
        loads = np.tile(crossing.linear.static_loads, N_STAGES)
        for before in (False, True) if stretch.run.jumps else (False,):
            at_nodes = node_forces(crossing, stretch, before=before) / crossing.linear.static_loads
            least = np.minimum(least, at_nodes.min(axis=(1, 2)))
        least = np.minimum(least, (stretch.forces / loads).min(axis=(1, 2)))
    return least


def leaves(least: FloatArray) -> NDArray[np.bool_]:
    """Whether some tire with such a least force would have to pull, the shape of that."""
    return np.asarray(least < -LIFT_OFF)


def lifts_off(crossing: Crossing, stretches: list[Stretch]) -> NDArray[np.bool_]:
    """At which speeds some tire would have to pull, shape (S,)."""
    return leaves(least_forces(crossing, stretches))


def node_forces(crossing: Crossing, stretch: Stretch, *, before: bool = False) -> FloatArray:
    """Tire forces at the nodes, (S, C + 1, n_tires): see `Run.forces`."""
    run = stretch.run._replace(crossing=crossing)
    return run.forces(stretch.cells.nodes, stretch.states, stretch.speeds, before=before)


def at_nodes(
    crossing: Crossing, stretches: list[Stretch], keep: NDArray[np.intp]
) -> tuple[FloatArray, FloatArray]:
    """States and tire forces of one speed at the nodes to keep, (n, m) and (n_tires, m)."""
    states, forces = [], []
    for stretch in stretches:
        # The last node of the approach is the first on the bridge.
        upto = None if stretch is stretches[-1] else -1
        padded = np.zeros((len(stretch.cells.nodes), crossing.n_states))
        padded[:, : stretch.states.shape[-1]] = stretch.states[0]
        states.append(padded[:upto])
        forces.append(node_forces(crossing, stretch)[0, :upto])
    return np.concatenate(states)[keep].T, np.concatenate(forces)[keep].T


def linear_contact(run: Run, speeds: FloatArray) -> NDArray[np.bool_]:
    """At which speeds every tire stays on the road throughout, shape (S,)."""
    contact = np.empty(len(speeds), dtype=bool)
    for batch in speed_batches(run, speeds):
        nodes = run.nodes(float(speeds[batch].min()), wide=True)
        contact[batch] = ~lifts_off(run.crossing, propagate(run, speeds[batch], nodes))
    return contact


def first_flight(positions: FloatArray, forces: FloatArray) -> float | None:
    """Where a tire first has no contact, forces of shape (n_tires, m) [m]."""
    flying = np.nonzero((forces <= 0.0).any(axis=0))[0]
    return float(positions[flying[0]]) if flying.size else None
