"""Roads and cases that several tests share."""

from __future__ import annotations

import ctypes
import dataclasses
import importlib.util
import subprocess
from collections.abc import Callable
from itertools import pairwise
from pathlib import Path
from types import ModuleType

import control as ct
import numpy as np

import bridgectl as bc
from bridgectl.cli.main import main
from bridgectl.dampers import SIGNALS, Strategy
from bridgectl.dampers.actuator import bare_vehicle
from bridgectl.dampers.block import CROSSING_OUTPUTS


def rough_road(
    seed: int, start: float, stop: float, step: float = 0.1, height: float = 5e-4
) -> bc.RoadProfile:
    """A random road of ramps: heights in metres, normally distributed."""
    rng = np.random.default_rng(seed)
    x = start + step * np.arange(round((stop - start) / step) + 1)
    return bc.RoadProfile(x, np.cumsum(rng.normal(0.0, height, x.size)))


def module_of(path: Path) -> ModuleType:
    """A module of a file outside of the package and the tests."""
    spec = importlib.util.spec_from_file_location(path.stem, path)
    found = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(found)
    return found


def run_command(capsys, *arguments) -> tuple[int, str, str]:
    """Exit status of a `bridgectl` command, and what it prints and says."""
    status = main([str(argument) for argument in arguments])
    out, err = capsys.readouterr()
    return status, out, err


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


def without_dampers() -> bc.Vehicle:
    """The paper's truck with a passive damper in whose place none can be put."""
    truck = bc.li2006.car().linear
    return dataclasses.replace(
        truck, damper_map=np.zeros((0, 2)), damper_axles=None, damper_dampings=None,
        damper_names=None,
    )  # fmt: skip


NO_DAMPERS = "vehicle must have dampers that can be controlled: type damper_map"
"""What is told of it."""


def law_of_crossing(damper, beam, car, speed, road, leg=1):
    """The law at a speed and a leg, with the gains that are set for this crossing."""
    crossing = bc.Crossing(beam, bare_vehicle(car))
    own = damper.strategy.gains_for(crossing, np.array([speed]), road.x, road.elevation[np.newaxis])
    law = damper.strategy.for_leg(leg).for_speed(speed)
    return law.with_gains(**{name: float(value[0, 0]) for name, value in own.items()})


def loop_of_the_control_library(beam, car, damper, speed, road):
    """DAF by `control.input_output_response` from sample to sample, c held or lagging between.

    No integration step crosses a kink of the road or of the moment.
    """
    crossing = bc.Crossing(beam, dataclasses.replace(car, damping=0.0))

    def force(x, damping):
        return min(max(damping * (x[1] - x[3]), -damper.max_force), damper.max_force)

    loop = ct.nlsys(
        lambda t, x, u, p: crossing.dynamics(speed * t, x, u[:1], np.array([force(x, u[1])])), None,
        inputs=["road", "damping"], states=crossing.state_labels,
    )  # fmt: skip

    def outputs(t, states, drops, dampings):
        shapes = crossing.tire_shapes(speed * t)
        hubs = crossing.linear.hubs @ states[:4]
        deflections = (shapes[:, 0] * states[4::2].T).sum(axis=1)
        tires = np.maximum(crossing.tire_forces(hubs[0], deflections, drops), 0)
        forces = np.array([[force(x, c) for x, c in zip(states.T, dampings, strict=True)]])
        return crossing.outputs(speed * t, states, tires[np.newaxis], forces)

    law, start, end = law_of_crossing(damper, beam, car, speed, road), road.x[0], beam.length
    samples = start / speed + damper.sample_time * np.arange(2000)
    kinks = np.unique(np.concatenate([road.x, [0.0, end / 2, end]])) / speed
    state, damping, peak = np.zeros(len(crossing.state_labels)), 0.0, 0.0
    last_force = None
    for first, last in pairwise([*samples[samples < end / speed - 1e-9], end / speed]):
        r = road.drop(np.array([speed * first]), start)
        now = outputs(np.array([first]), state[:, np.newaxis], r, np.array([damping]))[:, 0]
        measured = {
            name: now[crossing.output_labels.index(label)]
            for name, label in CROSSING_OUTPUTS.items()
        }
        last_force = measured["tire_force"] if last_force is None else last_force
        rate = (measured["tire_force"] - last_force) / damper.sample_time
        last_force = measured["tire_force"]
        wanted = float(
            law.command(**measured, tire_force_rate=rate, position=speed * first, speed=speed)
        )
        if damper.lag == 0 or first == samples[0]:
            damping = wanted
        before, sampled = damping, first
        inside = kinks[(kinks > first + 1e-9) & (kinks < last - 1e-9)]
        for begin, stop in pairwise([first, *inside, last]):
            t = np.linspace(begin, stop, 11)
            r = road.drop(speed * t, start)
            c = wanted + (before - wanted) * np.exp(-(t - sampled) / (damper.lag or np.inf))
            response = ct.input_output_response(
                loop, t, np.vstack([r, c]), state, solve_ivp_method="DOP853",
                solve_ivp_kwargs={"rtol": 1e-7, "atol": 1e-10, "first_step": stop - begin},
            )  # fmt: skip
            if speed * stop > 1e-9:
                moment = outputs(t, response.states, r, c)[0]
                curve = np.polynomial.Polynomial.fit(t, moment, 8)
                peak = max(peak, moment.max(), curve(np.linspace(begin, stop, 200)).max())
            state, damping = response.states[:, -1], float(c[-1])
    return peak


def called_in_c(law: Strategy, folder: Path, *options: str) -> Callable[..., float]:
    """Compile the lines at the head of a law's C file to a function of all signals."""
    source, library = folder / "caller.c", folder / "caller.so"
    lines = law.to_c(folder / "law.c").read_text(encoding="utf-8").split("\n\n")[1]
    arguments = ", ".join(f"double {name}" for name in SIGNALS)
    source.write_text(f'#include "law.c"\ndouble once({arguments}) {{\n{lines}\nreturn c; }}\n')
    command = ["cc", "-O0", "-Wall", "-Wno-unused", "-Werror", "-shared", "-fPIC", *options]
    subprocess.run([*command, source, "-o", library, "-lm"], check=True)
    function = ctypes.CDLL(str(library)).once
    function.argtypes, function.restype = [ctypes.c_double] * len(SIGNALS), ctypes.c_double
    return function
