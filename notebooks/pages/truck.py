"""Pictures and checks of the page on a truck of one's own."""

from __future__ import annotations

from collections.abc import Mapping
from types import SimpleNamespace
from typing import Any, NamedTuple

import numpy as np
from matplotlib.figure import Figure
from scipy.linalg import eigh

import bridgectl as bc
from bridgectl.plots import style, vehicle_plot
from pages.claims import hold
from pages.shell import told

COLORS = {"full": style.BLUE, "empty": style.VERMILLION, "quarter-car": style.GREY}


@style.styled
def side_views(*trucks: bc.Vehicle) -> Figure:
    """Trucks from the side, with loads and distances."""
    figure = Figure(figsize=(10.5 if len(trucks) > 1 else 8, 3.2), layout="constrained")
    for ax, truck in zip(np.ravel(figure.subplots(1, len(trucks))), trucks, strict=True):
        vehicle_plot(truck, ax)
    return figure


def body_modes(truck: bc.Vehicle) -> Any:
    """Heave [m] and pitch [rad] of the body in its two modes, those of a truck on its tires."""
    tires = truck.tire_map.T @ np.diag(truck.tire_stiffnesses) @ truck.tire_map
    return eigh(truck.stiffness_matrix + tires, truck.mass_matrix)[1][:2, :2]


@style.styled
def pitch_and_bounce(
    trucks: Mapping[str, bc.Vehicle], centres: Mapping[str, float], nodes: Mapping[str, Any]
) -> Figure:
    """Both modes of the body along the truck, with the nodes about which it turns."""
    figure = Figure(figsize=(10.5, 3.3), layout="constrained")
    axes = figure.subplots(1, 2, sharey=True)
    along = np.array([-1.0, 7.0])
    for ax, (name, truck) in zip(axes, trucks.items(), strict=True):
        heave, pitch = body_modes(truck)
        for j, color in enumerate((style.BLUE, style.VERMILLION)):
            shape = heave[j] + (along - centres[name]) * pitch[j]
            label = f"{truck.frequencies[j]:.2f} Hz, node at {nodes[name][j]:.1f} m"
            ax.plot(along, shape / np.abs(shape).max(), color=color, label=label)
            ax.plot(nodes[name][j], 0, "D", color=color, mfc="white", zorder=3)
        ax.plot([0, 5], [0, 0], "o", color=style.BLACK, label="axles")
        ax.set_xlabel("behind the front axle [m]")
        ax.set_title(name, pad=42)
        ax.invert_xaxis()
        ax.legend(loc="lower left", bbox_to_anchor=(0, 1), ncols=2, fontsize=9, borderpad=0.2)
    axes[0].set_ylabel("mode shape [-]")
    return figure


@style.styled
def over_speed(kmh: Any, smooth: Mapping[str, Any], rough: Mapping[str, Any]) -> Figure:
    """DAF over speed of each truck, on a smooth and on the measured road."""
    figure = Figure(figsize=(10.5, 3.7), layout="constrained")
    axes = figure.subplots(1, 2, sharey=True)
    titles = ("smooth road", "measured road")
    for ax, dafs, title in zip(axes, (smooth, rough), titles, strict=True):
        for name, daf in dafs.items():
            ax.plot(kmh, daf, color=COLORS[name], label=name)
        ax.set(xlabel=style.SPEED_LABEL, title=title, xlim=(50, 110))
    axes[0].set_ylabel("DAF [-]")
    figure.legend(*axes[0].get_legend_handles_labels(), loc="outside upper center", ncols=3)
    return figure


class Peak(NamedTuple):
    """A crossing, cut into the parts of its axles."""

    x: Any
    """Places of the first axle [m]."""
    parts: Any
    """Each axle's tire force through the influence line, (n_axles, n), over the static peak."""
    moment: Any
    at: int
    """Where the moment is largest."""
    places: Any
    """Each axle then [m]."""


def cut(bridge: Any, truck: bc.Vehicle, speed: float, road: Any, start: float) -> Peak:
    """Cut the moment of a crossing into what each axle gives."""
    response = bc.crossing_response(bridge, truck, speed, road, start=start)
    x, moment = speed * response.time, np.array(response.outputs["moment"])
    places = x - truck.tire_offsets[:, np.newaxis]
    on_bridge = (places >= 0) & (places <= bridge.length)
    line = on_bridge * bridge.influence_line(np.clip(places, 0, bridge.length), 0.5)
    forces = np.array([response.outputs[f"tire_force_{k + 1}"] for k in range(truck.n_tires)])
    parts = forces * line / bc.Crossing(bridge, truck).static_peak
    at = int(moment.argmax())
    return Peak(x, parts, moment, at, places[:, at])


def print_parts(peak: Peak, names: Any) -> None:
    """Print what each axle and the bridge's vibration give to the peak."""
    parts = peak.parts[:, peak.at]
    largest = peak.moment[peak.at]
    print(f"largest, {largest:.3f}, with the first axle at x = {peak.x[peak.at]:.1f} m:")
    for name, part, place in zip(names, parts, peak.places, strict=True):
        print(f"  {name:<10} at {place:5.1f} m {part:7.3f}")
    print(f"  {'vibration of the bridge':<20} {largest - parts.sum():.3f}")


@style.styled
def axle_by_axle(peak: Peak, names: Any) -> Figure:
    """The parts of the axles, one on top of the other, and the moment that they make."""
    figure = Figure(figsize=(9.5, 3.8), layout="constrained")
    ax = figure.subplots()
    ax.stackplot(peak.x, peak.parts, colors=style.TRACKS, alpha=0.55, labels=names)
    ax.plot(peak.x, peak.moment, color=style.BLACK, lw=1.4, label="moment")
    at = peak.x[peak.at], peak.moment[peak.at]
    ax.plot(*at, "o", color=style.BLACK, label="its largest value")
    ax.set(xlim=(0, 38), xlabel="place of the first axle, x [m]", ylabel="moment / static peak [-]")
    handles, labels = ax.get_legend_handles_labels()
    order = [*range(len(names), len(labels)), *reversed(range(len(names)))]  # as they lie
    figure.legend(
        [handles[i] for i in order], [labels[i] for i in order], loc="outside right upper"
    )
    return figure


@style.styled
def ramps_and_estimates(kmh: Any, surface: Any, road: Any, simulated: Any) -> Figure:
    """What each ramp changes, and DAE, superposed and simulated DAF over speed."""
    figure = Figure(figsize=(10.5, 3.9), layout="constrained")
    axes = figure.subplots(1, 2)
    surface.plot(difference=True, ax=axes[0])
    axes[0].set(title="what a 1 mm drop changes", xlim=(-1.2, 1), xticks=[-1, -0.5, 0, 0.5, 1])
    ax = axes[1]
    ax.plot(kmh, surface.superposed_daf(road), color=style.SKY, lw=4.5, label="superposed DAF")
    ax.plot(kmh, simulated, color=style.BLACK, lw=1.1, label="simulated DAF")
    ax.plot(kmh, surface.dae(road), "--", color=style.VERMILLION, label="DAE")
    ax.set(xlabel=style.SPEED_LABEL, ylabel="DAF, DAE [-]", xlim=(50, 110))
    ax.legend(loc="lower center", bbox_to_anchor=(0.5, 1.0), ncols=3, fontsize=9)
    return figure


@style.styled
def over_damping(factors: Any, largest: Mapping[str, Any]) -> Figure:
    """Largest DAF over the damping of an axle, or of both."""
    figure, ax = _each_dotted(factors, largest, (7.5, 3.4))
    ax.set_xscale("log", base=2)
    ax.set_xticks(factors, [f"{each:g}" for each in factors])
    ax.set(xlabel="damping, over that of the truck [-]", ylabel="largest DAF, 50 to 110 km/h [-]")
    return figure


@style.styled
def controlled(kmh: Any, dafs: Mapping[str, Any]) -> Figure:
    """DAF over speed, for each way to control the dampers."""
    figure, ax = _each_dotted(kmh, dafs, (9, 3.2))
    ax.set(xlabel=style.SPEED_LABEL, ylabel="DAF [-]", xticks=kmh)
    return figure


def _each_dotted(x: Any, curves: Mapping[str, Any], size: tuple[float, float]) -> tuple[Any, Any]:
    """Draw each curve with its name beside the axes."""
    figure = Figure(figsize=size, layout="constrained")
    ax = figure.subplots()
    for (name, curve), color in zip(curves.items(), style.TRACKS, strict=False):
        ax.plot(x, curve, "o-", color=color, label=name)
    figure.legend(loc="outside right upper")
    return figure, ax


def check(names: dict[str, Any]) -> None:
    """Assert what the page claims, by its variables."""
    n = SimpleNamespace(**names)
    empty, full = n.trucks["empty"], n.trucks["full"]
    first_at = {
        name: cut(n.bridge, n.semi, 55 / 3.6, road, start)
        for name, road, start in (("smooth", None, 0), ("measured", n.road, -200))
    }
    at_55 = {name: each.x[each.at] for name, each in first_at.items()}
    share = n.peak.parts[:, n.peak.at] / n.peak.moment[n.peak.at]
    superposed, dae = n.surface.superposed_daf(n.road), n.surface.dae(n.road)
    empty_at_69, full_at_69 = (
        bc.crossing_response(n.bridge, truck, n.speed, n.road, start=-200).outputs
        for truck in (empty, full)
    )
    varying = [
        np.std(full_at_69[force]) / np.std(empty_at_69[force])
        for force in ("tire_force_1", "tire_force_2")
    ]
    command = told(n.command)["daf_simulated"]
    front_load = 9.81 * (6000 * 3 / 5 + 700)  # by the lever
    less = {name: (daf - n.damped["passive"]).mean() for name, daf in n.damped.items()}
    assert full == bc.trucks.load("my_truck.toml")
    assert n.semi.static_loads.argmax() == 1
    assert all(-1 < node[1] < 5 < node[0] for node in n.nodes.values())
    assert all(dafs[3] == min(dafs) for dafs in n.largest.values())
    assert (n.damped["bridgehook"] < n.damped["passive"]).all()
    hold([
        ("empty: load of the front axle [N]", empty.static_loads[0], front_load, 1e-6),
        ("full: load of both [kN]", full.static_loads.sum() / 1e3, 15.8 * 9.81, 1e-9),
        ("full: first frequency [Hz]", full.frequencies[0], 1.27, 1e-3),
        ("full: node of bounce [m]", n.nodes["full"][0], 6.39, 0.01),
        ("full: node of pitch [m]", n.nodes["full"][1], 1.71, 0.01),
        ("104 km/h, the command and Python", command[-1], n.rough["full"][104 - 50], 1e-4),
        ("measured road: mean DAF, empty less full",
         (n.rough["empty"] - n.rough["full"]).mean(), 0.129, 2e-3),
        ("static peak, empty over full", n.static["empty"] / n.static["full"], 0.488, 1e-3),
        ("69 km/h: how tire forces vary, full over empty, front", varying[0], 1.08, 0.01),
        ("rear", varying[1], 1.2, 0.01),
        ("largest moment, full [kN m]", n.total["full"] / 1e3, 922, 1),
        ("largest moment, empty [kN m]", n.total["empty"] / 1e3, 515, 1),
        ("five axles: loads over the weight", n.semi.static_loads.sum() / (40e3 * 9.81), 1, 1e-9),
        ("100 km/h: share of the trailer's axles", share[2:].sum(), 0.806, 5e-3),
        ("share of the front axle", share[0], 0.022, 2e-3),
        ("55 km/h, smooth road: first axle at [m]", at_55["smooth"], 21.3, 0.3),
        ("55 km/h, measured road: first axle at [m]", at_55["measured"], 24.2, 0.3),
        ("superposed less simulated DAF", np.abs(superposed - n.simulated).max(), 0, 1e-6),
        ("DAE less simulated DAF, mean", np.abs(dae - n.simulated).mean(), 0.065, 2e-3),
        ("DAE less simulated DAF at 55 km/h", (dae - n.simulated)[5], -0.195, 5e-3),
        ("an eighth of the damping: largest DAF", n.largest["both axles"][0], 1.402, 2e-3),
        ("four times the damping: largest DAF", n.largest["both axles"][-1], 1.246, 2e-3),
        ("its own damping: largest DAF", n.largest["both axles"][3], 1.14, 2e-3),
        ("bridgehook less passive: mean DAF", less["bridgehook"], -0.126, 2e-3),
        ("at the front alone", less["bridgehook at the front"], -0.075, 2e-3),
    ])  # fmt: skip
