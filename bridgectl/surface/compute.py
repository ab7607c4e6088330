"""Ramp surfaces: the amplification of a unit ramp at every place and speed, computed."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike

from bridgectl import _checks
from bridgectl._checks import FloatArray
from bridgectl._plausible import judge_crossing, judge_range
from bridgectl._progress import track
from bridgectl._threads import on_one_thread
from bridgectl.linear.cells import SAME_PLACE, bridge_entry, sample_positions
from bridgectl.linear.estimates import require_surface
from bridgectl.linear.peaks import find_peaks
from bridgectl.linear.runs import Run, prepare, reference_effect
from bridgectl.model.beam import Beam
from bridgectl.model.crossing import Crossing
from bridgectl.model.quarter_car import QuarterCar
from bridgectl.model.vehicle import Vehicle
from bridgectl.road import RoadProfile, ramp_covariance
from bridgectl.road.psd import CLASSES
from bridgectl.simulate import METHODS
from bridgectl.surface.histories import DenseHistories, Histories, factor_histories
from bridgectl.surface.surface import RampSurface

if TYPE_CHECKING:
    from bridgectl.dampers import Damper, Strategy


RAMP_LENGTH, RAMP_HEIGHT = 0.1, 1e-3
"""The unit ramp of the paper [m]: a drop of 1 mm over 100 mm."""


@on_one_thread
def ramp_surface(
    beam: Beam,
    vehicle: Vehicle | QuarterCar,
    speeds: ArrayLike,
    *,
    approach: float = 0.0,
    ramp_length: float = RAMP_LENGTH,
    ramp_height: float | str = RAMP_HEIGHT,
    both_ways: bool = False,
    every: int = 1,
    section: float = 0.5,
    recovery: str = "exact",
    effect: str = "moment",
    method: str = "propagator",
    damper: Damper | Strategy | None = None,
    progress: bool = True,
) -> RampSurface:
    """Compute the DAF of a unit ramp at every place, for every speed: Fig. 5 of the paper.

    Parameters
    ----------
    beam, vehicle, section, recovery, effect
        See `bridgectl.Crossing`. Of an effect other than the moment, every "DAF" is that
        effect's largest value over its largest static one; of the acceleration, in m/s^2.
    speeds : float or array_like
        Speeds c [m/s].
    approach : float, optional
        Length of the approach [m]: the vehicle starts that far before the bridge, in
        equilibrium, and ramps lie there too.
    ramp_length, ramp_height : float, optional
        The unit ramp [m]: by default 1 mm over 100 mm, a *drop*, as in the paper. A road class,
        "A" to "H", stands for the height sigma sqrt(N) of one ramp with the variance of the drops
        over all N ramps of its roads: 13.4 mm for class A and 850 ramps.
    both_ways : bool, optional
        Whether there are rises of that height beside the drops: what they do together is the
        even part of a ramp's effect, which `RampSurface.dae` of order 2 and
        `RampSurface.class_dae` need to tell dampers apart.
    every : int, optional
        Take a ramp at every so many-th place alone, and straight lines between: a tenth of the
        ramps cost a tenth of the time.
    method : {'propagator', 'control'}, optional
        'propagator': all ramps from one propagation, factored. 'control': one
        `control.input_output_response` for each ramp and speed, slow, for comparison.
    damper : bridgectl.dampers.Damper or Strategy, optional
        A damper in place of the vehicle's own. If it is semi-active, its responses do not
        superpose: the surface has a DAE, which then is an estimate twice over, and no superposed
        DAF.
    progress : bool, optional
        Whether 'control' shows a progress bar on a terminal.

    Returns
    -------
    RampSurface

    Raises
    ------
    TypeError, ValueError
        If a parameter has the wrong kind, shape or range, or the work would be too much; the
        message names it.

    Warns
    -----
    PlausibilityWarning
        If speeds, vehicle or damper can hardly be meant.
    UserWarning
        If it takes minutes.

    References
    ----------
    Y. Li, E. OBrien, A. Gonzalez, J. Sound Vib. 293 (2006) 125-137, Section 3.1.

    Examples
    --------
    The paper prints 0.00433 for a unit ramp at 0.12 l and 110 km/h.

    >>> import bridgectl as bc
    >>> beam, car = bc.li2006.beam(), bc.li2006.car()
    >>> surface = bc.ramp_surface(beam, car, 110 / 3.6, recovery="li2006")
    >>> surface.positions[29].round(3), round(surface.daf_unit[0, 29] - surface.daf_smooth[0], 5)
    (np.float64(2.9), np.float64(0.00429))
    """
    c = _checks.speeds(speeds)
    length = _checks.positive("ramp_length", ramp_length, unit="m")
    before = _checks.not_negative("approach", approach, unit="m")
    _checks.flag("both_ways", both_ways)
    places = slice(None, None, _checks.integer("every", every, at_least=1))
    if isinstance(beam, Beam) and length > beam.length:
        raise ValueError(
            f"ramp_length must not exceed the bridge of {beam.length:g} m, got {length:g} m: for "
            f"{length:g} mm type {length / 1000:g}"
        )
    _checks.choice("method", method, METHODS)
    _checks.flag("progress", progress)
    crossing = Crossing(beam, vehicle, float(c[0]), section, recovery, effect)
    if damper is not None and (effect != "moment" or method != "propagator"):
        raise ValueError(
            f"with a damper, a surface is of the moment and by the fast path, got {effect=} and "
            f"{method=}: leave them out"
        )
    judge_crossing(crossing, c)
    require_surface(crossing, c, before, length, method)
    n_ramps = int(np.ceil((before + beam.length) / length - SAME_PLACE))
    height = _height(ramp_height, length, n_ramps)
    heights = np.array([height, -height] if both_ways else [height])
    positions = -before + length * np.arange(n_ramps)
    edges = np.append(positions, positions[-1] + length)
    histories: Histories
    if damper is not None:
        # Late, for dampers lie above this module.
        from bridgectl.dampers.actuator import as_damper, bare_vehicle

        device, bare = as_damper(damper), bare_vehicle(vehicle)
        judge_range(bare, device)
        if device.constant is not None:  # a vehicle like any other
            vehicle, damper = replace(bare, damping=device.constant), None
            crossing = replace(crossing, vehicle=vehicle)
    if damper is not None:
        from bridgectl.dampers.loop.damped import ramp_dafs

        daf_smooth, ramps, histories = ramp_dafs(crossing, damper, c, edges, heights, every)
    else:
        # The smooth road has nodes at the ramps' ends all the same.
        smooth_road = RoadProfile(edges, np.zeros_like(edges))
        run = prepare(crossing, smooth_road, -before)
        if method == "propagator":
            histories = factor_histories(run, c, length, n_ramps)
        else:
            histories = _simulate_ramps(run, edges, c, height, progress)
        daf_smooth = find_peaks(histories.smooth.T).values
        ramps = np.array([[histories.peaks(i, h) for i in range(c.size)] for h in heights])
        ramps = ramps[..., places]
    daf_unit, *daf_rise = between(positions, positions[places], ramps)
    return RampSurface(
        beam, vehicle, section, recovery, effect, before, length, height, c, positions,
        daf_smooth, daf_unit, histories, daf_rise[0] if both_ways else None, every,
    )  # fmt: skip


def _height(given: float | str, length: float, n_ramps: int) -> float:
    """Height of the unit ramp [m], of a road class that of one ramp for all of them."""
    if isinstance(given, str) and given.isalpha():
        _checks.choice("ramp_height, if no height [m],", given, tuple(CLASSES))
        height = class_height(given, length, n_ramps)
    else:
        height = _checks.positive("ramp_height", given, unit="m")
    if height > length:
        raise ValueError(
            f"ramp_height must not exceed ramp_length (a slope of 1), got {height:.3g} m over "
            f"{length:g} m: for a ramp of 1 mm type 1e-3"
        )
    return height


def class_height(road_class: str, length: float, n_ramps: int) -> float:
    """Height of one ramp that has the variance of all drops over the ramps of a class [m]."""
    return float(np.sqrt(n_ramps * ramp_covariance(road_class, 1, length)[0]))


def between(positions: FloatArray, places: FloatArray, dafs: FloatArray) -> FloatArray:
    """DAFs (..., n_places) at all positions, on straight lines between the places."""
    if len(places) == len(positions):
        return dafs
    rows = dafs.reshape(-1, len(places))
    return np.array([np.interp(positions, places, row) for row in rows]).reshape(
        *dafs.shape[:-1], -1
    )


def _simulate_ramps(
    run: Run, edges: FloatArray, speeds: FloatArray, height: float, progress: bool
) -> DenseHistories:
    """Histories of one control-library simulation for each ramp and speed."""
    n_ramps = len(edges) - 1
    nodes = run.nodes(float(speeds.min()))
    nodes = nodes[bridge_entry(nodes) :]
    positions = sample_positions(nodes)
    moments = np.empty((len(speeds), n_ramps + 1, len(positions)))
    cases = [(i, ramp) for i in range(len(speeds)) for ramp in range(n_ramps + 1)]
    for i, ramp in track(cases, "Simulating ramps", len(cases), show=progress):
        # After the last edge there is no ramp: the smooth road.
        road = RoadProfile(edges, -height * (np.arange(n_ramps + 1) > ramp))
        at_speed = replace(run.crossing, speed=float(speeds[i]))
        moments[i, ramp] = reference_effect(
            run._replace(crossing=at_speed, profile=road), positions
        )
    smooth = moments[:, -1]
    unit = (moments[:, :-1] - smooth[:, np.newaxis]) / height
    return DenseHistories(nodes, smooth, np.moveaxis(unit, 1, 2))
