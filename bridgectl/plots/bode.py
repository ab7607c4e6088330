"""Bode plots of a crossing, frozen with the vehicle at several places along the bridge."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import control
import matplotlib as mpl
import matplotlib.pyplot as plt
import numpy as np
from numpy.typing import ArrayLike, NDArray

from bridgectl import _checks
from bridgectl._checks import FloatArray
from bridgectl.plots import style
from bridgectl.plots.responses import unit_of
from bridgectl.plots.shown import CrossingShown

RIGHT = 1e-6
"""How far right of the imaginary axis responses are read, as a share of the frequency.

Poles and zeros of an undamped bridge are on the axis, where a phase jumps by 180 degrees either
way: read from here they turn it as those of a bridge with the slightest damping do.
"""

TURN, ROUNDS, FIRST = 0.5, 40, 400
"""Largest change of phase between frequencies [rad], halvings at most, frequencies at first."""

MOST_NAMED, WIDEST, THINNEST = 8, 5.0, 1.6
"""Places that get a name each, not a colour bar; widths of lines [points]."""

FAINT = 200.0
"""How far below the others [dB] a response is nothing but rounding: of a vehicle at a support."""

COLORS = mpl.colors.ListedColormap(mpl.colormaps["viridis"](np.linspace(0, 0.92, 256)))
"""Without the yellow, which is pale on white."""


@style.styled
def bode_plot(
    crossing: CrossingShown, places: ArrayLike, outputs: Sequence[str], input: str | None,
    limits: Sequence[float] | None, speed: float,
) -> control.ControlPlot:  # fmt: skip
    """Draw a crossing frozen at some places [m]: see `bridgectl.Crossing.plot_bode`."""
    at = _checks.array("places", np.atleast_1d(places), (None,), unit="m")
    if not len(at):
        raise ValueError("places must be positions along the bridge [m], got none")
    labels, inputs = tuple(crossing.output_labels), tuple(crossing.input_labels)
    asked = (outputs,) if isinstance(outputs, str) else tuple(outputs)
    names = [_checks.choice("outputs", name, labels) for name in asked]
    source = inputs[0] if input is None else _checks.choice("input", input, inputs)
    frozen = [crossing.frozen(x, speed) for x in at]
    low, high = _limits(frozen, limits)
    figure = plt.figure(figsize=(1.2 + 4.4 * len(names), 5.6), layout="tight")
    axes = figure.subplots(2, len(names), sharex=True, squeeze=False)
    shares = at / crossing.beam.length
    colors = mpl.cm.ScalarMappable(mpl.colors.Normalize(shares.min(), shares.max()), COLORS)
    lines = np.empty(axes.shape, dtype=object)
    for k, name in enumerate(names):
        curves = [_curve(system[name, source], low, high) for system in frozen]
        lines[:, k] = _draw(axes[:, k], curves, shares, colors)
        unit = f"1 {unit_of(name)}/{unit_of(source)}".replace("1 1/", "1/")
        axes[0, k].set(title=f"{source} → {name}", ylabel=f"magnitude [dB re {unit}]")
        axes[1, k].set(xlabel="frequency [Hz]", ylabel="phase [degrees]", xlim=(low, high))
    beside = axes[0, -1]
    if len(at) > MOST_NAMED:
        bar = beside.inset_axes((1.03, 0.0, 0.04, 1.0))
        figure.colorbar(colors, cax=bar, label="place of the vehicle, x/l [-]")
        return control.ControlPlot(lines, axes, figure)
    legend = beside.legend(
        handles=lines[0, -1], title="vehicle at", loc="upper left", bbox_to_anchor=(1.0, 1.0)
    )
    return control.ControlPlot(lines, axes, figure, legend)


def _limits(frozen: list[control.StateSpace], limits: Sequence[float] | None) -> FloatArray:
    """Lowest and highest frequency [Hz]."""
    if limits is None:
        hertz = np.abs(np.concatenate([system.poles() for system in frozen])) / (2 * np.pi)
        return np.array([0.4, 1.25]) * (hertz[hertz > 0].min(), hertz.max())
    pair = _checks.array("limits", limits, (2,), unit="Hz")
    if not 0 < pair[0] < pair[1]:
        raise ValueError(f"limits must be above 0 Hz and increase, got {pair.tolist()}")
    return pair


def _curve(system: control.StateSpace, low: float, high: float) -> tuple[FloatArray, ...]:
    """Frequencies [Hz], magnitudes [dB] and unwrapped phases [degrees], close where they turn."""

    def read(hertz: FloatArray) -> NDArray[np.complex128]:
        return np.asarray(system(2 * np.pi * (1j + RIGHT) * hertz))

    poles = np.abs(system.poles()) / (2 * np.pi)
    inside = poles[(poles > low) & (poles < high)]
    hertz = np.unique(np.concatenate([np.geomspace(low, high, FIRST), inside]))
    values = read(hertz)
    for _ in range(ROUNDS):
        (wide,) = np.nonzero(np.abs(np.angle(values[1:] * values[:-1].conj())) > TURN)
        if not len(wide):
            break
        middle = np.sqrt(hertz[wide] * hertz[wide + 1])
        values = np.insert(values, wide + 1, read(middle))
        hertz = np.insert(hertz, wide + 1, middle)
    phases = np.degrees(np.unwrap(np.angle(values)))
    return hertz, 20 * np.log10(np.maximum(np.abs(values), 1e-300)), phases


def _draw(
    pair: Any, curves: list[tuple[FloatArray, ...]], shares: FloatArray, colors: Any
) -> tuple[list[Any], list[Any]]:
    """Draw magnitudes into the first of two axes and phases into the second; return the lines."""
    widths = np.linspace(WIDEST, THINNEST, len(curves)) if len(curves) > 1 else [1.6]
    _, loudest, anchor = max(curves, key=lambda curve: curve[1].max())
    lowest = max(loudest.max(), -FAINT / 2) - FAINT
    above: list[Any] = []
    below: list[Any] = []
    for (hertz, decibels, phases), share, width in zip(curves, shares, widths, strict=True):
        look = {"color": colors.to_rgba(share), "lw": width, "label": f"{share:.4g} l"}
        if decibels.max() < lowest:
            decibels = phases = np.full(len(hertz), np.nan)
            look["label"] += ": none"
        # A phase that begins at about 180 degrees begins at the same of both for all.
        turns = np.round((anchor[0] - phases[0]) / 360)
        above += pair[0].semilogx(hertz, decibels, **look)
        below += pair[1].semilogx(hertz, phases + 360 * turns, **look)
    pair[1].yaxis.set_major_locator(mpl.ticker.MultipleLocator(90))
    return above, below
