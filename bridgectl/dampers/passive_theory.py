"""Closed forms for a passive quarter-car on a random road: variances, best dampings, frequencies.

The road is one of waviness 2 (ISO 8608), whose velocity u' under a moving tire is white noise of
covariance ``W delta(t)``, and the tire stays on it. Each formula solves the Lyapunov equation of
the quarter-car, or asks when a frequency response does not depend on the damping c, by hand; M
is m_s + m_t throughout. Signs do not matter here.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from bridgectl import _checks as check
from bridgectl._checks import FloatArray
from bridgectl.model.quarter_car import QuarterCar, require_quarter_car
from bridgectl.road.psd import REFERENCE
from bridgectl.road.spectrum import requested_roughness


class Variances(NamedTuple):
    """Stationary variances of a quarter-car, found by `variances`, numbers or of one shape."""

    body_acceleration: FloatArray
    """Of y_s'' [m^2/s^4]."""
    suspension_travel: FloatArray
    """Of y_s - y_t [m^2]."""
    tire_deflection: FloatArray
    """Of the tire beyond its static deflection [m^2]."""
    tire_force: FloatArray
    """Of R [N^2]; its root over the static load is the dynamic load coefficient."""

    def __repr__(self) -> str:
        return (
            f"Variances(body_acceleration={_span(self.body_acceleration)} m^2/s^4, "
            f"suspension_travel={_span(self.suspension_travel)} m^2, "
            f"tire_deflection={_span(self.tire_deflection)} m^2, "
            f"tire_force={_span(self.tire_force)} N^2)"
        )


class InvariantFrequencies(NamedTuple):
    """Where a response does not depend on the damping, found by `invariant_frequencies`."""

    body_acceleration: FloatArray
    """Of the sprung mass [Hz], shape (3,)."""
    suspension_travel: FloatArray
    """Of y_s - y_t [Hz], shape (1,)."""
    tire_force: FloatArray
    """Of R [Hz], shape (2,)."""

    def __repr__(self) -> str:
        told = (
            f"{name}={', '.join(f'{f:.4g}' for f in values)} Hz"
            for name, values in self._asdict().items()
        )
        return f"InvariantFrequencies({'; '.join(told)})"


def white_velocity(
    roughness: str | float, speed: ArrayLike, *, level: str = "mean"
) -> float | FloatArray:
    """Return the intensity W [m^2/s] of the road's velocity u' under a tire at `speed` [m/s].

    ``W = (2 pi n_0)^2 G_d(n_0) V / 2``: u' has the covariance W delta(t). The half is there because
    G_d is one-sided. ISO 8608:2016, Annex C; the same noise as in `bridgectl.road.shaping_filter`.
    """
    density = requested_roughness(roughness, level)
    return (2 * np.pi * REFERENCE) ** 2 * density / 2 * _above_zero("speed", speed, "m/s")


def variances(
    car: QuarterCar,
    roughness: str | float,
    speed: ArrayLike,
    damping: ArrayLike | None = None,
    *,
    level: str = "mean",
) -> Variances:
    """Return the stationary variances of a quarter-car on a random road, in closed form.

    With W from `white_velocity`::

        E[y_s''^2]        = W (c^2 K_t + K_s^2 M) / (2 c m_s^2)
        E[(y_s - y_t)^2]  = W M / (2 c)
        E[(R - W_0)^2]    = W (c^2 K_t M^2 + N) / (2 c m_s^2)
        N = K_s^2 M^3 - 2 K_s K_t m_s m_t M + K_t^2 m_s^2 m_t

    and the tire's deflection is (R - W_0) / K_t, W_0 the static load. They are those of the whole
    spectrum: a road without its longest or shortest waves gives a little less. A `damping` c [N
    s/m] other than the car's own is broadcast with `speed` [m/s]. For such closed forms: S. Turkay,
    H. Akcay, J. Sound Vib. 282 (2005) 111-124; derived anew here.
    """
    body, stiffness, tire = _car(car).sprung_mass, car.suspension_stiffness, car.tire_stiffness
    mass = body + car.unsprung_mass
    c = _damping(car, damping)
    intensity = white_velocity(roughness, speed, level=level)
    per_damping = _broadcast(intensity, c)
    force = per_damping * (c**2 * tire * mass**2 + _residual(car)) / body**2
    return Variances(
        body_acceleration=per_damping * (c**2 * tire + stiffness**2 * mass) / body**2,
        suspension_travel=per_damping * mass,
        tire_deflection=force / tire**2,
        tire_force=force,
    )


def comfort_damping(car: QuarterCar) -> float:
    """Return the fixed damping of the least body acceleration on a random road.

    ``c = K_s sqrt(M / K_t)`` minimises E[y_s''^2] of `variances` at every speed and roughness.

    Parameters
    ----------
    car : QuarterCar
        Its own damping does not matter.

    Returns
    -------
    float
        In N s/m.

    Raises
    ------
    TypeError
        If `car` is not a QuarterCar.

    Examples
    --------
    >>> import bridgectl as bc
    >>> from bridgectl.dampers.passive_theory import comfort_damping
    >>> round(comfort_damping(bc.li2006.car()))
    5963
    """
    mass = _car(car).sprung_mass + car.unsprung_mass
    return float(car.suspension_stiffness * np.sqrt(mass / car.tire_stiffness))


def road_damping(car: QuarterCar) -> float:
    """Return the fixed damping of the least tire-force variance on a random road.

    ``c = sqrt(N / (K_t M^2))`` minimises E[(R - W_0)^2] of `variances`, at every speed and
    roughness; N is always above 0, for as a quadratic in K_t it has no real root.

    Parameters
    ----------
    car : QuarterCar
        Its own damping does not matter.

    Returns
    -------
    float
        In N s/m.

    Raises
    ------
    TypeError
        If `car` is not a QuarterCar.

    Examples
    --------
    >>> import bridgectl as bc
    >>> from bridgectl.dampers.passive_theory import road_damping
    >>> round(road_damping(bc.li2006.car()))
    36736
    """
    mass = _car(car).sprung_mass + car.unsprung_mass
    return float(np.sqrt(_residual(car) / car.tire_stiffness) / mass)


def invariant_frequencies(car: QuarterCar) -> InvariantFrequencies:
    """Return the frequencies at which the response to the road does not depend on the damping.

    A response at w [rad/s] is (a + i w c b) / (d + i w c e), with a, b, d, e polynomials in
    x = w^2 that are free of c. Its size is independent of c where |a e| = |b d|; with
    e = K_t - M x and d = K_s e - m_s x (K_t - m_t x) for every response::

        body force m_s y_s''  a = K_s b, b = m_s x K_t      K_s e = d or K_s e = -d
        travel y_s - y_t      a = m_s x K_t, b = 0          e = 0
        tire force R - W      a = (K_s - x m_s m_t / M) b,  b = K_t x M

    At each of those of body and tire force the better damper changes from stiff to soft or
    back; the travel is smaller for a stiff one on either side. A stiff damper gives the smaller
    tire force below the first of its two frequencies and above the second, a soft one in
    between: the damping that is good for a bridge depends on the bridge's frequency.

    Parameters
    ----------
    car : QuarterCar
        Its own damping does not matter.

    Returns
    -------
    InvariantFrequencies
        In Hz, rising.

    Raises
    ------
    TypeError
        If `car` is not a QuarterCar.

    References
    ----------
    J. K. Hedrick, T. Butsuen, Proc. Inst. Mech. Eng. D 204 (1990) 21-27: sqrt(K_t / m_t) for the
    body and sqrt(K_t / M) for the travel hold for any force between the two masses.

    Examples
    --------
    >>> import bridgectl as bc
    >>> from bridgectl.dampers.passive_theory import invariant_frequencies
    >>> found = invariant_frequencies(bc.li2006.car())
    >>> found.body_acceleration.round(3), found.tire_force.round(3)
    (array([0.643, 6.752, 7.049]), array([0.617, 5.191]))
    """
    body, axle = _car(car).sprung_mass, car.unsprung_mass
    soft, tire, mass = car.suspension_stiffness, car.tire_stiffness, body + axle
    both = body * axle
    # K_s e = -d, and a e = -b d over 2 K_t x, both in x = w^2.
    of_body = [both, -(body * tire + 2 * soft * mass), 2 * soft * tire]
    of_tire = [2 * mass * both, -(2 * soft * mass**2 + body * tire * (mass + axle)), 0]
    of_tire[2] = 2 * soft * mass * tire
    return InvariantFrequencies(
        body_acceleration=_hertz([*np.roots(of_body), tire / axle]),
        suspension_travel=_hertz([tire / mass]),
        tire_force=_hertz(np.roots(of_tire)),
    )


def _span(values: FloatArray) -> str:
    """One number, or the least and the largest."""
    low, high = np.min(values), np.max(values)
    return f"{low:.4g}" if np.ndim(values) == 0 else f"{low:.4g} to {high:.4g}"


def _hertz(squares: ArrayLike) -> FloatArray:
    """Rising frequencies [Hz] of squares of angular frequencies [rad^2/s^2]."""
    return np.sort(np.sqrt(np.asarray(squares, dtype=np.float64))) / (2 * np.pi)


def _residual(car: QuarterCar) -> float:
    """N of `variances` [kg^3 N^2/m^2]: what the tire force keeps as c goes to zero."""
    body, axle = car.sprung_mass, car.unsprung_mass
    soft, tire, mass = car.suspension_stiffness, car.tire_stiffness, body + axle
    return soft**2 * mass**3 - 2 * soft * tire * body * axle * mass + tire**2 * body**2 * axle


def _car(car: QuarterCar) -> QuarterCar:
    return require_quarter_car(car, "the closed forms hold for it alone", "car")


def _damping(car: QuarterCar, damping: ArrayLike | None) -> FloatArray:
    if damping is None and car.damping == 0:
        raise ValueError("a car of damping 0 has no stationary state: type damping=7e3 [N s/m]")
    return _above_zero("damping", car.damping if damping is None else damping, "N s/m")


def _broadcast(intensity: float | FloatArray, damping: FloatArray) -> FloatArray:
    """W / 2c of every speed and damping."""
    try:
        return np.asarray(intensity / (2 * damping))[()]
    except ValueError:
        raise ValueError(
            f"speed and damping must have shapes that broadcast, got {np.shape(intensity)} and "
            f"{np.shape(damping)}: type speed[:, np.newaxis] for a table of both"
        ) from None


def _above_zero(name: str, value: ArrayLike, unit: str) -> FloatArray:
    """Check an array of any shape, all above zero."""
    result = check.floats(name, value, unit=unit)
    check.finite(name, result, unit=unit)
    if np.any(result <= 0):
        raise ValueError(f"{name} must be above 0 {unit}, got {result[result <= 0].flat[0]:g}")
    return result[()]
