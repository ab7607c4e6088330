"""Trucks of weighed axle loads: bodies, hinge and springs that carry just these.

Axles closer than 2.5 m are a group. Trucks of one or two groups are rigid; of more, the first two
carry a tractor, and the others a semi-trailer that rests on its hinge. The rest is statics:

* An axle weighs what is drawn, but at most half of what it carries.
* The centre of gravity of a rigid truck or a trailer is where the loads ask for it. A tractor's
  mass is drawn (at most 80 % of what its springs carry) and the hinge is over its rear group,
  with its centre of gravity where the loads ask for it; if that is outside the front half, it is
  at the end of it, and the hinge where the loads ask for it.
* More axles under a body than two would share its weight by their springs. Spring and tires of an
  axle are times one factor each, by which all axles of a body sag to one straight line, through
  what the front and the rear group (or the hinge and all axles of the trailer) sag as drawn. If
  that is too steep for one of them, the body is level.
"""

from __future__ import annotations

import os
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from bridgectl import _checks
from bridgectl._checks import FloatArray
from bridgectl._toml import parsed, require_keys, require_known
from bridgectl.fleet.distributions import Distribution, positive
from bridgectl.model.trucks import Axle, Body, articulated, rigid
from bridgectl.model.vehicle import GRAVITY, Vehicle

DATA = Path(__file__).parent / "data"

APART = 2.5
"""Axles of different groups are so far apart [m]."""

HEAVIEST_AXLE, HEAVIEST_TRACTOR = 0.5, 0.8
"""Largest shares of an axle in its load, and of a tractor in what its springs carry."""

FOREMOST, REARMOST = 0.1, 0.5
"""Between these shares of a tractor's length is its centre of gravity, from the first axle on."""

LEAST_SAG = 0.25
"""Bodies do not slope so that an axle sags less than this share of the others."""

PLACES = ("steer", "drive", "trailer")
OF_AXLE = ("mass", "suspension_stiffness", "tire_stiffness", "damping", "tire_damping")
OF_BODIES = (
    "tractor_mass", "hinge", "rigid_gyration", "tractor_gyration", "trailer_gyration",
)  # fmt: skip
LOOKS = {
    **{place: f"[{place}], and mass = 600 and so on below" for place in PLACES},
    "bodies": "[bodies], and tractor_mass = 3300 and so on below", "mass": "mass = 600",
    "suspension_stiffness": "suspension_stiffness = 1e6", "tire_stiffness": "tire_stiffness = 2e6",
    "damping": "damping = 10e3", "tractor_mass": "tractor_mass = 3300", "hinge": "hinge = 0.889",
    **dict.fromkeys(OF_BODIES[2:], "0.28, a share of the length"),
}  # fmt: skip


@dataclass(frozen=True)
class Unweighed:
    """What a weigh-in-motion station does not tell, by table and key."""

    numbers: Mapping[tuple[str, str], Distribution]

    def drawn(self, uniforms: Sequence[float]) -> dict[tuple[str, str], float]:
        """One number of each."""
        return {
            key: each.ppf(u) for (key, each), u in zip(self.numbers.items(), uniforms, strict=True)
        }


def read_unweighed(name: str | os.PathLike[str] | None) -> Unweighed:
    """Read what is not weighed from a TOML file, by default from the one that ships."""
    path = DATA / "axles.toml" if name is None else Path(_checks.path("axles", name, "axles.toml"))
    try:
        content = parsed(path, "table of axles", LOOKS["mass"], "none, for what ships")
        return Unweighed(_numbers(content))
    except (TypeError, ValueError) as error:
        raise ValueError(f"{path}: {error}") from None


def _numbers(content: Mapping[str, Any]) -> dict[tuple[str, str], Distribution]:
    require_known("", content, ("description", "source", *PLACES, "bodies"))
    require_keys("", content, (*PLACES, "bodies"), LOOKS)
    found: dict[tuple[str, str], Distribution] = {}
    for table in (*PLACES, "bodies"):
        keys, needed = (OF_BODIES, OF_BODIES) if table == "bodies" else (OF_AXLE, OF_AXLE[:3])
        if not isinstance(content[table], Mapping):
            raise TypeError(f"{table} must be a table: type {LOOKS[table]}")
        require_known(table, content[table], keys)
        require_keys(table, content[table], needed, LOOKS)
        for key, given in content[table].items():
            if not (key in OF_AXLE[3:] and given == 0):
                found[table, key] = positive(f"{table}.{key}", given)
    return found


def groups_of(spacings: Sequence[float]) -> list[list[int]]:
    """Axles, counted from 0, by their groups."""
    groups = [[0]]
    for i, spacing in enumerate(spacings, start=1):
        if spacing < APART:
            groups[-1].append(i)
        else:
            groups.append([i])
    return groups


def kind_of(spacings: Sequence[float]) -> str:
    """Numbers of axles of the groups, as '1+1+3'."""
    return "+".join(str(len(group)) for group in groups_of(spacings))


def truck(
    loads: FloatArray, spacings: FloatArray, numbers: Mapping[tuple[str, str], float]
) -> Vehicle:
    """Return a truck of axle loads [N] and spacings [m], and of what is not weighed."""
    row = _Weighed(loads, spacings, numbers)
    return _rigid(row) if row.n == len(loads) else _articulated(row)


class _Weighed:
    """What the statics of one truck needs, by axle; places count from the first one [m]."""

    def __init__(
        self, loads: FloatArray, spacings: FloatArray, numbers: Mapping[tuple[str, str], float]
    ) -> None:
        groups = groups_of(spacings.tolist())
        self.n = sum(map(len, groups[:2]))
        """How many axles the rigid truck or the tractor has."""
        self.numbers = numbers
        steering = len(groups[0]) if len(groups) > 1 else 1
        self.where = ["steer"] * steering + ["drive"] * (self.n - steering)
        self.where += ["trailer"] * (len(loads) - self.n)
        self.places = np.concatenate([[0.0], np.cumsum(spacings)])
        self.mass = np.minimum(self.of_axles("mass"), HEAVIEST_AXLE * loads / GRAVITY)
        self.sprung = loads - self.mass * GRAVITY
        self.spring, self.tire = map(self.of_axles, OF_AXLE[1:3])
        self.sag = self.sprung / self.spring + loads / self.tire
        self.ends = (slice(0, steering), slice(steering, self.n))
        """The first and the last group of the rigid truck or the tractor."""

    def of_axles(self, key: str) -> FloatArray:
        """A number of each axle by where it is."""
        return np.array([self.numbers.get((place, key), 0.0) for place in self.where])

    def middle(self, values: FloatArray) -> tuple[float, float]:
        """Means over the first and the last group."""
        front, rear = (float(values[end].mean()) for end in self.ends)
        return front, rear

    def axles(self, span: slice, line: FloatArray) -> list[Axle]:
        """Axles whose springs and tires sag to a line [m]."""
        factor = self.sag[span] / line
        columns = (
            self.places[span], self.mass[span], self.spring[span] * factor,
            self.tire[span] * factor, self.of_axles("damping")[span],
            self.of_axles("tire_damping")[span],
        )  # fmt: skip
        return [Axle(*each) for each in zip(*(c.tolist() for c in columns), strict=True)]


def _rigid(row: _Weighed) -> Vehicle:
    front, rear = row.middle(row.places)
    line = _line((front, rear), row.middle(row.sag), row.places)
    weight = float(row.sprung.sum())
    radius = row.numbers["bodies", "rigid_gyration"] * (rear - front)
    centre = float(row.sprung @ row.places) / weight
    body = Body(
        weight / GRAVITY, weight / GRAVITY * radius**2, row.axles(slice(None), line), centre
    )
    return rigid(body)


def _articulated(row: _Weighed) -> Vehicle:
    front, behind = slice(0, row.n), slice(row.n, None)
    ends, of = row.middle(row.places), row.numbers
    length = ends[1] - ends[0]
    weight, centre, hinge = _balanced(row, ends)
    here, there = row.places[front], row.places[behind]
    *line, at_hinge = _line(ends, row.middle(row.sag), np.append(here, hinge)).tolist()
    radius = of["bodies", "tractor_gyration"] * length
    tractor = Body(
        weight / GRAVITY, weight / GRAVITY * radius**2, row.axles(front, np.array(line)), centre
    )
    hung = float(row.sprung[front].sum()) - weight
    carried = hung + float(row.sprung[behind].sum())
    centre = (hung * hinge + float(row.sprung[behind] @ there)) / carried
    radius = of["bodies", "trailer_gyration"] * (float(there[-1]) - hinge)
    line = _line((hinge, float(there.mean())), (at_hinge, float(row.sag[behind].mean())), there)
    trailer = Body(
        carried / GRAVITY, carried / GRAVITY * radius**2, row.axles(behind, line), centre
    )
    return articulated(tractor, trailer, (hinge, hinge))  # both count from the first axle


def _balanced(row: _Weighed, ends: tuple[float, float]) -> tuple[float, float, float]:
    """Weight of the tractor's body [N], its centre of gravity and the hinge [m]."""
    places, sprung = row.places[: row.n], row.sprung[: row.n]
    carried, moment = float(sprung.sum()), float(sprung @ places)
    weight = min(row.numbers["bodies", "tractor_mass"] * GRAVITY, HEAVIEST_TRACTOR * carried)
    hung, length = carried - weight, ends[1] - ends[0]
    hinge = ends[0] + row.numbers["bodies", "hinge"] * length
    asked = (moment - hung * hinge) / weight
    centre = min(max(asked, ends[0] + FOREMOST * length), ends[0] + REARMOST * length)
    if centre != asked:
        hinge = (moment - weight * centre) / hung
        between = float(row.places[row.n - 1] + row.places[row.n]) / 2
        hinge = min(max(hinge, ends[0] + FOREMOST * length), between)
        centre = (moment - hung * hinge) / weight
    return weight, centre, hinge


def _line(ends: tuple[float, float], sags: tuple[float, float], places: FloatArray) -> FloatArray:
    """A straight line through two points [m], or a level one where that comes near the axles."""
    slope = (sags[1] - sags[0]) / (ends[1] - ends[0])
    line = sags[0] + slope * (places - ends[0])
    return line if line.min() >= LEAST_SAG * min(sags) else np.full(places.size, sags[0])
