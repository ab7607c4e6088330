"""The road profile: elevation over station, and the roads that are made of one."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.polynomial import Polynomial
from numpy.typing import ArrayLike

from bridgectl import _checks as check
from bridgectl._checks import FloatArray
from bridgectl._places import SAME_PLACE, even_places, whole_pieces
from bridgectl.road.elevations import Elevations
from bridgectl.road.limits import require_gentle, require_increasing
from bridgectl.road.sampling import measured_step
from bridgectl.road.survey import means_along

if TYPE_CHECKING:
    from matplotlib.figure import Figure

MAX_ORDER = 20  # least-squares polynomials of higher order lose their digits


class RoadProfile(Elevations):
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

    >>> from bridgectl import RoadProfile
    >>> road = RoadProfile([-10, 3.0, 3.1, 25], [0, 0, -0.001, -0.001], name="unit ramp")
    >>> road
    RoadProfile('unit ramp', 4 points, x from -10 m to 25 m, elevation from -0.001 m to 0 m, \
steps 0.1 to 21.9 m)
    """

    __slots__ = ()

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
    def from_survey(
        cls,
        east: ArrayLike,
        north: ArrayLike,
        elevation: ArrayLike,
        *,
        bridge: Sequence[float] | None = None,
        step: float = 0.25,
        name: str = "",
    ) -> RoadProfile:
        """Return the road of one wheel path from surveyed points, in the order of driving.

        Stations are lengths along a smooth line through all points, so that their noise does not
        stretch the road. Where several points lie within one step, their mean counts.

        Parameters
        ----------
        east, north : array_like, shape (n,)
            Coordinates of the points [m], as of UTM; the first and the last tell the direction.
        elevation : array_like, shape (n,)
            Their elevations [m], positive up.
        bridge : (float, float), optional
            East and north of the start of the bridge [m], where stations begin. Default: the first
            point.
        step : float, optional
            Distance between the stations of the road [m].
        name : str, optional
            A label for tables and plots.

        Returns
        -------
        RoadProfile
            With even stations.

        Raises
        ------
        TypeError, ValueError
            If the arrays are not of one length, hold degrees, or lie on no smooth line, or the line
            is shorter than a step.

        Warns
        -----
        UserWarning
            If there are stretches above one foot (0.305 m) without a point, where the road counts
            as straight.

        Notes
        -----
        Noise of heights remains, less by the square root of the points in a step, and looks like
        roughness: 1 mm at each step of 0.25 m alone has an IRI of 1.6 m/km. Compare two passes. The
        mean over a step lowers the IRI by 4 % at 0.25 m.

        Examples
        --------
        Degrees first become metres about a point, here about the abutment:

        >>> import numpy as np
        >>> from bridgectl import RoadProfile
        >>> latitude, longitude = np.linspace(50, 50.001, 900), np.linspace(14, 14.001, 900)
        >>> north = np.radians(latitude - 50.0005) * 6.371e6
        >>> east = np.radians(longitude - 14.0005) * 6.371e6 * np.cos(np.radians(50))
        >>> road = RoadProfile.from_survey(east, north, 200 + 0.01 * north, bridge=(0, 0))
        >>> road.x[[0, -1]]
        array([-66.,  66.])
        """
        length = check.positive("step", step, unit="m")
        x, heights = means_along(east, north, elevation, bridge, length)
        road = cls(x, heights, name=name)
        return road.resample(length, start=float(np.ceil(x[0] / length)) * length)

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
        pieces = whole_pieces(last - first, check.positive("step", step, unit="m"))
        if pieces < 1:
            raise ValueError(
                f"step = {step:.10g} m is longer than the road from start to stop "
                f"({last - first:.10g} m): type a smaller step"
            )
        stations = even_places(first, step, pieces + 1)
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
        inside = self._x[(self._x > first + SAME_PLACE) & (self._x < last - SAME_PLACE)]
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

    def plot_roughness(self, *others: RoadProfile, segment: float = 100.0) -> Figure:
        """Draw elevation, IRI of each segment, and spectrum; other tracks beside them.

        Parameters
        ----------
        *others : RoadProfile
            Other tracks of the road, evenly spaced as this one.
        segment : float, optional
            Length of the segments [m].

        Returns
        -------
        matplotlib.figure.Figure

        Raises
        ------
        ValueError
            If a road is shorter than the segment, or not evenly spaced.

        Examples
        --------
        >>> import bridgectl as bc
        >>> [axes.get_ylabel() for axes in bc.utia_road().plot_roughness().axes]
        ['elevation, up [mm]', 'IRI [m/km]', 'power spectral density $G_d$ [m³]']
        """
        from bridgectl.plots.roads import profile_figure  # late, for matplotlib is slow to load

        return profile_figure([self, *others], segment)
