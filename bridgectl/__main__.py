"""Run the command line: ``bridgectl`` or ``python -m bridgectl``."""

from __future__ import annotations

import os
import signal


def main() -> int:
    """Run a command: 130 after Ctrl-C, at which it leaves quietly, even while libraries load."""
    heard = signal.getsignal(signal.SIGINT) is signal.default_int_handler  # not so under nohup
    if heard:  # nothing is lost yet, and an exception might end in a library's own import
        signal.signal(signal.SIGINT, lambda *_: os._exit(130))
    from bridgectl.cli.main import main as run

    if heard:
        signal.signal(signal.SIGINT, signal.default_int_handler)
    try:
        return run()
    except KeyboardInterrupt:  # a second one
        return 130
    finally:
        if heard:  # all that is left is to leave
            signal.signal(signal.SIGINT, signal.SIG_IGN)


if __name__ == "__main__":
    raise SystemExit(main())
