"""Functions of CasADi as machine code, where there is a C compiler.

It is that of the C export, without any freedom to round otherwise: the numbers are CasADi's own.
"""

from __future__ import annotations

import hashlib
import shutil
import subprocess
from functools import cache
from pathlib import Path
from tempfile import TemporaryDirectory

import casadi as ca

from bridgectl.dampers.c_code import c_of

COMPILERS = ("cc", "gcc", "clang")

FLAGS = ("-O2", "-ffp-contract=off", "-fPIC", "-shared")
"""Without products and sums as one operation, which rounds once: some compilers have it anyway."""

LEAST = 1000
"""Operations of the functions that a law calls from which on it is worth a second of compiling."""

_made: dict[bytes, ca.Function] = {}


def compiled(function: ca.Function) -> ca.Function:
    """Return the same function, compiled if it calls others of many operations.

    That is done once for this process.
    """
    parts = [part for part in function.find_functions() if part.is_a("SXFunction")]
    if sum(part.n_instructions() for part in parts) < LEAST:
        return function
    key = hashlib.blake2b(function.serialize().encode()).digest()
    if key not in _made:
        _made[key] = _compiled(function, key.hex()[:16])
    return _made[key]


def _compiled(function: ca.Function, name: str) -> ca.Function:
    compiler = next(filter(None, map(shutil.which, COMPILERS)), None)
    if compiler is None:
        return function
    source, library = (_folder() / f"{name}{ending}" for ending in (".c", ".so"))
    source.write_text(c_of(function))
    command = [compiler, *FLAGS, str(source), "-o", str(library), "-lm"]
    if subprocess.run(command, capture_output=True, check=False).returncode != 0:
        return function
    return ca.external(function.name(), str(library))


@cache
def _home() -> TemporaryDirectory[str]:
    """A folder that goes with this process."""
    return TemporaryDirectory(prefix="bridgectl-", ignore_cleanup_errors=True)


def _folder() -> Path:
    return Path(_home().name)
