"""The mean DAF over a road class, simulated on a few roads and their mirror images."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np

from bridgectl._checks import FloatArray
from bridgectl.dampers import simulate_loop
from bridgectl.dampers.actuator import Damper, as_damper, bare_vehicle
from bridgectl.road import iso8608_elevations
from bridgectl.surface.class_dae import ClassDae
from bridgectl.surface.histories import FeedbackHistories

if TYPE_CHECKING:
    from bridgectl.dampers import Strategy
    from bridgectl.surface.surface import RampSurface

SAME_DAF = 2e-5
"""How much the smooth DAFs of one damper may differ: closed loops are as near to fine steps."""


def calibrate(
    surface: RampSurface,
    closed: ClassDae,
    mirror_pairs: int,
    damper: Damper | Strategy | None,
    roughness: str | float,
    **spectrum: Any,
) -> ClassDae:
    """Put the simulated mean of random roads and their mirror images in place of the closed form's.

    Parameters
    ----------
    surface, closed
        The surface, and what it gives in closed form.
    mirror_pairs, damper, roughness
        See `RampSurface.class_dae`.
    spectrum
        `seed`, `waviness`, `band` and `level` of `bridgectl.road.iso8608_elevations`.
    """
    if mirror_pairs == 0:
        raise ValueError("damper goes with roads that are simulated: type mirror_pairs=25")
    if mirror_pairs == 1:
        raise ValueError("mirror_pairs must be 0 or at least 2, for a standard error: type 25")
    step = surface.ramp_length
    length = step * len(surface.positions)
    roads = iso8608_elevations(mirror_pairs, roughness, length, step, **spectrum)
    mean, error = mirror_mean(surface, roads, damper)
    return replace(closed, mean=mean, mirror_pairs=mirror_pairs, standard_error=error)


def mirror_mean(
    surface: RampSurface, roads: FloatArray, damper: Damper | Strategy | None
) -> tuple[FloatArray, FloatArray]:
    """Return the mean simulated DAF of roads and their mirror images, and its standard error.

    In a pair the odd effects of ramps cancel; the pairs are the independent samples.

    Parameters
    ----------
    surface : RampSurface
        What is crossed, and the speeds.
    roads : ndarray, shape (n_pairs, n_ramps + 1)
        Elevations at its stations [m].
    damper : Damper or Strategy, optional
        The damper that the surface was made with; needed if it is semi-active.

    Returns
    -------
    mean, standard_error : ndarray, shape (n_speeds,)

    Raises
    ------
    TypeError, ValueError
        If `damper` is missing or another than the surface's.
    """
    device = None if damper is None else as_damper(damper)
    both = np.vstack([roads, -roads])
    if isinstance(surface.histories, FeedbackHistories):
        dafs = _simulated(surface, both, _own(surface.histories.damper, device))
    else:
        _require_linear(surface, device)
        dafs = surface.superposed_daf(both)
    pairs = dafs.reshape(2, len(roads), -1).mean(axis=0)
    return pairs.mean(axis=0), pairs.std(axis=0, ddof=1) / np.sqrt(len(pairs))


def _simulated(surface: RampSurface, roads: FloatArray, damper: Damper) -> FloatArray:
    """Simulated DAFs (n_roads, n_speeds); a smooth road goes along to tell the damper by."""
    smooth, *dafs = simulate_loop(
        surface.beam, bare_vehicle(surface.vehicle), damper, surface.speeds, surface.stations,
        np.vstack([np.zeros_like(roads[:1]), roads]),
        section=surface.section, recovery=surface.recovery,
    ).daf.T  # fmt: skip
    apart = float(np.abs(smooth - surface.daf_smooth).max())
    if apart > SAME_DAF:
        raise ValueError(
            f"damper must be that of the surface, whose smooth DAF is up to {apart:.2g} from its "
            "own: type the one that ramp_surface was given, with the same bounds and options"
        )
    return np.array(dafs)


def _own(name: str, damper: Damper | None) -> Damper:
    """Return the damper of a surface that knows its name, if it is that."""
    if damper is None or damper.strategy.name != name:
        got = "none" if damper is None else repr(damper.strategy.name)
        raise ValueError(
            f"damper must be that of the surface, {name!r}, of which it holds the name alone, got "
            f"{got}: type damper=..., the one that ramp_surface was given"
        )
    return damper


def _require_linear(surface: RampSurface, damper: Damper | None) -> None:
    """Refuse a damper that is not the one of a linear surface's vehicle."""
    if damper is not None and damper.constant != getattr(surface.vehicle, "damping", None):
        raise ValueError(
            "damper must be that of the surface, whose vehicle has a linear one of its own, got "
            f"{damper.strategy.name!r}: leave damper out"
        )
