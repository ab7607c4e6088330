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
from bridgectl._places import SAME_PLACE
from bridgectl._units import to_kmh
from bridgectl._warn import warn
from bridgectl.linear.cells import (
    FORCE_POINTS,
    GAUSS,
    N_STAGES,
    SAMPLES,
    bridge_entry,
    build_cells,
    modal_forces,
    parabola,
    road_rows,
)
from bridgectl.linear.modes import hold_responses, mode_responses
from bridgectl.linear.runs import LIFT_OFF, Run
from bridgectl.linear.stages import vehicle_matrices
from bridgectl.model.crossing import Crossing

EVENT_TOLERANCE = 1e-12
"""Accuracy of the place of an event, as a fraction of its cell."""

GRAZING = 1e-3
"""After an event the next one is looked for from this fraction of the rest of the cell on."""

FEWEST_CELLS = 16
"""Cells that are tried at once after an event; four times as many each time nothing happens."""

_TRIED = np.polynomial.chebyshev.chebpts1(12)
_TO_SERIES = np.linalg.inv(np.polynomial.chebyshev.chebvander(_TRIED, len(_TRIED) - 1))


class LiftOffWarning(UserWarning):
    """A tire leaves the road: the crossing is not linear, and superposition not exact."""


class Flight(NamedTuple):
    """A crossing with tires kept from pulling, its nodes [m] (m,) with the events among them.

    States (n, m) and tire forces [N] (n_tires, m) are those at the nodes, the crossing's effect
    (6 (m - 1) + 1,) that at `bridgectl.linear.cells.sample_positions` of the nodes.
    """

    nodes: FloatArray
    states: FloatArray
    forces: FloatArray
    effects: FloatArray


class _Part(NamedTuple):
    """Cells one after the other: ends, states and forces there, and what is in them."""

    ends: FloatArray
    states: FloatArray
    forces: FloatArray
    effects: FloatArray


class _Stretch:
    """Cells from a place on in which the same tires touch the road, whatever their forces."""

    def __init__(
        self,
        run: Run,
        speed: float,
        nodes: FloatArray,
        state: FloatArray,
        touching: NDArray[np.bool_],
    ) -> None:
        self.run, self.speed, self.nodes, self.touching = run, speed, nodes, touching
        crossing, self.on_bridge = run.crossing, nodes[-1] > SAME_PLACE
        cells = build_cells(
            crossing, np.array([speed]), nodes, on_bridge=self.on_bridge, contact=touching
        )
        road, size = run.road(nodes), cells.n_states
        states, stages = cells.propagate(
            road_rows(road)[..., np.newaxis], state[np.newaxis, :size, np.newaxis]
        )
        self.states = np.zeros((len(nodes), crossing.n_states))
        self.states[:, :size] = states[0, ..., 0]
        self.stages = stages[0].reshape(len(nodes) - 1, 2, N_STAGES, -1)
        self.effects = cells.inner_effects(states[:, :-1, :, 0], stages[..., 0])[0]
        self.would_be = _would_be(crossing, nodes, self.states, road)

    def violation(self) -> tuple[int, float] | None:
        """First cell in which a tire has left or met the road too late, and by where in it."""
        slack = LIFT_OFF * self.run.crossing.linear.static_loads
        pulling = ((self.stages[:, 0] < -slack) & self.touching).any(axis=2)
        late = (_margins(self.would_be[1:], self.touching) < -slack).any(axis=1)
        found = np.nonzero(pulling.any(axis=1) | late)[0]
        if not found.size:
            return None
        of_cell = pulling[found[0]]
        return int(found[0]), float(GAUSS[np.argmax(of_cell)]) if of_cell.any() else 1.0

    def part(self, count: int) -> _Part:
        """The first cells."""
        forces = np.where(self.touching, np.maximum(self.would_be, 0.0), 0.0)
        after, inside = slice(1, count + 1), slice(count)
        return _Part(
            self.nodes[after], self.states[after], forces[after], self.effects[inside]
        )  # fmt: skip

    def event(self, cell: int, latest: float, first: float) -> float:
        """Fraction of a cell, up to `latest`, where a tire first leaves or meets the road."""
        tried = first + (latest - first) * (1 + _TRIED) / 2
        margins = _margins(self._within(cell, np.append(first, tried))[1], self.touching)
        if margins[0].min() <= 0:
            return first
        series = _TO_SERIES @ margins[1:]

        def margin(fraction: float) -> float:
            place = 2 * (fraction - first) / (latest - first) - 1
            return float(np.polynomial.chebyshev.chebval(place, series).min())

        return float(brentq(margin, first, latest, xtol=EVENT_TOLERANCE))

    def cut(self, cell: int, fraction: float) -> tuple[_Part, int]:
        """A cell up to an event, and the tire that leaves or meets the road there."""
        crossing, slack = self.run.crossing, LIFT_OFF * self.run.crossing.linear.static_loads
        inside = fraction * np.append(SAMPLES[1:], 1.0)
        states, would_be = self._within(cell, inside)
        forces = parabola(inside[:-1]) @ self.stages[cell, 0]
        turning = int(np.argmin(_margins(would_be[-1], self.touching) / slack))
        x, width = self.nodes[cell], self.nodes[cell + 1] - self.nodes[cell]
        touching = self.touching & (np.arange(len(slack)) != turning)
        effects = crossing.values(x + inside[:-1] * width, states[:-1], forces)
        end = np.where(touching, np.maximum(would_be[-1], 0.0), 0.0)
        part = _Part(
            x + inside[-1:] * width, states[-1:], end[np.newaxis], effects[np.newaxis]
        )  # fmt: skip
        return part, turning

    def _within(self, cell: int, fractions: FloatArray) -> tuple[FloatArray, FloatArray]:
        """States at fractions of a cell, and the forces that tires would have there."""
        crossing, vehicle = self.run.crossing, self.run.crossing.linear
        x, width = self.nodes[cell], self.nodes[cell + 1] - self.nodes[cell]
        duration = np.array([[width / self.speed]])
        surface = self.stages[cell, 1]
        start, n = self.states[cell], crossing.n_vehicle
        free, held = (
            of[0, 0] for of in hold_responses(
                *vehicle_matrices(vehicle, self.touching), duration, GAUSS, fractions
            )
        )  # fmt: skip
        places, states = x + fractions * width, np.zeros((len(fractions), crossing.n_states))
        states[:, :n] = free @ start[:n] + held.reshape(*free.shape[:2], -1) @ surface.ravel()
        if self.on_bridge:
            states[:, n:] = self._modes_within(cell, fractions, duration)
        return states, _would_be(crossing, places, states, self.run.road(places))

    def _modes_within(self, cell: int, fractions: FloatArray, duration: FloatArray) -> FloatArray:
        """States of the modes at fractions of a cell."""
        crossing, ends = self.run.crossing, self.nodes[cell : cell + 2]
        forces = self.stages[np.newaxis, cell : cell + 1, 0]
        places = ends[:1, np.newaxis] + np.diff(ends)[:, np.newaxis] * FORCE_POINTS
        loads = modal_forces(crossing, places, forces)[0, 0]
        start = self.states[cell, crossing.n_vehicle :].reshape(-1, 1, 2, 1)
        free, held = (
            of[0, 0] for of in mode_responses(crossing.beam, duration, FORCE_POINTS, fractions)
        )
        states = free @ start + held @ loads[:, np.newaxis, :, np.newaxis]
        return states[..., 0].swapaxes(0, 1).reshape(len(fractions), -1)


def fly(run: Run, speed: float, nodes: FloatArray) -> Flight:
    """Simulate a crossing at a speed [m/s] with its tires kept from pulling, R >= 0.

    Its vehicle starts at rest on the road under each axle. The nodes [m] hold all kinks.
    """
    loads = run.crossing.linear.static_loads
    touching, turned, count = np.ones(len(loads), dtype=bool), False, FEWEST_CELLS
    parts, x, state = [], nodes[0], run.initial()
    first_state, first_force = state, run.forces(x, state, np.array(speed))
    while x < nodes[-1]:
        first, entry = np.searchsorted(nodes, x, side="right"), bridge_entry(nodes)
        # The modes are at rest before the bridge.
        ahead = nodes[first : entry + 1 if first <= entry else None][:count]
        stretch = _Stretch(run, speed, np.append(x, ahead), state, touching)
        found = stretch.violation()
        if found is None:
            parts.append(stretch.part(len(ahead)))
            turned, count = False, 4 * count
        else:
            cell, latest = found
            parts.append(stretch.part(cell))
            earliest = GRAZING if turned and cell == 0 else EVENT_TOLERANCE
            part, turning = stretch.cut(cell, stretch.event(cell, latest, earliest))
            parts.append(part)
            touching = touching.copy()
            touching[turning] = not touching[turning]
            turned, count = True, FEWEST_CELLS
        x, state = parts[-1].ends[-1], parts[-1].states[-1]
    ends, states, forces, inner = (np.concatenate(of) for of in zip(*parts, strict=True))
    ends, forces = np.append(nodes[0], ends), np.vstack([first_force, forces])
    states = np.vstack([first_state, states])
    at_nodes = run.crossing.values(ends, states, forces)
    effects = np.column_stack([at_nodes[:-1], inner]).ravel()
    return Flight(ends, states.T, forces.T, np.append(effects, at_nodes[-1]))


def _would_be(
    crossing: Crossing, x: FloatArray, states: FloatArray, road: FloatArray
) -> FloatArray:
    """Forces that tires would have if they could pull (m, n_tires), for states (m, n)."""
    n = crossing.n_vehicle
    deflections = (crossing.tire_shapes(x) @ states[:, n::2, np.newaxis])[..., 0]
    return crossing.tire_forces(states[:, :n] @ crossing.linear.hubs.T, deflections, road)


def _margins(would_be: FloatArray, touching: NDArray[np.bool_]) -> FloatArray:
    """How far each tire is from leaving or meeting the road [N]; negative is too late."""
    return np.where(touching, would_be, -would_be)


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
