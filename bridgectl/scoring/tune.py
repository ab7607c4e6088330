"""Tuning: gains of a strategy for the roads and speeds at hand, judged on roads held out."""

from __future__ import annotations

import time
import warnings
from collections.abc import Sequence
from dataclasses import replace
from functools import partial
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from bridgectl import _checks as check
from bridgectl._checks import FloatArray
from bridgectl._plausible import judge_crossing, judge_range
from bridgectl._workers import check_workers
from bridgectl.dampers.actuator import Damper, as_damper
from bridgectl.dampers.fitted import Fitted, fitted_everywhere
from bridgectl.dampers.preset import Preset
from bridgectl.dampers.program import Program
from bridgectl.dampers.strategy import Strategy
from bridgectl.linear.lift_off import LiftOffWarning
from bridgectl.model.bridge import BridgeModel
from bridgectl.model.crossing import Crossing, make_crossing, require_factor
from bridgectl.model.quarter_car import QuarterCar
from bridgectl.model.vehicle import Vehicle
from bridgectl.road import RoadProfile
from bridgectl.scoring.objective import Objective, all_roads, by_differences, class_ramps
from bridgectl.scoring.search import STEP, Scale, Search, by_generations, by_gradient
from bridgectl.scoring.study import Study, make_study
from bridgectl.scoring.tuning import CLASS_DAE, DAF, GENERATIONS, GRADIENT, Tuning


def tune(
    damper: Damper | Strategy,
    beam: BridgeModel,
    vehicle: Vehicle | QuarterCar,
    roads: Sequence[RoadProfile],
    speeds: ArrayLike,
    *,
    held_out: Sequence[RoadProfile] = (),
    gains: Sequence[str] | None = None,
    objective: str = DAF,
    softness: float | None = None,
    method: str | None = None,
    iterations: int = 30,
    approach: float = 60.0,
    section: float = 0.5,
    recovery: str = "exact",
    workers: int | None = None,
    progress: bool = True,
) -> Tuning:
    """Tune the gains of a damper strategy, or the dampings of a program, for a bridge.

    Parameters
    ----------
    damper : Damper or Strategy
        The damper of every leg, whose strategy has gains (`Strategy.bounds`), or is a
        `bridgectl.dampers.program` with bounds. The search starts at its gains.
    beam, section, recovery
        See `bridgectl.daf`.
    vehicle : Vehicle or QuarterCar
        The vehicle; its dampers are replaced.
    roads : sequence of RoadProfile
        Training roads, which cover approach and bridge: see `bridgectl.score`.
    speeds : float or array_like
        Speeds c [m/s].
    held_out : sequence of RoadProfile, optional
        Other roads, which the search does not see: they tell what the tuned gains are worth.
    gains : sequence of str, optional
        Names of the gains that vary. Default: all of them.
    objective : {'daf', 'class_dae'}, optional
        What is minimised: the mean simulated DAF of the training roads, or the second-order class
        DAE of their classes, in closed form: see `bridgectl.RampSurface.class_dae`.
    softness : float, optional
        With it the objective is a soft maximum over the speeds, s log(mean(exp(DAF / s))), in which
        DAFs count nearly alike that differ by less than this s [-], as 0.01. Default: the mean.
    method : {'generations', 'gradient'}, optional
        Differential evolution of many gains at once, or L-BFGS-B within the bounds. The gradient is
        exact for a program of 'lines' in a damper of the default kind, else by differences.
        Default: 'gradient' for programs, 'generations' for others, whose DAF is rough.
    iterations : int, optional
        Number of generations, or of gradients, at most.
    approach : float, optional
        Road before the bridge [m] that is driven; the vehicle starts in equilibrium.
    workers : int, optional
        Processes at work where one run would be large. Default: see `bridgectl.score`.
    progress : bool, optional
        Whether to show a progress bar on a terminal.

    Returns
    -------
    Tuning
        Of the best gains found, which are never worse than the first on the training roads. Ctrl-C
        ends the search, and the best so far is returned.

    Raises
    ------
    TypeError, ValueError
        If an argument is not what is described above: a strategy without gains, a road that is
        both a training road and held out.

    Warns
    -----
    PlausibilityWarning
        If speeds, vehicle, roads or damper can hardly be meant.
    UserWarning
        As `bridgectl.score`.

    Notes
    -----
    Few training roads are soon fitted. A program of 20 places, the paper's bridge and truck at 70,
    90 and 108 km/h, c from 1 to 30 kN s/m: changes of the mean DAF of so many roads of class A, and
    of 40 others (95 % within 0.007 for 12 and 25, 0.004 for 50, 0.003 for 100 and 200)::

        training roads      12       25       50       100      200
        of these         -0.0149  -0.0048  -0.0034  -0.0024  -0.0017
        held out         +0.0006  -0.0003  -0.0042  -0.0023  -0.0028
        seconds                9        8       10       11       12

    Examples
    --------
    >>> import bridgectl as bc
    >>> from bridgectl.dampers import program
    >>> roads = [bc.iso8608_profile("A", 27, seed=i, start=-2) for i in range(4)]
    >>> found = bc.tune(
    ...     program([-2, 4, 9], [7e3] * 3, shape="lines", bounds=(1e3, 30e3)), bc.li2006.beam(),
    ...     bc.li2006.car(), roads[:2], 30.0, held_out=roads[2:], approach=2, iterations=3)
    >>> found
    Tuning('program', 3 gains, DAF 1.1166 to 1.1117 on 2 training roads, 1.1155 to 1.1059 on 2 \
held out, approach of 2 m)
    >>> found.strategy.dampings.round(-3)
    array([ 2000.,  1000., 23000.])
    """
    check.flag("progress", progress)
    check.choice("objective", objective, (DAF, CLASS_DAE))
    check_workers(workers)
    soft = np.inf if softness is None else check.positive("softness", softness)
    steps = check.integer("iterations", iterations, at_least=1)
    device = as_damper(damper)
    crossing = make_crossing(beam, vehicle, "moment", section, recovery)
    require_factor(crossing)
    devices = fitted_everywhere(device, vehicle)
    names = _names(device.strategy, devices, gains)
    way = _method(method, device.strategy)
    training, others = _studies(crossing, roads, held_out, speeds, approach)
    classes = training.classes
    if objective == CLASS_DAE and not classes:
        raise ValueError(
            "objective 'class_dae' needs roads of a class whose unit ramp is no higher than long, "
            f"got class {' and '.join(sorted(set(training.road_classes)))}: type objective='daf'"
        )
    judge_crossing(crossing, training.speeds, *roads, *held_out)
    judge_range(vehicle, devices)
    driven = all_roads(training) if objective == DAF else class_ramps(training, classes)
    goal = Objective(crossing, devices, names, training.speeds, driven, soft, workers)
    first = device.strategy
    scale = Scale(
        np.array([first.gains[k] for k in names]), np.array([first.bounds[k][1:] for k in names])
    )
    search, began = Search(steps, progress), time.perf_counter()
    search.run(partial(_search, search, goal, scale, way, device))
    seconds = time.perf_counter() - began
    best = scale.gains(search.best)
    tuned = first.with_gains(**dict(zip(names, best.tolist(), strict=True)))
    ends = np.array([scale.start, best])
    judged = goal.dafs(ends, all_roads(training))
    fresh = judged[..., :0] if others is None else goal.dafs(ends, all_roads(others))
    return Tuning(
        tuned, names, scale.start, best, scale.bounds, objective, way, soft,
        np.array(search.history), training.speeds, judged, fresh,
        {name: _class_dae(goal, training, name, ends) for name in classes},
        seconds, search.interrupted, beam, vehicle, training.approach,
    )  # fmt: skip


def _class_dae(goal: Objective, study: Study, name: str, gains: FloatArray) -> FloatArray:
    """Class DAE for some values of gains, (n_values, n_speeds)."""
    ramps = class_ramps(study, [name])
    return goal.dafs(gains, ramps) @ ramps.weights


def _search(search: Search, goal: Objective, scale: Scale, way: str, device: Damper) -> None:
    start, ends = scale.scaled(scale.start), scale.ends

    def values(u: FloatArray) -> FloatArray:
        return goal.values(scale.gains(u))

    if way == GENERATIONS:
        by_generations(search, values, start, ends)
    else:
        exact = _has_adjoint(device, goal)

        def slopes(u: FloatArray) -> tuple[float, FloatArray]:
            found = _adjoint(goal, device.strategy, scale.gains(u)) if exact else None
            if found is None:
                return by_differences(values, u, ends, STEP)
            return found[0], found[1] * scale.slopes(u)

        by_gradient(search, slopes, start, ends)


def _has_adjoint(device: Damper, goal: Objective) -> bool:
    """Whether the damper is a program with an exact gradient."""
    law = device.strategy
    lines = isinstance(law, Program) and law.shape == "lines" and len(goal.names) == len(law.gains)
    return lines and device == replace(Damper(law), seed=device.seed)


def _adjoint(goal: Objective, law: Any, gains: FloatArray) -> tuple[float, FloatArray] | None:
    """Value and gradient; None where a tire leaves the road, which the adjoint does not see."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # all else that there is to say has been said before
        warnings.simplefilter("error", LiftOffWarning)
        try:
            return goal.by_adjoint(law, gains)
        except LiftOffWarning:
            return None


def _names(law: Strategy, devices: Fitted, gains: Sequence[str] | None) -> tuple[str, ...]:
    """Names of the gains that vary, the same at all legs."""
    if isinstance(law, Preset):
        raise ValueError(f"{law.name} chooses its gain before each crossing: there is no tuning it")
    if not law.gains:
        raise ValueError(
            f"{law.name} has no gains to tune: type for example bridgectl.dampers.hybrid(1e3, "
            "30e3), or program(positions, dampings, bounds=(1e3, 30e3))"
        )
    if isinstance(gains, str) or not (gains is None or isinstance(gains, Sequence)):
        raise TypeError(f"gains must be a list of names, got {gains!r}: type for example ['gain']")
    laws = [damper.strategy for damper in devices.dampers]
    alike = [k for k in law.gains if len({own.bounds.get(k) for own in laws}) == 1]
    chosen = alike if gains is None else list(gains)
    for name in chosen:
        check.choice("gains", name, tuple(law.gains))
        if name not in alike:
            raise ValueError(f"gains: {name!r} differs between the legs: leave it out")
    if not chosen or len(set(chosen)) < len(chosen):
        raise ValueError(f"gains must be different names of {', '.join(alike)}, got {chosen}")
    return tuple(chosen)


def _method(method: str | None, law: Strategy) -> str:
    if method is None:
        return GRADIENT if isinstance(law, Program) else GENERATIONS
    check.choice("method", method, (GENERATIONS, GRADIENT))
    return method


def _studies(
    crossing: Crossing, roads: Sequence[RoadProfile], held_out: Sequence[RoadProfile],
    speeds: ArrayLike, approach: float,
) -> tuple[Study, Study | None]:  # fmt: skip
    """Training roads and those held out, none of which may be the same."""
    make_study(crossing, roads, speeds, approach, 0.0)
    given: Any = held_out
    if not isinstance(given, Sequence) or isinstance(given, str):
        raise TypeError(f"held_out must be a list of RoadProfile, got {type(given).__name__}")
    both, n = make_study(crossing, [*roads, *held_out], speeds, approach, 0.0), len(roads)
    first, second = both.elevations[:n], both.elevations[n:]
    others = replace(both, elevations=second) if len(second) else None
    return replace(both, elevations=first), others
