"""What both searches for roads share: the surface's speeds, and tolerances."""

from __future__ import annotations

import numpy as np

from bridgectl import _checks as check
from bridgectl.surface.surface import RampSurface

IRI_TOLERANCE = 1e-4
"""How closely the IRI of a made road meets what was asked [m/km]."""

NO_EFFECT = 1e-12
"""Changes of the DAE, and fractions of a spectrum, that are round-off."""


def speed_index(surface: RampSurface, speed: float) -> int:
    """Return which of the surface's speeds [m/s] this is."""
    wanted = check.positive("speed", speed, unit="m/s")
    i = int(np.argmin(np.abs(surface.speeds - wanted)))
    if not np.isclose(surface.speeds[i], wanted, rtol=1e-9):
        raise ValueError(
            f"speed = {wanted:g} m/s is not one of the surface's: the nearest is "
            f"{float(surface.speeds[i])!r}"
        )
    return i
