"""Bridgehook: a damper that works against the bending moment of the bridge it is on.

A force F_d(t) between body and axle changes the peak moment by sigma(t) = dM / dF_d(t) for each
N s, and a damper has the choice of how much of F_d = c v to give, v = y_s' - y_t'::

    c = c_max where sigma v < 0, c_min elsewhere

Two sigmas are here. With feedback (the default) it is the worth of a force before a peak that the
road may bring sooner or later, affine in the measured velocities of body and axle::

    sigma = s(x) + b(x) y_s' + a(x) y_t'

by `bridgectl.dampers.peak_value`, from `REACH` before the bridge to its end. Without feedback it is
the costate of the passive crossing of a smooth road, up to the time t* of its peak: one backward
pass through the crossing's own transition matrices::

    sigma(t) = lambda(t)' B_F,   lambda' = -A' lambda,   lambda(t*)' = row of M

Elsewhere the damper is passive. Either needs position and speed, and no preview of the road. Where
the ride counts too, sigma holds what a force is worth to it, and c need not be at a bound: see
`bridgectl.dampers.weights`. Of a position that is known to a standard deviation d alone, the mean
counts, that of the sigmas of all places where the tire may be::

    sigma(x) = E[sigma(x + d n)],  n normal with mean 0 and deviation 1
"""

from __future__ import annotations

from copy import copy
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import casadi as ca
import numpy as np
from numpy.typing import ArrayLike

from bridgectl import _checks as check
from bridgectl._checks import FloatArray
from bridgectl.dampers.costate import REACH, Costate, costate
from bridgectl.dampers.legs import Legs, checked_leg, require_dampers
from bridgectl.dampers.peak_value import PeakValue, blurred, peak_values
from bridgectl.dampers.strategy import Strategy
from bridgectl.dampers.weights import best_damping, checked_weights, crossing_time, side_worth
from bridgectl.model.bridge import BridgeModel
from bridgectl.model.crossing import make_crossing
from bridgectl.model.effect import Effect
from bridgectl.model.quarter_car import QuarterCar
from bridgectl.model.vehicle import Vehicle

SPACING = 0.7
"""Largest distance between knots on the bridge [m]: an axle hop takes more than a metre."""

KNOTS = 16
"""Knots on the approach: with three times as many the mean DAF over speeds changes by 0.001."""

PLACES = 32
"""Places where sigma may change its sign come in multiples of this; see `_costate_law`."""

FAR = 1e9
"""A place [m] that no vehicle comes to."""


class Bridgehook(Strategy):
    """The bridgehook strategy; made by `bridgehook`. At each speed it has its own law.

    >>> import bridgectl as bc
    >>> from bridgectl.dampers import bridgehook
    >>> bridgehook(bc.li2006.beam(), bc.li2006.car(), 1e3, 30e3)
    Bridgehook('bridgehook', c from 1000 to 30000 N s/m, for a bridge of 25 m, feedback=True, \
lag=0 s, position_deviation=0 m)
    """

    def __init__(
        self,
        beam: BridgeModel,
        vehicle: Vehicle | QuarterCar,
        c_min: float,
        c_max: float,
        section: float = 0.5,
        *,
        effect: Effect | str = "moment",
        feedback: bool = True,
        lag: float = 0.0,
        position_deviation: float = 0.0,
        ride: float = 0.0,
        travel: float = 0.0,
        tire_force: float = 0.0,
    ) -> None:
        # The crossing checks beam, vehicle and effect.
        self.effect = make_crossing(beam, vehicle, effect, section).effect
        require_dampers(vehicle)
        if not isinstance(feedback, bool | np.bool_):
            raise TypeError(f"feedback must be True or False, got {feedback!r}")
        self.beam, self.vehicle, self.feedback = beam, vehicle, bool(feedback)
        self.lag = check.not_negative("lag", lag, unit="s")
        self.position_deviation = check.not_negative(
            "position_deviation", position_deviation, unit="m"
        )
        self.weights = checked_weights(ride, travel, tire_force)
        if any(self.weights) and not feedback:
            raise ValueError(
                "ride, travel and tire_force must be 0 without feedback, which they are part of: "
                "leave out feedback=False"
            )
        self.leg, self.laws = 1, dict[tuple[int, float], Strategy]()
        self.worths: dict[float, list[PeakValue]] = {}
        super().__init__("bridgehook", self._untold, c_min, c_max)

    def __repr__(self) -> str:
        return (
            f"Bridgehook({self.name!r}, c from {self.c_min:g} to {self.c_max:g} N s/m, for a "
            f"bridge of {self.beam.length:g} m, feedback={self.feedback}, lag={self.lag:g} s, "
            f"position_deviation={self.position_deviation:g} m"
            f"{f', {self.weights}' if any(self.weights) else ''})"
        )

    @staticmethod
    def _untold(s: Any, g: Any) -> Any:
        """Without a speed there is no law: see `for_speed`."""
        return g.c_min + 0 * s.speed

    def for_speed(self, speed: float) -> Strategy:
        """Return the law at a speed [m/s]: see `Strategy.for_speed`."""
        c = check.positive("speed", speed, unit="m/s")
        if (self.leg, c) not in self.laws:
            self.laws[self.leg, c] = self._made(c)
        return self.laws[self.leg, c]

    def for_leg(self, leg: int) -> Bridgehook:
        """Return the law of a damper of the vehicle: see `Strategy.for_leg`."""
        other = copy(self)
        other.leg = checked_leg(self.vehicle, leg)
        return other

    def _made(self, speed: float) -> Strategy:
        if not self.feedback:
            simple = costate(self.beam, self.vehicle, speed, effect=self.effect, leg=self.leg)
            return _costate_law(Costate(*blurred(simple, self.position_deviation)), self)
        return _feedback_law(self._worth(speed), self, self._square(speed))

    def _worth(self, speed: float) -> PeakValue:
        """What a force is worth, in the mean over the places where the tire may be."""
        if speed not in self.worths:  # those of all legs come together
            case = self.beam, self.vehicle, speed, self.c_min, self.c_max
            self.worths[speed] = peak_values(
                *case, effect=self.effect, reach=REACH, beside=self.weights,
                position_deviation=self.position_deviation,
            )  # fmt: skip
        return self.worths[speed][self.leg - 1]

    def _square(self, speed: float) -> float:
        """What the square of a force beyond the passive one costs [1/(N^2 s)]."""
        case = self.vehicle, self.weights, self.c_min, self.c_max
        return float(side_worth(*case, crossing_time(self.beam, speed)).squares[self.leg - 1])

    def command(self, **signals: ArrayLike) -> FloatArray:
        """Evaluate the command [N s/m] at one speed, one of the signals: see `Strategy.command`."""
        speed: Any = signals.get("speed", ())
        if np.ndim(speed) != 0:
            raise ValueError(
                f"{self.name} has a law for each speed: type for example command(speed=25.0, ...)"
            )
        return self.for_speed(speed).command(**signals)

    def to_c(self, path: str | Path) -> Path:
        """Refuse: a C file holds the law of one speed, ``bridgehook(...).for_speed(25.0)``."""
        raise ValueError(
            f"{self.name} has a law for each speed: type for example law.for_speed(25.0).to_c(path)"
        )

    @property
    def passive_damping(self) -> float:
        """Damping before and after it is commanded [N s/m]: the vehicle's own, in its range."""
        own = self.vehicle.linear.damper_dampings[self.leg - 1]
        return float(np.clip(own, self.c_min, self.c_max))

    @property
    def behind(self) -> float:
        """How far the leg is behind the reference tire, whose places count [m]."""
        return float(Legs(self.vehicle.linear).offsets[self.leg - 1])


def bridgehook(
    beam: BridgeModel,
    vehicle: Vehicle | QuarterCar,
    c_min: float,
    c_max: float,
    *,
    section: float = 0.5,
    effect: Effect | str = "moment",
    feedback: bool = True,
    lag: float = 0.0,
    position_deviation: float = 0.0,
    ride: float = 0.0,
    travel: float = 0.0,
    tire_force: float = 0.0,
) -> Bridgehook:
    """Return the damper that works against the bending moment of a bridge.

    It has to know bridge, vehicle and speed, and to measure position and the velocities of body
    and axle. `bridgectl.dampers.bridgehook` and `bridgectl.dampers.peak_value` have the formulas.

    Parameters
    ----------
    beam : Beam
        The bridge that sigma is computed for.
    vehicle : Vehicle or QuarterCar
        The vehicle, with its passive damping. Each of its dampers has a law of its own, in which
        all have c from `c_min` to `c_max`.
    section, effect : optional
        What it works against: see `bridgectl.daf`. A moment at mid-span if omitted.
    c_min, c_max : float
        Bounds of the damping [N s/m].
    feedback : bool, optional
        False for the costate of a smooth road, which takes the sign of the suspension velocity
        alone. It is simpler, and where the road decides when the peak comes it can be worse than
        a passive damper; at every axle of a truck with five it is, on roads of class B by 0.113.
    lag : float, optional
        Time [s] by which the damper is late, as its `Damper.lag`: position and velocities are
        taken that much later, as c t and by the accelerations, which then are measured too.
    position_deviation : float, optional
        Standard deviation of the error of its position [m], as of its `Damper`. It then asks what a
        force is worth in the mean over the places where the tire may be.
    ride, travel, tire_force : float, optional
        What else counts beside the DAF, with weights: the mean squares, over time, of the body's
        acceleration in m/s^2, of the suspension travel in 10 mm and of the tire force's deviation
        from the static one over that. See the notes, and `bridgectl.dampers.weights`.

    Returns
    -------
    Bridgehook

    Raises
    ------
    TypeError, ValueError
        If an argument is not what is described above.

    Notes
    -----
    The paper's truck and bridge, 60 to 120 km/h, 60 m of approach, c from 1 to 30 kN s/m, 200
    random roads of each ISO class (`tests/benchmarks/bridgehook.py`); mean DAF over roads at the
    worst speed, and over all speeds::

                                class A          class B
        passive 7 kN s/m        1.135  1.055     1.142  1.072
        without feedback        1.058  0.993     1.052  0.998
        bridgehook              1.055  0.985     0.994  0.966
        with lag and noise      1.072  0.997     1.022  0.984
        the lag made up for     1.064  0.992     1.007  0.973

    Without feedback it is worse than passive by up to 0.027 (A) and 0.066 (B), near 82 km/h; with
    feedback nowhere. The damper's lag is 10 ms, which `lag` makes up for; the noise is 5 % of the
    RMS velocities. The rougher the road, the more the suspension moves and the more there is to
    use; on a smooth road no damper does anything.

    Told of places some way before or behind the true ones, it loses its gain. Made for that, by
    `position_deviation`, it gives up some of the gain for a smaller loss; a metre is a quarter to a
    third of the way that the truck goes in an axle hop. Changes of the mean DAF from passive at 70,
    90 and 108 km/h, 120 roads of class A and of class B (`tests/benchmarks/sensors.py`), errors of
    either sign::

        deviation      0 m             0.3 m           1 m             3 m
        no error      -0.078 -0.118   -0.077 -0.118   -0.071 -0.109   -0.051 -0.079
        0.3 m         -0.073 -0.109   -0.073 -0.110   -0.069 -0.106   -0.050 -0.078
        1 m           -0.037 -0.052   -0.037 -0.055   -0.043 -0.076   -0.040 -0.069
        3 m           +0.019 +0.038   +0.019 +0.036   +0.011 +0.008   -0.013 -0.031

    Half a metre of deviation costs nothing (40 roads: 0.001), and helps on a bridge of another
    frequency: at 1.2 times that known -0.024 -0.019, not -0.022 -0.009; with 1.5 m -0.032 -0.054,
    and -0.056 -0.095 without an error. `bridgectl.robustness` tries these errors and others.

    It doubles acceleration and travel; by weights they are spared. Mean DAF at 70, 90 and 108 km/h,
    50 roads of class A and of class B (`tests/benchmarks/weights.py`), 95 % within 0.004 (A) and
    0.009 (B) of the difference from passive; ride weighted as ISO 2631-1 does, and largest travel,
    over passive's::

        ride, tire_force     A: DAF  ride  travel     B: DAF  ride  travel
        passive               1.071  1.00  1.00        1.087  1.00  1.00
        0, 0                  0.995  1.61  2.01        0.973  1.60  1.97
        0.1, 0.8              0.996  1.53  2.00        0.975  1.40  1.84
        0.2, 1.6              0.997  1.44  1.90        0.981  1.27  1.59
        0.4, 0                1.000  1.24  1.57        0.997  1.13  1.28
        0.4, 3.2              1.000  1.31  1.64        0.989  1.17  1.31
        1.6, 12.8             1.010  1.11  1.05        1.004  1.03  0.96

    At every axle of a truck each damper counts on bridgehook at the others. Trucks of the catalog
    on springs for tires, c from 2 to 30 kN s/m, 100 roads of class A and of class B, 60 to 120
    km/h: changes of the mean DAF from passive 10 kN s/m, 95 % within 0.007 (without feedback 0.01),
    and that of the worst speed; places wrong by 1 m of either sign (`tests/benchmarks/trucks.py`)::

                                  T2              T2A01           T5air
        bridgehook               -0.032 -0.061   -0.068 -0.105   -0.101 -0.113
        at the worst speed       -0.022 -0.041   -0.055 -0.064   -0.039 -0.052
        1 m off                  -0.031 -0.060   -0.050 -0.080   -0.054 -0.050
        1 m off, made for that   -0.030 -0.060   -0.052 -0.084   -0.063 -0.067
        without feedback         -0.014 -0.004   -0.048 -0.049   +0.005 +0.113

    So it does no harm at any speed; without feedback it does at five axles, up to 0.222 at 70 km/h.
    Told of places a metre before the true ones bridgehook still gains 0.006 there. No law of the
    library that does not know the road is below it at any speed; at T2, with stiff springs, skyhook
    and `preset` are close.

    Examples
    --------
    >>> import bridgectl as bc
    >>> from bridgectl.dampers import bridgehook
    >>> law = bridgehook(bc.li2006.beam(), bc.li2006.car(), 1e3, 30e3).for_speed(25.0)
    >>> law.command(position=[-70.0, 11.0, 26.0], axle_velocity=0.1, suspension_velocity=-0.1)
    array([ 7000., 30000.,  7000.])
    """
    return Bridgehook(
        beam, vehicle, c_min, c_max, section, effect=effect, feedback=feedback, lag=lag,
        position_deviation=position_deviation, ride=ride, travel=travel, tire_force=tire_force,
    )  # fmt: skip


def _feedback_law(found: PeakValue, owner: Bridgehook, square: float) -> Strategy:
    """The law of the worth of a force, straight between knots that are the same at all speeds."""
    end = float(found.positions[-1])
    before = -REACH * np.linspace(1, 0, KNOTS, endpoint=False) ** 2  # closer and closer
    on_bridge = np.linspace(0, end, int(np.ceil(end / SPACING)) + 1)
    knots = np.concatenate([before, on_bridge])
    tables = np.array([np.interp(knots, found.positions, values) for values in found[1:]])
    first = np.diff(tables[:, :2]) / np.diff(knots[:2])
    bends = np.diff(np.diff(tables) / np.diff(knots), prepend=first, axis=1)
    bends[:, 0] = first[:, 0]

    def law(signals: Any, g: Any) -> Any:
        s = _later(signals, owner.lag, owner.behind)
        place = ca.fmin(ca.fmax(s.position, -REACH), end)
        beyond = [ca.fmax(place - float(knot), 0) for knot in knots[:-1]]
        constant, body, axle = (
            float(table[0]) + sum(float(b) * u for b, u in zip(bend, beyond, strict=True))
            for table, bend in zip(tables, bends, strict=True)
        )
        sigma = constant + body * s.body_velocity + axle * s.axle_velocity
        return _switched(sigma, s, g, -REACH, end, owner, square)

    return Strategy(owner.name, law, owner.c_min, owner.c_max)


def _costate_law(found: Costate, owner: Bridgehook) -> Strategy:
    """The law switched at the places where the costate changes its sign.

    Each place is a factor of the sign, -1 when it is passed. Places that are always or never passed
    fill up their number, so that the laws of all speeds are the same operations.
    """
    x, sigma = found
    positive = sigma[:-1] > 0  # at the peak itself a force is worth nothing yet
    turns = np.nonzero(positive[1:] != positive[:-1])[0]
    share = sigma[turns] / (sigma[turns] - sigma[turns + 1])
    places = [*(x[turns] + share * (x[turns + 1] - x[turns]))]
    if not positive[0]:
        places.append(-FAR)
    filled = PLACES * (len(places) // PLACES + 1)
    places += [FAR * (1 + 0.1 * k) for k in range(filled - len(places))]
    start, end = float(x[0]), float(x[-1])

    def law(signals: Any, g: Any) -> Any:
        s = _later(signals, owner.lag, owner.behind)
        sign: Any = 1.0
        for place in places:
            sign = sign * (2 * (s.position < float(place)) - 1)
        return _switched(sign, s, g, start, end, owner)

    return Strategy(owner.name, law, owner.c_min, owner.c_max)


def _switched(
    sigma: Any, s: Any, g: Any, start: float, end: float, owner: Bridgehook, square: float = 0.0
) -> Any:
    active = ca.logic_and(s.position >= start, s.position <= end)
    passive = owner.passive_damping
    return ca.if_else(
        active, best_damping(sigma, square, passive, s.suspension_velocity, g), passive
    )


def _later(s: Any, time: float, behind: float) -> Any:
    """The signals that count, as they will be a time [s] from now; the reference tire's place."""
    if time == behind == 0:
        return s
    place = s.position + behind
    if time == 0:
        return SimpleNamespace(**{**vars(s), "position": place})
    return SimpleNamespace(
        position=place + time * s.speed,
        body_velocity=s.body_velocity + time * s.body_acceleration,
        axle_velocity=s.axle_velocity + time * s.axle_acceleration,
        suspension_velocity=s.suspension_velocity
        + time * (s.body_acceleration - s.axle_acceleration),
    )
