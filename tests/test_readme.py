import re
from pathlib import Path

README = Path(__file__).parents[1] / "README.md"


def test_the_python_of_the_readme_runs_from_top_to_bottom():
    blocks = re.findall(r"```python\n(.*?)```", README.read_text(encoding="utf-8"), re.DOTALL)
    assert len(blocks) >= 2
    names: dict = {}
    for block in blocks:
        exec(compile(block, "README.md", "exec"), names)
    assert names["estimate"].shape == (101,)
    assert names["middle"].input_labels == ["road", "damper_force"]


def test_the_setup_commands_are_one_line_each():
    text = README.read_text(encoding="utf-8")
    commands = [line for line in text.splitlines() if line.startswith("python3 -m venv")]
    assert len(commands) == 2
    assert "bridgectl score" in commands[0]
    assert commands[1].endswith(".venv/bin/pytest")


def test_the_picture_of_the_readme_is_there():
    picture = re.search(r"!\[.*?\]\((.*?)\)", README.read_text(encoding="utf-8")).group(1)
    assert (README.parent / picture).is_file()
