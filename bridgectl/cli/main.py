"""The command line: parse, call, tell of mistakes.

Each command has a module `commands.NAME`, of what it takes, and a module `NAME`, which does it and
brings the libraries: that one is loaded when the options are understood, so that help is quick.
"""

from __future__ import annotations

import argparse
import os
import sys
import warnings
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager, redirect_stdout
from importlib import import_module
from typing import Any, NoReturn

from bridgectl._ctrl_c import leaving_at_ctrl_c
from bridgectl._version import __version__
from bridgectl.cli.commands.shared import add_output_options, as_options

OUTPUT = "standard output"

MAIN_HELP = """\
What a road does to a bridge, and what dampers can do about it: dynamic amplification of a vehicle's
crossing.

  bridgectl score     damper strategies, scored for a bridge: amplification, road wear, ride
  bridgectl tune      gains of a damper strategy, tuned for a bridge and judged on other roads
  bridgectl dae       the dynamic amplification estimate (DAE) of a measured road
  bridgectl assess    what random traffic does to a bridge: amplification, characteristic effects
  bridgectl profile   roughness (IRI), spectrum and ISO 8608 class of a road file
  bridgectl trucks    the catalog of trucks: axle loads, distances, natural frequencies
  bridgectl paper     every number of Li, OBrien and Gonzalez (2006) beside the computed one
  bridgectl validate  its Section 4 again: DAE against DAF on eight good roads and three spans;
                      with --dampers whether DAE orders dampers

Without a road file, score, dae and profile take a measured road that comes with the program."""

COMMANDS = {
    "score": "damper strategies, scored for a bridge",
    "tune": "gains of a damper strategy, tuned for a bridge",
    "assess": "what random traffic does to a bridge",
    "dae": "DAE and DAF of a measured road",
    "profile": "IRI, spectrum and ISO class of a road file",
    "trucks": "the catalog of trucks",
    "paper": "the paper's numbers",
    "validate": "DAE against DAF on good roads",
}
"""What each is, in brief."""


class _Parser(argparse.ArgumentParser):
    """A parser whose complaint is one line."""

    def error(self, message: str) -> NoReturn:
        raise ValueError(f"{message} (see {self.prog} --help)")


def main(argv: Sequence[str] | None = None) -> int:
    """Run a command, of this process by default; 2 after a mistake, which is told in one line."""
    try:
        with warnings.catch_warnings(), redirect_stdout(_Output()):
            warnings.simplefilter("always", UserWarning)
            warnings.showwarning = _show_each_once()
            try:
                args = _parser(sys.argv[1:] if argv is None else argv).parse_args(argv)
                with leaving_at_ctrl_c():
                    module = import_module(f"bridgectl.cli.{args.command}")
                getattr(module, f"run_{args.command}")(args)
            finally:
                sys.stdout.flush()
    except BrokenPipeError:  # a reader such as `head` has seen enough
        _drop_output()
        return 0
    except KeyboardInterrupt:
        return 130
    except (ValueError, TypeError, NotImplementedError) as error:
        _tell("error", error)
        return 2
    except OSError as error:
        if error.filename == OUTPUT:
            _drop_output()
        _tell("error", error)
        return 2
    except MemoryError:  # the estimate let it through, and knows the cause
        from bridgectl._work import memory_advice

        _tell("error", memory_advice())
        return 2
    return 0


class _Output:
    """Standard output, with its name in errors of writing."""

    def __init__(self) -> None:
        self.stream = sys.stdout

    def __getattr__(self, name: str) -> Any:
        return getattr(self.stream, name)

    def write(self, text: str) -> int:
        """Write text."""
        with _named_output():
            return self.stream.write(text)

    def flush(self) -> None:
        """Write what waits."""
        with _named_output():
            self.stream.flush()


@contextmanager
def _named_output() -> Iterator[None]:
    try:
        yield
    except OSError as error:
        raise OSError(error.errno, error.strerror, OUTPUT) from None


def _drop_output() -> None:
    """Drop what is not written, which Python would complain of at its end."""
    os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())


def _tell(kind: str, message: object) -> None:
    line = "".join(c if c.isprintable() else " " for c in str(message))
    print(f"bridgectl: {kind}: {' '.join(line.split())}", file=sys.stderr)


def _show_each_once() -> Callable[..., None]:
    told: set[str] = set()

    def show(message: Warning | str, *_: Any, **__: Any) -> None:
        if str(message) not in told:
            told.add(str(message))
            _tell("warning", as_options(str(message)))

    return show


def _parser(argv: Sequence[str]) -> _Parser:
    """Return the parser of all commands, with the options of those that may be meant."""
    look = argparse.RawDescriptionHelpFormatter
    parser = _Parser(prog="bridgectl", description=MAIN_HELP, formatter_class=look)
    parser.add_argument("--version", action="version", version=f"bridgectl {__version__}")
    commands = parser.add_subparsers(required=True, dest="command", metavar="COMMAND")
    for name, brief in COMMANDS.items():
        made = commands.add_parser(name, help=brief, formatter_class=look)
        if name in argv:
            takes = import_module(f"bridgectl.cli.commands.{name}")
            made.description = takes.HELP
            takes.add_options(made)
            add_output_options(made)
    return parser
