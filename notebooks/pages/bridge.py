"""Pictures and checks of the page on a bridge of one's own."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
from matplotlib.figure import Figure

import bridgectl as bc
from bridgectl.plots import bridge_plot, style
from pages.claims import hold
from pages.shell import told

NAMES = ("hogging over the pier", "sagging in the second span")
COLORS = dict(zip(NAMES, (style.BLUE, style.VERMILLION), strict=True))


@style.styled
def drawing(bridge: bc.Bridge, effect: Any) -> Figure:
    """Mode shapes, and the influence line of an effect."""
    figure = Figure(figsize=(10.5, 3.6), layout="constrained")
    axes = figure.subplots(1, 2)
    bridge_plot(bridge, ax=axes[0])
    bridge_plot(bridge, effect, ax=axes[1])
    return figure


def write_modes(path: str, bridge: bc.Bridge, sensors: Any, count: int) -> None:
    """Write the table of a modal analysis: a column a mode, rounded as a report has them."""
    shapes = bridge.mode_shapes(sensors)[:, :count]
    lines = [
        "x [m]," + ",".join(f"mode {j + 1}" for j in range(count)),
        "frequency [Hz]," + ",".join(f"{each:.4f}" for each in bridge.frequencies[:count]),
        "damping ratio," + ",".join(f"{each:.4f}" for each in bridge.damping_ratios[:count]),
    ]
    lines += [
        f"{x:g}," + ",".join(f"{each:.4f}" for each in row)
        for x, row in zip(sensors, shapes / np.abs(shapes).max(axis=0), strict=True)
    ]
    Path(path).write_text("\n".join(lines) + "\n", encoding="utf-8")


def strain_gauge(bridge: bc.Bridge, at: float, sensors: Any, count: int) -> dict[str, Any]:
    """What a gauge tells of the moment: under a slow truck, and in each mode of the table."""
    places, section = np.linspace(0, bridge.length, 109), at / bridge.length
    scale = np.abs(bridge.mode_shapes(sensors)[:, :count]).max(axis=0)
    return {
        "places": places,
        "influence": bridge.influence_line(places, section),
        "modal": bridge.modal_effects(section)[:count] / scale,
    }


def write_toml(path: str, modes: str, mass: float, at: float, gauge: Mapping[str, Any]) -> None:
    """Write the file of a measured bridge that tells a moment."""
    numbers = [f"{key} = {np.round(value, 6).tolist()}" for key, value in gauge.items()]
    head = [f'modes = "{modes}"', f"mass_per_length = {mass}", "", "[[effects]]"]
    lines = [*head, 'quantity = "moment"', f"at = {at}", *numbers]
    Path(path).write_text("\n".join(lines) + "\n", encoding="utf-8")


@style.styled
def smooth(kmh: Any, pier: Any, from_modes: Any, span: Any) -> Figure:
    """DAF of a smooth road over speed: of the drawing, of measured modes, of a span."""
    figure = Figure(figsize=(7.5, 3.6), layout="constrained")
    ax = figure.subplots()
    ax.plot(kmh, pier, color=style.SKY, lw=4.5, label=f"{NAMES[0]}, from the drawing")
    ax.plot(kmh, from_modes, color=style.BLACK, lw=1.1, label=f"{NAMES[0]}, from measured modes")
    ax.plot(kmh, span, color=style.VERMILLION, label=f"{NAMES[1]}, from the drawing")
    ax.set(xlabel=style.SPEED_LABEL, ylabel="DAF, smooth road [-]", xlim=(50, 130))
    figure.legend(loc="outside upper center", ncols=1)
    return figure


def on_the_bridge(response: Any, speed: float, length: float) -> tuple[Any, dict[str, Any]]:
    """Places of the tire on the bridge [m], and what a response has there [kN m], [kN]."""
    x = speed * response.time
    here = (x >= 0) & (x <= length)
    signals = {
        name: np.array(response.outputs[name])[here] / 1e3
        for effect in ("hogging", "reaction", "shear")
        for name in (effect, f"static_{effect}")
    }
    return x[here], signals


def print_peaks(signals: Mapping[str, Any]) -> None:
    """Print the peak of each effect beside the static one."""
    for name, unit, sign in (("hogging", "kN m", -1), ("reaction", "kN", 1), ("shear", "kN", -1)):
        total, static = (sign * (sign * signals[each]).max() for each in (name, f"static_{name}"))
        print(f"{name:<10}{total:8.0f} {unit}, static{static:8.0f} {unit}")


@style.styled
def histories(x: Any, signals: Mapping[str, Any]) -> Figure:
    """Moment, reaction and shear at the pier while the truck crosses."""
    labels = {
        "hogging": "moment over\nthe pier [kN m]",
        "reaction": "reaction of\nthe pier [kN]",
        "shear": "shear before\nthe pier [kN]",
    }
    figure = Figure(figsize=(8.5, 7), layout="constrained")
    axes = figure.subplots(3, 1, sharex=True)
    for ax, (name, label) in zip(axes, labels.items(), strict=True):
        ax.plot(x, signals[name], color=style.BLUE, lw=1.3, label="82 km/h")
        ax.plot(x, signals[f"static_{name}"], "--", color=style.GREY, label="static")
        ax.axvline(24, color=style.BLACK, lw=0.9, ls=":", label="pier")
        ax.set_ylabel(label)
    figure.align_ylabels(axes)
    figure.legend(*axes[0].get_legend_handles_labels(), loc="outside upper center", ncols=3)
    axes[-1].set(xlabel="place of the tire, x [m]", xlim=(0, 54))
    return figure


@style.styled
def envelopes(*hulls: Any) -> Figure:
    """Envelopes, one below the other."""
    figure = Figure(figsize=(8.5, 3.2 * len(hulls)), layout="constrained")
    for ax, hull in zip(figure.subplots(len(hulls), 1), hulls, strict=True):
        hull.plot(ax)
    return figure


@style.styled
def over_speed(kmh: Any, rough: Any, smooth: Any) -> Figure:
    """DAF over speed of both effects, on the measured road and on a smooth one."""
    figure = Figure(figsize=(8, 3.8), layout="constrained")
    ax = figure.subplots()
    for name, measured, level in zip(NAMES, rough, smooth, strict=True):
        ax.plot(kmh, measured, color=COLORS[name], label=f"{name}, measured road")
        ax.plot(kmh, level, ":", color=COLORS[name], label=f"{name}, smooth road")
    ax.set(xlabel=style.SPEED_LABEL, ylabel="DAF [-]", xlim=(50, 130))
    figure.legend(loc="outside upper center", ncols=2)
    return figure


@style.styled
def ramp_map(surface: bc.RampSurface) -> Figure:
    """What each ramp does to the hogging, at each speed."""
    figure = Figure(figsize=(8, 3.9), layout="constrained")
    ax = figure.subplots()
    surface.plot(difference=True, ax=ax).set_title(f"{NAMES[0]}: what a 1 mm drop changes")
    return figure


@style.styled
def estimates(kmh: Any, surfaces: Any, road: bc.RoadProfile, simulated: Any) -> Figure:
    """DAE, superposed and simulated DAF of both effects."""
    figure = Figure(figsize=(10.5, 4), layout="constrained")
    axes = figure.subplots(1, 2, sharey=True)
    for ax, name, surface, exact in zip(axes, NAMES, surfaces, simulated, strict=True):
        ax.plot(kmh, surface.superposed_daf(road), color=style.SKY, lw=4.5, label="superposed DAF")
        ax.plot(kmh, exact, color=style.BLACK, lw=1.1, label="simulated DAF")
        ax.plot(kmh, surface.dae(road), "--", color=style.VERMILLION, label="DAE")
        ax.set(xlabel=style.SPEED_LABEL, title=name, xlim=(50, 130))
    axes[0].set_ylabel("DAF, DAE [-]")
    figure.legend(*axes[0].get_legend_handles_labels(), loc="outside upper center", ncols=3)
    return figure


def check(names: dict[str, Any]) -> None:
    """Assert what the page claims, by its variables."""
    n = SimpleNamespace(**names)
    at_82 = list(n.kmh).index(82)
    pier_daf, span_daf = n.rough
    errors = [np.abs(s.dae(n.road) - exact) for s, exact in zip(n.surfaces, n.rough, strict=True)]
    exact = [s.superposed_daf(n.road) for s in n.surfaces]
    hogging, static = n.signals["hogging"], n.signals["static_hogging"]
    reaction = n.signals["static_reaction"]
    weight = 9.81 * (n.truck.sprung_mass + n.truck.unsprung_mass) / 1e3
    over_pier, in_span = (n.bridge.modal_effects(at / 54)[1] for at in (24, 42))
    ratio = abs(over_pier / in_span)
    command = {
        name: told(f"{n.command} --bridge {name}.toml")["daf_simulated"]
        for name in ("my_bridge", "measured")
    }
    assert pier_daf.max() > span_daf.max()
    assert 0.1 < n.trust[0].trusted.mean() < 0.25
    hold([
        ("first frequency [Hz]", n.bridge.frequencies[0], 3.277, 1e-3),
        ("second frequency [Hz]", n.bridge.frequencies[1], 6.34, 0.01),
        ("damping ratio of mode 4", n.bridge.damping_ratios[3], 0.02, 1e-9),
        ("82 km/h, the command and Python", command["my_bridge"][1], pier_daf[at_82], 1e-4),
        ("the command, measured and drawn", command["measured"][1], pier_daf[at_82], 5e-3),
        ("measured modes, smooth road", np.abs(n.from_modes - n.smooth[0]).max(), 0, 5e-3),
        ("smooth road, hogging: largest DAF", n.smooth[0].max(), 1.105, 2e-3),
        ("82 km/h, hogging: DAF", hogging.min() / static.min(), 1.423, 2e-3),
        ("the same, from the envelope", n.peak / n.weight, pier_daf[at_82], 1e-5),
        ("mode 2: moment over the pier, over that in the span", ratio, 2.66, 0.02),
        ("82 km/h, sagging: DAF", span_daf[at_82], 1.106, 2e-3),
        ("modulus times stress [kN m]", n.stress * 2.1 / 1e3, hogging.min(), 0.05),
        ("static reaction, largest, over the weight", reaction.max() / weight, 1.015, 2e-3),
        ("and where [m]", n.x[reaction.argmax()], 27.5, 0.5),
        ("far ramps", np.abs(n.surfaces[0].daf_difference[:, :730]).max(), 0, 5e-3),
        ("measured road, sagging: largest DAF", span_daf.max(), 1.18, 5e-3),
        ("superposed less simulated DAF", np.abs(np.array(exact) - n.rough).max(), 0, 1e-6),
        ("DAE of hogging, mean error", errors[0].mean(), 0.166, 2e-3),
        ("DAE of sagging, mean error", errors[1].mean(), 0.008, 1e-3),
        ("sagging: where it is trusted", n.trust[1].trusted.mean(), 0.8, 0.05),
    ])  # fmt: skip
