"""Reading OpenCRG files, through the optional package pyopencrg."""

import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

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
        crg(extra="$CT\nonce more\n$!\n"),  # a warning
    ],
)
def test_what_the_package_refuses_or_warns_of_is_refused_in_one_line(
    write: Write, content: str
) -> None:
    pytest.importorskip("pyopencrg")
    message = refusal(write(content))
    assert message.startswith("pyopencrg cannot read this: ")
    assert str(write(content)) not in message


def test_modifiers_are_not_applied_but_refused(write: Write) -> None:
    pytest.importorskip("pyopencrg")
    extra = "$ROAD_CRG_MODS\nSCALE_Z_GRID = 2.0\n$!\n"
    message = refusal(write(crg(extra=extra)))
    assert message.startswith("modifiers ($ROAD_CRG_MODS: scale_z_grid) would change the elevatio")


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
