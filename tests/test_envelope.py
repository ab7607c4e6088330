"""Effects side by side from one crossing: lists, named outputs, static values, envelopes."""

from dataclasses import replace

import numpy as np
import pytest
from helpers import rough_road

import bridgectl as bc
from bridgectl.dampers import passive, skyhook
from bridgectl.linear import samples
from bridgectl.plots.bridge import supports_of

MU, EJ = 18358.0, 4.865e10
SPEEDS = np.array([60, 90, 120]) / 3.6
PIER = bc.Moment(25.0, sense="smallest")
KINDS = {
    "moment": bc.Moment,
    "shear": bc.Shear,
    "deflection": bc.Deflection,
    "acceleration": bc.BridgeAcceleration,
}
FITTED = {"its own": None, "constant": passive(12e3), "skyhook": skyhook(1e3, 30e3)}
every_damper = pytest.mark.parametrize("damper", FITTED.values(), ids=FITTED.keys())


@pytest.fixture(scope="module")
def spans():
    return bc.Bridge([25, 25], MU, EJ, damping_ratio=0.01)


@pytest.fixture(scope="module")
def haunched():
    return bc.Bridge(
        [20, 30], MU, [(15, EJ), (10, 2 * EJ), (25, EJ)], supports=["simple", "simple", "clamped"]
    )


@pytest.fixture(scope="module")
def road():
    return rough_road(3, -20, 50)


@pytest.fixture(scope="module")
def violent():
    """A road on which a tire flies."""
    return bc.iso8608_profile("D", 50, seed=3)


# A list of effects is simulated once, and is what single calls are


def singly(function, effects, *arguments, **options):
    return np.array([function(*arguments, effect=effect, **options) for effect in effects])


def test_effects_at_one_place_are_those_of_single_calls_but_for_round_off(spans, truck, road):
    effects = [bc.Moment(10.0), bc.Moment(10.0, sense="smallest"), bc.Deflection(10.0)]
    given = spans, truck, SPEEDS, road
    many = bc.daf(*given, start=-20, effect=effects)
    assert many.shape == (3, 3)
    assert many == pytest.approx(singly(bc.daf, effects, *given, start=-20), rel=1e-12, abs=0)


@pytest.mark.slow
def test_effects_at_many_places_are_those_of_single_calls(spans, truck, road):
    """Within 1e-9 of the largest: cells end where any effect has a kink, not only its own."""
    effects = [
        PIER, bc.Moment(12.5), bc.Shear(25.0), bc.Reaction(25.0), bc.Stress(4.0, section_modulus=1),
        bc.TireForce(sense="smallest"), bc.BodyAcceleration(), bc.BridgeAcceleration(10.0),
    ]  # fmt: skip
    given = spans, truck, SPEEDS, road
    single = singly(bc.peak_effect, effects, *given, start=-20)
    off = np.abs(bc.peak_effect(*given, start=-20, effect=effects) - single).max(axis=1)
    assert np.all(off < 1e-9 * np.abs(single).max(axis=1))


def test_a_truck_of_several_axles_has_the_same_peaks_in_a_list(spans, truck, road):
    train = bc.convoy([truck, truck, truck], [0, 6, 15])
    effects = [PIER, "tire_force_2", "acceleration"]
    given = spans, train, SPEEDS[:1], road
    single = singly(bc.peak_effect, effects, *given)
    assert bc.peak_effect(*given, effect=effects) == pytest.approx(single, rel=1e-9)


def test_names_and_tuples_are_lists_of_effects_too(bridge, truck):
    many = bc.daf(bridge, truck, SPEEDS, effect=("moment", "deflection"), section=0.4)
    assert many[1] == pytest.approx(bc.daf(bridge, truck, SPEEDS, effect=bc.Deflection(10.0)))


def test_a_list_is_propagated_once(bridge, truck, monkeypatch):
    calls = []
    true = samples.propagate
    monkeypatch.setattr(samples, "propagate", lambda *a: calls.append(a) or true(*a))
    bc.daf(bridge, truck, SPEEDS, effect=["moment", "deflection", bc.Moment(7.0), "tire_force"])
    assert len(calls) == 1


@pytest.mark.slow
def test_a_list_by_the_control_library_agrees(bridge, truck):
    effects = [bc.Moment(10.0), "deflection"]
    options = {"effect": effects, "progress": False}
    slow = bc.daf(bridge, truck, SPEEDS[:1], method="control", **options)
    assert slow == pytest.approx(bc.daf(bridge, truck, SPEEDS[:1], **options), abs=1e-6)


@pytest.mark.quick_cases(1)
@every_damper
def test_a_list_with_a_damper_is_what_single_calls_are(bridge, truck, damper):
    effects = ["moment", bc.Deflection(10.0)]
    given = bridge, truck, SPEEDS, rough_road(1, -10, 25)
    single = singly(bc.daf, effects, *given, start=-10, damper=damper)
    assert bc.daf(*given, start=-10, damper=damper, effect=effects) == pytest.approx(
        single, rel=1e-9
    )


def test_a_list_in_flight_is_what_single_calls_are_within_a_millionth(spans, truck, violent):
    effects = [PIER, bc.Moment(12.5), "tire_force"]
    given = spans, truck, SPEEDS, violent
    with pytest.warns(bc.LiftOffWarning, match="leaves the road at"):
        many = bc.daf(*given, effect=effects)
    with pytest.warns(bc.LiftOffWarning, match="leaves the road at"):
        single = singly(bc.daf, effects, *given)
    assert many == pytest.approx(single, rel=1e-6)


@pytest.mark.parametrize(
    ("effect", "message"),
    [
        ([], "effect must be one effect or more.*type effect='moment'"),
        (["moment", bc.Moment(sense="smallest")], "effect must have a static peak"),
        (["moment", None], "effect must be one of"),
    ],
)
def test_a_list_is_checked_as_each_of_its_effects(bridge, truck, effect, message):
    with pytest.raises((TypeError, ValueError), match=message):
        bc.daf(bridge, truck, 25.0, effect=effect)


# Named outputs


@pytest.mark.quick_cases(1)
@pytest.mark.parametrize("method", ["propagator", "control"])
def test_named_outputs_come_after_the_usual_ones_in_their_units(spans, truck, road, method):
    effects = {"pier": PIER, "at_10_m": bc.Deflection(10.0), "tire": "tire_force"}
    options = {"start": 0 if method == "control" else -20, "method": method}
    spans = replace(spans, n_modes=3)
    usual = bc.crossing_response(spans, truck, 25.0, road, **options, section=0.2)
    more = bc.crossing_response(spans, truck, 25.0, road, **options, section=0.2, effects=effects)
    assert more.output_labels == [*usual.output_labels, *effects]
    assert np.array_equal(more.outputs["tire"], more.outputs["tire_force"])
    scale = np.abs(more.outputs["deflection"]).max()
    assert more.outputs["at_10_m"] == pytest.approx(
        more.outputs["deflection"], abs=1e-9 * float(scale)
    )
    peak = bc.peak_effect(spans, truck, 25.0, road, start=options["start"], effect=PIER)[0]
    assert more.outputs["pier"].min() == pytest.approx(peak, rel=1e-4)


@every_damper
def test_a_named_acceleration_knows_the_damper(bridge, truck, damper):
    road = rough_road(1, -10, 25)
    named = {"body": bc.BodyAcceleration(), "axle": bc.BodyAcceleration(2)}
    found = bc.crossing_response(
        bridge, truck, 25.0, road, start=-10, damper=damper, effects=named
    ).outputs
    assert found["body"] == pytest.approx(found["y_s_ddot"], abs=1e-9)
    assert found["axle"] == pytest.approx(found["y_t_ddot"], abs=1e-9)


def test_a_system_has_the_named_outputs(spans, truck):
    system = bc.crossing_system(spans, truck, 25.0, effects={"pier": PIER}, static=True)
    assert system.output_labels[-4:] == [
        "pier", "static_moment", "static_deflection", "static_pier",
    ]  # fmt: skip
    static = system.output(0.5, np.zeros(system.nstates), np.zeros(2))[-1]
    assert static == pytest.approx(PIER.static_values(spans, truck, 12.5))


def test_a_crossing_tells_its_further_effects(spans, truck):
    assert "effects" not in repr(bc.Crossing(spans, truck))
    assert "'pier': Moment(at=25 m" in repr(bc.Crossing(spans, truck, effects={"pier": PIER}))
    crossing = bc.Crossing(spans, truck, effects={"pier": bc.Moment(7.0)})
    assert crossing.kinks == pytest.approx([0, 7, 25, 50])
    assert replace(crossing, vehicle=truck) == crossing


# Static values


@pytest.mark.quick_cases(1)
@pytest.mark.parametrize("effect", [PIER, bc.Shear(10.0), bc.Deflection(10.0), bc.Reaction(25.0)])
def test_a_truck_that_creeps_has_the_static_values(spans, truck, effect):
    """Within half a percent of the peak at 0.5 m/s."""
    damped = replace(spans, n_modes=4, damping_ratio=0.05)
    given = damped, truck, 0.5
    x = np.linspace(1.0, 49.0, 9)
    found = bc.crossing_response(*given, effects={"it": effect}, static=True, timepts=x / 0.5)
    static = found.outputs["static_it"]
    assert static == pytest.approx(effect.static_values(damped, truck, x))
    assert found.outputs["it"] == pytest.approx(static, abs=5e-3 * float(np.abs(static).max()))


def test_static_values_reach_the_static_peak(spans, truck):
    x = np.linspace(0, 50, 5001)
    for effect in (PIER, bc.Shear(10.0), bc.TireForce(), bc.Stress(12.5, section_modulus=0.5)):
        extreme = np.min if effect.sense == "smallest" else np.max
        x = np.sort(np.append(x, effect.kinks(spans)))
        peak = effect.static_peak(spans, truck.linear)
        assert extreme(effect.static_values(spans, truck, x)) == pytest.approx(peak, rel=1e-5)
    assert not bc.BodyAcceleration().static_values(spans, truck, x).any()
    assert not bc.BridgeAcceleration().static_values(spans, truck, x).any()


def test_an_influence_line_is_that_of_the_bridge(haunched, bridge):
    x = np.linspace(0, 50, 11)
    moment = haunched.influence_line(x, 0.3)
    assert np.array_equal(bc.Moment(15.0).influence_line(haunched, x), moment)
    stress = bc.Stress(15.0, section_modulus=0.5)
    assert stress.influence_line(haunched, x) == pytest.approx(2 * moment)
    few = bc.Deflection().influence_line(bridge, 12.5)
    assert few == pytest.approx(bridge.influence_line(12.5, 0.5, "deflection"), rel=0.01)
    assert not bc.BridgeAcceleration().influence_line(bridge, x).any()


# Envelopes


@every_damper
@pytest.mark.parametrize(
    "quantity",
    [kind if kind == "moment" else pytest.param(kind, marks=pytest.mark.slow) for kind in KINDS],
)
@pytest.mark.slow
def test_an_envelope_has_the_peaks_of_each_place(haunched, truck, road, quantity, damper):
    """Within 1e-6 of the largest; 2e-4 where a damper switches: its steps end at samples too."""
    options = {"start": -20, "damper": damper}
    at = [3.0, 10.0, 20.0, 27.5, 44.0]
    found = bc.envelope(haunched, truck, 25.0, road, quantity=quantity, at=at, **options)
    assert found.places.tolist() == at
    tolerance = (1e-6 if damper is not FITTED["skyhook"] else 2e-4) * np.abs(found.largest).max()
    for i, place in enumerate(at):
        for sense in ("largest", "smallest"):
            effect = KINDS[quantity](place, sense=sense)
            peak = bc.peak_effect(haunched, truck, 25.0, road, effect=effect, **options)[0]
            assert getattr(found, sense)[i] == pytest.approx(peak, abs=tolerance)
            static = effect.static_peak(haunched, truck.linear)
            limit = 1e-5 * np.abs(found.static_largest).max()
            assert getattr(found, f"static_{sense}")[i] == pytest.approx(static, abs=limit)


def test_an_envelope_tells_where_the_vehicle_is(haunched, truck):
    found = bc.envelope(haunched, truck, 25.0, at=[10.0, 30.0])
    for i, place in enumerate(found.places):
        effects = {"it": bc.Moment(place)}
        for sense in ("largest", "smallest"):
            when = getattr(found, f"{sense}_at")[i] / found.speed
            response = bc.crossing_response(
                haunched, truck, 25.0, effects=effects, timepts=[0, when]
            )
            value = getattr(found, sense)[i]
            assert response.outputs["it"][-1] == pytest.approx(value, rel=1e-5)


@pytest.mark.slow
def test_the_envelope_of_a_truck_that_creeps_is_the_static_one(spans, truck):
    """Within half a percent of the largest moment at 0.5 m/s."""
    damped = replace(spans, n_modes=4, damping_ratio=0.05)
    found = bc.envelope(damped, truck, 0.5, at=np.linspace(0, 50, 21))
    limit = 5e-3 * found.static_largest.max()
    assert found.largest == pytest.approx(found.static_largest, abs=limit)
    assert found.smallest == pytest.approx(found.static_smallest, abs=limit)


@pytest.mark.slow
def test_a_bridge_turned_round_has_the_static_envelope_turned_round(haunched, truck):
    turned = replace(
        haunched, spans=[30, 20], flexural_rigidity=haunched.flexural_rigidity[::-1],
        supports=["clamped", "simple", "simple"],
    )  # fmt: skip
    there, back = (bc.envelope(each, truck, 25.0) for each in (haunched, turned))
    assert back.places == pytest.approx(50 - there.places[::-1])
    limit = 1e-5 * there.static_largest.max()
    assert back.static_largest == pytest.approx(there.static_largest[::-1], abs=limit)
    assert back.static_smallest == pytest.approx(there.static_smallest[::-1], abs=limit)


@pytest.mark.slow
def test_a_symmetric_bridge_and_a_mirrored_truck_have_mirrored_static_envelopes(spans, truck):
    car = replace(truck, sprung_mass=3000.0)
    trains = [bc.convoy(each, [0, 5]) for each in ([truck, car], [car, truck])]
    there, back = (bc.envelope(spans, each, 25.0) for each in trains)
    limit = 1e-5 * there.static_largest.max()
    assert back.static_largest == pytest.approx(there.static_largest[::-1], abs=limit)
    assert back.static_smallest == pytest.approx(there.static_smallest[::-1], abs=limit)


@pytest.mark.slow
def test_places_are_even_ones_with_supports_and_steps(haunched, bridge, truck):
    moments = bc.envelope(haunched, truck, 25.0)
    assert set(haunched.kinks(0.5)) <= set(moments.places)
    assert moments.places.size == 101  # all of them are among the even ones
    shear = bc.envelope(haunched, truck, 25.0, quantity="shear")
    behind = shear.places[np.searchsorted(shear.places, 20.0) + 1]
    assert behind == pytest.approx(20.001)
    assert not np.any(bc.envelope(bridge, truck, 25.0).largest[[0, -1]].round())


def test_a_modal_bridge_has_the_places_that_are_told(spans, truck):
    x = np.linspace(0, 50, 101)
    told = {
        ("moment", s): (x, spans.influence_line(x, s), spans.modal_effects(s)) for s in (0.2, 0.5)
    }
    shapes, masses = spans.mode_shapes(x), spans.modal_masses
    modal = bc.ModalBridge(x, shapes, spans.frequencies, masses, 0.01, effects=told)
    found, exact = (bc.envelope(each, truck, 25.0, at=at) for each, at in (
        (modal, None), (spans, [10.0, 25.0]),
    ))  # fmt: skip
    assert found.places == pytest.approx([10.0, 25.0])
    assert found.largest[0] == pytest.approx(exact.largest[0], rel=0.01)
    assert found.smallest == pytest.approx(exact.smallest, rel=0.01)


@pytest.mark.quick_cases(1)
@pytest.mark.parametrize("damper", [None, FITTED["skyhook"]])
def test_an_envelope_in_flight_is_that_of_single_places(spans, truck, violent, damper):
    """Within 1e-5 of the largest; the tire leaves the road and lands on either way."""
    given = spans, truck, SPEEDS[2], violent
    with pytest.warns(bc.LiftOffWarning, match="first with the reference tire at x ="):
        found = bc.envelope(*given, at=[12.5, 25.0], damper=damper)
    with pytest.warns(bc.LiftOffWarning):
        peak = bc.peak_effect(*given, effect=PIER, damper=damper)[0]
    assert found.smallest[1] == pytest.approx(peak, rel=1e-5)


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"quantity": "torsion"}, "quantity must be one of 'moment'"),
        ({"at": [30.0]}, "at must be places on the bridge, from 0 to 25 m, got 30 to 30 m"),
        ({"at": []}, "at must be places on the bridge.*got none"),
        ({"at": "middle"}, "at must be an array of numbers"),
        ({"recovery": "exakt"}, "recovery must be one of"),
        ({"damper": 7e3}, "damper must be"),
        ({"start": 5.0}, "start must be 0 m"),
    ],
)
def test_what_is_no_envelope_is_told(bridge, truck, options, message):
    with pytest.raises((TypeError, ValueError), match=message):
        bc.envelope(bridge, truck, 25.0, **options)


def test_an_envelope_shows_itself_in_one_line(bridge, truck):
    assert repr(bc.envelope(bridge, truck, 25.0, at=[5.0, 12.5])) == (
        "Envelope(moment at 2 places, 90 km/h: from -3.308e+04 N m at x = 12.5 m to 6.155e+05 N m "
        "at x = 12.5 m)"
    )


# Figures


@pytest.mark.quick_cases(1)
@pytest.mark.parametrize(
    ("quantity", "label", "factor"),
    [("moment", "moment [kN m]", 1e-3), ("deflection", "deflection [mm]", 1e3),
     ("shear", "shear [kN]", 1e-3), ("acceleration", "acceleration [m/s²]", 1.0)],
)  # fmt: skip
def test_an_envelope_draws_its_own_numbers_and_the_supports(
    haunched, truck, quantity, label, factor
):
    found = bc.envelope(haunched, truck, 25.0, quantity=quantity)
    axes = found.plot()
    assert (axes.get_xlabel(), axes.get_ylabel()) == ("x from the start of the bridge [m]", label)
    drawn = {line.get_label(): line.get_ydata() for line in axes.lines}
    assert drawn["largest"] == pytest.approx(factor * found.largest)
    assert drawn["smallest"] == pytest.approx(factor * found.smallest)
    assert ("static" in drawn) == (quantity != "acceleration")
    marked = [line.get_xdata()[0] for line in axes.lines if line.get_ls() == "None"]
    assert marked == [0, 20, 50]
    assert axes.yaxis_inverted() == (quantity != "shear")


def test_a_bridge_is_drawn_with_its_modes_or_an_influence_line(haunched, bridge):
    modes = bc.plots.bridge_plot(haunched)
    names = [text.get_text() for text in modes.get_legend().get_texts()]
    assert names == [f"mode {i + 1}: {f:.3g} Hz" for i, f in enumerate(haunched.frequencies[:4])]
    line = bc.plots.bridge_plot(bridge, bc.Deflection())
    assert line.get_title(loc="left") == "deflection at 12.5 m per force"
    assert line.lines[0].get_ydata().max() == pytest.approx(
        1e6 * bc.Deflection().influence_line(bridge, 12.5)
    )


def test_supports_have_their_own_marks():
    bridge = bc.Bridge(
        [6, 25, 20], MU, EJ, supports=["free", "simple", {"vertical": 5e8}, "clamped"]
    )
    places, marks = zip(*supports_of(bridge), strict=True)
    assert places == (6, 31, 51)
    assert len(set(marks)) == 3
