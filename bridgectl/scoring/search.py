"""The search for better gains: by gradients, or by generations of many gains at once.

DAFs are maxima, and laws switch from sample to sample: looked at closely the objective of most laws
is rough, from afar it is flat and has several valleys. For the laws of the library differential
evolution found lower DAFs than L-BFGS-B with differences, in comparable time, as all gains of a
generation run side by side. A program is smooth, has many gains, and an exact gradient.
"""

from __future__ import annotations

from collections.abc import Callable
from contextlib import suppress
from dataclasses import dataclass, field

import numpy as np
from scipy.optimize import Bounds, differential_evolution, minimize

from bridgectl._checks import FloatArray
from bridgectl._progress import track

MEMBERS = 40
"""Gains of a generation, at least: with fewer, the steps that all share would take most time."""

SEED = 2006
"""Of the generations: the same study, the same gains."""

STEP = 0.02
"""Of differences: shorter ones see how rough the objective is."""

FLAT = 1e-7
"""A search by gradients ends where a step gains less, as a share."""

LONG = 1e3
"""What L-BFGS-B has of the objective: its first step is as long as the gradient, at most 1."""

OF_WIDTH = 1e-3
"""What a gain that is 0 is measured by, as a share of the distance of its bounds."""


@dataclass(frozen=True)
class Scale:
    """Gains as u = asinh(gain / size): even steps near 0, and in ratio to the gain far from it."""

    start: FloatArray
    """Gains where the search starts, (n,)."""
    bounds: FloatArray
    """Least and largest gains, (n, 2)."""

    @property
    def sizes(self) -> FloatArray:
        """The start's own sizes."""
        return np.where(self.start, np.abs(self.start), OF_WIDTH * np.ptp(self.bounds, axis=1))

    def scaled(self, gains: FloatArray) -> FloatArray:
        """Return u of gains (..., n)."""
        return np.arcsinh(gains / self.sizes)

    def gains(self, u: FloatArray) -> FloatArray:
        """Return gains of u (..., n), within their bounds in spite of round-off."""
        return np.clip(self.sizes * np.sinh(u), *self.bounds.T)

    def slopes(self, u: FloatArray) -> FloatArray:
        """Return d gain / d u."""
        return np.asarray(self.sizes * np.cosh(u))

    @property
    def ends(self) -> FloatArray:
        """Least and largest u, (n, 2)."""
        return self.scaled(self.bounds.T).T


class _EnoughError(Exception):
    """All steps are taken: L-BFGS-B would end its line search first."""


@dataclass
class Search:
    """The best so far, and how it came; each step counts for the progress bar."""

    steps: int
    progress: bool
    best: FloatArray = field(default_factory=lambda: np.zeros(0))
    history: list[float] = field(default_factory=list)
    interrupted: bool = False

    def run(self, search: Callable[[], object]) -> None:
        """Search; one interruption ends it and keeps the best."""
        name = "Tuning"
        self._bar = iter(track(range(self.steps + 1), name, self.steps, show=self.progress))
        next(self._bar)
        try:
            with suppress(_EnoughError):
                search()
        except KeyboardInterrupt:
            if not self.history:
                raise
            self.interrupted = True
        finally:
            self._bar.close()  # type: ignore[attr-defined]

    def note(self, u: FloatArray, values: FloatArray) -> None:
        """Take note of a step's values (m,) at u (m, n); the very first one is of the start."""
        first = not self.history
        if first:
            self.best, self.history = u[0].copy(), [float(values[0])]
        if not first or len(values) > 1:
            k = int(values.argmin())
            if values[k] < self.history[-1]:
                self.best = u[k].copy()
            self.history.append(min(float(values[k]), self.history[-1]))
            with suppress(StopIteration):
                next(self._bar)  # last, for an interruption may come while it draws


def by_gradient(
    search: Search, slopes: Callable[[FloatArray], tuple[float, FloatArray]], start: FloatArray,
    ends: FloatArray,
) -> None:  # fmt: skip
    """Search by L-BFGS-B; `slopes` returns value and gradient."""

    def noted(u: FloatArray) -> tuple[float, FloatArray]:
        if len(search.history) > search.steps:
            raise _EnoughError
        value, gradient = slopes(u)
        search.note(u[np.newaxis], np.array([value]))
        return LONG * value, LONG * gradient

    minimize(
        noted, start, jac=True, method="L-BFGS-B", bounds=Bounds(*ends.T),
        options={"ftol": FLAT},
    )  # fmt: skip


def by_generations(
    search: Search, values: Callable[[FloatArray], FloatArray], start: FloatArray, ends: FloatArray
) -> None:
    """Search by differential evolution, a generation at once; `values` takes (m, n)."""

    def noted(u: FloatArray) -> FloatArray:
        found = values(u.T)
        search.note(u.T, found)
        return found

    differential_evolution(
        noted, Bounds(*ends.T), x0=start, vectorized=True, updating="deferred", polish=False,
        popsize=int(np.ceil(MEMBERS / start.size)), maxiter=search.steps - 1, tol=1e-4, rng=SEED,
        init="latinhypercube",
    )  # fmt: skip
