"""A strategy's command for many speeds and roads at once: its CasADi expression on numpy arrays.

CasADi evaluates an expression case by case. Here each of its operations is done for all cases
before the next one, on arrays of signals that broadcast: many times faster for some thousand
cases, and what depends on position or speed alone is computed once for all roads.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import Any, NamedTuple

import casadi as ca
import numpy as np
from numpy.typing import ArrayLike

from bridgectl._checks import FloatArray
from bridgectl.dampers.compiled import compiled
from bridgectl.dampers.expression import INPUTS, SAMPLE_TIME, at_sample, numbers
from bridgectl.dampers.strategy import Strategy

Operation = Callable[..., Any]

OPERATIONS: dict[int, Operation] = {
    ca.OP_ASSIGN: lambda a: a,
    ca.OP_ADD: np.add,
    ca.OP_SUB: np.subtract,
    ca.OP_MUL: np.multiply,
    ca.OP_DIV: np.divide,
    ca.OP_NEG: np.negative,
    ca.OP_EXP: np.exp,
    ca.OP_LOG: np.log,
    ca.OP_POW: np.power,
    ca.OP_CONSTPOW: np.power,
    ca.OP_SQRT: np.sqrt,
    ca.OP_SQ: np.square,
    ca.OP_TWICE: lambda a: 2.0 * a,
    ca.OP_SIN: np.sin,
    ca.OP_COS: np.cos,
    ca.OP_TAN: np.tan,
    ca.OP_ASIN: np.arcsin,
    ca.OP_ACOS: np.arccos,
    ca.OP_ATAN: np.arctan,
    ca.OP_ATAN2: np.arctan2,
    ca.OP_SINH: np.sinh,
    ca.OP_COSH: np.cosh,
    ca.OP_TANH: np.tanh,
    ca.OP_INV: lambda a: 1.0 / a,
    ca.OP_FABS: np.abs,
    ca.OP_SIGN: np.sign,
    ca.OP_FLOOR: np.floor,
    ca.OP_CEIL: np.ceil,
    ca.OP_FMOD: np.fmod,
    ca.OP_COPYSIGN: np.copysign,
    ca.OP_FMIN: np.fmin,
    ca.OP_FMAX: np.fmax,
    # Truth is 1.0 in CasADi, and counts as a number.
    ca.OP_LT: lambda a, b: np.multiply(np.less(a, b), 1.0),
    ca.OP_LE: lambda a, b: np.multiply(np.less_equal(a, b), 1.0),
    ca.OP_EQ: lambda a, b: np.multiply(np.equal(a, b), 1.0),
    ca.OP_NE: lambda a, b: np.multiply(np.not_equal(a, b), 1.0),
    ca.OP_NOT: lambda a: np.multiply(np.logical_not(a), 1.0),
    ca.OP_AND: lambda a, b: np.multiply(np.logical_and(a, b), 1.0),
    ca.OP_OR: lambda a, b: np.multiply(np.logical_or(a, b), 1.0),
    ca.OP_IF_ELSE_ZERO: lambda a, b: np.where(a, b, 0.0),
}
"""What CasADi's operations are on arrays."""

NOTHING = np.zeros((1, 0, 1))
"""Memory, and what is seen ahead, of a law without."""


class BatchLaw:
    """The `Controller` that is a strategy, of S speeds [m/s] and R roads.

    `gains` are those that differ between cases, by name, shape (S, R); `sample_time` is the time
    between samples [s]. See `Strategy.for_speed` and `Strategy.gains_for`.
    """

    def __init__(
        self,
        strategy: Strategy,
        speeds: Sequence[float],
        gains: Mapping[str, FloatArray] | None = None,
        sample_time: float = SAMPLE_TIME,
    ) -> None:
        self.name, self.own_gains = strategy.name, dict(gains or {})
        self.sample_time = sample_time
        at_speeds = [strategy.for_speed(float(speed)) for speed in speeds]
        self.laws = at_speeds[:1] if all(law is strategy for law in at_speeds) else at_speeds
        if len({(law.signals, *law.states, len(law.preview)) for law in self.laws}) > 1:
            raise ValueError(
                f"{self.name} must have the same states at every speed, and as many distances of "
                "preview, and measure at the same legs"
            )
        self.signals = self.laws[0].signals
        self.preview: FloatArray = np.array([law.preview for law in self.laws], dtype=np.float64)
        self.steps = _merged([law.function for law in self.laws])
        self.functions = [] if self.steps else [compiled(law.function) for law in self.laws]
        self._know({})

    def start(self, n_speeds: int, n_roads: int) -> FloatArray:
        """See `Controller.start`."""
        own = np.array([[*law.states.values()] for law in self.laws], dtype=np.float64)
        return np.tile(own[..., np.newaxis], (n_speeds // len(own), 1, n_roads))

    def foresee(self, positions: FloatArray, speeds: FloatArray) -> None:
        """Evaluate ahead of all samples what depends on place and speed alone.

        Positions [m] have the shape (speeds, samples), speeds [m/s] the shape (speeds,).
        """
        self._know({"position": positions, "speed": speeds[:, np.newaxis]})

    def _know(self, signals: dict[str, FloatArray]) -> None:
        """Do all steps that take no other signals: constants at least."""
        steps, known = self.steps or [], dict[int, Any]()
        given = {"sample_time": self.sample_time, **signals}
        with np.errstate(all="ignore"):
            for k, step in enumerate(steps):
                if step.operation == ca.OP_CONST:
                    several = len(step.constant) > 1
                    known[k] = step.constant[:, np.newaxis] if several else step.constant[0]
                elif step.operation == ca.OP_INPUT:
                    if (name := _told(step, self.signals)) in given:
                        known[k] = given[name]
                elif all(i in known for i in step.takes):
                    known[k] = _operation(step)(*[known[i] for i in step.takes])
        remaining = [k for k in range(len(steps)) if k not in known]
        # Only what is taken later is kept: tables of many places are long.
        given_back = sorted((step.gives, k) for k, step in enumerate(steps) if step.gives)
        self.outputs = [k for _, k in given_back]
        taken = {i for k in remaining for i in steps[k].takes} | set(self.outputs)
        kept = {k: value for k, value in known.items() if k in taken}
        # Told apart once, since a sample of few cases takes hardly longer than to do so.
        self.inputs = [(k, steps[k]) for k in remaining if steps[k].operation == ca.OP_INPUT]
        self.operations = [
            (k, _operation(steps[k]), steps[k].takes)
            for k in remaining
            if steps[k].operation != ca.OP_INPUT
        ]
        self.known = {k: value for k, value in kept.items() if np.ndim(value) == 0}
        self.tables = [(k, value) for k, value in kept.items() if np.ndim(value)]

    def command(
        self,
        signals: Mapping[str, ArrayLike],
        memory: FloatArray = NOTHING,
        ahead: FloatArray = NOTHING,
        sample: int = 0,
    ) -> tuple[FloatArray, FloatArray]:
        """See `Controller.command`; NaN and infinity of a law or an update are errors.

        `sample` is one of those foreseen. Signals tell the shape (S, R) by what they broadcast to.
        """
        shape = np.broadcast_shapes(*{np.shape(value) for value in signals.values()})
        inputs = signals, self._gains(shape), memory, ahead
        if self.steps is None:
            return self._one_by_one(inputs, shape)
        with np.errstate(all="ignore"):  # a branch that is not taken may divide by zero
            found, *after = self._together(inputs, shape, sample)
            c = numbers(f"law of {self.name}", found)
            if not after:
                return c, memory
            return c, numbers(f"update of {self.name}", np.stack(after, axis=1))

    def _together(self, inputs: _Inputs, shape: tuple[int, ...], sample: int) -> list[FloatArray]:
        """Step after step, each for all cases."""
        values: dict[int, Any] = dict(self.known)
        for k, table in self.tables:
            column = sample if table.shape[1] > 1 else 0
            values[k] = table[: shape[0], column : column + 1]
        for k, step in self.inputs:
            values[k] = _input(step, self.signals, *inputs)
        for k, operation, takes in self.operations:
            values[k] = operation(*[values[i] for i in takes])
        return [np.broadcast_to(values[k], shape) for k in self.outputs]

    def _one_by_one(self, inputs: _Inputs, shape: tuple[int, ...]) -> tuple[FloatArray, FloatArray]:
        """Case by case in CasADi, for operations that are not among those above."""
        signals, gains, *others = inputs
        memory, ahead = (np.moveaxis(values, 1, 0) for values in others)
        columns = [signals[name] for name in self.signals], gains, memory, [self.sample_time], ahead
        rows = np.array([np.broadcast_to(case, shape) for each in columns for case in each])
        ends = np.cumsum([len(each) for each in columns])[:-1]
        several = np.split(rows, shape[0], axis=1) if len(self.laws) > 1 else [rows]
        found = [
            at_sample(self.name, function, *np.split(part.reshape(len(part), -1), ends))
            for function, part in zip(self.functions, several, strict=False)
        ]
        c, after = (np.concatenate(each, axis=-1) for each in zip(*found, strict=True))
        return c.reshape(shape), np.moveaxis(after.reshape(-1, *shape), 0, 1)

    def _gains(self, shape: tuple[int, ...]) -> list[Any]:
        """Values of the gains, of those cases that are asked for."""
        here = tuple(slice(0, size) for size in shape)
        own = {name: values[here] for name, values in self.own_gains.items()}
        return [own.get(name, value) for name, value in self.laws[0].gains.items()]


class _Step(NamedTuple):
    """One operation of a CasADi expression, for laws that differ in their constants alone."""

    operation: int
    takes: tuple[int, ...]
    """The steps whose results it takes; of an input, which argument and which entry of it."""
    gives: tuple[int, ...]
    """Of an output, which result and which entry of it."""
    constant: FloatArray
    """A constant's value, one for all laws or one for each."""


def _merged(functions: Sequence[ca.Function]) -> list[_Step] | None:
    """Steps of functions that differ in their constants alone; None where they do not."""
    first, *others = [_steps(function) for function in functions]
    alike = all([step[:3] for step in other] == [step[:3] for step in first] for other in others)
    special = {ca.OP_CONST, ca.OP_INPUT, ca.OP_OUTPUT}
    if not alike or not {step.operation for step in first} <= special | set(OPERATIONS):
        return None
    merged = []
    for step, *same in zip(first, *others, strict=True):
        every = np.concatenate([step.constant, *(other.constant for other in same)])
        equal = bool(np.all(every == every[0]) or np.isnan(every).all())
        merged.append(step._replace(constant=every[:1] if equal else every))
    return merged


def _steps(function: ca.Function) -> list[_Step]:
    """The operations of a function."""
    made_by: dict[int, int] = {}  # places of the work vector, which are used again and again
    steps = []
    for k in range(function.n_instructions()):
        operation = function.instruction_id(k)
        takes = tuple(function.instruction_input(k))
        constant = function.instruction_constant(k) if operation == ca.OP_CONST else 0.0
        if operation not in (ca.OP_CONST, ca.OP_INPUT):
            takes = tuple(made_by[place] for place in takes)
        gives = tuple(function.instruction_output(k))
        if operation != ca.OP_OUTPUT:
            made_by.update(dict.fromkeys(gives, k))
            gives = ()
        steps.append(_Step(operation, takes, gives, np.array([constant])))
    return steps


def _told(step: _Step, names: Sequence[str]) -> str | None:
    """Name of the signal that an input is, or 'sample_time'; None of others."""
    which, entry = step.takes
    return names[entry] if which == 0 else INPUTS[which] if INPUTS[which] == "sample_time" else None


_Inputs = tuple[Mapping[str, ArrayLike], list[Any], FloatArray, FloatArray]
"""Signals by name, gains, states and what is seen ahead."""


def _input(
    step: _Step, names: Sequence[str], signals: Mapping[str, Any], gains: list[Any],
    memory: FloatArray, ahead: FloatArray,
) -> Any:  # fmt: skip
    """What a step reads, but for the sample time, which is known."""
    which, entry = step.takes
    if which == 0:
        return signals[names[entry]]
    return gains[entry] if which == 1 else (memory if which == 2 else ahead)[:, entry]


def _operation(step: _Step) -> Operation:
    return OPERATIONS[ca.OP_ASSIGN if step.operation == ca.OP_OUTPUT else step.operation]
