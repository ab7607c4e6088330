"""What a simulation over roads gives of every measure, and of the optimum that a road allows."""

from __future__ import annotations

import dataclasses
import hashlib
import json
import warnings
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from bridgectl._parts import Part
from bridgectl.dampers.fitted import Fitted, fitted_everywhere
from bridgectl.dampers.loop.damped import RampsAndRoads, ramps_and_roads
from bridgectl.dampers.optimum.bound import MOST, damper_bound
from bridgectl.dampers.optimum.clairvoyant import STEP, clairvoyant
from bridgectl.measures import aggregate_fourth_power, dynamic_load_coefficient, weighted_rms
from bridgectl.measures.history import largest, rms
from bridgectl.measures.loads import CELL, road_stress_factor
from bridgectl.road import RoadProfile
from bridgectl.scoring.rows import MEASURES
from bridgectl.scoring.study import Study

RECORDED = ("tire_force", "body_acceleration", "suspension_travel")

SIMULATED = tuple(name for name in MEASURES if not name.startswith("dae"))


BOUND, BOUND_STEP = "daf_bound", 10e-3
"""The proven bound of the DAF, of dampings that are held so long [s]; 0 where there is none."""

OPTIMUM = (*SIMULATED, BOUND)


class Bounds(NamedTuple):
    """Dampings that the optimum is sought between [N s/m]."""

    c_min: float
    c_max: float


def bounds_of(devices: Sequence[Fitted]) -> Bounds:
    """Return the range of all strategies together, constant ones included."""
    laws = [damper.strategy for device in devices for damper in device.dampers]
    return Bounds(min(law.c_min for law in laws), max(law.c_max for law in laws))


def optimum_key(study: Study, bounds: Bounds) -> str:
    """Tell the optimum of a study of one road from others."""
    whole = hashlib.sha256(json.dumps([*bounds, STEP, BOUND_STEP]).encode())
    whole.update(np.ascontiguousarray(study.elevations).tobytes())
    return whole.hexdigest()[:16]


def optimum_part(study: Study, bounds: Bounds) -> Part:
    """`OPTIMUM` of the study's only road: arrays (1, n_speeds)."""
    road = RoadProfile(study.stations, study.elevations[0])
    # R >= 0 is simulated, and the roads tell of lift-off; a bound that says nothing is 0.
    with warnings.catch_warnings(action="ignore", category=UserWarning):
        proven = [_bound(study, bounds, speed, road) for speed in study.speeds.tolist()]
        found = clairvoyant(
            study.beam, study.vehicle, study.speeds, road, *bounds, start=-study.approach,
            effect=study.crossing.effect, workers=1, progress=False,
        )  # fmt: skip
    of_speeds = []
    for speed, best in zip(study.speeds, found[:, 0], strict=True):
        device = fitted_everywhere(best.damper, study.vehicle)
        own = dataclasses.replace(study, speeds=np.array([speed]))
        run = ramps_and_roads(
            study.crossing, device, own.speeds, study.stations, np.arange(0), np.zeros(0),
            study.elevations, RECORDED,
        )  # fmt: skip
        of_speeds.append(simulated(own, device, run))
    of_all = {name: np.hstack([each[name] for each in of_speeds]) for name in SIMULATED}
    return of_all | {BOUND: np.array([proven])}


def _bound(study: Study, bounds: Bounds, speed: float, road: RoadProfile) -> float:
    """Return the proven bound where control begins at the bridge, and it can be found."""
    time = (study.beam.length + study.vehicle.linear.tire_offsets.max()) / speed
    if study.approach > 0 or time / BOUND_STEP * len(study.vehicle.linear.damper_map) > MOST:
        return 0.0
    found = damper_bound(
        study.beam, study.vehicle, speed, road, *bounds, step=BOUND_STEP,
        effect=study.crossing.effect,
    )  # fmt: skip
    return found.bound if found.meaningful else 0.0


def simulated(study: Study, damper: Fitted, run: RampsAndRoads) -> Part:
    """Return every measure, of shape (n_roads, n_speeds), and the roads' fourth power."""
    found = run.roads
    return {
        "daf": found.daf.T,
        "least_force": found.least_force.T,
        "switching_rate": (found.switches / study.durations[:, np.newaxis]).T,
        **_measure(study, damper, run),
    }


def _measure(study: Study, damper: Fitted, run: RampsAndRoads) -> Part:
    """Measures of the histories: arrays (roads, speeds), and the roads' fourth power."""
    vehicle = study.vehicle.linear
    load, rows, fourth = vehicle.static_loads[:, np.newaxis], [], []
    for speed, history in zip(study.speeds, run.roads.histories, strict=True):
        # Of each tire or leg, (T or D, roads, samples).
        force, ride, travel = (
            each if each.ndim == 3 else each[np.newaxis] for each in (history[k] for k in RECORDED)
        )
        row = {
            "dynamic_load_coefficient": dynamic_load_coefficient(force, load),
            "tire_force_95": np.percentile(force, 95, axis=-1) / load,
            "road_stress": road_stress_factor(force, load),
            "body_acceleration": rms(ride),
            "weighted_acceleration": weighted_rms(ride, damper.sample_time),
            "suspension_travel": largest(travel),
        }
        rows.append({name: values.max(axis=0) for name, values in row.items()})
        x = study.stations[0] + speed * damper.sample_time * np.arange(force.shape[2])
        tires = x - vehicle.tire_offsets[:, np.newaxis]
        # Longer than a sample's way.
        cell = max(CELL, 2 * speed * damper.sample_time)
        fourth.append(
            [
                aggregate_fourth_power(each, load[:, 0], tires, cell).values
                for each in np.swapaxes(force, 0, 1)
            ]
        )
    shortest = min(len(road) for roads in fourth for road in roads)
    places = np.array([[road[:shortest] for road in roads] for roads in fourth]).mean(axis=0)
    return {
        **{name: np.array([row[name] for row in rows]).T for name in rows[0]},
        "fourth_power_95": np.percentile(places, 95, axis=-1),
    }
