"""How laws come from a wish to a damping: on and off, or as near to a force as it goes."""

from __future__ import annotations

from typing import Any

import casadi as ca

from bridgectl.dampers.strategy import Law, Strategy

Gains = dict[str, tuple[float, float, float]]
"""Value, least and largest value of gains by name."""

DEAD_BAND = 1e-4
"""Suspension velocity [m/s] below which on-off laws stay soft: 3 N at 30 kN s/m."""


def on_off(
    name: str, driver: Law, c_min: float, c_max: float, dead_band: float,
    gains: Gains | None = None,
) -> Strategy:  # fmt: skip
    """Return a strategy that is stiff where driver v > 0 and v is beyond the dead band."""

    def law(s: Any, g: Any) -> Any:
        v = s.suspension_velocity
        return ca.if_else(
            ca.logic_and(driver(s, g) * v > 0, ca.fabs(v) > g.dead_band), g.c_max, g.c_min
        )

    bounds = {**(gains or {}), "dead_band": (dead_band, 0.0, 1.0)}
    return Strategy(name, law, c_min, c_max, bounds)


def damping_for(force: Any, s: Any, g: Any) -> Any:
    """Return the damping [N s/m] that comes closest to a wanted damper force [N].

    It is F / v within [c_min, c_max], and c_min where |v| is not beyond the dead band. Which bound
    holds is seen from the forces: a quotient by a small v may grow beyond all numbers.
    """
    v = s.suspension_velocity
    still = ca.fabs(v) <= g.dead_band
    size = ca.if_else(still, 1.0, ca.fabs(v))
    along = force * ca.sign(v)
    within = ca.if_else(along <= g.c_min * size, g.c_min, along / size)
    return ca.if_else(still, g.c_min, ca.if_else(along >= g.c_max * size, g.c_max, within))
