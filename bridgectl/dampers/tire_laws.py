"""Strategies that watch the tire: Valasek's groundhooks, and one for fast tire forces only.

Signs as in the crossing: displacements positive downward, travel d = y_s - y_t, v = d'. The tire
force R = W + K_t e holds the tire's deflection e = y_t - surface beyond its static one, the surface
being the road on the deflected bridge. So e = (R - W) / K_t and e' = R' / K_t can be measured
wherever the tire force can, on a bridge too, while the surface's own velocity cannot.
"""

from __future__ import annotations

from typing import Any

import casadi as ca
import numpy as np

from bridgectl import _checks as check
from bridgectl.dampers.each_leg import of_each_leg
from bridgectl.dampers.passive_theory import invariant_frequencies
from bridgectl.dampers.strategy import Strategy
from bridgectl.dampers.switching import DEAD_BAND, Gains, documented, nearest, on_off
from bridgectl.model.quarter_car import QuarterCar, require_quarter_car
from bridgectl.model.vehicle import Vehicle


@documented
def tire_groundhook(c_min: float, c_max: float, *, dead_band: float = DEAD_BAND) -> Strategy:
    """Return Valasek's on-off groundhook: c_max where -e' v > 0, c_min elsewhere.

    It holds the axle against the surface that the tire meets: with e' = y_t' minus the velocity of
    that surface, the force of a stiff damper then works against the tire's deflection. Only the
    sign of the tire force's rate matters, so that no stiffness has to be known.

    {on_off}

    References
    ----------
    M. Valasek, M. Novak, Z. Sika, O. Vaculin, Veh. Syst. Dyn. 27 (1997) 289-303.

    Examples
    --------
    >>> from bridgectl.dampers import tire_groundhook
    >>> tire_groundhook(1e3, 30e3).command(tire_force_rate=[5e3, -5e3], suspension_velocity=0.2)
    array([ 1000., 30000.])
    """
    return on_off("tire groundhook", lambda s, g: -s.tire_force_rate, c_min, c_max, dead_band)


@of_each_leg
@documented
def extended_groundhook(
    c_min: float,
    c_max: float,
    *,
    vehicle: Vehicle | QuarterCar,
    tire_damping: float = 0.0,
    sky_damping: float = 0.0,
    suspension_damping: float = 16e3,
    tire_stiffness_change: float = 100e3,
    travel_stiffness_change: float = -70e3,
    dead_band: float = DEAD_BAND,
) -> Strategy:
    """Return Valasek's extended groundhook: c = F* / v of a force of five gains.

    ::

        F* = -b_1 e' + b_2 y_s' + b_12 v - dK_10 e + dK_12 d

    A damper of the tire (b_1) and one to the sky (b_2), one between body and axle (b_12), and
    springs added to the tire (dK_10) and the suspension (dK_12): what the damper can give of it.

    Parameters
    ----------
    {bounds}
    vehicle : Vehicle or QuarterCar
        Its static load W and tire stiffness K_t turn the tire force into e and e'. They are gains
        too, `static_load` [N] and `tire_stiffness` [N/m]: a controller knows them but roughly.
    tire_damping, sky_damping : float, optional
        b_1 and b_2 [N s/m], 0 or more.
    suspension_damping : float, optional
        b_12 [N s/m].
    tire_stiffness_change, travel_stiffness_change : float, optional
        dK_10 and dK_12 [N/m].
    {dead_band}

    {strategy}

    Notes
    -----
    No published gains are known for such a truck, so the defaults were tuned here: they are the
    least J = DLC / DLC_7 + a / (2 a_7) of the paper's truck on a rigid road of ISO class A at
    25 m/s, rounded, with c from 1 to 30 kN s/m sampled every 2 ms; DLC is the dynamic load
    coefficient, a the RMS body acceleration, and the index 7 means passive 7 kN s/m. On 36 km of
    other class A roads::

                               DLC      a [m/s^2]   J
        passive 7 kN s/m       0.0422   0.102       1.500
        passive 16.5 kN s/m    0.0294   0.127       1.323   the best constant
        extended groundhook    0.0304   0.117       1.295

    On class B all DLC and a are twice as large. For another vehicle, tune anew. b_1 and b_2 came
    out as next to nothing: on a random road e' is mostly the velocity of the surface, which is
    nearly white and tells nothing of what comes, and the damping of axle and body is in b_12.

    References
    ----------
    M. Valasek, M. Novak, Z. Sika, O. Vaculin, Veh. Syst. Dyn. 27 (1997) 289-303.

    Examples
    --------
    >>> import numpy as np
    >>> import bridgectl as bc
    >>> from bridgectl.dampers import extended_groundhook
    >>> law = extended_groundhook(1e3, 30e3, vehicle=bc.li2006.car())
    >>> law.command(
    ...     suspension_velocity=0.1, suspension_travel=[0, 0.01, 0, 0],
    ...     tire_force=98.1e3 + 1.8e6 * np.array([0, 0, 0.01, -0.1]))
    array([16000.,  9000.,  6000., 30000.])
    """
    for name, value in (("tire_damping", tire_damping), ("sky_damping", sky_damping)):
        check.not_negative(name, value, unit="N s/m")
    gains: Gains = {
        "tire_damping": (tire_damping, 0.0, 1e6),
        "sky_damping": (sky_damping, 0.0, 1e6),
        "suspension_damping": (suspension_damping, -1e6, 1e6),
        "tire_stiffness_change": (tire_stiffness_change, -1e8, 1e8),
        "travel_stiffness_change": (travel_stiffness_change, -1e8, 1e8),
        **tire_gains(require_quarter_car(vehicle)),
    }

    def force(s: Any, g: Any) -> Any:
        return (
            g.sky_damping * s.body_velocity
            + g.suspension_damping * s.suspension_velocity
            + g.travel_stiffness_change * s.suspension_travel
            - g.tire_damping * s.tire_force_rate / g.tire_stiffness
            - g.tire_stiffness_change * deflection_of_tire(s, g)
        )

    return nearest("extended groundhook", force, c_min, c_max, dead_band, gains)


@of_each_leg
@documented
def selective_groundhook(
    c_min: float,
    c_max: float,
    *,
    vehicle: Vehicle | QuarterCar,
    crossover: float | None = None,
    dead_band: float = DEAD_BAND,
) -> Strategy:
    """Return the groundhook of fast tire forces: `tire_groundhook` where they are, else c_min.

    Fast is R'^2 > (crossover (R - W))^2: at one frequency, all above the crossover. It parts the
    tire force as `sh_add` parts the body's motion, at the frequency from which on a stiff damper
    makes it smaller: `bridgectl.passive_theory.invariant_frequencies` has two such frequencies, for
    the paper's truck 0.62 and 5.19 Hz, with soft better in between. Below the first one stiff is
    better again, but there this law stays soft.

    Parameters
    ----------
    {bounds}
    vehicle : Vehicle or QuarterCar
        Gives the static load W, as the gain `static_load` [N], and the crossover.
    crossover : float, optional
        In rad/s. Default: 2 pi times the upper of the two frequencies.
    {dead_band}

    {strategy}

    Notes
    -----
    The law is our own. On a random road R' is broad-banded, so that nearly all is fast: on those of
    `extended_groundhook` the dynamic load coefficient is 0.0268, that of `tire_groundhook` 0.0259.

    Examples
    --------
    An oscillation of the tire force by 10 kN, as it passes 5 kN falling, at 1 Hz and at 7 Hz:

    >>> import numpy as np
    >>> import bridgectl as bc
    >>> from bridgectl.dampers import selective_groundhook
    >>> law = selective_groundhook(1e3, 30e3, vehicle=bc.li2006.car())
    >>> rates = -2 * np.pi * np.array([1, 7]) * 8660.0
    >>> law.command(tire_force=103.1e3, tire_force_rate=rates, suspension_velocity=0.1)
    array([ 1000., 30000.])
    """
    car = require_quarter_car(vehicle)
    quick = 2 * np.pi * invariant_frequencies(car).tire_force[-1]
    rate = quick if crossover is None else check.not_negative("crossover", crossover, unit="rad/s")

    def driver(s: Any, g: Any) -> Any:
        fast = ca.fabs(s.tire_force_rate) > g.crossover * ca.fabs(s.tire_force - g.static_load)
        return ca.if_else(fast, -s.tire_force_rate, 0)

    gains: Gains = {
        "crossover": (float(rate), 0.0, 1e3),
        "static_load": tire_gains(car)["static_load"],
    }
    return on_off("selective groundhook", driver, c_min, c_max, dead_band, gains)


def tire_gains(vehicle: QuarterCar) -> Gains:
    """Return what turns a tire force into a deflection: W [N] and K_t [N/m], as gains."""
    load = float(vehicle.linear.static_loads[0])
    return {"static_load": (load, 0.0, 1e7), "tire_stiffness": (vehicle.tire_stiffness, 1.0, 1e9)}


def deflection_of_tire(s: Any, g: Any) -> Any:
    """Return e = (R - W) / K_t [m] of signals and `tire_gains`."""
    return (s.tire_force - g.static_load) / g.tire_stiffness
