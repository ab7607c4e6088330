"""From a law, a Python function, to one CasADi function; where that fails, what to type instead.

A law, and the update of its states, is called once, with expressions in place of numbers. Python's
own `if`, `and` or `max` want to know what such an expression comes to, which nobody knows yet;
CasADi has operations for them.
"""

from __future__ import annotations

import inspect
import re
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from threading import RLock
from types import SimpleNamespace
from typing import Any

import casadi as ca
import numpy as np

from bridgectl._checks import FloatArray
from bridgectl._warn import warn
from bridgectl.dampers.signals import SIGNALS, parts_of

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

AHEAD = 0.02
"""And of the elevations ahead [m]."""

SAMPLE_TIME = 2e-3
"""Sample time [s] of a law where none is told: that of a `Damper`."""

FAR = 100.0
"""Factor by which a law is beyond its bounds that is in another unit, as kN s/m."""

_building = RLock()

INPUTS = "signals", "gains", "states", "sample_time", "ahead"
"""Inputs of a law with states or preview, in their order; of others the first two."""

OUTPUTS = "c", "next_states"
"""And its outputs; of others the first."""


def damping_function(
    name: str,
    law: Callable[..., Any],
    update: Callable[..., Any] | None,
    gains: Mapping[str, float],
    states: Mapping[str, float],
    n_ahead: int,
    *,
    c_min: float,
    c_max: float,
) -> tuple[ca.Function, tuple[str, ...]]:
    """Return a law as the CasADi function "damping" of `INPUTS` (columns) to `OUTPUTS`.

    And its signals: `SIGNALS`, and what it measures of other legs. Gains and states are given by
    name, with the values at which slips are looked for.
    """
    if not callable(law):
        raise TypeError(f"law must be a function law(s, g), got {type(law).__name__}")
    known = {"c_min": c_min, "c_max": c_max}
    free, signals = _law_function(name, law, update, [*gains], [*states], n_ahead, known)
    columns = gains.values(), states.values(), [SAMPLE_TIME]
    held = [np.reshape([*values], (-1, 1)) for values in columns]
    _warn_of_slips(name, free, signals, held, n_ahead, c_min, c_max)
    return _within(free, c_min, c_max), signals


class _Measured(SimpleNamespace):
    """What a law measures, as attributes; signals of other legs once it names them."""

    def __getattr__(self, name: str) -> Any:
        if not parts_of(name)[1]:
            return super().__getattribute__(name)  # which fails
        setattr(self, name, ca.SX.sym(name))
        return getattr(self, name)


def _law_function(
    name: str,
    law: Callable[..., Any],
    update: Callable[..., Any] | None,
    gains: Sequence[str],
    states: Sequence[str],
    n_ahead: int,
    known: Mapping[str, float],
) -> tuple[ca.Function, tuple[str, ...]]:
    """A law without bounds, with what is `known` of the gains as numbers, and its signals."""
    sizes = len(SIGNALS), len(gains), len(states), 1, n_ahead
    columns = [ca.SX.sym(letter, size) for letter, size in zip("sgxta", sizes, strict=True)]
    s, g, x, (time,), ahead = (ca.vertsplit(c) if c.numel() else [] for c in columns)
    measured: dict[str, Any] = dict(zip((*SIGNALS, *states), (*s, *x), strict=True))
    measured |= {"sample_time": time} if states else {}
    measured |= {"ahead": ahead} if n_ahead else {}
    arguments = (
        _Measured(**measured),
        SimpleNamespace(**known, **dict(zip(gains, g, strict=True))),
    )
    result = _called(f"law of {name}", law, arguments)
    command = _one_number(f"law of {name}", result)
    _require_no_condition(name, result, command, known["c_max"])
    what = f"update of {name}"
    following = _called(what, update, arguments) if update else {}
    others = {key: sym for key, sym in vars(arguments[0]).items() if key not in measured}
    columns[0] = ca.vertcat(columns[0], *others.values())
    inputs = columns if states or n_ahead else columns[:2]
    outputs = [_of_inputs(f"law of {name}", inputs, command)]
    if states or n_ahead:
        outputs.append(_of_inputs(what, inputs, _every_state(what, following, states)))
    return ca.Function("law", inputs, outputs), (*SIGNALS, *others)


def _evaluated(function: ca.Function, *columns: Any) -> list[FloatArray]:
    """Outputs of a law, (n, count), from those of `INPUTS` that it takes, (n, count) or (n, 1)."""
    count = np.shape(columns[0])[1]
    given = [np.tile(c, (1, count // np.shape(c)[1])) for c in columns[: function.n_in()]]
    return [found.full() for found in function.map(count).call(given)]


def at_sample(name: str, function: ca.Function, *columns: Any) -> tuple[FloatArray, FloatArray]:
    """Commands (count,) and next states (m, count) of a law, if all are finite numbers."""
    command, *following = _evaluated(function, *columns)
    after = following[0] if following else np.zeros((0, command.size))
    return numbers(f"law of {name}", command[0]), numbers(f"update of {name}", after)


def numbers(what: str, found: FloatArray) -> FloatArray:
    """Return what a law or an update has found, if all are finite numbers."""
    if not np.isfinite(found).all():
        told = "NaN" if np.isnan(found).any() else "infinity, a division by 0"
        raise ValueError(
            f"the {what} returned {told}: guard divisions, for example by "
            "ca.if_else(ca.fabs(s.suspension_velocity) < 1e-6, ...)"
        )
    return found


def depends(
    function: ca.Function, signals: Sequence[str], gains: Sequence[float], *, at_once: bool = False
) -> list[str]:
    """Signals that a law depends on with gains as they are, by its states or only at once."""
    s, _, *others = function.sx_in()
    outputs = ca.vertcat(
        *function.call([s, ca.SX(ca.DM(gains)), *others])[: 1 if at_once else None]
    )
    return [
        name
        for name, matters in zip(signals, ca.which_depends(outputs, s, 1, False), strict=True)
        if matters
    ]


def _within(law: ca.Function, c_min: float, c_max: float) -> ca.Function:
    """A law kept within bounds, its inputs and outputs by name."""
    inputs = law.sx_in()
    command, *following = law.call(inputs)
    # fmin and fmax would make a bound of NaN, and of what a division by 0 gives: those are told.
    kept = ca.if_else(ca.fabs(command) < np.inf, ca.fmin(ca.fmax(command, c_min), c_max), command)
    names = [*INPUTS[: law.n_in()]], [*OUTPUTS[: law.n_out()]]
    return ca.Function("damping", inputs, [kept, *following], *names)


def _warn_of_slips(
    name: str, law: ca.Function, signals: Sequence[str], held: Sequence[FloatArray], n_ahead: int,
    c_min: float, c_max: float,
) -> None:  # fmt: skip
    """Warn of a law that returns a force, or a damping in another unit, in its first sample."""
    measured = [parts_of(key)[0] for key in signals]
    size = np.array([(TYPICAL | ELSE)[key] for key in measured])
    motion = np.array([key in TYPICAL for key in measured])
    random = np.random.default_rng(0)
    there = size * random.uniform(-1, 1, (50, len(signals)))
    there[:, ~motion] = np.abs(there[:, ~motion])
    back, ahead = np.where(motion, -there, there), AHEAD * random.uniform(-1, 1, (n_ahead, 50))
    c, mirrored = (
        _evaluated(law, rows.T, *held, road)[0][0]
        for rows, road in ((there, ahead), (back, -ahead))
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


def _called(what: str, function: Callable[..., Any], arguments: tuple[Any, Any]) -> Any:
    """What a law or an update returns for expressions."""
    _require_two_arguments(what, function, arguments)
    try:
        with _float_refused():
            return function(*arguments)
    except Exception as error:
        if isinstance(error, AttributeError) and isinstance(error.obj, SimpleNamespace):
            signals, gains = (", ".join(vars(argument)) for argument in arguments)
            raise ValueError(
                f"the {what} uses an unknown name ({error}); signals: {signals}; gains: {gains}; "
                "of another leg of a vehicle for example s.body_velocity_rear; others come by "
                "states=..., update=... and, for s.ahead, preview=..."
            ) from error
        raise ValueError(f"the {what} fails: {_in_short(error)}") from error


def _require_two_arguments(
    what: str, function: Callable[..., Any], arguments: tuple[Any, Any]
) -> None:
    try:
        signature = inspect.signature(function)
    except (TypeError, ValueError):  # some that are not written in Python have none
        return
    try:
        signature.bind(*arguments)
    except TypeError as error:
        kind = what.partition(" ")[0]
        raise TypeError(
            f"the {what} must be a function {kind}(s, g) of signals and gains, "
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


def _one_number(what: str, result: Any) -> Any:
    try:
        number: Any = ca.SX(result)
    except (NotImplementedError, TypeError) as error:
        end = ", a function without return" if result is None else ""
        raise ValueError(
            f"the {what} must return one number or expression, got {result!r:.60}{end}"
        ) from error
    if number.shape != (1, 1):
        raise ValueError(f"the {what} must return one number, got {number.shape}")
    return number


def _require_no_condition(name: str, result: Any, command: Any, c_max: float) -> None:
    truth = isinstance(result, bool | np.bool_)
    # Where c_max is 1, a damping of `condition * c_max` is a condition too.
    if truth or (c_max > 1 and not command.is_leaf() and command.op() in CONDITIONS):
        raise ValueError(
            f"the law of {name} returns a condition, true or false, and no damping: type "
            "ca.if_else(condition, g.c_max, g.c_min)"
        )


def _every_state(what: str, result: Any, states: Sequence[str]) -> Any:
    """The next values of the states, one column."""
    if not isinstance(result, Mapping) or set(result) != set(states):
        got = f"{[*result]}" if isinstance(result, Mapping) else f"{result!r:.60}"
        every = ", ".join(f'"{key}": ...' for key in states)
        raise ValueError(
            f"the {what} must return the next value of every state by name, got {got}: "
            f"type return {{{every}}}"
        )
    each = [_one_number(f"{what}, for state {key},", result[key]) for key in states]
    return ca.densify(ca.vertcat(*each)) if each else ca.SX(0, 1)


def _of_inputs(what: str, inputs: Sequence[Any], expression: Any) -> Any:
    """The expression, if it has no symbols but the inputs."""
    try:
        ca.Function("one", inputs, [expression])
    except RuntimeError as error:
        raise ValueError(
            f"the {what} has a symbol of its own in {expression!s:.60}: it may use signals and "
            "gains, as s.suspension_velocity and g.c_max"
        ) from error
    return expression
