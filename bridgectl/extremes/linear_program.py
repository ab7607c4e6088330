"""The road of the largest or smallest DAE within bounds: the paper's profiles 7 and 8.

The DAE of Eq. (15) is linear in the ramps, their bounds are linear and so is the IRI's golden car,
whose mean rectified motion is convex: a linear program.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass

import numpy as np
from scipy import sparse
from scipy.optimize import linprog

from bridgectl import _checks as check
from bridgectl._checks import FloatArray
from bridgectl._progress import track
from bridgectl._threads import on_one_thread
from bridgectl._units import to_kmh
from bridgectl.extremes.common import IRI_TOLERANCE, NO_EFFECT, speed_index
from bridgectl.road import RoadProfile
from bridgectl.road.iri import AT_START, SPEED, golden_car, input_slopes
from bridgectl.surface.surface import RampSurface

UNIT_RAMP = 1e-3
"""The paper's unit ramp [m over 100 mm]: the default bound of a ramp."""

BOUND_TOLERANCE = 1e-6
"""How far a ramp may exceed its bound by the program's round-off, as a fraction of it."""

DAE_TOLERANCE = 1e-6
"""How far the road's DAE may lie from the program's by round-off."""


@dataclass(frozen=True, eq=False)
class ExtremeRoad:
    """The road of the largest or smallest DAE within bounds, made by `extreme_road`.

    Attributes
    ----------
    road : RoadProfile
        The road, over approach and bridge, level before its start.
    speed : float
        Speed [m/s] of its largest DAE, or the one speed that was asked for.
    dae : float
        DAE at that speed, read back from the surface.
    iri : float
        IRI [m/km] of the road.
    largest_ramp : float
        Largest rise or fall over a ramp [m].
    """

    road: RoadProfile
    speed: float
    dae: float
    iri: float
    largest_ramp: float

    def __repr__(self) -> str:
        return (
            f"ExtremeRoad(DAE {self.dae:.4f} at {to_kmh(self.speed):g} km/h, IRI {self.iri:.3f} "
            f"m/km, ramps up to {self.largest_ramp * 1e3:.3g} mm)"
        )


@on_one_thread
def extreme_road(
    surface: RampSurface,
    *,
    speed: float | None = None,
    iri: float | None = None,
    max_ramp: float = UNIT_RAMP,
    largest: bool = True,
    progress: bool = True,
) -> ExtremeRoad:
    """Find the road that amplifies most, or least, of all within bounds.

    The DAE of Eq. (15) is linear in the ramps, and their bounds and the IRI are convex: a linear
    program (the largest over all speeds: one for each speed).

    Parameters
    ----------
    surface : RampSurface
        Ramp surface of bridge and vehicle.
    speed : float, optional
        Make the DAE extreme at this speed [m/s], one of the surface's. If omitted, the largest
        over its speeds.
    iri : float, optional
        Bound of the IRI over approach and bridge [m/km]; none if omitted.
    max_ramp : float, optional
        Bound of the rise or fall over each ramp [m].
    largest : bool, optional
        Whether to look for the largest DAE or for the smallest.
    progress : bool, optional
        Whether to show a progress bar on a terminal.

    Returns
    -------
    ExtremeRoad

    Raises
    ------
    TypeError, ValueError
        If an argument is not what is described above.
    RuntimeError
        If the solution does not hold what the program was asked, when it is computed anew.

    References
    ----------
    Y. Li, E. OBrien, A. Gonzalez, J. Sound Vib. 293 (2006) 125-137, Section 4, profiles 7 and 8.

    Examples
    --------
    >>> import bridgectl as bc
    >>> from bridgectl.extremes import extreme_road
    >>> surface = bc.ramp_surface(bc.li2006.beam(), bc.li2006.car(), [25.0, 30.0])
    >>> extreme_road(surface, max_ramp=0.5e-3)
    ExtremeRoad(DAE 1.3741 at 108 km/h, IRI 2.872 m/km, ramps up to 0.5 mm)
    """
    bound = check.positive("max_ramp", max_ramp, unit="m")
    if bound > surface.ramp_length:
        raise ValueError(
            f"max_ramp must not exceed the ramps' length (a slope of 1), got {bound:g} m over "
            f"{surface.ramp_length:g} m: type 1e-3 for ramps of 1 mm"
        )
    limit = None if iri is None else check.positive("iri", iri, unit="m/km")
    wanted = range(len(surface.speeds)) if speed is None else [speed_index(surface, speed)]
    program = _Program(surface, bound, limit)
    if largest:
        shown = track(wanted, "Searching roads", len(wanted), show=progress)
        drops = program.largest(shown)
    else:
        drops = program.smallest(list(wanted))
    return _checked(surface, program, drops, list(wanted))


class _Program:
    """The linear program. Its first variables are the drops of the ramps, over their bound."""

    def __init__(self, surface: RampSurface, bound: float, iri: float | None) -> None:
        self.surface, self.bound, self.iri = surface, bound, iri
        # What a drop of `bound` adds to the DAE, (n_speeds, n_ramps).
        effect: FloatArray = surface.daf_difference * (bound / surface.ramp_height)
        self.effect: FloatArray = np.where(np.abs(effect) < NO_EFFECT, 0.0, effect)
        self.n_ramps = self.effect.shape[1]
        nothing = sparse.csr_array((0, self.n_ramps))
        limits: FloatArray = np.zeros(0)
        rows = (nothing, nothing, limits) if iri is None else self._iri_rows(iri)
        self.equal, self.below, self.limits = rows

    def largest(self, speeds: Iterable[int]) -> FloatArray:
        """Drops [m] of the largest DAE at any of these speeds."""
        found = [self._solve(-self.effect[i]) for i in speeds]
        return max(found, key=lambda drops: float(self.dae(drops).max())) * self.bound

    def smallest(self, speeds: list[int]) -> FloatArray:
        """Drops [m] of the smallest maximum of the DAE over these speeds."""
        if len(speeds) == 1:
            return self._solve(self.effect[speeds[0]]) * self.bound
        return self._solve(np.zeros(self.n_ramps), speeds) * self.bound

    def dae(self, drops: FloatArray) -> FloatArray:
        """DAE at every speed of drops over their bound."""
        return np.asarray(self.surface.daf_smooth + self.effect @ drops)

    def _solve(self, cost: FloatArray, maximum_of: Sequence[int] = ()) -> FloatArray:
        """Minimise cost @ drops, plus the largest DAE at the speeds `maximum_of`."""
        if self.iri is None and not maximum_of:
            return -np.sign(cost)  # each ramp on its own
        n_rows, n_below = len(maximum_of), self.equal.shape[1]
        # The last variable t is not below the DAE of any of these speeds.
        above = sparse.csr_array((n_rows, n_below - self.n_ramps))
        at_speeds = sparse.hstack([self.effect[list(maximum_of)], above, -np.ones((n_rows, 1))])
        rows = sparse.vstack([_widened(self.below), at_speeds])
        limits = np.append(self.limits, -self.surface.daf_smooth[list(maximum_of)])
        objective = np.concatenate([cost, np.zeros(n_below - self.n_ramps), [float(n_rows > 0)]])
        bounds = np.full((n_below + 1, 2), (-np.inf, np.inf))
        bounds[: self.n_ramps] = -1, 1
        solved = linprog(
            objective, A_ub=rows, b_ub=limits, A_eq=_widened(self.equal),
            b_eq=np.zeros(self.equal.shape[0]), bounds=bounds, method="highs",
        )  # fmt: skip
        if solved.status != 0:
            raise RuntimeError(f"the linear program found no road: {solved.message}")
        return np.asarray(solved.x[: self.n_ramps])

    def _iri_rows(self, iri: float) -> tuple[sparse.sparray, sparse.sparray, FloatArray]:
        """Rows that take the golden car over the ramps, and bound its mean rectified motion.

        Variables after the drops: four states of the car after each step, per mille, and a bound
        of its rectified output.
        """
        n, step = self.n_ramps, self.surface.ramp_length
        fall = -1e3 * self.bound * sparse.csr_array(np.tri(n + 1, n, -1))
        slopes, mean_slope = input_slopes(sparse.eye_array(n + 1, format="csr"), step)
        slopes, mean_slope = slopes.T @ fall, mean_slope @ fall
        car = golden_car().sample(step / SPEED, "zoh")
        m = slopes.shape[0]
        identity = sparse.eye_array(m, format="csr")
        first = sparse.csr_array(identity[:, [0]])
        start = sparse.kron(first, (car.A @ AT_START)[:, np.newaxis]) @ mean_slope.reshape(1, -1)
        moved = sparse.kron(identity, sparse.eye_array(4)) - sparse.kron(
            sparse.eye_array(m, k=-1), car.A
        )
        nothing = sparse.csr_array((4 * m, m))
        equal = sparse.hstack([-sparse.kron(identity, car.B) @ slopes - start, moved, nothing])
        output = sparse.kron(identity, car.C)
        no_drops = sparse.csr_array((m, n))
        mean = sparse.csr_array(
            np.concatenate([np.zeros(n + 4 * m), np.full(m, 1 / m)])[np.newaxis]
        )
        sizes = sparse.block_array([[no_drops, output, -identity], [no_drops, -output, -identity]])
        return equal, sparse.vstack([sizes, mean]), np.append(np.zeros(2 * m), iri)


def _widened(rows: sparse.sparray) -> sparse.sparray:
    """Rows with a column of zeros for one more variable."""
    return sparse.hstack([rows, sparse.csr_array((rows.shape[0], 1))])


def _checked(
    surface: RampSurface, program: _Program, drops: FloatArray, speeds: list[int]
) -> ExtremeRoad:
    """Read the road's DAE, IRI and ramps back, and compare them with what was asked."""
    road = surface.road(drops, "extreme road")
    dae = surface.dae(road)
    at = speeds[int(np.argmax(dae[speeds]))]
    iri, largest = road.iri(), float(np.abs(np.diff(road.elevation)).max())
    found = ExtremeRoad(road, float(surface.speeds[at]), float(dae[at]), iri, largest)
    if program.iri is not None and iri > program.iri + IRI_TOLERANCE:
        raise RuntimeError(f"the road's IRI exceeds {program.iri:g} m/km: {found!r}")
    if largest > program.bound * (1 + BOUND_TOLERANCE):
        raise RuntimeError(f"a ramp exceeds {program.bound * 1e3:g} mm: {found!r}")
    expected = program.dae(drops / program.bound)[at]
    if abs(found.dae - expected) > DAE_TOLERANCE:
        raise RuntimeError(f"the road's DAE is not that of the program, {expected:.6f}: {found!r}")
    return found
