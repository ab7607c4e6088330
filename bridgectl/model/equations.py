"""The equations of a vehicle and a bridge that it crosses: a linear system that varies with place.

Signs: displacements, deflection and the road input r are positive downward, measured from
static equilibrium on a level road, as in the paper. Roads come as elevations, positive
upward, and turn into r in one place, `RoadProfile.drop`.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike

from bridgectl._checks import FloatArray
from bridgectl.model.bridge import (
    BridgeModel,
    bridge_states,
    input_matrix,
    slopes_of,
    state_matrix,
)
from bridgectl.model.paths import Paths
from bridgectl.model.quarter_car import QuarterCar
from bridgectl.model.traffic import paths_of
from bridgectl.model.vehicle import Vehicle, road_signals, signals, vehicle_states


@dataclass(frozen=True)
class Equations:
    """Equations of motion of a `bridgectl.Crossing`, which tells of its parameters and states.

    They vary with the position x of the reference tire: how it comes there is another matter, but
    for its speed where tires have damping.
    """

    beam: BridgeModel
    vehicle: Vehicle | QuarterCar

    @property
    def linear(self) -> Vehicle:
        """The vehicle as a `Vehicle`."""
        return self.vehicle.linear

    @property
    def n_vehicle(self) -> int:
        """Number of vehicle states, which come first."""
        return 2 * self.linear.n_coordinates

    @property
    def n_states(self) -> int:
        """Number of states."""
        return self.n_vehicle + 2 * self.beam.n_modes

    @property
    def exit(self) -> float:
        """Position of the reference tire when the last tire leaves the bridge [m]."""
        return self.paths.exit(self.beam.length)

    @cached_property
    def paths(self) -> Paths:
        """Where the tires are: see `bridgectl.model.paths`."""
        return paths_of(self.linear)

    def tire_positions(self, x: ArrayLike) -> FloatArray:
        """Positions of the tires for the reference tire at x.

        Parameters
        ----------
        x : array_like
            Positions of the reference tire [m], any shape.

        Returns
        -------
        ndarray, shape (..., n_tires)
            Positions [m].
        """
        return self.paths.places(x, self.beam.length)

    def tire_shapes(self, x: ArrayLike) -> FloatArray:
        """Mode shapes under the tires.

        Both the time-varying input map of the modes (transposed) and the rows that read
        the deflection under each tire.

        Parameters
        ----------
        x : array_like
            Positions of the reference tire [m], any shape.

        Returns
        -------
        ndarray, shape (..., n_tires, n_modes)
            Dimensionless, zero off the bridge: see `Beam.mode_shapes`. Times lane factors.
        """
        return self._in_lanes(self.beam.mode_shapes(self.tire_positions(x)))

    def _in_lanes(self, shapes: FloatArray) -> FloatArray:
        """Shapes under tires (..., n_tires, n_modes) as tires feel them in their lanes."""
        factors = self.paths.lane_factors
        return shapes if np.all(factors == 1) else factors[:, np.newaxis] * shapes

    def tire_paces(self, x: ArrayLike) -> FloatArray:
        """How far tires go along the bridge as the reference tire goes 1 m.

        Parameters
        ----------
        x : array_like
            Positions of the reference tire [m], any shape.

        Returns
        -------
        ndarray, shape (..., n_tires)
            Dimensionless; negative from the other end.
        """
        return self.paths.signs * self.paths.paces(np.asarray(x, dtype=np.float64))

    def shape_rates(self, x: ArrayLike, speeds: ArrayLike) -> FloatArray | None:
        """Rates at which the shapes under the tires change as these move, c phi_x.

        Parameters
        ----------
        x, speeds : array_like
            Positions of the reference tire [m], any shape, and its speeds [m/s] there.

        Returns
        -------
        ndarray, shape (..., n_tires, n_modes), or None
            [1/s], zero off the bridge; None without tire damping, which alone feels them.
        """
        if not self.linear.tire_damping.any():
            return None
        slopes = self._in_lanes(slopes_of(self.beam)(self.tire_positions(x)))
        along = np.asarray(speeds)[..., np.newaxis] * self.tire_paces(x)
        return np.asarray(along[..., np.newaxis] * slopes)

    def leading_deflections(
        self, modes: FloatArray, shapes: FloatArray, rates: FloatArray | None
    ) -> FloatArray:
        """Deflections v under the tires, with tire damping v + lag v': see `Vehicle.tire_lags`.

        Parameters
        ----------
        modes : ndarray, shape (..., 2 n_modes)
            States of the bridge [m, m/s].
        shapes, rates : ndarray, shape (..., n_tires, n_modes)
            See `tire_shapes` and `shape_rates`.

        Returns
        -------
        ndarray, shape (..., n_tires)
            [m]
        """
        deflections = np.einsum("...kj,...j->...k", shapes, modes[..., ::2])
        if rates is not None:
            moving = np.einsum("...kj,...j->...k", shapes, modes[..., 1::2])
            moving += np.einsum("...kj,...j->...k", rates, modes[..., ::2])
            deflections += self.linear.tire_lags * moving
        return np.asarray(deflections)

    def deflection_rows(self, x: ArrayLike, speeds: ArrayLike = 0.0) -> FloatArray:
        """Rows that read `leading_deflections` from the states of the bridge.

        Parameters
        ----------
        x, speeds : array_like
            Positions of the reference tire [m], any shape, and its speeds [m/s] there.

        Returns
        -------
        ndarray, shape (..., n_tires, 2 n_modes)
            Dimensionless [m / m], and of the rates [s].
        """
        shapes, rates = self.tire_shapes(x), self.shape_rates(x, speeds)
        lags = self.linear.tire_lags[:, np.newaxis]
        of_values = shapes if rates is None else shapes + lags * rates
        return np.stack([of_values, lags * shapes], axis=-1).reshape(*shapes.shape[:-1], -1)

    @cached_property
    def free_matrix(self) -> FloatArray:
        """A without the tires, of `state_labels` [m, m/s]: vehicle in flight beside a free beam."""
        matrix = np.zeros((self.n_states, self.n_states))
        matrix[: self.n_vehicle, : self.n_vehicle] = self.linear.state_matrix
        matrix[self.n_vehicle :, self.n_vehicle :] = self.modal_matrix
        return matrix

    @cached_property
    def modal_matrix(self) -> FloatArray:
        """State matrix of the modes [m, m/s]: see `bridgectl.model.bridge.state_matrix`."""
        return state_matrix(self.beam)

    @cached_property
    def modal_input(self) -> FloatArray:
        """Input matrix of the modal forces [N]: see `bridgectl.model.bridge.input_matrix`."""
        return input_matrix(self.beam)

    @cached_property
    def damper_matrix(self) -> FloatArray:
        """B_F: input matrix of the damper forces [N], shape (n, n_dampers)."""
        matrix = np.zeros((self.n_states, len(self.linear.damper_map)))
        matrix[: self.n_vehicle] = self.linear.damper_input
        return matrix

    def tire_input(self, x: float) -> FloatArray:
        """Input matrix of the tire forces [N], with the beam's input map b.

        The vehicle takes R - W, the beam R.

        Parameters
        ----------
        x : float
            Position of the reference tire [m].

        Returns
        -------
        ndarray, shape (n, n_tires)
        """
        return np.vstack([self.linear.tire_input, self.modal_input @ self.tire_shapes(x).T])

    def tire_rows(self, x: float, speed: float = 0.0) -> FloatArray:
        """Rows of K_t (y - v), with damping: tire forces [N] per state, the tires in contact.

        Parameters
        ----------
        x, speed : float
            Position of the reference tire [m]; its speed [m/s] counts with tire damping alone.

        Returns
        -------
        ndarray, shape (n_tires, n)
        """
        rows = np.hstack([self.linear.leading_hubs, -self.deflection_rows(x, speed)])
        return np.asarray(self.linear.tire_stiffnesses[:, np.newaxis] * rows)

    def state_matrix(self, x: float, speed: float = 0.0) -> FloatArray:
        """A(x) with every tire in contact, of the states `state_labels` [m, m/s].

        Parameters
        ----------
        x, speed : float
            Position of the reference tire [m]; its speed [m/s] counts with tire damping alone.

        Returns
        -------
        ndarray, shape (n, n)
        """
        return np.asarray(self.free_matrix + self.tire_input(x) @ self.tire_rows(x, speed))

    def road_matrix(self, x: float) -> FloatArray:
        """B_r(x), input matrix of the road r [m], with damping r + lag r', every tire in contact.

        Parameters
        ----------
        x : float
            Position of the reference tire [m].

        Returns
        -------
        ndarray, shape (n, n_tires)
        """
        return np.asarray(-self.tire_input(x) * self.linear.tire_stiffnesses)

    def load_vector(self, x: float) -> FloatArray:
        """b(x) W: what the static loads [N] on the beam add to the state derivative.

        Parameters
        ----------
        x : float
            Position of the reference tire [m].

        Returns
        -------
        ndarray, shape (n,)
        """
        on_beam = self.tire_input(x) @ self.linear.static_loads
        on_beam[: self.n_vehicle] = 0.0
        return np.asarray(on_beam)

    def tire_forces(
        self, hubs: FloatArray, deflections: FloatArray, road: FloatArray
    ) -> FloatArray:
        """Tire forces of Eq. (2) in contact, R = W + K_t (y_t - v - r) [N].

        Parameters
        ----------
        hubs, deflections, road : ndarray, shape (..., n_tires)
            Hub displacements, deflections under the tires and road [m], each with its rate times
            the lag of tire damping.

        Returns
        -------
        ndarray, shape (..., n_tires)
        """
        vehicle = self.linear
        return vehicle.static_loads + vehicle.tire_stiffnesses * (hubs - deflections - road)

    def contact_forces(
        self,
        state: FloatArray,
        road: FloatArray,
        shapes: FloatArray,
        rates: FloatArray | None = None,
    ) -> FloatArray:
        """Tire forces kept from pulling, R >= 0: see `tire_forces`.

        Parameters
        ----------
        state : ndarray, shape (n,)
            The states `state_labels` [m, m/s].
        road : ndarray, shape (n_tires,)
            Road r under the tires [m], positive downward; with tire damping r + lag r'.
        shapes, rates : ndarray, shape (n_tires, n_modes)
            Mode shapes under the tires, dimensionless, and with tire damping their rates [1/s]: see
            `tire_shapes` and `shape_rates`.

        Returns
        -------
        ndarray, shape (n_tires,)
            R [N].
        """
        n, hubs = self.n_vehicle, self.linear.leading_hubs
        deflections = self.leading_deflections(state[n:], shapes, rates)
        return np.maximum(self.tire_forces(hubs @ state[:n], deflections, road), 0.0)

    def dynamics(
        self,
        x: float,
        state: FloatArray,
        road: FloatArray,
        damper_force: FloatArray,
        speed: float = 0.0,
        acceleration: float = 0.0,
    ) -> FloatArray:
        """State derivative, with the tires kept from pulling.

        Parameters
        ----------
        x, speed, acceleration : float
            Position of the reference tire [m]; its speed [m/s] counts with tire damping alone, its
            acceleration [m/s^2] of a vehicle that pitches from it.
        state : ndarray, shape (n,)
            The states `state_labels` [m, m/s].
        road : ndarray, shape (n_tires,)
            Road r under the tires [m], positive downward; with tire damping r + lag r'.
        damper_force : ndarray, shape (n_dampers,)
            Forces of the controlled dampers [N].

        Returns
        -------
        ndarray, shape (n,)
            Rates of the states [m/s, m/s^2].
        """
        n = self.n_vehicle
        shapes = self.tire_shapes(x)
        force = self.contact_forces(state, road, shapes, self.shape_rates(x, speed))
        rate = self.free_matrix @ state + self.damper_matrix @ damper_force
        # The static loads hold the vehicle in equilibrium; the beam feels all of R.
        rate[:n] += self.linear.tire_input @ (force - self.linear.static_loads)
        rate[:n] += self.linear.pitching * acceleration
        rate[n:] += self.modal_input @ (force @ shapes)
        return np.asarray(rate)

    @cached_property
    def input_labels(self) -> list[str]:
        """Names of the inputs: road (and its rates) under each tire, force of each damper."""
        return [
            *road_signals(self.linear),
            *signals("damper_force", len(self.linear.damper_map)),
        ]

    @cached_property
    def state_labels(self) -> list[str]:
        """Names of the states, in order."""
        return vehicle_states(self.linear) + bridge_states(self.beam)
