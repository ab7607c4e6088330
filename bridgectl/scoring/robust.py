"""What is left of a strategy's gain when something is wrong, and whether it then does harm.

Each strategy, made for one bridge and vehicle, crosses with each error over the same roads at the
same speeds, and so does the first one, which is what it is compared with.
"""

from __future__ import annotations

import hashlib
import json
import os
from collections.abc import Iterable, Mapping, Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from bridgectl import _checks as check
from bridgectl._checks import FloatArray
from bridgectl._parts import Kind, Part, Parts, check_resume
from bridgectl._plausible import judge_crossing, judge_range
from bridgectl._progress import shows
from bridgectl._workers import check_workers, keep_missing
from bridgectl.dampers.fitted import Dampers, Fitted
from bridgectl.dampers.loop.closed_loop import run_loop
from bridgectl.dampers.loop.loop import Loop
from bridgectl.dampers.loop.work import require_loop
from bridgectl.dampers.told import told_of
from bridgectl.measures.history import rms
from bridgectl.model.bridge import BridgeModel, described
from bridgectl.model.crossing import Crossing, make_crossing, require_factor
from bridgectl.model.effect import Effect
from bridgectl.model.quarter_car import QuarterCar
from bridgectl.model.vehicle import Vehicle
from bridgectl.road import RoadProfile
from bridgectl.scoring.changes import Robustness
from bridgectl.scoring.errors import Error, applies, errors_of, true_crossing, with_error
from bridgectl.scoring.study import Study, checked_devices, header, make_study, parameters

KIND = Kind("a robustness study", 1)
"""What files of studies in progress are called, and the version of their format."""


Classes = tuple[str, ...]


class Case(NamedTuple):
    """Dampers on the roads of some classes with an error: what one process does at once."""

    crossing: Crossing
    """With the true bridge and vehicle."""
    devices: Fitted
    classes: Classes


def robustness(
    dampers: Sequence[Dampers],
    beam: BridgeModel,
    vehicle: Vehicle | QuarterCar,
    roads: Sequence[RoadProfile],
    speeds: ArrayLike,
    *,
    errors: Iterable[str] | None = None,
    approach: float = 60.0,
    section: float = 0.5,
    recovery: str = "exact",
    effect: Effect | str = "moment",
    resume: str | os.PathLike[str] | None = None,
    workers: int | None = None,
    scheduler: str | None = None,
    progress: bool = True,
) -> Robustness:
    """Find out what strategies gain, or do harm, when something is wrong.

    Parameters
    ----------
    dampers : sequence of Damper or Strategy, or of lists or dicts of them
        The strategies, as of `bridgectl.score`: the first, best the vehicle's own passive damper,
        is what the others are compared with, on the same bridge with the same load.
    beam, vehicle
        The bridge and the vehicle that the strategies are made for.
    roads, speeds, approach, section, recovery, effect
        See `bridgectl.score`. Roads are put to ISO 8608 classes by their roughness.
    errors : iterable of str, optional
        What may be wrong, of 'bridge frequency', 'bridge damping', 'load', 'speed told',
        'position', 'position drift', 'lag', 'sample time', 'velocity noise', 'filter' and 'all at
        once'; by default all. `bridgectl.scoring.errors.ERRORS` has the sizes.
    resume, workers, scheduler, progress : optional
        See `bridgectl.score`.

    Returns
    -------
    Robustness

    Raises
    ------
    TypeError, ValueError
        If an argument is not what is described above: see `bridgectl.score`.
    OSError
        See `bridgectl.score`.

    Warns
    -----
    PlausibilityWarning, UserWarning
        See `bridgectl.score`.

    Notes
    -----
    Bridge frequency: that of the true bridge, by its flexural rigidity; its damping ratio: more
    than known; load: the true sprung mass (of a `QuarterCar`). Position, drift (a share of the way
    since the start), speed: as told, beside the truth. Noise is a share of the RMS suspension
    velocity with the first strategy on roads of the class. Filters (`bridgectl.dampers.Sensors`)
    have noise of 0.05 m/s^2 and 0.5 mm. All at once: 10 ms of lag, 2 ms samples, 5 % noise, and 10
    % of frequency and 1 m of position either way.

    Examples
    --------
    >>> import bridgectl as bc
    >>> from bridgectl.dampers import bridgehook, passive
    >>> beam, truck = bc.li2006.beam(9, n_modes=1), bc.li2006.car()
    >>> roads = [bc.iso8608_profile("B", 13, start=-4, seed=i) for i in range(4)]
    >>> found = bc.robustness([passive(7e3), bridgehook(beam, truck, 1e3, 30e3)], beam, truck,
    ...     roads, 25.0, approach=4, errors=["position"], workers=1)
    >>> found
    Robustness(1 strategy, 7 errors, 4 roads, 1 speed from 90 to 90 km/h)
    >>> found.change("bridgehook", "position +3 m").mean > found.change("bridgehook").mean
    True
    """
    check.flag("progress", progress)
    check_workers(workers, scheduler)
    check_resume(resume, "robust.jsonl")
    tried = errors_of(errors)
    crossing = make_crossing(beam, vehicle, effect, section, recovery)
    devices = checked_devices(dampers, vehicle)
    if len(devices) < 2:
        raise ValueError(
            "dampers must hold a strategy beside the first, which it is compared with: type "
            "[bridgectl.dampers.passive(7e3), bridgectl.dampers.skyhook(1e3, 30e3)]"
        )
    require_factor(crossing)
    study = make_study(crossing, roads, speeds, approach, 0.0)
    judge_crossing(crossing, study.speeds, *roads)
    judge_range(vehicle, *devices)
    tried = tuple(error for error in tried if applies(error, crossing))
    cases = _cases(study, devices, tried)
    tasks = {_key(study, case): case for case in cases.values() if case is not None}
    bare, every = devices[0].bare(crossing), [case.devices for case in tasks.values()]
    for time in {each.sample_time for each in every}:
        alike = [each for each in every if each.sample_time == time]
        require_loop(
            bare, alike, study.speeds, study.stations, len(roads), announced=not shows(progress)
        )
    done = _done(study, tasks, resume, workers, scheduler, progress)
    return _found(study, devices, roads, tried, {
        place: None if case is None else done[_key(study, case)]["daf"]
        for place, case in cases.items()
    })  # fmt: skip


Place = tuple[int, int, Classes]
"""Strategy and error, by number, and the classes of the roads."""


def _cases(
    study: Study, devices: Sequence[Fitted], errors: Sequence[Error]
) -> dict[Place, Case | None]:
    """What is to be done, by strategy, error and class; None where it cannot be done."""
    speed, found = float(study.speeds[0]), dict[Place, Case | None]()
    names = sorted(set(study.road_classes))
    each: list[Classes] = [(name,) for name in names]
    together: list[Classes] = [tuple(names)]
    noisy = any(error.noise for error in errors)
    moved = {of: _velocity(study, devices[0], of) for of in each} if noisy else {}
    for j, error in enumerate(errors):
        crossing = true_crossing(study.crossing, error)
        for classes in each if error.noise else together:
            own = error
            if error.noise:  # a share of what the roads of a class make
                noise = {"velocity_noise": error.noise * moved[classes]}
                own = error._replace(damper={**error.damper, **noise})
            for i, device in enumerate(devices):
                fitted = with_error(device, own, study.crossing, speed)
                case = None if fitted is None else Case(crossing, fitted, classes)
                found[i, j, classes] = case
    return found


def _velocity(study: Study, device: Fitted, classes: Classes) -> float:
    """RMS suspension velocity [m/s] with a damper on roads of classes, over legs and speeds."""
    bare, name = device.bare(study.crossing), "suspension_velocity"
    roads = _of_classes(study, classes)
    found = Loop(bare, device, np.sort(study.speeds), study.stations, roads, (name,)).run()
    return float(rms(np.array([rms(each[name]).ravel() for each in found.histories]).ravel()))


def _of_classes(study: Study, classes: Classes) -> FloatArray:
    return study.elevations[np.isin(study.road_classes, classes)]


def _key(study: Study, case: Case) -> tuple[str, str]:
    """Name of a part, and what tells it from others: bridge, vehicle, dampers and roads."""
    crossing = case.crossing
    told = [described(crossing.beam), parameters(crossing.vehicle)]
    text = json.dumps([told, told_of(case.devices, study.speeds)])
    whole = hashlib.sha256(text.encode())
    whole.update(np.ascontiguousarray(_of_classes(study, case.classes)).tobytes())
    name = f"{case.devices.name}, class {' and '.join(case.classes)}"
    return name, whole.hexdigest()[:16]


def _done(
    study: Study,
    tasks: Mapping[tuple[str, str], Case],
    resume: str | os.PathLike[str] | None,
    workers: int | None,
    scheduler: str | None,
    progress: bool,
) -> dict[tuple[str, str], Part]:
    """Do what the file has not, which is the same for all strategies to which an error is none."""
    roads = {of: _of_classes(study, of) for of in {case.classes for case in tasks.values()}}
    jobs = {
        task: (case, study.speeds, study.stations, roads[case.classes])
        for task, case in tasks.items()
    }
    shapes = {task: {"daf": (len(job[-1]), len(study.speeds))} for task, job in jobs.items()}
    with Parts(resume, header(study), shapes, KIND) as parts:
        keep_missing(
            parts, _part, jobs, "Trying errors", "cases", workers, scheduler, progress=progress
        )
        return {task: parts[task] for task in tasks}


def _part(case: Case, speeds: FloatArray, stations: FloatArray, elevations: FloatArray) -> Part:
    """DAFs of a case, (roads, speeds)."""
    crossing = case.devices.bare(case.crossing)
    return {"daf": run_loop(crossing, case.devices, speeds, stations, elevations).daf.T}


def _found(
    study: Study,
    devices: Sequence[Fitted],
    roads: Sequence[RoadProfile],
    errors: tuple[Error, ...],
    dafs: Mapping[Place, FloatArray | None],
) -> Robustness:
    """Put the parts together."""
    whole = np.full((len(devices), len(errors), *study.elevations.shape[:1], study.speeds.size),
                    np.nan)  # fmt: skip
    for (i, j, classes), daf in dafs.items():
        if daf is not None:
            whole[i, j, np.isin(study.road_classes, classes)] = daf
    return Robustness(
        devices[0].name, tuple(device.name for device in devices[1:]), errors,
        tuple(road.name or f"road {i}" for i, road in enumerate(roads, 1)), study.road_classes,
        study.speeds, whole[0], whole[1:], study.beam, study.vehicle, study.approach,
    )  # fmt: skip
