"""From a law, a Python function, to one CasADi function; where that fails, what to type instead.

A law is called once, with expressions in place of numbers. Python's own `if`, `and` or `max` want
to know what such an expression comes to, which nobody knows yet; CasADi has operations for them.
"""

from __future__ import annotations

import inspect
import re
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from threading import RLock
from types import SimpleNamespace
from typing import Any

import casadi as ca
import numpy as np

from bridgectl._checks import FloatArray
from bridgectl._warn import warn

INSTEAD = (
    "the signals are CasADi expressions, not numbers: for `x if a else b` or np.where type "
    "ca.if_else(a, x, b), for `and`, `or`, `not` and a < b < c ca.logic_and, ca.logic_or, "
    "ca.logic_not, for max and min ca.fmax and ca.fmin, for math.sqrt and the like ca.sqrt and so "
    "on, and no float() or int()"
)

CONDITIONS = {ca.OP_LT, ca.OP_LE, ca.OP_EQ, ca.OP_NE, ca.OP_NOT, ca.OP_AND, ca.OP_OR}
"""Operations that give true or false, which CasADi takes for 1 or 0."""

TYPICAL = {
    "body_velocity": 0.1, "axle_velocity": 0.3, "suspension_travel": 0.02,
    "suspension_velocity": 0.3, "body_acceleration": 1.0, "axle_acceleration": 30.0,
    "tire_force_rate": 1e6,
}  # fmt: skip
"""Size of each signal of motion that a truck's damper sees (m/s, m, m/s^2, N/s)."""

ELSE = {"tire_force": 1e5, "position": 5.0, "speed": 25.0}
"""And of those that do not change their sign with the motion: N, m, m/s."""

FAR = 100.0
"""Factor by which a law is beyond its bounds that is in another unit, as kN s/m."""

_building = RLock()


def law_function(
    name: str, law: Callable[..., Any], signals: Sequence[str], gains: Sequence[str], **known: float
) -> ca.Function:
    """Return a law as a CasADi function of signals and gains (columns), without bounds.

    Signals and gains are given by name, beside what is `known` of the gains as numbers.
    """
    s, g = ca.SX.sym("s", len(signals)), ca.SX.sym("g", len(gains))
    named = SimpleNamespace(**dict(zip(signals, ca.vertsplit(s), strict=True)))
    values = dict(zip(gains, ca.vertsplit(g), strict=True)) if gains else {}
    arguments = named, SimpleNamespace(**known, **values)
    _require_two_arguments(name, law, arguments)
    try:
        with _float_refused():
            result = law(*arguments)
    except Exception as error:
        if isinstance(error, AttributeError) and isinstance(error.obj, SimpleNamespace):
            names = f"signals: {', '.join(signals)}; gains: {', '.join([*known, *gains])}"
            raise ValueError(
                f"the law of {name} uses an unknown name ({error}); {names}"
            ) from error
        raise ValueError(f"the law of {name} fails: {_in_short(error)}") from error
    command = _one_number(name, result, known["c_max"])
    try:
        return ca.Function("law", [s, g], [command])
    except RuntimeError as error:
        raise ValueError(
            f"the law of {name} has a symbol of its own in {command!s:.60}: it may use signals and "
            "gains, as s.suspension_velocity and g.c_max"
        ) from error


def warn_of_slips(name: str, law: ca.Function, signals: Sequence[str], gains: FloatArray,
                  c_min: float, c_max: float) -> None:  # fmt: skip
    """Warn of a law that returns a force, or a damping in another unit."""
    size = np.array([(TYPICAL | ELSE)[key] for key in signals])
    motion = np.array([key in TYPICAL for key in signals])
    there = size * np.random.default_rng(0).uniform(-1, 1, (50, len(signals)))
    there[:, ~motion] = np.abs(there[:, ~motion])
    back = np.where(motion, -there, there)
    c, mirrored = (
        np.array(law.map(len(rows))(rows.T, np.tile(gains[:, np.newaxis], len(rows))))[0]
        for rows in (there, back)
    )
    least, most = min(c.min(), mirrored.min()), max(c.max(), mirrored.max())
    if most > 0 and np.allclose(c, -mirrored, rtol=1e-9, atol=0.0):
        slip = (
            "changes its sign with the motion, as a force [N] does: return a damping [N s/m], "
            "the force over s.suspension_velocity"
        )
    elif 0 < most < c_min / FAR or least > c_max * FAR:
        slip = (
            f"returns {least:.3g} to {most:.3g} where c_min and c_max are {c_min:g} and {c_max:g}: "
            "give all of them in N s/m"
        )
    else:
        return
    warn(f"the law of {name} {slip}")


def _require_two_arguments(name: str, law: Callable[..., Any], arguments: tuple[Any, Any]) -> None:
    try:
        signature = inspect.signature(law)
    except (TypeError, ValueError):  # some that are not written in Python have none
        return
    try:
        signature.bind(*arguments)
    except TypeError as error:
        raise TypeError(
            f"the law of {name} must be a function law(s, g) of signals and gains, "
            f"got one of {signature}"
        ) from error


@contextmanager
def _float_refused() -> Iterator[None]:
    """Make float() of an expression an error: to CasADi it is NaN, which may pass unseen."""
    own = ca.SX.__float__

    def known(expression: Any) -> float:
        if not expression.is_constant():
            raise TypeError("float() of an expression")
        return float(own(expression))

    with _building:
        ca.SX.__float__ = known  # type: ignore[method-assign]
        try:
            yield
        finally:
            ca.SX.__float__ = own  # type: ignore[method-assign]


def _in_short(error: Exception) -> str:
    """The first line of an error, without CasADi's place in C++, and what helps against it."""
    first = re.sub(r"^\S+\.[ch]pp:\d+: ", "", str(error).partition("\n")[0])
    told = f"{type(error).__name__}: {first}"
    of_expressions = isinstance(error.__cause__ or error, RuntimeError | TypeError)
    return f"{told}; {INSTEAD}" if of_expressions or "SX" in first else told


def _one_number(name: str, result: Any, c_max: float) -> Any:
    try:
        command: Any = ca.SX(result)
    except (NotImplementedError, TypeError) as error:
        end = ", a function without return" if result is None else ""
        raise ValueError(
            f"the law of {name} must return one number or expression, got {result!r:.60}{end}"
        ) from error
    if command.shape != (1, 1):
        raise ValueError(f"the law of {name} must return one number, got {command.shape}")
    truth = isinstance(result, bool | np.bool_)
    # Where c_max is 1, a damping of `condition * c_max` is a condition too.
    if truth or (c_max > 1 and not command.is_leaf() and command.op() in CONDITIONS):
        raise ValueError(
            f"the law of {name} returns a condition, true or false, and no damping: type "
            "ca.if_else(condition, g.c_max, g.c_min)"
        )
    return command
