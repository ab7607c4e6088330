"""One crossing: the motion of beam and vehicle, what is read from it, and its named signals."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Any

import control
import numpy as np
from numpy.typing import ArrayLike

from bridgectl import _checks
from bridgectl._checks import FloatArray
from bridgectl._plausible import judge_crossing
from bridgectl.model.bridge import BridgeModel
from bridgectl.model.effects import EffectRows, effect_rows, known_effects, static_peak
from bridgectl.model.equations import Equations
from bridgectl.model.quarter_car import QuarterCar
from bridgectl.model.recovery import RECOVERIES
from bridgectl.model.vehicle import Vehicle, signals, vehicle_states


@dataclass(frozen=True)
class Crossing(Equations):
    """A vehicle that crosses a beam at constant speed, the reference tire at x = c t.

    States x = [vehicle states, beam states], each coordinate followed by its rate. With the
    tires in contact

        x' = A(t) x + B_r(t) r + B_F F_d + b(t)

    where b(t) is the static loads W through the beam's time-varying input map.

    Parameters
    ----------
    beam : Beam
        The bridge, or another `bridgectl.model.bridge.BridgeModel`.
    vehicle : Vehicle or QuarterCar
        The vehicle.
    speed : float
        Speed c [m/s].
    section : float, optional
        The section of the moment and deflection, as a fraction of the span.
    recovery : {'exact', 'li2006', 'modal'}, optional
        How the bending moment is recovered from the truncated modes.

        - 'exact': tire forces through the static influence line plus the inertia and
          damping forces of the modes. A few modes suffice.
        - 'li2006': Eqs. (5)-(8) as printed, for the paper's own numbers.
        - 'modal': curvature of the modes. Converges as 1 / n: for comparison only.

        `bridgectl.model.recovery` has the formulas.
    effect : {'moment', 'deflection', 'tire_force', 'acceleration'}, optional
        What amplification is of: bending moment or modal deflection at the section, tire force
        ('tire_force_1', ... of several tires), each over its static peak, or the acceleration
        of the first vehicle coordinate [m/s^2], downward.

    Raises
    ------
    TypeError, ValueError
        If a parameter has the wrong kind or range; the message names it.

    Warns
    -----
    PlausibilityWarning
        If the vehicle is heavier than the bridge, or faster than 216 km/h.

    References
    ----------
    Y. Li, E. OBrien, A. Gonzalez, J. Sound Vib. 293 (2006) 125-137, Eqs. (1)-(8).

    Examples
    --------
    >>> import bridgectl as bc
    >>> crossing = bc.Crossing(bc.li2006.beam(), bc.li2006.car(), speed=25.0)
    >>> f"{crossing.peak_static_moment / 1e3:.1f} kN m under the truck at mid-span"
    '613.1 kN m under the truck at mid-span'
    >>> crossing.state_matrix(0.5).shape
    (10, 10)
    """

    section: float = 0.5
    recovery: str = "exact"
    effect: str = "moment"

    def __post_init__(self) -> None:
        if not isinstance(self.beam, BridgeModel):
            raise TypeError(
                f"beam must be a bridgectl.Beam, got {type(self.beam).__name__}: type for example "
                "bridgectl.Beam(25, 18358, 4.865e10), and the vehicle after it"
            )
        if not isinstance(self.vehicle, Vehicle | QuarterCar):
            raise TypeError(
                "vehicle must be a bridgectl.Vehicle or QuarterCar, "
                f"got {type(self.vehicle).__name__}: type for example "
                "bridgectl.QuarterCar(9000, 1000, 80e3, 1.8e6, 7e3), after the beam"
            )
        checked: dict[str, object] = {
            "speed": _checks.positive("speed", self.speed, unit="m/s"),
            "section": _checks.fraction("section", self.section, self.beam.length),
            "recovery": _checks.choice("recovery", self.recovery, RECOVERIES),
            "effect": _checks.choice("effect", self.effect, known_effects(self.linear)),
        }
        for name, value in checked.items():
            object.__setattr__(self, name, value)
        judge_crossing(self, self.speed)

    def __repr__(self) -> str:
        return (
            f"Crossing({self.beam!r}, {self.vehicle!r}, speed={self.speed:g} m/s, "
            f"section={self.section:g} of the span, recovery={self.recovery!r}, "
            f"effect={self.effect!r})"
        )

    @property
    def peak_static_moment(self) -> float:
        """Largest static moment M_0 at the section as the vehicle creeps across [N m]."""
        return static_peak(self.beam, self.linear, self.section, "moment")

    def rows(self, x: ArrayLike, effect: str | None = None) -> EffectRows:
        """Rows of an effect, by default the crossing's, over its static peak: Eqs. (6)-(8).

        Parameters
        ----------
        x : array_like
            Positions of the reference tire [m], any shape.
        effect : str, optional
            One of those that `Crossing` has.

        Returns
        -------
        EffectRows
            Gains on the tire forces, shape (..., n_tires), and on the states, shape (n,).
        """
        name = self.effect if effect is None else effect
        beam, vehicle, tires = self.beam, self.linear, self.tire_positions(x)
        rows = effect_rows(beam, vehicle, self.section, self.recovery, name, tires)
        return rows.scaled(1 / static_peak(beam, vehicle, self.section, name))

    def values(
        self, x: FloatArray, states: FloatArray, forces: FloatArray, effect: str | None = None
    ) -> FloatArray:
        """Effect at many positions of the reference tire, over its static peak.

        Parameters
        ----------
        x : ndarray, shape (m,)
            Positions [m].
        states, forces : ndarray, shapes (..., m, n) and (..., m, n_tires)
            States (displacements [m] and rates [m/s]) and tire forces [N] there.
        effect : str, optional
            See `rows`.

        Returns
        -------
        ndarray, shape (..., m)
            Amplification [-]; the acceleration in m/s^2.
        """
        per_force, per_state, constant = self.rows(x, effect)
        from_forces = np.einsum("mk,...mk->...m", per_force, forces)
        return np.asarray(from_forces + states @ per_state + constant)

    @cached_property
    def deflection_row(self) -> FloatArray:
        """Row of the deflection [m] at the section on the beam states, shape (2 n_modes,)."""
        shape = self.beam.mode_shapes(self.section * self.beam.length)
        return np.kron(shape, [1.0, 0.0])

    @cached_property
    def output_labels(self) -> list[str]:
        """Names of the outputs, in order: see `crossing_system`."""
        vehicle = self.linear
        return [
            "moment",
            "deflection",
            *signals("tire_force", vehicle.n_tires),
            *vehicle_states(vehicle),
            *(f"{name}_ddot" for name in vehicle.coordinates),
            *signals("suspension_travel", len(vehicle.damper_map)),
            *signals("suspension_velocity", len(vehicle.damper_map)),
        ]

    def outputs(
        self, t: FloatArray, states: FloatArray, forces: FloatArray, damper: FloatArray
    ) -> FloatArray:
        """Outputs at many times from states, tire forces and damper forces.

        Parameters
        ----------
        t : ndarray, shape (m,)
            Times [s].
        states, forces, damper : ndarray, shapes (n, m), (n_tires, m), (n_dampers, m)
            States (displacements [m] and rates [m/s]), tire forces [N] and damper forces [N].

        Returns
        -------
        ndarray, shape (n_outputs, m)
            In the order of `output_labels`. See `crossing_system` for their units.
        """
        vehicle, n = self.linear, self.n_vehicle
        rates = (
            vehicle.state_matrix @ states[:n]
            + vehicle.tire_input @ (forces - vehicle.static_loads[:, np.newaxis])
            + vehicle.damper_input @ damper
        )
        return np.vstack(
            [
                self.values(self.speed * t, states.T, forces.T, "moment"),
                self.deflection_row @ states[n:],
                forces,
                states[:n],
                vehicle.velocities @ rates,
                vehicle.damper_map @ vehicle.displacements @ states[:n],
                vehicle.damper_map @ vehicle.velocities @ states[:n],
            ]
        )

    def system(self, name: str = "crossing") -> control.NonlinearIOSystem:
        """Return the crossing as a control system: see `crossing_system`.

        Parameters
        ----------
        name : str, optional
            Name of the system.

        Returns
        -------
        control.NonlinearIOSystem
        """
        n_tires = self.linear.n_tires

        def update(t: float, x: FloatArray, u: FloatArray, _: dict[str, Any]) -> FloatArray:
            return self.dynamics(t, x, u[:n_tires], u[n_tires:])

        def output(t: float, x: FloatArray, u: FloatArray, _: dict[str, Any]) -> FloatArray:
            force = self.contact_forces(x, u[:n_tires], self.tire_shapes(self.speed * t))
            columns = x[:, np.newaxis], force[:, np.newaxis], u[n_tires:, np.newaxis]
            return self.outputs(np.array([t]), *columns)[:, 0]

        return control.nlsys(
            update,
            output,
            inputs=self.input_labels,
            outputs=self.output_labels,
            states=self.state_labels,
            name=name,
        )


def crossing_system(
    beam: BridgeModel,
    vehicle: Vehicle | QuarterCar,
    speed: float,
    *,
    section: float = 0.5,
    recovery: str = "exact",
    name: str = "crossing",
) -> control.NonlinearIOSystem:
    """Return the crossing of a vehicle as a control system.

    Time is zero when the reference tire is at the start of the bridge, x = c t. The system
    works in `control.interconnect`, in `control.linearize(sys, 0, t=...)` (frozen-time poles
    and Bode plots) and in `control.input_output_response`. Give the last one tolerances,
    ``solve_ivp_kwargs=dict(rtol=1e-9, atol=1e-12)``: at its defaults the DAF at 110 km/h
    comes out as 1.136 instead of 1.130, which is more than a unit ramp changes.

    Parameters
    ----------
    beam, vehicle, speed, section, recovery
        See `Crossing`.
    name : str, optional
        Name of the system.

    Returns
    -------
    control.NonlinearIOSystem
        Inputs: 'road' [m], the road r under the tire, positive *downward* (minus the
        elevation), and 'damper_force' [N], which acts as -F on the body and +F on the axle
        on top of the passive damping. Outputs: 'moment' (over the peak static moment),
        'deflection' [m] at the section, 'tire_force' [N], the vehicle's states
        ('y_s', 'y_s_dot', 'y_t', 'y_t_dot' for a quarter-car), accelerations ('y_s_ddot',
        'y_t_ddot'), 'suspension_travel' [m] and 'suspension_velocity' [m/s] of each
        controlled damper. Several tires or dampers are numbered: 'road_1', 'road_2', ...
        The static loads are inside: the zero state is the vehicle in equilibrium before an
        unloaded bridge.

    Raises
    ------
    TypeError, ValueError
        If a parameter has the wrong kind or range; the message names it.

    Warns
    -----
    PlausibilityWarning
        As `Crossing`.

    References
    ----------
    Y. Li, E. OBrien, A. Gonzalez, J. Sound Vib. 293 (2006) 125-137, Eqs. (1)-(8).

    Examples
    --------
    >>> import control as ct
    >>> import bridgectl as bc
    >>> sys = bc.crossing_system(bc.li2006.beam(), bc.li2006.car(), speed=110 / 3.6)
    >>> sys.input_labels
    ['road', 'damper_force']
    >>> mid_span = ct.linearize(sys, 0, t=12.5 / (110 / 3.6))
    >>> sorted({round(float(abs(pole)) / 6.2832, 2) for pole in mid_span.poles()})
    [0.46, 4.08, 6.91, 16.37, 36.83]
    """
    crossing = Crossing(beam, vehicle, speed, section, recovery)
    judge_crossing(crossing, crossing.speed)
    return crossing.system(name)
