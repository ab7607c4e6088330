"""Stations along a road, and which stretches of it they cover."""

from __future__ import annotations

from bridgectl import _checks as check
from bridgectl._checks import FloatArray
from bridgectl._places import SAME_PLACE


class Stations:
    """What a road profile knows of its stations: where it is, and where it is not."""

    __slots__ = ("_x",)

    _x: FloatArray

    @property
    def x(self) -> FloatArray:
        """Stations [m] from the start of the bridge, shape (n,), read-only."""
        return self._x

    def covers(self, start: float, stop: float) -> bool:
        """Tell whether the road reaches from one station to another, to within 1e-9 m.

        Parameters
        ----------
        start, stop : float
            The stations [m].

        Returns
        -------
        bool

        Raises
        ------
        TypeError, ValueError
            If one of them is not a finite number.
        """
        first, last = check.number("start", start), check.number("stop", stop)
        return bool(self._x[0] - SAME_PLACE <= first <= last <= self._x[-1] + SAME_PLACE)

    def require(
        self, start: float, stop: float, what: str = "the crossing", argument: str = "start"
    ) -> None:
        """Refuse a road that does not reach from one station to another, approach plus bridge.

        Parameters
        ----------
        start, stop : float
            The stations [m].
        what : str, optional
            What needs the road, for the message.
        argument : {'start', 'approach'}, optional
            What may be changed for a shorter approach.

        Raises
        ------
        ValueError
            If it does not. The message says what needs the stretch, and what to do.
        """
        if self.covers(start, stop):
            return
        start, stop = start + 0.0, stop + 0.0  # which makes -0 a 0
        first, last = float(self._x[0]), float(self._x[-1])
        way_out = "pass a longer road"
        if last - first >= stop - start:
            way_out += f" or place_bridge({first - start:.10g} to {last - stop:.10g})"
        elif first < stop <= last:
            way_out += f" or {argument}={first if argument == 'start' else -first:.10g}"
        elif 10 * (last - first) < stop - start and self.covers(start / 1e3, stop / 1e3):
            way_out = "for stations in km type RoadProfile(1000 * x, elevation)"
        raise ValueError(
            f"the road covers {self._range()} but {what} needs {start:.10g} m to {stop:.10g} m "
            f"(approach plus bridge): {way_out}"
        )

    def _range(self) -> str:
        return f"x from {self._x[0]:.10g} m to {self._x[-1]:.10g} m"

    def _inside(self, argument: str, station: float) -> float:
        station = check.number(argument, station, unit="m")
        if self.covers(station, station):
            return station
        raise ValueError(
            f"{argument} = {station:.10g} m is outside the road, which covers {self._range()}: "
            "type a station in this range or pass a longer road"
        )

    def _stretch(self, start: float | None, stop: float | None) -> tuple[float, float]:
        first = float(self._x[0]) if start is None else self._inside("start", start)
        last = float(self._x[-1]) if stop is None else self._inside("stop", stop)
        if first >= last:
            raise ValueError(f"stop must be past start = {first:.10g} m, got {last:.10g} m")
        return first, last
