"""The notebooks run, print what they store, and can be read without running them.

`notebooks/build.py` runs them, in a process of its own: what the kernel's machinery warns of
stays there, and a warning of the notebook makes it fail.
"""

from __future__ import annotations

import importlib.util
import re
import subprocess
import sys
from pathlib import Path

import nbformat
import pytest

FOLDER = Path(__file__).parents[1] / "notebooks"
NOTEBOOKS = sorted(FOLDER.glob("*.ipynb"))
NUMBER = re.compile(r"[-+]?\d+(?:\.\d+)?(?:e[-+]?\d+)?")

each_notebook = pytest.mark.parametrize("path", NOTEBOOKS, ids=lambda path: path.stem)


@pytest.fixture(scope="module")
def build():
    spec = importlib.util.spec_from_file_location("notebooks_build", FOLDER / "build.py")
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def read(path: Path) -> nbformat.NotebookNode:
    return nbformat.read(path, as_version=4)


def unit(number: str) -> float:
    """One unit of the last digit of a printed number; none of a whole number.

    Whole thousands are counts of which some lie at a limit: 0.2 %.
    """
    mantissa, _, exponent = number.partition("e")
    if mantissa == number and "." not in number:
        return 2e-3 * abs(float(number)) if abs(float(number)) >= 1000 else 0.0
    return 10.0 ** (int(exponent or 0) - len(mantissa.partition(".")[2]))


def differences(stored: str, printed: str) -> list[str]:
    """Lines that differ by more than one unit in the last digit of a number, or in words."""
    old, new = stored.strip().splitlines(), printed.strip().splitlines()
    if len(old) != len(new):
        return [f"{len(old)} lines stored, {len(new)} printed"]
    return [f"{a!r} is now {b!r}" for a, b in zip(old, new, strict=True) if not same(a, b)]


def same(stored: str, printed: str) -> bool:
    # Spaces fill up columns, so that they go with the numbers.
    words = [NUMBER.sub("#", line).replace(" ", "") for line in (stored, printed)]
    numbers = zip(NUMBER.findall(stored), NUMBER.findall(printed), strict=False)
    return words[0] == words[1] and all(
        abs(float(a) - float(b)) <= 1.001 * max(unit(a), unit(b)) for a, b in numbers
    )


def test_printed_numbers_may_differ_in_their_last_digit_only():
    assert same("DAF  1.1302 at 110 km/h", "DAF 1.1303 at 110 km/h")
    assert same("off by -0.0000", "off by +0.0000")
    assert same("error 3e-06", "error 2e-06")
    assert not same("DAF 1.1302", "DAF 1.1304")
    assert not same("103 km/h", "104 km/h")
    assert not same("1.1 m", "1.1 mm")
    assert differences("1.0\n2.0\n", "1.0\n2.3\n") == ["'2.0' is now '2.3'"]
    assert differences("1.0\n", "1.0\n2.0\n") == ["1 lines stored, 2 printed"]


def test_the_notebooks_are_numbered_in_reading_order_and_each_leads_to_the_next():
    assert [path.name[:3] for path in NOTEBOOKS] == [f"{i + 1:02d}_" for i in range(len(NOTEBOOKS))]
    names = [path.name for path in NOTEBOOKS]
    for i, path in enumerate(NOTEBOOKS):
        words = [cell.source for cell in read(path).cells if cell.cell_type == "markdown"]
        links = re.findall(r"\]\(([^)]+\.ipynb)\)", "\n".join(words))
        assert set(links) <= set(names), path.name
        assert i + 1 == len(names) or names[i + 1] in links, path.name


@each_notebook
def test_a_notebook_is_stored_complete_and_clean(path, build):
    notebook = read(path)
    assert build.faults(notebook) == []
    assert path.stat().st_size <= build.LARGEST
    code = [cell for cell in notebook.cells if cell.cell_type == "code"]
    assert [cell.execution_count for cell in code] == list(range(1, len(code) + 1))
    assert any("image/png" in output.get("data", {}) for cell in code for output in cell.outputs)


@each_notebook
def test_a_notebook_ends_with_checks_of_its_claims(path):
    last = [cell for cell in read(path).cells if cell.cell_type == "code"][-1]
    assert "assert " in last.source
    assert last.outputs


@pytest.mark.slow
@each_notebook
def test_a_notebook_runs_and_prints_what_it_stores(path, build, tmp_path):
    command = [sys.executable, FOLDER / "build.py", "--to", tmp_path, path.stem]
    run = subprocess.run(command, capture_output=True, text=True, timeout=600, check=False)
    assert run.returncode == 0, run.stderr
    stale = []
    for stored, fresh in zip(read(path).cells, read(tmp_path / path.name).cells, strict=True):
        stale += differences("\n".join(build.texts(stored)), "\n".join(build.texts(fresh)))
    assert stale == [], f"run notebooks/build.py {path.stem}"


@pytest.mark.slow
@pytest.mark.parametrize(
    ("source", "why"),
    [
        ("import warnings; warnings.warn('odd')", "UserWarning: odd"),
        ("import sys; print('odd', file=sys.stderr)", "odd"),
        ("object()", "belongs to one machine"),
        ("assert 1 + 1 == 3, 'a claim'", "AssertionError: a claim"),
    ],
)
def test_a_notebook_that_warns_or_fails_is_not_stored(source, why, tmp_path):
    cell = nbformat.v4.new_code_cell(source, id="one")
    path = tmp_path / "01_odd.ipynb"
    nbformat.write(nbformat.v4.new_notebook(cells=[cell]), path)
    before = path.read_text(encoding="utf-8")
    program = (FOLDER / "build.py").read_text(encoding="utf-8")
    (tmp_path / "build.py").write_text(program, encoding="utf-8")
    command = [sys.executable, tmp_path / "build.py"]
    run = subprocess.run(command, capture_output=True, text=True, timeout=120, check=False)
    assert run.returncode == 1
    assert why in run.stderr
    assert path.read_text(encoding="utf-8") == before
