"""What score, dae, assess and profile say first, in three sentences, and what to type next."""

import json
import re
from dataclasses import replace

import numpy as np
import pytest
from helpers import run_command

import bridgectl as bc
from bridgectl._units import readable, readable_unit
from bridgectl.cli.main import _parser
from bridgectl.dampers import bridgehook, passive, skyhook
from bridgectl.scoring import run as scoring
from bridgectl.scoring.text import print_short, print_verdict

SCORE = ["score", "--approach", "2", "--speeds", "80", "--workers", "1", "--span", "9", "--modes",
         "1", "--strategies", "skyhook", "--random", "1"]  # fmt: skip
DAE = ["dae", "--approach", "10", "--speeds", "80:110:30"]
ASSESS = ["assess", "--approach", "20", "--workers", "1", "--random", "2", "--trucks", "6"]
COMMANDS = {"score": SCORE, "dae": DAE, "assess": ASSESS, "profile": ["profile"]}


def told(capsys, *arguments):
    """What a command prints, without its line breaks."""
    status, out, _ = run_command(capsys, *arguments)
    assert status == 0
    return " ".join(out.split())


@pytest.mark.parametrize(
    ("value", "unit", "text"),
    [
        (613125.0, "N m", "613 kN m"), (-5.364e5, "N m", "-536 kN m"), (97.1e3, "N", "97.1 kN"),
        (5.571e5, "N/m^2", "0.557 MPa"), (5.92e-4, "m", "0.592 mm"),
        (0.3684, "m/s^2", "0.368 m/s^2"), (0.0, "N m", "0 kN m"), (np.nan, "N", "- kN"),
    ],
)  # fmt: skip
def test_effects_are_told_in_the_units_that_people_read(value, unit, text):
    assert f"{readable(value, unit)} {readable_unit(unit)}" == text


# Score


@pytest.fixture(scope="module")
def board():
    roads = [bc.iso8608_profile("A", 40, seed=seed, start=-15) for seed in range(5)]
    beam, car = bc.li2006.beam(), bc.li2006.car()
    laws = [passive(7e3), bridgehook(beam, car, 1e3, 30e3), skyhook(1e3, 30e3)]
    seen = []
    found = bc.score(laws, beam, car, roads, 30.0, approach=15, workers=1, dae=False,
                     on_simulated=seen.append)  # fmt: skip
    assert np.array_equal(seen[0].values["daf"], found.values["daf"])
    return found


def test_without_dae_a_board_says_nothing_of_it(board):
    assert np.isnan(board.values["dae"]).all()
    assert np.isnan(board.daf_smooth).all()
    assert (board.surfaces, board.rankings()) == ({}, [])
    text = str(board)
    assert "nan" not in text
    assert "DAE" not in text
    assert json.loads(board.to_json())["values"]["dae"][0][0] == [None]


def test_the_verdict_has_the_moment_in_kn_m_and_its_interval(board, capsys):
    """The static moment of a quarter-car at mid-span is its weight times a quarter span."""
    static = 10e3 * 9.81 * 25 / 4
    assert board.static_peak == pytest.approx(static, rel=1e-12)
    best, *_ = board.rows()
    assert best.strategy == "bridgehook"
    low, high = sorted(-end for end in best.daf_difference[1:])
    own = next(row for row in board.rows() if row.strategy.startswith("passive"))
    print_verdict(board)
    text = " ".join(capsys.readouterr().out.split())
    assert text.startswith(
        f"Lowest mean DAF: bridgehook, {best.daf:.3f}, {-best.daf_difference.mean:.3f} below "
        f"passive 7 kN s/m (95 % confidence: {low:.3f} to {high:.3f}); the largest bending moment "
        f"at 12.5 m is {best.daf * static / 1e3:.0f} kN m on average in place of "
        f"{own.daf * static / 1e3:.0f}, static 613."
    )
    assert f"With bridgehook the body accelerates by {best.body_acceleration:.2g} m/s^2" in text
    assert " ".join(str(board).split()).startswith(text)
    assert json.loads(board.to_json())["summary"][0]["peak_N_m"] == best.daf * board.static_peak


def test_a_section_modulus_gives_stresses_beside_moments(board, capsys):
    best = board.rows()[0].daf * board.static_peak
    print_verdict(board, 1.1)
    print_short(board, 1.1)
    text = " ".join(capsys.readouterr().out.split())
    stress = readable(best / 1.1, "N/m^2")
    assert f"{best / 1e3:.0f} kN m ({stress} MPa)" in text
    assert f" {best / 1e3:.0f} {stress} " in text[text.index("Dynamic amplification") :]


def test_how_the_others_do_is_counted(board, capsys):
    print_verdict(board)
    text = " ".join(capsys.readouterr().out.split())
    (row,) = (row for row in board.rows() if row.strategy == "skyhook")
    word = "clearly" if row.daf_difference.clear else "not distinguishable from"
    assert f"Of the others, skyhook is {word}" in text
    assert "passive 7 kN s/m on these roads." in text


def test_no_ramps_are_simulated_for_a_verdict_alone(capsys, monkeypatch):
    pieces, whole = [], scoring._part

    def noted(study, damper, piece):
        pieces.append(piece)
        return whole(study, damper, piece)

    monkeypatch.setattr(scoring, "_part", noted)
    case, title = [*SCORE, "--strategies", "passive"], "The DAE over the road class"
    short = told(capsys, *case)
    assert pieces == [0]
    assert title not in short
    full = told(capsys, *case, "--full")
    assert pieces[1:] == [0, "unit ramps", "A", "B"]
    assert title in full
    # One answer: the verdict is the same to the letter.
    end = short.index("Dynamic amplification (DAF)")
    assert full[:end] == short[:end]
    assert "Bridge at 678 to 687 m of UTIA road, which ships (measured from 478 to 1022 m)" in short


def test_of_many_strategies_the_short_table_has_the_best_the_own_and_the_last(board, capsys):
    names = (*board.strategies[:2], *(f"law {i}" for i in range(9)), "skyhook")
    index = [0, 1, *9 * [0], 2]
    shift = 1e-3 * np.arange(12)[:, np.newaxis, np.newaxis]
    values = {name: each[index] + shift * (name == "daf") for name, each in board.values.items()}
    many = replace(board, strategies=names, values=values, dampings=12 * (np.nan,),
                   fourth_power_95=board.fourth_power_95[index])  # fmt: skip
    print_short(many)
    out = capsys.readouterr().out
    rows = [row.strategy for row in many.rows()]
    shown = [name for name in rows if re.search(rf"^ {name} ", out, re.MULTILINE)]
    assert shown[:3] == rows[:3]
    assert {names[0], rows[-1]} <= set(shown)
    assert f"leaves out {12 - len(shown)} strategies" in out


# DAE


def test_dae_says_the_critical_speed_the_moment_and_the_ramp_that_does_most(capsys):
    out = told(capsys, *DAE, "--section-modulus", "1.1")
    found = json.loads(told(capsys, *DAE, "--section-modulus", "1.1", "--json"))
    daf, kmh = found["critical_daf"], found["critical_speed_km_per_h"]
    static = found["effect"]["static_peak"]
    total, stress = daf * static / 1e3, daf * static / 1.1e6
    assert out.startswith(f"Critical speed: {kmh:g} km/h, DAF {daf:.4f} (smooth road: ")
    assert f"at 12.5 m is {total:.0f} kN m ({stress:.3f} MPa), static 613 (0.557)." in out
    assert max(found["peak_simulated_N_m"]) == pytest.approx(1e3 * total)
    assert max(found["stress_simulated_N_per_m2"]) == pytest.approx(1e6 * stress)
    ramp = found["largest_contributions"][0]
    assert f"(station {found['road']['bridge_station_m'] + ramp['x_m']:.1f} m)" in out
    assert f"change the DAE by {ramp['contribution']:+.4f}." in out


def test_what_speaks_against_the_dae_is_told(capsys, tmp_path):
    out = told(capsys, *DAE)
    road = bc.utia_road().place_bridge(488).crop(-10, 25).detrend().resample(0.1)
    surface = bc.ramp_surface(bc.li2006.beam(), bc.li2006.car(), np.array([80, 110]) / 3.6,
                              approach=10)  # fmt: skip
    doubted = (~bc.dae_trust(surface, road).trusted).sum()
    says = f"Against it speak, at {doubted} of 2 speeds" if doubted else "nothing speaks against it"
    assert says in out
    x = np.arange(0, 60, 0.1)
    for name, height in (("rough", 40 * np.sin(x)), ("level", 0 * x)):
        rows = "".join(f"{a:.1f},{z:.3f}\n" for a, z in zip(x, height, strict=True))
        (tmp_path / name).write_text(f"x [m],z [mm]\n{rows}", encoding="utf-8")
    rough, level = (told(capsys, DAE[0], tmp_path / name, *DAE[1:]) for name in ("rough", "level"))
    assert re.search(r"at 2 of 2 speeds: .*an IRI of \d+ m/km", rough)
    assert "nothing speaks against it at any speed" in level


def test_a_bridge_file_may_state_the_section_modulus(capsys, tmp_path):
    file = tmp_path / "own.toml"
    own = "spans = 25\nmass_per_length = 18e3\nfrequency = 4.1\n"
    file.write_text(f"{own}section_modulus = 1.1\n", encoding="utf-8")
    stated = told(capsys, *DAE, "--bridge", file)
    assert "MPa" in stated
    assert "--section-modulus" not in stated  # which is what to type next where there is none
    assert "MPa" not in told(capsys, *DAE, "--bridge", file, "--effect", "shear@0")
    twice = told(capsys, *DAE, "--bridge", file, "--section-modulus", "2.2")
    file.write_text(own, encoding="utf-8")
    assert told(capsys, *DAE, "--bridge", file, "--section-modulus", "1.1") == stated
    assert told(capsys, *DAE, "--bridge", file, "--section-modulus", "2.2") == twice
    file.write_text(f"{own}section_modulus = 350e6\n", encoding="utf-8")
    _, _, err = run_command(capsys, *DAE, "--bridge", file)
    assert f"{file}: section_modulus must be in m^3, 1e-05 to 1000, got 3.5e+08: type 0.35" in err


@pytest.mark.parametrize(
    ("effects", "rows"),
    [
        ("deflection@12.5,bridge_acceleration@12.5", [r"deflection@12.5 .* mm .* mm",
         r"bridge_acceleration@12.5 +\d+ +- +- +- +\d\.\d+ m/s\^2"]),
        ("body_acceleration,bridge_acceleration@12.5",
         [r"body_acceleration +\d+ +-?\d\.\d+ m/s\^2 +\d\.\d+ m/s\^2"]),
    ],
)  # fmt: skip
def test_several_effects_have_a_sentence_and_a_row_each(capsys, effects, rows):
    out = run_command(capsys, *DAE, "--effect", effects)[1]
    for name in effects.split(","):
        assert re.search(rf"^{name}: critical speed: \d+ km/h, ", out, re.MULTILINE)
    for row in rows:
        assert re.search(rf"^ {row} *$", out, re.MULTILINE)


# Roads


def test_of_many_tracks_the_roughest_and_those_too_coarse_are_named(capsys, tmp_path):
    x, rng = np.arange(0, 250, 0.25), np.random.default_rng(1)
    tracks = np.cumsum(rng.normal(size=(9, x.size)), axis=1) * np.linspace(0.3, 3, 9)[:, None]
    for name, step in (("close", 1), ("coarse", 4)):
        columns = np.column_stack([x, *tracks])[::step]
        np.savetxt(tmp_path / name, columns, fmt="%.4f", delimiter=",")
    options = ["--units", "m,mm", "--columns", "0,1,2,3,4,5,6,7,8,9"]
    out = told(capsys, "profile", tmp_path / "close", *options)
    found = json.loads(told(capsys, "profile", tmp_path / "close", *options, "--json"))["tracks"]
    worst = max(found, key=lambda track: track["iri_m_per_km"])
    good = sum(track["good"] for track in found)
    assert re.match(rf"{good or 'None'} of 9 tracks (is|are) good", out)
    assert f"the roughest is {worst['name']} with {worst['iri_m_per_km']:.2f} m/km." in out
    assert "... and 1 more; --full has all" in out
    out = told(capsys, "profile", tmp_path / "coarse", *options)
    assert out.startswith("Measured too coarsely for an IRI or a class: ")


# Traffic


def test_assess_says_what_half_and_most_of_the_crossings_stay_below(capsys):
    case = [*ASSESS, "--classes", "A", "--section-modulus", "1.1"]
    out, found = told(capsys, *case), json.loads(told(capsys, *case, "--json"))
    (only,) = found["effects"]
    half, most = (only["daf"][only["quantiles"].index(share)][0] for share in (0.5, 0.95))
    assert out.startswith(
        f"Half of the crossings and 95 % of them have a DAF of the moment below {half:.3f} and "
        f"{most:.3f}"
    )
    stress, total = only["total_stress_N_per_m2"][1][0], only["total"][1][0]
    assert stress == pytest.approx(total / 1.1)
    assert re.search(r"\d+ kN m \(\d\.\d\d MPa\) \d+ kN m \(\d\.\d\d MPa\)", out)


# What comes last


@pytest.mark.parametrize("command", ["dae", "profile"])
def test_what_to_type_next_can_be_typed(capsys, command):
    text = run_command(capsys, *COMMANDS[command])[1]
    steps = re.findall(
        r"^  [a-z ]+?  +((?:--|[A-Z]).*)$", text[text.index("\nNext") :], re.MULTILINE
    )
    assert steps[-1] == "--full"
    assert len(steps) == {"dae": 5, "profile": 2}[command]
    for words in steps:
        _parser([command]).parse_args([command, *words.split()])


def test_what_is_given_is_not_asked_for_again(capsys):
    out = told(capsys, *DAE, "--truck", "T2", "--full", "--section-modulus", "1")
    steps = out[out.index("Next, add to this command for") :]
    assert "your road" in steps
    assert not re.search("your truck|every table|stress", steps)


@pytest.mark.parametrize(
    ("arguments", "says"),
    [
        ([*DAE, "--section-modulus", "0"], "--section-modulus must be above 0 [m^3]"),
        ([*DAE, "--section-modulus", "350e6"], "in m^3, 1e-05 to 1000, got 3.5e+08: type 0.35"),
        ([*DAE, "--section-modulus", "1", "--effect", "shear@0"], "shear@0 is none: leave it out"),
        ([*ASSESS, "--section-modulus", "nan"], "--section-modulus must be finite"),
        ([*SCORE, "--section-modulus", "-1"], "--section-modulus must be above 0 [m^3]"),
        ([*SCORE, "--robust", "--full"], "--full goes with a score, and --robust prints all"),
        ([*SCORE, "--robust", "--section-modulus", "1"], "--section-modulus goes with a score"),
    ],
)  # fmt: skip
def test_nonsense_is_refused_before_the_work(capsys, arguments, says):
    status, out, err = run_command(capsys, *arguments)
    assert (status, out, err.count("\n")) == (2, "", 1)
    assert says in err
