"""The picture of a crossing in slow motion: the vehicle on the bridge, moment and tire force."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
from matplotlib.animation import FuncAnimation
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from matplotlib.patches import Circle, FancyBboxPatch, Polygon

from bridgectl._checks import FloatArray
from bridgectl._units import to_kmh
from bridgectl.plots import style
from bridgectl.plots.bridge import supports_of
from bridgectl.plots.shown import BeamShown, RoadShown

BEFORE, AFTER = 0.3, 0.26
"""How much road is shown before and after the bridge, in spans."""

BETWEEN = 8
"""Points of the curves from one frame to the next."""

SIZE, LEFT, WIDTH = (8.0, 5.4), 0.1, 0.875
"""Size of the figure [in], left edge and width of its panels, as fractions of it."""

SCENE, MOMENT, FORCE = (0.545, 0.395), (0.31, 0.185), (0.095, 0.135)
"""Bottom and height of the three panels, as fractions of the figure."""

TIRE, SPRING, BODY = 0.032, 0.075, (0.15, 0.06)
"""Radius of the tire, length of the spring and size of the body, as fractions of the width."""

DEFLECTED, RIDING = 0.035, 0.035
"""About how tall deflection and road, or ride, are drawn, as fractions of the width."""

COILS, POINTS = 6, 201
"""Coils of the spring, and points of the bridge besides the road's stations: one at mid-span."""


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
    """Position of the tire; `BETWEEN` points a frame, and the last one."""
    moment: FloatArray
    """Moment over the peak static one."""
    static: FloatArray
    """Static moment over its peak."""
    force: FloatArray
    """Tire force over the static load."""
    squeeze: FloatArray
    """Tire's compression beyond the static one."""
    travel: FloatArray
    """Suspension's compression beyond the static one."""
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
        self.window = (-BEFORE * span, (1 + AFTER) * span)
        self.unit = self.window[1] - self.window[0]
        inner = np.zeros(0) if road is None else road.x
        inside = (inner > self.window[0]) & (inner < self.window[1])
        on_bridge = np.linspace(0.0, span, POINTS)
        self.x = np.unique(np.concatenate([inner[inside], on_bridge, self.window]))
        rise = np.zeros_like(self.x) if road is None else -road.drop(self.x, motion.start)
        # The road is drawn from where the bridge begins.
        self.rise = rise - np.interp(0.0, self.x, rise)
        self.on = (self.x >= 0) & (self.x <= span)
        self.shapes = motion.beam.mode_shapes(self.x)
        deflections = np.abs(motion.modes @ self.shapes[self.on].T)
        self.by_bridge = _round_factor(DEFLECTED * self.unit / float(deflections.max()))
        ride = max(float(np.abs(part).max()) for part in (self.rise, motion.squeeze, motion.travel))
        self.by_ride = _round_factor(RIDING * self.unit / max(ride, 1e-3))

        self.figure = Figure(figsize=SIZE, dpi=100)
        FigureCanvasAgg(self.figure)
        self.scene = self.figure.add_axes((LEFT, SCENE[0], WIDTH, SCENE[1]))
        self._draw_ground()
        self._draw_vehicle()
        self.moment, self.moment_now = self._panel(
            MOMENT, style.BLUE, "moment", "moment\n$M / M_0$ [-]"
        )
        self.force, self.force_now = self._panel(
            FORCE, style.VERMILLION, "tire force", "tire force\n$R / W$ [-]"
        )
        self._finish_panels()

    def name(self, slower: float) -> None:
        """Write the title, and the scales of what is drawn."""
        shown = f"{slower:.2g} times slower" if slower >= 1 else f"{1 / slower:.2g} times faster"
        kmh, places = to_kmh(self.motion.speed), [place for place, _ in self.supports]
        spans = " + ".join(f"{span:g}" for span in np.diff(places)) or f"{self.span:g}"
        self.scene.set_title(f"{kmh:.4g} km/h over a bridge of {spans} m, {shown} than it is")
        self.scene.text(
            0.995, 0.97,
            f"drawn taller: deflection of the bridge {self.by_bridge:g} times,\n"
            f"road, tire and suspension {self.by_ride:g} times",
            transform=self.scene.transAxes, ha="right", va="top", color=style.GREY, fontsize=8.5,
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
        # The tire stands on the road as drawn; from there upward, compressions add.
        x = float(m.x[i])
        axle = float(np.interp(x, self.x, road)) + TIRE * unit - self.by_ride * m.squeeze[i]
        body = axle + SPRING * unit - self.by_ride * m.travel[i]
        self.tire.set_center((x, axle))
        self.hub.set_data([x], [axle])
        self.spring.set_data(*_coils(x, axle, body, 0.012 * unit))
        self.body.set_x(x - BODY[0] * unit / 2)
        self.body.set_y(body)
        self.axle.set_data([x, x], [axle, axle + 0.012 * unit])
        past = slice(i + 1)
        self.moment.set_data(m.x[past], m.moment[past])
        self.force.set_data(m.x[past], m.force[past])
        self.moment_now.set_data([x], [m.moment[i]])
        self.force_now.set_data([x], [m.force[i]])
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

    def _draw_vehicle(self) -> None:
        """Body, spring, axle and tire, moved by `draw`."""
        ax, unit = self.scene, self.unit
        self.tire = Circle((0, 0), TIRE * unit, fc="#4a4a4a", ec=style.BLACK, lw=1.0, zorder=4)
        self.tire.set_label("tire")
        ax.add_patch(self.tire)
        (self.axle,) = ax.plot([], [], color=style.BLACK, lw=2.0, zorder=5)
        (self.hub,) = ax.plot(
            [], [], "o", ms=8, mfc="#d9d9d9", mec=style.BLACK, zorder=5, label="hub"
        )
        (self.spring,) = ax.plot([], [], color=style.BLACK, lw=1.3, zorder=3)
        self.body = FancyBboxPatch(
            (0, 0), BODY[0] * unit, BODY[1] * unit, fc=style.VERMILLION, ec=style.BLACK, lw=1.0,
            zorder=4, boxstyle=f"round,pad=0,rounding_size={0.008 * unit}", label="body",
        )  # fmt: skip
        ax.add_patch(self.body)

    def _panel(
        self, place: tuple[float, float], color: str, name: str, label: str
    ) -> tuple[Any, Any]:
        """A curve over the position of the tire, and its end."""
        ax = self.figure.add_axes((LEFT, place[0], WIDTH, place[1]), sharex=self.scene)
        ax.axvspan(0, self.span, color=style.BRIDGE_TINT, zorder=0)
        (curve,) = ax.plot([], [], color=color, lw=1.8, label=name)
        (now,) = ax.plot([], [], "o", color=color, ms=6)
        ax.set_ylabel(label)
        return curve, now

    def _finish_panels(self) -> None:
        """Static lines, limits and labels of the curves."""
        m = self.motion
        above: Axes = self.moment.axes
        below: Axes = self.force.axes
        above.plot(m.x, m.static, ":", color=style.GREY, lw=1.4, label="static")
        (self.peak,) = above.plot([], [], "o", ms=7, mfc="none", mec=style.BLACK, mew=1.2)
        self.peak_text = above.text(
            0.995, 0.95, "", transform=above.transAxes, ha="right", va="top", color=style.BLACK
        )
        above.set_ylim(min(-0.1, float(m.moment.min()) - 0.1), float(m.moment.max()) + 0.15)
        above.tick_params(labelbottom=False)
        above.legend(loc="upper left", handlelength=1.6, borderaxespad=0.2)
        below.axhline(1.0, color=style.GREY, ls=":", lw=1.4)
        reach = max(0.1, 1.15 * float(np.abs(m.force - 1).max()))
        below.set(ylim=(1 - reach, 1 + reach), xlabel=f"tire at {style.STATION_LABEL}")
        self.figure.align_ylabels([above, below])


def _band(x: FloatArray, above: FloatArray, below: FloatArray) -> FloatArray:
    """Outline of what lies between two lines, shape (2 m, 2)."""
    return np.column_stack([np.append(x, x[::-1]), np.append(above, below[::-1])])


def _coils(x: float, low: float, high: float, width: float) -> tuple[FloatArray, FloatArray]:
    """Zigzag of a spring between two heights."""
    sides = np.concatenate([[0, 0], np.tile([1.0, -1.0], COILS), [0, 0]])
    inner = np.linspace(0.2, 0.8, 2 * COILS + 2)
    heights = low + (high - low) * np.concatenate([[0.0], inner, [1.0]])
    return x + width * sides, heights


def _round_factor(value: float) -> float:
    """The largest of 1, 2, 5, 10, 20, ... that is not above a value of 1 or more."""
    if value < 1:
        return 1.0
    power = 10.0 ** np.floor(np.log10(value))
    return float(max(step for step in (1, 2, 5) if step * power <= value) * power)
