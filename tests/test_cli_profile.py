"""`bridgectl profile`, and road files of every format and track on the command line."""

import json
from importlib.resources import files
from pathlib import Path

import numpy as np
import pytest
from helpers import run_command

import bridgectl as bc

SHARED = Path(__file__).parents[2] / "shared" / "profiles"
UTIA = files("bridgectl.road").joinpath("data/utia_profile_1.txt")


@pytest.fixture
def two_tracks(tmp_path):
    """An ERD file of a class A and a class D road, 300 m each."""
    roads = [
        bc.RoadProfile(0.1 * np.arange(3001), road.elevation, name=name)
        for name, road in (
            ("left", bc.iso8608_profile("A", 300, seed=1)),
            ("right", bc.iso8608_profile("D", 300, seed=2)),
        )
    ]
    path = tmp_path / "survey.erd"
    bc.write_profile(path, roads)
    return path


def test_the_measured_road_has_its_published_iri_and_is_good(capsys):
    status, out, err = run_command(capsys, "profile", "--full")
    assert (status, err) == (0, "")
    assert out.startswith(
        "UTIA road is good: its IRI is 3.34 m/km, and good roads stay below 7; ISO 8608 class"
    )
    assert "The roughest 100 m begin at 778 m: 4.09 m/km." in out
    row = next(line for line in out.splitlines() if line.startswith("  UTIA road "))
    assert row.split()[2:7] == ["478", "1022", "0.25", "3.335", "good"]
    rows = [line.split() for line in out[out.index("of each 100 m") :].splitlines()]
    assert [row[2] for row in rows if len(row) == 3 and row[0].isdecimal()] == [
        "3.298", "2.442", "3.555", "4.086", "2.708",
    ]  # fmt: skip


def test_every_track_is_measured_and_a_rough_one_is_not_good(capsys, two_tracks):
    status, out, err = run_command(capsys, "profile", two_tracks, "--json")
    assert (status, err) == (0, "")
    left, right = json.loads(out)["tracks"]
    assert (left["name"], right["name"]) == ("survey left", "survey right")
    assert (left["good"], right["good"]) == (True, False)
    assert (left["iso_class"], right["iso_class"]) == ("A", "D")
    assert len(left["segment_iri_m_per_km"]) == 3
    assert left["roughness_m3"] == pytest.approx(16e-6, rel=0.3)


def test_the_text_has_a_column_for_each_track(capsys, two_tracks):
    status, out, _ = run_command(capsys, "profile", two_tracks, "--segment", "50", "--full")
    assert status == 0
    assert out.startswith(
        "1 of 2 tracks is good (an IRI below 7 m/km); the roughest is survey right"
    )
    assert "IRI [m/km] of each 50 m" in out
    assert "not good" in out
    lines = [line.rstrip() for line in out.splitlines()]
    assert lines.pop() == f"What it does to a bridge: bridgectl dae {two_tracks}"
    assert max(map(len, lines)) <= 100


def test_one_track_may_be_chosen_by_label_or_number(capsys, two_tracks):
    by_label = run_command(capsys, "profile", two_tracks, "--track", "RIGHT", "--json")
    by_number = run_command(capsys, "profile", two_tracks, "--track", "1", "--json")
    assert by_label == by_number
    assert [track["name"] for track in json.loads(by_label[1])["tracks"]] == ["survey right"]


def test_dae_takes_any_format_and_track(capsys, two_tracks):
    quick = ["--approach", "10", "--speeds", "90", "--json"]
    left = run_command(capsys, "dae", two_tracks, *quick)
    right = run_command(capsys, "dae", two_tracks, *quick, "--track", "right")
    assert (left[0], right[0]) == (0, 0)
    assert json.loads(left[1])["road"]["name"] == "survey left"
    assert json.loads(right[1])["critical_daf"] > json.loads(left[1])["critical_daf"]


def test_stations_may_be_left_out_with_a_step(capsys, tmp_path):
    path = tmp_path / "levels.csv"
    path.write_text("\n".join(str(i % 7) for i in range(400)), encoding="utf-8")
    status, out, err = run_command(capsys, "profile", path, "--step", "0.25", "--units", "mm")
    assert (status, err) == (0, "")
    row = next(line.split() for line in out.splitlines() if line.startswith(" levels "))
    assert row[1:4] == ["0", "99.75", "0.25"]


def test_uneven_stations_are_interpolated_and_that_is_said(capsys, tmp_path):
    rng = np.random.default_rng(0)
    x = np.cumsum(rng.uniform(0.2, 0.4, 500))
    path = tmp_path / "uneven.csv"
    rows = [f"{a:.4f},{2 * np.sin(a):.4f}" for a in x]
    path.write_text("x [m],z [mm]\n" + "\n".join(rows), encoding="utf-8")
    status, out, err = run_command(capsys, "profile", path)
    assert status == 0
    assert "uneven" in out
    assert err.startswith("bridgectl: warning: uneven: the stations are unevenly spaced: measured")
    assert "every 0.25 m" in err


def test_a_road_too_short_for_a_segment_or_a_line_is_measured_as_far_as_it_goes(capsys, tmp_path):
    path = tmp_path / "short.csv"
    rows = [f"{0.25 * i},{i % 3}" for i in range(13)]
    path.write_text("x [m],z [mm]\n" + "\n".join(rows), encoding="utf-8")
    status, out, err = run_command(capsys, "profile", path, "--json")
    assert status == 0
    assert "an IRI over 3 m says little" in err
    track = json.loads(out)["tracks"][0]
    assert (track["segment_iri_m_per_km"], track["iso_class"]) == ([], None)
    status, out, _ = run_command(capsys, "profile", path)
    assert "of each" not in out


def test_the_figure_is_drawn(capsys, two_tracks, tmp_path):
    picture = tmp_path / "survey.png"
    status, out, _ = run_command(capsys, "profile", two_tracks, "--plot", picture)
    assert status == 0
    assert out.rstrip().endswith(f"Drawn: {picture}")
    assert picture.stat().st_size > 40_000


@pytest.mark.parametrize(
    ("options", "message"),
    [
        (["--track", "middle"], "no track 'middle', there are 0: 'left', 1: 'right'"),
        (["--segment", "0"], "segment must be above 0"),
        (["--columns", "a"], "--columns must be numbers separated by commas"),
        (["--step", "0.1"], "states this itself: leave out step"),
        (["--units", "m,furlong"], "unknown unit 'furlong'"),
        (["--plot", "survey.gif"], "--plot must end in .png, .pdf or .svg"),
    ],
)
def test_a_mistake_is_told_in_one_line(capsys, two_tracks, options, message):
    status, out, err = run_command(capsys, "profile", two_tracks, *options)
    assert (status, out) == (2, "")
    assert len(err.splitlines()) == 1
    assert message in err


@pytest.mark.skipif(not SHARED.is_dir(), reason="the shared reference files are not here")
def test_the_shared_erd_file_has_the_iri_that_its_header_states(capsys):
    status, out, _ = run_command(capsys, "profile", SHARED / "txdot_track_run_e1.erd", "--json")
    assert status == 0
    iri = [63.36 * track["iri_m_per_km"] for track in json.loads(out)["tracks"]]
    assert iri == pytest.approx([183.22, 162.95], abs=0.02)


@pytest.mark.parametrize(("unit", "warned"), [("m", False), ("mm", True)])
def test_a_road_in_metres_read_as_millimetres_is_told_of(capsys, tmp_path, unit, warned):
    road, path = bc.iso8608_profile("D", 200, step=0.25, seed=1), tmp_path / "road.csv"
    rows = zip(road.x, road.elevation, strict=True)
    path.write_text("".join(f"{x:.2f},{z:.5f}\n" for x, z in rows))
    status, _, err = run_command(capsys, "profile", path, "--units", f"m,{unit}")
    assert status == 0
    assert ("smoother than any road" in err and "in m, and not in mm?" in err) == warned
    assert bool(err) == warned
