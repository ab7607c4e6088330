"""Bridgehook with feedback: what a force is worth, the switching, and what it does to a bridge."""

import control as ct
import numpy as np
import pytest
from helpers import NO_DAMPERS, without_dampers
from hypothesis import given
from hypothesis import strategies as st

import bridgectl as bc
from bridgectl.dampers import SIGNALS, Damper, bridgehook, costate, passive, simulate_loop
from bridgectl.dampers.block import CROSSING_OUTPUTS
from bridgectl.dampers.bridgehook import Bridgehook
from bridgectl.dampers.loop.batch_law import BatchLaw
from bridgectl.dampers.peak_value import _expected, blurred, peak_value
from bridgectl.linear.cells import build_cells
from bridgectl.road import iso8608_elevations

SOFT, STIFF = 1e3, 30e3
MIDDLE = (SOFT + STIFF) / 2
SPEED = 25.0
LAWS = {
    feedback: bridgehook(bc.li2006.beam(), bc.li2006.car(), SOFT, STIFF, feedback=feedback)
    for feedback in (True, False)
}
NEVER = 1e15  # v_0 [m/s] at which the damper takes nothing off later


@pytest.fixture(scope="module")
def middle_truck(truck):
    return bc.QuarterCar(
        truck.sprung_mass, truck.unsprung_mass, truck.suspension_stiffness, truck.tire_stiffness,
        MIDDLE,
    )  # fmt: skip


@pytest.fixture(scope="module")
def found(bridge, truck):
    return peak_value(bridge, truck, SPEED, SOFT, STIFF)


# What a force is worth


@pytest.mark.parametrize("section", [0.5, 0.3])
def test_for_one_sharp_peak_the_worth_is_the_costate_of_the_middle_damper(
    bridge, truck, middle_truck, found, section
):
    never = {"section": section, "yield_speed": NEVER}
    sharp = peak_value(bridge, truck, SPEED, SOFT, STIFF, sharpness=1e9, **never)
    expected = costate(bridge, middle_truck, SPEED, section=section)
    before = expected.positions[:-2]
    worth = np.interp(before, sharp.positions, sharp.constant)
    assert worth == pytest.approx(expected.sigma[:-2], abs=0.02 * np.abs(expected.sigma).max())
    ahead = sharp.positions < before[-1]
    assert np.abs(sharp.body[ahead]).max() < 1e-3 * np.abs(found.body).max()
    assert np.abs(sharp.axle[ahead]).max() < 1e-3 * np.abs(found.axle).max()


def test_a_force_is_worth_something_up_to_the_last_cell(found):
    assert np.all(found.constant[:-1] != 0)
    assert found.constant[-1] == 0


@pytest.mark.parametrize("reach", [0.0, 12.0])
def test_a_shorter_reach_changes_nothing_within_it(bridge, truck, found, reach):
    near = peak_value(bridge, truck, SPEED, SOFT, STIFF, reach=reach)
    assert near.positions[0] == -reach
    inside = near.positions > 0.1 - reach  # its first node stands for half a cell
    for values, of_all in zip(near[1:], found[1:], strict=True):
        expected = np.interp(near.positions[inside], found.positions, of_all)
        assert values[inside] == pytest.approx(expected, abs=1e-9 * np.abs(of_all).max())
    sigma = costate(bridge, truck, SPEED, reach=reach)
    whole = costate(bridge, truck, SPEED)
    expected = np.interp(sigma.positions, *whole)
    assert sigma.sigma == pytest.approx(expected, abs=1e-9 * np.abs(expected).max())


def expected_state(bridge, car, place, measured):
    """Deviation of the states to be expected of velocities of body and axle, on the bridge."""
    crossing, nodes = bc.Crossing(bridge, car), np.linspace(0, 25, 251)
    cells = build_cells(crossing, np.array([SPEED]), nodes, on_bridge=True)
    steps = cells.transitions()[0, :, : crossing.n_states, : crossing.n_states]
    gains = _expected(crossing, steps, np.diff(nodes) / SPEED)[:, 0]
    return gains[np.argmin(np.abs(nodes - place))] @ measured


def after(bridge, car, place, deviations):
    """Places from one on, and changes of moment and suspension velocity by deviations of state.

    By the control library, from the smooth road's state.
    """
    system = bc.crossing_system(bridge, car, SPEED)
    exact = {"solve_ivp_method": "DOP853", "solve_ivp_kwargs": {"rtol": 1e-9, "atol": 1e-13}}

    def run(x, state):
        return ct.input_output_response(system, x / SPEED, np.zeros((2, x.size)), state, **exact)

    here = run(np.linspace(0, place, 11), 0).states[:, -1]
    x = np.linspace(place, 25, 1001)
    rows = [system.output_labels.index(name) for name in ("moment", "suspension_velocity")]
    smooth = run(x, here).outputs[rows]
    return x, smooth[0], [run(x, here + change).outputs[rows] - smooth for change in deviations]


@pytest.mark.slow
@pytest.mark.parametrize(("place", "measured"), [(4.0, [0.1, 0.0]), (9.0, [0.0, 0.1])])
def test_the_feedback_is_how_the_soft_maximum_bends(bridge, truck, middle_truck, place, measured):
    """Mixed difference of log(sum of w exp(beta M)) / beta in a push and in the measured state."""
    beta, push = 10.0, 100.0
    change = expected_state(bridge, middle_truck, place, measured)
    jump = bc.Crossing(bridge, middle_truck).damper_matrix[:, 0]
    _, smooth, ((by_state, _), (by_push, _)) = after(
        bridge, middle_truck, place, [change, push * jump]
    )
    small = 1e-3

    def soft(*shares):
        moment = smooth + small * (shares[0] * by_state + shares[1] * by_push)
        return np.log(np.exp(beta * (moment - 1)).sum()) / beta

    mixed = soft(1, 1) - soft(1, -1) - soft(-1, 1) + soft(-1, -1)
    expected = mixed / (4 * small**2 * push)
    table = peak_value(bridge, truck, SPEED, SOFT, STIFF, sharpness=beta, yield_speed=NEVER)
    gains = [np.interp(place, table.positions, values) for values in (table.body, table.axle)]
    scale = 0.1 * np.abs([table.body, table.axle]).max()
    assert gains @ np.array(measured) == pytest.approx(expected, abs=0.02 * scale)


@pytest.mark.slow
@pytest.mark.parametrize("measured", [[0.1, 0.0], [0.0, 0.1]])
def test_the_feedback_spares_the_motion_that_the_damper_will_yet_use(
    bridge, truck, middle_truck, measured
):
    """With all places of the peak alike: mixed derivative of D / (2 v_0) times that integral."""
    place, slow = 4.0, 0.5
    level, spared = (
        peak_value(bridge, truck, SPEED, SOFT, STIFF, sharpness=1e-9, yield_speed=v)
        for v in (NEVER, slow)
    )
    change = expected_state(bridge, middle_truck, place, measured)
    jump = bc.Crossing(bridge, middle_truck).damper_matrix[:, 0]
    x, _, ((_, by_state), (_, by_push)) = after(bridge, middle_truck, place, [change, jump])
    # With equal weights the share of the peaks still ahead falls linearly to the bridge's end.
    ahead = np.interp(x, level.positions, np.abs(level.constant)) * (25 - x) / (25 - place)
    taken = np.trapezoid(ahead * by_state * by_push, x / SPEED)
    expected = -(STIFF - SOFT) / 2 / slow * taken
    gains = [np.interp(place, spared.positions, values) for values in (spared.body, spared.axle)]
    assert gains @ np.array(measured) == pytest.approx(expected, rel=0.03)


def test_what_the_damper_will_yet_take_off_goes_with_its_range_over_the_yield_speed(bridge, truck):
    wide = peak_value(bridge, truck, SPEED, MIDDLE - 14e3, MIDDLE + 14e3, yield_speed=0.4)
    narrow = peak_value(bridge, truck, SPEED, MIDDLE - 7e3, MIDDLE + 7e3, yield_speed=0.2)
    never = peak_value(bridge, truck, SPEED, MIDDLE - 7e3, MIDDLE + 7e3, yield_speed=NEVER)
    for mine, same in zip(wide, narrow, strict=True):
        assert mine == pytest.approx(same, rel=1e-6, abs=1e-12)
    assert np.abs(narrow.axle - never.axle).max() > 0.1 * np.abs(never.axle).max()


def test_what_is_expected_of_the_velocities_is_what_random_roads_show(bridge, middle_truck):
    """Slope of the tire force on body and axle velocity at one place, over 400 roads."""
    x, place = -60 + 0.1 * np.arange(851), 8.0
    roads = iso8608_elevations(400, "A", 85, seed=5)
    names = ("body_velocity", "axle_velocity", "tire_force")
    run = simulate_loop(bridge, middle_truck, passive(MIDDLE), SPEED, x, roads, record=names)
    sample = round((60 + place) / SPEED / 2e-3)
    body, axle, force = (run.histories[0][name][:, sample] for name in names)
    slopes = np.linalg.lstsq(np.column_stack([body, axle, np.ones(400)]), force, rcond=None)[0]
    crossing = bc.Crossing(bridge, middle_truck)
    expected = [
        float(crossing.tire_rows(place)[0] @ expected_state(bridge, middle_truck, place, m))
        for m in ([1, 0], [0, 1])
    ]
    noise = np.std(force) / np.sqrt(400)
    assert slopes[0] == pytest.approx(expected[0], abs=4 * noise / np.std(body))
    assert slopes[1] == pytest.approx(expected[1], abs=4 * noise / np.std(axle))


@pytest.mark.filterwarnings("ignore::bridgectl.PlausibilityWarning")  # a bridge of rock
def test_on_a_bridge_that_does_not_yield_velocities_tell_what_they_told_on_the_road(middle_truck):
    """The noise of the road and the damper are in balance there, in every cell."""
    rock = bc.Beam(25.0, 18358.0, 5e18, n_modes=1)
    crossing, nodes = bc.Crossing(rock, middle_truck), np.linspace(0, 25, 126)
    cells = build_cells(crossing, np.array([SPEED]), nodes, on_bridge=True)
    steps = cells.transitions()[0, :, : crossing.n_states, : crossing.n_states]
    gains = _expected(crossing, steps, np.diff(nodes) / SPEED)[:, 0]
    # Displacements [m] per velocity [m/s]: up to 0.13 s.
    on_road = np.broadcast_to(gains[0, :4], gains[:, :4].shape)
    assert gains[:, :4] == pytest.approx(on_road, abs=1e-3)
    assert gains[0, [1, 3]] == pytest.approx(np.eye(2), abs=1e-12)


# The law


def test_it_is_stiff_where_the_worth_of_a_force_and_the_velocity_are_opposed(found):
    x = found.positions[(found.positions > -59) & (found.positions < 24)]
    body, axle = np.array([[0.1], [0.0], [-0.05]]), np.array([[0.0], [0.1], [0.1]])
    constant, by_body, by_axle = (np.interp(x, found.positions, values) for values in found[1:])
    worth = constant + by_body * body + by_axle * axle
    clear = np.abs(worth) > 0.1 * np.abs(worth).max()
    for v in (-0.2, 0.2):
        measured = {"body_velocity": body, "axle_velocity": axle, "suspension_velocity": v}
        c = LAWS[True].for_speed(SPEED).command(position=x, **measured)
        assert np.array_equal(c[clear], np.where(worth * v < 0, STIFF, SOFT)[clear])
    assert clear.mean() > 0.15


@pytest.mark.parametrize("place", [-60.0, -15.0, 0.0, 12.5, 25 * 35 / 36])
def test_at_a_knot_of_its_table_it_switches_where_the_worth_changes_its_sign(found, place):
    """Between knots, which lie closer to each other towards the bridge, the table is straight."""
    constant, _, by_axle = (np.interp(place, found.positions, values) for values in found[1:])
    turn = -constant / by_axle
    c = (
        LAWS[True]
        .for_speed(SPEED)
        .command(
            position=place, axle_velocity=turn * np.array([0.999, 1.001]), suspension_velocity=0.1
        )
    )
    before, after = (STIFF, SOFT) if constant < 0 else (SOFT, STIFF)
    assert c.tolist() == [before, after]


@pytest.mark.parametrize(("c_min", "c_max", "rest"), [(8e3, 30e3, 8e3), (1e3, 5e3, 5e3)])
def test_it_rests_at_its_bound_where_the_own_damping_lies_beyond(bridge, truck, c_min, c_max, rest):
    law = bridgehook(bridge, truck, c_min, c_max, feedback=False)
    assert law.passive_damping == rest
    assert law.for_speed(SPEED).command(position=26.0, suspension_velocity=0.1) == rest


@pytest.mark.parametrize("feedback", LAWS)
def test_it_rests_beyond_its_reach_and_after_the_bridge(feedback):
    law = LAWS[feedback].for_speed(SPEED)
    assert np.array_equal(
        law.command(position=[-60.1, 25.1], axle_velocity=1.0, suspension_velocity=-1.0), [7e3, 7e3]
    )


def test_it_looks_at_mid_span_unless_told_otherwise(bridge, truck):
    assert Bridgehook(bridge, truck, SOFT, STIFF).effect.at == 12.5
    assert bridgehook(bridge, truck, SOFT, STIFF).effect.at == 12.5
    assert bridgehook(bridge, truck, SOFT, STIFF, section=0.3).effect.at == 7.5


def test_it_measures_the_velocities_and_without_feedback_that_of_the_suspension_alone():
    sign = ["suspension_velocity", "position"]
    assert LAWS[True].for_speed(SPEED).used == ["body_velocity", "axle_velocity", *sign]
    assert LAWS[False].for_speed(SPEED).used == sign


@pytest.mark.parametrize("feedback", LAWS)
@given(values=st.lists(st.floats(-1e9, 1e9), min_size=len(SIGNALS), max_size=len(SIGNALS)))
def test_every_command_is_within_its_bounds_whatever_is_measured(feedback, values):
    c = LAWS[feedback].for_speed(SPEED).command(**dict(zip(SIGNALS, values, strict=True)))
    assert float(c) in (SOFT, STIFF, 7e3)


@pytest.mark.parametrize("feedback", LAWS)
def test_without_suspension_velocity_it_is_soft(feedback):
    law = LAWS[feedback].for_speed(SPEED)
    assert law.command(position=5.0, body_velocity=0.1, axle_velocity=0.1) == SOFT


@pytest.mark.slow
@pytest.mark.parametrize("feedback", LAWS)
def test_the_laws_of_all_speeds_are_evaluated_together(feedback):
    speeds = np.arange(40, 141, 10) / 3.6
    batch = BatchLaw(LAWS[feedback], [*speeds])
    assert batch.steps is not None
    rng = np.random.default_rng(0)
    signals = {name: rng.normal(0, 0.1, (speeds.size, 50)) for name in SIGNALS}
    signals["position"] = rng.uniform(-65, 26, (speeds.size, 50))
    each = [
        LAWS[feedback].for_speed(speed).command(**{k: v[i] for k, v in signals.items()})
        for i, speed in enumerate(speeds)
    ]
    assert np.array_equal(batch.command(signals)[0], each)


def test_it_is_a_block_of_the_control_library_and_a_c_file_at_each_speed(tmp_path):
    block, law = LAWS[True].system(SPEED), LAWS[True].for_speed(SPEED)
    measured = {"body_velocity": 0.05, "axle_velocity": -0.1, "suspension_velocity": 1.0}
    values = {CROSSING_OUTPUTS[name]: value for name, value in measured.items()}
    inputs = [values.get(label, 0.0) for label in block.input_labels]
    c = float(law.command(position=5.0, **measured))
    assert block.output(5 / SPEED, [], inputs) == pytest.approx([c, c])
    assert law.to_c(tmp_path / "hook.c").exists()
    with pytest.raises(ValueError, match=r"for_speed\(25.0\).to_c"):
        LAWS[True].to_c(tmp_path / "hook.c")


def test_a_lag_is_made_up_for_by_what_the_signals_will_be(bridge, truck):
    early = bridgehook(bridge, truck, SOFT, STIFF, lag=0.02).for_speed(SPEED)
    rng = np.random.default_rng(1)
    body, axle, body_change, axle_change = rng.normal(0, 0.1, (4, 500))
    x = rng.uniform(-65, 26, 500)
    now = {"body_velocity": body, "axle_velocity": axle, "suspension_velocity": body - axle}
    rates = {"body_acceleration": body_change / 0.02, "axle_acceleration": axle_change / 0.02}
    body, axle = body + body_change, axle + axle_change
    then = {"body_velocity": body, "axle_velocity": axle, "suspension_velocity": body - axle}
    assert np.array_equal(
        early.command(position=x, speed=SPEED, **now, **rates),
        LAWS[True].for_speed(SPEED).command(position=x + 0.02 * SPEED, **then),
    )
    with pytest.raises(ValueError, match="lag must be 0 or more"):
        bridgehook(bridge, truck, SOFT, STIFF, lag=-0.01)


@pytest.mark.quick_cases(1)
@pytest.mark.parametrize("deviation", [0.3, 1.0])
def test_of_places_that_are_known_to_a_deviation_the_mean_worth_counts(found, deviation):
    """Against a sum over thousands of places, to 1e-5 of the largest; 0 behind the bridge."""
    n = np.linspace(-6, 6, 6001)
    weights = np.exp(-(n**2) / 2)
    told, *means = blurred(found, deviation)
    places = told[:, np.newaxis] + deviation * n
    for values, mean in zip(found[1:], means, strict=True):
        each = np.interp(places, found.positions, values, right=0.0)
        expected = each @ weights / weights.sum()
        assert mean == pytest.approx(expected, abs=1e-5 * np.abs(values).max())
    assert told[-1] == pytest.approx(25.0 + 3 * deviation, abs=1e-9)


def test_places_that_are_known_are_taken_as_they_are(found):
    assert blurred(found, 0.0) is found


@pytest.mark.slow
def test_an_unsure_damper_counts_on_its_own_mean_worth_later(bridge, truck, found):
    """What it will yet take off per |v| is of |s| in the mean, which is less than the mean of |s|.

    The rest of the worth, as of a damper that takes nothing off later, is a plain mean.
    """
    case = bridge, truck, SPEED, SOFT, STIFF
    plain = peak_value(*case, yield_speed=NEVER)

    def taken(deviation):
        worth = peak_value(*case, position_deviation=deviation)
        return np.subtract(worth[2:], blurred(plain, deviation)[2:])

    unyielding = peak_value(*case, yield_speed=NEVER, position_deviation=1.0)
    for mean, expected in zip(unyielding, blurred(plain, 1.0), strict=True):
        assert mean == pytest.approx(expected, abs=1e-6 * np.abs(expected).max())
    sure = np.subtract(found[2:], plain[2:])
    ratios = [
        np.linalg.norm(taken(d)) / np.linalg.norm(blurred((found.positions, *sure), d)[1:])
        for d in (0.01, 1.0, 2.0)
    ]
    assert ratios[0] == pytest.approx(1.0, abs=1e-3)
    assert ratios[2] < ratios[1] < 0.95


def test_both_laws_may_be_told_how_well_places_are_known(bridge, truck):
    """Sigma of a sharp costate turns less often; behind the bridge three deviations are active."""
    x = np.linspace(-40, 25, 2000)
    for feedback in (True, False):
        sure, unsure = (
            bridgehook(bridge, truck, SOFT, STIFF, feedback=feedback, position_deviation=d)
            .for_speed(SPEED).command(position=x, suspension_velocity=0.1)
            for d in (0.0, 1.0)
        )  # fmt: skip
        turns, fewer = (np.count_nonzero(np.diff(c)) for c in (sure, unsure))
        assert 1 < fewer <= turns
        assert not np.array_equal(sure, unsure)
    law = bridgehook(bridge, truck, SOFT, STIFF, position_deviation=1.0).for_speed(SPEED)
    behind = law.command(position=[27.9, 28.1], suspension_velocity=0.1)
    assert behind[0] in (SOFT, STIFF)
    assert behind[1] == 7e3


def test_the_command_needs_the_speed_whose_law_it_is(bridge, truck):
    law = bridgehook(bridge, truck, SOFT, STIFF)
    signals = {"position": [3.0, 9.0], "axle_velocity": 0.1, "suspension_velocity": -0.1}
    expected = law.for_speed(SPEED).command(speed=SPEED, **signals)
    assert np.array_equal(law.command(speed=SPEED, **signals), expected)
    for speed in ({}, {"speed": [20.0, 25.0]}):
        with pytest.raises(ValueError, match="a law for each speed: type for example command"):
            law.command(**speed, **signals)


@pytest.mark.parametrize(
    ("changes", "error", "says"),
    [
        ({"c_min": STIFF, "c_max": SOFT}, ValueError, "c_min must not exceed c_max"),
        ({"c_max": 0.0}, ValueError, r"c_max must be above 0 \[N s/m\]"),
        ({"reach": -1.0}, ValueError, r"reach must be 0 or more \[m\]"),
        ({"sharpness": 0.0}, ValueError, "sharpness must be above 0"),
        ({"yield_speed": 0.0}, ValueError, r"yield_speed must be above 0 \[m/s\]"),
        ({"vehicle": without_dampers()}, ValueError, NO_DAMPERS),
    ],
)
def test_a_peak_value_that_cannot_be_is_refused(bridge, truck, changes, error, says):
    asked = {"beam": bridge, "vehicle": truck, "speed": SPEED, "c_min": SOFT, "c_max": STIFF}
    with pytest.raises(error, match=says):
        peak_value(**asked | changes)


# What it does to a bridge


@pytest.fixture(scope="module", params=[("A", 0.5), ("B", 0.4)], ids=lambda case: case[0])
def crossings(request, bridge, truck):
    """Mean DAF over random roads of a class: of the passive truck, and of a damper."""
    name, share = request.param
    speeds = np.array([72, 84, 96, 108]) / 3.6
    x, roads = -60 + 0.1 * np.arange(851), iso8608_elevations(40, name, 85, seed=31)
    surface = bc.ramp_surface(bridge, truck, speeds, approach=60)

    def mean(damper):
        return simulate_loop(bridge, truck, damper, speeds, x, roads).daf.mean(axis=1)

    own = surface.superposed_daf(roads).mean(axis=0)
    return share, own, mean(LAWS[True]), mean


@pytest.mark.slow
def test_on_random_roads_it_takes_half_of_the_largest_dynamic_increment_off(crossings):
    share, own, hook, mean = crossings
    assert hook.max() - 1 < share * (own.max() - 1)
    assert np.all(hook < own - 0.01)
    assert hook.mean() < mean(LAWS[False]).mean() - 0.005


@pytest.mark.slow
def test_a_late_and_noisy_damper_keeps_most_of_the_gain(bridge, truck, crossings):
    _, own, hook, mean = crossings
    early = bridgehook(bridge, truck, SOFT, STIFF, lag=0.01)
    late, made_up = (
        mean(Damper(law, lag=0.01, velocity_noise=0.005)) for law in (LAWS[True], early)
    )
    assert own.max() - late.max() > 0.6 * (own.max() - hook.max())
    assert made_up.max() < late.max() - 0.002


@pytest.mark.slow
def test_made_for_a_metre_it_keeps_more_of_its_gain_there_and_does_no_harm_at_three(
    bridge, truck, crossings
):
    """Mean DAF over four speeds; told of places a metre or three before or behind the true ones."""
    _, own, hook, mean = crossings
    unsure = bridgehook(bridge, truck, SOFT, STIFF, position_deviation=1.0)
    very = bridgehook(bridge, truck, SOFT, STIFF, position_deviation=3.0)

    def gain(law, error):
        return np.mean([own - mean(Damper(law, position_error=e)) for e in (-error, error)])

    whole = (own - hook).mean()
    assert gain(LAWS[True], 1.0) < 0.6 * whole
    assert gain(unsure, 1.0) > gain(LAWS[True], 1.0) + 0.005
    assert (own - mean(unsure)).mean() > 0.8 * whole
    assert gain(LAWS[True], 3.0) < 0
    assert gain(very, 3.0) > 0.005
