"""Time the paper's ramp surface against simulating each ramp with the control library.

Run ``python tests/benchmarks/surface.py [FIGURE.png]`` from the top of the repository. Everything
runs on one thread in one process; ratios are what to quote, machines differ.
"""

from __future__ import annotations

from timing import timed  # isort: skip  # before numpy, for it limits the threads

import resource
import sys
import warnings

import control
import matplotlib.pyplot as plt
import numpy as np

import bridgectl as bc
from bridgectl.road import iso8608_elevations

SPEEDS = np.arange(50, 151) / 3.6
SAMPLE = 20


def one_ramp(speed, place):
    """One ramp with `control.input_output_response` at rtol 1e-8, 1001 samples."""
    system = bc.crossing_system(bc.li2006.beam(), bc.li2006.car(), speed, recovery="li2006")
    x = np.linspace(0, 25, 1001)
    road = 1e-3 * np.clip((x - place) / 0.1, 0, 1)
    return control.input_output_response(
        system,
        x / speed,
        np.vstack([road, 0 * x]),
        0,
        solve_ivp_method="DOP853",
        solve_ivp_kwargs={"rtol": 1e-8, "atol": 1e-12},
    )


def bare_product(surface):
    """What no factored surface can do without: rows @ states of every ramp, and its maximum."""
    rng = np.random.default_rng(0)
    n_samples, n_states = surface.histories.smooth.shape[1], surface.histories.entry.shape[1]
    rows = rng.normal(size=(n_samples, n_states))
    states = rng.normal(size=(n_states, len(surface.positions)))
    return [(rows @ states).max(axis=0) for _ in surface.speeds]


def surfaces(beam, truck):
    """Times of ramp surfaces, against every ramp simulated and against the bare product."""
    times = {
        approach: timed(
            lambda a=approach: bc.ramp_surface(beam, truck, SPEEDS, approach=a, recovery="li2006")
        )
        for approach in (0.0, 200.0)
    }
    paper = times[0.0]
    yield "paper surface, 101 speeds x 250 ramps", paper, "itself", paper
    yield "with 200 m of approach, 2250 ramps", times[200.0], "the paper surface", paper
    surface = bc.ramp_surface(beam, truck, SPEEDS, recovery="li2006")
    yield "paper surface", paper, "bare product and maximum", timed(lambda: bare_product(surface))
    rng = np.random.default_rng(0)
    cases = list(zip(rng.choice(SPEEDS, SAMPLE), rng.uniform(0, 12.5, SAMPLE), strict=True))
    each = timed(lambda: [one_ramp(*case) for case in cases], 1) / SAMPLE
    every = each * len(SPEEDS) * 251
    yield "paper surface", paper, f"control library ({SAMPLE} ramps, extrapolated)", every


def roads(beam, truck):
    """Times of reading many roads from a surface."""
    surface = bc.ramp_surface(beam, truck, SPEEDS)
    many = iso8608_elevations(10_000, "A", 25, seed=0)
    weights, scales = surface.daf_difference.T.copy(), surface.ramps(many)
    product = timed(lambda: scales @ weights)
    yield "DAE of 10 000 roads", timed(lambda: surface.dae(many)), "one matrix product", product
    surface.superposed_daf(many[:1])
    superposed = timed(lambda: surface.superposed_daf(many[:1000]), 1)
    profiles = [bc.RoadProfile(surface.stations, z) for z in many[:5]]
    simulated = 200 * timed(lambda: [bc.daf(beam, truck, SPEEDS, p) for p in profiles], 1)
    yield "superposed DAF of 1000 roads", superposed, "simulating them (5, extrapolated)", simulated


def costs(truck):
    """Times of surfaces over speeds, ramps and modes: what is varied, how much, seconds."""
    for count in (26, 51, 101, 202, 404):
        speeds = np.linspace(50, 150, count) / 3.6
        yield "speeds", count, timed(lambda c=speeds: bc.ramp_surface(bc.li2006.beam(), truck, c))
    for approach in (0, 100, 200, 400, 800):
        surface = timed(
            lambda a=approach: bc.ramp_surface(bc.li2006.beam(), truck, SPEEDS[::4], approach=a)
        )
        yield "ramps", 250 + 10 * approach, surface
    for count in (1, 2, 3, 5, 8, 12, 20):
        beam = bc.li2006.beam(n_modes=count)
        yield "modes", count, timed(lambda b=beam: bc.ramp_surface(b, truck, SPEEDS[::20]), 1)


def draw(table, path):
    """Draw the costs over what is varied, each over its own least."""
    axes = plt.subplots(1, 3, figsize=(10, 3), layout="constrained")[1]
    for panel, name in zip(axes, ("speeds", "ramps", "modes"), strict=True):
        rows = np.array([(count, seconds) for what, count, seconds in table if what == name])
        panel.plot(*rows.T, "o-")
        panel.set(xlabel=f"number of {name}", ylabel="time [s]", ylim=(0, None), xlim=(0, None))
    plt.savefig(path, dpi=110)


def main():
    """Print times, ratios and peak memory; draw the costs into the file named, if any."""
    warnings.simplefilter("error")
    beam, truck = bc.li2006.beam(), bc.li2006.car()
    bc.ramp_surface(beam, truck, SPEEDS, recovery="li2006")
    peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024
    print(f"{'what':40} {'seconds':>8}  {'ratio':>9}  of")
    for part in (surfaces, roads):
        for what, seconds, baseline, other in part(beam, truck):
            print(f"{what:40} {seconds:8.3f}  {seconds / other:9.2g}  {baseline} ({other:.3g} s)")
    print(f"peak memory of the process after the paper surface: {peak:.0f} MB")
    table = list(costs(truck))
    for what, count, seconds in table:
        print(f"{count:6} {what}: {seconds:.3f} s")
    if len(sys.argv) > 1:
        draw(table, sys.argv[1])


if __name__ == "__main__":
    main()
