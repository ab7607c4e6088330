"""The reference route: one crossing at a time by the control library, tires kept from pulling."""

from __future__ import annotations

from itertools import pairwise

import control
import numpy as np

from bridgectl._checks import FloatArray
from bridgectl._places import SAME_PLACE, merge_places
from bridgectl.linear.cells import SAMPLES, bridge_entry, sample_positions
from bridgectl.linear.runs import Run, connected, effect_at
from bridgectl.model.motion import Motion

REFERENCE_TOLERANCES = {"rtol": 1e-9, "atol": 1e-13}
"""Tolerances of the reference route; the states are metres, deflections about 1e-4 of one."""

FINER = 4
"""Times in a cell of a motion that is not uniform, between which roads are linear in time."""


def reference_effect(run: Run, motion: Motion, positions: FloatArray) -> FloatArray:
    """The crossing's effect at positions by the reference path, shape (m,)."""
    # The simulation starts on the approach, whatever positions are asked for.
    nodes = merge_places(np.concatenate([run.kinks(), positions]))
    states, forces = simulate_reference(run, motion, nodes)
    keep = np.searchsorted(nodes, positions - SAME_PLACE)
    read = positions, states[:, keep].T, forces[:, keep].T
    return run.crossing.values(*read, motion.accelerations(positions))


def simulate_reference(
    run: Run, motion: Motion, positions: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """Simulate with `control.input_output_response`, the tires kept from pulling.

    One simulation from kink to kink, so that no integration step crosses one and none is
    stepped over. Positions must include the kinks, at which forces are those just after. Returns
    states (n, m) and tire forces (n_tires, m).
    """
    crossing = run.crossing
    system = crossing.system(motion, outputs="forces" if run.plain else "states")
    states = np.zeros((crossing.n_states, len(positions)))
    states[:, 0] = run.initial()
    forces = np.empty((crossing.linear.n_tires, len(positions)))
    ends = np.searchsorted(positions, run.kinks() - SAME_PLACE)
    for first, last in pairwise(ends):
        piece, finer = slice(first, last + 1), FINER if run.motion and run.profile else 1
        count = finer * (last - first)
        time = np.interp(np.arange(count + 1) / finer, np.arange(last - first + 1),
                         motion.time(positions[piece]))  # fmt: skip
        response = control.input_output_response(
            system,
            time,
            _road_inputs(run, motion, positions[[first, last]], time),
            states[:, first],
            solve_ivp_method="DOP853",
            # A kink is where a step may be as long as the motion allows, from the start.
            solve_ivp_kwargs={**REFERENCE_TOLERANCES, "first_step": time[-1] - time[0]},
            squeeze=False,
        )
        states[:, piece] = response.states[:, ::finer]
        if run.plain:
            forces[:, piece] = response.outputs
    return states, forces if run.plain else contact_forces(run, motion, positions, states)


def contact_forces(
    run: Run, motion: Motion, x: FloatArray, states: FloatArray, *, before: bool = False
) -> FloatArray:
    """Tire forces of one crossing kept from pulling, (n_tires, m): see `Run.forces`."""
    speeds = motion.speeds(x)
    return np.maximum(run.forces(x, states.T, speeds, before=before), 0.0).T


def _road_inputs(run: Run, motion: Motion, ends: FloatArray, time: FloatArray) -> FloatArray:
    """Inputs of the crossing at times of a piece between two places, where the road is straight."""
    places, paths = np.clip(motion.position(time), *ends), run.crossing.paths
    first, last = run.road(ends)
    ways = paths.ways(ends)
    slopes = ((last - first) / (ways[1] - ways[0]))[:, np.newaxis]
    inputs = np.zeros((len(run.crossing.input_labels), len(time)))
    inputs[: len(first)] = first[:, np.newaxis] + slopes * (paths.ways(places) - ways[0]).T
    if run.crossing.linear.tire_damping.any():
        inputs[len(first) : 2 * len(first)] = slopes * motion.speeds(places) * paths.paces(places).T
    return inputs


def reference_samples(
    run: Run, motion: Motion, nodes: FloatArray, states: FloatArray, forces: FloatArray
) -> FloatArray:
    """As `effect_samples`, from states and forces at all samples by the reference, (n_samples,)."""
    first, x = len(SAMPLES) * bridge_entry(nodes), sample_positions(nodes, run.motion)
    after = effect_at(run, x, states.T, forces.T)[first:]
    if not run.jumps:
        return after
    ends = slice(first + len(SAMPLES), None, len(SAMPLES))
    x, states = x[ends], states[:, ends]
    before = contact_forces(run, motion, x, states, before=True)
    last = effect_at(run, x, states.T, before.T, before=True)
    return connected(after[:-1].reshape(-1, len(SAMPLES)), last)
