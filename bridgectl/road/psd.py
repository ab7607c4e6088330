"""Power spectral density of a road's elevation, and the ISO 8608 line through it.

The density G_d(n) is one-sided, in m^3 over wave numbers n in cycles per metre, as in ISO 8608::

    G_d(n) = G_d(n_0) (n / n_0)^-w,   n_0 = 0.1 cycles/m

with the waviness w, 2 for the standard's classes. It is estimated from the *slope* of the road,
whose spectrum is nearly flat, so that long waves do not leak into short ones.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from numpy.typing import ArrayLike
from scipy.signal import welch
from scipy.special import digamma

from bridgectl import _checks as check
from bridgectl._checks import FloatArray
from bridgectl._labelled import Labelled
from bridgectl._places import whole_pieces
from bridgectl._warn import warn
from bridgectl.road.limits import even_step
from bridgectl.road.sampling import coarse, too_coarse

if TYPE_CHECKING:
    import pandas
    from matplotlib.axes import Axes

REFERENCE = 0.1
"""Reference wave number n_0 [cycles/m] of ISO 8608."""

BAND = (0.011, 2.83)
"""Wave numbers [cycles/m] over which ISO 8608 classifies a road."""

SEGMENT = 100.0
"""Length of the averaged stretches [m]: their second harmonic lies inside `BAND`."""

BANDS_PER_OCTAVE = 3
"""The line goes through means over third octaves, so that short waves do not outvote long ones."""

CLASSES = "ABCDEFGH"

UNMEASURED = (1e-11, 1e3 * np.finfo(float).eps)
"""Heights [m], and parts of the largest elevation, that no road has but round-off may make."""

ROUND_OFF = 1e-3
"""Of a wave number, as mean and median steps of rounded stations differ."""


def class_roughness(iso_class: str, level: str = "mean") -> float:
    """Return G_d(n_0) [m^3] of an ISO 8608 class: its geometric mean, or its limits.

    Class A has the mean 16e-6 m^3 and the limits 8e-6 and 32e-6; each further class four times as
    much (ISO 8608:2016, Table C.1). The standard leaves out the lower limit of A and the upper
    limit of H; here they follow the same rule.
    """
    check.choice("iso_class", iso_class, tuple(CLASSES))
    factor = {"lower": 0.5, "mean": 1.0, "upper": 2.0}
    check.choice("level", level, tuple(factor))
    return 16e-6 * 4 ** CLASSES.index(iso_class) * factor[level]


class PsdFit(NamedTuple):
    """The straight line of ISO 8608 through a spectrum, found by `RoadPsd.fit`."""

    roughness: float
    """G_d(n_0) [m^3]."""
    waviness: float
    """w [-]."""

    def __repr__(self) -> str:
        return (
            f"PsdFit(G_d(n_0) {self.roughness:.3g} m^3, waviness {self.waviness:.3g}, "
            f"class {self.iso_class})"
        )

    @property
    def iso_class(self) -> str:
        """The ISO 8608 class that the roughness lies in, "A" to "H"."""
        limits = [class_roughness(name, "upper") for name in CLASSES[:-1]]
        return CLASSES[int(np.searchsorted(limits, self.roughness))]

    def density(self, wavenumber: ArrayLike) -> FloatArray:
        """Return G_d(n) = G_d(n_0) (n / n_0)^-w [m^3] of wave numbers n [cycles/m]."""
        return np.asarray(self.roughness * (np.asarray(wavenumber) / REFERENCE) ** -self.waviness)


@dataclass(frozen=True, eq=False)
class RoadPsd:
    """One-sided power spectral density of a road's elevation; made by `RoadProfile.psd`.

    Attributes
    ----------
    wavenumber : ndarray, shape (n,)
        Wave numbers [cycles/m], above zero.
    density : ndarray, shape (n,)
        G_d [m^3].
    averages : float
        Number of independent stretches of road that each density averages.
    name : str
        Label for plots.
    resolved : float
        Highest wave number [cycles/m] that the road was measured at, of waves two steps long; of an
        interpolated road it lies below those of its spectrum.
    round_off : float
        Density [m^3] below which the spectrum may be one of round-off.

    Examples
    --------
    >>> import bridgectl as bc
    >>> bc.utia_road().psd()
    RoadPsd('UTIA road', 200 wave numbers from 0.01 to 2 cycles/m, 8.6 averages)
    """

    wavenumber: FloatArray
    density: FloatArray
    averages: float
    name: str = ""
    resolved: float = np.inf
    round_off: float = 0.0

    def __repr__(self) -> str:
        n = self.wavenumber
        return (
            f"RoadPsd({self.name!r}, {n.size} wave numbers from {n[0]:.4g} to {n[-1]:.4g} "
            f"cycles/m, {self.averages:.1f} averages)"
        )

    def fit(self, *, waviness: float | None = None, band: tuple[float, float] = BAND) -> PsdFit:
        """Fit the line of ISO 8608 over a band [cycles/m]: G_d(n_0), waviness and class.

        Least squares through the logarithms of third-octave means, each freed of the bias that the
        logarithm of a mean of few values has (ISO 8608:2016, Section 5.2 and Annex C). A given
        waviness, 2 for the classes, leaves G_d(n_0) alone to be fitted. A warning tells if the band
        reaches beyond what the road was measured at (see `RoadProfile.measured_step`).
        """
        ends = check.array("band", band, (2,), unit="cycles/m")
        n, logarithm = self._third_octaves(ends)
        if self.coarse and ends[1] > self.resolved * (1 + ROUND_OFF):
            warn(coarse("the line of ISO 8608", 0.5 / self.resolved, name=self.name))
        octave = np.log(n / REFERENCE)
        if waviness is None:
            slope, level = np.polyfit(octave, logarithm, 1)
        else:
            slope = -check.number("waviness", waviness)
            level = np.mean(logarithm - slope * octave)
        return PsdFit(float(np.exp(level)), float(-slope))

    @property
    def coarse(self) -> bool:
        """Whether the road was measured too coarsely for the classes of ISO 8608."""
        return too_coarse(0.5 / self.resolved)

    @property
    def band(self) -> tuple[float, float]:
        """Wave numbers [cycles/m] over which ISO 8608 classifies a road."""
        return BAND

    @property
    def classes(self) -> dict[str, tuple[PsdFit, ...]]:
        """Lower limit, mean and upper limit of each ISO 8608 class, as lines of waviness 2."""
        levels = ("lower", "mean", "upper")
        return {
            name: tuple(PsdFit(class_roughness(name, level), 2.0) for level in levels)
            for name in CLASSES
        }

    def _third_octaves(self, band: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Geometric mean wave number and logarithm of the mean density of each third octave."""
        high = min(band[1], self.resolved * (1 + ROUND_OFF))
        inside = (self.wavenumber >= band[0]) & (self.wavenumber <= high)
        n, density = self.wavenumber[inside], self.density[inside]
        which = np.floor(BANDS_PER_OCTAVE * np.log2(n / band[0])).astype(int)
        if np.unique(which).size < 2:
            raise ValueError(
                f"the spectrum has {n.size} wave numbers from {band[0]:g} to {band[1]:g} cycles/m, "
                "too few for a line: pass a longer road, or another band"
            )
        count = np.bincount(which)
        held = count > 0
        count = count[held]
        mean = np.bincount(which, density)[held] / count
        if np.any(mean <= self.round_off):
            raise ValueError(
                f"the road has no waves in a part of {band[0]:g} to {band[1]:g} cycles/m: a line "
                "needs some everywhere in its band"
            )
        place = np.exp(np.bincount(which, np.log(n))[held] / count)
        # A mean of m independent densities is gamma distributed: E[ln] = ln + psi(m) - ln m.
        # The Hann window ties neighbours by 4/9 and 1/36 (squared correlations).
        ties = 1 + 2 * (4 / 9 * (1 - 1 / count) + 1 / 36 * np.maximum(1 - 2 / count, 0))
        m = self.averages * count / ties
        return place, np.log(mean) - digamma(m) + np.log(m)

    def to_pandas(self) -> pandas.DataFrame:
        """Return the density [m^3] as a table over the wave numbers [cycles/m].

        Returns
        -------
        pandas.DataFrame
            Indexed by 'wavenumber' with a column 'density'; units are in ``attrs["units"]``.
        """
        units = {"wavenumber": "cycles/m", "density": "m^3"}
        return Labelled({"wavenumber": self.wavenumber}, {"density": self.density}, units).table()

    def plot(self, ax: Axes | None = None) -> Axes:
        """Draw the spectrum over the ISO 8608 classes, in a new figure or in `ax`."""
        from bridgectl.plots.roads import psd_plot  # late, for matplotlib is slow to load

        return psd_plot(self, ax=ax)


def elevation_psd(
    elevation: ArrayLike, step: float, segment: float | None = None, window: str = "hann"
) -> tuple[FloatArray, FloatArray, float]:
    """Spectra of evenly sampled roads: wave numbers, densities (..., n), averages.

    Welch's method on the slope, with half of each stretch in the next one.
    """
    heights = np.asarray(elevation, dtype=np.float64)
    slopes = np.diff(heights) / step
    n_slopes = slopes.shape[-1]
    length = SEGMENT if segment is None else check.positive("segment", segment, unit="m")
    size = min(whole_pieces(length, step), n_slopes)
    if size < 8:
        raise ValueError(f"segment must hold 8 steps of {step:g} m or more, got {size}")
    n, slope_psd = welch(slopes, 1 / step, window=window, nperseg=size, detrend="constant")
    n, slope_psd = n[1:], slope_psd[..., 1:]
    # The slope of a sampled wave exp(2 pi i n x) is its difference over a step.
    density = slope_psd / (2 * np.sin(np.pi * n * step) / step) ** 2
    stretches = 1 + (n_slopes - size) // (size - size // 2)
    # Hann windows that overlap by half are correlated by 1/6.
    averages = stretches / (1 + (stretches - 1) / stretches / 18)
    return n, density, averages


def road_psd(
    x: FloatArray, elevation: FloatArray, segment: float | None, window: str, name: str,
    measured_step: float,
) -> RoadPsd:  # fmt: skip
    """Spectrum of one road; see `RoadProfile.psd`."""
    step = even_step(x, "PSD")
    n, density, averages = elevation_psd(elevation, step, segment, window)
    height = max(UNMEASURED[0], UNMEASURED[1] * float(np.abs(elevation).max()))
    # White noise of this height, and so of a variance of a twelfth of its square, as of rounding.
    resolved = 0.5 / (measured_step or step)
    return RoadPsd(n, density, averages, name, resolved, step * height**2 / 6)
