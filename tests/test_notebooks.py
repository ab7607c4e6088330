"""The notebooks run, print what they store, and can be read without running them.

`notebooks/build.py` runs them, in a process of its own: what the kernel's machinery warns of
stays there, and a warning of the notebook makes it fail.
"""

from __future__ import annotations

import re
import subprocess
import sys
from pathlib import Path

import nbformat
import pytest
from helpers import module_of

FOLDER = Path(__file__).parents[1] / "notebooks"
NOTEBOOKS = sorted(FOLDER.glob("*.ipynb"))

each_notebook = pytest.mark.parametrize("path", NOTEBOOKS, ids=lambda path: path.stem)


@pytest.fixture(scope="module")
def build():
    return module_of(FOLDER / "build.py")


def read(path: Path) -> nbformat.NotebookNode:
    return nbformat.read(path, as_version=4)


def test_printed_numbers_may_differ_in_their_last_digit_only(build):
    same, differences = build.same, build.differences
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
def test_a_notebook_ends_with_a_check_of_its_claims_in_one_line(path):
    last = [cell for cell in read(path).cells if cell.cell_type == "code"][-1]
    assert last.source == "page.check(globals())"
    assert [output.text for output in last.outputs] == ["All claims of this page checked.\n"]


@each_notebook
def test_a_notebook_draws_by_what_it_imports(path):
    code = [cell.source for cell in read(path).cells if cell.cell_type == "code"]
    assert re.search(r"^from pages import \w+ as page$", "\n".join(code), re.MULTILINE)
    assert not [cell for cell in code if re.search(r"\bpyplot\b|\.set_xlabel|\.legend\(", cell)]


@each_notebook
def test_a_notebook_has_three_exercises_with_answers_folded_away(path, build):
    answers = build.answers(read(path))
    assert len(answers) == 3
    assert all(code and printed for code, printed in answers)


@pytest.mark.slow
@each_notebook
def test_a_notebook_runs_and_prints_what_it_stores(path, build, tmp_path):
    command = [sys.executable, FOLDER / "build.py", "--to", tmp_path, path.stem]
    run = subprocess.run(command, capture_output=True, text=True, timeout=600, check=False)
    assert run.returncode == 0, run.stderr
    stale = []
    for stored, fresh in zip(read(path).cells, read(tmp_path / path.name).cells, strict=True):
        stale += build.differences("\n".join(build.texts(stored)), "\n".join(build.texts(fresh)))
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


ANSWER = """<details><summary>Answer</summary>

```python
print(3 * x)
```

```text
{}
```
</details>"""


@pytest.mark.slow
def test_an_answer_that_prints_something_else_is_refused(tmp_path, build):
    path = tmp_path / "01_odd.ipynb"

    def store(said: str) -> Path:
        cells = [
            nbformat.v4.new_code_cell("x = 2", id="one"),
            nbformat.v4.new_markdown_cell(ANSWER.format(said), id="two"),
        ]
        nbformat.write(nbformat.v4.new_notebook(cells=cells), path)
        return path

    assert len(read(build.build(store("6"))).cells) == 2
    with pytest.raises(build.RefusedError, match=r"01_odd\.ipynb: an answer's '7' is now '6'"):
        build.build(store("7"))
