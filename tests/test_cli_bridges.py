"""The command line with bridges of one's own, in options and in files, and with any effect."""

import importlib.resources
import json
import random
import re
import tomllib

import numpy as np
import pytest
from helpers import run_command

import bridgectl as bc
from bridgectl.cli.bridge_file import EXAMPLE, OF_MODES, OF_SPANS, bridge_of_spans, read_bridge
from bridgectl.cli.effects import EFFECTS
from bridgectl.model.supports import Support

QUICK = ["--approach", "2", "--speeds", "80,100"]
OWN = ["--mass-per-length", "18358", "--flexural-rigidity", "4.86535e10"]
MASS = ["--frequency", "4.1", "--mass-per-length"]
TWO = ["--spans", "15,10", *OWN, "--modes", "2"]


def dae(capsys, *options):
    """What `dae --json` tells."""
    status, out, err = run_command(capsys, "dae", *QUICK, *options, "--json")
    assert (status, err) == (0, "")
    return json.loads(out, parse_constant=pytest.fail)


def complaint(capsys, *options, command="dae"):
    """The one line of a command that is refused."""
    status, out, err = run_command(capsys, command, *QUICK, *options)
    assert (status, out) == (2, "")
    assert err.count("\n") == 1
    return err.removeprefix("bridgectl: error: ").rstrip()


def simulated(bridge, effect):
    """Factors or peaks of the measured road where the command takes it."""
    station = bc.utia_road().x[0] + 2
    road = bc.utia_road().place_bridge(station).crop(-2, bridge.length).detrend().resample(0.1)
    simulate = bc.daf if effect.has_static else bc.peak_effect
    speeds = np.array([80, 100]) / 3.6
    return simulate(bridge, bc.li2006.car(), speeds, road.level(-2), start=-2, effect=effect)


def modes_of_a_beam(folder, name="modes.csv", beam=None):
    """A table of the modes of a beam."""
    beam = beam or bc.li2006.beam(n_modes=2)
    x = np.linspace(0, 25, 26)
    rows = [
        ["frequency [Hz]", *beam.frequencies], ["modal mass [kg]", *beam.modal_masses],
        *np.column_stack([x, beam.mode_shapes(x)]),
    ]  # fmt: skip
    text = "\n".join(",".join(map(str, row)) for row in rows)
    (folder / name).write_text(f"x [m],1,2\n{text}\n", encoding="utf-8")
    moments = ", ".join(map(str, beam.modal_moments().tolist()))
    return (
        f'modes = "{name}"\n[[effects]]\nquantity = "moment"\nat = 12.5\n'
        f"places = [0, 12.5, 25]\ninfluence = [0, 6.25, 0]\nmodal = [{moments}]\n"
    )


@pytest.fixture
def file(tmp_path):
    """Write a bridge file, and return its name."""

    def written(text, name="bridge.toml"):
        path = tmp_path / name
        path.write_text(text, encoding="utf-8")
        return path

    return written


# Bridges of options


@pytest.mark.parametrize(
    "options",
    [["--length", "25"], ["--spans", "25"], ["--spans", "25", "--supports", "simple,simple"]],
)
def test_one_simply_supported_span_is_the_beam_of_the_paper(capsys, options):
    own, paper = dae(capsys, *options, *OWN), dae(capsys)
    assert own["bridge"] == paper["bridge"]
    assert own["dae"] == paper["dae"]


def test_several_spans_are_a_bridge_that_json_tells(capsys):
    found = dae(capsys, *TWO, "--supports", "clamped, simple,free", "--damping-ratio", "0.01,0.02")
    assert found["bridge"]["spans_m"] == [15, 10]
    assert found["bridge"]["supports"] == ["clamped", "simple", "free"]
    bridge = bc.Bridge(
        [15, 10], 18358, 4.86535e10, supports=["clamped", "simple", "free"], n_modes=2,
        damping_ratio=[0.01, 0.02],
    )  # fmt: skip
    assert found["bridge"]["frequencies_Hz"] == pytest.approx(bridge.frequencies.tolist())
    assert found["daf_simulated"] == pytest.approx(
        simulated(bridge, bc.Moment(12.5)).tolist(), abs=1e-9
    )


def test_numbers_of_each_span_are_steps_of_the_deck(capsys):
    steps = ["--mass-per-length", "18e3,20e3", "--flexural-rigidity", "4e10,5e10"]
    found = dae(capsys, "--spans", "15,10", *steps)["bridge"]
    assert found["mass_per_length_kg_per_m"] == [18e3, 20e3]
    assert found["flexural_rigidity_N_m2"] == [4e10, 5e10]
    assert found["n_modes"] == 12


@pytest.mark.parametrize("bridge", [["--length", "25"], ["--spans", "15,10"]])
def test_a_frequency_in_place_of_the_rigidity_is_that_of_the_first_mode(capsys, bridge):
    found = dae(capsys, *bridge, "--mass-per-length", "18e3", "--frequency", "4.7")["bridge"]
    assert found["frequencies_Hz"][0] == pytest.approx(4.7, rel=1e-9)


def test_a_damping_ratio_is_that_of_mode_1_of_a_beam_and_of_all_modes_of_spans(capsys):
    beam = dae(capsys, "--length", "25", *OWN, "--damping-ratio", "0.02")
    assert beam["bridge"]["damping_ratio"] == 0.02
    assert beam["dae"] == dae(capsys, "--damping-ratio", "0.02")["dae"]
    span = dae(capsys, "--spans", "25", *OWN, "--damping-ratio", "0.02")
    assert span["bridge"]["damping_ratio"] == [0.02, 0.02, 0.02]


def test_a_rigidity_in_other_units_is_told_with_the_option_to_type(capsys):
    status, _, err = run_command(
        capsys,
        "dae",
        *QUICK,
        "--length",
        "25",
        "--mass-per-length",
        "18",
        "--frequency",
        "4.1",
        "--modes",
        "1",
    )
    assert status == 0
    assert err.startswith("bridgectl: warning: mass_per_length = 18 kg/m is lighter than any deck")
    assert "type --mass-per-length 18000" in err
    _, _, err = run_command(
        capsys, "dae", *QUICK, "--spans", "15,10", "--mass-per-length", "18e3", "--frequency", "90",
        "--effect", "moment@5", "--modes", "1",
    )  # fmt: skip
    assert err.startswith("bridgectl: warning: the first frequency of the beam is 90 Hz")
    assert err.count("\n") == 1


@pytest.mark.parametrize(
    ("options", "says"),
    [
        (["--span", "25", "--spans", "25"], "--spans and --span exclude each other: leave one out"),
        (["--length", "25", "--spans", "25"], "--length and --spans exclude each other"),
        (["--length", "25", "--deck", "Y"], "--length and --deck exclude each other"),
        (["--bridge", "b.toml", "--span", "9"], "--bridge and --span exclude each other"),
        (["--bridge", "b.toml", "--modes", "2"], "--bridge and --modes exclude each other: the fi"),
        (["--bridge", "b.toml", "--frequency", "4"], "--bridge and --frequency exclude each other"),
        (["--frequency", "4"], "--frequency goes with --length or --spans: type one of them, too"),
        (["--supports", "free"], "--supports goes with --length or --spans"),
        (["--length", "25", "--supports", "free"], "--supports goes with --spans: type --spans 25"),
        (["--length", "25"], "--length needs --mass-per-length: type it in kg/m, as 18e3"),
        (["--spans", "9", "--mass-per-length", "18e3"], "--spans needs --flexural-rigidity [N m^2"),
        ([*TWO, "--frequency", "4"], "--flexural-rigidity and --frequency exclude each other"),
        ([*MASS, "1e4,2e4", "--spans", "9,9,9"], "--mass-per-length must be one number, or one of"),
        ([*MASS, "1,2", "--length", "9"], "--mass-per-length must be one number, got 2"),
        (["--spans", "9;9", *OWN], "--spans must be numbers separated by commas, got '9;9'"),
        (["--spans", "9,-9", *OWN], "--spans[1] must be above 0 [m], got -9: type 9"),
        (["--length", "0", *OWN], "--spans[0] must be above 0 [m], got 0"),
        ([*TWO, "--supports", "simple,simple"], "--supports must be 3 for 2 spans, got 2"),
        ([*TWO, "--supports", "simple,pin,free"], "--supports[1] must be one of 'simple', 'clamp"),
        ([*TWO, "--supports", "free,free,free"], "--supports leave the bridge free to fall"),
        ([*MASS, "-1", "--length", "9"], "--mass-per-length must be above 0 [kg/m], got -1: t"),
        (["--length", "9", "--mass-per-length", "1e4", "--frequency", "0"], "--frequency must be "),
        (["--length", "9", *OWN, "--damping-ratio", "2"], "for 2 percent type 0.02"),
        (["--length", "600", "--mass-per-length", "18e3", "--frequency", "0.3"], "602 m are need"),
    ],
)  # fmt: skip
def test_options_that_do_not_go_together_are_one_line(capsys, options, says):
    assert says in complaint(capsys, *options)


# Bridges of files


def test_the_example_ships_and_is_what_the_help_shows(capsys):
    path = importlib.resources.files("bridgectl.cli") / "data" / "two_spans.toml"
    assert path.read_text(encoding="utf-8") == EXAMPLE.read_text(encoding="utf-8")
    with pytest.raises(SystemExit):
        run_command(capsys, "dae", "--help")
    out = capsys.readouterr().out
    for line in EXAMPLE.read_text(encoding="utf-8").splitlines():
        assert f"  {line}\n" in out
    assert all(len(line) <= 100 for line in out.splitlines())


def test_the_example_is_two_spans_with_a_stepped_deck_and_an_elastic_bearing(capsys, file):
    bridge = bc.Bridge(
        [25, 25], 18358, [(20, 4.9e10), (10, 7e10), (20, 4.9e10)],
        supports=["simple", "simple", Support(5e8)], n_modes=8, damping_ratio={1: 0.02, 3: 0.03},
    )  # fmt: skip
    assert read_bridge("example") == bridge
    assert read_bridge(str(file(EXAMPLE.read_text(encoding="utf-8")))) == bridge
    found = dae(capsys, "--bridge", "example", "--effect", "hogging@25")
    assert found["bridge"]["supports"][2] == {"vertical": 5e8, "rotational": 0}
    assert found["bridge"]["damping_ratio"] == [[1, 0.02], [3, 0.03]]
    expected = simulated(bridge, bc.Moment(25.0, sense="smallest"))
    assert found["daf_simulated"] == pytest.approx(expected.tolist(), abs=1e-9)


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        (
            "spans = 25\nmass_per_length = 18358\nflexural_rigidity = [[25, 4.9e10]]",
            bc.Beam(25, 18358, 4.9e10),
        ),
        (
            "spans = [25]\nmass_per_length = [18358]\nflexural_rigidity = 4.9e10\n"
            "damping_ratio = [0.01, 0.02]",
            bc.Beam(25, 18358, 4.9e10, 2, (0.01, 0.02)),
        ),
        (
            "spans = 25\nmass_per_length = 18358\nflexural_rigidity = 4.9e10\n"
            "damping_ratio = {1 = 0.02, 2 = 0.02}",
            bc.Bridge(25, 18358, 4.9e10, damping_ratio={1: 0.02, 2: 0.02}),
        ),
        (
            "spans = 25\nmass_per_length = 18358\nflexural_rigidity = 4.9e10\n"
            "supports = ['simple', {vertical = inf, rotational = 1e9}]",
            bc.Bridge(25, 18358, 4.9e10, supports=["simple", Support(np.inf, 1e9)]),
        ),
    ],
)
def test_a_file_is_a_beam_where_its_modes_are_closed_forms_and_else_a_bridge(file, text, expected):
    assert read_bridge(str(file(text))) == expected


def test_a_frequency_of_a_deck_on_springs_is_found_or_refused(file):
    text = (
        "spans = [25, 25]\nmass_per_length = 18358\nfrequency = {}\n"
        "supports = ['simple', {{vertical = 1e8}}, 'simple']"
    )
    assert read_bridge(str(file(text.format(3.0)))).frequencies[0] == pytest.approx(3, rel=1e-8)
    spring = {"supports": ["simple", {"vertical": 1e7}]}
    with pytest.raises(ValueError, match=r"frequency of 4 Hz is more than the springs of the"):
        bridge_of_spans({"spans": 25, "mass_per_length": 18358, "frequency": 4, **spring})


def test_a_table_of_modes_crosses_as_the_beam_that_they_are_of(capsys, file, tmp_path):
    path = file(modes_of_a_beam(tmp_path))
    found, beam = dae(capsys, "--bridge", path), dae(capsys, "--modes", "2")
    assert found["daf_simulated"] == pytest.approx(beam["daf_simulated"], abs=1e-5)
    assert found["bridge"]["effects"] == [["moment", 0.5]]
    assert found["bridge"]["frequencies_Hz"] == pytest.approx(beam["bridge"]["frequencies_Hz"])
    damped = read_bridge(str(file(f"damping_ratio = 0.02\n{modes_of_a_beam(tmp_path)}")))
    assert damped.damping_ratios.tolist() == [0.02, 0.02]
    says = complaint(capsys, "--bridge", path, "--effect", "moment@5")
    assert says.endswith("the bridge tells no bending moment at 5 m: type --effect moment@12.5")
    says = complaint(capsys, "--bridge", path, "--section", "0.2", command="score")
    assert says.endswith("the bridge tells no bending moment at 5 m: type --section 0.5")
    says = complaint(capsys, "--bridge", path, "--effect", "shear@5")
    assert says.endswith("the bridge tells no shear force at 5 m: leave it out")
    assert "deflection at 25 m is 0" in complaint(
        capsys, "--bridge", path, "--effect", "deflection@25"
    )


DECK = "spans = [25, 25]\nmass_per_length = 18358\nflexural_rigidity = 4.9e10\n"


@pytest.mark.parametrize(
    ("text", "says"),
    [
        ("", "lacks spans: type spans = [25, 30]"),
        ("spans = [25]", "lacks mass_per_length: type mass_per_length = 18e3"),
        ("spans = [25]\nmass_per_length = 1e4", "must have either flexural_rigidity or frequency"),
        (f"{DECK}frequency = 4", "must have either flexural_rigidity or frequency: type flexural"),
        (f"{DECK}span = 25", "has the key 'span', which is none: type one of spans, mass_per_len"),
        (f"{DECK}effects = []", "has the key 'effects', which does not go with spans: type one of"),
        (f"{DECK}modes = 'm.csv'", "has the key 'spans', which does not go with modes: type one"),
        (f"{DECK}spans = 2\n", "is no TOML: Cannot overwrite a value (at line 4, column 10)"),
        ("spans [25]", "is no TOML: Expected '=' after a key in a key/value pair (at line 1, col"),
        ("spans = [[25]]\nmass_per_length = 1\nfrequency = 4", "spans[0] must be one number [m]"),
        ("spans = '25'\nmass_per_length = 1\nfrequency = 4", "spans must be one number [m], got"),
        ("spans = []\nmass_per_length = 1\nfrequency = 4", "spans must hold at least one length"),
        (DECK.replace("25,", "true,"), "spans[0] must be one number [m], got True"),
        (DECK.replace("18358", "[[20, 1e4]]"), "mass_per_length has pieces up to 20 m, the bridge"),
        (DECK.replace("18358", "[[20, 1e4, 3]]"), "mass_per_length[0] must be a pair (length [m]"),
        (DECK.replace("18358", "1979-05-27"), "mass_per_length must be one number [kg/m], got"),
        (DECK.replace("4.9e10", "[1e10, 2e10, 3e10]"), "one a span (2), or pieces [length, value"),
        (f"{DECK}supports = 'simple'", "type supports=['simple', 'simple', 'simple']"),
        (f"{DECK}supports = ['simple', 'simple', {{up = 1}}]", "type {vertical = 5e8, rotational"),
        (f"{DECK}supports = [1, 2, 3]", "supports[0] must be one of 'simple', 'clamped', 'free'"),
        (f"{DECK}n_modes = 2.0", "n_modes must be a whole number, got 2.0: type 2"),
        (f"{DECK}n_modes = 2\ndamping_ratio = {{1 = 0.1, 3 = 0.1}}", "type damping_ratio={1 ="),
        (f"{DECK}damping_ratio = {{first = 0.1}}", "damping_ratio has the key 'first', expected"),
        (f"{DECK}damping_ratio = 5", "for 5 percent type 0.05"),
        ("modes = 5", "modes must name a CSV file, got 5: type modes = \"modes.csv\""),
        ("modes = 'm.csv'\nn_modes = 2", "has the key 'n_modes', which does not go with modes"),
        ("modes = 'm.csv'\neffects = 'moment'", "effects must be tables: type [[effects]]"),
        ("modes = 'm.csv'\ndamping_ratio = {1 = 2}", "damping_ratio of modes must be one number"),
        ("modes = 'bad.csv'", "bad.csv: line 2 has 'two', which is no number"),
        ("modes = 'm.csv'\n[[effects]]\nquantity = 'moment'", "effects[0] lacks at: type at ="),
        ("modes = 'm.csv'\n[[effects]]\nsort = 1", "effects[0] has 'sort', which is none: type"),
        ("modes = 'm.csv'\nmass_per_length = 1", "effects[0] lacks quantity: type quantity ="),
    ],
)  # fmt: skip
def test_a_mistake_in_a_file_names_the_file_and_the_key(capsys, file, tmp_path, text, says):
    modes_of_a_beam(tmp_path, "m.csv")
    (tmp_path / "bad.csv").write_text("frequency,1\n0,two\n", encoding="utf-8")
    path = file(text + "\n[[effects]]" * text.endswith("mass_per_length = 1"))
    message = complaint(capsys, "--bridge", path)
    assert message.startswith(f"{path}: ")
    assert says in message


@pytest.mark.parametrize(
    ("old", "new", "says"),
    [
        ("12.5\n", "30\n", "effects[0].at must be on the bridge, 0 to 25 m, got 30"),
        ("12.5\n", "'x'\n", "effects[0].at must be one number [m], got 'x'"),
        ('"moment"', '"twist"', "effects[0].quantity must be one of 'moment', 'shear', 'reaction'"),
        ("[0, 12.5, 25]", "[0, 25, 12]", "effects[0].places must be two places [m] or more, each"),
        ("[0, 6.25, 0]", "[0, 6.25]", "effects[0].influence must have shape (3,)"),
        ("modal = [", "modal = [1, 2, ", "effects[0].modal must have shape (2,)"),
    ],
)
def test_a_mistake_in_an_effect_of_modes_names_its_key(capsys, file, tmp_path, old, new, says):
    text = modes_of_a_beam(tmp_path)
    assert old in text
    assert says.split(" must")[0] in complaint(capsys, "--bridge", file(text.replace(old, new)))
    twice = text + text.split("\n", 1)[1]
    assert "effects has the moment at 12.5 m twice" in complaint(capsys, "--bridge", file(twice))


def test_files_that_are_none_are_one_line(capsys, tmp_path):
    told = complaint(capsys, "--bridge", tmp_path / "nowhere.toml")
    assert "nowhere.toml: no such file: check the name and the folder" in told
    assert "is no file but a folder" in complaint(capsys, "--bridge", tmp_path)
    path = tmp_path / "binary.toml"
    path.write_bytes(b"\xff\xfe\x00s")
    assert "is no UTF-8 text" in complaint(capsys, "--bridge", path)
    path.write_text("a = " + "[" * 100_000, encoding="utf-8")
    assert "is no TOML" in complaint(capsys, "--bridge", path)
    path.write_text('modes = "gone.csv"', encoding="utf-8")
    assert "gone.csv" in complaint(capsys, "--bridge", path)


def test_what_can_hardly_be_meant_is_told_with_the_file_and_its_key(capsys, file):
    path = file(f"{DECK}damping_ratio = 0.5")
    status, _, err = run_command(capsys, "dae", *QUICK, "--bridge", path, "--effect", "moment@10")
    assert status == 0
    assert err.startswith(f"bridgectl: warning: {path}: damping_ratio = 0.5 is 50 percent of cri")
    assert "type damping_ratio = 0.005" in err
    assert err.count("\n") == 1


def why_refused(path):
    """What is wrong with a file; nothing if it is a bridge."""
    try:
        assert read_bridge(str(path)).n_modes > 0
    except (ValueError, OSError) as error:
        return str(error)
    return ""


@pytest.mark.filterwarnings("ignore")
def test_a_damaged_file_is_a_bridge_or_one_line_that_names_it(file, tmp_path):
    rng, texts, read = random.Random(0), [EXAMPLE.read_text(encoding="utf-8")], 0
    texts.append(modes_of_a_beam(tmp_path))
    words = ["", "[", "]", "{", "'", "-", "nan", "inf", "true", "0", "1e99", ",", "=", "\n", "25"]
    for i in range(150):
        text = texts[i % 2]
        for _ in range(rng.randrange(1, 4)):
            at = rng.randrange(len(text))
            text = text[:at] + rng.choice(words) + text[at + rng.randrange(3) :]
        path = file(text)
        told = why_refused(path)
        assert told == "" or str(tmp_path) in told
        read += not told
    assert 10 < read < 140  # else the damage is of one kind


def test_the_docstring_has_every_key():
    from bridgectl.cli import bridge_file

    assert tomllib.loads(EXAMPLE.read_text(encoding="utf-8")).keys() <= set(OF_SPANS)
    for key in (*OF_SPANS, *OF_MODES, *bridge_file.OF_EFFECT):
        assert re.search(rf"\b{key}\b", bridge_file.__doc__)


# Effects


@pytest.mark.quick_cases(4)
@pytest.mark.parametrize(
    ("text", "effect"),
    [
        ("moment@5", bc.Moment(5.0)),
        ("sagging", bc.Moment(12.5)),
        (" Hogging@15 ", bc.Moment(15.0, sense="smallest")),
        ("shear@0", bc.Shear(0.0)),
        ("least_shear@15", bc.Shear(15.0, sense="smallest")),
        ("reaction@15", bc.Reaction(15.0)),
        ("deflection", bc.Deflection(12.5)),
        ("least_deflection@5", bc.Deflection(5.0, sense="smallest")),
        ("tire_force", bc.TireForce()),
        ("least_tire_force", bc.TireForce(sense="smallest")),
        ("bridge_acceleration@5", bc.BridgeAcceleration(5.0)),
        ("least_body_acceleration", bc.BodyAcceleration(sense="smallest")),
    ],
)
def test_each_effect_is_that_of_the_library(capsys, text, effect):
    found = dae(capsys, *TWO, "--effect", text)
    expected = simulated(bc.Bridge([15, 10], 18358, 4.86535e10, n_modes=2), effect)
    key = "daf_simulated" if effect.has_static else "peak_simulated_m_per_s2"
    assert found[key] == pytest.approx(expected.tolist(), abs=1e-9)
    worst = np.argmin if text.strip().startswith("least_t") or (effect.sense == "smallest" and (
        not effect.has_static)) else np.argmax  # fmt: skip
    assert found["critical_speed_km_per_h"] == pytest.approx([80, 100][worst(expected)])
    told = found["effect"]
    assert (told["sense"], told["unit"]) == (effect.sense, effect.unit)
    assert told["at_m"] == getattr(effect, "at", None)
    assert ("static_peak" in told) == effect.has_static


def test_recovery_is_that_of_moments_alone(capsys):
    found = dae(capsys, "--recovery", "li2006", "--effect", "moment@10,deflection")["effects"]
    beam = bc.li2006.beam()
    expected = simulated(beam, bc.Moment(10.0, recovery="li2006"))
    assert found[0]["daf_simulated"] == pytest.approx(expected.tolist(), abs=1e-9)


def test_several_effects_are_tables_and_figures_with_their_names(capsys, tmp_path):
    status, out, err = run_command(
        capsys, "dae", *QUICK, *TWO, "--effect", "moment@5,hogging@15", "--plot",
        tmp_path / "dae.png", "--full",
    )  # fmt: skip
    assert (status, err) == (0, "")
    assert "Bridge: Bridge(15 + 10 m, supports simple, simple, simple" in out
    assert out.startswith("moment@5: critical speed: ")
    assert "Dynamic amplification by speed: largest bending moment at 5 m" in out
    assert "Dynamic amplification by speed: smallest bending moment at 15 m" in out
    first, second = tmp_path / "dae_moment_5.png", tmp_path / "dae_hogging_15.png"
    assert f"Drawn: {first}, {second}" in " ".join(out.split())
    assert first.stat().st_size > 10_000
    assert second.stat().st_size > 10_000


def test_what_is_no_factor_is_told_with_its_unit_and_never_called_one(capsys, tmp_path):
    options = [*TWO, "--effect", "bridge_acceleration@5"]
    status, out, _ = run_command(capsys, "dae", *QUICK, *options)
    assert status == 0
    assert "Peaks by speed [m/s^2]: largest acceleration of the bridge at 5 m" in out
    assert re.search(r"Critical speed: \d+ km/h, \d\.\d{4} m/s\^2 \(smooth road", out)
    assert not re.search(r"DAF|DAE|amplification", out)
    assert not re.search(r"\bdaf|\bdae|_dae", json.dumps(dae(capsys, *options)))
    says = complaint(capsys, *options, "--plot", tmp_path / "a.png")
    assert "--plot draws factors whose largest is the worst, and bridge_acceleration@5 has" in says
    says = complaint(capsys, "--effect", "least_tire_force", "--plot", tmp_path / "a.png")
    assert "least_tire_force has none" in says
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize(
    ("text", "says"),
    [
        ("momnt@5", "--effect: there is no 'momnt': type moment"),
        ("x", "--effect: there is no 'x': type one of moment, shear, "),
        ("moment@", "--effect moment@ must have a place on the bridge, from 0 to 25 m: for"),
        ("moment@30", "from 0 to 25 m: for halfway type moment@12.5"),
        ("tire_force@5", "--effect tire_force@5: that of the vehicle has no place: type tire"),
        ("moment,moment", "--effect names 'moment' twice: leave one out"),
        ("reaction@5", "no support reaction at 5 m: type --effect reaction@0 or --effect rea"),
        ("moment@0", "the bending moment at 0 m is 0, whatever crosses: type another place, as"),
        ("deflection@15", "the deflection at 15 m is 0, whatever crosses: type another place"),
        ("bridge_acceleration@25", "the acceleration of the bridge at 25 m is 0, whatever crosses"),
        ("moment@15", "makes no factor: type another place, as moment@6, or hogging@15"),
        ("least_reaction@15", "makes no factor: type another place, as least_reaction@6, or reac"),
    ],
)  # fmt: skip
def test_an_effect_that_there_is_not_is_one_line(capsys, text, says):
    assert says in complaint(capsys, *TWO, "--effect", text)


def test_beams_have_neither_moments_nor_inner_reactions_at_their_ends(capsys):
    assert "the bending moment at 25 m is 0" in complaint(capsys, "--effect", "moment@25")
    assert "type --effect reaction@0 or --effect reaction@25" in complaint(
        capsys, "--effect", "reaction@5"
    )
    assert dae(capsys, "--effect", "reaction@25")["effect"]["unit"] == "N"


def test_section_is_short_for_a_moment_there(capsys):
    short, long = dae(capsys, "--section", "0.4"), dae(capsys, "--effect", "moment@10")
    assert short["daf_simulated"] == long["daf_simulated"]
    assert short["effect"]["at_m"] == 10
    assert complaint(capsys, "--section", "0.4", "--effect", "deflection").endswith(
        "exclude each other: for a moment there type --effect moment@10"
    )
    halfway = ["--spans", "15,15", *OWN]
    says = complaint(capsys, *halfway)
    assert says.startswith("--section 0.5: the largest bending moment at 15 m is 0 while the vehi")
    assert says.endswith("makes no factor: type another --section, as 0.2")


def test_each_effect_of_the_list_has_a_name_in_the_help(capsys):
    with pytest.raises(SystemExit):
        run_command(capsys, "dae", "--help")
    out = " ".join(capsys.readouterr().out.split())
    assert all(name in out for name in EFFECTS)


# Scores


def test_a_score_of_a_bridge_tells_it_and_goes_on_for_it_alone(capsys, tmp_path):
    quick = ["--approach", "2", "--speeds", "80", "--workers", "1", "--random", "1", "--strategies",
             "passive", "--resume", tmp_path / "score.jsonl"]  # fmt: skip
    bridge = ["--spans", "9,9", *OWN, "--modes", "2", "--section", "0.2"]
    status, out, err = run_command(capsys, "score", *quick, *bridge)
    assert (status, err) == (0, "")
    assert "the largest bending moment at 3.6 m is" in " ".join(out.split())
    assert "Bridge of 18 m, first frequency" in out
    status, out, _ = run_command(capsys, "score", *quick, *bridge, "--json")
    found = json.loads(out, parse_constant=pytest.fail)
    assert found["bridge"]["spans"] == [9, 9]
    assert found["effect"]["told"] == "largest bending moment at 3.6 m"
    other = [*bridge, "--supports", "simple,simple,clamped"]
    status, _, err = run_command(capsys, "score", *quick, *other)
    assert status == 2
    assert "holds another study: its beam is " in err
    assert "--section 0.5: the largest bending moment at 9 m is 0" in complaint(
        capsys, *bridge[:-2], command="score"
    )
