"""Small mistakes made in the core on purpose, one at a time: some test must notice each.

From the root of the repository, with the extra `dev` installed:

    python tests/mutation.py "bridgectl.linear.peaks*" "bridgectl.road.iri*"
    cd .mutation
    mutmut results
    mutmut show bridgectl.linear.peaks.x_margins__mutmut_19

`[tool.mutmut]` in pyproject.toml says which modules are changed and which tests look on. Begin
with a module or two: first of all every test runs once, which takes some minutes, and a
mutant that lives costs the time of all tests that call its function. Constants of modules are
not changed.

Judge those that live. What test modules make as they are imported was made without the
mistake: look again, in `.mutation/mutants`, with

    MUTANT_UNDER_TEST=bridgectl.linear.peaks.x_margins__mutmut_19 python -m pytest -n0 -x tests

Some are no mistakes: `<` for `<=` of real numbers, labels of an `einsum` in capitals, a
shortcut that is not taken, a word of a message, a bound of tuning moved by 1 in 1e6. The others
want a test that says in words what they break.
"""

from __future__ import annotations

import ast
import shutil
import subprocess
import sys
from pathlib import Path

PLACE = Path(".mutation")
"""Where a copy is changed, ignored by git."""


def without_decorators(source: str) -> str:
    """Move decorators of one name below their functions: mutmut leaves what is decorated alone.

    >>> print(without_decorators("@cache\\ndef one():\\n    return 1\\n"))
    def one():
        return 1
    one = cache(one)
    """
    lines = source.split("\n")
    functions = [node for node in ast.walk(ast.parse(source)) if isinstance(node, ast.FunctionDef)]
    for function in sorted(functions, key=lambda found: -found.lineno):
        match function.decorator_list:
            case [ast.Name("on_one_thread" | "property" | "cached_property" | "cache" as name)]:
                indent = " " * function.col_offset
                below = f"{indent}{function.name} = {name}({function.name})"
                lines.insert(function.end_lineno, below)
                del lines[function.lineno - 2]
    return "\n".join(lines)


def without_callers_lines(source: str) -> str:
    """Hide the tests that ask for the file of a caller: mutmut stands between it and the package.

    >>> print(without_callers_lines("def test_one():\\n    assert told[0].filename == __file__\\n"))
    def hidden_test_one():
        assert told[0].filename == __file__
    <BLANKLINE>
    """
    for node in ast.parse(source).body:
        about = isinstance(node, ast.FunctionDef) and ".filename" in ast.unparse(node)
        if about and node.name.startswith("test_"):
            source = source.replace(f"def {node.name}(", f"def hidden_{node.name}(")
    return source


def main(patterns: list[str]) -> int:
    """Copy what changed and run the mutants whose names match."""
    copied = shutil.ignore_patterns(".*", "__pycache__")
    shutil.copytree(".", PLACE, ignore=copied, dirs_exist_ok=True)
    changes = (("bridgectl", without_decorators), ("tests", without_callers_lines))
    for folder, change in changes:
        for path in (PLACE / folder).rglob("*.py"):
            path.write_text(change(path.read_text(encoding="utf-8")), encoding="utf-8")
    return subprocess.run(["mutmut", "run", *patterns], cwd=PLACE, check=False).returncode


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
