"""`bridgectl score`: options, files and errors."""

import json

import numpy as np
import pytest
from helpers import NO_DAMPERS, run_command, without_dampers

import bridgectl as bc
from bridgectl.cli.main import main
from bridgectl.dampers import library
from bridgectl.scoring import run as scoring

QUICK = ["--approach", "2", "--speeds", "80", "--workers", "1", "--span", "9", "--modes", "1"]
TWO = [*QUICK, "--strategies", "skyhook", "--random", "1"]


def run(capsys, *arguments):
    return run_command(capsys, "score", *arguments)


def write_road(path, height=2.0, length=40.0):
    x = np.arange(0, length + 0.05, 0.1)
    rows = "\n".join(f"{a:.2f},{height * np.sin(a / 3):.4f}" for a in x)
    path.write_text(f"x [m],z [mm]\n{rows}\n", encoding="utf-8")
    return path


def test_the_library_is_of_different_names_and_begins_with_the_vehicles_own_damper(bridge, truck):
    found = library(bridge, truck, 2e3, 20e3)
    assert found[0].name == "passive 7 kN s/m"
    assert len({strategy.name for strategy in found}) == 14
    assert {(strategy.c_min, strategy.c_max) for strategy in found[1:]} == {(2e3, 20e3)}


def test_the_library_needs_a_vehicle_with_a_damper(bridge):
    with pytest.raises(ValueError, match=NO_DAMPERS):
        library(bridge, without_dampers(), 2e3, 20e3)
    bare = bc.QuarterCar(9000, 1000, 8e4, 1.8e6, 0.0)
    with pytest.raises(ValueError, match="vehicle must have a damping above 0"):
        library(bridge, bare, 2e3, 20e3)


def test_without_a_file_there_is_the_measured_road_and_random_ones(capsys):
    status, out, err = run(capsys, *TWO, "--random", "2", "--json")
    assert (status, err) == (0, "")
    result = json.loads(out)
    assert result["strategies"] == ["passive 7 kN s/m", "skyhook"]
    assert result["roads"] == ["UTIA road", "class A, 1", "class A, 2", "class B, 1", "class B, 2"]
    assert result["approach_m"] == 2
    whole = bc.utia_road().place_bridge(678).crop(-2, 9).detrend().resample(0.1)
    beam = bc.li2006.beam(9, n_modes=1)
    daf = bc.daf(beam, bc.li2006.car(), 80 / 3.6, whole, start=-2)
    assert result["values"]["daf"][0][0] == pytest.approx(daf.tolist(), abs=1e-5)


def test_random_roads_stay_the_same_when_more_are_asked_for(capsys):
    few = json.loads(run(capsys, *QUICK, "--strategies", "passive", "--random", 1, "--json")[1])
    many = json.loads(run(capsys, *QUICK, "--strategies", "passive", "--random", 2, "--json")[1])
    of_few, of_many = (result["values"]["daf"][0] for result in (few, many))
    assert of_few == [of_many[0], of_many[1], of_many[3]]


def test_files_are_placed_detrended_and_named(capsys, tmp_path):
    (tmp_path / "other").mkdir()
    first, second = write_road(tmp_path / "road.csv"), write_road(tmp_path / "other/road.csv", 4.0)
    options = ["--station", "12", "--random", "0", "--strategies", "passive", "--json"]
    status, out, _ = run(capsys, first, second, *QUICK, *options)
    result = json.loads(out)
    assert status == 0
    assert result["roads"] == [str(first), str(second)]
    road = bc.read_profile(second).place_bridge(12).crop(-2, 9).detrend()
    daf = bc.daf(bc.li2006.beam(9, n_modes=1), bc.li2006.car(), 80 / 3.6, road, start=-2)
    assert result["values"]["daf"][0][1] == pytest.approx(daf.tolist(), abs=1e-5)


def test_the_bounds_lag_and_constants_reach_the_study(capsys, monkeypatch):
    seen = {}

    def score(dampers, beam, vehicle, roads, speeds, **options):
        seen.update(options, dampers=dampers, beam=beam, vehicle=vehicle, roads=roads)
        raise ValueError("enough")

    monkeypatch.setattr(bc, "score", score)
    status, _, _ = run(
        capsys, *QUICK, "--strategies", " Clipped  lqr ,constant", "--c-min", "2e3",
        "--c-max", "20e3", "--lag", "0.01", "--sample-time", "0.004", "--max-force", "9e3",
        "--velocity-noise", "0.01", "--seed", "3", "--departure", "1.5", "--damping", "20e3",
        "--section", "0.4", "--recovery", "li2006",
    )  # fmt: skip
    assert status == 2
    own, chosen, *constants = seen["dampers"]
    assert own.strategy.name == "passive 20 kN s/m"
    assert chosen.strategy.name == "clipped LQR"
    assert (chosen.lag, chosen.max_force, chosen.velocity_noise, chosen.seed) == (
        0.01,
        9e3,
        0.01,
        3,
    )
    # The vehicle's own damping is not there twice, and the constant dampers are without limit.
    assert [damper.strategy.c_max for damper in constants] == [2e3, 3600, 6300, 11e3]
    assert {damper.max_force for damper in [own, *constants]} == {np.inf}
    assert {damper.sample_time for damper in seen["dampers"]} == {0.004}
    assert (seen["departure"], seen["section"], seen["recovery"]) == (1.5, 0.4, "li2006")
    assert all(road.x[-1] == pytest.approx(10.5) for road in seen["roads"])


@pytest.mark.slow
def test_rollouts_are_named_with_their_preview(capsys):
    """Over one road with samples 10 ms apart, quicker than the 6 ms that W_k asks for."""
    options = ["--strategies", "rollout, Preview  2.5 m", "--random", "0", "--sample-time", "0.01"]
    status, out, err = run(capsys, *QUICK, *options, "--json")
    assert status == 0
    assert "W_k" in err
    result = json.loads(out)
    assert result["strategies"] == ["passive 7 kN s/m", "rollout", "preview 2.5 m"]
    status, _, err = run(capsys, *QUICK, "--strategies", "preview", "--random", "0")
    assert status == 2
    assert "constant, rollout, preview 10 m" in err
    status, _, err = run(capsys, *QUICK, "--truck", "T2", "--strategies", "rollout")
    assert status == 2
    assert "bridgehook takes every vehicle" in err


def test_all_strategies_and_constants_are_the_default(capsys, monkeypatch):
    def score(dampers, *_, **__):
        raise ValueError(", ".join(damper.strategy.name for damper in dampers))

    monkeypatch.setattr(bc, "score", score)
    _, _, err = run(capsys)
    assert err.startswith("bridgectl: error: passive 7 kN s/m, preset, skyhook,")
    assert err.endswith(
        "bridgehook, passive 1 kN s/m, passive 2.3 kN s/m, passive 5.5 kN s/m, "
        "passive 13 kN s/m, passive 30 kN s/m\n"
    )


def test_round_values_of_constant_dampers_stay_within_narrow_bounds(capsys, monkeypatch):
    def score(dampers, *_, **__):
        raise ValueError(", ".join(damper.strategy.name for damper in dampers))

    monkeypatch.setattr(bc, "score", score)
    bounds = ["--c-min", "1240", "--c-max", "1350", "--strategies", "constant"]
    _, _, err = run(capsys, *QUICK, *bounds)
    assert err.endswith("7 kN s/m, passive 1.24 kN s/m, passive 1.3 kN s/m, passive 1.35 kN s/m\n")


@pytest.mark.slow
def test_what_a_file_keeps_is_not_done_again(capsys, monkeypatch, tmp_path):
    kept = tmp_path / "score.jsonl"
    _, first, _ = run(capsys, *TWO, "--resume", kept, "--json")
    monkeypatch.setattr(scoring, "_part", None)
    status, again, err = run(capsys, *TWO, "--resume", kept, "--json")
    assert (status, err) == (0, "")
    assert again == first


def test_an_interruption_keeps_what_is_done_and_says_where(capsys, monkeypatch, tmp_path):
    kept, done = tmp_path / "score.jsonl", scoring._part

    def interrupted(study, damper, first):
        if damper.name == "skyhook":
            raise KeyboardInterrupt
        return done(study, damper, first)

    monkeypatch.setattr(scoring, "_part", interrupted)
    status, out, err = run(capsys, *TWO, "--resume", kept)
    assert (status, out) == (130, "")
    assert f"interrupted: {kept} keeps what is done" in err
    # The study, and of the passive damper the roads.
    assert len(kept.read_text(encoding="utf-8").splitlines()) == 2
    todo = []
    monkeypatch.setattr(
        scoring, "_part",
        lambda study, damper, first: todo.append(damper) or done(study, damper, first),
    )  # fmt: skip
    assert run(capsys, *TWO, "--resume", kept)[0] == 0
    # Unit ramps, and those of the classes A and B, come last.
    assert [damper.name for damper in todo] == [
        "skyhook", *3 * ["passive 7 kN s/m"], *3 * ["skyhook"],
    ]  # fmt: skip


@pytest.mark.slow
def test_a_figure_is_drawn(capsys, tmp_path):
    picture = tmp_path / "score.png"
    status, out, _ = run(capsys, *TWO, "--plot", picture)
    assert status == 0
    assert f"Drawn: {picture}" in out
    assert picture.stat().st_size > 20_000


@pytest.mark.parametrize(
    ("options", "says"),
    [
        (["--strategies", "skyhok"], "there is no 'skyhok'; there are: passive, preset, skyhook,"),
        (["--strategies", ""], "--strategies: there is no ''"),
        (["--strategies", "skyhook,,hybrid"], "--strategies: there is no ''"),
        (["--strategies", "skyhook,Skyhook"], "--strategies names 'skyhook' twice"),
        (["--c-min", "0"], "--c-min must be above 0 [N s/m], got 0"),
        (["--c-max", "nan"], "--c-max must be finite [N s/m]"),
        (["--c-min", "40e3"], "--c-min must be below --c-max, got 40000 and 30000 N s/m"),
        (["--damping", "0"], "--damping must be above 0"),
        (["--lag", "-1"], "--lag must be 0 or more"),
        (["--sample-time", "0"], "--sample-time must be above 0"),
        (["--max-force", "0"], "--max-force must be above 0"),
        (["--max-force", "nan"], "--max-force must be above 0"),
        (["--velocity-noise", "-1"], "--velocity-noise must be 0 or more"),
        (["--seed", "-1"], "--seed must be 0 or more"),
        (["--random", "-1"], "--random must be 0 or more"),
        (["--workers", "0"], "--workers must be 1 or more"),
        (["--departure", "0.05"], "--departure must be a whole number of 0.1 m ramps"),
        (["--departure", "-1"], "--departure must be 0 m or more"),
        (["--departure", "400"], "9 m of bridge, 400 m of departure at station 678 m"),
        (["--approach", "nan"], "--approach must be 0 m or more"),
        (["--approach", "600"], "609 m are needed: pass a smaller --approach or --span"),
        (["--speeds", "0"], "--speeds must be above 0 km/h"),
        (["--plot", "score.doc"], "--plot must end in"),
        (["--resume", "."], "--resume must name a file, got the folder '.'"),
        (["--resume", "nowhere/score.jsonl"], "--resume: the folder 'nowhere' does not exist"),
        (["none.csv"], "none.csv"),
        (["--lag", "long"], "--lag: must be a number, as 12e3, got 'long' (see bridgectl"),
        (["--random", "2.5"], "--random: must be a whole number, as 3, got '2.5' (see bridgectl"),
    ],
)
def test_a_mistake_is_one_line_and_status_2(capsys, options, says):
    status, out, err = run(capsys, *TWO, *options)
    assert (status, out) == (2, "")
    assert err.startswith("bridgectl: error: ")
    assert err.count("\n") == 1
    assert says in err


def test_mistakes_name_the_file(capsys, tmp_path):
    short, bad = write_road(tmp_path / "short.csv", length=10), tmp_path / "bad.csv"
    bad.write_text("x [m],z [mm]\n0,0\n0.1,zero\n", encoding="utf-8")
    good = write_road(tmp_path / "good.csv")
    for roads, says in (
        ([good, short], "short.csv (0 to 10 m) does not hold 2 m of approach"),
        ([good, bad], "bad.csv:3"),
        ([good, good], "good.csv is given twice"),
    ):
        status, out, err = run(capsys, *roads, *TWO)
        assert (status, out, err.count("\n")) == (2, "", 1)
        assert says in err


def test_a_file_of_another_study_is_one_line(capsys, tmp_path):
    kept = tmp_path / "score.jsonl"
    assert run(capsys, *TWO, "--resume", kept)[0] == 0
    status, out, err = run(capsys, *TWO, "--speeds", "90", "--resume", kept)
    assert (status, out, err.count("\n")) == (2, "", 1)
    assert f"{kept} holds another study: its speeds is" in err
    road = write_road(tmp_path / "road.csv")
    status, _, err = run(capsys, *TWO, "--resume", road)
    assert (status, err.count("\n")) == (2, 1)
    assert "is no file of a score" in err


def test_help_lists_the_command_and_the_library(capsys, bridge, truck):
    with pytest.raises(SystemExit):
        main(["--help"])
    assert "bridgectl score" in capsys.readouterr().out
    with pytest.raises(SystemExit):
        main(["score", "--help"])
    text = " ".join(capsys.readouterr().out.split())
    assert "bridgectl score --strategies skyhook" in text
    names = [strategy.name for strategy in library(bridge, truck, 1e3, 30e3)[1:]]
    assert f"passive (the vehicle's own), {', '.join(names)}." in text


# Trucks


@pytest.mark.slow
@pytest.mark.filterwarnings("ignore:start = :bridgectl.PlausibilityWarning")  # stiff springs
def test_a_truck_is_scored_with_the_laws_at_every_leg(capsys):
    """Its own damping, that of both axles, is not among the constant ones beside it."""
    names = "constant,clipped lqr"
    case = [*QUICK, "--truck", "T2", "--strategies", names, "--c-max", "1e5", "--random", "1"]
    status, out, err = run(capsys, *case, "--approach", "60", "--json")
    assert (status, err) == (0, "")
    result = json.loads(out)
    constants = [f"passive {c} kN s/m" for c in ("1", "3.2", "32", "100")]
    assert result["strategies"] == ["passive 10 kN s/m", *constants, "clipped LQR"]
    beam = bc.li2006.beam(9, n_modes=1)
    whole = bc.utia_road().place_bridge(678).crop(-60, 9).detrend().resample(0.1)
    daf = bc.daf(beam, bc.trucks.load("T2"), 80 / 3.6, whole, start=-60)
    assert result["values"]["daf"][0][0] == pytest.approx(daf.tolist(), abs=1e-5)


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["--truck", "T9"], "--truck: there is no truck 'T9': type one of T2"),
        (["--truck", "T2", "--damping", "7e3"], "--truck and --damping exclude each other"),
        (["--truck", "none.toml"], "--truck: none.toml: no such file"),
    ],
)
def test_a_truck_that_there_is_not_is_named(capsys, arguments, message):
    status, out, err = run(capsys, *QUICK, *arguments)
    assert (status, out) == (2, "")
    assert message in err
