"""A strategy as a block of python-control: outputs of a crossing in, a damper force out."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, Protocol

import control
import numpy as np

from bridgectl import _checks as check
from bridgectl._checks import FloatArray

CROSSING_OUTPUTS = {
    "body_velocity": "y_s_dot",
    "axle_velocity": "y_t_dot",
    "suspension_travel": "suspension_travel",
    "suspension_velocity": "suspension_velocity",
    "body_acceleration": "y_s_ddot",
    "axle_acceleration": "y_t_ddot",
    "tire_force": "tire_force",
}
"""Outputs of `bridgectl.crossing_system` that the measured signals are."""

MOTION = ("body_velocity", "axle_velocity", "suspension_travel", "suspension_velocity")
"""Inputs of every block."""

SAMPLED = ("body_acceleration", "axle_acceleration")
"""Signals that there are but for a controller that samples: see `law_block`."""

RATE_TIME = 1e-3
"""Time constant [s] of the rate of the tire force in a block: as late as a change over 2 ms."""


class Measuring(Protocol):
    """What a block knows of a strategy: see `bridgectl.dampers.Strategy`."""

    name: str
    c_min: float

    @property
    def used(self) -> list[str]:
        """Signals that the command depends on."""

    def evaluate(self, rows: FloatArray) -> FloatArray:
        """Damping [N s/m] from the signals, shape (n_signals, count)."""


def law_block(
    law: Measuring, signals: Sequence[str], speed: float, rate_time: float
) -> control.NonlinearIOSystem:
    """Return the block of a law of some signals: see `bridgectl.dampers.Strategy.system`."""
    velocity = check.positive("speed", speed, unit="m/s")
    lag = check.positive("rate_time", rate_time, unit="s")
    used = set(law.used)
    if loops := [name for name in SAMPLED if name in used]:
        raise ValueError(
            f"{law.name} measures {' and '.join(loops)}, which the damper force changes at "
            "once: it has no block without delay, simulate it with a sample time by "
            "daf(..., damper=Damper(law, sample_time=2e-3)) or simulate_loop"
        )
    measured = [*MOTION, *(["tire_force"] if used & {"tire_force", "tire_force_rate"} else [])]
    states = ["lagged_tire_force"] if "tire_force_rate" in used else []
    places = [signals.index(name) for name in (*measured, "position", "speed")]
    rate, row = MOTION.index("suspension_velocity"), np.zeros((len(signals), 1))

    def update(t: float, x: FloatArray, u: FloatArray, p: dict[str, Any]) -> FloatArray:
        return (u[-1] - x) / lag

    def output(t: float, x: FloatArray, u: FloatArray, p: dict[str, Any]) -> FloatArray:
        row[places, 0] = *u, velocity * t, velocity
        if states:
            row[signals.index("tire_force_rate"), 0] = update(t, x, u, p)[0]
        try:
            c = float(law.evaluate(row)[0])
        except ValueError:
            # No output of another system is known when all are asked for theirs at first, and
            # only then is a tire force 0 without any motion.
            if len(u) == len(MOTION) or u.any():
                raise
            c = law.c_min
        return np.array([c * u[rate], c])

    return control.nlsys(
        update if states else None, output, states=states or None,
        inputs=[CROSSING_OUTPUTS[name] for name in measured],
        outputs=["damper_force", "damping"],
        name=law.name.replace(".", "_").lstrip("-") or "damper",
    )  # fmt: skip
