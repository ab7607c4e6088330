"""Tables of constants in functions of CasADi."""

from __future__ import annotations

from typing import Any

import casadi as ca

from bridgectl._checks import FloatArray

APART = {"never_inline": True}
"""What makes a function of CasADi one of its own in C, called where it is used."""


def read(table: FloatArray, index: Any, share: Any, size: int) -> Any:
    """Columns of a table (n, size) from one on, each a share of the way to the next."""
    rows, held = len(table), ca.MX(ca.DM(table.ravel(order="F")))
    first = rows * ca.fmin(ca.fmax(index, 0), table.shape[1] - size - 1)
    before = held[first + ca.DM(range(rows * size))]
    after = held[first + ca.DM(range(rows, rows * (size + 1)))]
    return ca.reshape(before + share * (after - before), rows, size)
