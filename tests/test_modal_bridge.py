"""A bridge that is known by sampled modes alone crosses as the beam they were sampled from."""

import json
import pickle
import warnings

import numpy as np
import pytest
from helpers import rough_road
from scipy.integrate import trapezoid

import bridgectl as bc
from bridgectl.model.bridge import BridgeModel, described
from bridgectl.model.modal import ModalBridge
from bridgectl.model.spans import Bridge

BEAM = bc.li2006.beam(n_modes=4)
WAVES = np.pi * np.arange(1, 5) / 25
TENT = ([0, 12.5, 25], [0, 6.25, 0])


def sampled(n_places=101, **changes):
    """The beam's modes at equal steps, with its mid-span moment."""
    x = np.linspace(0, 25, n_places)
    arguments = {
        "x": x,
        "mode_shapes": BEAM.mode_shapes(x),
        "frequencies": BEAM.frequencies,
        "modal_masses": BEAM.modal_masses,
        "effects": {("moment", 0.5): (*TENT, BEAM.modal_moments(0.5))},
    }
    return ModalBridge(**(arguments | changes))


def difference(bridge, **options):
    road, speeds = rough_road(3, -10, 25), [20.0, 30.0]
    first, second = (
        bc.daf(b, bc.li2006.car(), speeds, road, start=-10, **options) for b in (BEAM, bridge)
    )
    return np.abs(second - first).max()


@pytest.mark.parametrize(("n_places", "tolerance"), [(11, 1e-3), (26, 3e-5), (101, 1e-7)])
def test_sampled_sines_have_the_daf_of_the_beam(n_places, tolerance):
    """Splines of four modes: the error falls as the fourth power of the step."""
    assert difference(sampled(n_places)) < tolerance


@pytest.mark.parametrize("effect", ["deflection", "tire_force"])
def test_other_effects_are_those_of_the_beam(effect):
    assert difference(sampled(), effect=effect) < 1e-7


def test_shapes_scaled_to_unit_modal_mass_cross_alike():
    scale = 1 / np.sqrt(BEAM.modal_masses)
    x = np.linspace(0, 25, 101)
    effects = {("moment", 0.5): (*TENT, scale * BEAM.modal_moments(0.5))}
    unit = sampled(mode_shapes=scale * BEAM.mode_shapes(x), modal_masses=1, effects=effects)
    assert unit.modal_masses == pytest.approx([1, 1, 1, 1])
    assert difference(unit) < 1e-7


def test_modes_of_two_spans_told_at_places_cross_as_their_bridge():
    bridge = Bridge([25, 25], 18358, 4.86535e10, n_modes=6, damping_ratio=0.02)
    x = np.linspace(0, 50, 201)
    told = ModalBridge(
        x, bridge.mode_shapes(x), bridge.frequencies, bridge.modal_masses, 0.02,
        effects={("moment", 0.2): (x, bridge.influence_line(x, 0.2), bridge.modal_moments(0.2))},
    )  # fmt: skip
    first, second = (bc.daf(b, bc.li2006.car(), [20.0, 30.0], section=0.2) for b in (bridge, told))
    assert second == pytest.approx(first, abs=1e-7)


def test_shapes_are_those_told_and_vanish_off_the_bridge():
    bridge = sampled()
    x = np.linspace(0, 25, 101)
    assert bridge.mode_shapes(x) == pytest.approx(BEAM.mode_shapes(x), abs=1e-15)
    assert bridge.mode_shapes([[1.0, 2.0]]).shape == (1, 2, 4)
    assert bridge.frequencies == pytest.approx(BEAM.frequencies, rel=1e-15)
    cantilever = ModalBridge([0, 5, 10], [[1.0], [0.5], [1.0]], [3.0], 1e5)
    assert cantilever.mode_shapes([-0.1, 0, 2.5, 10, 10.1])[:, 0] == pytest.approx(
        [0, 1, 0.75, 1, 0]
    )


def test_an_effect_has_a_name_or_a_quantity_and_its_section():
    gauge = ([0, 10, 25], [0, 2e-9, 0], [1e-4, 2e-4, 3e-4, 4e-4])
    effects = {"strain_gauge_1": gauge, ("moment", 0.5): (*TENT, BEAM.modal_moments(0.5))}
    bridge = sampled(effects=effects)
    assert bridge.effects == ["strain_gauge_1", ("moment", 0.5)]
    line = bridge.influence_line([-1, 5, 10, 17.5, 26], quantity="strain_gauge_1")
    assert line == pytest.approx([0, 1e-9, 2e-9, 1e-9, 0])
    assert bridge.modal_effects(0.1, "strain_gauge_1") == pytest.approx(gauge[2])
    assert bridge.modal_moments() == pytest.approx(BEAM.modal_moments())
    assert bridge.kinks(0.2) == pytest.approx([0, 5, 10, 12.5, 25])


def test_a_deflection_that_is_not_told_is_that_of_the_modes():
    """Four modes have the deflection of mid-span within 1 % of l^3 / 48 E J."""
    bridge = sampled()
    line = bridge.influence_line(12.5, quantity="deflection")
    assert line == pytest.approx(25**3 / 48 / BEAM.flexural_rigidity, rel=1e-2)
    assert bridge.modal_effects(1.0, "deflection") == pytest.approx([0] * 4, abs=1e-14)
    told = sampled(effects={("deflection", 0.5): (*TENT, [1, 2, 3, 4])})
    assert told.influence_line(12.5, quantity="deflection") == 6.25
    end = sampled(effects={("shear", 1): ([0, 25], [0, -1], [1, 2, 3, 4])})
    assert end.influence_line(25, 1.0, "shear") == -1


def test_a_modal_bridge_is_a_value():
    bridge = sampled()
    assert isinstance(bridge, BridgeModel)
    assert pickle.loads(pickle.dumps(bridge)) == bridge == sampled()
    assert hash(bridge) == hash(sampled())
    assert bridge != sampled(damping_ratio=0.01) != BEAM
    assert described(bridge) != described(sampled(frequencies=2 * BEAM.frequencies))
    assert json.dumps(described(bridge))
    assert repr(bridge).startswith(
        "ModalBridge(25 m, n_modes=4 of 4.092 to 65.46 Hz, effects ('moment', 0.5), data "
    )
    assert "effects none" in repr(sampled(effects=None))
    with pytest.raises(AttributeError):
        bridge.frequencies = [1, 2, 3, 4]
    with pytest.raises(ValueError, match="read-only"):
        bridge.modal_masses[0] = 0


# Mass


def test_modal_masses_come_from_the_mass_where_it_is_given():
    bridge = sampled(modal_masses=None, mass_per_length=BEAM.mass_per_length)
    assert bridge.modal_masses == pytest.approx(BEAM.modal_masses, rel=1e-6)
    along = np.full(101, BEAM.mass_per_length)
    assert sampled(mass_per_length=along).modal_masses == pytest.approx(BEAM.modal_masses)


def test_mass_that_grows_along_the_bridge_is_integrated():
    """Linear between places, as is told: within 1e-6 of the integral of sines."""
    x = np.linspace(0, 25, 25001)
    mass = np.interp(x, [0, 10, 25], [1e4, 1.2e4, 1.4e4])
    exact = trapezoid(mass[:, np.newaxis] * BEAM.mode_shapes(x) ** 2, x, axis=0)
    told = np.interp(np.linspace(0, 25, 101), x, mass)
    found = sampled(modal_masses=None, mass_per_length=told).modal_masses
    assert found == pytest.approx(exact, rel=1e-6)


def test_the_worst_pair_of_shapes_that_mass_couples_is_told():
    x = np.linspace(0, 25, 101)
    shapes = BEAM.mode_shapes(x)
    shapes[:, 3] += 0.5 * shapes[:, 1]
    with pytest.warns(bc.PlausibilityWarning, match=r"modes 2 and 4 are coupled .* by 0\.45"):
        sampled(mode_shapes=shapes, modal_masses=None, mass_per_length=18358)


def test_a_modal_mass_of_another_scale_is_told():
    with pytest.warns(bc.PlausibilityWarning, match=r"modal_masses\[0\] is 1 kg, .* 2\.295e\+05"):
        sampled(modal_masses=[1, 229475, 229475, 229475], mass_per_length=18358)


def test_good_shapes_and_masses_are_not_judged_aloud():
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        sampled(mass_per_length=18358, modal_masses=1.1 * BEAM.modal_masses)


# Files

TABLE = """x, bending, second
Frequency [Hz], 4.09, 16.4
Modal mass [kg], 229e3, 229e3
Damping ratio, 0.01, 0.02

0, 0, 0
6.25, 0.7071, 1
12.5, 1, 0
18.75, 0.7071, -1
25, 0, 0
"""


def read(tmp_path, text, **options):
    file = tmp_path / "modes.csv"
    file.write_text(text, encoding="utf-8")
    return ModalBridge.from_csv(file, **options)


def test_modes_are_read_from_a_table(tmp_path):
    effects = {("moment", 0.5): (*TENT, [7.68e8, 0])}
    expected = ModalBridge(
        [0, 6.25, 12.5, 18.75, 25], [[0, 0], [0.7071, 1], [1, 0], [0.7071, -1], [0, 0]],
        [4.09, 16.4], [229e3, 229e3], [0.01, 0.02], effects=effects,
    )  # fmt: skip
    assert read(tmp_path, TABLE, effects=effects) == expected
    assert read(tmp_path, "\ufeff" + TABLE.replace(",", ";"), effects=effects) == expected


def test_a_table_may_leave_out_damping_and_have_its_mass_from_elsewhere(tmp_path):
    short = "frequency,3\n0,0\n5,1\n10,0\n"
    bridge = read(tmp_path, short, mass_per_length=3e3)
    assert bridge.modal_masses == pytest.approx([1e4])  # of a tent, a third of its mass
    assert bridge.damping_ratios == pytest.approx([0])


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ("Frequency", "Freq", r"modes\.csv: line 2 begins with 'Freq \[Hz\]', neither a place"),
        ("12.5, 1, 0", "12.5, 1", r"modes\.csv: line 8 has 1 value, those before it 2"),
        ("6.25, 0.7071", "6.25, high", r"modes\.csv: line 7 has 'high', which is no number"),
        ("Frequency [Hz], 4.09, 16.4\n", "", r"modes\.csv has no line 'frequency' \[Hz\]"),
        ("Modal mass [kg], 229e3, 229e3\n", "", "modal_masses are missing"),
    ],
)  # fmt: skip
def test_what_is_wrong_in_a_table_is_told_with_its_line(tmp_path, old, new, message):
    with pytest.raises(ValueError, match=message):
        read(tmp_path, TABLE.replace(old, new))


def test_a_table_of_no_text_or_no_regular_file_is_refused(tmp_path):
    (tmp_path / "modes.csv").write_bytes(b"\xff\xfe\x00")
    with pytest.raises(ValueError, match=r"modes\.csv is no UTF-8 text"):
        ModalBridge.from_csv(tmp_path / "modes.csv")
    with pytest.raises(ValueError, match="is no regular file"):
        ModalBridge.from_csv(tmp_path)
    with pytest.raises(FileNotFoundError):
        ModalBridge.from_csv(tmp_path / "none.csv")
    with pytest.raises(TypeError, match="path must be a string or a Path"):
        ModalBridge.from_csv(3)


# What is refused


@pytest.mark.parametrize(
    ("wrong", "message"),
    [
        ({"modal_masses": None}, "modal_masses are missing.*modal_masses=1 if shapes are mass"),
        ({"modal_masses": [1, 2]}, r"modal_masses must have shape \(4,\)"),
        ({"modal_masses": [1, 2, 3, -4]}, "above 0 kg, got -4 at index 3"),
        ({"modal_masses": -1}, "modal_masses must be above 0"),
        ({"frequencies": [0, 1, 2, 3]}, "frequencies must all be above 0 Hz, got 0 at index 0"),
        ({"frequencies": []}, "frequencies must all be above 0 Hz, got none"),
        ({"frequencies": [1, 2, 3]}, r"mode_shapes must have shape \(101, 3\)"),
        ({"mode_shapes": np.ones((4, 101))}, r"type numpy\.transpose\(mode_shapes\)"),
        ({"mode_shapes": np.eye(101, 4) * [1, 1, 0, 1]}, r"mode_shapes\[:, 2\] is zero everywhere"),
        ({"x": [0]}, "x must be two places"),
        ({"x": np.linspace(25, 0, 101)}, "x must be two places .* each beyond the one before"),
        ({"x": np.linspace(1, 26, 101)}, r"x must begin with 0.*type x - x\[0\]"),
        ({"damping_ratio": 2}, "type 0.02"),
        ({"damping_ratio": [0.01, 0.02]}, "one number or 4 numbers"),
        ({"mass_per_length": 0}, "mass_per_length must be above 0"),
        ({"mass_per_length": [1, 2]}, r"mass_per_length must have shape \(101,\)"),
        ({"effects": {3: TENT}}, r"got 3: type \('moment', 0\.5\)"),
        ({"effects": {("moment", 12.5): TENT}}, "a fraction of the length, got .*12.5"),
        ({"effects": {"strain": TENT}}, r"effects\['strain'\] must be \(places .* got tuple"),
        ({"effects": {"strain": ([1], [1], [1] * 4)}}, r"\['strain'\]\[0\] must be two places"),
        ({"effects": {"strain": ([0, 3, 3], [1] * 3, [1] * 4)}}, "each beyond the one before"),
        ({"effects": {"strain": ([0, 30], [1, 1], [1] * 4)}}, "from 0 to 25 m, got 0 to 30 m"),
        ({"effects": {"strain": ([0, 3], [1], [1] * 4)}}, r"\['strain'\]\[1\] must have shape"),
        ({"effects": {("moment", 0.5): ([0, 3], [1, 1], [1])}}, r"\[\('moment', 0\.5\)\]\[2\]"),
    ],
)  # fmt: skip
def test_a_wrong_argument_is_named_with_what_to_type(wrong, message):
    with pytest.raises(ValueError, match=message):
        sampled(**wrong)


def test_an_effect_that_is_not_told_is_refused_with_those_that_are():
    bridge = sampled()
    with pytest.raises(ValueError, match=r"no 'moment' at section 0\.3, its effects are \('moment"):
        bridge.influence_line(1.0, 0.3)
    with pytest.raises(ValueError, match=r"effects=\{\('moment', 0\.3\): \(places, influence"):
        bc.daf(bridge, bc.li2006.car(), [20.0], section=0.3)
    with pytest.raises(ValueError, match="its effects are none"):
        sampled(effects=None).modal_moments()
    with pytest.raises(ValueError, match="section must lie between 0 and 1"):
        bridge.modal_effects(12.5, "deflection")
    with pytest.raises(ValueError, match="masked"):
        bridge.mode_shapes(np.ma.masked_array([1.0, 2], [0, 1]))
