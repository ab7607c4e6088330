"""Laws that are no CasADi expression of one damping: each slip is met by a word that names it."""

import math
import warnings

import casadi as ca
import numpy as np
import pytest

import bridgectl as bc
from bridgectl.dampers import SIGNALS, Strategy
from bridgectl.dampers.loop.batch_law import BatchLaw

SOFT, STIFF = 1e3, 30e3


def own(law, **gains):
    return Strategy("own", law, SOFT, STIFF, {key: (value, 0, 1e9) for key, value in gains.items()})


PYTHON = {
    "if": (lambda s, g: g.c_max if s.suspension_velocity > 0 else g.c_min, "ca.if_else"),
    "== in if": (lambda s, g: 5e3 if s.suspension_velocity == 0 else 1e3, "ca.if_else"),
    "and": (lambda s, g: ca.if_else(s.body_velocity > 0 and s.axle_velocity > 0, 5e3, 2e3),
            "ca.logic_and"),
    "or": (lambda s, g: ca.if_else(s.body_velocity > 0 or s.axle_velocity > 0, 5e3, 2e3),
           "ca.logic_or"),
    "not": (lambda s, g: ca.if_else(not s.body_velocity > 0, 5e3, 2e3), "ca.logic_not"),
    "a < b < c": (lambda s, g: ca.if_else(0 < s.body_velocity < 1, 5e3, 2e3), "ca.logic_and"),
    "&": (lambda s, g: ca.if_else((s.body_velocity > 0) & (s.axle_velocity > 0), 5e3, 2e3),
          "ca.logic_and"),
    "max": (lambda s, g: max(1e4 * s.body_velocity, 2e3), "ca.fmax"),
    "min": (lambda s, g: min([1e4 * s.body_velocity, 2e3]), "ca.fmin"),
    "any": (lambda s, g: 5e3 if any([s.body_velocity > 0]) else 2e3, "ca.logic_or"),
    "math.sqrt": (lambda s, g: 1e4 * math.sqrt(abs(s.body_velocity)), "ca.sqrt"),
    "math.copysign": (lambda s, g: 5e3 + 1e3 * math.copysign(1, s.body_velocity), "and so on"),
    "math.isnan": (lambda s, g: 5e3 if math.isnan(s.body_velocity) else 1e3, "ca.if_else"),
    "float in if": (lambda s, g: 5e3 if float(s.body_velocity) > 0 else 1e3, r"no float\(\)"),
    "float of a gain": (lambda s, g: float(g.k) + 0 * s.speed, r"no float\(\)"),
    "numpy of floats": (lambda s, g: np.array([s.body_velocity], dtype=float)[0], r"no float\(\)"),
    "int": (lambda s, g: 1e3 * int(s.body_velocity), r"int\(\)"),
    "index": (lambda s, g: [1e3, 2e3][s.body_velocity > 0], "ca.if_else"),
    "look-up": (lambda s, g: {True: 1e3}[s.body_velocity > 0], "ca.if_else"),
    "method": (lambda s, g: s.body_velocity.clip(1e3, 2e3), "ca.fmax and ca.fmin"),
}  # fmt: skip
"""Python's own way, and what the message says instead of it."""


@pytest.mark.parametrize("way", PYTHON)
def test_pythons_own_ways_with_numbers_are_told_with_what_to_type_instead(way):
    """Some were CasADi's bare C++ error; float() was NaN, so that a branch was taken in silence."""
    law, instead = PYTHON[way]
    with pytest.raises(ValueError, match=f"(?s)the law of own fails: .*{instead}") as caught:
        own(law, k=5e3)
    assert ".cpp" not in str(caught.value)
    assert caught.value.__cause__ is not None


def test_a_number_that_casadi_knows_may_become_a_float():
    law = own(lambda s, g: float(ca.SX(3e3)) + 1e3 * abs(s.body_velocity))
    assert law.command(body_velocity=1.0) == 4e3


def test_float_of_an_expression_is_casadis_own_again_after_a_law_is_built_or_fails():
    before = ca.SX.__float__
    own(lambda s, g: 5e3)
    with pytest.raises(ValueError, match="the law of own fails"):
        own(lambda s, g: math.exp(s.speed))
    assert ca.SX.__float__ is before


@pytest.mark.parametrize(
    ("law", "error", "message"),
    [
        (lambda s, g: None, ValueError, "must return one number.*got None, a function without ret"),
        (lambda s, g: "hard", ValueError, "must return one number or expression, got 'hard'"),
        (lambda s, g: 5e3 + 1j, ValueError, "must return one number or expression"),
        (lambda s, g: ca.MX.sym("x"), ValueError, "must return one number or expression"),
        (lambda s, g: (g.c_min, g.c_max), ValueError, r"must return one number, got \(2, 1\)"),
        (lambda s, g: np.array([1e3, 2e3]), ValueError, r"must return one number, got \(2, 1\)"),
        (lambda s, g: s.body_velocity > 0, ValueError, "a condition.*ca.if_else"),
        (lambda s, g: ca.logic_not(s.body_velocity > 0), ValueError, "a condition.*ca.if_else"),
        (lambda s, g: True, ValueError, "a condition.*ca.if_else"),
        (lambda s, g: ca.SX.sym("mine") * 5e3, ValueError, "a symbol of its own"),
        (lambda s: 5e3, TypeError, r"must be a function law\(s, g\).*got one of \(s\)"),
        (lambda s, g, k: 5e3, TypeError, r"must be a function law\(s, g\).*got one of \(s, g, k\)"),
        (lambda s, g: {}["key"], ValueError, " fails: KeyError: 'key'$"),
        (lambda s, g: ca.if_esle(s.speed > 0, 1e3, 2e3), ValueError, "no attribute 'if_esle'$"),
        (lambda s, g: s.sped, ValueError, "unknown name .*'sped'.*signals: body_velocity"),
    ],
)  # fmt: skip
def test_what_is_no_damping_is_told_with_the_name_of_the_strategy(law, error, message):
    with pytest.raises(error, match=f"the law of own.*{message}"):
        own(law)


def test_a_law_that_python_knows_no_signature_of_is_called_all_the_same():
    class Odd:
        __signature__ = "none"

        def __call__(self, s, g):
            return 5e3 + 0 * s.speed

    assert own(Odd()).command(speed=1.0) == 5e3


@pytest.mark.parametrize(
    ("law", "bounds", "message"),
    [
        (lambda s, g: 15e3 * s.suspension_velocity, (SOFT, STIFF), "its sign with the motion"),
        (
            lambda s, g: 9e3 * s.body_velocity - 2e4 * s.suspension_travel,
            (0, STIFF),
            "its sign with the motion, as a force",
        ),
        (lambda s, g: 5 + ca.fabs(s.body_velocity), (SOFT, STIFF), "give all of them in N s/m"),
        (lambda s, g: 0.007 + 0 * s.speed, (SOFT, STIFF), "returns 0.007 to 0.007 where c_min"),
        (lambda s, g: 7e3 + 0 * s.speed, (1, 30), "returns 7e.03 to 7e.03 where c_min and c_max"),
    ],
)
def test_a_force_or_a_damping_in_another_unit_is_warned_of_where_it_is_typed(law, bounds, message):
    with pytest.warns(UserWarning, match=f"the law of own.*{message}") as caught:
        Strategy("own", law, *bounds)
    assert caught[0].filename == __file__


@pytest.mark.parametrize(
    "law",
    [
        lambda s, g: s.body_velocity / s.suspension_velocity * 1e4,
        lambda s, g: ca.if_else(s.suspension_velocity > 0, 2e3, 20e3),
        lambda s, g: g.k * ca.fabs(s.suspension_velocity),
        lambda s, g: 40e3 + 0 * s.speed,
        lambda s, g: -1e3 * s.position,
    ],
)
def test_laws_that_make_sense_are_not_warned_of(law):
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        own(law, k=0.0)


# Large commands: clipped; infinite ones and NaN: told. In CasADi, on arrays, in a block alike


def routes(law):
    """The command for v by CasADi, on arrays, and by the block."""
    zeros = {name: np.zeros((1, 1)) for name in SIGNALS}
    block = law.system(25.0)
    return {
        "casadi": lambda v: float(law.command(suspension_velocity=v)),
        "arrays": lambda v: float(
            BatchLaw(law, [25.0]).command(zeros | {"suspension_velocity": np.full((1, 1), v)})[0][
                0, 0
            ]
        ),
        "block": lambda v: float(block.output(0.0, [], [0, 0, 0, v])[1]),
    }


@pytest.mark.parametrize("way", ["casadi", "arrays", "block"])
def test_a_large_finite_command_is_clipped_and_an_infinite_one_is_told(way):
    inverse = routes(own(lambda s, g: 5e3 / s.suspension_velocity + 1.0))[way]
    assert inverse(1e-9) == inverse(1e-300) == STIFF
    assert inverse(-1e-9) == SOFT
    assert inverse(0.5) == 10e3 + 1
    with pytest.raises(ValueError, match="the law of own returned infinity, a division by 0"):
        inverse(0.0)
    undefined = routes(own(lambda s, g: s.suspension_velocity / s.suspension_velocity**2 + 1.0))
    with pytest.raises(ValueError, match="the law of own returned NaN: guard divisions"):
        undefined[way](0.0)


def test_dry_friction_with_a_guard_of_1e_9_has_the_daf_of_one_of_1e_6(bridge, truck):
    """c = 5 kN / max(|v|, guard): 5e12 and 5e9 N s/m at rest are both c_max."""
    road = bc.iso8608_profile("C", 45, seed=1, start=-20)

    def daf(guard):
        law = own(lambda s, g: 5e3 / ca.fmax(ca.fabs(s.suspension_velocity), guard))
        return bc.daf(bridge, truck, [25.0], road, start=-20, damper=law)

    assert np.array_equal(daf(1e-9), daf(1e-6))
