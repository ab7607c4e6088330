"""Print how the cost of linear crossings grows with modes, speeds and flights, as ratios.

Run ``PYTHONPATH=tests/benchmarks pytest -n 0 -s tests/benchmarks/test_modes.py`` from the top of
the repository. Process time of one thread, best of several; nothing is asserted of it, for machines
differ.
"""

from __future__ import annotations

import timing  # isort: skip  # before numpy, for it limits the threads

import time
import warnings

import numpy as np
import pytest

import bridgectl as bc
from bridgectl._threads import on_one_thread

SPEEDS = np.linspace(50, 150, 21) / 3.6


@on_one_thread
def cost(call, repeats=4):
    """Best process time of some calls, after one that warms up [ms]."""
    return 1e3 * timing.timed(call, repeats, clock=time.process_time, warm=True)


def told(what, part, whole):
    print(f"\n{what}: {part:.1f} ms, {part / whole:.2f} times {whole:.1f} ms", end="")


@pytest.fixture(scope="module")
def beams():
    """Of 3 modes and of 20."""
    return bc.li2006.beam(), bc.li2006.beam(n_modes=20)


@pytest.fixture(scope="module")
def car():
    return bc.li2006.car()


@pytest.fixture(scope="module")
def roads():
    measured = bc.utia_road().place_bridge(678).crop(-100, 25).detrend().resample(0.1)
    return {"smooth": (None, 0.0), "measured": (measured, -100.0)}


@pytest.mark.parametrize("road", ["smooth", "measured"])
@pytest.mark.parametrize("speeds", [25.0, SPEEDS], ids=["one speed", "21 speeds"])
def test_dafs_of_20_modes_against_3(beams, car, roads, speeds, road):
    profile, start = roads[road]
    few, many = (cost(lambda b=b: bc.daf(b, car, speeds, profile, start=start)) for b in beams)
    told(f"daf, {np.size(speeds)} speeds, {road} road, 20 modes against 3", many, few)


def test_surfaces_of_20_modes_against_3(beams, car):
    few, many = (cost(lambda b=b: bc.ramp_surface(b, car, SPEEDS)) for b in beams)
    told("ramp_surface, 21 speeds x 250 ramps, 20 modes against 3", many, few)


@pytest.mark.parametrize("trucks", [1, 2])
def test_flights_against_crossings_that_stay_down(beams, car, trucks):
    vehicle = bc.convoy([car] * trucks, [0.0, 4.0][:trucks])
    roads = [bc.RoadProfile([-20, -6, -5, -4.9, 40], [0, 0, h, 0, 0]) for h in (0.01, 0.09)]
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", bc.LiftOffWarning)
        down, up = (cost(lambda r=r: bc.daf(beams[0], vehicle, 10.0, r, start=-20)) for r in roads)
    told(f"lift-off, {trucks} trucks", up, down)


@pytest.mark.filterwarnings("ignore:start = -100 m is not forgotten")
def test_many_speeds_of_a_five_axle_truck_against_one_by_one(beams):
    truck, road = five_axles(), bc.iso8608_profile("A", 140, seed=1, start=-100)
    calm = bc.RoadProfile(road.x, 0.4 * road.elevation)  # the light axles stay down
    at_once = cost(lambda: bc.daf(beams[0], truck, SPEEDS, calm, start=-100), 2)
    single = cost(lambda: [bc.daf(beams[0], truck, c, calm, start=-100) for c in SPEEDS], 2)
    told("five-axle truck, 21 speeds at once against one by one", at_once, single)


def test_the_paper_surface_against_the_bare_product(beams, car):
    speeds = np.arange(50, 151) / 3.6
    surface = bc.ramp_surface(beams[0], car, speeds, recovery="li2006")
    rng = np.random.default_rng(0)
    n_samples, n_states = surface.histories.smooth.shape[1], surface.histories.entry.shape[1]
    rows, states = rng.normal(size=(n_samples, n_states)), rng.normal(size=(n_states, 250))
    bare = cost(lambda: [(rows @ states).max(axis=0) for _ in speeds])
    made = cost(lambda: bc.ramp_surface(beams[0], car, speeds, recovery="li2006"))
    told("paper surface against the bare product and maximum", made, bare)


def five_axles():
    """A tractor of two axles and a semi-trailer of three, hinged (VBI-2D, vehicle 2)."""
    suspensions = [6e6, 6e6, 10e6, 10e6, 10e6], [10e3, 10e3, 20e3, 20e3, 20e3]
    # Travel of each suspension by heave and pitch of the tractor and pitch of the trailer, whose
    # hinge is 3 m behind the tractor's center and 5 m ahead of its own.
    arms = np.array([[1, -1, 0], [1, 3.5, 0], [1, 3, 7], [1, 3, 8.2], [1, 3, 9.4]])
    legs = np.hstack([arms, -np.eye(5)])
    bodies = np.array([[1, 0, 0], [1, 3, 5]])  # heave of each body's center
    mass = bodies.T @ np.diag([3100, 20000]) @ bodies + np.diag([0, 5000, 120000])
    whole = np.diag([0.0, 0.0, 0.0, 750, 750, 1100, 1100, 1100])
    whole[:3, :3] = mass
    stiffness, damping = (legs.T @ np.diag(of) @ legs for of in suspensions)
    return bc.Vehicle(
        whole, damping, stiffness, [1.75e6, 1.75e6, 3.5e6, 3.5e6, 3.5e6],
        [0, 4.5, 11, 12.2, 13.4], heave=[1, 0, 0, 1, 1, 1, 1, 1],
    )  # fmt: skip
