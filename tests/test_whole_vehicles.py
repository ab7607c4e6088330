"""Dampers at every axle: against a fine integration, quarter-cars, and the linear crossing."""

from __future__ import annotations

import numpy as np
import pytest
from fine_loop import FineLoop
from helpers import rough_road

import bridgectl as bc
from bridgectl import dampers
from bridgectl.dampers import Damper, simulate_loop

SOFT, STIFF = 1e3, 30e3

LAWS = {
    law.name: law
    for law in (
        dampers.skyhook(SOFT, STIFF), dampers.continuous_skyhook(SOFT, STIFF),
        dampers.groundhook(SOFT, STIFF), dampers.hybrid(SOFT, STIFF), dampers.add(SOFT, STIFF),
        dampers.sh_add(SOFT, STIFF), dampers.pdd(SOFT, STIFF, stiffness=2e5),
    )
}  # fmt: skip
"""Laws that know no vehicle; the eighth, bridgehook, is made for it."""


def half_car(rng, inertia=None):
    """A truck of two axles with bounce and pitch; without coupling inertia if none is given."""
    a, b = rng.uniform(1, 3, 2)
    legs = np.array([[1, -a, -1, 0], [1, b, 0, -1]])
    mass, springs, dashpots = rng.uniform(8e3, 14e3), rng.uniform(1e5, 4e5, 2), [8e3, 11e3]
    return bc.Vehicle(
        np.diag([mass, mass * a * b if inertia is None else inertia, *rng.uniform(500, 1e3, 2)]),
        legs.T @ np.diag(dashpots) @ legs, legs.T @ np.diag(springs) @ legs,
        rng.uniform(1.2e6, 2.5e6, 2), [0, a + b], damper_map=legs, damper_dampings=dashpots,
        damper_names=["front", "rear"], heave=[1, 0, 1, 1],
    )  # fmt: skip


def quarter_cars(car):
    """The quarter-cars that a half-car without coupling inertia is."""
    mass, (a, b) = car.mass_matrix[0, 0], (-car.damper_map[0, 1], car.damper_map[1, 1])
    shares = mass * b / (a + b), mass * a / (a + b)
    springs = -car.stiffness_matrix[0, 2], -car.stiffness_matrix[0, 3]
    return [
        bc.QuarterCar(share, car.mass_matrix[2 + i, 2 + i], spring, tire, damping)
        for i, (share, spring, tire, damping) in enumerate(
            zip(shares, springs, car.tire_stiffnesses, car.damper_dampings, strict=True)
        )
    ]


def five_axles(rng):
    """A tractor of two axles and a semi-trailer of three, hinged, on soft springs."""
    springs, dashpots = rng.uniform(3e5, 8e5, 5), rng.uniform(5e3, 2e4, 5)
    arms = np.array([[1, -1, 0], [1, 3.5, 0], [1, 3, 7], [1, 3, 8.2], [1, 3, 9.4]])
    legs, bodies = np.hstack([arms, -np.eye(5)]), np.array([[1, 0, 0], [1, 3, 5]])
    mass = np.diag([0.0, 0.0, 0.0, 750, 750, 1100, 1100, 1100])
    mass[:3, :3] = bodies.T @ np.diag([5e3, rng.uniform(15e3, 25e3)]) @ bodies
    mass[1, 1] += 5e3
    mass[2, 2] += 12e4
    stiffness, damping = (legs.T @ np.diag(of) @ legs for of in (springs, dashpots))
    return bc.Vehicle(
        mass, damping, stiffness, [1.75e6, 1.75e6, 3.5e6, 3.5e6, 3.5e6],
        [0, 4.5, 11, 12.2, 13.4], heave=[1, 0, 0, 1, 1, 1, 1, 1], damper_map=legs,
        damper_dampings=dashpots,
    )  # fmt: skip


def random_case(seed, truck):
    """A short bridge, a vehicle, dampers, a speed and a road: lift-off of every third."""
    rng = np.random.default_rng(seed)
    length = rng.uniform(6, 10)
    rigidity = 15e3 * (2 * np.pi * rng.uniform(6, 9)) ** 2 * (length / np.pi) ** 4
    beam = bc.Beam(length, 15e3, rigidity, n_modes=2, damping_ratio=rng.choice([0.0, 0.02]))
    car = truck(rng) if truck is five_axles else truck(rng, rng.uniform(1e4, 5e4))
    lift_off = seed % 3 == 0
    limits = [[np.inf, 2e3], [1e3, 4e3], [np.inf]][seed % 3]
    clock = rng.choice([2e-3, rng.uniform(5e-3, 2e-2)])
    options = [
        {
            "sample_time": clock,
            "lag": rng.choice([0.0, rng.uniform(2e-3, 2e-2)]),
            "max_force": float(rng.choice(limits)),
        }
        for _ in car.damper_map
    ]
    height = 4e-2 if lift_off else 1e-3
    road = rough_road(seed, -2, np.ceil(length), 0.5, height=height)
    return beam, car, options, rng.uniform(20, 40), road, lift_off


def compare(seed, truck, name):
    """The loop's result and the fine integration of the same crossing."""
    beam, car, options, speed, road, lift_off = random_case(seed, truck)
    law = LAWS[name] if name in LAWS else dampers.bridgehook(beam, car, SOFT, STIFF)
    each = [Damper(law, **own) for own in options]
    found = simulate_loop(beam, car, each, speed, road.x, road.elevation)
    return found, FineLoop(beam, car, each, speed, road), lift_off


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(5))
@pytest.mark.parametrize("name", [*LAWS, "bridgehook"])
@pytest.mark.parametrize("truck", [half_car, five_axles])
def test_every_law_at_every_axle_is_its_fine_integration(truck, name, seed):
    """Eight laws, five random crossings each, with lift-off, force limits, lags: within 2e-5."""
    found, fine, lift_off = compare(seed, truck, name)
    assert found.daf[0, 0] == pytest.approx(fine.peak, abs=2e-5)
    assert (found.least_force[0, 0] == 0) == (fine.least == 0) == lift_off


@pytest.mark.parametrize(
    ("truck", "seed", "name"), [(half_car, 3, "skyhook"), (five_axles, 1, "groundhook")]
)
def test_a_law_at_every_axle_is_its_fine_integration(truck, seed, name):
    found, fine, _ = compare(seed, truck, name)
    assert found.daf[0, 0] == pytest.approx(fine.peak, abs=2e-5)
