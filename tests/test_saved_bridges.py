"""Surfaces and scores of any bridge and any effect come back from files, or are refused."""

import dataclasses
import json

import numpy as np
import pytest
from helpers import rough_road

import bridgectl as bc
from bridgectl.dampers import passive
from bridgectl.model.bridge import described
from bridgectl.model.supports import Support
from bridgectl.scoring import run as scoring
from bridgectl.surface.expected import SurfaceFileError
from bridgectl.surface.labelled import surface_to_xarray
from bridgectl.surface.load import load_surface

DECK = {"mass_per_length": 18358.0, "flexural_rigidity": 4.86535e10, "n_modes": 3}
BEAM = bc.li2006.beam(n_modes=3)


def modal(**changes):
    """The modes of a beam, at places."""
    x = np.linspace(0, 25, 26)
    tent = [0, 12.5, 25], [0, 6.25, 0], BEAM.modal_moments()
    arguments = {
        "x": x, "mode_shapes": BEAM.mode_shapes(x), "frequencies": BEAM.frequencies,
        "modal_masses": BEAM.modal_masses, "damping_ratio": 0.01,
        "effects": {
            ("moment", 0.5): tent,
            "gauge": ([0, 25], [1, 0], [1, 2, 3]),
            ("reaction", 0.0): (x, 1 - x / 25, BEAM.modal_effects(0, "reaction")),
        },
    }  # fmt: skip
    return bc.ModalBridge(**(arguments | changes))


BRIDGES = {
    "one number each": bc.Bridge([15, 10], **DECK),
    "one number a span": bc.Bridge([15, 10], [18e3, 20e3], [4e10, 5e10], n_modes=3),
    "tables of pieces": bc.Bridge(
        25, [(5, 20e3), (20, 18e3)], [(10, 4e10), (5, 7e10), (10, 4e10)], n_modes=3
    ),
    "supports": bc.Bridge(
        [15, 10], **DECK,
        supports=["clamped", Support(5e8, 1e9), {"vertical": np.inf, "rotational": 2e9}],
    ),
    "Rayleigh damping": bc.Bridge([15, 10], **DECK, damping_ratio={1: 0.02, 3: 0.03}),
    "one ratio a mode": bc.Bridge([15, 10], **DECK, damping_ratio=[0.01, 0.02, 0.03]),
    "modes": modal(),
    "modes in reverse": modal(
        mode_shapes=np.asfortranarray(BEAM.mode_shapes(np.linspace(0, 25, 26))[:, ::-1]),
        frequencies=BEAM.frequencies[::-1],
    ),
    "modes that tell nothing": modal(effects=None),
}  # fmt: skip
EFFECTS = [
    bc.Moment(5.0), bc.Moment(15.0, sense="smallest", recovery="modal"), bc.Deflection(5.0),
    bc.Shear(4.0), bc.Reaction(15.0), bc.Stress(5.0, section_modulus=1.1),
    bc.BridgeAcceleration(5.0), bc.TireForce(sense="smallest"), bc.BodyAcceleration(2),
]  # fmt: skip


def made(bridge, effect=None):
    effect = effect or (bc.TireForce() if isinstance(bridge, bc.ModalBridge) else bc.Moment(5.0))
    return bc.ramp_surface(
        bridge, bc.li2006.car(), [20.0, 30.0], approach=2, ramp_length=0.5, effect=effect
    )


def assert_same(found, surface):
    road = rough_road(1, -2, 25)
    assert type(found.beam) is type(surface.beam)
    assert (found.beam, found.effect, repr(found)) == (surface.beam, surface.effect, repr(surface))
    for name in ("dae", "superposed_daf", "contributions"):
        np.testing.assert_array_equal(getattr(found, name)(road), getattr(surface, name)(road))


@pytest.mark.quick_cases(3)
@pytest.mark.parametrize("name", BRIDGES)
def test_a_surface_of_any_bridge_comes_back_to_the_bit(name, tmp_path):
    surface, file = made(BRIDGES[name]), tmp_path / "surface.npz"
    surface.save(file)
    assert_same(load_surface(file), surface)
    assert_same(load_surface(file, beam=BRIDGES[name], effect=surface.effect), surface)


@pytest.mark.quick_cases(3)
@pytest.mark.parametrize("effect", EFFECTS, ids=lambda effect: type(effect).__name__)
def test_a_surface_of_any_effect_comes_back_to_the_bit(effect, tmp_path):
    surface, file = made(BRIDGES["one number each"], effect), tmp_path / "surface.npz"
    surface.save(file)
    assert_same(load_surface(file, effect=effect), surface)
    other = dataclasses.replace(
        effect, sense="smallest" if effect.sense == "largest" else "largest"
    )
    with pytest.raises(SurfaceFileError, match=r"effect.sense is '\w+' in the file, '\w+' expe"):
        load_surface(file, effect=other)
    another = next(each for each in EFFECTS if type(each) is not type(effect))
    with pytest.raises(SurfaceFileError, match=r"effect is .* in the file, .* expected"):
        load_surface(file, effect=another)


@pytest.mark.parametrize("effect", [e for e in EFFECTS if hasattr(e, "at")], ids=repr)
def test_an_effect_at_another_place_is_refused(effect, tmp_path):
    file, at = tmp_path / "surface.npz", 15.0 if effect.at != 15 else 0.0
    made(BRIDGES["one number each"], effect).save(file)
    with pytest.raises(SurfaceFileError, match=rf"effect.at is {effect.at} m in the file, {at} m"):
        load_surface(file, effect=dataclasses.replace(effect, at=at))


@pytest.mark.slow
def test_a_bridge_of_another_kind_or_of_other_numbers_is_refused(tmp_path):
    for name, bridge in BRIDGES.items():
        made(bridge).save(tmp_path / f"{name}.npz")
        for other, expected in BRIDGES.items():
            if other != name:
                with pytest.raises(SurfaceFileError, match=r"not the expected surface: beam.* exp"):
                    load_surface(tmp_path / f"{name}.npz", beam=expected)
        with pytest.raises(SurfaceFileError, match=r"beam is .* in the file, Beam\(.*\) expected"):
            load_surface(tmp_path / f"{name}.npz", beam=BEAM)


def test_each_number_of_modes_tells_a_bridge_from_others(tmp_path):
    made(BRIDGES["modes"]).save(tmp_path / "modes.npz")
    gauge = {"gauge": ([0, 25], [1, 0.5], [1, 2, 3])}
    for changes, says in (
        ({"frequencies": BEAM.frequencies * 1.01}, r"beam.frequencies\[0\] is 4.09\d* Hz in the"),
        ({"modal_masses": 1e5}, r"beam.modal_masses\[0\] is .* kg in the file, 100000.0 kg"),
        ({"damping_ratio": 0.02}, r"beam.damping_ratio\[0\] is 0.01 in the file, 0.02 expected"),
        ({"effects": gauge}, "beam.effects is .* in the file, "),
    ):
        with pytest.raises(SurfaceFileError, match=says):
            load_surface(tmp_path / "modes.npz", beam=modal(**changes))


@pytest.mark.parametrize("name", BRIDGES)
def test_any_bridge_is_told_in_json_and_in_datasets(name, tmp_path):
    bridge = BRIDGES[name]
    text = json.dumps(described(bridge), allow_nan=False)
    assert [json.dumps(described(each)) == text for each in BRIDGES.values()].count(True) == 1
    pytest.importorskip("xarray")
    data = surface_to_xarray(made(bridge))
    data.to_netcdf(tmp_path / "surface.nc", engine="scipy")
    assert data.sizes == {"speed": 2, "position": 54}


@pytest.mark.parametrize("name", ["supports", "Rayleigh damping", "modes"])
def test_a_score_goes_on_for_the_same_bridge_alone(name, tmp_path, monkeypatch):
    """Supports that are rigid, a table and arrays alike are told from others in the header."""
    bridge, file = BRIDGES[name], tmp_path / "score.jsonl"
    road = bc.iso8608_profile("A", 27, seed=1, start=-2)

    def scored(beam):
        section = 0.5 if isinstance(beam, bc.ModalBridge) else 0.2
        return bc.score(
            [passive(7e3)], beam, bc.li2006.car(), [road], [25.0], approach=2, section=section,
            resume=file, workers=1,
        )  # fmt: skip

    first = scored(bridge)
    done = file.read_bytes()
    monkeypatch.setattr(scoring, "_part", None)  # nothing is left to do
    assert scored(bridge).values["daf"] == pytest.approx(first.values["daf"], abs=0)
    for other, beam in BRIDGES.items():
        if other != name and ("modes" in other) == ("modes" in name):
            if other == "modes that tell nothing":
                continue
            with pytest.raises(ValueError, match="holds another study: its beam is "):
                scored(beam)
    assert file.read_bytes() == done
