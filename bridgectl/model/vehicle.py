"""Linear vehicles on any number of tires."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, fields, replace
from functools import cached_property

import control
import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.linalg import eigvalsh

from bridgectl import _checks
from bridgectl._checks import FloatArray
from bridgectl._plausible import judge_vehicle
from bridgectl.model.vehicle_checks import (
    check_matrices,
    check_tires,
    damping_of_tires,
    lower_ends,
    unique_names,
)

GRAVITY = 9.81
"""Acceleration due to gravity g [m/s^2]: the value behind the paper's W = 98.1 kN."""
ROUND_OFF = 1e-12  # of a damping, relative to those of its coordinates


@dataclass(frozen=True, eq=False, init=False, repr=False)
class Vehicle:
    """A linear vehicle with any number of tires and dampers.

    Coordinates y are displacements from static equilibrium on a level road, positive
    downward::

        M y'' + C y' + K y = -T' (R - W) - D' F_d + P a
        R_k = W_k + K_tk e_k + C_tk e_k',     e_k = T_k y - v(x_k, t) - r(x_k)      (Eq. (2))

    with tire k at x_k, of the reference tire less d_k, and R_k >= 0. `K` and `C` hold the
    suspension only: the tires enter through R. Under a tire that moves at c, deflection and road
    change at the rate v_t + c (v_x + r_x): the convective term of tire damping. F_d are the forces
    of controlled dampers, on top of `C`, positive in the sense of a damper that opposes D y'; a is
    the acceleration along the road (see `bridgectl.Motion`).

    Parameters
    ----------
    mass_matrix, damping_matrix, stiffness_matrix : array_like, shape (n, n)
        M [kg], C [N s/m] and K [N/m].
    tire_stiffnesses : array_like, shape (n_tires,)
        K_t of each tire [N/m].
    tire_offsets : array_like, shape (n_tires,), optional
        Distance d_k of each tire behind the reference tire [m], 0 or more. Default: zeros.
    tire_map : array_like, shape (n_tires, n), optional
        T, dimensionless for translations: the displacement of each tire's hub from the
        coordinates. Default: the last n_tires coordinates are the hubs.
    damper_map : array_like, shape (n_dampers, n), optional
        D, as T: the relative displacement of each controlled damper from the coordinates.
        Dimensionless for translations. Default: no controlled damper.
    damper_axles : array_like, shape (n_dampers, n), optional
        As T, dimensionless: displacement of each damper's lower end. Default: the tires' hubs, if
        there are as many as dampers, else those nearest in `damper_map`.
    damper_dampings : array_like, shape (n_dampers,), optional
        Damping of each passive damper [N s/m] that is part of `C` and that a controlled one takes
        the place of. Default: zeros.
    damper_names : sequence of str, optional
        Names of the dampers. Default: '1', '2', ...
    body_places, body_map : array_like, shapes (n_bodies, 2) and (n_bodies, 2, n), optional
        Front and rear end of each body behind the reference tire [m], and, dimensionless as T,
        their displacements: what figures draw. Default: none; they draw a box at each tire.
    heave : array_like, shape (n,), optional
        Coordinates when the whole vehicle moves down by 1 [m]: 1 for a translation (default),
        0 for a rotation. Gravity acts along it.
    coordinates : sequence of str, optional
        Names of the coordinates. Default: 'y_1', 'y_2', ...
    tire_damping : float or array_like, shape (n_tires,), optional
        Damping C_t of the tires [N s/m], one for all or one each. Default: none.
    pitch_input : array_like, shape (n,), optional
        P, force on each coordinate per acceleration along the road [kg, kg m of a rotation]: of a
        body of mass m, h above the road, m h on a pitch that lifts the front. Default: zeros.

    Raises
    ------
    TypeError, ValueError
        If a parameter has the wrong kind, shape or range; the message names it.

    Warns
    -----
    PlausibilityWarning
        If no road vehicle is so light, or moves so fast or slowly on its tires.

    Examples
    --------
    A half-car with pitch: coordinates body heave, body pitch, front hub, rear hub.

    >>> import numpy as np
    >>> import bridgectl as bc
    >>> a, b, k, c = 1.5, 2.5, 200e3, 10e3                   # axles a ahead, b behind
    >>> legs = np.array([[1, -a, -1, 0], [1, b, 0, -1]])     # travel of the two suspensions
    >>> car = bc.Vehicle(
    ...     mass_matrix=np.diag([12000, 20000, 700, 900]),
    ...     damping_matrix=c * legs.T @ legs, stiffness_matrix=k * legs.T @ legs,
    ...     tire_stiffnesses=[1.8e6, 3.6e6], tire_offsets=[0, a + b],
    ...     damper_map=legs, heave=[1, 0, 1, 1],
    ... )
    >>> car.static_loads.round()
    array([80442., 52974.])
    """

    mass_matrix: FloatArray
    damping_matrix: FloatArray
    stiffness_matrix: FloatArray
    tire_stiffnesses: FloatArray
    tire_offsets: FloatArray
    tire_map: FloatArray
    damper_map: FloatArray
    body_places: FloatArray
    body_map: FloatArray
    heave: FloatArray
    coordinates: tuple[str, ...]
    damper_axles: FloatArray
    damper_dampings: FloatArray
    damper_names: tuple[str, ...]
    tire_damping: FloatArray
    pitch_input: FloatArray

    def __init__(
        self,
        mass_matrix: ArrayLike,
        damping_matrix: ArrayLike,
        stiffness_matrix: ArrayLike,
        tire_stiffnesses: ArrayLike,
        tire_offsets: ArrayLike | None = None,
        tire_map: ArrayLike | None = None,
        damper_map: ArrayLike | None = None,
        heave: ArrayLike | None = None,
        coordinates: Sequence[str] | None = None,
        tire_damping: ArrayLike = 0.0,
        damper_axles: ArrayLike | None = None,
        damper_dampings: ArrayLike | None = None,
        body_places: ArrayLike | None = None,
        body_map: ArrayLike | None = None,
        damper_names: Sequence[str] | None = None,
        pitch_input: ArrayLike | None = None,
    ) -> None:
        mass = _checks.array("mass_matrix", mass_matrix, (None, None), unit="kg")
        tires = _checks.array("tire_stiffnesses", tire_stiffnesses, (None,), unit="N/m")
        n, n_tires = mass.shape[0], tires.size
        last = np.eye(n)[max(n - n_tires, 0) :] if tire_map is None else ()

        def given(
            name: str, value: ArrayLike | None, default: ArrayLike, shape: tuple[int | None, ...]
        ) -> FloatArray:
            return _checks.array(name, default if value is None else value, shape)

        hubs = given("tire_map", tire_map, last, (n_tires, n))
        bodies = given("body_places", body_places, np.zeros((0, 2)), (None, 2))
        ends = (*bodies.shape, n)
        dampers = given("damper_map", damper_map, np.zeros((0, n)), (None, n))
        count = len(dampers)
        values: dict[str, FloatArray | tuple[str, ...]] = {
            "mass_matrix": _checks.array("mass_matrix", mass, (n, n), unit="kg"),
            "damping_matrix": _checks.array("damping_matrix", damping_matrix, (n, n)),
            "stiffness_matrix": _checks.array("stiffness_matrix", stiffness_matrix, (n, n)),
            "tire_stiffnesses": tires,
            "tire_offsets": given("tire_offsets", tire_offsets, np.zeros(n_tires), (n_tires,)),
            "body_places": bodies,
            "body_map": given("body_map", body_map, np.zeros(ends), ends),
            "tire_map": hubs,
            "damper_map": dampers,
            "heave": given("heave", heave, np.ones(n), (n,)),
            "coordinates": unique_names("coordinates", "y_", coordinates, n),
            "damper_axles": given(
                "damper_axles", damper_axles, lower_ends(dampers, hubs), (count, n)
            ),
            "damper_dampings": given("damper_dampings", damper_dampings, np.zeros(count), (count,)),
            "damper_names": unique_names("damper_names", "", damper_names, count),
            "tire_damping": damping_of_tires(tire_damping, n_tires),
            "pitch_input": given("pitch_input", pitch_input, np.zeros(n), (n,)),
        }
        for name, value in values.items():
            object.__setattr__(self, name, value)
        check_tires(self.tire_stiffnesses, self.tire_offsets)
        if np.any(self.damper_dampings < 0):
            raise ValueError(f"damper_dampings must be 0 N s/m or more, got {self.damper_dampings}")
        check_matrices(self.mass_matrix, self.damping_matrix, self.stiffness_matrix)
        self._check_support()
        judge_vehicle(self)

    def __repr__(self) -> str:
        offsets = ", ".join(f"{offset:g}" for offset in self.tire_offsets)
        return (
            f"Vehicle({self.n_coordinates} coordinates, mass={self.mass:g} kg, "
            f"tires at [{offsets}] m behind the first, {len(self.damper_map)} dampers)"
        )

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, Vehicle) or type(other) is not type(self):
            return NotImplemented
        return all(
            np.array_equal(getattr(self, field.name), getattr(other, field.name))
            for field in fields(self)
        )

    def __hash__(self) -> int:
        return hash((self.mass_matrix.tobytes(), self.stiffness_matrix.tobytes()))

    def _check_support(self) -> None:
        if np.linalg.matrix_rank(self._supported_stiffness) < self.n_coordinates:
            raise ValueError(
                "stiffness_matrix and tire_map leave a coordinate without support: no static "
                "equilibrium exists"
            )
        if np.any(self.static_loads <= 0):
            raise _checks.UnloadedTireError(self.static_loads)

    @property
    def linear(self) -> Vehicle:
        """The vehicle itself: what `QuarterCar.linear` gives for a quarter-car."""
        return self

    @property
    def n_coordinates(self) -> int:
        """Number of coordinates n."""
        return self.mass_matrix.shape[0]

    @property
    def n_tires(self) -> int:
        """Number of tires."""
        return self.tire_stiffnesses.size

    @property
    def mass(self) -> float:
        """Mass of the whole vehicle [kg]."""
        return float(self.heave @ self.mass_matrix @ self.heave)

    @property
    def _supported_stiffness(self) -> FloatArray:
        """Stiffness of the vehicle on its tires on a rigid road, K + T' K_t T."""
        return np.asarray(
            self.stiffness_matrix
            + self.tire_map.T @ (self.tire_stiffnesses[:, np.newaxis] * self.tire_map)
        )

    @cached_property
    def frequencies(self) -> FloatArray:
        """Natural frequencies on a rigid road, without damping [Hz], rising, shape (n,)."""
        squares = eigvalsh(self._supported_stiffness, self.mass_matrix)
        return np.asarray(np.sqrt(np.maximum(squares, 0.0)) / (2 * np.pi))

    @cached_property
    def static_loads(self) -> FloatArray:
        """Static load W_k of each tire on a level road [N], shape (n_tires,)."""
        weight = GRAVITY * self.mass_matrix @ self.heave
        sag = np.linalg.solve(self._supported_stiffness, weight)
        return np.asarray(self.tire_stiffnesses * (self.tire_map @ sag))

    @cached_property
    def displacements(self) -> FloatArray:
        """Selects the coordinates y [m] from the states (y_1, y_1', y_2, ...), shape (n, 2 n)."""
        return np.kron(np.eye(self.n_coordinates), [1.0, 0.0])

    @cached_property
    def velocities(self) -> FloatArray:
        """Selects the rates y' [m/s] from the states, shape (n, 2 n)."""
        return np.kron(np.eye(self.n_coordinates), [0.0, 1.0])

    @cached_property
    def state_matrix(self) -> FloatArray:
        """State matrix without tires, states (y_1 [m], y_1' [m/s], y_2, ...), shape (2 n, 2 n)."""
        position, velocity = self.displacements, self.velocities
        forces = self.stiffness_matrix @ position + self.damping_matrix @ velocity
        accelerations = -np.linalg.solve(self.mass_matrix, forces)
        return np.asarray(position.T @ velocity + velocity.T @ accelerations)

    @cached_property
    def tire_input(self) -> FloatArray:
        """Input matrix of the tire forces beyond the static loads [N], shape (2 n, n_tires)."""
        return np.asarray(-self.velocities.T @ np.linalg.solve(self.mass_matrix, self.tire_map.T))

    @cached_property
    def damper_input(self) -> FloatArray:
        """Input matrix of the damper forces [N], shape (2 n, n_dampers)."""
        return np.asarray(-self.velocities.T @ np.linalg.solve(self.mass_matrix, self.damper_map.T))

    @cached_property
    def pitching(self) -> FloatArray:
        """Input vector of the acceleration along the road [m/s^2], shape (2 n,)."""
        return np.asarray(self.velocities.T @ np.linalg.solve(self.mass_matrix, self.pitch_input))

    @cached_property
    def flexibility(self) -> FloatArray:
        """States at rest on the tires per force on each coordinate [m/N], shape (2 n, n)."""
        return np.asarray(self.displacements.T @ np.linalg.inv(self._supported_stiffness))

    @cached_property
    def pitched(self) -> FloatArray:
        """States at rest per acceleration along the road [m per m/s^2], shape (2 n,)."""
        return np.asarray(self.flexibility @ self.pitch_input)

    @property
    def undamped(self) -> Vehicle:
        """The vehicle without its passive dampers, `damper_dampings`: controlled ones stay."""
        return with_dampings(self, np.zeros_like(self.damper_dampings))

    @cached_property
    def hubs(self) -> FloatArray:
        """Selects the hub displacement [m] of each tire from the states, shape (n_tires, 2 n)."""
        return np.asarray(self.tire_map @ self.displacements)

    @cached_property
    def tire_lags(self) -> FloatArray:
        """Damping over stiffness of each tire [s]: R - W = K_t (e + lag e'), shape (n_tires,)."""
        return self.tire_damping / self.tire_stiffnesses

    @cached_property
    def leading_hubs(self) -> FloatArray:
        """Hub displacements with what damping adds, T y + lag T y' [m], from the states."""
        rates = self.tire_map @ self.velocities
        return np.asarray(self.hubs + self.tire_lags[:, np.newaxis] * rates)

    def state_matrix_on_tires(self, contact: NDArray[np.bool_] | None = None) -> FloatArray:
        """State matrix of the vehicle on those of its tires that touch a rigid road.

        Parameters
        ----------
        contact : ndarray of bool, shape (n_tires,), optional
            Which tires touch it; all if omitted.

        Returns
        -------
        ndarray, shape (2 n, 2 n)
            Of the states (y_1 [m], y_1' [m/s], y_2, ...).
        """
        touching = 1.0 if contact is None else contact
        spring = (touching * self.tire_stiffnesses)[:, np.newaxis] * self.leading_hubs
        return np.asarray(self.state_matrix + self.tire_input @ spring)

    @cached_property
    def road_input(self) -> FloatArray:
        """Input matrix of the surface u = v + r under each tire, with damping u + lag u' [m]."""
        return np.asarray(-self.tire_input * self.tire_stiffnesses)

    def system(self) -> control.StateSpace:
        """Return the vehicle on a rigid road as a linear system.

        Returns
        -------
        control.StateSpace
            Inputs: 'road' [m] for one tire, 'road_1', ... for several, positive downward (minus
            the elevation); with tire damping 'road_rate' [m/s], its rate; 'damper_force' [N] for
            each controlled damper. Outputs: 'tire_force' [N], the force R - W beyond the static
            load, and the coordinates [m]. States: each coordinate and its rate ('y_s_dot').

        Examples
        --------
        >>> import bridgectl as bc
        >>> sys = bc.li2006.car().system()
        >>> sys.input_labels, sys.output_labels
        (['road', 'damper_force'], ['tire_force', 'y_s', 'y_t'])
        >>> [round(float(f), 3) for f in sorted(set(abs(sys.poles()) / 6.283185))]
        [0.465, 6.892]
        """
        springs = np.diag(self.tire_stiffnesses)
        outputs = np.vstack([springs @ self.leading_hubs, self.displacements])
        roads = np.vstack([-springs, np.zeros((self.n_coordinates, self.n_tires))])
        inputs, through = self.road_input, roads
        if self.tire_damping.any():
            inputs = np.hstack([inputs, inputs * self.tire_lags])
            through = np.hstack([roads, roads * self.tire_lags])
        dampers = self.damper_input
        return control.ss(
            self.state_matrix_on_tires(),
            np.hstack([inputs, dampers]),
            outputs,
            np.hstack([through, np.zeros((len(outputs), dampers.shape[1]))]),
            states=vehicle_states(self),
            inputs=[*road_signals(self), *signals("damper_force", dampers.shape[1])],
            outputs=signals("tire_force", self.n_tires) + list(self.coordinates),
            name="vehicle",
        )


def with_dampings(vehicle: Vehicle, dampings: FloatArray) -> Vehicle:
    """Return a vehicle whose passive dampers have other dampings [N s/m], (n_dampers,)."""
    change, travels = dampings - vehicle.damper_dampings, vehicle.damper_map
    matrix = vehicle.damping_matrix + travels.T @ (change[:, np.newaxis] * travels)
    # What round-off leaves of dampers that are taken out would not pass for damping.
    size = np.sqrt(np.maximum(np.diag(vehicle.damping_matrix), 0.0))
    matrix[np.abs(matrix) <= ROUND_OFF * np.outer(size, size)] = 0.0
    return replace(vehicle, damping_matrix=(matrix + matrix.T) / 2, damper_dampings=dampings)


def vehicle_states(vehicle: Vehicle) -> list[str]:
    """Names of the vehicle's states, in order."""
    return [f"{name}{dot}" for name in vehicle.coordinates for dot in ("", "_dot")]


def signals(name: str, count: int) -> list[str]:
    """Names of `count` signals of a kind: the plain name for one, numbered for several."""
    return [name] if count == 1 else [f"{name}_{i}" for i in range(1, count + 1)]


def road_signals(vehicle: Vehicle) -> list[str]:
    """Names of the inputs of the road: under each tire, and with tire damping its rates."""
    kinds = ("road", "road_rate") if vehicle.tire_damping.any() else ("road",)
    return [name for kind in kinds for name in signals(kind, vehicle.n_tires)]
