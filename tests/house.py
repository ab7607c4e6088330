"""Count circles, floors and arrows up between modules, from all imports: late and for types, too.

``python tests/house.py`` prints the counts, and fails if there is a circle or an arrow up. A floor
is a room on whose modules nothing below depends; the longest chain of modules is counted, too.
"""

from __future__ import annotations

import re
import sys
import tomllib
from functools import cache
from pathlib import Path

ROOT = Path(__file__).parents[1]


def layers() -> list[set[str]]:
    """Return the rooms from the top, floor by floor, as pyproject.toml has them.

    The command line sees the package from outside; the face of the package lies below it.
    """
    settings = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))
    contract = settings["tool"]["importlinter"]["contracts"][0]
    rooms = [set(re.split(r"\s*[|:]\s*", layer)) for layer in contract["layers"]]
    return [rooms[0] | {"__main__"}, {""}, *rooms[1:]]


def imports() -> dict[str, set[str]]:
    """Return what each module imports of the package."""
    import grimp  # of import-linter, which plain tests do not need

    graph = grimp.build_graph("bridgectl", exclude_type_checking_imports=False)
    return {name: set(graph.find_modules_directly_imported_by(name)) for name in graph.modules}


def circles(graph: dict[str, set[str]]) -> list[set[str]]:
    """Return sets of modules that lead to each other."""

    @cache
    def reached(start: str) -> frozenset[str]:
        found, todo = set(), [start]
        while todo:
            for name in graph[todo.pop()] - found:
                found.add(name)
                todo.append(name)
        return frozenset(found)

    found = {
        frozenset(other for other in reached(name) if name in reached(other))
        for name in graph
        if name in reached(name)
    }
    return [set(circle) for circle in found]


def main() -> int:
    graph, floors = imports(), layers()
    level = {room: i for i, floor in enumerate(reversed(floors)) for room in floor}

    def height(module: str) -> int:
        return level[module.removeprefix("bridgectl").removeprefix(".").split(".")[0]]

    up = [(a, b) for a in graph for b in graph[a] if height(b) > height(a)]
    found = circles(graph)
    for circle in found:
        print("circle:", *sorted(circle))
    for a, b in up:
        print("up:", a, "imports", b)
    print(f"{len(graph)} modules, {len(found)} circles, {len(floors)} floors, {len(up)} arrows up")
    return 1 if found or up else 0


if __name__ == "__main__":
    sys.exit(main())
