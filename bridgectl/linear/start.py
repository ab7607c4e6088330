"""Where a crossing starts: checked, and judged by how much of the start is left at the bridge."""

from __future__ import annotations

import numpy as np
from scipy.linalg import expm

from bridgectl._checks import FloatArray
from bridgectl._places import SAME_PLACE
from bridgectl._plausible import PlausibilityWarning
from bridgectl._warn import asker, warn
from bridgectl.linear.runs import Run, moving, prepare, require_beyond
from bridgectl.model.crossing import Crossing
from bridgectl.model.motion import Motion
from bridgectl.model.vehicle import Vehicle
from bridgectl.road import RoadProfile

LEFT = 0.01
"""Share of a static tire force that what is left of the start may change it by at the bridge."""

UNDAMPED = 1e-6
"""Slowest decay [1/s] below which there is none but for round-off."""


def begin(
    crossing: Crossing,
    profile: RoadProfile | None,
    start: float,
    speeds: float | FloatArray,
    motion: Motion | None = None,
) -> Run:
    """Check a crossing, see `prepare`, and judge its start."""
    run = prepare(crossing, profile, start)
    require_beyond(run)
    if motion is not None:
        run = moving(run, motion)
    require_contact(run)
    if asker(depth=2) != "package":  # this function and the public one
        doubt = start_doubt(run, float(np.max(speeds)))
        if doubt is not None:
            warn(doubt, PlausibilityWarning)
    return run


def require_contact(run: Run) -> None:
    """Refuse a start at which a tire would hang above the road."""
    x = np.array([run.start])
    forces = run.forces(x, run.initial()[np.newaxis, : run.crossing.n_vehicle], np.zeros(1))[0]
    if forces.min() < 0:
        raise ValueError(
            f"start must be where all tires stand on the road, and at {run.start:g} m tire "
            f"{1 + int(np.argmin(forces))} would hang above it: type another start, or "
            f"profile.crop({run.start:g}, ...) for a level road under all axles there"
        )


def start_doubt(run: Run, fastest: float) -> str | None:
    """Say so if another road under the rear axles at the start would be felt at the bridge.

    That tells whether what is not known counts, for the vehicle stands still there and has come
    along in truth: a level road instead of a known one, the mirror image ahead of an unknown one.
    """
    vehicle, way, paths = run.crossing.linear, -run.start, run.crossing.paths
    if run.profile is None or way == 0 or vehicle.n_tires == 1:
        return None
    tires = run.crossing.tire_positions(run.start)
    fronts = tires + paths.signs * paths.offsets
    ahead, level = (run.profile.drop(x, run.datum) for x in (2 * fronts - tires, fronts))
    at, signs = run.profile.x, paths.signs
    known = signs * tires >= np.where(signs > 0, at[0], -at[-1]) - SAME_PLACE
    other = np.where(known, level, ahead)
    changes = vehicle.tire_stiffnesses * (other - run.road(np.array(run.start)))
    matrix = vehicle.state_matrix_on_tires()
    state = vehicle.flexibility @ (vehicle.tire_map.T @ changes)
    left = _swing(vehicle, expm(matrix * (way / fastest)) @ state)
    if left <= LEFT:
        return None
    slowest = -float(np.linalg.eigvals(matrix).real.max())
    remedy = "nothing ends it without damping"
    if slowest > UNDAMPED:
        # As if all of it were in the slowest motion, and no less than from here on.
        logs = np.log([_swing(vehicle, state) / LEFT, left / LEFT])
        enough = np.ceil((logs * fastest / slowest + [0.0, way]).max())
        remedy = f"type start=-{enough:g} for less than {LEFT:.0%}"
    return (
        f"start = {run.start:g} m is not forgotten at the bridge: with another road under the rear "
        f"axles there a tire force would differ by {left:.0%} of the static one; {remedy}"
    )


def _swing(vehicle: Vehicle, state: FloatArray) -> float:
    """Largest change of a tire force in a state of the vehicle, over its static load."""
    swings = vehicle.tire_stiffnesses * (vehicle.hubs @ state) / vehicle.static_loads
    return float(np.abs(swings).max())
