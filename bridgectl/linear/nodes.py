"""Where a crossing is cut into cells: at what is not smooth, and finely enough between."""

from __future__ import annotations

import numpy as np

from bridgectl._checks import FloatArray
from bridgectl._places import SAME_PLACE, merge_places
from bridgectl._work import MOST_CELLS
from bridgectl.model.crossing import Crossing

MAX_WIDTH = 0.1
"""Widest cell [m]: the paper's segment length, below which road waves do not matter."""

# Largest advance of phase in a cell [rad], of the vehicle's fastest motion and of the highest
# mode. Moments are then within 1e-7 of their converged values (tests/test_propagator.py).
MAX_VEHICLE_PHASE = 0.4
MAX_BEAM_PHASE = 1.7

MOVING = 1e-3
"""Share of its largest value above which a mode's shape moves an end of the bridge. A tire comes on
with a blow there, and the mode rings on: its phase is off when cells do not follow it."""

BLOW = 2.0
"""How many times as fast such a mode counts."""


def kink_positions(
    crossing: Crossing, start: float, end: float, stations: FloatArray
) -> FloatArray:
    """Positions from `start` to `end` where the motion is not smooth, both included [m].

    There a tire meets one of the `stations` (the road's ramps), enters, leaves, or passes the
    section.
    """
    places = np.concatenate([stations, crossing.kinks])
    paths, length = crossing.paths, crossing.beam.length
    kinks = paths.passing(places, length, start, end)
    kinks = np.concatenate([kinks, paths.changes(start, end)])
    inside = (kinks > start + SAME_PLACE) & (kinks < end - SAME_PLACE)
    return merge_places(np.concatenate([[start], kinks[inside], [end]]))


def fastest_motion(crossing: Crossing) -> float:
    """Fastest motion of the vehicle on a rigid road [rad/s]."""
    return float(np.abs(np.linalg.eigvals(crossing.linear.state_matrix_on_tires())).max())


def cell_width(vehicle: float, beam: float, speed: float) -> float:
    """Width of cells [m] that are short for motions of vehicle and beam [rad/s] at a speed."""
    phases = vehicle / MAX_VEHICLE_PHASE, beam / MAX_BEAM_PHASE
    return min(MAX_WIDTH, speed / max(phases))


def followed(crossing: Crossing, *, wide: bool) -> float:
    """Fastest mode that cells follow [rad/s]: wide ones follow what the tires feel."""
    beam = crossing.beam
    shapes = np.abs(beam.mode_shapes(np.linspace(0.0, beam.length, 101)))
    largest = shapes.max(axis=0)
    moving = np.maximum(shapes[0], shapes[-1]) > MOVING * largest
    yields = crossing.linear.tire_stiffnesses.max() * largest**2
    felt = yields > crossing.negligible * beam.modal_masses * beam.omega**2
    if not wide:
        felt[:] = True
    fastest = np.where(moving, BLOW, 1.0) * beam.omega
    return float(fastest[felt | moving].max(initial=beam.omega.min()))


def cell_nodes(
    crossing: Crossing, speed: float, kinks: FloatArray, refine: int = 1, *, wide: bool = False
) -> FloatArray:
    """Place the nodes of the cells: at the kinks, and between them where cells are too long.

    Cells are short enough for the fastest motions at `speed`, the slowest of a batch;
    `refine` cuts each into as many again; `wide` ones follow what the tires feel alone. Before the
    bridge no mode moves.
    """
    fastest, highest = fastest_motion(crossing), followed(crossing, wide=wide)
    on_bridge = cell_width(fastest, highest, speed)
    width = np.where(kinks[1:] < SAME_PLACE, cell_width(fastest, 0.0, speed), on_bridge)
    # Errors of several vehicles add up.
    width = width / np.sqrt(crossing.paths.distances.size)
    width = np.minimum(width, MAX_WIDTH / crossing.paths.fastest(kinks[0], kinks[-1]))
    pieces = refine * np.ceil(np.diff(kinks) / width - SAME_PLACE)
    if pieces.sum() > MOST_CELLS:
        raise ValueError(
            f"the crossing at {speed:g} m/s needs {pieces.sum():.3g} cells of {on_bridge:.2g} m, "
            f"more than {MOST_CELLS:.0f}: the vehicle's fastest motion is at {fastest:.3g} rad/s "
            f"(check stiffnesses, damping and masses), the beam's at {highest:.3g} rad/s "
            "(type a smaller n_modes)"
        )
    pieces = pieces.astype(int)
    first, steps = np.repeat([kinks[:-1], np.diff(kinks) / pieces], pieces, axis=1)
    within = np.arange(pieces.sum()) - np.repeat(np.cumsum(pieces) - pieces, pieces)
    return np.append(first + within * steps, kinks[-1])
