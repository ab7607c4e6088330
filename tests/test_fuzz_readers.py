"""Damaged road files of every format are read, or refused with one line."""

import gzip
import importlib.util
import random
import tempfile
import warnings
from importlib import resources
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from bridgectl.road import ProfileFileError, read_profile, read_tracks

TXDOT = Path(__file__).parents[2] / "shared" / "profiles" / "txdot_track_run_e1.erd"
UTIA = (resources.files("bridgectl.road") / "data" / "utia_profile_1.txt").read_bytes()
ROWS = "".join(f"{0.001 * (i % 7):.4f} {-0.002 * (i % 5):.4f}\n" for i in range(100))

CSV = b"# A1\nx [m], left [mm], right [in]\n" + b"".join(
    b"%.2f, %d, %d\n" % (0.25 * i, i % 7, -i % 5) for i in range(100)
)
ERD = f"""ERDFILEV2.00
2, 100, -1, 1, 5, 0.25, -1,
TITLE   A road
SHORTNAMleft    right
LONGNAMEleft wheel track                right wheel track
UNITSNAMm       ft
XUNITS  m
XSTART  12.5
END
{ROWS}""".encode()
CRG = (
    b"""$CT
A road
$!
$ROAD_CRG
REFERENCE_LINE_START_U = 0.0
REFERENCE_LINE_END_U = 9.5
REFERENCE_LINE_INCREMENT = 0.5
LONG_SECTION_V_RIGHT = -1.0
LONG_SECTION_V_LEFT = 1.0
LONG_SECTION_V_INCREMENT = 1.0
$!
$KD_Definition
#:LRFI
D:long section 1,m
D:long section 2,m
D:long section 3,m
$!
$$$$$$$$10$$$$$$$$20$$$$$$$$30$$$$$$$$40$$$$$$$$50$$$$$$$$60$$$$$$$$70$$$$$$$$80
"""
    + b" *missing* 0.0100000 0.0200000\n"[1:]
    + 18 * b" 0.0100000 0.0000000-0.0100000\n"
    + b" 0.0100000 0.0000000 *missing*\n"
)


def shortened_txdot() -> bytes:
    """Return the first samples of the measured ERD file, with a matching count."""
    lines = TXDOT.read_bytes().splitlines(keepends=True)
    end = next(i for i, line in enumerate(lines) if line.startswith(b"END"))
    return b"".join(lines[: end + 101]).replace(b"25544", b"  100", 1)


EUROPEAN = "Straße;A1\nx [m];Höhe [mm];rechts [in]\n" + "".join(
    f"{0.25 * i:.2f};{i % 7},{i % 10};{-i % 5}\n".replace(".", ",") for i in range(100)
)
CHAINAGES = "n,Station [km+m],z [mm]\n" + "".join(
    f"{i},12+{345 + 0.25 * i:06.2f},{-999 if i % 40 == 9 else i % 7}\n" for i in range(100)
)
HEIGHTS = "".join(f"{i % 7},{i % 10}\n" for i in range(100))

SEEDS: dict[str, tuple[bytes, dict[str, Any]]] = {
    "plain": (b"".join(UTIA.splitlines(keepends=True)[:200]), {"units": "m,m"}),
    "csv": (CSV, {}),
    "step": (CSV, {"step": 0.25, "columns": (1, 2)}),
    "erd": (ERD, {}),
    "european": (b"sep=;\n" + EUROPEAN.encode(), {}),
    "latin": (EUROPEAN.encode("latin-1"), {"decimal": ",", "skip_lines": 1}),
    "utf-16": (EUROPEAN.replace(";", "\t").encode("utf-16"), {}),
    "chainages": (CHAINAGES.encode(), {"columns": (1, 2), "missing": (-999, "nan", "")}),
    "heights": (HEIGHTS.encode(), {"units": "mm", "step": 0.25, "decimal": ","}),
    "gz": (gzip.compress(CSV), {}),
    "gz of erd": (gzip.compress(ERD), {"missing": 0.006}),
}
if TXDOT.exists():
    SEEDS["txdot"] = (shortened_txdot(), {})
if importlib.util.find_spec("pyopencrg"):
    SEEDS["crg"] = (CRG, {})

WORDS = [
    *(b"\n", b"\r", b"\r\n", b" ", b",", b";", b"\t", b"#", b"%", b"_", b"-", b"+", b".", b"\0"),
    *(b"nan", b"inf", b"1e999", b"-1e-999", b"1e18", b"9" * 400, b"0x1p3", b"1_0", b"1d3"),
    *(
        b'"',
        b'"""\'\'\'""',
        b"'",
        b"[",
        b"]",
        b"[m]",
        b"(mm)",
        b"_in",
        b"\xef\xbb\xbf",
        b"\xff\xfe",
    ),
    *("٣".encode(), b"\xe4", b"\xed\xb2\x80", b"\x1a", b"\x1c", b"\x85", "\u2028".encode()),
    *(
        b"0,25",
        b"1,234",
        b"1.234,5",
        b"1'000",
        b"12+345",
        b"12+34.5",
        b"0+0",
        b"sep=,\n",
        b"sep=;\n",
    ),
    *(b"-999", b"9999", b"-999,9", b"NaN", b"N/A", b"1e30", b"\x1f\x8b\x08", b"\xfe\xff", b"\xfc"),
    *(b"END\n", b"ERDFILEV2.00\n", b"XUNITS  ", b"UNITSNAM", b"furlong", b"m/s", b"&1000"),
    *(
        b"$",
        b"$!\n",
        b"$KD_Definition\n",
        b"$$$$\n",
        b"*missing*",
        b"D:long section 4,m\n",
        b"KRBI",
    ),
]


def mutated(data: bytes, rng: random.Random) -> bytes:
    """Return data after one deletion, repetition, flip, insertion, cut or splice."""
    i, j = sorted(rng.randrange(len(data) + 1) for _ in range(2))
    if rng.random() < 0.8:
        j = min(j, i + rng.randrange(1, 30))
    kind = rng.randrange(7)
    if kind == 0:
        return data[:i] + data[j:]
    if kind == 1:
        return data[:j] + data[i:j] * rng.choice([1, 1, 5]) + data[j:]
    if kind == 2 and data:
        i = min(i, len(data) - 1)
        return data[:i] + bytes([data[i] ^ 1 << rng.randrange(8)]) + data[i + 1 :]
    if kind == 3:
        return data[:i] + rng.choice(WORDS) + data[rng.choice([i, j]) :]
    if kind == 4:
        return data[:j] if rng.random() < 0.3 else data[:i] + data[j : j + 20] + data[i:j]
    if kind == 5:  # swap two lines
        lines = data.splitlines(keepends=True) or [b""]
        a, b = rng.randrange(len(lines)), rng.randrange(len(lines))
        lines[a], lines[b] = lines[b], lines[a]
        return b"".join(lines)
    other = rng.choice(list(SEEDS.values()))[0]
    k = rng.randrange(len(other))
    return data[:i] + other[k : k + rng.randrange(200)] + data[j:]


def assert_read_or_refused(path: Path, **arguments: Any) -> bool:
    """Return whether a file is read; assert finite tracks, or else one line."""
    tracks = arguments.pop("track", None)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        warnings.filterwarnings("ignore", "(?s).* left out|.* passed over, ", UserWarning)
        warnings.filterwarnings("ignore", ".*: (pyopencrg notes: |left out )")
        try:
            roads = read_tracks(path, **arguments) if tracks is None else []
            roads = roads or [read_profile(path, track=tracks, **arguments)]
        except ProfileFileError as error:
            message = str(error)
            assert message.startswith(f"{path}:")
            assert message.isprintable()
            assert len(message) < 1000
            return False
    for road in roads:
        assert road.x.size == road.elevation.size >= 2
        assert np.isfinite(road.x).all()
        assert np.isfinite(road.elevation).all()
        assert (np.diff(road.x) > 0).all()
    return True


@pytest.mark.parametrize("seed", SEEDS)
def test_the_files_are_read_before_they_are_damaged(seed: str, tmp_path: Path) -> None:
    data, arguments = SEEDS[seed]
    (tmp_path / "road").write_bytes(data)
    assert assert_read_or_refused(tmp_path / "road", **arguments)


@pytest.mark.slow
@pytest.mark.parametrize("seed", SEEDS)
def test_a_damaged_file_is_read_or_refused_with_one_line(seed: str, tmp_path: Path) -> None:
    data, arguments = SEEDS[seed]
    path = tmp_path / "road"
    rng = random.Random(seed)
    read = 0
    for _ in range(500):
        damaged = data
        for _ in range(rng.choice([1, 1, 1, 2, 5])):
            damaged = mutated(damaged, rng)
        path.write_bytes(damaged)
        read += assert_read_or_refused(path, **arguments)
    # Else the damage is of one kind; but that to a checksum always is.
    assert (0 if data.startswith(b"\x1f\x8b") else 5) < read < 495


@pytest.mark.slow
@pytest.mark.parametrize("seed", SEEDS)
@given(data=st.data())
@settings(max_examples=100, deadline=None)
def test_a_file_spliced_with_anything_is_read_or_refused(seed: str, data: st.DataObject) -> None:
    content, arguments = SEEDS[seed]
    i = data.draw(st.integers(0, len(content)))
    j = data.draw(st.integers(i, min(len(content), i + 60)))
    word = data.draw(st.binary(max_size=20) | st.text(max_size=20).map(str.encode))
    track = data.draw(st.sampled_from([None, 0, 1, "right", "rechts"]))
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder, "road")
        path.write_bytes(content[:i] + word + content[j:])
        assert_read_or_refused(path, **arguments, track=track)


@pytest.mark.parametrize("seed", SEEDS)
@pytest.mark.parametrize(
    "damage",
    [
        lambda data: b"",
        lambda data: data[:12],
        lambda data: data[: data.find(b"\n") + 1],
        lambda data: data + b"\0" * 10_000,
        lambda data: data.replace(b" ", b"\0"),
        lambda data: data.replace(b"\n", b"\r"),
        lambda data: data.replace(b"\n", b" "),
        lambda data: data.decode("latin-1").encode("utf-16"),
        lambda data: data.decode("latin-1").encode("utf-16-be"),
        lambda data: gzip.compress(data),
        lambda data: gzip.compress(data)[:-9],
        lambda data: data.replace(b".", b","),
        lambda data: b"\xef\xbb\xbf" + data,
        lambda data: data + b"7" * 10_000_000,
        lambda data: data[:-1] + b" " * 10_000_000 + b"\n",
        lambda data: b'"' * 100_000 + data,
        lambda data: data + b"\n" * 1_000_000,
        lambda data: data.replace(b"100,", b"%d," % 10**18),
        lambda data: data.replace(b"2, ", b"1e9, ", 1),
        lambda data: data.replace(b"0.25", b"nan"),
        lambda data: data.replace(b"0.25", b"0"),
        lambda data: data.replace(b"0.25", b"-0.25"),
        lambda data: data.replace(b"0.5", b"nan"),
        lambda data: data.replace(b"0.5", b"0"),
    ],
)
def test_wholly_damaged_files_are_read_or_refused(seed: str, damage: Any, tmp_path: Path) -> None:
    data, arguments = SEEDS[seed]
    (tmp_path / "road").write_bytes(damage(data))
    assert_read_or_refused(tmp_path / "road", **arguments)
