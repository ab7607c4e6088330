"""Estimates of the work of linear crossings: see `bridgectl._work`."""

from __future__ import annotations

import numpy as np

from bridgectl._checks import FloatArray
from bridgectl._work import Given, Work, at_least, at_most, require_feasible
from bridgectl.linear.cells import N_STAGES, SAMPLES
from bridgectl.linear.nodes import cell_width, fastest_motion
from bridgectl.linear.runs import BATCH_BYTES, Run
from bridgectl.model.crossing import Crossing

# Measured on one core of 2020, of crossings of 10 states:
CELL_SECONDS, RAMP_CELL_SECONDS = 4e-6, 6e-6
"""Time of a cell on the bridge at one speed; with the histories of ramps."""

APPROACH_SECONDS, RAMP_SECONDS, STEP_SECONDS = 1e-6, 2.5e-6, 1e-5
"""Time of a cell on the approach and of a ramp at one speed, and of a cell of a batch of speeds."""

REFERENCE_SECONDS = 0.3
"""Time of one ramp's simulation by the control library."""

TEMPORARY = 2.5
"""How much more memory it takes to make the maps of cells than to keep them."""


def require_crossing(run: Run, speeds: FloatArray, *, tail: float = 0.0, refine: int = 1) -> None:
    """Refuse a crossing that is too much work: of `daf` and `crossing_response`."""
    crossing = run.crossing
    stations = 0 if run.profile is None else len(run.profile.x)
    arguments = _arguments(crossing, speeds) | {
        "start": at_most(run.start, -200.0, "m"),
        "tail": at_most(tail, 2.0, "s"),
        "profile": at_most(stations, 5000.0, what="a profile of {value} stations"),
    }

    def work(
        n_modes: float, speeds: float, slowest: float, vehicle: float, start: float, tail: float,
        profile: float,
    ) -> Work:  # fmt: skip
        width = _width(crossing, n_modes, slowest, vehicle) / refine
        bridge, all_of_it = crossing.exit + tail * slowest, crossing.exit + tail * slowest - start
        cells = max(all_of_it / width, profile)
        on_bridge = cells * bridge / all_of_it
        n = crossing.n_vehicle + 2 * n_modes
        maps = on_bridge * _map_bytes(crossing, n)
        at_once = np.clip(BATCH_BYTES / maps, 1, speeds)
        seconds = speeds * (
            on_bridge * CELL_SECONDS * (n / 10) ** 2 + (cells - on_bridge) * APPROACH_SECONDS
        )
        return Work(
            TEMPORARY * at_once * maps + 16 * at_once * cells * n,
            seconds + cells * STEP_SECONDS * speeds / at_once, cells,
        )  # fmt: skip

    require_feasible(work, arguments)


def require_surface(
    crossing: Crossing, speeds: FloatArray, approach: float, ramp_length: float, method: str
) -> None:
    """Refuse a ramp surface that is too much work."""
    arguments = _arguments(crossing, speeds) | {
        "approach": at_most(approach, 200.0, "m"),
        "ramp_length": at_least(ramp_length, 0.1, "m"),
    }

    def work(
        n_modes: float, speeds: float, slowest: float, vehicle: float, approach: float,
        ramp_length: float,
    ) -> Work:  # fmt: skip
        width = min(_width(crossing, n_modes, slowest, vehicle), ramp_length)
        on_bridge, n_ramps = crossing.exit / width, (approach + crossing.exit) / ramp_length
        n = crossing.n_vehicle + 2 * n_modes + crossing.linear.n_tires
        local = np.sqrt(on_bridge) * width / ramp_length + crossing.linear.n_tires + 1
        kept = 8 * speeds * (on_bridge * len(SAMPLES) * (n + local) + n_ramps * (n + 1))
        if method == "control":
            kept = 8 * speeds * on_bridge * len(SAMPLES) * n_ramps
            return Work(2 * kept, speeds * n_ramps * REFERENCE_SECONDS)
        seconds = on_bridge * RAMP_CELL_SECONDS * (n / 10) ** 2 + n_ramps * RAMP_SECONDS
        return Work(
            2 * kept + TEMPORARY * on_bridge * _map_bytes(crossing, n), speeds * seconds,
            (approach + crossing.exit) / width,
        )  # fmt: skip

    require_feasible(work, arguments, announced=method != "control")  # which has a progress bar


def what_counts(crossing: Crossing, speeds: FloatArray) -> dict[str, Given]:
    """What counts in every crossing."""
    return {
        "n_modes": at_most(crossing.beam.n_modes, 3),
        "speeds": at_most(speeds.size, 101, what="{value} speeds"),
        "slowest": at_least(float(speeds.min()), 5.0, "m/s", "a speed of {value}"),
    }


def _arguments(crossing: Crossing, speeds: FloatArray) -> dict[str, Given]:
    """What counts in every linear crossing."""
    return what_counts(crossing, speeds) | {
        "vehicle": at_most(
            fastest_motion(crossing), 500.0, "rad/s",
            "the vehicle's fastest motion of {value} (by its stiffnesses, damping and masses)",
        ),
    }  # fmt: skip


def _width(crossing: Crossing, n_modes: float, slowest: float, fastest: float) -> float:
    """Width of the cells [m] for any number of modes."""
    highest = float(crossing.beam.omega.max()) * (n_modes / crossing.beam.n_modes) ** 2
    return cell_width(fastest, highest, slowest)


def _map_bytes(crossing: Crossing, n_states: float) -> float:
    """Memory of the maps of a cell at one speed."""
    stages = 2 * N_STAGES * crossing.linear.n_tires
    return 8 * stages * (4 * n_states + stages)
