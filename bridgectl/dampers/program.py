"""Damping programs: a damping for each place, decided before the crossing.

A program measures nothing but the position, so a crossing with it stays linear in the road, and
superposition exact. Its dampings may be gains, for `bridgectl.tune` to change.
"""

from __future__ import annotations

from typing import Any

import casadi as ca
import numpy as np
from numpy.typing import ArrayLike

from bridgectl import _checks as check
from bridgectl._checks import FloatArray
from bridgectl.dampers.gains import damping_bounds
from bridgectl.dampers.strategy import Strategy

SHAPES = ("steps", "lines")
"""A damping is held to the next position, or changes in a straight line to the next one."""


class Program(Strategy):
    """The program strategy; made by `program`. With bounds, its dampings are gains."""

    def __init__(
        self, name: str, positions: FloatArray, dampings: FloatArray, shape: str,
        bounds: tuple[float, float] | None,
    ) -> None:  # fmt: skip
        self.positions, self.shape, self._fixed = positions, shape, dampings
        c_min, c_max = (dampings.min(), dampings.max()) if bounds is None else bounds
        names = [] if bounds is None else [f"damping_{i}" for i in range(1, dampings.size + 1)]
        gains = {k: (float(c), c_min, c_max) for k, c in zip(names, dampings, strict=False)}

        def law(s: Any, g: Any) -> Any:
            # Choices instead of ca.pw_const or ca.pw_lin: those add up differences, so that a
            # damping is right but for rounding, and the latter goes on beyond the ends.
            c = [getattr(g, each) for each in names] or [*dampings]
            slopes: list[Any] = [0.0] * len(c)
            if shape == "lines":
                slopes[:-1] = [
                    (c[i + 1] - c[i]) / length for i, length in enumerate(np.diff(positions))
                ]
            command: Any = c[0] + 0 * s.position
            for start, damping, slope in zip(positions, c, slopes, strict=True):
                command = ca.if_else(
                    s.position >= start, damping + slope * (s.position - start), command
                )
            return command

        super().__init__(name, law, float(c_min), float(c_max), gains)

    @property
    def dampings(self) -> FloatArray:
        """Dampings at the positions [N s/m]."""
        return np.array([*self.gains.values()]) if self.gains else self._fixed

    def __repr__(self) -> str:
        return (
            f"Program({self.name!r}, {self.positions.size} places from {self.positions[0]:g} to "
            f"{self.positions[-1]:g} m, c from {self.c_min:g} to {self.c_max:g} N s/m)"
        )


def program(
    positions: ArrayLike, dampings: ArrayLike, *, name: str = "program", shape: str = "steps",
    bounds: tuple[float, float] | None = None,
) -> Program:  # fmt: skip
    """Return a damping program c(x), x being the position of the reference tire.

    Parameters
    ----------
    positions : array_like, shape (n,)
        Places [m] from the start of the bridge, increasing, negative on the approach.
    dampings : array_like, shape (n,)
        Dampings [N s/m], 0 or more; one value is a constant damper. Their least and largest are
        the bounds of the strategy.
    name : str, optional
        What tables call it.
    shape : {'steps', 'lines'}, optional
        'steps' has the damping of a place from it on up to the next, 'lines' joins them by straight
        lines. Either has the first damping before the first place and the last after the last.
    bounds : tuple of float, optional
        Least and largest damping [N s/m], between which each damping is a gain of the strategy,
        `damping_1`, `damping_2`, ...: see `bridgectl.tune`. Default: the dampings stay as they are.

    Returns
    -------
    Program

    Raises
    ------
    TypeError, ValueError
        If an argument is not what is described above, or no damping is above 0.

    Examples
    --------
    Soft from 10 m before the bridge to 5 m into it:

    >>> from bridgectl.dampers import program
    >>> law = program([-60, -10, 5], [7e3, 1e3, 30e3])
    >>> law.command(position=[-100, -10.1, -10, 4.9, 5, 25])
    array([ 7000.,  7000.,  1000.,  1000., 30000., 30000.])

    The same places, without steps:

    >>> program([-60, -10, 5], [7e3, 1e3, 30e3], shape="lines").command(position=[-35, -10, 25])
    array([ 4000.,  1000., 30000.])
    """
    check.choice("shape", shape, SHAPES)
    x = check.array("positions", positions, (None,), unit="m")
    c = check.array("dampings", dampings, (None,), unit="N s/m")
    _check_table(x, c)
    return Program(name, x, c, shape, None if bounds is None else _checked_bounds(bounds))


def _checked_bounds(bounds: Any) -> tuple[float, float]:
    if not isinstance(bounds, tuple | list) or len(bounds) != 2:
        raise TypeError(
            f"bounds must be the least and the largest damping, got {bounds!r}: type for example "
            "(1e3, 30e3)"
        )
    return damping_bounds(*bounds)


def _check_table(x: FloatArray, c: FloatArray) -> None:
    if x.size == 0:
        raise ValueError("positions must hold at least one position in m, got none: type [0.0]")
    if x.size != c.size:
        raise ValueError(
            f"dampings must have one value for each of the {x.size} positions, got {c.size}"
        )
    if np.any(np.diff(x) <= 0):
        i = int(np.argmax(np.diff(x) <= 0))
        raise ValueError(f"positions must increase, got {x[i]:g} m before {x[i + 1]:g} m")
    if np.any(c < 0):
        raise ValueError(f"dampings must be 0 or more [N s/m], got {c[c < 0][0]:g}")
    if not np.any(c > 0):
        raise ValueError("dampings must have a value above 0 [N s/m], got only zeros")
