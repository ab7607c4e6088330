"""Reading OpenCRG files, through the optional package pyopencrg."""

import json
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from helpers import run_command

from bridgectl.road import ProfileFileError, read_profile, read_tracks

ASAM = Path(__file__).parents[2] / "shared" / "profiles" / "asam_handmade_straight.crg"
Z = [[0.0, 0.01, 0.02], [0.01, 0.0, -0.01], [0.02, 0.01, 0.0], [0.0, 0.0, 0.01]]

HEADER = """$CT
A road of three long sections
$!
$ROAD_CRG
REFERENCE_LINE_START_U = 10.0
REFERENCE_LINE_END_U = 11.5
REFERENCE_LINE_INCREMENT = 0.5
LONG_SECTION_V_RIGHT = -1.5
LONG_SECTION_V_LEFT = 1.5
LONG_SECTION_V_INCREMENT = 1.5
$!
{extra}$KD_Definition
#:LRFI
{channels}D:long section 1,m
D:long section 2,m
D:long section 3,m
$!
$$$$$$$$10$$$$$$$$20$$$$$$$$30$$$$$$$$40$$$$$$$$50$$$$$$$$60$$$$$$$$70$$$$$$$$80
"""


def crg(rows: Any = Z, *, channels: str = "", extra: str = "") -> str:
    """Return the text of an OpenCRG file."""
    words = (["*missing*" if np.isnan(z) else f"{z:.7f}" for z in row] for row in rows)
    numbers = ("".join(f"{word:>10}" for word in row) + "\n" for row in words)
    return HEADER.format(channels=channels, extra=extra) + "".join(numbers)


Write = Callable[[str], Path]


@pytest.fixture
def write(tmp_path: Path) -> Write:
    """Write text to a file of a suffix that says nothing, and return its path."""

    def write_file(content: str) -> Path:
        path = tmp_path / "road.txt"
        path.write_text(content)
        return path

    return write_file


def refusal(path: Path, **arguments: Any) -> str:
    """Return the one line that refuses a file, without the path before it."""
    with pytest.raises(ProfileFileError) as caught:
        read_profile(path, **arguments)
    message = str(caught.value)
    assert message.startswith(f"{path}:")
    assert message.isprintable()
    return message.removeprefix(f"{path}:").strip()


def test_without_the_package_one_line_says_what_to_install(
    write: Write, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setitem(sys.modules, "pyopencrg", None)
    expected = 'OpenCRG files need the package pyopencrg: type pip install "bridgectl[crg]"'
    assert refusal(write(crg())) == expected


def test_long_sections_are_tracks(write: Write) -> None:
    pytest.importorskip("pyopencrg")
    roads = read_tracks(write(crg()))
    assert [road.name for road in roads] == ["road v=-1.5", "road v=0", "road v=1.5"]
    for road, expected in zip(roads, np.transpose(Z), strict=True):
        assert road.x.tolist() == [10, 10.5, 11, 11.5]
        np.testing.assert_allclose(road.elevation, expected, rtol=0, atol=1e-9)
    assert read_profile(write(crg()), track="v=0", units="m,m") == roads[1]


def test_elevations_hold_the_slope_and_the_banking_of_the_reference_line(write: Write) -> None:
    pytest.importorskip("pyopencrg")
    channels = "D:reference line slope,m/m\nD:reference line banking,m/m\n"
    rows = np.column_stack([np.full(4, 0.02), np.full(4, 0.1), Z])
    road = read_profile(write(crg(rows, channels=channels)), track=2)
    expected = np.transpose(Z)[2] + 0.02 * 0.5 * np.arange(4) + 0.1 * 1.5
    np.testing.assert_allclose(road.elevation, expected, rtol=0, atol=1e-9)


def test_the_stations_of_a_curved_road_are_those_of_its_reference_line(write: Write) -> None:
    pytest.importorskip("pyopencrg")
    rows = np.column_stack([0.1 * np.arange(4), Z])
    road = read_profile(write(crg(rows, channels="D:reference line phi,rad\n")), track=1)
    assert road.x.tolist() == [10, 10.5, 11, 11.5]
    np.testing.assert_allclose(road.elevation, np.transpose(Z)[1], rtol=0, atol=1e-9)


def test_missing_elevations_at_the_ends_are_cropped(write: Write) -> None:
    pytest.importorskip("pyopencrg")
    rows = np.array(Z)
    rows[0, 0] = rows[3, 2] = np.nan
    roads = read_tracks(write(crg(rows)))
    assert [road.x.tolist() for road in roads[::2]] == [[10.5, 11, 11.5], [10, 10.5, 11]]


def test_missing_elevations_inside_are_refused(write: Write) -> None:
    pytest.importorskip("pyopencrg")
    rows = np.array(Z)
    rows[1, 0] = np.nan
    path = write(crg(rows))
    assert refusal(path) == (
        "track v=-1.5 has no elevation at u = 10.5 m: pass track= (--track on the command line) "
        "with another of 0: 'v=-1.5', 1: 'v=0', 2: 'v=1.5'"
    )
    assert read_profile(path, track=1).x.size == 4
    rows[1:, 0] = np.nan
    assert refusal(write(crg(rows))).startswith("track v=-1.5 has no elevations: pass track=")


@pytest.mark.parametrize("holed", [0, 1, 2])
def test_whole_tracks_are_read_and_those_with_holes_are_told_of(write: Write, holed: int) -> None:
    """A hole between whole tracks, too, of which the package has a note of its own."""
    pytest.importorskip("pyopencrg")
    plain, rows = read_tracks(write(crg())), np.array(Z)
    rows[1, holed] = np.nan
    path = write(crg(rows))
    label = ("v=-1.5", "v=0", "v=1.5")[holed]
    expected = f"left out 1 of 3 tracks with holes: track {label} has no elevation at u = 10.5 m"
    with pytest.warns(UserWarning, match=expected) as told:
        roads = read_tracks(path)
    assert roads == [road for i, road in enumerate(plain) if i != holed]
    assert [road.name for road in roads] == [p.name for i, p in enumerate(plain) if i != holed]
    assert [warning.filename for warning in told] == [__file__]
    whole = (holed + 1) % 3
    assert read_profile(path, track=whole) == plain[whole]  # nobody asked for the others
    assert refusal(path, track=holed).endswith("with another of 0: 'v=-1.5', 1: 'v=0', 2: 'v=1.5'")


def test_a_file_without_a_whole_track_is_one_error_without_other_tracks(write: Write) -> None:
    pytest.importorskip("pyopencrg")
    rows = np.array(Z)
    rows[1], rows[1, 1] = np.nan, 0.0
    rows[2, 1] = np.nan
    path = write(crg(rows))
    with pytest.raises(ProfileFileError) as caught:
        read_tracks(path)
    assert str(caught.value).removeprefix(f"{path}: ") == refusal(path)
    assert refusal(path) == (
        "track v=-1.5 has no elevation at u = 10.5 m, and no other track is whole: fill the holes "
        "and save, for example by fill_holes of pyopencrg"
    )


def test_the_command_line_measures_whole_tracks_beside_one_with_a_hole(
    write: Write, capsys: pytest.CaptureFixture[str]
) -> None:
    pytest.importorskip("pyopencrg")
    rows = np.tile(1e-3 * (np.arange(100)[:, np.newaxis] % 7), 3)
    rows[50, 1] = np.nan
    text = (
        crg(rows)
        .replace("END_U = 11.5", "END_U = 34.75")
        .replace("INCREMENT = 0.5", "INCREMENT = .25")
    )
    path = write(text.replace("V_INCREMENT = .25", "V_INCREMENT = 1.5"))
    status, out, err = run_command(capsys, "profile", path, "--json")
    assert status == 0
    assert err == (
        f"bridgectl: warning: {path}: left out 1 of 3 tracks with holes: track v=0 has no "
        "elevation at u = 22.5 m\n"
    )
    tracks = json.loads(out)["tracks"]
    assert [track["name"] for track in tracks] == ["road v=-1.5", "road v=1.5"]
    assert all(track["good"] is not None for track in tracks)


@pytest.mark.skipif(not ASAM.exists(), reason="the shared profiles are not here")
def test_the_sample_of_the_standard_is_read() -> None:
    pytest.importorskip("pyopencrg")
    road = read_profile(ASAM, track="v=0.5")
    assert road.x.tolist() == list(range(23))
    np.testing.assert_allclose(road.elevation[15:18], [-1 / 90, 0, 0], rtol=0, atol=1e-7)
    assert refusal(ASAM).startswith("track v=-1.5 has no elevation at u = 7 m")


@pytest.mark.parametrize(
    "content",
    [
        "$ROAD_CRG\n",
        "$KD_Definition\n#:LRFI\n$!\n",
        crg(Z[:1]),
        crg().replace("LRFI", "XRFI"),
        crg().replace("long section 3,m", "long section 3,mm"),
        crg().replace(" 0.0200000", " 0.02x0000"),
        crg().replace("INCREMENT = 0.5", "INCREMENT = -0.5"),
        crg().replace("INCREMENT = 0.5", "INCREMENT = half"),  # a note that leaves a doubt
    ],
)
def test_what_the_package_refuses_or_cannot_read_is_refused_in_one_line(
    write: Write, content: str
) -> None:
    pytest.importorskip("pyopencrg")
    message = refusal(write(content))
    assert message.startswith("pyopencrg cannot read this: ")
    assert str(write(content)) not in message


@pytest.mark.parametrize(
    "modifiers",
    ["SCALE_Z_GRID = 2", "SCALE_SLOPE=0", "SCALE_BANKING = -1", "SCALE_LENGTH = 1.01",
     "SCALE_WIDTH = 2", "REFLINE_OFFSET_Z = 0.1", "REFPOINT_Z = 100"],
)  # fmt: skip
def test_modifiers_are_not_applied_but_refused(write: Write, modifiers: str) -> None:
    pytest.importorskip("pyopencrg")
    extra = f"$ROAD_CRG_MODS\n{modifiers}\nGRID_NAN_MODE = 2\n$!\n"
    message = refusal(write(crg(extra=extra)))
    name = modifiers.partition("=")[0].strip().lower()
    assert message.startswith(f"modifiers ($ROAD_CRG_MODS: {name}) would change the elevations: ")


@pytest.mark.parametrize(
    "modifiers",
    [
        ["SCALE_Z_GRID = 1.0", "SCALE_SLOPE = 1", "SCALE_BANKING = 1", "SCALE_LENGTH = 1",
         "SCALE_WIDTH = 1", "SCALE_CURVATURE = 1", "GRID_NAN_MODE = 2", "GRID_NAN_OFFSET = 0"],
        ["REFPOINT_U_FRACTION = 0.0", "REFPOINT_U_OFFSET = 0", "REFPOINT_V = 0", "REFPOINT_X = 0",
         "REFPOINT_Y = 0", "REFPOINT_Z = 0.0", "REFPOINT_PHI = 0"],
        ["REFLINE_OFFSET_X = 7", "REFLINE_OFFSET_Y = 8", "REFLINE_OFFSET_Z = 0",
         "REFLINE_OFFSET_PHI = 0.5", "REFLINE_ROTCENTER_X = 1", "REFLINE_ROTCENTER_Y = 1"],
    ],
    ids=["defaults", "reference point", "moved in the plane"],
)  # fmt: skip
def test_modifiers_that_change_no_elevation_are_accepted(
    write: Write, modifiers: list[str]
) -> None:
    pytest.importorskip("pyopencrg")
    plain = read_tracks(write(crg()))
    extra = "\n".join(["$ROAD_CRG_MODS", *modifiers, "$!", ""])
    assert read_tracks(write(crg(extra=extra))) == plain


def test_a_note_of_the_package_is_passed_on(write: Write) -> None:
    pytest.importorskip("pyopencrg")
    plain = read_tracks(write(crg()))
    path = write(crg(extra="$ROAD_CRG_MODS\nGRID_NAN_MODE = 2.000+e00\n$!\n$CT\nonce more\n$!\n"))
    with pytest.warns(UserWarning, match="pyopencrg notes: .*badly written .*; .*once") as told:
        assert read_tracks(path) == plain
    assert [(str(w.message).startswith(f"{path}: "), w.filename) for w in told] == [
        (True, __file__)
    ]


def test_steps_and_slopes_of_no_road_are_refused(write: Write) -> None:
    pytest.importorskip("pyopencrg")
    text = (
        crg().replace("END_U = 11.5", "END_U = 310").replace("INCREMENT = 0.5", "INCREMENT = 100")
    )
    assert refusal(write(text)) == (
        "a step of 100 m, expected 0.001 m to 5 m: correct REFERENCE_LINE_INCREMENT"
    )
    rows = np.array(Z)
    rows[2, 0] = 20.0
    assert refusal(write(crg(rows))) == (
        "the elevation in m changes by 19.99 m over 0.5 m, steeper than 1 m/m: correct track v=-1.5"
    )


def test_what_the_file_states_itself_cannot_be_passed(write: Write) -> None:
    path = write(crg())
    message = "an OpenCRG file states this itself: leave out columns= (--columns)"
    assert refusal(path, columns=(0, 1)) == message
    assert refusal(path, units="m,mm").startswith("OpenCRG files are in metres: leave out units")
