"""What the page of the DAE of second order draws and checks: dampers in order, and one designed."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any, NamedTuple

import numpy as np
from matplotlib.figure import Figure
from numpy.typing import ArrayLike, NDArray

import bridgectl as bc
from bridgectl.plots import style
from bridgectl.road import iso8608_elevations
from pages.claims import hold

Array = NDArray[np.float64]
PLACE = "place of the ramp, x [m]"
LOOKS = {"passive 7 kN s/m": style.BLACK, "PDD": style.BLUE, "bridgehook": style.VERMILLION}


class Gain(NamedTuple):
    """Change of a mean DAF, and its 95 % confidence interval."""

    mean: float
    low: float
    high: float


def roads_both_ways(span: float, approach: float) -> list[bc.RoadProfile]:
    """Return twelve random roads of class B for a span, each followed by its mirror image."""
    x = -approach + 0.1 * np.arange(round(10 * (approach + span)) + 1)
    elevations = iso8608_elevations(12, "B", approach + 35, seed=2)[:, : len(x)]
    return [bc.RoadProfile(x, sign * z) for z in elevations for sign in (1, -1)]


def single_ramps(height: float, approach: float, span: float) -> tuple[Array, Array]:
    """Return stations, and elevations of a ramp every 2 m, up and down, of an otherwise level road.

    A row of each ramp.
    """
    starts = np.arange(-approach, span, 2.0)
    stations = np.sort(np.r_[starts, starts + 0.1, span])
    ramps = height * (stations > starts[:, np.newaxis] + 0.05)
    return stations, np.vstack([ramps, -ramps])


def print_orders(boards: Mapping[int, bc.Scoreboard]) -> None:
    """Print what either estimate and simulation say of the dampers, and how the orders agree."""
    heads = (
        "".join(f"{f'{span} m bridge':>29}" for span in boards),
        "   Eq. (15)  class  simulated" * len(boards),
        "     mean     DAE       DAF  " * len(boards),
    )
    for words, head in zip(("class B", "", ""), heads, strict=True):
        print(f"{words:<18}{head}".rstrip())
    for name in (row.strategy for row in boards[25].rows()):
        line = f"{name:<18}"
        for board in boards.values():
            row = next(row for row in board.class_rows("B") if row.strategy == name)
            first = board.values["dae"][board.strategies.index(name)].mean()
            line += f"{first:11.4f}{row.dae:9.4f}{row.daf:9.4f}"
        print(line)
    print()
    for span, board in boards.items():
        for each in orders(board):
            print(
                f"{span} m, {each.estimate:<16} tau {each.agreement.tau:5.2f}, "
                f"{each.pairs.right} of {each.pairs.number} clear pairs in order"
            )


@style.styled
def even_effects(surfaces: Mapping[str, Any]) -> Figure:
    """Draw what ramps up and down have in common, by place, for a few dampers."""
    fig = Figure(figsize=(9, 3.6), layout="constrained")
    ax = fig.subplots()
    ax.axvspan(0, 25, color=style.BRIDGE_TINT, zorder=0)
    ax.axhline(0, color=style.GREY, lw=0.8)
    for name, color in LOOKS.items():
        effect = surfaces[name].even_effect.mean(axis=0)
        ax.plot(surfaces[name].positions, effect, color=color,
                label=f"{name}: mean {effect.mean():+.3f}")  # fmt: skip
    ax.set(xlabel=PLACE, ylabel="even effect e [-]", xlim=(surfaces[name].positions[0], 25),
           title="mean over the speeds, ramps of class B")  # fmt: skip
    ax.legend(loc="upper left")
    return fig


@style.styled
def damping_over_place(knots: Array, dampings: Array, passive: float) -> Figure:
    """Draw a damping program beside the constant it started from."""
    fig = Figure(figsize=(8, 3.2), layout="constrained")
    ax = fig.subplots()
    ax.axvspan(0, 25, color=style.BRIDGE_TINT, zorder=0)
    ax.axhline(passive / 1e3, color=style.GREY, label="passive")
    ax.plot(np.r_[-14, knots, 25], np.r_[dampings[0], dampings, dampings[-1]] / 1e3,
            color=style.BLUE)  # fmt: skip
    ax.plot(knots, dampings / 1e3, "o-", ms=4, color=style.BLUE, label="tuned on the class DAE")
    ax.set(xlabel="place of the tire, x [m]", ylabel="damping c [kN s/m]", xlim=(-14, 25))
    ax.legend(loc="upper right")
    return fig


def even_part(found: Any) -> float:
    """Return what the drop and the rise of the height of the class change in common."""
    rise, smooth, drop = np.interp(
        found.ramp_height * np.array([-1, 0, 1]), found.heights, found.daf
    )
    return (rise + drop) / 2 - smooth


def rms(values: ArrayLike) -> float:
    """Return the root mean square."""
    return float(np.sqrt(np.mean(np.square(values))))


def orders(board: bc.Scoreboard) -> Sequence[Any]:
    """Return how the mean of Eq. (15) and the class DAE order the dampers on roads of class B."""
    return [each for each in board.rankings() if each.pairs is not None and each.roads != "all"]


def check(names: Mapping[str, Any]) -> None:
    """Assert what the page says, by the variables of its cells."""
    boards, surfaces, fresh = names["boards"], names["surfaces"], names["gain"]
    plain, hook = names["plain"], names["hooked"]
    board = boards[25]
    apart = [np.abs(each.values["dae"].mean(axis=1) - each.daf_smooth).max()
             for each in boards.values()]  # fmt: skip
    by_mean = surfaces["bridgehook"].daf_smooth + surfaces["bridgehook"].even_effect.mean(axis=1)
    closed = surfaces["bridgehook"].class_dae("B").mean
    before = surfaces["bridgehook"].positions < 0
    effect = {name: each.even_effect.mean(axis=0) for name, each in surfaces.items()}
    first, second = (each.agreement.tau for each in orders(boards[35]))
    spread = np.ptp(boards[35].values["dae"].mean(axis=(1, 2)))
    at_rest = board.daf_smooth[0].mean()  # of the passive damper, as the row
    row = next(row for row in board.class_rows("B") if row.strategy == board.strategies[0])
    hold([
        ("passive, one ramp: error of the line", rms(plain.first_order - plain.daf), 0, 1e-4),
        ("bridgehook, one ramp: even part", even_part(hook), -0.0251, 1e-3),
        ("bridgehook, one ramp: error of the line", rms(hook.first_order - hook.daf), 0.031, 2e-3),
        ("the same, of the parabola", rms(hook.second_order - hook.daf), 0.008, 1e-3),
        ("mean of Eq. (15) - smooth DAF, largest", max(apart), 0, 1e-9),
        ("class DAE - mean over single ramps, largest", np.abs(closed - by_mean).max(), 0, 1e-12),
        ("class DAE: share of what roads add", (row.dae - at_rest) / (row.daf - at_rest), 0.5, 0.1),
        ("35 m: tau of Eq. (15)", first, 0.0, 0.06),
        ("35 m: tau of the class DAE", second, 0.94, 0.06),
        ("35 m: range of the means of Eq. (15)", spread, 0, 0.003),
        ("bridgehook: even effects on the approach", effect["bridgehook"][before].mean(), -0.052,
         3e-3),
        ("the same on the bridge, largest", effect["bridgehook"][~before].max(), 0.123, 0.01),
        ("passive: even effects on the approach", effect["passive 7 kN s/m"][before].mean(), 0,
         2e-3),
        ("program: gain of the class DAE", names["best"].fun - names["untuned"], -0.0023, 3e-4),
        ("program: gain on fresh roads", fresh.mean, -0.0028, 4e-4),
    ])  # fmt: skip
    assert all(each.rows()[0].strategy == "bridgehook" for each in boards.values())
    for each in boards.values():
        assert min(each.class_rows("B"), key=lambda row: row.dae).strategy == "bridgehook"
        assert orders(each)[1].pairs.share > 0.9
    assert fresh.high < 0
