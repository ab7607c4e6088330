"""`bridgectl.assess`: what a fleet of random trucks does to a bridge."""

from __future__ import annotations

import os
from collections.abc import Mapping, Sequence
from contextlib import closing
from typing import Any

import numpy as np

from bridgectl import _checks as check
from bridgectl._parts import Kind, Parts
from bridgectl._plausible import judge_crossing, judge_range
from bridgectl._progress import shows, track
from bridgectl._warn import warn
from bridgectl._work import Work, at_most, require_feasible
from bridgectl._workers import in_processes
from bridgectl.dampers.fitted import Dampers, fitted
from bridgectl.fleet.assessment import Assessment
from bridgectl.fleet.fleet import Fleet
from bridgectl.fleet.gathered import Gathered
from bridgectl.fleet.share import shapes, simulate_share
from bridgectl.fleet.study import DamperOf, Roads, Study, checked_roads, checked_share
from bridgectl.linear.lift_off import LiftOffWarning
from bridgectl.model.bridge import BridgeModel
from bridgectl.model.crossing import make_crossing, require_factor
from bridgectl.model.effect import Effect

SECONDS, DAMPED_SECONDS = 2e-3, 1.0
"""Time of a crossing on one core [s], passive and with semi-active dampers."""

FILE = Kind("an assessment", 1)
"""What files of an assessment in progress are of."""


def assess(
    bridge: BridgeModel,
    fleet: Fleet,
    roads: Roads,
    *,
    effects: Effect | str | Sequence[Effect | str] | Mapping[str, Effect | str] = "moment",
    n: int | None = None,
    approach: float = 100.0,
    damper: Dampers | DamperOf | None = None,
    damper_share: float = 1.0,
    meeting_rate: float = 0.0,
    lane_factor: float = 1.0,
    trucks_a_day: float | None = None,
    seed: int = 0,
    resume: str | os.PathLike[str] | None = None,
    workers: int | None = None,
    scheduler: str | None = None,
    progress: bool = True,
) -> Assessment:
    """Let trucks of a fleet cross a bridge, each at its speed on one of the roads.

    Parameters
    ----------
    bridge : Beam, Bridge or ModalBridge
        The bridge.
    fleet : Fleet
        Trucks 0 to n - 1 of it cross.
    roads : RoadProfile, or list of them, or mapping of str to these
        Roads that cover approach and bridge, of which each crossing takes one at random; None is a
        smooth one. With names, of road qualities, each truck crosses once on a road of each.
    effects : Effect or str, or mapping of str to these, optional
        Load effects with a static peak, and their names: see `bridgectl.daf`.
    n : int, optional
        Number of crossings. Default: the trucks of a table.
    approach : float, optional
        Road before the bridge that is driven [m]; trucks start at rest.
    damper : Damper, Strategy, list or dict of them, or function, optional
        Semi-active dampers: see `bridgectl.crossing_response`. A function of bridge and truck
        makes them for each truck. They do not go with meetings.
    damper_share : float, optional
        Share of trucks that cross with them, too; such a crossing takes about a second.
    meeting_rate : float, optional
        Trucks [1/h] that come from the other end, at random times and of the same fleet. Roads must
        then reach as far behind the bridge as before it. One meets each truck at most.
    lane_factor : float, optional
        Share, up to 1, of what the other lane's trucks do: see `bridgectl.convoy`.
    trucks_a_day : float, optional
        Number of crossings a day, for characteristic values. Default: those of the fleet's table,
        if it has times.
    seed : int, optional
        Of what is drawn: roads, meetings, and who has dampers.
    resume : path-like, optional
        A file that keeps each share of the work when it is done, and which the same study goes on
        from, with more trucks, too: see `bridgectl.score`.
    workers : int, optional
        Processes at work. Default: as many as there are cores.
    scheduler : str, optional
        Address of a Dask scheduler, 'local' for one of this machine: see `bridgectl.score`.
    progress : bool, optional
        Whether to show a progress bar on a terminal.

    Returns
    -------
    Assessment

    Raises
    ------
    TypeError, ValueError
        If an argument is not what is described above, or a truck cannot be simulated; with
        `resume` what was done is kept.
    OSError
        If the file cannot be written, or the scheduler does not answer.

    Warns
    -----
    LiftOffWarning
        If tires leave the road.
    PlausibilityWarning
        If the first truck, its speed, bridge, roads or dampers can hardly be meant.
    UserWarning
        As `bridgectl.score`.

    Examples
    --------
    >>> import bridgectl as bc
    >>> fleet = bc.Fleet({"T2A01": 1}, speed={"min": 15, "max": 25}, load={"min": 0.5, "max": 1})
    >>> roads = [bc.iso8608_profile("A", 125, seed=k, start=-100) for k in range(5)]
    >>> found = bc.assess(bc.li2006.beam(), fleet, roads, n=20, workers=1)
    >>> len(found.columns["daf moment"])
    20
    """
    study, names = _study(
        bridge, fleet, roads, effects, approach, damper, damper_share, meeting_rate, lane_factor,
        seed,
    )  # fmt: skip
    count = _count(fleet, n)
    per_day = fleet.per_day if trucks_a_day is None else check.positive(
        "trucks_a_day", trucks_a_day
    )  # fmt: skip
    check.flag("progress", progress)
    _require_feasible(study, count, announced=False)
    shares = study.shares(count)
    expected = {_name(own): shapes(study, own) for own in shares}
    with Parts(resume, study.header(names), expected, FILE, in_memory=resume is None) as parts:
        todo = [own for own in shares if _name(own) not in parts]
        left = sum(map(len, todo))
        _require_feasible(study, left, announced=not shows(progress))
        jobs = ((study.share(own),) for own in todo)
        with closing(in_processes(simulate_share, jobs, workers, scheduler)) as found:
            for index, part in track(
                found, "Crossings", count, show=progress, before=count - left, unit="crossings",
                weight=lambda result: len(todo[result[0]]),
            ):  # fmt: skip
                parts.keep(*_name(todo[index]), part)
        return _assessment(study, names, shares, parts, per_day)


def _name(crossings: range) -> tuple[str, str]:
    """Name and key of a part: the study that it is of is in the file's first line."""
    return "crossings", f"{crossings.start} to {crossings.stop - 1}"


def _study(
    bridge: BridgeModel, fleet: Fleet, roads: Roads, effects: Any, approach: float,
    damper: Dampers | DamperOf | None, damper_share: float, meeting_rate: float, lane_factor: float,
    seed: int,
) -> tuple[Study, list[str]]:  # fmt: skip
    """Check what is asked for; return it with the names of the effects."""
    if not isinstance(fleet, Fleet):
        raise TypeError(
            f"fleet must be a bridgectl.Fleet, got {type(fleet).__name__}: type for example "
            'bridgectl.Fleet.load("monte_carlo")'
        )
    first = fleet.passing(0)
    named = effects if isinstance(effects, Mapping) else _named(effects)
    crossings = {name: make_crossing(bridge, first.vehicle, each) for name, each in named.items()}
    if not crossings:
        raise ValueError("effects must be one effect or more, got none: type effects='moment'")
    for crossing in crossings.values():
        require_factor(crossing)
    before = check.not_negative("approach", approach, unit="m")
    rate = check.not_negative("meeting_rate", meeting_rate)
    share = checked_share("damper_share", damper_share)
    factor = checked_share("lane_factor", lane_factor)
    if rate and factor == 0:
        raise ValueError("lane_factor must be above 0 with meetings: type meeting_rate=0 for none")
    if damper is not None and rate:
        raise ValueError(
            "damper and meeting_rate exclude each other: dampers go with one truck on the bridge; "
            "type meeting_rate=0"
        )
    last = bridge.length + (before if rate else 0.0)
    known = checked_roads(roads, -before, last)
    every = [road for own in known.values() for road in own.values() if road is not None]
    judge_crossing(next(iter(crossings.values())), np.array([first.speed]), *every)
    own_effects = tuple(crossing.effect for crossing in crossings.values())
    study = Study(
        bridge, fleet, fleet.kinds, known, own_effects, before,
        check.integer("seed", seed, at_least=0), damper, share, rate, factor,
    )  # fmt: skip
    if damper is not None:
        judge_range(first.vehicle, fitted(study.damper_of(first.vehicle), first.vehicle))
    return study, list(crossings)


def _named(effects: Any) -> dict[str, Effect | str]:
    """Effects by names: what they are told by."""
    listed = effects if isinstance(effects, list | tuple) else [effects]
    names = [each if isinstance(each, str) else repr(each) for each in listed]
    if twice := [name for name in names if names.count(name) > 1]:
        raise ValueError(f"effects must differ, got {twice[0]} twice: leave one out")
    return dict(zip(names, listed, strict=True))


def _count(fleet: Fleet, n: int | None) -> int:
    """Number of crossings."""
    if n is None:
        if not fleet.is_finite:
            raise ValueError("n must be given for a fleet without end: type n=1000")
        return len(fleet)
    count = check.integer("n", n, at_least=1)
    if fleet.is_finite and count > len(fleet):
        raise ValueError(f"n must be at most {len(fleet)}, the trucks of the fleet, got {n}")
    return count


def _require_feasible(study: Study, n: int, *, announced: bool) -> None:
    """Refuse more crossings than can be made and kept."""
    rows, effects = len(study.roads) + (study.damper is not None), len(study.effects)

    def work(**given: float) -> Work:
        damped = study.damper_share * DAMPED_SECONDS * (study.damper is not None)
        return Work(
            16 * given["n"] * rows * (10 + 5 * effects),
            given["n"] * len(study.roads) * effects * (SECONDS + damped),
        )

    require_feasible(work, {"n": at_most(n, 1000)}, announced=announced)


def _assessment(
    study: Study, names: Sequence[str], shares: Sequence[range], parts: Parts,
    per_day: float | None,
) -> Assessment:  # fmt: skip
    """Put the shares together, in order; tell of tires that leave the road."""
    rows = Gathered(study, names, shares[-1].stop)
    for own in shares:
        rows.take(own, parts[_name(own)])
    if flights := rows.flights:
        warn(
            f"a tire leaves the road in {flights} of {len(rows)} crossings: simulated there "
            "with R >= 0",
            LiftOffWarning,
        )
    units = {name: effect.unit for name, effect in zip(names, study.effects, strict=True)}
    known = None if per_day is None or np.isnan(per_day) else per_day
    return Assessment(rows.columns, units, repr(study.bridge), known)
