"""How laws come from a wish to a damping: on and off, or as near to a force as it goes.

And what their docstrings have in common, which `documented` fills in.
"""

from __future__ import annotations

from typing import Any

import casadi as ca

from bridgectl._docs import filled
from bridgectl.dampers.strategy import Law, Strategy

Gains = dict[str, tuple[float, float, float]]
"""Value, least and largest value of gains by name."""

DEAD_BAND = 1e-4
"""Suspension velocity [m/s] below which on-off laws stay soft: 3 N at 30 kN s/m."""

documented = filled(
    on_off="""\
Parameters
----------
{bounds}
{dead_band}

{strategy}""",
    bounds="""\
c_min, c_max : float
    Bounds of the damping [N s/m].""",
    dead_band="""\
dead_band : float, optional
    Suspension velocity [m/s] below which the command is c_min.""",
    strategy="""\
Returns
-------
Strategy

Raises
------
TypeError, ValueError
    If an argument is not what is described above.""",
)
"""Fills in what the docstrings of laws have in common; {on_off} has all of it."""


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

    return _with_dead_band(name, law, c_min, c_max, dead_band, gains or {})


def nearest(
    name: str, force: Law, c_min: float, c_max: float, dead_band: float, gains: Gains
) -> Strategy:
    """Return a strategy whose damper force is as near to a wanted one as it goes."""

    def law(s: Any, g: Any) -> Any:
        return damping_for(force(s, g), s, g)

    return _with_dead_band(name, law, c_min, c_max, dead_band, gains)


def _with_dead_band(
    name: str, law: Law, c_min: float, c_max: float, dead_band: float, gains: Gains
) -> Strategy:
    return Strategy(name, law, c_min, c_max, {**gains, "dead_band": (dead_band, 0.0, 1.0)})


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
