"""Tables of constants in functions of CasADi."""

from __future__ import annotations

from typing import Any

import casadi as ca
import numpy as np

from bridgectl._checks import FloatArray

APART = {"never_inline": True}
"""What makes a function of CasADi one of its own in C, called where it is used."""


def read(table: FloatArray, index: Any, share: Any, size: int, apart: int = 1) -> Any:
    """Some columns of a table (n, size) from one on, each a share of the way to the next."""
    rows, held = len(table), ca.MX(ca.DM(table.ravel(order="F")))
    first = rows * ca.fmin(ca.fmax(index, 0), table.shape[1] - size * apart - 1)
    columns = (rows * apart * np.arange(size)[:, np.newaxis] + np.arange(rows)).ravel()
    before, after = (held[first + ca.DM(columns + k)] for k in (0, rows))
    return ca.reshape(before + share * (after - before), rows, size)
