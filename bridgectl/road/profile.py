"""The road profile: elevation over station, and the ramps a tire meets on it.

A profile holds the elevation z, positive *up*, as road files and ISO 8608 do. The equations of the
crossing use the paper's r, positive *down* (Eq. 2). The sign changes in `RoadProfile.drop` and
nowhere else; `RoadProfile.ramps` gives the differences of that r.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, Any, NamedTuple, overload

import numpy as np
from numpy.polynomial import Polynomial
from numpy.typing import ArrayLike

from bridgectl import _checks as check
from bridgectl._checks import FloatArray
from bridgectl.road.iri import GOOD, running_iri, segment_iri
from bridgectl.road.limits import TOLERANCE, mean_step, require_gentle, require_increasing
from bridgectl.road.psd import RoadPsd, road_psd
from bridgectl.road.sampling import measured_step, warn_if_coarse
from bridgectl.road.stations import Stations

if TYPE_CHECKING:
    from matplotlib.axes import Axes

__all__ = ["Ramps", "RoadProfile"]

MAX_ORDER = 20  # least-squares polynomials of higher order lose their digits


class Ramps(NamedTuple):
    """A road cut into n ramps of equal length."""

    positions: FloatArray
    """Station x_i where each ramp starts [m], shape (n,)."""
    heights: FloatArray
    """Drop over each ramp, r(x_i + length) - r(x_i) [m], positive downward, shape (n,)."""


class RoadProfile(Stations):
    """Elevation of a road over its stations, straight between them. Immutable.

    Two profiles are equal when their stations and elevations are; the name is only a label. The
    methods return new profiles of the same name. They accept stations on the road, to within
    1e-9 m, and raise a ValueError that names the argument for one outside it.

    Parameters
    ----------
    x : array_like, shape (n,)
        Stations [m], n >= 2, strictly increasing, measured from the start of the bridge (negative
        on the approach).
    elevation : array_like, shape (n,)
        Elevation [m] at each station, positive up.
    name : str, optional
        A label for tables and plots.

    Raises
    ------
    TypeError
        If `x` or `elevation` are not real numbers, or `name` is not a string.
    ValueError
        If they are not two 1-D arrays of one length, hold NaN or infinity, the stations do not
        increase, or the road is anywhere steeper than 1 m/m (texture of up to 5 mm may be).

    Examples
    --------
    A 1 mm drop over 100 mm, the paper's unit ramp, 3 m past the start of the bridge:

    >>> from bridgectl.road import RoadProfile
    >>> road = RoadProfile([-10, 3.0, 3.1, 25], [0, 0, -0.001, -0.001], name="unit ramp")
    >>> road
    RoadProfile('unit ramp', 4 points, x from -10 m to 25 m, elevation from -0.001 m to 0 m, \
steps 0.1 to 21.9 m)
    """

    __slots__ = ("_elevation", "_measured_step", "_name")

    _measured_step: float | None

    def __init__(self, x: ArrayLike, elevation: ArrayLike, *, name: str = "") -> None:
        if not isinstance(name, str):
            raise TypeError(f'name must be a string, got {name!r}: type for example name="A1 east"')
        stations = check.array("x", x, (None,), unit="m")
        heights = check.array("elevation", elevation, (None,), unit="m")
        if stations.size < 2 or stations.size != heights.size:
            raise ValueError(
                f"x and elevation must have one length of at least 2, got {stations.size} and "
                f"{heights.size} values: give one elevation [m] for every station [m]"
            )
        require_increasing(stations)
        require_gentle(stations, heights)
        self._x, self._elevation, self._name = stations, heights, name
        self._measured_step = None

    @classmethod
    def _trusted(
        cls, x: FloatArray, elevation: FloatArray, name: str, step: float | None = None
    ) -> RoadProfile:
        """Return a road of a file, or one made of another that was measured at a step [m]."""
        # Unchecked: taking a slope out of a valid road may leave one steeper than MAX_SLOPE.
        road = cls.__new__(cls)
        x.flags.writeable = elevation.flags.writeable = False
        road._x, road._elevation, road._name = x, elevation, name
        road._measured_step = measured_step(x, elevation, record=True) if step is None else step
        return road

    def _like(self, x: FloatArray, elevation: FloatArray) -> RoadProfile:
        """Return what was made of this road: of its name, and no better measured."""
        return self._trusted(x, elevation, self._name, self.measured_step)

    def _measured_as(self, step: float, name: str | None = None) -> RoadProfile:
        """Return this road as one measured at a step [m], and of another name if given."""
        label = self._name if name is None else name
        return self._trusted(self._x, self._elevation, label, step)

    def __reduce__(self) -> tuple[Callable[..., RoadProfile], tuple[Any, ...]]:
        """Pickle by rebuilding, since unpickled arrays would be writable."""
        return self._trusted, (self._x, self._elevation, self._name, self.measured_step)

    @property
    def elevation(self) -> FloatArray:
        """Elevation [m] at the stations, positive up, shape (n,), read-only."""
        return self._elevation

    @property
    def name(self) -> str:
        """Label for tables and plots."""
        return self._name

    @property
    def measured_step(self) -> float:
        """Step [m] at which the road was measured, 0 for one that was drawn.

        A road that is resampled, cropped or shifted is no better measured than before. Elevations
        that lie on straight lines between even stations farther apart were interpolated, and count
        as measured there. What has no such stations, or few, is a shape that is meant to be
        straight between its points. Of more than one foot (0.305 m), the IRI, the ISO 8608 line and
        dynamic amplification of the road draw a warning.

        Examples
        --------
        >>> from bridgectl.road import utia_road
        >>> utia_road().resample(0.1).measured_step
        0.25
        >>> RoadProfile([-10, 3.0, 3.1, 25], [0, 0, -0.001, -0.001]).resample(0.1).measured_step
        0.0
        """
        if self._measured_step is None:
            self._measured_step = measured_step(self._x, self._elevation)
        return self._measured_step

    def __repr__(self) -> str:
        """Return name, number of points, ranges and step."""
        low, high = np.diff(self._x).min(), np.diff(self._x).max()
        step = f"step {low:.6g}" if high - low <= 1e-6 * high else f"steps {low:.4g} to {high:.4g}"
        return (
            f"RoadProfile({self._name!r}, {self._x.size} points, {self._range()}, elevation from "
            f"{self._elevation.min():.6g} m to {self._elevation.max():.6g} m, {step} m)"
        )

    def __eq__(self, other: object) -> bool:
        """Compare stations and elevations; the name is only a label."""
        if not isinstance(other, RoadProfile):
            return NotImplemented
        same_x = np.array_equal(self._x, other._x)
        return same_x and np.array_equal(self._elevation, other._elevation)

    def __hash__(self) -> int:
        """Hash what equality compares."""
        return hash((self._x.size, *self._x[[0, -1]], float(self._elevation.sum())))

    def resample(
        self, step: float = 0.1, *, start: float | None = None, stop: float | None = None
    ) -> RoadProfile:
        """Return the road at equal steps, interpolated linearly.

        Parameters
        ----------
        step : float
            Distance between stations [m].
        start, stop : float, optional
            The stations are ``start + i * step`` up to `stop` [m]; the ends of the road if omitted.

        Returns
        -------
        RoadProfile

        Raises
        ------
        ValueError
            If `step` is not positive or longer than the stretch, or `start` or `stop` are outside
            the road.

        Examples
        --------
        >>> RoadProfile([0, 1], [0, 0.01]).resample(0.25).elevation
        array([0.    , 0.0025, 0.005 , 0.0075, 0.01  ])
        """
        first, last = self._stretch(start, stop)
        pieces = int(np.floor((last - first) / check.positive("step", step, unit="m") + 1e-9))
        if pieces < 1:
            raise ValueError(
                f"step = {step:.10g} m is longer than the road from start to stop "
                f"({last - first:.10g} m): type a smaller step"
            )
        stations = first + step * np.arange(pieces + 1, dtype=np.float64)
        measured = self.measured_step and max(self.measured_step, float(step))
        return self._trusted(stations, self._interpolated(stations), self._name, measured)

    def detrend(self, order: int = 1) -> RoadProfile:
        """Return the road without its least-squares polynomial.

        Parameters
        ----------
        order : int
            0 takes out the mean, 1 a straight line (the grade), 2 a parabola, and so on.

        Returns
        -------
        RoadProfile

        Raises
        ------
        ValueError
            If `order` is not a whole number from 0 to 20, or needs more points than there are.
        """
        highest = min(MAX_ORDER, self._x.size - 1)
        if check.number("order", order) not in range(highest + 1):
            raise ValueError(
                f"order must be a whole number from 0 to {highest} for {self._x.size} points, "
                f"not {order}: type order=1 for a straight line"
            )
        trend = Polynomial.fit(self._x, self._elevation, int(order))
        return self._like(self._x, self._elevation - trend(self._x))

    def crop(self, start: float, stop: float) -> RoadProfile:
        """Return the road from one station to another, interpolated at these two ends.

        Parameters
        ----------
        start, stop : float
            The ends [m].

        Returns
        -------
        RoadProfile

        Raises
        ------
        ValueError
            If they are outside the road, or do not increase.
        """
        first, last = self._stretch(start, stop)
        inside = self._x[(self._x > first + TOLERANCE) & (self._x < last - TOLERANCE)]
        stations = np.concatenate([[first], inside, [last]])
        return self._like(stations, self._interpolated(stations))

    def place_bridge(self, station: float) -> RoadProfile:
        """Return the road with its stations measured from the start of a bridge.

        Parameters
        ----------
        station : float
            Station of the start of the bridge [m].

        Returns
        -------
        RoadProfile

        Raises
        ------
        ValueError
            If it is outside the road.

        Examples
        --------
        >>> RoadProfile([478, 479, 480], [0, 0, 0]).place_bridge(479).x
        array([-1.,  0.,  1.])
        """
        origin = self._inside("station", station)
        return self._like(self._x - origin, self._elevation)

    def level(self, x: float = 0.0) -> RoadProfile:
        """Return the road shifted to elevation 0 at a station, where a vehicle then starts level.

        Parameters
        ----------
        x : float
            The station [m].

        Returns
        -------
        RoadProfile

        Raises
        ------
        ValueError
            If it is outside the road.
        """
        datum = self._interpolated(self._inside("x", x))
        return self._like(self._x, self._elevation - datum)

    def elevation_at(self, x: ArrayLike) -> FloatArray:
        """Return the elevation at stations.

        Parameters
        ----------
        x : array_like, any shape
            Stations [m].

        Returns
        -------
        ndarray, same shape as `x`
            Elevation [m], positive up.

        Raises
        ------
        ValueError
            If any station is outside the road (by more than 1e-9 m) or NaN.
        """
        stations = check.floats("x", x, unit="m")
        on_road = (stations >= self._x[0] - TOLERANCE) & (stations <= self._x[-1] + TOLERANCE)
        if not on_road.all():
            self._inside("x", stations[~on_road][0])
        return self._interpolated(stations)

    def drop(self, x: ArrayLike, start: float) -> FloatArray:
        """Return r(x), the drop of the road below its elevation at `start`, positive *downward*.

        This is the one place where the sign changes from the elevation z (positive up) of road
        files to the r of the paper's Eq. (2), which is positive for a road that falls::

            r(x) = z(start) - z(x),   start <= x <= end of the profile

        Before `start` the road is level (r = 0), so a vehicle at rest stays at rest until there;
        past the end of the profile it continues level at its last elevation.

        Parameters
        ----------
        x : array_like, any shape
            Stations [m].
        start : float
            Station where the road stops being level [m]; inside the profile.

        Returns
        -------
        ndarray, same shape as `x`
            Drop [m].

        Examples
        --------
        A road that falls by 1 mm has r = +1 mm after the fall:

        >>> road = RoadProfile([0, 0.1], [0, -0.001])
        >>> road.drop([-1, 0, 0.05, 0.1, 7], start=0)
        array([0.    , 0.    , 0.0005, 0.001 , 0.001 ])
        """
        first = self._inside("start", start)
        ahead = np.maximum(np.asarray(x, dtype=np.float64), first)
        return np.asarray(self._interpolated(first) - self._interpolated(ahead))

    def ramps(
        self, length: float = 0.1, *, start: float | None = None, stop: float | None = None
    ) -> Ramps:
        """Cut the road into ramps of equal length, with the paper's sign: positive for a drop.

        Parameters
        ----------
        length : float
            Length of a ramp [m].
        start, stop : float, optional
            The ramps begin at ``start + i * length`` and reach to `stop` [m]; the ends of the road
            if omitted. The last one may reach past `stop`, or past the end of the road, where it
            continues level.

        Returns
        -------
        Ramps
            Positions and heights [m]; over the height of the unit ramp, the s(i) of Eq. (14).

        Raises
        ------
        ValueError
            If `length` is not positive, or `start` or `stop` are outside the road.

        Examples
        --------
        >>> ramps = RoadProfile([0, 0.1, 0.2], [0, -0.001, -0.003]).ramps()
        >>> ramps.positions, ramps.heights
        (array([0. , 0.1]), array([0.001, 0.002]))
        """
        first, last = self._stretch(start, stop)
        pieces = int(np.ceil((last - first) / check.positive("length", length, unit="m") - 1e-9))
        ends = first + length * np.arange(max(1, pieces) + 1, dtype=np.float64)
        drops = self.drop(ends, first)
        return Ramps(ends[:-1], drops[1:] - drops[:-1])

    @property
    def good_iri(self) -> float:
        """The IRI [m/km] below which a road is good: `bridgectl.road.iri.GOOD`."""
        return GOOD

    @overload
    def iri(self, segment: None = None) -> float: ...
    @overload
    def iri(self, segment: float) -> FloatArray: ...
    def iri(self, segment: float | None = None) -> float | FloatArray:
        """Return the International Roughness Index (Sayers 1995, ASTM E1926).

        The golden car starts on the mean slope of the first 11 m and runs over the whole road.

        Parameters
        ----------
        segment : float, optional
            Give one IRI for each whole segment of this length [m]; of the whole road if omitted.

        Returns
        -------
        float or ndarray
            IRI [m/km].

        Raises
        ------
        ValueError
            If the stations are not evenly spaced (but for rounding), or the road is shorter than
            `segment`, or `segment` than 1 m or a step.

        Warns
        -----
        UserWarning
            If the window is shorter than 20 m, too short to mean anything, or the road was measured
            at steps of more than one foot (see `measured_step`).

        Examples
        --------
        >>> from bridgectl.road import utia_road
        >>> utia_road().iri(segment=100).round(3)
        array([3.298, 2.442, 3.555, 4.086, 2.708])
        """
        values = segment_iri(self._x, self._elevation, segment)
        warn_if_coarse(self, "an IRI", mean_step(self._x))
        return float(values[0]) if segment is None else values

    def running_iri(self, window: float | None = None) -> tuple[FloatArray, FloatArray]:
        """Return the IRI along the road, of what lies behind each station.

        Parameters
        ----------
        window : float, optional
            Length [m] behind each station that is averaged; from the start of the road if omitted.

        Returns
        -------
        x, iri : ndarray, shape (n,)
            Stations [m] where the averaged stretch ends, and its IRI [m/km].

        Raises
        ------
        ValueError
            If the stations are not evenly spaced (but for rounding), or the road is shorter than
            `window`, or `window` than 1 m or a step.

        Warns
        -----
        UserWarning
            As `iri`.

        Examples
        --------
        >>> from bridgectl.road import utia_road
        >>> x, iri = utia_road().running_iri(window=100)
        >>> f"{iri.max():.2f} m/km over the 100 m before station {x[iri.argmax()]:.0f} m"
        '4.23 m/km over the 100 m before station 862 m'
        """
        found = running_iri(self._x, self._elevation, window)
        warn_if_coarse(self, "an IRI", mean_step(self._x))
        return found

    def psd(self, segment: float | None = None, *, window: str = "hann") -> RoadPsd:
        """Return the power spectral density of the elevation (Welch's method, on the slope).

        Parameters
        ----------
        segment : float, optional
            Length of the averaged stretches [m]; 100 m, or the whole of a shorter road, if omitted.
        window : str, optional
            Window of each stretch, a name that `scipy.signal.get_window` knows. With "boxcar" and
            a segment as long as the road this is the periodogram of the road's slope.

        Returns
        -------
        RoadPsd
            Wave numbers [cycles/m] and densities [m^3]; ``.fit()`` gives G_d(n_0), waviness and
            ISO 8608 class, ``.plot()`` draws them.

        Raises
        ------
        ValueError
            If the stations are not evenly spaced, or the segment holds fewer than 8 steps.

        Examples
        --------
        >>> from bridgectl.road import utia_road
        >>> utia_road().psd()
        RoadPsd('UTIA road', 200 wave numbers from 0.01 to 2 cycles/m, 8.6 averages)
        """
        return road_psd(self._x, self._elevation, segment, window, self._name, self.measured_step)

    def plot(self, ax: Axes | None = None) -> Axes:
        """Draw the elevation [mm] over the station [m].

        Parameters
        ----------
        ax : matplotlib.axes.Axes, optional
            Where to draw; those of a new pyplot figure if omitted.

        Returns
        -------
        matplotlib.axes.Axes
        """
        import matplotlib.pyplot as plt  # here, so that no crossing waits for matplotlib

        if ax is None:
            ax = plt.subplots()[1]
        ax.plot(self._x, 1e3 * self._elevation, label=self._name or None)
        ax.set_xlabel("station x [m]")
        ax.set_ylabel("elevation, up [mm]")
        return ax

    def _interpolated(self, stations: float | FloatArray) -> FloatArray:
        return np.asarray(np.interp(stations, self._x, self._elevation))
