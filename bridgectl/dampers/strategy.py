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

import control
import numpy as np
from numpy.typing import ArrayLike

from bridgectl import _checks as check
from bridgectl._checks import FloatArray
from bridgectl.dampers.block import RATE_TIME, law_block
from bridgectl.dampers.c_code import usage, write_c
from bridgectl.dampers.expression import SAMPLE_TIME, at_sample, damping_function, depends
from bridgectl.dampers.gains import (
    cases,
    changed_gains,
    checked_gains,
    checked_name,
    checked_preview,
    checked_states,
    damping_bounds,
)
from bridgectl.dampers.legs import checked_leg
from bridgectl.dampers.signals import SIGNALS
from bridgectl.model.crossing import Crossing
from bridgectl.model.vehicle import Vehicle

Law = Callable[[Any, Any], Any]
"""From signals and gains, by name as attributes, to the command c [N s/m], in CasADi operations."""


class Strategy:
    """A damper strategy.

    Write your own in five lines: a function of named signals and gains, in CasADi operations.

    Parameters
    ----------
    name : str
        What tables call it.
    law : callable
        ``law(s, g)`` returns the command c [N s/m]. ``s`` has the signals of
        `bridgectl.dampers.SIGNALS` as attributes, those of other legs of a vehicle by their names
        as ``s.body_velocity_rear``, and what `states` and `preview` add; ``g`` the gains, and
        ``c_min``, ``c_max``. What it returns is kept within [c_min, c_max]; NaN and
        infinity are errors when they occur. It is called once, with CasADi expressions: see the
        errors for what Python does not do to them.
    c_min, c_max : float
        Bounds of the damping [N s/m].
    gains : mapping, optional
        Value, least and largest value of each gain by name, as ``{"share": (0.5, 0.0, 1.0)}``.
    states : mapping, optional
        Initial values of states, as of a filter, by name: attributes of ``s``, beside
        ``s.sample_time`` [s]. Their order is that of C: see `to_c`.
    update : callable, optional
        ``update(s, g)`` returns every state's next value by name. At each sample the law comes
        first: both have the states as the last sample left them.
    preview : array_like, shape (n,), optional
        Distances ahead of the tire [m], rising: ``s.ahead[0]``, ... are the road's elevations there
        less that under the tire [m], positive up. Beyond its end the road is level.

    Raises
    ------
    TypeError, ValueError
        If an argument is not what is described above: bounds reversed, a gain outside its bounds,
        a signal or gain that the law names and that is unknown, a law that takes its signals for
        numbers (by `if`, `and`, `max`, `math.sqrt`, `float`, ...), that fails or that does not
        return one number or expression; and so for `update`.

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
    >>> lifting = Strategy(
    ...     "lifting", lambda s, g: ca.if_else(s.body_velocity < 0, g.c_max, g.c_min), 1e3, 30e3)
    >>> lifting
    Strategy('lifting', c from 1000 to 30000 N s/m)
    >>> lifting.command(body_velocity=[-0.1, 0.1])
    array([30000.,  1000.])

    The same on a velocity without what is faster than 20 rad/s:

    >>> smooth = Strategy(
    ...     "smooth", lambda s, g: ca.if_else(s.low < 0, g.c_max, g.c_min), 1e3, 30e3,
    ...     states={"low": 0.0}, update=lambda s, g: {
    ...         "low": s.low + (1 - ca.exp(-20 * s.sample_time)) * (s.body_velocity - s.low)})
    >>> smooth.command(body_velocity=0.1, low=-0.05)
    array(30000.)

    Against pitch, for any leg of a vehicle whose dampers are called front and rear:

    >>> pitch = Strategy(
    ...     "pitch", lambda s, g: 8e3 + 60e3 * (s.body_velocity_front - s.body_velocity_rear),
    ...     1e3, 30e3)
    >>> pitch.command(body_velocity_front=0.1, body_velocity_rear=[0.0, 0.2])
    array([14000.,  2000.])
    """

    def __init__(
        self,
        name: str,
        law: Law,
        c_min: float,
        c_max: float,
        gains: Mapping[str, tuple[float, float, float]] | None = None,
        states: Mapping[str, float] | None = None,
        update: Callable[[Any, Any], Mapping[str, Any]] | None = None,
        preview: ArrayLike = (),
    ) -> None:
        self.name, self.law, self.update = checked_name(name), law, update
        self.c_min, self.c_max = damping_bounds(c_min, c_max)
        self.bounds = checked_gains({} if gains is None else gains)
        self.gains = {key: value[0] for key, value in self.bounds.items()}
        taken = *SIGNALS, *self.gains, "c_min", "c_max", "sample_time", "ahead"
        self.states = checked_states({} if states is None else states, update, taken)
        self.preview = checked_preview(preview)
        # Of `INPUTS` and to `OUTPUTS`; name, law, bounds and this belong together.
        self.function, self.signals = damping_function(
            self.name, law, update, self.gains, self.states, len(self.preview),
            c_min=self.c_min, c_max=self.c_max,
        )  # fmt: skip

    def __repr__(self) -> str:
        told = "".join(f", {key}={value:g}" for key, value in self.gains.items())
        told += f", states={self.states}" * bool(self.states)
        told += f", preview={self.preview} m" * bool(self.preview)
        return f"Strategy({self.name!r}, c from {self.c_min:g} to {self.c_max:g} N s/m{told})"

    def __getstate__(self) -> dict[str, Any]:
        """Copies, and other processes, have the function alone: it is all that law and update say.

        Expressions that these may hold on to go to no other process.
        """
        return {**vars(self), "law": None, "update": None}

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
        other.name = checked_name(name)
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
        changed = copy(self)
        changed.bounds = changed_gains(self.name, self.bounds, values)
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

    def for_leg(self, leg: int) -> Strategy:
        """Return the law at a damper of a vehicle, counted from 1: see `for_speed`.

        Parameters
        ----------
        leg : int

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
            Others are 0. By name come states, too, else their initial values; `ahead` [m], whose
            last axis is the distances of `preview`, else 0; and `sample_time` [s], else 2 ms.

        Returns
        -------
        ndarray
            Damping c [N s/m], of their shape.

        Raises
        ------
        TypeError, ValueError
            If a signal is unknown or not finite numbers, or the law returns NaN or infinity.
        """
        return self._commanded(signals)

    def evaluate(
        self, rows: FloatArray, gains: FloatArray | None = None, **others: ArrayLike
    ) -> FloatArray:
        """Evaluate the command by CasADi, case by case.

        Parameters
        ----------
        rows : ndarray, shape (n_signals, count)
            The `signals` of each case: see `bridgectl.dampers.SIGNALS` for units.
        gains : ndarray, shape (n_gains, count), optional
            The gains of each case, as `with_gains` takes them; the strategy's own if omitted.
        others : array_like
            States, `ahead` and `sample_time`: see `command`.

        Returns
        -------
        ndarray, shape (count,)
            Damping c [N s/m].

        Raises
        ------
        TypeError, ValueError
            If an argument is not what is described above, or the law returns NaN or infinity.
        """
        signals = check.array("rows", rows, (len(self.signals), None))
        return self._commanded({**dict(zip(self.signals, signals, strict=True)), **others}, gains)

    def _commanded(
        self, given: Mapping[str, ArrayLike], gains: FloatArray | None = None
    ) -> FloatArray:
        known = dict.fromkeys(self.signals, 0.0) | self.states
        shape, time, rows = cases(self.name, known, len(self.preview), given)
        own, count = np.reshape([*self.gains.values()], (-1, 1)), rows.shape[1]
        each = own if gains is None else check.array("gains", gains, (len(own), count))
        if count == 0:
            return np.zeros(shape)
        signals, states, seen = np.split(rows, np.cumsum([len(self.signals), len(self.states)]))
        columns = signals, each, states, [[time]], seen
        return at_sample(self.name, self.function, *columns)[0].reshape(shape)

    def system(
        self, speed: float, *, rate_time: float = RATE_TIME, sample_time: float = SAMPLE_TIME,
        vehicle: Vehicle | None = None, leg: int = 1,
    ) -> control.NonlinearIOSystem:  # fmt: skip
        """Return the strategy as an I/O block for `control.interconnect` with a crossing.

        Parameters
        ----------
        speed : float
            Speed c [m/s] of the crossing.
        rate_time : float, optional
            Time constant T [s] of the rate of the tire force, if the law measures it: (R - L) / T,
            where L' is that rate. The state L, 'lagged_tire_force' [N], starts best at the static
            load.
        sample_time : float, optional
            Time T [s] in which a state x of the law moves to its next value x+: x' = (x+ - x) / T,
            for a short one as the sampled state does. `X0` tells where it starts.
        vehicle : Vehicle, optional
            The vehicle of the crossing, if it is no `QuarterCar`: each of its legs has a block.
        leg : int, optional
            Which of its dampers, counted from 1: outputs are then 'damper_force_1', 'damping_1'.

        Returns
        -------
        control.NonlinearIOSystem
            Inputs as the crossing's outputs ('y_s_dot', 'suspension_velocity', ..., 'tire_force' if
            the law measures it or its rate, accelerations if its states take them), and 'ahead_1',
            ... [m] as `preview` has them; outputs 'damper_force' [N] and 'damping' [N s/m],
            evaluated without delay. The crossing's own vehicle must have damping 0. The block is
            called as the strategy is, with '_' for '.', which no system may have in its name.

        Raises
        ------
        TypeError, ValueError
            If `speed` is not above 0 m/s or a time not above 0 s, or the command depends at once on
            an acceleration, which the damper force changes at once: that needs a sample time, as
            `simulate_loop` has it, or a delay as of `measured`.

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
        own = self if vehicle is None else self.for_leg(checked_leg(vehicle, leg))
        return law_block(own.for_speed(speed), speed, rate_time, sample_time, vehicle, leg)

    @property
    def used(self) -> list[str]:
        """Signals that the command, or a state, depends on, with the gains as they are."""
        return depends(self.function, self.signals, [*self.gains.values()])

    def to_c(self, path: str | Path) -> Path:
        """Write the law as a C file with the function ``damping(signals, gains) -> c``.

        With states or preview it is ``damping(signals, gains, states, sample_time, ahead) -> (c,
        next_states)``: signals in the order of `signals`, gains and states in
        that of `gains` and `states`, these as the last sample left them. The file opens with the
        lines that call it. What is no finite number it returns as it is: NaN or infinity.

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
        title = f"{self.name}, a damping from {self.c_min:g} to {self.c_max:g} N s/m"
        told = self.signals, self.used, self.gains, self.states, len(self.preview)
        return write_c(self.function, path, usage(self.function, title, *told))
