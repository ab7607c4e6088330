import ast
import contextlib
import io
import re
import shlex
from pathlib import Path

import numpy as np
import pytest

import bridgectl as bc
from bridgectl.cli.main import main

README = Path(__file__).parents[1] / "README.md"


def test_the_python_of_the_readme_runs_and_prints_what_it_says():
    found = re.findall(
        r"```python\n(.*?)```(?:\n\n```text\n(.*?)```)?",
        README.read_text(encoding="utf-8"),
        re.DOTALL,
    )
    assert len(found) >= 2
    assert any(printed for _, printed in found)
    names: dict = {}
    for block, expected in found:
        with contextlib.redirect_stdout(io.StringIO()) as printed:
            exec(compile(block, "README.md", "exec"), names)
        assert printed.getvalue() == expected
    assert names["board"].rows()[0].strategy == "bridgehook"


def test_the_setup_commands_are_one_line_each():
    text = README.read_text(encoding="utf-8")
    commands = [line for line in text.splitlines() if line.startswith("python3 -m venv")]
    assert len(commands) == 2
    assert "bridgectl score" in commands[0]
    assert commands[1].endswith(".venv/bin/pytest")


def commands():
    """What the README lets a user type, in words: the main job, and those for own files."""
    text = README.read_text(encoding="utf-8")
    block = re.search(r"```sh\n(bridgectl .*?)```", text, re.DOTALL)
    first = re.search(r"\.venv/bin/(bridgectl .*)", text)
    assert block is not None
    assert first is not None
    return [shlex.split(line) for line in [first[1], *block[1].splitlines()]]


@pytest.mark.slow
@pytest.mark.parametrize("words", commands(), ids=lambda words: words[1])
def test_each_command_of_the_readme_runs(words, tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    for seed, name in enumerate(("east.csv", "west.csv", "road.csv")):
        road = bc.iso8608_profile("A", 1400, seed=seed)
        np.savetxt(name, np.column_stack([road.x, 1e3 * road.elevation]), delimiter=",")
    bc.write_profile("survey.erd", road)
    assert words[0] == "bridgectl"
    assert main(words[1:]) == 0
    assert capsys.readouterr().out
    if "--plot" in words:
        assert Path(words[words.index("--plot") + 1]).stat().st_size > 10_000


def test_the_readme_takes_two_minutes():
    assert len(README.read_text(encoding="utf-8").splitlines()) <= 150


def test_each_number_is_shown_by_a_test_or_a_command_that_is_there():
    tests = README.parent / "tests"
    lines = (tests / "README.md").read_text(encoding="utf-8").splitlines()
    rows = [line for line in lines if line.endswith(" |") and line[0] == "|"]
    shown = re.findall(r"`(test_\w+\.py)`", "\n".join(rows))
    run = re.findall(r"`python tests/(benchmarks/\w+\.py)", "\n".join(lines))
    assert len(shown) > 20
    assert len(run) > 5
    assert [name for name in (*shown, *run) if not (tests / name).is_file()] == []


CLAIM = re.compile(
    r"\b(?:within|by|to) (?:up to |at most |less than |more than )?(?:0\.0\d|[1-9]e-\d+\b(?! m\b))"
    r"|\d (?:random )?(?:roads|samples) of|of \d+ roads|\d us\b"
    r"| % (?:lower|higher)|\d times (?:as|faster)|\brms errors?\b.*\d"
)
"""How numbers that were measured are told: differences of DAFs, over roads, faster, lower."""


def claimed(module):
    """What a module's docstrings claim, without their examples and what they raise."""
    for node in ast.walk(ast.parse(module.read_text(encoding="utf-8"))):
        if isinstance(node, ast.Expr) and isinstance(node.value, ast.Constant):
            told, *_ = str(node.value.value).partition("Examples\n")
            yield from CLAIM.findall(" ".join(re.sub(r"Raises\n.*?\n\n", "", told).split()))


def test_modules_whose_docstrings_claim_numbers_are_told_with_what_shows_them():
    package = README.parent / "bridgectl"
    modules = {
        ".".join(path.relative_to(package).with_suffix("").parts): path
        for path in package.rglob("*.py")
    }
    text = (README.parent / "tests" / "README.md").read_text(encoding="utf-8")
    part = text.partition("## Claims in docstrings")[2].partition("\n## ")[0]
    rows = [line.split(" | ") for line in part.splitlines() if line.startswith("| ")][2:]
    told = {name for row in rows for name in re.findall(r"`([\w.]+)`", row[1])}
    claims = {name for name, path in modules.items() if any(claimed(path))}
    assert len(claims) > 10
    assert claims - told == set()
    assert told - set(modules) == {"cli.commands"}  # a package


def test_what_the_readme_shows_and_links_to_is_there():
    links = re.findall(r"\]\((?!https?:)(.*?)\)", README.read_text(encoding="utf-8"))
    assert len(links) > 8
    for link in links:
        assert (README.parent / link).exists(), link
