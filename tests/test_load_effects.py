"""Shear, reactions, stress and accelerations of any bridge, by every route."""

import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from helpers import rough_road
from scipy.integrate import simpson

import bridgectl as bc
from bridgectl.dampers import (
    bridgehook,
    clairvoyant,
    passive,
    program_sensitivity,
    simulate_loop,
    skyhook,
)
from bridgectl.model.crossing import make_crossing

VEHICLES = Path(__file__).parents[2] / "shared" / "reference" / "vehicles.json"
SPAN = {"mass_per_length": 18358.0, "flexural_rigidity": 4.86535e10}
SPEEDS = np.array([60, 90, 120]) / 3.6
ALONG = [
    bc.Shear(10.0), bc.Shear(10.0, sense="smallest"), bc.Shear(0.0), bc.Reaction(0.0),
    bc.Reaction(25.0), bc.Stress(10.0, section_modulus=1.1), bc.BridgeAcceleration(10.0),
    bc.BridgeAcceleration(10.0, sense="smallest"), bc.Moment(10.0), bc.Deflection(10.0),
]  # fmt: skip


@pytest.fixture(scope="module")
def two_spans():
    return bc.Bridge([25.0, 20.0], **SPAN, n_modes=8, damping_ratio=0.02)


@pytest.fixture(scope="module")
def road():
    return rough_road(3, -20, 46)


# A beam's closed forms are those of the general bridge


@pytest.mark.parametrize(
    ("quantity", "section"),
    [
        *[(quantity, section) for quantity in ("moment", "shear", "deflection")
          for section in (0.3, 0.5)],
        ("shear", 0.0), ("shear", 1.0), ("deflection", 1.0), ("reaction", 0.0), ("reaction", 1.0),
    ],
)  # fmt: skip
def test_a_beam_tells_what_a_bridge_of_one_span_does(quantity, section):
    beam, general = bc.Beam(25.0, **SPAN, n_modes=5), bc.Bridge(25.0, **SPAN, n_modes=5)
    x = np.linspace(-2, 27, 291)
    line = beam.influence_line(x, section, quantity)
    scale = np.abs(line).max()
    other = general.influence_line(x, section, quantity)
    assert line == pytest.approx(other, abs=1e-9 * scale + 1e-20)
    per_mode = beam.modal_effects(section, quantity)
    assert per_mode == pytest.approx(
        general.modal_effects(section, quantity), abs=1e-8 * np.abs(per_mode).max() + 1e-12
    )


@pytest.mark.parametrize("effect", ALONG, ids=repr)
def test_every_effect_of_a_beam_is_that_of_a_bridge_of_one_span(truck, effect):
    beam, general = bc.Beam(25.0, **SPAN, n_modes=5), bc.Bridge(25.0, **SPAN, n_modes=5)
    first, second = (bc.peak_effect(b, truck, SPEEDS, effect=effect) for b in (beam, general))
    assert first == pytest.approx(second, rel=1e-8)


def test_a_beam_has_no_reaction_in_its_span_and_no_other_effects(bridge, truck):
    with pytest.raises(ValueError, match="place of a support that has a reaction, 0 or 1"):
        bc.peak_effect(bridge, truck, 25.0, effect=bc.Reaction(10.0))
    with pytest.raises(ValueError, match="quantity must be one of 'moment', 'shear'"):
        bridge.influence_line(3.0, 0.5, "torsion")
    with pytest.raises(ValueError, match="section_modulus must be"):
        bc.Stress(10.0)


def test_what_a_bridge_does_not_tell_is_an_error(truck):
    from test_bridge_model import Sines

    with pytest.raises(TypeError, match="beam must tell its shear force"):
        bc.peak_effect(Sines(25.0, 18358.0, 4.9e10), truck, 25.0, effect=bc.Shear(10.0))


# What the effects are


@pytest.mark.quick_cases(3)
@pytest.mark.parametrize(
    "effect",
    [bc.Shear(10.0), bc.Shear(10.0, sense="smallest"), bc.Reaction(25.0), bc.Moment(10.0),
     bc.Moment(25.0, sense="smallest"), bc.Stress(10.0, section_modulus=1.1),
     bc.Reaction(45.0, sense="smallest"), bc.Deflection(10.0),
     bc.Shear(25.0, sense="smallest")],
    ids=repr,
)  # fmt: skip
def test_a_creeping_truck_has_the_static_effect(truck, two_spans, effect):
    damped = replace(two_spans, damping_ratio=0.01)
    assert bc.daf(damped, truck, 0.5, effect=effect)[0] == pytest.approx(1, abs=1e-3)


def test_a_stress_is_a_moment_over_its_section_modulus(bridge, truck, road):
    stress, moment = (
        bc.peak_effect(bridge, truck, SPEEDS, road.crop(-20, 26), start=-20, effect=effect)
        for effect in (bc.Stress(10.0, section_modulus=1.1, recovery="li2006"),
                       bc.Moment(10.0, recovery="li2006"))
    )  # fmt: skip
    assert stress == pytest.approx(moment / 1.1, rel=1e-12)


def test_the_acceleration_of_the_bridge_is_that_of_its_deflection(truck, two_spans, road):
    response = bc.crossing_response(two_spans, truck, 25.0, road, start=-20)
    x, states = response.time * 25.0, np.asarray(response.states)
    forces = np.asarray(response.outputs["tire_force"])[:, np.newaxis]
    crossing = make_crossing(two_spans, truck, bc.BridgeAcceleration(10.0))
    acceleration, states = crossing.values(x, states.T, forces), states[4:]
    rates = two_spans.mode_shapes(10.0) @ states[1::2]
    steps = np.diff(x) / 25.0
    gathered = np.concatenate([[0], np.cumsum(steps * (acceleration[1:] + acceleration[:-1]) / 2)])
    assert rates - rates[0] == pytest.approx(gathered, abs=1e-3 * np.abs(rates).max())


@pytest.mark.skipif(not VEHICLES.exists(), reason="the reference numbers are not shipped")
@pytest.mark.parametrize(
    ("case", "effect", "n_modes"),
    [
        ("c_QC_TS50_smooth_20", bc.Moment(25.0, sense="smallest"), 24),
        ("c_QC_TS50_smooth_20", bc.Moment(10.0), 24),
        ("d_QC_CC25_smooth_20", bc.Moment(0.0, sense="smallest"), 14),
    ],
    ids=["pier", "span", "clamped end"],
)
def test_sagging_and_hogging_are_those_of_the_independent_code(truck, case, effect, n_modes):
    known = json.loads(VEHICLES.read_text(encoding="utf-8"))["cases"][case]
    section = known["sections"][f"{effect.at:g}"]
    if "TS50" in case:
        given = bc.Bridge([25.0, 25.0], **SPAN, n_modes=n_modes)
    else:
        given = bc.Bridge(25.0, **SPAN, supports=["clamped", "clamped"], n_modes=n_modes)
    static = make_crossing(given, truck, effect).static_peak
    assert static == pytest.approx(section["peak_moment_static_Nm"], rel=1e-6)
    found = bc.daf(given, truck, 20.0, start=-1.0, effect=effect)[0]
    assert found == pytest.approx(section["daf_moment"], abs=2e-5)


# By every route


@pytest.mark.parametrize("effect", [*ALONG[:3], *ALONG[4:8]], ids=repr)
def test_superposed_histories_of_every_effect_are_simulated_ones(truck, two_spans, road, effect):
    surface = bc.ramp_surface(two_spans, truck, SPEEDS, approach=20, effect=effect)
    on_ramps = surface.road(surface.ramps(road) * surface.ramp_height)
    simulated = bc.peak_effect(two_spans, truck, SPEEDS, on_ramps, start=-20, effect=effect)
    unit = make_crossing(two_spans, truck, effect).static_peak or 1.0
    assert unit * surface.superposed_daf(road) == pytest.approx(simulated, rel=1e-6)


@pytest.mark.filterwarnings("ignore:start = -10 m is not forgotten")
@pytest.mark.slow
@pytest.mark.parametrize("seed", range(20))
def test_every_effect_of_a_random_bridge_is_that_of_the_control_library(seed):
    rng = np.random.default_rng(seed)
    spans = rng.uniform(10, 30, rng.integers(1, 4))
    given = bc.Bridge(
        spans, 15e3 * rng.uniform(0.7, 1.5), 3e10 * rng.uniform(0.5, 2), n_modes=6,
        damping_ratio=0.01, supports=rng.choice(["simple", "clamped"], len(spans) + 1).tolist(),
    )  # fmt: skip
    car = bc.QuarterCar(9000 * rng.uniform(0.7, 1.3), 1000.0, 80e3, 1.8e6, 7e3)
    vehicle = bc.convoy([car, car], [0, rng.uniform(2, 9)]) if seed % 2 else car
    at = float(rng.uniform(0.1, 0.9) * given.length)
    support = float(rng.choice(given.support_places))
    effect = [
        bc.Moment(at), bc.Moment(at, sense="smallest"), bc.Shear(at), bc.Reaction(support),
        bc.BridgeAcceleration(at),
    ][seed % 5]  # fmt: skip
    road = rough_road(seed, -10, given.length + 1, height=3e-4)
    fast, reference = (
        bc.peak_effect(given, vehicle, rng_speed, road, start=-10, effect=effect, method=method)[0]
        for rng_speed, method in ((22.0, "propagator"), (22.0, "control"))
    )
    scale = abs(make_crossing(given, vehicle, effect).static_peak) or abs(reference)
    assert fast == pytest.approx(reference, abs=1e-6 * scale)


@pytest.mark.quick_cases(1)
@pytest.mark.parametrize(
    "effect",
    [bc.Moment(25.0, sense="smallest"), bc.Shear(25.0), bc.Reaction(25.0),
     bc.BridgeAcceleration(10.0)],
    ids=repr,
)  # fmt: skip
def test_loops_have_every_effect_of_every_bridge(truck, two_spans, road, effect):
    almost = skyhook(7e3, 7e3 * (1 + 1e-9))
    loop, linear = (
        bc.peak_effect(two_spans, truck, SPEEDS, road, start=-20, effect=effect, damper=damper)
        for damper in (almost, passive(7e3))
    )
    assert loop == pytest.approx(linear, rel=3e-4)


def test_surfaces_of_any_bridge_and_effect_come_back_from_files(truck, tmp_path):
    given = bc.Bridge(
        [12, 10], [(8, 15e3), (14, 18e3)], [4e10, 5e10], n_modes=4,
        supports=["clamped", "simple", {"vertical": 4e8, "rotational": 1e9}],
        damping_ratio={1: 0.02, 3: 0.03},
    )  # fmt: skip
    effect = bc.Shear(12.0, sense="smallest")
    surface = bc.ramp_surface(given, truck, SPEEDS, ramp_length=1.0, effect=effect)
    surface.save(tmp_path / "surface.npz")
    loaded = bc.load_surface(tmp_path / "surface.npz", beam=given, effect=effect)
    assert (loaded.beam, loaded.effect) == (given, effect)
    assert np.array_equal(loaded.daf_unit, surface.daf_unit)
    with pytest.raises(bc.SurfaceFileError, match="effect is Shear"):
        bc.load_surface(tmp_path / "surface.npz", effect=bc.Moment(12.0))


# Nothing that is no factor is called one


def test_what_would_be_a_factor_of_nothing_is_refused_everywhere(truck):
    pier = bc.Bridge([25.0, 25.0], **SPAN, n_modes=4)
    x = np.linspace(-5, 50, 111)
    level = bc.RoadProfile(x, 0 * x)
    hard = passive(1e3).c_max, 30e3
    for ask in (
        lambda: bc.daf(pier, truck, 25.0),
        lambda: bc.score([passive(7e3)], pier, truck, [level], 25.0, approach=5),
        lambda: bc.ramp_surface(pier, truck, 25.0),
        lambda: simulate_loop(pier, truck, passive(7e3), 25.0, x, 0 * x),
        lambda: bc.daf(pier, truck, 25.0, damper=bridgehook(pier, truck, *hard)),
        lambda: clairvoyant(pier, truck, 25.0, level, *hard),
        lambda: bc.ramp_heights(pier, truck, passive(7e3), 25.0, 5.0),
        lambda: program_sensitivity(pier, truck, 25.0, [0], [7e3], x, 0 * x),
    ):
        with pytest.raises(ValueError, match=r"is 0 N m: type another place or sense='smallest'"):
            ask()
    sagging = simulate_loop(
        pier, truck, passive(7e3), 25.0, x, 0 * x, effect=bc.Moment(25.0, sense="smallest")
    )
    assert 1 < sagging.daf[0, 0] < 1.5


# A bridge that twists, known by its modes


@pytest.mark.parametrize("n_modes", [5, 41])
def test_a_wheel_path_beside_the_axis_twists_the_bridge(truck, n_modes):
    """Closed forms of bending and St. Venant torsion, w + e theta along a path e from the axis.

    Deflection under a creeping truck at mid-span: W (l^3 / 48 E J + e^2 l / 4 G J_t), in modes.
    """
    length, mass, rigidity, polar, twisting, e = 25.0, 18358.0, 4.86535e10, 6e4, 2e10, 1.5
    j = np.arange(1, n_modes + 1)
    bending = (j * np.pi / length) ** 2 * np.sqrt(rigidity / mass)
    torsion = j * np.pi / length * np.sqrt(twisting / polar)
    x = np.linspace(0, length, 1001)
    sines = np.sin(np.outer(x, j * np.pi / length))
    half = length / 2 * np.ones(j.size)
    twisted = bc.ModalBridge(
        x, np.hstack([sines, e * sines]), np.concatenate([bending, torsion]) / (2 * np.pi),
        modal_masses=np.concatenate([mass * half, polar * half]), damping_ratio=0.02,
    )  # fmt: skip
    weight = 98100.0
    exact = weight * (length**3 / (48 * rigidity) + e**2 * length / (4 * twisting))
    static = make_crossing(twisted, truck, bc.Deflection()).static_peak
    # Modes carry 96 / pi^4 sum over odd j of j^-4 of bending, 8 / pi^2 sum of j^-2 of torsion.
    bent, turned = (np.sum(j[::2] ** -power) for power in (4.0, 2.0))
    missing = [1 - 96 / np.pi**4 * bent, 1 - 8 / np.pi**2 * turned]
    parts = [weight * length**3 / (48 * rigidity), weight * e**2 * length / (4 * twisting)]
    assert static == pytest.approx(exact - np.dot(missing, parts), rel=1e-8)
    if n_modes == 5:
        daf = bc.daf(twisted, truck, 0.5, effect=bc.Deflection())[0]
        assert daf == pytest.approx(1, abs=1e-3)


def test_the_work_of_the_tires_on_three_spans_is_energy_and_what_damping_took(truck):
    three = bc.Bridge([20.0, 25.0, 15.0], **SPAN, n_modes=9, damping_ratio=0.02)
    speed, road = 25.0, rough_road(7, -20, 61)
    response = bc.crossing_response(three, truck, speed, road, start=-20, tail=0.5)
    time, states = response.time, np.asarray(response.states)[4:]
    q, rates, mass = states[::2], states[1::2], three.modal_masses
    shapes = three.mode_shapes(speed * time)
    power = response.outputs["tire_force"] * np.einsum("mj,jm->m", shapes, rates)
    damping = 2 * three.damping_ratios * three.omega * mass
    losses = np.einsum("j,jm->m", damping, rates**2)
    energy = (mass / 2 * (rates[:, -1] ** 2 + (three.omega * q[:, -1]) ** 2)).sum()
    assert simpson(power, x=time) == pytest.approx(energy + simpson(losses, x=time), rel=1e-6)


@pytest.mark.slow
def test_a_score_is_of_the_effect_that_is_asked_for(truck, two_spans, tmp_path):
    hogging, roads = bc.Moment(25.0, sense="smallest"), [rough_road(s, -5, 46) for s in (1, 2)]
    asked = {"approach": 5, "workers": 1, "progress": False, "resume": tmp_path / "score.jsonl"}
    case = [passive(7e3)], two_spans, truck, roads, SPEEDS
    board = bc.score(*case, effect=hogging, **asked)
    alone = [bc.daf(two_spans, truck, SPEEDS, road, start=-5, effect=hogging) for road in roads]
    assert board.values["daf"][0] == pytest.approx(np.array(alone), abs=2e-5)
    for other in (bc.Shear(10.0), bc.Moment(20.0), bc.Moment(20.0, sense="smallest")):
        with pytest.raises(ValueError, match=r"score\.jsonl"):
            bc.score(*case, effect=other, **asked)
    sagging = tmp_path / "sagging.jsonl"
    bc.score(*case, effect=bc.Moment(10.0), **asked | {"resume": sagging})
    with pytest.raises(ValueError, match=r"sagging\.jsonl"):
        bc.score(*case, effect=bc.Moment(10.0, sense="smallest"), **asked | {"resume": sagging})
    again = bc.score(*case, effect=hogging, **asked)
    assert np.array_equal(again.values["daf"], board.values["daf"])


def test_a_rigid_support_does_not_deflect(truck):
    pier = bc.Bridge([25.0, 25.0], **SPAN, n_modes=4)
    with pytest.raises(ValueError, match=r"largest static deflection of .* is 0 m"):
        bc.daf(pier, truck, 25.0, effect=bc.Deflection(25.0))
