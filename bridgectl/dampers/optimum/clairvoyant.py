"""The clairvoyant optimum: how low semi-active dampers could bring the peak moment.

With all of the road known, the dampings c(t) of one crossing are chosen for the least peak moment.
No damper can know the road like that: this is a line to compare strategies with, not a controller.

The damping is held over intervals, which are cut into the steps of
`bridgectl.dampers.optimum.steps`: states, impulses z and moments M_k are linear in one another, and
all that is not is z = phi v, with phi between its values at c_min and c_max. IPOPT solves

    minimise t   subject to   M_k <= t,   x_(k+1) = T_k x_k + Z_k z_k + g_k,   z_k = phi_k v_k

with all states as variables (multiple shooting). It finds local optima: it starts from the passive
damper and from bridgehook, and the lowest of all is taken, these two included. Beside it goes the
descent over blocks of `bridgectl.dampers.optimum.descent`, from the same two, with IPOPT to polish
what it comes to. What is reported is never a number of these but that of `simulate_loop` with the
damping, and the better of the two.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import closing
from dataclasses import replace
from itertools import product
from typing import Any, NamedTuple, overload

import numpy as np
from numpy.typing import ArrayLike, NDArray

from bridgectl import _checks as check
from bridgectl._checks import FloatArray
from bridgectl._plausible import judge_crossing
from bridgectl._progress import track
from bridgectl._warn import warn
from bridgectl._workers import in_processes
from bridgectl.dampers.actuator import with_damping
from bridgectl.dampers.costate import costate_of
from bridgectl.dampers.fitted import fitted
from bridgectl.dampers.gains import damping_bounds
from bridgectl.dampers.legs import Legs, require_dampers
from bridgectl.dampers.loop.damped import simulate_run
from bridgectl.dampers.loop.result import LoopResult
from bridgectl.dampers.optimum.descent import LOWERED, Descent
from bridgectl.dampers.optimum.result import Clairvoyant
from bridgectl.dampers.optimum.ride import RideLimit
from bridgectl.dampers.optimum.solver import NOT_SOLVED, Solver, Try
from bridgectl.dampers.optimum.steps import Steps, join, march
from bridgectl.linear.lift_off import LiftOffWarning
from bridgectl.linear.runs import Run
from bridgectl.linear.start import begin
from bridgectl.model.bridge import BridgeModel
from bridgectl.model.crossing import Crossing, make_crossing, require_factor
from bridgectl.model.effect import Effect
from bridgectl.model.motion import Motion
from bridgectl.model.quarter_car import QuarterCar
from bridgectl.model.vehicle import Vehicle
from bridgectl.road import RoadProfile
from bridgectl.road.events import require_road

STEPS = (5e-3, 2.5e-3, 1.25e-3)
"""Longest steps to try [s], until the closed loop agrees: their error falls with the square."""

STEP = 5e-3
"""Time that the damping is held [s], if no other is asked for."""

AGREEMENT = 2e-3
"""Largest difference allowed between the DAF of the steps and that of the closed loop. The damping
hardly changes with the steps: with half as long ones its DAF is the same within 0.001."""

SAME = 1e-5
"""Peaks that differ by less [-] are the same. IPOPT's damping is taken then, which stays near the
passive one where it matters to nobody."""

MOST_ENDS = 41
"""Places from which on the passive damping is tried behind the peak."""


class _Job(NamedTuple):
    """One crossing whose optimum is sought."""

    run: Run
    """Without dampers."""
    vehicle: Vehicle | QuarterCar
    """With its own."""
    speed: float
    step: float
    c_min: float
    c_max: float
    ride: float | None


@overload
def clairvoyant(
    beam: BridgeModel, vehicle: Vehicle | QuarterCar, speed: float, road: RoadProfile,
    c_min: float, c_max: float, *, start: float = ..., step: float = ..., section: float = ...,
    recovery: str = ..., effect: Effect | str = ..., ride: float | None = ...,
    workers: int | None = ..., progress: bool = ...,
) -> Clairvoyant: ...  # fmt: skip


@overload
def clairvoyant(
    beam: BridgeModel, vehicle: Vehicle | QuarterCar, speed: Sequence[float] | FloatArray,
    road: RoadProfile | Sequence[RoadProfile], c_min: float, c_max: float, *, start: float = ...,
    step: float = ..., section: float = ..., recovery: str = ..., effect: Effect | str = ...,
    ride: float | None = ..., workers: int | None = ..., progress: bool = ...,
) -> NDArray[np.object_]: ...  # fmt: skip


@overload
def clairvoyant(
    beam: BridgeModel, vehicle: Vehicle | QuarterCar, speed: float, road: Sequence[RoadProfile],
    c_min: float, c_max: float, *, start: float = ..., step: float = ..., section: float = ...,
    recovery: str = ..., effect: Effect | str = ..., ride: float | None = ...,
    workers: int | None = ..., progress: bool = ...,
) -> NDArray[np.object_]: ...  # fmt: skip


def clairvoyant(
    beam: BridgeModel,
    vehicle: Vehicle | QuarterCar,
    speed: ArrayLike,
    road: RoadProfile | Sequence[RoadProfile],
    c_min: float,
    c_max: float,
    *,
    start: float = 0.0,
    step: float = STEP,
    section: float = 0.5,
    recovery: str = "exact",
    effect: Effect | str = "moment",
    ride: float | None = None,
    workers: int | None = None,
    progress: bool = True,
) -> Clairvoyant | NDArray[np.object_]:
    """Find the dampings that give a crossing its least peak moment, all of the road known.

    A reference line for strategies, not a controller: no damper knows the road so well. It is the
    best that two local searches found, from several starts: an upper bound of the true optimum.

    Parameters
    ----------
    beam, section, recovery, effect
        See `bridgectl.daf`.
    vehicle : Vehicle or QuarterCar
        The vehicle; its own dampings (`damper_dampings`) are where the search starts.
    speed : float or array_like
        Speed c, or speeds [m/s].
    road : RoadProfile or sequence of RoadProfile
        The road, covering `start` to the end of the bridge, or several.
    c_min, c_max : float
        Bounds of the damping [N s/m].
    start : float, optional
        Where the vehicle starts in equilibrium [m]: 0, or negative for a start on the approach.
    step : float, optional
        Time that the damping is held [s].
    ride : float, optional
        Largest rms body acceleration [m/s^2] from the start to the end of the bridge, above each
        leg, which IPOPT then keeps; the descent does not go with it. Default: any.
    workers : int, optional
        Processes at work on several crossings: see `bridgectl.score`.
    progress : bool, optional
        Whether to show a progress bar on a terminal.

    Returns
    -------
    Clairvoyant, or ndarray of Clairvoyant, shape (n_speeds, n_roads)
        The array if speeds or roads are several, with the numbers that each has alone.

    Raises
    ------
    TypeError, ValueError
        If an argument is not what is described above.
    RuntimeError
        If the closed loop does not confirm a peak moment within 0.002.

    Warns
    -----
    LiftOffWarning
        If a tire leaves the road, which the search knows nothing of.

    References
    ----------
    S. M. Savaresi, C. Spelta, J. Dyn. Syst. Meas. Control 129 (2007) 382-391, for bounds of
    semi-active suspensions by full knowledge of the road; G. Strang, SIAM J. Numer. Anal. 5 (1968)
    506-517, for the splitting.

    Examples
    --------
    >>> import bridgectl as bc
    >>> from bridgectl.dampers import clairvoyant
    >>> beam, car = bc.li2006.beam(), bc.li2006.car()
    >>> road = bc.RoadProfile([-5, 3, 3.1, 25], [0, 0, -0.003, -0.003])
    >>> best = clairvoyant(beam, car, 30.0, road, 1e3, 30e3, start=-5, step=0.02)
    >>> print(f"{best.passive_daf:.2f} passive, {best.daf:.2f} at best")
    1.15 passive, 1.12 at best
    """
    require_dampers(vehicle)
    several = isinstance(road, Sequence) and any(isinstance(each, RoadProfile) for each in road)
    roads: list[Any] = list(road) if several else [road]  # type: ignore[arg-type]
    for each in roads:
        require_road(each)
    soft, stiff = damping_bounds(c_min, c_max)
    passing = make_crossing(beam, vehicle, effect, section, recovery)
    single: Any = speed if np.ndim(speed) == 0 else None
    speeds = check.speeds(speed) if single is None else np.array([Motion(single).speed])
    require_factor(passing)
    check.flag("progress", progress)
    crossing = replace(passing, vehicle=with_damping(vehicle, 0.0))
    held = check.positive("step", step, unit="s")
    most = None if ride is None else check.positive("ride", ride, unit="m/s^2")
    runs = [begin(passing, each, start, speeds)._replace(crossing=crossing) for each in roads]
    judge_crossing(crossing, speeds, *roads)
    jobs = [(_Job(run, vehicle, c, held, soft, stiff, most),) for c, run in product(speeds, runs)]
    found = np.empty(len(jobs), dtype=object)
    flights = 0
    with closing(in_processes(_optimum, jobs, workers)) as done:
        for index, (result, flies) in track(
            done, "Finding optima", len(jobs), show=progress, unit="crossings"
        ):
            found[index], flights = result, flights + flies
    if flights:
        _warn_of_flights(flights, len(jobs))
    return found.reshape(len(speeds), -1) if several or single is None else found[0]


def _warn_of_flights(flights: int, total: int) -> None:
    where = "" if total == 1 else f" in {flights} of {total} crossings"
    warn(
        f"the tire leaves the road{where}: the damping is the best of a crossing without lift-off, "
        "and its DAF is that with R >= 0",
        LiftOffWarning,
    )


def _optimum(job: _Job) -> tuple[Clairvoyant, bool]:
    """Find the optimum of one crossing, and tell whether its tire leaves the road."""
    run, vehicle, c, held, soft, stiff, most = job
    crossing, legs = run.crossing, Legs(vehicle.linear)
    own, offsets = np.clip(vehicle.linear.damper_dampings, soft, stiff), legs.offsets
    ride = None if most is None else RideLimit(legs.body, most)

    def simulate(damping: FloatArray, status: str) -> tuple[Clairvoyant, LoopResult]:
        rows = _of_dampers(damping, len(own))
        tried = Clairvoyant(
            np.nan, np.nan, steps.positions, rows, held, soft, stiff, status, offsets
        )
        loop = simulate_run(run, fitted(tried.damper, vehicle), np.array([c]))
        return replace(tried, daf=float(loop.daf[0, 0])), loop

    for longest in STEPS:
        steps = join(run, c, held, longest, soft, stiff)
        each = [_lowest(tries, steps) for tries in _tries(steps, vehicle, crossing, c, own, ride)]
        simulated = [simulate(steps.damping(best.shares), best.status) for best, _ in each[:1]]
        for best, _ in each[1:]:
            same = best is each[0][0]
            simulated += simulated if same else [simulate(steps.damping(best.shares), best.status)]
        k = int(np.argmin([crossing.orientation * result.daf for result, _ in simulated]))
        (result, optimum), peak = simulated[k], crossing.orientation * each[k][1]
        flies = not optimum.least_force[0, 0] > 0
        # Nothing confirms an optimum where the tire leaves the road.
        if flies or abs(result.daf - peak) <= AGREEMENT:
            break
    else:
        raise RuntimeError(
            f"the closed loop gives a DAF of {result.daf:.4f} for an optimum of {peak:.4f}: type a "
            f"smaller step, for example step={min(held, longest) / 2:g}"
        )
    ipopt, descent = (found.daf for found, _ in (simulated[0], simulated[-1]))
    kept, _ = simulate(np.tile(own, len(steps.positions)), NOT_SOLVED)
    free = ride is None or ride.kept(steps, march(steps, steps.shares(own)))
    if free and crossing.orientation * (kept.daf - result.daf) <= 0:
        result = kept
    return replace(result, passive_daf=kept.daf, ipopt_daf=ipopt, descent_daf=descent), flies


def _lowest(tries: Sequence[Try], steps: Steps) -> tuple[Try, float]:
    """Return the first try of the lowest peak, and that."""
    peaks = np.array([march(steps, each.shares).peak for each in tries])
    k = int(np.argmax(peaks <= peaks.min() + SAME))
    return tries[k], float(peaks[k])


def _of_dampers(values: FloatArray, count: int) -> FloatArray:
    """Values (n count,) of intervals and dampers as rows of the dampers; of the only one (n,)."""
    return values if count == 1 else values.reshape(-1, count).T


def _tries(
    steps: Steps,
    vehicle: Vehicle | QuarterCar,
    crossing: Crossing,
    speed: float,
    own: FloatArray,
    ride: RideLimit | None,
) -> Iterator[list[Try]]:
    """What IPOPT starts from and finds, and then what the descent does, unless nothing is free.

    Of a limited ride: what keeps it of the former alone.
    """
    passive = steps.shares(own)
    hook = _bridgehook_shares(steps, vehicle, crossing, speed, passive)
    plain = [Try(shares, NOT_SOLVED) for shares in (passive, 0 * passive, 0 * passive + 1, hook)]
    fixed = steps.c_min == steps.c_max
    solver = None if fixed else Solver(steps, passive, ride)
    solved = [*plain, *(solver.solve(each) for each in (passive, hook) if solver)]
    if ride is not None:
        runs = [march(steps, each.shares) for each in solved]
        fit = [each for each, run in zip(solved, runs, strict=True) if ride.kept(steps, run)]
        if not fit:
            raise ValueError(
                f"ride must be one that dampings from {steps.c_min:g} to {steps.c_max:g} N s/m can "
                f"keep, got {ride.most:g} m/s^2: type for example ride="
                f"{1.01 * min(ride.of(steps, run) for run in runs):.3g}"
            )
        solved = fit
    yield solved
    if solver is None or ride is not None:
        return
    descent = Descent(steps)
    lowered = [descent.lower(Try(shares, NOT_SOLVED)) for shares in (passive, hook)]
    polished = [solver.solve(each.shares) for each in lowered]
    yield [
        _calmed(steps, descent.lower(_lowest([*solved, *polished, *lowered], steps)[0]), passive)
    ]


def _calmed(steps: Steps, found: Try, passive: FloatArray) -> Try:
    """Return to passive where a descent's damping matters to nobody: behind the peak."""
    if found.status != LOWERED:
        return found
    peak, n = march(steps, found.shares).peak, len(steps.positions)
    for first in np.linspace(0, n, MOST_ENDS).astype(int):
        calm = np.where(np.arange(n).repeat(len(steps.masses)) < first, found.shares, passive)
        if march(steps, calm).peak <= peak:
            break
    return found._replace(shares=calm)


def _bridgehook_shares(
    steps: Steps, vehicle: Vehicle | QuarterCar, crossing: Crossing, speed: float, own: FloatArray
) -> FloatArray:
    """Shares that bridgehook commands, from the costates of the passive crossing."""
    passive, n = replace(crossing, vehicle=vehicle), len(steps.masses)
    found = [costate_of(passive, speed, -float(steps.positions[0]), leg + 1) for leg in range(n)]
    sigma = np.ravel([np.interp(steps.positions, *each) for each in found], order="F")
    past = np.repeat(steps.positions > found[0].positions[-1], n)

    def choose(i: int, v: float) -> float:
        return float(own[i]) if past[i] else float(sigma[i] * v < 0)

    return march(steps, choose).shares
