"""Sensors on a truck: linear filters from what they measure to estimates of other signals.

Of the measurements m the estimates are y::

    x' = A x + B m,    y = y_0 + C x

From sample to sample m is held, and x moves exactly, for any sample time. A filter that knows the
vehicle, and the damping c that it commands, moves as the vehicle with a nominal c_0 does, with the
force of c - c_0 at the middle of the sample, and corrects what it has predicted to be measured::

    x' = A x + b (c - c_0) n x + K (m - m_predicted)

Estimates have no part of the measurements of their own sample: none depends on an acceleration at
once, so that there is no loop through the damper force.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, NamedTuple

import casadi as ca
import control
import numpy as np

from bridgectl import _checks as check
from bridgectl._checks import FloatArray
from bridgectl.dampers.expression import SAMPLE_TIME
from bridgectl.dampers.lqr import regulator
from bridgectl.dampers.passive_theory import comfort_damping, road_damping, white_velocity
from bridgectl.model.quarter_car import QuarterCar, require_quarter_car

VELOCITIES = ("body_velocity", "axle_velocity", "suspension_velocity")
"""What each of the filters estimates."""

ACCELERATIONS = ("body_acceleration", "axle_acceleration")
"""What accelerometers measure."""

CORNER = 0.5
"""Rate [rad/s] below which velocities from accelerometers are forgotten: a sixth of the rate of a
truck's body on its springs."""

CROSSOVER = 12.0
"""Rate [rad/s] that parts the travel's share of a suspension velocity from the accelerometers': the
square root of their noises' ratio, 0.07 m/s^2 to 0.5 mm."""


STANDING = 1e-7
"""Rate [rad/s] of a state that is kept: in an hour it changes by less than a thousandth."""


class Model(NamedTuple):
    """What a filter knows of a vehicle."""

    seen: FloatArray
    """What is measured per state, (m, n)."""
    per_force: FloatArray
    """And per force of the damper beside the nominal one [1/N], (m,)."""
    force: FloatArray
    """b, rates of the states per such force, (n,)."""
    velocity_row: FloatArray
    """n, suspension velocity [m/s] per state, (n,)."""
    damping: float
    """c_0 [N s/m]."""


@dataclass(frozen=True, eq=False)
class Sensors:
    """A filter from what sensors measure to what a strategy wants to know; see `measured`.

    Made by `accelerometers`, `complementary` and `kalman`, or with matrices of your own: estimates
    are C x + y_0, with x' = A x + B m of the measurements m.

    Parameters
    ----------
    name : str
        What it is called.
    inputs, outputs : tuple of str
        Signals measured and estimated: see `bridgectl.dampers.SIGNALS` for their units.
    state_matrix, input_matrix, output_matrix : ndarray, shapes (n, n), (n, m) and (p, n)
        A [1/s], B and C, between states of your own and signals in SI units.
    offsets : ndarray, shape (p,)
        y_0, in the units of the estimates [m/s, m, N, ...].
    model : optional
        What a filter knows of the vehicle, whose gain K [1/s] then is B; see `kalman`.

    Examples
    --------
    >>> from bridgectl.dampers import Sensors
    >>> Sensors.accelerometers()
    Sensors('accelerometers', from body_acceleration, axle_acceleration to body_velocity, \
axle_velocity, suspension_velocity, memory=2 s)
    """

    name: str
    inputs: tuple[str, ...]
    outputs: tuple[str, ...]
    state_matrix: FloatArray
    input_matrix: FloatArray
    output_matrix: FloatArray
    offsets: FloatArray
    model: Model | None = None

    @classmethod
    def accelerometers(cls, corner: float = CORNER) -> Sensors:
        """Return accelerometers on body and axle: velocities by leaky integration.

        Each is v' = a - corner v: above the corner a velocity, below it forgotten, with all that an
        accelerometer drifts by.

        Parameters
        ----------
        corner : float, optional
            Rate of forgetting [rad/s].

        Returns
        -------
        Sensors

        Raises
        ------
        TypeError, ValueError
            If the corner is not above 0.

        Examples
        --------
        >>> from bridgectl.dampers import Sensors, measured, skyhook
        >>> measured(skyhook(1e3, 30e3), Sensors.accelerometers()).name
        'skyhook (accelerometers)'
        """
        leak = check.positive("corner", corner, unit="rad/s")
        estimates = np.array([[1.0, 0.0], [0.0, 1.0], [1.0, -1.0]])
        return cls(
            "accelerometers", ACCELERATIONS, VELOCITIES, -leak * np.eye(2), np.eye(2), estimates,
            np.zeros(3),
        )  # fmt: skip

    @classmethod
    def complementary(cls, corner: float = CORNER, crossover: float = CROSSOVER) -> Sensors:
        """Return accelerometers on body and axle, and a sensor of the travel between them.

        The suspension velocity is, above the crossover, from the accelerometers and, below it, from
        the travel d: w' = a_body - a_axle + q^2 (d - d_w), d_w' = w + sqrt(2) q (d - d_w). The
        body's velocity is from its accelerometer alone, see `accelerometers`; that of the axle is
        the body's less w.

        Parameters
        ----------
        corner : float, optional
            Rate of forgetting of the body's velocity [rad/s].
        crossover : float, optional
            q [rad/s].

        Returns
        -------
        Sensors

        Raises
        ------
        TypeError, ValueError
            If a rate is not above 0.

        Examples
        --------
        >>> from bridgectl.dampers import Sensors, groundhook, measured
        >>> measured(groundhook(1e3, 30e3), Sensors.complementary()).name
        'groundhook (complementary filter)'
        """
        leak = check.positive("corner", corner, unit="rad/s")
        q = check.positive("crossover", crossover, unit="rad/s")
        state = np.array([[-leak, 0, 0], [0, -np.sqrt(2) * q, 1], [0, -(q**2), 0]])
        measured = np.array([[1.0, 0, 0], [0, 0, np.sqrt(2) * q], [1, -1, q**2]])
        estimates = np.array([[1.0, 0, 0], [1, 0, -1], [0, 0, 1]])
        return cls(
            "complementary filter", (*ACCELERATIONS, "suspension_travel"), VELOCITIES, state,
            measured, estimates, np.zeros(3),
        )  # fmt: skip

    @classmethod
    def kalman(
        cls,
        vehicle: QuarterCar,
        *,
        acceleration_noise: float = 0.05,
        travel_noise: float = 0.5e-3,
        roughness: str | float = "A",
        speed: float = 25.0,
        sample_time: float = SAMPLE_TIME,
    ) -> Sensors:
        """Return an accelerometer on the body and a sensor of the travel, with a Kalman filter.

        It knows the quarter-car and the dampings that it commands, and takes the velocity of the
        surface under the tire for white noise: `control.lqe` of x = [d, y_s', e, y_t'], as in
        `clipped_lqr`. It knows no bridge.

        Parameters
        ----------
        vehicle : QuarterCar
            The vehicle; its own damping does not matter.
        acceleration_noise, travel_noise : float, optional
            Standard deviations of the noise of each sample [m/s^2] and [m].
        roughness : str or float, optional
            Road that is expected: an ISO class, or G_d(n_0) [m^3].
        speed : float, optional
            Speed that is expected [m/s].
        sample_time : float, optional
            Time between samples for which the noise is told [s].

        Returns
        -------
        Sensors

        Raises
        ------
        TypeError, ValueError
            If an argument is not what is described above.

        Examples
        --------
        >>> import bridgectl as bc
        >>> from bridgectl.dampers import Sensors, measured, tire_groundhook
        >>> sensors = Sensors.kalman(bc.li2006.car(), travel_noise=1e-3)
        >>> measured(tire_groundhook(1e3, 30e3), sensors).name
        'tire groundhook (Kalman filter)'
        """
        time = check.positive("sample_time", sample_time, unit="s")
        noise = [
            check.positive("acceleration_noise", acceleration_noise, unit="m/s^2"),
            check.positive("travel_noise", travel_noise, unit="m"),
        ]
        car = regulator(require_quarter_car(vehicle))
        damping = float(np.sqrt(comfort_damping(vehicle) * road_damping(vehicle)))
        rate, force = np.array([0.0, 1.0, 0.0, -1.0]), car.input_matrix[:, 0]
        state = car.state_matrix + damping * np.outer(force, rate)
        seen = np.array([state[1], [1.0, 0.0, 0.0, 0.0]])  # y_s'' and d
        intensity = white_velocity(roughness, check.positive("speed", speed, unit="m/s"))
        gain, _, _ = control.lqe(
            state, np.array([[0.0], [0], [-1], [0]]), seen, [[intensity]],
            time * np.diag(np.square(noise)),
        )  # fmt: skip
        gain = np.asarray(gain, dtype=np.float64)
        stiffness, load = vehicle.tire_stiffness, float(vehicle.linear.static_loads[0])
        body, travel, axle, tire = np.eye(4)[[1, 0, 3, 2]]
        return cls(
            "Kalman filter",
            ("body_acceleration", "suspension_travel"),
            (*VELOCITIES, "suspension_travel", "tire_force", "tire_force_rate"),
            state,
            gain,
            np.array([body, axle, rate, travel, stiffness * tire, stiffness * axle]),
            np.array([0.0, 0, 0, 0, load, 0]),
            Model(seen, np.array([force[1], 0.0]), force, rate, damping),
        )

    def __repr__(self) -> str:
        slowest = np.min(-np.linalg.eigvals(own_matrix(self)).real)
        return (
            f"Sensors({self.name!r}, from {', '.join(self.inputs)} to {', '.join(self.outputs)}, "
            f"memory={1 / slowest:.3g} s)"
        )


def own_matrix(sensors: Sensors) -> FloatArray:
    """The matrix of the filter's own motion."""
    model = sensors.model
    corrected = 0.0 if model is None else sensors.input_matrix @ model.seen
    return sensors.state_matrix - corrected


def states_of(sensors: Sensors) -> dict[str, float]:
    """Names of the filter's states, with where they start; the last may be a damping [N s/m]."""
    names = [f"filter_{i + 1}" for i in range(len(sensors.state_matrix))]
    known = {} if sensors.model is None else {"filter_damping": sensors.model.damping}
    return dict.fromkeys(names, 0.0) | known


def estimates(sensors: Sensors, x: Any) -> dict[str, Any]:
    """Signals from the states, one column."""
    found = ca.mtimes(ca.DM(sensors.output_matrix), x[: len(sensors.state_matrix)])
    return dict(zip(sensors.outputs, ca.vertsplit(found + ca.DM(sensors.offsets)), strict=True))


def moved(sensors: Sensors, x: Any, measurements: Any, command: Any, time: Any) -> Any:
    """States after a time [s] of held measurements and command [N s/m], one column."""
    model, a = sensors.model, sensors.state_matrix
    if model is None:
        grown, held = exact(a, sensors.input_matrix, time)
        return ca.mtimes(grown, x) + ca.mtimes(held, measurements)
    x, last, row = x[: len(a)], x[len(a)], ca.DM(model.velocity_row).T
    grown, pushed = exact(a, model.force[:, np.newaxis], time)
    # What was measured is of before this sample, with the damping of the last one.
    beside = (last - model.damping) * ca.mtimes(row, x)
    expected = ca.mtimes(ca.DM(model.seen), x) + ca.DM(model.per_force) * beside
    halfway = ca.mtimes(exact(a, np.zeros((len(a), 0)), time / 2)[0], x)
    force = (command - model.damping) * ca.mtimes(row, halfway)
    correction = exact(own_matrix(sensors), sensors.input_matrix, time)[1]
    following = (
        ca.mtimes(grown, x) + pushed * force + ca.mtimes(correction, measurements - expected)
    )
    return ca.vertcat(following, command)


def exact(state_matrix: FloatArray, input_matrix: FloatArray, time: Any) -> tuple[Any, Any]:
    """exp(A t), and its integral times B, for a time t that is an expression [s].

    Of each rate r of A, with its vectors, exp(r t) and (exp(r t) - 1) / r; t where r is next to 0.
    """
    rates, vectors = np.linalg.eig(state_matrix)
    rows = np.linalg.inv(vectors)
    grown, held = ca.SX(*state_matrix.shape), ca.SX(*state_matrix.shape)
    for k, rate in enumerate(rates):
        part = np.outer(vectors[:, k], rows[k])
        size = ca.exp(rate.real * time)
        real, imaginary = size * ca.cos(rate.imag * time), size * ca.sin(rate.imag * time)
        grown += ca.DM(part.real) * real - ca.DM(part.imag) * imaginary
        if abs(rate) < STANDING:
            held += ca.DM(part.real) * time
        else:
            over = part / rate
            held += ca.DM(over.real) * (real - 1) - ca.DM(over.imag) * imaginary
    return grown, ca.mtimes(held, ca.DM(input_matrix))
