"""Crossings with a semi-active damper, for many speeds and roads at once.

The damping is held over a sample (or follows its lag exactly), and the crossing is integrated from
node to node: samples of the controller, stations of the road, the section, and points between
them, at each speed its own. All speeds and roads are advanced side by side by the classic
Runge-Kutta method, on the crossing's own matrices.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from bridgectl import _checks as check
from bridgectl._checks import FloatArray
from bridgectl._threads import on_one_thread
from bridgectl.beam import Beam
from bridgectl.crossing import Crossing
from bridgectl.propagator import SAME_PLACE
from bridgectl.quarter_car import QuarterCar

from .actuator import Damper
from .strategy import SIGNALS, Strategy

BODY, AXLE = 1, 3
"""Places of y_s' and y_t' among a quarter-car's states; each displacement is before its rate."""

RATE = np.array([0.0, 1.0, 0.0, -1.0])
"""Suspension velocity of a quarter-car's states."""

MAX_PHASE = 0.12
"""Largest advance of phase of the fastest motion in a step [rad]: DAFs then are within 5e-5."""


@dataclass(frozen=True, eq=False)
class LoopResult:
    """What `simulate_loop` finds, for each speed and road: shapes (n_speeds, n_roads).

    Attributes
    ----------
    daf : ndarray
        Peak moment over the peak static one.
    least_force : ndarray
        Least tire force over its static load, on approach and bridge.
    dissipated : ndarray
        Energy that the damper has taken out [J].
    switches : ndarray
        How often the command crosses the middle of its range.
    """

    daf: FloatArray
    least_force: FloatArray
    dissipated: FloatArray
    switches: NDArray[np.intp]


@on_one_thread
def simulate_loop(
    beam: Beam,
    vehicle: QuarterCar,
    damper: Damper | Strategy,
    speeds: ArrayLike,
    stations: ArrayLike,
    elevations: ArrayLike,
    *,
    section: float = 0.5,
    recovery: str = "exact",
) -> LoopResult:
    """Simulate crossings with a semi-active damper in place of the passive one.

    Parameters
    ----------
    beam, section, recovery
        See `bridgectl.crossing.Crossing`.
    vehicle : QuarterCar
        The vehicle; its passive damping counts until the first sample, which is at the start.
    damper : Damper or Strategy
        The damper; a strategy alone gets the defaults of `Damper`.
    speeds : float or array_like
        Speeds c [m/s].
    stations : array_like, shape (n,)
        Stations of the roads [m], the first where the vehicle starts in equilibrium.
    elevations : array_like, shape (n,) or (n_roads, n)
        Elevations of the roads there [m], positive up.

    Returns
    -------
    LoopResult

    Raises
    ------
    TypeError, ValueError
        If an argument is not what is described above, or a law returns NaN.

    Examples
    --------
    >>> import numpy as np
    >>> import bridgectl as bc
    >>> from bridgectl.dampers import passive, simulate_loop
    >>> x = np.linspace(0, 25, 251)
    >>> result = simulate_loop(bc.li2006.beam(), bc.li2006.car(), passive(7e3), 30.0, x, 0 * x)
    >>> bool(abs(result.daf[0, 0] - bc.daf(bc.li2006.beam(), bc.li2006.car(), 30.0)[0]) < 1e-4)
    True
    """
    if not isinstance(vehicle, QuarterCar):
        raise TypeError(
            f"vehicle must be a QuarterCar, got {type(vehicle).__name__}: other vehicles have "
            "passive dampers only"
        )
    device = damper if isinstance(damper, Damper) else Damper(damper)
    c = check.speeds(speeds)
    x = check.array("stations", stations, (None,), unit="m")
    z = np.atleast_2d(np.asarray(elevations, dtype=np.float64))
    if z.ndim != 2 or z.shape[1] != x.size or x.size < 2:
        raise ValueError(
            f"elevations must have one value for each of the {x.size} stations, got {z.shape}"
        )
    if np.any(np.diff(x) <= 0) or x[0] > 0 or x[-1] < beam.length - SAME_PLACE:
        raise ValueError(
            f"stations must increase from 0 m or less to the end of the bridge, {beam.length:g} m"
        )
    loop = _Loop(beam, vehicle, device, x, z[:, :1] - z, section, recovery)
    order = np.argsort(c)  # the slowest have the most nodes, and finish last
    found = loop.run(c[order])
    back = np.argsort(order)
    return LoopResult(
        found.daf[back], found.least_force[back], found.dissipated[back], found.switches[back]
    )


@dataclass(frozen=True)
class _Plan:
    """Steps of each speed: K nodes, and P = 2 K - 1 places, the nodes and the points between.

    Speeds that need fewer nodes stay at their last one.
    """

    x: FloatArray
    """Nodes [m], (S, K)."""
    durations: FloatArray
    """Time of each step [s], (S, K - 1)."""
    sampled: NDArray[np.bool_]
    """Nodes where the controller samples, (S, K)."""
    last: NDArray[np.intp]
    """Last node of each speed, (S,)."""
    piece: NDArray[np.intp]
    """Piece of the road under each place, (S, P)."""
    share: FloatArray
    """Fraction of it that lies behind, (S, P, 1)."""
    shapes: FloatArray
    """Mode shapes, (n_modes, S, P, 1)."""
    per_force: FloatArray
    """Moment per tire force at the nodes, (S, K, 1)."""
    per_state: FloatArray
    """Moment per state, (n,)."""


class _Loop:
    """The integration, on arrays (n states, speeds, roads)."""

    def __init__(
        self,
        beam: Beam,
        vehicle: QuarterCar,
        damper: Damper,
        stations: FloatArray,
        drops: FloatArray,
        section: float,
        recovery: str,
    ) -> None:
        bare = QuarterCar(
            vehicle.sprung_mass, vehicle.unsprung_mass,
            vehicle.suspension_stiffness, vehicle.tire_stiffness, 0.0,
        )  # fmt: skip
        self.crossing = Crossing(beam, bare, 1.0, section, recovery)
        self.damper, self.stations, self.drops = damper, stations, drops
        self.drops_at = np.ascontiguousarray(drops.T)
        self.n = self.crossing.n_vehicle
        linear = self.crossing.linear
        self.free = self.crossing.free_matrix
        self.of_force = self.crossing.damper_matrix[:, 0]
        self.of_tire = linear.tire_input[:, 0]
        self.of_beam = beam.input_matrix[1::2].diagonal()[:, np.newaxis, np.newaxis]
        self.weight, self.stiffness = linear.static_loads[0], linear.tire_stiffnesses[0]

    def nodes(self, speed: float) -> tuple[FloatArray, NDArray[np.bool_]]:
        """Places where steps begin and end [m], and which of them are samples."""
        start, end = self.stations[0], self.crossing.beam.length
        stiffest = self.crossing.linear.state_matrix_on_tires() + np.outer(
            self.of_force[: self.n], self.damper.strategy.c_max * RATE
        )
        fastest = max(np.abs(np.linalg.eigvals(stiffest)).max(), self.crossing.beam.omega[-1])
        between = int(np.ceil(self.damper.sample_time * fastest / MAX_PHASE))
        step = speed * self.damper.sample_time / between
        grid = start + step * np.arange(int(np.ceil((end - start) / step)) + 1)
        places = [grid, self.stations, [0.0, self.crossing.section * end, end]]
        every = np.unique(np.round(np.concatenate(places), 10))
        every = every[(every >= start) & (every <= end + SAME_PLACE)]
        samples = np.round(grid[::between], 10)
        return every, np.isin(every, samples)

    def run(self, speeds: FloatArray) -> LoopResult:
        """Advance all speeds, in increasing order, to the end of the bridge."""
        plan = self._plan(speeds)
        n_roads, n_nodes = len(self.drops), plan.x.shape[1]
        shape = len(speeds), n_roads
        state = np.zeros((len(self.free), *shape))
        strategy = self.damper.strategy
        middle = (strategy.c_min + strategy.c_max) / 2
        damping, command = np.zeros(shape), np.zeros(shape)
        peak, least = np.full(shape, -np.inf), np.full(shape, np.inf)
        energy, switches = np.zeros(shape), np.zeros(shape, dtype=int)
        laws = [strategy.for_speed(float(speed)).evaluator(n_roads) for speed in speeds]
        rng = np.random.default_rng(self.damper.seed)
        for k in range(n_nodes):
            here = slice(0, int((plan.last >= k).sum()))  # the slowest have most nodes
            force = self._tire_force(state[:, here], *self._at(plan, 2 * k, here))
            moment = self._moment(plan, k, state[:, here], force)
            peak[here] = np.maximum(peak[here], moment)
            least[here] = np.minimum(least[here], force / self.weight)
            for i in np.nonzero(plan.sampled[here, k])[0]:
                measured = state[:, i], damping[i], force[i], plan.x[i, k], speeds[i]
                wanted = laws[i](self._signals(*measured, rng))
                if k:
                    switches[i] += (wanted > middle) != (command[i] > middle)
                command[i] = wanted
                if self.damper.lag == 0 or k == 0:
                    damping[i] = wanted
            ahead = slice(0, int((plan.last > k).sum()))
            if ahead.stop:
                state[:, ahead], damping[ahead], work = self._step(
                    plan, k, ahead, state[:, ahead], damping[ahead], command[ahead]
                )
                energy[ahead] += work
        return LoopResult(peak, least, energy, switches)

    def _plan(self, speeds: FloatArray) -> _Plan:
        """Places of all steps, and what is the same for all roads there."""
        each = [self.nodes(float(speed)) for speed in speeds]
        longest = max(len(nodes) for nodes, _ in each)
        x = np.array([np.pad(nodes, (0, longest - len(nodes)), "edge") for nodes, _ in each])
        sampled = np.array([np.pad(flags, (0, longest - len(flags))) for _, flags in each])
        places = np.empty((len(speeds), 2 * longest - 1))
        places[:, ::2], places[:, 1::2] = x, (x[:, 1:] + x[:, :-1]) / 2
        at = np.clip(places, self.stations[0], self.stations[-1])
        piece = np.searchsorted(self.stations, at, side="right") - 1
        piece = np.clip(piece, 0, self.stations.size - 2)
        share = (at - self.stations[piece]) / np.diff(self.stations)[piece]
        shapes = np.moveaxis(self.crossing.beam.mode_shapes(places), -1, 0)
        rows = self.crossing.rows(x)
        return _Plan(
            x, np.diff(x) / speeds[:, np.newaxis], sampled,
            np.array([len(nodes) - 1 for nodes, _ in each]), piece, share[..., np.newaxis],
            np.ascontiguousarray(shapes)[..., np.newaxis], rows.per_force, rows.per_state,
        )  # fmt: skip

    def _at(self, plan: _Plan, place: int, here: slice) -> tuple[FloatArray, FloatArray]:
        """Drop of every road and mode shapes under the tire, at a place of some speeds."""
        piece, share = plan.piece[here, place], plan.share[here, place]
        before = self.drops_at[piece]
        return before + share * (self.drops_at[piece + 1] - before), plan.shapes[:, here, place]

    def _step(
        self,
        plan: _Plan,
        k: int,
        here: slice,
        state: FloatArray,
        damping: FloatArray,
        command: FloatArray,
    ) -> tuple[FloatArray, FloatArray, FloatArray]:
        """One step of the classic Runge-Kutta method: states, damping, energy dissipated."""
        duration = plan.durations[here, k, np.newaxis]
        halfway = self._lagged(damping, command, duration / 2)
        after = self._lagged(damping, command, duration)
        start, middle, end = (self._at(plan, 2 * k + i, here) for i in range(3))
        k1, p1 = self._rates(state, damping, *start)
        k2, p2 = self._rates(state + duration / 2 * k1, halfway, *middle)
        k3, p3 = self._rates(state + duration / 2 * k2, halfway, *middle)
        k4, p4 = self._rates(state + duration * k3, after, *end)
        k2 += k3
        work = duration / 6 * (p1 + 2 * (p2 + p3) + p4)
        return state + duration / 6 * (k1 + 2 * k2 + k4), after, work

    def _rates(
        self, state: FloatArray, damping: FloatArray, road: FloatArray, shapes: FloatArray
    ) -> tuple[FloatArray, FloatArray]:
        """Rates of the states, and the power that the damper takes out [W]."""
        tire = self._tire_force(state, road, shapes)
        velocity = state[BODY] - state[AXLE]
        force = self._force(damping, velocity)
        rates = (self.free @ state.reshape(len(state), -1)).reshape(state.shape)
        rates[AXLE] += self.of_tire[AXLE] * (tire - self.weight)
        rates[BODY] += self.of_force[BODY] * force
        rates[AXLE] += self.of_force[AXLE] * force
        rates[self.n + 1 :: 2] += (self.of_beam * shapes) * tire
        return rates, force * velocity

    def _force(self, damping: FloatArray, velocity: FloatArray) -> FloatArray:
        force = damping * velocity
        limit = self.damper.max_force
        return force if limit == np.inf else np.clip(force, -limit, limit)

    def _tire_force(self, state: FloatArray, road: FloatArray, shapes: FloatArray) -> FloatArray:
        """R = W + K_t (y_t - v - r) >= 0, Eq. (2)."""
        closer = state[AXLE - 1] - road
        closer -= np.einsum("jsr,jst->sr", state[self.n :: 2], shapes)
        closer *= self.stiffness
        closer += self.weight
        return np.maximum(closer, 0.0, out=closer)

    def _moment(self, plan: _Plan, k: int, state: FloatArray, force: FloatArray) -> FloatArray:
        from_states = plan.per_state @ state.reshape(len(state), -1)
        return plan.per_force[: len(force), k] * force + from_states.reshape(force.shape)

    def _lagged(self, damping: FloatArray, command: FloatArray, duration: FloatArray) -> FloatArray:
        if self.damper.lag == 0:
            return damping
        return command + (damping - command) * np.exp(-duration / self.damper.lag)

    def _signals(
        self,
        state: FloatArray,
        damping: FloatArray,
        force: FloatArray,
        place: float,
        speed: float,
        rng: np.random.Generator,
    ) -> FloatArray:
        """What the controller measures of one speed, (len(SIGNALS), n_roads)."""
        vehicle = state[: self.n]
        velocity = vehicle[BODY] - vehicle[AXLE]
        rates = self.free[: self.n, : self.n] @ vehicle
        rates += self.of_tire[:, np.newaxis] * (force - self.weight)
        rates += self.of_force[: self.n, np.newaxis] * self._force(damping, velocity)
        values = {
            "body_velocity": vehicle[BODY], "axle_velocity": vehicle[AXLE],
            "suspension_travel": vehicle[BODY - 1] - vehicle[AXLE - 1],
            "suspension_velocity": velocity,
            "body_acceleration": rates[BODY], "axle_acceleration": rates[AXLE],
            "tire_force": force, "position": np.full_like(force, place),
            "speed": np.full_like(force, speed),
        }  # fmt: skip
        signals = np.array([values[name] for name in SIGNALS])
        if self.damper.velocity_noise:
            for name in ("body_velocity", "axle_velocity"):
                noise = rng.normal(0.0, self.damper.velocity_noise, force.shape)
                signals[SIGNALS.index(name)] += noise
            rate = SIGNALS.index("suspension_velocity")
            signals[rate] = signals[0] - signals[1]
        return signals
