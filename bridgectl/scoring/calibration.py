"""The mean DAF over a road class, simulated on a few roads and their mirror images."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np

from bridgectl import _checks
from bridgectl._checks import FloatArray
from bridgectl.dampers import simulate_loop
from bridgectl.dampers.fitted import Dampers, Fitted, fitted
from bridgectl.road import iso8608_elevations
from bridgectl.road.iso8608 import Seed
from bridgectl.road.spectrum import DEFAULT_BAND
from bridgectl.surface.class_dae import ClassDae
from bridgectl.surface.histories import FeedbackHistories

if TYPE_CHECKING:
    from bridgectl.surface.surface import RampSurface

SAME_DAF = 2e-5
"""How much the smooth DAFs of one damper may differ: closed loops are as near to fine steps."""


def calibrated_class_dae(
    surface: RampSurface,
    roughness: str | float,
    mirror_pairs: int = 25,
    *,
    waviness: float = 2.0,
    band: tuple[float, float] = DEFAULT_BAND,
    level: str = "mean",
    seed: Seed = 0,
    damper: Dampers | None = None,
) -> ClassDae:
    """Put a simulated mean of random roads and their mirror images in place of the class DAE's.

    The mean then is not DAE's but that of simulated DAFs, and so is any ranking by it. With odd
    effects about it single roads are estimated better:
    ``calibrated.mean + surface.ramps(roads) @ surface.odd_effect.T``.

    Parameters
    ----------
    surface : RampSurface
        The surface.
    roughness, waviness, band, level
        See `bridgectl.iso8608_profile`.
    mirror_pairs : int, optional
        Number of random roads to simulate, each with its mirror image.
    seed : int or numpy.random.Generator, optional
        Of these roads: the same seed gives the same numbers.
    damper : bridgectl.dampers.Damper or Strategy, optional
        The semi-active damper that the surface was made with, to simulate.

    Returns
    -------
    ClassDae
        Its `sd` is in closed form, as ever.

    Raises
    ------
    TypeError, ValueError
        As `RampSurface.class_dae`; if there are fewer than two pairs, or `damper` is not that of
        the surface.

    Warns
    -----
    LiftOffWarning
        As `RampSurface.superposed_daf`, of roads that are simulated.
    UserWarning
        If it takes minutes.

    Examples
    --------
    >>> import bridgectl as bc
    >>> beam, car = bc.li2006.beam(), bc.li2006.car()
    >>> hook = bc.dampers.bridgehook(beam, car, 1e3, 30e3)
    >>> surface = bc.ramp_surface(
    ...     beam, car, 30.0, approach=20, ramp_height="A", both_ways=True, every=10, damper=hook)
    >>> found = bc.calibrated_class_dae(surface, "A", damper=hook)
    >>> print(f"{found.mean[0]:.2f}, standard error {found.standard_error[0]:.3f}")
    1.08, standard error 0.002
    """
    spectrum: Any = {"waviness": waviness, "band": band, "level": level}
    closed = surface.class_dae(roughness, **spectrum)
    count = _checks.integer("mirror_pairs", mirror_pairs, at_least=2)  # for a standard error
    step = surface.ramp_length
    length = step * len(surface.positions)
    roads = iso8608_elevations(count, roughness, length, step, seed=seed, **spectrum)
    mean, error = _mirror_mean(surface, roads, damper)
    return replace(closed, mean=mean, mirror_pairs=count, standard_error=error)


def _mirror_mean(
    surface: RampSurface, roads: FloatArray, damper: Dampers | None
) -> tuple[FloatArray, FloatArray]:
    """Return the mean simulated DAF of roads and their mirror images, and its standard error.

    In a pair the odd effects of ramps cancel; the pairs are the independent samples. The roads are
    elevations [m], shape (n_pairs, n_ramps + 1); a damper must be the surface's own.
    """
    device = None if damper is None else fitted(damper, surface.vehicle)
    both = np.vstack([roads, -roads])
    if isinstance(surface.histories, FeedbackHistories):
        dafs = _simulated(surface, both, _own(surface.histories.damper, device))
    else:
        _require_linear(surface, device)
        dafs = surface.superposed_daf(both)
    pairs = dafs.reshape(2, len(roads), -1).mean(axis=0)
    return pairs.mean(axis=0), pairs.std(axis=0, ddof=1) / np.sqrt(len(pairs))


def _simulated(surface: RampSurface, roads: FloatArray, damper: Fitted) -> FloatArray:
    """Simulated DAFs (n_roads, n_speeds); a smooth road goes along to tell the damper by."""
    smooth, *dafs = simulate_loop(
        surface.beam, surface.vehicle, damper, surface.speeds, surface.stations,
        np.vstack([np.zeros_like(roads[:1]), roads]),
        effect=surface.effect,
    ).daf.T  # fmt: skip
    apart = float(np.abs(smooth - surface.daf_smooth).max())
    if apart > SAME_DAF:
        raise ValueError(
            f"damper must be that of the surface, whose smooth DAF is up to {apart:.2g} from its "
            "own: type the one that ramp_surface was given, with the same bounds and options"
        )
    return np.array(dafs)


def _own(name: str, damper: Fitted | None) -> Fitted:
    """Return the damper of a surface that knows its name, if it is that."""
    if damper is None or damper.name != name:
        got = "none" if damper is None else repr(damper.name)
        raise ValueError(
            f"damper must be that of the surface, {name!r}, of which it holds the name alone, got "
            f"{got}: type damper=..., the one that ramp_surface was given"
        )
    return damper


def _require_linear(surface: RampSurface, damper: Fitted | None) -> None:
    """Refuse dampers that are not those of a linear surface's vehicle."""
    own = surface.vehicle.linear.damper_dampings
    if damper is not None and not np.all(damper.constant == own):
        raise ValueError(
            "damper must be that of the surface, whose vehicle has a linear one of its own, got "
            f"{damper.name!r}: leave damper out"
        )
