"""The ramp surface and what reads from it: DAE, superposed DAF, contributions."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike

from bridgectl import _checks
from bridgectl._checks import FloatArray
from bridgectl._progress import track
from bridgectl._threads import on_one_thread
from bridgectl.beam import Beam
from bridgectl.crossing import Crossing
from bridgectl.peaks import find_peaks
from bridgectl.propagator import SAME_PLACE, sample_positions
from bridgectl.quarter_car import QuarterCar
from bridgectl.ramps import DenseHistories, Histories, factor_histories
from bridgectl.response import METHODS, daf
from bridgectl.road import RoadProfile
from bridgectl.simulation import Run, linear_contact, prepare, reference_moments
from bridgectl.vehicle import Vehicle

if TYPE_CHECKING:
    from matplotlib.axes import Axes


@dataclass(frozen=True, eq=False)
class RampSurface:
    """Dynamic amplification of unit ramps, by speed and place: Fig. 5 of the paper.

    Made by `ramp_surface`.

    Attributes
    ----------
    beam, vehicle, section, recovery
        What was simulated: see `bridgectl.crossing.Crossing`.
    approach : float
        Where the vehicle starts before the bridge, and the ramps with it [m].
    ramp_length, ramp_height : float
        The unit ramp [m], a drop.
    speeds : ndarray, shape (n_speeds,)
        Speeds c [m/s].
    positions : ndarray, shape (n_ramps,)
        Start of each ramp [m], from the start of the bridge.
    daf_smooth : ndarray, shape (n_speeds,)
        DAF of a smooth road.
    daf_unit : ndarray, shape (n_speeds, n_ramps)
        DAF of a unit ramp on an otherwise smooth road.
    histories : Histories
        The moment histories behind them.
    """

    beam: Beam
    vehicle: Vehicle | QuarterCar
    section: float
    recovery: str
    approach: float
    ramp_length: float
    ramp_height: float
    speeds: FloatArray
    positions: FloatArray
    daf_smooth: FloatArray
    daf_unit: FloatArray
    histories: Histories = field(repr=False)

    def __repr__(self) -> str:
        kmh = self.speeds * 3.6
        return (
            f"RampSurface({len(self.speeds)} speeds from {kmh.min():g} to {kmh.max():g} km/h, "
            f"{len(self.positions)} ramps of {self.ramp_height * 1e3:g} mm over "
            f"{self.ramp_length * 1e3:g} mm from x = {0.0 - self.approach:g} m to "
            f"{self.beam.length:g} m, recovery={self.recovery!r})"
        )

    @property
    def daf_difference(self) -> FloatArray:
        """What a unit ramp changes, DAF_unit - DAF_smooth (Fig. 5(b)), (n_speeds, n_ramps)."""
        return np.asarray(self.daf_unit - self.daf_smooth[:, np.newaxis])

    def ramps(self, profile: RoadProfile) -> FloatArray:
        """Ramp scale factors s(i) of a road, Eq. (14): positive for a drop.

        Parameters
        ----------
        profile : RoadProfile
            A road that covers the approach and the bridge.

        Returns
        -------
        ndarray, shape (n_ramps,)

        Raises
        ------
        TypeError
            If `profile` is not a `RoadProfile`.
        ValueError
            If it does not cover the approach and the bridge.
        """
        prepare(self._crossing(), profile, -self.approach)
        ramps = profile.ramps(self.ramp_length, start=-self.approach, stop=self.beam.length)
        return np.asarray(ramps.heights / self.ramp_height)

    def road(self, drops: ArrayLike, name: str = "") -> RoadProfile:
        """Road of straight ramps: what superposed histories belong to; see `ramps`.

        Parameters
        ----------
        drops : array_like, shape (n_ramps,)
            Drop over each ramp [m], positive downward.
        name : str, optional
            Name of the road.

        Returns
        -------
        RoadProfile
            Over approach and bridge, at elevation 0 where it starts.

        Raises
        ------
        TypeError, ValueError
            If there is not one drop for each ramp, or a ramp is steeper than 1 m/m.
        """
        falls = _checks.array("drops", drops, (len(self.positions),), unit="m")
        x = np.append(self.positions, self.positions[-1] + self.ramp_length)
        return RoadProfile(x, -np.append(0.0, np.cumsum(falls)), name=name)

    def dae(self, profile: RoadProfile) -> FloatArray:
        """Dynamic amplification estimate of a road, Eq. (15).

        DAE(c) = DAF_smooth(c) + sum_i [DAF_unit(c, i) - DAF_smooth(c)] s(i): a first-order
        estimate, right where the peak moment keeps its place in time and poor at speeds
        where two peaks compete. `superposed_daf` has no such error.

        Parameters
        ----------
        profile : RoadProfile
            A road that covers the approach and the bridge.

        Returns
        -------
        ndarray, shape (n_speeds,)

        Raises
        ------
        TypeError, ValueError
            As `ramps`.

        References
        ----------
        Y. Li, E. OBrien, A. Gonzalez, J. Sound Vib. 293 (2006) 125-137, Eqs. (14), (15).

        Examples
        --------
        Fig. 7 of the paper, which prints 1.0663: a rise of 5 mm, one of 7 mm, a drop of 10 mm.

        >>> import numpy as np
        >>> import bridgectl as bc
        >>> beam, car = bc.li2006.beam(), bc.li2006.car()
        >>> surface = bc.ramp_surface(beam, car, 110 / 3.6, recovery="li2006")
        >>> print(f"{surface.dae(bc.li2006.fig7_road())[0]:.4f}")
        1.0648
        """
        return np.asarray(self.daf_smooth + self.contributions(profile).sum(axis=1))

    def contributions(self, profile: RoadProfile) -> FloatArray:
        """What each ramp of a road adds to its DAE, the terms of Eq. (15).

        Parameters
        ----------
        profile : RoadProfile
            A road that covers the approach and the bridge.

        Returns
        -------
        ndarray, shape (n_speeds, n_ramps)

        Raises
        ------
        TypeError, ValueError
            As `ramps`.
        """
        return np.asarray(self.daf_difference * self.ramps(profile))

    @on_one_thread
    def superposed_daf(self, profile: RoadProfile) -> FloatArray:
        """DAF of a road from the superposed moment histories: exact for a linear crossing.

        M(t) = M_smooth(t) + sum_i s(i) M_i(t), then its maximum.

        Parameters
        ----------
        profile : RoadProfile
            A road that covers the approach and the bridge; between the ends of the ramps it
            counts as straight.

        Returns
        -------
        ndarray, shape (n_speeds,)

        Raises
        ------
        TypeError, ValueError
            As `ramps`.

        Warns
        -----
        LiftOffWarning
            If a tire leaves the road at some speeds. The crossing is not linear there: they
            are simulated instead.
        """
        drops = self.ramps(profile) * self.ramp_height
        result = np.empty(len(self.speeds))
        for i in range(len(self.speeds)):
            moment = self.histories.moments(i, drops[:, np.newaxis])
            moment += self.histories.smooth[i][:, np.newaxis]
            result[i] = find_peaks(moment).values[0]
        road = self.road(drops)
        run = prepare(self._crossing(), road, -self.approach)
        flying = ~linear_contact(run, self.speeds)
        if flying.any():
            result[flying] = daf(
                self.beam,
                self.vehicle,
                self.speeds[flying],
                road,
                start=-self.approach,
                section=self.section,
                recovery=self.recovery,
            )
        return result

    def plot(self, *, difference: bool = False, ax: Axes | None = None) -> Axes:
        """Draw the surface over place and speed: see `bridgectl.plots.surface_plot`."""
        # Late, for it lies above this module, and matplotlib is slow to load.
        from bridgectl.plots import surface_plot

        return surface_plot(self, difference=difference, ax=ax)

    def _crossing(self) -> Crossing:
        return Crossing(self.beam, self.vehicle, float(self.speeds[0]), self.section, self.recovery)


@on_one_thread
def ramp_surface(
    beam: Beam,
    vehicle: Vehicle | QuarterCar,
    speeds: ArrayLike,
    *,
    approach: float = 0.0,
    ramp_length: float = 0.1,
    ramp_height: float = 1e-3,
    section: float = 0.5,
    recovery: str = "exact",
    method: str = "propagator",
    progress: bool = True,
) -> RampSurface:
    """Compute the DAF of a unit ramp at every place, for every speed: Fig. 5 of the paper.

    Parameters
    ----------
    beam, vehicle, section, recovery
        See `bridgectl.crossing.Crossing`.
    speeds : float or array_like
        Speeds c [m/s].
    approach : float, optional
        Length of the approach [m]: the vehicle starts that far before the bridge, in
        equilibrium, and ramps lie there too.
    ramp_length, ramp_height : float, optional
        The unit ramp [m]: by default 1 mm over 100 mm, a *drop*, as in the paper.
    method : {'propagator', 'control'}, optional
        'propagator': all ramps from one propagation, factored. 'control': one
        `control.input_output_response` for each ramp and speed, slow, for comparison.
    progress : bool, optional
        Whether 'control' shows a progress bar on a terminal.

    Returns
    -------
    RampSurface

    Raises
    ------
    TypeError, ValueError
        If a parameter has the wrong kind, shape or range; the message names it.

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
    height = _checks.positive("ramp_height", ramp_height, unit="m")
    if height > length:
        raise ValueError(
            f"ramp_height must not exceed ramp_length (a slope of 1), got {height:g} m over "
            f"{length:g} m: for a ramp of 1 mm type 1e-3"
        )
    before = _checks.not_negative("approach", approach, unit="m")
    _checks.choice("method", method, METHODS)
    crossing = Crossing(beam, vehicle, float(c[0]), section, recovery)
    n_ramps = int(np.ceil((before + beam.length) / length - SAME_PLACE))
    positions = -before + length * np.arange(n_ramps)
    # The smooth road has nodes at the ramps' ends all the same.
    edges = np.append(positions, positions[-1] + length)
    smooth_road = RoadProfile(edges, np.zeros_like(edges))
    run = prepare(crossing, smooth_road, -before)
    if method == "propagator":
        histories: Histories = factor_histories(run, c, length, n_ramps)
    else:
        histories = _simulate_ramps(run, edges, c, height, progress)
    daf_smooth = find_peaks(histories.smooth.T).values
    daf_unit = np.array([histories.peaks(i, height) for i in range(c.size)])
    return RampSurface(
        beam, vehicle, section, recovery, before, length, height, c, positions,
        daf_smooth, daf_unit, histories,
    )  # fmt: skip


def _simulate_ramps(
    run: Run, edges: FloatArray, speeds: FloatArray, height: float, progress: bool
) -> DenseHistories:
    """Histories of one control-library simulation for each ramp and speed."""
    n_ramps = len(edges) - 1
    nodes = run.nodes(float(speeds.min()))
    nodes = nodes[np.searchsorted(nodes, -SAME_PLACE) :]
    positions = sample_positions(nodes)
    moments = np.empty((len(speeds), n_ramps + 1, len(positions)))
    cases = [(i, ramp) for i in range(len(speeds)) for ramp in range(n_ramps + 1)]
    for i, ramp in track(cases, "Simulating ramps", len(cases), show=progress):
        # After the last edge there is no ramp: the smooth road.
        road = RoadProfile(edges, -height * (np.arange(n_ramps + 1) > ramp))
        at_speed = replace(run.crossing, speed=float(speeds[i]))
        moments[i, ramp] = reference_moments(
            run._replace(crossing=at_speed, profile=road), positions
        )
    smooth = moments[:, -1]
    unit = (moments[:, :-1] - smooth[:, np.newaxis]) / height
    return DenseHistories(nodes, smooth, np.moveaxis(unit, 1, 2))
