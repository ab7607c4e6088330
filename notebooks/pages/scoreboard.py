"""What the page of the scoreboard draws and checks: dampers of the literature on random roads."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from matplotlib.figure import Figure
from numpy.typing import NDArray
from scipy.signal import welch

import bridgectl as bc
from bridgectl.plots import style
from pages.claims import hold

Array = NDArray[np.float64]
CONSTANTS = (1e3, 3e3, 7e3, 15e3, 30e3)
"""Constant dampings [N s/m]."""
SHADES = ("#bddf26", "#3fbc73", "#21918c", "#3b528b", "#440154")
"""A colour for each, the darker the stiffer."""
COLORS = {
    "passive 7 kN s/m": style.BLACK, "skyhook": style.BLUE,
    "groundhook": style.TRACKS[2], "bridgehook": style.VERMILLION,
}  # fmt: skip
PLACE = "place of the tire, x [m]"
MOMENT = "mid-span moment / $M_0$ [-]"


def random_road(iso_class: str, seed: int) -> bc.RoadProfile:
    """Return a random road from 40 m before the bridge to its end, 25 m, named by its seed."""
    road = bc.iso8608_profile(iso_class, 65, seed=seed, start=-40)
    return bc.RoadProfile(road.x, road.elevation, name=f"class {iso_class}, seed {seed}")


def mirrored(road: bc.RoadProfile) -> bc.RoadProfile:
    """Return a road with rises for drops."""
    return bc.RoadProfile(road.x, -road.elevation)


def gain(truck: bc.QuarterCar, c: float, hertz: Array) -> Array:
    """Return the tire force per velocity of the road under the tire [kN s/m]."""
    s = 2j * np.pi * hertz
    link = truck.suspension_stiffness + c * s
    body = link / (truck.sprung_mass * s**2 + link)  # y_s / y_t
    inertia = truck.unsprung_mass * s**2 + truck.sprung_mass * s**2 * body
    return 1e-3 * abs(truck.tire_stiffness * inertia / (inertia + truck.tire_stiffness) / s)


def spectrum(forces: Array, step: float) -> tuple[Array, Array]:
    """Return frequencies [Hz] and the mean power spectral density of histories of a step [s]."""
    hertz, density = welch(forces, fs=1 / step, nperseg=1024)
    return hertz, density.mean(axis=0)


def print_spectra(deviations: Mapping[str, float], at_bridge: Mapping[str, float], bridge: float
                  ) -> None:  # fmt: skip
    """Print the deviation of the tire force, and its density where the bridge listens."""
    print(f"class B road, 100 km/h    tire force, standard deviation    its PSD at {bridge:.2f} Hz")
    for name, deviation in deviations.items():
        ratio = at_bridge[name] / at_bridge["passive 7 kN s/m"]
        print(f"{name:<26}{deviation:16.1f} kN{ratio:30.1f} times passive")


def print_rows(board: bc.Scoreboard, names: Sequence[str] = ()) -> None:
    """Print means over roads and speeds of strategies, the lowest DAF first."""
    print("                   mean     difference to the first    load           ride   switches")
    print("                    DAF     95 % confidence            coefficient  [m/s²]      [1/s]")
    for row in board.rows():
        if row.strategy not in (names or board.strategies):
            continue
        d = [f"{each:+.4f}" for each in row.daf_difference]
        words = f"{d[0]}  {d[1]} to {d[2]}" if row.strategy != board.strategies[0] else ""
        print(
            f"{row.strategy:<18}{row.daf:.4f}  {words:<29}{row.dynamic_load_coefficient:.4f}"
            f"{row.body_acceleration:13.3f}{row.switching_rate:9.0f}"
        )


def print_judgement(board: bc.Scoreboard) -> None:
    """Print the means of Eq. (15) and of the simulated DAF over roads and their mirror images."""
    print("                     smooth      mean DAE            mean DAF           mean of both")
    print("                       DAF    road   mirrored      road   mirrored       DAE       DAF")
    for i, name in enumerate(board.strategies):
        dae, dafs = (board.values[measure][i, :, 0] for measure in ("dae", "daf"))
        halves = [part.mean() for each in (dae, dafs) for part in np.split(each, 2)]
        means = board.daf_smooth[i, 0], *halves, dae.mean(), dafs.mean()
        widths = 8, 9, 9, 12, 9, 13, 10
        columns = zip(means, widths, strict=True)
        print(f"{name:<18}" + "".join(f"{mean:{width}.3f}" for mean, width in columns))


@style.styled
def constant_dampers(kmh: Array, smooth: Array, rough: Array, title: str) -> Figure:
    """Draw the DAF of constant dampers over speed, on a smooth road and on a rough one."""
    fig = Figure(figsize=(10, 3.5), layout="constrained")
    axes = fig.subplots(1, 2, sharey=True)
    for ax, dafs, name in zip(axes, (smooth, rough), ("smooth road", title), strict=True):
        for c, values, shade in zip(CONSTANTS, dafs, SHADES, strict=True):
            ax.plot(kmh, values, color=shade, lw=1.5, label=f"{c / 1e3:g} kN s/m")
        ax.set(xlabel=style.SPEED_LABEL, xlim=(kmh[0], kmh[-1]), title=name)
    axes[0].set_ylabel("DAF [-]")
    axes[0].legend(loc="upper left", fontsize=9)
    return fig


@style.styled
def tire_gains(truck: bc.QuarterCar, band: Sequence[float], bridge: float) -> Figure:
    """Draw the gain from road to tire force of constant dampers, and where the bridge listens."""
    hertz = np.geomspace(0.2, 15, 1000)
    fig = Figure(figsize=(8.5, 3.8), layout="constrained")
    ax = fig.subplots()
    ax.axvspan(*band, color=style.BRIDGE_TINT, zorder=0, label="stiff is worse")
    for c, shade in zip(CONSTANTS, SHADES, strict=True):
        ax.plot(hertz, gain(truck, c, hertz), color=shade, label=f"{c / 1e3:g} kN s/m")
    ends = np.array(band)
    ax.plot(ends, gain(truck, 7e3, ends), "o", color=style.BLACK, zorder=4)
    ax.axvline(bridge, color=style.VERMILLION, ls="--", lw=1.2, label=f"bridge, {bridge:.2f} Hz")
    ax.set(xscale="log", yscale="log", xlim=(0.2, 15), ylim=(2, 2500), xlabel="frequency [Hz]",
           ylabel="tire force per\nroad velocity [kN s/m]")  # fmt: skip
    ax.set_xticks([0.2, 0.5, 1, 2, 5, 10], ["0.2", "0.5", "1", "2", "5", "10"])
    fig.legend(loc="outside right upper", fontsize=9)
    return fig


@style.styled
def forces_and_moments(crossings: Mapping[str, Any], smooth: Any, speed: float) -> Figure:
    """Draw tire force and moment of one crossing with several dampers."""
    fig = Figure(figsize=(9.5, 6), layout="constrained")
    force, moment = fig.subplots(2, 1)
    for name, response in crossings.items():
        x, color, values = speed * response.time, COLORS[name], response.outputs["moment"]
        force.plot(x, 1e-3 * response.outputs["tire_force"], color=color, lw=1.1, label=name)
        moment.plot(x, values, color=color, label=f"{name}: DAF {values.max():.3f}")
        moment.plot(x[values.argmax()], values.max(), "o", color=color)
    load = 1e-3 * smooth.outputs["tire_force"][0]
    force.axhline(load, color=style.GREY, ls=":", label="static load")
    moment.plot(speed * smooth.time, smooth.outputs["moment"], ":", color=style.GREY,
                label="smooth road, passive")  # fmt: skip
    force.axvspan(0, 25, color=style.BRIDGE_TINT, zorder=0)
    force.set(ylabel="tire force R [kN]", xlim=(-40, 25), ylim=(60, 145),
              title="on the approach and on the bridge")  # fmt: skip
    moment.set(ylabel=MOMENT, xlim=(0, 25), title="on the bridge", xlabel=PLACE)
    force.legend(loc="upper left", ncols=4, fontsize=8.5)
    moment.legend(loc="upper left", fontsize=9)
    fig.align_ylabels([force, moment])
    return fig


@style.styled
def spectra(hertz: Array, densities: Mapping[str, Array], band: Sequence[float], bridge: float
            ) -> Figure:  # fmt: skip
    """Draw spectra of the tire force, and where the bridge listens."""
    fig = Figure(figsize=(8.5, 3.6), layout="constrained")
    ax = fig.subplots()
    ax.axvspan(*band, color=style.BRIDGE_TINT, zorder=0, label="stiff is worse")
    for name, density in densities.items():
        ax.plot(hertz[1:], density[1:], color=COLORS[name], label=name)
    ax.axvline(bridge, color=style.VERMILLION, ls="--", lw=1.2, label=f"bridge, {bridge:.2f} Hz")
    ax.set(xlim=(0, 12), ylim=(0.03, 300), yscale="log", xlabel="frequency [Hz]",
           ylabel="PSD of the tire force [kN²/Hz]")  # fmt: skip
    fig.legend(loc="outside right upper", fontsize=9)
    return fig


@style.styled
def estimate_beside_simulation(board: bc.Scoreboard, names: Sequence[str]) -> Figure:
    """Draw the simulated DAF over that of Eq. (15), of roads and of their mirror images."""
    fig = Figure(figsize=(10.5, 3.8), layout="constrained")
    axes = fig.subplots(1, len(names), sharex=True, sharey=True)
    for ax, name in zip(axes, names, strict=True):
        i = board.strategies.index(name)
        ax.plot([0.7, 1.5], [0.7, 1.5], color=style.GREY, lw=0.9)
        dae, dafs = (np.split(board.values[each][i, :, 0], 2) for each in ("dae", "daf"))
        for k, label in enumerate(("road", "mirrored")):
            ax.plot(dae[k], dafs[k], "o", ms=4, color=style.TRACKS[k], label=label)
        at_rest = board.daf_smooth[i, 0]
        ax.plot(at_rest, at_rest, "*", ms=12, color=style.BLACK, label="smooth road")
        ax.set(xlabel="DAE by Eq. (15) [-]", title=name, xlim=(0.86, 1.36), ylim=(0.86, 1.36))
    axes[0].set_ylabel("simulated DAF [-]")
    axes[0].legend(loc="upper left", fontsize=9)
    return fig


def check(names: Mapping[str, Any]) -> None:
    """Assert what the page says, by the variables of its cells."""
    truck, board, both = names["truck"], names["board"], names["both"]
    band, bridge, deviations = names["band"], names["bridge"], names["deviations"]
    passive, tire = "passive 7 kN s/m", "dynamic_load_coefficient"
    load, mean = ({row.strategy: getattr(row, each) for row in board.rows()}
                  for each in (tire, "daf"))  # fmt: skip
    to_first = {name: board.difference(name) for name in board.strategies[1:]}
    one = {name: each.outputs["moment"].max() for name, each in names["crossings"].items()}
    apart = both.values["dae"][:, :, 0].mean(axis=1) - both.daf_smooth[:, 0]
    changed = {each: both.difference("bridgehook", each).mean for each in ("daf", "dae")}
    at_bridge = names["at_bridge"]
    hold([
        ("smooth road: from 1 to 30 kN s/m", np.ptp(names["smooth"], axis=0).max(), 0, 0.0035),
        ("class B road: the same", np.ptp(names["rough"], axis=0).max(), 0.28, 0.01),
        ("comfort: best constant [kN s/m]", names["comfort"] / 1e3, 5.96, 0.005),
        ("tire force: best constant [kN s/m]", names["road_best"] / 1e3, 36.7, 0.05),
        ("tire force: lower frequency [Hz]", band[0], 0.617, 1e-3),
        ("tire force: upper frequency [Hz]", band[1], 5.19, 5e-3),
        ("gain there, 1 over 30 kN s/m", np.divide(
            *(gain(truck, c, np.array(band)) for c in (1e3, 30e3))).max(), 1, 1e-9),
        ("gain at 4.09 Hz, 30 over 7 kN s/m",
         gain(truck, 30e3, bridge) / gain(truck, 7e3, bridge), 1.5, 0.1),
        ("groundhook: load coefficient", load["groundhook"] / load[passive], 0.63, 0.01),
        ("groundhook: DAF - passive", to_first["groundhook"].mean, 0.0065, 1e-3),
        ("skyhook: DAF - passive", to_first["skyhook"].mean, 0.0147, 1e-3),
        ("1 kN s/m: DAF - passive", to_first["passive 1 kN s/m"].mean, 0.0181, 1e-3),
        ("preset: DAF - passive", to_first["preset"].mean, -0.0192, 1e-3),
        ("bridgehook: DAF - passive", to_first["bridgehook"].mean, -0.0801, 2e-3),
        ("one crossing: groundhook - passive", one["groundhook"] - one[passive], 0.048, 2e-3),
        ("spectra: deviation", deviations["groundhook"] / deviations[passive], 0.61, 0.03),
        ("spectra: density at 4.09 Hz", at_bridge["groundhook"] / at_bridge[passive], 2.1, 0.3),
        ("groundhook: share of time stiff", names["stiff"]["groundhook"], 0.91, 0.03),
        ("mean DAE of road and mirror - smooth DAF", np.abs(apart).max(), 0, 1e-9),
        ("bridgehook - passive, 48 roads: DAF", changed["daf"], -0.103, 3e-3),
        ("bridgehook - passive, 48 roads: DAE", changed["dae"], 0, 0.003),
    ])  # fmt: skip
    assert min(load, key=load.get) == "groundhook"
    assert max(mean, key=mean.get) == "passive 1 kN s/m"
    assert max({"skyhook", "groundhook", "tire groundhook"}, key=mean.get) == "skyhook"
    assert not to_first["groundhook"].clear
    assert to_first["skyhook"].clear
    assert to_first["preset"].clear
    assert to_first["bridgehook"].high < to_first["preset"].low
    assert board.difference("skyhook", tire).low > 0
    assert band[0] < bridge < band[1]
