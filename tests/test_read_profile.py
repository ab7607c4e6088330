"""Reading road files: what is understood, and what every bad file is told."""

import ast
import gzip
import os
import re
import tempfile
import tracemalloc
import warnings
from collections.abc import Callable
from importlib import resources
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from bridgectl.road import ProfileFileError, RoadProfile, read_profile, read_tracks, utia_road
from bridgectl.road.files import lines, packed, read, table, tracks

SHARED = Path(__file__).parents[2] / "shared" / "profiles"
UTIA = (resources.files("bridgectl.road") / "data" / "utia_profile_1.txt").read_bytes()
GOOD = "x [m], z [mm]\n0.0, 0\n0.1, 2\n0.2, 3\n"

Write = Callable[[str | bytes], Path]


@pytest.fixture
def write(tmp_path: Path) -> Write:
    """Write text or bytes to a file and return its path."""

    def write_file(content: str | bytes) -> Path:
        path = tmp_path / "road.csv"
        path.write_bytes(content if isinstance(content, bytes) else content.encode())
        return path

    return write_file


def refusal(path: Path | str, **arguments: Any) -> str:
    """Return the one line that refuses a file, without the path before it."""
    with pytest.raises(ProfileFileError) as caught:
        read_profile(path, **arguments)
    message = str(caught.value)
    assert message.startswith(f"{path}:")
    assert message.isprintable()
    return message.removeprefix(f"{path}:").strip()


# Files that are understood


def test_the_utia_road_has_2177_stations_from_478_to_1022_metres() -> None:
    road = utia_road()
    assert road.x.size == 2177
    assert road.x[[0, -1]].tolist() == [478.0, 1022.0]
    assert road.elevation[[0, -1]].tolist() == [583.1370, 583.0498]
    assert road.name == "UTIA road"


@pytest.mark.parametrize("delimiter", [",", ";", "\t", " ", "   ", " , ", ";\t"])
@pytest.mark.parametrize("end", ["\n", "\r\n", "\r"])
def test_each_delimiter_and_line_end_is_understood(write: Write, delimiter: str, end: str) -> None:
    lines = [f"{x}{delimiter}{z}" for x, z in [("0.0", "1e-3"), ("+.25", "-2."), ("5E-1", "3")]]
    road = read_profile(write(end.join(lines)), units="m,mm")
    assert road.x.tolist() == [0.0, 0.25, 0.5]
    np.testing.assert_allclose(road.elevation, [1e-6, -2e-3, 3e-3], rtol=0, atol=1e-12)


def test_the_name_is_the_file_name_unless_given(write: Write) -> None:
    path = write(GOOD)
    assert read_profile(path).name == "road"
    assert read_profile(str(path), name="A1").name == "A1"


@pytest.mark.parametrize(
    "label",
    [
        "x [m], z [mm]",
        "station (m); elevation (mm)",
        "x_m,z_mm",
        "x_m z_mm",
        "x [m] z [ mm ]",
        "x[m]\tz[mm]",
        '"x (m)","z (mm)"',
        "# x [m], z [mm]",
        "% x_m z_mm",
        "// station [m]; elevation [mm]",
        "# a road\n\n# x [m], z [mm]\nstation,elevation",
        "station,elevation\n#x_m,z_mm",
    ],
)
def test_units_are_taken_from_the_line_that_names_the_columns(write: Write, label: str) -> None:
    road = read_profile(write(f"{label}\n0, 0\n0.1, 2\n"))
    np.testing.assert_allclose(road.elevation, [0.0, 2e-3], rtol=0, atol=1e-12)


@pytest.mark.parametrize("units", ["m,mm", " m , mm ", ("m", "mm"), ["m", "mm"]])
def test_units_may_be_passed_again_when_they_agree(write: Write, units: Any) -> None:
    assert read_profile(write(GOOD), units=units) == read_profile(write(GOOD))


def test_a_bracket_that_is_no_unit_does_not_contradict_the_units_passed(write: Write) -> None:
    road = read_profile(write("x [m], z [left]\n0, 0\n1, 2\n"), units="m,mm")
    assert road.elevation[-1] == pytest.approx(2e-3, abs=1e-12)


def test_other_columns_may_hold_anything(write: Write) -> None:
    text = "lane,z [in],note,x [ft]\nA_1,0,ü,0\nA_1,1,,1\nA_1,2,#,2\n"
    road = read_profile(write(text), columns=(3, 1))
    np.testing.assert_allclose(road.x, [0.0, 0.3048, 0.6096], rtol=0, atol=1e-12)
    np.testing.assert_allclose(road.elevation, [0.0, 0.0254, 0.0508], rtol=0, atol=1e-12)


def test_a_comment_of_as_many_fields_is_no_line_of_numbers(write: Write) -> None:
    road = read_profile(write("n,x [m],z [mm]\n1,0,0\n#2,5,5\n3,1,0\n"), columns=(1, 2))
    assert road.x.tolist() == [0.0, 1.0]


def test_blank_lines_comments_and_a_byte_order_mark_are_skipped(write: Write) -> None:
    text = "\ufeff# räum\n\n \t \nx_m\tz_m\t\n0\t0\t\n  # gap\n% gap\n// gap\n\n0.1\t0\t\n0.2\t0\t"
    assert read_profile(write(text)).x.tolist() == [0.0, 0.1, 0.2]


@pytest.mark.parametrize("delimiter", [",", ";", "\t", " "])
@given(
    steps=st.lists(st.floats(0.01, 1.0), min_size=1, max_size=40),
    slopes=st.lists(st.floats(-0.5, 0.5), min_size=40, max_size=40),
    start=st.floats(-1000, 1000),
    units=st.tuples(st.sampled_from(list(tracks.UNITS)), st.sampled_from(list(tracks.UNITS))),
)
@settings(max_examples=40, deadline=None)
def test_a_written_road_is_read_back(
    delimiter: str, steps: list[float], slopes: list[float], start: float, units: tuple[str, str]
) -> None:
    x = start + np.cumsum([0.0, *steps])
    z = np.cumsum([0.0, *np.multiply(steps, slopes[: len(steps)])])
    columns = (x / tracks.UNITS[units[0]], z / tracks.UNITS[units[1]])
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder, "road.txt")
        rows = zip(*(column.tolist() for column in columns), strict=True)
        path.write_text("\n".join(f"{a!r}{delimiter}{b!r}" for a, b in rows))
        road = read_profile(path, units=units, missing=())  # 9.9999 cm is an elevation here
    np.testing.assert_allclose(road.x, x, rtol=0, atol=1e-9)
    np.testing.assert_allclose(road.elevation, z, rtol=0, atol=1e-9)


@pytest.mark.skipif(not SHARED.is_dir(), reason="the shared profiles are not here")
def test_the_shared_profiles_are_read_or_refused_with_one_line() -> None:
    assert read_profile(SHARED / "utia_profile_1.txt", units="m,m") == utia_road()
    assert read_profile(SHARED / "utia_profile_2_irregular.txt", units="m,m").x.size == 2177
    pulse = read_profile(SHARED / "wtp46_pulse_check.csv")
    assert pulse.elevation.max() == pytest.approx(0.02, abs=1e-12)


# Files that are none


def test_a_missing_file_is_refused(tmp_path: Path) -> None:
    assert refusal(tmp_path / "none.csv") == "no such file: check the name and the folder"


def test_a_folder_is_refused(tmp_path: Path) -> None:
    assert refusal(tmp_path) == "this is a folder: type the name of a file in it"


def test_a_file_without_permission_is_refused(
    write: Write, monkeypatch: pytest.MonkeyPatch
) -> None:
    path = write(GOOD)

    def deny(*arguments: object) -> None:
        raise PermissionError(13, "Permission denied")

    monkeypatch.setattr(lines, "open", deny, raising=False)
    assert refusal(path).startswith("permission denied: make the file readable")


def test_a_device_or_a_huge_file_is_refused(write: Write, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(lines, "MAX_BYTES", 2**20)
    for path in (write(GOOD.ljust(2**20 + 1)), os.devnull):
        assert refusal(path) == "expected a file of at most 1 MiB: save the profile in one"


def test_names_that_no_file_can_have_are_refused(tmp_path: Path) -> None:
    for name in ("a\0b", "\ud800", "a" * 5000):
        with pytest.raises(ProfileFileError, match="cannot be opened") as caught:
            read_profile(tmp_path / name)
        assert str(caught.value).isprintable()


def test_line_breaks_in_a_name_are_escaped(tmp_path: Path) -> None:
    with pytest.raises(ProfileFileError, match=r"a\\nb: no such file"):
        read_profile(tmp_path / "a\nb")


@pytest.mark.parametrize("content", ["", " \n\n", "\ufeff\n"])
def test_an_empty_file_is_refused(write: Write, content: str) -> None:
    message = refusal(write(content), units="m,m")
    assert "expected" in message
    assert "station and" in message


def test_a_file_of_comments_has_no_numbers(write: Write) -> None:
    expected = "no line of numbers: expected a station and an elevation on each line"
    assert refusal(write("# x [m], z [m]\nx,z\n"), units="m,m") == expected


def test_one_line_of_numbers_is_no_road(write: Write) -> None:
    expected = "3: only one line of numbers: a road needs two or more"
    assert refusal(write("# x\n\n0 0\n"), units="m,m") == expected


@pytest.mark.parametrize(
    ("content", "byte"),
    [(b"0 0\n1\x00 0\n", "0x00"), (b"0 0\n1 0\xe4\n", "0xe4"), (b"0 0\n1\x81\n", "0x81")],
)
def test_a_binary_file_is_refused_with_the_line(write: Write, content: bytes, byte: str) -> None:
    expected = f"2: the byte {byte} is not text: save the file as UTF-8 text (csv)"
    assert refusal(write(content), units="m,m") == expected


def test_words_in_latin_1_are_read_wherever_they_stand(write: Write) -> None:
    text = "# Länge\nx [m];Höhe [mm];Anmerkung\n0;0;Fuß\n# Brücke\u2014Süd\n1;2;\n"
    road = read_profile(write(text.encode("cp1252")), track="höhe")
    assert road.elevation.tolist() == [0.0, 2e-3]
    tracks = read_tracks(write("x [m],Höhe [mm],Tiefe [mm]\n0,0,0\n1,0,0\n".encode("latin-1")))
    assert [track.name for track in tracks] == ["road Höhe", "road Tiefe"]


def test_words_in_latin_1_are_not_blamed_for_another_fault(write: Write) -> None:
    path = write("0;0;Straße\n1;0;Fuß;2\n".encode("latin-1"))
    assert refusal(path, units="m,mm").startswith("2: expected 3 columns, found 4")


@pytest.mark.parametrize("encoding", ["utf-8-sig", "utf-16", "utf-32"])
def test_a_byte_order_mark_tells_the_encoding(write: Write, encoding: str) -> None:
    assert read_profile(write(GOOD.encode(encoding))) == read_profile(write(GOOD))


def test_a_torn_utf_16_file_is_refused(write: Write) -> None:
    assert "found '3" in refusal(write(GOOD.encode("utf-16")[:-1]))


# Lines that are no numbers


@pytest.mark.parametrize("word", ["1_000", "٣", '"3"', "1.2.3", "//", "no reading"])
@pytest.mark.parametrize("comment", ["", "# a comment\n"])
def test_a_word_in_the_place_of_a_number_is_quoted(write: Write, word: str, comment: str) -> None:
    message = refusal(write(f"x_m,z_m\n0,0\n{comment}0.1,{word}\n0.2,0\n"))
    assert message == (
        f"{4 if comment else 3}: expected a finite number in column 1 (counted from 0), found "
        f"'{word}': correct or remove the line, or begin it with # if it is a comment"
    )


@pytest.mark.parametrize("delimiter", [",", ";"])
@pytest.mark.parametrize(
    "word",
    ["abc", "nan", "inf", "-Infinity", "1e999", "2e12", "-1.0E+30", "", "-", "*", "NA", "#N/A"],
)
def test_a_word_that_may_mark_a_missing_reading_is_left_out_as_its_refusal_says(
    write: Write, word: str, delimiter: str
) -> None:
    text = f"x_m,z_m\n0.0,0.5\n0.1,{word}\n0.2,0.5\n"
    if delimiter == ";":
        text = text.replace(",", ";").replace(".", ",")
    path = write(text)
    advice = re.search(r"; pass missing=(\S+) \(--missing=(\S*) on the .* missing", refusal(path))
    assert advice
    for missing in (ast.literal_eval(advice[1]), advice[2]):
        with pytest.warns(UserWarning, match="1 missing reading left out, the first on line 3"):
            assert read_profile(path, missing=missing).x.tolist() == [0.0, 0.2]


def test_the_advice_on_a_second_marker_keeps_the_first(write: Write) -> None:
    path = write("x_m,z_m\n0,0\n0.1,-999\n0.2,0\n0.3,NaN\n0.4,0\n")
    assert 'pass missing="-999,NaN" (--missing=-999,NaN on' in refusal(path, missing=-999)


def test_a_long_or_unprintable_word_is_cut_and_escaped(write: Write) -> None:
    message = refusal(write("0;0\n\x1b[31m" + 100 * "a" + ";0\n"), units="m,m")
    assert "found '\\x1b[31m" + 32 * "a" + "...':" in message


def test_an_empty_field_is_refused(write: Write) -> None:
    assert "found nothing: correct" in refusal(write("0,0\n1,\n"), units="m,m")


@pytest.mark.parametrize(
    "first", ["nan,0", "4x8,583", "Run 3", '"0.0","0.0"', "-- --", "0 [m],0 [m]"]
)
def test_a_damaged_first_line_is_not_taken_for_a_header(write: Write, first: str) -> None:
    assert refusal(write(f"{first}\n1,0\n2,0\n"), units="m,m").startswith("1: ")


def test_numbers_above_the_header_are_told_of_with_its_line(write: Write) -> None:
    path = write("A 1\n2021,12\n# as built\nx [m],z [mm]\n0,1\n1,2\n")
    message = refusal(path)
    assert message.startswith("2: numbers stand above the names and units on line 4, '2021,12': ")
    assert "(--skip-lines on the command line) with 3 or more" in message
    assert read_profile(path, skip_lines=3).elevation.tolist() == [1e-3, 2e-3]


def test_a_step_above_one_column_is_no_first_line_of_numbers(write: Write) -> None:
    path = write("! levels\n0.25 m\n1.5\n2.5\n3.5\n")
    assert re.match(
        r"2: expected .* found '0.25 m': .* with 2 or more", refusal(path, step=0.25, units="mm")
    )
    road = read_profile(path, skip_lines=2, step=0.25, units="mm")
    assert road.elevation.tolist() == [1.5e-3, 2.5e-3, 3.5e-3]


def test_a_track_may_have_a_number_for_a_name(write: Write) -> None:
    assert len(read_tracks(write("x [m],2 [mm],lane 3 [mm]\n0,1,2\n1,1,2\n"))) == 2


def test_a_second_header_line_is_refused(write: Write) -> None:
    assert "2: expected a finite number" in refusal(write("x,z\nm,mm\n0,0\n1,0\n"), units="m,m")


@pytest.mark.parametrize("line", ["1,0,5", "1", "1,0,"])
def test_a_wrong_number_of_columns_is_refused(write: Write, line: str) -> None:
    found = line.count(",") + 1
    expected = f"2: expected 2 columns, found {found}: correct or remove the line"
    assert refusal(write(f"0,0\n{line}\n2,0\n"), units="m,m") == expected


@pytest.mark.parametrize(
    ("first", "second", "names"),
    [
        ("0,0", "1;0", "expected comma, found semicolon"),
        ("0 0", "1, 0", "expected white space, found comma"),
        ("0\t0", "1 0", "expected tab, found white space"),
    ],
)
def test_mixed_delimiters_are_refused(write: Write, first: str, second: str, names: str) -> None:
    expected = (
        f"2: {names}: use one delimiter throughout, or pass delimiter= (--delimiter on the command "
        "line)"
    )
    assert refusal(write(f"{first}\n{second}\n"), units="m,m") == expected


def test_a_delimiter_that_the_file_does_not_use_is_refused(write: Write) -> None:
    message = refusal(write("0 0\n1 0\n"), units="m,m", delimiter=";")
    assert message.startswith("1: expected semicolon, found white space: use one delimiter")


# Decimal commas


@pytest.mark.parametrize("text", ["0,25;1,3", "0,25 1,3", "0,25\t1,3", "0,25 ; 1,3", "0,25;+1,3"])
@pytest.mark.parametrize("before", ["", "0;0\n", "# a comment, or two\n"])
def test_decimal_commas_are_read(write: Write, text: str, before: str) -> None:
    before = before.replace(";", "\t" if "\t" in text else ";" if ";" in text else " ")
    road = read_profile(write(f"{before}{text}\n0,5{text[4:]}\n"), units="m,mm")
    assert road.x[-2:].tolist() == [0.25, 0.5]
    assert road.elevation[-1] == pytest.approx(1.3e-3, abs=1e-12)


def test_one_field_with_three_digits_of_many_leaves_no_doubt_of_the_decimal_comma(
    write: Write,
) -> None:
    assert read_profile(write("0,000;1,234\n0,250;1,235\n"), units="m,mm").x[-1] == 0.25
    path = write("1,000;1,234\n1,250;1,235\n")
    assert refusal(path, units="m,mm") == (
        "1: '1,000' may be 1.000 or 1000: pass decimal=\",\" (--decimal ,) or leave out the comma"
    )
    assert read_profile(path, units="m,mm", decimal=",").x.tolist() == [1.0, 1.25]
    assert "decimal comma or a separator" in refusal(path, units="m,mm", decimal=".")


@pytest.mark.parametrize(
    ("text", "arguments", "message"),
    [
        ("0,0;1.5\n0,5;1,3\n", {}, "1: a decimal comma or a separator of thousands in '0,0'"),
        ("0,0;1,5\n0,5;1.3\n", {"decimal": ","}, "2: a decimal point or a separator of thousands"),
        ("0.0;1.5\n1'000.5;1\n", {}, "2: thousands separators are not understood, found '1'000.5'"),
        ("0,5;1\n1.000,5;1\n", {}, "2: thousands separators are not understood, found '1.000,5'"),
        ("0,5;1,5,5\n1,0;1\n", {}, "1: expected a finite number in column 1"),
        ("x [m],z [mm]\n1,000.0,2\n1,001.0,2\n", None, "2: commas may separate columns or be"),
        ("0,0,1,5\n0,1,1,6\n", {}, "1: commas may separate columns or be decimal marks"),
        ("0,0\n0,1\n", {"decimal": ","}, "1: column 1 (counted from 0) does not exist, found 1"),
        ("sep=,\n0,0\n0,1\n", {"decimal": ","}, "2: commas cannot separate columns and be"),
        ("sep=|\n0|0\n1|1\n", {}, "1: sep=| is no delimiter known here, which are"),
    ],
)
def test_numbers_that_can_be_read_in_two_ways_are_refused(
    write: Write, text: str, arguments: dict[str, Any] | None, message: str
) -> None:
    arguments = {} if arguments is None else {"units": "m,mm", **arguments}
    assert refusal(write(text), **arguments).startswith(message)


@pytest.mark.parametrize(
    ("text", "arguments"),
    [
        ("0,0,1,5\n1,0,1,6\n", {"columns": (0, 3)}),
        ("a,b,c,d\n0,5,1,5\n1,6,1,6\n", {}),
        ("# x [m], z [mm], u [mm], v [mm]\n0,5,1,5\n1,6,1,6\n", {}),
    ],
)
def test_whole_numbers_between_commas_are_columns_where_they_are_named_or_chosen(
    write: Write, text: str, arguments: dict[str, Any]
) -> None:
    road = read_profile(write(text), units="m,mm", **arguments)
    assert road.elevation == pytest.approx([5e-3, 6e-3], abs=1e-12)


@pytest.mark.parametrize(
    ("text", "arguments"),
    [
        ("1,25\n1,3\n", {"units": "mm", "decimal": ","}),
        ("1,25\n1,3\n", {"units": "mm", "decimal": ",", "delimiter": ";"}),
        ("z [mm]\n1,25\n1,3\n", {}),
        ("# z [mm]\n1,25\n1,3\n", {}),
        ("z [mm]\n1,25\n1,30\n", {"units": "mm"}),
    ],
)
def test_one_column_of_decimal_commas_keeps_its_digits(
    write: Write, text: str, arguments: dict[str, Any]
) -> None:
    road = read_profile(write(text), step=0.25, **arguments)
    np.testing.assert_allclose(road.elevation, [1.25e-3, 1.3e-3], rtol=0, atol=1e-12)


def test_one_column_of_commas_is_refused_unless_two_columns_are_named_or_chosen(
    write: Write,
) -> None:
    message = refusal(write("1,25\n1,30\n"), units="mm", step=0.25)
    assert message == (
        "1: '1,25' may be one number with a decimal comma or two: pass decimal=\",\" (--decimal ,) "
        "or columns=(0,) (--columns 0)"
    )
    for text, arguments in (
        ("1,25\n2,30\n", {"columns": (0,)}),
        ("1,25\n2,30\n", {"delimiter": ","}),
        ("z [mm],n\n1,25\n2,30\n", {}),
    ):
        road = read_profile(write(text), units="mm", step=0.25, **arguments)
        np.testing.assert_allclose(road.elevation, [1e-3, 2e-3], rtol=0, atol=1e-12)


# Lines above the header

SURVEY = "Road: A1\nOperator, none\nSpeed [km/h],80\n\nx [m],left [mm],right [mm]\n0,1,2\n1,2,3\n"


def test_lines_above_the_names_and_units_are_passed_over_with_a_warning(write: Write) -> None:
    path = write(SURVEY)
    with pytest.warns(UserWarning, match="3 lines above the names and units on line 5.*'Road"):
        road = read_profile(path)
    assert road.name == "road left"
    assert read_profile(path, skip_lines=4) == read_profile(path, skip_lines=3) == road
    with pytest.warns(UserWarning, match=r"1 line above the names and units on line 2 passed over"):
        read_profile(write("Road\nx [m],z [mm]\n0,0\n1,1\n"))


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("A1\nA2\nx,z\n0,0\n1,1\n", "2: expected a finite number in each column, or their names"),
        ("A1\n0,0\n1,1\nx [m],z [mm]\n2,0\n3,1\n", "4: expected a finite number in column 0"),
    ],
)
def test_lines_are_not_passed_over_without_units_below_nor_if_they_hold_numbers(
    write: Write, text: str, message: str
) -> None:
    assert refusal(write(text), units="m,mm").startswith(message)


def test_lines_are_skipped_whatever_they_hold(write: Write) -> None:
    path = write("9,9\n8,8\nx [m],z [mm]\n0,0\n1,1\n")
    assert read_profile(path, skip_lines=2).x.tolist() == [0.0, 1.0]
    assert refusal(path, skip_lines=9).startswith("no line of numbers")
    message = refusal(write("A1\nA2\n0,0\n1,0\n"), units="m,mm")
    assert message.endswith("pass skip_lines= (--skip-lines on the command line) with 2 or more if "
                            "the road begins below")  # fmt: skip


# Chainages


@pytest.mark.parametrize(
    ("stations", "units", "x"),
    [
        (["12+345.6", "12+346", "12+346.5"], "m", [12345.6, 12346.0, 12346.5]),
        (["-0+000.5", "0+000", "0 + 000.25"], "m", [-0.5, 0.0, 0.25]),
        (["12+345", "12+346", "12+347"], "km", [12345.0, 12346.0, 12347.0]),
        (["12+99.5", "13+00", "13+01"], "ft", [396.0876, 396.24, 396.5448]),
    ],
)
@pytest.mark.parametrize("block", [2, 4096])
def test_chainages_are_stations(
    write: Write,
    monkeypatch: pytest.MonkeyPatch,
    stations: list[str],
    units: str,
    x: list[float],
    block: int,
) -> None:
    monkeypatch.setattr(table, "BLOCK", block)
    path = write("".join(f"{station};0;{station}\n" for station in stations))
    np.testing.assert_allclose(read_profile(path, units=f"{units},mm").x, x, rtol=0, atol=1e-9)
    path = write("".join(f"0\t{station}\n" for station in stations))
    road = read_profile(path, units=f"{units},mm", columns=(1, 0))
    np.testing.assert_allclose(road.x, x, rtol=0, atol=1e-9)


@pytest.mark.parametrize(
    ("text", "units", "message"),
    [
        ("12+34.5,0\n12+35,0\n", "m", "1: the station '12+34.5' is no chainage in m: expected 12+"),
        ("12+345,0\n12+346,0\n", "ft", "1: the station '12+345' is no chainage in ft"),
        ("12+345,0\n12+346,0\n", "mm", "1: the station '12+345' is no chainage in mm"),
        ("0+999,0\n1000,0\n", "m", "2: expected a chainage in column 0 (counted from 0), found '1"),
        ("0+999,0\n1+0,0\n", "m", "2: expected a chainage in column 0 (counted from 0), found '1"),
        ("0.5,0\n1+000,0\n", "m", "2: expected a finite number in column 0 (counted from 0)"),
        ("0,0\n1,1+000\n", "m", "2: expected a finite number in column 1 (counted from 0)"),
        ("0+000,0\n0+001,1+000\n", "m", "2: expected a finite number in column 1"),
    ],
)
def test_what_is_no_chainage_is_refused(write: Write, text: str, units: str, message: str) -> None:
    assert refusal(write(text), units=f"{units},mm").startswith(message)


def test_a_column_that_does_not_exist_is_refused(write: Write) -> None:
    message = refusal(write("x,z\n0,0\n1,0\n"), units="m,m", columns=(0, 2))
    assert message == (
        "2: column 2 (counted from 0) does not exist, found 2 separated by comma in '0,0': "
        "pass columns= or delimiter= (--columns or --delimiter on the command line), or step= "
        "(--step) if there are no stations"
    )


# Units


@pytest.mark.parametrize("label", ["", "x,z\n", "x [m], z [furlong]\n", "x [m]\n", "x [m], z\n"])
def test_units_are_never_guessed(write: Write, label: str) -> None:
    assert refusal(write(f"{label}0,0\n1,0\n")) == (
        'the file does not state its units: pass units="m,mm" (station, elevation) in Python or '
        "--units m,mm on the command line; known units: m, mm, cm, km, ft, in, mil"
    )


def test_units_that_disagree_with_the_file_are_refused(write: Write) -> None:
    expected = "1: the units stated here are m,mm: pass these or correct this line"
    assert refusal(write(GOOD), units="m,m") == expected


def test_an_unknown_unit_is_refused(write: Write) -> None:
    message = refusal(write(GOOD), units="m,furlong")
    assert message.startswith("unknown unit 'furlong' in units: pass units=\"m,mm\"")
    assert message.endswith("known units: m, mm, cm, km, ft, in, mil")


@pytest.mark.parametrize("units", ["m", "m,m,m", ("m",)])
def test_units_must_be_two(write: Write, units: Any) -> None:
    assert refusal(write(GOOD), units=units).startswith("units must name two units, got ")


@pytest.mark.parametrize(
    ("step", "units", "fitting"),
    [
        (250, "m,m", "mm (0.25 m) or cm (2.5 m)"),
        (0.00025, "m,mm", "km (0.25 m)"),
        (1e9, "m,m", "none: then pass columns= or step= (--columns or --step on"),
    ],
)
def test_stations_in_the_wrong_unit_are_refused(
    write: Write, step: float, units: str, fitting: str
) -> None:
    message = refusal(write("".join(f"{i * step},0\n" for i in range(5))), units=units)
    assert message.startswith(
        f"the stations in m have a median step of {step:.6g} m, expected 0.001 m to 5 m: "
        f'pass units="UNIT,{units[2:]}" (--units UNIT,{units[2:]}) with the unit they are in, '
        "which may be "
    )
    assert fitting in message


def test_a_wrong_unit_of_stations_is_to_be_corrected_where_it_is_stated(write: Write) -> None:
    text = "# levels\nx [m];z [mm]\n" + "".join(f"{0.00025 * i:.5f};{i % 7}\n" for i in range(30))
    message = refusal(write(text))
    assert ": correct line 2 with the unit they are in, which may be km (0.25 m)" in message
    assert read_profile(write(text.replace("[m]", "[km]"))).x[-1] == pytest.approx(7.25)


def test_a_road_of_stations_too_far_apart_is_told_what_it_lacks(write: Write) -> None:
    path = write("".join(f"{20 * i} {i % 7}\n" for i in range(30)))
    assert "has lost the bumps that vehicles feel" in refusal(path, units="m,mm")


@pytest.mark.parametrize(("given_unit", "finer"), [("m", "mm"), ("mm", "mil")])
def test_elevations_in_the_wrong_unit_are_refused(
    write: Write, given_unit: str, finer: str
) -> None:
    message = refusal(write("0,0\n0.1,0\n0.2,250\n"), units=f"m,{given_unit}")
    assert message.startswith(f"3: the elevation in {given_unit} changes by ")
    assert "steeper than 1 m/m: correct it, or " in message
    advice = f'pass units="m,{finer}" (--units m,{finer})'
    assert message.endswith(f"if the elevations are in {finer}, {advice}")


# Several tracks

TRACKS = "x [m], left [mm], speed [km/h], right (in)\n0.0, 0, 80, 1\n0.1, 2, 80, 1\n0.2, 3, 81, 1\n"


def test_every_column_with_a_unit_of_length_is_a_track(write: Write) -> None:
    left, right = read_tracks(write(TRACKS))
    assert [left.name, right.name] == ["road left", "road right"]
    np.testing.assert_allclose(left.elevation, [0, 2e-3, 3e-3], rtol=0, atol=1e-15)
    np.testing.assert_allclose(right.elevation, [0.0254] * 3, rtol=0, atol=1e-15)
    assert left.x.tolist() == right.x.tolist() == [0.0, 0.1, 0.2]


def test_the_first_track_is_read_unless_another_is_asked_for(write: Write) -> None:
    left, right = read_tracks(write(TRACKS))
    path = write(TRACKS)
    assert read_profile(path) == left
    assert read_profile(path).name == "road left"
    for track in (1, "1", "right", "RIGHT", " Right "):
        assert read_profile(path, track=track) == right
        assert read_profile(path, track=track).name == "road right"
    assert read_profile(path, track=1, name="A1").name == "A1"
    assert [road.name for road in read_tracks(path, name="A1")] == ["A1 left", "A1 right"]


@pytest.mark.parametrize("track", [2, -1, "2", "middle", "", "1" * 30])
def test_an_unknown_track_is_refused_with_those_that_there_are(write: Write, track: Any) -> None:
    message = refusal(write(TRACKS), track=track)
    assert message.startswith("no track '")
    assert message.endswith(
        "there are 0: 'left', 1: 'right': pass track= (--track on the command line) with one of "
        "these"
    )


def test_a_label_goes_before_a_number_and_must_be_one(write: Write) -> None:
    path = write("x [m],1 [mm],0 [mm],a [m],A [m]\n0,1,2,0,0\n1,1,2,0,0\n")
    assert read_profile(path, track="1").name == "road 1"
    assert read_profile(path, track=1).name == "road 0"
    expected = "tracks 2 and 3 are both labelled 'a': pass a number"
    assert refusal(path, track="A") == expected


def test_tracks_are_chosen_by_columns_and_numbered_without_labels(write: Write) -> None:
    path = write("0 1 5 3\n1 2 5 4\n")
    roads = read_tracks(path, units="m,m", columns=[0, 3, 1])
    assert [road.elevation.tolist() for road in roads] == [[3, 4], [1, 2]]
    assert [road.name for road in roads] == ["road track 0", "road track 1"]
    assert [road.name for road in read_tracks(path, units="m,m")] == ["road"]
    assert read_profile(path, units="m,m", columns=(0, 2, 1), track=1).elevation.tolist() == [1, 2]


def test_a_track_that_is_not_wanted_may_hold_anything(write: Write) -> None:
    path = write("x [m], z [mm], altitude [m]\n0.0, 0, -\n0.1, 2, 500\n")
    assert read_profile(path).elevation[-1] == pytest.approx(2e-3, abs=1e-15)
    assert "found '-'" in refusal(path, track="altitude")


def test_units_passed_must_agree_with_all_that_the_file_states(write: Write) -> None:
    path = write("x [m], left [mm], right [mm]\n0,0,0\n1,1,1\n")
    assert read_tracks(path, units="m,mm") == read_tracks(path)
    assert refusal(path, units="m,cm") == (
        "1: the units stated here are m,mm,mm: pass these or correct this line"
    )
    assert refusal(write(TRACKS), units="m,mm") == (
        "1: the units stated here are m,mm,in: pass none or correct this line"
    )
    message = refusal(write("x [ft], z\n0,0\n1,1\n"), units="m,mm")
    assert message.startswith("1: the units stated here are ft,?: pass")


def test_units_passed_complete_those_that_the_header_states(write: Write) -> None:
    path = write("x, z [mm]\n0,0\n1,2\n")
    assert read_profile(path, units="m,mm").elevation[-1] == pytest.approx(2e-3, abs=1e-15)


# Files without stations


@pytest.mark.parametrize(
    ("content", "arguments"),
    [
        ("0\n2\n3\n", {"units": "mm"}),
        ("z [mm]\n0\n2\n3\n", {}),
        ("# z [mm]\n0\n2\n3\n", {"units": ("mm",)}),
        ("lane,z [mm]\nA,0\nA,2\nA,3\n", {}),
        ("5;0\n5;2\n5;3\n", {"units": "mm", "columns": (1,)}),
    ],
)
def test_a_file_without_stations_is_read_with_a_step(
    write: Write, content: str, arguments: dict[str, Any]
) -> None:
    road = read_profile(write(content), step=0.25, **arguments)
    assert road.x.tolist() == [0.0, 0.25, 0.5]
    np.testing.assert_allclose(road.elevation, [0, 2e-3, 3e-3], rtol=0, atol=1e-15)


def test_several_tracks_without_stations_are_read_with_a_step(write: Write) -> None:
    path = write("left [mm] right [mm]\n0 1\n2 1\n")
    assert [road.name for road in read_tracks(path, step=0.1)] == ["road left", "road right"]


def test_a_file_without_stations_and_a_step_is_told_to_pass_one(write: Write) -> None:
    message = refusal(write("0\n1\n"), units="m,m")
    assert message.startswith("1: column 1 (counted from 0) does not exist, found 1 separated by")
    assert message.endswith("or step= (--step) if there are no stations")


def test_a_column_that_does_not_exist_is_refused_with_a_step_too(write: Write) -> None:
    message = refusal(write("0\n1\n"), units="mm", step=0.25, columns=(3,))
    assert message.endswith("pass columns= or delimiter= (--columns or --delimiter on the command "
                            "line)")  # fmt: skip


def test_units_with_a_step_are_one(write: Write) -> None:
    path = write("0\n1\n")
    assert refusal(path, units="m,mm", step=0.25) == (
        'units must name one unit, since step= is in metres, got 2: pass units="mm" (elevation) '
        "in Python or --units mm on the command line; known units: m, mm, cm, km, ft, in, mil"
    )
    assert refusal(path, step=0.25).startswith('the file does not state its units: pass units="mm')


# Stations


def test_a_gap_in_the_stations_is_refused_with_the_line(write: Write) -> None:
    def file(gap: float, step: float) -> Path:
        return write("".join(f"{i * step + gap * (i > 9)} 0\n" for i in range(20)))

    message = refusal(file(20, 0.1), units="m,m")
    assert message == (
        "11: station 21 m comes 20.1 m after 0.9 m on line 10, where the median step is 0.1 m: "
        "correct the station, or cut the file here and read the part before or after the gap"
    )
    assert read_profile(file(9.8, 0.1), units="m,m").x[-1] == pytest.approx(11.7)
    assert read_profile(file(4.9, 0.01), units="m,m").x[-1] == pytest.approx(5.09)
    assert refusal(file(5.1, 0.01), units="m,m").startswith("11: station 5.2 m comes")


def test_stations_rounded_until_they_repeat_may_be_left_out(write: Write) -> None:
    path = write("x [m],z [mm]\n" + "".join(f"{0.004 * i:.2f},{i % 4}\n" for i in range(50)))
    message = refusal(path)
    assert message.startswith("3: station 0 m repeats 0 m on line 2, as 28 others do: they are ")
    assert message.endswith(
        "pass step= and columns= (--step and --columns) of the elevations alone"
    )
    assert read_profile(path, step=0.004, columns=(1,)).x[-1] == pytest.approx(0.196)


@pytest.mark.parametrize(
    ("stations", "message"),
    [
        ((0, 1, 1, 2), "5: station 1 m repeats 1 m on line 3: remove one of the two lines"),
        (
            (0, 2, 1, 3),
            "5: station 1 m lies before 2 m on line 3: sort the lines by station, or pass columns=",
        ),
        ((3, 2, 1, 0), "3: station 2 m lies before 3 m on line 2, and so on: reverse the order"),
    ],
)
def test_stations_that_do_not_increase_are_refused(
    write: Write, stations: tuple[int, ...], message: str
) -> None:
    lines = ["x_m,z_m", *(f"{x},0" for x in stations)]
    lines.insert(3, "# a comment")
    assert refusal(write("\n".join(lines))).startswith(message)


# Columns that are no elevations

COUNTED = "".join(f"{i}{{0}}{0.25 * i:.2f}{{0}}{i * i % 7 / 7:.3f}\n" for i in range(30))


@pytest.mark.parametrize("label", ["", "n,x,z\n", ",x,z\n", "a,b,c\n", "# n, x, z\n"])
def test_a_counter_in_the_stations_place_is_refused_with_the_columns_to_pass(
    write: Write, label: str
) -> None:
    path = write(label + COUNTED.format(","))
    message = refusal(path, units="m,mm")
    assert "counts the lines or holds stations: pass columns=(1, 2) (--columns 1,2) for" in message
    assert message.endswith("or pass columns=(0, 1) (--columns 0,1) if it is right all the same")
    assert read_profile(path, units="m,mm", columns=(1, 2)).x[-1] == pytest.approx(7.25)
    assert read_profile(path, units="m,mm", columns=(0, 1)).x[-1] == pytest.approx(29)


def test_a_counter_with_a_name_is_refused_though_the_stations_are_uneven(write: Write) -> None:
    rows = "".join(f"{i},{0.25 * i + 0.01 * (i % 3):.2f},{i % 5}\n" for i in range(30))
    assert "pass columns=(1, 2)" in refusal(write(f"No.,x,z\n{rows}"), units="m,mm")
    assert read_profile(write(f"x,left,right\n{rows}"), units="m,mm").x[-1] == 29


def test_times_before_the_stations_are_told_of(write: Write) -> None:
    path = write("".join(f"{0.01 * i:.2f} {0.25 * i:.2f} {i % 5}\n" for i in range(30)))
    assert "pass columns=(1, 2) (--columns 1,2) for those after" in refusal(path, units="m,mm")
    assert read_profile(path, units="m,mm", columns=(1, 2)).x[-1] == pytest.approx(7.25)


@pytest.mark.parametrize("label", ["", "No.", "index"])
def test_a_counter_beside_nothing_but_heights_is_refused_with_the_step_to_pass(
    write: Write, label: str
) -> None:
    rows = "".join(f"{i},{i % 5}\n" for i in range(30))
    path = write(f"{label},z\n{rows}")
    message = refusal(path, units="m,mm")
    assert "pass step= (--step on the command line) and columns=(1,) (--columns 1) if" in message
    assert read_profile(path, units="mm", step=0.25, columns=(1,)).x[-1] == pytest.approx(7.25)
    assert read_profile(path, units="m,mm", columns=(0, 1)).x[-1] == 29
    assert read_profile(write(f"x,z\n{rows}"), units="m,mm").x[-1] == 29


@pytest.mark.parametrize(
    ("n", "place"), [(0, "columns=(1, 2) (--columns 1,2)"), (1, "columns=(0, 2) (--columns 0,2)")]
)
def test_a_counter_in_the_elevations_place_is_refused(write: Write, n: int, place: str) -> None:
    columns = [[f"{0.3 * i:.1f}" for i in range(20)], ["5"] * 20]
    columns.insert(n, list(map(str, range(1, 21))))
    path = write("\n".join(map(" ".join, zip(*columns, strict=True))))
    assert place in refusal(path, units="m,mm")


@pytest.mark.parametrize("unit", ["m", "mm", "ft"])
def test_stations_in_the_heights_place_are_refused_in_any_unit(write: Write, unit: str) -> None:
    rows = "".join(f"{0.25 * i / tracks.UNITS[unit]:.3f};{i % 5}\n" for i in range(30))
    message = refusal(write(rows), units="mm", step=0.25)
    assert (
        "column 0 (counted from 0) counts the lines or holds stations: pass columns=(1,)" in message
    )
    message = refusal(write(f"x [{unit}];z [mm]\n{rows}"), step=0.25)
    assert "pass columns=(1,) (--columns 1) for those after it" in message
    only = "".join(f"{row.split(';')[0]}\n" for row in rows.splitlines())
    message = refusal(write(only), units="mm", step=0.25)
    assert message.endswith("stations: pass columns=(0,) (--columns 0) if it is right all the same")


@pytest.mark.parametrize(("unit", "digits"), [("m", 2), ("km", 5), ("ft", 3), ("mm", 0)])
def test_stations_twice_are_no_road_though_both_units_are_stated(
    write: Write, unit: str, digits: int
) -> None:
    size = tracks.UNITS[unit]
    rows = "".join(f"0+{0.25 * i:06.2f};{0.25 * i / size:.{digits}f};{i % 5}\n" for i in range(30))
    path = write(f"Stat. [km];Stat. 2 [{unit}];z [mm]\n{rows}")
    message = refusal(path)
    assert (
        "column 1 (counted from 0) counts the lines or holds stations: pass columns=(0, 2)"
        in message
    )
    assert read_profile(path, columns=(0, 2)) == read_profile(path, track="z")


def test_a_straight_grade_is_a_road(write: Write) -> None:
    grade = "".join(f"{i},{10 * i}\n" for i in range(30))
    assert read_profile(write(grade), units="m,mm").elevation[-1] == pytest.approx(0.29)
    steep = "".join(f"{i},{i}\n" for i in range(30))
    assert "counts the lines" in refusal(write(steep), units="m,mm")
    assert read_profile(write(f"x [m],z [mm]\n{steep}")).elevation[-1] == pytest.approx(0.029)
    assert read_profile(write(steep[:28]), units="m,mm").x.size == 7


def test_a_point_number_before_named_units_is_told_of(write: Write) -> None:
    path = write("n,x [m],z [mm]\n1,0,0\n2,1,1\n")
    advice = "column 0 has none ('n'), pass columns=(1, 2) (--columns 1,2) for those that have"
    assert refusal(path) == f"1: the file does not state its units: {advice}"
    assert refusal(path, units="m,mm") == f"1: the units stated here are ?,m,mm: {advice}"
    assert refusal(write("n,x [m],z [mm]\n1,0,0\n2,1,1\n"), columns=(0, 2)).startswith(
        "the file does not state its units: pass units"
    )


# Packed files


@pytest.mark.parametrize("name", ["road.csv.gz", "road.gz", "road"])
def test_a_packed_file_is_read_whatever_its_name(tmp_path: Path, name: str) -> None:
    (tmp_path / name).write_bytes(gzip.compress(GOOD.encode()))
    assert read_profile(tmp_path / name).name == "road"
    assert read_profile(tmp_path / name).elevation[-1] == pytest.approx(3e-3, abs=1e-12)


@pytest.mark.parametrize(
    "damage",
    [
        lambda data: data[:-1],
        lambda data: data[:15],
        lambda data: data[:2],
        lambda data: data + b"more",
        lambda data: data[:-8] + b"\0" * 8,
        lambda data: data[:20] + b"\xff" * 9 + data[29:],
    ],
)
def test_a_damaged_packed_file_is_refused(write: Write, damage: Callable[[bytes], bytes]) -> None:
    message = refusal(write(damage(gzip.compress(GOOD.encode()))))
    assert message.startswith("the gz file is damaged (")
    assert message.endswith("): copy it again")


CRG = f"""$CT
A road
$ROAD_CRG
REFERENCE_LINE_START_U = 0.0
REFERENCE_LINE_END_U = 4.0
REFERENCE_LINE_INCREMENT = 1.0
LONG_SECTION_V_RIGHT = -0.5
LONG_SECTION_V_LEFT = 0.5
LONG_SECTION_V_INCREMENT = 1.0
$!
$KD_Definition
#:LRFI
D:long section 1,m
D:long section 2,m
$!
{"$$$$$$$$10$$$$$$$$20$$$$$$$$30$$$$$$$$40$$$$$$$$50$$$$$$$$60$$$$$$$$70$$$$$$$$80"}
""" + "".join(f" 0.00{i}0000 0.0100000\n" for i in range(5))


def test_a_packed_open_crg_file_is_read_and_refused_by_its_own_name(tmp_path: Path) -> None:
    pytest.importorskip("pyopencrg")
    path = tmp_path / "road.crg.gz"
    path.write_bytes(gzip.compress(CRG.encode()))
    right, left = read_tracks(path)
    assert [right.name, left.name] == ["road v=-0.5", "road v=0.5"]
    assert right.elevation == pytest.approx(1e-3 * np.arange(5), abs=1e-12)
    assert refusal(path, missing=-999).startswith(
        "an OpenCRG file states this itself: leave out mis"
    )
    path.write_bytes(gzip.compress(CRG[:-40].encode()))
    assert refusal(path).startswith("pyopencrg cannot read this")


def test_what_is_warned_of_a_packed_open_crg_file_names_it(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def read_with_a_note(file: str, *arguments: Any) -> list[RoadProfile]:
        warnings.warn(f"{file}: a note", UserWarning, stacklevel=2)
        return [RoadProfile([0, 1], [0, 0])]

    monkeypatch.setattr(read, "read_crg", read_with_a_note)
    path = tmp_path / "road.crg.gz"
    path.write_bytes(gzip.compress(CRG.encode()))
    with pytest.warns(UserWarning, match="a note") as told:
        read_tracks(path)
    assert [(str(one.message), one.filename) for one in told] == [(f"{path}: a note", __file__)]


@pytest.mark.slow
def test_a_packed_file_may_not_unfold_without_end(
    write: Write, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(packed, "FEW_BYTES", 2**20)
    path = write(gzip.compress(GOOD.encode() + b"\n" * 2 * 10**6))
    tracemalloc.start()
    message = refusal(path)
    peak = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    assert message == "the gz file holds more than 1 MiB: unpack it with gunzip if it is a road"
    assert peak < 8e6
    monkeypatch.setattr(packed, "MAX_RATIO", 2000)
    assert read_profile(path).x.size == 3


# Arguments


@pytest.mark.parametrize(
    ("arguments", "error", "message"),
    [
        (
            {"units": 5},
            TypeError,
            r"^units must be a string like \"m,mm\" or a pair of strings, got 5",
        ),
        ({"units": (1, 2)}, TypeError, "^units must be"),
        ({"columns": "x"}, ValueError, r"^columns must be two or more different .* \(0, 1\)"),
        ({"columns": (1, 1)}, ValueError, "^columns must be two or more different"),
        ({"columns": (1,)}, ValueError, "^columns must be two or more different"),
        ({"columns": (), "step": 0.1}, ValueError, r"^columns must be one or more .* \(0,\)"),
        ({"columns": 3}, ValueError, "^columns must be two or more different"),
        ({"columns": ("a", "b")}, TypeError, "^columns must be"),
        ({"columns": (0, -1)}, ValueError, "^columns must be 0 or more"),
        ({"delimiter": "|"}, ValueError, "^delimiter must be one of"),
        ({"name": 5}, TypeError, "^name must be a string"),
        ({"step": 0}, ValueError, r"^step must be above 0 \[m\]"),
        ({"step": 250}, ValueError, "^step must be 0.001 m to 5 m, got 250"),
        ({"step": "x"}, TypeError, "^step must be one number"),
        ({"track": 1.5}, TypeError, "^track must be a label or a whole number, got 1.5"),
        ({"track": True}, TypeError, "^track must be a label or a whole number"),
        ({"decimal": ";"}, ValueError, r"^decimal must be one of '\.', ','"),
        ({"decimal": ",", "delimiter": ","}, ValueError, "^decimal and delimiter are both"),
        ({"missing": True}, TypeError, "^missing must be numbers or words, got True: type missing"),
        ({"missing": (None,)}, TypeError, "^missing must be numbers or words"),
        ({"missing": {}}, TypeError, "^missing must be numbers or words"),
        ({"skip_lines": -1}, ValueError, "^skip_lines must be 0 or more"),
        ({"skip_lines": 1.5}, TypeError, "^skip_lines must be a whole number"),
    ],
)
def test_wrong_arguments_are_named(
    write: Write, arguments: dict[str, Any], error: type[Exception], message: str
) -> None:
    with pytest.raises(error, match=message):
        read_profile(write(GOOD), **arguments)


@pytest.mark.parametrize("path", [5, None, b"road.csv"])
def test_a_path_that_is_none_is_a_type_error(path: Any) -> None:
    with pytest.raises(TypeError, match=r"^path must be a string or a Path.*type path="):
        read_profile(path)


# Damaged files

HEAD = b"".join(UTIA.splitlines(keepends=True)[:200])
POSITION = st.integers(0, len(HEAD))
BYTES = st.binary(min_size=1, max_size=6) | st.sampled_from(
    [
        b"\n",
        b" ",
        b",",
        b";",
        b"\t",
        b"#",
        b"nan",
        b"1e999",
        b"_",
        b"-",
        b"\n\n",
        b"9",
        b"\xef\xbb\xbf",
    ]
)


def swapped(data: bytes, first: int, second: int) -> bytes:
    """Swap two lines."""
    lines = data.splitlines(keepends=True) or [b""]
    i, j = first % len(lines), second % len(lines)
    lines[i], lines[j] = lines[j], lines[i]
    return b"".join(lines)


PIECES = ["0;0\n", "0,25;1,5\n", "0,5;-9\n", "1,000;2,000\n", "0+001 ", "0+002,5;", "1\n", "nan\n"]
PIECES += ["x [m];z [mm]\n", "Road: A1\n", ";", ",", "1;nan\n", "2,5;\n", "3;1e30\n", "sep=;\n"]

MUTATIONS = st.one_of(
    st.builds(lambda i, new: lambda d: d[:i] + new + d[i + len(new) :], POSITION, BYTES),
    st.builds(lambda i, new: lambda d: d[:i] + new + d[i:], POSITION, BYTES),
    st.builds(lambda i, n: lambda d: d[:i] + d[i + n :], POSITION, st.integers(1, 30)),
    st.builds(lambda i, j: lambda d: swapped(d, i, j), POSITION, POSITION),
    st.builds(lambda i: lambda d: d[:i], POSITION),
)


def outcome(path: Path, **arguments: Any) -> RoadProfile | str:
    """Return the road or the refusal; anything else is an error of the reader."""
    try:
        with warnings.catch_warnings():
            warnings.filterwarnings("ignore", ".* left out|.* passed over, ", UserWarning)
            return read_profile(path, **arguments)
    except ProfileFileError as error:
        return str(error)


def assert_read_or_refused(path: Path, **arguments: Any) -> None:
    """Assert that the fast and the careful way give one road, or one line of refusal."""
    fast = outcome(path, **arguments)
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(table.Layout, "_plain", lambda self, texts: None)
        assert outcome(path, **arguments) == fast
    if isinstance(fast, str):
        assert fast.startswith(f"{path}:")
        assert fast.isprintable()


@given(mutations=st.lists(MUTATIONS, min_size=1, max_size=4), block=st.sampled_from([3, 50, 4096]))
@settings(max_examples=150, deadline=None)
def test_a_damaged_file_is_read_or_refused_and_the_fast_path_agrees(
    mutations: list[Callable[[bytes], bytes]], block: int
) -> None:
    data = HEAD
    for mutate in mutations:
        data = mutate(data)
    with tempfile.TemporaryDirectory() as folder, pytest.MonkeyPatch.context() as patch:
        path = Path(folder, "road.txt")
        path.write_bytes(data)
        patch.setattr(table, "BLOCK", block)
        assert_read_or_refused(path, units="m,m")


@pytest.mark.slow
@given(
    data=st.binary(max_size=60)
    | st.text("0123456789.,;-+eE_ \t\r\n#%/xzm[]()naif\x1c\x85\xa0", max_size=80).map(str.encode)
    | st.lists(st.sampled_from(PIECES), max_size=16).map(lambda words: "".join(words).encode()),
    arguments=st.fixed_dictionaries(
        {},
        optional={
            "units": st.just("m,mm"),
            "delimiter": st.sampled_from([",", " ", ";"]),
            "columns": st.sampled_from([(0, 1), (2, 0)]),
            "decimal": st.sampled_from([",", "."]),
            "missing": st.sampled_from([-9, "nan", "", (0, "e", 1e30)]),
            "skip_lines": st.just(1),
        },
    ).filter(lambda given: not given.get("decimal") == given.get("delimiter") == ","),
)
@settings(max_examples=300, deadline=None)
def test_any_bytes_are_read_or_refused_and_the_fast_path_agrees(
    data: bytes, arguments: dict[str, Any]
) -> None:
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder, "road.txt")
        path.write_bytes(data)
        assert_read_or_refused(path, **arguments)


@pytest.mark.parametrize(
    "content", [10_000_000 * b"7", 10_000_000 * b"7 ", b"0 0\n" + 10**7 * b"\t"]
)
def test_a_line_without_an_end_is_refused(write: Write, content: bytes) -> None:
    line = 1 + content.count(b"\n")
    expected = f"{line}: more than 65536 characters: expected a station and elevations on each line"
    assert refusal(write(content), units="m,m") == expected


def test_the_first_fault_in_the_file_is_told(write: Write) -> None:
    content = b"0 0\n1 x\n" + 100_000 * b"2 2\n" + b"\xff\n"
    assert refusal(write(content), units="m,m").startswith("2: expected a finite number")
    content = 100_000 * b"2 2\n" + b"1\xff\n"
    assert refusal(write(content), units="m,m").startswith("100001: the byte 0xff is not text")


def test_a_disk_that_fails_is_told(write: Write, monkeypatch: pytest.MonkeyPatch) -> None:
    path = write(GOOD)

    class Failing:
        def __enter__(self) -> "Failing":
            return self

        def __exit__(self, *error: object) -> None:
            pass

        def read(self, size: int) -> bytes:
            raise OSError(5, "Input/output error")

    monkeypatch.setattr(lines, "open", lambda *arguments: Failing(), raising=False)
    expected = "cannot be read (Input/output error): check the disk or copy the file"
    assert refusal(path) == expected


def test_a_large_file_takes_less_memory_than_thrice_its_bytes(write: Write) -> None:
    n_lines = 100_000
    path = write("x_m,z_m\n" + "".join(f"{0.05 * i:.2f},0.123456\n" for i in range(n_lines)))
    tracemalloc.start()
    read_profile(path)
    peak = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    # Five arrays of one float a line at most, and the lines converted at once.
    assert peak < 5 * 8 * n_lines + 2.5e6
    assert peak < 3 * path.stat().st_size + 2.5e6
