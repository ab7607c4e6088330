"""The score: what damper strategies do to a bridge, and to road, ride and suspension beside it.

Each strategy runs over the same roads at the same speeds, which gives the simulated DAF, and the
measures of tire force and ride: the verdict, which comes first. Then its own unit ramps give the
DAE of Eq. (15). Ramps down and up, of the height of the roads' classes, give the DAE of second
order, over each class and of each road.
"""

from __future__ import annotations

import os
from collections.abc import Callable, Mapping, Sequence
from functools import partial
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import ArrayLike

from bridgectl import _checks as check
from bridgectl._checks import FloatArray
from bridgectl._parts import Kind, Part, Parts, Shapes, check_resume
from bridgectl._plausible import judge_crossing, judge_range
from bridgectl._progress import shows
from bridgectl._threads import on_one_thread
from bridgectl._workers import check_workers, keep_missing
from bridgectl.dampers.fitted import Dampers, Fitted
from bridgectl.dampers.loop.damped import ramps_and_roads
from bridgectl.dampers.loop.work import require_loop
from bridgectl.model.bridge import BridgeModel
from bridgectl.model.crossing import make_crossing, require_factor
from bridgectl.model.effect import Effect
from bridgectl.model.quarter_car import QuarterCar
from bridgectl.model.vehicle import Vehicle
from bridgectl.road import RoadProfile
from bridgectl.scoring.board import Scoreboard
from bridgectl.scoring.classes import class_part, class_shapes, class_surface, n_class_ramps
from bridgectl.scoring.rows import MEASURES
from bridgectl.scoring.simulated import (
    BOUND,
    OPTIMUM,
    RECORDED,
    SIMULATED,
    Bounds,
    bounds_of,
    optimum_key,
    optimum_part,
    simulated,
)
from bridgectl.scoring.study import (
    ROADS_AT_ONCE,
    UNIT_RAMPS,
    Piece,
    Study,
    checked_devices,
    header,
    key,
    make_study,
    task_name,
)
from bridgectl.simulate import ramp_surface
from bridgectl.surface.compute import RAMP_HEIGHT, RAMP_LENGTH, RampGrid
from bridgectl.surface.histories import FeedbackHistories
from bridgectl.surface.surface import RampSurface

KIND = Kind("a score", 4)
"""What files of scores in progress are called, and the version of their format."""

UNIT = "unit ramps"
"""What a part has until the DAE is made of it."""

Tasks: TypeAlias = dict[tuple[str, str], tuple[Study, Fitted | Bounds, Piece]]


def score(
    dampers: Sequence[Dampers],
    beam: BridgeModel,
    vehicle: Vehicle | QuarterCar,
    roads: Sequence[RoadProfile],
    speeds: ArrayLike,
    *,
    approach: float = 60.0,
    departure: float = 0.0,
    section: float = 0.5,
    recovery: str = "exact",
    effect: Effect | str = "moment",
    clairvoyant: bool = False,
    dae: bool = True,
    on_simulated: Callable[[Scoreboard], object] | None = None,
    resume: str | os.PathLike[str] | None = None,
    workers: int | None = None,
    scheduler: str | None = None,
    progress: bool = True,
) -> Scoreboard:
    """Score damper strategies over roads and speeds, by simulation and by DAE.

    Parameters
    ----------
    dampers : sequence of Damper or Strategy, or of lists or dicts of them
        The strategies, each with a name of its own; the first is what others are compared with.
        A strategy alone gets the defaults of `bridgectl.dampers.Damper`; a list has one for each
        leg of the vehicle: see `bridgectl.crossing_response`.
    beam, section, recovery, effect
        See `bridgectl.daf`.
    vehicle : Vehicle or QuarterCar
        The vehicle; its dampers are replaced. Of several tires, and of the body above several legs,
        the worst counts: the largest load coefficient, acceleration and travel, the least force.
    roads : sequence of RoadProfile
        Roads that cover approach, bridge and departure; they count in straight pieces of 100 mm.
    speeds : float or array_like
        Speeds c [m/s].
    approach, departure : float, optional
        Road before and after the bridge [m] that is driven; the vehicle starts in equilibrium.
        Unit ramps lie on approach and bridge.
    clairvoyant : bool, optional
        Whether to find the optimum of each road and speed, too (`bridgectl.dampers.clairvoyant`,
        within the range of all strategies together), and how much of the gap to it each strategy
        closes: some seconds a crossing. With an approach of 0 the optimum is bounded, too
        (`bridgectl.dampers.damper_bound`).
    dae : bool, optional
        Whether to find the DAE, too, which takes two thirds of the time; without it, what the board
        has of DAE is NaN, and there are no surfaces.
    on_simulated : callable, optional
        Called with the board without DAE as soon as that is known, to show it while the rest is
        done.
    resume : path-like, optional
        A file that keeps each part of the work when it is done. Parts of the same study that it
        holds are not done again, and those of other strategies and roads stay in it. A last line
        that an interruption cut short is done again; so are lines that are damaged or edited,
        with a warning, and all other lines count. A file of another study, or by another version
        of bridgectl, is refused, as is one that another process adds to.
    workers : int, optional
        Processes at work. Default: as many as there are cores, or as `joblib.parallel_config` says,
        whose backends count, too.
    scheduler : str, optional
        Address of a Dask scheduler that has the workers, or "local" for `workers` processes of this
        machine under Dask; it needs ``pip install "bridgectl[dask]"``. A script then begins its
        work under ``if __name__ == "__main__":``.
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
        If the file cannot be written, as on a full disk; parts that it held are still there. If
        the scheduler does not answer, or workers die again and again; what is done is kept.
    ModuleNotFoundError
        If Dask is asked for and not installed.

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
    check.flag("clairvoyant", clairvoyant)
    check.flag("dae", dae)
    if not (on_simulated is None or callable(on_simulated)):
        raise TypeError(
            f"on_simulated must be a function of a scoreboard, got {on_simulated!r:.40}: type "
            "on_simulated=print"
        )
    check_workers(workers, scheduler)
    check_resume(resume, "score.jsonl")
    crossing = make_crossing(beam, vehicle, effect, section, recovery)
    devices = checked_devices(dampers, vehicle)
    require_factor(crossing)
    study = make_study(crossing, roads, speeds, approach, departure)
    judge_crossing(crossing, study.speeds, *roads)
    judge_range(vehicle, *devices)
    require_loop(
        devices[0].bare(crossing), devices, study.speeds, study.stations, len(roads),
        n_ramps=study.n_ramps + len(study.classes) * n_class_ramps(study.n_ramps),
        n_recorded=len(RECORDED), at_once=ROADS_AT_ONCE, announced=not shows(progress),
    )  # fmt: skip

    def tasks_of(pieces: Sequence[Piece]) -> Tasks:
        return {
            (task_name(device, piece, len(roads)), key(device, study, piece)):
            (study.share(piece), device, piece)
            for device in devices
            for piece in pieces
        }  # fmt: skip

    simulations, ramps = tasks_of(study.of_roads), tasks_of(study.of_ramps if dae else [])
    tasks = simulations | ramps
    shapes = {task: _shapes(study, piece) for task, (_, _, piece) in tasks.items()}
    bounds, optima = bounds_of(devices), []
    for i in range(len(roads) if clairvoyant else 0):
        own = study.of_road(i)
        optima.append((f"clairvoyant, road {i + 1}", optimum_key(own, bounds)))
        simulations[optima[-1]] = own, bounds, i
        shapes[optima[-1]] = dict.fromkeys(OPTIMUM, (1, len(study.speeds)))
    with Parts(resume, header(study), shapes, KIND) as parts:

        def board() -> Scoreboard:
            done = {
                (device.name, piece): parts[task]
                for task, (_, device, piece) in tasks.items()
                if isinstance(device, Fitted) and task in parts
            }
            return _scoreboard(study, devices, roads, done, [parts[task] for task in optima])

        work: dict[str, Any] = {"progress": progress, "finish": partial(_with_dae, study)}
        where = "parts", workers, scheduler
        keep_missing(parts, _part, simulations, "Scoring strategies", *where, **work)
        if on_simulated is not None:
            on_simulated(board())
        keep_missing(parts, _part, ramps, "Ramps of strategies", *where, **work)
        return board()


def _scoreboard(
    study: Study,
    devices: Sequence[Fitted],
    roads: Sequence[RoadProfile],
    done: Mapping[tuple[str, Piece], Part],
    of_roads: Sequence[Part],
) -> Scoreboard:
    """Put the parts together, by strategy and piece, as far as they are done."""
    names = tuple(device.name for device in devices)
    own = {
        key: np.array([
            np.concatenate([done[name, i][key] for i in study.of_roads]) for name in names
        ])
        for key in (*SIMULATED, "fourth_power_95")
    }  # fmt: skip
    ramps = [done.get((name, UNIT_RAMPS), {}) for name in names]
    for name, shape in _ramp_shapes(study).items():
        unknown = np.full(shape, np.nan)
        own[name] = np.array([part.get(name, unknown) for part in ramps])
    surfaces = {
        each: tuple(
            class_surface(study.crossing, name, study.speeds, study.positions, each,
                          done[name, each])
            for name in names
        )
        for each in study.classes
        if (names[0], each) in done
    }  # fmt: skip
    own["dae_2"] = _second_order(study, surfaces, own["dae"].shape)
    optimum = {
        name: np.concatenate([part[name] for part in of_roads]) for name in OPTIMUM if of_roads
    }
    if optimum:
        optimum[BOUND] = np.where(optimum[BOUND] == 0, np.nan, optimum[BOUND])
    return Scoreboard(
        names, tuple(np.nan if device.constant is None else device.constant for device in devices),
        tuple(road.name or f"road {i}" for i, road in enumerate(roads, 1)), study.speeds,
        {name: own[name] for name in MEASURES}, own["daf_smooth"], own["fourth_power_95"],
        study.beam, study.vehicle, study.approach,
        study.road_classes, surfaces, optimum, study.crossing.effect,
    )  # fmt: skip


def _second_order(
    study: Study, surfaces: Mapping[str, Sequence[RampSurface]], shape: tuple[int, ...]
) -> FloatArray:
    """DAE of second order by each road's own class; NaN where that has no surface."""
    found = np.full(shape, np.nan)
    for each, own in surfaces.items():
        index = np.flatnonzero(np.array(study.road_classes) == each)
        for i, surface in enumerate(own):
            found[i, index] = surface.dae(study.under_ramps[index], order=2)
    return found


def _part(study: Study, damper: Fitted | Bounds, piece: Piece) -> Part:
    """Score one strategy on the study's roads, arrays (roads, speeds) of measures, or its ramps.

    Of bounds: find the optimum on the study's only road.

    Of unit ramps there are the surface's DAFs, of which `_with_dae` makes the DAE of all roads.
    """
    if isinstance(damper, Bounds):
        return optimum_part(study, damper)
    if piece == UNIT_RAMPS:
        return _unit_ramps(study, damper)
    if isinstance(piece, str):
        return class_part(study.crossing, damper, study.speeds, study.approach, piece)
    run = ramps_and_roads(
        study.crossing, damper, study.speeds, study.stations, np.arange(0), np.zeros(0),
        study.elevations, RECORDED,
    )  # fmt: skip
    return simulated(study, damper, run)


def _unit_ramps(study: Study, damper: Fitted) -> Part:
    """DAF of the smooth road and of unit ramps."""
    if damper.kept is None:
        run = ramps_and_roads(
            study.crossing, damper, study.speeds, study.stations, np.arange(study.n_ramps),
            np.full(study.n_ramps, RAMP_HEIGHT), study.elevations,
        )  # fmt: skip
        return {"daf_smooth": run.smooth, UNIT: run.unit}
    surface = ramp_surface(  # exact, and quick
        study.beam, study.vehicle, study.speeds, approach=study.approach,
        effect=study.crossing.effect, damper=damper,
    )  # fmt: skip
    return {"daf_smooth": surface.daf_smooth, UNIT: surface.daf_unit}


@on_one_thread  # sums over threads differ in the last digits
def _with_dae(study: Study, part: Part) -> Part:
    """Put the DAE of all roads in the place of the DAFs of unit ramps, if a part is of these."""
    if UNIT not in part:
        return part
    grid = RampGrid(study.approach, RAMP_LENGTH, RAMP_HEIGHT, study.n_ramps)
    surface = grid.surface(
        study.crossing, study.speeds, part["daf_smooth"], part[UNIT][np.newaxis],
        FeedbackHistories(""),
    )  # fmt: skip
    return {"dae": surface.dae(study.under_ramps), "daf_smooth": surface.daf_smooth}


def _shapes(study: Study, piece: Piece) -> Shapes:
    """Names and shapes of a part's arrays."""
    if piece == UNIT_RAMPS:
        return _ramp_shapes(study)
    if isinstance(piece, str):
        return class_shapes(len(study.speeds), study.n_ramps)
    own = len(study.share(piece).elevations)
    return {**dict.fromkeys(SIMULATED, (own, len(study.speeds))), "fourth_power_95": (own,)}


def _ramp_shapes(study: Study) -> dict[str, tuple[int, ...]]:
    """Names and shapes of what `_with_dae` makes of unit ramps."""
    n_speeds = len(study.speeds)
    return {"dae": (len(study.elevations), n_speeds), "daf_smooth": (n_speeds,)}
