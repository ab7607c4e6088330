"""`bridgectl.assess`: random trucks on a bridge, share by share."""

import os
import signal
import subprocess
import sys
import time
from functools import partial

import numpy as np
import pytest

import bridgectl as bc
from bridgectl.dampers import skyhook
from bridgectl.fleet import study as studies

SPEEDS = {"min": 15, "max": 30}


@pytest.fixture(scope="module")
def fleet():
    return bc.Fleet(
        {"T2A01": 1, "T5air": 2}, speed=SPEEDS, load={"min": 0.5, "max": 1.1},
        suspension={"median": 1, "log_sd": 0.2}, seed=1,
    )  # fmt: skip


@pytest.fixture(scope="module")
def roads():
    return {
        quality: [
            bc.RoadProfile(road.x, factor * road.elevation, name=f"{quality}{k}")
            for k in range(3)
            for road in [bc.iso8608_profile("A", 66, seed=k, start=-40)]
        ]
        for quality, factor in (("good", 0.2), ("worse", 0.5))
    }


@pytest.fixture(autouse=True)
def small_shares(monkeypatch):
    monkeypatch.setattr(studies, "SHARE", 7)
    monkeypatch.setattr(studies, "DAMPED_SHARE", 3)


def assess(bridge, fleet, roads, n=16, **options):
    given = {"n": n, "approach": 40, "workers": 1, "progress": False, "trucks_a_day": 1000}
    return bc.assess(bridge, fleet, roads, **(given | options))


def same(one, other) -> bool:
    """Whether two assessments hold the same columns to the bit."""
    frames = one.to_pandas(), other.to_pandas()
    return frames[0].equals(frames[1])


def test_each_row_is_the_crossing_alone(bridge, fleet, roads):
    found = assess(bridge, fleet, roads, effects={"middle": "moment", "quarter": bc.Moment(6.0)})
    table = found.to_pandas()
    assert len(table) == 2 * 16
    for row in table[::5].to_dict("records"):
        truck = fleet.passing(row["truck"])
        road = next(each for each in roads[row["quality"]] if each.name == row["road"])
        daf = bc.daf(bridge, truck.vehicle, truck.speed, road, start=-40,
                     effect=["moment", bc.Moment(6.0)])[:, 0]  # fmt: skip
        assert [row["daf middle"], row["daf quarter"]] == pytest.approx(daf, abs=1e-6)
        static = bc.Crossing(bridge, truck.vehicle, bc.Moment(6.0)).static_peak
        assert row["static quarter"] == pytest.approx(static, rel=1e-12)
        assert row["total quarter"] == pytest.approx(static * row["daf quarter"], rel=1e-12)
        assert (row["speed"], row["kind"]) == (truck.speed, truck.kind)
        assert row["gross_weight"] == pytest.approx(9.81 * truck.vehicle.mass)
        assert row["time middle"] == pytest.approx(row["place middle"] / truck.speed)


def test_the_same_trucks_cross_on_each_quality_and_every_road_is_used(bridge, fleet, roads):
    table = assess(bridge, fleet, roads, n=30).to_pandas()
    by_quality = [table[table.quality == each] for each in ("good", "worse")]
    for name in ("truck", "speed", "gross_weight"):
        assert by_quality[0][name].tolist() == by_quality[1][name].tolist()
    assert set(table.road) == {f"{quality}{k}" for quality in ("good", "worse") for k in range(3)}
    assert by_quality[0]["daf moment"].mean() < by_quality[1]["daf moment"].mean()


@pytest.mark.slow
@pytest.mark.parametrize("options", [{"workers": 2}, {"workers": 1}])
def test_workers_and_resumption_change_no_bit(bridge, fleet, roads, tmp_path, options):
    whole = assess(bridge, fleet, roads)
    file = tmp_path / "done.jsonl"
    assess(bridge, fleet, roads, n=7, resume=file, **options)
    assert same(assess(bridge, fleet, roads, resume=file, **options), whole)
    assert same(assess(bridge, fleet, roads, resume=file, **options), whole)


@pytest.mark.slow
def test_shares_of_another_size_change_no_bit(bridge, fleet, roads, monkeypatch):
    whole = assess(bridge, fleet, roads)
    monkeypatch.setattr(studies, "SHARE", 500)
    assert same(assess(bridge, fleet, roads), whole)


def test_a_file_of_another_study_is_refused(bridge, fleet, roads, tmp_path):
    file = tmp_path / "done.jsonl"
    assess(bridge, fleet, roads, n=7, resume=file)
    other = bc.Fleet({"T2A01": 1, "T5air": 2}, speed=SPEEDS, load={"min": 0.5, "max": 1.2}, seed=1)
    with pytest.raises(ValueError, match="holds another study: its fleet is"):
        assess(bridge, other, roads, n=7, resume=file)
    with pytest.raises(ValueError, match="its roads is"):
        assess(bridge, fleet, roads["good"], n=7, resume=file)
    with pytest.raises(ValueError, match="its effects is"):
        assess(bridge, fleet, roads, n=7, resume=file, effects=bc.Moment(6.0))


def test_shares_carry_their_own_trucks_and_roads_alone(bridge, roads):
    weighed = bc.Fleet.from_table("example")
    many = {f"{k}": roads["good"][0] for k in range(1)} | {"good": roads["good"]}
    study = studies.Study(
        bridge, weighed, weighed.kinds, {q: dict(enumerate(r if isinstance(r, list) else [r]))
                                         for q, r in many.items()},
        (bc.Moment(12.5),), 40.0, 0, None, 0.0, 5.0, 1.0,
    )  # fmt: skip
    share = study.share(range(2, 4))
    assert len(share.study.fleet) == 4  # two, and those that they may meet
    assert share.study.fleet.passing(0).speed == weighed.passing(2).speed
    assert len(share.study.roads["good"]) <= 2


def test_the_ratio_of_one_truck_on_a_level_road_is_its_daf(bridge):
    fleet = bc.Fleet({"T5air": 1}, speed=25.0)
    found = assess(bridge, fleet, None, n=60)
    daf = bc.daf(bridge, bc.trucks.load("T5air"), 25.0, start=-40)[0]
    assert found.adr(75) == pytest.approx((daf,) * 3, abs=1e-6)


@pytest.mark.slow
def test_dampers_are_in_a_share_of_the_trucks_which_cross_without_them_too(bridge, roads):
    fleet = bc.Fleet({"li2006": 1}, speed=SPEEDS, load={"min": 0.8, "max": 1.1}, seed=2)
    law = skyhook(3e3, 20e3)
    found = assess(bridge, fleet, roads["worse"], n=10, damper=law, damper_share=0.3)
    damped = found.to_pandas().query("damped")
    assert 1 <= len(damped) < 10
    for row in damped.to_dict("records"):
        truck = fleet.passing(row["truck"])
        road = next(each for each in roads["worse"] if each.name == row["road"])
        daf = bc.daf(bridge, truck.vehicle, truck.speed, road, start=-40, damper=law)[0]
        assert row["daf moment"] == daf
        assert np.isnan(row["least_tire_force"])
    of_each = assess(bridge, fleet, roads["worse"], n=10, damper=partial(of_truck, law),
                     damper_share=0.3)  # fmt: skip
    assert same(of_each, found)
    assert found.damper_influence(len(damped) / 10)[""].value != 0


def of_truck(law, bridge, truck):
    """A damper for a truck, by a function of a module."""
    assert truck.damper_map.shape[0] == 1
    return law


@pytest.mark.slow
def test_trucks_meet_as_often_as_they_come_while_one_is_there(bridge):
    fleet = bc.Fleet({"T2A01": 1}, speed=20.0)
    rate = 600.0
    alone = assess(bridge, fleet, None, n=60)
    found = assess(bridge, fleet, None, n=60, meeting_rate=rate, lane_factor=0.5)
    meeting = found.columns["meeting"]
    chance = 1 - np.exp(-rate / 3600 * 2 * (25 + 4) / 20)
    assert abs(meeting.mean() - chance) < 4 * np.sqrt(chance * (1 - chance) / 60)
    totals = [each.columns["total moment"] for each in (alone, found)]
    statics = [each.columns["static moment"] for each in (alone, found)]
    assert np.array_equal(totals[0][~meeting], totals[1][~meeting])
    assert (statics[1][meeting] >= statics[0][meeting] * (1 - 1e-9)).all()
    assert (statics[1][meeting] <= 1.5 * statics[0][meeting]).all()
    assert statics[1][meeting].max() > 1.2 * statics[0].max()


@pytest.mark.slow
@pytest.mark.filterwarnings("ignore:start = ")
def test_a_meeting_is_the_convoy_of_the_two(bridge, roads):
    fleet = bc.Fleet({"T2A01": 1}, speed=SPEEDS, seed=3)
    long = bc.iso8608_profile("A", 140, seed=1, start=-40)
    found = assess(bridge, fleet, long, n=8, meeting_rate=5e3)
    study = studies.Study(
        bridge, fleet, fleet.kinds, {"": {0: long}}, (bc.Moment(12.5),), 40.0, 0, None, 0.0, 5e3,
        1.0,
    )  # fmt: skip
    assert found.columns["meeting"].all()
    draws = studies.Draws.of(0, range(8))
    for i in (0, 5):
        own, other = fleet.passing(i), fleet.passing(int(study.partners(range(8), draws)[i]))
        mine, theirs = ((25 + 4) / each.speed for each in (own, other))
        later = draws.when[i] * (mine + theirs) - theirs
        first, second = (own, other) if later > 0 else (other, own)
        both = bc.convoy(
            [first.vehicle, second.vehicle], [0, abs(later) * second.speed],
            opposite=[first is other, second is other], motions=[first.speed, second.speed],
        )  # fmt: skip
        behind = abs(later) * second.speed
        start = -min(40, (40 - behind) * first.speed / second.speed)
        daf = bc.daf(bridge, both, first.speed, long, start=start)[0]
        assert found.columns["daf moment"][i] == pytest.approx(daf, abs=1e-9)


@pytest.mark.parametrize(
    ("options", "error"),
    [
        ({"fleet": "T2"}, 'fleet must be a bridgectl.Fleet, got str: type .*load\\("'),
        ({"n": None}, "n must be given for a fleet without end: type n=1000"),
        ({"n": 0}, "n must be 1 or more, got 0"),
        ({"roads": []}, "roads must hold a road of each quality"),
        ({"roads": {}}, "roads must hold a road, got none: type None for a smooth one"),
        ({"roads": {1: None}}, "roads must have names of qualities for keys, got 1"),
        ({"roads": "A"}, "roads must be RoadProfile, a list of them, or such by the name"),
        ({"approach": 50}, "road 1 of good, .*-50 m"),
        ({"effects": []}, "effects must be one effect or more, got none"),
        ({"effects": ["moment", "moment"]}, "effects must differ, got moment twice"),
        ({"effects": bc.BodyAcceleration()}, "effect must have a static peak for a factor"),
        ({"damper_share": 20}, "damper_share must be at most 1, got 20: type 0.2"),
        ({"meeting_rate": 1.0, "lane_factor": 0.0}, "lane_factor must be above 0"),
        ({"damper": skyhook(1e3, 9e3), "meeting_rate": 1.0}, "damper and meeting_rate exclude"),
        ({"trucks_a_day": 0}, "trucks_a_day must be above 0"),
        ({"meeting_rate": 5.0}, "road 1 of good, .*65 m"),
        ({"n": 10**9}, "n = 1e\\+09; n = .* would do"),
    ],
)  # fmt: skip
def test_what_is_no_study_is_refused_with_what_to_type(bridge, fleet, roads, options, error):
    given = {"fleet": fleet, "roads": roads} | options
    with pytest.raises((TypeError, ValueError), match=error):
        assess(bridge, given.pop("fleet"), given.pop("roads"), **given)


def test_more_trucks_than_were_weighed_are_refused(bridge, roads):
    weighed = bc.Fleet.from_table("example")
    with pytest.raises(ValueError, match=f"n must be at most {len(weighed)}"):
        assess(bridge, weighed, roads, n=len(weighed) + 1)


def test_a_meeting_that_begins_before_the_road_says_how_long_it_must_be(bridge, roads):
    fleet = bc.Fleet({"T5air": 1}, speed={"min": 10, "max": 40}, seed=1)
    road = bc.iso8608_profile("A", 30, seed=1, start=-2)
    with pytest.raises(ValueError, match=r"approach must be .* m or more for truck"):
        assess(bridge, fleet, road, n=20, approach=2, meeting_rate=1e5)


def test_tires_that_leave_the_road_are_told_once(bridge):
    fleet = bc.Fleet({"T2": 1}, speed=SPEEDS, load=0.4)
    road = bc.iso8608_profile("C", 66, seed=1, start=-40)
    with pytest.warns(bc.LiftOffWarning, match=r"in \d of 4 crossings") as told:
        assess(bridge, fleet, road, n=4)
    assert len(told) == 1


STUDY = """
import sys
import bridgectl as bc
from bridgectl.fleet import study
study.SHARE = 10
fleet = bc.Fleet({"T2A01": 1}, speed={"min": 15, "max": 30}, load={"min": 0.5, "max": 1.1}, seed=5)
roads = [bc.iso8608_profile("A", 66, seed=k, start=-40) for k in range(4)]
roads = [bc.RoadProfile(road.x, 0.3 * road.elevation) for road in roads]
found = bc.assess(bc.li2006.beam(), fleet, roads, n=400, approach=40, workers=2,
                  resume=sys.argv[1], progress=False)
found.to_csv(sys.argv[2])
"""


@pytest.mark.slow
@pytest.mark.skipif(sys.platform == "win32", reason="processes are killed as POSIX has it")
def test_a_study_killed_20_times_ends_as_if_it_never_was(tmp_path):
    def start(name):
        command = [sys.executable, "-c", STUDY, str(tmp_path / f"{name}.jsonl"),
                   str(tmp_path / f"{name}.csv")]  # fmt: skip
        return subprocess.Popen(command, start_new_session=True)

    assert start("whole").wait() == 0
    kills = 0
    rng = np.random.default_rng(1)
    while kills < 20:
        process = start("killed")
        time.sleep(rng.uniform(1.2, 2.0))
        if process.poll() is None:
            kills += 1
            os.killpg(process.pid, signal.SIGKILL)
        process.wait()
        (tmp_path / "killed.csv").unlink(missing_ok=True)
    assert start("killed").wait() == 0
    one, other = ((tmp_path / f"{name}.csv").read_bytes() for name in ("whole", "killed"))
    assert one == other


@pytest.mark.slow
def test_on_dask_every_bit_is_the_same(bridge, fleet, roads):
    whole = assess(bridge, fleet, roads)
    assert same(assess(bridge, fleet, roads, workers=2, scheduler="local"), whole)
