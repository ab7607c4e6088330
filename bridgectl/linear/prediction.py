"""Prediction matrices of a crossing: its motion from node to node, and its effect there."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from bridgectl._checks import FloatArray
from bridgectl._plausible import judge_crossing
from bridgectl._threads import on_one_thread
from bridgectl._warn import warn
from bridgectl.linear.cells import bridge_entry, road_rows
from bridgectl.linear.estimates import require_crossing
from bridgectl.linear.lift_off import LiftOffWarning
from bridgectl.linear.runs import Run, Stretch, lifts_off, propagate
from bridgectl.linear.start import begin
from bridgectl.model.bridge import BridgeModel
from bridgectl.model.crossing import make_crossing
from bridgectl.model.effect import Effect
from bridgectl.model.motion import Motion
from bridgectl.model.quarter_car import QuarterCar
from bridgectl.model.vehicle import Vehicle
from bridgectl.road import RoadProfile


@dataclass(frozen=True, eq=False)
class Prediction:
    """A linear crossing, node by node; `prediction_matrices` tells of the fields."""

    positions: FloatArray
    """[m]"""
    durations: FloatArray
    """[s]"""
    transitions: FloatArray
    """Of states [m, m/s]."""
    offsets: FloatArray
    """Of states [m, m/s]."""
    damper_input: FloatArray
    """[m/s per N s]"""
    velocity_rows: FloatArray
    """[m/s] of states [m, m/s]."""
    effect_rows: FloatArray
    """A factor, of states [m, m/s]."""
    effect_constants: FloatArray
    """A factor."""
    entry: int
    initial: FloatArray
    """[m, m/s]"""

    def __repr__(self) -> str:
        x, (n, n_dampers) = self.positions, self.damper_input.shape
        return (
            f"Prediction({len(x) - 1} cells from x = {x[0]:.4g} m to {x[-1]:.4g} m, {n} states, "
            f"{n_dampers} dampers)"
        )


@on_one_thread
def prediction_matrices(
    beam: BridgeModel,
    vehicle: Vehicle | QuarterCar,
    speed: float,
    profile: RoadProfile | None = None,
    *,
    start: float = 0.0,
    section: float = 0.5,
    recovery: str = "exact",
    effect: Effect | str = "moment",
) -> Prediction:
    """Return one crossing as a linear recursion in the impulses of its dampers.

    For control with preview, bounds and optimization. With the tires in contact::

        x_(k+1) = transitions[k] @ (x_k + damper_input @ z_k) + offsets[k],   x_0 = initial
        effect_k = effect_rows[k] @ x_k + effect_constants[k]
        v_k = velocity_rows @ x_k

    z_k are the impulses [N s] of damper forces at node k, on top of the vehicle's own damping,
    v_k the suspension velocities [m/s] before them. The cells between the nodes are exact but for
    1e-7 of the moment.

    Parameters
    ----------
    beam, vehicle, section, recovery, effect
        See `bridgectl.daf`.
    speed, profile, start
        See `bridgectl.crossing_response`.

    Returns
    -------
    Prediction
        Of C cells, the n states of `crossing_system` [m, m/s] and n_dampers dampers:

        - positions (C + 1,) of the reference tire at the nodes [m], durations (C,) of the cells
          [s], and the index `entry` of the node at the start of the bridge;
        - transitions (C, n, n) and offsets (C, n), in which are the road and the static loads;
        - damper_input (n, n_dampers) [m, m/s per N s] and velocity_rows (n_dampers, n);
        - effect_rows (C + 1, n) and effect_constants (C + 1,) of the effect over its static peak,
          if it has one, with the road and the static loads; of what counts by its smallest value,
          and is positive, its negative.

        - initial (n,) [m, m/s]: the states at the start, at rest on the road under each axle.

        On the approach the bridge is at rest: its states are 0, and so are all rows.

    Raises
    ------
    TypeError, ValueError
        As `bridgectl.crossing_response`.

    Warns
    -----
    LiftOffWarning
        If a tire leaves the road without damper forces: the recursion lets it pull there.
    PlausibilityWarning, UserWarning
        As `bridgectl.crossing_response`.

    Examples
    --------
    >>> import numpy as np
    >>> import bridgectl as bc
    >>> beam, car = bc.li2006.beam(), bc.li2006.car()
    >>> road = bc.RoadProfile([-5, 3, 3.1, 25], [0, 0, -0.003, -0.003])
    >>> known = bc.prediction_matrices(beam, car, 30.0, road, start=-5)
    >>> states = [np.zeros(10)]
    >>> for transition, offset in zip(known.transitions, known.offsets):
    ...     states.append(transition @ states[-1] + offset)
    >>> moment = (known.effect_rows * states).sum(axis=1) + known.effect_constants
    >>> response = bc.crossing_response(beam, car, 30.0, road, start=-5)
    >>> print(f"{moment.max():.4f} predicted, {response.outputs['moment'].max():.4f} simulated")
    1.1484 predicted, 1.1484 simulated
    """
    crossing, c = make_crossing(beam, vehicle, effect, section, recovery), Motion(speed).speed
    run, speeds = begin(crossing, profile, start, c), np.array([c])
    crossing.paths.require_steady(speeds)
    judge_crossing(crossing, c, profile)
    require_crossing(run, speeds)
    nodes = run.nodes(c)
    stretches = propagate(run, speeds, nodes)
    if lifts_off(crossing, stretches)[0]:
        warn("a tire leaves the road: the prediction is of one that pulls there", LiftOffWarning)
    return predict(run, c, nodes, stretches)


def predict(
    run: Run, speed: float, nodes: FloatArray, stretches: list[Stretch] | None = None
) -> Prediction:
    """Prediction at nodes; `stretches` if it is already simulated there."""
    crossing, n, first = run.crossing, run.crossing.n_states, 0
    durations = np.diff(nodes) / speed
    transitions, offsets = np.zeros((len(durations), n, n)), np.zeros((len(durations), n))
    for _, cells, *_ in stretches or propagate(run, np.array([speed]), nodes):
        own, size = slice(first, first + len(cells.kind)), cells.n_states
        maps = cells.transitions()[0, cells.map_of, :size]
        transitions[own, :size, :size] = maps[..., :size]
        offsets[own, :size] = (
            maps[..., size:] @ road_rows(run.road(cells.nodes))[..., np.newaxis]
        )[..., 0]
        first = own.stop
    velocities = np.zeros((len(crossing.linear.damper_map), n))
    velocities[:, : crossing.n_vehicle] = crossing.linear.damper_map @ crossing.linear.velocities
    return Prediction(
        nodes, durations, transitions, offsets, crossing.damper_matrix, velocities,
        *_effects(run, speed, nodes), bridge_entry(nodes), run.initial(),
    )  # fmt: skip


def _effects(run: Run, speed: float, nodes: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Rows and constants of the crossing's effect at the nodes, 0 on the approach.

    The effect is affine in the states: its values at rest and at each unit state tell.
    """
    crossing, on = run.crossing, slice(bridge_entry(nodes), None)
    x, units = nodes[on], np.eye(crossing.n_states + 1, crossing.n_states, -1)
    forces = run.forces(x, units[:, np.newaxis], np.full(len(x), speed))
    values = np.zeros((len(nodes), len(units)))
    values[on] = crossing.values(x, units[:, np.newaxis], forces).T
    return values[:, 1:] - values[:, :1], values[:, 0]
