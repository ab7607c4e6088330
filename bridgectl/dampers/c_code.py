"""The law of a strategy as C, for a controller."""

from __future__ import annotations

from pathlib import Path

import casadi as ca

from bridgectl._files import replacing


def write_c(function: ca.Function, path: str | Path) -> Path:
    """Write a function of CasADi as C: see `bridgectl.dampers.Strategy.to_c`."""
    if not isinstance(path, str | Path):
        raise TypeError(f"path must be a string or Path, got {path!r}: type path='damping.c'")
    file = Path(path)
    if file.suffix != ".c":
        raise ValueError(f"path must end in .c, got {str(path)!r}: type path='damping.c'")
    with replacing(str(file)) as handle:
        handle.write(c_of(function).encode())
    return file


def c_of(function: ca.Function) -> str:
    """Return a function of CasADi in C."""
    # CasADi makes a name in C of this one, so it is not that of a file.
    generator = ca.CodeGenerator("damping.c", {"with_header": False})
    generator.add(function)
    return str(generator.dump())
