"""Two roads of one IRI and one spectrum that load a bridge differently: Fig. 3 of the paper.

The DAE is linear in the ramps of a road, so the phases of its waves decide: all in step with the
bridge give the largest DAE of one spectrum. An augmented Lagrangian holds the IRI.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike
from scipy.fft import irfft, rfft
from scipy.optimize import minimize

from bridgectl import _checks as check
from bridgectl._checks import FloatArray
from bridgectl._threads import on_one_thread
from bridgectl._units import to_kmh
from bridgectl.extremes.common import IRI_TOLERANCE, NO_EFFECT, speed_index
from bridgectl.road import RoadProfile
from bridgectl.road.iri import suspension_slope
from bridgectl.surface.surface import RampSurface

if TYPE_CHECKING:
    from matplotlib.figure import Figure

PAPER_IRI = 2.78
"""IRI of both roads of the paper's Fig. 3 [m/km]."""

FIRST_WEIGHT, ROUNDS = 0.1, 20
"""Penalty of a squared error of the IRI [1/(m/km)^2], doubled in each of at most so many rounds."""


@dataclass(frozen=True, eq=False)
class EqualRoughnessPair:
    """Two roads with one IRI and one spectrum, made by `equal_roughness_pair`.

    Attributes
    ----------
    first, second : RoadProfile
        The road that was given, scaled to the IRI, and the one with other phases.
    speed : float
        Speed [m/s] at which their DAEs differ most.
    dae : ndarray, shape (2,)
        DAE of both at that speed.
    iri : ndarray, shape (2,)
        IRI of both [m/km].
    psd_difference : float
        Largest difference of their periodograms, as a fraction.
    """

    first: RoadProfile
    second: RoadProfile
    speed: float
    dae: FloatArray
    iri: FloatArray
    psd_difference: float

    def __repr__(self) -> str:
        return (
            f"EqualRoughnessPair(IRI {self.iri[0]:.3f} and {self.iri[1]:.3f} m/km, DAE "
            f"{self.dae[0]:.4f} and {self.dae[1]:.4f} at {to_kmh(self.speed):g} km/h)"
        )

    def plot(self, speeds: ArrayLike, daf: ArrayLike, *, smooth: ArrayLike | None = None) -> Figure:
        """Draw both roads, their spectra, and their DAF (2, n_speeds) over speeds [m/s]: Fig. 3."""
        from bridgectl.plots.roads import pair_figure  # late: matplotlib is slow to load

        return pair_figure(self, speeds, daf, smooth=smooth)


@on_one_thread
def equal_roughness_pair(
    surface: RampSurface,
    road: RoadProfile,
    speed: float,
    *,
    iri: float = PAPER_IRI,
    largest: bool = True,
) -> EqualRoughnessPair:
    """Make from one road another with the same spectrum and IRI but another DAE (Fig. 3).

    The road is scaled to the IRI. The amplitudes of the waves of its ramps are kept; their phases
    are chosen for the largest (or smallest) DAE at a speed, with the IRI held. The spectrum is the
    periodogram of the whole road: its waves gather on the bridge, as spectra of shorter stretches
    show.

    Parameters
    ----------
    surface : RampSurface
        Ramp surface of bridge and vehicle.
    road : RoadProfile
        A road over the surface's approach and bridge.
    speed : float
        One of the surface's speeds [m/s].
    iri : float, optional
        IRI of both roads over approach and bridge [m/km].
    largest : bool, optional
        Whether the second road's DAE is to be large, or small. The DAF, a maximum over time,
        seldom falls as far as a small DAE says.

    Returns
    -------
    EqualRoughnessPair

    Raises
    ------
    TypeError, ValueError
        If an argument is not what is described above, or the road is level.
    RuntimeError
        If no phases with this IRI are found.

    References
    ----------
    Y. Li, E. OBrien, A. Gonzalez, J. Sound Vib. 293 (2006) 125-137, Section 2.3 and Fig. 3.

    Examples
    --------
    >>> import bridgectl as bc
    >>> from bridgectl.extremes import equal_roughness_pair
    >>> surface = bc.ramp_surface(bc.li2006.beam(), bc.li2006.car(), 25.0, approach=75)
    >>> road = bc.iso8608_profile("A", 100, seed=1, start=-75)
    >>> pair = equal_roughness_pair(surface, road, 25.0)
    >>> pair.iri.round(3), bool(pair.dae[1] > pair.dae[0] + 0.1)
    (array([2.78, 2.78]), True)
    """
    target = check.positive("iri", iri, unit="m/km")
    i = speed_index(surface, speed)
    first = _scaled(surface, road, target)
    search = _PhaseSearch(surface, first, i, target, 1.0 if largest else -1.0)
    second = surface.road(search.best(), f"{road.name}, other phases")
    both = (first, second)
    daes = np.array([surface.dae(each)[i] for each in both])
    iris = np.array([each.iri() for each in both])
    at, apart = float(surface.speeds[i]), _psd_difference(*both)
    pair = EqualRoughnessPair(first, second, at, daes, iris, apart)
    if np.abs(pair.iri - target).max() > IRI_TOLERANCE:
        raise RuntimeError(f"no phases of this road have an IRI of {target:g} m/km: {pair!r}")
    return pair


class _PhaseSearch:
    """Phases of the waves of a road's ramps: most DAE, with the IRI held."""

    def __init__(
        self, surface: RampSurface, road: RoadProfile, speed: int, iri: float, sign: float
    ) -> None:
        drops = surface.ramps(road) * surface.ramp_height
        self.n, self.iri = drops.size, iri
        self.waves = rfft(drops)
        # The mean drop, and the shortest wave of an even number of ramps, have no phase.
        self.turned = slice(1, (self.n + 1) // 2)
        self.amplitude = np.abs(self.waves[self.turned])
        self.effect = sign * surface.daf_difference[speed] / surface.ramp_height
        # Golden-car motion of a drop of 1 m at each ramp, (n_ramps, n_steps).
        fallen = -np.tri(self.n + 1, self.n, -1).T
        self.motion = suspension_slope(fallen, surface.ramp_length)

    def best(self) -> FloatArray:
        """Drops [m] of the road found, from an augmented Lagrangian for the IRI.

        It starts where all waves act together on the bridge, the largest DAE of any phases.
        """
        phases = np.angle(rfft(self.effect)[self.turned])
        multiplier, weight = 0.0, FIRST_WEIGHT
        for _ in range(ROUNDS):
            solved = minimize(
                self._lagrangian, phases, (multiplier, weight), method="L-BFGS-B", jac=True,
                options={"maxiter": 200},
            )  # fmt: skip
            phases = solved.x
            excess = self._iri(self.drops(phases))[0] - self.iri
            multiplier += weight * excess
            if abs(excess) < IRI_TOLERANCE:
                break
            weight *= 2
        return self.drops(phases)

    def drops(self, phases: FloatArray) -> FloatArray:
        """Drops [m] of the ramps with these phases of their waves."""
        waves = self.waves.copy()
        waves[self.turned] = self.amplitude * np.exp(1j * phases)
        return np.asarray(irfft(waves, self.n))

    def _iri(self, drops: FloatArray) -> tuple[float, FloatArray]:
        """IRI [m/km], and its slope over each drop."""
        motion = drops @ self.motion
        return float(np.abs(motion).mean()), self.motion @ np.sign(motion) / motion.size

    def _lagrangian(
        self, phases: FloatArray, multiplier: float, weight: float
    ) -> tuple[float, FloatArray]:
        drops = self.drops(phases)
        iri, iri_slope = self._iri(drops)
        excess = iri - self.iri
        value = -self.effect @ drops + multiplier * excess + weight / 2 * excess**2
        slope = -self.effect + (multiplier + weight * excess) * iri_slope
        turn = np.exp(1j * phases) * np.conj(rfft(slope)[self.turned])
        return float(value), -2 / self.n * self.amplitude * turn.imag


def _scaled(surface: RampSurface, road: RoadProfile, iri: float) -> RoadProfile:
    """The road under the surface's ramps, scaled to an IRI."""
    drops = surface.ramps(road) * surface.ramp_height
    roughness = surface.road(drops, road.name).iri()
    if roughness == 0:
        raise ValueError(f"road is level or a straight grade: no scale gives it {iri:g} m/km")
    return surface.road(drops * (iri / roughness), road.name)


def _psd_difference(first: RoadProfile, second: RoadProfile) -> float:
    """Largest relative difference of two periodograms, over waves that the first road has."""
    whole = float(first.x[-1] - first.x[0])
    one, other = (road.psd(whole, window="boxcar").density for road in (first, second))
    return float(np.max(np.abs(other - one) / np.maximum(one, NO_EFFECT * one.max())))
