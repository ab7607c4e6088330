"""Reading ERD files, the text that inertial profilers write."""

import time
import tracemalloc
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from bridgectl.road import ProfileFileError, read_profile, read_tracks

TXDOT = Path(__file__).parents[2] / "shared" / "profiles" / "txdot_track_run_e1.erd"

COUNTS = "2, 4, -1, 1, 5, 0.25, -1,"
FIELDS = "SHORTNAMleft    right\nUNITSNAMmm      in\nXUNITS  m"
NUMBERS = "0 0\n1.5 0.1\n2 .2\n-3 1e-1\n"


def erd(counts: str = COUNTS, fields: str = FIELDS, numbers: str = NUMBERS) -> str:
    """Return the text of an ERD file."""
    return f"ERDFILEV2.00\n{counts}\nTITLE   A road\n{fields}\nSURVDATE 03/01/2001\nEND\n{numbers}"


Write = Callable[[str], Path]


@pytest.fixture
def write(tmp_path: Path) -> Write:
    """Write text to a file of a suffix that says nothing, and return its path."""

    def write_file(content: str) -> Path:
        path = tmp_path / "road.txt"
        path.write_text(content, newline="")
        return path

    return write_file


def refusal(path: Path, **arguments: Any) -> str:
    """Return the one line that refuses a file, without the path before it."""
    with pytest.raises(ProfileFileError) as caught:
        read_tracks(path, **arguments)
    message = str(caught.value)
    assert message.startswith(f"{path}:")
    assert message.isprintable()
    return message.removeprefix(f"{path}:").strip()


# Files that are understood


@pytest.mark.parametrize("end", ["\n", "\r\n", "\r"])
@pytest.mark.parametrize("delimiter", [" ", ",", "  ", ", ", "\t"])
def test_channels_are_tracks_in_their_units(write: Write, delimiter: str, end: str) -> None:
    text = erd(numbers=NUMBERS.replace(" ", delimiter)).replace("\n", end)
    left, right = read_tracks(write(text))
    assert [left.name, right.name] == ["road left", "road right"]
    assert left.x.tolist() == right.x.tolist() == [0, 0.25, 0.5, 0.75]
    np.testing.assert_allclose(left.elevation, [0, 1.5e-3, 2e-3, -3e-3], rtol=0, atol=1e-15)
    np.testing.assert_allclose(right.elevation, [0, 2.54e-3, 5.08e-3, 2.54e-3], rtol=0, atol=1e-15)


def test_a_track_is_chosen_by_label_or_number(write: Write) -> None:
    path = write(erd())
    left, right = read_tracks(path)
    assert read_profile(path) == left
    assert read_profile(path, track="Right") == read_profile(path, track=1) == right
    with pytest.raises(ProfileFileError, match="there are 0: 'left', 1: 'right'"):
        read_profile(path, track="middle")


@pytest.mark.parametrize(
    ("unit", "metres"),
    [("m", 1), ("mm", 1e-3), ("cm", 0.01), ("ft", 0.3048), ("in", 0.0254), ("mil", 2.54e-5)],
)
def test_each_unit_of_length_is_understood_in_capitals_too(
    write: Write, unit: str, metres: float
) -> None:
    for word in (unit, unit.upper()):
        fields = f"UNITSNAM{word:8}{word:8}\nXUNITS  ft\nXSTART  -10"
        road = read_profile(write(erd(fields=fields, numbers="0 0\n.05 0\n.05 0\n.05 0\n")))
        np.testing.assert_allclose(road.elevation[1], 0.05 * metres, rtol=1e-15)
        np.testing.assert_allclose(road.x, (np.arange(4) * 0.25 - 10) * 0.3048, rtol=1e-15)


def test_long_names_go_before_short_ones(write: Write) -> None:
    long_names = "LONGNAMELeft wheel track".ljust(40)
    path = write(erd(fields=f"{long_names}\n{FIELDS}"))
    assert [road.name for road in read_tracks(path)] == ["road Left wheel track", "road right"]


def test_channels_without_names_are_numbered(write: Write) -> None:
    path = write(erd(fields="UNITSNAMmm      mm\nXUNITS  m\n"))
    assert [road.name for road in read_tracks(path)] == ["road track 0", "road track 1"]


def test_a_channel_that_is_no_length_is_no_track(write: Write) -> None:
    fields = "SHORTNAMspeed   left\nUNITSNAMkm/h    mm\nXUNITS  m"
    (road,) = read_tracks(write(erd(fields=fields)))
    assert road.name == "road"
    assert road.elevation[2] == pytest.approx(2e-4, abs=1e-15)


def test_units_that_the_file_lacks_may_be_passed(write: Write) -> None:
    path = write(erd(fields="XUNITS  m"))
    expected = read_profile(write(erd(fields="UNITSNAMmm      mm\nXUNITS  m")))
    path = write(erd(fields="XUNITS  m"))
    assert read_profile(path, units="mm") == read_profile(path, units="m,mm") == expected
    assert read_profile(write(erd(fields="COUNTY  1")), units="m,mm") == expected


@pytest.mark.skipif(not TXDOT.exists(), reason="the shared profiles are not here")
@pytest.mark.parametrize(("track", "inches_per_mile"), [("LElev.", 183.22), (1, 162.95)])
def test_a_measured_file_has_the_iri_of_an_independent_code(
    track: str | int, inches_per_mile: float
) -> None:
    road = read_profile(TXDOT, track=track)
    assert road.x.size == 25544
    assert road.iri() * 63.36 == pytest.approx(inches_per_mile, abs=0.02)


# Files that are none


@pytest.mark.parametrize("keynum", [0, 1, 2, 3, 11])
def test_a_binary_file_is_refused_with_what_to_export(write: Write, keynum: int) -> None:
    message = refusal(write(erd(f"2,4,-1,4,{keynum},0.25,-1", numbers="\0\1\2\3" * 100)))
    assert message.startswith(f"2: KEYNUM {keynum} says that the numbers of this ERD file are bina")
    assert message.endswith("export it as ERD text (KEYNUM 5) or CSV")


@pytest.mark.parametrize(
    ("counts", "message"),
    [
        ("", "2: expected numbers for NCHAN, NSAMP, NRECS, NBYTES, KEYNUM, STEP, found ''"),
        ("2,4,-1,1", "2: expected numbers for NCHAN"),
        ("2,4,-1,1,5", "2: expected numbers for NCHAN"),
        ("x,4,-1,1,5,.25", "2: expected numbers for NCHAN"),
        ("2,4,-1,1,5,nan", "2: expected numbers for NCHAN"),
        ("2,4,-1,1,5,inf", "2: expected numbers for NCHAN"),
        ("2,4,-1,1,5,0", "2: a step of 0 m, expected 0.001 m to 5 m: correct STEP or XUNITS"),
        ("2,4,-1,1,5,-.25", "2: a step of -0.25 m, expected 0.001 m to 5 m"),
        ("2,4,-1,1,5,250", "2: a step of 250 m, expected 0.001 m to 5 m"),
        ("0,4,-1,1,5,.25", "2: NCHAN must be a whole number of at least 1, found 0"),
        ("1.5,4,-1,1,5,.25", "2: NCHAN must be a whole number of at least 1, found 1.5"),
        ("1e9,4,-1,1,5,.25", "9: expected NCHAN = 1000000000 numbers (line 2), found 2"),
        ("1,4,-1,1,5,.25", "9: expected NCHAN = 1 numbers (line 2), found 2"),
        ("2,1,-1,1,5,.25", "2: NSAMP must be a whole number of at least 2, found 1"),
        ("2,-1,-1,1,5,.25", "2: NSAMP must be a whole number of at least 2, found -1"),
        ("2,1e11,-1,1,5,.25", "12: 4 samples end here, line 2 has 100000000000 (NSAMP)"),
        ("2,1e18,-1,1,5,.25", "2: expected numbers for NCHAN"),
        ("2,5,-1,1,5,.25", "12: 4 samples end here, line 2 has 5 (NSAMP): the file is cut short"),
        ("2,3,-1,1,5,.25", "12: more than the 3 samples (NSAMP) of line 2: correct line 2 or rem"),
    ],
)
def test_counts_that_cannot_be_are_refused(write: Write, counts: str, message: str) -> None:
    assert refusal(write(erd(counts))).startswith(message)


@pytest.mark.parametrize(
    ("fields", "message"),
    [
        ("UNITSNAMmm      mm", "the file does not state its units in XUNITS: pass units="),
        ("XUNITS  m", "the file does not state its units in UNITSNAM: pass units="),
        ("UNITSNAMmm\nXUNITS  m", "the file does not state its units in UNITSNAM: pass units="),
        (
            "UNITSNAMmm      furlong\nXUNITS  m",
            "4: unknown unit 'furlong' in UNITSNAM, known units: m, mm, cm, km, ft, in, mil: corr",
        ),
        ("UNITSNAMmm      mm\nXUNITS  s", "5: unknown unit 's' in XUNITS, known units: m, mm"),
        (
            "UNITSNAMm/s     deg\nXUNITS  m",
            "4: no channel is an elevation, the units are 'm/s', 'deg': expected one in m, mm,",
        ),
        ("XUNITS  m\nXUNITS  m", "5: XUNITS repeats line 4: remove one of the two lines"),
        (f"{FIELDS}\nXSTART  far", "7: expected a number in XSTART, found 'far'"),
        (f"{FIELDS}\nXSTART", "7: expected a number in XSTART, found ''"),
    ],
)
def test_headers_that_cannot_be_are_refused(write: Write, fields: str, message: str) -> None:
    assert refusal(write(erd(fields=fields))).startswith(message)


@pytest.mark.parametrize(
    ("numbers", "message"),
    [
        ("", "no numbers follow END: the file is cut short, copy it again"),
        ("\n\n", "no numbers follow END"),
        (
            "0 0\n1 x\n2 0\n3 0\n",
            "10: expected a finite number in column 1 (counted from 0), found",
        ),
        ("0 0\n1 nan\n2 0\n3 0\n", "10: expected a finite number in column 1"),
        ("0 0\n1\n2 0\n3 0\n", "10: expected 2 columns, found 1: correct or remove the line"),
        (
            "0 0\n1, 0\n2 0\n3 0\n",
            "10: expected white space, found comma: use one delimiter through",
        ),
        ("0 0\n# 1\n2 0\n3 0\n", "10: expected a finite number in column 0"),
        ("0 0\n1 0\n2 0\n990 0\n", "12: the elevation in mm changes by 0.988 m over 0.25 m, steep"),
        (f"{NUMBERS}end\n", "13: expected 2 columns, found 1"),
        ("0 0\n1 0\n2 \0\n", "11: the byte 0x00 is not text"),
    ],
)
def test_numbers_that_cannot_be_are_refused(write: Write, numbers: str, message: str) -> None:
    told = refusal(write(erd(numbers=numbers)))
    assert told.startswith(message)
    assert "delimiter=" not in told
    assert "#" not in told.replace("found '#'", "")


def test_blank_lines_between_the_numbers_are_skipped(write: Write) -> None:
    expected = read_profile(write(erd()))
    text = erd(numbers="\n" + NUMBERS.replace("\n", "\n \n") + "\n\n")
    assert read_profile(write(text)) == expected


def test_a_header_without_end_is_refused(write: Write) -> None:
    expected = "the header has no line END: the file is cut short, copy it again"
    assert refusal(write("ERDFILEV2.00\n2,4,-1,1,5,.25\nTITLE   x\n")) == f"3: {expected}"
    assert refusal(write("ERDFILEV2.00\n2,4,-1,1,5,.25")) == f"2: {expected}"
    assert refusal(write("ERDFILEV2.00")).startswith("2: expected numbers for NCHAN")


# Arguments


def test_units_that_disagree_with_the_file_are_refused(write: Write) -> None:
    path = write(erd(fields="UNITSNAMmm      mm\nXUNITS  m"))
    assert read_tracks(path, units="m,mm") == read_tracks(path, units="mm") == read_tracks(path)
    expected = "4: the unit stated here is mm, not m: pass mm or correct this line"
    assert refusal(path, units="m,m") == expected
    assert refusal(path, units="ft,mm").startswith("5: the unit stated here is m, not ft")
    assert refusal(path, units="m,mm,mm").startswith("units must name two units, got 3")


def test_what_the_file_states_itself_cannot_be_passed(write: Write) -> None:
    path = write(erd())
    message = "an ERD file states this itself: leave out columns= (--columns)"
    assert refusal(path, columns=(0, 1)) == message
    message = (
        "an ERD file states this itself: leave out delimiter= (--delimiter) and step= (--step)"
    )
    assert refusal(path, delimiter=",", step=0.1) == message


# Large files


def test_a_large_file_takes_less_memory_than_thrice_its_bytes(write: Write) -> None:
    n = 100_000
    path = write(erd(f"2,{n},-1,1,5,.05", numbers="0.012345 0.012345\n" * n))
    start = time.process_time()
    read_tracks(path)
    assert time.process_time() - start < 2  # a tenth of that where nothing else runs
    tracemalloc.start()
    read_tracks(path)
    peak = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    assert peak < 5 * 8 * n + 2.5e6
    assert peak < 3 * path.stat().st_size + 2.5e6
