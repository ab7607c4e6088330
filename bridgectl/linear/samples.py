"""States and tire forces at all samples of a crossing, of which any number of effects is read.

`bridgectl.linear.cells` carries one effect along; here are the states themselves at its samples.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import NamedTuple, cast

import numpy as np
from numpy.typing import NDArray

from bridgectl._checks import FloatArray
from bridgectl._places import SAME_PLACE
from bridgectl._progress import track
from bridgectl.linear.cells import (
    GAUSS,
    SAMPLES,
    bridge_entry,
    sample_positions,
)
from bridgectl.linear.estimates import require_crossing
from bridgectl.linear.fine import Refinement, pieces_of
from bridgectl.linear.lift_off import fly
from bridgectl.linear.nodes import followed
from bridgectl.linear.peaks import Peaks, find_peaks
from bridgectl.linear.reference import contact_forces, simulate_reference
from bridgectl.linear.response import Crossed, linear_peaks
from bridgectl.linear.runs import (
    Run,
    connected,
    first_flight,
    least_forces,
    leaves,
    moving,
    propagate,
    speed_batches,
    twice,
)
from bridgectl.linear.within import bridge_samples
from bridgectl.model.bridge import BridgeModel
from bridgectl.model.crossing import Crossing, make_crossing
from bridgectl.model.effect import Effect, EffectRows
from bridgectl.model.motion import Motion
from bridgectl.model.quarter_car import QuarterCar
from bridgectl.model.vehicle import Vehicle

AT_STAGES = np.searchsorted(SAMPLES, GAUSS)
"""The stages among the samples of a cell."""


class Samples(NamedTuple):
    """A crossing of the bridge at the `sample_positions` of its cells.

    Where forces may jump there are cells of no width between them: see `runs.connected`.
    """

    nodes: FloatArray
    states: FloatArray
    """Shape (n, m)."""
    forces: FloatArray
    """Tire forces, shape (n_tires, m)."""
    flight: float | None = None
    """Where a tire first leaves the road [m]."""
    least: float = 0.0
    """Least tire force over its static load, on approach and bridge."""
    slowest: float = np.inf
    """The slowest speed [m/s] that cells were made for, that of the crossing or less."""
    places: FloatArray | None = None
    """Places of the samples [m], (m,), if they are not the `sample_positions`."""
    accelerations: FloatArray | float = 0.0
    """Along the road [m/s^2], (m,)."""

    def histories(self, crossing: Crossing, effects: Sequence[Effect]) -> FloatArray:
        """Histories of effects in their units, shape (m, n_effects)."""
        places = sample_positions(self.nodes) if self.places is None else self.places
        tires = crossing.tire_positions(places)
        read = crossing.beam, crossing.linear, tires, self.states, self.forces
        each = [effect.history(*read, accelerations=self.accelerations) for effect in effects]
        return np.stack(each, axis=1)

    def peaks(
        self, crossing: Crossing, speed: float, effects: Sequence[Effect], factors: FloatArray
    ) -> Peaks:
        """Largest values of effects times factors at a speed [m/s], one of each."""
        histories = self.histories(crossing, effects) * factors
        if self.places is not None:  # such cells follow every mode
            return find_peaks(histories)
        per_cell = len(SAMPLES)
        states = self.states.T[np.newaxis, ::per_cell]
        forces = self.forces[:, :-1].T.reshape(len(self.nodes) - 1, per_cell, -1)[:, AT_STAGES]
        known = states, forces.reshape(1, len(forces), -1), self.forces.T[np.newaxis, ::per_cell]
        found = []
        for effect, factor, history in zip(effects, factors, histories.T, strict=True):

            def rows(x: FloatArray, of: Effect = effect, by: float = factor) -> EffectRows:
                tires = crossing.tire_positions(x)
                return of.rows(crossing.beam, crossing.linear, tires).scaled(by)

            pieces = pieces_of(crossing, min(speed, self.slowest), self.nodes, rows)
            between = Refinement(crossing, np.array([speed]), self.nodes, *known, pieces, rows)
            found.append(find_peaks(history[:, np.newaxis], between))
        return Peaks(*(np.concatenate(of) for of in zip(*found, strict=True)))


def crossings_of(
    effect: Effect | str | Sequence[Effect | str],
    beam: BridgeModel,
    vehicle: Vehicle | QuarterCar,
    section: float,
    recovery: str,
) -> list[Crossing]:
    """Return the crossing of an effect, or of each of a list."""
    several = isinstance(effect, list | tuple)
    effects = cast(list[Effect | str], effect if several else [effect])
    if not effects:
        raise ValueError("effect must be one effect or more, got none: type effect='moment'")
    return [make_crossing(beam, vehicle, each, section, recovery) for each in effects]


def dafs_of_effects(
    run: Run,
    crossings: Sequence[Crossing],
    speeds: FloatArray,
    method: str = "propagator",
    progress: bool = True,
) -> FloatArray:
    """Return `linear_dafs` of several effects, each told by a crossing, (n_effects, n_speeds)."""
    found = peaks_of_effects(run, crossings, speeds, method, progress)
    found.tell(speeds)
    return found.factors


def peaks_of_effects(
    run: Run,
    crossings: Sequence[Crossing],
    speeds: FloatArray,
    method: str = "propagator",
    progress: bool = True,
) -> Crossed:
    """Return `linear_peaks` of several effects, each told by a crossing, from one propagation.

    Of shape (n_effects, n_speeds). Nodes of the cells are those of all effects.
    """
    if len(crossings) == 1:
        one = linear_peaks(run._replace(crossing=crossings[0]), speeds, method, progress)
        return one._replace(factors=one.factors[np.newaxis], places=one.places[np.newaxis])
    effects = [crossing.effect for crossing in crossings]
    run = run._replace(crossing=with_nodes_of(crossings[0], effects))
    require_crossing(run, speeds)
    alike = [_cells_of(run, crossing) for crossing in crossings]
    result = Crossed.of_none(len(effects), speeds.size)
    if len(set(alike)) > 1:
        for cells in dict.fromkeys(alike):
            own = [i for i, each in enumerate(alike) if each == cells]
            group = [crossings[i] for i in own]
            part = peaks_of_effects(run, group, speeds, method, progress)
            result.factors[own], result.places[own] = part.factors, part.places
            result = result._replace(
                least=np.fmin(result.least, part.least),
                flights=np.fmin(result.flights, part.flights),
            )
        return result
    scales = np.array([crossing.scale for crossing in crossings])
    orientations = np.array([crossing.orientation for crossing in crossings])
    for i, found in sampled(run, speeds, method, progress):
        peaks = found.peaks(run.crossing, float(speeds[i]), effects, 1 / scales)
        result.factors[:, i] = orientations * peaks.values
        result.places[:, i] = peaks.positions(found.nodes)
        result.least[i] = found.least
        if found.flight is not None:
            result.flights[i] = found.flight
    return result


def _cells_of(run: Run, crossing: Crossing) -> tuple[float, ...]:
    """What cells depend on that do not follow every mode: they do where none is the same."""
    wide = followed(crossing, wide=True)
    if wide == followed(crossing, wide=False):
        return ()
    return wide, *run._replace(crossing=crossing).kinks().tolist()


def dafs_of_motions(
    run: Run, crossings: Sequence[Crossing], motions: Sequence[Motion], method: str, progress: bool
) -> FloatArray:
    """Return `dafs_of_effects` of several motions, one after the other."""
    speeds = np.array([[motion.speed] for motion in motions])
    each = zip([moving(run, motion) for motion in motions], speeds, strict=True)
    found = [dafs_of_effects(one, crossings, c, method, progress) for one, c in each]
    return np.hstack(found)


def with_nodes_of(crossing: Crossing, effects: Sequence[Effect]) -> Crossing:
    """Return a crossing whose cells end where any of some effects has a kink."""
    named = {f"effect_{i}": effect for i, effect in enumerate(effects)}
    return Crossing(crossing.beam, crossing.vehicle, effects[0], named)


def sampled(
    run: Run, speeds: FloatArray, method: str = "propagator", progress: bool = True
) -> Iterator[tuple[int, Samples]]:
    """Simulate the bridge at each speed, by `linear_dafs`' routes: its number, and the samples."""
    linear = np.zeros(speeds.size, dtype=bool)
    if method == "propagator":
        batches = list(speed_batches(run, speeds))
        for batch in track(batches, "Simulating crossings", len(batches), show=progress):
            nodes = run.nodes(speeds[batch].min(), wide=True)
            stretches = propagate(run, speeds[batch], nodes)
            least = least_forces(run.crossing, stretches)
            linear[batch] = ~leaves(least)
            states, forces = bridge_samples(run.crossing, speeds[batch], stretches[-1])
            nodes = stretches[-1].cells.nodes
            for i in np.flatnonzero(linear[batch]):
                own = _samples(run, nodes, states[i].T, forces[i].T)
                slowest, lowest = speeds[batch].min(), float(least[i])
                yield int(batch.start + i), own._replace(slowest=slowest, least=lowest)
    simulate = _flying if run.plain and method == "propagator" else _reference
    flying = np.flatnonzero(~linear)
    for i in track(flying, "Simulating tires that leave the road", len(flying), show=progress):
        yield int(i), simulate(run, float(speeds[i]))


def _samples(
    run: Run, nodes: FloatArray, states: FloatArray, forces: FloatArray, flight: float | None = None
) -> Samples:
    """Samples of cells between nodes, told of where they are and how they are passed."""
    if run.plain:
        return Samples(nodes, states, forces, flight)
    places = sample_positions(nodes, run.motion)
    a: FloatArray = np.zeros(1)
    if run.motion is not None:
        middles = (nodes[:-1] + nodes[1:]) / 2
        a = np.repeat(run.motion.accelerations(middles), len(SAMPLES))
        a = np.append(a, a[-1])
    if run.jumps:
        cells, ends = places[:-1].reshape(-1, len(SAMPLES)), slice(len(SAMPLES), None, len(SAMPLES))
        places = connected(cells, places[ends])
        if run.motion is not None:
            a = connected(a[:-1].reshape(cells.shape), a[:-1][:: len(SAMPLES)])
        nodes = twice(nodes)
    return Samples(nodes, states, forces, flight, places=places, accelerations=a)


def _flying(run: Run, speed: float) -> Samples:
    """With the tires kept from pulling: once for the events, and once for all samples between."""
    first = fly(run, speed, run.nodes(speed))
    place = first_flight(first.nodes, first.forces)
    flight = fly(run, speed, sample_positions(first.nodes))
    return _on_bridge(first.nodes, flight.nodes, flight.states, flight.forces, place)


def _reference(run: Run, speed: float) -> Samples:
    """The same by the control library."""
    nodes, motion = run.nodes(speed), run.motion or Motion(speed)
    positions = sample_positions(nodes, run.motion)
    states, forces = simulate_reference(run, motion, positions)
    place, first = first_flight(positions, forces), len(SAMPLES) * bridge_entry(nodes)
    states, forces, nodes = states[:, first:], forces[:, first:], nodes[bridge_entry(nodes) :]
    if run.jumps:
        ends = contact_forces(run, motion, nodes, states[:, :: len(SAMPLES)], before=True)
        states, forces = (
            connected(of[:, :-1].reshape(len(of), -1, len(SAMPLES)), last[:, 1:])
            for of, last in ((states, states[:, :: len(SAMPLES)]), (forces, ends))
        )
    return _samples(run, nodes, states, forces, place)


def _on_bridge(
    nodes: FloatArray,
    positions: FloatArray,
    states: FloatArray,
    forces: FloatArray,
    flight: float | None,
) -> Samples:
    """Samples of the bridge's cells out of what was simulated at these and other positions."""
    nodes = nodes[bridge_entry(nodes) :]
    keep: NDArray[np.intp] = np.searchsorted(positions, sample_positions(nodes) - SAME_PLACE)
    return Samples(nodes, states[:, keep], forces[:, keep], flight)
