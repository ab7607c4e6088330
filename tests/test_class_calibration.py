"""The mean over a road class from simulated mirror pairs, and single roads estimated about it."""

import numpy as np
import pytest
import threadpoolctl
from test_closed_loop import LAWS, SOFT, STIFF

import bridgectl as bc
from bridgectl import calibrated_class_dae
from bridgectl.dampers import Damper, bridgehook, passive, simulate_loop
from bridgectl.road import iso8608_elevations

SPEEDS = np.array([108, 60, 90]) / 3.6
OPTIONS = {"approach": 20, "ramp_height": "A", "both_ways": True}


@pytest.fixture(scope="module")
def surface(bridge, truck):
    """A linear one."""
    return bc.ramp_surface(bridge, truck, SPEEDS, **OPTIONS)


@pytest.fixture(scope="module")
def hooked(bridge, truck):
    return bc.ramp_surface(bridge, truck, SPEEDS, every=25, damper=LAWS["bridgehook"], **OPTIONS)


def pairs(n_pairs, seed, iso_class="A"):
    """Roads on 20 m of approach and the bridge, shape (2, n_pairs, n): as they are and mirrored."""
    roads = iso8608_elevations(n_pairs, iso_class, 45, seed=seed)
    return np.array([roads, -roads])


# The mean


@pytest.mark.parametrize(("which", "name"), [("surface", "passive"), ("hooked", "bridgehook")])
@pytest.mark.slow
def test_the_mean_is_that_of_each_road_and_its_mirror_image_simulated_alone(
    request, bridge, truck, which, name
):
    """By `daf` of one road at a time, in class B; within 1e-4 of the static moment."""
    found = request.getfixturevalue(which)
    law = None if which == "surface" else LAWS[name]
    calibrated = calibrated_class_dae(found, "B", mirror_pairs=3, seed=4, damper=law)
    alone = [
        [bc.daf(bridge, truck, SPEEDS, bc.RoadProfile(found.stations, z), start=-20, damper=law)
         for z in roads]
        for roads in pairs(3, 4, "B")
    ]  # fmt: skip
    each = np.mean(alone, axis=0)
    assert calibrated.mean == pytest.approx(each.mean(axis=0), abs=1e-4)
    expected = each.std(axis=0, ddof=1) / np.sqrt(3)
    assert calibrated.standard_error == pytest.approx(expected, abs=1e-4)


@pytest.mark.quick_cases(1)
@pytest.mark.parametrize("which", ["surface", "hooked"])
def test_the_mean_is_as_far_from_that_of_many_roads_as_its_standard_error_says(
    request, bridge, truck, which
):
    """Of 150 other pairs: within 4 standard errors of the difference."""
    found = request.getfixturevalue(which)
    law = LAWS["passive" if which == "surface" else "bridgehook"]
    calibrated = calibrated_class_dae(found, "A", mirror_pairs=25, damper=law)
    others = pairs(150, 99).reshape(300, -1)
    dafs = simulate_loop(bridge, truck, law, SPEEDS, found.stations, others).daf.T
    each = dafs.reshape(2, 150, -1).mean(axis=0)
    error = np.hypot(calibrated.standard_error, each.std(axis=0, ddof=1) / np.sqrt(150))
    assert np.all(np.abs(calibrated.mean - each.mean(axis=0)) < 4 * error)
    # As many roads without their mirror images would tell less.
    assert np.all(calibrated.standard_error < dafs.std(axis=0) / np.sqrt(50))


@pytest.mark.slow
def test_where_a_tire_leaves_the_road_the_mean_is_that_of_the_crossing_with_flights(
    bridge, truck, surface
):
    """Class E, within 1e-4 of the closed loop of a constant damper."""
    with pytest.warns(bc.LiftOffWarning):
        calibrated = calibrated_class_dae(surface, "E", mirror_pairs=3, seed=0)
    roads = pairs(3, 0, "E").reshape(6, -1)
    law = passive(truck.damping)
    loop = simulate_loop(bridge, truck, law, SPEEDS, surface.stations, roads)
    assert np.isfinite(loop.lift_off).any()
    assert calibrated.mean == pytest.approx(loop.daf.mean(axis=1), abs=1e-4)


def test_the_spread_stays_that_of_the_closed_form_and_both_say_what_they_are(hooked):
    closed = hooked.class_dae("A")
    calibrated = calibrated_class_dae(hooked, "A", mirror_pairs=4, damper=LAWS["bridgehook"])
    assert np.array_equal(calibrated.sd, closed.sd)
    assert (closed.mirror_pairs, closed.standard_error) == (0, None)
    assert (calibrated.mirror_pairs, calibrated.order) == (4, 2)
    assert "simulated" not in repr(closed)
    error = calibrated.standard_error.max()
    assert "mean simulated on 4 mirror pairs of roads from " in repr(calibrated)
    assert f"(standard error up to {error:.4f})" in repr(calibrated)
    assert calibrated.percentile(50) == pytest.approx(calibrated.mean)


@pytest.mark.slow
def test_the_same_seed_gives_the_same_numbers_whatever_the_number_of_threads(surface, hooked):
    for found, law in ((surface, None), (hooked, LAWS["bridgehook"])):
        means = []
        for threads, seed in ((1, 7), (2, 7), (1, 8)):
            with threadpoolctl.threadpool_limits(threads):
                one = calibrated_class_dae(found, "A", mirror_pairs=3, seed=seed, damper=law)
            means.append([one.mean, one.standard_error])
        assert np.array_equal(means[0], means[1])
        assert not np.allclose(means[0], means[2], atol=1e-4)


def test_roads_have_the_spectrum_that_was_asked_for(surface):
    of_class = calibrated_class_dae(surface, "A", mirror_pairs=3).mean
    assert calibrated_class_dae(surface, 16e-6, mirror_pairs=3).mean == pytest.approx(
        of_class, abs=1e-12
    )
    for other in ({"level": "upper"}, {"waviness": 2.5}, {"band": (0.05, 2.0)}):
        found = calibrated_class_dae(surface, "A", mirror_pairs=3, **other).mean
        assert np.abs(found - of_class).max() > 1e-4


@pytest.mark.slow
@pytest.mark.filterwarnings("ignore:start = -5 m is not forgotten")
def test_surfaces_of_one_way_of_several_tires_and_of_a_preset_damper_have_it_too(bridge, truck):
    one = bc.ramp_surface(bridge, truck, SPEEDS, approach=20)
    calibrated = calibrated_class_dae(one, "A", mirror_pairs=3, seed=4)
    assert calibrated.order == 1
    loop = simulate_loop(
        bridge, truck, passive(truck.damping), SPEEDS, one.stations, pairs(3, 4).reshape(6, -1)
    )
    assert calibrated.mean == pytest.approx(loop.daf.mean(axis=1), abs=1e-4)
    twins = bc.convoy([truck, truck], [0, 6.0])
    two = bc.ramp_surface(bridge, twins, 25.0, approach=5, ramp_length=0.5)
    road = iso8608_elevations(2, "A", 30, 0.5, seed=0)
    dafs = [bc.daf(bridge, twins, 25.0, two.road(z), start=-5) for z in -np.diff([*road, *-road])]
    assert calibrated_class_dae(two, "A", mirror_pairs=2).mean == pytest.approx(
        np.mean(dafs), abs=1e-6
    )
    law = LAWS["preset"]
    best = bc.ramp_surface(bridge, truck, SPEEDS, damper=law, every=25, **OPTIONS)
    loop = simulate_loop(bridge, truck, law, SPEEDS, best.stations, pairs(3, 4).reshape(6, -1))
    mean = calibrated_class_dae(best, "A", mirror_pairs=3, seed=4, damper=law).mean
    assert mean == pytest.approx(loop.daf.mean(axis=1), abs=1e-12)


@pytest.mark.slow
def test_a_damper_with_noise_lag_and_limit_is_known_again(bridge, truck):
    damper = Damper(LAWS["skyhook"], lag=0.01, max_force=15e3, velocity_noise=0.02, seed=3)
    noisy = bc.ramp_surface(bridge, truck, SPEEDS, every=50, damper=damper, **OPTIONS)
    assert calibrated_class_dae(noisy, "A", mirror_pairs=2, damper=damper).mirror_pairs == 2


# Single roads


@pytest.mark.slow
@pytest.mark.parametrize(
    ("iso_class", "of_first", "of_second"), [("A", 0.45, 0.73), ("B", 0.53, 0.85)]
)
def test_odd_effects_about_the_simulated_mean_estimate_single_roads_better(
    bridge, truck, iso_class, of_first, of_second
):
    """The rms error on 60 fresh roads and their mirror images at 13 speeds of 60 to 120 km/h, over
    five strategies. Eq. (15), order 2 and this: 0.041, 0.025, 0.018 in class A, 0.084, 0.051, 0.042
    in class B.
    """
    speeds, x = np.linspace(60, 120, 13) / 3.6, -60 + 0.1 * np.arange(851)
    roads = iso8608_elevations(60, iso_class, 85, seed=5)
    roads = np.vstack([roads, -roads])
    squares = np.zeros(3)
    for name in ("passive", "skyhook", "groundhook", "preset", "bridgehook"):
        law = LAWS[name]
        exact = simulate_loop(bridge, truck, law, speeds, x, roads).daf.T
        options = {"approach": 60, "damper": law}
        one = bc.ramp_surface(bridge, truck, speeds, **options)
        both = bc.ramp_surface(
            bridge, truck, speeds, ramp_height=iso_class, both_ways=True, every=5, **options
        )
        calibrated = calibrated_class_dae(both, iso_class, mirror_pairs=25, damper=law)
        about = calibrated.mean + both.ramps(roads) @ both.odd_effect.T
        estimates = one.dae(roads), both.dae(roads, order=2), about
        squares += [np.mean((estimate - exact) ** 2) for estimate in estimates]
    first, second, third = np.sqrt(squares)
    assert third < of_first * first
    assert third < of_second * second


# Bad input


@pytest.mark.parametrize(
    ("which", "given", "error", "message"),
    [
        ("surface", {"mirror_pairs": -1}, ValueError, "mirror_pairs must be 2 or more"),
        ("surface", {"mirror_pairs": 25.0}, TypeError, "mirror_pairs must be a whole .* type 25"),
        ("surface", {"mirror_pairs": 1}, ValueError, "mirror_pairs must be 2 or more"),
        ("surface", {"mirror_pairs": 2, "seed": "one"}, TypeError, "seed must be a whole number"),
        ("surface", {"mirror_pairs": 2, "damper": passive(8e3)}, ValueError, "leave damper out"),
        ("surface", {"mirror_pairs": 2, "damper": LAWS["skyhook"]}, ValueError, "'skyhook': leave"),
        ("surface", {"mirror_pairs": 2, "damper": 7e3}, TypeError, r"type bridgectl.*passive\(7e3"),
        ("hooked", {"mirror_pairs": 2}, ValueError, "'bridgehook', .* got none: type damper="),
        ("hooked", {"mirror_pairs": 2, "damper": LAWS["skyhook"]}, ValueError, "got 'skyhook'"),
        ("hooked", {"mirror_pairs": 2, "damper": 7e3}, TypeError, "damper must be a bridgectl"),
    ],
)
def test_each_mistake_is_named(request, which, given, error, message):
    with pytest.raises(error, match=message):
        calibrated_class_dae(request.getfixturevalue(which), "A", **given)


@pytest.mark.quick_cases(2)
@pytest.mark.parametrize(
    "other",
    [
        lambda b, c: bridgehook(b, c, SOFT, 20e3),
        lambda b, c: bridgehook(b, c, SOFT, STIFF, feedback=False),
        lambda b, c: Damper(bridgehook(b, c, SOFT, STIFF), lag=5e-3),
        lambda b, c: LAWS["skyhook"].renamed("bridgehook"),
    ],
)
def test_another_damper_of_the_same_name_is_told_by_its_smooth_daf(bridge, truck, hooked, other):
    with pytest.raises(ValueError, match=r"whose smooth DAF is up to .* same bounds and options"):
        calibrated_class_dae(hooked, "A", mirror_pairs=2, damper=other(bridge, truck))
