"""Readings that are missing: markers are refused, and left out where they are told."""

import gzip
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from helpers import run_command

import bridgectl as bc
from bridgectl.road import ProfileFileError, RoadProfile, read_profile, read_tracks

LIKELY = [
    *(-999, -9999, 999, 9999, 99999, -99999, 999999, -99),
    *(-999.9, 999.9, -99.99, 9999.9, -999.25, -9.999, 0.999),
    *(-32768, 32767, 65535, -2147483648, 8388607, 10000, 100000, 7777, -8888),
]


def write(folder: Path, heights: Any, header: str = "x [m],z [mm]", step: float = 1.0) -> Path:
    """Write a road of heights, in the units of the header."""
    rows = "".join(f"{step * i:g},{z}\n" for i, z in enumerate(heights))
    (folder / "road.csv").write_text(f"{header}\n{rows}")
    return folder / "road.csv"


def refusal(path: Path, **arguments: Any) -> str:
    """Return the line that refuses a file, without the path before it."""
    with pytest.raises(ProfileFileError) as caught:
        read_profile(path, **arguments)
    return str(caught.value).removeprefix(f"{path}:")


def rough(n: int = 60, scale: float = 1e-3) -> list[float]:
    """Heights, rough as a road of class C at steps of 1 m, rounded to 0.1."""
    return np.round(np.cumsum(np.random.default_rng(0).normal(0, 5, n)) * scale / 1e-3, 1).tolist()


@pytest.mark.parametrize("marker", LIKELY)
@pytest.mark.parametrize("unit", ["mm", "m", "mil", "ft", "in"])
def test_a_marker_among_other_heights_is_refused_with_its_line(
    tmp_path: Path, marker: float, unit: str
) -> None:
    heights: list[Any] = [0.0] * 20
    heights[7] = marker
    message = refusal(write(tmp_path, heights, f"x [m],z [{unit}]"))
    assert message.startswith(f"9: the elevation {marker:.12g} {unit} looks like the marker of a ")
    assert f"pass missing={marker:.12g} (--missing={marker:.12g} on the command line)" in message
    assert message.endswith("or missing=() (--missing=none) if it is an elevation")


@pytest.mark.parametrize("text", ["-999", "-999.0", "-999.00", "-9.99e2", " -999 "])
@pytest.mark.parametrize(
    "places", [[0], [59], [30], [30, 31, 32], [0, 1, 2], [58, 59], [5, 20, 40], range(1, 60, 2)]
)
def test_markers_on_a_rough_road_are_refused_wherever_they_stand_and_left_out_if_told(
    tmp_path: Path, text: str, places: Any
) -> None:
    heights: list[Any] = rough()
    kept = np.delete(heights, places)
    for place in places:
        heights[place] = text
    path = write(tmp_path, heights)
    assert refusal(path).startswith(f"{min(places) + 2}: the elevation -999 mm looks like")
    n = len(places)
    told = f"{n} missing reading{'s' * (n > 1)} left out, the first on line {min(places) + 2}; the"
    for missing in (-999, "-999", [-999.0], "nan,-999", np.float64(-999)):
        with pytest.warns(UserWarning, match=told):
            road = read_profile(path, missing=missing)
        np.testing.assert_allclose(road.elevation, 1e-3 * kept, rtol=0, atol=1e-15)
        np.testing.assert_array_equal(road.x, np.delete(np.arange(60.0), places))


@pytest.mark.parametrize("unit", ["m", "mm", "mil"])
@pytest.mark.parametrize("level", [999.0, 9999.0, -999.0, 99.9, 32768.0])
def test_a_road_at_the_height_of_a_marker_is_a_road(
    tmp_path: Path, unit: str, level: float
) -> None:
    heights = np.round(level + 0.02 * np.sin(np.arange(100)), 2)
    heights[50:60] = level
    road = read_profile(write(tmp_path, heights, f"x [m],z [{unit}]"))
    assert road.x.size == 100


def test_a_step_down_to_the_number_of_a_marker_is_a_road(tmp_path: Path) -> None:
    heights = [0.0, 0, 0, -99, -120, -100, -99, -80, 0, 0]
    assert read_profile(write(tmp_path, heights)).x.size == 10


def test_random_roads_of_whole_millimetres_are_read(tmp_path: Path) -> None:
    rng = np.random.default_rng(1)
    alike = 0
    for _ in range(20):
        heights = np.round(np.cumsum(rng.normal(0, 60, 3000))).astype(int)
        alike += np.isin(heights, [999, -999, -99, 9999, -9999]).sum()
        assert read_profile(write(tmp_path, heights)).x.size == 3000
    assert alike > 20


def test_a_column_of_nothing_but_markers_is_refused(tmp_path: Path) -> None:
    path = write(tmp_path, [-9999] * 9)
    assert refusal(path).startswith("2: the elevation -9999 mm looks like the marker")
    assert refusal(path, missing=-9999) == (
        "2: road: without the missing readings 0 of 9 are left: a road needs two or more"
    )


def test_what_looks_like_a_marker_is_an_elevation_if_that_is_said(tmp_path: Path) -> None:
    path = write(tmp_path, [0, 0, -99, 0, 0])
    for missing in ((), [], "none"):
        assert read_profile(path, missing=missing).elevation.min() == pytest.approx(-0.099)


def test_a_marker_beside_the_one_told_is_refused_with_both(tmp_path: Path) -> None:
    path = write(tmp_path, [0, 0, -999, 0, -9999, "nan", 0])
    message = refusal(path, missing=("nan", -999))
    assert message.startswith("6: the elevation -9999 mm")
    assert 'missing="nan,-999,-9999" (--missing=nan,-999,-9999 on' in message


@pytest.mark.parametrize(
    ("word", "missing"),
    [
        ("nan", "nan"),
        ("NaN", float("nan")),
        ("", ""),
        ("N/A", "n/a"),
        ("-", "-"),
        ("*", ("*", -999)),
        ('"NA"', "NA"),
        ("1e30", 1e30),
        ("-1.7E+38", -1.7e38),
        ("inf", float("inf")),
    ],
)
def test_any_word_or_number_may_mark_a_missing_reading(
    tmp_path: Path, word: str, missing: Any
) -> None:
    path = write(tmp_path, [0, 1, word, 3])
    assert refusal(path).startswith("4: expected a finite number in column 1 (counted from 0)")
    with pytest.warns(UserWarning, match="1 missing reading left out, the first on line 4"):
        assert read_profile(path, missing=missing).x.tolist() == [0.0, 1.0, 3.0]


def test_other_words_than_those_told_are_refused(tmp_path: Path) -> None:
    path = write(tmp_path, [0, "nan", "abc", 3])
    assert refusal(path, missing="nan").startswith("4: expected a finite number in column 1")


def test_a_marker_is_not_written(tmp_path: Path) -> None:
    road = RoadProfile(np.arange(9.0), np.array([0, 0, 0, -0.999, 0, 0, 0, 0, 0]))
    with pytest.raises(ValueError, match=r"read_profile would take the elevation -0\.999 m at 3 m"):
        bc.write_profile(tmp_path / "road.csv", road)


def test_a_missing_station_is_refused_in_any_case(tmp_path: Path) -> None:
    path = tmp_path / "road.csv"
    for marker, line in (("-999", 4), ("9999", 4), ("9999", 2)):
        rows = ["0,0", "1,0", "3,0", "4,0"]
        rows.insert(line - 2, f"{marker},0")
        path.write_text("\n".join(["x [m],z [mm]", *rows]))
        for arguments in ({}, {"missing": float(marker)}):
            assert refusal(path, **arguments) == (
                f"{line}: the station {marker} m looks like the marker of a missing one: correct "
                "or remove the line"
            )
    path.write_text("x [m],z [mm]\n998,0\n999,0\n998.5,0\n")
    assert refusal(path).startswith(
        "4: station 998.5 m lies before 999 m on line 3: sort the lines"
    )
    path.write_text("x [m],z [mm]\n0,0\nnan,0\n2,0\n")
    assert refusal(path, missing="nan").startswith("3: expected a finite number in column 0")


def test_a_station_equal_to_the_marker_of_the_heights_stays(tmp_path: Path) -> None:
    path = tmp_path / "road.csv"
    path.write_text("x [m],z [mm]\n998,0\n999,0\n1000,999\n1001,0\n")
    with pytest.warns(UserWarning, match="1 missing reading left out, the first on line 4"):
        assert read_profile(path, missing=999).x.tolist() == [998.0, 999.0, 1001.0]


def test_each_track_misses_its_own_readings(tmp_path: Path) -> None:
    path = tmp_path / "road.csv"
    path.write_text("x [m],l [mm],r [mm],z [mm]\n0,0,1,2\n1,-999,1,2\n# a\n2,0,nan,2\n3,1,1,2\n")
    assert read_profile(path, track="z").x.size == 4
    with pytest.warns(UserWarning, match="missing") as told:
        left, right, other = read_tracks(path, missing=(-999, "nan"))
    assert [track.x.tolist() for track in (left, right)] == [[0.0, 2.0, 3.0], [0.0, 1.0, 3.0]]
    assert other.x.size == 4
    assert [str(one.message).removeprefix(f"{path}: ") for one in told] == [
        "road l: 1 missing reading left out, the first on line 3; the widest gap is now 2 m, after "
        "station 0 m",
        "road r: 1 missing reading left out, the first on line 5; the widest gap is now 2 m, after "
        "station 1 m",
    ]
    assert {one.filename for one in told} == {__file__}


def test_a_track_that_misses_too_much_is_left_out_if_there_are_others(tmp_path: Path) -> None:
    path = tmp_path / "road.csv"
    rows = "".join(f"{0.1 * i:.1f},{i % 3},-999,{-999 if 9 < i < 190 else 0}\n" for i in range(200))
    path.write_text(f"x [m],left [mm],middle [mm],right [mm]\n{rows}")
    with pytest.warns(UserWarning, match="is left out") as told:
        roads = read_tracks(path, missing=-999)
    assert [road.name for road in roads] == ["road left"]
    assert [str(one.message) for one in told] == [
        f"{path}:2: road middle: without the missing readings 0 of 200 are left: a road needs two "
        "or more; road middle is left out",
        f"{path}:192: station 19 m comes 18.1 m after 0.9 m on line 11, where the median step is "
        "0.1 m: correct the station, or cut the file here and read the part before or after the "
        "gap; road right is left out",
    ]
    assert refusal(path, missing=-999, track="right").startswith("192: station 19 m comes 18.1 m")


def test_a_gap_of_missing_readings_too_wide_for_a_road_is_refused(tmp_path: Path) -> None:
    heights: list[Any] = [0] * 400
    heights[100:201] = [-999] * 101
    path = write(tmp_path, heights, step=0.25)
    assert refusal(path, missing=-999) == (
        "203: station 50.25 m comes 25.5 m after 24.75 m on line 101, where the median step is "
        "0.25 m: correct the station, or cut the file here and read the part before or after the "
        "gap"
    )
    heights[199:201] = [0, 0]
    with pytest.warns(UserWarning, match="99 missing readings left out, .* gap is now 25 m, after"):
        read_profile(write(tmp_path, heights, step=0.25), missing=-999)


def test_later_faults_are_told_with_their_own_line(tmp_path: Path) -> None:
    path = write(tmp_path, [0, -999, 0, 0, 5000, 0])
    assert refusal(path, missing=-999).startswith("6: the elevation in mm changes by 5 m over 1 m")


def test_erd_files_are_treated_alike(tmp_path: Path) -> None:
    road = RoadProfile(0.25 * np.arange(30), 1e-3 * np.arange(30.0))
    bc.write_profile(tmp_path / "road.erd", road)
    lines = (tmp_path / "road.erd").read_text().splitlines()
    lines[-4] = "-9999"
    (tmp_path / "road.erd").write_bytes(gzip.compress("\n".join(lines).encode()))
    at = f"{len(lines) - 3}: the elevation -9999 m looks like"
    assert refusal(tmp_path / "road.erd").startswith(at)
    with pytest.warns(UserWarning, match=f"the first on line {len(lines) - 3}; the widest gap"):
        read = read_profile(tmp_path / "road.erd", missing=-9999)
    assert read.x.tolist() == np.delete(road.x, 26).tolist()
    for name in ("decimal", "skip_lines"):
        message = refusal(tmp_path / "road.erd", **{name: {"decimal": ","}.get(name, 1)})
        option = name.replace("_", "-")
        assert message == f" an ERD file states this itself: leave out {name}= (--{option})"


def test_the_command_line_takes_what_the_library_takes(tmp_path: Path, capsys: Any) -> None:
    path = tmp_path / "road.csv"
    rows = "".join(f"{0.25 * i};{i % 7}\n".replace(".", ",") for i in range(200))
    path.write_text(f"A1\nx [m];z [mm]\n{rows.replace('25,5;4', '25,5;-999')}")
    status, out, err = run_command(capsys, "profile", path)
    assert (status, out) == (2, "")
    assert "(--missing=-999 on the command line)" in err.splitlines()[-1]
    status, out, err = run_command(
        capsys, "profile", path, "--missing=-999,nan", "--decimal", ",", "--skip-lines", "1"
    )
    assert status == 0
    assert "1 missing reading left out, the first on line 105; the widest gap is now 0.5 m" in err
