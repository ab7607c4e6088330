"""What is seen ahead comes with noise, and late: of any strategy with preview, in closed loops."""

import numpy as np
import pytest

import bridgectl as bc
from bridgectl.dampers import Damper, Strategy, preview_hook, rollout_hook, simulate_loop
from bridgectl.dampers.fitted import fitted
from bridgectl.dampers.told import told_of
from bridgectl.road import iso8608_elevations

BEAM = bc.Beam(8.0, 15e3, 15e3 * (2 * np.pi * 7) ** 2 * (8.0 / np.pi) ** 4, 2, 0.02)
CAR = bc.QuarterCar(8e3, 800.0, 1.5e5, 1.8e6, 7e3)
X = -4 + 0.1 * np.arange(121)
SPEEDS, STEP = np.array([20.0, 25.0]), 4e-3
ROADS = iso8608_elevations(8, "B", 12, seed=2)
BOUNDS = 1e3, 30e3

TELLING = Strategy(
    "telling", lambda s, g: 15e3 + 1e5 * (s.ahead[0] + 2 * s.ahead[1]), *BOUNDS, preview=[1.0, 3.0]
)
"""Its damping tells what it sees, 1e5 N s/m for each metre."""


def told(roads=ROADS, speeds=SPEEDS, **sensor):
    """Dampings of each speed, (R, samples)."""
    damper = Damper(TELLING, STEP, **sensor)
    histories = simulate_loop(BEAM, CAR, damper, speeds, X, roads, record=["damping"]).histories
    return [each["damping"] for each in histories]


def test_late_elevations_are_those_seen_so_long_ago():
    """By seven samples: to 1e-6 N s/m of some thousand; at first the road before was level."""
    for now, late in zip(told(), told(preview_delay=7 * STEP), strict=True):
        assert late[:, 7:] == pytest.approx(now[:, :-7], abs=1e-6)
        assert np.abs(late[:, 7:] - now[:, 7:]).max() > 300


def test_noise_of_the_preview_is_white_of_its_deviation_and_each_readings_own():
    """3 mm on each of two elevations: 3 sqrt(5) mm of their sum with a factor of 2."""
    noises = [
        (noisy - now) / 1e5
        for now, noisy in zip(told(), told(preview_noise=3e-3), strict=True)
    ]  # fmt: skip
    every = np.concatenate([each.ravel() for each in noises])
    assert np.std(every) == pytest.approx(3e-3 * np.sqrt(5), rel=0.05)
    own = noises[0][0]
    assert abs(np.corrcoef(own[1:], own[:-1])[0, 1]) < 0.25
    assert abs(np.corrcoef(own, noises[0][1])[0, 1]) < 0.25


def test_noise_of_the_preview_is_the_same_alone_and_in_a_batch_and_another_of_another_seed():
    together = told(preview_noise=3e-3)
    (alone,) = told(ROADS[1], SPEEDS[1], preview_noise=3e-3)
    assert alone[0] == pytest.approx(together[1][1], abs=1e-6)
    (other,) = told(ROADS[1], SPEEDS[1], preview_noise=3e-3, seed=1)
    assert np.abs(other - alone).max() > 100


def test_noise_of_the_preview_leaves_that_of_other_sensors_as_it_is():
    found = [
        simulate_loop(
            BEAM, CAR, Damper(TELLING, STEP, velocity_noise=0.05, seed=4, preview_noise=noise),
            25.0, X, ROADS[:1], record=["body_velocity"],
        ).histories[0]["body_velocity"][0, 0]
        for noise in (0.0, 3e-3)
    ]  # fmt: skip
    assert found[0] == found[1] != 0


def test_studies_with_another_sensor_are_others():
    plain, noisy, late = (
        told_of(fitted(Damper(TELLING, **sensor), CAR), SPEEDS)
        for sensor in ({}, {"preview_noise": 1e-3}, {"preview_delay": 1e-3})
    )
    assert plain != noisy != late != plain


# What preview_hook and rollout_hook take


CASE = BEAM, CAR, *BOUNDS


@pytest.mark.parametrize(
    ("make", "options", "says"),
    [
        (preview_hook, {"preview": 0.0}, "preview must be .*above 0"),
        (preview_hook, {"road_map": [0.0, 1.0]}, "road must be a RoadProfile"),
        (rollout_hook, {"hold": 4.0}, "hold must be at most 0.1 s.*for 4 ms type 0.004"),
    ],
)
def test_what_is_no_rollout_is_told(make, options, says):
    with pytest.raises((TypeError, ValueError), match=says):
        make(*CASE, **options)


def test_other_vehicles_are_referred_to_bridgehook():
    truck = CAR.linear
    with pytest.raises(TypeError, match=r"vehicle must be a QuarterCar.*bridgehook takes every"):
        rollout_hook(CASE[0], truck, *BOUNDS)


def test_a_rollout_has_a_law_for_each_speed():
    law = preview_hook(*CASE, preview=0.25)
    assert "preview=0.25 m" in repr(law)
    assert law.for_speed(25.0).preview == pytest.approx([0.25 / 3, 0.5 / 3, 0.25])
    with pytest.raises(ValueError, match=r"preview 0\.25 m has a law for each speed"):
        law.command(speed=[20.0, 25.0])
    with pytest.raises(ValueError, match=r"preview 0\.25 m has a law for each speed"):
        law.to_c("law.c")
    road = bc.RoadProfile([0, 25], [0, 0])
    assert "road_map=RoadProfile" in repr(preview_hook(*CASE, road_map=road))
