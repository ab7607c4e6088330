"""Dampers that the DAE is tried on: those that its second order was found with, and others."""

from __future__ import annotations

from typing import Any

import casadi as ca
import numpy as np

from bridgectl._checks import FloatArray
from bridgectl.dampers import (
    Damper,
    Strategy,
    add,
    bridgehook,
    hybrid,
    library,
    passive,
    program,
    skyhook,
)
from bridgectl.model.beam import Beam
from bridgectl.model.quarter_car import QuarterCar

C_MIN, C_MAX = 1e3, 30e3
"""Bounds of the damping [N s/m]."""

SEED = 1306
"""Of random gains and programs."""

REACH = 20.0
"""How far before the bridge random programs begin [m]."""


def known_dampers(beam: Beam, vehicle: QuarterCar) -> list[Damper]:
    """Return the 23 that the formula was found with: library, constants, programs."""
    thirds = beam.length * np.array([0.0, 0.32, 0.64])
    quarters = beam.length * np.array([0.0, 0.24, 0.48])
    strategies = [
        *library(beam, vehicle, C_MIN, C_MAX),
        *(passive(c) for c in (1e3, 2e3, 4e3, 12e3, 20e3, 30e3)),
        program(thirds, [7e3, 30e3, 1e3], name="program, stiff first"),
        program(quarters, [1e3, 30e3, 1e3], name="program, soft first"),
        bridgehook(beam, vehicle, C_MIN, C_MAX, feedback=False).renamed("bridgehook, no feedback"),
    ]
    return [Damper(strategy) for strategy in strategies]


def unseen_dampers(beam: Beam, vehicle: QuarterCar) -> list[Damper]:
    """Return laws without a part in it: random gains and programs, scheduled, delayed, limited."""
    rng = np.random.default_rng(SEED)
    x = np.linspace(-REACH, beam.length, 9)
    dampings = np.exp(rng.uniform(np.log(C_MIN), np.log(C_MAX), (2, x.size)))
    hook = bridgehook(beam, vehicle, C_MIN, C_MAX)
    return [
        *(Damper(_random_gains(number, rng.normal(size=3))) for number in (1, 2)),
        *(
            Damper(program(x, c, name=f"random program {number}", shape="lines"))
            for number, c in enumerate(dampings, 1)
        ),
        Damper(hybrid(C_MIN, C_MAX, share=0.8, gain=12e3).renamed("hybrid, 0.8 of 12 kN s/m")),
        Damper(Strategy("skyhook below 90 km/h, groundhook above", _by_speed, C_MIN, C_MAX)),
        Damper(Strategy("groundhook on the bridge alone", _by_place, C_MIN, C_MAX)),
        Damper(skyhook(C_MIN, C_MAX).renamed("skyhook, 30 ms late"), lag=0.03),
        Damper(add(5e3, 15e3).renamed("ADD, 5 to 15 kN s/m")),
        Damper(hook.renamed("bridgehook, 20 ms late"), lag=0.02),
        Damper(hook.renamed("bridgehook, up to 6 kN"), max_force=6e3),
    ]


def _random_gains(number: int, gains: FloatArray) -> Strategy:
    """A law that switches with a random combination of what it measures."""
    scales = gains * [1.0, 1.0, 10.0]  # travel [m] beside velocities [m/s]

    def law(s: Any, g: Any) -> Any:
        force = (
            scales[0] * s.body_velocity + scales[1] * s.axle_velocity
            + scales[2] * s.suspension_travel
        )  # fmt: skip
        return ca.if_else(force * s.suspension_velocity > 0, g.c_max, g.c_min)

    return Strategy(f"random gains {number}", law, C_MIN, C_MAX)


def _by_speed(s: Any, g: Any) -> Any:
    held = ca.if_else(s.speed < 25, s.body_velocity, -s.axle_velocity)
    return ca.if_else(held * s.suspension_velocity > 0, g.c_max, g.c_min)


def _by_place(s: Any, g: Any) -> Any:
    ground = ca.if_else(-s.axle_velocity * s.suspension_velocity > 0, g.c_max, g.c_min)
    return ca.if_else(s.position >= 0, ground, 7e3)
