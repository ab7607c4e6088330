"""Scripts by which a shell completes commands, options, files and names: `shtab` makes them.

They hold what there is when they are made, and complete without starting the program.
"""

from __future__ import annotations

import argparse
import shlex
from collections.abc import Iterable, Iterator

import shtab

import bridgectl as bc
from bridgectl.cli.effects import ALIASES, EFFECTS
from bridgectl.cli.score import CONSTANT, PASSIVE, ROLLOUT
from bridgectl.cli.tune import PROGRAM, tunable
from bridgectl.dampers import library
from bridgectl.fleet.kinds import shipped
from bridgectl.fleet.tails import METHODS
from bridgectl.model.recovery import RECOVERIES
from bridgectl.model.supports import KINDS as SUPPORTS
from bridgectl.road.psd import CLASSES
from bridgectl.scoring.errors import KINDS as ERRORS
from bridgectl.scoring.tuning import CLASS_DAE, DAF, GENERATIONS, GRADIENT

FILES = "file", "roads", "truck", "bridge", "fleet", "weighed", "plot", "resume", "table"
"""What may be a file."""

BASH = """\
{name}() {{  # names, also after commas
  local word typed="${{1##*,}}"
  for word in {words}; do
    word=$(printf %q "$word")
    [[ $word == "$typed"* ]] && echo "${{1%"$typed"}}$word"
  done
  {files}
}}
"""


def completion_script(parser: argparse.ArgumentParser, shell: str) -> str:
    """Return the script of a shell for the parser of all options, which gets hints for it."""
    names = _names()
    for command, action in _actions(parser):
        option = action.option_strings[0] if action.option_strings else action.dest
        words = names.get(f"{command} {option}", names.get(option, ()))
        if words or action.dest in FILES:
            hint = _hint(f"{command}_{action.dest}", words, action.dest in FILES)
            action.complete = hint  # type: ignore[attr-defined]
    return shtab.complete(parser, shell)


def _actions(parser: argparse.ArgumentParser) -> Iterator[tuple[str, argparse.Action]]:
    """Yield what each command takes, whose description becomes the brief one."""
    for commands in parser._actions:
        if isinstance(commands, argparse._SubParsersAction):
            for brief in commands._get_subactions():
                command = commands.choices[brief.dest]
                command.description = brief.help
                yield from ((brief.dest, each) for each in command._actions)


def _names() -> dict[str, Iterable[str]]:
    """Return the names that an option knows, of all commands or of one."""
    strategies = library(bc.li2006.beam(), bc.li2006.car(), 1e3, 30e3)[1:]
    named = [each.name for each in strategies]
    trucks = list(bc.trucks.catalog())
    return {
        "truck": trucks, "--truck": trucks, "--fleet": shipped(), "--weighed": ["example"],
        "--bridge": ["example"], "--deck": list(bc.li2006.DECKS), "--supports": SUPPORTS,
        "--recovery": RECOVERIES, "--effect": [*EFFECTS, *ALIASES], "--class": CLASSES,
        "--classes": CLASSES, "--strategies": [PASSIVE, *named, CONSTANT, ROLLOUT, "preview 10 m"],
        "--strategy": [*(each.name for each in tunable(strategies)), PROGRAM], "--damper": named,
        "--errors": ERRORS, "--objective": [DAF, CLASS_DAE], "assess --method": METHODS,
        "tune --method": [GENERATIONS, GRADIENT], "--scheduler": ["local"],
    }  # fmt: skip


def _hint(name: str, words: Iterable[str], files: bool) -> dict[str, str | dict[str, str]]:
    """Return how each shell completes words, and files if it may be one."""
    quoted, name = shlex.join(words), f"_{'file' if files else 'name'}_of_bridgectl_{name}"
    bash = BASH.format(name=name, words=quoted, files='compgen -f -- "$1"' if files else "")
    return {
        "bash": name,
        "zsh": f"{{compadd -- {quoted}; {'_files' if files else ''}}}",
        "fish": f"{quoted} {'(__fish_complete_path (commandline -ct))' if files else ''}".strip(),
        "preamble": {"bash": bash},
    }
