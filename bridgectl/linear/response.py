"""The engine of linear crossings: responses and peaks of one road at many speeds.

Two routes lead to them: exact cells, and the control library, which they are compared with.
"""

from __future__ import annotations

from typing import NamedTuple

import control
import numpy as np
from numpy.typing import ArrayLike, NDArray

from bridgectl import _checks
from bridgectl._checks import FloatArray
from bridgectl._places import SAME_PLACE, merge_places
from bridgectl._progress import track
from bridgectl._units import to_kmh
from bridgectl.linear import reference, runs
from bridgectl.linear.cells import SAMPLES, bridge_entry, sample_positions
from bridgectl.linear.estimates import require_crossing
from bridgectl.linear.fine import Refinement, pieces_of
from bridgectl.linear.lift_off import fly, warn_of_flights
from bridgectl.linear.peaks import find_peaks
from bridgectl.linear.within import all_samples
from bridgectl.model.motion import Motion

METHODS = ("propagator", "control")

REFINE = 4
"""How many times as close as nodes of cells the places of responses are, which people look at."""


def linear_response(
    run: runs.Run, motion: Motion, asked: FloatArray | None, method: str
) -> tuple[tuple[FloatArray, FloatArray, FloatArray], float | None]:
    """Return places, states and tire forces [N] of one crossing, at places [m] or where cells end.

    Of shapes (m,), (n, m) and (n_tires, m), and where a tire leaves the road, if it does [m]. The
    propagator takes motions of constant speed alone.
    """
    crossing, slowest = run.crossing, run.slowest(motion.speed)
    speed, tail = np.array([slowest]), (run.end - crossing.exit) / slowest
    require_crossing(run, speed, tail=tail, refine=REFINE)
    if method == "propagator":
        nodes, keep = _nodes(run, slowest, asked, wide=True)
        stretches = runs.propagate(run, speed, nodes)
        if not runs.lifts_off(crossing, stretches)[0]:
            if asked is None:
                return all_samples(run, speed, stretches, REFINE), None
            return (nodes[keep], *runs.at_nodes(crossing, stretches, keep)), None
    nodes, keep = _nodes(run, slowest, asked)
    if method == "propagator" and run.plain:
        flight = fly(run, motion.speed, nodes)
        # The places of lift-offs and landings are among its nodes.
        keep = np.searchsorted(flight.nodes, nodes[keep] - SAME_PLACE)
        nodes, states, forces = flight.nodes, flight.states, flight.forces
    else:
        states, forces = reference.simulate_reference(run, motion, nodes)
    place = runs.first_flight(nodes, forces)
    return (nodes[keep], states[:, keep], forces[:, keep]), place


def _nodes(
    run: runs.Run, slowest: float, asked: FloatArray | None, *, wide: bool = False
) -> tuple[FloatArray, NDArray[np.intp]]:
    """Nodes of a response [m], what is asked for among them, and which that is: all by default."""
    nodes = run.nodes(slowest, REFINE, wide=wide)
    if asked is None:
        return nodes, np.arange(len(nodes))
    nodes = merge_places(np.concatenate([asked, nodes]))
    return nodes, np.searchsorted(nodes, asked - SAME_PLACE)


def until(
    run: runs.Run, motion: Motion, tail: float, timepts: ArrayLike | None
) -> tuple[runs.Run, FloatArray | None]:
    """The crossing with a tail [s], and the places [m] that a response is asked for at, if any."""
    run = run._replace(end=run.end_of_tail(motion, _checks.not_negative("tail", tail, unit="s")))
    return run, None if timepts is None else motion.position(checked_times(timepts, run, motion))


def checked_times(timepts: ArrayLike, run: runs.Run, motion: Motion) -> FloatArray:
    """Times [s] that a response is asked for, within the crossing."""
    times = _checks.array("timepts", timepts, (None,), unit="s")
    first, last = motion.time(run.start), motion.time(run.end)
    slack = SAME_PLACE / motion.speed
    if times.size < 2 or np.any(np.diff(times) <= 0):
        raise ValueError("timepts must hold two or more increasing times [s]")
    if times[0] < first - slack or times[-1] > last + slack:
        raise ValueError(
            f"timepts must lie within the crossing, {first:g} s to {last:g} s, "
            f"got {times[0]:g} s to {times[-1]:g} s"
        )
    return times


def as_response(
    run: runs.Run,
    motion: Motion,
    positions: FloatArray,
    states: FloatArray,
    forces: FloatArray,
    damper: FloatArray | None = None,
) -> control.TimeResponseData:
    """Return a crossing as python-control does: see `bridgectl.crossing_response`."""
    crossing = run.crossing
    if damper is None:
        damper = np.zeros((len(crossing.linear.damper_map), len(positions)))
    return control.TimeResponseData(
        motion.time(positions),
        crossing.outputs(positions, states, forces, damper, motion.accelerations(positions)),
        states,
        np.vstack([run.road_inputs(motion, positions), damper]),
        issiso=False,
        output_labels=crossing.output_labels,
        state_labels=crossing.state_labels,
        input_labels=crossing.input_labels,
        sysname="crossing",
        title=f"Crossing at {to_kmh(motion.speed):g} km/h",
        params={
            "speed": motion.speed,
            "section": crossing.section,
            "recovery": crossing.recovery,
            "start": run.start,
        },
    )


class Crossed(NamedTuple):
    """What is kept of crossings at S speeds: nothing of those that were not simulated."""

    factors: FloatArray
    """Peaks over their static ones, if they have any, (..., S)."""
    places: FloatArray
    """Of the reference tire then [m], (..., S)."""
    least: FloatArray
    """Least tire force over its static load, on approach and bridge, (S,)."""
    flights: FloatArray
    """Where a tire first leaves the road [m], (S,); not a number where none does."""

    @classmethod
    def of_none(cls, *shape: int) -> Crossed:
        """Of crossings (..., S) that are yet to be simulated."""
        return cls(*np.full((2, *shape), np.nan), *np.full((2, shape[-1]), np.nan))

    def tell(self, speeds: FloatArray) -> None:
        """Tell at which speeds a tire leaves the road, if it does."""
        flying = np.flatnonzero(~np.isnan(self.flights))
        warn_of_flights({float(speeds[i]): self.flights[i] for i in flying}, speeds.size)


def linear_dafs(
    run: runs.Run, speeds: FloatArray, method: str = "propagator", progress: bool = True
) -> FloatArray:
    """Return the peak of the effect over its static peak, if it has one, at speeds [m/s]."""
    found = linear_peaks(run, speeds, method, progress)
    found.tell(speeds)
    return found.factors


def linear_peaks(
    run: runs.Run, speeds: FloatArray, method: str = "propagator", progress: bool = True
) -> Crossed:
    """Simulate crossings at speeds [m/s], and find the peaks of the effect."""
    crossing = run.crossing
    require_crossing(run, speeds)
    result = Crossed.of_none(speeds.size)
    linear = np.zeros(speeds.size, dtype=bool)
    if method == "propagator":
        batches = list(runs.speed_batches(run, speeds))
        for batch in track(batches, "Simulating crossings", len(batches), show=progress):
            nodes = run.nodes(speeds[batch].min(), wide=True)
            stretches = runs.propagate(run, speeds[batch], nodes)
            bridge = stretches[-1]
            samples = runs.effect_samples(crossing, bridge)
            nodes, forces = bridge.cells.nodes, runs.node_forces(crossing, bridge)
            between = Refinement(
                crossing, speeds[batch], nodes, bridge.states, bridge.forces, forces,
                pieces_of(crossing, speeds[batch].min(), nodes) if run.plain else 1,
            )  # fmt: skip
            peaks = find_peaks(samples.T, between)
            result.factors[batch] = peaks.values
            result.places[batch] = peaks.positions(runs.twice(nodes) if run.jumps else nodes)
            result.least[batch] = runs.least_forces(crossing, stretches)
            linear[batch] = ~runs.leaves(result.least[batch])
    simulate = _flying_peak if run.plain and method == "propagator" else _reference_peak
    flying = np.nonzero(~linear)[0]
    for i in track(flying, "Simulating tires that leave the road", len(flying), show=progress):
        one = simulate(run, float(speeds[i]))
        for every, own in zip(result, one, strict=True):
            every[i] = own
    return result._replace(factors=crossing.orientation * result.factors)


def _flying_peak(run: runs.Run, speed: float) -> tuple[float, float, float, float]:
    """The same of one speed with the tires kept from pulling, of `Crossed` in its order."""
    flight = fly(run, speed, run.nodes(speed))
    entry = bridge_entry(flight.nodes)
    effect = flight.effects[len(SAMPLES) * entry :, np.newaxis]
    return _kept(run, effect, flight.nodes[entry:], flight.nodes, flight.forces)


def _reference_peak(run: runs.Run, speed: float) -> tuple[float, float, float, float]:
    """The same by the reference route."""
    nodes, motion = run.nodes(speed), run.motion or Motion(speed)
    positions = sample_positions(nodes, run.motion)
    states, forces = reference.simulate_reference(run, motion, positions)
    effect = reference.reference_samples(run, motion, nodes, states, forces)[:, np.newaxis]
    bridge = nodes[bridge_entry(nodes) :]
    return _kept(run, effect, runs.twice(bridge) if run.jumps else bridge, positions, forces)


def _kept(
    run: runs.Run, effect: FloatArray, nodes: FloatArray, x: FloatArray, forces: FloatArray
) -> tuple[float, float, float, float]:
    """What is kept of an effect in cells of the bridge, and of tire forces (n_tires, m) at places.

    A place where no tire leaves the road is not a number.
    """
    peak, place = find_peaks(effect), runs.first_flight(x, forces)
    least = float((forces.T / run.crossing.linear.static_loads).min())
    first = np.nan if place is None else place
    return float(peak.values[0]), float(peak.positions(nodes)[0]), max(least, 0.0), first
