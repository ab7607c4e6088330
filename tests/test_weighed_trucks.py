"""Trucks of weigh-in-motion tables: loads and spacings to the digit, and every bad row named."""

import io
import math
import pickle
import warnings

import numpy as np
import pandas as pd
import pytest

import bridgectl as bc
from bridgectl._toml import parsed
from bridgectl.fleet import weighed
from bridgectl.model.trucks.file import truck_path

HEADER = "time,speed_kmh,load_1_kN,load_2_kN,load_3_kN,spacing_1_m,spacing_2_m"
FIRST = "2026-03-01T00:00:00,90,60,110,,5.0,"
SECOND = "2026-03-01T12:00:00,72,55,80,75,4.5,1.3"
PLAIN = "\n".join([HEADER, FIRST, SECOND])

KEYS = ("mass", "suspension_stiffness", "tire_stiffness", "damping")
DRAWS = (
    [(60, 110), (5,)], [(20, 15), (2.7,)], [(60, 50), (2.0,)], [(60, 90, 80), (4.5, 1.3)],
    [(60, 55, 90, 100), (1.9, 3.5, 1.35)], [(60, 90, 95), (3.6, 7.0)],
    [(60, 100, 70, 70), (3.6, 6.0, 1.35)], [(65, 105, 78, 75, 80), (3.6, 5.5, 1.3, 1.3)],
    [(50, 40, 20, 15, 25), (3.6, 5.5, 1.3, 1.3)], [(60, 70, 70, 80, 80), (3.2, 1.35, 9.0, 1.3)],
    [(10, 90, 20, 5, 100), (3.6, 5.5, 1.3, 1.3)], [(90, 5, 20), (3.6, 5.5)],
    [(60, 75, 75, 70, 70, 70, 65), (3.0, 1.35, 6.0, 1.3, 1.3, 1.3)],
    [(60, 80, 75, 90, 85), (4.8, 1.3, 5.0, 4.5)], [(5, 4), (2.6,)], [(70, 300), (4.0,)],
)  # fmt: skip
"""Axle loads [kN] and spacings [m]: of every layout, some as no truck is loaded."""


@pytest.fixture
def file(tmp_path):
    def write(text, name="weighed.csv", encoding="utf-8"):
        path = tmp_path / name
        path.write_bytes(text.encode(encoding))
        return path

    return write


def table(loads, spacings, **others):
    """A table of one truck."""
    row = {"speed_kmh": 80.0, **others}
    row |= {f"load_{i}_kN": float(load) for i, load in enumerate(loads, start=1)}
    row |= {f"spacing_{i}_m": float(spacing) for i, spacing in enumerate(spacings, start=1)}
    return pd.DataFrame([row])


def same(fleet, other):
    """Whether two fleets have the same trucks, but for round-off of their units."""
    for i in range(len(other)):
        mine, theirs = fleet.passing(i), other.passing(i)
        assert mine.vehicle.static_loads == pytest.approx(theirs.vehicle.static_loads, rel=1e-9)
        assert mine.vehicle.tire_offsets == pytest.approx(theirs.vehicle.tire_offsets, abs=1e-9)
        assert mine.speed == pytest.approx(theirs.speed, rel=1e-9)
        assert mine.time == pytest.approx(theirs.time, abs=1e-6, nan_ok=True)
    return len(fleet) == len(other)


@pytest.mark.parametrize(("loads", "spacings"), DRAWS)
def test_a_truck_carries_what_was_weighed_where_it_was_weighed(loads, spacings):
    for seed in range(20):
        truck = bc.Fleet.from_table(table(loads, spacings), seed=seed).passing(0).vehicle
        assert truck.static_loads == pytest.approx(1e3 * np.array(loads), rel=1e-9)
        assert truck.tire_offsets == pytest.approx(np.cumsum([0, *spacings]), abs=1e-9)


def test_loads_at_random_are_carried_too():
    rng = np.random.default_rng(1)
    for _ in range(150):
        loads, spacings = DRAWS[rng.integers(len(DRAWS))]
        loads = np.array(loads) * rng.uniform(0.2, 1.8, len(loads))
        truck = bc.Fleet.from_table(table(loads, spacings)).passing(0).vehicle
        assert truck.static_loads == pytest.approx(1e3 * loads, rel=1e-9)


def test_loads_are_found_by_springs_in_the_air_too():
    """An independent way: the vehicle let down on its tires by its own equations of motion."""
    truck = bc.Fleet.from_table(table(*DRAWS[7])).passing(0).vehicle
    tires = truck.tire_map.T @ np.diag(truck.tire_stiffnesses) @ truck.tire_map
    y = np.linalg.lstsq(
        truck.stiffness_matrix + tires, 9.81 * truck.mass_matrix @ truck.heave, rcond=None
    )[0]
    forces = truck.tire_stiffnesses * (truck.tire_map @ y)
    assert forces == pytest.approx(1e3 * np.array(DRAWS[7][0]), rel=1e-9)
    assert truck.mass == pytest.approx(1e3 * sum(DRAWS[7][0]) / 9.81, rel=1e-9)


@pytest.mark.parametrize("name", ["T5air", "T5", "T2"])
def test_a_truck_of_the_catalog_is_found_again_from_its_axle_loads(name):
    """With its own axles and tractor: its masses, places and springs, by statics alone."""
    truck = bc.trucks.load(name)
    content = parsed(truck_path(name), "truck", "", "")
    bodies = content["bodies"]
    places = dict(zip(("steer", "drive"), bodies[0]["axles"], strict=True))
    places["trailer"] = bodies[-1]["axles"][-1]
    numbers = {(place, key): axle[key] for place, axle in places.items() for key in KEYS}
    wheelbase = bodies[0]["axles"][1]["place"] - bodies[0]["axles"][0]["place"]
    ends = content.get("hinge", [0.0, 0.0])
    hinge = (ends[0] - bodies[0]["axles"][0]["place"]) / wheelbase
    length = bodies[-1]["axles"][-1]["place"] - ends[1]
    radii = [math.sqrt(body["inertia"] / body["mass"]) for body in bodies]
    for key, value in {
        "tractor_mass": bodies[0]["mass"], "hinge": hinge, "rigid_gyration": radii[0] / wheelbase,
        "tractor_gyration": radii[0] / wheelbase, "trailer_gyration": radii[-1] / length,
    }.items():  # fmt: skip
        numbers["bodies", key] = value
    found = weighed.truck(truck.static_loads, np.diff(truck.tire_offsets), numbers)
    for matrix in ("mass_matrix", "damping_matrix", "stiffness_matrix"):
        given = getattr(truck, matrix)
        assert getattr(found, matrix) == pytest.approx(given, abs=1e-9 * np.abs(given).max())
    assert found.tire_stiffnesses == pytest.approx(truck.tire_stiffnesses, rel=1e-9)
    assert found.frequencies == pytest.approx(truck.frequencies, rel=1e-9)


@pytest.mark.parametrize(
    ("spacings", "kind", "bodies"),
    [
        ((5.0,), "1+1", 1), ((2.0,), "2", 1), ((1.2, 1.2), "3", 1), ((4.5, 1.3), "1+2", 1),
        ((1.9, 3.5, 1.35), "2+2", 1), ((3.6, 7.0), "1+1+1", 2), ((3.6, 2.5), "1+1+1", 2),
        ((3.6, 5.5, 1.3, 1.3), "1+1+3", 2), ((3.2, 1.35, 9.0, 1.3), "1+2+2", 2),
        ((4.8, 1.3, 5.0, 4.5), "1+2+1+1", 2),
    ],
)  # fmt: skip
def test_groups_of_axles_tell_rigid_trucks_from_those_with_a_trailer(spacings, kind, bodies):
    passing = bc.Fleet.from_table(table([60] * (1 + len(spacings)), spacings)).passing(0)
    assert passing.kind == kind
    assert len(passing.vehicle.body_places) == bodies
    assert [name[:3] for name in passing.vehicle.coordinates].count("thB") == bodies


def test_springs_are_nearly_as_drawn_where_axles_share_evenly():
    """Of the trucks that ship, 9 of 10 axles within 20 %."""
    fleet = bc.Fleet.from_table("example")
    factors = []
    for i in range(len(fleet)):
        truck = fleet.passing(i).vehicle
        trailing = truck.tire_stiffnesses[2:] if "1+1+" in fleet.passing(i).kind else []
        factors += [stiffness / 3.5e6 for stiffness in trailing]
    assert len(factors) > 60
    assert np.mean(np.abs(np.array(factors) - 1) < 0.2) > 0.9


def test_a_steel_light_axle_weighs_half_of_its_load():
    truck = bc.Fleet.from_table(table((5, 4), (2.6,))).passing(0).vehicle
    masses = [truck.mass_matrix[i, i] for i in (2, 3)]
    assert masses == pytest.approx([5e3 / 2 / 9.81, 4e3 / 2 / 9.81])


def test_tractors_are_as_drawn_and_lie_on_the_front_of_their_length():
    """Unless loads ask for a lighter one: 80 % of what its springs carry."""
    ships = weighed.read_unweighed(None)
    numbers = ships.drawn([0.5] * len(ships.numbers))
    for loads, spacings in DRAWS:
        row = weighed._Weighed(1e3 * np.array(loads), np.array(spacings), numbers)
        if row.n == len(loads):
            continue
        ends = row.middle(row.places)
        weight, centre, hinge = weighed._balanced(row, ends)
        carried = row.sprung[: row.n].sum()
        assert weight / 9.81 == pytest.approx(min(4500, 0.8 * carried / 9.81), rel=1e-6)
        moment = weight * centre + (carried - weight) * hinge
        assert moment == pytest.approx(row.sprung[: row.n] @ row.places[: row.n], rel=1e-9)
        assert 0 < hinge < row.places[row.n]


def test_time_speed_and_trucks_a_day_are_those_of_the_table(file):
    fleet = bc.Fleet.from_table(file(PLAIN))
    assert len(fleet) == 2
    assert [fleet.passing(i).time for i in range(2)] == [0, 12 * 3600]
    assert [fleet.passing(i).speed for i in range(2)] == pytest.approx([25, 20])
    assert fleet.duration == 12 * 3600
    assert fleet.per_day == pytest.approx(2)  # one more after half a day
    assert fleet.left_out == ()


def test_trucks_stay_in_the_order_of_the_table(file):
    fleet = bc.Fleet.from_table(file("\n".join([HEADER, SECOND, FIRST])))
    assert [fleet.passing(i).time for i in range(2)] == [12 * 3600, 0]
    assert fleet.per_day == pytest.approx(2)


def test_a_table_without_times_knows_no_day():
    fleet = bc.Fleet.from_table(table(*DRAWS[0]))
    assert math.isnan(fleet.passing(0).time)
    assert math.isnan(fleet.per_day)
    assert repr(fleet) == "Fleet(1 weighed trucks of 2 to 2 axles, 22.22 to 22.22 m/s, seed=0)"


def test_the_same_truck_whoever_asks_and_another_seed_other_springs():
    fleet, again = (bc.Fleet.from_table("example", seed=3) for _ in range(2))
    backward = [again.passing(i).vehicle for i in reversed(range(8))][::-1]
    assert [fleet.passing(i).vehicle for i in range(8)] == backward
    other = bc.Fleet.from_table("example", seed=4)
    assert other != fleet
    assert other.passing(0).vehicle != fleet.passing(0).vehicle
    assert same(other, fleet)


def test_a_part_has_the_trucks_of_the_whole_and_no_others():
    fleet = bc.Fleet.from_table("example")
    part = fleet.part([40, 7]).part([1])
    assert len(part) == 1
    assert part.passing(0) == fleet.passing(7)
    assert part.per_day == fleet.per_day
    assert part.duration == fleet.duration
    assert len(pickle.dumps(part)) < 4000 < len(pickle.dumps(fleet)) < 10_000
    assert pickle.loads(pickle.dumps(fleet)) == fleet == bc.Fleet.from_table("example")
    assert hash(fleet) == hash(bc.Fleet.from_table("example"))
    assert fleet != part
    assert fleet._source != "table"
    with pytest.raises(IndexError, match=r"indices must be 0 or more and below 60, .* got 2 to"):
        fleet.part([2, 60])
    with pytest.raises(IndexError, match="i must be below 60, the number of trucks, got 60"):
        fleet.passing(60)


def test_the_example_says_that_it_is_synthetic():
    text = (weighed.DATA / "example.csv").read_text(encoding="utf-8")
    assert text.startswith("# Synthetic")
    assert repr(bc.Fleet.from_table("example")).startswith(
        "Fleet(60 weighed trucks of 2 to 6 axles"
    )


UNITS = [
    ("speed_kmh", 90, "speed [mph]", 90 / 1.609344), ("speed_kmh", 90, "v (m/s)", 25),
    ("load_1_kN", 60, "load_1_N", 60e3), ("load_1_kN", 60, "axle 1 [kg]", 60e3 / 9.81),
    ("load_1_kN", 60, "axle_load_1 [t]", 60 / 9.81), ("load_1_kN", 60, "W1 (kip)", 60 / 4.4482216),
    ("load_1_kN", 60, "weight 1 [lbs]", 60e3 / 4.4482216), ("load_1_kN", 60, "AXLE1_LOAD [KN]", 60),
    ("spacing_1_m", 5, "spacing 1 [cm]", 500), ("spacing_1_m", 5, "S1_mm", 5000),
    ("spacing_1_m", 5, "axle distance 1-2 (ft)", 5 / 0.3048),
]  # fmt: skip


@pytest.mark.parametrize(("name", "value", "other", "converted"), UNITS)
def test_units_are_those_in_the_names_of_the_columns(name, value, other, converted):
    plain = table((60, 110), (5,))
    changed = plain.rename(columns={name: other})
    assert plain[name][0] in (value, 80.0)
    changed[other], plain[name] = converted, value
    fleet, usual = bc.Fleet.from_table(changed), bc.Fleet.from_table(plain)
    assert fleet.passing(0).speed == pytest.approx(usual.passing(0).speed, rel=1e-7)
    loads = [each.passing(0).vehicle.static_loads for each in (fleet, usual)]
    assert loads[0] == pytest.approx(loads[1], rel=1e-7)
    assert fleet.passing(0).vehicle.tire_offsets == pytest.approx([0, 5], rel=1e-7)


def test_units_are_those_that_are_stated():
    bare = table((6, 11), (16.4,)).rename(columns=lambda name: name.rsplit("_", 1)[0])
    units = {"speed": "m/s", "load": "t", "spacing": "ft"}
    bare["speed"] = 20.0
    passing = bc.Fleet.from_table(bare, units=units).passing(0)
    assert passing.speed == 20
    assert passing.vehicle.static_loads == pytest.approx([6e3 * 9.81, 11e3 * 9.81])
    assert passing.vehicle.tire_offsets[1] == pytest.approx(16.4 * 0.3048)


def test_columns_are_those_that_are_named(file):
    text = "Datum;Uhrzeit;V;A;B;AB;Klasse\n01.03.2026;06:00:00;80,5;60,2;110,9;5,02;8\n"
    text += "01.03.2026;07:00:00;81;61;100;4,98;8\n"
    fleet = bc.Fleet.from_table(
        file(text),
        columns={"time": ["Datum", "Uhrzeit"], "speed": "V", "load": ["A", "B"], "spacing": "AB"},
        units={"speed": "km/h", "load": "kN", "spacing": "m", "time": "%d.%m.%Y %H:%M:%S"},
    )
    assert fleet.passing(0).vehicle.static_loads == pytest.approx([60.2e3, 110.9e3])
    assert fleet.passing(1).time == 3600
    assert fleet.passing(0).speed == pytest.approx(80.5 / 3.6)


MESSY = [
    PLAIN + "\n", PLAIN.replace("\n", "\r\n"), PLAIN.replace(",", ";"), PLAIN.replace(",", "\t"),
    "# station 7\n\n// of all lanes\n" + PLAIN, PLAIN.replace("\n", "\n\n") + "\n  \n",
    "Station 7\nexported,today\n" + PLAIN, PLAIN.replace(FIRST, "# a note\n" + FIRST),
    PLAIN.replace(",", ";").replace(".", ","), PLAIN.replace(",", " , "),
    PLAIN.replace(FIRST, FIRST + ",,"), PLAIN.replace(FIRST, FIRST.rstrip(",")),
    PLAIN.replace("60,110,,5.0,", "60,110,0,5.0,0"), PLAIN.replace("5.0", '"5.0"'),
    PLAIN.replace(",", ",lane,", 1).replace("00,", '00,"left, slow",'),
    PLAIN.replace("time", "date,time").replace("T", ","),
    PLAIN.replace("time", "timestamp,date").replace("00:00,", "00:00,2026,"),
    PLAIN.replace("T00", "T01").replace("00,90", "00+01:00,90").replace("00,72", "00Z,72"),
    PLAIN.replace("T", " ").replace("\n", ";\n").replace(",", ";"),
    PLAIN.replace("60,110", "6e1,1.1e2"), PLAIN.replace("60,110", "+60,110.0"),
    PLAIN.replace("time", "time [s]").replace(FIRST[:19], "1000.5").replace(SECOND[:19], "44200.5"),
]  # fmt: skip


@pytest.mark.parametrize("text", MESSY)
def test_files_of_many_dialects_hold_the_same(file, text):
    assert same(bc.Fleet.from_table(file(text)), bc.Fleet.from_table(file(PLAIN, "plain.csv")))


@pytest.mark.parametrize("encoding", ["utf-8-sig", "utf-16"])
def test_marks_of_encodings_are_no_part_of_the_first_name(file, encoding):
    fleet = bc.Fleet.from_table(file(PLAIN, encoding=encoding))
    assert same(fleet, bc.Fleet.from_table(file(PLAIN, "plain.csv")))


def test_letters_of_old_windows_are_read_as_such(file):
    text = "Länge [m];speed_kmh;load_1_kN;load_2_kN;Ort\n5;80;60;70;Köln\n5;8ö;60;70;\n"
    path = file(text, encoding="latin-1")
    with pytest.raises(ValueError, match="line 3: 'speed_kmh' = '8ö' is no number"):
        bc.Fleet.from_table(path, columns={"spacing": "Länge [m]"})
    with pytest.raises(ValueError, match="there are 'Länge \\[m\\]', 'speed_kmh'"):
        bc.Fleet.from_table(path)


def test_a_table_of_pandas_is_as_its_file(file):
    frame = pd.read_csv(io.StringIO(PLAIN))
    assert bc.Fleet.from_table(frame) == bc.Fleet.from_table(file(PLAIN))
    frame["time"] = pd.to_datetime(frame["time"])
    assert bc.Fleet.from_table(frame) == bc.Fleet.from_table(file(PLAIN))
    assert bc.Fleet.from_table(frame.convert_dtypes()) == bc.Fleet.from_table(file(PLAIN))
    twice = pd.concat([frame, frame[["speed_kmh"]]], axis=1)
    with pytest.raises(ValueError, match="the table: two columns are called 'speed_kmh'"):
        bc.Fleet.from_table(twice)
    frame = frame.astype(object)
    assert bc.Fleet.from_table(frame) == bc.Fleet.from_table(file(PLAIN))


@pytest.mark.parametrize(("decimal", "load"), [(",", 60.123), (".", None)])
def test_the_decimal_mark_is_the_one_stated(file, decimal, load):
    text = PLAIN.replace(",", ";").replace(";60;", ";60,123;").replace("5.0", "5").replace(".", ",")
    fleet = bc.Fleet.from_table(file(text), decimal=",")
    assert fleet.passing(0).vehicle.static_loads[0] == pytest.approx(60.123e3)
    if load is None:
        with pytest.raises(ValueError, match=r"line 2: 'load_1_kN' = '60,123' is no number"):
            bc.Fleet.from_table(file(text), decimal=decimal)


def test_commas_that_may_separate_thousands_are_not_guessed(file):
    text = "speed_kmh;load_1_N;load_2_N;spacing_1_m\n80;60,000;90,500;5\n"
    with pytest.raises(ValueError, match=r"'60,000' may be 60.000 or 60000: type decimal=\",\" or"):
        bc.Fleet.from_table(file(text))


BAD = [
    ("90,60,110,,5.0,", "90,,,,5.0,", "has no axles"),
    ("90,60,110,,5.0,", "90,0,0,0,0,0", "has no axles"),
    ("90,60,110,,5.0,", "90,60,,,,", "has one axle"),
    ("90,60,110,,5.0,", "90,60,,110,5.0,", "has a load behind an axle that has none"),
    ("5.0,", ",", "has 2 axles, and no spacing 1"),
    ("5.0,", "0,", "'spacing_1_m' = 0 m is no spacing of an axle, 0.3 to 40 m"),
    ("5.0,", "5.0,1.3", "has 2 axles, and a spacing 2 behind them"),
    ("5.0,", "-5.0,", "'spacing_1_m' = -5 m is no spacing of an axle"),
    ("5.0,", "500,", "'spacing_1_m' = 500 m is no spacing of an axle, 0.3 to 40 m"),
    ("5.0,", "five,", "'spacing_1_m' = 'five' is no number"),
    ("110", "-110", "'load_2_kN' = -110 kN is no load of an axle, 500 to 500000 N"),
    ("110", "11000", "'load_2_kN' = 11000 kN is no load of an axle"),
    ("110", "inf", "'load_2_kN' = 'inf' is no number"),
    ("110", "11o", "'load_2_kN' = '11o' is no number"),
    ("110", "1.1.0", "'load_2_kN' = '1.1.0' is no number"),
    ("90", "0", "'speed_kmh' = 0 km/h is no speed of a truck, 0.1 to 60 m/s"),
    ("90", "900", "'speed_kmh' = 900 km/h is no speed of a truck"),
    ("90", "", "has no speed"), ("90", "fast", "'speed_kmh' = 'fast' is no number"),
    ("2026-03-01T00:00:00", "yesterday", "'time' = 'yesterday' is no time: expected 2026-03-01 "),
    ("2026-03-01T00:00:00", "2026-13-01", "'time' = '2026-13-01' is no time"),
    ("2026-03-01T00:00:00", "", "'time' = '' is no time"),
    ("5.0,", "5.0,,,7", "9 cells, and 7 columns have names"),
    ("5.0,", '5.0,,"a,b"', "8 cells, and 7 columns have names"),
]  # fmt: skip


@pytest.mark.parametrize(("good", "wrong", "says"), BAD)
def test_a_bad_row_is_named_or_left_out_with_a_word(file, good, wrong, says):
    assert good in FIRST
    path = file("\n".join([HEADER, "", SECOND, FIRST.replace(good, wrong, 1), SECOND]))
    with pytest.raises(ValueError, match=r"weighed\.csv, line 4: ") as error:
        bc.Fleet.from_table(path)
    assert says in str(error.value)
    assert str(error.value).endswith('correct the 1 bad of 3 rows, or type bad="leave out"')
    assert "\n" not in str(error.value)
    with pytest.warns(UserWarning, match="^1 of 3 rows are left out: line 4: ") as told:
        fleet = bc.Fleet.from_table(path, bad="leave out")
    assert [warning.filename for warning in told] == [__file__]
    assert len(fleet) == 2
    assert len(fleet.left_out) == 1
    assert says in fleet.left_out[0]


def test_many_bad_rows_are_counted_and_the_first_few_named(file):
    rows = [SECOND, FIRST.replace("60", "x"), SECOND] * 5
    with pytest.warns(
        UserWarning, match=r"^5 of 15 rows are left out: line 3.*line 9: .*; \.\.\.$"
    ):
        fleet = bc.Fleet.from_table(file("\n".join([HEADER, *rows])), bad="leave out")
    assert [text.split(":")[0] for text in fleet.left_out] == [
        f"line {i}" for i in (3, 6, 9, 12, 15)
    ]
    assert fleet.part([0]).left_out == ()


def test_trucks_have_their_own_numbers_whichever_rows_are_left_out(file):
    """A corrected row changes no other truck."""
    rows = [SECOND, FIRST, SECOND]
    whole = bc.Fleet.from_table(file("\n".join([HEADER, *rows])))
    rows[0] = rows[0].replace("55", "x")
    with pytest.warns(UserWarning, match="1 of 3 rows"):
        fewer = bc.Fleet.from_table(file("\n".join([HEADER, *rows])), bad="leave out")
    assert fewer.passing(1).vehicle == whole.passing(2).vehicle


def test_bad_rows_of_a_table_are_told_by_their_labels():
    frame = pd.concat([table((60, 110), (5,)), table((60, -1), (5,))])
    frame.index = ["a", "b"]
    with pytest.raises(ValueError, match=r"^the table, row b: 'load_2_kN' = -1 kN is no load"):
        bc.Fleet.from_table(frame)


def test_seconds_that_are_missing_are_told(file):
    text = PLAIN.replace("time", "time_s").replace(FIRST[:19], "").replace(SECOND[:19], "30")
    with pytest.raises(ValueError, match="line 2: 'time_s' is empty"):
        bc.Fleet.from_table(file(text))


BARE = HEADER.replace("_kmh", "").replace("_kN", "").replace("_m", "")


@pytest.mark.parametrize(
    ("header", "options", "says"),
    [
        (HEADER.replace("speed_kmh", "speed"), {}, "'speed' states no unit, of km/h, m/s, mph: "
         r"type units=\{\"speed\": \"km/h\"\}, or call it 'speed \[km/h\]'"),
        (HEADER.replace("load_2_kN", "load_2"), {}, r"'load_2' states .* call it 'load_2 \[kN\]'"),
        (HEADER.replace("spacing_1_m", "spacing_1 [in]"), {},
         r"'spacing_1 \[in\]' has the unit 'in', of m, cm, mm, ft: .* call it 'spacing_1 \[m\]'"),
        (BARE, {"units": {"speed": "knots"}}, r"units\['speed'\] must be one of km/h, .* 'knots'"),
        (BARE, {"units": {"speed": 3.6}}, r"units\['speed'\] must be one of km/h, .* got 3.6"),
        (BARE, {"units": {"weight": "kN"}}, "units has 'weight': type some of speed, load"),
        (BARE, {"units": "kN"}, r"units must be by what they are, .*type units=\{\"load\": "),
        (HEADER, {"units": {"load": "t"}}, r"'load_1_kN' is in kN, and units says t: leave out"),
        (HEADER.replace("speed_kmh", "vau"), {}, r"no column is called speed_kmh, there are 'time'"
         r", 'vau', .*type columns=\{\"speed\": \"A\"\} with"),
        (HEADER.replace("load", "mass"), {}, r"no column is called load_1_kN and so on.*\[\"A\", "),
        (HEADER.replace("spacing_2_m", "rest"), {}, "3 columns of loads need 2 of spacings, found"),
        (HEADER.replace("spacing_2_m", "speed_mph"), {}, "speed may be any of 'speed_kmh', 'spee"),
        (HEADER, {"columns": {"speed": "V"}}, r"columns\['speed'\] = 'V' is no column of the"),
        (HEADER, {"columns": {"velocity": "V"}}, "columns has 'velocity': type some of speed"),
        (HEADER, {"columns": ["V"]}, r"columns must be by what they are"),
        (HEADER.replace("time", "speed_kmh"), {}, "two columns are called 'speed_kmh': rename one"),
        (HEADER, {"decimal": ";"}, "decimal must be one of '.', ','"),
        (HEADER, {"bad": "ignore"}, "bad must be one of 'error', 'leave out', got 'ignore'"),
        (HEADER, {"seed": -1}, "seed must be 0 or more"),
        (HEADER, {"axles": "no.toml"}, "no.toml: no such file: .* or type none, for what ships"),
    ],
)  # fmt: skip
def test_what_is_not_stated_or_wrong_is_told_with_what_to_type(file, header, options, says):
    with pytest.raises((TypeError, ValueError), match=says) as error:
        bc.Fleet.from_table(file("\n".join([header, FIRST, SECOND])), **options)
    assert "\n" not in str(error.value)


def test_times_in_numbers_need_a_unit_or_a_form(file):
    text = PLAIN.replace(FIRST[:19], "20260301000000").replace(SECOND[:19], "20260301120000")
    with pytest.raises(
        ValueError, match=r"'time' holds numbers without a unit: type units=\{\"time"
    ):
        bc.Fleet.from_table(file(text))
    fleet = bc.Fleet.from_table(file(text), units={"time": "%Y%m%d%H%M%S"})
    assert fleet.passing(1).time == 12 * 3600
    seconds = bc.Fleet.from_table(file(text), units={"time": "s"})
    assert seconds.passing(1).time == 120000
    with pytest.raises(ValueError, match="holds numbers without a unit"):
        bc.Fleet.from_table(pd.read_csv(io.StringIO(text)))
    same_form = bc.Fleet.from_table(pd.read_csv(io.StringIO(text)), units={"time": "%Y%m%d%H%M%S"})
    assert same_form == fleet


@pytest.mark.parametrize(
    ("text", "says"),
    [
        ("", "there is no line of names"), ("# nothing\n\n", "there is no line of names"),
        (HEADER, "has no row of a truck$"), ("1,2\n3,4\n", "no column is called speed_kmh"),
    ],
)  # fmt: skip
def test_files_without_trucks_are_told(file, text, says):
    with pytest.raises(ValueError, match=says):
        bc.Fleet.from_table(file(text))


def test_a_table_of_bad_rows_alone_is_told(file):
    path = file("\n".join([HEADER, FIRST.replace("60", "x")]))
    with pytest.raises(
        ValueError, match=r"has no row of a truck, the first is line 2: 'load_1_kN'"
    ):
        bc.Fleet.from_table(path, bad="leave out")


@pytest.mark.parametrize(
    ("name", "says"),
    [("absent.csv", "no such file"), ("", "folder"), (3, "table must be a string or a Path")],
)
def test_what_is_no_file_is_told(tmp_path, name, says):
    with pytest.raises((TypeError, ValueError), match=says):
        bc.Fleet.from_table(tmp_path / name if isinstance(name, str) else name)


def test_a_name_that_is_empty_is_no_column_of_ours(file):
    text = "\n".join([HEADER + ",", FIRST + ",", SECOND + ",x"])
    assert same(bc.Fleet.from_table(file(text)), bc.Fleet.from_table(file(PLAIN, "plain.csv")))


AXLES = (weighed.DATA / "axles.toml").read_text(encoding="utf-8")


def test_what_is_not_weighed_may_be_of_a_file(file):
    path = file(AXLES.replace("[drive]", "tire_damping = 500\n[drive]"), "axles.toml")
    truck = bc.Fleet.from_table("example", axles=path).passing(2).vehicle
    assert truck.tire_damping.tolist() == [500, 0, 0, 0, 0]
    usual = bc.Fleet.from_table("example").passing(2).vehicle
    assert truck.damper_dampings.tolist() == [10e3] * 5 == usual.damper_dampings.tolist()
    path = file(AXLES.replace("damping = 10e3", "damping = 0"), "axles.toml")
    truck = bc.Fleet.from_table("example", axles=path).passing(2).vehicle
    assert not truck.damping_matrix.any()
    assert truck.static_loads == pytest.approx(usual.static_loads, rel=1e-9)


@pytest.mark.parametrize(
    ("old", "new", "says"),
    [
        ("[trailer]", "[trailers]", "has the key 'trailers'"),
        ("[bodies]", "[trailer.bodies]", r"lacks bodies: type \[bodies\], and tractor_mass"),
        ("hinge = 0.889", "", "bodies lacks hinge: type hinge = 0.889"),
        ("hinge = 0.889", "hinge = -1", "bodies.hinge must be above 0"),
        (
            "rigid_gyration = 0.436",
            "rigid_gyration = 'x'",
            "bodies.rigid_gyration must be a number",
        ),
        ("min = 350", "min = 2000", "steer.mass.min must be below steer.mass.max"),
        ("damping = 10e3", "damping = -1", "steer.damping must be above 0"),
        ("[bodies]", "[[bodies]]", r"bodies must be a table: type \[bodies\]"),
        ("[steer]", "[steer", "is no TOML"),
    ],
)
def test_a_wrong_file_of_axles_is_told_with_its_key(file, old, new, says):
    assert old in AXLES
    path = file(AXLES.replace(old, new, 1), "axles.toml")
    with pytest.raises(ValueError, match=says) as error:
        bc.Fleet.from_table("example", axles=path)
    assert str(error.value).startswith(f"{path}: ")


def test_drawing_warns_of_nothing():
    fleet = bc.Fleet.from_table(table((5, 4), (2.6,)))
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        fleet.passing(0)
