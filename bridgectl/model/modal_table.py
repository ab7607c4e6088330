"""Modes in a text file: a table with a column a mode."""

from __future__ import annotations

import csv
import os
from typing import Any

from bridgectl import _checks
from bridgectl._files import is_regular

LINES = {
    "frequency": "frequencies",
    "modal mass": "modal_masses",
    "damping ratio": "damping_ratio",
}
"""What lines are of that begin with a word, as arguments of `bridgectl.model.modal.ModalBridge`."""


def read_modes(path: str | os.PathLike[str]) -> dict[str, Any]:
    """Arguments of a `ModalBridge` from a table: see `ModalBridge.from_csv`."""
    name = _checks.path("path", path, "modes.csv")
    if not is_regular(name):
        raise ValueError(f"{name} is no regular file: type the name of a table")
    try:
        with open(name, encoding="utf-8-sig", newline="") as file:
            text = file.read()
    except UnicodeDecodeError:
        raise ValueError(f"{name} is no UTF-8 text: save the table as CSV") from None
    rows = csv.reader(text.splitlines(), delimiter=";" if ";" in text else ",")
    found: dict[str, Any] = {"x": [], "mode_shapes": []}
    width = 0
    for line, row in enumerate(rows, 1):
        cells = [cell.strip() for cell in row]
        if not any(cells) or (line == 1 and _word(cells[0]) in ("x", "x m", "")):
            continue
        where = f"{name}: line {line}"
        values = [_number(where, cell) for cell in cells[1:]]
        if len(values) != (width := width or len(values)):
            raise ValueError(
                f"{where} has {len(values)} value{'s' * (len(values) != 1)}, "
                f"those before it {width}: one a mode is needed"
            )
        if argument := LINES.get(_word(cells[0])):
            found[argument] = values
            continue
        found["x"].append(_place(where, cells[0]))
        found["mode_shapes"].append(values)
    if "frequencies" not in found:
        raise ValueError(f"{name} has no line 'frequency' [Hz]: begin one with this word")
    return found


def _word(cell: str) -> str:
    """A name without its unit, in small letters."""
    return cell.split("[")[0].replace("_", " ").strip().lower()


def _number(where: str, cell: str) -> float:
    try:
        return float(cell)
    except ValueError:
        raise ValueError(f"{where} has {cell!r}, which is no number") from None


def _place(where: str, cell: str) -> float:
    try:
        return float(cell)
    except ValueError:
        raise ValueError(
            f"{where} begins with {cell!r}, neither a place [m] nor one of {', '.join(LINES)}"
        ) from None
