import contextlib
import io
import re
from pathlib import Path

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
    assert names["estimate"].shape == (101,)
    assert names["middle"].input_labels == ["road", "damper_force"]


def test_the_setup_commands_are_one_line_each():
    text = README.read_text(encoding="utf-8")
    commands = [line for line in text.splitlines() if line.startswith("python3 -m venv")]
    assert len(commands) == 2
    assert "bridgectl score" in commands[0]
    assert commands[1].endswith(".venv/bin/pytest")


def test_what_the_readme_shows_and_links_to_is_there():
    links = re.findall(r"\]\((?!https?:)(.*?)\)", README.read_text(encoding="utf-8"))
    assert len(links) > 8
    for link in links:
        assert (README.parent / link).is_file(), link
