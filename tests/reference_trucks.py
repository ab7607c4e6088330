"""Trucks, bridges and roads of the reference cases, and random ones."""

from __future__ import annotations

import json
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import bridgectl as bc

FILE = Path(__file__).parents[2] / "shared" / "reference" / "vehicles.json"

needs_reference = pytest.mark.skipif(
    not FILE.exists(), reason="the shared reference files are not here"
)


@cache
def reference() -> dict[str, Any]:
    return json.loads(FILE.read_text(encoding="utf-8"))


def reference_truck(name: str, **changes: Any) -> bc.Vehicle:
    """A vehicle of the reference file, by its printed matrices."""
    told = reference()["vehicles"][name]
    return bc.Vehicle(
        told["mass_matrix"],
        told["damping_matrix_without_tyres"],
        told["stiffness_matrix_without_tyres"],
        told["tyre_stiffness_N_m"],
        told["axle_offsets_behind_first_m"],
        told["tyre_map"],
        heave=[0.0 if name.startswith("th") else 1.0 for name in told["coordinates"]],
        coordinates=told["coordinates"],
        **{"tire_damping": told["tyre_damping_Ns_m"], **changes},
    )


def reference_case(name: str, n_modes: int = 14) -> tuple[dict[str, Any], float]:
    """Arguments of `daf` for a case on the simply supported beam, and its DAF."""
    case = reference()["cases"][name]
    told, road = reference()["bridges"][case["bridge"]], reference()["roads"][case["road"]]
    (one,) = case["vehicles"]
    braking = one["acceleration_from_bridge_entry_m_s2"]
    given = {
        "beam": bc.Beam(
            25.0, told["mass_per_length_kg_m"], told["flexural_rigidity_N_m2"], n_modes=n_modes
        ),
        "vehicle": reference_truck(one["vehicle"]),
        "speeds": bc.Motion(one["speed_m_s"], [0.0, braking], [0.0]),
        "profile": road["x_m"] and bc.RoadProfile(road["x_m"], road["elevation_m"]),
        "start": one["front_axle_start_m"],
    }
    return given, case["sections"]["12.5"]["daf_moment"]


def random_truck(rng: np.random.Generator) -> bc.Vehicle | bc.QuarterCar:
    """A quarter-car, or a rigid truck of up to four axles that pitches from braking."""
    n = int(rng.integers(1, 5))
    if n == 1:
        return bc.QuarterCar(
            rng.uniform(6e3, 12e3), rng.uniform(700, 1200), rng.uniform(80e3, 1e6),
            rng.uniform(1e6, 3e6), rng.uniform(5e3, 2e4), tire_damping=rng.uniform(0, 1e4),
        )  # fmt: skip
    axles = np.cumsum(rng.uniform(1.2, 3.5, n))
    legs = np.column_stack([np.ones(n), axles - axles.mean(), -np.eye(n)])
    stiffness, damping = rng.uniform(3e5, 2e6, n), rng.uniform(5e3, 3e4, n)
    body = rng.uniform(5e3, 1e4) * n
    return bc.Vehicle(
        np.diag([body, body * rng.uniform(3, 6), *rng.uniform(600, 1200, n)]),
        legs.T @ np.diag(damping) @ legs,
        legs.T @ np.diag(stiffness) @ legs,
        rng.uniform(1e6, 3.5e6, n),
        axles - axles[0],
        damper_map=legs,
        heave=[1.0, 0.0, *np.ones(n)],
        tire_damping=rng.uniform(0, 1.5e4, n),
        pitch_input=[0.0, body * rng.uniform(0.5, 2.0), *np.zeros(n)],
    )


def random_bridge(rng: np.random.Generator) -> bc.Beam | bc.Bridge | bc.ModalBridge:
    """A beam, two spans, or modes told at places."""
    length, kind = rng.uniform(12, 25), int(rng.integers(3))
    if kind == 0:
        return bc.Beam(length, 18358, 4.865e10, n_modes=int(rng.integers(2, 5)))
    if kind == 1:
        return bc.Bridge([length, 0.8 * length], 18358, 4.865e10, n_modes=3, damping_ratio=0.02)
    x = np.linspace(0, length, 41)
    line = ("moment", 0.5), ([0, length / 2, length], [0, length / 4, 0], [7.7e8, 0, -7e9])
    return bc.ModalBridge(
        x, np.sin(np.pi * np.outer(x, [1, 2, 3]) / length), frequencies=[4.0, 16.0, 36.0],
        modal_masses=9179 * length, damping_ratio=0.01, effects=dict([line]),
    )  # fmt: skip


def random_motion(rng: np.random.Generator, start: float, end: float) -> bc.Motion:
    """A motion of up to three pieces that comes from start to end [m]."""
    while True:
        places = np.sort(rng.uniform(start, end, int(rng.integers(0, 3))))
        motion = bc.Motion(rng.uniform(15, 35), rng.uniform(-4, 3, len(places) + 1), places)
        try:
            motion.time(np.array([start, end]))
        except ValueError:
            continue
        return motion
