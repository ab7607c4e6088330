"""The predicted peaks of a few held dampings, as one CasADi function.

A step of length h is symmetric (Strang's splitting): half a kick by the springs, half the way, the
damper's impulse by its own exact law, the other half of the way and of the kick. The bridge moves
exactly under a tire force that changes straight from start to end of the step. The damping of a
step is chosen at its start: held, or bridgehook's. All dampings step side by side.

Steps come in blocks, of which those behind the end of the bridge are left out, and on the approach
the bridge is: a decision near the end takes no time.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import casadi as ca
from bridgectl.dampers.rollout.ahead import Mapped, Seen
from bridgectl.dampers.rollout.plant import NEVER, Plant
from bridgectl.dampers.rollout.table import read

BLOCK = 32
"""Steps that are made or left out together."""

POWER = 0
UNROLLED = 4
"""Steps that are written out one after the other."""

PEAK = 4
"""Row of the largest effect yet: after suspension travel and axle [m], velocities of body and axle
[m/s], before the tire force [N], and of each mode displacement [m], velocity [m/s] and modal force
[N]."""

APART = {"never_inline": True}


def peaks_function(
    plant: Plant, dampings: Sequence[float], bounds: tuple[float, float], hold: float,
    road: Seen | Mapped,
) -> ca.Function:  # fmt: skip
    """Return the peaks that are predicted of held dampings [N s/m], over the static one.

    Of the place, in steps behind the first node of the plant, the state, (n, 1) without the largest
    effect yet, and the elevations of the road. Bounds are those that bridgehook switches between
    [N s/m].
    """
    n_modes, count = plant.crossing.beam.n_modes, len(dampings)
    place, given = ca.MX.sym("place"), ca.MX.sym("given", 5 + 3 * n_modes)
    index = ca.floor(place)
    share = place - index
    state = ca.repmat(ca.vertcat(given[:PEAK], NEVER if POWER == 0 else 0, given[PEAK:]), 1, count)
    held, blocks = max(1, round(hold / plant.step)), _Blocks(plant, count, bounds)
    first, free = blocks.held(held, [float(plant.impulse(c)) for c in dampings]), blocks.free()
    state = first(index, share, state, road.drops(index, share, 0, held))
    for begin in range(held, plant.last + 1, BLOCK):
        state = free(index + begin, share, state, road.drops(index, share, begin, BLOCK))
    return ca.Function("rollout", [place, given, road.elevations], [state[PEAK, :].T], APART)


class _Blocks:
    """Functions of several steps: of an index, a share, the states (n, count) and drops."""

    def __init__(self, plant: Plant, count: int, bounds: tuple[float, float]) -> None:
        self.plant, self.count = plant, count
        self.soft, self.stiff = (float(plant.impulse(c)) for c in bounds)
        self.n_rows = 6 + 3 * plant.crossing.beam.n_modes

    def held(self, size: int, impulses: Any) -> ca.Function:
        """Steps with an impulse per suspension velocity held for each state."""
        return self._block("held", size, True, impulses)

    def free(self) -> ca.Function:
        """Steps with bridgehook's damping; behind the end of the bridge nothing."""
        inputs = self._inputs(BLOCK)
        still = ca.Function("still", inputs, [inputs[2]], APART)
        parts = [self._block("approach", BLOCK, False), self._block("bridge", BLOCK, True)]
        which = ca.Function.conditional("which", parts, still, APART)
        index = inputs[0]
        kind = (index + BLOCK > self.plant.entry) + (index >= self.plant.last)
        return ca.Function("free", inputs, [which(kind, *inputs)], APART)

    def _inputs(self, size: int) -> list[Any]:
        return [
            ca.MX.sym("index"), ca.MX.sym("share"), ca.MX.sym("state", self.n_rows, self.count),
            ca.MX.sym("drops", 1, size),
        ]  # fmt: skip

    def _block(self, name: str, size: int, on_bridge: bool, impulses: Any = None) -> ca.Function:
        index, share, state, drops = inputs = self._inputs(size)
        rows = read(self.plant.table, index, share, size)
        unrolled = UNROLLED if size % UNROLLED == 0 else 1
        steps = self._steps(unrolled, on_bridge, impulses)
        every = steps.mapaccum(f"every_{name}", size // unrolled) if size > unrolled else steps
        after = every(state, ca.vertcat(rows, drops))
        return ca.Function(name, inputs, [after[:, -self.count :]], APART)

    def _steps(self, size: int, on_bridge: bool, impulses: Any) -> ca.Function:
        state = ca.SX.sym("state", self.n_rows, self.count)
        rows = ca.SX.sym("rows", len(self.plant.table) + 1, size)
        columns = ca.horzsplit(state)
        for k in range(size):
            for i, column in enumerate(columns):
                own = None if impulses is None else impulses[i]
                columns[i] = self._step(column, rows[:, k], on_bridge, own)
        return ca.Function("steps", [state, rows], [ca.horzcat(*columns)], APART)

    def _step(self, state: Any, row: Any, on_bridge: bool, impulse: Any) -> Any:
        """One step of one state."""
        plant, (travel, axle, up, low, peak, force, *modes) = self.plant, ca.vertsplit(state)
        n, h, car = plant.crossing.beam.n_modes, plant.step, plant.car
        constant, per_body, per_axle, *others = ca.vertsplit(row)
        shapes, (per_force, beside, drop) = others[:n], others[n:]
        of_body, of_axle, load = h / 2 / car.sprung_mass, h / 2 / car.unsprung_mass, plant.load
        if impulse is None:
            worth = (constant + per_body * up + per_axle * low) * (up - low)
            impulse = self.soft + (worth < 0) * (self.stiff - self.soft)
        spring = car.suspension_stiffness * travel
        up, low = up - of_body * spring, low + of_axle * (spring + load - force)
        pushed = impulse * (up - low)
        v, w = up - pushed / car.sprung_mass, low + pushed / car.unsprung_mass
        axle, travel = axle + h / 2 * (low + w), travel + h / 2 * (up - low + v - w)
        squeezed, free = axle - drop, []
        if on_bridge:
            for shape, (own, first, second), k in zip(shapes, plant.modes, range(n), strict=True):
                q, p, push = modes[3 * k : 3 * k + 3]
                free += [own[i, 0] * q + own[i, 1] * p + first[i] * push for i in (0, 1)]
                squeezed -= shape * (free[-2] + second[0] * shape * force)
        force = ca.fmax(load + car.tire_stiffness * squeezed, 0)
        spring = car.suspension_stiffness * travel
        v, w = v - of_body * spring, w + of_axle * (spring + load - force)
        if on_bridge:
            modes, effect = [], per_force * force + beside
            for k, shape in enumerate(shapes):
                push, second = shape * force, plant.modes[k][2]
                q, p = (free[2 * k + i] + second[i] * push for i in (0, 1))
                modes += [q, p, push]
                effect += plant.per_state[k, 0] * q + plant.per_state[k, 1] * p
            if POWER == 0:
                peak = ca.fmax(peak, effect)
            else:
                power, n2 = ca.fmax(effect, 0), POWER
                while n2 > 1:
                    power, n2 = power * power, n2 // 2
                peak += power
        return ca.vertcat(travel, axle, v, w, peak, force, *modes)
