"""Crossings with semi-active dampers, for many speeds and roads at once."""

from __future__ import annotations

from collections.abc import Iterable
from contextlib import suppress

import numpy as np
from numpy.typing import ArrayLike

from bridgectl import _checks as check
from bridgectl._checks import FloatArray
from bridgectl._places import SAME_PLACE
from bridgectl._plausible import judge_crossing, judge_range
from bridgectl._threads import on_one_thread
from bridgectl.dampers.fitted import Dampers, Fitted, fitted
from bridgectl.dampers.loop.loop import RECORDED, Loop
from bridgectl.dampers.loop.result import LoopResult
from bridgectl.dampers.loop.work import require_loop
from bridgectl.model.bridge import BridgeModel
from bridgectl.model.crossing import Crossing, make_crossing, require_factor
from bridgectl.model.effect import Effect
from bridgectl.model.quarter_car import QuarterCar
from bridgectl.model.vehicle import Vehicle
from bridgectl.road.limits import first_too_steep, require_gentle


@on_one_thread
def simulate_loop(
    beam: BridgeModel,
    vehicle: Vehicle | QuarterCar,
    damper: Dampers,
    speeds: ArrayLike,
    stations: ArrayLike,
    elevations: ArrayLike,
    *,
    section: float = 0.5,
    recovery: str = "exact",
    effect: Effect | str = "moment",
    record: Iterable[str] = (),
) -> LoopResult:
    """Simulate crossings with semi-active dampers in place of the passive ones.

    Parameters
    ----------
    beam, section, recovery, effect
        See `bridgectl.daf`.
    vehicle : Vehicle or QuarterCar
        The vehicle; the passive dampers (`damper_dampings`) that others replace are taken out.
    damper : Damper or Strategy, or a list or dict of them
        The damper of every leg, or a list of one for each (None for the passive one that it has),
        or some by `Vehicle.damper_names`. A strategy alone gets the defaults of `Damper`.
    speeds : float or array_like
        Speeds c [m/s].
    stations : array_like, shape (n,)
        Stations of the roads [m], the first where the vehicle starts in equilibrium, the last at
        the end of the bridge or beyond it.
    elevations : array_like, shape (n,) or (n_roads, n)
        Elevations of the roads there [m], positive up, nowhere steeper than 1 m/m.
    record : iterable of str, optional
        Histories to keep: 'tire_force' [N] of each tire, and of each leg with a damper
        'body_acceleration' [m/s^2], ..., 'damping' [N s/m].

    Returns
    -------
    LoopResult

    Raises
    ------
    TypeError, ValueError
        If an argument is not what is described above, or a law returns NaN or infinity.

    Examples
    --------
    >>> import numpy as np
    >>> import bridgectl as bc
    >>> from bridgectl.dampers import passive, simulate_loop
    >>> x = np.linspace(0, 25, 251)
    >>> result = simulate_loop(bc.li2006.beam(), bc.li2006.car(), passive(7e3), 30.0, x, 0 * x)
    >>> bool(abs(result.daf[0, 0] - bc.daf(bc.li2006.beam(), bc.li2006.car(), 30.0)[0]) < 1e-5)
    True
    """
    crossing = make_crossing(beam, vehicle, effect, section, recovery)
    require_factor(crossing)
    devices = fitted(damper, vehicle)
    c = check.speeds(speeds)
    x, z = checked_roads(beam, stations, elevations)
    names = _names(record)
    judge_crossing(crossing, c)
    judge_range(vehicle, devices)
    return run_loop(devices.bare(crossing), devices, c, x, z, names)


def run_loop(
    crossing: Crossing,
    dampers: Fitted,
    speeds: FloatArray,
    stations: FloatArray,
    elevations: FloatArray,
    record: tuple[str, ...] = (),
    start: float | None = None,
) -> LoopResult:
    """Do what `simulate_loop` was asked for; the crossing is without what they replace.

    The reference tire may start further on than the roads [m].
    """
    n_roads = len(elevations)
    require_loop(crossing, [dampers], speeds, stations, n_roads, n_recorded=len(record))
    order = np.argsort(speeds, kind="stable")
    found = Loop(crossing, dampers, speeds[order], stations, elevations, record, start=start).run()
    return found.of_speeds(np.argsort(order))


def checked_roads(
    beam: BridgeModel, stations: ArrayLike, elevations: ArrayLike
) -> tuple[FloatArray, FloatArray]:
    """Stations [m], shape (n,), and elevations of roads there [m], shape (n_roads, n)."""
    x = check.array("stations", stations, (None,), unit="m")
    with suppress(ValueError):  # rows of different lengths, which the check tells of
        elevations = np.atleast_2d(elevations)
    z = check.array("elevations", elevations, (None, None), unit="m")
    if z.shape[1] != x.size or z.size == 0 or x.size < 2:
        raise ValueError(
            f"elevations must have one value for each of the {x.size} stations, got {z.shape}"
        )
    if np.any(np.diff(x) <= 0) or x[0] > 0 or x[-1] < beam.length - SAME_PLACE:
        raise ValueError(
            f"stations must increase from 0 m or less to the end of the bridge, {beam.length:g} m"
        )
    steepest = np.append(0.0, np.cumsum(np.abs(np.diff(z)).max(axis=0)))  # of all roads at once
    if first_too_steep(x, steepest) is not None:
        _require_gentle_roads(x, z)
    return x, z


def _require_gentle_roads(x: FloatArray, z: FloatArray) -> None:
    """Name the first road that is too steep, and where."""
    for k, road in enumerate(z):
        try:
            require_gentle(x, road)
        except ValueError as error:
            raise ValueError(f"elevations of road {k}: {error}") from None


def _names(record: Iterable[str]) -> tuple[str, ...]:
    """Histories to keep."""
    names = (record,) if isinstance(record, str) or not isinstance(record, Iterable) else (*record,)
    if names == (record,) or not all(isinstance(name, str) for name in names):
        raise TypeError(
            f"record must be a list of names, got {record!r:.60}: type for example "
            'record=["tire_force"]'
        )
    if unknown := set(names) - set(RECORDED):
        raise ValueError(
            f"record has an unknown name, {sorted(unknown)[0]!r}, known: {', '.join(RECORDED)}"
        )
    return names
