"""What a few held dampings are predicted to lead to, as one CasADi function.

A step of length h is symmetric (Strang's splitting): half a kick by the springs, half the way, the
damper's impulse by its own exact law, the other half of the way and of the kick. The bridge moves
exactly under a tire force that changes straight from start to end of the step. The damping of a
step is chosen at its start: held, or bridgehook's. All dampings step side by side.

Of the effects E_k at the ends of the steps the cost of a damping is a soft maximum, since nobody
knows which of them the road will make the largest, and the cost J of `bridgectl.dampers.weights`::

    log(sum over k of max(E_k, 0)^p) / p + J

Steps come in blocks, of which those behind the end of the bridge are left out, and on the approach
the bridge is: a decision near the end takes no time.
"""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any, NamedTuple

import casadi as ca

from bridgectl.dampers.rollout.ahead import Mapped, Seen
from bridgectl.dampers.rollout.plant import Plant
from bridgectl.dampers.rollout.table import APART, read
from bridgectl.dampers.weights import Weights, best_damping, crossing_time, side_cost

SQUARINGS = 6
"""p = 2^6 = 64, of 8, 16, 32 and 64 as good as any on roads of class A; the maximum itself is as
good with 10 m of preview, and worse without."""

MARGIN = 6e-5
"""Share of the static effect by which another damping must be better than bridgehook's own."""

BLOCK = 32
"""Steps that are made or left out together."""

UNROLLED = 4
"""Steps that are written out one after the other."""

FIRST = 5
"""Rows of a state before the powers of the effects and J: suspension travel and axle [m],
velocities of body and axle [m/s], tire force [N]. After these two each mode has its displacement
[m], its velocity [m/s] and the force on it [N]."""

LEAST = 1e-300
"""Where no effect counts."""


class Policy(NamedTuple):
    """Bridgehook's damping [N s/m] of what a force is worth."""

    c_min: float
    c_max: float
    passive: float
    square: float
    """What the square of a force beyond the passive one costs [1/(N^2 s)]."""

    def damping(self, worth: Any, up: Any, low: Any) -> Any:
        """Of the worth of a force, constant and per velocity, for velocities of body and axle."""
        sigma = worth[0] + worth[1] * up + worth[2] * low
        bounds = SimpleNamespace(c_min=self.c_min, c_max=self.c_max)
        return best_damping(sigma, self.square, self.passive, up - low, bounds)

    def tried(self, own: Any) -> list[Any]:
        """Dampings to try: its own, and others."""
        if self.square == 0:  # it is one of the bounds, and this is the other one
            return [own, self.c_min + self.c_max - own]
        return [own, self.c_min, self.c_max]


def best_function(
    plant: Plant, policy: Policy, weights: Weights, hold: float,
    road: Seen | Mapped,
) -> ca.Function:  # fmt: skip
    """Return the best damping [N s/m], the dampings that are tried and their costs.

    It is a function of the place, in steps behind the first node of the plant, the state of vehicle
    and bridge, and the elevations of the road.
    """
    place, given = ca.MX.sym("place"), ca.MX.sym("given", FIRST + 3 * len(plant.modes))
    index = ca.floor(place)
    share = place - index
    now = ca.vertsplit(read(plant.worth, index, share, 1))
    tried = ca.horzcat(*policy.tried(policy.damping(now, given[2], given[3])))
    state = ca.repmat(ca.vertcat(given[:FIRST], 0, 0, given[FIRST:]), 1, tried.numel())
    held, blocks = max(1, round(hold / plant.step)), _Blocks(plant, policy, weights, tried.numel())
    state = blocks.held(held)(index, share, state, road.drops(index, share, 0, held), tried)
    free = blocks.free()
    for begin in range(held, plant.last + 1, BLOCK):
        state = free(index + begin, share, state, road.drops(index, share, begin, BLOCK))
    peaks = ca.log(ca.fmax(state[FIRST, :], LEAST)) / 2**SQUARINGS
    costs = peaks + state[FIRST + 1, :]
    best, least = tried[0], costs[0] - MARGIN
    for i in range(1, tried.numel()):
        best = ca.if_else(costs[i] < least, tried[i], best)
        least = ca.fmin(costs[i], least)
    return ca.Function("rollout", [place, given, road.elevations], [best, tried, costs], APART)


class _Blocks:
    """Functions of several steps: of an index, a share, states (n, count) and drops (1, size)."""

    def __init__(self, plant: Plant, policy: Policy, weights: Weights, count: int) -> None:
        self.plant, self.policy, self.count = plant, policy, count
        self.n_rows = FIRST + 2 + 3 * len(plant.modes)
        self.cost = side_cost(plant.car, weights) if any(weights) else None
        time = crossing_time(plant.crossing.beam, plant.width / plant.step)
        self.share_of_time = plant.step / time

    def held(self, size: int) -> ca.Function:
        """Steps with dampings (1, count), a further input, held."""
        dampings = ca.MX.sym("dampings", 1, self.count)
        inputs = [*self._inputs(size), dampings]
        return ca.Function("held", inputs, [self._after(inputs, size, True)], APART)

    def free(self) -> ca.Function:
        """Steps with bridgehook's damping; behind the end of the bridge nothing."""
        inputs = self._inputs(BLOCK)
        still = ca.Function("still", inputs, [inputs[2]], APART)
        parts = [
            ca.Function(name, inputs, [self._after(inputs, BLOCK, name == "bridge")], APART)
            for name in ("approach", "bridge")
        ]
        which = ca.Function.conditional("which", parts, still, APART)
        kind = (inputs[0] + BLOCK > self.plant.entry) + (inputs[0] >= self.plant.last)
        return ca.Function("free", inputs, [which(kind, *inputs)], APART)

    def _inputs(self, size: int) -> list[Any]:
        state, drops = ca.MX.sym("state", self.n_rows, self.count), ca.MX.sym("drops", 1, size)
        return [ca.MX.sym("index"), ca.MX.sym("share"), state, drops]

    def _after(self, inputs: list[Any], size: int, on_bridge: bool) -> Any:
        """States after several steps."""
        index, share, state, drops, *dampings = inputs
        rows = ca.vertcat(read(self.plant.table, index, share, size), drops)
        unrolled = UNROLLED if size % UNROLLED == 0 else 1
        steps = self._steps(unrolled, on_bridge, bool(dampings))
        if size == unrolled:
            return steps(state, rows, *dampings)
        every = steps.mapaccum("every", size // unrolled)
        more = [ca.repmat(each, 1, size // unrolled) for each in dampings]
        return every(state, rows, *more)[:, -self.count :]

    def _steps(self, size: int, on_bridge: bool, held: bool) -> ca.Function:
        state = ca.SX.sym("state", self.n_rows, self.count)
        rows = ca.SX.sym("rows", len(self.plant.table) + 1, size)
        dampings = [ca.SX.sym("dampings", 1, self.count)] if held else []
        columns = ca.horzsplit(state)
        for k in range(size):
            for i, column in enumerate(columns):
                damping = dampings[0][i] if held else None
                columns[i] = self._step(column, rows[:, k], on_bridge, damping)
        return ca.Function("steps", [state, rows, *dampings], [ca.horzcat(*columns)], APART)

    def _step(self, state: Any, row: Any, on_bridge: bool, damping: Any) -> Any:
        """One step of one state, with a damping [N s/m] or bridgehook's."""
        plant, car, h = self.plant, self.plant.car, self.plant.step
        travel, axle, up, low, force, powers, cost, *modes = ca.vertsplit(state)
        each = ca.vertsplit(row)
        shapes, (per_force, beside, drop) = each[3:-3], each[-3:]
        if damping is None:
            damping = self.policy.damping(each[:3], up, low)
        cost += self._cost(travel, up, low, force, damping)
        impulse, half = plant.impulse(damping), h / 2
        spring = car.suspension_stiffness * travel
        up = up - half * spring / car.sprung_mass
        low = low + half * (spring + plant.load - force) / car.unsprung_mass
        pushed = impulse * (up - low)
        v, w = up - pushed / car.sprung_mass, low + pushed / car.unsprung_mass
        axle, travel = axle + half * (low + w), travel + half * (up - low + v - w)
        squeezed, free = axle - drop, []
        for k, shape in enumerate(shapes if on_bridge else []):
            q, p, push = modes[3 * k : 3 * k + 3]
            own, first, second = plant.modes[k]
            free += [own[i, 0] * q + own[i, 1] * p + first[i] * push for i in (0, 1)]
            squeezed -= shape * (free[-2] + second[0] * shape * force)
        force = ca.fmax(plant.load + car.tire_stiffness * squeezed, 0)
        spring = car.suspension_stiffness * travel
        v = v - half * spring / car.sprung_mass
        w = w + half * (spring + plant.load - force) / car.unsprung_mass
        if on_bridge:
            modes, effect = [], per_force * force + beside
            for k, shape in enumerate(shapes):
                push, second = shape * force, plant.modes[k][2]
                q, p = (free[2 * k + i] + second[i] * push for i in (0, 1))
                modes += [q, p, push]
                effect += plant.per_state[k, 0] * q + plant.per_state[k, 1] * p
            power = ca.fmax(effect, 0)
            for _ in range(SQUARINGS):
                power = power * power
            powers += power
        return ca.vertcat(travel, axle, v, w, force, powers, cost, *modes)

    def _cost(self, travel: Any, up: Any, low: Any, force: Any, damping: Any) -> Any:
        """What a step adds to J, from its start."""
        if self.cost is None:
            return 0
        tire = (force - self.plant.load) / self.plant.car.tire_stiffness
        states = ca.vertcat(travel + tire, up, tire, low)
        parts = ca.mtimes(ca.DM(self.cost.states), states) + ca.DM(self.cost.forces) * (
            damping * (up - low)
        )
        return self.share_of_time * ca.sumsqr(parts)
