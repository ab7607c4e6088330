"""How low no semi-active damper can bring the peak moment: a proven bound, all of the road known.

The crossing is that of `bridgectl.dampers.optimum.steps`, one step for each damping that is held,
relaxed as `bridgectl.dampers.optimum.hull` has it. Intervals of the suspension velocities are those
of dampings that are better than the best found by a descent over blocks. They are narrowed, round
by round, and where that no longer pays the search branches on the sign of a velocity: of that whose
hull is to blame for most of the bound, by its price. The least bound of all branches holds.
"""

from __future__ import annotations

import heapq
from dataclasses import dataclass, replace
from itertools import count
from time import monotonic

import numpy as np

from bridgectl import _checks as check
from bridgectl._checks import FloatArray
from bridgectl._plausible import judge_crossing
from bridgectl._threads import on_one_thread
from bridgectl._warn import warn
from bridgectl.dampers.actuator import with_damping
from bridgectl.dampers.fitted import fitted
from bridgectl.dampers.gains import damping_bounds
from bridgectl.dampers.legs import Legs, require_dampers
from bridgectl.dampers.loop.damped import simulate_run
from bridgectl.dampers.optimum.hull import Hull
from bridgectl.dampers.optimum.impulses import Impulses
from bridgectl.dampers.optimum.result import Clairvoyant
from bridgectl.dampers.optimum.steps import Steps, join, march
from bridgectl.linear.lift_off import LiftOffWarning
from bridgectl.linear.runs import Run
from bridgectl.linear.start import begin
from bridgectl.model.bridge import BridgeModel
from bridgectl.model.crossing import make_crossing, require_factor
from bridgectl.model.effect import Effect
from bridgectl.model.motion import Motion
from bridgectl.model.quarter_car import QuarterCar
from bridgectl.model.vehicle import Vehicle
from bridgectl.road import RoadProfile
from bridgectl.road.events import require_road

CLOSED = 1e-4
"""Gap [-] at which the search ends: no DAF is known so well."""

SMALL = 5e-3
"""Gap [-] that says something even where dampers gain nothing."""

PAYS = 0.05
"""Share of the gap that a round of narrowing must close for another one to follow."""

STATUS = "best found of a bound"
"""Of the best damping: no solver was asked."""

MOST = 400
"""Most dampings to choose: with more a program alone takes a second."""

FINER = 10
"""Samples in a step of the closed loop: it begins to hold a damping so much of a step late, if
`free_from` is no whole number of steps from the start."""


@dataclass(frozen=True, eq=False)
class DamperBound:
    """A bound of the peak moment, and the best damping found, by `damper_bound`.

    Attributes
    ----------
    bound : float
        No damping of the grid has a DAF below this [-].
    lowest : float
        DAF [-] of the best damping found, on the grid.
    passive : float
        DAF [-] of the vehicle's own damping, kept within the damper's range, on the grid.
    best : Clairvoyant
        The best damping found, with its DAF and the passive one by `simulate_loop`.
    step : float
        Time that a damping is held [s].
    free_from : float
        Where control begins [m].
    rounds, branches : int
        How often the intervals of velocities were narrowed, and sign by sign distinguished.
    seconds : float
        Time that it took [s].
    """

    bound: float
    lowest: float
    passive: float
    best: Clairvoyant
    step: float
    free_from: float
    rounds: int
    branches: int
    seconds: float

    def __repr__(self) -> str:
        told = "" if self.meaningful else ", which says nothing"
        return (
            f"DamperBound(DAF {self.bound:.4f} to {self.lowest:.4f}{told}, passive "
            f"{self.passive:.4f}, control from x = {self.free_from:g} m held {self.step * 1e3:g} "
            f"ms, {self.rounds} rounds and {self.branches} branches in {self.seconds:.1f} s)"
        )

    @property
    def gap(self) -> float:
        """Between the bound and the best found [-]."""
        return abs(self.lowest - self.bound)

    @property
    def interval(self) -> tuple[float, float]:
        """The DAF [-] of the best damping of the grid lies in it."""
        low, high = sorted((self.bound, self.lowest))
        return low, high

    @property
    def meaningful(self) -> bool:
        """Whether the best found gains at least half of what any damping can, or the gap is small.

        Small is 0.005.
        """
        return self.gap <= max(SMALL, abs(self.passive - self.lowest))

    @property
    def splitting(self) -> float:
        """DAF of the best found [-] by `simulate_loop` less that on the grid.

        It is the error of the steps, from which differences of DAFs on the grid are free.
        """
        return self.best.daf - self.lowest


@on_one_thread
def damper_bound(
    beam: BridgeModel,
    vehicle: Vehicle | QuarterCar,
    speed: float,
    road: RoadProfile,
    c_min: float,
    c_max: float,
    *,
    free_from: float = 0.0,
    start: float = 0.0,
    step: float = 20e-3,
    seconds: float = 30.0,
    section: float = 0.5,
    recovery: str = "exact",
    effect: Effect | str = "moment",
) -> DamperBound:
    """Bound the peak moment of one crossing from below, whatever the damper, all of the road known.

    It holds for every damping between `c_min` and `c_max` that is held over steps from `free_from`
    on, the vehicle's own before; each step is split as `clairvoyant` does it, and tires are taken
    to stay on the road. Compare with it strategies on the same grid: with `step` as sample time,
    which makes them differ by the error of the steps, `DamperBound.splitting`.

    Parameters
    ----------
    beam, section, recovery, effect
        See `bridgectl.daf`. Of what counts by its smallest value the bound is one from above.
    vehicle : Vehicle or QuarterCar
        The vehicle, with its own dampings (`damper_dampings`).
    speed : float
        Speed c [m/s].
    road : RoadProfile
        The road, covering `start` to the end of the bridge.
    c_min, c_max : float
        Bounds of the damping [N s/m].
    free_from : float, optional
        Where control begins [m]. The further before the bridge, the wider the gap: with 20 m it
        may say nothing, with 60 m it does.
    start : float, optional
        Where the vehicle starts in equilibrium [m], best a whole number of steps before
        `free_from`.
    step : float, optional
        Time that a damping is held [s]: shorter ones take longer, by the square and more.
    seconds : float, optional
        Time after which the search ends with the bound that it has [s].

    Returns
    -------
    DamperBound

    Raises
    ------
    TypeError, ValueError
        If an argument is not what is described above.

    Warns
    -----
    UserWarning
        If the gap is so wide that the bound says nothing: see `DamperBound.meaningful`.
    LiftOffWarning
        If a tire leaves the road with the best damping found, which the bound knows nothing of.

    Notes
    -----
    It is proven for the steps' matrices as they are in memory: no tolerance of a solver is in it.
    The paper's truck and bridge, class A, 60 m of approach, c from 1 to 30 kN s/m, control from the
    bridge on: at 70, 90 and 108 km/h the gap is closed to 0.0001 on each of 20 roads, in 1 to 6 s
    of CPU. There the best damping's DAF by `simulate_loop` differs by 0.002, at most 0.013, from
    that on the grid; in steps of 10 ms, which take up to 11 s at 90 and 108 km/h, by 0.0007, at
    most 0.0023. A damping held 20 ms is one held 10 ms twice: the bound of these steps holds, too.

    Examples
    --------
    >>> import bridgectl as bc
    >>> from bridgectl.dampers import damper_bound
    >>> beam, car = bc.li2006.beam(), bc.li2006.car()
    >>> road = bc.RoadProfile([-6, 3, 3.1, 25], [0, 0, -0.003, -0.003])
    >>> found = damper_bound(beam, car, 30.0, road, 1e3, 30e3, start=-6, step=0.04)
    >>> print(f"{found.bound:.3f} to {found.lowest:.3f}, passive {found.passive:.3f}")
    1.128 to 1.128, passive 1.148
    """
    began = monotonic()
    require_dampers(vehicle)
    require_road(road)
    soft, stiff = damping_bounds(c_min, c_max)
    passing, c = make_crossing(beam, vehicle, effect, section, recovery), Motion(speed).speed
    require_factor(passing)
    crossing = replace(passing, vehicle=with_damping(vehicle, 0.0))
    run, speeds = begin(passing, road, start, c)._replace(crossing=crossing), np.array([c])
    judge_crossing(crossing, c, road)
    held = check.positive("step", step, unit="s")
    limit = check.positive("seconds", seconds, unit="s")
    free = _checked_place(free_from, run.start, run.end)
    own = np.clip(vehicle.linear.damper_dampings, soft, stiff)

    steps = join(run, c, held, held, soft, stiff, free)
    kept = steps.shares(own)
    impulses = Impulses(steps, kept, len(own) * int(free > run.start))
    if (n := len(impulses.which)) > MOST:
        raise ValueError(
            f"step = {held:g} s makes {n} dampings to choose, more than {MOST}: type for example "
            f"step={1.1 * held * n / MOST:.2g}"
        )
    search = Search(impulses, kept[impulses.which], began + limit)
    bound, shares = search.run(), kept.copy()
    shares[impulses.which] = search.shares
    passive, best = (_simulated(run, speeds, vehicle, steps, held, each) for each in (kept, shares))
    sign = crossing.orientation
    found = DamperBound(
        sign * bound, sign * search.peak, sign * march(steps, kept).peak,
        replace(best, passive_daf=passive.daf), held, free, search.rounds, search.branches,
        monotonic() - began,
    )  # fmt: skip
    if not found.meaningful:
        warn(
            f"the bound says nothing: the DAF of the best damping lies between {found.bound:.3f} "
            f"and {found.lowest:.3f}, and passive has {found.passive:.3f}; type a larger seconds, "
            f"or a free_from nearer to the bridge than {free:g} m"
        )
    return found


def _simulated(
    run: Run, speeds: FloatArray, vehicle: Vehicle | QuarterCar, steps: Steps, held: float,
    shares: FloatArray,
) -> Clairvoyant:  # fmt: skip
    """Dampings, with their DAF in the closed loop."""
    damping, legs = steps.damping(shares), Legs(vehicle.linear)
    each = damping if len(legs.offsets) == 1 else damping.reshape(-1, len(legs.offsets)).T
    best = Clairvoyant(
        daf=np.nan, passive_daf=np.nan, positions=steps.positions, damping=each, step=held,
        c_min=steps.c_min, c_max=steps.c_max, status=STATUS, offsets=legs.offsets,
    )  # fmt: skip
    loop = simulate_run(run, fitted(replace(best, step=held / FINER).damper, vehicle), speeds)
    if loop.least_force[0, 0] <= 0:
        warn(
            "a tire leaves the road: the bound is that of a crossing without lift-off",
            LiftOffWarning,
        )
    return replace(best, daf=float(loop.daf[0, 0]))


class Search:
    """The search for the bound of all dampings, as `shares` of their impulses."""

    def __init__(self, impulses: Impulses, own: FloatArray, deadline: float) -> None:
        self.impulses, self.deadline = impulses, deadline
        starts = own, np.zeros_like(own), np.ones_like(own)
        self.peak, self.shares = min(map(impulses.lower, starts), key=lambda found: found[0])
        self.rounds = self.branches = 0

    @property
    def cut(self) -> float:
        """Peak below which dampings are sought, or proven not to be."""
        return self.peak - CLOSED

    def late(self) -> bool:
        """Whether time is up."""
        return monotonic() >= self.deadline

    def run(self) -> float:
        """Return the bound."""
        root = Hull(self.impulses, self.cut)
        worth, before = self._relax(root), -np.inf
        while root.floor < self.cut and not self.late():
            if root.floor - before < PAYS * (self.cut - root.floor):
                return self._branch(root, worth)
            before = root.floor
            worth = self._narrow(root)
        return min(root.floor, self.cut)

    def _branch(self, root: Hull, worth: FloatArray) -> float:
        """Branch where the bound is least, until it is that of all branches or time is up."""
        numbers = count()
        branches = [(root.floor, next(numbers), root, worth)]
        while branches and branches[0][0] < self.cut and not self.late():
            if not branches[0][3].any():  # the solver failed here: the bound is as it was
                break
            _, _, hull, worth = heapq.heappop(branches)
            for half in hull.branch(int(np.argmax(worth))):
                self.branches += 1
                worth = self._relax(half)
                if half.floor < self.cut:
                    worth = self._narrow(half)
                if half.floor < self.cut:
                    heapq.heappush(branches, (half.floor, next(numbers), half, worth))
        return min([self.cut, *(branch[0] for branch in branches)])

    def _narrow(self, hull: Hull) -> FloatArray:
        """Narrow intervals once, and relax again."""
        self.rounds += 1
        hull.cut = self.cut
        hull.tighten(self.late)
        return self._relax(hull)

    def _relax(self, hull: Hull) -> FloatArray:
        """Bound the peak, try the dampings of the solution, and tell what hulls are to blame."""
        found = hull.least_peak()
        shares = self.impulses.shares(found.impulses)
        if self.impulses.peaks(shares[:, np.newaxis])[0] < self.cut:
            self.peak, self.shares = self.impulses.lower(shares)
        return found.worth


def _checked_place(free_from: float, start: float, end: float) -> float:
    """Check where control begins."""
    place = check.number("free_from", free_from, unit="m")
    if not start <= place < end:
        raise ValueError(
            f"free_from must lie between the start at {start:g} m and the end of the bridge at "
            f"{end:g} m, got {place:g}: type free_from={max(start, 0.0):g}"
        )
    return place
