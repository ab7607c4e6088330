"""What is read from elevations over stations: the ramps a tire meets, and how rough they are.

A road holds the elevation z, positive *up*, as road files and ISO 8608 do. The equations of the
crossing use the paper's r, positive *down* (Eq. 2). The sign changes in `Elevations.drop`, and
in `drops_of` of roads side by side; `Elevations.ramps` gives the differences of that r.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple, overload

import numpy as np
from numpy.typing import ArrayLike

from bridgectl import _checks as check
from bridgectl._checks import FloatArray
from bridgectl._labelled import Labelled
from bridgectl._places import SAME_PLACE, count_pieces, even_places
from bridgectl.road.iri import GOOD, running_iri, segment_iri
from bridgectl.road.limits import mean_step
from bridgectl.road.psd import RoadPsd, road_psd
from bridgectl.road.sampling import measured_step, warn_if_coarse
from bridgectl.road.stations import Stations

if TYPE_CHECKING:
    import pandas
    from matplotlib.axes import Axes


class Ramps(NamedTuple):
    """A road cut into n ramps of equal length."""

    positions: FloatArray
    """Station x_i where each ramp starts [m], shape (n,)."""
    heights: FloatArray
    """Drop over each ramp, r(x_i + length) - r(x_i) [m], positive downward, shape (n,)."""


def drops_of(elevations: FloatArray) -> FloatArray:
    """Return r, the drop below the first station, of roads (n_roads, n): one row a station."""
    return np.ascontiguousarray((elevations[:, :1] - elevations).T)


def falls_of(road: Elevations, x: FloatArray) -> FloatArray:
    """Return dr/dx just after stations, 0 before and after the road: see `Elevations.drop`."""
    piece = np.searchsorted(road.x, x + SAME_PLACE, side="right") - 1
    on_road = (piece >= 0) & (piece < road.x.size - 1)
    piece = np.minimum(np.maximum(piece, 0), road.x.size - 2)
    ends = road.x[np.array([piece, piece + 1])]
    falls = np.diff(road.drop(ends, road.x[0]), axis=0)[0] / np.diff(ends, axis=0)[0]
    return np.where(on_road, falls, 0.0)


class Elevations(Stations):
    """What a `bridgectl.RoadProfile` tells of its elevations."""

    __slots__ = ("_elevation", "_measured_step", "_name")

    _elevation: FloatArray
    _measured_step: float | None
    _name: str

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
        >>> from bridgectl import RoadProfile, utia_road
        >>> utia_road().resample(0.1).measured_step
        0.25
        >>> RoadProfile([-10, 3.0, 3.1, 25], [0, 0, -0.001, -0.001]).resample(0.1).measured_step
        0.0
        """
        if self._measured_step is None:
            self._measured_step = measured_step(self._x, self._elevation)
        return self._measured_step

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
        on_road = (stations >= self._x[0] - SAME_PLACE) & (stations <= self._x[-1] + SAME_PLACE)
        if not on_road.all():
            self._inside("x", stations[~on_road][0])
        return self._interpolated(stations)

    def drop(self, x: ArrayLike, start: float, *, level: bool = True) -> FloatArray:
        """Return r(x), the drop of the road below its elevation at `start`, positive *downward*.

        This is the one place where the sign changes from the elevation z (positive up) of road
        files to the r of the paper's Eq. (2), which is positive for a road that falls::

            r(x) = z(start) - z(x),   start <= x <= end of the profile

        Before `start` the road is level (r = 0), so a vehicle at rest stays at rest until there,
        or with ``level=False`` as it is; past both ends of the profile it continues level.

        Parameters
        ----------
        x : array_like, any shape
            Stations [m].
        start : float
            Station where the road stops being level [m]; inside the profile.
        level : bool, optional
            Whether the road before `start` counts as level.

        Returns
        -------
        ndarray, same shape as `x`
            Drop [m].

        Examples
        --------
        A road that falls by 1 mm has r = +1 mm after the fall:

        >>> from bridgectl import RoadProfile
        >>> road = RoadProfile([0, 0.1], [0, -0.001])
        >>> road.drop([-1, 0, 0.05, 0.1, 7], start=0)
        array([0.    , 0.    , 0.0005, 0.001 , 0.001 ])
        """
        first = self._inside("start", start)
        ahead = np.asarray(x, dtype=np.float64)
        if level:
            ahead = np.maximum(ahead, first)
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
        >>> from bridgectl import RoadProfile
        >>> ramps = RoadProfile([0, 0.1, 0.2], [0, -0.001, -0.003]).ramps()
        >>> ramps.positions, ramps.heights
        (array([0. , 0.1]), array([0.001, 0.002]))
        """
        first, last = self._stretch(start, stop)
        pieces = count_pieces(last - first, check.positive("length", length, unit="m"))
        ends = even_places(first, length, max(1, pieces) + 1)
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
        >>> from bridgectl import utia_road
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
        >>> from bridgectl import utia_road
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
        >>> from bridgectl import utia_road
        >>> utia_road().psd()
        RoadPsd('UTIA road', 200 wave numbers from 0.01 to 2 cycles/m, 8.6 averages)
        """
        return road_psd(self._x, self._elevation, segment, window, self._name, self.measured_step)

    def to_pandas(self) -> pandas.DataFrame:
        """Return the elevation [m], positive up, as a table over the stations [m].

        Returns
        -------
        pandas.DataFrame
            Indexed by 'station' with a column 'elevation'; units are in ``attrs["units"]``.
        """
        columns = {"elevation": self._elevation}
        return Labelled({"station": self._x}, columns, {"elevation": "m"}).table()

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
            ax = plt.subplots(layout="constrained")[1]
        ax.plot(self._x, 1e3 * self._elevation, label=self._name or None)
        ax.set_xlabel("station x [m]")
        ax.set_ylabel("elevation, up [mm]")
        return ax

    def _interpolated(self, stations: float | FloatArray) -> FloatArray:
        return np.asarray(np.interp(stations, self._x, self._elevation))
