"""States and tire forces between the nodes of the cells of the bridge."""

from __future__ import annotations

import numpy as np

from bridgectl._checks import FloatArray
from bridgectl.linear.cells import FORCE_POINTS, GAUSS, N_STAGES, SAMPLES, modal_forces, parabola
from bridgectl.linear.fine import mode_pieces
from bridgectl.linear.modes import mode_responses
from bridgectl.linear.pace import Pace, responses
from bridgectl.linear.runs import Run, Stretch, at_nodes, connected, node_forces
from bridgectl.model.crossing import Crossing


def all_samples(
    run: Run, speed: FloatArray, stretches: list[Stretch], refine: int
) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Places, states and tire forces of one crossing, `refine` times as close as modes need.

    Of shapes (m,), (n, m) and (n_tires, m).
    """
    crossing, cells = run.crossing, [stretch.cells.nodes for stretch in stretches]
    every = np.concatenate([*(nodes[:-1] for nodes in cells), cells[-1][-1:]])
    states, forces = at_nodes(crossing, stretches, np.arange(len(every)))
    nodes = cells[-1]
    pieces = mode_pieces(crossing, float(speed[0]), nodes, refine)
    if pieces == 1:
        return every, states, forces
    points, before = np.arange(1, pieces) / pieces, len(every) - len(nodes)
    places = nodes[:-1, np.newaxis] + np.diff(nodes)[:, np.newaxis] * np.append(0.0, points)
    places = np.concatenate([every[:before], places.ravel(), nodes[-1:]])
    within, _ = bridge_samples(crossing, speed, stretches[-1], points)
    states = np.hstack([states[:, :before], within[0].T])
    # Near the ends of cells the states tell the forces better than the stages do.
    return places, states, run.forces(places, states.T, np.full(len(places), speed)).T


def bridge_samples(
    crossing: Crossing, speeds: FloatArray, bridge: Stretch, points: FloatArray = SAMPLES[1:]
) -> tuple[FloatArray, FloatArray]:
    """States and tire forces at the samples of the bridge, (S, m, n) and (S, m, n_tires).

    Samples are the nodes and, in each cell, points as fractions of it: by default those of
    `sample_positions`.
    """
    vehicle, n, nodes = crossing.linear, crossing.n_vehicle, bridge.cells.nodes
    pace = Pace(nodes, speeds, bridge.run.motion)
    durations, kind = pace.durations, pace.kind
    stages = bridge.stages.reshape(*bridge.stages.shape[:2], 2, N_STAGES, vehicle.n_tires)
    forces, surface = stages[:, :, 0], stages[:, :, 1]
    inner = np.empty((*stages.shape[:2], len(points), crossing.n_states))

    on_tires = vehicle.state_matrix_on_tires()
    free, held = (
        response[:, kind]
        for response in responses(on_tires, vehicle.road_input, durations, GAUSS, points)
    )
    before, pitched = bridge.states[:, :-1], bridge.run.pitched(nodes)[:, np.newaxis]
    inner[..., :n] = np.einsum("scpij,scj->scpi", free, before[..., :n] - pitched[:, 0])
    inner[..., :n] += np.einsum("scpiqk,scqk->scpi", held, surface) + pitched

    free, held = (
        of[:, kind] for of in mode_responses(crossing.beam, durations, FORCE_POINTS, points)
    )
    places = nodes[:-1, np.newaxis] + np.diff(nodes)[:, np.newaxis] * pace.shares(FORCE_POINTS)
    loads = modal_forces(crossing, places, forces)
    states = before[..., n:].reshape(*before.shape[:2], -1, 2)
    of_modes = np.einsum("scjpab,scjb->scpja", free, states)
    of_modes += np.einsum("scjpaf,scjf->scpja", held, loads)
    inner[..., n:] = of_modes.reshape(*inner.shape[:3], -1)

    at_nodes = node_forces(crossing, bridge)
    between = np.einsum("pq,scqk->scpk", parabola(points), forces)
    ends = node_forces(crossing, bridge, before=True) if bridge.run.jumps else None
    same = None if ends is None else bridge.states
    return _interleaved(bridge.states, inner, same), _interleaved(at_nodes, between, ends)


def _interleaved(at_nodes: FloatArray, inner: FloatArray, ends: FloatArray | None) -> FloatArray:
    """Values at nodes (S, C + 1, k) with those at the samples between (S, C, p, k).

    With what is just before the nodes, (S, C + 1, k), if they jump there.
    """
    cells = np.concatenate([at_nodes[:, :-1, np.newaxis], inner], axis=2)
    if ends is not None:
        last = np.moveaxis(ends[:, 1:], -1, 1)
        return np.moveaxis(connected(np.moveaxis(cells, -1, 1), last), 1, -1)
    flat = cells.reshape(len(cells), -1, cells.shape[-1])
    return np.concatenate([flat, at_nodes[:, -1:]], axis=1)
