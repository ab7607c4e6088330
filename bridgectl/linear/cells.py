"""The fast path through a crossing: exact linear pieces joined by the tire forces.

Beam and vehicle are each linear and time-invariant; only the place where the tire forces
act on the beam changes with time. A crossing is cut into short cells. Within a cell the
tire forces R and the surface under each tire, u = v + r, are parabolas through three Gauss points
(the stages), and the modal forces R phi_j polynomials through five. Beam and vehicle respond to
those exactly: stiff modes and heavily damped vehicles cost neither accuracy nor stability, and
a cell may be many periods of a high mode long. What such a mode does to the tires within it is
seen at the stages only, which is little: the mode is stiff beside the tires. Of a tire with damping
u stands for u + lag u', and T y for T (y + lag y').

Two relations tie the stages together, u = r + v and Eq. (2), R = W + K_t (T y - u). With
v = F b + P R from the beam and K_t (T y - u) = G a + H u from the vehicle (a, b: vehicle and
beam states at the start of the cell),

    (I - H P) R = W + G a + H (r + F b),    u = r + F b + P R

is one small linear system a cell, solved for all cells and speeds at once. What remains
is a product of two thin matrices a cell, with any number of roads side by side.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from bridgectl._checks import FloatArray
from bridgectl._places import SAME_PLACE
from bridgectl.linear.modes import mode_responses
from bridgectl.linear.pace import Pace, climbed_each, responses
from bridgectl.linear.stages import solve_stages, vehicle_matrices, vehicle_stages
from bridgectl.model.crossing import Crossing
from bridgectl.model.motion import Motion

N_STAGES = 3
GAUSS = (np.polynomial.legendre.leggauss(N_STAGES)[0] + 1) / 2
"""The stages as fractions of a cell: Gauss points, order 6 where the motion is smooth."""


def parabola(fractions: FloatArray) -> FloatArray:
    """Values (m, N_STAGES) at fractions of a cell from those at its stages."""
    return np.vander(fractions, N_STAGES) @ np.linalg.inv(np.vander(GAUSS))


FORCE_POINTS = np.append(GAUSS, [0.0, 1.0])
"""Where modal forces are told, which waves of the mode shapes bend: the stages and both ends."""

N_FORCES = len(FORCE_POINTS)

BETWEEN = (GAUSS[1:] + GAUSS[:-1]) / 2
"""Where the effect is sampled besides, so that the polynomial of a cell finds peaks to 1e-7."""

SAMPLES = np.sort(np.concatenate([[0.0], GAUSS, BETWEEN]))
"""Where a cell's outputs are sampled, as fractions of it; its end is the next one's start."""

# The points of a cell that responses are computed at, and the samples after its start in them.
_POINTS = np.concatenate([GAUSS, [1.0], BETWEEN])
_INNER = np.argsort(_POINTS)[:-1]
END = N_STAGES  # the end of the cell, in them
N_ROWS = N_STAGES + 2  # deflections at the stages and states at the end
# Values at those samples of the parabola through values at the stages.
FROM_STAGES = parabola(SAMPLES[1:])
# The same at the force points.
TO_FORCES = parabola(FORCE_POINTS)


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
    """States at the end from those at the start, with no input, (S, U, n, n)."""
    gains: FloatArray
    """States at the end, and the effect at the samples after the start, from the stage values
    [R, u], (S, M, n + N_INNER, 2 q)."""
    to_stages: FloatArray
    """Stage values [R, u], tire forces [N] and surface [m], from states and road rows,
    (S, M, 2 q, n + 2 n_tires + 1)."""
    effect_from_states: FloatArray
    """Effect at the samples after the start from the states at it, (S, U, N_INNER, n)."""
    effect_constant: float
    """What is always added to it."""
    pitched: FloatArray | None = None
    """States at rest under an acceleration along the road of 1 m/s^2, (n,), if that counts: its
    value is then the last of the road rows."""

    @property
    def n_states(self) -> int:
        """Number of states n."""
        return self.free.shape[-1]

    @property
    def size(self) -> int:
        """Memory of the maps [bytes]."""
        return self.gains.nbytes + self.to_stages.nbytes + self.free.nbytes

    @property
    def inputs(self) -> FloatArray:
        """States at the end from the stage values, (S, M, n, 2 q)."""
        return self.gains[:, :, : self.n_states]

    @property
    def effect_from_stages(self) -> FloatArray:
        """Effect at the samples from the stage values, (S, M, N_INNER, 2 q)."""
        return self.gains[:, :, self.n_states :]

    @property
    def from_states(self) -> FloatArray:
        """Stage values from the states at the start, (S, M, 2 q, n)."""
        return self.to_stages[..., : self.n_states]

    @property
    def from_road(self) -> FloatArray:
        """Stage values from the road rows, (S, M, 2 q, 2 n_tires + 1)."""
        return self.to_stages[..., self.n_states :]

    def propagate(self, road: FloatArray, initial: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Return states at the nodes, (S, C + 1, n, R), and stage values [R, u], (S, C, 2 q, R).

        From road rows of the cells, (C, 2 n_tires + 1, R), and states at the first, (S, n, R).
        """
        drive, pitch = self.from_road[:, self.map_of] @ road, self._pitch(road)
        states = np.empty((len(initial), len(self.kind) + 1, *initial.shape[1:]))
        states[:, 0] = initial
        if self.n_states > 2 * drive.shape[2]:  # a step is more than the two it is made of
            stages, states[:, 1:] = drive, pitch
            inputs, from_states = self.inputs, self.from_states
            for c, (kind, cell) in enumerate(zip(self.kind, self.map_of, strict=True)):
                now, after, own = states[:, c], states[:, c + 1], stages[:, c]
                own += from_states[:, cell] @ now
                after += self.free[:, kind] @ now
                after += inputs[:, cell] @ own
            return states, stages
        push, steps = self.inputs[:, self.map_of] @ drive + pitch, self.steps
        for c, cell in enumerate(self.map_of):
            np.matmul(steps[:, cell], states[:, c], out=states[:, c + 1])
            states[:, c + 1] += push[:, c]
        return states, drive + self.from_states[:, self.map_of] @ states[:, :-1]

    def _pitch(self, road: FloatArray) -> FloatArray:
        """What accelerations add to the states at the end of each cell, (S, C, n, R), or 0."""
        if self.pitched is None:
            return np.zeros((1, len(self.kind), 1, 1))
        moved = (self.pitched - self.free @ self.pitched)[:, self.kind]
        return np.asarray(moved[..., np.newaxis] * road[:, -1:])

    @property
    def kind_of_map(self) -> NDArray[np.intp]:
        """Kind of the cells of each map, shape (M,)."""
        n_maps = self.inputs.shape[1]
        return self.kind if n_maps == len(self.kind) else np.arange(n_maps)

    @cached_property
    def steps(self) -> FloatArray:
        """States at the end from the states at the start, the tires at work, (S, M, n, n)."""
        return np.asarray(self.inputs @ self.from_states + self.free[:, self.kind_of_map])

    def transitions(self) -> FloatArray:
        """Maps from the states and the road rows at a cell's start, by map.

        To the states at its end and the effect at its samples, stacked: shape
        (S, M, n + N_INNER, n + 2 n_tires + 1).
        """
        n = self.n_states
        maps = np.asarray(self.gains @ self.to_stages)
        maps[:, :, n:, (n + maps.shape[-1]) // 2] += self.effect_constant
        alone = np.concatenate([self.free, self.effect_from_states], axis=2)
        maps[..., :n] += alone[:, self.kind_of_map] if alone.shape[1] > 1 else alone
        return maps

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


def sample_positions(nodes: FloatArray, motion: Motion | None = None) -> FloatArray:
    """Positions of the samples: each cell's start and stages, and the last node [m]."""
    shares = SAMPLES if motion is None else Pace(nodes, np.zeros(1), motion).shares(SAMPLES)
    inner = nodes[:-1, np.newaxis] + np.diff(nodes)[:, np.newaxis] * shares
    return np.append(inner.ravel(), nodes[-1])


def road_rows(road: FloatArray, accelerations: FloatArray | None = None) -> FloatArray:
    """Road rows of the cells from the road under each tire at the nodes.

    From shape (C + 1, n_tires) to (C, 2 n_tires + 1): see `Cells`. Accelerations (C,), if they
    count, come after them.
    """
    load = np.ones((len(road) - 1, 1))
    last = [] if accelerations is None else [accelerations[:, np.newaxis]]
    return np.hstack([road[:-1], load, np.diff(road, axis=0), *last])


def build_cells(
    crossing: Crossing,
    speeds: FloatArray,
    nodes: FloatArray,
    *,
    on_bridge: bool,
    contact: NDArray[np.bool_] | None = None,
    motion: Motion | None = None,
) -> Cells:
    """Compute the maps of the cells between nodes, for speeds [m/s] or for one motion.

    With ``on_bridge=False`` all tires run on a rigid road: vehicle states alone, and cells
    of one width share their maps. `contact` tells which tires touch the road, by default all;
    a tire in flight has R = 0, and where others have u it has its force on the vehicle, R - W.
    """
    vehicle, n = crossing.linear, crossing.n_vehicle
    contact = np.ones(vehicle.n_tires, dtype=bool) if contact is None else contact
    pace = Pace(nodes, speeds, motion)
    durations, kind = pace.durations, pace.kind
    pitches = motion is not None and bool(vehicle.pitch_input.any())
    if on_bridge:
        n_modes, map_of, kind_of_map = crossing.beam.n_modes, np.arange(len(kind)), kind
        starts, steps = nodes[:-1, np.newaxis], np.diff(nodes)[:, np.newaxis]
    else:
        n_modes, map_of, kind_of_map = 0, kind, np.arange(len(pace.widths))
        starts, steps = np.zeros((2, len(pace.widths), 1))
    free_vehicle, held_vehicle = responses(
        *vehicle_matrices(vehicle, contact), durations, GAUSS, _POINTS
    )
    held_vehicle = held_vehicle.reshape(*free_vehicle.shape[:-1], -1)
    rows = crossing.rows(starts + steps * pace.shares(SAMPLES[1:]))
    of_vehicle = rows.per_state[:n]
    of_beam = rows.per_state[n : n + 2 * n_modes].reshape(n_modes, 2)
    places = starts + steps * pace.shares(FORCE_POINTS)
    rates = crossing.shape_rates(places[:, :N_STAGES], pace.speeds(GAUSS))
    beam = _beam_maps(crossing, places, rates, kind_of_map, durations, of_beam)
    from_vehicle, spring = vehicle_stages(crossing, free_vehicle, held_vehicle, contact)
    if crossing.paths.steady:
        climbed = pace.climbed(GAUSS, vehicle.tire_lags, pace.widths[kind_of_map])
    else:
        climbed = climbed_each(pace, GAUSS, vehicle.tire_lags, crossing.paths, nodes)
    to_stages = solve_stages(
        crossing, contact, from_vehicle[:, kind_of_map], spring[:, kind_of_map],
        beam.deflections, beam.compliance,
        climbed, pitches,
    )  # fmt: skip

    q, n_states = beam.compliance.shape[-1], n + 2 * n_modes
    gains = np.zeros((*beam.compliance.shape[:2], n_states + len(_INNER), 2 * q))  # of [R, u]
    inputs, effect = gains[:, :, :n_states], gains[:, :, n_states:]
    inputs[:, :, n:, :q] = beam.at_end
    inputs[:, :, :n, q:] = held_vehicle[:, kind_of_map, END]
    free = np.zeros((*durations.shape, n_states, n_states))
    free[:, :, :n, :n] = free_vehicle[:, :, END]
    for j, own in enumerate(np.arange(n, n_states).reshape(n_modes, 2)):
        free[:, :, own[:, np.newaxis], own] = beam.free[:, :, j, END]
    through_forces = np.einsum("mpk,pn->mpnk", rows.per_force, FROM_STAGES)
    effect[..., :q] = beam.effect + through_forces.reshape(len(starts), -1, q)
    effect[..., q:] = (of_vehicle @ held_vehicle[:, :, _INNER])[:, kind_of_map]
    modes = np.einsum("ja,sujpab->supjb", of_beam, beam.free[:, :, :, _INNER])
    per_state = [
        of_vehicle @ free_vehicle[:, :, _INNER],
        modes.reshape(*modes.shape[:3], 2 * n_modes),
    ]
    return Cells(
        nodes, kind, map_of, free, gains, to_stages, np.concatenate(per_state, axis=-1),
        rows.constant, np.append(vehicle.pitched, np.zeros(2 * n_modes)) if pitches else None,
    )  # fmt: skip


def modal_forces(crossing: Crossing, places: FloatArray, forces: FloatArray) -> FloatArray:
    """Modal forces (S, C, modes, N_FORCES) from tire forces at stages (S, C, N_STAGES, n_tires).

    `places` (C, N_FORCES) are those of the cells' `FORCE_POINTS`.
    """
    shapes = np.moveaxis(crossing.tire_shapes(places), -1, 1)  # cells, modes, force points, tires
    at_points = (TO_FORCES @ forces)[:, :, np.newaxis]
    return np.asarray((shapes * at_points).sum(axis=-1))


class _BeamMaps(NamedTuple):
    """What the modes do in cells, axis names as in `Cells`, of stage values of R alone.

    `deflections` (S, M, q, 2 modes) and `compliance` (S, M, q, q) are F and P of the module's
    docstring; `at_end` (S, M, 2 modes, q) are states, `effect` has shape (S, M, N_INNER, q);
    `free` is that of `mode_responses`.
    """

    free: FloatArray
    deflections: FloatArray
    compliance: FloatArray
    at_end: FloatArray
    effect: FloatArray


def _beam_maps(
    crossing: Crossing,
    places: FloatArray,
    rates: FloatArray | None,
    kind: NDArray[np.intp],
    durations: FloatArray,
    of_beam: FloatArray,
) -> _BeamMaps:
    """Maps of cells by their `FORCE_POINTS` (M, N_FORCES) and kinds (M,).

    `rates` are those of the shapes at the stages, `of_beam` is the effect's row (modes, 2).
    """
    n_speeds, n_maps, n_modes = len(durations), len(places), len(of_beam)
    lags = crossing.linear.tire_lags[:, np.newaxis]
    free, held = (
        of[:, :, :n_modes] for of in mode_responses(crossing.beam, durations, FORCE_POINTS, _POINTS)
    )
    forces = crossing.tire_shapes(places)[..., :n_modes]
    shapes = forces[:, :N_STAGES]
    leading = shapes[np.newaxis] if rates is None else shapes + lags * rates[..., :n_modes]
    q = N_STAGES * shapes.shape[2]  # tires innermost
    by_mode = np.ascontiguousarray(forces.transpose(3, 1, 0, 2))[:, :, :, np.newaxis]
    loads = by_mode * TO_FORCES[:, np.newaxis, :, np.newaxis]
    loads = loads.reshape(n_modes, N_FORCES, n_maps, q)
    at_stages = held[:, :, :, :N_STAGES]
    read = [at_stages[..., 0, :], held[:, :, :, END]]
    rows = np.concatenate(read if rates is None else [*read, at_stages[..., 1, :]], axis=3)
    n_rows = rows.shape[3]
    effects = np.einsum("ja,sujpaf->supjf", of_beam, held[:, :, :, _INNER])
    compliance = np.zeros((n_speeds, n_maps, N_STAGES, q // N_STAGES, q))
    at_end = np.zeros((n_speeds, n_maps, n_modes, 2, q))
    effect = np.zeros((n_speeds, n_maps, len(_INNER), q))
    for u in range(durations.shape[1]) if n_modes else ():
        of_kind = kind == u
        own = slice(None) if of_kind.all() else np.nonzero(of_kind)[0]
        here = loads[:, :, own]
        size, here = here.shape[2], here.reshape(n_modes, N_FORCES, -1)
        # Of each mode by speed, row, cell and stage value.
        response = rows[:, u].swapaxes(0, 1).reshape(n_modes, n_speeds * n_rows, N_FORCES) @ here
        response = response.reshape(n_modes, n_speeds, n_rows, size, q)
        # The same by speed, cell, row, mode and stage value.
        felt = response.transpose(1, 3, 2, 0, 4)
        compliance[:, own] = leading[:, own] @ felt[:, :, :N_STAGES]
        if rates is not None:
            compliance[:, own] += (lags * shapes[own]) @ felt[:, :, N_ROWS:]
        at_end[:, own] = response[:, :, N_STAGES:N_ROWS].transpose(1, 3, 0, 2, 4)
        values = effects[:, u].reshape(n_speeds * len(_INNER), -1) @ here.reshape(-1, size * q)
        effect[:, own] = values.reshape(n_speeds, -1, size, q).swapaxes(1, 2)
    motions = free[:, :, :, :N_STAGES].swapaxes(2, 3)[:, kind, :, np.newaxis]
    deflections = leading[..., np.newaxis] * motions[..., 0, :]
    if rates is not None:
        deflections += (lags * shapes)[..., np.newaxis] * motions[..., 1, :]
    return _BeamMaps(
        free,
        deflections.reshape(n_speeds, n_maps, q, 2 * n_modes),
        compliance.reshape(n_speeds, n_maps, q, q),
        at_end.reshape(n_speeds, n_maps, 2 * n_modes, q),
        effect,
    )
