"""The law of a strategy as C, for a controller, with the lines that call it at the head."""

from __future__ import annotations

import textwrap
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path

import casadi as ca

from bridgectl._files import replacing


def write_c(function: ca.Function, path: str | Path, head: str) -> Path:
    """Write a function of CasADi as C: see `bridgectl.dampers.Strategy.to_c`."""
    if not isinstance(path, str | Path):
        raise TypeError(f"path must be a string or Path, got {path!r}: type path='damping.c'")
    file = Path(path)
    if file.suffix != ".c":
        raise ValueError(f"path must end in .c, got {str(path)!r}: type path='damping.c'")
    with replacing(str(file)) as handle:
        handle.write((head + c_of(function)).encode())
    return file


def c_of(function: ca.Function) -> str:
    """Return a function of CasADi in C."""
    # CasADi makes a name in C of this one, so it is not that of a file.
    generator = ca.CodeGenerator("damping.c", {"with_header": False})
    generator.add(function)
    return str(generator.dump())


def usage(
    function: ca.Function,
    title: str,
    signals: Sequence[str],
    used: Sequence[str],
    gains: Mapping[str, float],
    states: Mapping[str, float],
    n_ahead: int,
) -> str:
    """Return a comment in C that tells how a law is called at each sample, in the file's order."""
    count, lines = len(states), [_array("casadi_real", "signals", signals)]
    lines += [_array("const casadi_real", "gains", gains.values(), gains)] * bool(gains)
    lines += [_array("static casadi_real", "states", states.values(), states)] * bool(states)
    lines += [f"casadi_real ahead[{n_ahead}] = {{0}};  // elevations [m]"] * bool(n_ahead)
    lines += ["casadi_real sample_time = 0.002;"] * (function.n_in() > 2)
    given = ["signals", "gains" if gains else "0", "states" if states else "0", "&sample_time"]
    given, found = [*given, "ahead" if n_ahead else "0"][: function.n_in()], ["&c", "next"]
    lines += [
        f"casadi_real c, next[{count + 1}], w[{function.sz_w() + 1}];",
        f"casadi_int iw[{function.sz_iw() + 1}];",
        f"const casadi_real *arg[{function.sz_arg()}] = {{{', '.join(given)}}};",
        f"casadi_real *res[{function.sz_res()}] = {{{', '.join(found[: function.n_out()])}}};",
        "damping(arg, res, iw, w, 0);  // c is the damping [N s/m]",
    ]
    lines += [f"for (int i = 0; i < {count}; i++) states[i] = next[i];"] * bool(states)
    measured = textwrap.fill(
        f"It measures {', '.join(used) or 'nothing'}; other signals may be 0. In single precision "
        "compile with -Dcasadi_real=float -Dcasadi_int=int.", 90,
    )  # fmt: skip
    opening = f"/* {title}. At each sample, in a file that includes this one (SI, down positive):"
    told = "\n".join([textwrap.fill(opening, 90), "", *lines, "", measured])
    # What ends a comment, in a name, would end this one.
    return told.replace("*/", "* /") + " */\n\n"


def _array(kind: str, name: str, values: Iterable[object], names: Iterable[str] = ()) -> str:
    """Declare an array in C, with what each value is."""
    each = [str(value) for value in values]
    said = f"  // {', '.join(names)}" if names else ""
    line = f"{kind} {name}[{len(each)}] = {{{', '.join(each)}}};{said}"
    return textwrap.fill(line, 90, subsequent_indent="    ") if not names else line
