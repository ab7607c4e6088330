"""Noise on measured velocities belongs to seed, road and speed, alone or in company."""

from itertools import combinations

import numpy as np
import pytest

import bridgectl as bc
from bridgectl.dampers import Damper, passive, simulate_loop, skyhook
from bridgectl.road import iso8608_elevations

X = -10 + 0.1 * np.arange(351)
NOISY = Damper(skyhook(1e3, 30e3), velocity_noise=0.05, seed=3)
SPEEDS = np.array([30.0, 17.0, 25.0, 21.5, 28.0])


@pytest.fixture(scope="module")
def roads():
    return iso8608_elevations(12, "B", 35, seed=2)


@pytest.fixture(scope="module")
def together(bridge, truck, roads):
    return simulate_loop(bridge, truck, NOISY, SPEEDS, X, roads).daf


@pytest.mark.parametrize(
    "some", [slice(None, None, 5), pytest.param(slice(None), marks=pytest.mark.slow)]
)
@pytest.mark.slow
def test_a_noisy_crossing_is_the_same_alone_and_in_a_batch(bridge, truck, roads, together, some):
    """Of sixty crossings every one, or some: to 1e-12 of the static moment."""
    cases = list(np.ndindex(together.shape))[some]
    for i, j in cases:
        alone = simulate_loop(bridge, truck, NOISY, SPEEDS[i], X, roads[j]).daf[0, 0]
        assert together[i, j] == pytest.approx(alone, abs=1e-12)


@pytest.mark.parametrize("start", [-8.4, -8.9, -10.4])
def test_round_off_in_the_first_station_changes_no_noise(bridge, truck, start):
    """As by -0.1 * 84: the way to the end of the bridge is a whole number of pieces of 100 mm."""
    before = np.nextafter(np.nextafter(start, -np.inf), -np.inf)
    one, other = (
        simulate_loop(bridge, truck, NOISY, 25.0, [x, 0, 10, 25], [0, 0, 1e-3, 0]).daf[0, 0]
        for x in (start, before)
    )
    assert other == pytest.approx(one, abs=1e-12)


@pytest.mark.quick_cases(1)
@pytest.mark.parametrize("seed", range(2))
def test_the_order_of_a_batch_does_not_matter(bridge, truck, roads, together, seed):
    rng = np.random.default_rng(seed)
    speeds, order = rng.permutation(len(SPEEDS)), rng.permutation(len(roads))
    found = simulate_loop(bridge, truck, NOISY, SPEEDS[speeds], X, roads[order]).daf
    assert found == pytest.approx(together[np.ix_(speeds, order)], abs=1e-12)


@pytest.mark.slow
def test_a_noisy_crossing_is_the_same_by_every_route(bridge, truck, roads, together):
    road = bc.RoadProfile(X, roads[4])
    by_daf = bc.daf(bridge, truck, SPEEDS, road, start=-10, damper=NOISY)
    assert by_daf == pytest.approx(together[:, 4], abs=1e-12)
    times = np.linspace(-0.3, 0.8, 50)  # more places of the road are known then
    response = bc.crossing_response(
        bridge, truck, 30.0, road, start=-10, damper=NOISY, timepts=times
    )
    whole = bc.crossing_response(bridge, truck, 30.0, road, start=-10, damper=NOISY)
    expected = np.interp(times, whole.time, whole.outputs["deflection"])
    assert response.outputs["deflection"] == pytest.approx(expected, abs=2e-6)  # [m]
    board = bc.score([passive(7e3), NOISY], bridge, truck, [road], SPEEDS, approach=10, workers=1)
    assert board.values["daf"][1, 0] == pytest.approx(together[:, 4], abs=1e-12)


@pytest.mark.slow  # processes take seconds to start
def test_two_processes_give_the_scores_of_one(bridge, truck, roads):
    dampers = [passive(7e3), NOISY, Damper(skyhook(1e3, 20e3).renamed("soft"), velocity_noise=0.1)]
    profiles = [bc.RoadProfile(X, z) for z in roads[:2]]
    one, two = (
        bc.score(dampers, bridge, truck, profiles, SPEEDS[:2], approach=10, workers=n)
        for n in (1, 2)
    )
    for name, values in one.values.items():
        assert two.values[name] == pytest.approx(values, abs=1e-12)


@pytest.mark.slow
def test_roads_speeds_and_seeds_have_noise_of_their_own(bridge, truck):
    """On roads that differ by a tenth of a millimetre far ahead, commands differ at once."""
    bump, between = (np.where(np.abs(X - place) < 0.05, 1e-4, 0.0) for place in (20, 20.4))

    def measured(speed, road, **changes):
        damper = Damper(skyhook(1e3, 30e3), velocity_noise=0.05, **changes)
        found = simulate_loop(bridge, truck, damper, speed, X, road, record=["body_velocity"])
        return found.histories[0]["body_velocity"][0, :20]

    first = measured(25.0, 0 * X)
    assert np.array_equal(first, measured(25.0, 0 * X))
    others = [measured(25.0, bump), measured(25.0, between), measured(25.0, bump + between)]
    others += [measured(26.0, 0 * X), measured(25.0, 0 * X, seed=1)]
    for one, other in combinations([first, *others], 2):
        assert np.abs(one - other).max() > 0.02
    assert np.all(first != 0)  # from the first sample on
    assert np.std(first) == pytest.approx(0.05, rel=0.5)


@pytest.mark.slow
def test_accelerometers_and_travel_have_noise_of_their_own(bridge, truck):
    """Alone as beside others, of their deviations, and that of velocities stays as it is."""
    x, names = np.linspace(0, 100, 5), ["axle_velocity", "axle_acceleration", "suspension_travel"]
    roads = np.vstack([0 * x, 1e-3 * np.sin(x)])
    both = Damper(
        passive(7e3), velocity_noise=0.05, acceleration_noise=0.2, travel_noise=1e-3, max_force=1e9
    )
    found = simulate_loop(bridge, truck, both, [9.0, 10.0], x, roads, record=names).histories[1]
    alone = simulate_loop(bridge, truck, both, 10.0, x, roads[:1], record=names).histories[0]
    plain = Damper(passive(7e3), velocity_noise=0.05, max_force=1e9)
    old = simulate_loop(bridge, truck, plain, 10.0, x, roads[:1], record=names).histories[0]
    assert alone["axle_velocity"] == pytest.approx(old["axle_velocity"], abs=1e-12)
    for name, deviation in zip(names, (0.05, 0.2, 1e-3), strict=True):
        assert alone[name][0] == pytest.approx(found[name][0], abs=1e-12)
        noise = alone[name][0, -3000:]  # 6 s, far behind the bridge, at rest
        assert np.std(noise) == pytest.approx(deviation, rel=0.05)
        assert abs(np.corrcoef(noise[1:], noise[:-1])[0, 1]) < 0.05
    every = np.array([alone[name][0, -3000:] for name in names])
    assert np.abs(np.corrcoef(every) - np.eye(3)).max() < 0.06


@pytest.mark.slow
def test_noise_is_white_and_of_its_deviation(bridge, truck):
    x = np.linspace(0, 100, 5)
    damper = Damper(passive(7e3), velocity_noise=0.05, max_force=1e9)
    found = simulate_loop(bridge, truck, damper, 10.0, x, 0 * x, record=["axle_velocity"])
    noise = found.histories[0]["axle_velocity"][0, -3000:]  # 6 s, far behind the bridge, at rest
    assert np.std(noise) == pytest.approx(0.05, rel=0.05)
    assert abs(np.corrcoef(noise[1:], noise[:-1])[0, 1]) < 0.05
