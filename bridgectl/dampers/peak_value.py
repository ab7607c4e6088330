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
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
from scipy.linalg import solve_continuous_lyapunov

from bridgectl import _checks as check
from bridgectl._checks import FloatArray
from bridgectl._plausible import judge_crossing
from bridgectl._threads import on_one_thread
from bridgectl.dampers.actuator import with_damping
from bridgectl.dampers.costate import REACH, smooth_crossing
from bridgectl.dampers.gains import damping_bounds
from bridgectl.dampers.legs import Legs, require_dampers
from bridgectl.linear.cells import SAMPLES
from bridgectl.linear.prediction import Prediction
from bridgectl.linear.runs import effect_samples
from bridgectl.model.bridge import BridgeModel
from bridgectl.model.crossing import Crossing, make_crossing, require_factor
from bridgectl.model.effect import Effect
from bridgectl.model.motion import Motion
from bridgectl.model.quarter_car import QuarterCar
from bridgectl.model.vehicle import Vehicle

SHARPNESS = 10.0
"""beta, per unit of the peak static moment: 0.1 of it is what a road may change of a peak."""

YIELD_SPEED = 0.35
"""v_0 [m/s], some three times the RMS suspension velocity on a class A road.

Both were chosen on 50 roads of class A and 50 of B: anything from 7 to 14 and from 0.25 to 0.7 m/s
changes the mean over speeds by less than 0.003.
"""

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
) -> list[PeakValue]:
    """Return what a force of each damper is worth before the peak moment, at a speed [m/s].

    The dampings are kept from `c_min` to `c_max` [N s/m]; `reach` is the length of the approach
    that is looked at [m]; `sharpness` and `yield_speed` [m/s] are beta and v_0 of the formulas
    above. The others are those of `bridgectl.daf`.

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
    car = with_damping(vehicle, (soft + stiff) / 2)
    crossing, c = make_crossing(beam, car, effect, section), Motion(speed).speed
    require_factor(crossing)
    judge_crossing(crossing, c)
    before = check.not_negative("reach", reach, unit="m")
    known, bridge = smooth_crossing(crossing, c, before)
    nodes, entry, measured = known.positions, known.entry, _measured(crossing)
    to_states = _expected(crossing, known.transitions[entry:], known.durations[entry:])
    moments = effect_samples(crossing, bridge)[0, :: len(SAMPLES)]
    sweep = _Backward(known, moments, beta, curvature)
    durations = np.gradient(nodes) / c
    gains = np.zeros((len(nodes), *measured.shape[:2]))
    constant = np.zeros(gains.shape[:2])
    for k in range(len(nodes) - 1, -1, -1):
        sweep.step_back(k, durations[k])
        constant[k], per_state = sweep.worth(k)
        gains[k] = np.einsum("dn,dnm->dm", per_state, to_states[max(k - entry, 0)])
    smooth = np.einsum("dmn,kn->kdm", measured, bridge.states[0])
    constant[entry:] -= (gains[entry:] * smooth).sum(axis=2)
    return [PeakValue(nodes, constant[:, leg], *gains[:, leg].T) for leg in range(len(measured))]


def peak_value(*case: Any, leg: int = 1, **options: Any) -> PeakValue:
    """Return what a force of one damper is worth, counted from 1: see `peak_values`."""
    return peak_values(*case, **options)[leg - 1]


def _measured(crossing: Crossing) -> FloatArray:
    """Rows of what is measured at each leg, of all states, (D, 2, n)."""
    rows = Legs(crossing.linear).measured
    return np.pad(rows, ((0, 0), (0, 0), (0, crossing.n_states - crossing.n_vehicle)))


class _Backward:
    """Backward sweep: rows of the moments ahead, and what the damper will yet take off."""

    def __init__(
        self, known: Prediction, moments: FloatArray, sharpness: float, curvature: float
    ) -> None:
        self.known, self.forces = known, known.damper_input
        below = np.maximum(sharpness * (moments - moments.max()), LEAST)
        self.weights = np.gradient(known.positions[known.entry :]) * np.exp(below)
        self.ahead = np.zeros_like(known.effect_rows[known.entry :])
        self.yet = np.zeros_like(known.transitions[0])
        self.squares = np.array([np.outer(row, row) for row in known.velocity_rows])
        self.sharpness, self.curvature = sharpness, curvature

    def step_back(self, k: int, duration: float) -> None:
        """Go back to node k, by the transition of a cell unless it is the last."""
        if k < len(self.known.transitions):
            step = self.known.transitions[k]
            self.ahead = self.ahead @ step
            self.yet = step.T @ self.yet @ step
        if k >= self.known.entry:
            self.ahead[k - self.known.entry] = self.known.effect_rows[k]
        means = np.abs(self.weights @ self.ahead @ self.forces)
        self.yet += duration * np.tensordot(means, self.squares, 1)

    def worth(self, k: int) -> tuple[FloatArray, FloatArray]:
        """s, and the row of dV / dF on the deviation of the states, of each damper."""
        later = slice(max(k - self.known.entry, 0), None)
        ahead, weights = self.ahead[later], self.weights[later]
        sigma, total = ahead @ self.forces, weights.sum()
        mean = weights @ sigma / total
        spread = (weights[:, np.newaxis] * (sigma - mean)).T @ ahead / total
        own = self.forces.T @ self.yet / total
        return mean, self.sharpness * spread - self.curvature * own


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
