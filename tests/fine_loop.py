"""A crossing with dampers in the loop, written anew from the equations and integrated finely.

Nothing of the package takes part but the laws: the equations of motion are written down here, and
each lift-off, landing and limit of a damper's force is found as an event of the integration. Each
leg of a vehicle has its own tire.
"""

from __future__ import annotations

from itertools import pairwise

import numpy as np
from helpers import law_of_crossing
from scipy.integrate import solve_ivp

import bridgectl as bc

G = 9.81

MAX_STEP = 5e-4
"""Longest step [s]: within one, no tire may leave the road and meet it again unseen."""

FIRST_STEP = 1e-6
"""First step after an event [s]: where that was, its margin is of no sign."""


class Parts:
    """Matrices of a vehicle without the dampers that are controlled."""

    def __init__(self, vehicle):
        if isinstance(vehicle, bc.QuarterCar):
            leg = np.array([[1.0, -1.0]])
            self.mass = np.diag([vehicle.sprung_mass, vehicle.unsprung_mass])
            self.damping, self.springs = 0 * self.mass, vehicle.suspension_stiffness * leg.T @ leg
            self.tires, self.hubs = np.array([vehicle.tire_stiffness]), np.array([[0.0, 1.0]])
            self.behind, self.legs, self.axles = np.zeros(1), leg, self.hubs
            heave = np.ones(2)
        else:
            legs, own = vehicle.damper_map, np.diag(vehicle.damper_dampings)
            self.mass, self.springs = vehicle.mass_matrix, vehicle.stiffness_matrix
            self.damping = vehicle.damping_matrix - legs.T @ own @ legs
            self.tires, self.hubs = vehicle.tire_stiffnesses, vehicle.tire_map
            self.behind, self.legs, self.axles = vehicle.tire_offsets, legs, vehicle.damper_axles
            heave = vehicle.heave
        supported = self.springs + self.hubs.T @ np.diag(self.tires) @ self.hubs
        sag = np.linalg.solve(supported, G * self.mass @ heave)
        self.loads = self.tires * (self.hubs @ sag)
        self.bodies, self.inverse = self.legs + self.axles, np.linalg.inv(self.mass)


class FineLoop:
    """One crossing: `peak` is its DAF, `least` the least tire force over the static load.

    `largest` is the largest tire force [N], `commands` are those of all samples [N s/m], of one leg
    numbers. The dampers have the same sample time; one is for all legs, or a list of one for each.
    """

    def __init__(self, beam, car, dampers, speed, road, tolerance=1e-9):
        self.beam, self.speed, self.road = beam, speed, road
        self.parts = Parts(car)
        n_legs = len(self.parts.legs)
        several = isinstance(dampers, list)
        self.dampers = dampers if several else [dampers] * n_legs
        self.laws = [
            law_of_crossing(damper, beam, car, speed, road, leg)
            for leg, damper in enumerate(self.dampers, 1)
        ]
        self.limits = np.array([damper.max_force for damper in self.dampers])
        self.lags = np.array([damper.lag for damper in self.dampers])
        self.late = np.where(self.lags > 0, self.lags, np.inf) if self.lags.any() else None
        self.tolerance = tolerance
        j = np.arange(1, beam.n_modes + 1)
        self.wave = j * np.pi / beam.length
        self.omega2 = self.wave**4 * beam.flexural_rigidity / beam.mass_per_length
        self.damped = 2 * beam.damping_ratio * np.sqrt(self.omega2[0])
        self.free = self._free()
        self.end = beam.length + self.parts.behind.max()
        x = np.linspace(0, self.end, 100_001)
        x = np.union1d(x, beam.length / 2 + self.parts.behind)
        self.static = (self._line(x) * self.parts.loads[:, None]).sum(axis=0).max()
        self.peak, self.least, self.largest, self.commands = 0.0, 1.0, 0.0, []
        self._run()

    def _free(self):
        """Rates of all states per state, with neither tire nor damper forces."""
        parts, n, m = self.parts, len(self.parts.mass), len(self.wave)
        free = np.zeros((2 * (n + m), 2 * (n + m)))
        free[:n, n : 2 * n] = np.eye(n)
        free[n : 2 * n, : 2 * n] = -parts.inverse @ np.hstack([parts.springs, parts.damping])
        free[2 * n : 2 * n + m, 2 * n + m :] = np.eye(m)
        free[2 * n + m :, 2 * n :] = np.hstack([-np.diag(self.omega2), -self.damped * np.eye(m)])
        return free

    def _places(self, x):
        return -np.subtract.outer(self.parts.behind, x)

    def _line(self, x):
        """Moment at mid-span per tire force, (T, ...)."""
        place = self._places(x)
        return np.maximum(np.minimum(place, self.beam.length - place), 0) / 2

    def _shapes(self, x):
        """Mode shapes under the tires, (modes, T, ...)."""
        place = self._places(x)
        on_bridge = (place >= 0) & (place <= self.beam.length)
        return np.sin(np.multiply.outer(self.wave, place)) * on_bridge

    def _drop(self, x):
        return self.road.elevation[0] - np.interp(self._places(x), self.road.x, self.road.elevation)

    def _split(self, y):
        n, m = len(self.parts.mass), len(self.wave)
        return y[:n], y[n : 2 * n], y[2 * n : 2 * n + m], y[2 * n + m :]

    def _would_be(self, t, y, shapes=None):
        """Tire forces if they could pull [N], (T, ...)."""
        x, parts, (u, _, q, _) = self.speed * t, self.parts, self._split(y)
        shapes = self._shapes(x) if shapes is None else shapes
        deflection = (shapes * q[:, None]).sum(axis=0)
        column = (..., *(None,) * (y.ndim - 1))
        closer = parts.hubs @ u - deflection - self._drop(x)
        return parts.loads[column] + parts.tires[column] * closer

    def _rates(self, y, tires, forces, shapes):
        parts, beam, n = self.parts, self.beam, len(self.parts.mass)
        pushing = parts.legs.T @ forces + parts.hubs.T @ (tires - parts.loads)
        rates = self.free @ y
        rates[n : 2 * n] -= parts.inverse @ pushing
        rates[-len(shapes) :] += 2 / (beam.mass_per_length * beam.length) * (shapes @ tires)
        return rates

    def _moment(self, t, y, tires):
        """Static moment of the tire forces less that of inertia and damping, over the static."""
        length, x = self.beam.length, self.speed * t
        static = (self._line(x) * tires).sum(axis=0)
        forced = 2 / length * (self._shapes(x) * tires).sum(axis=1)
        inertia = forced - self.beam.mass_per_length * self.omega2[:, None] * self._split(y)[2]
        spread = (np.sin(self.wave * length / 2) / self.wave**2)[:, None]
        return (static - (spread * inertia).sum(axis=0)) / self.static

    def _run(self):
        start, end = self.road.x[0] / self.speed, self.end / self.speed
        step = self.dampers[0].sample_time
        samples = start + step * np.arange(int(np.ceil((end - start) / step - 1e-9)))
        special = [*self.road.x, 0.0, self.beam.length / 2, self.beam.length]
        kinks = np.unique(np.add.outer(special, self.parts.behind)) / self.speed
        y = np.zeros(2 * (len(self.parts.mass) + len(self.wave)))
        self.dampings, before = np.zeros(len(self.laws)), self.parts.loads
        for first, last in pairwise([*samples, end]):
            tires = np.maximum(self._would_be(first, y), 0.0)
            self._sample(first, y, tires, (tires - before) / step, first == samples[0])
            before = tires
            inside = kinks[(kinks > first + 1e-10) & (kinks < last - 1e-10)]
            inside = inside[np.diff(inside, prepend=-np.inf) > 1e-10]
            for begin, stop in pairwise([first, *inside, last]):
                y = self._smooth_road(begin, stop, y)
            self.dampings = self._lagging(last)

    def _sample(self, t, y, tires, rates, first):
        parts, (u, v, *_) = self.parts, self._split(y)
        forces = np.clip(self._wanted(self.dampings, y), -self.limits, self.limits)
        a = self._rates(y, tires, forces, self._shapes(self.speed * t))[len(u) : 2 * len(u)]
        rows = zip(parts.bodies, parts.axles, parts.legs, tires, rates, parts.behind, strict=True)
        told = [
            {
                "body_velocity": body @ v, "axle_velocity": axle @ v, "suspension_travel": leg @ u,
                "suspension_velocity": leg @ v, "body_acceleration": body @ a,
                "axle_acceleration": axle @ a, "tire_force": tire, "tire_force_rate": rate,
                "position": self.speed * t - behind, "speed": self.speed,
            }
            for body, axle, leg, tire, rate, behind in rows
        ]  # fmt: skip
        by_leg = {
            f"{key}_{i}": value for i, own in enumerate(told, 1) for key, value in own.items()
        }
        self.command = np.array(
            [
                law.command(**own, **{key: by_leg[key] for key in law.signals if key in by_leg})
                for law, own in zip(self.laws, told, strict=True)
            ]
        )
        self.commands.append(self.command if len(self.laws) > 1 else float(self.command[0]))
        self.sampled = t
        jumps = (self.lags == 0) | first
        self.dampings = np.where(jumps, self.command, self.dampings)

    def _wanted(self, dampings, y):
        return dampings * (self.parts.legs @ self._split(y)[1])

    def _lagging(self, t):
        if self.late is None:
            return self.command
        fading = np.where(self.lags > 0, np.exp(-(t - self.sampled) / self.late), 0.0)
        return self.command + (self.dampings - self.command) * fading

    def _turn(self, i, sign):
        """The event in which a tire leaves or meets the road."""

        def margin(t, y):
            return self._would_be(t, y)[i]

        margin.terminal, margin.direction = True, sign
        return margin

    def _meet(self, i, side):
        """The event in which a damper's force meets its limit, or comes back from it."""

        def margin(t, y):
            force = self._wanted(self._lagging(t), y)[i]
            return side * force - self.limits[i] if side else self.limits[i] - abs(force)

        margin.terminal, margin.direction = True, -1
        return margin

    def _smooth_road(self, begin, stop, y):
        """From event to event."""
        limits, limited = self.limits, np.flatnonzero(self.limits < np.inf)

        def wanted(t, y):
            return self._wanted(self._lagging(t), y)

        touching = self._would_be(begin, y) > 0
        held = np.sign(wanted(begin, y)) * (np.abs(wanted(begin, y)) > limits)
        first_step = stop - begin
        while begin < stop:

            def rates(t, y, touching=touching, held=held):
                shapes, forces = self._shapes(self.speed * t), wanted(t, y)
                tires = np.where(touching, self._would_be(t, y, shapes), 0.0)
                forces[limited] = np.where(
                    held[limited] != 0, held[limited] * limits[limited], forces[limited]
                )
                return self._rates(y, tires, forces, shapes)

            events = [self._turn(i, -1 if on else 1) for i, on in enumerate(touching)]
            events += [self._meet(i, held[i]) for i in limited]
            found = solve_ivp(
                rates, (begin, stop), y, method="DOP853", rtol=self.tolerance,
                atol=self.tolerance * 1e-4, events=events, dense_output=True,
                first_step=min(first_step, stop - begin), max_step=MAX_STEP,
            )  # fmt: skip
            t = np.linspace(begin, found.t[-1], 201)
            states = found.sol(t)
            tires = np.maximum(self._would_be(t, states), 0.0) * touching[:, None]
            self.least = min(self.least, (tires / self.parts.loads[:, None]).min())
            self.largest = max(self.largest, tires.max())
            if t[0] >= -1e-12:
                self.peak = max(self.peak, self._moment(t, states, tires).max())
            met = [len(times) > 0 for times in found.t_events]
            touching = touching ^ np.array(met[: len(touching)])
            force = np.sign(wanted(found.t[-1], found.y[:, -1]))
            for i, event in zip(limited, met[len(touching) :], strict=True):
                if event:
                    held[i] = 0.0 if held[i] else force[i]
            begin, y, first_step = found.t[-1], found.y[:, -1], FIRST_STEP
        return y
