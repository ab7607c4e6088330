"""`bridgectl tune`: options and errors."""

import json

import numpy as np
import pytest
from helpers import run_command

import bridgectl as bc
from bridgectl.cli.main import main

QUICK = ["--approach", "2", "--speeds", "80", "--workers", "1", "--span", "9", "--modes", "1",
         "--random", "2", "--held-out", "3", "--iterations", "3"]  # fmt: skip


def run(capsys, *arguments):
    return run_command(capsys, "tune", *QUICK, *arguments)


def test_a_program_is_tuned_drawn_and_printed(capsys, tmp_path):
    picture = tmp_path / "tuned.png"
    status, out, err = run(capsys, "--strategy", "program", "--places", "3", "--plot", picture)
    assert (status, err) == (0, "")
    assert out.startswith("program, tuned for the simulated DAF")
    assert "2 training roads, 3 held out, at 80 km/h, 2 m of approach" in out
    assert f"Drawn: {picture}" in out
    assert picture.stat().st_size > 20_000


@pytest.mark.slow
def test_json_is_of_the_roads_that_score_has(capsys):
    """The first ones are trained on, the next ones held out; gains begin as the library's."""
    options = ["--strategy", " Continuous  skyhook", "--gains", "gain", "--softness", "0.01"]
    status, out, err = run(capsys, *options, "--json")
    assert (status, err) == (0, "")
    found = json.loads(out)
    assert found["strategy"] == "continuous skyhook"
    assert [gain["name"] for gain in found["gains"]] == ["gain"]
    assert found["softness"] == 0.01
    roads = [
        bc.iso8608_profile("A", 11, seed=np.random.default_rng((ord("A"), k)), start=-2)
        for k in range(1, 6)
    ]
    beam, law = bc.li2006.beam(9, n_modes=1), bc.dampers.continuous_skyhook(1e3, 30e3)
    dafs = [
        bc.daf(beam, bc.li2006.car(), 80 / 3.6, road, start=-2, damper=law)[0] for road in roads
    ]
    before = found["training_daf"][0][0] + found["held_out_daf"][0][0]
    assert before == pytest.approx(dafs, abs=1e-6)


def test_options_reach_the_tuning(capsys, monkeypatch, tmp_path):
    seen = {}

    def tune(damper, beam, vehicle, roads, speeds, **options):
        seen.update(options, damper=damper, roads=roads)
        raise ValueError("enough")

    monkeypatch.setattr(bc, "tune", tune)
    file = tmp_path / "road.csv"
    x = np.arange(0, 40, 0.1)
    np.savetxt(file, np.column_stack([x, 2 * np.sin(x)]), header="x [m],z [mm]", comments="",
               delimiter=",")  # fmt: skip
    status, _, _ = run(
        capsys, file, "--strategy", "program", "--c-min", "2e3", "--c-max", "20e3", "--lag",
        "0.01", "--damping", "30e3", "--class", "B", "--objective", "class_dae", "--section", "0.4",
        "--method", "generations",
    )  # fmt: skip
    assert status == 2
    law = seen["damper"].strategy
    assert seen["damper"].lag == 0.01
    assert (law.positions[[0, -1]].tolist(), law.dampings.tolist()) == ([-2, 9], [20e3] * 20)
    assert (law.c_min, law.c_max) == (2e3, 20e3)
    assert [road.name for road in seen["roads"]] == ["road", "class B, 1", "class B, 2"]
    assert [road.name for road in seen["held_out"]] == [f"class B, {k}" for k in (3, 4, 5)]
    told = [seen[k] for k in ("objective", "method", "section", "approach", "gains")]
    assert told == ["class_dae", "generations", 0.4, 2.0, None]


@pytest.mark.parametrize(
    ("options", "says"),
    [
        ([], "--strategy is needed; there are: skyhook, continuous skyhook, groundhook,"),
        (["--strategy", "bridgehook"], "--strategy: there is no 'bridgehook'; there are: skyhook,"),
        (["--strategy", "hybrid", "--gains", "shar"], "gains must be one of 'share'"),
        (["--strategy", "hybrid", "--random", "-1"], "--random must be 0 or more"),
        (["--strategy", "hybrid", "--held-out", "-1"], "--held-out must be 0 or more"),
        (["--strategy", "program", "--places", "1"], "--places must be 2 or more"),
        (["--strategy", "hybrid", "--random", "0"], "--random 0 leaves no training roads"),
        (["--strategy", "hybrid", "--class", "K"], "--class must be one of 'A'"),
        (["--strategy", "hybrid", "--softness", "-1"], "--softness must be above 0"),
        (["--strategy", "hybrid", "--iterations", "0"], "--iterations must be 1 or more"),
        (["--strategy", "hybrid", "--workers", "0"], "--workers must be 1 or more"),
        (["--strategy", "hybrid", "--units", "m,mm"], "--units is about a road file"),
        (["--strategy", "hybrid", "--plot", "x.doc"], "--plot must end in"),
    ],
)
def test_a_mistake_is_one_line_and_status_2(capsys, options, says):
    status, out, err = run(capsys, *options)
    assert (status, out) == (2, "")
    assert err.startswith("bridgectl: error: ")
    assert err.count("\n") == 1
    assert says in err


def test_help_lists_the_strategies_with_gains(capsys, bridge, truck):
    with pytest.raises(SystemExit):
        main(["tune", "--help"])
    text = " ".join(capsys.readouterr().out.split())
    names = [
        each.name
        for each in bc.dampers.library(bridge, truck, 1e3, 30e3)
        if each.gains and each.kept is None
    ]
    assert f"({', '.join(names)})" in text
