"""A semi-active damper strategy: one CasADi expression from measured signals to a damping.

The command is a damping coefficient c within [c_min, c_max], never a force, so that the damper can
only take energy out. The one expression serves batch simulation, `control.interconnect`,
differentiation and C export.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from copy import copy
from pathlib import Path
from typing import Any

import casadi as ca
import control
import numpy as np
from numpy.typing import ArrayLike

from bridgectl import _checks as check
from bridgectl._checks import FloatArray
from bridgectl.dampers.block import RATE_TIME, law_block
from bridgectl.dampers.c_code import write_c
from bridgectl.dampers.expression import law_function, warn_of_slips
from bridgectl.dampers.gains import checked_gain, checked_gains
from bridgectl.model.crossing import Crossing

SIGNALS = (
    "body_velocity",
    "axle_velocity",
    "suspension_travel",
    "suspension_velocity",
    "body_acceleration",
    "axle_acceleration",
    "tire_force",
    "tire_force_rate",
    "position",
    "speed",
)
"""What a strategy may measure: m/s, m/s, m, m/s, m/s^2, m/s^2, N, N/s, m from the bridge's start,
m/s.

Displacements are positive downward, the suspension's are body minus axle, as in the crossing. The
rate of the tire force is its change since the last sample over the sample time (0 at the first).
"""

Law = Callable[[Any, Any], Any]
"""From signals and gains, by name as attributes, to the command c [N s/m], in CasADi operations."""


class Strategy:
    """A damper strategy.

    Write your own in five lines: a function of named signals and named gains, in CasADi
    operations.

    Parameters
    ----------
    name : str
        What tables call it.
    law : callable
        ``law(s, g)`` returns the command c [N s/m]. ``s`` has the signals of
        `bridgectl.dampers.SIGNALS` as attributes, ``g`` the gains, and ``c_min``, ``c_max``. What
        it returns is kept within [c_min, c_max]; NaN and infinity are errors when they occur. It
        is called once, with CasADi expressions: see the errors for what Python does not do to them.
    c_min, c_max : float
        Bounds of the damping [N s/m].
    gains : mapping, optional
        Value, least and largest value of each gain by name, as ``{"share": (0.5, 0.0, 1.0)}``.

    Raises
    ------
    TypeError, ValueError
        If a bound, a gain or the law is not what is described above: bounds reversed, a gain
        outside its bounds, a signal or gain that the law names and that is unknown, a law that
        takes its signals for numbers (by `if`, `and`, `max`, `math.sqrt`, `float`, ...), that fails
        or that does not return one number or expression.

    Warns
    -----
    UserWarning
        If what the law returns changes its sign with the motion, as a force does, or is a hundred
        times below `c_min` or above `c_max`, as in kN s/m.

    Examples
    --------
    A damper that is stiff while the body moves up:

    >>> import casadi as ca
    >>> from bridgectl.dampers import Strategy
    >>> def law(s, g):
    ...     return ca.if_else(s.body_velocity < 0, g.c_max, g.c_min)
    >>> lifting = Strategy("lifting", law, 1e3, 30e3)
    >>> lifting
    Strategy('lifting', c from 1000 to 30000 N s/m)
    >>> lifting.command(body_velocity=[-0.1, 0.1])
    array([30000.,  1000.])
    """

    def __init__(
        self,
        name: str,
        law: Law,
        c_min: float,
        c_max: float,
        gains: Mapping[str, tuple[float, float, float]] | None = None,
    ) -> None:
        if not callable(law):
            raise TypeError(f"law must be a function law(s, g), got {type(law).__name__}")
        self.name, self.law = _name(name), law
        self.c_min, self.c_max = damping_bounds(c_min, c_max)
        self.bounds = checked_gains({} if gains is None else gains)
        self.gains = {key: value[0] for key, value in self.bounds.items()}
        limits = {"c_min": self.c_min, "c_max": self.c_max}
        free = law_function(self.name, law, SIGNALS, [*self.gains], **limits)
        warn_of_slips(self.name, free, SIGNALS, np.array([*self.gains.values()]), **limits)
        # Of signals and gains, columns in their orders; name, law, bounds and this belong together.
        self.function = _within(free, self.c_min, self.c_max)

    def __repr__(self) -> str:
        gains = "".join(f", {key}={value:g}" for key, value in self.gains.items())
        return f"Strategy({self.name!r}, c from {self.c_min:g} to {self.c_max:g} N s/m{gains})"

    def renamed(self, name: str) -> Strategy:
        """Return the strategy under another name.

        Parameters
        ----------
        name : str
            What tables call it.

        Returns
        -------
        Strategy

        Raises
        ------
        TypeError
            If it is not a string, or empty.
        """
        other = copy(self)
        other.name = _name(name)
        return other

    def with_gains(self, **values: float) -> Strategy:
        """Return the strategy with other values of some gains.

        Parameters
        ----------
        values : float
            Gains by name, each in a unit of its own: see `gains`.

        Returns
        -------
        Strategy

        Raises
        ------
        ValueError
            If a gain is unknown or outside its bounds.
        """
        if unknown := set(values) - set(self.bounds):
            known = ", ".join(self.bounds) or "none"
            raise ValueError(f"{self.name} has no gain {sorted(unknown)[0]!r}, its gains: {known}")
        changed = copy(self)
        changed.bounds = {
            key: checked_gain(key, (values.get(key, value), low, high))
            for key, (value, low, high) in self.bounds.items()
        }
        changed.gains = {key: value[0] for key, value in changed.bounds.items()}
        return changed

    def for_speed(self, speed: float) -> Strategy:
        """Return the law at a speed: itself, but for strategies that depend on it.

        Parameters
        ----------
        speed : float
            Speed c [m/s].

        Returns
        -------
        Strategy
        """
        return self

    @property
    def kept(self) -> FloatArray | None:
        """Dampings [N s/m], the best of which a crossing keeps throughout; None of most."""
        return np.array([self.c_max]) if self.c_min == self.c_max else None

    def gains_for(
        self, crossing: Crossing, speeds: FloatArray, stations: FloatArray, elevations: FloatArray
    ) -> Mapping[str, FloatArray]:
        """Return gains that each crossing has its own value of, by name: none but for a `preset`.

        Parameters
        ----------
        crossing : Crossing
            Beam, vehicle and section.
        speeds, stations, elevations : ndarray, shapes (S,), (n,) and (R, n)
            Speeds [m/s], stations and elevations of the roads [m].

        Returns
        -------
        mapping
            To arrays of shape (S, R), in the units of the gains. See `preset`.
        """
        return {}

    def command(self, **signals: ArrayLike) -> FloatArray:
        """Evaluate the command for arrays of signals.

        Parameters
        ----------
        signals : array_like
            Signals by name, of shapes that broadcast: see `bridgectl.dampers.SIGNALS` for units.
            Others are 0.

        Returns
        -------
        ndarray
            Damping c [N s/m], of their shape.

        Raises
        ------
        TypeError, ValueError
            If a signal is unknown or not finite numbers, or the law returns NaN or infinity.
        """
        if unknown := set(signals) - set(SIGNALS):
            raise ValueError(f"unknown signal {sorted(unknown)[0]!r}, known: {', '.join(SIGNALS)}")
        arrays = {name: self._measured(name, value) for name, value in signals.items()}
        try:
            given: Any = np.broadcast_arrays(*arrays.values())
        except ValueError:
            shapes = ", ".join(f"{name} {value.shape}" for name, value in arrays.items())
            raise ValueError(f"signals must have shapes that broadcast, got {shapes}") from None
        shape = given[0].shape if arrays else ()
        rows = np.zeros((len(SIGNALS), int(np.prod(shape))))
        for name, values in zip(signals, given, strict=True):
            rows[SIGNALS.index(name)] = values.ravel()
        return self.evaluate(rows).reshape(shape)

    def _measured(self, name: str, value: ArrayLike) -> FloatArray:
        try:
            shape = np.shape(value)
        except ValueError:  # rows of different lengths, which the check tells of
            shape = ()
        try:
            return check.array(name, value, shape)
        except ValueError as error:
            raise ValueError(f"{error}: from that {self.name} returned NaN") from None

    def evaluate(self, rows: FloatArray, gains: FloatArray | None = None) -> FloatArray:
        """Evaluate the command by CasADi, case by case.

        Parameters
        ----------
        rows : ndarray, shape (n_signals, count)
            The signals of each case: see `bridgectl.dampers.SIGNALS` for order and units.
        gains : ndarray, shape (n_gains, count), optional
            The gains of each case, as `with_gains` takes them; the strategy's own if omitted.

        Returns
        -------
        ndarray, shape (count,)
            Damping c [N s/m].

        Raises
        ------
        TypeError, ValueError
            If an argument is not what is described above, or the law returns NaN or infinity.
        """
        signals = check.array("rows", rows, (len(SIGNALS), None))
        own = [[value] for value in self.gains.values()]
        count = signals.shape[1]
        if count == 0:
            return np.zeros(0)
        shape = len(own), count
        each = np.tile(own, count) if gains is None else check.array("gains", gains, shape)
        command: Any = self.function.map(count)(signals, each)
        return numbers(self.name, command.full().ravel())

    def system(self, speed: float, *, rate_time: float = RATE_TIME) -> control.NonlinearIOSystem:
        """Return the strategy as an I/O block for `control.interconnect` with a crossing.

        Parameters
        ----------
        speed : float
            Speed c [m/s] of the crossing: position and speed are signals.
        rate_time : float, optional
            Time constant T [s] of the rate of the tire force, if the law measures it: (R - L) / T,
            where L' is that rate. The state L, 'lagged_tire_force' [N], starts best at the static
            load.

        Returns
        -------
        control.NonlinearIOSystem
            Inputs as the crossing's outputs ('y_s_dot', 'suspension_velocity', ..., 'tire_force' if
            the law measures it or its rate), outputs 'damper_force' [N] and 'damping' [N s/m],
            evaluated without delay. The crossing's own vehicle must have damping 0. The block is
            called as the strategy is, with '_' for '.', which no system may have in its name.

        Raises
        ------
        TypeError, ValueError
            If `speed` is not above 0 m/s or `rate_time` not above 0 s, or the law measures an
            acceleration, which the damper force changes at once: that needs a sample time, as
            `simulate_loop` has it.

        Examples
        --------
        Clipped optimal damping in the loop:

        >>> import dataclasses
        >>> import control as ct
        >>> import bridgectl as bc
        >>> from bridgectl.dampers import clipped_lqr
        >>> law = clipped_lqr(bc.li2006.car(), 1e3, 30e3).system(25.0)
        >>> bare = dataclasses.replace(bc.li2006.car(), damping=0.0)
        >>> crossing = bc.crossing_system(bc.li2006.beam(), bare, 25.0)
        >>> loop = ct.interconnect(
        ...     [crossing, law], inputs=["road"], outputs=["moment", "damping"], check_unused=False)
        >>> loop.nstates
        10
        """
        return law_block(self, SIGNALS, speed, rate_time)

    @property
    def used(self) -> list[str]:
        """Signals that the command depends on, with the gains as they are."""
        signals = ca.SX.sym("s", len(SIGNALS))
        command = self.function(signals, ca.DM([*self.gains.values()]))
        depends = ca.which_depends(command, signals, 1, False)
        return [name for name, matters in zip(SIGNALS, depends, strict=True) if matters]

    def to_c(self, path: str | Path) -> Path:
        """Write the law as a C file with the function ``damping(signals, gains) -> c``.

        What is no finite number the function returns as it is: NaN or infinity.

        Parameters
        ----------
        path : str or Path
            A name ending in .c, in a folder that exists.

        Returns
        -------
        Path
            The file written.

        Raises
        ------
        TypeError, ValueError
            If it is not a path, or does not end in .c.
        OSError
            If the file cannot be written.
        """
        return write_c(self.function, path)


def damping_bounds(c_min: float, c_max: float) -> tuple[float, float]:
    """Check bounds of the damping [N s/m]."""
    soft = check.not_negative("c_min", c_min, unit="N s/m")
    stiff = check.positive("c_max", c_max, unit="N s/m")
    if soft > stiff:
        raise ValueError(
            f"c_min must not exceed c_max, got {soft:g} and {stiff:g} N s/m: swap them"
        )
    return soft, stiff


def numbers(name: str, command: FloatArray) -> FloatArray:
    """Return the commands of a law, if all are finite numbers."""
    if not np.isfinite(command).all():
        what = "NaN" if np.isnan(command).any() else "infinity, a division by 0"
        raise ValueError(
            f"the law of {name} returned {what}: guard divisions, for example by "
            "ca.if_else(ca.fabs(s.suspension_velocity) < 1e-6, ...)"
        )
    return command


def _within(law: ca.Function, c_min: float, c_max: float) -> ca.Function:
    """Return a law kept within bounds: the CasADi function "damping" of signals and gains."""
    signals, gains = law.sx_in()
    command: Any = law(signals, gains)
    # fmin and fmax would make a bound of NaN, and of what a division by 0 gives: those are told.
    kept = ca.if_else(ca.fabs(command) < np.inf, ca.fmin(ca.fmax(command, c_min), c_max), command)
    return ca.Function("damping", [signals, gains], [kept], ["signals", "gains"], ["c"])


def _name(name: Any) -> str:
    if not isinstance(name, str) or not name:
        raise TypeError(f'name must be a string, got {name!r}: type for example "skyhook"')
    return name
