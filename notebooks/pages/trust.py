"""What the page on trust draws and checks: where the estimate errs, and the light that warns."""

from __future__ import annotations

from collections.abc import Mapping
from types import SimpleNamespace
from typing import Any

import numpy as np
from matplotlib.figure import Figure

from bridgectl.plots import style
from pages.claims import hold

Case = tuple[int, int, int]
"""Span [m], approach [m] and number of the road."""


@style.styled
def three_amplifications(
    kmh: np.ndarray,
    superposed: Mapping[Case, np.ndarray],
    simulated: Mapping[Case, np.ndarray],
    dae: Mapping[Case, np.ndarray],
) -> Figure:
    """Draw superposed and simulated DAF and the DAE: a column for each bridge, a row a road."""
    fig = Figure(figsize=(10.5, 7), layout="constrained")
    columns = list(dict.fromkeys(key[:2] for key in dae))
    roads = list(dict.fromkeys(key[2] for key in dae))
    axes = fig.subplots(len(roads), len(columns), sharex=True, sharey="row")
    for row, road in zip(axes, roads, strict=True):
        for ax, (span, approach) in zip(row, columns, strict=True):
            key = span, approach, road
            ax.plot(kmh, superposed[key], color=style.SKY, lw=4.5, label="superposed DAF")
            ax.plot(kmh, simulated[key], color=style.BLACK, lw=1.1, label="simulated DAF")
            ax.plot(kmh, dae[key], "--", color=style.VERMILLION, lw=1.4, label="DAE")
        row[0].set_ylabel(f"road {road}\nDAF, DAE [-]")
    for top, bottom, (span, approach) in zip(axes[0], axes[-1], columns, strict=True):
        top.set_title(f"{span} m bridge, from {-approach} m")
        bottom.set_xlabel(style.SPEED_LABEL)
    axes[0, 0].set(xlim=(50, 150), xticks=[50, 100, 150])
    fig.legend(*axes[0, 0].get_legend_handles_labels(), loc="outside upper center", ncols=3)
    return fig


def table(
    kmh: np.ndarray, simulated: Mapping[Case, np.ndarray], dae: Mapping[Case, np.ndarray]
) -> None:
    """Print the peaks over the speeds, and where the DAE is farthest off."""
    print("bridge  from  road   peak DAF  at [km/h]   peak DAE   difference"
          "   largest error  at [km/h]")  # fmt: skip
    for (span, approach, road), estimate in dae.items():
        exact = simulated[span, approach, road]
        worst = np.abs(estimate - exact).argmax()
        # Adding zero makes a plus of a minus before nothing.
        apart, error = round(estimate.max() - exact.max(), 3) + 0.0, (estimate - exact)[worst]
        print(f"{span:4} m{-approach:6}{road:6}{exact.max():11.3f}{kmh[exact.argmax()]:11d}"
              f"{estimate.max():11.3f}{apart:+13.3f}{error:+16.3f}{kmh[worst]:11d}")  # fmt: skip


@style.styled
def competing_peaks(
    cases: Mapping[str, tuple[np.ndarray, np.ndarray, np.ndarray, float, float]],
) -> Figure:
    """Draw the moment of a smooth and of a rough road, and what the DAE follows.

    Each case has the places of the tire, both moments, and place and moment that are followed.
    """
    fig = Figure(figsize=(10, 6.4), layout="constrained")
    axes = fig.subplots(2, 1, sharex=True, sharey=True)
    for ax, (title, (x, smooth, rough, place, value)) in zip(axes, cases.items(), strict=True):
        ax.axvline(place, color=style.GREY, lw=0.9)
        ax.plot(x, smooth, "--", color=style.GREY, label="smooth road")
        ax.plot(x, rough, color=style.BLACK, label="measured road")
        ax.plot(place, smooth.max(), "o", color=style.GREY, label=f"smooth DAF {smooth.max():.3f}")
        ax.plot(x[rough.argmax()], rough.max(), "o", color=style.BLACK,
                label=f"DAF {rough.max():.3f}")  # fmt: skip
        ax.plot(place, value, "D", color=style.VERMILLION, mfc="none", ms=9, mew=1.6,
                label=f"what the DAE\nfollows: {value:.3f}")  # fmt: skip
        ax.set(title=title, ylabel="mid-span moment / $M_0$ [-]", xlim=(0, x[-1]))
        ax.legend(loc="center left", bbox_to_anchor=(1, 0.5))
    axes[-1].set_xlabel("place of the tire, x [m]")
    return fig


@style.styled
def where(
    kmh: np.ndarray, smooth: Mapping[int, np.ndarray], large: Mapping[int, np.ndarray]
) -> Figure:
    """Draw the DAF of a smooth road, and the share of roads with a large error at each speed."""
    fig = Figure(figsize=(10.5, 5), layout="constrained")
    axes = fig.subplots(2, len(large), sharex=True, sharey="row")
    for column, (span, wrong) in zip(axes.T, large.items(), strict=True):
        column[0].plot(kmh, smooth[span], color=style.BLACK)
        column[0].set_title(f"{span} m bridge")
        share = 100 * wrong.mean(axis=0)
        column[1].fill_between(kmh, share, color=style.VERMILLION, alpha=0.5, lw=0)
        column[1].set_xlabel(style.SPEED_LABEL)
    axes[0, 0].set_ylabel("DAF, smooth road [-]")
    axes[1, 0].set(ylabel="roads with a large\nerror of the DAE [%]", xlim=(50, 150), ylim=(0, 100))
    return fig


@style.styled
def light(
    error: Mapping[int, np.ndarray], large: Mapping[int, np.ndarray], trust: Mapping[int, Any]
) -> Figure:
    """Draw the error of the DAE over the rise of the peak, with what the light says of it."""
    fig = Figure(figsize=(10.5, 3.9), layout="constrained")
    axes = fig.subplots(1, len(error), sharex=True, sharey=True)
    for ax, span in zip(axes, error, strict=True):
        rise, lit = trust[span].peak_rise.ravel(), ~trust[span].trusted.ravel()
        wrong = large[span].ravel()
        for dots, color, name in [
            (wrong & lit, style.VERMILLION, "large error, light on"),
            (~wrong & ~lit, style.BLUE, "small error, light off"),
            (wrong & ~lit, style.BLACK, "missed"),
            (~wrong & lit, style.TRACKS[4], "false alarm"),
        ]:
            ax.plot(rise[dots], -error[span].ravel()[dots], ".", ms=3, mew=0, color=color,
                    label=name, rasterized=True)  # fmt: skip
        ax.plot([0, 0.5], [0, 0.5], color=style.GREY, lw=0.9, zorder=3, label="equal values")
        ax.set(xlabel="peak_rise [-]", title=f"{span} m bridge")
    axes[0].set(ylabel="DAF - DAE [-]", xlim=(-0.01, 0.5), ylim=(-0.15, 0.5))
    handles = axes[0].get_legend_handles_labels()
    fig.legend(*handles, loc="outside upper center", ncols=5, markerscale=4)
    return fig


@style.styled
def in_flight(kmh: np.ndarray, told: np.ndarray, simulated: np.ndarray, dae: np.ndarray) -> Figure:
    """Draw the three amplifications on a road that the tire leaves."""
    fig = Figure(figsize=(7.5, 3.4), layout="constrained")
    ax = fig.subplots()
    ax.plot(kmh, told, color=style.SKY, lw=5, label="superposed DAF, or simulated in flight")
    ax.plot(kmh, simulated, color=style.BLACK, lw=1.2, label="simulated DAF")
    ax.plot(kmh, dae, "--", color=style.VERMILLION, label="DAE")
    ax.set(xlabel=style.SPEED_LABEL, ylabel="DAF, DAE [-]", xlim=(50, 150))
    ax.set_title("class D road on the 25 m bridge")
    ax.legend(fontsize=9)
    return fig


def check(names: dict[str, Any]) -> None:
    """Assert what the page says of the errors of the DAE, of the light, and of flights."""
    n = SimpleNamespace(**names)
    gaps = {key: n.dae[key].max() - n.simulated[key].max() for key in n.dae}
    at, off = {span: n.surfaces[span, 0] for span in n.error}, {}
    for span in n.error:
        peaks = n.estimate[span].max(axis=1) - n.exact[span].max(axis=1)
        off[span] = (np.abs(peaks) > n.TOLERANCE).mean()
    share = {span: wrong.mean() for span, wrong in n.large.items()}
    low = [(n.error[span] < 0)[n.large[span]].mean() for span in n.error]
    smooth, large = at[25].daf_smooth, n.large[25]
    tops, valleys = smooth >= np.quantile(smooth, 0.8), smooth <= np.quantile(smooth, 0.2)
    strength = {span: np.sqrt(np.mean(surface.daf_difference**2)) for span, surface in at.items()}
    stiffness = n.truck.suspension_stiffness + n.truck.tire_stiffness
    bounce = np.sqrt(stiffness / n.truck.unsprung_mass) / (2 * np.pi)
    near = np.abs(n.error[25] + n.trust[25].peak_rise)
    found = {span: n.trust[span].trusted[~wrong].mean() for span, wrong in n.large.items()}
    critical, worst = n.dae[n.key] - n.simulated[n.key], n.worst
    follows = n.dae[n.key][worst] - n.followed[worst][1]
    hold([
        ("superposed - simulated DAF, largest",
         max(np.abs(n.superposed[key] - n.simulated[key]).max() for key in n.dae), 0, 1e-6),
        ("25 and 35 m: peak DAE - peak DAF, largest",
         max(abs(gap) for (span, *_), gap in gaps.items() if span > 15), 0, 1e-3),
        ("15 m, road 5: peak DAE - peak DAF", gaps[15, 0, 5], -0.2, 0.02),
        ("measured road, critical speed: DAE - DAF", critical[n.critical], 0, 1e-6),
        ("measured road, worst speed: DAE - DAF", critical[worst], -0.175, 0.01),
        ("the same: DAE - moment that it follows", follows, 0, 0.01),
        ("critical speed: peak at mid-span [m]", n.followed[n.critical][0], 12.5, 1e-6),
        ("random roads, 25 m: share of large errors", share[25], 0.34, 0.01),
        ("15 m: share of large errors", share[15], 0.50, 0.01),
        ("35 m: share of large errors", share[35], 0.20, 0.01),
        ("large errors that are too low, least share", min(low), 1, 0.05),
        ("25 m: roads whose peak is off by 0.02", off[25], 0, 0.05),
        ("35 m: roads whose peak is off by 0.02", off[35], 0, 0.05),
        ("15 m: roads whose peak is off by 0.02", off[15], 0.2, 0.05),
        ("25 m: large errors, highest fifth of smooth DAF", large[:, tops].mean(), 0.10, 0.02),
        ("25 m: large errors, lowest fifth of smooth DAF", large[:, valleys].mean(), 0.60, 0.02),
        ("15 m: rms effect of a ramp, over 25 m", strength[15] / strength[25], 2.64, 0.05),
        ("35 m: rms effect of a ramp, over 25 m", strength[35] / strength[25], 0.41, 0.05),
        ("frequency of the axle's bounce [Hz]", bounce, 6.9, 0.01),
        ("first frequency, 15 m [Hz]", at[15].beam.frequencies[0], 5.7, 0.05),
        ("light: least precision", min(p for p, _ in n.light.values()), 0.93, 0.01),
        ("light, 25 m: recall", n.light[25][1], 0.91, 0.01),
        ("light, 15 m: recall", n.light[15][1], 0.86, 0.01),
        ("light off where the error is small, least share", min(found.values()), 0.95, 0.03),
        ("25 m: |error + peak_rise|, 95 % below", np.quantile(near, 0.95), 0, 0.025),
        ("class D: superposed or simulated - simulated",
         np.abs(n.with_flights - n.flights).max(), 0, 1e-6),
        ("class D: a lift-off warning at least", min(len(n.told), 1), 1, 0),
        ("class D: speeds near lift-off, one at least", min(n.rough_trust.lift_off.sum(), 1), 1, 0),
    ])  # fmt: skip
