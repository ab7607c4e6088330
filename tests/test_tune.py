"""Tuning: many gains at once, exact gradients, and what is told of roads that were held out."""

import dataclasses
import json
import signal

import numpy as np
import pytest

import bridgectl as bc
from bridgectl.cli.roads import random_roads
from bridgectl.dampers import (
    Damper,
    bridgehook,
    clipped_lqr,
    continuous_skyhook,
    hybrid,
    passive,
    preset,
    program,
    simulate_loop,
    skyhook,
)
from bridgectl.dampers.fitted import fitted_everywhere
from bridgectl.model.crossing import make_crossing
from bridgectl.scoring import objective as objectives
from bridgectl.scoring import tune as tuning
from bridgectl.scoring.objective import Objective, all_roads, by_differences, class_ramps
from bridgectl.scoring.search import Scale
from bridgectl.scoring.study import make_study

BEAM, CAR = bc.li2006.beam(9, n_modes=1), bc.li2006.car()
ROADS = [bc.iso8608_profile("A", 11, seed=seed, start=-2) for seed in range(6)]
SPEEDS = np.array([100, 80]) / 3.6
BOUNDS = 1e3, 30e3
SHORT = {"approach": 2, "workers": 1, "progress": False}


def lines(n=3, **options):
    """A program of n places from 2 m before the bridge to its middle."""
    options = {"shape": "lines", "bounds": BOUNDS} | options
    return program(np.linspace(-2, 5, n), [7e3] * n, **options)


def goal_of(damper, driven=None, softness=np.inf):
    """What a tuning of all gains minimises, on the first two roads."""
    crossing, study = make_crossing(BEAM, CAR, "moment", 0.5, "exact"), study_of()
    devices = fitted_everywhere(damper, CAR)
    names = tuple(devices.dampers[0].strategy.gains)
    roads = all_roads(study) if driven is None else driven
    return Objective(crossing, devices, names, study.speeds, roads, softness, 1)


def study_of():
    crossing = make_crossing(BEAM, CAR, "moment", 0.5, "exact")
    return make_study(crossing, ROADS[:2], SPEEDS, 2.0, 0.0)


@pytest.fixture(scope="module")
def tuned():
    """A program of three places, tuned on two roads."""
    return bc.tune(lines(), BEAM, CAR, ROADS[:2], SPEEDS, held_out=ROADS[2:], iterations=8, **SHORT)


# The objective


@pytest.mark.parametrize("hardware", [{}, {"lag": 0.01, "velocity_noise": 0.01}])
def test_gains_side_by_side_do_what_each_does_alone(hardware):
    """To the last digits: with noise and lag, too, as a crossing has its own stream of noise."""
    law = hybrid(1e3, 30e3)
    goal = goal_of(Damper(law, **hardware))
    gains = np.array([[0.5, 30e3, 1e-4], [0.1, 5e3, 1e-2], [1.0, 2e5, 0.0]])
    found = goal.dafs(gains)
    assert found.shape == (3, 2, 2)
    for values, dafs in zip(gains, found, strict=True):
        own = Damper(law.with_gains(**dict(zip(goal.names, values, strict=True))), **hardware)
        alone = simulate_loop(BEAM, CAR, own, SPEEDS, goal.driven.stations, goal.driven.elevations)
        assert dafs == pytest.approx(alone.daf, abs=1e-12)
    assert np.ptp(found, axis=0).min() > 1e-5


def test_parts_of_a_large_run_are_put_together_in_order(monkeypatch):
    goal, gains = goal_of(continuous_skyhook(1e3, 30e3)), np.array([[1e4, 0], [5e4, 0], [2e5, 0]])
    whole = goal.dafs(gains)
    monkeypatch.setattr(objectives, "AT_ONCE", 4)
    assert goal.dafs(gains) == pytest.approx(whole, abs=1e-12)


def test_ramps_weighed_are_the_class_dae_of_the_surface():
    """Of a switching law and of one class: within 1e-9; of two classes it is the mean of both."""
    law = continuous_skyhook(1e3, 30e3)
    expected = []
    for name in "AB":
        surface = bc.ramp_surface(
            BEAM, CAR, SPEEDS, approach=2, ramp_height=name, both_ways=True, every=10, damper=law
        )
        expected.append(surface.class_dae(name).mean.mean())
        goal = goal_of(law, class_ramps(study_of(), [name]))
        found = goal.values(np.array([[*law.gains.values()]]))
        assert found == pytest.approx(expected[-1], abs=1e-9)
        assert goal.driven.weights.sum() == pytest.approx(1, abs=1e-12)
    both = goal_of(law, class_ramps(study_of(), "AB"))
    found = both.values(np.array([[*law.gains.values()]]))
    assert found == pytest.approx(np.mean(expected), abs=1e-9)


@pytest.mark.parametrize("softness", [np.inf, 0.01])
@pytest.mark.parametrize("what", ["roads", "ramps"])
def test_the_adjoint_is_what_differences_of_the_closed_loop_are(what, softness):
    """Within 1e-6 per kN s/m, where the slopes are up to some 1e-3 per kN s/m."""
    driven = all_roads(study_of()) if what == "roads" else class_ramps(study_of(), ["A"])
    law, dampings = lines(), np.array([7e3, 4e3, 12e3])
    goal = goal_of(law, driven, softness)
    value, slopes = goal.by_adjoint(law, dampings)
    everywhere = np.tile([-np.inf, np.inf], (3, 1))
    expected, differences = by_differences(goal.values, dampings, everywhere, 50.0)
    assert value == pytest.approx(expected, abs=1e-6)
    assert slopes == pytest.approx(differences, abs=1e-9)
    assert np.abs(slopes).max() > 1e-8


def test_differences_stay_within_the_bounds():
    asked = []

    def values(at):
        asked.extend(at)
        return (at**2).sum(axis=1)

    ends = np.array([[0.0, 1.0], [-1.0, 0.5]])
    value, slopes = by_differences(values, np.array([0.0, 0.5]), ends, 0.1)
    assert value == 0.25
    assert slopes == pytest.approx([0.1, 0.9], abs=1e-12)  # one-sided, of u^2
    assert np.all((np.array(asked) >= ends[:, 0]) & (np.array(asked) <= ends[:, 1]))


def test_a_soft_maximum_lies_between_mean_and_maximum():
    law = lines()
    gains = np.array([[7e3, 7e3, 7e3], [1e3, 1e3, 1e3]])
    goal = goal_of(law)
    by_speed = goal.dafs(gains).mean(axis=2)
    assert goal.values(gains) == pytest.approx(by_speed.mean(axis=1), abs=1e-12)
    softer = [goal_of(law, softness=s).values(gains) for s in (1e-5, 1e-2, 1e3)]
    assert softer[0] == pytest.approx(by_speed.max(axis=1), abs=1e-4)
    assert softer[2] == pytest.approx(by_speed.mean(axis=1), abs=1e-4)
    assert np.all((softer[0] > softer[1]) & (softer[1] > softer[2]))


def test_gains_are_measured_by_their_own_size():
    bounds = np.array([[-1e8, 1e8], [0, 1e6], [0, 1]])
    scale = Scale(np.array([-2e4, 0.0, 1e-4]), bounds)
    assert scale.sizes.tolist() == [2e4, 1e3, 1e-4]
    for gains in (scale.start, *bounds.T):
        assert scale.gains(scale.scaled(gains)) == pytest.approx(gains, rel=1e-12)
    u, h = np.array([0.3, 2.0, -0.5]), 1e-6
    free = Scale(scale.start, np.tile([-np.inf, np.inf], (3, 1)))
    rises = (np.sinh(u + h) - np.sinh(u - h)) / (2 * h) * scale.sizes
    assert dataclasses.replace(free, bounds=bounds).slopes(u) == pytest.approx(rises, rel=1e-8)


# The search


def best_constant(roads):
    """The least mean DAF of constant dampers, by the linear engine."""
    dafs = [
        np.mean([
            bc.daf(BEAM, dataclasses.replace(CAR, damping=c), SPEEDS, road, start=-2)
            for road in roads
        ])
        for c in np.geomspace(*BOUNDS, 40)
    ]  # fmt: skip
    return min(dafs)


@pytest.mark.slow
@pytest.mark.parametrize("method", ["gradient", "generations"])
def test_a_program_of_one_place_becomes_the_best_constant_damper(method):
    """Not more than 5e-5 above the best of 40 that another engine finds; 0.008 are gained."""
    law = program([0.0], [7e3], bounds=BOUNDS)
    found = bc.tune(law, BEAM, CAR, ROADS[:2], SPEEDS, method=method, iterations=6, **SHORT)
    assert found.training[1].mean() < best_constant(ROADS[:2]) + 5e-5
    assert found.training[1].mean() < found.training[0].mean() - 5e-3


def test_the_result_is_what_its_strategy_does(tuned):
    x = ROADS[0].x
    for roads, dafs in ((ROADS[:2], tuned.training), (ROADS[2:], tuned.held_out)):
        z = [road.elevation for road in roads]
        for law, own in zip((lines(), tuned.strategy), dafs, strict=True):
            expected = simulate_loop(BEAM, CAR, law, SPEEDS, x, z).daf
            assert own == pytest.approx(expected, abs=1e-9)
    assert tuned.strategy.dampings.tolist() == tuned.after.tolist()
    assert np.all((tuned.after >= 1e3) & (tuned.after <= 30e3))


def test_the_best_so_far_only_falls_from_the_start_to_the_end(tuned):
    history = tuned.history
    assert len(history) <= 9
    assert np.all(np.diff(history) <= 0)
    assert history[0] == pytest.approx(tuned.training[0].mean(), abs=1e-6)
    assert history[-1] == pytest.approx(tuned.training[1].mean(), abs=1e-6)
    assert history[-1] < history[0] - 1e-4


@pytest.mark.quick_cases(1)
@pytest.mark.parametrize("method", ["generations", "gradient"])
def test_a_law_is_never_worse_than_it_was_and_others_gains_stay(method):
    law = hybrid(1e3, 30e3)
    case = law, BEAM, CAR, ROADS[:2], SPEEDS
    found = bc.tune(*case, gains=["share"], method=method, iterations=2, **SHORT)
    assert found.method == method
    assert found.names == ("share",)
    assert found.training[1].mean() < found.training[0].mean()
    assert found.strategy.gains == law.gains | {"share": found.after[0]}
    assert found.held_out.shape == (2, 2, 0)
    again = bc.tune(*case, gains=["share"], method=method, iterations=2, **SHORT)
    assert again.after.tolist() == found.after.tolist()


def test_the_class_dae_is_lowered_in_place_of_the_daf():
    found = bc.tune(
        lines(), BEAM, CAR, ROADS[:2], SPEEDS, objective="class_dae", iterations=6, **SHORT
    )
    before, after = found.class_dae["A"].mean(axis=1)
    assert found.history[[0, -1]] == pytest.approx([before, after], abs=1e-6)
    assert after < before - 1e-4
    assert "tuned for the class DAE" in str(found)


def test_tires_that_leave_the_road_are_left_to_the_closed_loop():
    """The adjoint would have them pull: differences take its place."""
    x = ROADS[0].x
    bump = bc.RoadProfile(x, 0.08 * ((x > -1.5) & (x < -0.5)))
    law = lines(2)
    found = bc.tune(law, BEAM, CAR, [bump], SPEEDS, iterations=3, **SHORT)
    loop = simulate_loop(BEAM, CAR, law, SPEEDS, x, bump.elevation)
    assert np.isfinite(loop.lift_off).any()
    assert found.history[0] == pytest.approx(loop.daf.mean(), abs=1e-9)
    assert found.history[-1] == pytest.approx(found.training[1].mean(), abs=1e-9)
    assert found.training[1].mean() <= found.training[0].mean()


@pytest.mark.parametrize(
    ("law", "options"), [(lines(), {}), (continuous_skyhook(1e3, 30e3), {"iterations": 4})]
)
def test_an_interruption_keeps_the_best_so_far(monkeypatch, request, law, options):
    # Programs that a shell started in the background ignore SIGINT.
    before = signal.signal(signal.SIGINT, signal.default_int_handler)
    request.addfinalizer(lambda: signal.signal(signal.SIGINT, before))
    steps = []

    def interrupted(self, *given):
        steps.append(0)
        if len(steps) == 2:
            signal.raise_signal(signal.SIGINT)
        return whole(self, *given)

    name = "by_adjoint" if not options else "values"
    whole = getattr(Objective, name)
    monkeypatch.setattr(Objective, name, interrupted)
    found = bc.tune(law, BEAM, CAR, ROADS[:2], SPEEDS, **SHORT, **options)
    assert found.interrupted
    assert len(found.history) <= 2
    assert found.training[1].mean() <= found.training[0].mean()
    assert "Interrupted: these are the best gains so far." in str(found)


def test_an_interruption_before_anything_is_known_is_one(monkeypatch):
    def interrupted(*_):
        raise KeyboardInterrupt

    monkeypatch.setattr(Objective, "values", interrupted)
    with pytest.raises(KeyboardInterrupt):
        bc.tune(hybrid(1e3, 30e3), BEAM, CAR, ROADS[:2], SPEEDS, **SHORT)


@pytest.mark.slow
def test_a_program_fits_few_roads_and_is_worth_as_much_elsewhere_if_it_had_many(bridge, truck):
    """Of 12 roads the mean DAF falls by 0.015, and not at all on 40 others; of 200 by 0.0017, and
    on the others by 0.0028 +- 0.0023.
    """
    roads = random_roads("A", 240, 60.0, 85.0)["A"]
    law = program(np.linspace(-20, 25, 20), [7e3] * 20, shape="lines", bounds=BOUNDS)
    few, many = (
        bc.tune(
            law, bridge, truck, roads[40 : 40 + n], np.array([70, 90, 108]) / 3.6,
            held_out=roads[:40], workers=1,
        )
        for n in (12, 200)
    )  # fmt: skip
    assert few.overfitted
    assert few.change("training").mean < -0.01
    assert few.change().mean > -0.004
    assert not many.overfitted
    assert many.change("training").high < 0
    assert many.change().high < 0


# What it tells


def with_dafs(tuned, training, held_out):
    """The tuning, with so much less DAF after it, and a wobble over the roads."""
    changes = []
    for dafs, gain in ((tuned.training, training), (tuned.held_out, held_out)):
        wobble = 1e-4 * np.arange(dafs.shape[2])
        changes.append(np.array([dafs[0], dafs[0] - gain + wobble - wobble.mean()]))
    return dataclasses.replace(tuned, training=changes[0], held_out=changes[1])


def test_roads_held_out_tell_of_gains_that_fit_the_training_roads(tuned):
    worse, better = with_dafs(tuned, 0.01, 0.004), with_dafs(tuned, 0.01, 0.006)
    assert worse.overfitted
    assert not better.overfitted
    assert not with_dafs(tuned, -0.001, -0.01).overfitted
    assert worse.change().mean == pytest.approx(-0.004)
    assert worse.change("training").mean == pytest.approx(-0.01)
    warning = "Warning: the gains fit the training roads: these gain 0.0100, roads held out 0.0040"
    assert warning in str(worse)
    assert "Warning" not in str(better)


def test_without_roads_held_out_it_says_that_nothing_is_known_of_others(tuned):
    alone = dataclasses.replace(tuned, held_out=tuned.held_out[..., :0])
    assert not alone.overfitted
    assert "No roads were held out" in str(alone)
    assert "held out" not in repr(alone)
    with pytest.raises(ValueError, match="no roads were held out: type"):
        alone.change()
    assert "held_out" not in json.loads(alone.to_json())["change"]


def test_the_text_has_every_gain_and_both_kinds_of_roads(tuned):
    text = str(tuned)
    assert max(len(line.rstrip()) for line in text.splitlines()) <= 100
    assert "2 training roads, 4 held out, at 100, 80 km/h, 2 m of approach" in text
    for name, place, after in zip(tuned.names, [-2, 1.5, 5], tuned.after, strict=True):
        row = next(line.split() for line in text.splitlines() if line.startswith(f"  {name} "))
        assert row == [name, f"{place:g}", "7000", f"{after:.5g}", "1000", "30000"]
    row = next(line.split() for line in text.splitlines() if line.startswith("  roads held out"))
    found = tuned.held_out.mean(axis=(1, 2))
    assert row[3:6] == [f"{found[0]:.4f}", f"{found[1]:.4f}", f"{tuned.change().mean:+.4f}"]
    soft = str(dataclasses.replace(tuned, softness=0.01))
    assert "its soft maximum over the speeds, of softness 0.01" in soft


def test_json_has_all_of_it(tuned):
    content = json.loads(tuned.to_json())
    assert [gain["after"] for gain in content["gains"]] == tuned.after.tolist()
    assert content["position_m"] == [-2, 1.5, 5]
    assert content["held_out_daf"] == tuned.held_out.tolist()
    assert content["change"]["held_out"]["mean"] == tuned.change().mean
    assert content["softness"] is None
    single = dataclasses.replace(tuned, training=tuned.training[..., :1], softness=0.01)
    content = json.loads(single.to_json())
    assert content["softness"] == 0.01
    assert content["change"]["training"]["low"] is None


def test_the_figure_shows_search_speeds_and_program(tuned):
    history, speeds, places = tuned.plot().axes
    assert history.lines[0].get_ydata().tolist() == tuned.history.tolist()
    before, after, *_ = (line.get_ydata() for line in speeds.lines)
    assert after == pytest.approx(tuned.training[1].mean(axis=1)[::-1])
    assert before == pytest.approx(tuned.training[0].mean(axis=1)[::-1])
    assert places.lines[1].get_ydata() == pytest.approx(1e-3 * tuned.after)
    assert places.lines[0].get_ydata() == pytest.approx([7, 7, 7])
    units = [ax.get_xlabel() + ax.get_ylabel() for ax in (history, speeds, places)]
    assert all("[" in label for label in units)


def test_of_a_law_the_figure_has_no_program(tuned):
    law = dataclasses.replace(
        tuned, strategy=hybrid(1e3, 30e3), names=("share",), method="generations",
        held_out=tuned.held_out[..., :0],
    )  # fmt: skip
    history, speeds = law.plot().axes
    assert history.get_xlabel() == "generation [-]"
    assert len(speeds.lines) == 2


# Programs with bounds


@pytest.mark.parametrize("shape", ["steps", "lines"])
def test_dampings_that_are_gains_make_the_same_program(shape):
    places, dampings = [-2.0, 1.0, 4.0], [7e3, 1e3, 20e3]
    law = program(places, [7e3] * 3, shape=shape, bounds=BOUNDS)
    assert law.bounds == {f"damping_{i}": (7e3, *BOUNDS) for i in (1, 2, 3)}
    changed = law.with_gains(**dict(zip(law.gains, dampings, strict=True)))
    assert changed.dampings.tolist() == dampings
    x, fixed = np.linspace(-3, 6, 91), program(places, dampings, shape=shape)
    assert fixed.gains == {}
    assert fixed.dampings.tolist() == dampings
    given = np.tile(np.array(dampings)[:, np.newaxis], x.size)
    rows = np.array([x if name == "position" else 0 * x for name in law.signals])
    assert law.evaluate(rows, given) == pytest.approx(fixed.command(position=x), rel=1e-12)
    assert repr(law) == "Program('program', 3 places from -2 to 4 m, c from 1000 to 30000 N s/m)"


@pytest.mark.parametrize(
    ("bounds", "error", "message"),
    [
        (1e3, TypeError, r"bounds must be the least and the largest.*type for example \(1e3, 30e3"),
        ((30e3, 1e3), ValueError, "c_min must not exceed c_max"),
        ((8e3, 30e3), ValueError, "gain damping_1 = 7000 is outside its bounds"),
    ],
)
def test_bounds_of_a_program_are_checked(bounds, error, message):
    with pytest.raises(error, match=message):
        program([0.0], [7e3], bounds=bounds)


# Mistakes


@pytest.mark.parametrize(
    ("changed", "error", "message"),
    [
        ({"damper": 7e3}, TypeError, r"type bridgectl.dampers.passive\(7e3\)"),
        ({"damper": passive(7e3)}, ValueError, "passive 7 kN s/m has no gains to tune: type"),
        ({"damper": bridgehook(BEAM, CAR, *BOUNDS)}, ValueError, "bridgehook has no gains to tune"),
        ({"damper": preset(*BOUNDS)}, ValueError, "preset chooses its gain before each crossing"),
        ({"gains": "share"}, TypeError, "gains must be a list of names, got 'share'"),
        ({"gains": 3}, TypeError, "gains must be a list of names, got 3"),
        ({"gains": ["shar"]}, ValueError, "gains must be one of 'share', .*type 'share'"),
        ({"gains": ["gain", "gain"]}, ValueError, "gains must be different names of share, gain"),
        ({"gains": []}, ValueError, "gains must be different names of share, gain"),
        ({"objective": "dae"}, ValueError, "objective must be one of 'daf', 'class_dae'"),
        ({"method": "newton"}, ValueError, "method must be one of 'generations', 'gradient'"),
        ({"softness": 0.0}, ValueError, "softness must be above 0"),
        ({"iterations": 0}, ValueError, "iterations must be 1 or more"),
        ({"workers": 0}, ValueError, "workers must be 1 or more"),
        ({"progress": 1}, TypeError, "progress must be True or False"),
        ({"roads": []}, ValueError, "roads must hold a road"),
        ({"held_out": ROADS[0]}, TypeError, "held_out must be a list of RoadProfile, got RoadProf"),
        ({"held_out": ROADS[1:2]}, ValueError, r"roads 2 .* and 3 .* are the same"),
        ({"held_out": ["road"]}, TypeError, "roads must be a list of RoadProfile"),
        ({"speeds": -1.0}, ValueError, "speeds must be above 0"),
        ({"approach": 60.0}, ValueError, "approach"),
    ],
)
def test_each_mistake_is_named(changed, error, message):
    given = {
        "damper": hybrid(1e3, 30e3), "beam": BEAM, "vehicle": CAR, "roads": ROADS[:2],
        "speeds": SPEEDS, **SHORT,
    }  # fmt: skip
    with pytest.raises(error, match=message):
        bc.tune(**given | changed)


def test_gains_that_differ_between_legs_are_no_ones_to_tune():
    truck = bc.trucks.load("T2")
    law = clipped_lqr(truck, *BOUNDS)
    names = tuning._names(law, fitted_everywhere(law, truck), None)
    assert "dead_band" in names
    assert "travel_gain_1" not in names
    with pytest.raises(ValueError, match="gains: 'travel_gain_1' differs between the legs"):
        tuning._names(law, fitted_everywhere(law, truck), ["travel_gain_1"])
    whole = skyhook(*BOUNDS)
    assert tuning._names(whole, fitted_everywhere(whole, truck), None) == ("dead_band",)


def test_a_rough_class_without_a_surface_has_no_class_dae():
    roads = [bc.iso8608_profile("F", 11, seed=1, start=-2)]
    with pytest.raises(ValueError, match="objective 'class_dae' needs roads of a class whose"):
        bc.tune(lines(), BEAM, CAR, roads, SPEEDS, objective="class_dae", **SHORT)
