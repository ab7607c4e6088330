"""Laws on arrays, against CasADi case by case."""

from types import SimpleNamespace

import casadi as ca
import numpy as np
import pytest

from bridgectl import dampers
from bridgectl.dampers import SIGNALS, Strategy
from bridgectl.dampers.loop.batch_law import OPERATIONS, BatchLaw

rng = np.random.default_rng(0)
SHAPE = 3, 400


def random_signals():
    return {name: rng.normal(0, 1, SHAPE) for name in SIGNALS}


def by_casadi(law, signals):
    rows = np.array([signals[name].ravel() for name in SIGNALS])
    return law.evaluate(rows).reshape(SHAPE)


def test_what_is_foreseen_of_place_and_speed_is_what_is_evaluated_sample_by_sample():
    """With more gains than there are signals: none is taken for one."""
    gains = {f"k{i}": (1e3 * (i + 1), 0.0, 1e6) for i in range(len(SIGNALS) + 2)}

    def law(s, g):
        of_place = ca.if_else(s.position < 5, g.k0, g.k2) * s.speed / 25
        return of_place + sum(getattr(g, name) for name in gains) * ca.fabs(s.body_velocity)

    strategy, speeds = Strategy("own", law, 0, 1e6, gains), np.array([20.0, 25.0, 30.0])
    positions = speeds[:, np.newaxis] * np.linspace(0, 0.5, 6)
    batch = BatchLaw(strategy, [*speeds])
    batch.foresee(positions, speeds)
    for k in range(6):
        signals = random_signals()
        signals["position"] = np.broadcast_to(positions[:, [k]], SHAPE)
        signals["speed"] = np.broadcast_to(speeds[:, np.newaxis], SHAPE)
        assert np.array_equal(batch.command(signals, sample=k)[0], by_casadi(strategy, signals))


def test_every_operation_on_arrays_is_casadis_own():
    """One law for each, of two signals that are rarely out of its range."""
    built = {
        ca.OP_ADD: lambda a, b: a + b, ca.OP_SUB: lambda a, b: a - b,
        ca.OP_MUL: lambda a, b: a * b, ca.OP_DIV: lambda a, b: a / b,
        ca.OP_NEG: lambda a, b: -a, ca.OP_EXP: lambda a, b: ca.exp(a),
        ca.OP_LOG: lambda a, b: ca.log(ca.fabs(a)), ca.OP_POW: lambda a, b: ca.fabs(a) ** b,
        ca.OP_CONSTPOW: lambda a, b: a**3, ca.OP_SQRT: lambda a, b: ca.sqrt(ca.fabs(a)),
        ca.OP_SQ: lambda a, b: a**2, ca.OP_TWICE: lambda a, b: 2 * a,
        ca.OP_SIN: lambda a, b: ca.sin(a),
        ca.OP_COS: lambda a, b: ca.cos(a), ca.OP_TAN: lambda a, b: ca.tan(a),
        ca.OP_ASIN: lambda a, b: ca.asin(ca.sin(a)), ca.OP_ACOS: lambda a, b: ca.acos(ca.sin(a)),
        ca.OP_ATAN: lambda a, b: ca.atan(a), ca.OP_ATAN2: lambda a, b: ca.atan2(a, b),
        ca.OP_SINH: lambda a, b: ca.sinh(a), ca.OP_COSH: lambda a, b: ca.cosh(a),
        ca.OP_TANH: lambda a, b: ca.tanh(a), ca.OP_INV: lambda a, b: 1 / a,
        ca.OP_FABS: lambda a, b: ca.fabs(a), ca.OP_SIGN: lambda a, b: ca.sign(a),
        ca.OP_FLOOR: lambda a, b: ca.floor(3 * a), ca.OP_CEIL: lambda a, b: ca.ceil(3 * a),
        ca.OP_FMOD: lambda a, b: ca.fmod(a, b), ca.OP_COPYSIGN: lambda a, b: ca.copysign(a, b),
        ca.OP_FMIN: lambda a, b: ca.fmin(a, b), ca.OP_FMAX: lambda a, b: ca.fmax(a, b),
        ca.OP_LT: lambda a, b: 2 + (a < b) * b, ca.OP_LE: lambda a, b: 2 + (a <= b) * b,
        ca.OP_EQ: lambda a, b: 2 + (ca.sign(a) == ca.sign(b)) * b,
        ca.OP_NE: lambda a, b: 2 + (ca.sign(a) != ca.sign(b)) * b,
        ca.OP_NOT: lambda a, b: 2 + ca.logic_not(a < b) * b,
        ca.OP_AND: lambda a, b: (a < b) + 3 * ca.logic_and(a < 0, b > 0),
        ca.OP_OR: lambda a, b: (a < b) + 3 * ca.logic_or(a < 0, b > 0),
        ca.OP_IF_ELSE_ZERO: lambda a, b: ca.if_else(a < b, a, 1 / b),
        ca.OP_ASSIGN: lambda a, b: a,
    }  # fmt: skip
    assert set(built) == set(OPERATIONS)
    for build in built.values():
        law = Strategy(
            "one", lambda s, g, f=build: 500 + 100 * f(s.body_velocity, s.axle_velocity), 0, 1e3
        )
        batch, signals = BatchLaw(law, [20.0, 25.0, 30.0]), random_signals()
        assert batch.steps is not None
        assert batch.command(signals)[0] == pytest.approx(by_casadi(law, signals), rel=1e-13)


def test_an_operation_that_arrays_do_not_have_is_left_to_casadi():
    law = Strategy("erf", lambda s, g: 500 + 100 * ca.erf(g.scale * s.body_velocity), 0, 1e3,
                   {"scale": (2.0, 0.0, 5.0)})  # fmt: skip
    batch, signals = BatchLaw(law, [20.0, 25.0, 30.0]), random_signals()
    assert batch.steps is None
    assert batch.command(signals)[0] == pytest.approx(by_casadi(law, signals), rel=1e-13)


def test_laws_of_several_speeds_are_evaluated_together_if_only_constants_differ():
    class Faster(Strategy):
        def for_speed(self, speed):
            return Strategy("fast", lambda s, g: speed * ca.fabs(s.body_velocity), 0, 1e3)

    class Stranger(Strategy):
        def for_speed(self, speed):
            power = 2 if speed > 22 else 3
            return Strategy("odd", lambda s, g: speed * ca.fabs(s.body_velocity) ** power, 0, 1e3)

    speeds, signals = [20.0, 25.0, 30.0], random_signals()
    for kind, together in ((Faster, True), (Stranger, False)):
        own = kind("own", lambda s, g: 0 * s.speed, 0, 1e3)
        batch = BatchLaw(own, speeds)
        assert (batch.steps is not None) is together
        each = [by_casadi(own.for_speed(c), signals)[i] for i, c in enumerate(speeds)]
        assert batch.command(signals)[0] == pytest.approx(np.array(each), rel=1e-13)
        # The slowest speeds alone, as when the others have crossed.
        some = {name: values[:2] for name, values in signals.items()}
        assert batch.command(some)[0] == pytest.approx(np.array(each[:2]), rel=1e-13)


def test_what_is_the_same_for_all_roads_may_come_as_a_column():
    law = dampers.program([0, 5, 10], [1e3, 2e3, 3e3])
    signals = random_signals()
    signals["position"] = np.array([[-1.0], [6.0], [12.0]])
    assert np.array_equal(BatchLaw(law, [1, 2, 3]).command(signals)[0][:, 0], [1e3, 2e3, 3e3])


def test_gains_of_every_crossing_count_case_by_case():
    law = Strategy("gain", lambda s, g: g.k * s.speed, 0, 1e3, {"k": (1.0, 0.0, 10.0)})
    signals = random_signals()
    signals["speed"] = np.full((3, 1), 10.0)
    own = np.arange(12.0).reshape(3, 4)
    batch = BatchLaw(law, [10.0], {"k": own})
    part = {name: values[:2, :3] for name, values in signals.items()}
    assert np.array_equal(batch.command(part)[0], 10 * own[:2, :3])


def test_a_law_that_divides_by_zero_where_it_counts_is_named():
    law = Strategy("careless", lambda s, g: s.body_velocity / s.axle_velocity, 0, 1e3)
    signals = random_signals()
    signals["body_velocity"] = signals["axle_velocity"] = np.zeros(SHAPE)
    with pytest.raises(ValueError, match="careless returned NaN: guard divisions"):
        BatchLaw(law, [20.0]).command(signals)


def test_a_branch_that_is_not_taken_may_divide_by_zero():
    def law(s, g):
        return ca.if_else(ca.fabs(s.axle_velocity) > 1e-9, s.body_velocity / s.axle_velocity, 7.0)

    signals = SimpleNamespace(**random_signals())
    signals.axle_velocity = np.zeros(SHAPE)
    careful = Strategy("careful", law, 0, 1e3)
    assert np.all(BatchLaw(careful, [20.0]).command(vars(signals))[0] == 7.0)
