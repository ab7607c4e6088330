"""Whatever tells its modes and influence line is a bridge: a second one, equal to the first.

`Sines` is the beam again, written from the closed forms with shapes of other scales and modes in
another order. Everything must come out the same, within 1e-12 of the static moment where nothing is
iterated.
"""

from dataclasses import dataclass, replace

import numpy as np
import pytest
from helpers import rough_road

import bridgectl as bc
from bridgectl import dampers
from bridgectl.extremes import extreme_road
from bridgectl.model.bridge import BridgeModel, described

SPEEDS = np.array([60, 90, 108]) / 3.6
ORDER, SCALES = np.array([2, 0, 1]), np.array([0.3, -2.0, 7.0])


@dataclass(frozen=True)
class Sines:
    """Modes 3, 1, 2 of a simply supported beam, as phi_j = a_j sin(j pi x / l)."""

    length: float
    mass_per_length: float
    stiffness: float

    n_modes = 3
    damping_ratios = np.array([0.03, 0.01, 0.02])

    @property
    def waves(self):
        return (ORDER + 1) * np.pi / self.length

    @property
    def omega(self):
        return self.waves**2 * np.sqrt(self.stiffness / self.mass_per_length)

    @property
    def modal_masses(self):
        return SCALES**2 * self.mass_per_length * self.length / 2

    def mode_shapes(self, x):
        x = np.asarray(x, dtype=float)[..., np.newaxis]
        inside = (x > 0) & (x < self.length)
        return np.where(inside, SCALES * np.sin(self.waves * x), 0.0)

    def influence_line(self, x, section=0.5):
        x, s = np.asarray(x, dtype=float), section * self.length
        inside = (x > 0) & (x < self.length)
        moment = np.where(x < s, x * (self.length - s), s * (self.length - x)) / self.length
        return np.where(inside, moment, 0.0)

    def modal_moments(self, section=0.5):
        return self.stiffness * self.waves**2 * self.mode_shapes(section * self.length)

    def kinks(self, section):
        return np.array([0.0, section * self.length, self.length])


@pytest.fixture(scope="module")
def pair():
    """The beam, and the same told otherwise."""
    beam = replace(bc.li2006.beam(), damping_ratio=(0.01, 0.02, 0.03))
    return beam, Sines(beam.length, beam.mass_per_length, beam.flexural_rigidity)


@pytest.fixture(scope="module")
def road():
    return rough_road(3, -20, 25)


def both(pair, made, *args, **kwargs):
    return [made(bridge, bc.li2006.car(), *args, **kwargs) for bridge in pair]


def test_both_are_bridges_and_a_number_is_none(pair):
    assert all(isinstance(bridge, BridgeModel) for bridge in pair)
    with pytest.raises(TypeError, match=r"beam must be a bridgectl\.Beam, got float"):
        bc.daf(25.0, bc.li2006.car(), 25.0)


@pytest.mark.parametrize("recovery", ["exact", "li2006", "modal"])
@pytest.mark.parametrize("effect", ["moment", "deflection", "tire_force", "acceleration"])
def test_dafs_of_every_effect_are_the_same(pair, road, recovery, effect):
    where = {"section": 0.4, "recovery": recovery, "effect": effect}
    ask = bc.peak_effect if effect == "acceleration" else bc.daf
    first, second = both(pair, ask, SPEEDS, road, start=-20, **where)
    assert second == pytest.approx(first, abs=1e-12)


@pytest.mark.slow
def test_the_control_library_finds_the_same(pair, road):
    """Its step control is of the states, whose scale differs: within 1e-7."""
    first, second = both(pair, bc.daf, 25.0, road, start=-20, method="control")
    assert second == pytest.approx(first, abs=1e-7)


def test_a_response_has_the_same_outputs(pair, road):
    first, second = both(pair, bc.crossing_response, 25.0, road, start=-20, tail=0.5)
    for name in ("moment", "tire_force", "deflection"):
        of_first, of_second = (np.array(each.outputs[name]) for each in (first, second))
        assert of_second == pytest.approx(of_first, abs=1e-12 * float(np.abs(of_first).max()))


def test_surfaces_and_what_they_tell_are_the_same(pair, road):
    first, second = both(
        pair, bc.ramp_surface, SPEEDS, approach=20, ramp_height="A", both_ways=True
    )
    assert second.daf_unit == pytest.approx(first.daf_unit, abs=1e-12)
    assert second.daf_rise == pytest.approx(first.daf_rise, abs=1e-12)
    for told in (
        lambda s: s.dae(road), lambda s: s.dae(road, order=2), lambda s: s.superposed_daf(road),
        lambda s: s.class_dae("A").sd, lambda s: bc.dae_trust(s, road).peak_rise,
        lambda s: s.contributions(road),
    ):  # fmt: skip
        assert told(second) == pytest.approx(told(first), abs=1e-11)


def test_a_truck_of_two_axles_crosses_both_alike(pair, road):
    twins = bc.convoy([bc.li2006.car(), bc.li2006.car()], [0.0, 5.0])
    first, second = (bc.daf(bridge, twins, SPEEDS, road, start=-15) for bridge in pair)
    assert second == pytest.approx(first, abs=1e-12)


def test_a_tire_that_leaves_the_road_flies_alike(pair):
    steep = bc.RoadProfile([-5.0, 2.0, 2.3, 30.0], [0.0, 0.0, 0.1, 0.1])
    with pytest.warns(bc.LiftOffWarning):
        first, second = both(pair, bc.daf, 25.0, steep, start=-5)
    assert second == pytest.approx(first, abs=1e-9)


@pytest.mark.quick_cases(1)
@pytest.mark.parametrize("law", ["skyhook", "clipped LQR", "preset"])
def test_closed_loops_are_the_same(pair, road, law):
    laws = {
        strategy.name: strategy for strategy in dampers.library(pair[0], bc.li2006.car(), 1e3, 30e3)
    }
    first, second = both(pair, bc.daf, SPEEDS, road, start=-20, damper=laws[law])
    assert second == pytest.approx(first, abs=1e-12)


@pytest.mark.slow
def test_bridgehook_knows_both_alike(pair, road):
    """Its tables come from both: a switch within round-off of zero may fall on the other side."""
    dafs = [
        bc.daf(bridge, bc.li2006.car(), SPEEDS, road, start=-20,
               damper=dampers.bridgehook(bridge, bc.li2006.car(), 1e3, 30e3))
        for bridge in pair
    ]  # fmt: skip
    assert dafs[1] == pytest.approx(dafs[0], abs=1e-9)


def test_costate_and_extreme_roads_are_the_same(pair):
    sigmas = both(pair, dampers.costate, 25.0)
    scale = np.abs(sigmas[0].sigma).max()
    assert sigmas[1].sigma == pytest.approx(sigmas[0].sigma, abs=1e-12 * scale)
    worst = [extreme_road(s, speed=25.0).dae for s in both(pair, bc.ramp_surface, 25.0)]
    assert worst[1] == pytest.approx(worst[0], abs=1e-9)


@pytest.mark.slow
def test_scores_are_the_same_and_files_tell_the_bridges_apart(pair, tmp_path):
    roads = [bc.iso8608_profile("A", 30, seed=seed, start=-5) for seed in range(2)]
    laws = [dampers.passive(7e3), dampers.skyhook(1e3, 30e3)]
    boards = [
        bc.score(laws, bridge, bc.li2006.car(), roads, SPEEDS[:2], approach=5, workers=1)
        for bridge in pair
    ]
    for name in ("daf", "dae", "dae_2", "suspension_travel"):
        assert boards[1].values[name] == pytest.approx(boards[0].values[name], abs=1e-11)
    assert boards[1].to_json()
    file, options = tmp_path / "score.jsonl", {"approach": 5, "workers": 1}
    bc.score(laws[:1], pair[0], bc.li2006.car(), roads, 25.0, resume=file, **options)
    with pytest.raises(ValueError, match="another study: its beam is"):
        bc.score(laws[:1], pair[1], bc.li2006.car(), roads, 25.0, resume=file, **options)


def test_a_surface_of_another_bridge_is_not_saved_in_silence(pair, tmp_path):
    surface = bc.ramp_surface(pair[1], bc.li2006.car(), 25.0)
    with pytest.raises(TypeError, match="Sines"):
        surface.save(tmp_path / "surface.npz")
    assert not list(tmp_path.iterdir())


def test_a_bridge_that_is_no_dataclass_is_described_by_its_text():
    class Plain:
        def __repr__(self):
            return "Plain()"

    assert described(Plain()) == {"bridge": "Plain()"}
