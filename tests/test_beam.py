import control as ct
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import bridgectl as bc

MM = 1e-3


def test_frequencies_of_the_thesis_beams_are_those_of_the_papers_three_spans():
    frequencies = [bc.li2006.beam(span).frequencies[0] for span in (15, 25, 35)]
    assert frequencies == pytest.approx([5.66, 4.0915, 3.01], abs=0.005)


def test_each_span_from_9_to_43_m_exists_and_longer_spans_of_one_deck_are_softer():
    for deck, table in bc.li2006.DECKS.items():
        frequencies = [bc.li2006.beam(span, deck).frequencies[0] for span in sorted(table)]
        assert np.all(np.diff(frequencies) < 0)
    spans = {span for table in bc.li2006.DECKS.values() for span in table}
    assert spans == set(range(9, 44, 2))


def test_table_1_is_the_thesis_beam_of_25_m():
    beam = bc.li2006.beam()
    assert (beam.length, beam.mass_per_length) == (25.0, 18358.0)
    assert beam.flexural_rigidity == pytest.approx(3.5e10 * 1.3901)


def test_one_damping_ratio_is_one_damping_frequency_for_all_modes():
    beam = bc.li2006.beam(n_modes=4, damping_ratio=0.02)
    damping_frequency = beam.damping_ratios * beam.omega  # w_b of Eq. (3)
    assert damping_frequency == pytest.approx(np.full(4, 0.02 * beam.omega[0]))


def test_a_sequence_of_damping_ratios_is_one_a_mode():
    beam = bc.li2006.beam(damping_ratio=(0.01, 0.02, 0.03))
    assert beam.damping_ratios == pytest.approx([0.01, 0.02, 0.03])
    poles = beam.system().poles()
    damped = np.unique(np.round(-poles.real / np.abs(poles), 9))
    assert damped == pytest.approx([0.01, 0.02, 0.03])


def test_the_beam_system_names_its_signals():
    system = bc.li2006.beam(n_modes=2).system()
    assert system.input_labels == ["modal_force_1", "modal_force_2"]
    assert system.output_labels == ["q_1", "q_2"]
    assert system.state_labels == ["q_1", "q_1_dot", "q_2", "q_2_dot"]


def test_static_deflection_converges_to_the_textbook_value():
    # P l^3 / (48 E J) under a force at mid-span; the modes after the 20th hold 1e-5 of it.
    beam = bc.li2006.beam(n_modes=40)
    flexibility = beam.system(loads=[0.5], sections=[0.5]).dcgain()
    assert flexibility == pytest.approx(25**3 / 48 / beam.flexural_rigidity, rel=2e-5)


def test_deflections_are_reciprocal():
    system = bc.li2006.beam(damping_ratio=0.02).system(loads=[0.2, 0.7], sections=[0.2, 0.7])
    gains = ct.frequency_response(system, [20.0]).complex[:, :, 0]
    assert gains[0, 1] == pytest.approx(gains[1, 0], rel=1e-9)


@given(st.floats(0.05, 0.95), st.floats(0.0, 25.0))
def test_the_influence_line_is_the_static_moment_of_many_modes(section, x):
    # Modal moments under a static unit force: error of the truncated tail falls as 1 / n.
    beam = bc.li2006.beam(n_modes=2000)
    q = 2 / beam.mass / beam.omega**2 * beam.mode_shapes(x)
    modal = beam.modal_moments(section) @ q
    assert beam.influence_line(x, section) == pytest.approx(modal, abs=4 * 25 / np.pi**2 / 2000)


def test_mode_shapes_and_influence_lines_vanish_off_the_bridge():
    beam = bc.li2006.beam()
    off = np.array([-3.0, -1e-9, 25.0, 30.0])
    assert np.abs(beam.mode_shapes(off)).max() < 1e-14
    assert np.abs(beam.influence_line(off)).max() < 1e-14


@pytest.mark.parametrize(
    ("change", "error", "says"),
    [
        ({"length": -25}, ValueError, "length must be above 0 [m], got -25"),
        ({"length": float("nan")}, ValueError, "length must be finite"),
        ({"mass_per_length": 0}, ValueError, "mass_per_length must be above 0 [kg/m]"),
        ({"flexural_rigidity": "4e10"}, TypeError, "flexural_rigidity must be one number"),
        ({"flexural_rigidity": [1e10]}, TypeError, "flexural_rigidity must be one number"),
        ({"n_modes": 0}, ValueError, "n_modes must be 1 or more, got 0"),
        ({"n_modes": 2.0}, TypeError, "n_modes must be a whole number"),
        ({"damping_ratio": 3}, ValueError, "for 3 percent type 0.03"),
        ({"damping_ratio": -0.01}, ValueError, "damping_ratio must be 0 or more"),
        ({"damping_ratio": (0.01, 0.02)}, ValueError, "3 numbers (one a mode), got 2"),
    ],
)
def test_a_bad_beam_parameter_is_named(change, error, says):
    good = {"length": 25.0, "mass_per_length": 18358.0, "flexural_rigidity": 4.9e10}
    with pytest.raises(error) as caught:
        bc.Beam(**{**good, **change})
    assert says in str(caught.value)


def test_an_unknown_span_or_deck_is_an_error_that_lists_the_known_ones():
    with pytest.raises(ValueError, match="span must be one of 9, 11, 13"):
        bc.li2006.beam(10)
    with pytest.raises(ValueError, match="with a Y deck, got 33"):
        bc.li2006.beam(33, "Y")
    with pytest.raises(ValueError, match="deck must be one of 'solid', 'Y', 'super-Y'"):
        bc.li2006.beam(25, "box")


@pytest.mark.parametrize("section", [0.0, 1.0, 1.5])
def test_a_section_outside_the_span_is_an_error(section):
    with pytest.raises(ValueError, match="section must lie between 0 and 1"):
        bc.li2006.beam().influence_line(3.0, section)
    with pytest.raises(ValueError, match="sections must lie between 0 and 1"):
        bc.li2006.beam().system(sections=[section])


def test_beams_are_values():
    assert bc.li2006.beam() == bc.li2006.beam()
    assert hash(bc.li2006.beam()) == hash(bc.li2006.beam())
    with pytest.raises(AttributeError):
        bc.li2006.beam().length = 3.0
    assert repr(bc.li2006.beam()) == (
        "Beam(length=25 m, mass_per_length=18358 kg/m, flexural_rigidity=4.86535e+10 N m^2, "
        "n_modes=3, damping_ratio=0.0, f_1=4.092 Hz)"
    )
