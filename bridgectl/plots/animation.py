"""The picture of a crossing in slow motion: the vehicle on the bridge, moment and tire force."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
from matplotlib.animation import FuncAnimation
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from matplotlib.patches import Polygon

from bridgectl._checks import FloatArray
from bridgectl._units import to_kmh
from bridgectl.plots import style
from bridgectl.plots.bridge import supports_of
from bridgectl.plots.moving_vehicle import FORCES, MovingVehicle, radius_and_size
from bridgectl.plots.shown import BeamShown, RoadShown, VehicleShown

BEFORE, AFTER = 0.3, 0.26
"""How much road is shown before and after the bridge, in spans."""

BETWEEN = 8
"""Points of the curves from one frame to the next."""

SIZE, LEFT, WIDTH = (8.0, 5.4), 0.1, 0.875
"""Size of the figure [in], left edge and width of its panels, as fractions of it."""

SCENE, MOMENT, FORCE = (0.545, 0.375), (0.31, 0.185), (0.095, 0.135)
"""Bottom and height of the three panels, as fractions of the figure."""

DEFLECTED, RIDING = 0.035, 0.035
"""About how tall deflection and road, or ride, are drawn, as fractions of the width."""

POINTS = 201
"""Points of the bridge besides the road's stations: one at mid-span."""


class DrawnCrossing(NamedTuple):
    """What is drawn, at every point of the curves [SI units]; displacements are downward."""

    beam: BeamShown
    """The bridge."""
    speed: float
    """Speed of the vehicle."""
    road: RoadShown | None
    """The road, None for a smooth one."""
    start: float
    """Where the vehicle starts on it."""
    x: FloatArray
    """Position of the reference tire; `BETWEEN` points a frame, and the last one."""
    moment: FloatArray
    """Moment over the peak static one."""
    static: FloatArray
    """Static moment over its peak."""
    vehicle: VehicleShown
    """The vehicle."""
    force: FloatArray
    """Tire forces over their static loads, shape (n_tires, m)."""
    squeeze: FloatArray
    """Compression of each tire beyond the static one, likewise."""
    travel: FloatArray
    """Compression of each suspension beyond the static one, shape (n_dampers, m)."""
    modes: FloatArray
    """Modal deflections of the beam, shape (m, n_modes)."""


@style.styled
def draw_crossing(motion: DrawnCrossing, fps: float) -> FuncAnimation:
    """Draw what `bridgectl.animation.crossing_animation` simulated, at some frames per second."""
    scene, x = _Scene(motion), motion.x
    frames = (x.size - 1) // BETWEEN + 1
    scene.name(frames / fps / ((x[-1] - x[0]) / motion.speed))
    return FuncAnimation(
        scene.figure, scene.draw, frames=frames, interval=1000 / fps, repeat=True, blit=False
    )


class _Scene:
    """The figure, and what moves in it."""

    def __init__(self, motion: DrawnCrossing) -> None:
        self.motion, self.span, road = motion, motion.beam.length, motion.road
        self.supports = list(supports_of(motion.beam))
        span = self.span
        # Of a long vehicle half is out of the picture where it starts and where it ends.
        half = float(motion.vehicle.tire_offsets.max()) / 2
        self.window = (-BEFORE * span - half, (1 + AFTER) * span + half)
        self.unit = self.window[1] - self.window[0]
        inner = np.zeros(0) if road is None else road.x
        reach = self.window[0] - half, self.window[1] + half
        inside = (inner > reach[0]) & (inner < reach[1])
        on_bridge = np.linspace(0.0, span, POINTS)
        self.x = np.unique(np.concatenate([inner[inside], on_bridge, reach]))
        rise = np.zeros_like(self.x) if road is None else -road.drop(self.x, motion.start)
        # The road is drawn from where the bridge begins.
        self.rise = rise - np.interp(0.0, self.x, rise)
        self.on = (self.x >= 0) & (self.x <= span)
        self.shapes = motion.beam.mode_shapes(self.x)
        deflections = np.abs(motion.modes @ self.shapes[self.on].T)
        self.by_bridge = _round_factor(DEFLECTED * self.unit / float(deflections.max()))
        _, size = radius_and_size(motion.vehicle, self.unit)
        rides = self.rise, motion.squeeze, motion.travel
        ride = max(float(np.abs(part).max()) for part in rides if part.size)
        self.by_ride = _round_factor(RIDING * size / max(ride, 1e-3))

        self.figure = Figure(figsize=SIZE, dpi=100)
        FigureCanvasAgg(self.figure)
        self.scene = self.figure.add_axes((LEFT, SCENE[0], WIDTH, SCENE[1]))
        self._draw_ground()
        self.vehicle = MovingVehicle(self.scene, motion.vehicle, self.unit, self.by_ride)
        above, below = (self._panel(place) for place in (MOMENT, FORCE))
        above.set_ylabel("moment\n$M / M_0$ [-]")
        below.set_ylabel("tire force\n$R / W$ [-]")
        self.curves = [(motion.moment, *_curve(above, style.BLUE, "moment"))]
        for i, force in enumerate(motion.force):
            name = "tire force" if i == 0 else f"tire force {i + 1}"
            self.curves.append((force, *_curve(below, FORCES[i % len(FORCES)], name)))
        self._finish_panels()

    def name(self, slower: float) -> None:
        """Write the title, and the scales of what is drawn."""
        shown = f"{slower:.2g} times slower" if slower >= 1 else f"{1 / slower:.2g} times faster"
        kmh, places = to_kmh(self.motion.speed), [place for place, _ in self.supports]
        spans = " + ".join(f"{span:g}" for span in np.diff(places)) or f"{self.span:g}"
        title = f"{kmh:.4g} km/h over a bridge of {spans} m, {shown} than it is"
        self.scene.set_title(title, pad=18)
        self.scene.text(
            0.0, 1.015,
            f"drawn taller: deflection of the bridge {self.by_bridge:g} times, "
            f"road, tire and suspension {self.by_ride:g} times",
            transform=self.scene.transAxes, color=style.GREY, fontsize=8.5,
        )  # fmt: skip

    def draw(self, frame: int) -> list[Any]:
        """Move everything to a frame."""
        i, m, unit = BETWEEN * frame, self.motion, self.unit
        sag = -self.by_bridge * (self.shapes @ m.modes[i])
        deck, road = sag[self.on], sag + self.by_ride * self.rise
        along = self.x[self.on]
        top = deck + self.under
        self.deck.set_xy(_band(along, top, top - 0.014 * unit))
        self.pavement.set_xy(_band(along, road[self.on], top))
        self.road.set_data(self.x, road)
        x, past = float(m.x[i]), slice(i + 1)
        self.vehicle.move(
            x, lambda at: np.interp(at, self.x, road), m.squeeze[:, i], m.travel[:, i]
        )
        for values, curve, now in self.curves:
            curve.set_data(m.x[past], values[past])
            now.set_data([x], [values[i]])
        peak = int(m.moment[past].argmax())
        self.peak.set_data([m.x[peak]], [m.moment[peak]])
        self.peak_text.set_text(f"largest so far: {m.moment[peak]:.3f}")
        return []

    def _draw_ground(self) -> None:
        """Ground, bridge and road; the bridge is moved by `draw`."""
        ax, unit, span = self.scene, self.unit, self.span
        heights = self.by_ride * self.rise
        self.under = min(0.0, float(heights[self.on].min())) - 0.006 * unit
        low = min(-0.1 * unit, self.under - 0.065 * unit)
        ratio = SIZE[1] * SCENE[1] / (SIZE[0] * WIDTH)
        # One metre is as tall as it is long.
        ax.set(xlim=self.window, ylim=(low, low + ratio * unit), yticks=[])
        ax.axvspan(0, span, color=style.BRIDGE_TINT, zorder=0)
        for side in (self.x <= 0, self.x >= span):
            ax.fill_between(self.x[side], heights[side], low, color=style.GROUND, lw=0)
        foot = self.under - 0.014 * unit
        for place, marker in self.supports:
            look: Any = {"marker": marker, "ms": 11, "color": style.DECK, "clip_on": False}
            ax.plot([place], [foot], ls="none", **look)
        self.deck = Polygon(np.zeros((3, 2)), color=style.DECK, lw=0, zorder=1.5)
        self.pavement = Polygon(np.zeros((3, 2)), color=style.PAVEMENT, lw=0, zorder=1.4)
        for part in (self.deck, self.pavement):
            ax.add_patch(part)
        (self.road,) = ax.plot([], [], color=style.BLACK, lw=1.2, label="road")
        ax.grid(False)
        ax.spines["left"].set_visible(False)
        ax.tick_params(labelbottom=False)

    def _panel(self, place: tuple[float, float]) -> Axes:
        """Axes of curves over the position of the reference tire."""
        ax = self.figure.add_axes((LEFT, place[0], WIDTH, place[1]), sharex=self.scene)
        ax.axvspan(0, self.span, color=style.BRIDGE_TINT, zorder=0)
        return ax

    def _finish_panels(self) -> None:
        """Static lines, limits and labels of the curves."""
        m = self.motion
        above, below = self.figure.axes[1:]
        above.plot(m.x, m.static, ":", color=style.GREY, lw=1.4, label="static")
        (self.peak,) = above.plot([], [], "o", ms=7, mfc="none", mec=style.BLACK, mew=1.2)
        self.peak_text = above.text(
            0.995, 0.95, "", transform=above.transAxes, ha="right", va="top", color=style.BLACK
        )
        room = 0.15 if len(m.force) == 1 else 0.4  # for the text, under which the peak may be
        above.set_ylim(min(-0.1, float(m.moment.min()) - 0.1), float(m.moment.max()) + room)
        above.tick_params(labelbottom=False)
        above.legend(loc="upper left", handlelength=1.6, borderaxespad=0.2)
        below.axhline(1.0, color=style.GREY, ls=":", lw=1.4)
        reach = max(0.1, 1.15 * float(np.abs(m.force - 1).max()))
        tire = "tire" if len(m.force) == 1 else "first tire"
        below.set(ylim=(1 - reach, 1 + reach), xlabel=f"{tire} at {style.STATION_LABEL}")
        self.figure.align_ylabels([above, below])


def _band(x: FloatArray, above: FloatArray, below: FloatArray) -> FloatArray:
    """Outline of what lies between two lines, shape (2 m, 2)."""
    return np.column_stack([np.append(x, x[::-1]), np.append(above, below[::-1])])


def _curve(ax: Axes, color: str, name: str) -> tuple[Any, Any]:
    """A curve that grows, and its end."""
    (curve,) = ax.plot([], [], color=color, lw=1.8, label=name)
    (now,) = ax.plot([], [], "o", color=color, ms=6)
    return curve, now


def _round_factor(value: float) -> float:
    """The largest of 1, 2, 5, 10, 20, ... that is not above a value of 1 or more."""
    if value < 1:
        return 1.0
    power = 10.0 ** np.floor(np.log10(value))
    return float(max(step for step in (1, 2, 5) if step * power <= value) * power)
