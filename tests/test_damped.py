"""`damper=` of responses, DAFs and ramp surfaces, and the preset damper."""

import dataclasses

import control as ct
import numpy as np
import pytest
from helpers import NO_DAMPERS, rough_road, without_dampers

import bridgectl as bc
from bridgectl import dampers
from bridgectl.dampers import Damper, simulate_loop
from bridgectl.road import iso8608_elevations

SKYHOOK = dampers.skyhook(1e3, 30e3)
SPEEDS = np.array([30.0, 20.0])


@pytest.fixture
def road():
    return rough_road(3, -5, 25, 0.1, height=1e-3)


def test_a_constant_damper_gives_the_passive_response(bridge, truck, road):
    stiff = dataclasses.replace(truck, damping=20e3)
    found = bc.crossing_response(bridge, truck, 30.0, road, start=-5, damper=dampers.passive(20e3))
    exact = bc.crossing_response(bridge, stiff, 30.0, road, start=-5, timepts=found.time)
    assert isinstance(found, ct.TimeResponseData)
    for name, tolerance in {"moment": 1e-6, "tire_force": 0.05, "y_s_ddot": 1e-5}.items():
        assert found.outputs[name] == pytest.approx(exact.outputs[name], abs=tolerance)


def test_a_response_gives_the_times_that_are_asked_for(bridge, truck, road):
    t = np.linspace(-0.1, 0.7, 33)
    found = bc.crossing_response(bridge, truck, 30.0, road, start=-5, damper=SKYHOOK, timepts=t)
    assert found.time == pytest.approx(t, abs=1e-12)
    whole = bc.crossing_response(bridge, truck, 30.0, road, start=-5, damper=SKYHOOK)
    near = np.interp(t, whole.time, whole.outputs["moment"])
    assert found.outputs["moment"] == pytest.approx(near, abs=1e-3)


def test_the_damper_force_of_a_response_is_within_its_limit(bridge, truck, road):
    damper = Damper(SKYHOOK, max_force=500.0)
    found = bc.crossing_response(bridge, truck, 30.0, road, start=-5, damper=damper)
    assert 400 < np.abs(found.inputs["damper_force"]).max() <= 500


def test_the_daf_is_the_peak_of_the_response(bridge, truck, road):
    found = bc.daf(bridge, truck, SPEEDS, road, start=-5, damper=SKYHOOK)
    for speed, daf in zip(SPEEDS, found, strict=True):
        response = bc.crossing_response(bridge, truck, speed, road, start=-5, damper=SKYHOOK)
        assert daf == pytest.approx(response.outputs["moment"].max(), abs=2e-4)


def test_a_constant_damper_gives_the_passive_ramp_surface(bridge, truck):
    stiff = dataclasses.replace(truck, damping=20e3)
    options = {"approach": 5.0, "recovery": "li2006", "section": 0.4}
    found = bc.ramp_surface(bridge, truck, SPEEDS, damper=dampers.passive(20e3), **options)
    exact = bc.ramp_surface(bridge, stiff, SPEEDS, **options)
    assert found.daf_smooth == pytest.approx(exact.daf_smooth, abs=1e-5)
    assert found.daf_unit == pytest.approx(exact.daf_unit, abs=1e-5)
    assert found.vehicle == stiff  # a vehicle like any other, whose responses superpose


def test_a_preset_damper_has_the_best_of_the_passive_ramp_surfaces(bridge, truck):
    x = -5 + 0.1 * np.arange(301)
    law = dampers.preset(1e3, 30e3, n_dampings=3)
    surface = bc.ramp_surface(bridge, truck, SPEEDS, approach=5, damper=law)
    ramps = -1e-3 * (np.arange(x.size) > np.array([[0], [40], [130], [300]]))
    alone = simulate_loop(bridge, truck, law, SPEEDS, x, ramps).daf
    assert surface.daf_unit[:, [0, 40, 130]] == pytest.approx(alone[:, :3], abs=1e-5)
    assert surface.daf_smooth == pytest.approx(alone[:, 3], abs=1e-5)


@pytest.mark.quick_cases(1)
@pytest.mark.parametrize(
    "law", [SKYHOOK, Damper(dampers.preset(1e3, 30e3, n_dampings=3), max_force=1e6)]
)
def test_a_unit_ramp_of_a_surface_is_that_ramp_simulated(bridge, truck, law):
    """Ramps share the smooth road's run until they begin; on their own they give the same."""
    surface = bc.ramp_surface(bridge, truck, SPEEDS, approach=5, damper=law)
    x = surface.stations
    for ramp in (0, 40, 130):
        z = -1e-3 * (np.arange(x.size) > ramp)
        alone = simulate_loop(bridge, truck, law, SPEEDS, x, z).daf[:, 0]
        assert surface.daf_unit[:, ramp] == pytest.approx(alone, abs=1e-12)


def test_histories_of_a_feedback_damper_do_not_superpose(bridge, truck, road, tmp_path):
    surface = bc.ramp_surface(bridge, truck, SPEEDS, approach=5, damper=SKYHOOK)
    assert surface.dae(road).shape == (2,)
    for use in (surface.superposed_daf, lambda road: bc.dae_trust(surface, road)):
        with pytest.raises(ValueError, match="with skyhook do not superpose: estimate"):
            use(road)
    with pytest.raises(TypeError, match="which files do not hold"):
        surface.save(tmp_path / "surface.npz")


def test_responses_to_a_damping_program_superpose(bridge, truck):
    """c(x) is open-loop: the crossing stays linear in the road."""
    law = dampers.program([-3, 4, 9], [2e3, 25e3, 5e3])
    t = np.linspace(-0.1, 0.8, 40)
    x = np.linspace(-5, 25, 61)

    def moment(z):
        road = bc.RoadProfile(x, z)
        options = {"start": -5, "damper": law, "timepts": t}
        return bc.crossing_response(bridge, truck, 30.0, road, **options).outputs["moment"]

    rng = np.random.default_rng(0)
    first, second = (np.cumsum(rng.normal(0, 5e-4, x.size)) for _ in range(2))
    whole = moment(first + second) - moment(0 * x)
    parts = moment(first) + moment(second) - 2 * moment(0 * x)
    assert whole == pytest.approx(parts, abs=1e-6)


def test_histories_are_recorded_at_the_samples(bridge, truck, road):
    names = ("tire_force", "body_acceleration", "suspension_travel", "damping")
    law = Damper(SKYHOOK, sample_time=4e-3)
    found = simulate_loop(
        bridge, truck, law, SPEEDS, road.x, np.array([road.elevation, 0 * road.x]), record=names
    )
    for speed, history in zip(SPEEDS, found.histories, strict=True):
        n = int(np.ceil(30 / speed / 4e-3))
        assert {history[name].shape for name in names} == {(2, n)}
        t = -5 / speed + 4e-3 * np.arange(1, n)
        exact = bc.crossing_response(
            bridge, truck, speed, road, start=-5, damper=law, timepts=t
        ).outputs  # fmt: skip
        assert history["tire_force"][0, 1:] == pytest.approx(exact["tire_force"], abs=0.5)
        assert history["suspension_travel"][0, 1:] == pytest.approx(
            exact["suspension_travel"], abs=1e-8
        )
        assert set(np.unique(history["damping"])) == {1e3, 30e3}


def test_a_road_may_go_on_after_the_bridge(bridge, truck):
    x = -5 + 0.1 * np.arange(401)
    z = iso8608_elevations(2, "B", 40, seed=1)
    long = simulate_loop(bridge, truck, SKYHOOK, SPEEDS, x, z, record=["tire_force"])
    short = simulate_loop(bridge, truck, SKYHOOK, SPEEDS, x[:301], z[:, :301])
    assert long.daf == pytest.approx(short.daf, abs=1e-12)
    assert long.histories[0]["tire_force"].shape[1] == int(np.ceil(40 / 30 / 2e-3))


# The preset damper


@pytest.mark.slow
def test_a_preset_damper_takes_the_best_constant_of_every_crossing(bridge, truck):
    x, z = -10 + 0.1 * np.arange(351), iso8608_elevations(4, "B", 35, seed=2)
    constants = np.geomspace(1e3, 30e3, 4)
    each = [simulate_loop(bridge, truck, dampers.passive(c), SPEEDS, x, z).daf for c in constants]
    found = simulate_loop(bridge, truck, dampers.preset(1e3, 30e3, n_dampings=4), SPEEDS, x, z)
    assert found.daf == pytest.approx(np.min(each, axis=0), abs=1e-5)


def test_a_preset_damper_takes_roads_of_uneven_stations(bridge, truck):
    x = np.array([-4, -1, -0.9, 3, 8, 8.2, 25.0])
    z = np.array([0, 0, -0.004, -0.004, 0.001, -0.003, 0])
    found = simulate_loop(bridge, truck, dampers.preset(1e3, 30e3, n_dampings=3), 30.0, x, z)
    each = [
        simulate_loop(bridge, truck, dampers.passive(c), 30.0, x, z).daf
        for c in np.geomspace(1e3, 30e3, 3)
    ]
    assert found.daf == pytest.approx(np.min(each, axis=0), abs=1e-5)


def test_a_preset_damper_takes_stations_that_are_even_but_for_round_off(bridge, truck):
    x = -300 + 0.1 * np.arange(3251)
    z = iso8608_elevations(1, "A", 325, seed=0)
    law = dampers.preset(1e3, 30e3, n_dampings=2)
    own = law.gains_for(bc.Crossing(bridge, truck), np.array([25.0]), x, z)["damping"]
    assert own[0, 0] in (1e3, 30e3)


@pytest.mark.parametrize(
    ("use", "error", "message"),
    [
        (lambda b, v: bc.daf(b, v, 25.0, damper=SKYHOOK, method="control"), ValueError,
         "method must be 'propagator' with a damper"),
        (lambda b, v: bc.daf(b, v, 25.0, damper=SKYHOOK, effect="acceleration"), ValueError,
         "effect must have a static peak"),
        (lambda b, v: bc.peak_effect(b, v, 25.0, damper=SKYHOOK, effect="acceleration"), ValueError,
         "the effect is a moment, a deflection or a tire force"),
        (lambda b, v: bc.crossing_response(b, v, 25.0, damper=SKYHOOK, method="control"),
         ValueError, "method must be 'propagator' with a damper"),
        (lambda b, v: bc.ramp_surface(b, v, 25.0, damper=SKYHOOK, effect="acceleration"),
         ValueError, "the effect is a moment, a deflection or a tire force"),
        (lambda b, v: bc.daf(b, without_dampers(), 25.0, damper=SKYHOOK), ValueError, NO_DAMPERS),
        (lambda b, v: bc.daf(b, v, 25.0, damper="skyhook"), TypeError,
         "strategy must be a Strategy"),
        (lambda b, v: simulate_loop(b, v, SKYHOOK, 25.0, [0, 25], [0, 0], record=["speed"]),
         ValueError, "record has an unknown name, 'speed'"),
        (lambda b, v: dampers.preset(0, 30e3), ValueError, "c_min must be above 0"),
        (lambda b, v: dampers.preset(30e3, 1e3), ValueError, "c_min must not exceed c_max"),
        (lambda b, v: dampers.preset(1e3, 3e3, n_dampings=1), ValueError, "n_dampings must be 2"),
        (lambda b, v: SKYHOOK.renamed(""), TypeError, "name must be a string"),
    ],
)  # fmt: skip
def test_each_mistake_is_named(bridge, truck, use, error, message):
    with pytest.raises(error, match=message):
        use(bridge, truck)


def test_a_constant_damper_has_the_passive_daf_and_one_with_a_force_limit_not(bridge, truck, road):
    stiff = dataclasses.replace(truck, damping=20e3)
    exact = bc.daf(bridge, stiff, SPEEDS, road, start=-5)
    for law in (dampers.passive(20e3), Damper(dampers.passive(20e3), lag=0.01)):
        assert np.array_equal(bc.daf(bridge, truck, SPEEDS, road, start=-5, damper=law), exact)
    limited = Damper(dampers.passive(20e3), max_force=500.0)
    found = bc.daf(bridge, truck, SPEEDS, road, start=-5, damper=limited)
    assert np.abs(found - exact).min() > 1e-4


LEAP = bc.RoadProfile([-10.0, -1.0, -0.9, 25.0], [0, 0, -0.08, -0.08], name="80 mm down")


@pytest.mark.parametrize(
    "damper",
    [
        SKYHOOK,
        dampers.passive(7e3),
        pytest.param(Damper(SKYHOOK, lag=0.01), marks=pytest.mark.slow),
    ],
)
def test_a_tire_that_leaves_the_road_is_told_with_a_damper_too(bridge, truck, damper):
    with pytest.warns(bc.LiftOffWarning, match=r"at 1 of 2 speeds, the slowest 108 km/h") as told:
        bc.daf(bridge, truck, [2.0, 30.0], LEAP, start=-10, damper=damper)
    assert [warning.filename for warning in told] == [__file__]
    with pytest.warns(bc.LiftOffWarning, match="first with the reference tire at x = -") as told:
        bc.crossing_response(bridge, truck, 30.0, LEAP, start=-10, damper=damper)
    assert [warning.filename for warning in told] == [__file__]


def test_a_surface_of_ramps_that_throw_the_tire_says_so(bridge, truck):
    with pytest.warns(bc.LiftOffWarning, match=r"in \d+ of 25 crossings of a ramp of 0.2 m"):
        bc.ramp_surface(bridge, truck, 30.0, ramp_length=1.0, ramp_height=0.2, damper=SKYHOOK)
