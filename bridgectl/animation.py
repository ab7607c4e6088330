"""A crossing in slow motion: simulated, and drawn as an animation."""

from __future__ import annotations

import control
import numpy as np
from matplotlib.animation import FuncAnimation

from bridgectl import _checks as check
from bridgectl.dampers.fitted import Dampers
from bridgectl.model.bridge import BridgeModel
from bridgectl.model.bridge_effects import Moment
from bridgectl.model.crossing import Crossing, require_factor
from bridgectl.model.motion import Motion
from bridgectl.model.quarter_car import QuarterCar
from bridgectl.model.traffic import require_row
from bridgectl.model.vehicle import Vehicle, signals
from bridgectl.plots.animation import BETWEEN, DrawnCrossing, draw_crossing
from bridgectl.road import RoadProfile
from bridgectl.simulate import crossing_response

RUNS_UP, ROLLS_ON = 0.16, 0.12
"""How far the vehicle is followed before and behind the bridge, in spans."""


def crossing_animation(
    beam: BridgeModel,
    vehicle: Vehicle | QuarterCar,
    speed: float,
    profile: RoadProfile | None = None,
    *,
    damper: Dampers | None = None,
    start: float = 0.0,
    effect: Moment | None = None,
    frames: int = 100,
    fps: float = 20.0,
) -> FuncAnimation:
    """Animate a crossing: the vehicle on the deflected bridge, moment and tire force below it.

    Bodies, springs, axles and tires roll over the road at x = c t, from a little before the bridge
    (or from `start`, if that is nearer) until the last axle is a little behind it. The vertical
    scale is exaggerated, by one factor for the bridge's deflection and by another for the road and
    the compression of tires and suspensions: the picture names both. Moment and tire forces build
    up below, as fractions of the peak static moment and of the static loads.

    Parameters
    ----------
    beam : Beam, Bridge or ModalBridge
        The bridge.
    vehicle : Vehicle or QuarterCar
        The vehicle; one that tells no bodies has a box at each tire.
    speed : float
        Speed c [m/s].
    profile : RoadProfile, optional
        The road, covering `start` to the end of the bridge; level beyond its end. Default: a
        smooth road.
    damper : bridgectl.dampers.Damper or Strategy, or a list or dict of them, optional
        Semi-active dampers in place of the vehicle's own: see `bridgectl.daf`.
    start : float, optional
        Where the vehicle starts, in equilibrium [m]: 0, or negative for a start on the approach.
    effect : Moment, optional
        The moment that is drawn. Default: the one halfway along the bridge.
    frames : int, optional
        Number of frames, 2 or more.
    fps : float, optional
        Frames per second [1/s]. The title tells how much slower than the crossing this is.

    Returns
    -------
    matplotlib.animation.FuncAnimation
        Save it with ``animation.save("crossing.gif", writer="pillow")``, or show it in a notebook
        with ``IPython.display.HTML(animation.to_jshtml())``.

    Raises
    ------
    TypeError, ValueError
        If an argument has the wrong kind or range, or the road does not cover the approach and
        the bridge.

    Warns
    -----
    LiftOffWarning
        If a tire leaves the road; its force is then zero.

    Examples
    --------
    >>> import tempfile
    >>> from pathlib import Path
    >>> import bridgectl as bc
    >>> animation = bc.crossing_animation(bc.li2006.beam(), bc.li2006.car(), 110 / 3.6, frames=3)
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     animation.save(Path(folder) / "crossing.gif", writer="pillow")
    ...     (Path(folder) / "crossing.gif").read_bytes()[:6]
    b'GIF89a'
    """
    if not isinstance(effect, Moment | None):
        raise TypeError(f"effect must be a Moment, got {effect!r:.60}: type bridgectl.Moment(12.5)")
    crossing = Crossing(beam, vehicle, effect or Moment())
    require_row(vehicle, "animations")
    require_factor(crossing)
    c = Motion(speed).speed
    count = check.integer("frames", frames, at_least=2)
    rate = check.positive("fps", fps)
    span = beam.length
    first = max(check.number("start", start, unit="m"), -RUNS_UP * span)
    length = float(crossing.linear.tire_offsets.max())
    x = np.linspace(first, (1 + ROLLS_ON) * span + length, BETWEEN * (count - 1) + 1)
    response = crossing_response(
        beam, vehicle, c, profile, start=start, damper=damper, tail=(ROLLS_ON + 0.01) * span / c,
        timepts=x / c, effect=crossing.effect, static=True,
    )  # fmt: skip
    return draw_crossing(_drawn(crossing, c, response, profile, start), rate)


def _drawn(
    crossing: Crossing,
    speed: float,
    response: control.TimeResponseData,
    profile: RoadProfile | None,
    start: float,
) -> DrawnCrossing:
    """Take what is drawn from the response."""
    signal = dict(zip(response.output_labels, np.asarray(response.outputs), strict=True))
    vehicle, n = crossing.linear, crossing.n_vehicle
    states = np.asarray(response.states)
    loads, stiffnesses = (
        each[:, np.newaxis] for each in (vehicle.static_loads, vehicle.tire_stiffnesses)
    )
    force = np.array([signal[name] for name in signals("tire_force", vehicle.n_tires)])
    return DrawnCrossing(
        crossing.beam,
        speed,
        profile,
        start,
        response.time * speed,
        signal["moment"],
        signal["static_moment"],
        vehicle,
        force / loads,
        (force - loads) / stiffnesses,
        vehicle.damper_map @ vehicle.displacements @ states[:n],
        states[n::2].T,
    )
