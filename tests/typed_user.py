"""A user's script, which runs and which type checkers follow: `.ci/built.py` tries both.

`mypy --strict` has nothing to say, and `assert_type` would complain of Any.
"""

from __future__ import annotations

from typing import Any, assert_type

import numpy as np
import numpy.typing as npt

import bridgectl as bc
from bridgectl.dampers import Damper, Strategy, library, skyhook

Floats = npt.NDArray[np.floating[Any]]

beam = bc.Beam(25.0, 18358.0, 4.865e10, n_modes=3)
bridge = bc.Bridge([25.0, 25.0], 18e3, 4.9e10)
truck = bc.trucks.load("T5air")
car = bc.li2006.car()
speeds = np.array([80.0, 90.0]) / 3.6

road = bc.utia_road().place_bridge(678).crop(-200, 25).detrend().resample(0.1)
random = [bc.iso8608_profile("A", 85.0, seed=seed, start=-60.0) for seed in range(2)]
assert_type(bc.li2006.beam(25), bc.Beam)
assert_type(truck, bc.Vehicle | bc.QuarterCar)
assert_type(road, bc.RoadProfile)
assert_type(road.x, Floats)
assert_type(road.iri(), float)
assert_type(road.psd().fit().iso_class, str)

factors = bc.daf(beam, car, speeds, road, start=-200.0)
assert_type(factors, Floats)
forces = bc.peak_effect(beam, car, speeds, road, start=-200.0, effect=bc.TireForce())
assert_type(forces, Floats)
assert_type(bc.envelope(beam, car, 25.0, road, start=-200.0).largest, Floats)

surface = bc.ramp_surface(beam, car, speeds, approach=200.0)
assert_type(surface, bc.RampSurface)
assert_type(surface.dae(road), Floats)
assert_type(surface.superposed_daf(road), Floats)
assert_type(surface.contributions(road), Floats)

hogging = bc.Crossing(bridge, truck, bc.Moment(25.0, sense="smallest"))
assert_type(hogging.static_peak, float)

damper = Damper(skyhook(1e3, 30e3), 2e-3, lag=0.01)
assert_type(bc.dampers.skyhook(1e3, 30e3), Strategy)
assert_type(library(beam, car, 1e3, 30e3), list[Strategy])
damped = bc.daf(beam, car, speeds, random[0], start=-60.0, damper=damper)
assert_type(damped, Floats)
board = bc.score([damper], beam, car, random, speeds, approach=60.0, workers=1)
assert_type(board, bc.Scoreboard)
found = bc.assess(beam, bc.Fleet.load("air_sprung"), {"A": random}, n=20, approach=60.0)
assert_type(found, bc.Assessment)
assert_type(found.summary(100.0), str)
print(factors, damped, surface.dae(road), len(found))
