"""One measured road as loggers, spreadsheets and surveyors write it: the same IRI, or one error.

An IRI may be off by 0.2 % of that of the plain file, in the library and on the command line.
"""

from __future__ import annotations

import gzip
import json
import re
import warnings
from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from helpers import run_command

from bridgectl.road import ProfileFileError, RoadProfile, read_profile, utia_road

ROAD = utia_road()
IRI = ROAD.iri()
MISSING = slice(60, None, 200)
"""Every 50 m a reading is missing."""


def rows(
    delimiter: str = ",",
    station: Callable[[float], str] = "{:.2f}".format,
    elevation: Callable[[float], str] = "{:.4f}".format,
    marker: str | None = None,
    unit: float = 1.0,
) -> str:
    """Lines of numbers, the elevations in a unit [m]."""
    heights = [elevation(z / unit) for z in ROAD.elevation]
    if marker is not None:
        heights[MISSING] = [marker] * len(heights[MISSING])
    pairs = zip(map(station, ROAD.x), heights, strict=True)
    return "".join(f"{x}{delimiter}{z}\n" for x, z in pairs)


def numbered(delimiter: str = ",") -> str:
    return "".join(
        f"{n}{delimiter}{line}\n" for n, line in enumerate(rows(delimiter).splitlines(), 1)
    )


def comma(text: str) -> str:
    return text.replace(".", ",")


def chainage(x: float) -> str:
    return f"{int(x) // 1000}+{x % 1000:06.2f}"


def us_chainage(x: float) -> str:
    feet = round(x / 0.3048, 7)
    return f"{int(feet) // 100}+{feet % 100:010.7f}"


@dataclass
class Variant:
    """A file, what a caller says of it, and what the caller is told."""

    content: str | bytes
    arguments: dict[str, Any] = field(default_factory=dict)
    warning: str = ""
    error: str = ""

    def write(self, folder: Path) -> Path:
        path = folder / "road.txt"
        content = self.content
        path.write_bytes(content if isinstance(content, bytes) else content.encode())
        return path

    def options(self) -> list[str]:
        return [f"--{name.replace('_', '-')}={self.word(v)}" for name, v in self.arguments.items()]

    @staticmethod
    def word(value: Any) -> str:
        return ",".join(map(str, value)) if isinstance(value, tuple) else str(value)


M_M = {"units": "m,m"}
PLAIN = "x [m],z [m]\n" + rows()
SEMICOLONS = comma("x [m];z [m]\n" + rows(";"))
TABS = comma("x [m]\tHöhe [m]\n" + rows("\t"))
MARKED = "x [m],z [m]\n" + rows(marker="-999.9")
ABOVE = "Road: UTIA\nDate: 2023-01-01\n\n"
LEFT_OUT = r"11 missing readings left out, the first on line 62; the widest gap is now 0\.5 m"

VARIANTS = {
    "plain": Variant(PLAIN),
    "semicolons and decimal commas": Variant(SEMICOLONS),
    "the same, told": Variant(SEMICOLONS, {"decimal": ",", "delimiter": ";"}),
    "sep=;": Variant("sep=;\n" + SEMICOLONS),
    "sep=, with a byte order mark": Variant("\ufeffsep=,\r\n" + PLAIN.replace("\n", "\r\n")),
    "UTF-16, tabs and decimal commas": Variant(TABS.encode("utf-16")),
    "UTF-16, big end first": Variant(b"\xfe\xff" + TABS.encode("utf-16-be")),
    "UTF-8 with its mark": Variant(TABS.encode("utf-8-sig")),
    "UTF-16 without its mark": Variant(
        TABS.encode("utf-16-le"), error="1: the byte 0x00 is not text: save the file as UTF-8"
    ),
    "Latin-1": Variant(TABS.encode("latin-1")),
    "white space and decimal commas": Variant(comma(rows("  ")), M_M),
    "commas and decimal commas": Variant(
        "x [m],z [m]\n" + comma(rows()), error="2: commas may separate columns or be decimal marks"
    ),
    "decimal commas and no header": Variant(
        comma(rows()), M_M, error="1: commas may separate columns or be decimal marks"
    ),
    "blanks around semicolons": Variant(
        comma(rows(" ; ")), {**M_M, "decimal": ",", "delimiter": ";"}
    ),
    "heights with decimal commas": Variant(
        "".join(f"{z:.4f}\n" for z in ROAD.elevation).replace(".", ","),
        {"units": "m", "step": 0.25},
        error="1: '583,1370' may be one number with a decimal comma or two: pass decimal",
    ),
    "heights with decimal commas, told": Variant(
        "".join(f"{z:.4f}\n" for z in ROAD.elevation).replace(".", ","),
        {"units": "m", "step": 0.25, "decimal": ","},
    ),
    "heights with decimal commas, named": Variant(
        "z [m]\n" + "".join(f"{z:.4f}\n" for z in ROAD.elevation).replace(".", ","),
        {"step": 0.25},
    ),
    "thousands in mm": Variant(
        "x [m];z [mm]\n" + rows(";", elevation="{:,.1f}".format, unit=1e-3),
        error="2: thousands separators are not understood, found '583,137.0': write 1234.5",
    ),
    "German thousands in mm": Variant(
        "x [m];z [mm]\n"
        + comma(rows(";", elevation="{:_.1f}".format, unit=1e-3)).replace("_", "."),
        error="2: thousands separators are not understood, found '583.137,0': write 1234,5",
    ),
    "lines above the header": Variant(
        ABOVE + PLAIN, warning="2 lines above the names and units on line 4 passed over, the first"
    ),
    "lines above the header, told": Variant(ABOVE + PLAIN, {"skip_lines": 3}),
    "lines above numbers": Variant(
        ABOVE + rows(), M_M, error="2: expected a finite number in each column, .* skip_lines"
    ),
    "lines above numbers, told": Variant(ABOVE + rows(), {**M_M, "skip_lines": 3}),
    "chainage": Variant("x [m],z [m]\n" + rows(station=chainage)),
    "chainage in Germany": Variant("Station [km+m];z [m]\n" + comma(rows(";", station=chainage))),
    "chainage in feet": Variant("x [ft],z [m]\n" + rows(station=us_chainage)),
    "chainage in another unit": Variant(
        "x [mm],z [m]\n" + rows(station=chainage),
        error=r"2: the station '0\+478\.00' is no chainage in mm: expected 12\+345\.6 with the",
    ),
    "gz": Variant(gzip.compress(PLAIN.encode())),
    "gz of UTF-16": Variant(gzip.compress(TABS.encode("utf-16"))),
    "gz cut short": Variant(
        gzip.compress(PLAIN.encode())[:-2000], error=" the gz file is damaged .*: copy it again"
    ),
    "a marker": Variant(
        MARKED, error=r"62: the elevation -999\.9 m looks like .*: pass missing=-999\.9 "
    ),
    "a marker, told": Variant(MARKED, {"missing": -999.9}, LEFT_OUT),
    "a marker in mm": Variant(
        "x [m],z [mm]\n" + rows(elevation="{:.1f}".format, unit=1e-3, marker="-9999"),
        {"missing": (-9999, "n/a")},
        LEFT_OUT,
    ),
    "NaN": Variant(
        "x [m],z [m]\n" + rows(marker="NaN"), error="62: expected a finite number in column 1"
    ),
    "NaN, told": Variant("x [m],z [m]\n" + rows(marker="NaN"), {"missing": "nan"}, LEFT_OUT),
    "empty cells, told": Variant("x [m],z [m]\n" + rows(marker=""), {"missing": ""}, LEFT_OUT),
    "point number first": Variant(
        "n,x [m],z [m]\n" + numbered(),
        error=r"1: the file does not state its units: column 0 has none .* pass columns=\(1, 2\)",
    ),
    "point number first, told": Variant("n,x [m],z [m]\n" + numbered(), {"columns": (1, 2)}),
    "point number first, no header": Variant(
        numbered(" "),
        M_M,
        error=r" column 1 .* counts the lines or holds stations: pass .*\(1, 2\)",
    ),
    "stations as heights": Variant(
        rows(" "),
        {"units": "m", "step": 0.25},
        error=r" column 0 .* counts the lines or holds stations: pass columns=\(1,\)",
    ),
}


def iri_of(road: RoadProfile) -> float:
    return float(road.resample(0.25).iri() if np.ptp(np.diff(road.x)) > 1e-6 else road.iri())


@pytest.mark.parametrize("name", VARIANTS)
def test_a_variant_has_the_iri_of_the_plain_file_or_one_clear_error(
    name: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    variant = VARIANTS[name]
    path = variant.write(tmp_path)
    status, out, err = run_command(capsys, "profile", path, "--json", *variant.options())
    if variant.error:
        with pytest.raises(ProfileFileError) as caught:
            read_profile(path, **variant.arguments)
        assert re.match(f"{re.escape(str(path))}:{variant.error}", str(caught.value))
        assert (status, out, err) == (2, "", f"bridgectl: error: {caught.value}\n")
        return
    with warnings.catch_warnings(record=True) as told:
        warnings.simplefilter("always")
        road = read_profile(path, **variant.arguments)
    assert iri_of(road) == pytest.approx(IRI, rel=2e-3)
    assert status == 0
    assert json.loads(out)["tracks"][0]["iri_m_per_km"] == pytest.approx(IRI, rel=2e-3)
    assert [re.search(variant.warning, str(one.message)) is not None for one in told] == (
        [True] if variant.warning else []
    )
    assert all(one.filename == __file__ for one in told)
    assert re.search(variant.warning, err)
    assert bool(err) == bool(variant.warning)
