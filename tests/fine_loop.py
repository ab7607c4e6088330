"""A crossing with a damper in the loop, written anew from the equations and integrated finely.

Nothing of the package takes part but the law: the equations of motion are written down here, and
each lift-off, landing and limit of the damper's force is found as an event of the integration.
"""

from __future__ import annotations

from itertools import pairwise

import numpy as np
from helpers import law_of_crossing
from scipy.integrate import solve_ivp

G = 9.81

MAX_STEP = 5e-4
"""Longest step [s]: within one, no tire may leave the road and meet it again unseen."""

FIRST_STEP = 1e-6
"""First step after an event [s]: where that was, its margin is of no sign."""


class FineLoop:
    """One crossing: `peak` is its DAF, `least` the least tire force over the static load.

    `largest` is the largest tire force [N], `commands` are those of all samples [N s/m].
    """

    def __init__(self, beam, car, damper, speed, road, tolerance=1e-9):
        self.beam, self.car, self.damper, self.speed, self.road = beam, car, damper, speed, road
        self.law = law_of_crossing(damper, beam, car, speed, road)
        self.tolerance = tolerance
        j = np.arange(1, beam.n_modes + 1)
        self.wave = j * np.pi / beam.length
        self.omega2 = self.wave**4 * beam.flexural_rigidity / beam.mass_per_length
        self.damped = 2 * beam.damping_ratio * np.sqrt(self.omega2[0])
        self.weight = (car.sprung_mass + car.unsprung_mass) * G
        self.peak, self.least, self.largest, self.commands = 0.0, 1.0, 0.0, []
        self._run()

    def _shapes(self, x):
        on_bridge = (x >= 0) & (x <= self.beam.length)
        return np.sin(np.multiply.outer(self.wave, x)) * on_bridge

    def _drop(self, x):
        return self.road.elevation[0] - np.interp(x, self.road.x, self.road.elevation)

    def _would_be(self, t, y):
        """Tire force if it could pull [N]."""
        x = self.speed * t
        deflection = (self._shapes(x) * y[4::2]).sum(axis=0)
        return self.weight + self.car.tire_stiffness * (y[2] - deflection - self._drop(x))

    def _rates(self, t, y, tire, force):
        car, beam = self.car, self.beam
        spring = car.suspension_stiffness * (y[0] - y[2])
        modal = 2 / (beam.mass_per_length * beam.length) * self._shapes(self.speed * t) * tire
        rates = np.empty_like(y)
        rates[0], rates[2], rates[4::2] = y[1], y[3], y[5::2]
        rates[1] = -(spring + force) / car.sprung_mass
        rates[3] = (spring + force - tire + self.weight) / car.unsprung_mass
        rates[5::2] = modal - self.damped * y[5::2] - self.omega2 * y[4::2]
        return rates

    def _moment(self, t, y, tire):
        """Static moment of the tire force less that of inertia and damping, over the static."""
        length, half = self.beam.length, self.beam.length / 2
        x = self.speed * t
        static = tire * np.minimum(x, length - x) / 2
        forced = 2 / length * self._shapes(x) * tire
        inertia = forced - self.beam.mass_per_length * self.omega2[:, None] * y[4::2]
        spread = (np.sin(self.wave * half) / self.wave**2)[:, None]
        return (static - (spread * inertia).sum(axis=0)) / (self.weight * length / 4)

    def _run(self):
        start, end = self.road.x[0] / self.speed, self.beam.length / self.speed
        step = self.damper.sample_time
        samples = start + step * np.arange(int(np.ceil((end - start) / step - 1e-9)))
        kinks = np.unique([*self.road.x, 0.0, self.beam.length / 2]) / self.speed
        y, self.damping, before = np.zeros(4 + 2 * len(self.wave)), 0.0, self.weight
        for first, last in pairwise([*samples, end]):
            tire = max(self._would_be(first, y), 0.0)
            self._sample(first, y, tire, (tire - before) / step, first == samples[0])
            before = tire
            inside = kinks[(kinks > first + 1e-10) & (kinks < last - 1e-10)]
            for begin, stop in pairwise([first, *inside, last]):
                y = self._smooth_road(begin, stop, y)
            self.damping = self._lagging(last)

    def _sample(self, t, y, tire, rate, first):
        rates = self._rates(t, y, tire, self._limited(self.damping * (y[1] - y[3])))
        self.command = float(
            self.law.command(
                body_velocity=y[1], axle_velocity=y[3], suspension_travel=y[0] - y[2],
                suspension_velocity=y[1] - y[3], body_acceleration=rates[1],
                axle_acceleration=rates[3], tire_force=tire, tire_force_rate=rate,
                position=self.speed * t, speed=self.speed,
            )
        )  # fmt: skip
        self.commands.append(self.command)
        self.sampled = t
        if first or self.damper.lag == 0:
            self.damping = self.command

    def _lagging(self, t):
        if self.damper.lag == 0:
            return self.command
        fading = np.exp(-(t - self.sampled) / self.damper.lag)
        return self.command + (self.damping - self.command) * fading

    def _limited(self, force):
        return min(max(force, -self.damper.max_force), self.damper.max_force)

    def _smooth_road(self, begin, stop, y):
        """From event to event."""
        limit = self.damper.max_force

        def wanted(t, y):
            return self._lagging(t) * (y[1] - y[3])

        touching = self._would_be(begin, y) > 0
        held = np.sign(wanted(begin, y)) * (abs(wanted(begin, y)) > limit)
        while begin < stop:

            def tire(t, y, touching=touching):
                return self._would_be(t, y) if touching else 0.0

            def force(t, y, held=held):
                return held * limit if held else wanted(t, y)

            def turns(t, y):
                return self._would_be(t, y)

            def meets(t, y, held=held):
                return held * wanted(t, y) - limit if held else limit - abs(wanted(t, y))

            turns.terminal, turns.direction = True, -1 if touching else 1
            meets.terminal, meets.direction = True, -1
            events = [turns] if limit == np.inf else [turns, meets]
            found = solve_ivp(
                lambda t, y, tire=tire, force=force: self._rates(t, y, tire(t, y), force(t, y)),
                (begin, stop), y, method="DOP853", rtol=self.tolerance,
                atol=self.tolerance * 1e-4, events=events, dense_output=True,
                first_step=min(FIRST_STEP, stop - begin), max_step=MAX_STEP,
            )  # fmt: skip
            t = np.linspace(begin, found.t[-1], 201)
            states = found.sol(t)
            tires = np.maximum(self._would_be(t, states), 0.0) * touching
            self.least = min(self.least, tires.min() / self.weight)
            self.largest = max(self.largest, tires.max())
            if t[0] >= -1e-12:
                moment = self._moment(t, states, tires)
                self.peak = max(self.peak, moment.max())
            if len(found.t_events[0]):
                touching = not touching
            if limit < np.inf and len(found.t_events[1]):
                held = 0.0 if held else np.sign(wanted(found.t[-1], found.y[:, -1]))
            begin, y = found.t[-1], found.y[:, -1]
        return y
