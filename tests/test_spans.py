"""Bridges of any spans and supports are those of textbooks and of exact dynamic stiffness.

Oracles: closed forms and transcendental roots (R. D. Blevins, Formulas for natural frequency and
mode shape, 1979, chapter 8); the exact dynamic stiffness of each piece, whose negative eigenvalues
count the frequencies below a trial (W. H. Wittrick, F. W. Williams, Q. J. Mech. Appl. Math. 24
(1971) 263-284), so that none is missed; virtual work for static deflections.
"""

import dataclasses
import json
import pickle
from itertools import pairwise

import numpy as np
import pytest
from helpers import rough_road
from scipy.optimize import brentq

import bridgectl as bc
from bridgectl.model.bridge import BridgeModel, described
from bridgectl.model.recovery import recover_moment
from bridgectl.model.spans import Bridge
from bridgectl.model.supports import KINDS, Support

MU, EJ = 18358.0, 3.5e10 * 1.3901
HINGED, CLAMPED, FREE = "simple", "clamped", "free"
STEPPED = {
    "spans": [20.0, 30.0, 25.0],
    "mass_per_length": [15e3, 18e3, 16e3],
    "flexural_rigidity": [(15, 4e10), (10, 9e10), (20, 5e10), (10, 9e10), (20, 4e10)],
}
BRIDGES = {
    "one span": Bridge(25.0, MU, EJ),
    "two spans": Bridge([25, 25], MU, EJ),
    "haunched spans": Bridge(**STEPPED),
    "clamped on a spring": Bridge(
        **STEPPED, supports=[CLAMPED, {"vertical": 2e8}, HINGED, {"vertical": 5e8}]
    ),
    "with cantilevers": Bridge([6, 25, 6], MU, EJ, supports=[FREE, HINGED, HINGED, FREE]),
    "clamped piers": Bridge([25, 35], MU, EJ, supports=[HINGED, CLAMPED, Support(np.inf, 5e9)]),
    "on springs": Bridge(25.0, MU, EJ, supports=[{"vertical": 5e8}, {"vertical": 3e8}]),
}
every_bridge = pytest.mark.parametrize("bridge", BRIDGES.values(), ids=BRIDGES.keys())


def omega_of(waves, length=25.0):
    """Circular frequencies of a uniform beam from beta l."""
    return (np.asarray(waves) / length) ** 2 * np.sqrt(EJ / MU)


def roots(function, stop, start=0.5, step=0.01):
    """Roots where a continuous function changes its sign."""
    grid = np.arange(start, stop, step)
    signs = np.sign([function(x) for x in grid])
    return [
        brentq(function, grid[i], grid[i + 1], xtol=1e-14, rtol=1e-14)
        for i in np.flatnonzero(signs[1:] * signs[:-1] < 0)
    ]


def dynamic_stiffness(omega, length, mass, rigidity):
    """Exact stiffness of a vibrating piece, of w, w' at both ends, and its clamped frequencies."""
    z = length * (mass * omega**2 / rigidity) ** 0.25
    c, s, ch, sh = np.cos(z), np.sin(z), np.cosh(z), np.sinh(z)
    d = 1 - c * ch
    ww, wt, tt = z**3 * (s * ch + c * sh), z**2 * s * sh * length, z * (s * ch - c * sh) * length**2
    other_ww, other_wt = -(z**3) * (s + sh), z**2 * (ch - c) * length
    other_tt = z * (sh - s) * length**2
    matrix = [
        [ww, wt, other_ww, other_wt],
        [wt, tt, -other_wt, other_tt],
        [other_ww, -other_wt, ww, -wt],
        [other_wt, other_tt, -wt, tt],
    ]
    halves = int(z / np.pi)
    below = halves - (1 - (-1) ** halves * np.sign(d)) / 2
    return rigidity / length**3 / d * np.array(matrix), int(below)


def frequencies_below(bridge, omega):
    """Number of circular frequencies below a trial, by Wittrick and Williams."""
    edges = bridge.kinks(0.0)
    matrix, count = np.zeros((2 * edges.size, 2 * edges.size)), 0
    for i, (start, end) in enumerate(pairwise(edges)):
        mass, rigidity = deck(bridge, (start + end) / 2)
        own, below = dynamic_stiffness(omega, end - start, mass, rigidity)
        matrix[2 * i : 2 * i + 4, 2 * i : 2 * i + 4] += own
        count += below
    held = []
    for place, support in zip(bridge.support_places, supports_of(bridge), strict=True):
        node = int(np.argmin(np.abs(edges - place)))
        for dof, stiffness in ((2 * node, support.vertical), (2 * node + 1, support.rotational)):
            if np.isinf(stiffness):
                held.append(dof)
            else:
                matrix[dof, dof] += stiffness
    free = np.setdiff1d(np.arange(len(matrix)), held)
    scale = 1 / np.sqrt(np.abs(np.diag(matrix))[free])
    inertia = np.linalg.eigvalsh(matrix[np.ix_(free, free)] * np.outer(scale, scale))
    return count + int(np.sum(inertia < 0))


def deck(bridge, x):
    """Mass per length and flexural rigidity at a place."""

    def at(value):
        if not isinstance(value, tuple):
            return value
        if isinstance(value[0], tuple):
            lengths, values = zip(*value, strict=True)
        else:
            lengths, values = bridge.spans, value
        return values[int(np.searchsorted(np.cumsum(lengths)[:-1], x))]

    return at(bridge.mass_per_length), at(bridge.flexural_rigidity)


def supports_of(bridge):
    return [KINDS.get(support, support) for support in bridge.supports]


def gauss(bridge, section=0.0, order=60):
    """Places, weights and deck (mass, rigidity) for integrals along a bridge."""
    t, weight = np.polynomial.legendre.leggauss(order)
    places, weights = [], []
    for start, end in pairwise(bridge.kinks(section)):
        places.append(start + (end - start) * (1 + t) / 2)
        weights.append(weight * (end - start) / 2)
    x = np.concatenate(places)
    return x, np.concatenate(weights), *np.array([deck(bridge, place) for place in x]).T


def effects_along(bridge, x, quantity):
    return np.array([bridge.modal_effects(place / bridge.length, quantity) for place in x])


# Frequencies


def test_a_single_span_is_the_simply_supported_beam():
    """Of 100 modes, frequencies within 1e-13 and moments within 1e-11 of their largest."""
    beam = bc.Beam(25.0, MU, EJ, n_modes=100)
    bridge = Bridge(25.0, MU, EJ, n_modes=100)
    x = np.linspace(-2, 27, 300)
    assert bridge.omega == pytest.approx(beam.omega, rel=1e-13)
    assert bridge.modal_masses == pytest.approx(beam.modal_masses, rel=1e-14)
    assert bridge.mode_shapes(x) == pytest.approx(beam.mode_shapes(x), abs=1e-10)
    assert bridge.influence_line(x, 0.3) == pytest.approx(beam.influence_line(x, 0.3), abs=1e-13)
    largest = EJ * beam.wavenumbers**2
    difference = bridge.modal_moments(0.3) - beam.modal_moments(0.3)
    assert np.abs(difference / largest).max() < 1e-11
    assert bridge.kinks(0.3) == pytest.approx(beam.kinks(0.3))


@pytest.mark.parametrize("n_spans", [2, 3, 5])
def test_equal_spans_vibrate_at_the_roots_of_the_periodic_beam(n_spans):
    """Rotations over the supports follow a cosine: R. S. Ayre, L. S. Jacobsen, J. Appl. Mech. 17
    (1950) 391-395; modes 1, n + 1, ... are those of one span. Forty modes within 1e-11."""

    def of_wave(r):
        share = np.cos(r * np.pi / n_spans)
        return lambda z: (
            np.sin(z) - np.tanh(z) * np.cos(z) + share * (np.tanh(z) - np.sin(z) / np.cosh(z))
        )

    waves = [np.pi * j for j in range(1, 60)]
    waves += [z for r in range(1, n_spans) for z in roots(of_wave(r), 60 * np.pi)]
    expected = omega_of(np.sort(waves)[:40])
    assert Bridge([25] * n_spans, MU, EJ, n_modes=40).omega == pytest.approx(expected, rel=1e-11)


@pytest.mark.parametrize(
    ("supports", "equation"),
    [
        ([CLAMPED, CLAMPED], lambda z: np.cos(z) - 1 / np.cosh(z)),
        ([CLAMPED, FREE], lambda z: np.cos(z) + 1 / np.cosh(z)),
        ([CLAMPED, HINGED], lambda z: np.sin(z) - np.cos(z) * np.tanh(z)),
    ],
    ids=["clamped", "cantilever", "propped"],
)
def test_clamped_beams_vibrate_at_their_transcendental_roots(supports, equation):
    """Blevins, Table 8-1. Eight modes within 1e-12."""
    bridge = Bridge(25, MU, EJ, supports=supports, n_modes=8)
    assert bridge.omega == pytest.approx(omega_of(roots(equation, 30)[:8]), rel=1e-12)


@pytest.mark.parametrize("spring", [1e7, 5e8, 1e11])
def test_a_beam_on_springs_vibrates_at_its_transcendental_roots(spring):
    """Of halves: symmetric E J b^3 (tan + tanh) = 2 k, antisymmetric E J b^3 (coth - cot) = 2 k."""

    def symmetric(a):
        stiffness = EJ * (a / 12.5) ** 3
        return stiffness * (np.sin(a) + np.tanh(a) * np.cos(a)) - 2 * spring * np.cos(a)

    def antisymmetric(a):
        stiffness = EJ * (a / 12.5) ** 3
        return stiffness * (np.sin(a) / np.tanh(a) - np.cos(a)) - 2 * spring * np.sin(a)

    halves = [a for side in (symmetric, antisymmetric) for a in roots(side, 16, 0.05, 0.005)]
    bridge = Bridge(25, MU, EJ, supports=[Support(spring), Support(spring)], n_modes=8)
    assert bridge.omega == pytest.approx(omega_of(2 * np.sort(halves)[:8]), rel=1e-11)


def test_a_span_with_rotational_springs_vibrates_as_an_independent_code_finds():
    springs = [{"rotational": 5e9}, {"vertical": np.inf, "rotational": 5e9}]
    bridge = Bridge(25, MU, EJ, supports=springs, n_modes=6)
    expected = [5.543306994, 18.08998682, 38.67255565, 67.38021704, 104.245461, 149.2803428]
    assert bridge.frequencies == pytest.approx(expected, rel=1e-9)


@every_bridge
def test_exact_dynamic_stiffness_counts_the_same_frequencies(bridge):
    """Just below the j-th of 30 frequencies there are j - 1, just above it j: none is missed."""
    bridge = dataclasses.replace(bridge, n_modes=30)
    for j, omega in enumerate(bridge.omega):
        assert frequencies_below(bridge, omega * (1 - 1e-9)) == j
        assert frequencies_below(bridge, omega * (1 + 1e-9)) == j + 1


def test_spans_that_a_clamped_pier_parts_have_each_frequency_twice():
    bridge = Bridge([25, 25], MU, EJ, supports=[HINGED, CLAMPED, HINGED], n_modes=12)
    single = Bridge(25, MU, EJ, supports=[CLAMPED, HINGED], n_modes=6)
    assert bridge.omega == pytest.approx(np.repeat(single.omega, 2), rel=1e-13)


def test_many_equal_spans_have_all_their_close_frequencies():
    """Those of 20 modes lie between the first ones of a hinged and of a clamped span."""
    bridge = Bridge([25] * 20, MU, EJ, n_modes=40)
    assert bridge.omega[0] == pytest.approx(omega_of(np.pi), rel=1e-13)
    assert bridge.omega[19] < omega_of(4.730041)
    for j in (0, 9, 19, 20, 39):
        assert frequencies_below(bridge, bridge.omega[j] * (1 + 1e-9)) == j + 1


def test_pieces_of_one_deck_are_that_deck():
    """Forty pieces of very different lengths: frequencies within 1e-11, shapes within 1e-9."""
    lengths = np.tile([0.05, 1.2], 20)
    pieces = [(length, EJ) for length in lengths]
    whole, cut = Bridge(25, MU, EJ, n_modes=8), Bridge(25, MU, pieces, n_modes=8)
    x = np.linspace(0, 25, 200)
    assert cut.kinks(0.0).size == 41
    assert cut.omega == pytest.approx(whole.omega, rel=1e-11)
    assert cut.mode_shapes(x) == pytest.approx(whole.mode_shapes(x), abs=1e-9)
    assert cut.influence_line(x, 0.31) == pytest.approx(whole.influence_line(x, 0.31), abs=1e-10)


def test_very_stiff_springs_are_rigid_supports():
    stiff = {"vertical": 1e17, "rotational": 1e19}
    near = Bridge([25, 25], MU, EJ, supports=[stiff, {"vertical": 1e17}, HINGED])
    rigid = Bridge([25, 25], MU, EJ, supports=[CLAMPED, HINGED, HINGED])
    assert near.omega == pytest.approx(rigid.omega, rel=1e-5)
    x = np.linspace(0.5, 49.5, 100)
    for section, quantity in ((0.0, "moment"), (0.3, "moment"), (0.5, "reaction")):
        expected = rigid.influence_line(x, section, quantity)
        assert near.influence_line(x, section, quantity) == pytest.approx(expected, abs=1e-6)


# Shapes


@every_bridge
def test_shapes_are_orthogonal_to_mass_with_half_the_mass_of_the_bridge(bridge):
    x, weight, mass, _ = gauss(bridge)
    shapes = bridge.mode_shapes(x)
    gram = shapes.T @ (shapes * (weight * mass)[:, np.newaxis])
    assert gram / bridge.modal_masses[0] == pytest.approx(np.eye(bridge.n_modes), abs=1e-12)
    assert bridge.modal_masses == pytest.approx(weight @ mass / 2, rel=1e-14)


@every_bridge
def test_moments_of_shapes_are_orthogonal_to_flexibility(bridge):
    """With the springs' energy, twice that of mode j is w_j^2 m_j: within 1e-11 of it."""
    x, weight, _, rigidity = gauss(bridge)
    moments = effects_along(bridge, x, "moment")
    energy = moments.T @ (moments * (weight / rigidity)[:, np.newaxis])
    for place, support in zip(bridge.support_places, supports_of(bridge), strict=True):
        if 0 < support.vertical < np.inf:
            force = bridge.modal_effects(place / bridge.length, "reaction")
            energy += np.outer(force, force) / support.vertical
        if 0 < support.rotational < np.inf:
            assert place == bridge.length  # where the spring has all of the moment
            energy += np.outer(moment := bridge.modal_moments(1.0), moment) / support.rotational
    scale = bridge.omega * np.sqrt(bridge.modal_masses)
    assert energy / np.outer(scale, scale) == pytest.approx(np.eye(bridge.n_modes), abs=1e-11)


@every_bridge
def test_shapes_begin_downward_and_are_as_large_as_sines(bridge):
    shapes = bridge.mode_shapes(np.linspace(0, bridge.length, 2001))
    largest = np.abs(shapes).max(axis=0)
    assert np.all((largest > 0.9) & (largest < 4))
    for shape, size in zip(shapes.T, largest, strict=True):
        assert shape[np.argmax(np.abs(shape) > 0.51 * size)] > 0


def test_the_first_mode_of_two_spans_is_a_sine_over_both():
    x = np.linspace(0, 50, 101)
    expected = np.sin(np.pi * x / 25)
    assert BRIDGES["two spans"].mode_shapes(x)[:, 0] == pytest.approx(expected, abs=1e-13)


@every_bridge
def test_shapes_and_lines_vanish_off_the_bridge_and_keep_the_shape_of_places(bridge):
    off = np.array([[-3.0, -1e-6], [bridge.length + 1e-6, bridge.length + 5]])
    assert not bridge.mode_shapes(off).any()
    assert bridge.mode_shapes(off).shape == (2, 2, bridge.n_modes)
    assert bridge.mode_shapes(1.0).shape == (bridge.n_modes,)
    assert bridge.mode_shapes(np.zeros((0, 3))).shape == (0, 3, bridge.n_modes)
    for quantity in ("moment", "shear", "deflection"):
        assert not bridge.influence_line(off, 0.3, quantity).any()
        assert bridge.influence_line(1.0, 0.3, quantity).shape == ()
    held = next(i for i, support in enumerate(supports_of(bridge)) if support.vertical > 0)
    at = bridge.support_places[held] / bridge.length
    assert not bridge.influence_line(off, at, "reaction").any()


def test_few_places_and_many_have_the_same_shapes():
    bridge = BRIDGES["haunched spans"]
    many = np.linspace(0, bridge.length, 3000)
    some = many[::97]
    assert bridge.mode_shapes(some) == pytest.approx(bridge.mode_shapes(many)[::97], abs=1e-12)


# Static influence lines


def test_influence_lines_of_textbook_beams():
    """Three-moment equation; clamped and propped beams, cantilevers. Within 1e-13 m."""
    x = np.linspace(0, 25, 26)
    two = BRIDGES["two spans"].influence_line(x, 0.5)
    assert two == pytest.approx(-x * (25**2 - x**2) / (4 * 25**2), abs=1e-13)
    clamped = Bridge(25, MU, EJ, supports=[CLAMPED, CLAMPED])
    assert clamped.influence_line(x, 0.0) == pytest.approx(-x * (25 - x) ** 2 / 625, abs=1e-13)
    assert clamped.influence_line(x, 1.0) == pytest.approx(-(x**2) * (25 - x) / 625, abs=1e-13)
    tip = Bridge(25, MU, EJ, supports=[CLAMPED, FREE])
    assert tip.influence_line(x, 0.0) == pytest.approx(-x, abs=1e-13)
    assert tip.influence_line(x, 0.4) == pytest.approx(-np.maximum(x - 10, 0), abs=1e-13)
    assert tip.influence_line(25, 1.0, "deflection") == pytest.approx(25**3 / 3 / EJ, rel=1e-13)


def test_deflections_of_a_stepped_beam_are_those_of_virtual_work():
    """Of a determinate beam: integral of both moments over E J. Within 1e-12."""
    bridge = Bridge(30, MU, [(8, 3e10), (5, 9e10), (17, 5e10)])
    beam = bc.Beam(30, MU, EJ)
    for section in (0.1, 0.3, 8 / 30, 0.77):
        for force in (2.0, 9.0, 20.0):
            cuts = np.unique([0, 8, 13, 30, section * 30, force])
            t, weight = np.polynomial.legendre.leggauss(4)
            work = 0.0
            for start, end in pairwise(cuts):
                x = start + (end - start) * (1 + t) / 2
                moments = beam.influence_line(x, section) * beam.influence_line(x, force / 30)
                work += weight @ moments * (end - start) / 2 / deck(bridge, x[0])[1]
            line = bridge.influence_line(force, section, "deflection")
            assert line == pytest.approx(work, rel=1e-12)


@every_bridge
def test_deflections_are_reciprocal(bridge):
    """As are any two of seven places: within 1e-12 of the largest."""
    places = np.linspace(0.02, 0.97, 7)
    matrix = np.array(
        [bridge.influence_line(places * bridge.length, s, "deflection") for s in places]
    )
    assert matrix == pytest.approx(matrix.T, abs=1e-12 * np.abs(matrix).max())


@every_bridge
@pytest.mark.parametrize("quantity", ["moment", "shear", "deflection", "reaction"])
def test_effects_of_shapes_are_those_of_their_inertia_through_the_influence_line(bridge, quantity):
    """E_j = w_j^2 integral of mu phi_j I_E: within 1e-9 of the largest of each mode."""
    places = np.linspace(0.03, 0.96, 6)
    if quantity == "reaction":
        holding = [support.vertical > 0 for support in supports_of(bridge)]
        places = bridge.support_places[holding] / bridge.length
    found, expected = [], []
    for section in places:
        x, weight, mass, _ = gauss(bridge, section)
        line = bridge.influence_line(x, section, quantity)
        found.append(bridge.modal_effects(section, quantity))
        expected.append(bridge.omega**2 * ((weight * mass * line) @ bridge.mode_shapes(x)))
    scale = np.abs(found).max(axis=0)
    assert found / scale == pytest.approx(expected / scale, abs=1e-9)


@every_bridge
def test_reactions_carry_the_load(bridge):
    """At every place of a force, 1 but for clamped cantilever ends: within 1e-12. So of modes."""
    x, weight, mass, _ = gauss(bridge)
    places = np.concatenate([x, bridge.kinks(0.0)])
    holding = [support.vertical > 0 for support in supports_of(bridge)]
    fractions = bridge.support_places[holding] / bridge.length
    total = sum(bridge.influence_line(places, s, "reaction") for s in fractions)
    assert total == pytest.approx(np.ones(places.size), abs=1e-12)
    of_modes = np.array([bridge.modal_effects(s, "reaction") for s in fractions])
    inertia = bridge.omega**2 * ((weight * mass) @ bridge.mode_shapes(x))
    assert of_modes.sum(axis=0) == pytest.approx(inertia, abs=1e-10 * np.abs(of_modes).max())


@every_bridge
def test_shear_is_the_derivative_of_the_moment(bridge):
    """Its integral between two sections of a piece is the difference: within 1e-10."""
    force = 0.37 * bridge.length
    t, weight = np.polynomial.legendre.leggauss(40)
    for start, end in pairwise(np.unique(np.append(bridge.kinks(0.0), force)) / bridge.length):
        low, high = start + 0.1 * (end - start), end - 0.1 * (end - start)
        inside = low + (high - low) * (1 + t) / 2
        width = (high - low) * bridge.length / 2
        shear = [bridge.influence_line(force, s, "shear") for s in inside]
        ends = [float(bridge.influence_line(force, s)) for s in (low, high)]
        assert weight @ shear * width == pytest.approx(ends[1] - ends[0], abs=1e-10)
        modal = np.array([bridge.modal_effects(s, "shear") for s in inside])
        of_ends = [bridge.modal_moments(s) for s in (low, high)]
        scale = np.abs(of_ends).max(axis=0)
        difference = (weight @ modal * width - of_ends[1] + of_ends[0]) / scale
        assert np.abs(difference).max() < 1e-9


def test_a_force_at_the_section_of_shear_is_just_beyond_it():
    single = BRIDGES["one span"]
    assert single.influence_line([7.5 - 1e-6, 7.5, 7.5 + 1e-6], 0.3, "shear") == pytest.approx(
        [-0.3, 0.7, 0.7], abs=1e-6
    )
    third = 1 - 2 / 3  # round-off above 1 / 3
    assert single.influence_line(25 / 3, third, "shear") == pytest.approx(2 / 3)
    assert single.influence_line([0, 25], 0.0, "shear") == pytest.approx([1, 0])
    assert single.influence_line([0, 25], 1.0, "shear") == pytest.approx([0, -1])


def test_a_section_at_a_pier_is_just_before_it():
    """A clamped pier takes the moment: what is beyond it is not felt before it."""
    bridge = Bridge([25, 25], MU, EJ, supports=[HINGED, CLAMPED, HINGED])
    assert bridge.influence_line(12.5, 0.5) == pytest.approx(-3 / 16 * 25)
    assert bridge.influence_line(37.5, 0.5) == pytest.approx(0, abs=1e-13)


@every_bridge
def test_many_modes_add_up_to_the_influence_line(bridge):
    """The tail of n modes falls as 1 / n for moments, as 1 / n^3 for deflections."""
    bridge = dataclasses.replace(bridge, n_modes=120)
    x = np.linspace(0.0, bridge.length, 50)
    shapes, rigidities = bridge.mode_shapes(x), bridge.modal_masses * bridge.omega**2
    for quantity, allowed in (("moment", 2e-2), ("deflection", 1e-5)):
        line = bridge.influence_line(x, 0.3, quantity)
        modes = shapes @ (bridge.modal_effects(0.3, quantity) / rigidities)
        assert np.abs(modes - line).max() / np.abs(line).max() < allowed


# Crossings


@pytest.mark.parametrize("effect", ["moment", "deflection", "tire_force"])
def test_the_daf_of_one_span_is_that_of_the_beam(effect):
    """Damping too, where each mode is told its ratio: within 1e-12."""
    damping = (0.01, 0.02, 0.03)
    pair = [made(25, MU, EJ, n_modes=3, damping_ratio=damping) for made in (bc.Beam, Bridge)]
    road, speeds = rough_road(3, -10, 25), [20.0, 30.0]
    first, second = (
        bc.daf(b, bc.li2006.car(), speeds, road, start=-10, section=0.4, effect=effect)
        for b in pair
    )
    assert second == pytest.approx(first, abs=1e-12)


@pytest.mark.parametrize(
    ("supports", "rotational", "effect", "speed", "daf", "tolerance"),
    [
        (3, 0.0, bc.Moment(at=10.0), 20.0, 0.9700806829, 1e-5),
        (3, 0.0, bc.Moment(at=25.0, sense="smallest"), 20.0, 1.090208092, 1e-5),
        (2, np.inf, bc.Moment(at=12.5), 20.0, 1.003816849, 1e-6),
        (2, np.inf, bc.Moment(at=0.0, sense="smallest"), 20.0, 1.007289146, 1e-6),
        (2, 5e9, bc.Moment(at=12.5), 25.0, 1.062583965, 1e-6),
    ],
    ids=["in a span", "over a pier", "between clamped ends", "at a clamped end", "sprung ends"],
)  # fmt: skip
def test_dafs_are_those_of_an_independent_code(supports, rotational, effect, speed, daf, tolerance):
    """Solutions by DOP853 with as many exact modes: 24 of two spans, 14 of one."""
    bridge = Bridge(
        [25] * (supports - 1), MU, EJ, supports=[Support(np.inf, rotational)] * supports,
        n_modes={3: 24, 2: 14}[supports],
    )  # fmt: skip
    found = bc.daf(bridge, bc.li2006.car(), [speed], effect=effect)
    assert found == pytest.approx(daf, abs=tolerance)
    fewer = dataclasses.replace(bridge, n_modes=None)
    assert bc.daf(fewer, bc.li2006.car(), [speed], effect=effect) == pytest.approx(daf, abs=6e-4)


def test_moments_over_the_middle_support_are_those_of_an_independent_code():
    """A quarter-car at 20 m/s: moments at five places within 1e-5 of the largest, 236 kN m."""
    bridge, car = Bridge([25, 25], MU, EJ, n_modes=24), bc.li2006.car()
    tire = np.array([5.0, 15.0, 25.0, 35.0, 45.0])
    crossing = bc.crossing_response(bridge, car, 20.0, start=-1.0, section=0.2)
    tires = 20 * crossing.time[:, np.newaxis]
    per_force, per_state = recover_moment(bridge, 0.5, "exact", tires)
    force = np.array(crossing.outputs["tire_force"])
    moment = per_force[:, 0] * force + per_state @ crossing.states[4:]
    expected = [-132586.7306, -251537.1208, 2117.215972, -225156.1707, -105339.5564]
    assert np.interp(tire / 20, crossing.time, moment) == pytest.approx(expected, abs=2.4)
    static = 98100 * bridge.influence_line(tire, 0.5)
    assert static == pytest.approx([-117720, -235440, 0, -235440, -117720], abs=1e-6)
    assert moment.min() == pytest.approx(-257280.2979, abs=2.4)


def test_a_creeping_vehicle_does_not_amplify():
    for name in ("two spans", "haunched spans", "clamped piers"):
        bridge = dataclasses.replace(BRIDGES[name], n_modes=4)
        found = bc.daf(bridge, bc.li2006.car(), [0.5], section=0.2)
        assert found == pytest.approx(1, abs=2e-3)


# What a bridge is


@every_bridge
def test_a_bridge_is_a_value(bridge):
    assert isinstance(bridge, BridgeModel)
    again = pickle.loads(pickle.dumps(bridge))
    assert again == bridge
    assert hash(again) == hash(bridge)
    assert dataclasses.replace(bridge) == bridge
    assert dataclasses.replace(bridge, n_modes=3) != bridge
    assert "\n" not in repr(bridge)
    assert repr(bridge).startswith("Bridge(")
    assert json.dumps(described(bridge))
    with pytest.raises(dataclasses.FrozenInstanceError):
        bridge.n_modes = 3


def test_the_text_of_a_bridge_tells_its_spans_and_supports():
    text = repr(Bridge([10, 20], MU, [4e10, 5e10], supports=[CLAMPED, FREE, {"vertical": 5e8}]))
    assert text == (
        "Bridge(10 + 20 m, supports clamped, free, 5e+08 N/m and 0 N m/rad, mass=550740 kg, "
        "flexural_rigidity=4e+10 to 5e+10 N m^2, n_modes=12, damping_ratio=0.0, f_1=4.107 Hz)"
    )


def test_kinks_are_ends_supports_steps_and_the_section():
    bridge = BRIDGES["haunched spans"]
    assert bridge.kinks(0.1) == pytest.approx([0, 7.5, 15, 20, 25, 45, 50, 55, 75])
    assert bridge.kinks(20 / 75) == pytest.approx([0, 15, 20, 25, 45, 50, 55, 75])


def test_ways_to_give_the_deck_agree():
    per_span = Bridge([20, 30], [15e3, 18e3], [4e10, 5e10])
    table = Bridge(
        (20, 30), np.array([[20, 15e3], [30, 18e3]]), [(20, 4e10), (10, 5e10), (20, 5e10)]
    )
    assert table.omega == pytest.approx(per_span.omega, rel=1e-12)
    assert table.mass == per_span.mass == pytest.approx(840e3)
    assert Bridge(25, MU, [(25, EJ)]).omega == pytest.approx(Bridge(25, MU, EJ).omega)
    same = Bridge(25, MU, EJ, supports=[Support(), {}])
    assert Bridge([25.0], MU, EJ) == same
    assert same.supports == (HINGED, HINGED)


def test_steps_that_round_off_keeps_apart_are_one():
    """Ends of pieces within 1e-9 of the length, 50 nm here."""
    table = [(25 + 4e-8, 15e3), (25 - 4e-8, 18e3)]
    assert Bridge([25, 25], table, EJ).kinks(0.5) == pytest.approx([0, 25, 50])
    apart = [(25 + 1e-6, 15e3), (25 - 1e-6, 18e3)]
    assert Bridge([25, 25], apart, EJ).kinks(0.5).size == 4


def test_by_default_a_section_is_at_the_middle():
    bridge, x = BRIDGES["with cantilevers"], np.linspace(0, 37, 9)
    assert bridge.influence_line(x) == pytest.approx(bridge.influence_line(x, 0.5, "moment"))
    assert bridge.modal_effects() == pytest.approx(bridge.modal_effects(0.5, "moment"))
    assert bridge.modal_moments() == pytest.approx(bridge.modal_moments(0.5))
    assert bridge.kinks() == pytest.approx([0, 6, 18.5, 31, 37])


def test_damping_is_one_number_for_all_modes_or_one_a_mode_or_rayleighs():
    one = Bridge(25, MU, EJ, n_modes=3, damping_ratio=0.02)
    assert one.damping_ratios == pytest.approx([0.02] * 3)
    each = Bridge(25, MU, EJ, n_modes=3, damping_ratio=[0.01, 0.02, 0.03])
    assert each.damping_ratios == pytest.approx([0.01, 0.02, 0.03])
    rayleigh = Bridge(25, MU, EJ, n_modes=3, damping_ratio={1: 0.02, 3: 0.05})
    low, middle, high = rayleigh.damping_ratios
    assert (low, high) == pytest.approx((0.02, 0.05))
    # a / w + b w with w as 1 : 4 : 9.
    b = (0.05 * 9 - 0.02) / 80
    assert middle == pytest.approx((0.02 - b) / 4 + 4 * b)
    assert dataclasses.replace(rayleigh) == rayleigh


WRONG = [
    ({"spans": []}, ValueError, "spans must hold at least one length"),
    ({"spans": [25, -25]}, ValueError, r"spans\[1\] must be above 0 \[m\], got -25: type 25"),
    ({"spans": "25"}, TypeError, "spans must be one number .* without quotes"),
    ({"spans": np.ma.masked_array([25.0, 25], [0, 1])}, ValueError, "masked"),
    ({"mass_per_length": [1e4, 2e4, 3e4]}, ValueError, r"one a span \(2\).*got 3 numbers"),
    ({"mass_per_length": []}, ValueError, "got 0 numbers"),
    ({"mass_per_length": [1e4, -2e4]}, ValueError, r"mass_per_length\[1\] must be above 0"),
    (
        {"flexural_rigidity": [(25, 4e10), (20, 5e10)]}, ValueError,
        "flexural_rigidity has pieces up to 45 m, the bridge is 50 m long: type 25 for the length",
    ),
    ({"flexural_rigidity": [(60, 4e10), (10, 4e10)]}, ValueError, "up to 70 m, .* 50 m long$"),
    ({"flexural_rigidity": [(25, 4e10), 5e10]}, ValueError, r"\[1\] must be a pair \(length"),
    ({"flexural_rigidity": [(0, 4e10), (50, 5e10)]}, ValueError, r"\[0\]\[0\] must be above 0"),
    ({"supports": "clamped"}, TypeError, "a list of 3, .* type supports="),
    ({"supports": 3}, TypeError, "a list of 3"),
    ({"supports": [HINGED, HINGED]}, ValueError, "supports must be 3 for 2 spans, got 2"),
    ({"supports": ["Simple", HINGED, HINGED]}, ValueError, r"supports\[0\] .*: type 'simple'"),
    ({"supports": [{"spring": 1}, HINGED, HINGED]}, ValueError, "'spring', not one of 'vertical'"),
    ({"supports": [{"vertical": -1}, HINGED, HINGED]}, ValueError, "vertical must be 0 or more"),
    ({"supports": [{"vertical": np.nan}, HINGED, HINGED]}, ValueError, "vertical must be finite"),
    ({"supports": [FREE] * 3}, ValueError, "free to fall: make two of them 'simple', or one"),
    ({"supports": [FREE, HINGED, FREE]}, ValueError, r"free to turn about supports\[1\]: make"),
    ({"n_modes": 0}, ValueError, "n_modes must be 1 or more"),
    ({"n_modes": 2.0}, TypeError, "n_modes must be a whole number, got 2.0: type 2"),
    ({"damping_ratio": -0.1}, ValueError, "damping_ratio must be 0 or more"),
    ({"damping_ratio": 2}, ValueError, "type 0.02"),
    ({"damping_ratio": [0.1] * 5}, ValueError, "one number or 4 numbers"),
    ({"damping_ratio": {1: 0.02}}, ValueError, "ratios of two modes from 1 to 4, got modes"),
    ({"damping_ratio": {1: 0.02, 5: 0.02}}, ValueError, "from 1 to 4"),
    ({"damping_ratio": {0: 0.02, 1: 0.02}}, ValueError, "mode must be 1 or more"),
]  # fmt: skip


@pytest.mark.parametrize(("wrong", "error", "message"), WRONG)
def test_a_wrong_argument_is_named_with_what_to_type(wrong, error, message):
    right = {"spans": [25, 25], "mass_per_length": MU, "flexural_rigidity": EJ, "n_modes": 4}
    with pytest.raises(error, match=message):
        Bridge(**(right | wrong))


def test_rayleigh_damping_that_makes_no_sense_is_refused():
    bridge = Bridge(25, MU, EJ, n_modes=8, damping_ratio={1: 0.0, 2: 0.0})
    assert not bridge.damping_ratios.any()
    with pytest.raises(ValueError, match="gives mode 3 the ratio -"):
        Bridge(25, MU, EJ, n_modes=8, damping_ratio={1: 0.05, 2: 0.0})
    with pytest.raises(ValueError, match="both modes have the same frequency"):
        Bridge(
            [25, 25], MU, EJ, n_modes=4, damping_ratio={1: 0.02, 2: 0.02},
            supports=[HINGED, CLAMPED, HINGED],
        )  # fmt: skip


@pytest.mark.parametrize(
    ("arguments", "error", "message"),
    [
        ((5, 1.5), ValueError, "section must lie between 0 and 1"),
        ((5, -0.1), ValueError, "section must lie between 0 and 1"),
        ((5, "0.5"), TypeError, "section must be one number"),
        ((5, 0.5, "Moment"), ValueError, "quantity must be one of .*type 'moment'"),
        ((5, 0.4, "reaction"), ValueError, "one of 0, 0.5, 1 of the length, got 0.4: type"),
        ((np.ma.masked_array([1.0, 2], [0, 1]), 0.5), ValueError, "masked"),
    ],
)
def test_a_wrong_section_or_quantity_is_refused(arguments, error, message):
    with pytest.raises(error, match=message):
        BRIDGES["two spans"].influence_line(*arguments)


def test_a_tip_has_no_reaction_and_masked_places_have_no_shape():
    bridge = BRIDGES["with cantilevers"]
    with pytest.raises(ValueError, match=r"one of 0\.162162, 0\.837838 of the length, got 0"):
        bridge.modal_effects(0.0, "reaction")
    with pytest.raises(ValueError, match="masked"):
        bridge.mode_shapes(np.ma.masked_array([1.0, 2], [0, 1]))


def test_a_slip_of_units_is_told():
    with pytest.warns(bc.PlausibilityWarning, match="type flexural_rigidity=4.865"):
        Bridge([25, 25], MU, 4.86535e7)
