"""The fast path through a crossing: exact linear pieces joined by the tire forces.

Beam and vehicle are each linear and time-invariant; only the place where the tire forces
act on the beam changes with time. A crossing is cut into short cells. Within a cell the
surface under each tire, u = v + r, and the modal forces R phi_j are polynomials through
three Gauss points (the stages), and beam and vehicle respond to those exactly, by matrix
exponentials: stiff modes and heavily damped vehicles cost neither accuracy nor stability.

Two relations tie the stages together, u = r + v and Eq. (2), R = W + K_t (T y - u). With
v = F b + P R from the beam and K_t (T y - u) = G a + H u from the vehicle (a, b: vehicle and
beam states at the start of the cell),

    (I - H P) R = W + G a + H (r + F b),    u = r + F b + P R

is one small linear system a cell, solved for all cells and speeds at once. What remains
is a product of two thin matrices a cell, with any number of roads side by side.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import expm

from bridgectl._checks import FloatArray
from bridgectl._places import SAME_PLACE
from bridgectl.model.crossing import Crossing

N_STAGES = 3
GAUSS = (np.polynomial.legendre.leggauss(N_STAGES)[0] + 1) / 2
"""The stages as fractions of a cell: Gauss points, order 6 where the motion is smooth."""

BETWEEN = (GAUSS[1:] + GAUSS[:-1]) / 2
"""Where the effect is sampled besides, so that the polynomial of a cell finds peaks to 1e-7."""

SAMPLES = np.sort(np.concatenate([[0.0], GAUSS, BETWEEN]))
"""Where a cell's outputs are sampled, as fractions of it; its end is the next one's start."""

# The points of a cell that responses are computed at, and the samples after its start in them.
_POINTS = np.concatenate([GAUSS, [1.0], BETWEEN])
_INNER = np.argsort(_POINTS)[:-1]
END = N_STAGES  # the end of the cell, in them
# Values at those samples of the parabola through values at the stages.
_FROM_STAGES = np.vander(SAMPLES[1:], N_STAGES) @ np.linalg.inv(np.vander(GAUSS))


@dataclass(frozen=True)
class Cells:
    """The cells of a stretch of road, for several speeds.

    Axis names: S speeds, C cells, U kinds of cells (different widths), M maps (one a cell on
    the bridge, one a kind off it), n states, q = N_STAGES * n_tires stage values of a
    quantity, N_INNER samples after a cell's start, and R roads simulated side by side. The road
    of a cell comes as the rows [r at its start, 1 for the static loads, rise of r in it],
    2 n_tires + 1 in all.
    """

    nodes: FloatArray
    """Positions of the reference tire at the ends of the cells [m], (C + 1,)."""
    kind: NDArray[np.intp]
    """Kind of each cell, (C,)."""
    map_of: NDArray[np.intp]
    """Map of each cell, (C,)."""
    free: FloatArray
    """States at `_POINTS` from those at the start, with no input, (S, U, points, n, n)."""
    inputs: FloatArray
    """States at the end from the stage values [R, u], (S, M, n, 2 q)."""
    from_states: FloatArray
    """Stage values [R, u], tire forces [N] and surface [m], from states, (S, M, 2 q, n)."""
    from_road: FloatArray
    """The same from the road rows, (S, M, 2 q, 2 n_tires + 1)."""
    effect_from_states: FloatArray
    """Effect at the samples after the start from the states there, (S, U, N_INNER, n)."""
    effect_from_stages: FloatArray
    """The same from the stage values [R, u], (S, M, N_INNER, 2 q)."""
    effect_constant: float
    """What is always added to it."""

    @property
    def n_states(self) -> int:
        """Number of states n."""
        return self.free.shape[-1]

    def propagate(self, road: FloatArray, initial: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Return states at the nodes, (S, C + 1, n, R), and stage values [R, u], (S, C, 2 q, R).

        From road rows of the cells, (C, 2 n_tires + 1, R), and states at the first, (S, n, R).
        """
        n_cells = len(self.kind)
        states = np.empty((len(initial), n_cells + 1, *initial.shape[1:]))
        stages = self.from_road[:, self.map_of] @ road
        states[:, 0] = initial
        for c, (kind, cell) in enumerate(zip(self.kind, self.map_of, strict=True)):
            stages[:, c] += self.from_states[:, cell] @ states[:, c]
            states[:, c + 1] = self.free[:, kind, END] @ states[:, c]
            states[:, c + 1] += self.inputs[:, cell] @ stages[:, c]
        return states, stages

    def transitions(self) -> tuple[FloatArray, FloatArray]:
        """Maps from the states and from the road rows at a cell's start, by map.

        To the states at its end and the effect at its samples, stacked: shapes
        (S, M, n + N_INNER, n) and (S, M, n + N_INNER, 2 n_tires + 1).
        """
        n_maps, n = self.inputs.shape[1], self.n_states
        kind = self.kind if n_maps == len(self.kind) else np.arange(n_maps)
        gains = np.concatenate([self.inputs, self.effect_from_stages], axis=2)
        from_states = gains @ self.from_states
        from_states[:, :, :n] += self.free[:, kind, END]
        from_states[:, :, n:] += self.effect_from_states[:, kind]
        from_road = gains @ self.from_road
        from_road[:, :, n:, from_road.shape[-1] // 2] += self.effect_constant
        return from_states, from_road

    def inner_effects(self, states: FloatArray, stages: FloatArray) -> FloatArray:
        """Effect at the samples after the start of all cells of one road, shape (S, C, N_INNER).

        From the states at the starts, (S, C, n), and the stage values [R, u], (S, C, 2 q).
        """
        values = np.einsum("scmi,sci->scm", self.effect_from_states[:, self.kind], states)
        values += np.einsum("scmq,scq->scm", self.effect_from_stages[:, self.map_of], stages)
        return values + self.effect_constant


def bridge_entry(nodes: FloatArray) -> int:
    """Index of the node at the start of the bridge: the nodes before it are on the approach."""
    return int(np.searchsorted(nodes, -SAME_PLACE))


def sample_positions(nodes: FloatArray) -> FloatArray:
    """Positions of the samples: each cell's start and stages, and the last node [m]."""
    inner = nodes[:-1, np.newaxis] + np.diff(nodes)[:, np.newaxis] * SAMPLES
    return np.append(inner.ravel(), nodes[-1])


def road_rows(road: FloatArray) -> FloatArray:
    """Road rows of the cells from the road under each tire at the nodes.

    From shape (C + 1, n_tires) to (C, 2 n_tires + 1): see `Cells`.
    """
    load = np.ones((len(road) - 1, 1))
    return np.hstack([road[:-1], load, np.diff(road, axis=0)])


def build_cells(
    crossing: Crossing,
    speeds: FloatArray,
    nodes: FloatArray,
    *,
    on_bridge: bool,
    contact: NDArray[np.bool_] | None = None,
) -> Cells:
    """Compute the maps of the cells between nodes.

    With ``on_bridge=False`` all tires run on a rigid road: vehicle states alone, and cells
    of one width share their maps. `contact` tells which tires touch the road, by default all;
    a tire in flight has R = 0, and where others have u it has its force on the vehicle, R - W.
    """
    vehicle, n = crossing.linear, crossing.n_vehicle
    contact = np.ones(vehicle.n_tires, dtype=bool) if contact is None else contact
    # Widths that differ by round-off only share their matrix exponentials.
    widths, kind = np.unique(np.round(np.diff(nodes), 10), return_inverse=True)
    if on_bridge:
        n_modes, map_of, kind_of_map = crossing.beam.n_modes, np.arange(len(kind)), kind
        positions = nodes[:-1, np.newaxis] + np.diff(nodes)[:, np.newaxis] * GAUSS
    else:
        n_modes, map_of, kind_of_map = 0, kind, np.arange(len(widths))
        positions = np.zeros((len(widths), N_STAGES))
    durations = widths / speeds[:, np.newaxis]
    free_vehicle, held_vehicle = hold_responses(
        vehicle.state_matrix_on_tires(contact),
        np.where(contact, vehicle.road_input, vehicle.tire_input),
        durations,
    )
    free_modes, held_modes = hold_responses(*mode_matrices(crossing, n_modes), durations)

    shapes = crossing.tire_shapes(positions)[..., :n_modes]
    q = N_STAGES * vehicle.n_tires  # tires innermost
    shapes = shapes.reshape(len(positions), q, n_modes)
    per_force = _modal_gains(held_modes[:, kind_of_map], shapes)
    vehicle_stages = _vehicle_stages(crossing, free_vehicle, held_vehicle, contact)
    from_vehicle, spring = (of[:, kind_of_map] for of in vehicle_stages)
    beam_stages = _beam_stages(free_modes[:, kind_of_map], per_force, shapes)
    from_states, from_road = _solve_stages(crossing, contact, from_vehicle, spring, *beam_stages)

    batch = per_force.shape[:2]
    of_vehicle, of_beam = slice(n), slice(n, n + 2 * n_modes)
    forces, surface = slice(q), slice(q, 2 * q)  # of the stage values [R, u]
    inputs = np.zeros((*batch, n + 2 * n_modes, 2 * q))
    inputs[:, :, of_beam, forces] = per_force[:, :, END].reshape(*batch, 2 * n_modes, q)
    inputs[:, :, of_vehicle, surface] = held_vehicle[:, kind_of_map, END].reshape(*batch, n, q)
    free = np.zeros((*free_vehicle.shape[:3], n + 2 * n_modes, n + 2 * n_modes))
    free[..., of_vehicle, of_vehicle] = free_vehicle
    for j in range(n_modes):
        own = slice(n + 2 * j, n + 2 * j + 2)
        free[..., own, own] = free_modes[:, :, j]
    samples = np.zeros((len(positions), len(_INNER)))
    if on_bridge:
        samples = nodes[:-1, np.newaxis] + np.diff(nodes)[:, np.newaxis] * SAMPLES[1:]
    per_state, from_stages, constant = _effect_maps(
        crossing, samples, per_force, held_vehicle[:, kind_of_map]
    )
    return Cells(
        nodes, kind, map_of, free, inputs, from_states, from_road,
        per_state @ free[:, :, _INNER], from_stages, constant,
    )  # fmt: skip


def mode_matrices(crossing: Crossing, n_modes: int) -> tuple[FloatArray, FloatArray]:
    """State and input matrices of the modes on their own, shapes (modes, 2, 2), (modes, 2, 1)."""
    own = 2 * np.arange(n_modes)[:, np.newaxis] + np.arange(2)
    matrices = crossing.modal_matrix[own[:, :, np.newaxis], own[:, np.newaxis, :]]
    gains = crossing.modal_input[own, np.arange(n_modes)[:, np.newaxis]]
    return matrices, gains[..., np.newaxis]


def _modal_gains(held: FloatArray, shapes: FloatArray) -> FloatArray:
    """Modal states at the points of a cell per stage value of R, (S, M, points, modes, 2, q)."""
    stage = np.repeat(np.arange(N_STAGES), shapes.shape[1] // N_STAGES)
    return np.asarray(np.einsum("smjpaq,mqj->smpjaq", held[..., stage, 0], shapes))


def _beam_stages(
    free: FloatArray, per_force: FloatArray, shapes: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """F and P of the module's docstring: deflections from the beam and the tire forces."""
    q, n_modes = shapes.shape[1:]
    stage = np.repeat(np.arange(N_STAGES), q // N_STAGES)
    from_beam = np.einsum("mqj,smjqa->smqja", shapes, free[:, :, :, stage, 0])
    compliance = np.einsum("mqj,smqjp->smqp", shapes, per_force[..., 0, :][:, :, stage])
    return from_beam.reshape(*free.shape[:2], q, 2 * n_modes), compliance


def _effect_maps(
    crossing: Crossing, samples: FloatArray, per_force: FloatArray, held_vehicle: FloatArray
) -> tuple[FloatArray, FloatArray, float]:
    """The crossing's effect at samples (M, N_INNER): from the states there, [R, u], and always."""
    rows, n, n_modes = crossing.rows(samples), crossing.n_vehicle, per_force.shape[3]
    of_vehicle, of_beam = rows.per_state[:n], rows.per_state[n : n + 2 * n_modes]
    batch, q = per_force.shape[:2], per_force.shape[-1]
    from_stages = np.zeros((*batch, len(_INNER), 2 * q))
    if of_beam.any():
        by_mode = of_beam.reshape(n_modes, 2)
        from_stages[..., :q] = np.einsum("ja,smpjaq->smpq", by_mode, per_force[:, :, _INNER])
    if of_vehicle.any():
        held = held_vehicle[:, :, _INNER].reshape(*batch, len(_INNER), n, q)
        from_stages[..., q:] = np.einsum("i,smpiq->smpq", of_vehicle, held)
    forces = np.einsum("mpk,pn->mpnk", rows.per_force, _FROM_STAGES)
    from_stages[..., :q] += forces.reshape(len(samples), len(_INNER), q)
    return np.append(of_vehicle, of_beam), from_stages, rows.constant


def _vehicle_stages(
    crossing: Crossing, free: FloatArray, held: FloatArray, contact: NDArray[np.bool_]
) -> tuple[FloatArray, FloatArray]:
    """G and H of the module's docstring: tire forces from the vehicle and the surface."""
    vehicle = crossing.linear
    stage, tire = np.divmod(np.arange(N_STAGES * vehicle.n_tires), vehicle.n_tires)
    hubs = vehicle.hubs[tire]
    stiffness = (contact * vehicle.tire_stiffnesses)[tire, np.newaxis]
    held = held.reshape(*free.shape[:4], -1)[:, :, stage]
    from_vehicle = stiffness * np.einsum("qi,suqij->suqj", hubs, free[:, :, stage])
    from_surface = np.einsum("qi,suqij->suqj", hubs, held) - np.eye(len(stage))
    return from_vehicle, stiffness * from_surface


def _solve_stages(
    crossing: Crossing,
    contact: NDArray[np.bool_],
    from_vehicle: FloatArray,
    spring: FloatArray,
    from_beam: FloatArray,
    compliance: FloatArray,
) -> tuple[FloatArray, FloatArray]:
    """Stage values [R, u] from states and road rows: the system of the module's docstring."""
    n_tires, n = crossing.linear.n_tires, from_vehicle.shape[-1]
    stage, tire = np.divmod(np.arange(N_STAGES * n_tires), n_tires)
    own = np.arange(len(stage))
    road = np.zeros((*compliance.shape[:3], 2 * n_tires + 1))
    road[:, :, own, tire] = 1.0
    road[:, :, own, n_tires + 1 + tire] = GAUSS[stage]
    loads = np.zeros(road.shape[2:])
    loads[:, n_tires] = (contact * crossing.linear.static_loads)[tire]
    flying = np.nonzero(~contact[tire])[0]
    from_beam, compliance = from_beam.copy(), compliance.copy()
    for rows in (from_beam, compliance, road):
        rows[:, :, flying] = 0.0
    road[:, :, flying, n_tires] = -crossing.linear.static_loads[tire[flying]]

    right = [from_vehicle, spring @ from_beam, loads + spring @ road]
    identity = np.eye(len(stage))
    forces = np.linalg.solve(identity - spring @ compliance, np.concatenate(right, axis=-1))
    surface = compliance @ forces
    surface[..., n:] += np.concatenate([from_beam, road], axis=-1)
    stages = np.concatenate([forces, surface], axis=2)
    n_states = n + from_beam.shape[-1]
    return stages[..., :n_states], stages[..., n_states:]


def hold_responses(
    matrix: FloatArray,
    inputs: FloatArray,
    durations: FloatArray,
    stages: FloatArray = GAUSS,
    points: FloatArray = _POINTS,
) -> tuple[FloatArray, FloatArray]:
    """Responses of x' = A x + B u at points of cells, exactly, to states and inputs.

    A and B have the shapes (..., n, n) and (..., n, m), the durations of the cells [s] (S, U). The
    input is the polynomial through its values at the q `stages`; the states are asked for at the p
    `points`, both fractions of a cell: (S, U, ..., p, n, n) and (S, U, ..., p, n, q, m).
    """
    n, m = inputs.shape[-2:]
    batch, n_stages = matrix.shape[:-2], len(stages)
    size = n + n_stages * m
    scaled = durations.reshape(*durations.shape, *(1,) * (len(batch) + 2))
    # A chain of integrators drives the system with the powers s^p / p! of the time in cells.
    chain = np.zeros((*durations.shape, *batch, size, size))
    chain[..., :n, :n] = matrix * scaled
    chain[..., :n, n : n + m] = inputs * scaled
    upper = np.arange(n, size - m)
    chain[..., upper, upper + m] = 1.0
    response = expm(chain[..., np.newaxis, :, :] * points[:, np.newaxis, np.newaxis])
    powers = response[..., :n, n:].reshape(*response.shape[:-2], n, n_stages, m)
    factorials = np.cumprod([1.0, *range(1, n_stages)])
    lagrange = factorials[:, np.newaxis] * np.linalg.inv(np.vander(stages, increasing=True))
    return response[..., :n, :n], np.einsum("...ipm,pn->...inm", powers, lagrange)
