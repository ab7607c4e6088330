"""A strategy as a block of python-control: outputs of a crossing in, a damper force out."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, NamedTuple, TypeAlias

import control
import numpy as np

from bridgectl import _checks as check
from bridgectl._checks import FloatArray
from bridgectl.dampers.expression import at_sample, depends
from bridgectl.dampers.legs import Legs
from bridgectl.model.vehicle import Vehicle
from bridgectl.model.vehicle import signals as signals_of

Strategy: TypeAlias = Any  # its module imports this one

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
"""Signals that a command may depend on but from one sample to the next: see `law_block`."""

RATE_TIME = 1e-3
"""Time constant [s] of the rate of the tire force in a block: as late as a change over 2 ms."""


class _Wiring(NamedTuple):
    """How a block reads what it measures from outputs of a crossing, and where its force goes."""

    inputs: list[str]
    """Outputs of the crossing."""
    reading: FloatArray
    """What is measured from them, (measured, inputs)."""
    number: str
    """What follows 'damper_force': '' of the only damper, else '_1', ..."""
    behind: float
    """How far the leg is behind the reference tire [m]."""


def _wiring(vehicle: Vehicle | None, leg: int, measured: Sequence[str]) -> _Wiring:
    """Of a leg of a vehicle, counted from 1; without one that of a quarter-car."""
    if vehicle is None:
        return _Wiring([CROSSING_OUTPUTS[name] for name in measured], np.eye(len(measured)), "", 0)
    legs, n = Legs(vehicle), len(vehicle.coordinates)
    number = f"_{leg}" if len(legs.rate) > 1 else ""
    rates = [f"{name}_dot" for name in vehicle.coordinates]
    suspension = [f"suspension_travel{number}", f"suspension_velocity{number}"]
    tires = signals_of("tire_force", vehicle.n_tires) if "tire_force" in measured else []
    reading = np.zeros((len(measured), n + 2 + len(tires)))
    reading[0, :n], reading[1, :n] = (of[leg - 1, 1::2] for of in (legs.body, legs.axle))
    reading[2:4, n : n + 2] = np.eye(2)
    if tires:
        reading[4, n + 2 :] = legs.tires[leg - 1]
    return _Wiring([*rates, *suspension, *tires], reading, number, float(legs.offsets[leg - 1]))


def law_block(
    law: Strategy, signals: Sequence[str], speed: float, rate_time: float, sample_time: float,
    vehicle: Vehicle | None = None, leg: int = 1,
) -> control.NonlinearIOSystem:  # fmt: skip
    """Return the block of a law of some signals: see `bridgectl.dampers.Strategy.system`."""
    velocity = check.positive("speed", speed, unit="m/s")
    lag = check.positive("rate_time", rate_time, unit="s")
    time = check.positive("sample_time", sample_time, unit="s")
    used, gains = set(law.used), np.reshape([*law.gains.values()], (-1, 1))
    at_once = depends(law.function, signals, gains[:, 0].tolist(), at_once=True)
    if loops := [name for name in SAMPLED if name in at_once]:
        raise ValueError(
            f"{law.name} measures {' and '.join(loops)}, which the damper force changes at "
            "once: it has no block without delay, simulate it with a sample time by "
            "daf(..., damper=Damper(law, sample_time=2e-3)) or simulate_loop"
        )
    measured = [*MOTION, *(name for name in SAMPLED if name in used)]
    of_tire = len(measured) if used & {"tire_force", "tire_force_rate"} else None
    measured += [] if of_tire is None else ["tire_force"]
    lagged = ["lagged_tire_force"] if "tire_force_rate" in used else []
    places = [signals.index(name) for name in (*measured, "position", "speed")]
    wired = _wiring(vehicle, leg, measured)
    rate, row = MOTION.index("suspension_velocity"), np.zeros((len(signals), 1))
    n, most = len(lagged), len(wired.inputs)

    def sampled(t: float, x: FloatArray, u: FloatArray) -> tuple[FloatArray, FloatArray]:
        row[places, 0] = *(wired.reading @ u[:most]), velocity * t - wired.behind, velocity
        if lagged:
            row[signals.index("tire_force_rate")] = tire_rate(x, u)
        columns = row, gains, x[n:, np.newaxis], [[time]], u[most:, np.newaxis]
        c, after = at_sample(law.name, law.function, *columns)
        return c, after[:, 0]

    def tire_rate(x: FloatArray, u: FloatArray) -> FloatArray:
        return (wired.reading[of_tire:] @ u[:most] - x[:n]) / lag if lagged else u[:0]

    def update(t: float, x: FloatArray, u: FloatArray, p: dict[str, Any]) -> FloatArray:
        moved = sampled(t, x, u)[1] if law.states else x[n:]
        return np.concatenate([tire_rate(x, u), (moved - x[n:]) / time])

    def output(t: float, x: FloatArray, u: FloatArray, p: dict[str, Any]) -> FloatArray:
        try:
            c = float(sampled(t, x, u)[0][0])
        except ValueError:
            # No output of another system is known when all are asked for theirs at first, and
            # only then is a tire force 0 without any motion.
            if of_tire is None or u.any():
                raise
            c = law.c_min
        return np.array([c * (wired.reading[rate] @ u[:most]), c])

    states = [*lagged, *law.states]
    return control.nlsys(
        update if states else None, output, states=states or None,
        inputs=wired.inputs + [f"ahead{wired.number}_{i + 1}" for i in range(len(law.preview))],
        outputs=[f"damper_force{wired.number}", f"damping{wired.number}"],
        name=(law.name.replace(".", "_").lstrip("-") or "damper") + wired.number,
    )  # fmt: skip
