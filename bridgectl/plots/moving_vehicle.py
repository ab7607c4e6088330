"""A vehicle that rolls over a road as drawn: bodies, hinges, springs, axles and tires."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.patches import Circle, FancyBboxPatch
from matplotlib.transforms import Affine2D

from bridgectl._checks import FloatArray
from bridgectl.plots import style
from bridgectl.plots.shown import VehicleShown
from bridgectl.plots.vehicle_parts import SHARED, DrawnBody, parts_of

TIRE, SPRING, BODY = 0.032, 0.075, (0.15, 0.06)
"""Radius of the tire, length of the spring and size of a box, as fractions of the width."""

CLOSE, LEAST, CARRYING = 0.46, 0.45, 0.4
"""Radius of tires over their distance, least height and that of a body that carries another, over
the usual ones."""

FORCES = (style.VERMILLION, "#009E73", "#CC79A7", "#E69F00", style.SKY, style.BLACK)
"""Colours of hubs and of the forces of their tires, over and over."""

COILS = 6
"""Coils of a spring."""


def radius_and_size(vehicle: VehicleShown, unit: float) -> tuple[float, float]:
    """Radius of the tires [m], and what heights are fractions of: less where axles are close."""
    apart = np.diff(np.unique(vehicle.tire_offsets))
    radius = float(min([TIRE * unit, *CLOSE * apart]))
    return radius, max(radius / TIRE, LEAST * unit)


class MovingVehicle:
    """The artists of a vehicle in axes that are `unit` wide [m]; compressions are drawn taller."""

    def __init__(self, ax: Axes, vehicle: VehicleShown, unit: float, taller: float) -> None:
        self.parts, self.taller = parts_of(vehicle, BODY[0] * unit), taller
        self.ax = ax
        self.radius, self.size = radius_and_size(vehicle, unit)
        carrying = {body.on for body in self.parts.bodies}
        self.tall = [BODY[1] * self.size * (CARRYING if i in carrying else 1.0)
                     for i in range(len(self.parts.bodies))]  # fmt: skip
        self._draw(ax)

    def _draw(self, ax: Axes) -> None:
        """Make the artists: those of the first of each kind have its plain name."""
        black: Any = {"color": style.BLACK}
        self.tires: list[Any] = []
        self.axles: list[Any] = []
        self.hubs: list[Any] = []
        self.springs: list[Any] = []
        hubs = FORCES if self.parts.tires.size > 1 else ("#d9d9d9",)
        share = self.radius / (TIRE * self.size)
        for i in range(self.parts.tires.size):
            tire = Circle((0, 0), self.radius, fc="#4a4a4a", ec=style.BLACK, lw=1.0, zorder=4)
            tire.set_label(_label("tire", i))
            ax.add_patch(tire)
            self.tires.append(tire)
            self.axles += ax.plot([], [], lw=2.0, zorder=5, **black)
            self.hubs += ax.plot([], [], "o", ms=8 * share, mfc=hubs[i % len(hubs)],
                                 mec=style.BLACK, zorder=5, label=_label("hub", i))  # fmt: skip
        for i in range(len(self.parts.legs)):
            self.springs += ax.plot([], [], lw=1.3, zorder=3, label=_label("spring", i), **black)
        self.bogies = {
            i: ax.plot([], [], lw=3.0, zorder=4.5, **black)[0]
            for i, leg in enumerate(self.parts.legs) if np.abs(leg.shares).max() < 1 - SHARED
        }  # fmt: skip
        self.bodies = [self._body(ax, i, body) for i, body in enumerate(self.parts.bodies)]
        look: Any = {"ms": 6, "mfc": "white", "mec": style.BLACK, "zorder": 6}
        self.hinges = [
            ax.plot([], [], "o", label="hinge", **look)[0]
            for body in self.parts.bodies if body.on is not None
        ]  # fmt: skip

    def _body(self, ax: Axes, i: int, body: DrawnBody) -> FancyBboxPatch:
        patch = FancyBboxPatch(
            (0, 0), body.rear - body.front, self.tall[i], fc=style.VERMILLION, ec=style.BLACK,
            lw=1.0, zorder=4, label=_label("body", i),
            boxstyle=f"round,pad=0,rounding_size={0.008 * self.size}",
        )  # fmt: skip
        ax.add_patch(patch)
        return patch

    def move(
        self, x: float, road: Callable[[FloatArray], FloatArray], squeeze: FloatArray,
        travel: FloatArray,
    ) -> None:  # fmt: skip
        """Put the reference tire at x [m] on the road as drawn, compressions [m] beyond static."""
        at = x - self.parts.tires
        # The tires stand on the road as drawn; from there upward, compressions add.
        hubs = road(at) + self.radius - self.taller * squeeze
        for tire, axle, hub, place, height in zip(
            self.tires, self.axles, self.hubs, at, hubs, strict=True
        ):
            tire.set_center((place, height))
            hub.set_data([place], [height])
            axle.set_data([place, place], [height, height + 0.012 * self.size])
        for i, bar in self.bogies.items():
            under = np.flatnonzero(np.abs(self.parts.legs[i].shares) > SHARED)[[0, -1]]
            bar.set_data(at[under], hubs[under])
        feet = [float(leg.shares @ hubs) for leg in self.parts.legs]
        tops = [foot + SPRING * self.size - self.taller * each
                for foot, each in zip(feet, travel, strict=True)]  # fmt: skip
        lines = self._place_bodies(x, hubs, tops)
        for leg, foot, top, spring in zip(self.parts.legs, feet, tops, self.springs, strict=True):
            end = top if leg.body is None else _height(lines[leg.body], x - leg.place)
            spring.set_data(*_coils(x - leg.place, foot, end, 0.012 * self.size))

    def _place_bodies(
        self, x: float, hubs: FloatArray, tops: list[float]
    ) -> list[tuple[float, float, float]]:
        """Move the bodies; return of each a place, the height of its floor there, and the slope."""
        lines: list[tuple[float, float, float]] = []
        lifts: list[float] = []
        hinges = iter(self.hinges)
        for i, body in enumerate(self.parts.bodies):
            under = 0.0 if body.on is None else lifts[body.on] + self.tall[body.on]
            lifts.append(under)
            legs = [
                (x - leg.place, top + under)
                for leg, top in zip(self.parts.legs, tops, strict=True) if leg.body == i
            ]  # fmt: skip
            if body.on is not None:
                front = x - body.front
                height = _height(lines[body.on], front) + self.tall[body.on]
                next(hinges).set_data([front], [height])
                line = _through(front, height, legs)
            elif legs:
                line = _fitted(legs)
            else:
                of = float(hubs.mean()) if body.tire is None else float(hubs[body.tire])
                line = x - (body.front + body.rear) / 2, of + 1.2 * self.radius, 0.0
            lines.append(line)
            patch, middle = self.bodies[i], x - (body.front + body.rear) / 2
            patch.set_x(x - body.rear)
            patch.set_y(_height(line, middle))
            shear = Affine2D.from_values(1, line[2], 0, 1, 0, -line[2] * middle)
            patch.set_transform(shear + self.ax.transData)
        return lines


def _label(name: str, i: int) -> str:
    return name if i == 0 else f"{name} {i + 1}"


def _height(line: tuple[float, float, float], place: float) -> float:
    """Height of a line at a place."""
    return line[1] + line[2] * (place - line[0])


def _through(
    place: float, height: float, points: list[tuple[float, float]]
) -> tuple[float, float, float]:
    """The line through a point that is nearest to others."""
    apart = np.array([x - place for x, _ in points])
    above = np.array([y - height for _, y in points])
    return place, height, float(apart @ above / (apart @ apart)) if apart.any() else 0.0


def _fitted(points: list[tuple[float, float]]) -> tuple[float, float, float]:
    """The line nearest to points; level through one."""
    x, y = np.array(points).T
    return _through(float(x.mean()), float(y.mean()), points)


def _coils(x: float, low: float, high: float, width: float) -> tuple[FloatArray, FloatArray]:
    """Zigzag of a spring between two heights."""
    sides = np.concatenate([[0, 0], np.tile([1.0, -1.0], COILS), [0, 0]])
    inner = np.linspace(0.2, 0.8, 2 * COILS + 2)
    heights = low + (high - low) * np.concatenate([[0.0], inner, [1.0]])
    return x + width * sides, heights
