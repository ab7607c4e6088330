"""The ramp surface and what reads from it: DAE, superposed DAF, contributions."""

from __future__ import annotations

import os
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike

from bridgectl import _checks
from bridgectl._checks import FloatArray
from bridgectl._plausible import judge_roads
from bridgectl._threads import on_one_thread
from bridgectl._units import to_kmh
from bridgectl.linear.response import linear_dafs
from bridgectl.linear.runs import prepare
from bridgectl.model.bridge_effects import Moment
from bridgectl.road import RoadProfile
from bridgectl.road.iso8608 import ramp_covariance
from bridgectl.road.spectrum import DEFAULT_BAND
from bridgectl.surface.class_dae import ClassDae, over_class
from bridgectl.surface.file import save_surface
from bridgectl.surface.histories import FeedbackHistories, Histories
from bridgectl.surface.labelled import surface_to_xarray
from bridgectl.surface.peaks import peaks_of
from bridgectl.surface.ramps import Roads, UnitRamps, profiles, road_parts

if TYPE_CHECKING:
    import xarray
    from matplotlib.axes import Axes


@dataclass(frozen=True, eq=False)
class RampSurface(UnitRamps):
    """Dynamic amplification of unit ramps, by speed and place: Fig. 5 of the paper.

    Made by `ramp_surface`.

    Attributes
    ----------
    beam, vehicle, effect
        What was simulated: see `bridgectl.Crossing`.
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
    daf_rise : ndarray, shape (n_speeds, n_ramps), or None
        DAF of a rise of the same height, if both ways were asked for.
    every : int
        The DAFs of ramps were computed at every so many-th place, with straight lines between.
    """

    daf_smooth: FloatArray
    daf_unit: FloatArray
    histories: Histories = field(repr=False)
    daf_rise: FloatArray | None = None
    every: int = 1

    def __repr__(self) -> str:
        kmh = to_kmh(self.speeds)
        rest = "" if self.section == 0.5 else f", section={self.section:g} of the span"
        rest += "" if type(self.effect) is Moment else f", effect={self.effect!r}"
        rest += "" if self.daf_rise is None else ", both ways"
        rest += "" if self.every == 1 else f", computed at one place in {self.every}"
        if isinstance(self.histories, FeedbackHistories):
            rest += f", damper={self.histories.damper!r}"
        return (
            f"RampSurface({len(self.speeds)} speeds from {kmh.min():g} to {kmh.max():g} km/h, "
            f"{len(self.positions)} ramps of {self.ramp_height * 1e3:g} mm over "
            f"{self.ramp_length * 1e3:g} mm from x = {0.0 - self.approach:g} m to "
            f"{self._end:g} m, recovery={self.recovery!r}{rest})"
        )

    @property
    def daf_difference(self) -> FloatArray:
        """What a unit ramp changes, DAF_unit - DAF_smooth [-] (Fig. 5(b)), (n_speeds, n_ramps)."""
        return np.asarray(self.daf_unit - self.daf_smooth[:, np.newaxis])

    @property
    def odd_effect(self) -> FloatArray:
        """What changes its sign with the ramp, (drop - rise) / 2 [-], (n_speeds, n_ramps).

        Raises
        ------
        ValueError
            If the surface has ramps down alone.
        """
        return np.asarray((self.daf_unit - self._both_ways()) / 2)

    @property
    def even_effect(self) -> FloatArray:
        """What drop and rise have in common, (drop + rise) / 2 - smooth [-], (n_speeds, n_ramps).

        Raises
        ------
        ValueError
            If the surface has ramps down alone.
        """
        mean = (self.daf_unit + self._both_ways()) / 2
        return np.asarray(mean - self.daf_smooth[:, np.newaxis])

    def _both_ways(self) -> FloatArray:
        if self.daf_rise is None:
            raise ValueError(
                "the surface has ramps down alone, which have no second order: type "
                'ramp_surface(..., ramp_height="A", both_ways=True)'
            )
        return self.daf_rise

    @on_one_thread
    def dae(self, roads: Roads, *, order: int = 1) -> FloatArray:
        """Dynamic amplification estimate of a road or of many, Eq. (15).

        DAE(c) = DAF_smooth(c) + sum_i [DAF_unit(c, i) - DAF_smooth(c)] s(i): a first-order
        estimate, right where the peak moment keeps its place in time and poor at speeds
        where two peaks compete. `superposed_daf` has no such error.

        It is odd in the road: over roads and their mirror images its mean is the smooth DAF,
        whatever the damper. Of order 2 it is DAF_smooth + sum_i o_i s(i) + sum_i e_i s(i)^2 with
        `odd_effect` o and `even_effect` e, where a damper that switches has its gain.

        Parameters
        ----------
        roads
            As `ramps`.
        order : {1, 2}, optional
            1: Eq. (15). 2: with the even effects, of a surface that was made both ways.

        Returns
        -------
        ndarray, shape (n_speeds,) or (n_roads, n_speeds)

        Raises
        ------
        TypeError, ValueError
            As `ramps`; of order 2, if the surface has ramps down alone.

        Warns
        -----
        PlausibilityWarning
            If a road is too rough to be driven, as of elevations in mm, or has a grade.
        UserWarning
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
        first, second = self._effects(order)
        scales = self.ramps(roads)
        judge_roads(*profiles(roads))
        estimate: FloatArray = scales @ first.T
        if second is not None:
            estimate += scales**2 @ second.T
        estimate += self.daf_smooth
        return estimate

    def _effects(self, order: int) -> tuple[FloatArray, FloatArray | None]:
        """What a unit ramp does times s, and times s^2."""
        if _checks.integer("order", order, at_least=1) > 2:
            raise ValueError(f"order must be 1 or 2, got {order}")
        return (self.daf_difference, None) if order == 1 else (self.odd_effect, self.even_effect)

    def class_dae(
        self,
        roughness: str | float,
        *,
        waviness: float = 2.0,
        band: tuple[float, float] = DEFAULT_BAND,
        level: str = "mean",
    ) -> ClassDae:
        """Mean and standard deviation of the DAE over the random roads of a class, closed form.

        Of the second order if the surface was made both ways: with ramps of covariance S, in units
        of the unit ramp, the mean is DAF_smooth + sum_i e_i S_ii, the variance
        o' S o + 2 tr((E S)^2). Of the first order the mean is the smooth DAF.

        Parameters
        ----------
        roughness, waviness, band, level
            See `bridgectl.iso8608_profile`.

        Returns
        -------
        ClassDae

        Raises
        ------
        TypeError, ValueError
            As `bridgectl.iso8608_profile`, of a class that there is not for example.

        Examples
        --------
        Bridgehook, which Eq. (15) does not tell from the vehicle's own damper, on class A roads:

        >>> import bridgectl as bc
        >>> beam, car = bc.li2006.beam(), bc.li2006.car()
        >>> for damper in (None, bc.dampers.bridgehook(beam, car, 1e3, 30e3)):
        ...     surface = bc.ramp_surface(
        ...         beam, car, 30.0, approach=20, ramp_height="A", both_ways=True, every=10,
        ...         damper=damper)
        ...     print(f"{surface.class_dae('A').mean[0]:.2f}, smooth {surface.daf_smooth[0]:.2f}")
        1.14, smooth 1.14
        1.10, smooth 1.13
        """
        covariance = ramp_covariance(
            roughness, len(self.positions), self.ramp_length, waviness=waviness, band=band,
            level=level,
        )  # fmt: skip
        effects = self._effects(1 if self.daf_rise is None else 2)
        return over_class(self.speeds, self.daf_smooth, *effects, covariance / self.ramp_height**2)

    def contributions(self, road: RoadProfile | ArrayLike, *, order: int = 1) -> FloatArray:
        """What each ramp of one road adds to its DAE, the terms of Eq. (15).

        Parameters
        ----------
        road : RoadProfile or array_like, shape (n_ramps + 1,)
            As `ramps`.
        order : {1, 2}, optional
            See `dae`.

        Returns
        -------
        ndarray, shape (n_speeds, n_ramps)

        Raises
        ------
        TypeError, ValueError
            As `ramps`.

        Warns
        -----
        PlausibilityWarning
            As `dae`.
        UserWarning
            As `ramps`.
        """
        scales = self.ramps(road)
        if scales.ndim != 1:
            raise ValueError(f"road must be one road, got {len(scales)}: take one at a time")
        judge_roads(*profiles(road))
        first, second = self._effects(order)
        return np.asarray(first * scales if second is None else first * scales + second * scales**2)

    @on_one_thread
    def superposed_daf(self, roads: Roads) -> FloatArray:
        """DAF of a road, or of many, from superposed histories: exact for a linear crossing.

        M(t) = M_smooth(t) + sum_i s(i) M_i(t), then its maximum.

        Parameters
        ----------
        roads
            As `ramps`; between the ends of the ramps a road counts as straight.

        Returns
        -------
        ndarray, shape (n_speeds,) or (n_roads, n_speeds)

        Raises
        ------
        TypeError, ValueError
            As `ramps`.

        Warns
        -----
        LiftOffWarning
            If a tire leaves the road at some speeds. The crossing is not linear there: they
            are simulated instead.
        UserWarning
            As `ramps`.
        """
        scales = self.ramps(roads)
        drops = np.atleast_2d(scales) * self.ramp_height
        judge_roads(*profiles(roads))
        values = np.hstack([self._superposed(part) for part in road_parts(drops.T)])
        for road in np.nonzero(~np.isfinite(values).all(axis=0))[0]:
            again = ~np.isfinite(values[:, road])
            run = prepare(self._crossing, self.road(drops[road]), -self.approach)
            values[again, road] = linear_dafs(run, self.speeds[again])
        return np.asarray(values.T if scales.ndim == 2 else values[:, 0])

    def _superposed(self, drops: FloatArray) -> FloatArray:
        """Superposed DAF of roads, (n_speeds, n_roads); NaN where a tire may leave the road."""
        values = np.empty((len(self.speeds), drops.shape[1]))
        peaks = peaks_of(self, self.histories)
        for i in range(len(self.speeds)):
            values[i] = self._crossing.orientation * peaks.of_roads(i, drops)
        values[self.near_lift_off(drops)] = np.nan
        return values

    def save(self, path: str | os.PathLike[str]) -> None:
        """Save the surface to an NPZ file: see `bridgectl.surface.file.save_surface`.

        Parameters
        ----------
        path : str or path-like
            The file; `bridgectl.load_surface` reads it back to the bit.
        """
        save_surface(self, path)

    def to_xarray(self) -> xarray.Dataset:
        """Return the surface as a dataset: see `bridgectl.surface.labelled.surface_to_xarray`."""
        return surface_to_xarray(self)

    def plot(self, *, difference: bool = False, ax: Axes | None = None) -> Axes:
        """Draw the surface over place and speed: see `bridgectl.plots.surface.surface_plot`.

        Parameters
        ----------
        difference : bool, optional
            Draw what a unit ramp changes (Fig. 5(b)) instead of its DAF.
        ax : matplotlib.axes.Axes, optional
            Where to draw; those of a new figure if omitted.

        Returns
        -------
        matplotlib.axes.Axes
        """
        from bridgectl.plots.surface import surface_plot  # late, for matplotlib is slow to load

        return surface_plot(self, difference=difference, ax=ax)
