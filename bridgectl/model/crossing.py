"""A crossing: a vehicle, a bridge, what is read from them, and the named signals of both."""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import cached_property
from typing import cast

import numpy as np
from numpy.typing import ArrayLike

from bridgectl import _checks
from bridgectl._checks import FloatArray
from bridgectl._plausible import judge_load
from bridgectl.model.bridge import BridgeModel, slopes_of
from bridgectl.model.bridge_effects import AtSection, Deflection, Moment
from bridgectl.model.control_systems import ControlSystems
from bridgectl.model.effect import SENSES, Effect, EffectRows
from bridgectl.model.effects import STATIC, NamedEffects, as_effect, named_effects
from bridgectl.model.quarter_car import QuarterCar, require_pair
from bridgectl.model.vehicle import Vehicle, signals, vehicle_states


@dataclass(frozen=True)
class Crossing(ControlSystems):
    """A vehicle that crosses a bridge, and the effect that is looked at.

    States x = [vehicle states, bridge states], each coordinate followed by its rate. With the
    tires in contact

        x' = A x + B_r r + B_F F_d + b

    where A, B_r and b, the static loads W through the bridge's input map, vary with the position of
    the reference tire. The speed is no part of it.

    Parameters
    ----------
    beam : Beam
        The bridge, or another `bridgectl.model.bridge.BridgeModel`.
    vehicle : Vehicle or QuarterCar
        The vehicle.
    effect : Moment, Deflection, TireForce or BodyAcceleration, optional
        What is looked at: the moment halfway if omitted.
    effects : mapping of str to effect, optional
        Further outputs by name: see `crossing_system`.
    static : bool, optional
        Whether what static loads give is beside the outputs.

    Raises
    ------
    TypeError, ValueError
        If a parameter has the wrong kind or range; the message names it.

    Warns
    -----
    PlausibilityWarning
        If the vehicle is heavier than the bridge.

    References
    ----------
    Y. Li, E. OBrien, A. Gonzalez, J. Sound Vib. 293 (2006) 125-137, Eqs. (1)-(8).

    Examples
    --------
    >>> import bridgectl as bc
    >>> crossing = bc.Crossing(bc.li2006.beam(), bc.li2006.car())
    >>> f"{crossing.static_peak / 1e3:.1f} kN m under the truck at mid-span"
    '613.1 kN m under the truck at mid-span'
    >>> crossing.state_matrix(12.5).shape
    (10, 10)
    """

    effect: Effect = field(default_factory=Moment)
    effects: NamedEffects = ()
    static: bool = False

    def __post_init__(self) -> None:
        require_pair(self.beam, self.vehicle)
        if self.linear.tire_damping.any():
            slopes_of(self.beam)
        object.__setattr__(self, "effect", as_effect(self.effect, self.beam, self.linear))
        effects = named_effects(self.effects, self._usual_labels, self.beam, self.linear)
        object.__setattr__(self, "effects", effects)
        _checks.flag("static", self.static)
        judge_load(self)

    def __repr__(self) -> str:
        further = f", effects={self._named}" if self.effects else ""
        return f"Crossing({self.beam!r}, {self.vehicle!r}, {self.effect!r}{further})"

    @property
    def _named(self) -> dict[str, Effect]:
        return cast(dict[str, Effect], dict(self.effects))

    @property
    def section(self) -> float:
        """Where moment and deflection are read, as a fraction of the bridge's length."""
        return self._moment.section(self.beam)

    @property
    def recovery(self) -> str:
        """How moments are recovered: see `Moment`."""
        return self._moment.recovery

    @cached_property
    def _moment(self) -> Moment:
        """The moment at the place of the effect, halfway if it has none."""
        if type(self.effect) is Moment:
            return self.effect
        at = self.effect.at if isinstance(self.effect, AtSection) else None
        return Moment(at).on(self.beam, self.linear)

    @cached_property
    def _moment_peak(self) -> float:
        """Its static peak [N m]: a search along the bridge, and a simulation asks at every step."""
        return self._moment.static_peak(self.beam, self.linear)

    @property
    def kinks(self) -> FloatArray:
        """Places [m] where mode shapes are not smooth, or what a tire there does to the effect."""
        places = [self.effect.kinks(self.beam), self.beam.kinks(self.section)]
        places += [effect.kinks(self.beam) for effect in self._named.values()]
        return np.unique(np.concatenate(places))

    @property
    def negligible(self) -> float:
        """What modes may yield that cells do not follow: see `Effect`."""
        return min(effect.negligible for effect in (self.effect, *self._named.values()))

    @cached_property
    def static_peak(self) -> float:
        """Largest or smallest static effect as the vehicle creeps across, in its unit; 0 if none.

        Of a moment M_0 [N m].
        """
        return self.effect.static_peak(self.beam, self.linear)

    @cached_property
    def scale(self) -> float:
        """What the effect is divided by [its unit], so that its peak is a largest value.

        The static peak; of the smallest of what is positive, as a tire force, that peak's negative.
        """
        sense, peak = SENSES[self.effect.sense], self.static_peak
        return sense * (abs(peak) or 1.0)

    @property
    def orientation(self) -> float:
        """1, or -1 where the amplification is the negative of a largest value: see `scale`."""
        return self.scale / (self.static_peak or 1.0)

    def rows(self, x: ArrayLike) -> EffectRows:
        """Rows of the effect over `scale`: Eqs. (6)-(8).

        Parameters
        ----------
        x : array_like
            Positions of the reference tire [m], any shape.

        Returns
        -------
        EffectRows
            Gains on the tire forces, shape (..., n_tires), and on the states, shape (n,).
        """
        rows = self.effect.rows(self.beam, self.linear, self.tire_positions(x))
        return rows.scaled(1 / self.scale)

    def values(
        self,
        x: FloatArray,
        states: FloatArray,
        forces: FloatArray,
        accelerations: FloatArray | float = 0.0,
    ) -> FloatArray:
        """Effect at many positions of the reference tire, over `scale`.

        Parameters
        ----------
        x : ndarray, shape (m,)
            Positions [m].
        states, forces : ndarray, shapes (..., m, n) and (..., m, n_tires)
            States (displacements [m] and rates [m/s]) and tire forces [N] there.
        accelerations : ndarray, shape (m,), optional
            Accelerations of the motion along the road [m/s^2] there.

        Returns
        -------
        ndarray, shape (..., m)
            Dimensionless; in the effect's unit if it has no static peak.
        """
        return self.rows(x).values(states, forces) + self.per_acceleration * accelerations

    @property
    def per_acceleration(self) -> float:
        """What acceleration along the road adds to the effect over `scale` [s^2/m]."""
        return self.effect._per_acceleration(self.linear) / self.scale

    @cached_property
    def output_labels(self) -> list[str]:
        """Names of the outputs, in order: see `crossing_system`."""
        further = [*self._named]
        static = ["moment", "deflection", *further] if self.static else []
        return [*self._usual_labels, *further, *(STATIC + name for name in static)]

    @cached_property
    def _usual_labels(self) -> list[str]:
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
        self,
        x: FloatArray,
        states: FloatArray,
        forces: FloatArray,
        damper: FloatArray,
        accelerations: FloatArray | float = 0.0,
    ) -> FloatArray:
        """Outputs at many places from states, tire forces and damper forces.

        Parameters
        ----------
        x : ndarray, shape (m,)
            Positions of the reference tire [m].
        states, forces, damper : ndarray, shapes (n, m), (n_tires, m), (n_dampers, m)
            States (displacements [m] and rates [m/s]), tire forces [N] and damper forces [N].
        accelerations : ndarray, shape (m,), optional
            Accelerations of the motion along the road [m/s^2].

        Returns
        -------
        ndarray, shape (n_outputs, m)
            In the order of `output_labels`. See `crossing_system` for their units.
        """
        vehicle, n = self.linear, self.n_vehicle
        read = self.beam, vehicle, self.tire_positions(x)
        moment, deflection = self._moment, Deflection(self._moment.at)
        peak = self._moment_peak or 1.0
        further, static = self._named.values(), []
        if self.static:
            each = moment, deflection, *further
            static = [effect.static_values(self.beam, vehicle, x) for effect in each]
            static[0] /= peak
        rates = (
            vehicle.state_matrix @ states[:n]
            + vehicle.tire_input @ (forces - vehicle.static_loads[:, np.newaxis])
            + vehicle.damper_input @ damper
            + vehicle.pitching[:, np.newaxis] * accelerations
        )
        return np.vstack(
            [
                moment.rows(*read).scaled(1 / peak).values(states.T, forces.T),
                deflection.history(*read, states, forces),
                forces,
                states[:n],
                vehicle.velocities @ rates,
                vehicle.damper_map @ vehicle.displacements @ states[:n],
                vehicle.damper_map @ vehicle.velocities @ states[:n],
                *(
                    effect.history(*read, states, forces, damper, accelerations)
                    for effect in further
                ),
                *static,
            ]
        )


def make_crossing(
    beam: BridgeModel,
    vehicle: Vehicle | QuarterCar,
    effect: Effect | str = "moment",
    section: float = 0.5,
    recovery: str = "exact",
    effects: NamedEffects = (),
    static: bool = False,
) -> Crossing:
    """Return the crossing of an effect, or of its name with a section and a recovery."""
    require_pair(beam, vehicle)
    asked = as_effect(effect, beam, vehicle.linear, section, recovery)
    return Crossing(beam, vehicle, asked, effects, static)


def require_factor(crossing: Crossing, *, unless_none: bool = False) -> None:
    """Refuse an effect whose static peak is nothing, unless no effect of its kind has one."""
    if crossing.static_peak == 0 and (crossing.effect.has_static or not unless_none):
        effect = crossing.effect
        other = next(sense for sense in SENSES if sense != effect.sense)
        instead = f"another place or sense={other!r}, or " if effect.has_static else ""
        raise ValueError(
            f"effect must have a static peak for a factor, and the {effect.sense} static "
            f"{effect.label} of {effect!r} is 0 {effect.unit}: type {instead}peak_effect(...) for "
            "its peak"
        )
