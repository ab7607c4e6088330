"""Read road profiles from files: delimited text, ERD text and OpenCRG.

Nothing about a file is guessed that could change the road: its units are stated in the file or by
the caller, one delimiter holds throughout, and what does not fit is refused with the file, the line
and what to type instead.
"""

from __future__ import annotations

import os
from collections.abc import Sequence
from importlib import resources
from pathlib import Path
from typing import Any

from bridgectl import _checks as check
from bridgectl._warn import warn
from bridgectl.road.files import lines, tracks
from bridgectl.road.files.crg import MARK, read_crg
from bridgectl.road.files.delimited import read_delimited
from bridgectl.road.files.dialect import COMMA, POINT
from bridgectl.road.files.erd import SIGNATURE, read_erd
from bridgectl.road.files.lines import DELIMITERS
from bridgectl.road.files.missing import known_missing
from bridgectl.road.files.packed import SUFFIX, unpacked, unpacked_copy
from bridgectl.road.profile import RoadProfile

__all__ = ["read_profile", "read_tracks", "utia_road"]

HEAD = 2**16  # bytes in which a file shows its format


def read_profile(
    path: str | os.PathLike[str], *, units: str | Sequence[str] | None = None,
    columns: Sequence[int] | None = None, delimiter: str | None = None, step: float | None = None,
    decimal: str | None = None, missing: float | str | Sequence[float | str] | None = None,
    skip_lines: int | None = None, track: str | int | None = None, name: str | None = None,
) -> RoadProfile:  # fmt: skip
    r"""Return one road profile of a file: delimited text, ERD text or OpenCRG.

    The content tells the format, whatever the name of the file, which gzip may have packed. In
    delimited text, numbers are separated by commas, semicolons, tabs or white space, with a decimal
    point, or a decimal comma where the first lines leave no doubt of it. Blank lines and lines
    that begin with ``#``, ``%`` or ``//`` are skipped, and one line may name the columns before the
    first numbers; a line ``sep=;`` before all others, as spreadsheets write it, is understood.
    Stations may be chainages, ``12+345.6`` for 12345.6 m or ``12+34.5`` for 1234.5 ft. Elevations
    are positive up; stations increase. OpenCRG files need the package that
    ``pip install "bridgectl[crg]"`` brings; their stations are the u along the reference line.

    Parameters
    ----------
    path : str or path-like
        The file. Text is UTF-8, or what a byte order mark says, as UTF-16; words, but no numbers,
        may hold letters of Latin-1.
    units : str or sequence of str, optional
        Station and elevation unit, ``"m,mm"`` or ``("m", "mm")``, out of m, mm, cm, km, ft, in and
        mil; the elevation unit alone, ``"mm"``, with `step`. May be omitted when the file states
        them: in delimited text the line that names the columns, or the last comment before the
        numbers, as ``x [m], z [mm]``, ``x (m); z (mm)`` or ``x_m,z_mm``. Units that the file states
        otherwise are refused.
    columns : sequence of int, optional
        The columns of the stations and of one or more elevations, counted from 0; only elevations
        with `step`. If omitted, the first holds the stations, and the elevations are in every other
        one that the file states a unit of length for, or else in the second.
    delimiter : {",", ";", "\t", " "}, optional
        What separates the columns, a blank for any white space. Found from the first line of
        numbers if omitted.
    step : float, optional
        Distance [m] between the lines of delimited text without stations, which then start at 0.
    decimal : {".", ","}, optional
        The decimal mark of delimited text. Found from the first lines if omitted, unless they can
        be read in two ways: ``1,25`` between commas, or ``1,234`` alone.
    missing : float, str or sequence of them, optional
        Numbers in the unit of the column, as -999, and words, as "nan", or "" for nothing, that
        stand for missing readings in the elevations of delimited text or ERD. These readings are
        left out of their track. If omitted, -999, 9999, -32768 and the like are refused where the
        neighbours are unlike them; ``()`` takes all numbers as elevations.
    skip_lines : int, optional
        How many lines at the top of delimited text say nothing of the road, whatever they hold.
        If omitted, lines above one that names columns and their units are passed over.
    track : str or int, optional
        Which elevations of a file of several, by their label (in any case) or counted from 0. The
        first if omitted; the name of the road then tells which that is. Labels are the names of
        columns without units, the LONGNAME or SHORTNAM of ERD channels, and the lateral position
        of OpenCRG, like ``v=-1.5``.
    name : str, optional
        Name of the road; if omitted the file name without its suffix, and the track's label if
        there are several.

    Returns
    -------
    RoadProfile

    Raises
    ------
    ProfileFileError
        If the file cannot be read as a road profile, whatever is in it. The message is one line
        that says where, why and what to type.
    TypeError, ValueError
        If an argument is not what is described above.

    Warns
    -----
    UserWarning
        If missing readings were left out, with the widest gap, or lines at the top passed over.

    Examples
    --------
    >>> import pathlib, tempfile
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     path = pathlib.Path(folder, "lane.csv")
    ...     _ = path.write_text("x [m], left [mm], right [mm]\n0.0, 0, 1\n0.1, 2, 2\n0.2, 3, 2\n")
    ...     read_profile(path)
    RoadProfile('lane left', 3 points, x from 0 m to 0.2 m, elevation from 0 m to 0.003 m,
    step 0.1 m)

    A file of a spreadsheet in Europe, with a line of its own at the top, in which the third reading
    is missing; of which Python would warn, with the gap of 0.2 m, if it were not told to be silent:

    >>> import warnings
    >>> text = "Road;A1\nx [m];z [mm]\n0,0;0,5\n0,1;1,5\n0,2;-999\n0,3;1,0\n"
    >>> with tempfile.TemporaryDirectory() as folder, warnings.catch_warnings(action="ignore"):
    ...     path = pathlib.Path(folder, "lane.csv")
    ...     _ = path.write_text(text)
    ...     read_profile(path, decimal=",", missing=-999, skip_lines=1).x.tolist()
    [0.0, 0.1, 0.3]
    """
    file = check.path("path", path, "road.csv")
    request = _request(file, units, columns, delimiter, step, decimal, missing, skip_lines)
    if isinstance(track, bool) or not isinstance(track, str | int | None):
        raise TypeError(f"track must be a label or a whole number, got {track!r}: type track=0")
    stem = _stem(file, name)

    def pick(labels: Sequence[str]) -> list[tuple[int, str]]:
        i, full_name = tracks.track_names(stem, labels)[tracks.track_index(file, track, labels)]
        return [(i, full_name if name is None else name)]

    return _read(file, request, pick)[0]


def read_tracks(
    path: str | os.PathLike[str], *, units: str | Sequence[str] | None = None,
    columns: Sequence[int] | None = None, delimiter: str | None = None, step: float | None = None,
    decimal: str | None = None, missing: float | str | Sequence[float | str] | None = None,
    skip_lines: int | None = None, name: str | None = None,
) -> list[RoadProfile]:  # fmt: skip
    r"""Return all road profiles of a file: the left and right wheel track, for example.

    Parameters
    ----------
    path, units, columns, delimiter, step, decimal, missing, skip_lines
        See `read_profile`.
    name : str, optional
        What the names of the roads begin with; the file name without its suffix if omitted. The
        label of the track follows, or its number if it has none, unless there is only one.

    Returns
    -------
    list of RoadProfile
        In the order of the file.

    Raises
    ------
    ProfileFileError, TypeError, ValueError
        See `read_profile`.

    Warns
    -----
    UserWarning
        See `read_profile`; also if a track misses so many readings that it is left out.

    Examples
    --------
    >>> import pathlib, tempfile
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     path = pathlib.Path(folder, "lane.csv")
    ...     _ = path.write_text("x [m], left [mm], right [mm]\n0.0, 0, 1\n0.1, 2, 2\n0.2, 3, 2\n")
    ...     [road.name for road in read_tracks(path)]
    ['lane left', 'lane right']
    """
    file = check.path("path", path, "road.csv")
    request = _request(file, units, columns, delimiter, step, decimal, missing, skip_lines)
    stem = _stem(file, name)
    return _read(file, request, lambda labels: tracks.track_names(stem, labels))


def utia_road() -> RoadProfile:
    """Return a measured road: stations 478 m to 1022 m every 0.25 m, elevations near 583 m.

    It is profile_1.txt of github.com/michalsorel/iri, MIT License, Copyright (c) 2023 Michal Sorel,
    Filip Sroubek (notice beside the data file). It has a grade and an elevation above sea level,
    and stations of its own: `RoadProfile.place_bridge` puts a bridge on it.

    Returns
    -------
    RoadProfile

    Examples
    --------
    >>> from bridgectl import utia_road
    >>> utia_road().place_bridge(678).crop(-200, 25)
    RoadProfile('UTIA road', 901 points, x from -200 m to 25 m, elevation from 582.014 m to
    583.143 m, step 0.25 m)
    """
    data = resources.files("bridgectl.road") / "data" / "utia_profile_1.txt"
    with resources.as_file(data) as path:
        return read_profile(path, units="m,m", name="UTIA road")


def _read(file: str, request: tracks.Request, pick: tracks.Pick) -> list[RoadProfile]:
    """Read a file as what its content says it is, and warn the caller of what it says besides."""
    with lines.opened(file) as opened:
        handle = unpacked(file, opened)
        head = lines.read(file, handle, HEAD)
        handle.seek(0)
        if MARK.search(head):
            with unpacked_copy(file, handle, request.remarks) as copy:
                roads = read_crg(copy, request, pick)
        else:
            encoding = lines.encoding_of(head)
            texts = lines.text_lines(file, handle, encoding)
            is_erd = head.decode(encoding, "replace").startswith(SIGNATURE)
            roads = (read_erd if is_erd else read_delimited)(file, texts, request, pick)
    for remark in request.remarks:
        warn(remark)
    return roads


def _stem(file: str, name: str | None) -> str:
    if not isinstance(name, str | None):
        raise TypeError(f'name must be a string, got {name!r}: type for example name="A1 east"')
    return Path(file.removesuffix(SUFFIX)).stem if name is None else name


def _request(
    file: str, units: str | Sequence[str] | None, columns: Sequence[int] | None,
    delimiter: str | None, step: float | None, decimal: str | None, missing: Any,
    skip_lines: int | None,
) -> tracks.Request:  # fmt: skip
    """Return what the caller says of the file, once it makes sense."""
    if step is not None and tracks.odd_step(check.positive("step", step, unit="m")):
        raise ValueError(
            f"step must be {tracks.STEPS[0]:g} m to {tracks.STEPS[1]:g} m, got {step:g}"
        )
    if delimiter is not None:
        check.choice("delimiter", delimiter, tuple(DELIMITERS))
    if decimal is not None:
        check.choice("decimal", decimal, (POINT, COMMA))
    if decimal == delimiter == COMMA:
        raise ValueError('decimal and delimiter are both ",": type delimiter=";" or decimal="."')
    if skip_lines is not None:
        check.integer("skip_lines", skip_lines, at_least=0)
    wanted = None if columns is None else _checked_columns(columns, 2 if step is None else 1)
    return tracks.Request(
        tracks.known_units(file, units), wanted, delimiter, step, decimal, skip_lines,
        None if missing is None else known_missing(missing),
    )  # fmt: skip


def _checked_columns(columns: Sequence[int], at_least: int) -> tuple[int, ...]:
    given = columns if isinstance(columns, list | tuple) else ()
    numbers = tuple(check.integer("columns", column, at_least=0) for column in given)
    if len(numbers) < at_least or len({*numbers}) < len(numbers):
        words = "two or more different numbers like (0, 1)"
        if at_least == 1:
            words = "one or more different numbers like (0,)"
        raise ValueError(f"columns must be {words}, got {columns!r}")
    return numbers
