"""What the page on roughness numbers draws and checks: bridges along a road, terms, grinding."""

from __future__ import annotations

from collections.abc import Mapping
from types import SimpleNamespace
from typing import Any

import numpy as np
from matplotlib.figure import Figure

import bridgectl as bc
from bridgectl.plots import style
from pages.claims import hold

COLORS = (style.BLUE, style.VERMILLION)
DAF = "largest DAF [-]"


def best(gain: np.ndarray, width: int, count: int) -> list[int]:
    """Return where the stretches of `width` steps of largest gain start that do not overlap."""
    left, starts = gain.copy(), []
    for _ in range(count):
        starts.append(int(left.argmax()))
        left[max(0, starts[-1] - width) : starts[-1] + width + 1] = -np.inf
    return starts


def whole(measured: bc.RoadProfile, place: float, part: bc.RoadProfile, z: np.ndarray) -> float:
    """Return the IRI of the whole road once the part around the bridge is ground from z."""
    change = np.interp(measured.x - place, part.x, part.elevation - z, left=0, right=0)
    return bc.RoadProfile(measured.x, measured.elevation + change).iri()


@style.styled
def along_the_road(
    places: np.ndarray, iri: np.ndarray, peak: np.ndarray, smooth: float, pair: tuple[int, int]
) -> Figure:
    """Draw IRI and largest DAF over the place of the bridge, and one over the other."""
    fig = Figure(figsize=(10, 4.6), layout="constrained")
    grid = fig.add_gridspec(2, 2, width_ratios=(1.5, 1))
    above, below, beside = (fig.add_subplot(grid[i]) for i in [(0, 0), (1, 0), (slice(None), 1)])
    above.plot(places, iri, color=style.BLACK)
    above.set(ylabel="IRI [m/km]", ylim=(0, None), title="IRI of the 100 m around each bridge")
    below.plot(places, peak, color=style.GREY, lw=1)
    below.axhline(smooth, color=style.BLACK, ls=":", zorder=3, label="smooth road")
    below.set(ylabel=DAF, xlabel="station of the start of the bridge [m]")
    beside.plot(iri, peak, "o", ms=3, color=style.GREY, mew=0)
    beside.set(xlabel="IRI [m/km]", ylabel=DAF, title="one dot a place of the bridge")
    for place, color in zip(pair, COLORS, strict=True):
        i = place - places[0]
        look = {"ls": "", "marker": "o", "color": color, "zorder": 4}
        below.plot(place, peak[i], label=f"bridge at {place} m", **look)
        beside.plot(iri[i], peak[i], ms=7, **look)
    below.legend(loc="upper left", ncols=3, fontsize=8.5, bbox_to_anchor=(0, 1.24))
    fig.align_ylabels([above, below])
    return fig


@style.styled
def over_speed(kmh: np.ndarray, dafs: Mapping[str, np.ndarray], smooth: np.ndarray) -> Figure:
    """Draw the DAF of some roads over the speed, beside that of a smooth one."""
    fig = Figure(figsize=(7.5, 3.4), layout="constrained")
    ax = fig.subplots()
    for (label, daf), color in zip(dafs.items(), COLORS, strict=True):
        ax.plot(kmh, daf, color=color, label=label)
    ax.plot(kmh, smooth, ":", color=style.GREY, label="smooth road")
    ax.set(xlabel=style.SPEED_LABEL, ylabel="DAF [-]", xlim=(50, 150))
    ax.legend(loc="upper left", fontsize=9)
    return fig


@style.styled
def products(start: np.ndarray, effect: np.ndarray, scale: np.ndarray, length: float) -> Figure:
    """Draw the effect of a unit ramp, the ramps of the road, and the sum of their products."""
    fig = Figure(figsize=(9, 6), layout="constrained")
    axes = fig.subplots(3, 1, sharex=True)
    axes[0].plot(start, 1e3 * effect, color=style.BLUE)
    axes[0].set(ylabel="effect of a\n1 mm drop [$10^{-3}$]", title="bridge and truck")
    axes[1].vlines(start, 0, scale, color=style.BLACK, lw=0.9)
    axes[1].set(ylabel="s(i): drop over\n100 mm [mm]", title="road")
    axes[2].plot(start, np.cumsum(effect * scale), color=style.VERMILLION)
    title = f"the sum of the products of both, from {start[0]:.0f} m on"
    axes[2].set(ylabel="sum so far [-]", title=title, xlabel=style.STATION_LABEL)
    for ax in axes:
        ax.axvspan(0, length, color=style.BRIDGE_TINT, zorder=0)
        ax.axhline(0, color=style.GREY, lw=0.8)
    axes[2].set(xlim=(start[0], length))
    fig.align_ylabels(axes)
    return fig


@style.styled
def grinding(
    road: bc.RoadProfile, surface: bc.RampSurface, gains: Mapping[str, np.ndarray],
    starts: Mapping[str, list[int]], dafs: Mapping[str, np.ndarray],
) -> Figure:  # fmt: skip
    """Draw where the road is ground, what each stretch takes away, and the DAF before and after."""
    fig = Figure(figsize=(10, 6.4), layout="constrained")
    grid = fig.add_gridspec(2, 2, height_ratios=(1, 1.25))
    top, left, right = (fig.add_subplot(grid[i]) for i in [(0, slice(None)), (1, 0), (1, 1)])
    x, kmh = road.x, 3.6 * surface.speeds
    top.axvspan(0, x[-1], color=style.BRIDGE_TINT, zorder=0)
    top.plot(x, 1e3 * road.elevation, color=style.BLACK, lw=1)
    left.plot(gains["IRI"], gains["DAE"], "o", ms=3, color=style.GREY, mew=0)
    right.plot(kmh, dafs["before"], color=style.BLACK, label="before")
    for (name, chosen), color in zip(starts.items(), COLORS, strict=True):
        for k, at in enumerate(sorted(chosen)):
            label = f"ground by {name}" if k == 0 else None
            top.axvspan(x[at], x[at] + 3, color=color, alpha=0.35, lw=0, label=label)
        dots = gains["IRI"][chosen], gains["DAE"][chosen]
        left.plot(*dots, "o", ms=7, color=color, label=f"chosen by {name}")
        right.plot(kmh, dafs[name], color=color, label=f"ground by {name}")
    right.plot(kmh, surface.daf_smooth, ":", color=style.GREY, label="smooth road")
    top.set(xlabel=style.STATION_LABEL, ylabel="elevation [mm]", xlim=(x[0], x[-1]))
    left.set(xlabel="IRI taken away [m/km]", ylabel="DAE taken away [-]")
    left.set_title("one dot a stretch of 3 m")
    right.set(xlabel=style.SPEED_LABEL, ylabel="DAF [-]", title="DAF over speed", xlim=(50, 150))
    top.legend(loc="lower left", ncols=2, bbox_to_anchor=(0, 1), borderaxespad=0.2)
    left.legend(loc="upper left")
    right.legend(loc="upper left", fontsize=9)
    return fig


def check(names: dict[str, Any]) -> None:
    """Assert what the page says of its road, the pair of roads, the ramps and the grinding."""
    n = SimpleNamespace(**names)
    surface, road, before = n.surface, n.road, n.dafs["before"]
    by_dae = n.ground_road["DAE"]
    add = before.max() - surface.daf_smooth.max()
    one, two = (surface.superposed_daf(n.road_at(place)).max() for place in n.pair_of_places)
    simulated = bc.daf(n.beam, n.truck, n.kmh / 3.6, by_dae, start=-n.approach).max()
    terms, at = surface.contributions(road)[n.critical], n.critical
    left = {name: r.iri() / road.iri() for name, r in n.ground_road.items()}
    hold([
        ("IRI of the measured road [m/km]", n.measured.iri(), 3.335, 5e-3),
        ("IRI of its smoothest 50 m [m/km]", n.measured.iri(segment=50).min(), 2.3, 0.05),
        ("IRI of its roughest 50 m [m/km]", n.measured.iri(segment=50).max(), 4.2, 0.05),
        ("waviness of its spectrum", n.fit.waviness, 2.54, 0.01),
        ("correlation of IRI and largest DAF", n.correlation, 0.18, 0.01),
        ("3 m apart: IRI, difference", n.road_at(820).iri() - n.road_at(817).iri(), 0, 0.1),
        ("3 m apart: DAF at 817 m", one, 1.067, 2e-3),
        ("3 m apart: DAF at 820 m", two, 1.251, 2e-3),
        ("largest DAF, smooth road", surface.daf_smooth.max(), 1.14, 5e-3),
        ("pair: difference of the IRIs [m/km]", np.ptp(n.pair.iri), 0, 2e-4),
        ("pair: difference of the spectra", n.pair.psd_difference, 0, 1e-6),
        ("pair: largest DAF, first road", n.pair_daf[0].max(), 1.076, 2e-3),
        ("pair: largest DAF, second road", round(n.pair_daf[1].max(), 1), 1.5, 1e-6),
        ("pair: speeds with a tire off the road", n.lifts_off.sum(), 0, 0),
        ("the same upside down, at 108 km/h", round(n.mirrored_daf[n.at_108], 1), 1, 1e-6),
        ("upside down: IRI, difference", n.upside_down.iri() - n.pair.second.iri(), 0, 1e-9),
        ("terms of Eq. (15) add up to the DAE",
         surface.daf_smooth[at] + terms.sum() - surface.dae(road)[at], 0, 1e-9),
        ("terms after mid-span", np.abs(n.effect[n.start > 12.5]).max(), 0, 1e-9),
        ("steepest drop from -15 m on, at [m]", n.start[n.scale.argmax()], 8.5, 0.15),
        ("where a drop harms most, at [m]", n.start[n.effect.argmax()], 8.0, 0.15),
        ("the drop under the bridge at 820 m", n.terms[820], 0.07, 0.01),
        ("the drop under the bridge at 817 m", n.terms[817], -0.05, 0.01),
        ("DAE - DAF at the critical speed", surface.dae(road)[at] - before[at], 0, 1e-6),
        ("ground by DAE: IRI left, 100 m", left["DAE"], 0.94, 0.01),
        ("ground by DAE: IRI left, 544 m",
         whole(n.measured, 820, by_dae, n.z) / n.measured.iri(), 0.987, 0.005),
        ("ground by DAE: share taken of what the road adds",
         (before.max() - n.dafs["DAE"].max()) / add, 0.8, 0.05),
        ("ground by IRI: IRI left, 100 m", left["IRI"], 0.88, 0.01),
        ("ground by IRI: metres of it on the bridge",
         max(0, n.x[max(n.starts["IRI"]) + 30]), 0, 1e-9),
        ("ground by IRI: DAF - DAF before", n.dafs["IRI"].max() - before.max(), 0, 0.005),
        ("ground by DAE: superposed - simulated DAF", n.dafs["DAE"].max() - simulated, 0, 1e-6),
    ])  # fmt: skip
