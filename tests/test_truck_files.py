"""Trucks of the catalog and of TOML files, in Python and on the command line."""

import json
import re
import tomllib

import numpy as np
import pytest
from helpers import run_command

import bridgectl as bc
from bridgectl.model.trucks.file import DATA

ONE = """
[[bodies]]
mass = 10500
inertia = 50e3

[[bodies.axles]]
place = -2.5
mass = 900
suspension_stiffness = 6e6
damping = 10e3
tire_stiffness = 1.75e6

[[bodies.axles]]
place = 2.5
mass = 900
suspension_stiffness = 6e6
damping = 10e3
tire_stiffness = 1.75e6
"""
WHEEL = """
sprung_mass = 9000
unsprung_mass = 1000
suspension_stiffness = 80e3
tire_stiffness = 1800e3
damping = 7e3
"""


@pytest.fixture
def file(tmp_path):
    """Write a truck file, and return its name."""

    def written(text, name="truck.toml"):
        path = tmp_path / name
        path.write_text(text, encoding="utf-8")
        return path

    return written


def test_every_truck_of_the_catalog_loads_and_tells_its_source():
    catalog = bc.trucks.catalog()
    assert set(catalog) == {path.stem for path in DATA.glob("*.toml")}
    for name, told in catalog.items():
        truck = bc.trucks.load(name).linear
        assert truck.static_loads.min() > 0
        assert "Source: " in told
        assert "\n" not in told
    masses = {name: bc.trucks.load(name).linear.mass for name in catalog}
    assert masses == pytest.approx(
        {"T2": 12300, "T2A01": 12e3, "T5": 27900, "T5A01": 40e3, "T5air": 40e3, "T5tridem": 40e3,
         "li2006": 10e3}
    )  # fmt: skip


def test_the_papers_truck_is_one_of_them():
    assert bc.trucks.load("li2006") == bc.li2006.car()
    assert bc.trucks.load("T5AIR") == bc.trucks.load("T5air")


def test_the_sample_sets_of_vbi_2d_have_the_numbers_of_their_source():
    """A01_VBI_input_and_run.m: a truck of two axles, and T5air with a tenth of its damping."""
    two, five, air = (bc.trucks.load(name) for name in ("T2A01", "T5A01", "T5air"))
    assert np.diag(two.mass_matrix).tolist() == [10e3, 20e3, 1e3, 1e3]
    assert np.diag(two.stiffness_matrix).tolist() == [2e6, 8e6, 1e6, 1e6]
    assert two.damping_matrix == pytest.approx(0.01 * two.stiffness_matrix)
    assert two.tire_stiffnesses.tolist() == [1e6, 1e6]
    assert two.tire_offsets.tolist() == [0, 4]
    assert np.array_equal(five.mass_matrix, air.mass_matrix)
    assert np.array_equal(five.stiffness_matrix, air.stiffness_matrix)
    assert np.array_equal(five.tire_stiffnesses, air.tire_stiffnesses)
    assert five.damping_matrix == pytest.approx(0.1 * air.damping_matrix)


def test_a_file_of_a_truck_is_that_of_the_catalog(file):
    assert bc.trucks.load(file(ONE)).mass_matrix.tolist() == (
        bc.trucks.load("T2").mass_matrix.tolist()
    )
    assert bc.trucks.load(file(WHEEL)) == bc.li2006.car()
    copy = file((DATA / "T5tridem.toml").read_text(encoding="utf-8"))
    assert bc.trucks.load(str(copy)) == bc.trucks.load("T5tridem")


def test_loads_of_a_file_are_on_the_body(file):
    text = f"{ONE}\n[[bodies.loads]]\nmass = 5000\nplace = 1.0\n"
    text += "\n[[bodies.loads]]\nmass = 100\nplace = -1.0\ninertia = 10\nheight = 1\n"
    truck = bc.trucks.load(file(text))
    axles = [bc.trucks.Axle(place, 900, 6e6, 1.75e6, 1e4) for place in (-2.5, 2.5)]
    body = bc.trucks.Body(10500, 5e4, axles).loaded(5000, 1.0).loaded(100, -1.0, 10, height=1)
    assert truck == bc.trucks.rigid(body)
    assert truck.mass == pytest.approx(17400)


@pytest.mark.parametrize(
    ("text", "says"),
    [
        ("", "lacks bodies: type [[bodies]]"),
        ("bodies = 3", "bodies must be tables: type [[bodies]], and their keys below"),
        ("x = ", "is no TOML: Invalid value"),
        ("x = " + "[" * 5000, "its brackets are too deep"),
        (ONE + "\n[[bodies]]\nmass = 1\ninertia = 1", "bodies[1] lacks axles: type [[bod"),
        (ONE.replace("mass = 900", "masse = 900", 1), "bodies[0].axles[0] has 'masse'"),
        (ONE.replace("place = 2.5\n", ""), "bodies[0].axles[1] lacks place: type place = 2.5"),
        (ONE.replace("-2.5", '"-2.5"'), "bodies[0].axles[0].place must be one number [m], got"),
        (ONE.replace("50e3", "-50e3"), "bodies[0].inertia must be above 0 [kg m^2], got -50000"),
        (ONE.replace("-2.5", "3.5"), "bodies[0].axles must be in order from front to rear"),
        (ONE.replace("-2.5", "1.5"), "axle 'rear' would carry -"),
        (ONE.replace("place = 2.5", "place = 2.5\nname = 2"), 'type name = "drive"'),
        ("hinge = [1, 2]\n" + ONE, "hinge needs two bodies, got one: leave it out"),
        (ONE + ONE, "lacks hinge: type hinge = [3, -5]"),
        (ONE * 3, "bodies must be one, or tractor and trailer, got 3"),
        ("hinge = 3\n" + ONE + ONE, "hinge must have shape (2,), got ()"),
        ("hinge = [-9, -5]\n" + ONE + ONE, "hinge must be behind the tractor's first axle"),
        (ONE + "[[bodies.loads]]\nmass = 3", "bodies[0].loads[0] lacks place"),
        (ONE + "[[bodies.loads]]\nmass = 3\nat = 1", "bodies[0].loads[0] has 'at', which is none"),
        (ONE + "[[bodies.loads]]\nmass = -3\nplace = 1", "bodies[0].loads[0].mass must be above 0"),
        (WHEEL.replace("damping = 7e3", ""), "lacks damping: type damping = 7e3"),
        (WHEEL.replace("9000", "-9"), "sprung_mass must be above 0 [kg], got -9: type 9"),
        (WHEEL + "hinge = 3", "has the key 'hinge', which does not go with sprung_mass"),
        (ONE + "\n[extra]\n", "has the key 'extra', which is none: type one of bodies"),
    ],
)  # fmt: skip
def test_a_bad_file_is_one_error_with_its_name_and_the_key(file, text, says):
    path = file(text)
    with pytest.raises(ValueError, match=re.escape(says)) as caught:
        bc.trucks.load(path)
    message = str(caught.value)
    assert message.startswith(f"{path}: ")
    assert "\n" not in message


def test_a_file_that_is_no_text_or_not_there_is_told(tmp_path):
    (tmp_path / "a.toml").write_bytes(b"\xff\xfe\x00")
    with pytest.raises(ValueError, match="is no UTF-8 text"):
        bc.trucks.load(tmp_path / "a.toml")
    with pytest.raises(ValueError, match="no such file: check the name and the folder, or type a"):
        bc.trucks.load(tmp_path / "b.toml")
    (tmp_path / "c.toml").mkdir()
    with pytest.raises(ValueError, match="is no file but a folder"):
        bc.trucks.load(tmp_path / "c.toml")


@pytest.mark.parametrize(
    ("name", "error", "says"),
    [
        (
            "T5ai",
            ValueError,
            "there is no truck 'T5ai': type T5air, or the name of a file that ends",
        ),
        ("lorry", ValueError, "type one of T2, T2A01, T5, T5A01, T5air, T5tridem, li2006, or"),
        (5, TypeError, 'name must be a string or a Path, got 5: type name="T5air"'),
    ],
)
def test_a_name_that_is_none_is_told_with_those_that_are(name, error, says):
    with pytest.raises(error) as caught:
        bc.trucks.load(name)
    assert says in str(caught.value)


def test_a_file_in_kn_and_tonnes_is_told(file, capsys):
    soft = file(ONE.replace("6e6", "6e3").replace("1.75e6", "1.75e3"))
    with pytest.warns(bc.PlausibilityWarning, match="lowest frequency on a rigid road is 0.0"):
        bc.trucks.load(soft)
    wheel = file(WHEEL.replace("9000", "9").replace("1000", "1"), "wheel.toml")
    with pytest.warns(bc.PlausibilityWarning, match="are its masses in tonnes"):
        bc.trucks.load(wheel)
    status, _, err = run_command(capsys, "trucks", soft)
    assert status == 0
    assert err.count("for kN/m type 1e3 * stiffness") == 1


# The command line

QUICK = ["--approach", "2", "--speeds", "80,100"]


def test_the_command_lists_the_catalog(capsys):
    status, out, err = run_command(capsys, "trucks")
    assert (status, err) == (0, "")
    row = next(line for line in out.splitlines() if line.strip().startswith("T5air "))
    assert " 40 " in row
    assert "55.2 105 78.3 77.3 76.4" in row
    assert "3 7.6 1.1 1.1" in row
    assert "1.41 1.59 5.24" in row
    for name in bc.trucks.catalog():
        assert f"\n{name}: " in out
    table = [line for line in out.splitlines() if not line.strip().startswith(("T", "li2006:"))]
    assert max(map(len, table)) <= 100


def test_json_of_the_command_has_the_numbers_of_every_truck(capsys):
    status, out, err = run_command(capsys, "trucks", "--json")
    assert (status, err) == (0, "")
    trucks = {each["name"]: each for each in json.loads(out)["trucks"]}
    assert set(trucks) == set(bc.trucks.catalog())
    truck = bc.trucks.load("T5")
    assert trucks["T5"]["static_loads_N"] == pytest.approx(truck.static_loads)
    assert trucks["T5"]["axles_behind_first_m"] == pytest.approx(truck.tire_offsets)
    assert trucks["T5"]["natural_frequencies_Hz"] == pytest.approx(truck.frequencies)
    assert trucks["li2006"]["sprung_mass_kg"] == 9000


def test_one_truck_is_told_drawn_and_printed_as_a_file(capsys, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    status, out, err = run_command(capsys, "trucks", "t5tridem", "--plot", "truck.png")
    assert (status, err) == (0, "")
    assert "\nT5tridem: Two-axle tractor" in out
    assert "52.2 82.5 85.9 85.9 85.9" in out
    assert out.endswith("Drawn: truck.png\n")
    assert (tmp_path / "truck.png").stat().st_size > 5000
    status, out, err = run_command(capsys, "trucks", "T5tridem", "--toml")
    assert tomllib.loads(out)["bodies"][0]["mass"] == 4500
    (tmp_path / "own.toml").write_text(out, encoding="utf-8")
    status, out, err = run_command(capsys, "trucks", "own.toml")
    assert (status, err) == (0, "")
    assert "52.2 82.5 85.9 85.9 85.9" in out


@pytest.mark.filterwarnings("ignore:start = -2 m:UserWarning")  # a short approach will do
def test_dae_takes_a_truck_by_name_or_file(capsys, file):
    found = []
    for name in ("T2", file(ONE)):
        status, out, _ = run_command(capsys, "dae", *QUICK, "--truck", name, "--json")
        assert status == 0
        found.append(json.loads(out))
    assert found[0]["daf_simulated"] == found[1]["daf_simulated"]
    assert found[0]["vehicle"]["static_loads_N"] == pytest.approx([60331.5] * 2)
    station = bc.utia_road().x[0] + 2
    road = bc.utia_road().place_bridge(station).crop(-2, 25).detrend().resample(0.1).level(-2)
    daf = bc.daf(bc.li2006.beam(), bc.trucks.load("T2"), np.array([80, 100]) / 3.6, road, start=-2)
    assert found[0]["daf_simulated"] == pytest.approx(daf)


def test_the_options_of_the_quarter_car_are_the_papers_unless_told(capsys):
    status, out, _ = run_command(capsys, "dae", *QUICK, "--damping", "9e3", "--json")
    assert status == 0
    vehicle = json.loads(out)["vehicle"]
    assert (vehicle["damping_N_s_per_m"], vehicle["sprung_mass_kg"]) == (9000, 9000)


@pytest.mark.parametrize(
    ("options", "says"),
    [
        (["dae", "--truck", "T2", "--tire-stiffness", "1e6"],
         "--truck and --tire-stiffness exclude each other: leave one out"),
        (["dae", "--truck", "T6"], "--truck: there is no truck 'T6'"),
        (["dae", "--truck", "none.toml"], "--truck: none.toml: no such file"),
        (["trucks", "--plot", "x.png"], "--plot needs a truck: type its name, as T5air"),
        (["trucks", "--toml"], "--toml needs a truck"),
        (["trucks", "T2", "--plot", "x.gif"], "--plot must end in .png"),
        (["trucks", "T22"], "there is no truck 'T22': type T2, or"),
    ],
)  # fmt: skip
def test_what_does_not_go_together_is_one_line(capsys, options, says):
    status, out, err = run_command(capsys, *options)
    assert (status, out) == (2, "")
    assert err.startswith(f"bridgectl: error: {says}")
    assert err.count("\n") == 1
