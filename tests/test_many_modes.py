"""Bridges of many modes: cells follow those that tires feel, peaks are sought between samples."""

import numpy as np
import pytest

import bridgectl as bc
from bridgectl.linear import nodes
from bridgectl.model.supports import Support
from bridgectl.surface import histories

SPEEDS = np.array([60.0, 97.0, 140.0]) / 3.6


@pytest.fixture(scope="module")
def car():
    return bc.li2006.car()


@pytest.fixture(scope="module")
def road():
    return bc.utia_road().place_bridge(678).crop(-40, 25).detrend().resample(0.1)


BRIDGES = {
    "14 modes": lambda: bc.li2006.beam(n_modes=14),
    "20 modes": lambda: bc.li2006.beam(n_modes=20),
    "two spans": lambda: bc.Bridge([25, 20], 18358, 4.865e10, n_modes=14, damping_ratio=0.01),
    "springs": lambda: bc.Bridge(
        [20], 15e3, 3e10, supports=[Support(8e8), Support(8e8)], n_modes=10, damping_ratio=0.01
    ),
}


@pytest.mark.quick_cases(2)
@pytest.mark.parametrize("name", BRIDGES)
@pytest.mark.parametrize(
    "effect", [bc.Moment(8.0), bc.Deflection(8.0), bc.TireForce(), bc.Shear(8.0)], ids=repr
)
def test_peaks_are_within_a_millionth_of_those_of_cells_that_follow_every_mode(
    car, road, name, effect
):
    bridge = BRIDGES[name]()
    level = bc.RoadProfile([-40.0, 60.0], [0.0, 0.0])
    for profile in (road, level) if bridge.length <= 25 else (level,):
        found = bc.peak_effect(bridge, car, SPEEDS, profile, start=-40, effect=effect)
        with pytest.MonkeyPatch.context() as patch:
            one = nodes.followed
            patch.setattr(nodes, "followed", lambda c, wide, one=one: one(c, wide=False))
            patch.setattr(nodes, "MAX_BEAM_PHASE", 0.85)
            every = bc.peak_effect(bridge, car, SPEEDS, profile, start=-40, effect=effect)
        assert found == pytest.approx(every, rel=2e-6)


def test_acceleration_of_the_bridge_has_cells_that_follow_every_mode(car):
    beam = bc.li2006.beam(n_modes=14)
    shaken = bc.Crossing(beam, car, bc.BridgeAcceleration(12.5))
    assert nodes.followed(shaken, wide=True) == pytest.approx(beam.omega.max())  # rad/s
    bent = bc.Crossing(beam, car, bc.Moment(12.5))
    assert nodes.followed(bent, wide=True) < 0.2 * beam.omega.max()


def test_cells_follow_more_modes_of_softer_bridges_and_all_that_move_an_end(car):
    def share(bridge):
        crossing = bc.Crossing(bridge, car)
        return nodes.followed(crossing, wide=True) / bridge.omega.max()

    beam = bc.li2006.beam(n_modes=14)
    soft = bc.Beam(25, 18358, beam.flexural_rigidity / 20, n_modes=14)
    assert share(beam) < share(soft) < 1
    assert share(BRIDGES["springs"]()) == pytest.approx(nodes.BLOW)


@pytest.fixture(scope="module")
def surface(car):
    return bc.ramp_surface(bc.li2006.beam(n_modes=14), car, SPEEDS, approach=40)


def test_ramps_and_roads_of_a_surface_have_the_peaks_of_simulations(car, road, surface):
    beam = surface.beam
    given = beam, car, SPEEDS
    on_level = bc.daf(*given, bc.RoadProfile(surface.stations, np.zeros(651)), start=-40)
    assert surface.daf_smooth == pytest.approx(on_level, abs=1e-9)
    for ramp in (300, 480, 540):
        drop = bc.RoadProfile(surface.stations, -1e-3 * (np.arange(651) > ramp))
        assert surface.daf_unit[:, ramp] == pytest.approx(bc.daf(*given, drop, start=-40), abs=1e-9)
    simulated = bc.daf(*given, surface.road(surface.ramps(road) * 1e-3), start=-40)
    assert surface.superposed_daf(road) == pytest.approx(simulated, abs=1e-9)


def test_peaks_between_samples_are_above_the_samples_and_do_not_need_kept_cells(
    car, surface, monkeypatch
):
    samples = surface.histories.smooth.max(axis=1)
    assert np.all(surface.daf_smooth >= samples - 1e-7)
    assert np.any(surface.daf_smooth > samples + 1e-7)
    monkeypatch.setattr(histories, "KEPT_BYTES", 0.0)
    again = bc.ramp_surface(surface.beam, car, SPEEDS, approach=40)
    np.testing.assert_allclose(again.daf_unit, surface.daf_unit, rtol=0, atol=1e-12)


def test_a_saved_surface_of_many_modes_superposes_to_the_bit(surface, road, tmp_path):
    surface.save(tmp_path / "many.npz")
    loaded = bc.load_surface(tmp_path / "many.npz")
    np.testing.assert_array_equal(loaded.superposed_daf(road), surface.superposed_daf(road))
    np.testing.assert_array_equal(loaded.daf_unit, surface.daf_unit)
