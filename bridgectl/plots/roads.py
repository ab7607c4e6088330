"""Figures of roads: elevation, IRI and spectrum of a file, and roads of equal roughness."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from numpy.typing import ArrayLike

from bridgectl._checks import FloatArray
from bridgectl._units import to_kmh
from bridgectl.plots import style
from bridgectl.plots.shown import LineShown, PairShown, PsdShown, RoadShown

FILE_STATION_LABEL = "station [m]"


@style.styled
def profile_figure(roads: Sequence[RoadShown], segment: float = 100.0) -> Figure:
    """Draw the tracks of a road: elevation, IRI of each segment [m], and spectrum."""
    figure = Figure(figsize=(10.0, 8.4), layout="constrained")
    grid = figure.add_gridspec(2, 2, width_ratios=(1.35, 1))
    above = figure.add_subplot(grid[0, 0])
    below = figure.add_subplot(grid[1, 0], sharex=above)
    spectra = figure.add_subplot(grid[:, 1])
    psds, good = [road.psd() for road in roads], roads[0].good_iri
    for road, psd, color in zip(roads, psds, _colors(len(roads)), strict=True):
        above.plot(road.x, 1e3 * road.detrend().elevation, color=color, lw=0.9, label=road.name)
        iri = road.iri(segment=segment)
        edges = road.x[0] + segment * np.arange(iri.size + 1)
        label = f"{road.name}: {road.iri():.2f} m/km{' (coarse)' if psd.coarse else ''}"
        below.stairs(iri, edges, baseline=None, color=color, lw=1.8, label=label)
    above.set(ylabel="elevation, up [mm]", title="elevation without its straight line")
    above.tick_params(labelbottom=False)
    below.axhline(good, color=style.GREY, ls="--", lw=1.2)
    below.annotate(
        f"not good: {good:g} m/km and more", (0.01, good), (0, 4), color=style.GREY,
        xycoords=("axes fraction", "data"), textcoords="offset points",
    )  # fmt: skip
    below.set(
        xlabel=FILE_STATION_LABEL, ylabel="IRI [m/km]", title=f"IRI of each {segment:g} m",
        ylim=(0, max(below.get_ylim()[1], 1.15 * good)),
    )  # fmt: skip
    below.legend(loc="lower right", framealpha=0.8, frameon=True, edgecolor="none")
    _draw_spectra(spectra, psds)
    return figure


@style.styled
def psd_plot(psd: PsdShown, ax: Axes | None = None) -> Axes:
    """Draw the spectrum of a road over the classes of ISO 8608:2016, Annex B."""
    ax = style.new_axes(ax)
    _draw_spectra(ax, [psd])
    return ax


@style.styled
def pair_figure(
    pair: PairShown, speeds: ArrayLike, daf: ArrayLike, *, smooth: ArrayLike | None = None
) -> Figure:
    """Draw two roads of one IRI and one spectrum, and their DAF over speed: Fig. 3 of the paper.

    `daf` of both roads has shape (2, n_speeds), that of a `smooth` road (n_speeds,); speeds in m/s.
    """
    figure = Figure(figsize=(10.0, 7.4), layout="constrained")
    panels = figure.subplot_mosaic([["roads", "roads"], ["spectra", "daf"]], height_ratios=(1, 1.3))
    roads, colors = (pair.first, pair.second), _colors(2)
    kmh = to_kmh(np.asarray(speeds))
    for i, (road, color) in enumerate(zip(roads, colors, strict=True)):
        label = f"case {i + 1}: IRI {pair.iri[i]:.2f} m/km"
        panels["roads"].plot(road.x, 1e3 * road.elevation, color=color, lw=1.2, label=label)
        panels["daf"].plot(kmh, np.asarray(daf)[i], color=color, lw=1.8, label=f"case {i + 1}")
        psd = road.psd(float(road.x[-1] - road.x[0]), window="boxcar")
        look = {"lw": 3.0 - 2 * i, "color": color, "label": f"case {i + 1}"}
        panels["spectra"].loglog(psd.wavenumber, psd.density, **look)
    if smooth is not None:
        panels["daf"].plot(kmh, smooth, ":", color=style.GREY, lw=1.8, label="smooth road")
    panels["daf"].axvline(to_kmh(pair.speed), color=style.GREY, lw=0.9, zorder=1)
    panels["daf"].set(
        xlabel=style.SPEED_LABEL, ylabel="DAF [-]",
        title=f"made to differ at {to_kmh(pair.speed):.4g} km/h",
    )  # fmt: skip
    panels["roads"].axvspan(0, float(roads[0].x[-1]), color=style.BRIDGE_TINT, zorder=0)
    panels["roads"].set(
        xlabel=style.STATION_LABEL,
        ylabel="elevation, up [mm]",
        title="two roads of equal roughness",
    )
    panels["spectra"].set(
        xlabel="wave number [cycles/m]", ylabel="$G_d$ [m³]", title="with one periodogram"
    )
    panels["spectra"].set_ylim(_range([psd.density[psd.wavenumber <= psd.band[1]]]))
    for panel in panels.values():
        panel.legend()
    return figure


def _draw_spectra(ax: Axes, spectra: Sequence[PsdShown]) -> None:
    """Spectra, their lines, and the bands of the ISO classes that they lie in."""
    lowest = min(psd.wavenumber[0] for psd in spectra)
    highest = max(psd.wavenumber[-1] for psd in spectra)
    band, classes = spectra[0].band, spectra[0].classes
    n = np.array([min(lowest, band[0]), max(highest, band[1])])
    limits = _range([psd.density[psd.wavenumber <= band[1]] for psd in spectra])
    for psd, color in zip(spectra, _colors(len(spectra)), strict=True):
        name = psd.name or "road"
        if psd.coarse:
            label = f"{name}: too coarse for a class"
            ax.loglog(psd.wavenumber, psd.density, color=color, lw=0.9, alpha=0.75, label=label)
            continue
        ax.loglog(psd.wavenumber, psd.density, color=color, lw=0.9, alpha=0.75)
        fit = psd.fit()
        label = (
            f"{name}: class {fit.iso_class}, w = {fit.waviness:.2f},\n"
            f"$G_d(n_0)$ = {fit.roughness * 1e6:.3g}·10⁻⁶ m³"
        )
        inside = np.clip(n, *band)
        ax.loglog(inside, fit.density(inside), color=color, lw=2.2, label=label)
    _draw_classes(ax, classes, n, limits)
    ax.set(
        xlim=n, ylim=limits, xlabel="wave number n [cycles/m]",
        ylabel="power spectral density $G_d$ [m³]", title="spectrum, and the ISO 8608 classes",
    )  # fmt: skip
    ax.legend(loc="lower left", fontsize=8.5)


def _range(densities: Sequence[FloatArray]) -> tuple[float, float]:
    """Limits of an axis that leave out what lies beyond the band, and make room for a legend."""
    every = np.concatenate(densities)
    return 0.05 * float(every.min()), 4 * float(every.max())


def _draw_classes(
    ax: Axes, classes: Mapping[str, Sequence[LineShown]], n: FloatArray, limits: tuple[float, float]
) -> None:
    """Bands of the classes, every other one tinted, with their letters at the left edge."""
    place = 1.5 * n[0]
    for i, (name, (lower, mean, upper)) in enumerate(classes.items()):
        if i % 2 == 0:
            limits_at = lower.density(n), upper.density(n)
            ax.fill_between(n, *limits_at, color=style.BRIDGE_TINT, lw=0, zorder=0)
        height = float(mean.density(place))
        if limits[0] < height < limits[1]:
            ax.text(place, height, name, color=style.GREY, ha="center", va="center", fontsize=11)


def _colors(count: int) -> list[str]:
    return [style.TRACKS[i % len(style.TRACKS)] for i in range(count)]
