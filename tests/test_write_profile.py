"""Writing road files: what is read back is what was written."""

import os
import tempfile
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from bridgectl.road import RoadProfile, read_profile, read_tracks, utia_road, write_profile
from bridgectl.road.files import write

ROAD = RoadProfile([0.0, 0.1, 0.2], [0.0, 0.001, 1e-17], name="left")
NAMES = st.text(max_size=50) | st.sampled_from(
    ["lane 2", 'a,b;"c"', "z [mm]", "x\ny\r\x85\u2028z", "2004", "'q'", "# a", "nan", "END", "m"]
)


@st.composite
def roads(draw: st.DrawFn, even: bool) -> list[RoadProfile]:
    """Return one to three tracks with the same stations."""
    n = draw(st.integers(2, 30))
    start = draw(st.floats(-1e5, 1e5))
    if even:
        x = start + draw(st.floats(0.002, 4.0)) * np.arange(n)
    else:
        x = start + np.cumsum(draw(st.lists(st.floats(0.002, 4.0), min_size=n, max_size=n)))
    slopes = st.lists(st.floats(-0.99, 0.99), min_size=n - 1, max_size=n - 1)
    climbs = [np.append(0.0, np.cumsum(draw(slopes) * np.diff(x)))]
    climbs += [climbs[0] * draw(st.floats(-1, 1)) for _ in range(draw(st.integers(0, 2)))]
    return [RoadProfile(x, z, name=draw(NAMES)) for z in climbs]


def written(tracks: list[RoadProfile], name: str) -> list[RoadProfile]:
    """Return what is read of a file that was written."""
    with tempfile.TemporaryDirectory() as folder:
        write_profile(Path(folder, name), tracks)
        assert os.listdir(folder) == [name]
        return read_tracks(Path(folder, name))


@pytest.mark.slow
@given(tracks=roads(even=False))
@settings(max_examples=200, deadline=None)
def test_csv_keeps_every_digit(tracks: list[RoadProfile]) -> None:
    assert written(tracks, "road.csv") == tracks


@given(tracks=roads(even=True))
@settings(max_examples=200, deadline=None)
def test_erd_keeps_every_digit_of_the_elevations(tracks: list[RoadProfile]) -> None:
    found = written(tracks, "road.erd")
    assert len(found) == len(tracks)
    for road, expected in zip(found, tracks, strict=True):
        assert np.array_equal(road.elevation, expected.elevation)
        np.testing.assert_allclose(road.x, expected.x, rtol=0, atol=1e-9)


@pytest.mark.parametrize("step", [0.1, 0.25, 0.05, 1 / 3, 0.0630682])
@pytest.mark.parametrize("start", [0.0, -13.7, 478.0])
def test_erd_keeps_stations_at_a_step_exactly(step: float, start: float) -> None:
    measured = utia_road()
    x = measured.x - measured.x[0] + start
    road = RoadProfile(x, measured.elevation).resample(step)
    assert written([road], "road.erd") == [road]


def test_a_measured_road_is_kept_in_both_formats() -> None:
    for name in ("road.csv", "road.ERD"):
        assert written([utia_road()], name) == [utia_road()]


@pytest.mark.parametrize("suffix", ["csv", "erd"])
@pytest.mark.parametrize(
    ("name", "label"),
    [
        ("left", "left"),
        ("lane 2", "lane 2"),
        ("2004", "2004"),
        ("wheel [in]", "wheel [in]"),
        ("räum", "räum"),
        ('a,b;c"d"', "a b c d"),
        ("a\n\tb\r\x85", "a b"),
        ("", "track 0"),
    ],
)
def test_names_become_labels(suffix: str, name: str, label: str) -> None:
    if suffix == "erd" and "," in name:
        label = "a b c d"
    tracks = [RoadProfile(ROAD.x, ROAD.elevation, name=name), ROAD]
    found = written(tracks, f"road.{suffix}")
    assert [road.name for road in found] == [f"road {label}", "road left"]


def test_a_csv_file_says_its_columns_and_units(tmp_path: Path) -> None:
    path = tmp_path / "lane.csv"
    write_profile(path, [ROAD, RoadProfile(ROAD.x, -ROAD.elevation, name="right")])
    assert path.read_bytes() == (
        b"x [m],left [m],right [m]\n0.0,0.0,-0.0\n0.1,0.001,-0.001\n0.2,1e-17,-1e-17\n"
    )


def test_an_erd_file_says_its_channels_and_units(tmp_path: Path) -> None:
    path = tmp_path / "lane.erd"
    write_profile(path, ROAD)
    assert path.read_text().splitlines() == [
        "ERDFILEV2.00",
        "1, 3, -1, 1, 5, 0.1, -1,",
        "TITLE   left",
        "SHORTNAMleft    ",
        "LONGNAMEleft".ljust(40),
        "UNITSNAMm       ",
        "XLABEL  Distance",
        "XUNITS  m",
        "XSTART  0.0",
        "END",
        "0.0",
        "0.001",
        "1e-17",
    ]


def test_the_format_may_be_passed(tmp_path: Path) -> None:
    path = tmp_path / "road.dat"
    write_profile(path, ROAD, format="erd")
    assert path.read_text().startswith("ERDFILEV2.00")
    assert read_profile(str(path)) == ROAD


@pytest.mark.parametrize(
    ("name", "tracks", "message"),
    [
        ("a.txt", ROAD, r"path must end in .csv or .erd, got .*a.txt': type path='road.csv'"),
        ("a", ROAD, "path must end in .csv or .erd"),
        ("a.csv", [ROAD, ROAD.place_bridge(1 / 8)], "roads must have the same stations"),
        (
            "a.erd",
            RoadProfile([0, 1, 2.5], [0, 0, 0]),
            r"one step for all .* 0.2 m off even ones: type road.resample\(0.1\), or write .csv",
        ),
        ("a.csv", RoadProfile([0, 10], [0, 0]), "refuse a median step of 10 m, expected 0.001"),
        ("a.csv", RoadProfile([0, 1, 2, 200], [0] * 4), "refuse the gap between 2 m and 200 m"),
        ("a.csv", RoadProfile([1e12, 1e12 + 1], [0, 0]), "would refuse numbers of 1e.12 m and"),
        (
            "a.csv",
            RoadProfile([0, 1, 2, 3], [0, 1, 2, 1]).detrend(),
            "would refuse a road steeper than 1 m/m",
        ),
    ],
)
def test_what_could_not_be_read_back_is_not_written(
    tmp_path: Path, name: str, tracks: Any, message: str
) -> None:
    with pytest.raises(ValueError, match=message):
        write_profile(tmp_path / name, tracks)
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize("tracks", [[], [ROAD, 5], [[0, 1]]])
def test_roads_must_be_roads(tmp_path: Path, tracks: Any) -> None:
    with pytest.raises(TypeError, match="roads must be one RoadProfile or a list of them"):
        write_profile(tmp_path / "a.csv", tracks)


def test_an_unknown_format_is_named(tmp_path: Path) -> None:
    with pytest.raises(ValueError, match="format must be one of 'csv', 'erd'"):
        write_profile(tmp_path / "a.csv", ROAD, format="crg")


# Files that are there


def test_a_file_is_replaced_with_its_permissions(tmp_path: Path) -> None:
    path = tmp_path / "road.csv"
    path.write_text("x [m],z [m]\n0,0\n1,1\n")
    path.chmod(0o640)
    link = tmp_path / "link.csv"
    link.symlink_to(path)
    write_profile(link, ROAD)
    assert link.is_symlink()
    assert read_profile(path) == ROAD
    assert path.stat().st_mode & 0o777 == 0o640


def test_a_new_file_has_the_permissions_of_any_other(tmp_path: Path) -> None:
    write_profile(tmp_path / "road.csv", ROAD)
    (tmp_path / "other").touch()
    assert (tmp_path / "road.csv").stat().st_mode == (tmp_path / "other").stat().st_mode


@pytest.mark.parametrize("error", [OSError(28, "No space left on device"), KeyboardInterrupt()])
def test_a_file_stays_as_it_is_when_the_new_one_fails(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, error: BaseException
) -> None:
    path = tmp_path / "road.csv"
    path.write_text("good")

    def fail(*arguments: object) -> None:
        raise error

    monkeypatch.setattr(write, "_rows", fail)
    with pytest.raises(type(error)) as caught:
        write_profile(path, ROAD)
    assert path.read_text() == "good"
    assert os.listdir(tmp_path) == ["road.csv"]
    if isinstance(error, OSError):
        assert str(caught.value) == f"[Errno 28] No space left on device: '{path}'"


def test_a_folder_that_is_missing_is_named(tmp_path: Path) -> None:
    path = tmp_path / "none" / "road.csv"
    with pytest.raises(FileNotFoundError) as caught:
        write_profile(path, ROAD)
    assert caught.value.filename == str(path)
