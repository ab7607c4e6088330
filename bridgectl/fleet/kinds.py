"""Kinds of trucks in a fleet: what all of a kind share, and what is drawn for each truck.

Keys of a fleet's file (``bridgectl/fleet/data/monte_carlo.toml``)::

    description, source     what it is, and where its numbers come from
    speed                   of all kinds [m/s], a number or a distribution
    [[kinds]]               one of each kind of truck:
      name, share           shares have any sum
      speed                 takes the place of that of all
      truck                 a truck of the catalog or a file, as "T5", and if they are given
      load, suspension, tires, damping      factors, as those of `bridgectl.Fleet`
      [kinds.parameters]    or else numbers or distributions by names of one's own, and
      hinge, [[kinds.bodies]], ...          the keys of a truck's file, with such a name, as
                            mass = "trailer", in place of any number

Distributions are as in ``bridgectl/fleet/distributions.py``. Two places with the name of one
parameter have the same number in one truck.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import accumulate
from pathlib import Path
from typing import Any, NamedTuple

from bridgectl import _checks
from bridgectl._toml import parsed, require_keys, require_known
from bridgectl.fleet.distributions import Distribution, distribution, positive
from bridgectl.fleet.weighed import DATA
from bridgectl.model.trucks.file import LOOKS as OF_TRUCKS
from bridgectl.model.trucks.file import OF_WHEEL, truck_of, truck_path
from bridgectl.model.vehicle import Vehicle

FACTORS = ("load", "suspension", "tires", "damping")
WORDS = ("name", "description", "source")
"""Keys of a truck whose values are no numbers."""

OF_KIND = ("name", "share", "speed", "parameters", "truck", *FACTORS, "bodies", "hinge", *OF_WHEEL)
LOOKS = {
    **OF_TRUCKS, "kinds": "[[kinds]], and its keys below", "share": "share = 0.3",
    "name": 'name = "five axles"', "speed": "speed = { mean = 22, sd = 2, min = 15, max = 28 }",
}  # fmt: skip


class Factor(NamedTuple):
    """A number of a truck that is drawn: a parameter, times what the truck has."""

    parameter: str
    value: float = 1.0


@dataclass(frozen=True)
class Kind:
    """A kind of truck."""

    name: str
    share: float
    """Of all trucks, in whatever unit the shares of all kinds have."""
    speed: Distribution
    """[m/s]"""
    parameters: Mapping[str, Distribution]
    content: Mapping[str, Any]
    """Of a truck's file, with factors in place of numbers."""

    def drawn(self, uniforms: Sequence[float]) -> tuple[Vehicle, float]:
        """A truck and its speed [m/s] of uniform numbers: the speed's, then one a parameter."""
        numbers = {
            name: each.ppf(u)
            for (name, each), u in zip(self.parameters.items(), uniforms[1:], strict=False)
        }
        return truck_of(_filled(self.content, numbers)).linear, self.speed.ppf(uniforms[0])

    @property
    def usual(self) -> Vehicle:
        """The truck of medians."""
        return self.drawn([0.5] * (1 + len(self.parameters)))[0]


def shares(kinds: Sequence[Kind]) -> list[float]:
    """Share of each kind with all before it, the last 1."""
    sums = list(accumulate(kind.share for kind in kinds))
    return [each / sums[-1] for each in sums]


def shipped() -> list[str]:
    """Return the names of the fleets that ship."""
    return sorted(path.stem for path in DATA.glob("*.toml") if path.stem != "axles")


def fleet_path(name: Any) -> Path:
    """Return the file of a fleet that ships, or that of a name that ends in .toml."""
    text = _checks.path("name", name, "monte_carlo")
    if text.lower().endswith(".toml"):
        return Path(text)
    if text in shipped():
        return DATA / f"{text}.toml"
    raise ValueError(
        f"there is no fleet {text!r}: type {' or '.join(shipped())}, or the name of a file "
        "that ends in .toml"
    )


def kinds_of(content: Mapping[str, Any], speed: Any = None) -> tuple[Kind, ...]:
    """Return the kinds of a file; a speed that is given takes the place of all in it."""
    require_known("", content, ("description", "source", "speed", "kinds"))
    require_keys("", content, ("kinds",), LOOKS)
    tables = content["kinds"]
    if not (isinstance(tables, list) and tables and all(isinstance(t, dict) for t in tables)):
        raise TypeError("kinds must be tables: type [[kinds]], and their keys below")
    made = []
    for i, table in enumerate(tables):
        found = speed if speed is not None else table.get("speed", content.get("speed"))
        made.append(_kind(f"kinds[{i}]", table, found))
    names = [kind.name for kind in made]
    for name in names:
        if names.count(name) > 1:
            raise ValueError(f"kinds must have different names, got {name!r} twice: rename one")
    return tuple(made)


def _kind(where: str, table: Mapping[str, Any], speed: Any) -> Kind:
    require_known(where, table, OF_KIND)
    require_keys(where, table, ("name", "share"), LOOKS)
    if speed is None:
        raise ValueError(f"{where} lacks speed [m/s], and so does the fleet: type {LOOKS['speed']}")
    given = table.get("parameters", {})
    if not isinstance(given, Mapping):
        raise TypeError(f"{where}.parameters must be a table: type [kinds.parameters]")
    parameters = {key: distribution(f"{where}.{key}", value) for key, value in given.items()}
    of_truck = "truck" in table
    keys = {"bodies", "hinge", *OF_WHEEL} - ({*FACTORS} if of_truck else set())
    own = {key: value for key, value in table.items() if key in keys}
    if of_truck:
        if own or parameters:
            raise ValueError(
                f"{where} has a truck, and {next(iter(own or parameters))!r} too: leave out one"
            )
        content = _varied(_read(table["truck"]))
        parameters = {key: positive(f"{where}.{key}", table.get(key, 1.0)) for key in FACTORS}
    else:
        content = _referring(where, own, parameters)
        for key in FACTORS:
            if key in table and key not in OF_WHEEL:
                raise ValueError(f'{where} has {key!r}, which needs truck: type truck = "T5"')
        unused = set(parameters) - {factor.parameter for factor in _factors(content)}
        if unused:
            name = min(unused)
            raise ValueError(f'{where}.{name} is used nowhere: type mass = "{name}", or remove it')
    kind = Kind(
        str(table["name"]), _checks.positive(f"{where}.share", table["share"]),
        positive(f"{where}.speed" if "speed" in table else "speed", speed, "m/s"),
        parameters, content,
    )  # fmt: skip
    try:
        _ = kind.usual
    except (TypeError, ValueError) as error:
        raise ValueError(f"{where}: of the truck of medians: {error}") from None
    return kind


def _read(name: Any) -> dict[str, Any]:
    path = truck_path(name)
    try:
        content = parsed(path, "truck", LOOKS["place"], "a name of the catalog, as T5air")
        truck_of(content)
    except (TypeError, ValueError) as error:
        raise ValueError(f"{path}: {error}") from None
    return content


def _varied(content: dict[str, Any]) -> dict[str, Any]:
    """Content of a truck in which springs, tires, dampers and load are times factors."""
    of = {"suspension_stiffness": "suspension", "damping": "damping", "tire_stiffness": "tires"}
    varied: dict[str, Any] = _times(content, {**of, "sprung_mass": "load"})
    if "bodies" in content:
        last = varied["bodies"][-1]
        for part in (last, *last.get("loads", ())):
            part |= _times({k: part[k] for k in ("mass", "inertia") if k in part}, _OF_BODY)
    return varied


_OF_BODY = {"mass": "load", "inertia": "load"}


def _times(part: Any, factors: Mapping[str, str], key: str = "") -> Any:
    if isinstance(part, dict):
        return {name: _times(each, factors, name) for name, each in part.items()}
    if isinstance(part, list):
        return [_times(each, factors, key) for each in part]
    return Factor(factors[key], part) if key in factors else part


def _referring(where: str, part: Any, parameters: Mapping[str, Any], key: str = "") -> Any:
    """Content in which names of parameters are what they stand for."""
    if isinstance(part, dict):
        return {
            name: _referring(f"{where}.{name}", each, parameters, name)
            for name, each in part.items()
        }
    if isinstance(part, list):
        return [_referring(f"{where}[{i}]", p, parameters, key) for i, p in enumerate(part)]
    if not isinstance(part, str) or key in WORDS:
        return part
    if part in parameters:
        return Factor(part)
    known = f"one of {', '.join(parameters)}" if parameters else "a number"
    raise ValueError(f"{where} = {part!r} is no parameter of its kind: type {known}")


def _factors(part: Any) -> Iterator[Factor]:
    if isinstance(part, Factor):
        yield part
    elif isinstance(part, dict | list):
        for each in part.values() if isinstance(part, dict) else part:
            yield from _factors(each)


def _filled(part: Any, numbers: Mapping[str, float]) -> Any:
    """Content with numbers in place of factors."""
    if type(part) is Factor:
        return part.value * numbers[part.parameter]
    if type(part) is dict:
        return {key: _filled(each, numbers) for key, each in part.items()}
    if type(part) is list:
        return [_filled(each, numbers) for each in part]
    return part
