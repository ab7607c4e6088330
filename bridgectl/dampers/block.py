"""A strategy as a block of python-control: outputs of a crossing in, a damper force out."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, NamedTuple, TypeAlias

import control
import numpy as np

from bridgectl import _checks as check
from bridgectl._checks import FloatArray
from bridgectl.dampers.compiled import compiled
from bridgectl.dampers.expression import at_sample, depends
from bridgectl.dampers.legs import Legs
from bridgectl.dampers.signals import SIGNALS, others_of
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

RATE = "tire_force_rate"

RATE_TIME = 1e-3
"""Time constant [s] of the rate of the tire force in a block: as late as a change over 2 ms."""


class _Signal(NamedTuple):
    """A signal that a law measures: what it is, and the leg, from 0, that it is of."""

    name: str
    signal: str
    leg: int


def _signals(law: Strategy, vehicle: Vehicle | None, leg: int) -> list[_Signal]:
    """What a law at a leg, counted from 1, measures, its own leg's first."""
    names = ("1",) if vehicle is None else vehicle.damper_names
    others = others_of(law.name, law.signals, names)
    return [_Signal(name, name, leg - 1) for name in SIGNALS] + [_Signal(*each) for each in others]


class _Wiring:
    """How a block reads what it measures from outputs of a crossing, and where its force goes."""

    def __init__(self, vehicle: Vehicle | None, leg: int, measured: Sequence[_Signal]) -> None:
        self.legs = None if vehicle is None else Legs(vehicle)
        rows = [self._row(each) for each in measured]
        self.inputs = [*dict.fromkeys(name for row in rows for name in row)]
        """Outputs of the crossing."""
        self.reading = np.array([[row.get(name, 0.0) for name in self.inputs] for row in rows])
        """What is measured from them, (measured, inputs)."""
        self.number = self._number(leg - 1)
        """What follows 'damper_force': '' of the only damper, else '_1', ..."""

    def _number(self, leg: int) -> str:
        return f"_{leg + 1}" if self.legs is not None and len(self.legs.rate) > 1 else ""

    def _row(self, what: _Signal) -> dict[str, float]:
        """Outputs of the crossing that sum up to a signal, with their factors."""
        signal = "tire_force" if what.signal == "tire_force_rate" else what.signal
        if self.legs is None:
            return {CROSSING_OUTPUTS[signal]: 1.0}
        if signal == "tire_force":
            tires = self.legs.tires[what.leg]
            names = signals_of("tire_force", len(tires))
            return {name: 1.0 for name, under in zip(names, tires, strict=True) if under}
        if signal.startswith("suspension"):
            return {f"{signal}{self._number(what.leg)}": 1.0}
        ends = self.legs.body if signal.startswith("body") else self.legs.axle
        dots = "_ddot" if signal in SAMPLED else "_dot"
        names = [f"{name}{dots}" for name in self.legs.vehicle.coordinates]
        found = zip(names, ends[what.leg, 1::2].tolist(), strict=True)
        return {name: factor for name, factor in found if factor}

    def behind(self, leg: int) -> float:
        """How far a leg is behind the reference tire [m]."""
        return 0.0 if self.legs is None else float(self.legs.offsets[leg])


def law_block(
    law: Strategy, speed: float, rate_time: float, sample_time: float,
    vehicle: Vehicle | None = None, leg: int = 1,
) -> control.NonlinearIOSystem:  # fmt: skip
    """Return the block of a law: see `bridgectl.dampers.Strategy.system`."""
    velocity = check.positive("speed", speed, unit="m/s")
    lag = check.positive("rate_time", rate_time, unit="s")
    time = check.positive("sample_time", sample_time, unit="s")
    used, gains = set(law.used), np.reshape([*law.gains.values()], (-1, 1))
    at_once = depends(law.function, law.signals, gains[:, 0].tolist(), at_once=True)
    every = _signals(law, vehicle, leg)
    if loops := [each.name for each in every if each.signal in SAMPLED and each.name in at_once]:
        raise ValueError(
            f"{law.name} measures {' and '.join(loops)}, which the damper force changes at "
            "once: it has no block without delay, simulate it with a sample time by "
            "daf(..., damper=Damper(law, sample_time=2e-3)) or simulate_loop"
        )
    placed = [(k, each.leg) for k, each in enumerate(every) if each.signal == "position"]
    fast = [k for k, each in enumerate(every) if each.signal == "speed"]
    rated = [k for k, each in enumerate(every) if each.signal == RATE and each.name in used]
    read = [
        k
        for k, each in enumerate(every)
        if each.name in MOTION or (each.name in used and each.signal in CROSSING_OUTPUTS)
    ]
    wired = _Wiring(vehicle, leg, [every[k] for k in [*read, *rated]])
    pressing = any(every[k].signal == "tire_force" for k in read) or bool(rated)
    offsets = np.array([wired.behind(of) for _, of in placed])
    rate, row = MOTION.index("suspension_velocity"), np.zeros((len(every), 1))
    n, most = len(rated), len(wired.inputs)
    function = compiled(law.function)

    def sampled(t: float, x: FloatArray, u: FloatArray) -> tuple[FloatArray, FloatArray]:
        row[read, 0] = (wired.reading @ u[:most])[: len(read)]
        row[[k for k, _ in placed], 0] = velocity * t - offsets
        row[fast], row[rated, 0] = velocity, tire_rates(x, u)
        columns = row, gains, x[n:, np.newaxis], [[time]], u[most:, np.newaxis]
        c, after = at_sample(law.name, function, *columns)
        return c, after[:, 0]

    def tire_rates(x: FloatArray, u: FloatArray) -> FloatArray:
        return np.asarray(((wired.reading @ u[:most])[len(read) :] - x[:n]) / lag)

    def update(t: float, x: FloatArray, u: FloatArray, p: dict[str, Any]) -> FloatArray:
        moved = sampled(t, x, u)[1] if law.states else x[n:]
        return np.concatenate([tire_rates(x, u), (moved - x[n:]) / time])

    def output(t: float, x: FloatArray, u: FloatArray, p: dict[str, Any]) -> FloatArray:
        try:
            c = float(sampled(t, x, u)[0][0])
        except ValueError:
            # No output of another system is known when all are asked for theirs at first, and
            # only then is a tire force 0 without any motion.
            if not pressing or u.any():
                raise
            c = law.c_min
        return np.array([c * (wired.reading[rate] @ u[:most]), c])

    states = [every[k].name.replace(RATE, "lagged_tire_force") for k in rated] + [*law.states]
    return control.nlsys(
        update if states else None, output, states=states or None,
        inputs=wired.inputs + [f"ahead{wired.number}_{i + 1}" for i in range(len(law.preview))],
        outputs=[f"damper_force{wired.number}", f"damping{wired.number}"],
        name=(law.name.replace(".", "_").lstrip("-") or "damper") + wired.number,
    )  # fmt: skip
