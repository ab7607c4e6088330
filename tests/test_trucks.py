"""Trucks from parts: against matrices of an independent solution, and against statics by hand."""

import dataclasses
import json
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, reject
from hypothesis import strategies as st

import bridgectl as bc
from bridgectl.model.trucks import Axle, Body, articulated, half_car, rigid

G = 9.81
REFERENCE = Path(__file__).parents[2] / "shared" / "reference" / "vehicles.json"

needs_reference = pytest.mark.skipif(
    not REFERENCE.is_file(), reason="the shared reference files are not here"
)


@pytest.fixture(scope="module")
def reference():
    return json.loads(REFERENCE.read_text(encoding="utf-8"))


def built(told):
    """A truck of the reference from its parts."""
    numbers = zip(
        told["axle_coordinate_behind_own_body_cg_m"], told["axle_mass_kg"],
        told["suspension_stiffness_N_m"], told["tyre_stiffness_N_m"],
        told["suspension_damping_Ns_m"], told["tyre_damping_Ns_m"], strict=True,
    )  # fmt: skip
    axles = [Axle(*each) for each in numbers]
    bodies = zip(told["body_mass_kg"], told["body_inertia_kg_m2"], strict=True)
    if len(told["body_mass_kg"]) == 1:
        return rigid(Body(*next(bodies), axles))
    tractor, trailer = (
        Body(*each, axles[part]) for each, part in zip(bodies, (slice(2), slice(2, 5)), strict=True)
    )
    ahead = told["hinge_ahead_of_body2_cg_m"]
    return articulated(tractor, trailer, (told["hinge_behind_body1_cg_m"], -ahead))


@needs_reference
@pytest.mark.parametrize("made", ["built", "load"])
@pytest.mark.parametrize("name", ["T2", "T5", "T5air"])
def test_matrices_offsets_and_loads_are_those_of_an_independent_solution(reference, name, made):
    told = reference["vehicles"][name]
    truck = built(told) if made == "built" else bc.trucks.load(name)
    assert list(truck.coordinates) == told["coordinates"]
    for key, of in {
        "mass_matrix": "mass_matrix",
        "damping_matrix": "damping_matrix_without_tyres",
        "stiffness_matrix": "stiffness_matrix_without_tyres",
        "tire_map": "tyre_map",
        "tire_offsets": "axle_offsets_behind_first_m",
    }.items():
        expected = np.array(told[of])
        worst = np.abs(getattr(truck, key) - expected).max()
        assert worst <= 1e-12 * np.abs(expected).max(), key
    # Printed to ten digits.
    assert truck.static_loads == pytest.approx(told["static_axle_loads_N"], rel=1e-9)
    assert truck.frequencies == pytest.approx(
        told["natural_frequencies_on_rigid_road_Hz"], rel=1e-9
    )


@pytest.mark.quick_cases(2)
@needs_reference
@pytest.mark.parametrize(
    "name",
    [
        "a_T2_SS25_smooth_20", "a_T2_SS25_ramp_25", "a_T2_SS25_iso_20", "b_T5_SS25_smooth_20",
        "b_T5_SS25_isoL_25", "b_T5_SS25_ramp_25", "c_T5_TS50_smooth_30", "g_T5airct_SS25_smooth_25",
    ],
)  # fmt: skip
@pytest.mark.filterwarnings("ignore:start = -100 m is not forgotten:UserWarning")
def test_amplifications_are_those_of_an_independent_solution(reference, name):
    case = reference["cases"][name]
    (told,) = case["vehicles"]
    bridge, road = reference["bridges"][case["bridge"]], reference["roads"][case["road"]]
    spans = np.diff([support["x_m"] for support in bridge["supports"]]).tolist()
    deck = bc.Bridge(
        spans, bridge["mass_per_length_kg_m"], bridge["flexural_rigidity_N_m2"],
        n_modes=case["oracle_modes"],
    )  # fmt: skip
    profile = None if road["x_m"] is None else bc.RoadProfile(road["x_m"], road["elevation_m"])
    for place, result in case["sections"].items():
        sense = "largest" if result["peak_moment_static_Nm"] > 0 else "smallest"
        daf = bc.daf(
            deck, built(reference["vehicles"][told["vehicle"]]), told["speed_m_s"], profile,
            start=told["front_axle_start_m"], effect=bc.Moment(float(place), sense=sense),
        )  # fmt: skip
        assert daf == pytest.approx(result["daf_moment"], abs=2e-4)


def random_body(rng, n_axles):
    """A body on axles, and groups of two or three, in which no leg is far from the next."""
    place, axles = -rng.uniform(1, 3), []
    for i in range(n_axles):
        spread = np.arange(rng.integers(1, 4)) * rng.uniform(1.0, 1.4)
        spread -= spread.mean()
        axles.append(
            Axle(
                place - spread[0], rng.uniform(500, 1500), rng.uniform(2e5, 5e6),
                rng.uniform(1e6, 4e6), rng.uniform(0, 3e4), spread=spread,
                inertia=rng.uniform(100, 500) if spread.size > 1 else 0.0, name=f"a{i}",
            )
        )  # fmt: skip
        place += spread[-1] - spread[0] + rng.uniform(1.5, 4)
    first, last = axles[0].place, axles[-1].place
    centre = first + rng.uniform(0.35, 0.65) * (last - first)
    return Body(rng.uniform(5e3, 3e4), rng.uniform(1e4, 2e5), axles, centre=centre)


@given(st.integers(0, 10_000), st.integers(2, 5))
def test_a_rigid_truck_has_the_loads_of_a_stiff_beam_on_springs(seed, n_axles):
    """Each leg is its spring and tires in series; a group on a hinge shares evenly among tires."""
    body = random_body(np.random.default_rng(seed), n_axles)
    tires = np.array([sum(axle.tire_stiffnesses) for axle in body.axles])
    springs = 1 / (1 / np.array([axle.suspension_stiffness for axle in body.axles]) + 1 / tires)
    # Each axle's own weight sags its tires first, away from the beam.
    sagged = np.array([axle.mass * G for axle in body.axles]) / tires
    arms = np.array([axle.place - body.centre for axle in body.axles])
    rows = np.column_stack([np.ones_like(arms), arms])
    weight = np.array([body.mass * G, 0]) + rows.T @ (springs * sagged)
    beam = np.linalg.solve(rows.T @ (springs[:, np.newaxis] * rows), weight)
    carried = springs * (rows @ beam - sagged)
    each = [
        (force + axle.mass * G) / len(axle.spread)
        for force, axle in zip(carried, body.axles, strict=True) for _ in axle.spread
    ]  # fmt: skip
    if min(each) <= 0:
        with pytest.raises(ValueError, match="would carry -"):
            rigid(body)
        return
    assert rigid(body).static_loads == pytest.approx(each, rel=1e-9)


@given(st.integers(0, 10_000))
def test_an_articulated_truck_weighs_what_its_parts_do_and_its_trailer_leans_on_the_hinge(seed):
    rng = np.random.default_rng(seed)
    tractor, trailer = random_body(rng, 2), random_body(rng, 2)
    trailer = dataclasses.replace(trailer, axles=[
        dataclasses.replace(axle, name=f"trailer {axle.name}") for axle in trailer.axles
    ])  # fmt: skip
    hinge = (tractor.tire_places[-1] - 0.2, trailer.tire_places[0] - rng.uniform(1, 6))
    try:
        truck = articulated(tractor, trailer, hinge)
    except ValueError as error:
        if "would carry -" not in str(error):
            raise
        reject()
    bodies, axles = (tractor, trailer), (*tractor.axles, *trailer.axles)
    mass = sum(part.mass for part in (*bodies, *axles))
    assert truck.mass == pytest.approx(mass, rel=1e-12)
    assert truck.static_loads.sum() == pytest.approx(mass * G, rel=1e-9)
    loads = truck.static_loads[len(tractor.tire_places) :]
    arms = np.array(trailer.tire_places) - hinge[1]
    own = trailer.mass * (trailer.centre - hinge[1])
    own += sum(axle.mass * (axle.place - hinge[1]) for axle in trailer.axles)
    assert loads @ arms == pytest.approx(own * G, rel=1e-9)


def test_a_load_on_a_body_is_a_mass_at_its_place():
    """A heavy point on the floor: the same loads and frequencies as with its own row in M."""
    empty = Body(6000, 25e3, [Axle(0, 700, 4e5, 1.75e6), Axle(5, 1100, 1e6, 3.5e6)], centre=2.0)
    alone, loaded = rigid(empty), rigid(empty.loaded(8000, 4.0, 20e3))
    at, pitch = np.array([1, 4.0 - 2.0, 0, 0]), np.array([0, 1, 0, 0])
    mass = alone.mass_matrix + 8000 * np.outer(at, at) + 20e3 * np.outer(pitch, pitch)
    same = dataclasses.replace(alone, mass_matrix=mass)
    assert loaded.static_loads == pytest.approx(same.static_loads, rel=1e-12)
    assert loaded.frequencies == pytest.approx(same.frequencies, rel=1e-9)


def test_the_height_of_a_load_raises_the_centre_of_gravity_and_adds_to_the_inertia():
    axles = [Axle(0, 700, 4e5, 1.75e6), Axle(5, 1100, 1e6, 3.5e6)]
    body = Body(6000, 25e3, axles, centre=2.0, height=1.0).loaded(2000, 2.0, height=3.0)
    assert body.height == pytest.approx(1.5)
    assert body.inertia == pytest.approx(25e3 + 6000 * 0.5**2 + 2000 * 1.5**2)
    assert body.centre == 2.0


def test_places_count_from_anywhere():
    def truck(origin):
        axles = [Axle(d + origin, 900, 6e6, 1.75e6, 1e4) for d in (-2.5, 1.2, 2.5)]
        return rigid(Body(10500, 5e4, axles, centre=origin))

    here, there = truck(0.0), truck(7.0)
    assert here.static_loads == pytest.approx(there.static_loads, rel=1e-9)
    assert here.stiffness_matrix == pytest.approx(there.stiffness_matrix, rel=1e-9)
    assert here.tire_offsets == pytest.approx([0, 3.7, 5])


def test_a_half_car_of_numbers_is_that_of_parts():
    truck = half_car(10500, 5e4, (-2.0, 3.0), (700, 900), (3e6, 6e6), 1.75e6, damping=(1e4, 2e4))
    front, rear = Axle(-2.0, 700, 3e6, 1.75e6, 1e4), Axle(3.0, 900, 6e6, 1.75e6, 2e4)
    assert truck == rigid(Body(10500, 5e4, [front, rear]))
    assert truck.damper_names == ("front", "rear")
    tall = half_car(10500, 5e4, (-2.0, 3.0), (700, 900), (3e6, 6e6), 1.75e6, (1e4, 2e4), height=1.4)
    assert tall == rigid(Body(10500, 5e4, [front, rear], height=1.4)) != truck


def test_a_group_has_one_leg_and_turns_about_it():
    group = Axle(
        4.0, 2250, 2.25e6, (3.0e6, 3.5e6, 4.0e6), 3e3, spread=(-1.1, 0, 1.1), inertia=200.0,
        name="tridem",
    )  # fmt: skip
    truck = rigid(Body(18e3, 6e4, [Axle(-2.0, 700, 4e5, 1.75e6), group]))
    assert truck.coordinates == ("yB", "thB", "yG1", "yG2", "thG2")
    assert truck.damper_names == ("front", "tridem")
    assert truck.tire_map[1:, 3:].tolist() == [[1, -1.1], [1, 0], [1, 1.1]]
    assert truck.tire_stiffnesses[1:].tolist() == [3.0e6, 3.5e6, 4.0e6]
    assert truck.damper_map.tolist() == [[1, -2, -1, 0, 0], [1, 4, 0, -1, 0]]
    assert np.diag(truck.mass_matrix).tolist() == [18e3, 6e4, 700, 2250, 200]
    # Nothing turns the group but the tires: their moment about the leg is zero.
    assert truck.static_loads[1:] @ [-1.1, 0, 1.1] == pytest.approx(0, abs=1e-6)  # N m


def test_a_tridem_of_one_suspension_is_vbi_2ds():
    """Expressions of VBI-2D's Vehicle_2A3_G_1_1_3.m, typed out: yB1, thB1, thB2, yG1-3, thG3."""
    truck = bc.trucks.load("T5tridem")
    b1, a2, d3, kt, k3, k = 2.15, 6.15, 1.9, 3.5e6, 2.25e6, (4e5, 1e6)
    assert truck.coordinates == ("yB1", "thB1", "thB2", "yG1", "yG2", "yG3", "thG3")
    assert truck.mass_matrix[0, 2] == pytest.approx(a2 * 31450)
    assert truck.mass_matrix[1, 1] == pytest.approx(4604 + b1**2 * 31450)
    assert truck.mass_matrix[6].tolist() == [0, 0, 0, 0, 0, 0, 200]
    stiffness = truck.stiffness_matrix
    assert stiffness[0, 1] == pytest.approx(b1 * k3 - 0.5 * k[0] + 2.5 * k[1])
    assert stiffness[2, 2] == pytest.approx(k3 * (a2 + d3) ** 2)
    assert stiffness[2, 5] == pytest.approx(-k3 * (a2 + d3))
    tires = truck.tire_map.T @ np.diag(truck.tire_stiffnesses) @ truck.tire_map
    assert (stiffness + tires)[6, 6] == pytest.approx(2 * 1.1**2 * kt)
    expected = [0, 3, a2 + b1 + 0.5 + d3 - 1.1, a2 + b1 + 0.5 + d3, a2 + b1 + 0.5 + d3 + 1.1]
    assert truck.tire_offsets == pytest.approx(expected)


def test_tires_have_their_damping():
    group = Axle(4.0, 2e3, 2e6, 3e6, 3e3, (5e3, 8e3), spread=(-0.6, 0.6), inertia=200.0)
    truck = rigid(Body(18e3, 6e4, [Axle(-2.0, 700, 4e5, 1.75e6, tire_damping=1e4), group]))
    assert truck.tire_damping.tolist() == [1e4, 5e3, 8e3]
    assert bc.trucks.load("T5tridem").tire_damping.tolist() == [1e4] * 5


def test_braking_moves_load_forward_by_height_over_wheelbase():
    body = Body(10500, 5e4, [Axle(-2.5, 900, 6e6, 1.75e6), Axle(2.5, 900, 6e6, 1.75e6)], height=1.4)
    truck = rigid(body)
    moved = -3.0 * truck.tire_stiffnesses * (truck.hubs @ truck.pitched)  # at -3 m/s^2
    assert moved == pytest.approx(10500 * 3.0 * 1.4 / 5.0 * np.array([1, -1]), rel=1e-9)


def test_of_a_semitrailer_each_body_brakes_itself():
    """Moments about the hinge of what the trailer's axles gain, and about the road of all."""
    tractor, trailer = (
        dataclasses.replace(body, height=h) for body, h in ((TRACTOR, 1.0), (TRAILER, 2.0))
    )
    truck = articulated(tractor, trailer, (2, -5))
    moved = truck.tire_stiffnesses * (truck.hubs @ truck.pitched)  # at 1 m/s^2
    assert moved[2:] @ [8.0, 9.2] == pytest.approx(2e4 * 2.0, rel=1e-9)
    assert moved.sum() == pytest.approx(0, abs=1e-6)
    assert moved @ truck.tire_offsets == pytest.approx(4000 * 1.0 + 2e4 * 2.0, rel=1e-9)


def test_the_dampers_stand_between_body_and_axle_and_are_part_of_the_damping():
    truck = bc.trucks.load("T5air")
    tops = truck.damper_map + truck.damper_axles
    assert np.all(tops[:, 3:] == 0)
    assert truck.damper_dampings.tolist() == [1e4] * 5
    assert truck.undamped.damping_matrix == pytest.approx(0, abs=1e-6)  # N s/m
    assert truck.undamped.damper_names == truck.damper_names
    assert truck.heave.tolist() == [1, 0, 0, 1, 1, 1, 1, 1]


def test_bodies_are_drawn_where_they_move_with_the_hinge():
    truck = bc.trucks.load("T5")
    (tractor_front, tractor_rear), (hinge, rear) = truck.body_places
    share = (hinge - tractor_front) / (tractor_rear - tractor_front)
    (first, last), (at_hinge, _) = truck.body_map
    assert at_hinge == pytest.approx(first + share * (last - first))
    assert hinge == pytest.approx(4.0)
    assert rear > truck.tire_offsets[-1]


def test_a_convoy_of_trucks_keeps_their_bodies():
    two = bc.convoy([bc.li2006.car(), bc.trucks.load("T2"), bc.trucks.load("T5")], [0, 8, 20])
    assert two.body_places == pytest.approx(
        np.vstack([bc.trucks.load("T2").body_places + 8, bc.trucks.load("T5").body_places + 20])
    )
    assert two.body_map.shape == (3, 2, 2 + 4 + 8)
    assert np.all(two.body_map[1:, :, :6] == 0)
    assert two.damper_names[:3] == ("1_1", "front_2", "rear_2")


@pytest.mark.parametrize(
    ("scale", "says"),
    [
        ({"inertia": 1e-3, "mass": 1e-3, "axle": 1e-3}, "mass is 12.3 kg: are its masses in t"),
        ({"stiffness": 1e-3}, "lowest frequency on a rigid road is 0.0769 Hz"),
        ({"axle": 1e-3}, "an axle moves at 467 Hz, trucks' at 100 Hz at most: check its mass"),
    ],
)
def test_units_that_can_hardly_be_meant_are_told_on_the_callers_line(scale, says):
    body, stiffness = scale.get("mass", 1), scale.get("stiffness", 1)
    own, inertia = scale.get("axle", 1), scale.get("inertia", 1)
    with pytest.warns(bc.PlausibilityWarning, match=says) as told:
        half_car(10500 * body, 5e4 * inertia, (-2.5, 2.5), 900 * own, 6e6 * stiffness,
                 1.75e6 * stiffness)  # fmt: skip
    assert [each.filename for each in told] == [__file__]
    axles = [Axle(d, 900 * own, 6e6 * stiffness, 1.75e6 * stiffness) for d in (-2.5, 2.5)]
    with pytest.warns(bc.PlausibilityWarning, match=says):
        rigid(Body(10500 * body, 5e4 * inertia, axles))


AXLE = {"place": 0.0, "mass": 900, "suspension_stiffness": 6e6, "tire_stiffness": 1.75e6}
GROUP = {**AXLE, "spread": (-0.6, 0.6), "inertia": 300}


@pytest.mark.parametrize(
    ("change", "error", "says"),
    [
        ({"mass": 0}, ValueError, "mass must be above 0 [kg]"),
        (
            {"place": "2"},
            TypeError,
            "place must be one number [m], got '2': type 2, without quotes",
        ),
        ({"suspension_stiffness": -1}, ValueError, "suspension_stiffness must be above 0 [N/m]"),
        ({"tire_stiffness": 0}, ValueError, "tire_stiffness must be above 0 [N/m]"),
        ({"tire_stiffness": [1e6, 1e6]}, ValueError, "tire_stiffness must have shape (1,)"),
        ({"tire_damping": -5}, ValueError, "tire_damping must be 0 or more [N s/m]"),
        ({"damping": -5}, ValueError, "damping must be 0 or more [N s/m], got -5: type 5"),
        ({"name": 3}, TypeError, "name must be text, got 3"),
        ({"spread": [0.6, -0.6]}, ValueError, "spread must rise from front to rear"),
        ({"spread": []}, ValueError, "spread must rise"),
        ({"spread": [1.0]}, ValueError, "spread of one axle must be (0,)"),
        ({"spread": [-0.6, 0.6]}, ValueError, "spread and inertia go together"),
        ({"inertia": 300}, ValueError, "spread and inertia go together"),
        ({**GROUP, "tire_stiffness": [1e6, -1e6]}, ValueError, "tire_stiffness must be 0 or more"),
    ],
)
def test_a_bad_axle_is_told_by_its_argument(change, error, says):
    with pytest.raises(error) as caught:
        Axle(**{**AXLE, **change})
    assert says in str(caught.value)


def axle(place, **change):
    return Axle(**{**AXLE, "place": place, **change})


@pytest.mark.parametrize(
    ("change", "error", "says"),
    [
        ({"mass": -1}, ValueError, "mass must be above 0 [kg]"),
        ({"inertia": 0}, ValueError, "inertia must be above 0 [kg m^2]"),
        ({"height": -1}, ValueError, "height must be 0 or more [m]"),
        ({"axles": [axle(2), axle(-2)]}, ValueError, "got 2 m before -2 m: places are positive"),
        ({"axles": []}, ValueError, "axles must be in order from front to rear"),
        ({"axles": [Axle(**{**GROUP, "place": 1}), axle(1.5)]}, ValueError, "1.6 m before 1.5 m"),
        ({"axles": [900, 900]}, TypeError, "axles must be a list of bridgectl.trucks.Axle"),
    ],
)
def test_a_bad_body_is_told_by_its_argument(change, error, says):
    with pytest.raises(error) as caught:
        Body(**{"mass": 1e4, "inertia": 5e4, "axles": [axle(-2), axle(2)], **change})
    assert says in str(caught.value)


TRACTOR = Body(4000, 5e3, [axle(-1), axle(2.5)])
TRAILER = Body(2e4, 1e5, [axle(3), axle(4.2)])


@pytest.mark.parametrize(
    ("make", "error", "says"),
    [
        (lambda: rigid(Body(1e4, 5e4, [axle(0)])), ValueError, "for one wheel type"),
        (lambda: rigid(TRACTOR.axles), TypeError, "body must be a bridgectl.trucks.Body"),
        (lambda: rigid(Body(1e4, 5e4, [axle(1), axle(4)])), ValueError,
         "axle 'rear' would carry -23.87 kN, and every tire needs a load above 0: move the centre"),
        (lambda: articulated(TRACTOR, TRAILER, (-1.5, -5)), ValueError,
         "hinge must be behind the tractor's first axle, which is at -1 m, got hinge[0] = -1.5 m"),
        (lambda: articulated(TRACTOR, TRAILER, (2, 5)), ValueError,
         "hinge[1] = 5 m: places are positive backward, for 5 m ahead type -5"),
        (lambda: articulated(TRACTOR, TRAILER, (5, -5)), ValueError,
         "would carry -"),
        (lambda: articulated(TRACTOR, TRAILER, (-0.9, 2.9)), ValueError,
         "hinge puts the trailer's first axle 3.3 m ahead of the tractor's last one"),
        (lambda: articulated(TRACTOR, TRAILER, 2), ValueError, "hinge must have shape (2,)"),
        (lambda: articulated(Body(4e3, 5e3, [axle(0)]), TRAILER, (1, -5)), ValueError,
         "tractor must have two axles"),
        (lambda: rigid(Body(1e4, 5e4, [axle(-2, name="a"), axle(2, name="a")])), ValueError,
         "axles must have different names, got 'a' twice"),
        (lambda: half_car(1e4, 5e4, (2, -2), 900, 6e6, 2e6), ValueError, "axles must be in order"),
        (lambda: half_car(1e4, 5e4, (-2, 2), (1, 2, 3), 6e6, 2e6), ValueError,
         "axle_mass must have shape (2,)"),
        (lambda: half_car(1e4, 5e4, (-2, 2), None, 6e6, 2e6), TypeError,
         "axle_mass must be one number [kg]"),
        (lambda: TRAILER.loaded(-5, 0), ValueError, "mass must be above 0 [kg], got -5"),
    ],
)  # fmt: skip
def test_what_makes_no_truck_is_one_clear_error(make, error, says):
    with pytest.raises(error) as caught:
        make()
    assert says in str(caught.value)
