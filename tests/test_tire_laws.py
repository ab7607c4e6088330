"""Laws that watch the tire: where each switches, what force it wants, and what is refused."""

import dataclasses

import numpy as np
import pytest
from helpers import NO_DAMPERS, without_dampers
from hypothesis import given
from hypothesis import strategies as st

import bridgectl as bc
from bridgectl import dampers
from bridgectl.dampers import SIGNALS
from bridgectl.dampers.passive_theory import invariant_frequencies

SOFT, STIFF = 1e3, 30e3
TRUCK = bc.li2006.car()
LOAD, TIRE = 98.1e3, 1.8e6
LAWS = {
    "tire groundhook": dampers.tire_groundhook(SOFT, STIFF),
    "extended groundhook": dampers.extended_groundhook(SOFT, STIFF, vehicle=TRUCK),
    "selective groundhook": dampers.selective_groundhook(SOFT, STIFF, vehicle=TRUCK),
}
BARE = {
    "tire_damping": 0.0, "sky_damping": 0.0, "suspension_damping": 0.0,
    "tire_stiffness_change": 0.0, "travel_stiffness_change": 0.0,
}  # fmt: skip


@pytest.mark.parametrize("name", LAWS)
@given(
    values=st.lists(st.floats(-1e100, 1e100), min_size=len(SIGNALS), max_size=len(SIGNALS)),
    slow=st.booleans(),
)
def test_every_command_is_within_its_bounds_whatever_is_measured(name, values, slow):
    signals = dict(zip(SIGNALS, values, strict=True))
    if slow:
        signals["suspension_velocity"] = 1.01e-4  # the largest quotient F / v
    assert SOFT <= float(LAWS[name].command(**signals)) <= STIFF


@pytest.mark.parametrize("velocity", [0.0, 1e-4, -1e-4])
@pytest.mark.parametrize("name", LAWS)
def test_within_the_dead_band_a_law_is_soft(name, velocity):
    signals = {"body_velocity": 1.0, "tire_force": 0.0, "tire_force_rate": [1e6, -1e6]}
    found = LAWS[name].command(**signals, suspension_velocity=velocity)
    assert np.array_equal(found, [SOFT, SOFT])


@pytest.mark.parametrize("name", LAWS)
def test_a_law_goes_by_its_name_and_makes_c(name, tmp_path):
    assert LAWS[name].name == name
    assert "damping(" in LAWS[name].to_c(tmp_path / "damping.c").read_text()


@pytest.mark.parametrize("name", LAWS)
def test_nothing_but_what_can_be_measured_on_a_bridge_is_used(name):
    assert {"tire_force_rate", "suspension_velocity"} <= set(
        LAWS[name].with_gains(**({"tire_damping": 1e3} if "extended" in name else {})).used
    )
    assert not {"position", "speed"} & set(LAWS[name].used)


def test_the_tire_groundhook_is_stiff_where_its_force_works_against_the_tire():
    rates, velocity = np.meshgrid([-5.0, 0.0, 5e4], [-0.2, 0.2])
    found = LAWS["tire groundhook"].command(tire_force_rate=rates, suspension_velocity=velocity)
    assert np.array_equal(found, np.where(-rates * velocity > 0, STIFF, SOFT))


def test_on_a_level_road_both_groundhooks_are_one():
    """There the surface rests, and e' = y_t'."""
    rng = np.random.default_rng(0)
    axle, v = rng.normal(size=(2, 1000))
    inertial = dampers.groundhook(SOFT, STIFF).command(axle_velocity=axle, suspension_velocity=v)
    tire = LAWS["tire groundhook"].command(tire_force_rate=TIRE * axle, suspension_velocity=v)
    assert np.array_equal(inertial, tire)


@pytest.mark.parametrize(
    ("gain", "signals", "force"),
    [
        ({"tire_damping": 10e3}, {"tire_force_rate": -0.2 * TIRE}, 2e3),
        ({"sky_damping": 10e3}, {"body_velocity": 0.2}, 2e3),
        ({"suspension_damping": 10e3}, {}, 1e3),
        ({"tire_stiffness_change": 100e3}, {"tire_force": LOAD - 0.02 * TIRE}, 2e3),
        ({"travel_stiffness_change": 100e3}, {"suspension_travel": 0.02}, 2e3),
    ],
)
def test_each_gain_of_the_extended_groundhook_brings_its_force(gain, signals, force):
    law = LAWS["extended groundhook"].with_gains(**{**BARE, **gain})
    measured = {"tire_force": LOAD, **signals, "suspension_velocity": 0.1}
    found = law.with_gains(**gain).command(**measured)
    assert found == pytest.approx(force / 0.1, rel=1e-9)


def test_the_extended_groundhook_gives_the_nearest_bound_to_a_force_out_of_reach():
    law = LAWS["extended groundhook"].with_gains(**{**BARE, "sky_damping": 1e6})
    signals = {"tire_force": LOAD, "suspension_velocity": [0.1, -0.1, 0.1, -0.1]}
    found = law.command(**signals, body_velocity=[1.0, 1.0, -1.0, -1.0])
    assert np.array_equal(found, [STIFF, SOFT, SOFT, STIFF])


def test_the_defaults_of_the_extended_groundhook_are_gains_that_can_be_changed():
    law = LAWS["extended groundhook"]
    assert law.gains == {
        **BARE, "suspension_damping": 16e3, "tire_stiffness_change": 100e3,
        "travel_stiffness_change": -70e3, "static_load": LOAD, "tire_stiffness": TIRE,
        "dead_band": 1e-4,
    }  # fmt: skip
    heavier = law.with_gains(static_load=2 * LOAD)
    signals = {"suspension_velocity": 0.1, "suspension_travel": 0.01}
    assert heavier.command(tire_force=2 * LOAD, **signals) == law.command(
        tire_force=LOAD, **signals
    )


@pytest.mark.parametrize("direction", [-1, 1])
def test_the_selective_groundhook_is_a_groundhook_above_its_crossover_only(direction):
    """An oscillation of the tire force, seen where its rate is the crossover times itself."""
    law = LAWS["selective groundhook"]
    crossover = 2 * np.pi * invariant_frequencies(TRUCK).tire_force[-1]
    assert law.gains["crossover"] == pytest.approx(crossover)
    for change in (-5e3, 5e3):
        rate = -direction * crossover * abs(change) * np.array([0.99, 1.01])
        signals = {"tire_force": LOAD + change, "tire_force_rate": rate}
        agreeing = law.command(**signals, suspension_velocity=direction * 0.1)
        assert np.array_equal(agreeing, [SOFT, STIFF])
        against = law.command(**signals, suspension_velocity=-direction * 0.1)
        assert np.array_equal(against, [SOFT, SOFT])


def test_without_crossover_the_selective_groundhook_is_the_tire_groundhook():
    law = LAWS["selective groundhook"].with_gains(crossover=0.0)
    rng = np.random.default_rng(1)
    rates, v = rng.normal(size=(2, 1000))
    signals = {"tire_force_rate": rates, "suspension_velocity": v}
    expected = LAWS["tire groundhook"].command(**signals)
    assert np.array_equal(law.command(tire_force=LOAD + 1e3, **signals), expected)


def test_a_given_crossover_is_kept_and_the_vehicle_gives_the_load():
    heavy = dataclasses.replace(TRUCK, sprung_mass=11e3)
    law = dampers.selective_groundhook(SOFT, STIFF, vehicle=heavy, crossover=20.0)
    assert law.gains["crossover"] == 20.0
    assert law.gains["static_load"] == pytest.approx(12e3 * 9.81)


@pytest.mark.parametrize(
    ("make", "error", "message"),
    [
        (lambda: dampers.tire_groundhook(STIFF, SOFT), ValueError, "c_min must not exceed c_max"),
        (lambda: dampers.tire_groundhook(SOFT, STIFF, dead_band=-1), ValueError, "gain dead_band"),
        (
            lambda: dampers.extended_groundhook(SOFT, STIFF, vehicle=without_dampers()),
            ValueError,
            NO_DAMPERS,
        ),
        (
            lambda: dampers.extended_groundhook(SOFT, STIFF, vehicle=TRUCK, tire_damping=-1),
            ValueError,
            "tire_damping must be 0 or more",
        ),
        (
            lambda: dampers.extended_groundhook(SOFT, STIFF, vehicle=TRUCK, sky_damping=-1),
            ValueError,
            "sky_damping must be 0 or more",
        ),
        (
            lambda: dampers.extended_groundhook(SOFT, STIFF, vehicle=TRUCK, suspension_damping="a"),
            TypeError,
            "gain suspension_damping must be one number",
        ),
        (
            lambda: dampers.selective_groundhook(SOFT, STIFF, vehicle=None),
            TypeError,
            "vehicle must be a QuarterCar",
        ),
        (
            lambda: dampers.selective_groundhook(SOFT, STIFF, vehicle=TRUCK, crossover=-1),
            ValueError,
            "crossover must be 0 or more",
        ),
        (
            lambda: LAWS["extended groundhook"].with_gains(tire_stiffness=0),
            ValueError,
            "tire_stiffness = 0 is outside its bounds",
        ),
    ],
)
def test_each_mistake_is_named(make, error, message):
    with pytest.raises(error, match=message):
        make()


def test_a_nan_is_told():
    with pytest.raises(ValueError, match="extended groundhook returned NaN"):
        LAWS["extended groundhook"].command(body_velocity=np.nan, suspension_velocity=0.1)
