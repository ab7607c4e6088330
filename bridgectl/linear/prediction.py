"""Prediction matrices of a crossing: its motion from node to node, and its effect there."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from bridgectl._checks import FloatArray
from bridgectl.linear.cells import bridge_entry, road_rows
from bridgectl.linear.runs import Run, Stretch, propagate


@dataclass(frozen=True, eq=False)
class Prediction:
    """A crossing with the tires in contact as a linear recursion over C cells.

    ::

        x_(k+1) = transitions[k] (x_k + damper_input z_k) + offsets[k]
        effect_k = effect_rows[k] x_k + effect_constants[k]

    from x_0 = 0, equilibrium at the start. z_k are impulses of the damper forces at node k [N s].
    Road and static loads are in offsets and constants. On the approach the beam's states stay 0,
    and so does the effect.
    """

    positions: FloatArray
    """Nodes: places of the reference tire [m], increasing, shape (C + 1,)."""
    durations: FloatArray
    """Time from node to node [s], shape (C,)."""
    transitions: FloatArray
    """Maps of the states [m, m/s] over each cell, shape (C, n, n)."""
    offsets: FloatArray
    """What road and static loads add to the states [m, m/s] in each cell, shape (C, n)."""
    damper_input: FloatArray
    """Change of the states [m, m/s] per impulse of each damper [N s], shape (n, n_dampers)."""
    velocity_rows: FloatArray
    """Suspension velocity [m/s] of each damper per states, shape (n_dampers, n)."""
    effect_rows: FloatArray
    """Effect over its static peak per states [1/m, s/m], shape (C + 1, n)."""
    effect_constants: FloatArray
    """Effect of road and static loads over its static peak [-], shape (C + 1,)."""
    entry: int
    """Index of the node at the start of the bridge."""

    def __repr__(self) -> str:
        return (
            f"Prediction({len(self.durations)} cells from x = {self.positions[0]:.4g} m to "
            f"{self.positions[-1]:.4g} m, {len(self.damper_input)} states, "
            f"{len(self.velocity_rows)} dampers)"
        )


def predict(run: Run, nodes: FloatArray | None = None) -> Prediction:
    """Prediction matrices of a run between the nodes of cells, by default its own."""
    speed = run.crossing.speed
    nodes = run.nodes(speed) if nodes is None else nodes
    return as_prediction(run, nodes, propagate(run, np.array([speed]), nodes))


def as_prediction(run: Run, nodes: FloatArray, stretches: list[Stretch]) -> Prediction:
    """Prediction matrices from the cells of a run that was simulated, at its own speed."""
    crossing, n, first = run.crossing, run.crossing.n_states, 0
    durations = np.diff(nodes) / crossing.speed
    transitions, offsets = np.zeros((len(durations), n, n)), np.zeros((len(durations), n))
    for cells, road, *_ in stretches:
        own, size = slice(first, first + len(cells.kind)), cells.n_states
        from_states, from_road = (of[0, :, :size] for of in cells.transitions())
        transitions[own, :size, :size] = from_states[cells.map_of]
        offsets[own, :size] = np.einsum("cij,cj->ci", from_road[cells.map_of], road_rows(road))
        first = own.stop
    velocities = np.zeros((len(crossing.linear.damper_map), n))
    velocities[:, : crossing.n_vehicle] = crossing.linear.damper_map @ crossing.linear.velocities
    return Prediction(
        nodes, durations, transitions, offsets, crossing.damper_matrix, velocities,
        *_effects(run, nodes), bridge_entry(nodes),
    )  # fmt: skip


def _effects(run: Run, nodes: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Rows and constants of the crossing's effect at the nodes, 0 on the approach.

    The effect is affine in the states: its values at rest and at each unit state tell.
    """
    crossing, n, on = run.crossing, run.crossing.n_vehicle, slice(bridge_entry(nodes), None)
    x, units = nodes[on], np.eye(crossing.n_states + 1, crossing.n_states, -1)
    deflections = np.einsum("ckj,sj->sck", crossing.tire_shapes(x), units[:, n::2])
    hubs = (units[:, :n] @ crossing.linear.hubs.T)[:, np.newaxis]
    forces = crossing.tire_forces(hubs, deflections, run.road(x))
    values = np.zeros((len(nodes), len(units)))
    values[on] = crossing.values(x, units[:, np.newaxis], forces).T
    return values[:, 1:] - values[:, :1], values[:, 0]
