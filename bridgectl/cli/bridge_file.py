"""Bridges in TOML files, for ``--bridge FILE.toml``: of spans, or of modes in a table.

Keys of a bridge of spans, those of `bridgectl.Bridge` (``bridgectl/cli/data/two_spans.toml``)::

    spans               lengths [m], as [25, 30]; or one number
    mass_per_length     [kg/m], one number, one a span, or pieces [[metres, value], ...] from the
                        start of the bridge to its end
    flexural_rigidity   E J [N m^2], likewise; or in its place
    frequency           the first one [Hz], which gives a deck of one E J
    supports            one at each end of a span: "simple" (the default), "clamped", "free", or
                        {vertical = N/m, rotational = N m/rad}, of which what is left out is rigid
                        and 0; inf is rigid
    n_modes             number of modes (default 3 of one simple span, else 6 a span)
    damping_ratio       one number for all modes, one a mode, or those of two modes as
                        {1 = 0.02, 3 = 0.03}: the others have a / w + b w (Rayleigh damping)

Keys of a bridge of modes, those of `bridgectl.ModalBridge`::

    modes               CSV file beside this one, with a column a mode: `ModalBridge.from_csv`
    modal_masses, mass_per_length, damping_ratio    in place of those of the table
    [[effects]]         one of these tables for each effect that the bridge tells:
      quantity          "moment", "shear" or "reaction"
      at                its place [m] from the start of the bridge
      places            of a force [m]: kinks of the influence line and what is between
      influence         static effect of 1 N at each [N m or N]
      modal             effect of each mode's shape

Of either, for the stresses of moments::

    section_modulus     of the fibre that they are told of [m^3]

Other keys are errors. Every error names the file, and the key or the line.
"""

from __future__ import annotations

import re
import warnings
from collections.abc import Mapping
from itertools import product
from pathlib import Path
from typing import Any

import numpy as np
from scipy.optimize import brentq

from bridgectl import Beam, Bridge, ModalBridge
from bridgectl import _checks as check
from bridgectl._toml import parsed, require_keys, require_known
from bridgectl.cli.commands.bridge import EXAMPLE, N_MODES
from bridgectl.model.modal_table import read_modes
from bridgectl.model.told import told

MODULUS = "section_modulus"
"""What is of the stresses that are told, and not of the bridge."""

OF_SPANS = (
    "spans", "mass_per_length", "flexural_rigidity", "frequency", "supports", "n_modes",
    "damping_ratio", MODULUS,
)  # fmt: skip
OF_MODES = ("modes", "modal_masses", "mass_per_length", "damping_ratio", "effects", MODULUS)
LINE = ("places", "influence", "modal")
OF_EFFECT = ("quantity", "at", *LINE)
QUANTITIES = ("moment", "shear", "reaction")

LOOKS = {
    "spans": "spans = [25, 30]", "mass_per_length": "mass_per_length = 18e3",
    "quantity": 'quantity = "moment"', "at": "at = 12.5", "places": "places = [0, 12.5, 25]",
    "influence": "influence = [0, 6.25, 0]", "modal": "modal = [7.7e8, 0]",
}  # fmt: skip
"""What to type for keys that are missing."""

STIFFEST = 1e4
"""How many times the E J of a simply supported span a deck may have to reach a frequency."""


def read_bridge(name: str) -> Beam | Bridge | ModalBridge:
    """Return the bridge of a file, or that of the example that ships."""
    path = _path(name)
    with warnings.catch_warnings(record=True) as found:
        warnings.simplefilter("always")
        try:
            content = _content(path)
            of_modes = "modes" in content
            _require_known("", content, OF_MODES if of_modes else OF_SPANS)
            content.pop(MODULUS, None)
            bridge = _modal_bridge(path, content) if of_modes else _of_spans(content)
        except (TypeError, ValueError) as error:
            raise ValueError(f"{path}: {_in_toml(str(error))}") from None
    for each in found:
        text = re.sub(r"\btype (\w+)=", r"type \1 = ", str(each.message))
        warnings.warn(f"{path}: {text}", each.category, stacklevel=2)
    return bridge


def section_modulus(name: str) -> Any:
    """Return what a file states of the fibre whose stress is told [m^3], None if nothing."""
    return _content(_path(name)).get(MODULUS)


def _path(name: str) -> Path:
    return EXAMPLE if name == "example" else Path(name)


def _content(path: Path) -> dict[str, Any]:
    return parsed(path, "bridge", LOOKS["spans"], "example")


def _require_known(where: str, given: Mapping[str, Any], known: tuple[str, ...]) -> None:
    require_known(where, given, known, () if where else (*OF_SPANS, *OF_MODES))


def _require(where: str, given: Mapping[str, Any], *keys: str) -> None:
    require_keys(where, given, keys, LOOKS)


def _of_spans(content: dict[str, Any]) -> Beam | Bridge:
    _require("", content, "spans", "mass_per_length")
    if ("frequency" in content) == ("flexural_rigidity" in content):
        raise ValueError(
            "must have either flexural_rigidity or frequency: type flexural_rigidity = 4.9e10 "
            "[N m^2], or frequency = 4.1 [Hz]"
        )
    damping = content.get("damping_ratio")
    if isinstance(damping, dict):
        content = content | {"damping_ratio": _of_numbered_modes(damping)}
    return bridge_of_spans(content)


def _of_numbered_modes(ratios: Mapping[str, Any]) -> dict[int, Any]:
    for mode in ratios:
        if not (mode.isascii() and mode.isdigit()):
            raise ValueError(
                f"damping_ratio has the key {mode!r}, expected the numbers of two modes: type "
                "damping_ratio = {1 = 0.02, 3 = 0.03}"
            )
    return {int(mode): ratio for mode, ratio in ratios.items()}


def bridge_of_spans(given: Mapping[str, Any], *, damped_in_mode_1: bool = False) -> Beam | Bridge:
    """Return the bridge of arguments of `Bridge`, or 'frequency' [Hz] in place of its E J.

    Of one simply supported span without steps it is a `Beam`, whose modes are closed forms; one
    damping ratio is that of all modes, or of mode 1 as `Beam` has it.
    """
    options = dict(given)
    if isinstance(options.get("damping_ratio"), list | tuple):
        options.setdefault("n_modes", len(options["damping_ratio"]))
    if "frequency" in options:
        frequency = check.positive("frequency", options.pop("frequency"), unit="Hz")
        options["flexural_rigidity"] = _rigidity(options, frequency)
    with warnings.catch_warnings(record=True) as found:
        warnings.simplefilter("always")
        bridge = Bridge(**options)
    alongs: list[Any] = [bridge.mass_per_length, bridge.flexural_rigidity]
    mass, rigidity = (
        float(np.ravel(along)[-1]) if isinstance(along, tuple) and len(along) == 1 else along
        for along in alongs
    )
    ratios: Any = bridge.damping_ratio
    rayleigh = isinstance(ratios, tuple) and isinstance(ratios[0], tuple)
    prismatic = isinstance(mass, float) and isinstance(rigidity, float)
    if bridge.supports == ("simple", "simple") and prismatic and not rayleigh:
        n_modes = bridge.n_modes if "n_modes" in options else N_MODES
        if isinstance(ratios, float) and ratios and not damped_in_mode_1:
            ratios = (ratios,) * n_modes
        return Beam(bridge.length, mass, rigidity, n_modes, ratios)
    for each in found:
        warnings.warn_explicit(each.message, each.category, each.filename, each.lineno)
    return bridge


def _rigidity(options: Mapping[str, Any], frequency: float) -> float:
    """E J [N m^2] with which the first frequency is this one [Hz]; springs may not allow it."""
    given = {name: options[name] for name in ("spans", "mass_per_length", "supports")
             if name in options}  # fmt: skip

    def frequency_of(rigidity: float) -> float:
        bridge = Bridge(**given, flexural_rigidity=rigidity, n_modes=1)
        return float(bridge.frequencies[0])

    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # of decks on the way
        bridge = Bridge(**given, flexural_rigidity=1e10, n_modes=1)
        longest = float(np.diff(bridge.support_places).max())
        usual = bridge.mass / bridge.length * (2 * frequency * longest**2 / np.pi) ** 2
        if (most := frequency_of(STIFFEST * usual)) < frequency:
            raise ValueError(
                f"frequency of {frequency:g} Hz is more than the springs of the supports allow, on "
                f"which a stiff deck has {most:.3g} Hz"
            )
        power = brentq(
            lambda power: np.log(frequency_of(usual * STIFFEST**power) / frequency), -1, 1,
            xtol=1e-14,
        )  # fmt: skip
    return float(usual * STIFFEST**power)


def _modal_bridge(path: Path, content: dict[str, Any]) -> ModalBridge:
    name, told_effects = content["modes"], content.get("effects", [])
    if not isinstance(name, str):
        raise TypeError(f'modes must name a CSV file, got {name!r}: type modes = "modes.csv"')
    if isinstance(content.get("damping_ratio"), dict):
        raise TypeError("damping_ratio of modes must be one number, or one a mode")
    if not (isinstance(told_effects, list) and all(isinstance(e, dict) for e in told_effects)):
        raise TypeError("effects must be tables: type [[effects]], and their keys below")
    table = read_modes(path.parent / name)
    table |= {key: content[key] for key in content if key not in ("modes", "effects")}
    length = max(table["x"], default=0.0)
    names = [_effect_name(i, effect, length) for i, effect in enumerate(told_effects)]
    if again := [name for name in names if names.count(name) > 1]:
        raise ValueError(
            f"effects has the {again[0][0]} at {again[0][1] * length:g} m twice: leave one out"
        )
    lines = [[effect[part] for part in LINE] for effect in told_effects]
    try:
        return ModalBridge(**table, effects=dict(zip(names, map(tuple, lines), strict=True)))
    except (TypeError, ValueError) as error:
        text = str(error)
        for (i, name), (j, part) in product(enumerate(names), enumerate(LINE)):
            text = text.replace(f"effects[{told(name)}][{j}]", f"effects[{i}].{part}")
        raise ValueError(text) from None


def _effect_name(i: int, effect: dict[str, Any], length: float) -> tuple[str, float]:
    """Quantity and section of an effect of a bridge so long [m]."""
    where = f"effects[{i}]"
    _require_known(where, effect, OF_EFFECT)
    _require(where, effect, *OF_EFFECT)
    at = check.not_negative(f"{where}.at", effect["at"], unit="m")
    if not at <= length or length == 0:
        raise ValueError(f"{where}.at must be on the bridge, 0 to {length:g} m, got {at:g}")
    return check.choice(f"{where}.quantity", effect["quantity"], QUANTITIES), at / length


def _in_toml(message: str) -> str:
    """An error of the library with lists and tables as TOML has them."""
    message = re.sub(r"\(([^() ]+, [^() ]+)\)", r"[\1]", message)
    return re.sub(r"\{[^}]*\}", lambda found: re.sub(r"'?(\w+)'?: ", r"\1 = ", found[0]), message)
