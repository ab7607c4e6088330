"""The quarter-car, and what a vehicle must be."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import control
import numpy as np

from bridgectl import _checks
from bridgectl._plausible import judge_quarter_car
from bridgectl.model.bridge import BridgeModel
from bridgectl.model.vehicle import Vehicle


@dataclass(frozen=True)
class QuarterCar:
    """A quarter-car: sprung mass, suspension, unsprung mass and tire (Eqs. (1a), (1b), (2)).

    Parameters
    ----------
    sprung_mass, unsprung_mass : float
        m_s and m_t [kg].
    suspension_stiffness, tire_stiffness : float
        K_s and K_t [N/m].
    damping : float
        Passive damping coefficient C of the suspension [N s/m].
    tire_damping : float, optional
        Damping of the tire [N s/m].

    Raises
    ------
    TypeError, ValueError
        If a parameter is not a number or out of range; the message names it.

    Warns
    -----
    PlausibilityWarning
        If no road vehicle is so: masses in tonnes, stiffnesses in kN/m, or arguments that changed
        places.

    References
    ----------
    Y. Li, E. OBrien, A. Gonzalez, J. Sound Vib. 293 (2006) 125-137, Eqs. (1) and (2).

    Examples
    --------
    >>> import dataclasses
    >>> import bridgectl as bc
    >>> car = bc.QuarterCar(9000.0, 1000.0, 80e3, 1.8e6, damping=7e3)
    >>> dataclasses.replace(car, damping=10e3).damping
    10000.0
    """

    sprung_mass: float
    unsprung_mass: float
    suspension_stiffness: float
    tire_stiffness: float
    damping: float
    tire_damping: float = 0.0

    def __post_init__(self) -> None:
        units = {"mass": "kg", "stiffness": "N/m"}
        for name in ("sprung_mass", "unsprung_mass", "suspension_stiffness", "tire_stiffness"):
            unit = units[name.rpartition("_")[2]]
            value = _checks.positive(name, getattr(self, name), unit=unit)
            object.__setattr__(self, name, value)
        damping = _checks.not_negative("damping", self.damping, unit="N s/m")
        object.__setattr__(self, "damping", damping)
        in_tire = _checks.not_negative("tire_damping", self.tire_damping, unit="N s/m")
        object.__setattr__(self, "tire_damping", in_tire)
        _ = self.linear  # so that its checks speak here, not at the first crossing
        judge_quarter_car(self)

    def __repr__(self) -> str:
        in_tire = f", tire_damping={self.tire_damping:g} N s/m" if self.tire_damping else ""
        return (
            f"QuarterCar(sprung_mass={self.sprung_mass:g} kg, "
            f"unsprung_mass={self.unsprung_mass:g} kg, "
            f"suspension_stiffness={self.suspension_stiffness:g} N/m, "
            f"tire_stiffness={self.tire_stiffness:g} N/m, damping={self.damping:g} N s/m"
            f"{in_tire})"
        )

    @cached_property
    def linear(self) -> Vehicle:
        """The quarter-car as a `Vehicle`, coordinates 'y_s' and 'y_t' as in the paper."""
        leg = np.array([[1.0, -1.0]])
        return Vehicle(
            mass_matrix=np.diag([self.sprung_mass, self.unsprung_mass]),
            damping_matrix=self.damping * leg.T @ leg,
            stiffness_matrix=self.suspension_stiffness * leg.T @ leg,
            tire_stiffnesses=[self.tire_stiffness],
            damper_map=leg,
            damper_dampings=[self.damping],
            coordinates=("y_s", "y_t"),
            tire_damping=self.tire_damping,
        )

    def system(self) -> control.StateSpace:
        """Return the quarter-car on a rigid road as a linear system: see `Vehicle.system`."""
        return self.linear.system()


def require_quarter_car(
    vehicle: object, why: str = "it is of one damper alone", name: str = "vehicle"
) -> QuarterCar:
    """Return a vehicle if it is a quarter-car; else refuse it, and tell why no other will do."""
    if not isinstance(vehicle, QuarterCar):
        raise TypeError(
            f"{name} must be a QuarterCar, got {type(vehicle).__name__}: {why}, type for example "
            "bridgectl.li2006.car()"
        )
    require_springs(vehicle, "closed loops, scores, closed forms and animations")
    return vehicle


def require_springs(vehicle: Vehicle | QuarterCar, what: str) -> None:
    """Refuse tires with damping where they are springs alone."""
    if vehicle.linear.tire_damping.any():
        raise ValueError(
            f"tire_damping must be 0 in {what}, where tires are springs alone, got "
            f"{vehicle.linear.tire_damping} N s/m: leave it out"
        )


def require_pair(beam: object, vehicle: object) -> None:
    """Refuse what is no bridge and vehicle."""
    if not isinstance(beam, BridgeModel):
        raise TypeError(
            f"beam must be a bridgectl.Beam, got {type(beam).__name__}: type for example "
            "bridgectl.Beam(25, 18358, 4.865e10), and the vehicle after it"
        )
    if not isinstance(vehicle, Vehicle | QuarterCar):
        raise TypeError(
            "vehicle must be a bridgectl.Vehicle or QuarterCar, "
            f"got {type(vehicle).__name__}: type for example "
            "bridgectl.QuarterCar(9000, 1000, 80e3, 1.8e6, 7e3), after the beam"
        )
