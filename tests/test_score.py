"""Scores of strategies: each number against what it is made of, and what is kept of the work."""

import dataclasses
import json
import math

import numpy as np
import pytest
from helpers import NO_DAMPERS, without_dampers
from scipy import stats

import bridgectl as bc
from bridgectl import dampers
from bridgectl.dampers import Damper, simulate_loop
from bridgectl.measures import aggregate_fourth_power, weighted_rms
from bridgectl.measures.history import rms
from bridgectl.road import iso8608_elevations
from bridgectl.scoring import run as scoring
from bridgectl.scoring.agreement import paired, rank_correlation
from bridgectl.scoring.rows import MEASURES

SPEEDS = np.array([30.0, 20.0])
STRATEGIES = (dampers.passive(7e3), dampers.skyhook(1e3, 30e3), dampers.add(1e3, 30e3))


@pytest.fixture(scope="module")
def roads():
    x, elevations = -5 + 0.1 * np.arange(321), iso8608_elevations(3, "B", 32, seed=4)
    return [bc.RoadProfile(x, z, name=f"B {i}") for i, z in enumerate(elevations)]


def scored(roads, strategies=STRATEGIES, **options):
    options = {"approach": 5.0, "departure": 2.0, "workers": 1, **options}
    return bc.score(strategies, bc.li2006.beam(), bc.li2006.car(), roads, SPEEDS, **options)


@pytest.fixture(scope="module")
def board(roads):
    return scored(roads)


def test_daf_and_dae_are_those_of_the_strategy_alone(bridge, truck, roads, board):
    x = roads[0].x[:301]
    for i, law in enumerate(STRATEGIES):
        # A constant damper has an exact surface.
        damper = None if law.c_min == law.c_max else law
        surface = bc.ramp_surface(bridge, truck, SPEEDS, approach=5, damper=damper)
        elevations = np.array([road.elevation[:301] for road in roads])
        loop = simulate_loop(bridge, truck, law, SPEEDS, x, elevations)
        assert board.values["daf"][i] == pytest.approx(loop.daf.T, abs=1e-6)
        assert board.values["dae"][i] == pytest.approx(surface.dae(elevations), abs=1e-9)
        assert board.daf_smooth[i] == pytest.approx(surface.daf_smooth, abs=1e-5)


def test_every_measure_is_that_of_the_recorded_histories(bridge, truck, roads, board):
    law, road = STRATEGIES[1], roads[2]
    x, z = road.x, road.elevation
    loop = simulate_loop(bridge, truck, law, SPEEDS, x, z, record=scoring.RECORDED)
    load = truck.linear.static_loads[0]
    for j, history in enumerate(loop.histories):
        force, ride = history["tire_force"][0], history["body_acceleration"][0]
        expected = {
            "dynamic_load_coefficient": np.std(force) / load,
            "tire_force_95": np.percentile(force, 95) / load,
            "road_stress": np.mean((force / load) ** 4),
            "least_force": loop.least_force[j, 0],
            "body_acceleration": rms(ride),
            "weighted_acceleration": weighted_rms(ride, 2e-3),
            "suspension_travel": np.abs(history["suspension_travel"]).max(),
            "switching_rate": loop.switches[j, 0] / (32 / SPEEDS[j]),
        }
        for name, value in expected.items():
            assert board.values[name][1, 2, j] == pytest.approx(value, rel=1e-6), name
    assert set(expected) | {"daf", "dae", "dae_2"} == set(MEASURES)
    places = [
        aggregate_fourth_power(
            h["tire_force"][0], load, -5 + c * 2e-3 * np.arange(h["tire_force"].shape[1])
        ).values
        for c, h in zip(SPEEDS, loop.histories, strict=True)
    ]
    shortest = min(len(p) for p in places)
    mean = np.mean([p[:shortest] for p in places], axis=0)
    assert board.fourth_power_95[1, 2] == pytest.approx(np.percentile(mean, 95), rel=1e-6)


@pytest.mark.slow
def test_the_damper_counts_and_not_the_strategy_alone(roads, board):
    law = STRATEGIES[1]
    slow = scored(roads, [Damper(law, lag=0.05), Damper(law.renamed("limited"), max_force=300.0)])
    for values in slow.values["daf"]:
        assert not np.allclose(values, board.values["daf"][1], atol=1e-4)


@pytest.mark.slow
def test_the_force_limit_of_a_constant_damper_counts(roads, board):
    constant = scored(roads, [Damper(STRATEGIES[0], max_force=300.0)])
    assert not np.allclose(constant.values["daf"], board.values["daf"][0], atol=1e-4)
    # Unit ramps are too low for the limit: the DAE does not know of it.
    assert constant.values["dae"][0] == pytest.approx(board.values["dae"][0], abs=1e-4)


@pytest.mark.slow
def test_several_processes_and_a_resumed_run_find_the_same_to_the_bit(roads, board, tmp_path):
    file = tmp_path / "score.jsonl"
    scored(roads, STRATEGIES[:1], resume=file)
    for again in (scored(roads, workers=2, resume=file), scored(roads, workers=1, resume=file)):
        for name in MEASURES:
            assert np.array_equal(again.values[name], board.values[name]), name
        assert np.array_equal(again.daf_smooth, board.daf_smooth)
        assert np.array_equal(again.fourth_power_95, board.fourth_power_95)


def test_an_edited_number_of_a_kept_part_is_told_and_not_used(roads, board, tmp_path):
    file = tmp_path / "score.jsonl"
    scored(roads, STRATEGIES[:1], resume=file)
    file.write_text(file.read_text().replace('"daf": [[', '"daf": [[-'))
    with pytest.warns(UserWarning, match=f"line 2 of {file} is damaged and not used") as told:
        again = scored(roads, STRATEGIES[:1], resume=file)
    assert [warning.filename for warning in told] == [__file__]
    assert np.array_equal(again.values["daf"], board.values["daf"][:1])


def test_differences_are_paired_over_roads(board):
    found = board.difference("skyhook")
    per_road = board.values["daf"].mean(axis=2)
    test = stats.ttest_rel(per_road[1], per_road[0])
    assert found.mean == pytest.approx(np.mean(per_road[1] - per_road[0]), abs=1e-12)
    interval = test.confidence_interval()
    assert (found.low, found.high) == pytest.approx((interval.low, interval.high), abs=1e-12)
    assert found.clear == (test.pvalue < 0.05)
    other = board.difference("ADD", "body_acceleration", baseline="skyhook")
    ride = board.values["body_acceleration"].mean()
    assert abs(other.mean) < ride


def test_one_road_has_no_confidence_interval():
    one = paired(np.array([0.1]))
    assert one.mean == 0.1
    assert math.isnan(one.low)
    assert not one.clear


def test_the_rank_correlation_is_1_for_the_same_order_and_nan_without_order():
    first = np.array([1.0, 3.0, 2.0])
    assert rank_correlation(first, first**3) == pytest.approx(1)
    assert rank_correlation(first, -first) == pytest.approx(-1)
    assert math.isnan(rank_correlation(first, np.ones(3)))


def test_the_summary_is_ranked_by_mean_daf_and_tells_the_worst_speed(board):
    rows = board.rows()
    assert [row.daf for row in rows] == sorted(row.daf for row in rows)
    by_name = {row.strategy: row for row in rows}
    for i, name in enumerate(board.strategies):
        means = board.values["daf"][i].mean(axis=0)
        row = by_name[name]
        assert row.worst_daf == pytest.approx(means.max())
        assert row.worst_speed == SPEEDS[means.argmax()]
        error = board.values["dae"][i] - board.values["daf"][i]
        assert row.dae_error == pytest.approx(np.sqrt(np.mean(error**2)))
    assert by_name["passive 7 kN s/m"].daf_difference.mean == 0


def test_pandas_and_json_have_every_number(board):
    table = board.to_pandas()
    assert table.shape == (3 * 3 * 2, len(MEASURES))
    assert table.loc[("skyhook", "B 1", 20.0), "daf"] == board.values["daf"][1, 1, 1]
    content = json.loads(board.to_json())
    assert content["values"]["dae"] == board.values["dae"].tolist()
    assert content["damping_N_s_per_m"] == [7e3, None, None]
    assert repr(board) == "Scoreboard(3 strategies, 3 roads, 2 speeds from 72 to 108 km/h)"


# What is kept


@pytest.mark.slow
def test_an_interrupted_run_goes_on_where_it_stopped(roads, board, tmp_path, monkeypatch):
    file, whole, done = tmp_path / "score.jsonl", scoring._part, []

    def interrupted(study, damper, first):
        if len(done) == 7:  # roads of each strategy, then unit ramps and a class of each
            raise KeyboardInterrupt
        done.append(damper.name)
        return whole(study, damper, first)

    monkeypatch.setattr(scoring, "_part", interrupted)
    with pytest.raises(KeyboardInterrupt):
        scored(roads, resume=file)
    with file.open("a") as handle:
        handle.write('{"part": "ADD, ro')  # cut short while it was written
    done.clear()
    found = scored(roads, resume=file)
    assert done == ["ADD", "ADD"]
    for name in MEASURES:
        assert np.array_equal(found.values[name], board.values[name])
    assert scored(roads, resume=file).values["daf"].shape == (3, 3, 2)
    assert done == ["ADD", "ADD"]


@pytest.mark.slow
def test_a_file_serves_more_strategies_and_changed_ones_are_done_again(roads, tmp_path):
    file = tmp_path / "score.jsonl"
    scored(roads, STRATEGIES[:1], resume=file)
    softer = dampers.skyhook(1e3, 20e3)
    for law in (STRATEGIES[1], softer, Damper(softer, lag=0.02)):
        found = scored(roads, [STRATEGIES[0], law], resume=file)
        fresh = scored(roads, [STRATEGIES[0], law])
        assert np.array_equal(found.values["daf"], fresh.values["daf"])


@pytest.mark.slow
def test_a_strategy_that_chooses_its_gains_otherwise_is_done_again(roads, tmp_path):
    file = tmp_path / "score.jsonl"
    for n_dampings in (2, 5):
        law = dampers.preset(1e3, 30e3, n_dampings=n_dampings)
        found = scored(roads[:1], [law], resume=file)
        assert np.array_equal(found.values["daf"], scored(roads[:1], [law]).values["daf"])


def test_a_vehicle_that_differs_in_the_last_digits_is_another_study(roads, tmp_path):
    file = tmp_path / "score.jsonl"
    scored(roads[:1], STRATEGIES[:1], resume=file)
    heavier = dataclasses.replace(bc.li2006.car(), sprung_mass=9000.0001)
    with pytest.raises(ValueError, match="another study: its vehicle is"):
        bc.score(
            STRATEGIES[:1], bc.li2006.beam(), heavier, roads[:1], SPEEDS, approach=5.0,
            departure=2.0, workers=1, resume=file,
        )  # fmt: skip


@pytest.mark.slow
def test_other_roads_of_a_file_are_done_again(roads, tmp_path):
    file = tmp_path / "score.jsonl"
    scored(roads[:1], STRATEGIES[:1], resume=file)
    found = scored(roads[1:2], STRATEGIES[:1], resume=file)
    assert np.array_equal(found.values["daf"], scored(roads[1:2], STRATEGIES[:1]).values["daf"])


@pytest.mark.slow
def test_many_roads_are_scored_in_parts(roads, board, monkeypatch):
    monkeypatch.setattr("bridgectl.scoring.study.ROADS_AT_ONCE", 2)
    found = scored(roads, STRATEGIES[:2])
    assert found.values["daf"] == pytest.approx(board.values["daf"][:2], abs=1e-12)
    assert found.fourth_power_95 == pytest.approx(board.fourth_power_95[:2], abs=1e-9)


@pytest.mark.parametrize(
    ("content", "message"),
    [
        (b"x,z\n0,0\n", "is no file of a score"),
        (b'{"format": "other"}\n', "is no file of a score"),
        (b"[1]\n", "is no file of a score"),
        (b"\xff\xfe\n", "is no file of a score"),
        (b'{"format": "bridgectl score", "version": 99}\n', "another study: its version is 99"),
    ],
)
def test_a_file_of_something_else_is_left_alone(roads, tmp_path, content, message):
    file = tmp_path / "score.jsonl"
    file.write_bytes(content)
    with pytest.raises(ValueError, match=message):
        scored(roads, resume=file)
    assert file.read_bytes() == content


def test_a_file_of_another_study_is_refused_with_what_differs(roads, tmp_path):
    file = tmp_path / "score.jsonl"
    scored(roads[:1], STRATEGIES[:1], resume=file)
    with pytest.raises(ValueError, match=r"another study: its stations is \[-5.* type the name"):
        scored(roads[:1], STRATEGIES[:1], resume=file, approach=4.0)


@pytest.mark.parametrize(
    ("change", "error", "message"),
    [
        ({"dampers": []}, ValueError, "dampers must hold a strategy, got none"),
        ({"dampers": STRATEGIES[0]}, TypeError, "dampers must be a list of strategies"),
        ({"dampers": ["skyhook"]}, TypeError, "strategy must be a Strategy"),
        ({"dampers": [*STRATEGIES, STRATEGIES[1]]}, ValueError, "got 'skyhook' twice: type"),
        ({"roads": []}, ValueError, "roads must hold a road, got none"),
        ({"roads": ["road.csv"]}, TypeError, "roads must be a list of RoadProfile"),
        ({"roads": bc.RoadProfile([-10, 40], [0, 0])}, TypeError, "roads must be a list"),
        (
            {"roads": [bc.RoadProfile([0, 40], [0, 0])]},
            ValueError,
            "of road 1, needs -5 m",
        ),
        ({"approach": -1}, ValueError, "approach must be 0 or more"),
        ({"departure": -1}, ValueError, "departure must be 0 or more"),
        ({"speeds": []}, ValueError, "speeds"),
        ({"workers": 0}, ValueError, "workers must be 1 or more"),
        ({"section": 2}, ValueError, "section must lie between 0 and 1"),
        ({"vehicle": without_dampers()}, ValueError, NO_DAMPERS),
    ],
)
def test_each_mistake_is_named(roads, change, error, message):
    arguments = {
        "dampers": STRATEGIES, "beam": bc.li2006.beam(), "vehicle": bc.li2006.car(),
        "roads": roads, "speeds": SPEEDS, "approach": 5.0, "workers": 1, **change,
    }  # fmt: skip
    with pytest.raises(error, match=message):
        bc.score(**arguments)


def test_unknown_names_are_told_with_the_known_ones(board):
    with pytest.raises(ValueError, match=r"strategy must be one of .*skyhook"):
        board.difference("skyhok")
    with pytest.raises(ValueError, match="measure must be one of"):
        board.difference("skyhook", "DAF")


def test_the_vehicles_own_damper_does_not_count(roads, board):
    other = dataclasses.replace(bc.li2006.car(), damping=1e3)
    found = bc.score(STRATEGIES[:1], bc.li2006.beam(), other, roads, SPEEDS, approach=5.0,
                     departure=2.0, workers=1)  # fmt: skip
    assert np.array_equal(found.values["daf"], board.values["daf"][:1])
