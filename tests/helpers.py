"""Roads and cases that several tests share."""

from __future__ import annotations

import numpy as np

import bridgectl as bc


def rough_road(
    seed: int, start: float, stop: float, step: float = 0.1, height: float = 5e-4
) -> bc.RoadProfile:
    """A random road of ramps: heights in metres, normally distributed."""
    rng = np.random.default_rng(seed)
    x = start + step * np.arange(round((stop - start) / step) + 1)
    return bc.RoadProfile(x, np.cumsum(rng.normal(0.0, height, x.size)))


def random_case(seed: int) -> dict:
    """Arguments of `crossing_response` for a random beam, vehicle, speed and road."""
    rng = np.random.default_rng(seed)
    length = rng.uniform(10, 45)
    mass_per_length = rng.uniform(5e3, 30e3)
    frequency = rng.uniform(0.7, 1.4) * 100 / length
    rigidity = mass_per_length * (2 * np.pi * frequency) ** 2 * (length / np.pi) ** 4
    beam = bc.Beam(
        length,
        mass_per_length,
        rigidity,
        n_modes=int(rng.integers(1, 5)),
        damping_ratio=rng.choice([0.0, rng.uniform(0, 0.05)]),
    )
    car = bc.QuarterCar(
        sprung_mass=rng.uniform(2e3, 12e3),
        unsprung_mass=rng.uniform(300, 1500),
        suspension_stiffness=rng.uniform(5e4, 1e6),
        tire_stiffness=rng.uniform(8e5, 4e6),
        damping=rng.uniform(0, 3e4),
    )
    start = -float(rng.integers(0, 15))
    step = rng.choice([0.1, 0.5, 1.0])
    return {
        "beam": beam,
        "vehicle": bc.convoy([car, car], [0, rng.uniform(1, 9)]) if seed % 5 == 4 else car,
        "speed": rng.uniform(10, 45),
        "profile": rough_road(seed, start, length + 1, step, height=2e-3 * step),
        "start": start,
        "section": rng.choice([0.5, rng.uniform(0.2, 0.8)]),
        "recovery": rng.choice(["exact", "li2006", "modal"]),
    }
