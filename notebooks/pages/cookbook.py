"""Notebook 12: pictures of the recipes and the checks of what it says."""

from __future__ import annotations

import base64
import re
from collections.abc import Iterable
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import control
import numpy as np
from IPython.display import Image
from matplotlib.figure import Figure

import bridgectl as bc
from bridgectl.plots import style
from pages.claims import hold
from pages.survey import survey as survey

PLACE = "place of the tire, x [m]"


@style.styled
def fatigue(crossing: control.TimeResponseData, cycles: Iterable[tuple[float, ...]]) -> Figure:
    """Draw the moment over time, and how many cycles are larger than a range."""
    fig = Figure(figsize=(9.5, 3.2), layout="constrained")
    left, right = fig.subplots(1, 2, width_ratios=[3, 2])
    left.plot(crossing.time, crossing.outputs["M"] / 1e3, color=style.BLUE, lw=1.0)
    left.set(xlabel="time since the first axle entered [s]", ylabel="mid-span moment [kN m]")
    left.set_xlim(-0.5, 6.5)
    size, count = np.array([(each[0], each[2]) for each in cycles]).T
    order = np.argsort(size)[::-1]
    above = np.cumsum(count[order])
    right.step(size[order], above, where="pre", color=style.VERMILLION)
    right.set(xscale="log", yscale="log", xlim=(10, 2500))
    right.set_ylim(0.4, above[size[order] >= 10][-1] * 1.5)
    right.set(xlabel="range of the moment [kN m]", ylabel="cycles of this range or more")
    return fig


@style.styled
def signals(drive: control.TimeResponseData, speed: float) -> Figure:
    """Draw what is recorded on axle and body over the place, the bridge shaded."""
    fig = Figure(figsize=(9.5, 3.6), layout="constrained")
    for ax, (name, label) in zip(
        fig.subplots(2, sharex=True), {"axle": "y_t_ddot", "body": "y_s_ddot"}.items(), strict=True
    ):
        ax.axvspan(0, 25, color=style.BRIDGE_TINT)
        ax.plot(speed * drive.time, drive.outputs[label], color=style.BLUE, lw=0.8)
        ax.set_ylabel(f"{name}, down [m/s²]")
    ax.set_xlabel(PLACE + "; the bridge is shaded")
    return fig


@style.styled
def lqg(passive: control.TimeResponseData, active: control.TimeResponseData, c: float) -> Figure:
    """Draw the moment and the body's acceleration with and without the controller."""
    fig = Figure(figsize=(9.5, 4.6), layout="constrained")
    upper, lower = fig.subplots(2, sharex=True)
    runs = {"passive": (passive, style.GREY), "LQG": (active, style.VERMILLION)}
    for name, (run, colour) in runs.items():
        moment, body = (np.asarray(run.outputs[label]) for label in ("moment", "y_s_ddot"))
        upper.plot(c * run.time, moment, color=colour, label=f"{name}: DAF {moment.max():.3f}")
        most = np.abs(body).max()
        lower.plot(c * run.time, body, color=colour, label=f"{name}: at most {most:.2f} m/s²")
    upper.set_ylabel("moment / static one [-]")
    lower.set_ylabel("body, down [m/s²]")
    lower.set_xlabel(PLACE)
    for ax in (upper, lower):
        ax.axvspan(0, 25, color=style.BRIDGE_TINT)
        ax.margins(x=0)
    upper.legend(loc="upper left")
    lower.legend(loc="upper left", bbox_to_anchor=(0, 1.22), ncols=2)
    return fig


@style.styled
def percentiles(speeds: np.ndarray, daf: np.ndarray) -> Figure:
    """Draw the distribution of the DAF over roads at each speed."""
    fig = Figure(figsize=(6.5, 3.4), layout="constrained")
    ax = fig.subplots()
    for speed, each, colour in zip(speeds, daf.T, style.TRACKS, strict=False):
        ax.ecdf(each, color=colour, label=f"{3.6 * speed:.0f} km/h")
    ax.axhline(0.95, color=style.BLACK, lw=0.8, ls="--")
    ax.set(xlabel="DAF [-]", ylabel="share of the roads below [-]", xlim=(0.88, 1.24))
    ax.legend(loc="center right")
    return fig


def still(picture: int, path: str | Path = "crossing.html") -> Image:
    """Take one picture out of the page that an animation was written to."""
    text = Path(path).read_text(encoding="utf-8")
    found = re.findall(r"data:image/png;base64,([\w+/=\\\n]+)", text)[picture]
    return Image(base64.b64decode(re.sub(r"\\?\n", "", found)), width=640)


@style.styled
def surveyed(found: bc.RoadProfile, true: bc.RoadProfile) -> Figure:
    """Draw the road of a survey on the one that was surveyed, before and on the bridge."""
    fig = Figure(figsize=(9.5, 2.8), layout="constrained")
    ax = fig.subplots()
    ax.axvspan(0, 25, color=style.BRIDGE_TINT)
    for road, name, look in (
        (true, "the road that is there", {"color": style.GREY, "lw": 2.4}),
        (found, "from the survey", {"color": style.VERMILLION, "lw": 1.0}),
    ):
        shown = road.crop(-30, 25).detrend()
        ax.plot(shown.x, 1e3 * shown.elevation, label=name, **look)
    ax.set(xlabel=style.STATION_LABEL, ylabel="elevation, up [mm]", xlim=(-30, 25))
    ax.legend(loc="lower left", bbox_to_anchor=(0, 1), ncols=2)
    return fig


@style.styled
def ground(surface: bc.RampSurface, before: np.ndarray, after: np.ndarray) -> Figure:
    """Draw the road and the DAF over speed, before and after grinding."""
    fig = Figure(figsize=(9.5, 3.2), layout="constrained")
    left, right = fig.subplots(1, 2, width_ratios=[3, 2])
    kmh = 3.6 * surface.speeds
    for heights, name, colour, look in (
        (before, "as it is", style.GREY, "-"), (after, "ground", style.VERMILLION, "--"),
    ):  # fmt: skip
        left.plot(surface.stations, 1e3 * heights, look, color=colour, label=name)
        right.plot(kmh, surface.superposed_daf(heights), look, color=colour, label=name)
    cut = surface.stations[np.flatnonzero(before > after)]
    left.set(xlim=(cut[0] - 8, cut[-1] + 8), xlabel=style.STATION_LABEL)
    near = np.abs(surface.stations - cut.mean()) < 10
    left.set_ylim(1e3 * before[near].min() - 3, 1e3 * before[near].max() + 3)
    left.set_ylabel("elevation, up [mm]")
    right.set(xlabel=style.SPEED_LABEL, ylabel="DAF [-]")
    left.legend()
    return fig


def check(names: dict[str, Any]) -> None:
    """Assert what the page says of its recipes' results."""
    n = SimpleNamespace(**names)
    sizes = sorted((size for size, *_ in n.cycles), reverse=True)
    moments = [np.abs(run.outputs["moment"]).max() for run in (n.no, n.yes)]
    bodies = [np.abs(run.outputs["y_s_ddot"]).max() for run in (n.no, n.yes)]
    rare, mean = np.quantile(n.roads_daf, 0.95, axis=0), n.roads_daf.mean(axis=0)
    true, walked = n.there, np.hypot(np.diff(n.east), np.diff(n.north)).sum()
    dae = {name: n.surface.dae(each).max() for name, each in (
        ("before", n.height), ("after", n.plans[n.best]))}  # fmt: skip
    plain = bc.daf(*n.case, start=-20, damper=bc.dampers.skyhook(1e3, 30e3))[0]
    third = sum(count * size**3 for size, _, count, *_ in n.cycles) / (sizes[1] ** 3)
    gains = n.surface.superposed_daf(n.height) - n.surface.superposed_daf(n.plans[n.best])
    hold([
        ("damage in the third power, of one cycle up to the peak", third, 1.13, 0.015),
        ("largest range over the largest moment", sizes[0] / sizes[1], 1.07, 0.01),
        ("half cycles as one", n.alike / sizes[0], 0.97, 0.005),
        ("LQG: body's acceleration, of the passive one", bodies[1] / bodies[0], 0.5, 0.03),
        ("LQG: what it adds to the DAF", moments[1] - moments[0], 0.07, 0.005),
        ("filtered skyhook: DAF over the passive one", n.reached / n.passive, 1.07, 0.005),
        ("skyhook without the filter: DAF", plain, 0.997, 0.001),
        ("hogging at the pier [kN m]", n.found.smallest.min() / 1e3, -809, 1.0),
        ("95 % of roads, least above the mean", (rare - mean).min(), 0.034, 0.004),
        ("95 % of roads, most above the mean", (rare - mean).max(), 0.05, 0.004),
        ("75 years: interval's width over the value", (
            n.level.total.high - n.level.total.low) / n.level.total.value, 0.41, 0.02),
        ("survey: IRI [m/km]", n.short.iri(), true.crop(-100, 25).resample(0.25).iri(), 0.1),
        ("survey: added up, over the road's length", walked / np.ptp(n.whole.x), 1.05, 0.005),
        ("grinding: what it takes off at 65 km/h", gains[1], 0.044, 0.002),
        ("grinding: what it adds at 100 km/h", -gains[-1], 0.033, 0.004),
        ("grinding: DAE before less after", dae["before"] - dae["after"], 0.044, 0.002),
    ])  # fmt: skip
