"""Trucks in TOML files, and the catalog of those that ship.

Keys of a truck (``bridgectl/model/trucks/data/T5air.toml``)::

    description, source     what it is, and where its numbers come from
    hinge                   of two bodies: its place on the first and on the second [m]
    [[bodies]]              one, or tractor and trailer; keys those of `Body`:
      mass, inertia         [kg], [kg m^2]
      centre, height        of the centre of gravity [m]; may be left out
      [[bodies.axles]]      from front to rear; keys those of `Axle`:
        place, mass, suspension_stiffness, tire_stiffness
        name, damping, tire_damping, spread, inertia    may be left out
      [[bodies.loads]]      what is loaded, if anything; keys those of `Body.loaded`:
        mass, place         [kg], [m]
        inertia, height     may be left out

Places are positive backward. Or the keys are those of `bridgectl.QuarterCar`. Others are errors,
and every error names the file and the key.
"""

from __future__ import annotations

import os
import re
from collections.abc import Callable, Mapping, Sequence
from difflib import get_close_matches
from functools import partial
from pathlib import Path
from typing import Any, TypeVar

from bridgectl import _checks
from bridgectl._plausible import judge_quarter_car, judge_truck
from bridgectl._toml import parsed, require_keys, require_known
from bridgectl.model.quarter_car import QuarterCar
from bridgectl.model.trucks.build import articulated, rigid
from bridgectl.model.trucks.parts import Axle, Body
from bridgectl.model.vehicle import Vehicle

DATA = Path(__file__).parent / "data"

TOLD = ("description", "source")
OF_TRUCK = ("bodies", "hinge", *TOLD)
OF_WHEEL = (
    "sprung_mass", "unsprung_mass", "suspension_stiffness", "tire_stiffness", "damping",
    "tire_damping",
)  # fmt: skip
OF_BODY = ("mass", "inertia", "axles", "centre", "height", "loads")
OF_AXLE = (
    "place", "mass", "suspension_stiffness", "tire_stiffness", "damping", "tire_damping", "name",
    "spread", "inertia",
)  # fmt: skip
OF_LOAD = ("mass", "place", "inertia", "height")

LOOKS = {
    "bodies": "[[bodies]], and its keys below", "axles": "[[bodies.axles]], and its keys below",
    "mass": "mass = 1100", "inertia": "inertia = 50e3", "place": "place = 2.5",
    "suspension_stiffness": "suspension_stiffness = 1e6", "tire_stiffness": "tire_stiffness = 3e6",
    "hinge": "hinge = [3, -5]", "sprung_mass": "sprung_mass = 9000",
    "unsprung_mass": "unsprung_mass = 1000", "damping": "damping = 7e3",
}  # fmt: skip
"""What to type for keys that are missing."""

T = TypeVar("T")


def catalog() -> dict[str, str]:
    """Return what ships: the name of each truck, with what it is and where it comes from.

    Returns
    -------
    dict of str to str

    Examples
    --------
    >>> import bridgectl as bc
    >>> print(*bc.trucks.catalog())
    T2 T2A01 T5 T5A01 T5air T5tridem li2006
    """
    contents = {path.stem: parsed(path, "truck", "", "") for path in sorted(DATA.glob("*.toml"))}
    return {
        name: f"{content['description']}. Source: {content['source']}"
        for name, content in contents.items()
    }


def load(name: str | os.PathLike[str]) -> Vehicle | QuarterCar:
    """Return a truck of the catalog, or of a TOML file.

    Parameters
    ----------
    name : str or path-like
        A name of `catalog`, or a file, whose name ends in ``.toml``: what it looks like is told in
        ``bridgectl/model/trucks/file.py``, and shown by ``bridgectl trucks T5air --toml``.

    Returns
    -------
    Vehicle or QuarterCar

    Raises
    ------
    TypeError, ValueError
        If there is no such truck; or if the file does not make one, with its name and the key.

    Warns
    -----
    PlausibilityWarning
        If no truck moves so fast or slowly on its axles.

    Examples
    --------
    >>> import bridgectl as bc
    >>> (bc.trucks.load("T5air").static_loads / 1e3).round(1)
    array([ 55.2, 105.3,  78.3,  77.3,  76.4])
    """
    path = truck_path(name)
    try:
        content = parsed(path, "truck", LOOKS["place"], "a name of the catalog, as T5air")
        truck = truck_of(content)
    except (TypeError, ValueError) as error:
        text = re.sub(r"\btype (\w+)=", r"type \1 = ", str(error))
        raise ValueError(f"{path}: {text}") from None
    if isinstance(truck, QuarterCar):
        judge_quarter_car(truck)
    else:
        judge_truck(truck)
    return truck


def truck_path(name: str | os.PathLike[str]) -> Path:
    """File of a truck of the catalog, or that of a name that ends in .toml."""
    text = _checks.path("name", name, "T5air")
    if text.lower().endswith(".toml"):
        return Path(text)
    names = sorted(path.stem for path in DATA.glob("*.toml"))
    folded = {each.lower(): each for each in names}
    if text.lower() in folded:
        return DATA / f"{folded[text.lower()]}.toml"
    near = get_close_matches(text.lower(), folded, 1)
    known = folded[near[0]] if near else f"one of {', '.join(names)}"
    raise ValueError(
        f"there is no truck {text!r}: type {known}, or the name of a file that ends in .toml"
    )


def truck_of(content: Mapping[str, Any]) -> Vehicle | QuarterCar:
    """Make the truck of a file's content; an error names the key."""
    if "bodies" not in content and "sprung_mass" in content:
        require_known("", content, (*OF_WHEEL, *TOLD), OF_TRUCK)
        require_keys("", content, OF_WHEEL[:-1], LOOKS)
        return QuarterCar(**{key: content[key] for key in OF_WHEEL if key in content})
    require_known("", content, OF_TRUCK, OF_WHEEL)
    require_keys("", content, ("bodies",), LOOKS)
    bodies = [_body(f"bodies[{i}]", each) for i, each in enumerate(_tables("bodies", content))]
    if len(bodies) == 1:
        if "hinge" in content:
            raise ValueError("hinge needs two bodies, got one: leave it out, or add [[bodies]]")
        return rigid(bodies[0])
    if len(bodies) != 2:
        raise ValueError(f"bodies must be one, or tractor and trailer, got {len(bodies)}")
    require_keys("", content, ("hinge",), LOOKS)
    return articulated(bodies[0], bodies[1], content["hinge"])


def _body(where: str, content: Mapping[str, Any]) -> Body:
    require_known(where, content, OF_BODY)
    require_keys(where, content, OF_BODY[:3], LOOKS)
    own = {key: value for key, value in content.items() if key != "loads"}
    own["axles"] = [
        _axle(f"{where}.axles[{i}]", each)
        for i, each in enumerate(_tables("axles", content, where + "."))
    ]
    body = _told(where, partial(Body, **own))
    for i, given in enumerate(_tables("loads", content, where + ".")):
        require_known(f"{where}.loads[{i}]", given, OF_LOAD)
        require_keys(f"{where}.loads[{i}]", given, OF_LOAD[:2], LOOKS)
        body = _told(f"{where}.loads[{i}]", partial(body.loaded, **given))
    return body


def _axle(where: str, content: Mapping[str, Any]) -> Axle:
    require_known(where, content, OF_AXLE)
    require_keys(where, content, OF_AXLE[:4], LOOKS)
    return _told(where, partial(Axle, **content))


def _tables(key: str, content: Mapping[str, Any], where: str = "") -> Sequence[Mapping[str, Any]]:
    tables = content.get(key, [])
    if not (isinstance(tables, list) and all(isinstance(each, dict) for each in tables)):
        inside = "bodies." if where else ""
        raise TypeError(
            f"{where}{key} must be tables: type [[{inside}{key}]], and their keys below"
        )
    return tables


def _told(where: str, make: Callable[[], T]) -> T:
    """Make a part; an error names its table."""
    try:
        return make()
    except (TypeError, ValueError) as error:
        raise ValueError(f"{where}.{error}") from None
