"""What the page of bridgehook draws and checks: a law derived, and one of your own."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.figure import Figure
from numpy.typing import NDArray

import bridgectl as bc
from bridgectl.plots import style
from pages.claims import hold

Array = NDArray[np.float64]
PLACE = "place of the tire, x [m]"
MOMENT = "mid-span moment / $M_0$ [-]"
SIGMA = "$\\sigma$ [$10^{-6}$/(N s)]"
DAMPING = "damping c [kN s/m]"


@style.styled
def worth_of_a_force(worth: Any, smooth: Any, speed: float) -> Figure:
    """Draw the moment of a smooth road, and below it what a damper force does to its peak."""
    fig = Figure(figsize=(9.5, 5), layout="constrained")
    moment, costate = fig.subplots(2, 1, sharex=True)
    x, values = speed * smooth.time, smooth.outputs["moment"]
    moment.plot(x, values, color=style.BLACK)
    moment.plot(x[values.argmax()], values.max(), "o", color=style.BLACK)
    moment.set(ylabel=MOMENT, title=f"smooth road, {3.6 * speed:.0f} km/h")
    costate.axhline(0, color=style.GREY, lw=0.8)
    costate.plot(worth.positions, 1e6 * worth.sigma, color=style.BLACK)
    fine = np.linspace(worth.positions[0], worth.positions[-1], 5000)
    works = np.interp(fine, worth.positions, worth.sigma) < 0
    for stiff, color, name in [(True, style.VERMILLION, "stiff"), (False, style.SKY, "soft")]:
        costate.fill_between(fine, 0, 1, where=works == stiff, color=color, alpha=0.25, lw=0,
                             transform=costate.get_xaxis_transform(),
                             label=f"{name} for v > 0")  # fmt: skip
    for ax in (moment, costate):
        ax.axvline(worth.positions[-1], color=style.GREY, ls=":", label="the peak")
    costate.set(xlabel=PLACE, ylabel=SIGMA, xlim=(-40, 25))
    costate.legend(loc="lower left", ncols=3, framealpha=0.9, frameon=True, edgecolor="none")
    fig.align_ylabels([moment, costate])
    return fig


@style.styled
def at_work(value: Any, x: Array, history: Mapping[str, Array], title: str) -> Figure:
    """Draw bridgehook's three tables, and velocity and damping on a road."""
    fig = Figure(figsize=(9.5, 6.6), layout="constrained")
    tables, velocity, damping = fig.subplots(3, 1, sharex=True)
    body, axle = (np.std(history[each]) for each in ("body_velocity", "axle_velocity"))
    for part, color, label in [
        (value.constant, style.BLACK, "s"),
        (value.body * body, style.BLUE, "b, times the rms of $\\dot y_s$ on this road"),
        (value.axle * axle, style.VERMILLION, "a, times the rms of $\\dot y_t$ on this road"),
    ]:
        tables.plot(value.positions, 1e6 * part, color=color, label=label)
    tables.set(ylabel="parts of " + SIGMA.replace(" [", "\n["), title="what the controller stores")
    tables.legend(loc="lower left")
    velocity.axhline(0, color=style.GREY, lw=0.8)
    velocity.plot(x, history["suspension_velocity"], color=style.BLACK, lw=1)
    velocity.set(ylabel="suspension\nvelocity v [m/s]", title=title)
    damping.fill_between(x, 1e-3 * history["damping"], step="post", color=style.VERMILLION,
                         alpha=0.6, lw=0)  # fmt: skip
    damping.set(ylabel=DAMPING.replace(" [", "\n["), xlabel=PLACE, xlim=(-40, 25))
    fig.align_ylabels([tables, velocity, damping])
    return fig


@style.styled
def in_the_loop(found: Any, response: Any, speed: float) -> Figure:
    """Draw what the loop of python-control does beside the sampled one."""
    fig = Figure(figsize=(9.5, 5), layout="constrained")
    moment, damping = fig.subplots(2, 1, sharex=True)
    for each, name, color, line in [
        (found, "input_output_response", style.BLUE, "-"),
        (response, "crossing_response", style.VERMILLION, "--"),
    ]:
        moment.plot(speed * each.time, each.outputs["moment"], line, color=color, label=name)
    moment.legend(loc="upper left")
    damping.step(speed * found.time, 1e-3 * found.outputs["damping"], where="post",
                 color=style.BLUE)  # fmt: skip
    moment.set(ylabel=MOMENT)
    damping.set(ylabel=DAMPING, xlabel=PLACE, xlim=(0, 25))
    fig.align_ylabels([moment, damping])
    return fig


@style.styled
def beside_the_best(responses: Mapping[str, Any], best: Any, speed: float) -> Figure:
    """Draw the moment of several dampers, and the damping of the clairvoyant below it."""
    fig = Figure(figsize=(9.5, 5.6), layout="constrained")
    moment, damping = fig.subplots(2, 1)
    colors = style.BLACK, style.VERMILLION, style.BLUE
    for (name, response), color in zip(responses.items(), colors, strict=True):
        values = response.outputs["moment"]
        moment.plot(speed * response.time, values, color=color, label=f"{name}: {values.max():.3f}")
    moment.axhline(best.daf, color=style.BLUE, ls=":", lw=1)
    moment.set(ylabel=MOMENT, xlim=(0, 25), title="the moment, and its peak")
    moment.legend(loc="lower center", fontsize=9, bbox_to_anchor=(0.37, 0))
    damping.axvspan(0, 25, color=style.BRIDGE_TINT, zorder=0)
    damping.step(best.positions, 1e-3 * best.damping, where="post", color=style.BLUE, lw=1)
    damping.set(ylabel=DAMPING, xlabel=PLACE, xlim=(-40, 25), title="the clairvoyant's damping")
    fig.align_ylabels([moment, damping])
    return fig


def print_by_speed(board: bc.Scoreboard, name: str) -> Array:
    """Print, and return, the difference of a strategy to the first one at each speed."""
    first, own = (board.values["daf"][i] for i in (0, board.strategies.index(name)))
    found = (own - first).mean(axis=0)
    print("difference at      " + "".join(f"{3.6 * c:9.0f}" for c in board.speeds), "km/h")
    print(f"{name:<19}" + "".join(f"{each:+9.3f}" for each in found))
    return found


def print_start(path: Path, lines: int = 14) -> None:
    """Print how the law begins in a C file."""
    text = path.read_text().splitlines()
    begin = next(i for i, line in enumerate(text) if line.startswith("/* damping:"))
    print(*text[begin : begin + lines], "  ...", sep="\n")


def print_shares(dafs: Mapping[str, float], title: str) -> dict[str, float]:
    """Print, and return, how far dampers go from the passive one to the clairvoyant."""
    base, best = dafs["passive 7 kN s/m"], dafs["clairvoyant"]
    print(f"{title:<22}DAF    share of what is possible")
    shares = {name: (base - daf) / (base - best) for name, daf in dafs.items()}
    for name in sorted(dafs, key=dafs.__getitem__):
        print(f"{name:<22}{dafs[name]:.3f}{shares[name]:14.2f}")
    return shares


def check(names: Mapping[str, Any]) -> None:
    """Assert what the page says, by the variables of its cells."""
    board, speed, worth = names["board"], names["speed"], names["worth"]
    differ = {name: board.difference(name) for name in board.strategies[1:]}
    turns = worth.positions[1:][np.diff(np.sign(worth.sigma)) != 0] / speed
    moments = names["found"].outputs["moment"]
    hold([
        ("costate: half periods on the bridge [s]", np.diff(turns[turns > 0.05]).mean(), 0.11,
         0.015),
        ("bridgehook obeys its formula, share", names["agreement"], 1, 0.03),
        ("bridgehook: DAF - passive", differ["bridgehook"].mean, -0.0801, 2e-3),
        ("no feedback: DAF - passive", differ["no feedback"].mean, -0.0598, 2e-3),
        ("preset: DAF - passive", differ["preset"].mean, -0.0192, 1e-3),
        ("first mode: DAF - passive", differ["first mode"].mean, -0.0384, 2e-3),
        ("first mode, 80 km/h: DAF - passive", names["by_speed"][1], 0.047, 2e-3),
        ("first mode: DAF of the loop - sampled", moments.max() - names["dafs"]["first mode"], 0,
         3e-3),
        ("clairvoyant: DAF", names["best"].daf, 1.026, 2e-3),
        ("bridgehook: share of what is possible", names["shares"]["bridgehook"], 0.6, 0.02),
    ])  # fmt: skip
    assert differ["bridgehook"].high < differ["first mode"].low
    assert board.difference("first mode", "dynamic_load_coefficient").low > 0
