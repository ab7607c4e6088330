"""Figures along a bridge: its mode shapes, an influence line, an envelope, with its supports."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.markers import CARETUP

from bridgectl._units import to_kmh
from bridgectl.plots import style
from bridgectl.plots.shown import BeamShown, EffectShown, EnvelopeShown

SHOWN = {
    "N m": ("kN m", 1e-3), "N": ("kN", 1e-3), "m": ("mm", 1e3), "N/m^2": ("MPa", 1e-6),
    "m/s^2": ("m/s²", 1.0),
}  # fmt: skip
"""Units of axes, and factors from those of effects."""

PER_FORCE = {
    "N m": ("kN m/kN", 1.0), "N": ("kN/kN", 1.0), "m": ("mm/kN", 1e6), "N/m^2": ("kPa/kN", 1.0),
}  # fmt: skip
"""The same of influence lines, per N."""

ABOVE: Any = {"loc": "lower right", "bbox_to_anchor": (1.0, 1.0), "fontsize": 9, "borderpad": 0.0}
"""Where a legend covers no curve."""

MODES, POINTS = 4, 1001
"""Most mode shapes that are drawn, and points of curves along the bridge."""


def supports_of(bridge: BeamShown) -> Iterator[tuple[float, Any]]:
    """Place of each support [m] and the marker it has; of a bridge that tells none, its ends."""
    places = getattr(bridge, "support_places", np.array([0.0, bridge.length]))
    kinds = getattr(bridge, "supports", ("simple",) * len(places))
    for place, kind in zip(places, kinds, strict=True):
        if kind != "free":
            yield float(place), {"simple": CARETUP, "clamped": "s"}.get(kind, "D")


@style.styled
def bridge_plot(
    bridge: BeamShown, effect: EffectShown | None = None, ax: Axes | None = None
) -> Axes:
    """Draw the first mode shapes of a bridge, or the influence line of an effect.

    Downward is down, and so is sagging. Supports are triangles, squares where they clamp the
    bridge, and diamonds where they are springs.

    Parameters
    ----------
    bridge : Beam, Bridge or ModalBridge
        The bridge.
    effect : Moment, Shear, ..., optional
        An effect at a place of the bridge; mode shapes if omitted.
    ax : matplotlib.axes.Axes, optional
        Axes to draw into; new ones if omitted.

    Returns
    -------
    matplotlib.axes.Axes

    Examples
    --------
    >>> import bridgectl as bc
    >>> bridge = bc.Bridge([25, 25], 18358, 4.865e10)
    >>> bc.plots.bridge_plot(bridge, bc.Moment(25.0)).get_ylabel()
    'bending moment [kN m/kN]'
    """
    ax = style.new_axes(ax)
    x = np.linspace(0.0, bridge.length, POINTS)
    if effect is None:
        frequencies = np.sort(bridge.omega)[:MODES] / (2 * np.pi)
        order = np.argsort(bridge.omega)[:MODES]
        shapes = bridge.mode_shapes(x)[:, order]
        shapes = shapes / np.abs(shapes).max(axis=0)
        for i, (frequency, shape) in enumerate(zip(frequencies, shapes.T, strict=True)):
            ax.plot(
                x, shape, color=style.TRACKS[i], lw=1.8, label=f"mode {i + 1}: {frequency:.3g} Hz"
            )
        ax.legend(**ABOVE, ncols=2)
        ax.set_ylabel("mode shape, over its largest [-]")
    else:
        unit, factor = PER_FORCE.get(effect.unit, (f"{effect.unit} / N", 1.0))
        line = factor * effect.influence_line(bridge, x)
        ax.plot(x, line, color=style.BLUE, lw=1.8)
        ax.fill_between(x, line, color=style.BLUE, alpha=0.15, lw=0)
        at = bridge.length / 2 if effect.at is None else effect.at
        ax.set(ylabel=f"{effect.label} [{unit}]", title=f"{effect.label} at {at:.4g} m per force")
    _finish(ax, bridge, downward=effect is None or effect.unit in ("N m", "m"))
    return ax


@style.styled
def envelope_plot(envelope: EnvelopeShown, ax: Axes | None = None) -> Axes:
    """Draw an envelope along its bridge, that of the static load dashed."""
    ax, x = style.new_axes(ax), envelope.places
    unit, factor = SHOWN[envelope.unit]
    largest, smallest = factor * envelope.largest, factor * envelope.smallest
    ax.fill_between(x, smallest, largest, color=style.BRIDGE_TINT, lw=0)
    ax.plot(x, largest, color=style.VERMILLION, lw=1.8, label="largest")
    ax.plot(x, smallest, color=style.BLUE, lw=1.8, label="smallest")
    if envelope.quantity != "acceleration":
        label: str | None = "static"
        for static in (envelope.static_largest, envelope.static_smallest):
            ax.plot(x, factor * static, "--", color=style.GREY, lw=1.4, label=label)
            label = None
    ax.set(
        ylabel=f"{envelope.quantity} [{unit}]",
        title=f"{envelope.quantity} at {to_kmh(envelope.speed):.4g} km/h",
    )
    ax.legend(**ABOVE, ncols=3)
    _finish(ax, envelope.bridge, downward=envelope.quantity != "shear")
    return ax


def _finish(ax: Axes, bridge: BeamShown, *, downward: bool) -> None:
    """Deck and supports along zero, and what is positive downward below them."""
    ax.plot([0, bridge.length], [0, 0], color=style.DECK, lw=2.5, solid_capstyle="butt", zorder=1.5)
    for place, marker in supports_of(bridge):
        ax.plot(
            [place], [0], ls="none", marker=marker, ms=11, color=style.DECK, clip_on=False, zorder=5
        )
    ax.set(xlabel=style.STATION_LABEL, xlim=(0, bridge.length))
    if downward and not ax.yaxis_inverted():
        ax.invert_yaxis()
