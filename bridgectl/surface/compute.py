"""Ramp surfaces of linear crossings: the amplification of a unit ramp at every place and speed."""

from __future__ import annotations

import warnings
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from bridgectl import _checks
from bridgectl._checks import FloatArray
from bridgectl._places import count_pieces, even_places, whole_pieces
from bridgectl._progress import track
from bridgectl._warn import warn
from bridgectl.linear.cells import bridge_entry, sample_positions
from bridgectl.linear.lift_off import LiftOffWarning
from bridgectl.linear.reference import reference_effect
from bridgectl.linear.response import linear_dafs
from bridgectl.linear.runs import Run, prepare
from bridgectl.model.crossing import Crossing
from bridgectl.model.motion import Motion
from bridgectl.road import RoadProfile
from bridgectl.road.iso8608 import ramp_covariance
from bridgectl.road.psd import CLASSES
from bridgectl.surface.histories import DenseHistories, Histories, Kept, factor_histories
from bridgectl.surface.peaks import HistoryPeaks
from bridgectl.surface.ramps import ends_of_ramps, one_ramp
from bridgectl.surface.surface import RampSurface
from bridgectl.surface.tire_contact import TireContact, is_plain

RAMP_LENGTH, RAMP_HEIGHT = 0.1, 1e-3
"""The unit ramp of the paper [m]: a drop of 1 mm over 100 mm."""

LIFTING = 3.0
"""No ramp changes the tire force by more than this times stiffness and height: a sudden step by 2
at most without damping, and the bridge adds little."""


@dataclass(frozen=True)
class RampGrid:
    """Where unit ramps lie, and how high they are [m].

    They begin at `n_ramps` places over approach and bridge, and at each `every`-th one of them are
    simulated: drops, and rises beside them if `both_ways`.
    """

    approach: float
    length: float
    height: float
    n_ramps: int
    both_ways: bool = False
    every: int = 1

    @property
    def positions(self) -> FloatArray:
        """Start of each ramp [m]."""
        return even_places(-self.approach, self.length, self.n_ramps)

    @cached_property
    def edges(self) -> FloatArray:
        """Ends of the ramps [m]."""
        return ends_of_ramps(self.positions, self.length)

    @property
    def heights(self) -> FloatArray:
        """Drops that are simulated at a place [m]."""
        return np.array([self.height, -self.height] if self.both_ways else [self.height])

    def surface(
        self,
        crossing: Crossing,
        speeds: FloatArray,
        smooth: FloatArray,
        ramps: FloatArray,
        histories: Histories,
    ) -> RampSurface:
        """Make the surface of DAFs, of the ramps (n_heights, n_speeds, n_places)."""
        x = self.positions
        unit, *rise = between(x, x[:: self.every], ramps)
        return RampSurface(
            crossing.beam, crossing.vehicle, crossing.effect, self.approach, self.length,
            self.height, speeds, x, smooth, unit, histories,
            rise[0] if self.both_ways else None, self.every,
        )  # fmt: skip


def ramp_grid(
    bridge: float, approach: float, ramp_length: float, ramp_height: float | str,
    both_ways: bool, every: int, beyond: float | None = None,
) -> RampGrid:  # fmt: skip
    """Check where ramps are to lie before and on a bridge so long [m]: see `ramp_surface`.

    Vehicles from the other end start so far `beyond` it, and as long an approach before.
    """
    length = _checks.positive("ramp_length", ramp_length, unit="m")
    before = _checks.not_negative("approach", approach, unit="m")
    _checks.flag("both_ways", both_ways)
    step = _checks.integer("every", every, at_least=1)
    if length > bridge:
        raise ValueError(
            f"ramp_length must not exceed the bridge of {bridge:g} m, got {length:g} m: for "
            f"{length:g} mm type {length / 1000:g}"
        )
    n_ramps = count_pieces(before + bridge, length)
    if beyond is not None:
        on_bridge, way = n_ramps, bridge + 2 * before + beyond
        n_ramps = whole_pieces(way, length)
        if n_ramps < on_bridge:
            raise ValueError(
                f"ramp_length must fit into the way of {way:g} m to the start of vehicles from the "
                f"other end, got {length:g} m: type {way / on_bridge:.6g}"
            )
    height = unit_height(ramp_height, length, n_ramps)
    return RampGrid(before, length, height, n_ramps, both_ways, step)


def linear_surface(
    crossing: Crossing,
    speeds: FloatArray,
    grid: RampGrid,
    method: str = "propagator",
    progress: bool = True,
) -> RampSurface:
    """Compute the surface of a linear crossing: see `ramp_surface`."""
    # The smooth road has nodes at the ramps' ends all the same.
    run = prepare(crossing, RoadProfile(grid.edges, np.zeros_like(grid.edges)), -grid.approach)
    histories: Histories
    kept = Kept({}, [])
    if method == "propagator":
        histories = factor_histories(run, speeds, grid.length, grid.n_ramps, kept)
    else:
        histories = _simulate_ramps(run, grid.edges, speeds, grid.height, progress)
    found = HistoryPeaks(run, speeds, grid.length, grid.n_ramps, histories, kept)
    peaks = [[found.of_ramps(i, h) for i in range(speeds.size)] for h in grid.heights]
    smooth = crossing.orientation * np.array([of_smooth for of_smooth, _ in peaks[0]])
    ramps = crossing.orientation * np.array([[each for _, each in row] for row in peaks])
    ramps = ramps[..., :: grid.every]
    vehicle = crossing.linear
    if is_plain(vehicle):  # of several tires, lift-off is looked for in roads alone
        rate = vehicle.tire_lags[0] * float(speeds.max()) / grid.length
        force = LIFTING * vehicle.tire_stiffnesses[0] * (1 + rate) * grid.height
        if force > vehicle.static_loads[0]:
            _fly(run, speeds, grid, ramps, progress)
    return grid.surface(crossing, speeds, smooth, ramps, histories)


def _fly(run: Run, speeds: FloatArray, grid: RampGrid, ramps: FloatArray, progress: bool) -> None:
    """Simulate, in place, ramps (n_heights, n_speeds, n_places) that may lift the tire."""
    contact = TireContact(run, speeds, grid.length, grid.n_ramps)
    doubtful = np.array(
        [[contact.doubtful_ramps(i, h) for i in range(speeds.size)] for h in grid.heights]
    )
    cases = np.argwhere(doubtful[..., :: grid.every].any(axis=1))
    flights = 0
    for k, place in track(cases, "Simulating ramps that lift tires", len(cases), show=progress):
        ramp = place * grid.every
        where = doubtful[k, :, ramp]
        road = RoadProfile(grid.edges, one_ramp(grid.edges, ramp, grid.heights[k]))
        with warnings.catch_warnings(record=True, action="always", category=LiftOffWarning) as told:
            found = linear_dafs(run._replace(profile=road), speeds[where], progress=False)
        ramps[k, where, place] = found
        flights += len(told)
    if flights:
        warn(
            f"a tire leaves the road at {flights} ramps of {grid.height:g} m, at some speeds: "
            "simulated there with R >= 0; type a smaller ramp_height",
            LiftOffWarning,
        )


def unit_height(given: float | str, length: float, n_ramps: int) -> float:
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
        road = RoadProfile(edges, one_ramp(edges, ramp, height))
        motion = Motion(float(speeds[i]))
        moments[i, ramp] = reference_effect(run._replace(profile=road), motion, positions)
    smooth = moments[:, -1]
    unit = (moments[:, :-1] - smooth[:, np.newaxis]) / height
    return DenseHistories(nodes, smooth, np.moveaxis(unit, 1, 2))
