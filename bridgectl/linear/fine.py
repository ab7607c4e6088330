"""Effects between the samples of cells in which some modes of the bridge go through many radians.

Cells follow the slow modes alone. What the fast ones add to an effect is exact at the samples, but
may rise far above them in between: wherever a peak may be, cells are sampled finely, from the
states of the modes at their start and the tire forces at their stages.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import NamedTuple, TypeAlias

import numpy as np
from numpy.typing import NDArray

from bridgectl._checks import FloatArray
from bridgectl.linear.cells import (
    FORCE_POINTS,
    N_FORCES,
    TO_FORCES,
    sample_positions,
)
from bridgectl.linear.modes import mode_responses
from bridgectl.linear.nodes import MAX_BEAM_PHASE
from bridgectl.model.crossing import Crossing
from bridgectl.model.effect import EffectRows

FINE_PHASE = 1.3
"""Largest advance of phase of the fastest mode in a piece of a cell [rad]."""

AT_ONCE = 400
"""Cells whose maps are made together: some 20 MB."""

# From forces at the force points to the polynomial through them.
_QUARTIC = np.linalg.inv(np.vander(FORCE_POINTS))

Rows: TypeAlias = Callable[[FloatArray], EffectRows]
"""What is read of a crossing with its reference tire at places."""


def pieces_of(
    crossing: Crossing, slowest: float, nodes: FloatArray, read: Rows | None = None
) -> int:
    """Pieces of a cell on the bridge that follow every mode; 1 where the effect reads none."""
    rows = (read or crossing.rows)(np.zeros(1))
    if crossing.linear.tire_damping.any():  # of which cells follow every mode
        return 1
    reads = rows.per_state[crossing.n_vehicle :].any()
    return mode_pieces(crossing, slowest, nodes) if reads else 1


def mode_pieces(crossing: Crossing, slowest: float, nodes: FloatArray, refine: int = 1) -> int:
    """Pieces of a cell on the bridge that follow every mode, `refine` times as close."""
    widest = float(np.diff(nodes)[nodes[:-1] >= 0].max())
    phase = refine * crossing.beam.omega.max() * widest / slowest
    return 1 if phase < MAX_BEAM_PHASE + 1e-6 else int(np.ceil(phase / FINE_PHASE))


class FineMaps(NamedTuple):
    """Effect over scale at the fine samples of cells: ``maps @ [modes, forces] + constant``.

    Modal states are those at the start of a cell, (2 modes), tire forces those at `FORCE_POINTS`,
    its stages and ends, point by point. `maps` has shape (cells, 6 pieces + 1, ...).
    """

    maps: FloatArray
    constant: float


def fine_maps(
    crossing: Crossing,
    speeds: FloatArray,
    starts: FloatArray,
    ends: FloatArray,
    pieces: int,
    read: Rows | None = None,
) -> FineMaps:
    """Maps of cells on the bridge, each at its own speed [m/s], from start to end [m].

    Of the crossing's effect, or of what else is read of it.
    """
    fractions = sample_positions(np.linspace(0, 1, pieces + 1))
    widths = ends - starts
    durations, which = np.unique(np.round(widths, 10) / speeds, return_inverse=True)
    free, held = (
        of[0] for of in mode_responses(crossing.beam, durations[None], FORCE_POINTS, fractions)
    )
    rows = (read or crossing.rows)(starts[:, np.newaxis] + widths[:, np.newaxis] * fractions)
    of_modes = rows.per_state[crossing.n_vehicle :].reshape(-1, 2)
    free = np.einsum("ja,ujpab->upjb", of_modes, free).reshape(len(durations), fractions.size, -1)
    held = np.einsum("ja,ujpaf->upjf", of_modes, held).reshape(len(durations), fractions.size, -1)
    shapes = crossing.tire_shapes(starts[:, np.newaxis] + widths[:, np.newaxis] * FORCE_POINTS)
    # Cells, modes, force points, stages, tires.
    loads = np.moveaxis(shapes, -1, 1)[:, :, :, np.newaxis] * TO_FORCES[..., np.newaxis]
    loads = loads.reshape(len(starts), held.shape[-1], -1)
    through = (
        rows.per_force[:, :, np.newaxis]
        * (np.vander(fractions, N_FORCES) @ _QUARTIC)[..., np.newaxis]
    )
    forces = through.reshape(*through.shape[:2], -1)
    forces[..., : loads.shape[-1]] += held[which] @ loads
    return FineMaps(np.concatenate([free[which], forces], axis=2), rows.constant)


class Refinement:
    """Samples between those of a batch of crossings, one a column of their histories.

    States have shape (S, C + 1, n), tire forces at the stages (S, C, q) and at the nodes
    (S, C + 1, n_tires).
    """

    def __init__(
        self,
        crossing: Crossing,
        speeds: FloatArray,
        nodes: FloatArray,
        states: FloatArray,
        forces: FloatArray,
        at_nodes: FloatArray,
        pieces: int,
        read: Rows | None = None,
    ) -> None:
        self.crossing, self.speeds, self.nodes, self.read = crossing, speeds, nodes, read
        self.known = states[:, :-1, crossing.n_vehicle :], forces, at_nodes[:, :-1], at_nodes[:, 1:]
        self.pieces = pieces

    def __call__(self, cells: NDArray[np.intp], columns: NDArray[np.intp]) -> Iterator[FloatArray]:
        """Fine samples of cells, (6 pieces + 1, some of them), a part after the other."""
        for first in range(0, len(cells), AT_ONCE):
            cell, column = (each[first : first + AT_ONCE] for each in (cells, columns))
            found = fine_maps(
                self.crossing, self.speeds[column], self.nodes[cell], self.nodes[cell + 1],
                self.pieces, self.read,
            )  # fmt: skip
            known = np.hstack([of[column, cell] for of in self.known])
            yield (found.maps @ known[..., np.newaxis])[..., 0].T + found.constant
