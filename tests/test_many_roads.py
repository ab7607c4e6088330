"""Many roads at once: their DAE, their superposed DAF, and where neither is to be trusted."""

import warnings

import numpy as np
import pytest
from helpers import rough_road

import bridgectl as bc
from bridgectl.road import add_events, iso8608_elevations, step
from bridgectl.road.iri import GOOD
from bridgectl.surface.tire_contact import TireContact
from bridgectl.surface.trust import TALLEST, TOLERANCE, DaeTrust

KMH = np.array([60, 80, 100, 120])
APPROACH = 40.0


@pytest.fixture(scope="module")
def surface():
    return bc.ramp_surface(bc.li2006.beam(), bc.li2006.car(), KMH / 3.6, approach=APPROACH)


@pytest.fixture(scope="module")
def elevations():
    return iso8608_elevations(30, "A", APPROACH + 25, seed=1)


def simulated(surface, road):
    return bc.daf(surface.beam, surface.vehicle, surface.speeds, road, start=-surface.approach)


def test_a_batch_has_the_dae_and_the_superposed_daf_of_each_road(surface, elevations):
    roads = [bc.RoadProfile(surface.stations, z) for z in elevations]
    dae, daf = surface.dae(elevations), surface.superposed_daf(elevations)
    assert dae.shape == daf.shape == (30, 4)
    assert dae == pytest.approx(np.array([surface.dae(road) for road in roads]), abs=1e-12)
    assert daf == pytest.approx(np.array([surface.superposed_daf(r) for r in roads]), abs=1e-12)
    assert surface.dae(roads) == pytest.approx(dae, abs=1e-12)
    assert surface.dae(elevations[0]) == pytest.approx(dae[0], abs=1e-12)


def test_a_batch_of_superposed_dafs_is_what_is_simulated(surface, elevations):
    found = surface.superposed_daf(elevations[:6])
    for z, values in zip(elevations, found, strict=False):
        road = bc.RoadProfile(surface.stations, z)
        assert values == pytest.approx(simulated(surface, road), abs=1e-6)


def test_batches_larger_than_what_fits_at_once_are_cut(surface, elevations, monkeypatch):
    whole = surface.superposed_daf(elevations)
    monkeypatch.setattr("bridgectl.surface.ramps.ROADS_AT_ONCE", 7)
    assert surface.superposed_daf(elevations) == pytest.approx(whole, abs=1e-12)


def test_a_road_that_lifts_the_tire_is_simulated_and_the_others_are_not(surface, elevations):
    level = bc.RoadProfile([-APPROACH, 25.0], [0.0, 0.0])
    jump = add_events(level, step(-3.0, -0.07))
    roads = [bc.RoadProfile(surface.stations, elevations[0]), jump]
    with pytest.warns(bc.LiftOffWarning):
        found = surface.superposed_daf(roads)
    straight = surface.road(surface.ramps(jump) * surface.ramp_height)
    with pytest.warns(bc.LiftOffWarning):
        expected = simulated(surface, straight)
    assert found[1] == pytest.approx(expected, abs=1e-9)
    assert found[0] == pytest.approx(simulated(surface, roads[0]), abs=1e-6)


def test_several_tires_are_watched_by_simulating_each_road(bridge, truck):
    convoy = bc.convoy([truck, truck], [0, 5.0])
    surface = bc.ramp_surface(bridge, convoy, [20.0, 30.0], approach=10)
    roads = [rough_road(seed, -10, 25) for seed in range(2)]
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        found = surface.superposed_daf(roads)
    for road, values in zip(roads, found, strict=True):
        assert values == pytest.approx(simulated(surface, road), abs=1e-6)


# The tire force behind the watch


@pytest.mark.parametrize("vehicle", ["truck", "undamped", "stiff", "heavily damped"])
def test_the_least_tire_force_is_that_of_a_simulation(bridge, truck, vehicle, monkeypatch):
    from dataclasses import replace

    changes = {
        "truck": {}, "undamped": {"damping": 0.0}, "stiff": {"tire_stiffness": 2e7},
        "heavily damped": {"damping": 2e5},
    }[vehicle]  # fmt: skip
    car, speed = replace(truck, **changes), 25.0
    surface = bc.ramp_surface(bridge, car, speed, approach=APPROACH)
    road = rough_road(9, -APPROACH, 25, height=2e-4)
    response = bc.crossing_response(bridge, car, speed, road, start=-APPROACH)
    least = response.outputs["tire_force"].min() / response.outputs["tire_force"][0]
    drops = (surface.ramps(road) * surface.ramp_height)[:, np.newaxis]
    contact = surface._contact
    assert isinstance(contact, TireContact)
    for margin in (-0.02, 0.02):
        monkeypatch.setattr("bridgectl.surface.tire_contact.DOUBTFUL", least + margin)
        assert contact.doubtful(0, drops)[0] == (margin > 0)


# The warning light


def test_the_light_predicts_large_errors_of_the_dae(bridge, truck):
    """Precision and recall above 0.8 on class A roads, and on B where more of it is large."""
    surface = bc.ramp_surface(bridge, truck, np.arange(50, 151, 5) / 3.6)
    for iso_class in "AB":
        roads = iso8608_elevations(100, iso_class, 25.0, seed=2)
        large = np.abs(surface.dae(roads) - surface.superposed_daf(roads)) > TOLERANCE
        lit = bc.dae_trust(surface, roads).peak_moves
        assert (large & lit).sum() > 0.8 * lit.sum()
        assert (large & lit).sum() > 0.8 * large.sum()


def test_the_rise_of_the_peak_is_what_the_dae_misses_of_a_small_ramp(surface):
    road = bc.li2006.fig7_road()
    at_bridge = bc.ramp_surface(surface.beam, surface.vehicle, surface.speeds)
    trust = bc.dae_trust(at_bridge, road)
    missed = at_bridge.superposed_daf(road) - at_bridge.dae(road)
    assert trust.peak_rise == pytest.approx(missed, abs=0.005)


def test_a_smooth_road_is_trusted_everywhere(surface):
    trust = bc.dae_trust(surface, np.zeros((2, len(surface.stations))))
    assert trust.trusted.all()
    assert trust.trusted.shape == (2, 4)
    # A sample is below the peak beside it.
    assert trust.peak_rise == pytest.approx(np.zeros((2, 4)), abs=2e-4)


def test_tall_ramps_and_rough_roads_and_lift_off_are_told(surface, elevations):
    tall = elevations[0].copy()
    tall[450:] += 0.011
    rough = elevations[1] * 4
    lifting = elevations[2].copy()
    lifting[380:] -= 0.07
    trust = bc.dae_trust(surface, np.array([elevations[0], tall, rough, lifting]))
    assert trust.tallest_ramp[1] > 0.01 > trust.tallest_ramp[0]
    assert trust.iri[2] == pytest.approx(4 * bc.RoadProfile(surface.stations, elevations[1]).iri())
    assert not trust.trusted[1:].any()
    assert trust.lift_off[3].any()
    assert not trust.lift_off[0].any()
    assert "IRI up to" in repr(trust)


def test_one_road_has_one_iri_and_one_tallest_ramp(surface, elevations):
    road = bc.RoadProfile(surface.stations, elevations[3])
    trust = bc.dae_trust(surface, road)
    assert trust.peak_rise.shape == trust.trusted.shape == (4,)
    assert float(trust.iri) == pytest.approx(road.iri(), rel=1e-9)


@pytest.mark.parametrize(
    ("against", "trusted"),
    [
        ({"peak_rise": TOLERANCE, "tallest_ramp": TALLEST, "iri": 6.99}, True),
        ({"peak_rise": TOLERANCE + 1e-9}, False),
        ({"lift_off": True}, False),
        ({"tallest_ramp": TALLEST + 1e-9}, False),
        ({"iri": GOOD}, False),
    ],
    ids=["all at their limits", "peak moves", "lift-off", "tall ramp", "not good"],
)
def test_each_thing_alone_speaks_against_a_road_beyond_its_limit(against, trusted):
    """Ramps of the paper's 10 mm are superposed by it; a good road is one below 7 m/km."""
    nothing = {"peak_rise": 0.0, "lift_off": False, "tallest_ramp": 0.0, "iri": 0.0}
    told = {name: np.array([value]) for name, value in (nothing | against).items()}
    assert DaeTrust(**told, tolerance=TOLERANCE, speeds=np.array([25.0])).trusted.tolist() == [
        [trusted]
    ]


def test_a_tolerance_of_nothing_is_an_error(surface, elevations):
    with pytest.raises(ValueError, match="tolerance must be above 0"):
        bc.dae_trust(surface, elevations, tolerance=0)
