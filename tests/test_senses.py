"""Effects as values: places in metres, both senses, and motions that are not uniform."""

import json
from dataclasses import replace
from pathlib import Path

import control as ct
import numpy as np
import pytest
from helpers import rough_road

import bridgectl as bc
from bridgectl.dampers import bridgehook, clairvoyant, costate, passive, preset, skyhook
from bridgectl.model.crossing import make_crossing

VEHICLES = Path(__file__).parents[2] / "shared" / "reference" / "vehicles.json"
SPEEDS = np.array([60, 90, 120]) / 3.6
LEAST, UPLIFT = bc.TireForce(sense="smallest"), bc.Deflection(sense="smallest")
SMALLEST = [LEAST, UPLIFT, bc.Moment(10.0, sense="smallest")]


@pytest.fixture(scope="module")
def road():
    return rough_road(3, -20, 25)


def history(response, effect):
    """What a response tells of an effect, in its unit."""
    name = {bc.TireForce: "tire_force", bc.Deflection: "deflection", bc.Moment: "moment"}
    return np.asarray(response.outputs[name[type(effect)]])


# Names are short forms


@pytest.mark.parametrize("recovery", ["exact", "li2006"])
def test_a_place_in_metres_is_a_section_and_a_name_is_its_effect(bridge, truck, road, recovery):
    at = {"section": 0.4, "recovery": recovery}
    short = bc.daf(bridge, truck, SPEEDS, road, start=-20, **at)
    moment = bc.Moment(10.0, recovery=recovery)
    assert bc.daf(bridge, truck, SPEEDS, road, start=-20, effect=moment).tolist() == short.tolist()
    halves = bc.Moment(10.0), {"recovery": recovery}
    both = bc.daf(bridge, truck, SPEEDS, road, start=-20, effect=halves[0], **halves[1])
    assert both.tolist() == short.tolist()


def test_effects_are_values_that_tell_what_they_are():
    assert bc.Moment(10) == bc.Moment(at=10.0)
    assert repr(bc.Moment(10, sense="smallest")) == "Moment(at=10 m, sense='smallest')"
    assert repr(LEAST) == "TireForce(sense='smallest', tire=1)"


def test_a_response_is_read_where_the_effect_is(bridge, truck, road):
    short = bc.crossing_response(bridge, truck, 25.0, road, start=-20, section=0.4)
    for effect in (bc.Moment(10.0), bc.Deflection(10.0)):
        long = bc.crossing_response(bridge, truck, 25.0, road, start=-20, effect=effect)
        assert np.array_equal(long.outputs["moment"], short.outputs["moment"])
        assert np.array_equal(long.outputs["deflection"], short.outputs["deflection"])


@pytest.mark.parametrize(
    ("options", "message"),
    [
        (
            {"effect": bc.Moment(25.5)},
            r"at must be a place on the bridge, from 0 to 25 m.*=12\.5",
        ),
        ({"effect": bc.Moment(10), "section": 0.3}, r"section goes with the name.*Moment\(at=7\.5"),
        ({"effect": bc.Moment(10, recovery="modal"), "recovery": "li2006"}, "leave one out"),
        ({"effect": bc.TireForce(2)}, "tire must be one of the 1 tires, got 2"),
        ({"effect": bc.BodyAcceleration(3)}, "coordinate must be 1 for y_s, 2 for y_t, got 3"),
        ({"effect": "acceleration"}, r"static acceleration of .* is 0 m/s\^2: type peak_effect"),
        ({"effect": bc.Moment(0.0)}, "section must lie between 0 and 1"),
        ({"effect": bc.Moment(sense="smallest")}, "smallest static bending moment .* is 0 N m"),
    ],
)
def test_what_is_no_effect_or_no_factor_is_told(bridge, truck, options, message):
    with pytest.raises(ValueError, match=message):
        bc.daf(bridge, truck, 25.0, **options)


def test_an_effect_of_no_kind_is_an_error(bridge, truck):
    with pytest.raises(
        TypeError, match=r"effect must be one of .*, or as Moment.* speeds go with daf"
    ):
        bc.Crossing(bridge, truck, 25.0)
    with pytest.raises(TypeError, match=r"in daf and peak_effect a list.*list\(effects.values"):
        bc.daf(bridge, truck, 25.0, effect={"pier": bc.Reaction(0.0)})
    with pytest.raises(ValueError, match="sense must be one of 'largest', 'smallest'"):
        bc.Moment(10.0, sense="hogging")
    with pytest.raises(ValueError, match=r"at must .* got -1"):
        bc.Deflection(-1.0)


# Both senses, by every route


@pytest.mark.quick_cases(3)
@pytest.mark.parametrize("effect", SMALLEST, ids=repr)
@pytest.mark.parametrize("method", ["propagator", "control"])
def test_the_smallest_value_is_that_of_the_history(bridge, truck, road, effect, method):
    found = bc.peak_effect(bridge, truck, 25.0, road, start=-20, effect=effect, method=method)[0]
    largest = replace(effect, sense="largest")
    response = bc.crossing_response(bridge, truck, 25.0, road, start=-20, effect=largest)
    seen = history(response, effect)[response.time >= 0]
    unit = 1.0
    if isinstance(effect, bc.Moment):  # which a response has over its static peak
        unit = make_crossing(bridge, truck, largest).static_peak
    assert found == pytest.approx(unit * seen.min(), abs=2e-3 * unit * np.ptp(seen))
    assert found <= unit * seen.min() + 1e-7 * unit * np.ptp(seen)


def test_the_least_tire_force_is_a_factor_below_one(bridge, truck, road):
    least = bc.daf(bridge, truck, SPEEDS, road, start=-20, effect=LEAST)
    most = bc.daf(bridge, truck, SPEEDS, road, start=-20, effect=bc.TireForce())
    assert np.all((least > 0) & (least < 1) & (most > 1))


@pytest.mark.parametrize("effect", [LEAST, bc.BodyAcceleration(sense="smallest")], ids=repr)
def test_smallest_values_superpose(bridge, truck, road, effect):
    surface = bc.ramp_surface(bridge, truck, SPEEDS, approach=20, effect=effect)
    simulated = bc.peak_effect(bridge, truck, SPEEDS, road, start=-20, effect=effect)
    unit = make_crossing(bridge, truck, effect).static_peak or 1.0
    scale = np.abs(simulated).max()
    assert unit * surface.superposed_daf(road) == pytest.approx(simulated, abs=1e-6 * scale)
    drop = surface.road(1e-3 * (np.arange(450) == 260))
    with_ramp = bc.peak_effect(bridge, truck, SPEEDS, drop, start=-20, effect=effect)
    assert unit * surface.daf_unit[:, 260] == pytest.approx(with_ramp, abs=1e-6 * scale)


@pytest.mark.quick_cases(2)
@pytest.mark.parametrize("effect", [*SMALLEST, bc.TireForce(), bc.Deflection(7.0)], ids=repr)
def test_a_damper_that_hardly_changes_is_the_passive_one_for_every_effect(
    bridge, truck, road, effect
):
    almost = skyhook(7e3, 7e3 * (1 + 1e-9))
    loop, linear = (
        bc.peak_effect(bridge, truck, SPEEDS, road, start=-20, effect=effect, damper=damper)
        for damper in (almost, passive(7e3))
    )
    assert loop == pytest.approx(linear, rel=2e-4)


def test_ramps_of_a_semi_active_damper_are_of_any_effect(bridge, truck):
    almost = skyhook(7e3, 7e3 * (1 + 1e-9))
    loop, linear = (
        bc.ramp_surface(bridge, truck, SPEEDS, every=50, effect=LEAST, damper=damper)
        for damper in (almost, passive(7e3))
    )
    assert loop.daf_unit == pytest.approx(linear.daf_unit, abs=1e-4)


def test_a_preset_takes_the_damping_of_the_largest_least_force(bridge, truck, road):
    law = preset(1e3, 30e3, n_dampings=3)
    found = bc.daf(bridge, truck, SPEEDS, road, start=-20, effect=LEAST, damper=law)
    kept = [
        bc.daf(bridge, truck, SPEEDS, road, start=-20, effect=LEAST, damper=passive(float(c)))
        for c in law.dampings
    ]
    assert found == pytest.approx(np.max(kept, axis=0), abs=1e-4)
    ramps = bc.ramp_surface(bridge, truck, SPEEDS, every=50, effect=LEAST, damper=law)
    one = bc.ramp_surface(bridge, truck, SPEEDS, effect=LEAST, damper=passive(30e3))
    assert np.all(ramps.daf_smooth >= one.daf_smooth)


@pytest.mark.slow
def test_the_clairvoyant_holds_the_tire_on_the_road(bridge, truck):
    bump = bc.RoadProfile([-20, 5, 5.5, 6, 25], [0, 0, 0.01, 0, 0])
    case = bridge, truck, 25.0, bump, 1e3, 30e3
    best = clairvoyant(*case, start=-2, step=0.01, effect=LEAST)
    own = bc.daf(bridge, truck, 25.0, bump, start=-2, effect=LEAST)[0]
    assert best.passive_daf == pytest.approx(own, abs=1e-3)
    assert best.daf > best.passive_daf + 0.02
    again = bc.daf(bridge, truck, 25.0, bump, start=-2, effect=LEAST, damper=best.damper)[0]
    assert again == pytest.approx(best.daf, abs=1e-9)


def test_a_costate_is_what_a_push_of_the_damper_does_to_the_peak_of_its_effect(bridge, truck):
    down = costate(bridge, truck, 25.0, effect=bc.Deflection(10.0))
    crossing, place, push = make_crossing(bridge, truck, bc.Deflection(10.0)), 4.0, 50.0  # N s
    end = down.positions[-1]
    jump = push * crossing.damper_matrix[:, 0]
    system = bc.crossing_system(bridge, truck, 25.0, effect=bc.Deflection(10.0))
    exact = {"solve_ivp_method": "DOP853", "solve_ivp_kwargs": {"rtol": 1e-9, "atol": 1e-13}}

    def at_end(state):
        x = np.linspace(place, end, 201)
        found = ct.input_output_response(system, x / 25.0, np.zeros((2, 201)), state, **exact)
        return np.asarray(found.outputs)[system.output_labels.index("deflection"), -1]

    moved = at_end(jump) - at_end(0 * jump)
    slope = np.interp(place, down.positions, down.sigma)
    assert moved / push / crossing.static_peak == pytest.approx(slope, rel=1e-3)


@pytest.mark.slow
def test_bridgehook_works_against_the_effect_that_it_is_made_for(bridge, truck):
    roads = [bc.iso8608_profile("A", 85, seed=seed, start=-60) for seed in range(6)]
    hook = bridgehook(bridge, truck, 1e3, 30e3, effect=bc.Deflection())
    where = {"start": -60, "effect": bc.Deflection()}
    means = [
        np.mean([bc.daf(bridge, truck, SPEEDS, road, damper=d, **where) for road in roads])
        for d in (hook, passive(7e3))
    ]
    assert means[0] < means[1] - 0.02


# Motions


def test_a_place_and_its_time_belong_together():
    for motion in (bc.Motion(25.0), bc.Motion(25.0, 2.0), bc.Motion(25.0, -3.0)):
        t = np.linspace(-1, 2, 7)
        assert motion.time(motion.position(t)) == pytest.approx(t, abs=1e-12)
    with pytest.raises(ValueError, match=r"not bring the vehicle to rest.*stands at x = 104\.2 m"):
        bc.Motion(25.0, -3.0).time(np.array([110.0]))


@pytest.mark.skipif(not VEHICLES.exists(), reason="the reference numbers are not shipped")
@pytest.mark.slow
def test_a_braking_truck_is_that_of_the_independent_code(bridge, truck):
    """DAF of a quarter-car that brakes by 3 m/s^2 from the bridge's start, of 14 modes."""
    cases = json.loads(VEHICLES.read_text(encoding="utf-8"))["cases"]
    known = cases["f_QC_SS25_smooth_25_brake3"]["sections"]["12.5"]
    beam = replace(bridge, n_modes=14)
    response = bc.crossing_response(beam, truck, bc.Motion(25.0, -3.0), method="control")
    assert response.outputs["moment"].max() == pytest.approx(known["daf_moment"], abs=2e-5)
    assert response.time[-1] == pytest.approx(1.0685, abs=1e-3)


def test_a_uniform_motion_is_a_constant_speed(bridge, truck):
    uniform = bc.crossing_response(bridge, truck, bc.Motion(25.0))
    assert np.array_equal(
        uniform.outputs["moment"], bc.crossing_response(bridge, truck, 25.0).outputs["moment"]
    )
