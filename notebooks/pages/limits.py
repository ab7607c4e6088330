"""What the page of limits draws and checks: the optimum, preview, errors and the price of ride."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from matplotlib.figure import Figure
from numpy.typing import NDArray

from bridgectl.plots import style
from pages.claims import hold

Array = NDArray[np.float64]
SHOWN = "nothing wrong", "position -1 m", "position -3 m", "all at once"
"""Errors of the table."""


def print_shares(dafs: Mapping[str, Array]) -> dict[str, float]:
    """Print mean DAFs, and print and return how far dampers go from passive to the optimum."""
    gap = (dafs["passive"] - dafs["optimum"]).mean()
    shares = {name: (dafs["passive"] - daf).mean() / gap for name, daf in dafs.items()}
    for name, daf in dafs.items():
        print(f"{name:<13} mean DAF {daf.mean():.3f}, gap closed {shares[name]:.2f}")
    return shares


def print_changes(wrong: Any) -> None:
    """Print the change of the mean DAF by each strategy under some errors."""
    print(" " * 13, *(f"{error:>14}" for error in SHOWN))
    for name in wrong.strategies:
        print(f"{name:<13}", *(f"{wrong.change(name, error).mean:>+14.3f}" for error in SHOWN))


@style.styled
def gaps_closed(shares: Mapping[str, float]) -> Figure:
    """Draw the share of the gap from passive to the optimum that dampers close."""
    fig = Figure(figsize=(8, 3.2), layout="constrained")
    ax = fig.subplots()
    names = [name for name in shares if name != "passive"]
    colors = [style.GREY if name == "optimum" else style.BLUE for name in names]
    bars = ax.barh(names, [shares[name] for name in names], color=colors)
    ax.bar_label(bars, fmt="{:.2f}", padding=3)
    ax.invert_yaxis()
    ax.set(xlabel="share of the gap from passive to the optimum [-]", xlim=(0, 1.08))
    return fig


@style.styled
def price_of_ride(ride: Array, daf: Array, weights: Sequence[float]) -> Figure:
    """Draw mean DAF over ride: the passive damper, which comes first, and bridgehook by weight."""
    fig = Figure(figsize=(6.5, 3.4), layout="constrained")
    ax = fig.subplots()
    ax.plot(ride[1:], daf[1:], "o-", color=style.BLUE, label="bridgehook, by its weight of ride")
    ax.plot(ride[0], daf[0], "s", color=style.GREY, label="passive")
    for x, y, weight in zip(ride[1:], daf[1:], weights, strict=True):
        left = weight > 0
        ax.annotate(f"{weight:g}", (x, y), textcoords="offset points",
                    xytext=(-4 if left else 6, 6), ha="right" if left else "left")  # fmt: skip
    ax.set(xlabel="ride, W$_k$ rms over that of the passive damper [-]", ylabel="mean DAF [-]")
    ax.margins(0.08)
    ax.legend(loc="upper right")
    return fig


def check(names: Mapping[str, Any]) -> None:
    """Assert what the page says, by the variables of its cells."""
    proven, wrong, shares, best = (names[each] for each in ("proven", "wrong", "shares", "best"))
    ride, seen, dafs = names["ride"], names["seen"], names["dafs"]
    without = dafs["bridgehook"].mean()
    hold([
        ("widest interval of the optimum", max(each.gap for each in proven), 0, 1.1e-4),
        ("bridgehook, share of the gap", shares["bridgehook"], 0.71, 0.02),
        ("rollout, share of the gap", shares["rollout"], 0.88, 0.02),
        ("10 m of preview, share of the gap", shares["preview 10 m"], 0.91, 0.02),
        ("1 mm of noise", seen["1 mm of noise"] - dafs["preview 10 m"].mean(), 0, 2e-3),
        ("bridgehook, places 3 m off", wrong.change("bridgehook", "position -3 m").mean, 0.026,
         0.005),
        ("careful, all at once", wrong.change("careful", "all at once").mean, -0.055, 0.005),
        ("ride of bridgehook over passive", ride[1], 1.70, 0.05),
    ])  # fmt: skip
    assert all(each.daf <= each.ipopt_daf + 1e-9 for each in np.ravel(best))
    assert all(each.interval[0] < each.passive for each in proven)
    assert np.all(dafs["optimum"] <= dafs["preview 10 m"])
    assert max(seen.values()) < without
    for name in ("bridgehook", "preview 5 m"):
        assert wrong.change(name, "position -3 m").mean > 0 > wrong.change(name, "all at once").mean
