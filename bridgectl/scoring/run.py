"""The score: what damper strategies do to a bridge, and to road, ride and suspension beside it.

Each strategy runs over the same roads at the same speeds, next to its own unit ramps: one run gives
the DAE of Eq. (15), the simulated DAF, and the measures of tire force and ride. Ramps down and up,
of the height of the roads' classes, give the DAE of second order, over each class and of each road.
"""

from __future__ import annotations

import dataclasses
import hashlib
import json
import os
import signal
import sys
import threading
from collections.abc import Generator, Iterator, Mapping, Sequence
from contextlib import closing, contextmanager, suppress
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from bridgectl import _checks as check
from bridgectl import measures
from bridgectl._checks import FloatArray
from bridgectl._plausible import judge_crossing, judge_range
from bridgectl._progress import shows, track
from bridgectl._threads import on_one_thread
from bridgectl.dampers import Damper, Strategy
from bridgectl.dampers.actuator import as_damper, bare_vehicle
from bridgectl.dampers.loop.damped import RampsAndRoads, ramps_and_roads
from bridgectl.dampers.loop.work import require_loop
from bridgectl.linear.cells import SAME_PLACE
from bridgectl.measures.weighting import weighted_rms
from bridgectl.model.beam import Beam
from bridgectl.model.crossing import Crossing
from bridgectl.model.quarter_car import QuarterCar
from bridgectl.road import RoadProfile
from bridgectl.road.sampling import warn_if_coarse
from bridgectl.scoring.board import MEASURES, Scoreboard
from bridgectl.scoring.classes import (
    class_part,
    class_shapes,
    class_surface,
    classes_of,
    n_class_ramps,
    with_surface,
)
from bridgectl.scoring.file import Part, Parts, Shapes
from bridgectl.simulate import ramp_surface
from bridgectl.surface.compute import RAMP_HEIGHT, RAMP_LENGTH, RampGrid, count_ramps
from bridgectl.surface.histories import FeedbackHistories
from bridgectl.surface.surface import RampSurface

RECORDED = ("tire_force", "body_acceleration", "suspension_travel")

ROADS_AT_ONCE = 50
"""Roads of one part of the work: what an interruption may cost, and memory for histories."""

Piece = int | str
"""A part of the work: the first of some roads, or a road class."""

SIMULATED = tuple(name for name in MEASURES if not name.startswith("dae"))

CELL = 0.25
"""Length of the places whose aggregate fourth power is taken [m]; longer than a sample's way."""


@dataclass(frozen=True)
class _Study:
    """What all parts of the work share."""

    beam: Beam
    vehicle: QuarterCar
    speeds: FloatArray
    stations: FloatArray
    n_ramps: int
    elevations: FloatArray
    section: float
    recovery: str

    @property
    def crossing(self) -> Crossing:
        return Crossing(self.beam, self.vehicle, float(self.speeds[0]), self.section, self.recovery)

    @property
    def positions(self) -> FloatArray:
        """Starts of the unit ramps [m]."""
        return self.stations[: self.n_ramps]

    @property
    def under_ramps(self) -> FloatArray:
        """Elevations at the ends of the unit ramps [m], (n_roads, n_ramps + 1)."""
        return self.elevations[:, : self.n_ramps + 1]

    @cached_property
    def classes(self) -> tuple[str, ...]:
        """Road classes that have a surface."""
        return with_surface(classes_of(self.under_ramps), self.n_ramps)

    @property
    def pieces(self) -> list[Piece]:
        """What is done at once of each strategy."""
        return [*range(0, len(self.elevations), ROADS_AT_ONCE), *self.classes]


def score(
    dampers: Sequence[Damper | Strategy],
    beam: Beam,
    vehicle: QuarterCar,
    roads: Sequence[RoadProfile],
    speeds: ArrayLike,
    *,
    approach: float = 60.0,
    departure: float = 0.0,
    section: float = 0.5,
    recovery: str = "exact",
    resume: str | os.PathLike[str] | None = None,
    workers: int | None = None,
    progress: bool = True,
) -> Scoreboard:
    """Score damper strategies over roads and speeds, by simulation and by DAE.

    Parameters
    ----------
    dampers : sequence of Damper or Strategy
        The strategies, each with a name of its own; the first is what others are compared with.
        A strategy alone gets the defaults of `bridgectl.dampers.Damper`.
    beam, section, recovery
        See `bridgectl.Crossing`.
    vehicle : QuarterCar
        The vehicle; its damper is replaced.
    roads : sequence of RoadProfile
        Roads that cover approach, bridge and departure; they count in straight pieces of 100 mm.
    speeds : float or array_like
        Speeds c [m/s].
    approach, departure : float, optional
        Road before and after the bridge [m] that is driven; the vehicle starts in equilibrium.
        Unit ramps lie on approach and bridge.
    resume : path-like, optional
        A file that keeps each part of the work when it is done. Parts of the same study that it
        holds are not done again, and those of other strategies and roads stay in it. A last line
        that an interruption cut short is done again; so are lines that are damaged or edited,
        with a warning, and all other lines count. A file of another study, or by another version
        of bridgectl, is refused, as is one that another process adds to.
    workers : int, optional
        Processes at work. Default: as many as there are cores.
    progress : bool, optional
        Whether to show a progress bar on a terminal.

    Returns
    -------
    Scoreboard

    Raises
    ------
    TypeError, ValueError
        If an argument is not what is described above: no strategies, two of one name, a road that
        is too short or given twice, or a file of another study.
    OSError
        If the file cannot be written, as on a full disk; parts that it held are still there.

    Warns
    -----
    PlausibilityWarning
        If speeds, vehicle, roads or dampers can hardly be meant.
    UserWarning
        If lines of the file are damaged; if a road was measured at steps of more than one foot
        (see `RoadProfile.measured_step`); if it takes minutes and no progress bar shows.

    Examples
    --------
    >>> import bridgectl as bc
    >>> from bridgectl.dampers import passive, skyhook
    >>> board = bc.score(
    ...     [passive(7e3), skyhook(1e3, 30e3)], bc.li2006.beam(), bc.li2006.car(),
    ...     [bc.iso8608_profile("A", 35, seed=0, start=-10)], 25.0, approach=10, workers=1)
    >>> board.values["daf"].shape  # strategies, roads, speeds
    (2, 1, 1)
    >>> board.strategies
    ('passive 7 kN s/m', 'skyhook')
    """
    check.flag("progress", progress)
    if workers is not None:
        check.integer("workers", workers, at_least=1)
    if resume is not None and not isinstance(resume, str | os.PathLike):
        raise TypeError(
            f'resume must name a file, got {type(resume).__name__}: type resume="score.jsonl"'
        )
    devices = _devices(dampers)
    study = _study(beam, vehicle, roads, speeds, approach, departure, section, recovery)
    judge_crossing(study.crossing, study.speeds, *roads)
    judge_range(vehicle, *devices)
    bare = replace(study.crossing, vehicle=bare_vehicle(vehicle))
    require_loop(
        bare, devices, study.speeds, study.stations, len(roads),
        n_ramps=study.n_ramps + len(study.classes) * n_class_ramps(study.n_ramps),
        n_recorded=len(RECORDED), at_once=ROADS_AT_ONCE, announced=not shows(progress),
    )  # fmt: skip
    jobs = {
        (_task(device, piece, len(roads)), _key(device, study, piece)): (study, device, piece)
        for device in devices
        for piece in study.pieces
    }
    shapes = {task: _shapes(study, piece) for task, (_, _, piece) in jobs.items()}
    with Parts(resume, _header(study), shapes) as parts:
        todo = [task for task in jobs if task not in parts]
        workers = check.workers(workers, len(todo))
        with closing(_run([jobs[task] for task in todo], workers)) as found:
            for index, part in track(found, "Scoring strategies", len(todo), show=progress):
                parts.keep(*todo[index], part)
        done = {(job[1].strategy.name, job[2]): parts[task] for task, job in jobs.items()}
    return _scoreboard(study, devices, roads, done)


def _scoreboard(
    study: _Study,
    devices: Sequence[Damper],
    roads: Sequence[RoadProfile],
    done: Mapping[tuple[str, Piece], Part],
) -> Scoreboard:
    """Put the parts together, by strategy and piece."""
    names = tuple(device.strategy.name for device in devices)
    of_roads = [piece for piece in study.pieces if isinstance(piece, int)]
    own = {
        key: np.array([np.concatenate([done[name, i][key] for i in of_roads]) for name in names])
        for key in (*SIMULATED, "fourth_power_95")
    }
    own |= {key: np.array([done[name, 0][key] for name in names]) for key in ("dae", "daf_smooth")}
    surfaces = {
        each: tuple(
            class_surface(study.crossing, name, study.speeds, study.positions, each,
                          done[name, each])
            for name in names
        )
        for each in study.classes
    }  # fmt: skip
    of_road = classes_of(study.under_ramps)
    own["dae_2"] = _second_order(surfaces, of_road, study.under_ramps, own["dae"].shape)
    return Scoreboard(
        names, tuple(np.nan if device.constant is None else device.constant for device in devices),
        tuple(road.name or f"road {i}" for i, road in enumerate(roads, 1)), study.speeds,
        {name: own[name] for name in MEASURES}, own["daf_smooth"], own["fourth_power_95"],
        study.beam, study.vehicle, -float(study.stations[0]), of_road, surfaces,
    )  # fmt: skip


def _second_order(
    surfaces: Mapping[str, Sequence[RampSurface]],
    of_road: Sequence[str],
    elevations: FloatArray,
    shape: tuple[int, ...],
) -> FloatArray:
    """DAE of second order by each road's own class; NaN where that has no surface."""
    found = np.full(shape, np.nan)
    for each, own in surfaces.items():
        index = np.flatnonzero(np.array(of_road) == each)
        for i, surface in enumerate(own):
            found[i, index] = surface.dae(elevations[index], order=2)
    return found


def _task(device: Damper, piece: Piece, n_roads: int) -> str:
    """What a piece of the work is called."""
    what = f"class {piece}" if isinstance(piece, str) else (
        f"roads {piece + 1} to {min(piece + ROADS_AT_ONCE, n_roads)}"
    )  # fmt: skip
    return f"{device.strategy.name}, {what}"


def _listed(value: object) -> bool:
    return isinstance(value, Sequence) and not isinstance(value, str)


def _devices(dampers: Sequence[Damper | Strategy]) -> list[Damper]:
    """Check the strategies."""
    if isinstance(dampers, Damper | Strategy):
        raise TypeError("dampers must be a list of strategies, got one: type [damper]")
    if not _listed(dampers):
        raise TypeError(
            f"dampers must be a list of strategies, got {type(dampers).__name__}: type "
            "[bridgectl.dampers.passive(7e3), bridgectl.dampers.skyhook(1e3, 30e3)]"
        )
    devices = [as_damper(damper) for damper in dampers]
    if not devices:
        raise ValueError(
            "dampers must hold a strategy, got none: type [bridgectl.dampers.passive(7e3)]"
        )
    names = [device.strategy.name for device in devices]
    twice = next((name for name in names if names.count(name) > 1), None)
    if twice is not None:
        raise ValueError(
            f"dampers must have different names, got {twice!r} twice: type "
            f'strategy.renamed("{twice}, other")'
        )
    return devices


def _study(
    beam: Beam,
    vehicle: QuarterCar,
    roads: Sequence[RoadProfile],
    speeds: ArrayLike,
    approach: float,
    departure: float,
    section: float,
    recovery: str,
) -> _Study:
    """Check what all strategies share, and lay the roads over common stations."""
    before = check.not_negative("approach", approach, unit="m")
    after = check.not_negative("departure", departure, unit="m")
    bare_vehicle(vehicle)
    if not _listed(roads) or not all(isinstance(road, RoadProfile) for road in roads):
        raise TypeError(
            "roads must be a list of RoadProfile: type [road], or [bridgectl.read_profile(path)]"
        )
    if not len(roads):
        raise ValueError("roads must hold a road, got none: type [bridgectl.utia_road()]")
    c = check.speeds(speeds)
    study = _Study(beam, vehicle, c, np.zeros(0), 0, np.zeros(0), section, recovery)
    _ = study.crossing  # what is wrong with beam, section or recovery is told first
    n_ramps = count_ramps(before + beam.length)
    n_pieces = count_ramps(before + beam.length + after)
    stations = -before + RAMP_LENGTH * np.arange(n_pieces + 1)
    for i, road in enumerate(roads, 1):
        road.require(-before, beam.length + after, f"the crossing, of road {i},", "approach")
        warn_if_coarse(road, "dynamic amplification")
    elevations = np.array([np.interp(stations, road.x, road.elevation) for road in roads])
    elevations -= elevations[:, :1]
    _require_different(roads, elevations)
    return replace(study, stations=stations, n_ramps=n_ramps, elevations=elevations)


def _require_different(roads: Sequence[RoadProfile], elevations: FloatArray) -> None:
    """Refuse a road that is given twice: it would look like more evidence than there is."""
    first: dict[bytes, int] = {}
    for i, heights in enumerate(np.round(elevations / SAME_PLACE), 1):
        j = first.setdefault((heights + 0.0).tobytes(), i)  # not -0.0
        if j != i:
            raise ValueError(
                f"roads {j} ({roads[j - 1].name!r}) and {i} ({roads[i - 1].name!r}) are the same, "
                "and would count twice in confidence intervals: leave one out"
            )


def _run(
    jobs: Sequence[tuple[_Study, Damper, Piece]], workers: int
) -> Generator[tuple[int, Part], None, None]:
    """Do the jobs, as many at once as there are workers; yield what is done, with its index."""
    if workers == 1:
        for index, job in enumerate(jobs):
            yield index, _part(*job)
        return
    import joblib  # late, as it is slow to load

    parallel, found = joblib.Parallel(workers, return_as="generator_unordered"), None
    try:
        with _deaf_to_ctrl_c():
            found = parallel(joblib.delayed(_numbered)(i, *job) for i, job in enumerate(jobs))
        for each in found:  # noqa: UP028 - "yield from" would let joblib warn of being ended
            yield each
    finally:
        if found is not None:
            with suppress(KeyboardInterrupt):  # of which joblib says nothing, and ends the workers
                found.throw(KeyboardInterrupt)


@contextmanager
def _deaf_to_ctrl_c() -> Iterator[None]:
    """Start processes that Ctrl-C does not reach; here it is felt when all have started.

    It goes to all processes of a terminal. Workers would each tell of it, and those that are not
    yet known to the process that starts them would be left; as it is, that one ends them.
    """
    if sys.platform == "win32" or threading.current_thread() is not threading.main_thread():
        yield
        return
    from multiprocessing import resource_tracker

    from joblib.externals.loky.backend import resource_tracker as loky_tracker

    for tracker in (resource_tracker, loky_tracker):  # when they start, they unblock the signal
        tracker.ensure_running()
    heard: list[int] = []
    # Processes inherit what is blocked; of this one, other threads may still take the signal.
    handler = signal.signal(signal.SIGINT, lambda number, _: heard.append(number))
    blocked = signal.pthread_sigmask(signal.SIG_BLOCK, [signal.SIGINT])
    try:
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, blocked)
        signal.signal(signal.SIGINT, handler)
        for number in heard[:1]:
            signal.raise_signal(number)


def _numbered(index: int, *job: Any) -> tuple[int, Part]:
    return index, _part(*job)


@on_one_thread  # as in workers: sums over threads differ in the last digits
def _part(study: _Study, damper: Damper, piece: Piece) -> Part:
    """Score one strategy on a class, or on some roads: arrays (roads, speeds) of every measure."""
    if isinstance(piece, str):
        approach = -float(study.stations[0])
        return class_part(study.crossing, damper, study.speeds, approach, piece)
    elevations = study.elevations[piece : piece + ROADS_AT_ONCE]
    ramps = np.arange(study.n_ramps if piece == 0 and damper.kept is None else 0)
    run = ramps_and_roads(
        study.crossing, damper, study.speeds, study.stations, ramps,
        np.full(ramps.size, RAMP_HEIGHT), elevations, RECORDED,
    )  # fmt: skip
    found = run.roads
    duration = (study.stations[-1] - study.stations[0]) / study.speeds
    part = {
        "daf": found.daf.T,
        "least_force": found.least_force.T,
        "switching_rate": (found.switches / duration[:, np.newaxis]).T,
        **_measure(study, damper, run),
    }
    return part if piece else part | _first_order(study, damper, run)


def _first_order(study: _Study, damper: Damper, run: RampsAndRoads) -> Part:
    """DAE of all roads, which comes with the first of them, and DAF of the smooth one."""
    if damper.kept is None:
        grid = RampGrid(-float(study.stations[0]), RAMP_LENGTH, RAMP_HEIGHT, study.n_ramps)
        surface = grid.surface(
            study.crossing, study.speeds, run.smooth, run.unit[np.newaxis],
            FeedbackHistories(damper.strategy.name),
        )  # fmt: skip
    else:  # exact, and quick
        surface = ramp_surface(
            study.beam, study.vehicle, study.speeds, approach=-float(study.stations[0]),
            section=study.section, recovery=study.recovery, damper=damper,
        )  # fmt: skip
    return {"dae": surface.dae(study.under_ramps), "daf_smooth": surface.daf_smooth}


def _shapes(study: _Study, piece: Piece) -> Shapes:
    """Names and shapes of what `_part` returns."""
    n_roads, n_speeds = len(study.elevations), len(study.speeds)
    if isinstance(piece, str):
        return class_shapes(n_speeds, study.n_ramps)
    own = min(ROADS_AT_ONCE, n_roads - piece)
    shapes = {**dict.fromkeys(SIMULATED, (own, n_speeds)), "fourth_power_95": (own,)}
    return shapes if piece else shapes | {"dae": (n_roads, n_speeds), "daf_smooth": (n_speeds,)}


def _measure(study: _Study, damper: Damper, run: RampsAndRoads) -> Part:
    """Measures of the histories: arrays (roads, speeds), and the roads' fourth power."""
    load = study.vehicle.linear.static_loads[0]
    columns: dict[str, list[FloatArray]] = {
        "dynamic_load_coefficient": [], "tire_force_95": [], "road_stress": [],
        "body_acceleration": [], "weighted_acceleration": [], "suspension_travel": [],
    }  # fmt: skip
    fourth = []
    for speed, history in zip(study.speeds, run.roads.histories, strict=True):
        force, ride = history["tire_force"], history["body_acceleration"]
        columns["dynamic_load_coefficient"].append(measures.dynamic_load_coefficient(force, load))
        columns["tire_force_95"].append(np.percentile(force, 95, axis=-1) / load)
        columns["road_stress"].append(measures.road_stress_factor(force, load))
        columns["body_acceleration"].append(measures.rms(ride))
        columns["weighted_acceleration"].append(weighted_rms(ride, damper.sample_time))
        columns["suspension_travel"].append(measures.largest(history["suspension_travel"]))
        x = study.stations[0] + speed * damper.sample_time * np.arange(force.shape[1])
        cell = max(CELL, 2 * speed * damper.sample_time)
        fourth.append([measures.aggregate_fourth_power(f, load, x, cell).values for f in force])
    shortest = min(len(row) for rows in fourth for row in rows)
    places = np.array([[row[:shortest] for row in rows] for rows in fourth]).mean(axis=0)
    return {
        **{name: np.array(column).T for name, column in columns.items()},
        "fourth_power_95": np.percentile(places, 95, axis=-1),
    }


def _header(study: _Study) -> dict[str, Any]:
    """What two studies share if their parts fit together."""
    return {
        "beam": dataclasses.asdict(study.beam),
        "vehicle": dataclasses.asdict(study.vehicle),
        "speeds": study.speeds.tolist(),
        "stations": [study.stations[0], study.stations[-1], len(study.stations)],
        "section": study.section,
        "recovery": study.recovery,
    }


def _key(damper: Damper, study: _Study, piece: Piece) -> str:
    """Tell a damper, and the roads if the piece is of them, from others: their text, shortened."""
    ends = [damper.strategy.for_speed(float(c)) for c in study.speeds[[0, -1]]]
    text = json.dumps(
        [
            repr(damper.strategy),  # what a strategy chooses gains from is in no function
            [law.function.serialize() for law in ends],
            damper.strategy.gains,
            [damper.sample_time, damper.lag, damper.max_force, damper.velocity_noise, damper.seed],
        ]
    )
    whole = hashlib.sha256(text.encode())
    if not isinstance(piece, str):
        whole.update(np.ascontiguousarray(study.elevations).tobytes())
    return whole.hexdigest()[:16]
