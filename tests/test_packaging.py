"""What is told of the package in several places agrees, and what CONTRIBUTING names is there."""

import re
import tomllib
from pathlib import Path

import pytest

import bridgectl as bc

ROOT = Path(__file__).parents[1]
PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
RECIPE = (ROOT / ".ci" / "conda" / "meta.yaml").read_text(encoding="utf-8")
CONTRIBUTING = (ROOT / "CONTRIBUTING.md").read_text(encoding="utf-8")

ON_CONDA_FORGE = {"matplotlib": "matplotlib-base"}
"""Names that differ there: without the windows that figures in files do not need."""


def listed(key):
    """The items of a list in the recipe."""
    (items,) = re.findall(rf"^ +{key}:\n((?: +- .*\n)+)", RECIPE, re.MULTILINE)
    return re.findall(r"- (.*)", items)


def test_the_recipe_depends_on_what_the_package_does():
    wanted = []
    for requirement in PROJECT["dependencies"]:
        name, lowest = requirement.split(">=")
        wanted.append(f"{ON_CONDA_FORGE.get(name, name)} >={lowest}")
    assert listed("run") == ["python >={{ python_min }}", *wanted]
    assert f'python_min = "{PROJECT["requires-python"].removeprefix(">=")}"' in RECIPE


def test_the_recipe_is_of_this_version_command_and_licence():
    assert f'version = "{bc.__version__}"' in RECIPE
    assert listed("entry_points") == [f"bridgectl = {PROJECT['scripts']['bridgectl']}"]
    assert f"summary: {PROJECT['description']}\n  license: {PROJECT['license']}\n" in RECIPE
    assert listed("license_file") == PROJECT["license-files"]


@pytest.mark.parametrize(
    "path",
    sorted({*re.findall(r"`((?:\.ci|bridgectl|notebooks|tests)/[a-z0-9_./]+)`", CONTRIBUTING)}),
)
def test_contributing_names_what_is_there(path):
    assert (ROOT / path).exists()


def test_contributing_has_every_room_on_one_page():
    table = CONTRIBUTING.split("| what belongs there |")[1].split("\n\n")[0]
    told = {name.strip("/").removesuffix(".py") for name in re.findall(r"`([\w./]+)`", table)}
    rooms = {path.stem for path in (ROOT / "bridgectl").glob("[a-z]*") if path.name != "py.typed"}
    assert rooms - {"__init__", "__main__"} <= told
    assert len(CONTRIBUTING.splitlines()) <= 80
