"""Run the command line: ``bridgectl`` or ``python -m bridgectl``."""

from __future__ import annotations

import signal

from bridgectl._ctrl_c import leaving_at_ctrl_c


def main() -> int:
    """Run a command: 130 after Ctrl-C, at which it leaves quietly, even while libraries load."""
    heard = signal.getsignal(signal.SIGINT) is signal.default_int_handler  # not so under nohup
    with leaving_at_ctrl_c():
        from bridgectl.cli.main import main as run
    try:
        return run()
    except KeyboardInterrupt:  # a second one
        return 130
    finally:
        if heard:  # all that is left is to leave
            signal.signal(signal.SIGINT, signal.SIG_IGN)


if __name__ == "__main__":
    raise SystemExit(main())
