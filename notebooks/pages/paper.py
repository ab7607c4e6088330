"""What the first page draws and checks: the paper's printed numbers beside the computed ones."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from types import SimpleNamespace
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

import bridgectl as bc
from bridgectl import li2006
from bridgectl.plots import style
from pages.claims import hold

PLACE = "place of the tire, x [m]"
MOMENT = "mid-span moment / $M_0$ [-]"
RAMP = "start of the ramp, x/l [-]"


def beside(rows: Iterable[tuple[str, float, float, int]]) -> None:
    """Print what is printed in the paper, what is computed, and the difference."""
    print(f"{'':<36}{'printed':>10} {'computed':>10} {'difference':>11}")
    for what, printed, computed, digits in rows:
        print(
            f"{what:<36}{printed:>10} {computed:>10.{digits}f} {computed - printed:>+11.{digits}f}"
        )


@style.styled
def truck_on_bridge(beam: bc.Beam) -> Figure:
    """Draw the quarter-car on the bridge, whose length is to scale; the truck is larger."""
    fig = Figure(figsize=(9.5, 3.9), layout="constrained")
    ax = fig.subplots()
    x, at, end = np.linspace(0, beam.length, 101), 9.0, beam.length
    ax.fill_between(x, -0.55, 0, color=style.PAVEMENT, lw=0)
    ax.plot(x, -0.55 - 0.8 * np.sin(np.pi * x / end), "--", color=style.BLUE, lw=1.2)
    ax.plot([0, end], [-0.85] * 2, "^", ms=13, color=style.DECK)
    ax.fill_between([-4, 0], -0.55, 0, color=style.GROUND, lw=0)
    ax.fill_between([end, end + 4], -0.55, 0, color=style.GROUND, lw=0)
    _spring(ax, at, 0, 1.4)
    _spring(ax, at - 0.9, 2.2, 3.9)
    _damper(ax, at + 0.9, 2.2, 3.9)
    ax.fill_between([at - 1.4, at + 1.4], 1.4, 2.2, color=style.GREY, lw=0)
    ax.fill_between([at - 2.4, at + 2.4], 3.9, 5.3, color=style.SKY, lw=0)
    for place, z, text in [
        (at, 4.6, "$m_s$"), (at, 1.78, "$m_t$"), (at + 0.75, 0.72, "$K_t$"),
        (at - 1.8, 3.0, "$K_s$"), (at + 1.8, 3.0, "$C$"), (at + 3.9, 4.25, "$y_s$"),
        (at + 2.9, 1.45, "$y_t$"), (at - 4.3, 4.95, "speed $c$"), (at, -2.55, "$x_1 = c\\,t$"),
        (20.2, -1.55, "$v(x, t)$"), (22.2, 0.4, rf"$\mu,\; E J,\; l = {end:g}$ m"),
    ]:  # fmt: skip
        ax.text(place, z, text, ha="center", va="center", fontsize=11.5)
    arrow = {"arrowstyle": "-|>", "color": style.VERMILLION, "lw": 1.4}
    for tip, tail in [
        ((at + 3.2, 3.7), (at + 3.2, 4.8)), ((at + 2.2, 1.0), (at + 2.2, 2.0)),
        ((at - 2.7, 4.55), (at - 5.9, 4.55)), ((at, -0.55), (at, -2.2)),
    ]:  # fmt: skip
        ax.annotate("", tip, tail, arrowprops=arrow)
    ax.set(aspect="equal", xlim=(-4, end + 4), ylim=(-2.9, 5.5))
    ax.set_axis_off()
    return fig


def _spring(ax: Axes, x: float, low: float, high: float) -> None:
    """Draw a spring between two heights."""
    z = np.r_[low, np.linspace(low + 0.15 * (high - low), high - 0.15 * (high - low), 9), high]
    ax.plot(x + 0.28 * np.r_[0, 0, [1, -1] * 3, 1, 0, 0], z, color=style.BLACK, lw=1.3)


def _damper(ax: Axes, x: float, low: float, high: float) -> None:
    """Draw a damper between two heights."""
    middle = (low + high) / 2
    ax.plot([x, x], [low, middle - 0.3], [x, x], [middle + 0.1, high], color=style.BLACK, lw=1.3)
    cup = x + 0.3 * np.array([-1, -1, 1, 1]), middle + np.array([0.35, -0.3, -0.3, 0.35])
    ax.plot(*cup, [x - 0.24, x + 0.24], [middle + 0.1] * 2, color=style.BLACK, lw=1.3)


@style.styled
def smooth_moment(x: np.ndarray, moment: np.ndarray, static: np.ndarray, kmh: float) -> Figure:
    """Draw the moment of a smooth road over the place of the tire, beside the static one."""
    fig = Figure(figsize=(7.5, 3.4), layout="constrained")
    ax = fig.subplots()
    ax.plot(x, static, "--", color=style.GREY, label="static")
    ax.plot(x, moment, color=style.BLACK, label=f"smooth road, {kmh} km/h")
    ax.plot(x[moment.argmax()], moment.max(), "o", color=style.VERMILLION,
            label=f"DAF = {moment.max():.4f}")  # fmt: skip
    ax.set(xlabel=PLACE, ylabel=MOMENT)
    ax.margins(x=0)
    ax.legend()
    return fig


@style.styled
def critical_speeds(kmh: np.ndarray, daf: np.ndarray) -> Figure:
    """Draw Fig. 2 with the two numbers that are printed of it, and the count of the swings."""
    fig = Figure(figsize=(7.5, 3.6), layout="constrained")
    ax = fig.subplots()
    ax.plot(kmh, daf, color=style.BLACK, label="computed")
    ax.plot(110, li2006.PRINTED["daf_smooth_110"], "o", color=style.VERMILLION,
            label="printed: 1.1302")  # fmt: skip
    ax.axvline(105, color=style.GREY, ls=":", label="printed: about 105 km/h")
    ax.set(xlabel=style.SPEED_LABEL, ylabel="DAF, smooth road [-]", xlim=(kmh[0], kmh[-1]))
    beam = li2006.beam()
    swings = np.array([1.25, 1.75, 2.25, 2.75, 3.25])
    top = ax.secondary_xaxis("top")
    top.set_xticks(3.6 * beam.frequencies[0] * beam.length / 2 / swings, [f"{s:g}" for s in swings])
    top.set_xlabel("swings of the bridge until the truck is at mid-span [-]")
    ax.legend(loc="lower left")
    return fig


@style.styled
def one_ramp(x: np.ndarray, ramp: Any, level: Any, over_ramp: Mapping[float, Any]) -> Figure:
    """Draw the elevation of each ramp, and the tire force and moment that it adds."""
    fig = Figure(figsize=(7.5, 6.2), layout="constrained")
    axes = fig.subplots(3, 1, sharex=True)
    for (place, response), color in zip(over_ramp.items(), style.TRACKS, strict=False):
        force = (response.outputs["tire_force"] - level.outputs["tire_force"]) / 1e3
        moment = response.outputs["moment"] - level.outputs["moment"]
        axes[0].plot(x, 1e3 * ramp(place * x[-1]).elevation_at(x), color=color)
        axes[1].plot(x, force, color=color, label=f"ramp at {place} l")
        axes[2].plot(x, moment, color=color)
    peak = x[level.outputs["moment"].argmax()]
    axes[2].axvline(peak, color=style.GREY, ls=":", label="the moment\nhas its peak")
    labels = "elevation [mm]", "added tire force [kN]", "added moment / $M_0$ [-]"
    for ax, label in zip(axes, labels, strict=True):
        ax.set_ylabel(label)
    fig.align_ylabels(axes)
    axes[1].legend(loc="lower left")
    axes[2].legend(loc="lower left")
    axes[2].set(xlabel=PLACE, xlim=(0, x[-1]))
    return fig


@style.styled
def every_ramp(surface: bc.RampSurface, number: int) -> Figure:
    """Draw the DAF with a ramp anywhere, and what the ramp changes: Fig. 5 or 6."""
    fig = Figure(figsize=(10, 3.9), layout="constrained")
    left, right = fig.subplots(1, 2)
    height = surface.ramp_height * 1e3
    title = f"Fig. {number}(a): DAF with a {height:g} mm drop over 0.1 m"
    surface.plot(ax=left).set_title(title)
    surface.plot(difference=True, ax=right).set_title(f"Fig. {number}(b): what it changes")
    return fig


@style.styled
def one_speed(surface: bc.RampSurface, row: int) -> Figure:
    """Draw the DAF with a ramp over its place, at one speed, and the printed place of a low."""
    fig = Figure(figsize=(7.5, 3.4), layout="constrained")
    ax = fig.subplots()
    places, kmh = surface.positions / surface.beam.length, 3.6 * surface.speeds[row]
    ax.plot(places, surface.daf_unit[row], color=style.BLUE, label=f"{kmh:.0f} km/h")
    ax.axvline(0.23, color=style.GREY, ls=":", label="printed: low at 0.23 l")
    ax.axhline(surface.daf_smooth[row], color=style.GREY, ls="--", lw=1, label="smooth road")
    ax.legend()
    ax.set(xlabel=RAMP, ylabel="DAF with a 10 mm drop [-]", xlim=(0, 1))
    return fig


@style.styled
def scaling(small: bc.RampSurface, tall: bc.RampSurface, speeds_kmh: tuple[int, ...]) -> Figure:
    """Draw the effect of a 10 mm ramp and ten times that of 1 mm, a panel for each speed."""
    fig = Figure(figsize=(10, 3.4), layout="constrained")
    axes = fig.subplots(1, len(speeds_kmh), sharey=True)
    places = small.positions / small.beam.length
    for ax, kmh in zip(axes, speeds_kmh, strict=True):
        row = np.abs(3.6 * small.speeds - kmh).argmin()
        ten, true = 10 * small.daf_difference[row], tall.daf_difference[row]
        ax.plot(places, ten, color=style.SKY, lw=4, label="ten times Fig. 5(b)")
        ax.plot(places, true, color=style.BLACK, label="Fig. 6(b)")
        ax.set(xlabel=RAMP, xlim=(0, 1), title=f"{kmh} km/h: largest gap {(true - ten).max():.3f}")
    axes[0].set_ylabel("change of the DAF [-]")
    axes[0].legend()
    return fig


@style.styled
def three_ramps(road: bc.RoadProfile) -> Figure:
    """Draw the road of Fig. 7 with the heights of its ramps."""
    fig = Figure(figsize=(7.5, 2.3), layout="constrained")
    ax = fig.subplots()
    ax.fill_between(road.x, 1e3 * road.elevation, -2, color=style.PAVEMENT, lw=0)
    ax.plot(road.x, 1e3 * road.elevation, color=style.BLACK)
    length = road.x[-1]
    for place, scale in li2006.FIG7_RAMPS.items():
        middle = 1e3 * road.elevation_at(place * length + 0.05)
        ax.text(place * length - 0.3, middle, f"s = {scale:+g}", ha="right")
    ax.set(xlabel=style.STATION_LABEL, ylabel="elevation [mm]", xlim=(0, length), ylim=(-2, 15))
    return fig


@style.styled
def moments(x: np.ndarray, by_name: Mapping[str, np.ndarray]) -> Figure:
    """Draw moments over the place of the tire, with the DAF of each."""
    fig = Figure(figsize=(7.5, 3.6), layout="constrained")
    ax = fig.subplots()
    colors = style.GREY, style.BLACK, style.VERMILLION
    for (name, moment), color in zip(by_name.items(), colors, strict=True):
        ax.plot(x, moment, color=color, label=f"{name}: DAF = {moment.max():.4f}")
    ax.set(xlabel=PLACE, ylabel=MOMENT)
    ax.margins(x=0)
    ax.legend(loc="lower center")
    return fig


def check(names: dict[str, Any]) -> None:
    """Assert what the page says of the paper's numbers and of ours."""
    n = SimpleNamespace(**names)
    starts, ends = n.dae
    unit, dae = n.surface.daf_difference[n.at_110], n.surface.dae(n.road)
    exact = bc.daf(n.beam, n.truck, n.speed)[0]
    swings = {kmh: n.beam.frequencies[0] * n.beam.length / 2 / (kmh / 3.6) for kmh in n.daf_smooth}
    top = max(range(60, 76), key=n.daf_smooth.get)
    valleys = [min(around, key=n.daf_smooth.get) for around in (range(50, 61), range(75, 91))]
    hold([
        ("Table 1: J [m⁴]", n.beam.flexural_rigidity / li2006.YOUNGS_MODULUS, 1.3901, 1e-9),
        ("DAF, smooth road, 110 km/h: printed 1.1302", n.daf_smooth[110], 1.1302, 5e-5),
        ("twin peaks: DAF at 103 km/h", n.daf_smooth[103], 1.1320, 1e-4),
        ("twin peaks: DAF at 108 km/h", n.daf_smooth[108], 1.1385, 1e-4),
        ("twin peaks: swings at 105 km/h", swings[105], 1.75, 0.05),
        ("size of the swing over the static deflection, 105 km/h",
         105 / 3.6 / (2 * n.beam.length * n.beam.frequencies[0]), 0.14, 5e-3),
        ("twin peaks: the higher one", max(n.daf_smooth.values()), 1.14, 5e-3),
        ("the peak before: swings", swings[top], 2.75, 0.05),
        ("a valley: swings", swings[valleys[0]], 3.25, 0.05),
        ("the next valley: swings", swings[valleys[1]], 2.25, 0.05),
        ("exact recovery, 110 km/h", exact, 1.1284, 1e-4),
        ("unit ramp ending at 0.12 l: printed 0.00433", unit[29], 0.00433, 5e-5),
        ("unit ramp ending at 0.3 l: printed 0.006031", unit[74], 0.006031, 1e-5),
        ("unit ramp at 0.75 l: printed 0", unit[188], 0.0, 1e-9),
        ("10 mm ramp, 105 km/h: printed low at 0.23 l", n.low, 0.23, 0.015),
        ("10 mm ramp, right half, 105 km/h: printed 0", n.late[n.at_105], 0.0, 1e-9),
        ("10 mm ramp, right half, any speed", n.late.max(), 0.0638, 1e-3),
        ("10 mm ramp - ten times 1 mm, least",
         (n.tall.daf_difference - 10 * n.surface.daf_difference).min(), 0.0, 1e-9),
        ("sum by hand = surface.dae", n.by_hand, n.dae[starts], 1e-9),
        ("Fig. 7, ramps start there: DAE, printed 1.0663", n.dae[starts], 1.0663, 2e-3),
        ("Fig. 7, ramps start there: DAF, printed 1.0656", n.dafs[starts], 1.0656, 5e-4),
        ("Fig. 7, ramps end there: DAE, printed 1.0663", n.dae[ends], 1.0663, 5e-4),
        ("Fig. 7, ramps end there: DAF", n.dafs[ends], 1.0715, 1e-3),
        ("Fig. 7, wrong sign: DAF", n.moments["Fig. 7, wrong sign"].max(), 1.195, 1e-3),
        ("Fig. 7, 66 km/h: DAF", n.simulated[66 - 50], 1.1465, 1e-3),
        ("peak DAE - peak DAF over the speeds", dae.max() - n.simulated.max(), 0.0, 1e-3),
        ("DAE - DAF, largest over the speeds", n.error[n.worst], -0.115, 1e-3),
        ("superposed - simulated DAF, largest",
         np.abs(n.superposed - n.simulated).max(), 0.0, 1e-6),
    ])  # fmt: skip
