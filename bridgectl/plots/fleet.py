"""The figure of an assessment: amplification of random traffic, and what its tail says."""

from __future__ import annotations

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from bridgectl._checks import FloatArray
from bridgectl.plots.shown import ReadingShown, ReadShown, TailShown
from bridgectl.plots.style import BLACK, BLUE, GREY, TRACKS, VERMILLION, styled

LOOKS = {"total": VERMILLION, "static": BLUE}

N_POINTS = 4000
"""Crossings that are drawn as points, and as many steps of a distribution."""

N_HEAVY = 200
"""Of these the ones of the largest effects, all of which are drawn."""

FAR = 3.0
"""Intervals are drawn up to so many times the largest value: their ends stand in the legend."""

N_LEVELS = 7
"""Return periods at which the interval is drawn."""


@styled
def fleet_figure(read: ReadShown) -> Figure:
    """Draw an effect of random traffic and its tail.

    Above: DAF over static effect, with bins; distribution of static and total effect; that of the
    DAF on each road quality. Below, of total and static effect: return levels with the fit and its
    interval, quantiles of the fit beside those of the data, and mean excesses over a threshold,
    which are a straight line where a generalized Pareto distribution holds.
    """
    figure = Figure(figsize=(13.0, 8.2), layout="constrained")
    axes = figure.subplots(2, 3)
    unit, size = _unit(read.unit, np.abs(read.total.values).max())
    label = f"{'' if read.sign > 0 else 'negative '}{read.effect} [{unit}]"
    readings = {"total": read.total, "static": read.static}
    _draw_daf(axes[0, 0], read, size, label)
    _draw_distributions(axes[0, 1], {n: each.values / size for n, each in readings.items()}, LOOKS)
    axes[0, 1].set(xlabel=label, title="distribution of the effect")
    colors = dict(zip(read.daf_by_quality, TRACKS * len(read.daf_by_quality), strict=False))
    _draw_distributions(axes[0, 2], read.daf_by_quality, colors)
    axes[0, 2].set(xlabel="DAF [-]", title="distribution of the DAF")
    for name, reading in readings.items():
        _draw_levels(axes[1, 0], read, reading, size, name)
        _draw_excesses(axes[1, 2], reading, size, name)
        if reading.tail is not None and reading.tail.scale > 0:
            _draw_quantiles(axes[1, 1], reading.tail, size, name)
    _cut(axes[1, 0], FAR * max(reading.value for reading in readings.values()) / size)
    axes[1, 0].set(xscale="log", xlabel="return period [years]", ylabel=label,
                   title="return levels, with 95 % interval")  # fmt: skip
    axes[1, 1].set(xlabel=f"quantiles of the fit [{unit}]", ylabel=f"peaks [{unit}]",
                   title="fit beside data")  # fmt: skip
    axes[1, 2].set(xlabel=f"threshold [{unit}]", ylabel=f"mean excess [{unit}]",
                   title="mean excess over a threshold")  # fmt: skip
    for ax in (axes[0, 0], *axes[0, 1:], *axes[1]):
        if ax.get_legend_handles_labels()[0]:
            ax.legend(fontsize=8.5)
    return figure


def _unit(unit: str, largest: float) -> tuple[str, float]:
    """Unit of the axes, and its size: of forces thousands, of small lengths thousandths."""
    if unit.startswith("N") and largest >= 1e4:
        return f"k{unit}", 1e3
    if unit == "m" and largest < 1:
        return "mm", 1e-3
    return unit, 1.0


def _draw_daf(ax: Axes, read: ReadShown, size: float, label: str) -> None:
    """Draw crossings as points, and bins of static effect."""
    static, bins = read.static.values, read.bins
    order = np.argsort(static, kind="stable")
    shown = np.union1d(order[:: max(len(order) // N_POINTS, 1)], order[-N_HEAVY:])
    ax.plot(static[shown] / size, read.daf[shown], ".", color=GREY, ms=2, alpha=0.5,
            label=f"{len(shown)} of {len(static)} crossings", rasterized=True)  # fmt: skip
    x = (bins.low + bins.high) / 2 / size
    low, _, high = bins.quantiles
    across = (bins.high - bins.low) / 2 / size
    errors = np.array([np.maximum(bins.mean - low, 0), np.maximum(high - bins.mean, 0)])
    ax.errorbar(x, bins.mean, errors, across, "o", color=BLACK, ms=4, lw=1.2,
                label="mean, 5 and 95 % of a bin")  # fmt: skip
    ax.set(xlabel=f"static {label}", ylabel="DAF [-]", title="amplification of static effects")


def _draw_distributions(ax: Axes, values: dict[str, FloatArray], colors: dict[str, str]) -> None:
    """Draw what share stays below."""
    shares = np.linspace(0, 1, N_POINTS)
    for name, each in values.items():
        ax.plot(np.quantile(each, shares), shares, color=colors[name], label=name or None)
    ax.set_ylabel("share of the crossings below [-]")


def _draw_levels(ax: Axes, read: ReadShown, reading: ReadingShown, size: float, name: str) -> None:
    """Draw peaks over their return periods, and the fit up to the one that is asked for."""
    color, tail, rule = LOOKS[name], reading.tail, read.rule
    value, low, high = np.array(reading.estimate) / size
    if tail is None:
        ranked = np.sort(reading.values)[-N_POINTS:]
        periods = len(reading.values) / (np.arange(len(ranked))[::-1] + 0.5)
        ax.plot(rule.years(periods), ranked / size, ".", color=color, ms=3)
    else:
        ax.plot(rule.years(tail.periods()), tail.peaks / size, ".", color=color, ms=3)
        # Of fewer crossings than stand for a peak it says nothing.
        crossings = np.geomspace(1.05 * tail.share, rule.crossings, 100)
        ax.plot(rule.years(crossings), tail.value(crossings) / size, color=color, lw=1.4)
        some = np.geomspace(2 * tail.share, rule.crossings, N_LEVELS)
        ends = np.array([tail.level(each)[1:] for each in some]).T / size
        ax.fill_between(rule.years(some), *ends, color=color, alpha=0.15, lw=0)
    reach = [[value - low], [high - value]] if np.isfinite([low, high]).all() else None
    ax.errorbar(rule.return_period, value, reach, fmt="o", color=color, capsize=3,
                label=f"{name}: {value:.4g} ({low:.4g} to {high:.4g})")  # fmt: skip


def _cut(ax: Axes, farthest: float) -> None:
    """Let an axis end where intervals become too wide to be drawn with the rest."""
    low, high = ax.dataLim.intervaly
    if high > farthest:
        ax.set_ylim(low - 0.05 * (farthest - low), farthest)


def _draw_quantiles(ax: Axes, tail: TailShown, size: float, name: str) -> None:
    """Draw peaks over the quantiles of their fit."""
    quantiles, peaks = tail.quantiles() / size, tail.peaks / size
    ax.plot(quantiles, peaks, ".", color=LOOKS[name], ms=4,
            label=f"{name}: {len(peaks)} peaks, p = {tail.p_value():.2f}")  # fmt: skip
    ends = [min(quantiles[0], peaks[0]), max(quantiles[-1], peaks[-1])]
    ax.plot(ends, ends, ":", color=BLACK, lw=0.8)


def _draw_excesses(ax: Axes, reading: ReadingShown, size: float, name: str) -> None:
    """Draw mean excesses with their standard errors, and where the threshold is."""
    x, mean, error = (each / size for each in reading.mean_excess)
    ax.plot(x, mean, color=LOOKS[name], label=name)
    ax.fill_between(x, mean - error, mean + error, color=LOOKS[name], alpha=0.15, lw=0)
    if reading.tail is not None and not reading.tail.of_blocks:
        ax.axvline(reading.tail.location / size, color=LOOKS[name], lw=0.8, ls="--")
