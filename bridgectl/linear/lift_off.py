"""Tires that leave the road: a crossing as linear pieces between lift-offs and landings.

While the same tires touch the road a crossing is linear, and the propagator's cells solve it.
Where a tire force falls to zero, or a tire in flight meets the road, the cell is cut there and
the crossing goes on with the other set of tires.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import brentq

from bridgectl._checks import FloatArray
from bridgectl._units import to_kmh
from bridgectl._warn import warn
from bridgectl.linear.cells import GAUSS, N_STAGES, Cells, build_cells, road_rows
from bridgectl.linear.runs import LIFT_OFF, Run
from bridgectl.model.crossing import Crossing

EVENT_TOLERANCE = 1e-12
"""Accuracy of the place of an event, as a fraction of its cell."""

GRAZING = 1e-3
"""After an event the next one is looked for from this fraction of the rest of the cell on."""


class LiftOffWarning(UserWarning):
    """A tire leaves the road: the crossing is not linear, and superposition not exact."""


class Flight(NamedTuple):
    """A crossing with tires kept from pulling, its nodes [m] (m,) with the events among them.

    States (n, m) and tire forces [N] (n_tires, m) are those at the nodes, the crossing's effect
    (6 (m - 1) + 1,) that at `bridgectl.linear.cells.sample_positions` of them.
    """

    nodes: FloatArray
    states: FloatArray
    forces: FloatArray
    effects: FloatArray


class _Step(NamedTuple):
    """States at its end, the forces tires would have there if they could pull, and its stages."""

    state: FloatArray
    would_be: FloatArray
    stage_forces: FloatArray
    effects: FloatArray


class _Stepper:
    """Steps through the cells of one crossing at one speed, with any set of tires touching."""

    def __init__(self, run: Run, speed: float, nodes: FloatArray) -> None:
        self.run, self.nodes = run, nodes
        self.speeds = np.array([speed])
        self.road, self.shapes = run.road(nodes), run.crossing.tire_shapes(nodes)
        self.rows = road_rows(self.road)
        self.built: dict[bytes, Cells] = {}

    def whole(self, c: int, state: FloatArray, touching: NDArray[np.bool_]) -> _Step:
        """Step through cell c; the maps of all cells are built when a set first needs them."""
        key = touching.tobytes()
        if key not in self.built:
            self.built[key] = self._cells(self.nodes, touching)
        after = self.road[c + 1], self.shapes[c + 1]
        return self._through(self.built[key], c, state, self.rows[c], *after)

    def part(self, x: float, end: float, state: FloatArray, touching: NDArray[np.bool_]) -> _Step:
        """Step from x to end, within a cell."""
        ends = np.array([x, end])
        road, shapes = self.run.road(ends), self.run.crossing.tire_shapes(end)
        cells = self._cells(ends, touching)
        return self._through(cells, 0, state, road_rows(road)[0], road[1], shapes)

    def _cells(self, nodes: FloatArray, touching: NDArray[np.bool_]) -> Cells:
        crossing = self.run.crossing
        return build_cells(crossing, self.speeds, nodes, on_bridge=True, contact=touching)

    def _through(
        self,
        cells: Cells,
        c: int,
        state: FloatArray,
        rows: FloatArray,
        road: FloatArray,
        shapes: FloatArray,
    ) -> _Step:
        kind, n = cells.kind[c], self.run.crossing.n_vehicle
        stages = cells.from_states[0, c] @ state + cells.from_road[0, c] @ rows
        forces = stages[: len(stages) // 2]
        effects = cells.effect_from_states[0, kind] @ state + cells.effect_constant
        effects += cells.effect_from_stages[0, c] @ stages
        after = cells.free[0, kind, N_STAGES] @ state + cells.inputs[0, c] @ stages
        hubs = self.run.crossing.linear.hubs @ after[:n]
        would_be = self.run.crossing.tire_forces(hubs, shapes @ after[n::2], road)
        return _Step(after, would_be, forces.reshape(N_STAGES, -1), effects)


def fly(run: Run, speed: float, nodes: FloatArray) -> Flight:
    """Simulate a crossing at a speed [m/s] with its tires kept from pulling, R >= 0.

    Its vehicle starts in equilibrium on a level road. The nodes of the cells [m] hold all kinks.
    """
    crossing, stepper = run.crossing, _Stepper(run, speed, nodes)
    slack = LIFT_OFF * crossing.linear.static_loads
    touching = np.ones(crossing.linear.n_tires, dtype=bool)
    state: FloatArray = np.zeros(crossing.n_states)
    force = crossing.linear.static_loads
    places, states, forces, effects = [nodes[0]], [state], [force], []
    for c, end in enumerate(nodes[1:]):
        x, turning = nodes[c], None
        while x < end:
            reach = end
            if x == nodes[c]:
                step = stepper.whole(c, state, touching)
            else:
                step = stepper.part(x, end, state, touching)
            latest = _violation(step, touching, slack)
            just_turned, turning = turning is not None, None
            if latest is not None:
                reach = _event(stepper, x, end, latest, state, touching, just_turned)
                step = stepper.part(x, reach, state, touching)
                turning = int(np.argmin(_margins(step.would_be, touching) / slack))
            effects.append([_effect(crossing, x, state, force), *step.effects])
            if turning is not None:
                touching = touching.copy()
                touching[turning] = not touching[turning]
            x, state = reach, step.state
            force = np.where(touching, np.maximum(step.would_be, 0.0), 0.0)
            places.append(x)
            states.append(state)
            forces.append(force)
    last = _effect(crossing, nodes[-1], state, force)
    return Flight(
        np.array(places), np.array(states).T, np.array(forces).T, np.append(np.ravel(effects), last)
    )


def _effect(crossing: Crossing, x: float, state: FloatArray, force: FloatArray) -> float:
    return float(crossing.values(np.array([x]), state[np.newaxis], force[np.newaxis])[0])


def _margins(would_be: FloatArray, touching: NDArray[np.bool_]) -> FloatArray:
    """How far each tire is from leaving or meeting the road [N]; negative is too late."""
    return np.where(touching, would_be, -would_be)


def _violation(step: _Step, touching: NDArray[np.bool_], slack: FloatArray) -> float | None:
    """Fraction of the cell by which some tire has left or met the road, None if none has."""
    pulling = (step.stage_forces < -slack) & touching
    if pulling.any():
        return float(GAUSS[np.argmax(pulling.any(axis=1))])
    late = _margins(step.would_be, touching) < -slack
    return 1.0 if late.any() else None


def _event(
    stepper: _Stepper,
    x: float,
    end: float,
    latest: float,
    state: FloatArray,
    touching: NDArray[np.bool_],
    just_turned: bool,
) -> float:
    """Position of the first lift-off or landing between x and the fraction `latest` [m]."""

    def margin(fraction: float) -> float:
        part = stepper.part(x, x + fraction * (end - x), state, touching)
        return float(_margins(part.would_be, touching).min())

    # The tire that has just left or met the road has a margin of zero, give or take round-off.
    first = GRAZING if just_turned else EVENT_TOLERANCE
    if margin(first) <= 0:
        return x + first * (end - x)
    fraction = brentq(margin, first, latest, xtol=EVENT_TOLERANCE)
    return x + fraction * (end - x)


def warn_of_flight(place: float) -> None:
    """Tell where the tire of one crossing first leaves the road [m]."""
    warn(
        f"a tire leaves the road, first with the reference tire at x = {place:.2f} m: "
        "simulated with R >= 0; the crossing is not linear there",
        LiftOffWarning,
    )


def warn_of_flights(flights: Mapping[float, float], n_speeds: int) -> None:
    """Tell at which speeds [m/s] a tire leaves the road, if it does, and where first [m]."""
    if flights:
        warn(
            f"a tire leaves the road at {len(flights)} of {n_speeds} speeds, the slowest "
            f"{to_kmh(min(flights)):.0f} km/h, the first place x = {min(flights.values()):.1f} m: "
            "simulated there with R >= 0",
            LiftOffWarning,
        )
