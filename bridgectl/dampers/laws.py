"""Strategies of the literature, each as one CasADi expression.

Signs as in the crossing: displacements positive downward, suspension velocity v = y_s' - y_t'. A
stiff damper then pulls the body against v. The on-off laws keep the last word to `dead_band`: below
that suspension velocity the force is small either way, and the command is the soft one.
"""

from __future__ import annotations

from typing import Any

import casadi as ca
import numpy as np

from bridgectl import _checks as check
from bridgectl.dampers.strategy import Strategy
from bridgectl.dampers.switching import DEAD_BAND, documented, nearest, on_off

SH_ADD_CROSSOVER = 2 * np.pi * 0.643
"""Rate [rad/s] where skyhook and ADD are equally good on the paper's truck: its first
damping-invariant frequency of body acceleration."""


@documented
def passive(damping: float, name: str = "") -> Strategy:
    """Return a constant damper.

    Parameters
    ----------
    damping : float
        Its damping c [N s/m].
    name : str, optional
        What tables call it; its damping if omitted.

    {strategy}

    Examples
    --------
    >>> from bridgectl.dampers import passive
    >>> passive(7e3)
    Strategy('passive 7 kN s/m', c from 7000 to 7000 N s/m)
    """
    c = check.positive("damping", damping, unit="N s/m")
    return Strategy(name or f"passive {c / 1e3:g} kN s/m", lambda s, g: g.c_max + 0 * s.speed, c, c)


@documented
def skyhook(c_min: float, c_max: float, *, dead_band: float = DEAD_BAND) -> Strategy:
    """Return the on-off skyhook: c_max where y_s' v > 0, c_min elsewhere.

    {on_off}

    References
    ----------
    D. Karnopp, M. J. Crosby, R. A. Harwood, J. Eng. Ind. 96 (1974) 619-626.

    Examples
    --------
    >>> from bridgectl.dampers import skyhook
    >>> law = skyhook(1e3, 30e3)
    >>> law.command(body_velocity=[0.1, -0.1, 0.1], suspension_velocity=[0.2, 0.2, 0.0])
    array([30000.,  1000.,  1000.])
    """
    return on_off("skyhook", lambda s, g: s.body_velocity, c_min, c_max, dead_band)


@documented
def continuous_skyhook(
    c_min: float, c_max: float, *, gain: float = 30e3, dead_band: float = DEAD_BAND
) -> Strategy:
    """Return the clipped skyhook: c = gain y_s' / v where y_s' v > 0, c_min elsewhere.

    Parameters
    ----------
    {bounds}
    gain : float, optional
        Damping to the sky [N s/m].
    {dead_band}

    {strategy}

    References
    ----------
    D. Karnopp, M. J. Crosby, R. A. Harwood, J. Eng. Ind. 96 (1974) 619-626.

    Examples
    --------
    >>> from bridgectl.dampers import continuous_skyhook
    >>> continuous_skyhook(1e3, 30e3, gain=10e3).command(
    ...     body_velocity=[0.1, -0.1], suspension_velocity=[0.2, 0.2])
    array([5000., 1000.])
    """
    return nearest(
        "continuous skyhook", lambda s, g: g.gain * s.body_velocity, c_min, c_max, dead_band,
        {"gain": (gain, 0.0, 1e6)},
    )  # fmt: skip


@documented
def groundhook(c_min: float, c_max: float, *, dead_band: float = DEAD_BAND) -> Strategy:
    """Return the inertial on-off groundhook: c_max where -y_t' v > 0, c_min elsewhere.

    It holds the axle against the ground as the skyhook holds the body against the sky, in the
    inertial meaning of C. A. Pare and M. Ahmadian. Valasek's meaning, the axle against the surface
    that the tire meets, is `tire_groundhook`.

    {on_off}

    References
    ----------
    Both meanings: Machines 13 (2025) 727, Sections 3.1.1 and 3.1.2.

    Examples
    --------
    >>> from bridgectl.dampers import groundhook
    >>> groundhook(1e3, 30e3).command(axle_velocity=[0.1, -0.1], suspension_velocity=[0.2, 0.2])
    array([ 1000., 30000.])
    """
    return on_off("groundhook", lambda s, g: -s.axle_velocity, c_min, c_max, dead_band)


@documented
def hybrid(
    c_min: float, c_max: float, *, share: float = 0.5, gain: float = 30e3,
    dead_band: float = DEAD_BAND,
) -> Strategy:  # fmt: skip
    """Return a mix of skyhook and groundhook.

    F = gain (share y_s' where y_s' v > 0, minus (1 - share) y_t' where -y_t' v > 0); c = F / v.

    Parameters
    ----------
    {bounds}
    share : float, optional
        Fraction of the skyhook in it, 0 to 1; the rest is the groundhook's.
    gain : float, optional
        Damping to sky and ground together [N s/m].
    {dead_band}

    {strategy}

    References
    ----------
    M. Ahmadian, Veh. Syst. Dyn. 28 (1997), on hybrid semi-active control.

    Examples
    --------
    >>> from bridgectl.dampers import hybrid
    >>> hybrid(1e3, 30e3, gain=10e3).command(
    ...     body_velocity=0.1, axle_velocity=-0.1, suspension_velocity=0.2)
    array(5000.)
    """

    def force(s: Any, g: Any) -> Any:
        v = s.suspension_velocity
        sky = ca.if_else(s.body_velocity * v > 0, s.body_velocity, 0)
        ground = ca.if_else(-s.axle_velocity * v > 0, -s.axle_velocity, 0)
        return g.gain * (g.share * sky + (1 - g.share) * ground)

    gains = {"share": (share, 0.0, 1.0), "gain": (gain, 0.0, 1e6)}
    return nearest("hybrid", force, c_min, c_max, dead_band, gains)


@documented
def add(c_min: float, c_max: float, *, dead_band: float = DEAD_BAND) -> Strategy:
    """Return acceleration-driven damping: c_max where y_s'' v > 0, c_min elsewhere.

    {on_off}

    References
    ----------
    S. M. Savaresi, E. Silani, S. Bittanti, J. Dyn. Syst. Meas. Control 127 (2005) 218-229.

    Examples
    --------
    >>> from bridgectl.dampers import add
    >>> add(1e3, 30e3).command(body_acceleration=[1.0, -1.0], suspension_velocity=[0.2, 0.2])
    array([30000.,  1000.])
    """
    return on_off("ADD", lambda s, g: s.body_acceleration, c_min, c_max, dead_band)


@documented
def sh_add(
    c_min: float, c_max: float, *, crossover: float = SH_ADD_CROSSOVER,
    dead_band: float = DEAD_BAND,
) -> Strategy:  # fmt: skip
    """Return the mix of skyhook and ADD: skyhook while y_s''^2 <= (crossover y_s')^2, else ADD.

    Parameters
    ----------
    {bounds}
    crossover : float, optional
        Angular frequency [rad/s] that parts slow body motion, the skyhook's, from fast.
    {dead_band}

    {strategy}

    References
    ----------
    S. M. Savaresi, C. Spelta, J. Dyn. Syst. Meas. Control 129 (2007) 382-391.

    Examples
    --------
    >>> from bridgectl.dampers import sh_add
    >>> sh_add(1e3, 30e3).command(
    ...     body_velocity=[0.1, 0.1], body_acceleration=[-0.1, -10.0], suspension_velocity=0.2)
    array([30000.,  1000.])
    """

    def driver(s: Any, g: Any) -> Any:
        slow = s.body_acceleration**2 <= (g.crossover * s.body_velocity) ** 2
        return ca.if_else(slow, s.body_velocity, s.body_acceleration)

    gains = {"crossover": (crossover, 0.0, 1e3)}
    return on_off("SH-ADD", driver, c_min, c_max, dead_band, gains)


@documented
def pdd(c_min: float, c_max: float, *, stiffness: float, dead_band: float = DEAD_BAND) -> Strategy:
    """Return power-driven damping: keep spring and damper together from driving the body.

    With travel d: c_min where K_s d v + c_min v^2 >= 0, c_max where K_s d v + c_max v^2 < 0, and
    -K_s d / v between.

    Parameters
    ----------
    {bounds}
    stiffness : float
        Stiffness of the suspension K_s [N/m].
    {dead_band}

    {strategy}

    References
    ----------
    R. Morselli, R. Zanasi, Mechatronics 18 (2008) 364-377.

    Examples
    --------
    >>> from bridgectl.dampers import pdd
    >>> law = pdd(1e3, 30e3, stiffness=80e3)
    >>> law.command(suspension_travel=[0.01, -0.01, -0.1], suspension_velocity=[0.1, 0.1, 0.1])
    array([ 1000.,  8000., 30000.])
    """
    return nearest(  # within [c_min, c_max] the damping for this force is all three cases
        "PDD", lambda s, g: -g.stiffness * s.suspension_travel, c_min, c_max, dead_band,
        {"stiffness": (stiffness, 0.0, 1e9)},
    )  # fmt: skip
