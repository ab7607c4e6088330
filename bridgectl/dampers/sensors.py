"""Sensors on a truck: linear filters from what they measure to estimates of other signals.

Of the measurements m the estimates are y::

    x' = A x + B m + b (c - c_0) n x,    y = y_0 + C x

with the last term for filters that know the vehicle, in which c is the damping commanded and c_0
that in A. From sample to sample m and the last term are held, and x moves exactly, for any sample
time. Estimates have no part of the measurements of their own sample: none depends on an
acceleration at once, so that there is no loop through the damper force.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import casadi as ca
import control
import numpy as np

from bridgectl import _checks as check
from bridgectl._checks import FloatArray
from bridgectl.dampers.expression import SAMPLE_TIME
from bridgectl.dampers.lqr import regulator
from bridgectl.dampers.passive_theory import comfort_damping, road_damping, white_velocity
from bridgectl.model.quarter_car import QuarterCar

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
        A, B and C, in SI units.
    offsets : ndarray, shape (p,)
        y_0, in the units of the estimates.
    force_input, velocity_row : ndarray, shape (n,), optional
        b and n of a filter that knows the damper: the suspension velocity [m/s] of its states, and
        what the force of a damping beside the nominal one does to their rates, in SI units.
    damping : float, optional
        The nominal damping c_0 [N s/m].

    Examples
    --------
    >>> from bridgectl.dampers import Sensors
    >>> Sensors.accelerometers()
    Sensors('accelerometers', from body_acceleration, axle_acceleration to body_velocity, \
axle_velocity, suspension_velocity)
    """

    name: str
    inputs: tuple[str, ...]
    outputs: tuple[str, ...]
    state_matrix: FloatArray
    input_matrix: FloatArray
    output_matrix: FloatArray
    offsets: FloatArray
    force_input: FloatArray | None = None
    velocity_row: FloatArray | None = None
    damping: float = 0.0

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
        car = regulator(vehicle)
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
            state - gain @ seen,
            gain,
            np.array([body, axle, rate, travel, stiffness * tire, stiffness * axle]),
            np.array([0.0, 0, 0, 0, load, 0]),
            force - gain[:, 0] * force[1],
            rate,
            damping,
        )

    def __repr__(self) -> str:
        return f"Sensors({self.name!r}, from {', '.join(self.inputs)} to {', '.join(self.outputs)})"

    @property
    def states(self) -> list[str]:
        """Names of the filter's states."""
        return [f"filter_{i + 1}" for i in range(len(self.state_matrix))]

    def estimates(self, x: Any) -> dict[str, Any]:
        """Signals from the states, one column."""
        found = ca.vertsplit(ca.mtimes(ca.DM(self.output_matrix), x) + ca.DM(self.offsets))
        return dict(zip(self.outputs, found, strict=True))

    def moved(self, x: Any, measurements: Any, command: Any, time: Any) -> Any:
        """States after a time [s] of held measurements and command, one column."""
        inputs, given = self.input_matrix, measurements
        if self.force_input is not None and self.velocity_row is not None:
            beside = (command - self.damping) * ca.mtimes(ca.DM(self.velocity_row).T, x)
            inputs, given = np.column_stack([inputs, self.force_input]), ca.vertcat(given, beside)
        grown, held = exact(self.state_matrix, inputs, time)
        return ca.mtimes(grown, x) + ca.mtimes(held, given)


def exact(state_matrix: FloatArray, input_matrix: FloatArray, time: Any) -> tuple[Any, Any]:
    """exp(A t), and its integral times B, for a time t that is an expression [s].

    Of each rate r of A, with its vectors, exp(r t) and (exp(r t) - 1) / r, or t where r is 0.
    """
    rates, vectors = np.linalg.eig(state_matrix)
    rows = np.linalg.inv(vectors)
    grown, held = ca.SX(*state_matrix.shape), ca.SX(*state_matrix.shape)
    for k, rate in enumerate(rates):
        part = np.outer(vectors[:, k], rows[k])
        size = ca.exp(rate.real * time)
        real, imaginary = size * ca.cos(rate.imag * time), size * ca.sin(rate.imag * time)
        grown += ca.DM(part.real) * real - ca.DM(part.imag) * imaginary
        if rate == 0:
            held += ca.DM(part.real) * time
        else:
            over = part / rate
            held += ca.DM(over.real) * (real - 1) - ca.DM(over.imag) * imaginary
    return grown, ca.mtimes(held, ca.DM(input_matrix))
