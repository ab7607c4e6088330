"""One Ctrl-C, which goes to all processes of a terminal, ends the one that starts the others."""

from __future__ import annotations

import os
import signal
import sys
import threading
from collections.abc import Iterator
from contextlib import contextmanager

MANAGER = "ExecutorManagerThread"
"""Name of joblib's thread that manages workers."""


@contextmanager
def leaving_at_ctrl_c() -> Iterator[None]:
    """Leave quietly at a Ctrl-C, with status 130, where libraries load.

    Nothing is lost yet, and an exception might end in a library's own import.
    """
    heard = (
        threading.current_thread() is threading.main_thread()
        and signal.getsignal(signal.SIGINT) is signal.default_int_handler  # not so under nohup
    )
    if heard:
        signal.signal(signal.SIGINT, lambda *_: os._exit(130))
    try:
        yield
    finally:
        if heard:
            signal.signal(signal.SIGINT, signal.default_int_handler)


def hear_no_manager() -> None:
    """Do not print what joblib's thread that manages the workers fails with as Ctrl-C ends them.

    Where it fails for another reason, the work that is lost raises an error of its own.
    """
    usual = threading.excepthook
    if getattr(usual, "hears_no_manager", False):
        return

    def hook(args: threading.ExceptHookArgs) -> None:
        if args.thread is None or args.thread.name != MANAGER:
            usual(args)

    hook.hears_no_manager = True  # type: ignore[attr-defined]
    threading.excepthook = hook


@contextmanager
def deaf_to_ctrl_c() -> Iterator[None]:
    """Start processes that Ctrl-C does not reach; here it is felt when all have started.

    It goes to all processes of a terminal. Workers would each tell of it, and those that are not
    yet known to the process that starts them would be left; as it is, that one ends them.
    """
    if sys.platform == "win32" or threading.current_thread() is not threading.main_thread():
        yield
        return
    from multiprocessing import resource_tracker

    from joblib.externals.loky.backend import resource_tracker as loky_tracker

    for tracker in (resource_tracker, loky_tracker):  # when they start, they unblock the signal
        tracker.ensure_running()
    heard: list[int] = []
    # Processes inherit what is blocked; of this one, other threads may still take the signal.
    handler = signal.signal(signal.SIGINT, lambda number, _: heard.append(number))
    blocked = signal.pthread_sigmask(signal.SIG_BLOCK, [signal.SIGINT])
    try:
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, blocked)
        signal.signal(signal.SIGINT, handler)
        for number in heard[:1]:
            signal.raise_signal(number)
