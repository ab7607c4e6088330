"""Roads that roughness numbers do not tell apart, and extreme roads."""

import numpy as np
import pytest
from scipy.sparse.linalg import spsolve

import bridgectl as bc
from bridgectl.extremes import equal_roughness_pair, extreme_road, linear_program, pairs
from bridgectl.linear.peaks import find_peaks

KMH = np.arange(60, 121, 10)
SPEEDS = KMH / 3.6
APPROACH = 75.0


@pytest.fixture(scope="module")
def surface():
    return bc.ramp_surface(bc.li2006.beam(), bc.li2006.car(), SPEEDS, approach=APPROACH)


def at(kmh):
    return float(SPEEDS[list(KMH).index(kmh)])


def simulated(road):
    return bc.daf(bc.li2006.beam(), bc.li2006.car(), SPEEDS, road, start=-APPROACH)


def class_a(seed):
    return bc.iso8608_profile("A", APPROACH + 25, seed=seed, start=-APPROACH)


# Equal roughness (Fig. 3)


@pytest.mark.parametrize("seed", range(3))
@pytest.mark.parametrize("kmh", [70, 100])
def test_a_pair_has_one_iri_and_one_spectrum_and_two_dafs(surface, seed, kmh):
    pair = equal_roughness_pair(surface, class_a(seed), at(kmh))
    first, second = pair.first, pair.second
    assert first.iri() == pytest.approx(2.78, abs=1e-9)
    assert second.iri() == pytest.approx(2.78, abs=1e-3)
    densities = [road.psd(APPROACH + 25, window="boxcar").density for road in (first, second)]
    assert densities[1] == pytest.approx(densities[0], rel=0.01)
    assert pair.psd_difference < 1e-6
    difference = simulated(second) - simulated(first)
    assert difference[list(KMH).index(kmh)] > 0.15


def test_the_phases_found_are_near_the_best_that_no_iri_holds_back(surface):
    """All waves in phase with the bridge bound what any phases can do."""
    road, kmh = class_a(4), 90
    pair = equal_roughness_pair(surface, road, at(kmh))
    i = list(KMH).index(kmh)
    waves = np.abs(np.fft.rfft(surface.ramps(pair.first)))
    effect = np.abs(np.fft.rfft(surface.daf_difference[i]))
    bound = surface.daf_smooth[i] + 2 * (waves * effect)[1:].sum() / len(surface.positions)
    assert pair.dae[1] < bound
    gained = pair.dae[1] - surface.daf_smooth[i]
    assert gained > 0.7 * (bound - surface.daf_smooth[i])


def test_a_pair_may_be_made_for_the_smallest_dae_and_another_iri(surface):
    pair = equal_roughness_pair(surface, class_a(1), at(90), iri=2.0, largest=False)
    assert pair.iri == pytest.approx([2.0, 2.0], abs=1e-3)
    assert pair.dae[1] < pair.dae[0] - 0.1


def test_a_pair_is_scaled_from_the_road_that_was_given(surface):
    road = class_a(2)
    pair = equal_roughness_pair(surface, road, at(90))
    ratio = np.diff(pair.first.elevation) / np.diff(road.elevation)
    assert ratio == pytest.approx(np.full_like(ratio, ratio[0]), rel=1e-6)
    assert "IRI 2.780 and 2.780 m/km" in repr(pair)


def test_a_road_of_one_wave_has_a_partner_too(surface):
    x = -APPROACH + 0.1 * np.arange(1001)
    wave = bc.RoadProfile(x, 1e-3 * np.sin(2 * np.pi * (x + APPROACH) / 50))
    pair = equal_roughness_pair(surface, wave, at(90))
    assert pair.iri == pytest.approx([2.78, 2.78], abs=1e-3)


def test_a_search_that_fails_is_an_error_that_tells_what_it_found(surface, monkeypatch):
    monkeypatch.setattr(pairs, "ROUNDS", 0)
    with pytest.raises(RuntimeError, match=r"no phases of this road have an IRI of 2\.78 m/km: Eq"):
        equal_roughness_pair(surface, class_a(0), at(90))


def test_a_level_road_has_no_partner(surface):
    road = bc.RoadProfile([-APPROACH, 25.0], [0.0, 0.0])
    with pytest.raises(ValueError, match="road is level or a straight grade"):
        equal_roughness_pair(surface, road, at(90))


def test_a_speed_that_the_surface_lacks_is_an_error_that_names_the_nearest(surface):
    with pytest.raises(ValueError, match=r"speed = 26 m/s is not one of the surface's.*25\.0"):
        equal_roughness_pair(surface, class_a(0), 26.0)


# Extreme roads (profiles 7 and 8)


def random_roads(surface, bound, count):
    """Roads whose ramps lie anywhere within the bound, or at it."""
    rng = np.random.default_rng(0)
    for i in range(count):
        drops = rng.uniform(-bound, bound, len(surface.positions))
        if i % 2:
            drops = bound * np.sign(drops)
        ends = np.append(surface.positions, surface.positions[-1] + surface.ramp_length)
        yield bc.RoadProfile(ends, np.append(0.0, -np.cumsum(drops)))


@pytest.mark.parametrize("largest", [True, False])
def test_no_random_road_of_the_same_bound_has_a_more_extreme_dae(surface, largest):
    extreme = extreme_road(surface, speed=at(90), max_ramp=1e-3, largest=largest)
    i = list(KMH).index(90)
    daes = [surface.dae(road)[i] for road in random_roads(surface, 1e-3, 1000)]
    assert (extreme.dae > max(daes)) if largest else (extreme.dae < min(daes))
    assert extreme.largest_ramp <= 1e-3 * (1 + 1e-6)


def test_the_simulated_daf_of_the_extreme_road_beats_1000_random_roads_of_its_bound(surface):
    """Those by superposed histories: simulations, as long as tires stay down."""
    one_speed = bc.ramp_surface(bc.li2006.beam(), bc.li2006.car(), at(90), approach=APPROACH)
    extreme = extreme_road(one_speed, max_ramp=0.5e-3)
    top = bc.daf(bc.li2006.beam(), bc.li2006.car(), at(90), extreme.road, start=-APPROACH)[0]
    assert top == pytest.approx(extreme.dae, abs=0.02)
    roads = random_roads(one_speed, 0.5e-3, 1000)
    drops = np.column_stack([one_speed.ramps(road) * one_speed.ramp_height for road in roads])
    moments = one_speed.histories.moments(0, drops) + one_speed.histories.smooth[0][:, np.newaxis]
    assert top > find_peaks(moments).values.max() + 0.05


def test_the_extreme_over_speeds_is_the_largest_of_the_extremes_at_each(surface):
    overall = extreme_road(surface)
    each = [extreme_road(surface, speed=float(c)).dae for c in SPEEDS]
    assert overall.dae == pytest.approx(max(each), abs=1e-9)
    assert overall.speed == SPEEDS[int(np.argmax(each))]


def test_the_smallest_maximum_over_speeds_lowers_the_daf_at_every_speed(surface):
    extreme = extreme_road(surface, max_ramp=0.5e-3, largest=False)
    dae = surface.dae(extreme.road)
    assert dae.max() == pytest.approx(extreme.dae, abs=1e-9)
    assert dae.max() < surface.daf_smooth.max() - 0.1
    assert simulated(extreme.road).max() < surface.daf_smooth.max() - 0.1
    # No single speed's smallest road has a smaller maximum.
    for c in SPEEDS:
        other = extreme_road(surface, speed=float(c), max_ramp=0.5e-3, largest=False)
        assert surface.dae(other.road).max() >= extreme.dae - 1e-9


@pytest.mark.quick_cases(1)
@pytest.mark.parametrize("largest", [True, False])
def test_an_iri_bound_holds_and_binds(surface, largest):
    extreme = extreme_road(surface, speed=at(100), iri=2.0, largest=largest)
    free = extreme_road(surface, speed=at(100), largest=largest)
    assert extreme.iri == pytest.approx(2.0, abs=1e-4)
    assert free.iri > 2.0
    assert (extreme.dae < free.dae) if largest else (extreme.dae > free.dae)


def test_the_program_knows_the_iri_that_the_road_has(surface):
    """Its golden car, a sparse recursion, against the one that every IRI comes from."""
    program = linear_program._Program(surface, 1e-3, 2.78)
    drops = np.random.default_rng(1).uniform(-1, 1, program.n_ramps)
    ends = np.append(surface.positions, surface.positions[-1] + surface.ramp_length)
    road = bc.RoadProfile(ends, np.append(0.0, -np.cumsum(drops)) * 1e-3)
    n_states = program.equal.shape[0]
    equal = program.equal.tocsc()
    n = program.n_ramps
    states = spsolve(equal[:, n : n + n_states], -(equal[:, :n] @ drops))
    output = program.below.tocsr()[: n_states // 4, n : n + n_states] @ states
    assert np.abs(output).mean() == pytest.approx(road.iri(), rel=1e-9)


def test_bounds_that_make_no_road_are_errors(surface):
    with pytest.raises(ValueError, match="max_ramp must not exceed the ramps' length"):
        extreme_road(surface, max_ramp=1.0)
    with pytest.raises(ValueError, match="iri must be above 0"):
        extreme_road(surface, iri=-1)
    with pytest.raises(ValueError, match="is not one of the surface's"):
        extreme_road(surface, speed=1.0)
    assert "ramps up to 1 mm" in repr(extreme_road(surface, speed=at(90)))
