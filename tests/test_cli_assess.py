"""`bridgectl assess`: options, tables, files and errors."""

import csv
import json

import numpy as np
import pytest
from helpers import run_command

import bridgectl as bc
from bridgectl.fleet import levels

QUICK = ["--approach", "20", "--workers", "1", "--random", "2"]
SMALL = [*QUICK, "--trucks", "12", "--classes", "A"]

pytestmark = pytest.mark.filterwarnings("default")  # they go to standard error


@pytest.fixture(autouse=True)
def few_draws(monkeypatch):
    """Intervals of ratios by few samples drawn again, where no one looks at their ends."""
    monkeypatch.setattr(levels, "N_PAIRS", 50)


def run(capsys, *arguments):
    return run_command(capsys, "assess", *arguments)


def test_it_prints_what_the_library_finds(capsys, tmp_path):
    table = tmp_path / "rows.csv"
    status, out, err = run(capsys, *SMALL, "--table", table, "--trucks-a-day", "0.0001")
    assert (status, err) == (0, "")
    for words in ("12 crossings of 12 trucks", "mean", "DAF", "moment  A", f"Table: {table}"):
        assert words in out
    with open(table, encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    fleet = bc.Fleet.load("air_sprung")
    assert [float(row["speed [m/s]"]) for row in rows] == [
        fleet.passing(i).speed for i in range(12)
    ]
    assert {row["road"] for row in rows} == {"class A, 1", "class A, 2"}


@pytest.mark.slow
def test_json_has_values_with_intervals_by_effect_and_quality(capsys):
    two = ["--spans", "20,20", "--mass-per-length", "12e3", "--frequency", "5"]
    status, out, _ = run(
        capsys, *QUICK, *two, "--trucks", "40", "--trucks-a-day", "900", "--json",
        "--effect", "sagging@8,hogging@20", "--return-period", "75",
    )  # fmt: skip
    assert status == 0
    found = json.loads(out)
    assert [(each["effect"], each["quality"]) for each in found["effects"]] == [
        ("sagging@8", "A"), ("sagging@8", "B"), ("hogging@20", "A"), ("hogging@20", "B"),
    ]  # fmt: skip
    first, last = found["effects"][0], found["effects"][-1]
    assert first["unit"] == "N m"
    assert last["static"][1][0] < 0 < first["static"][1][0]
    assert all(value > 1 for value, *_ in first["daf"][1:])
    low, value, high = (first["characteristic_total"][i] for i in (1, 0, 2))
    assert low < value < high
    assert first["adr"][1] < first["adr"][0] < first["adr"][2]


def test_what_there_are_too_few_crossings_for_is_null_with_the_reason(capsys):
    found = json.loads(run(capsys, *SMALL, "--trucks-a-day", "900", "--json")[1])
    (only,) = found["effects"]
    assert (only["characteristic_total"], only["adr"]) == (None, None)
    assert "simulate more crossings than 12" in only["why_none"]


def test_without_a_rate_there_are_no_return_periods_but_all_else(capsys):
    status, out, _ = run(capsys, *SMALL)
    assert status == 0
    assert "No effects of 1000 years: trucks_a_day must be said" in out


def test_weighed_trucks_cross_as_often_as_they_were_weighed(capsys, tmp_path):
    csv = tmp_path / "station.csv"
    csv.write_text(
        "time,v,W1,W2,s1\n" + "".join(f"{30 * i},{60 + i},{40 + i},{70 + i},4.5\n"
                                      for i in range(6)) + "200,70,,,4.5\n", "utf-8",
    )  # fmt: skip
    units = ["--weighed-units", "time=s,speed=km/h,load=kN,spacing=m"]
    status, _, err = run(capsys, *QUICK, "--weighed", csv, *units)
    assert status == 2
    assert "station.csv" in err
    assert "line 8" in err
    status, out, err = run(capsys, *QUICK, "--weighed", csv, *units, "--leave-out-bad", "--json")
    assert status == 0
    assert "1 of 7 rows are left out" in err
    assert json.loads(out)["crossings"] == 12
    assert json.loads(out)["trucks_a_day"] == pytest.approx(86400 / 30)


def test_files_are_a_quality_of_their_own(capsys, tmp_path):
    x = np.arange(0, 60.05, 0.1)
    path = tmp_path / "east.csv"
    rows = "\n".join(f"{a:.1f},{np.sin(a):.3f}" for a in x)
    path.write_text(f"x [m],z [mm]\n{rows}\n", "utf-8")
    status, out, _ = run(capsys, path, *QUICK, "--trucks", "3", "--json")
    assert (status, [each["quality"] for each in json.loads(out)["effects"]]) == (0, ["measured"])
    status, out, _ = run(capsys, path, *QUICK, "--trucks", "3", "--json", "--classes", "b")
    assert [each["quality"] for each in json.loads(out)["effects"]] == ["measured", "B"]


def test_a_study_goes_on_with_more_trucks(capsys, tmp_path):
    file = tmp_path / "study.jsonl"
    whole = run(capsys, *SMALL, "--json")[1]
    run(capsys, *SMALL, "--trucks", "5", "--json", "--resume", file)
    assert run(capsys, *SMALL, "--json", "--resume", file)[1] == whole


@pytest.mark.slow
def test_figures_are_drawn_of_each_effect_and_quality(capsys, tmp_path):
    status, out, _ = run(
        capsys, *QUICK, "--trucks", "60", "--trucks-a-day", "0.01", "--plot", tmp_path / "a.png",
        "--effect", "moment,reaction@0", "--return-period", "1",
    )  # fmt: skip
    assert status == 0
    names = {path.name for path in tmp_path.iterdir()}
    assert names == {"a_moment_A.png", "a_moment_B.png", "a_reaction_0_A.png", "a_reaction_0_B.png"}
    assert "Drawn: " in out


def test_what_cannot_be_drawn_is_told_after_what_was_found(capsys, tmp_path):
    status, out, err = run(capsys, *SMALL, "--plot", tmp_path / "a.png")
    assert status == 2
    assert "12 crossings" in out
    assert "trucks_a_day must be said" in err


@pytest.mark.parametrize(
    ("options", "error"),
    [
        (["--fleet", "trucks"], "there is no fleet 'trucks': type air_sprung or monte_carlo"),
        (["--fleet", "monte_carlo", "--weighed", "example"], "--fleet and --weighed exclude each"),
        (["--weighed-units", "load=kN"], "--weighed-units goes with --weighed"),
        (["--leave-out-bad"], "--leave-out-bad goes with --weighed"),
        (["--weighed", "example", "--weighed-units", "kN"], "--weighed-units must look like"),
        (["--weighed", "nowhere.csv"], "nowhere.csv"),
        (["--classes", "A,A"], "--classes must be different ones of A to H"),
        (["--classes", "Z"], "--classes must be different ones of A to H, as A,B, got 'Z'"),
        (["--table", "rows.txt"], "--table must end in .csv or .parquet, got 'rows.txt'"),
        (["--trucks", "0"], "--trucks must be 1 or more"),
        (["--damper", "soft"], "--damper: there is no 'soft'; there are: preset, skyhook"),
        (["--units", "m,mm"], "--units is about a road file, and none is given"),
        (["--method", "guess"], "--method must be"),
        (["--return-period", "0"], "--return-period must be above 0"),
        (["--trucks-a-day", "-3"], "--trucks-a-day must be above 0"),
    ],
)  # fmt: skip
def test_mistakes_are_told_in_one_line(capsys, options, error):
    status, _, err = run(capsys, *SMALL, *options)
    assert status == 2
    assert error in err
    assert err.count("\n") == 1
