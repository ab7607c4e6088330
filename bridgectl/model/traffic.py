"""Several vehicles as one: one behind the other, in other lanes, or from the other end."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import combinations
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import block_diag

from bridgectl import _checks
from bridgectl._checks import FloatArray
from bridgectl.model.motion import Motion, as_motion
from bridgectl.model.paths import Paths
from bridgectl.model.quarter_car import QuarterCar
from bridgectl.model.vehicle import Vehicle


@dataclass(frozen=True, eq=False, init=False, repr=False)
class Traffic(Vehicle):
    """Vehicles of several lanes, ends or motions: see `convoy`, which makes it.

    Its `tire_offsets` are distances from the bridge when the first vehicle enters it.
    """

    members: NDArray[np.intp]
    distances: FloatArray
    opposite: NDArray[np.bool_]
    lanes: tuple[object, ...]
    lane_factors: FloatArray
    motions: tuple[Motion, ...]

    def __init__(
        self,
        members: NDArray[np.intp],
        distances: FloatArray,
        opposite: NDArray[np.bool_],
        lanes: tuple[object, ...],
        lane_factors: FloatArray,
        motions: tuple[Motion, ...],
        **vehicle: Any,
    ) -> None:
        own = (members, distances, opposite, lanes, lane_factors, motions)
        names = ("members", "distances", "opposite", "lanes", "lane_factors", "motions")
        for name, value in zip(names, own, strict=True):
            object.__setattr__(self, name, value)
        super().__init__(**vehicle)

    def __repr__(self) -> str:
        ends = np.where(self.opposite, "the other end", "the start").tolist()
        each = zip(self.distances, ends, self.lane_factors, strict=True)
        told = [f"{way:g} m before {end}, lane factor {factor:g}" for way, end, factor in each]
        moving = f", motions={self.motions}" if self.motions else ""
        return f"Traffic({'; '.join(told)}{moving})"

    @cached_property
    def paths(self) -> Paths:
        """Where its tires are."""
        return Paths(
            self.tire_offsets - self.distances[self.members], self.members, self.distances,
            self.opposite, self.lane_factors[self.members], self.motions,
        )  # fmt: skip

    def require_apart(self, x: FloatArray, length: float) -> None:
        """Refuse vehicles that overlap with the first at places, before all is over [m]."""
        ways = self.paths.ways(x)
        of_each = [ways[:, self.members == i] for i in range(len(self.distances))]
        for i, j in combinations(range(len(of_each)), 2):
            if self.lanes[i] != self.lanes[j]:
                continue
            a, b = of_each[i], of_each[j]
            here = (a.min(axis=1) <= length) & (b.min(axis=1) <= length)
            behind, ahead = (
                (one.max(axis=1) < other.min(axis=1))[here] for one, other in ((a, b), (b, a))
            )
            if not (behind.all() or ahead.all()):
                most = x[here][np.argmin(behind if behind[0] else ahead)]
                raise ValueError(
                    f"vehicles {i + 1} and {j + 1} overlap in their lane with the first at x = "
                    f"{most:.4g} m: type larger offsets, or other lanes, convoy(..., lanes=[...])"
                )


def paths_of(vehicle: Vehicle) -> Paths:
    """Where the tires of a vehicle are."""
    return vehicle.paths if isinstance(vehicle, Traffic) else Paths.of(vehicle.tire_offsets)


def require_row(vehicle: Vehicle | QuarterCar, what: str) -> None:
    """Refuse traffic where there is one lane alone, one way and at one speed."""
    if isinstance(vehicle, Traffic):
        raise TypeError(
            f"vehicle must be one, or a row of them in one lane, in {what}, got {vehicle!r}: leave "
            "out opposite, lane_factors and motions in convoy(...)"
        )


def convoy(
    vehicles: Sequence[Vehicle | QuarterCar],
    offsets: Sequence[float],
    *,
    opposite: Sequence[bool] = (),
    lane_factors: Sequence[float] = (),
    lanes: Sequence[object] = (),
    motions: Sequence[float | Motion] = (),
) -> Vehicle:
    """Return several vehicles as one `Vehicle`: one behind the other, overtaking or meeting.

    Parameters
    ----------
    vehicles : sequence of Vehicle or QuarterCar
        The vehicles; nothing but the bridge couples them.
    offsets : sequence of float
        Distance of each vehicle's reference tire from the bridge when the first enters it [m]:
        behind the first, or before the other end.
    opposite : sequence of bool, optional
        Which vehicles come from the other end. The road of these is the same one, read backwards:
        it must reach to where they start.
    lane_factors : sequence of float, optional
        Share, up to 1, of each vehicle's tire forces that the beam feels, and of the beam's
        deflection that its tires feel. Default: 1.
    lanes : sequence, optional
        Number or name of each vehicle's lane. Default: one for each direction and lane factor.
    motions : sequence of float or Motion, optional
        Speed [m/s] or motion of each vehicle, on its own way from where it enters the bridge. The
        `speed` of a crossing must then be the first. Default: all as fast as the first, always.

    Returns
    -------
    Vehicle
        Its coordinates are those of the vehicles with suffixes '_1', '_2', ...

    Raises
    ------
    TypeError, ValueError
        If there is no vehicle, not one value for each, an offset below 0 m, a lane factor not in
        (0, 1], or vehicles overlap in a lane: by their tires, the first to the last.

    Examples
    --------
    >>> import bridgectl as bc
    >>> beam, car = bc.li2006.beam(), bc.li2006.car()
    >>> bc.convoy([car, car], [0, 5])
    Vehicle(4 coordinates, mass=20000 kg, tires at [0, 5] m behind the first, 2 dampers)
    >>> meeting = bc.convoy([car, car], [0, 10], opposite=[False, True])
    >>> bc.daf(beam, meeting, 25.0).round(3)
    array([1.088])
    >>> overtaking = bc.convoy([car, car], [0, 10], motions=[15, 25], lane_factors=[1, 0.6])
    >>> bc.daf(beam, overtaking, 15.0).round(3)
    array([1.042])
    """
    if not isinstance(vehicles, Sequence) or not all(
        isinstance(vehicle, Vehicle | QuarterCar) for vehicle in vehicles
    ):
        raise TypeError("vehicles must be a list of Vehicle or QuarterCar: type [front, rear]")
    members = [vehicle.linear for vehicle in vehicles]
    if not members:
        raise ValueError("vehicles must hold at least one vehicle")
    if any(isinstance(member, Traffic) for member in members):
        raise TypeError("vehicles must be single ones, or rows of one lane: name them all in one")
    behind = _checks.array("offsets", offsets, (len(members),), unit="m")
    if behind.min() < 0:
        raise ValueError(
            f"offsets must be distances behind the first vehicle, 0 m or more, got {offsets}: "
            f"type {(behind - behind.min()).tolist()}, or the vehicles in the order they drive in"
        )
    traffic = _traffic(members, behind, opposite, lane_factors, lanes, motions)
    if not traffic.motions:
        traffic.require_apart(np.zeros(1), np.inf)
    paths, plain = traffic.paths, not (traffic.opposite.any() or traffic.motions)
    # Of one lane, for which any of them may be the first.
    row = plain and np.all(paths.lane_factors == 1)
    return Vehicle(**_joined(members, behind)) if row else traffic


def _traffic(
    members: list[Vehicle],
    behind: FloatArray,
    opposite: Sequence[bool],
    lane_factors: Sequence[float],
    lanes: Sequence[object],
    motions: Sequence[float | Motion],
) -> Traffic:
    """Check what `convoy` is given, and return its traffic."""
    count = len(members)

    def each(name: str, given: Sequence[Any], default: list[Any]) -> list[Any]:
        if isinstance(given, str) or not hasattr(given, "__len__"):
            raise TypeError(f"{name} must be a list, one value for each vehicle, got {given!r}")
        if len(given) not in (0, count):
            raise ValueError(
                f"{name} must hold one value for each of the {count} vehicles, got {len(given)}"
            )
        return list(given) if len(given) else default

    ends = [_checks.flag("opposite", end) for end in each("opposite", opposite, [False] * count)]
    factors = _checks.array("lane_factors", each("lane_factors", lane_factors, [1.0] * count),
                            (count,))  # fmt: skip
    if not np.all((factors > 0) & (factors <= 1)):
        raise ValueError(
            f"lane_factors must be above 0 and at most 1, got {factors.tolist()}: type the share "
            "of a tire force that the beam feels"
        )
    own = [as_motion(motion) for motion in each("motions", motions, [])]
    names = tuple(each("lanes", lanes, list(zip(ends, factors.tolist(), strict=True))))
    if (own or any(ends)) and behind[0] != 0:
        raise ValueError(
            "vehicles must begin with the one that enters the bridge first, whose offset is 0 m, "
            f"got {behind[0]:g} m"
        )
    for i, j in combinations(range(count), 2):
        if names[i] == names[j] and ends[i] != ends[j]:
            raise ValueError(f"vehicles {i + 1} and {j + 1} meet in one lane, {names[i]!r}: type "
                             "another one for those of the other direction")  # fmt: skip
    pitching = any(member.pitch_input.any() for member in members)
    if pitching and not all(motion.uniform for motion in own):
        raise ValueError(
            "motions must be of constant speed for vehicles that pitch as they brake: leave them "
            "out and give the crossing one motion, with which all brake alike"
        )
    tires = np.repeat(np.arange(count), [member.n_tires for member in members])
    return Traffic(
        tires, behind, np.array(ends), names, factors, tuple(own), **_joined(members, behind)
    )


def _joined(members: list[Vehicle], behind: FloatArray) -> dict[str, Any]:
    """What a `Vehicle` of several takes, that are so far behind the first [m]."""
    places = [car.body_places + offset for car, offset in zip(members, behind, strict=True)]
    ends = block_diag(*(car.body_map.reshape(-1, car.n_coordinates) for car in members))
    return {
        "mass_matrix": block_diag(*(car.mass_matrix for car in members)),
        "damping_matrix": block_diag(*(car.damping_matrix for car in members)),
        "stiffness_matrix": block_diag(*(car.stiffness_matrix for car in members)),
        "tire_stiffnesses": np.concatenate([car.tire_stiffnesses for car in members]),
        "tire_offsets": np.concatenate(
            [car.tire_offsets + offset for car, offset in zip(members, behind, strict=True)]
        ),
        "tire_map": block_diag(*(car.tire_map for car in members)),
        "damper_map": block_diag(*(car.damper_map for car in members)),
        "heave": np.concatenate([car.heave for car in members]),
        "body_places": np.concatenate(places),
        "body_map": ends.reshape(-1, 2, ends.shape[1]),
        "coordinates": [
            f"{name}_{i}" for i, car in enumerate(members, start=1) for name in car.coordinates
        ],
        "damper_axles": block_diag(*(car.damper_axles for car in members)),
        "damper_dampings": np.concatenate([car.damper_dampings for car in members]),
        "damper_names": [
            f"{name}_{i}" for i, car in enumerate(members, start=1) for name in car.damper_names
        ],
        "tire_damping": np.concatenate([car.tire_damping for car in members]),
        "pitch_input": np.concatenate([car.pitch_input for car in members]),
    }
