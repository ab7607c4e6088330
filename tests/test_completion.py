"""Shells complete commands, options, files and names; bash is asked to."""

import shutil
import subprocess

import pytest

from bridgectl.cli.completion import completion_script
from bridgectl.cli.main import COMMANDS, SHELLS, _parser, main

ASK = """
source {script}
ask() {{
  COMP_WORDS=("$@"); COMP_CWORD=$(($# - 1)); _shtab_bridgectl 2>/dev/null
  local IFS=,; echo "${{COMPREPLY[*]}}"
}}
"""


@pytest.fixture(scope="module")
def scripts(tmp_path_factory):
    folder = tmp_path_factory.mktemp("scripts")
    for shell in SHELLS:
        script = completion_script(_parser(tuple(COMMANDS)), shell)
        (folder / shell).write_text(script, encoding="utf-8")
    return folder


@pytest.fixture(scope="module")
def completed(scripts, tmp_path_factory):
    """What bash makes of each line, where there are two files and a folder."""
    here = tmp_path_factory.mktemp("here")
    (here / "a road.csv").touch()
    (here / "T5mine.toml").touch()
    (here / "roads").mkdir()
    asked = "".join(f"ask bridgectl {line}\n" for line in LINES)
    script = ASK.format(script=scripts / "bash") + asked
    done = subprocess.run(["bash", "-c", script], cwd=here, capture_output=True, text=True)
    assert (done.returncode, done.stderr) == (0, "")
    return dict(zip(LINES, done.stdout.splitlines(), strict=True))


LINES = {
    "sc": "score", "validate --da": "--dampers", "score --str": "--strategies",
    "score --strategies sky": "skyhook", "score --strategies skyhook,sel":
    r"skyhook,selective\ groundhook", r"score --strategies 'continuous\ '": r"continuous\ skyhook",
    "tune --strategy pr": "program", "assess --method p": r"peaks\ over\ threshold",
    "tune --method g": "generations,gradient", "score --deck s": "solid,super-Y",
    "dae --truck T5": "T5,T5A01,T5air,T5tridem,T5mine.toml", "trucks T2": "T2,T2A01",
    "dae --bridge ex": "example", "profile 'a '": "a road.csv",
    "score --random 1 one.csv r": "roads", "score --resume r": "roads", "dae --span ''": "",
}  # fmt: skip


@pytest.mark.parametrize("line", LINES)
def test_bash_completes(completed, line):
    assert completed[line] == LINES[line]


def test_every_shell_knows_every_command_and_its_options(scripts):
    for shell in SHELLS:
        text = (scripts / shell).read_text(encoding="utf-8")
        for word in (*COMMANDS, "strategies", "no-detrend", "T5tridem", "groundhook"):
            assert word in text
        if program := shutil.which(shell):
            subprocess.run([program, "-n", scripts / shell], check=True)


def test_the_program_prints_the_script_and_refuses_other_shells(capsys, scripts):
    with pytest.raises(SystemExit, match="0"):
        main(["--print-completion", "bash"])
    assert capsys.readouterr().out == (scripts / "bash").read_text(encoding="utf-8") + "\n"
    assert main(["--print-completion", "cmd"]) == 2
    assert "invalid choice: 'cmd'" in capsys.readouterr().err
