import json
import re
import subprocess
import sys
from importlib.resources import files

import numpy as np
import pytest
from helpers import run_command
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

import bridgectl as bc
from bridgectl.cli.main import main

QUICK = ["--approach", "10", "--speeds", "80:110:30"]
UTIA = files("bridgectl.road").joinpath("data/utia_profile_1.txt").read_bytes()


@pytest.fixture
def road_file(tmp_path):
    path = tmp_path / "road.csv"
    x = np.arange(0, 60.05, 0.1)
    rows = [f"{a:.2f},{2 * np.sin(a / 3):.4f}" for a in x]
    path.write_text("x [m],z [mm]\n" + "\n".join(rows) + "\n", encoding="utf-8")
    return path


def test_dae_without_a_file_is_the_dae_of_the_measured_road(capsys):
    status, out, err = run_command(capsys, "dae", "--full")
    assert (status, err) == (0, "")
    assert "Road: UTIA road, bridge from station 678 m" in out
    assert "speed [km/h]" in out
    assert out.startswith(
        "Critical speed: 66 km/h, DAF 1.1775 (smooth road: 108 km/h, 1.1365): the "
    )
    row = next(line for line in out.splitlines() if line.strip().startswith("110 "))
    assert row.split() == ["110", "1.1284", "1.0394", "1.0411", "1.0411", "-0.0017"]
    ramps = out[out.index("The 10 ramps") :]
    assert len(re.findall(r"^ +-?\d+\.\d  +-?\d\.\d{3}", ramps, re.MULTILINE)) == 10
    assert max(len(line.rstrip()) for line in out.splitlines()) <= 100


def test_json_holds_every_speed_and_the_librarys_numbers(capsys, road_file):
    status, out, err = run_command(capsys, "dae", road_file, *QUICK, "--json", "--no-detrend")
    assert (status, err) == (0, "")
    result = json.loads(out)
    assert result["speed_km_per_h"] == pytest.approx([80, 110])
    assert result["daf_superposed"] == pytest.approx(result["daf_simulated"], abs=1e-6)
    road = bc.read_profile(road_file).place_bridge(10).crop(-10, 25)
    surface = bc.ramp_surface(
        bc.li2006.beam(), bc.li2006.car(), np.array([80, 110]) / 3.6, approach=10
    )
    assert result["dae"] == pytest.approx(surface.dae(road).tolist(), abs=1e-12)
    assert result["critical_daf"] == max(result["daf_simulated"])
    assert len(result["largest_contributions"]) == 10
    assert result["bridge"]["recovery"] == "exact"


def test_the_options_reach_the_study(capsys, road_file):
    options = [
        "--units", "m,mm", "--station", "20", "--approach", "5", "--span", "15", "--modes", "2",
        "--damping-ratio", "0.02", "--damping", "12e3", "--sprung-mass", "8000",
        "--speeds", "60,90", "--section", "0.4", "--recovery", "li2006",
    ]  # fmt: skip
    status, out, _ = run_command(capsys, "dae", road_file, *options, "--json")
    result = json.loads(out)
    assert status == 0
    assert result["bridge"]["length_m"] == 15
    assert result["bridge"]["n_modes"] == 2
    assert (result["bridge"]["section"], result["bridge"]["recovery"]) == (0.4, "li2006")
    assert result["vehicle"]["damping_N_s_per_m"] == 12e3
    assert result["vehicle"]["sprung_mass_kg"] == 8000
    assert result["road"] == {"name": "road", "bridge_station_m": 20, "approach_m": 5}


def test_a_grade_counts_only_if_it_is_asked_for(capsys, tmp_path):
    x = np.arange(0, 41.0)
    for name, slope in (("level", 0.0), ("grade", 0.03)):
        rows = "\n".join(f"{a} {slope * a}" for a in x)
        (tmp_path / name).write_text(f"# x [m] z [m]\n{rows}\n", encoding="utf-8")
    results = {}
    for name in ("level", "grade"):
        for option in ([], ["--no-detrend"]):
            _, out, _ = run_command(capsys, "dae", tmp_path / name, *QUICK, "--json", *option)
            results[name, bool(option)] = json.loads(out)["daf_simulated"]
    assert results["grade", False] == pytest.approx(results["level", False], abs=1e-9)
    assert np.abs(np.subtract(results["grade", True], results["level", True])).max() > 1e-3


@pytest.mark.parametrize("suffix", ["png", "svg"])
def test_dae_draws_what_it_computed(capsys, tmp_path, suffix):
    picture = tmp_path / f"dae.{suffix}"
    status, out, _ = run_command(capsys, "dae", *QUICK, "--plot", picture)
    assert status == 0
    assert picture.stat().st_size > 10_000
    assert f"Drawn: {picture}" in out


def test_paper_prints_every_printed_number_beside_ours(capsys, tmp_path):
    picture = tmp_path / "paper.png"
    status, out, err = run_command(capsys, "paper", "--plot", picture)
    assert (status, err) == (0, "")
    for printed in bc.li2006.PRINTED.values():
        assert re.search(rf" {printed:g}( km/h| x/l)? ", out), printed
    assert "1.13023" in out
    assert "+0.00003" in out
    assert picture.stat().st_size > 50_000


@pytest.mark.slow
def test_paper_json_holds_the_differences(capsys):
    _, out, _ = run_command(capsys, "paper", "--json")
    rows = json.loads(out)["results"]
    for row in rows:
        if row["printed"] is not None:
            assert row["difference"] == pytest.approx(row["computed"] - row["printed"])
    assert len(json.loads(out)["smooth_road"]) == 11


def test_a_tire_that_leaves_the_road_is_a_warning_of_one_line(capsys, tmp_path):
    path = tmp_path / "hump.txt"
    path.write_text("# x [m] z [m]\n0 0\n4 0\n5 0.09\n5.1 0\n36 0\n", encoding="utf-8")
    status, out, err = run_command(
        capsys, "dae", path, "--approach", "10", "--speeds", "36", "--no-detrend"
    )
    assert status == 0
    assert "36 <" in out
    assert err.count("\n") == 1
    assert err.startswith("bridgectl: warning: a tire leaves the road at 1 of 1 speeds")


def test_a_truck_in_tonnes_is_a_warning_of_one_line(capsys):
    light = [
        "--sprung-mass", "9", "--unsprung-mass", "1", "--suspension-stiffness", "80",
        "--tire-stiffness", "1800", "--damping", "7",
    ]  # fmt: skip
    _, _, err = run_command(capsys, "dae", *QUICK, *light)
    assert err.startswith("bridgectl: warning: the vehicle's mass is 10 kg: are its masses in")
    assert err.count("\n") == 1


@pytest.mark.parametrize("command", [[], ["dae"], ["paper"]])
def test_help_is_worth_reading(capsys, command):
    with pytest.raises(SystemExit) as stop:
        main([*command, "--help"])
    out, _ = capsys.readouterr()
    assert stop.value.code == 0
    assert "bridgectl dae" in out or "Figs. 2, 5 and 6" in out
    assert len(out.splitlines()) > 8


def test_the_version_is_told(capsys):
    with pytest.raises(SystemExit):
        main(["--version"])
    assert capsys.readouterr().out == f"bridgectl {bc.__version__}\n"


@pytest.mark.parametrize(
    ("options", "says"),
    [
        (["--speeds", "0:50:10"], "--speeds must rise from above 0 km/h, as 50:150:1"),
        (["--speeds", "150:50:1"], "--speeds must rise from above 0 km/h"),
        (["--speeds", "50:150"], "--speeds must look like 50:150:1 or 80,90,100, got '50:150'"),
        (["--speeds", "50:1e9:1"], "--speeds must be at most 10000 speeds"),
        (["--speeds", "-80"], "--speeds"),
        (["--speeds", "80,-3"], "--speeds must be above 0 km/h"),
        (["--speeds", "fast"], "--speeds must be numbers separated by commas, got 'fast'"),
        (["--speeds", "nan"], "--speeds must be above 0 km/h"),
        (["--station", "480"], "--station must lie between 488 and 997 m"),
        (["--approach", "2000"], "2025 m are needed: pass a smaller --approach or --span"),
        (["--approach", "-3"], "--approach must be 0 m or more, got -3"),
        (["--span", "26"], "span must be one of 9, 11"),
        (["--deck", "arch"], "deck must be one of 'solid', 'Y', 'super-Y', got 'arch'"),
        (["--modes", "0"], "n_modes must be 1 or more, got 0"),
        (["--damping-ratio", "3"], "for 3 percent type 0.03"),
        (["--damping", "-7000"], "damping"),
        (["--sprung-mass", "nan"], "sprung_mass must be finite [kg]"),
        (["--section", "1"], "section must lie between 0 and 1"),
        (["--recovery", "fryba"], "recovery must be one of"),
        (["--plot", "figure.doc"], "--plot must end in .png, .pdf or .svg, got 'figure.doc'"),
        (["--plot", "no/such/folder/figure.png"], "does not exist"),
        (
            ["--modes", "three"],
            "must be a whole number, as 3, got 'three' (see bridgectl dae --help)",
        ),
        (["--sped", "30"], "unrecognized arguments: --sped"),
    ],
)
def test_a_bad_option_is_one_line_and_status_2(capsys, options, says):
    status, out, err = run_command(capsys, "dae", *QUICK, *options)
    assert (status, out) == (2, "")
    assert err.startswith("bridgectl: error: ")
    assert err.count("\n") == 1
    assert says in err


def lines(*rows):
    return "".join(f"{row}\n" for row in rows).encode()


@pytest.mark.parametrize(
    ("content", "options", "says"),
    [
        (b"", [], "road.txt"),
        (b"\x00\x01\x02\xff" * 50, ["--units", "m,m"], "road.txt"),
        (lines("0 0", "0.1 zero", "0.2 0"), ["--units", "m,m"], "road.txt:2"),
        (lines("0 0", "0.1 0", "0.2 nan"), ["--units", "m,m"], "road.txt:3"),
        (lines("0 0", "0.2 0", "0.1 0"), ["--units", "m,m"], "road.txt:3"),
        (lines("0 0", "0.1 0", "0.1 0"), ["--units", "m,m"], "road.txt:3"),
        (lines("0 0", "0.1 3", "0.2 5"), ["--units", "m,m"], "m,mm"),
        (lines("0 0", "100 0", "200 0"), ["--units", "m,m"], "mm"),
        (lines("0 0", "0.1 0"), [], "--units m,mm"),
        (lines("0 0", "0.1 0"), ["--units", "m,parsec"], "parsec"),
        (lines("0 0", "1 0", "2 0"), ["--units", "m,m"], "does not hold 10 m of approach"),
        (lines("0 0", "1 0"), ["--units", "m,m", "--columns", "0,5"], "column"),
        (lines("0 0", "1 0"), ["--units", "m,m", "--columns", "0,b"], "--columns must be numbers"),
    ],
)
def test_a_bad_road_is_one_line_and_status_2(capsys, tmp_path, content, options, says):
    path = tmp_path / "road.txt"
    path.write_bytes(content)
    status, out, err = run_command(capsys, "dae", path, *QUICK, *options)
    assert (status, out) == (2, "")
    assert err.startswith("bridgectl: error: ")
    assert err.count("\n") == 1
    assert says in err


def test_a_missing_file_is_one_line_and_status_2(capsys, tmp_path):
    status, _, err = run_command(capsys, "dae", tmp_path / "none.csv")
    assert status == 2
    assert err.count("\n") == 1
    assert "none.csv" in err


def test_no_command_is_one_line_and_status_2(capsys):
    status, _, err = run_command(capsys)
    assert status == 2
    assert err.count("\n") == 1


@settings(max_examples=25, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(st.data())
def test_a_damaged_road_file_ends_in_numbers_or_in_one_line(capsys, tmp_path, data):
    content = bytearray(UTIA[: 18 * 200])
    for _ in range(data.draw(st.integers(1, 8))):
        at = data.draw(st.integers(0, len(content) - 1))
        what = data.draw(st.sampled_from(["change", "drop", "insert", "cut"]))
        if what == "change":
            content[at] = data.draw(st.integers(0, 255))
        elif what == "drop":
            del content[at : at + data.draw(st.integers(1, 30))]
        elif what == "insert":
            content[at:at] = data.draw(st.binary(min_size=1, max_size=20))
        else:
            del content[max(at, 400) :]
        content = content or bytearray(b"0")
    path = tmp_path / "damaged.txt"
    path.write_bytes(bytes(content))
    status, out, err = run_command(
        capsys, "dae", path, "--units", "m,m", "--approach", "5", "--span", "9", "--speeds", "80"
    )
    assert status in (0, 2)
    if status == 2:
        assert (out, err.count("\n")) == ("", 1)
        assert err.startswith("bridgectl: error: ")


@pytest.mark.slow
def test_the_program_runs_as_a_module_into_a_closed_pipe():
    program = f"{sys.executable} -m bridgectl dae --approach 10 --speeds 80 | head -n 1"
    done = subprocess.run(
        ["bash", "-c", f"set -o pipefail; {program}"], capture_output=True, text=True, check=False
    )
    assert done.stderr == ""
    assert done.stdout.startswith("Critical speed: 80 km/h")
    assert done.returncode == 0


def test_ctrl_c_is_quiet(capsys, monkeypatch):
    def interrupted(*_, **__):
        raise KeyboardInterrupt

    monkeypatch.setattr(bc, "ramp_surface", interrupted)
    status, out, err = run_command(capsys, "dae", *QUICK)
    assert (status, out, err) == (130, "", "")
