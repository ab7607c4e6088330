import json

import pytest

import bridgectl as bc
from bridgectl.cli.main import main

QUICK = ["dae", "--approach", "10", "--speeds", "80"]


@pytest.mark.parametrize(
    ("options", "says"),
    [
        (["--approach", "10.05"], "--approach must be a whole number of 0.1 m ramps, got 10.05"),
        (["--approach", "nan"], "--approach must be 0 m or more, got nan"),
        (["--approach", "inf"], "--approach must be 0 m or more, got inf"),
        (["--units", "mm"], "--units is about a road file, and none is given: name the file"),
        (["--track", "0"], "--track is about a road file"),
        (["--speeds", "60-120"], "by commas, got '60-120': type 50:150:1 or 80,90,100"),
        (["--span", "25.5"], "span must be one of 9, 11, "),
        (["--speeds", "0.001"], "--speeds must be 1 to 1000 km/h, got '0.001'"),
        (["--speeds", "1e9"], "--speeds must be 1 to 1000 km/h"),
        (["--damping-ratio", "0.01,x"], "--damping-ratio must be numbers separated by commas"),
        (["--deck", "a\x1b[1m\nb"], "deck must be one of"),
    ],
)
def test_what_cannot_be_computed_is_refused_in_one_line(capsys, options, says):
    assert main([*QUICK, *options]) == 2
    out, err = capsys.readouterr()
    assert (out, err.count("\n")) == ("", 1)
    assert says in err
    assert err.strip().isprintable()


def test_a_crossing_too_large_for_memory_is_one_line(capsys, monkeypatch):
    def too_large(*_, **__):
        raise MemoryError

    monkeypatch.setattr(bc, "ramp_surface", too_large)
    assert main(QUICK) == 2
    assert capsys.readouterr().err.startswith("bridgectl: error: not enough memory")


def test_a_folder_that_cannot_be_written_is_found_before_the_work(capsys, monkeypatch, tmp_path):
    monkeypatch.setattr("os.access", lambda *_: False)
    monkeypatch.setattr(bc, "ramp_surface", None)
    assert main([*QUICK, "--plot", str(tmp_path / "figure.png")]) == 2
    assert "--plot: no permission to write" in capsys.readouterr().err


@pytest.mark.parametrize("times", [1, 2])
def test_one_warning_is_told_once_a_run(capsys, times):
    for _ in range(times):
        assert main([*QUICK, "--sprung-mass", "9e6"]) == 0
    assert capsys.readouterr().err.count("is heavier than the bridge") == times


def test_speeds_come_in_order_and_once_and_each_mode_may_have_its_damping(capsys):
    options = ["--speeds", "90,80,90", "--damping-ratio", "0.01,0.02,0.03", "--json"]
    assert main([*QUICK, *options]) == 0
    result = json.loads(capsys.readouterr().out)
    assert result["speed_km_per_h"] == pytest.approx([80, 90])
    assert result["bridge"]["damping_ratio"] == [0.01, 0.02, 0.03]
