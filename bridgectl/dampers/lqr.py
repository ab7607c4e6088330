"""Clipped optimal damping: the linear-quadratic regulator's force, as near as a damper can give it.

The quarter-car without its damper, on a rigid road or a bridge, with the force F of the damper as
its input and the velocity of the surface under the tire as white noise::

    x = [d, y_s', e, y_t'],   d = y_s - y_t,   e = y_t - surface
    d' = y_s' - y_t'          m_s y_s'' = -K_s d - F
    e' = y_t' - surface'      m_t y_t'' = K_s d + F - K_t e

    J = E[q_1 y_s''^2 + q_2 d^2 + q_3 e^2 + rho F^2]

The force that minimises J is F* = -K x, whatever the noise; y_s'' holds F, so the weight of x
crosses with that of F. The damper gives c = F* / v within its bounds. That is the best force at
each instant if the next ones are not clipped, not the best that a damper can do.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import control
import numpy as np

from bridgectl import _checks as check
from bridgectl._checks import FloatArray
from bridgectl.dampers.each_leg import of_each_leg
from bridgectl.dampers.passive_theory import comfort_damping, road_damping, variances
from bridgectl.dampers.strategy import Strategy
from bridgectl.dampers.switching import DEAD_BAND, documented, nearest
from bridgectl.dampers.tire_laws import deflection_of_tire, tire_gains
from bridgectl.model.quarter_car import QuarterCar, require_quarter_car
from bridgectl.model.vehicle import Vehicle

FEEDBACK = ("travel_gain", "body_gain", "deflection_gain", "axle_gain")
"""Names of the gains K of x = [d, y_s', e, y_t']: N/m, N s/m, N/m, N s/m."""

TRAVEL_SHARE = 0.1
"""How much the suspension travel counts by default, relative to the body acceleration."""


class Regulator(NamedTuple):
    """A linear-quadratic problem x' = A x + B F, J = x' Q x + 2 x' N F + R F^2."""

    state_matrix: FloatArray
    """A, shape (4, 4)."""
    input_matrix: FloatArray
    """B, shape (4, 1)."""
    state_weight: FloatArray
    """Q, shape (4, 4)."""
    force_weight: FloatArray
    """R, shape (1, 1)."""
    cross_weight: FloatArray
    """N, shape (4, 1)."""

    def feedback(self) -> FloatArray:
        """Return K of the force F = -K x [N] with the least J, shape (4,)."""
        # Forces in units of 1 / sqrt(R): numbers of the same size in the Riccati equation.
        unit = 1 / np.sqrt(self.force_weight[0, 0])
        gain, _, _ = control.lqr(
            self.state_matrix, unit * self.input_matrix, self.state_weight, np.eye(1),
            unit * self.cross_weight,
        )  # fmt: skip
        return unit * np.asarray(gain, dtype=np.float64)[0]


@of_each_leg
@documented
def clipped_lqr(
    vehicle: Vehicle | QuarterCar,
    c_min: float,
    c_max: float,
    *,
    body_acceleration: float = 1.0,
    suspension_travel: float | None = None,
    tire_deflection: float | None = None,
    damper_force: float = 0.0,
    dead_band: float = DEAD_BAND,
) -> Strategy:
    """Return clipped optimal damping: c = F* / v of the linear-quadratic regulator's force.

    F* = -K x minimises E[q_1 y_s''^2 + q_2 d^2 + q_3 e^2 + rho F^2], with travel d = y_s - y_t,
    tire deflection e = (R - W) / K_t and x = [d, y_s', e, y_t'].

    Parameters
    ----------
    vehicle : Vehicle or QuarterCar
        Its own damping does not matter. At each leg of a vehicle the law is that of the quarter-car
        that its axle, springs and tires, and the load on them are.
    {bounds}
    body_acceleration : float, optional
        q_1, dimensionless: the other weights are relative to it.
    suspension_travel, tire_deflection : float, optional
        q_2 and q_3 [1/s^4], above 0. Default: see the notes.
    damper_force : float, optional
        rho [m^2/(s^4 N^2)]. A damper needs no power for its force, so 0.
    {dead_band}

    Returns
    -------
    Strategy

    Raises
    ------
    TypeError, ValueError
        If an argument is not what is described above, or q_1 and rho are both 0.

    Notes
    -----
    The default weights balance ride and road: q_3 e^2 counts as much as y_s''^2, and q_2 d^2 a
    tenth of it, for a truck's travel has only to stay within its stops. They count so in the mean,
    on a random road, for the passive vehicle whose damping is the geometric mean of those that are
    best for ride and for road (14.8 kN s/m for the paper's truck), at any speed and roughness. On
    the roads of `extended_groundhook` the dynamic load coefficient then is 0.0308 and the RMS body
    acceleration 0.115 m/s^2; with three times that q_3 they are 0.0264 and 0.142.

    K is in gains: `travel_gain` and `deflection_gain` [N/m], `body_gain` and `axle_gain` [N s/m],
    for d, e, y_s' and y_t'; so are W and K_t, `static_load` [N] and `tire_stiffness` [N/m].

    References
    ----------
    D. Hrovat, Automatica 33 (1997) 1781-1817, on such criteria. H. E. Tseng, J. K. Hedrick, Veh.
    Syst. Dyn. 23 (1994) 545-569, on clipping them.

    Examples
    --------
    >>> import bridgectl as bc
    >>> from bridgectl.dampers import clipped_lqr
    >>> law = clipped_lqr(bc.li2006.car(), 1e3, 30e3)
    >>> round(law.gains["body_gain"] / 1e3, 1), round(law.gains["axle_gain"] / 1e3, 1)
    (-35.9, 14.9)
    >>> law.command(
    ...     body_velocity=[0.1, -0.1], axle_velocity=0.0, suspension_velocity=[0.1, -0.1],
    ...     tire_force=98.1e3)
    array([30000., 30000.])
    """
    car = require_quarter_car(vehicle)
    of_tire = tire_gains(car)
    weights = body_acceleration, suspension_travel, tire_deflection, damper_force
    feedback = regulator(car, *weights).feedback()
    gains = {
        **{name: (float(k), -1e8, 1e8) for name, k in zip(FEEDBACK, feedback, strict=True)},
        **of_tire,
    }
    return nearest("clipped LQR", _force, c_min, c_max, dead_band, gains)


def regulator(
    vehicle: QuarterCar,
    body_acceleration: float = 1.0,
    suspension_travel: float | None = None,
    tire_deflection: float | None = None,
    damper_force: float = 0.0,
) -> Regulator:
    """Return the linear-quadratic problem of `clipped_lqr`, for the same arguments."""
    q1 = check.not_negative("body_acceleration", body_acceleration)
    rho = check.not_negative("damper_force", damper_force, unit="m^2/(s^4 N^2)")
    if q1 == rho == 0:
        raise ValueError(
            "body_acceleration and damper_force must not both be 0: the force would be without "
            "bounds; type body_acceleration=1.0"
        )
    equal = equal_weights(vehicle)
    # Above 0, so that no motion of the vehicle is free: else the Riccati equation has no solution.
    q2, q3 = (
        default if value is None else check.positive(name, value, unit="1/s^4")
        for name, value, default in (
            ("suspension_travel", suspension_travel, TRAVEL_SHARE * equal[0]),
            ("tire_deflection", tire_deflection, equal[1]),
        )
    )
    body, axle = vehicle.sprung_mass, vehicle.unsprung_mass
    spring, tire = vehicle.suspension_stiffness, vehicle.tire_stiffness
    state = np.array(
        [
            [0, 1, 0, -1],
            [-spring / body, 0, 0, 0],
            [0, 0, 0, 1],
            [spring / axle, 0, -tire / axle, 0],
        ]
    )
    force = np.array([[0], [-1 / body], [0], [1 / axle]])
    of_state, of_force = state[1:2], force[1:2]  # y_s'' = of_state x + of_force F
    return Regulator(
        state, force,
        q1 * of_state.T @ of_state + np.diag([q2, 0, q3, 0]),
        q1 * of_force.T @ of_force + rho,
        q1 * of_state.T @ of_force,
    )  # fmt: skip


def equal_weights(vehicle: QuarterCar) -> tuple[float, float]:
    """Return q_2 and q_3 [1/s^4] that make d and e count as much as y_s''.

    They are ratios of variances of the passive vehicle, in which speed and roughness cancel.
    """
    middle = np.sqrt(comfort_damping(vehicle) * road_damping(vehicle))
    found = variances(vehicle, "A", 25.0, middle)
    return (
        float(found.body_acceleration / found.suspension_travel),
        float(found.body_acceleration / found.tire_deflection),
    )


def _force(s: Any, g: Any) -> Any:
    return -(
        g.travel_gain * s.suspension_travel
        + g.body_gain * s.body_velocity
        + g.deflection_gain * deflection_of_tire(s, g)
        + g.axle_gain * s.axle_velocity
    )
