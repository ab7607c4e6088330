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

Of a vehicle with several dampers it is one problem of its whole state: see
`bridgectl.dampers.regulator`.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import partial
from typing import Any

import numpy as np

from bridgectl import _checks as check
from bridgectl._checks import FloatArray
from bridgectl.dampers.each_leg import EachLeg, corners, of_each_leg
from bridgectl.dampers.passive_theory import comfort_damping, road_damping, variances
from bridgectl.dampers.regulator import Regulator, of_signals, tells_state, whole_regulator
from bridgectl.dampers.strategy import Strategy
from bridgectl.dampers.switching import DEAD_BAND, Gains, documented, nearest
from bridgectl.dampers.tire_laws import deflection_of_tire, tire_gains
from bridgectl.model.quarter_car import QuarterCar, require_quarter_car
from bridgectl.model.vehicle import Vehicle

FEEDBACK = ("travel_gain", "body_gain", "deflection_gain", "axle_gain")
"""Names of the gains K of x = [d, y_s', e, y_t']: N/m, N s/m, N/m, N s/m."""

TRAVEL_SHARE = 0.1
"""How much the suspension travel counts by default, relative to the body acceleration."""


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
        Its own damping does not matter. For a vehicle of several dampers see the notes.
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

    Each damper of a vehicle measures at all legs, and J sums over them, with the acceleration that
    spring and damper of a leg give the mass that it carries; x is the motion about the equilibrium
    on the road that is under the tires now. Default weights are those of the quarter-car of each
    leg: its axle, springs and tires, and the load on them. Where the legs' signals do not tell the
    motion, as of two axles on one spring, each leg has the law of its quarter-car alone.

    That is the least J before forces are clipped. Clipped to 1 to 30 kN s/m, on class B roads at
    25 m/s, J was the same as with such laws for the truck T2 of `bridgectl.trucks`, 5 % lower for
    T5air, 8 % higher for T2A01.

    K is in gains: `travel_gain` and `deflection_gain` [N/m], `body_gain` and `axle_gain` [N s/m],
    for d, e, y_s' and y_t'; so are W and K_t, `static_load` [N] and `tire_stiffness` [N/m]. Of a
    vehicle each of them is one for each leg, `travel_gain_1`, ...

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
    weights = body_acceleration, suspension_travel, tire_deflection, damper_force
    if isinstance(vehicle, Vehicle) and len(vehicle.damper_map) > 1 and tells_state(vehicle):
        return _whole(vehicle, c_min, c_max, weights, dead_band)
    return _of_each(vehicle, c_min, c_max, weights, dead_band)


Weights = tuple[float, float | None, float | None, float]
"""q_1, q_2, q_3 and rho of `clipped_lqr`, as they are given."""


def _whole(
    vehicle: Vehicle, c_min: float, c_max: float, weights: Weights, dead_band: float
) -> Strategy:
    """The law of a whole vehicle, at each of its legs."""
    cars = corners(vehicle)
    masses = np.array([car.sprung_mass for car in cars])
    q1, q2, q3, rho = np.array([_weights(car, *weights) for car in cars]).T
    found = whole_regulator(vehicle, masses, q1[0], q2, q3, rho[0]).feedbacks()
    legs = range(1, len(cars) + 1)
    of_tires = {
        f"{name}_{leg}": gain
        for leg, car in zip(legs, cars, strict=True)
        for name, gain in tire_gains(car).items()
    }
    names = [f"{name}_{leg}" for name in FEEDBACK for leg in legs]
    laws = [
        nearest(
            "clipped LQR", partial(_whole_force, legs), c_min, c_max, dead_band,
            _feedback_gains(names, own.ravel()) | of_tires,
        )
        for own in of_signals(vehicle, found)
    ]  # fmt: skip
    return EachLeg(vehicle, laws)


@of_each_leg
def _of_each(
    vehicle: Vehicle | QuarterCar, c_min: float, c_max: float, weights: Weights, dead_band: float
) -> Strategy:
    car = require_quarter_car(vehicle)
    gains = tire_gains(car)
    feedback = regulator(car, *weights).feedback()
    gains = _feedback_gains(FEEDBACK, feedback) | gains
    return nearest("clipped LQR", _force, c_min, c_max, dead_band, gains)


def _feedback_gains(names: Sequence[str], values: FloatArray) -> Gains:
    return {name: (float(k), -1e8, 1e8) for name, k in zip(names, values, strict=True)}


def regulator(
    vehicle: QuarterCar,
    body_acceleration: float = 1.0,
    suspension_travel: float | None = None,
    tire_deflection: float | None = None,
    damper_force: float = 0.0,
) -> Regulator:
    """Return the linear-quadratic problem of `clipped_lqr`, for the same arguments."""
    q1, q2, q3, rho = _weights(
        vehicle, body_acceleration, suspension_travel, tire_deflection, damper_force
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


def _weights(
    vehicle: QuarterCar,
    body_acceleration: float,
    suspension_travel: float | None,
    tire_deflection: float | None,
    damper_force: float,
) -> tuple[float, float, float, float]:
    """Check q_1, q_2, q_3 and rho of a quarter-car, with the defaults for it."""
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
    return q1, q2, q3, rho


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


def _whole_force(legs: Sequence[int], s: Any, g: Any) -> Any:
    """F* of a damper from the signals of all legs."""
    return sum(_force(_AtLeg(s, leg), _AtLeg(g, leg)) for leg in legs)


class _AtLeg:
    """Signals, or gains, of a leg, called as those of a law's own."""

    def __init__(self, every: Any, leg: int) -> None:
        self._every, self._leg = every, leg

    def __getattr__(self, name: str) -> Any:
        return getattr(self._every, f"{name}_{self._leg}")
