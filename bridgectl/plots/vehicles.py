"""A vehicle from the side: bodies, axles, hinge, and what its tires carry."""

from __future__ import annotations

from itertools import pairwise
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Circle, FancyBboxPatch

from bridgectl.plots import style
from bridgectl.plots.shown import VehicleShown
from bridgectl.plots.vehicle_parts import SHARED, Parts, parts_of

RADIUS, FLOOR, DEEP, TALL = 0.5, 1.15, 0.4, 1.7
"""Radius of tires, height of floors, and of bodies that carry others and that do not [m]."""

LOADS, SPACINGS = -0.75, -1.6
"""Where loads and spacings are written [m]."""

ROOM, PER_METRE = 1.2, 0.42
"""Free length before and behind a vehicle [m], and size of the figure [in/m]."""


@style.styled
def vehicle_plot(vehicle: VehicleShown, ax: Axes | None = None) -> Axes:
    """Draw a vehicle from the side, with static loads and distances between its axles.

    It drives to the right. Bodies are as long as they are told, heights are not to scale. A leg is
    a spring, with its damper beside it if it has one; a circle is a hinge.

    Parameters
    ----------
    vehicle : Vehicle or QuarterCar
        The vehicle.
    ax : matplotlib.axes.Axes, optional
        Axes to draw into; new ones if omitted.

    Returns
    -------
    matplotlib.axes.Axes

    Examples
    --------
    >>> import bridgectl as bc
    >>> bc.plots.vehicle_plot(bc.trucks.load("T5air")).get_title(loc="left")
    '40 t, natural frequencies 1.41, 1.59, 5.24, 8.85, 10.5, 12, 12, 12.1 Hz'
    """
    car = vehicle.linear
    parts = parts_of(car, 3.0)
    ends = [place for body in parts.bodies for place in (body.front, body.rear)]
    front, rear = min([0.0, *ends]) - ROOM, max([*parts.tires, *ends]) + ROOM
    if ax is None:
        size = max(6.0, PER_METRE * (rear - front)), 3.2
        ax = Figure(figsize=size, layout="constrained").subplots()
    floors = _draw_bodies(ax, parts)
    for leg, damping in zip(parts.legs, car.damper_dampings, strict=True):
        top = FLOOR if leg.body is None else floors[leg.body]
        _draw_leg(ax, leg.place, top, damped=damping > 0)
        under = parts.tires[np.abs(leg.shares) > SHARED]
        ax.plot([under.min(), under.max()], [RADIUS] * 2, color=style.BLACK, lw=3, zorder=5)
    _draw_tires(ax, parts.tires, car.static_loads)
    ax.axhline(0, color=style.DECK, lw=1.5, zorder=1)
    frequencies = ", ".join(f"{f:.3g}" for f in car.frequencies)
    ax.set_title(f"{car.mass / 1e3:.3g} t, natural frequencies {frequencies} Hz")
    ax.set(
        xlim=(rear, front), ylim=(SPACINGS - 0.35, FLOOR + DEEP + TALL + 0.3), yticks=[],
        xlabel="behind the first axle [m]", ylabel="side view", aspect="equal",
    )  # fmt: skip
    ax.grid(visible=False)
    ax.spines["left"].set_visible(False)
    return ax


def _draw_bodies(ax: Axes, parts: Parts) -> list[float]:
    """Draw the bodies, those on hinges above what carries them; return their floors [m]."""
    floors: list[float] = []
    carrying, sprung = {body.on for body in parts.bodies}, {leg.body for leg in parts.legs}
    for i, body in enumerate(parts.bodies):
        own = FLOOR if i in sprung else 2 * RADIUS  # what has no leg sits on its tire
        floors.append(own if body.on is None else floors[body.on] + DEEP)
        tall = DEEP if i in carrying else TALL
        ax.add_patch(FancyBboxPatch(
            (body.front, floors[i]), body.rear - body.front, tall, fc=style.VERMILLION,
            ec=style.BLACK, lw=1.0, zorder=4, boxstyle="round,pad=0,rounding_size=0.12",
        ))  # fmt: skip
        if body.on is not None:
            ax.plot([body.front], [floors[i]], "o", ms=8, mfc="white", mec=style.BLACK, zorder=6)
    return floors


def _draw_leg(ax: Axes, place: float, top: float, *, damped: bool) -> None:
    """A zigzag from hub to floor, and a damper beside it."""
    aside = 0.16 if damped else 0.0
    heights = np.concatenate([[RADIUS], np.linspace(RADIUS + 0.12, top - 0.12, 8), [top]])
    sides = np.concatenate([[0.0, 0.0], np.tile([0.12, -0.12], 3), [0.0, 0.0]])
    ax.plot(place + aside + sides, heights, color=style.BLACK, lw=1.2, zorder=5)
    if damped:
        middle = (RADIUS + top) / 2
        ax.plot([place - aside] * 2, [RADIUS, top], color=style.BLACK, lw=1.2, zorder=5)
        ax.plot([place - aside] * 2, [middle - 0.12, middle + 0.12], color=style.BLACK, lw=5,
                solid_capstyle="butt", zorder=5)  # fmt: skip


def _draw_tires(ax: Axes, tires: Any, loads: Any) -> None:
    """Tires, and in two rows below them their loads and the distances between them."""
    for place, load in zip(tires, loads, strict=True):
        ax.add_patch(Circle((place, RADIUS), RADIUS, fc=style.PAVEMENT, ec=style.BLACK, zorder=3))
        arrow: Any = {"arrowstyle": "-|>", "color": style.BLUE, "lw": 1.4}
        ax.annotate("", (place, 0), (place, LOADS + 0.25), arrowprops=arrow)
        ax.text(place, LOADS, f"{load / 1e3:.3g}", color=style.BLUE, ha="center", va="center",
                fontsize=9)  # fmt: skip
    along = np.sort(tires)
    for ahead, behind in pairwise(along):
        line: Any = {
            "arrowstyle": "<->",
            "color": style.GREY,
            "lw": 1.0,
            "shrinkA": 0,
            "shrinkB": 0,
        }
        ax.annotate("", (ahead, SPACINGS + 0.25), (behind, SPACINGS + 0.25), arrowprops=line)
        ax.text((ahead + behind) / 2, SPACINGS, f"{behind - ahead:.3g}", color=style.BLACK,
                ha="center", va="center", fontsize=9)  # fmt: skip
    last: Any = {"ha": "right", "va": "center", "fontsize": 9}
    ax.text(along[-1] + 0.75, LOADS, "kN", color=style.BLUE, **last)
    if along.size > 1:
        ax.text(along[-1] + 0.75, SPACINGS, "m", color=style.BLACK, **last)
