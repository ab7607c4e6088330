"""What is loaded before anything is done: help, mistakes and the import are quick."""

import json
import subprocess
import sys

import pytest

import bridgectl as bc
from bridgectl.cli.commands.shared import VEHICLE
from bridgectl.cli.main import COMMANDS, MAIN_HELP, main
from bridgectl.fleet.tails import METHODS
from bridgectl.model.recovery import RECOVERIES

HEAVY = "casadi", "control", "joblib", "matplotlib", "numpy", "pandas", "rich", "scipy"
"""Libraries that take time to load."""


def loaded(code):
    """Which heavy libraries are loaded by some code, in a process of its own."""
    told = f"{code}\nimport json, sys\nprint('\\n' + json.dumps([*sys.modules]), file=sys.stderr)"
    done = subprocess.run([sys.executable, "-c", told], capture_output=True, text=True, check=True)
    names = json.loads(done.stderr.splitlines()[-1])
    return [name for name in HEAVY if name in names]


def calls(*commands):
    """Code that calls the command line, in which help leaves by an exception."""
    return f"""
from bridgectl.__main__ import main
import sys
for arguments in {commands}:
    sys.argv[1:] = arguments
    try:
        main()
    except SystemExit:
        pass
"""


def test_import_help_of_every_command_and_mistakes_load_no_library():
    helps = [[name, "--help"] for name in COMMANDS]
    mistakes = [["skore"], ["score", "--sped", "80"], ["dae", "--modes", "three"], []]
    assert loaded(calls(["--help"], ["--version"], *helps, *mistakes)) == []


@pytest.mark.slow
def test_the_first_daf_loads_neither_dampers_nor_tables():
    daf = "import bridgectl as bc; bc.daf(bc.li2006.beam(), bc.li2006.car(), [25.0])"
    found = {*loaded(daf)}
    assert {"numpy", "control"} <= found  # which may bring matplotlib
    assert not {"casadi", "joblib", "pandas", "rich"} & found


def test_the_overview_names_every_command():
    assert all(f"  bridgectl {name} " in MAIN_HELP for name in COMMANDS)


@pytest.mark.parametrize("name", VEHICLE)
def test_help_tells_the_parameters_of_the_papers_truck(name):
    assert VEHICLE[name].endswith(f" (default {getattr(bc.li2006.car(), name):g})")


def test_help_tells_the_words_of_the_library(capsys):
    with pytest.raises(SystemExit):
        main(["assess", "--help"])
    told = " ".join(capsys.readouterr().out.split())
    assert f"of the moment from the modes: {', '.join(RECOVERIES)} (default" in told
    assert f"HOW {' or '.join(METHODS)} (default {METHODS[1]})" in told
