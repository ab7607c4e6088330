"""What a damper force is worth at each place before the peak: the sensitivity of bridgehook.

A damper with its coefficient between c_min and c_max is one of c_0 = (c_min + c_max) / 2 beside a
force u of any value from -D |v| to D |v|, D = (c_max - c_min) / 2. With c_0 the crossing is linear:
the moment at a time t_j is M_j = lambda_j(t)' z(t) + ..., and u adds the integral of sigma_j u,
sigma_j = lambda_j' B_F. From the state z on, with the best u, the peak is about

    V(t, z) = log(sum over j of w_j exp(beta M_j)) / beta - D (integral from t of |s| |v|)

It has two more approximations. The first term is a soft maximum over the times that are still
ahead, since the road makes the peak come sooner or later. The second is what the damper will yet
take off, s = mean of sigma_j with the weights of the smooth road; there |v| is replaced by
v^2 / (2 v_0) + v_0 / 2, the parabola that touches it at v_0. To the second order in the deviation
dz from the smooth road's crossing, V then is a quadratic form, and the worth of a force

    dV / dF = s(t) + (beta Cov_w(sigma_j, lambda_j) - (D / v_0) B_F' S) dz
    -S' = A' S + S A + |s| n n',  S(end) = 0,  v = n' z

Of z the controller measures the velocities of body and axle alone. The rest is what is to be
expected of them on a random road: z is measured from the road's level, on a road whose slope is
white (ISO 8608, waviness 2) its covariance is

    P' = A P + P A' + N N',  N = -1 for each displacement of the vehicle

times a roughness that does not matter, and E[dz | m] = P C' (C P C')^-1 m. Of a vehicle on several
tires N has a column for each, the displacements that its road gives the vehicle at rest, as if it
had a road of its own; every damper takes off its part of V, and each has a worth. Such roads are
as likely to rise as to fall, so that what is to be expected ahead is level, and is all that is
known.

Of a position known to a standard deviation d alone each s, and what it is worth per velocity, is
the mean over the places where the tire may be; so is the s in S: an unsure damper will take off
less.

Several dampers that all work against the one peak of the smooth road would overdo it, and make
another. So each counts on the others: its weights are those of the moments M_j that the others
leave when they do their best, with forces u of up to D v_m, v_m a mean of |v|, in a problem that is
convex::

    minimize over the others' u:  log(sum over j of w_j exp(beta (M_j + integral of sigma_j u)))

Where ride, travel or tire force count too, V has what dz will yet cost them, and dV / dF the r of
`bridgectl.dampers.weights` for dz, at the force of the passive damper.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Any, NamedTuple

import numpy as np
from scipy.linalg import solve_continuous_lyapunov
from scipy.special import ndtr

from bridgectl import _checks as check
from bridgectl._checks import FloatArray
from bridgectl._plausible import judge_crossing
from bridgectl._threads import on_one_thread
from bridgectl.dampers.actuator import with_damping
from bridgectl.dampers.costate import REACH, smooth_crossing
from bridgectl.dampers.gains import damping_bounds
from bridgectl.dampers.legs import Legs, require_dampers
from bridgectl.dampers.weights import PEAK_ALONE, Weights, crossing_time, side_worth
from bridgectl.linear.cells import SAMPLES
from bridgectl.linear.prediction import Prediction
from bridgectl.linear.runs import effect_samples
from bridgectl.model.bridge import BridgeModel
from bridgectl.model.crossing import Crossing, make_crossing, require_factor
from bridgectl.model.effect import Effect
from bridgectl.model.motion import Motion
from bridgectl.model.quarter_car import QuarterCar, require_springs
from bridgectl.model.vehicle import Vehicle

SHARPNESS = 10.0
"""beta, per unit of the peak static moment: 0.1 of it is what a road may change of a peak."""

YIELD_SPEED = 0.35
"""v_0 [m/s], some three times the RMS suspension velocity on a class A road.

Both were chosen on 50 roads of class A and 50 of B: anything from 7 to 14 and from 0.25 to 0.7 m/s
changes the mean over speeds by less than 0.003.
"""

OTHERS_SPEED = 0.08
"""v_m [m/s] of the other dampers: a mean |v| on a class A road.

At 0.05 or 0.12 m/s the mean over speeds of a truck with five axles changes by less than 0.005 on
roads of class A; of class B it is 0.02 higher at 0.05 m/s, and 0.01 lower at 0.12 m/s.
"""

ROUNDS = 60
"""Steps towards the best that the others do, which these find to 1e-5 of the static moment."""

BEYOND = 3
"""Deviations of a position behind the end of the bridge up to which a force may be of worth."""

LEAST = -200.0
"""Least logarithm of a weight: after a sharp peak the sum of the others must not vanish."""


class PeakValue(NamedTuple):
    """Worth of a damper force dV / dF = constant + body y_s' + axle y_t', by place.

    V is the peak moment to be expected over the peak static moment. Made by `peak_values`.
    """

    positions: FloatArray
    """Places of the reference tire [m], increasing, up to the end of the bridge."""
    constant: FloatArray
    """[1/(N s)], same shape."""
    body: FloatArray
    """Per body velocity [1/(N m)], same shape."""
    axle: FloatArray
    """Per axle velocity [1/(N m)], same shape."""

    def __repr__(self) -> str:
        return (
            f"PeakValue({len(self.positions)} places from x = {self.positions[0]:.4g} m to "
            f"{self.positions[-1]:.4g} m, constant up to {abs(self.constant).max():.3g} 1/(N s), "
            f"body up to {abs(self.body).max():.3g} and axle up to {abs(self.axle).max():.3g} "
            "1/(N m))"
        )


@on_one_thread
def peak_values(
    beam: BridgeModel,
    vehicle: Vehicle | QuarterCar,
    speed: float,
    c_min: float,
    c_max: float,
    *,
    section: float = 0.5,
    effect: Effect | str = "moment",
    reach: float = REACH,
    sharpness: float = SHARPNESS,
    yield_speed: float = YIELD_SPEED,
    beside: Weights = PEAK_ALONE,
    position_deviation: float = 0.0,
) -> list[PeakValue]:
    """Return what a force of each damper is worth before the peak moment, at a speed [m/s].

    The dampings are kept from `c_min` to `c_max` [N s/m]; `reach` is the length of the approach
    that is looked at [m]; `sharpness` and `yield_speed` [m/s] are beta and v_0 of the formulas
    above; `beside` weighs what else counts; the places returned are known to a standard
    `position_deviation` [m]. The others are those of `bridgectl.daf`.

    >>> import bridgectl as bc
    >>> from bridgectl.dampers.peak_value import peak_values
    >>> (found,) = peak_values(bc.li2006.beam(), bc.li2006.car(), 25.0, 1e3, 30e3)
    >>> found.positions[0].round(3), found.positions[-1].round(3)
    (np.float64(-60.0), np.float64(25.0))
    """
    soft, stiff = damping_bounds(c_min, c_max)
    beta = check.positive("sharpness", sharpness)
    curvature = (stiff - soft) / 2 / check.positive("yield_speed", yield_speed, unit="m/s")
    require_dampers(vehicle)
    require_springs(vehicle, "bridgehook")
    car = with_damping(vehicle, (soft + stiff) / 2)
    crossing, c = make_crossing(beam, car, effect, section), Motion(speed).speed
    require_factor(crossing)
    judge_crossing(crossing, c)
    before = check.not_negative("reach", reach, unit="m")
    known, bridge = smooth_crossing(crossing, c, before)
    nodes, entry, measured = known.positions, known.entry, _measured(crossing)
    to_states = _expected(crossing, known.transitions[entry:], known.durations[entry:])
    moments = effect_samples(crossing, bridge)[0, :: len(SAMPLES)]
    durations = np.gradient(nodes) / c
    weights = _weights(known, moments, beta, (stiff - soft) / 2 * OTHERS_SPEED * durations)
    sweep = _Backward(known, weights, beta, curvature, position_deviation)
    gains = np.zeros((len(nodes), *measured.shape[:2]))
    constant = np.zeros(gains.shape[:2])
    side = side_worth(vehicle, beside, soft, stiff, crossing_time(beam, c)).states
    of_side = np.pad(side, ((0, 0), (0, crossing.n_states - crossing.n_vehicle)))
    for k, ahead in _backward(known):
        sweep.step_back(k, durations[k])
        constant[k], per_state = sweep.worth(k, ahead)
        gains[k] = np.einsum("dn,dnm->dm", per_state + of_side, to_states[max(k - entry, 0)])
    smooth = np.einsum("dmn,kn->kdm", measured, bridge.states[0])
    constant[entry:] -= (gains[entry:] * smooth).sum(axis=2)
    return [
        PeakValue(*blurred((nodes, constant[:, leg], *gains[:, leg].T), position_deviation))
        for leg in range(len(measured))
    ]


def blurred(found: Sequence[FloatArray], deviation: float) -> Sequence[FloatArray]:
    """Places, and what is straight between them and 0 beyond, in its mean about each place."""
    if deviation == 0:
        return found
    x, values = found[0], np.pad(found[1:], ((0, 0), (0, 1)))
    places = np.append(x, 2 * x[-1] - x[-2])
    bends = np.diff(np.diff(values) / np.diff(places), prepend=0.0, append=0.0)
    told = np.append(x, x[-1] + deviation * np.linspace(0.1, BEYOND, 10 * BEYOND))
    z = (told - places[:, np.newaxis]) / deviation
    rises = deviation * (z * ndtr(z) + np.exp(-(z**2) / 2) / np.sqrt(2 * np.pi))
    return [told, *(values[:, :1] + bends @ rises)]


def peak_value(*case: Any, leg: int = 1, **options: Any) -> PeakValue:
    """Return what a force of one damper is worth, counted from 1: see `peak_values`."""
    return peak_values(*case, **options)[leg - 1]


def _measured(crossing: Crossing) -> FloatArray:
    """Rows of what is measured at each leg, of all states, (D, 2, n)."""
    rows = Legs(crossing.linear).measured
    return np.pad(rows, ((0, 0), (0, 0), (0, crossing.n_states - crossing.n_vehicle)))


def _backward(known: Prediction) -> Iterator[tuple[int, FloatArray]]:
    """Nodes from the last one on, and rows of the moments that are still ahead, (C + 1, n)."""
    ahead = np.zeros_like(known.effect_rows[known.entry :])
    for k in range(len(known.positions) - 1, -1, -1):
        if k < len(known.transitions):
            ahead = ahead @ known.transitions[k]
        if k >= known.entry:
            ahead[k - known.entry] = known.effect_rows[k]
        yield k, ahead


def _weights(
    known: Prediction, moments: FloatArray, sharpness: float, impulses: FloatArray
) -> FloatArray:
    """Weights of the moments for each damper, of those that the others leave, (D, C + 1)."""
    widths = np.gradient(known.positions[known.entry :])

    def soft(left: FloatArray) -> FloatArray:
        return np.asarray(widths * np.exp(np.maximum(sharpness * (left - left.max()), LEAST)))

    def left_by(others: FloatArray) -> FloatArray:
        pushes = np.zeros(others.shape[1])
        for n in range(ROUNDS):  # a conditional gradient's, each to the best corner
            best = -np.sign(soft(moments + others @ pushes) @ others)
            pushes += 2 / (n + 2) * (best - pushes)
        return np.asarray(moments + others @ pushes)

    n_dampers = known.damper_input.shape[1]
    if n_dampers == 1:
        return soft(moments)[np.newaxis]
    worths = [impulses[k] * ahead @ known.damper_input for k, ahead in _backward(known)]
    each = np.stack(worths, axis=1)  # (C + 1, nodes, D)
    return np.array([
        soft(left_by(np.delete(each, leg, axis=2).reshape(moments.size, -1)))
        for leg in range(n_dampers)
    ])  # fmt: skip


class _Backward:
    """Backward sweep: the worth for each damper, and what all of them will yet take off."""

    def __init__(
        self, known: Prediction, weights: FloatArray, sharpness: float, curvature: float,
        deviation: float,
    ) -> None:  # fmt: skip
        self.known, self.forces, self.weights = known, known.damper_input, weights
        self.yet = np.zeros((len(weights), *known.transitions.shape[1:]))
        self.squares = np.array([np.outer(row, row) for row in known.velocity_rows])
        self.sharpness, self.curvature = sharpness, curvature
        left = np.cumsum(weights[:, ::-1], axis=1)[:, ::-1]  # on the approach all are ahead
        totals = np.pad(left, ((0, 0), (known.entry, 0)), mode="edge").T[..., np.newaxis]
        own = np.array([weights @ ahead @ self.forces for _, ahead in _backward(known)])[::-1]
        columns = (own / totals).reshape(len(own), -1).T
        means = np.array(blurred((known.positions, *columns), deviation)[1:])[:, : len(own)].T
        self.means = np.abs(means.reshape(own.shape)) * totals
        """|s| of each damper's force at the nodes by each one's weights, (nodes, D, D)."""

    def step_back(self, k: int, duration: float) -> None:
        """Go back to node k, by the transition of a cell unless it is the last."""
        if k < len(self.known.transitions):
            step = self.known.transitions[k]
            self.yet = step.T @ self.yet @ step
        self.yet += duration * np.tensordot(self.means[k], self.squares, 1)

    def worth(self, k: int, ahead: FloatArray) -> tuple[FloatArray, FloatArray]:
        """s, and the row of dV / dF on the deviation of the states, of each damper."""
        later = slice(max(k - self.known.entry, 0), None)
        ahead, weights = ahead[later], self.weights[:, later]
        sigma, total = ahead @ self.forces, weights.sum(axis=1)
        mean = (weights * sigma.T).sum(axis=1) / total
        spread = (weights * (sigma - mean).T) @ ahead
        own = np.einsum("nd,dnm->dm", self.forces, self.yet)
        per_state = self.sharpness * spread - self.curvature * own
        return mean, per_state / total[:, np.newaxis]


def _at_rest(vehicle: Vehicle) -> FloatArray:
    """Displacements of a vehicle at rest per drop of the road under each tire, (coordinates, T)."""
    springs = vehicle.tire_map.T * vehicle.tire_stiffnesses
    return np.linalg.solve(vehicle.stiffness_matrix + springs @ vehicle.tire_map, springs)


def _expected(crossing: Crossing, steps: FloatArray, durations: FloatArray) -> FloatArray:
    """E[dz | m] per measured velocity of each leg, at the nodes on the bridge, (C + 1, D, n, 2)."""
    vehicle, n, measured = crossing.linear, crossing.n_vehicle, _measured(crossing)
    slopes = np.zeros((crossing.n_states, vehicle.n_tires))
    slopes[:n:2] = -_at_rest(vehicle)
    noise = slopes @ slopes.T
    covariance = np.zeros_like(noise)
    covariance[:n, :n] = solve_continuous_lyapunov(vehicle.state_matrix_on_tires(), -noise[:n, :n])
    gains = []
    for k in range(len(steps) + 1):
        known = covariance @ np.swapaxes(measured, 1, 2)
        gains.append(known @ np.linalg.inv(measured @ known))
        if k < len(steps):
            half = noise * durations[k] / 2
            covariance = steps[k] @ (covariance + half) @ steps[k].T + half
    return np.array(gains)
