"""Ctrl-C, at any moment: status 130, at most one line, and no process is left."""

import os
import re
import signal
import subprocess
import sys
import threading
import time
from pathlib import Path

import pytest

import bridgectl.cli.main
from bridgectl import _ctrl_c
from bridgectl.__main__ import main

SCORE = [
    "score", "--random", "1", "--strategies", "skyhook,groundhook,hybrid,ADD", "--approach", "30",
    "--speeds", "60:120:5", "--workers", "2",
]  # fmt: skip
LINUX = pytest.mark.skipif(sys.platform != "linux", reason="looks at processes in /proc")


def group(leader):
    """Return command lines of the living processes of a group."""
    found = []
    for folder in Path("/proc").glob("[0-9]*"):
        try:
            state, _, of_group = (folder / "stat").read_text().rpartition(")")[2].split()[:3]
            if int(of_group) == leader and state != "Z":
                found.append((folder / "cmdline").read_bytes())
        except (FileNotFoundError, ProcessLookupError):  # it ended meanwhile
            pass
    return found


def libraries_load(process, _):
    return "numpy" in Path(f"/proc/{process.pid}/maps").read_text()


def workers_start(process, _):
    return any(b"LokyProcess" in line for line in group(process.pid))


def a_part_is_kept(_, kept):
    return kept.exists() and kept.read_bytes().count(b"\n") > 1


def assert_interrupted(tmp_path, moment, delay=0.0):
    """Interrupt a score, and all of its processes as a terminal does, some time after a moment."""
    kept = tmp_path / "score.jsonl"
    process = subprocess.Popen(
        [sys.executable, "-m", "bridgectl", *SCORE, "--resume", str(kept)],
        stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, start_new_session=True,
        preexec_fn=lambda: signal.signal(signal.SIGINT, signal.SIG_DFL),
    )  # fmt: skip
    try:
        while not moment(process, kept):
            assert process.poll() is None
            time.sleep(0.002)
        time.sleep(delay)
        if process.poll() is None:
            os.killpg(process.pid, signal.SIGINT)
        out, err = process.communicate(timeout=60)
        if process.returncode == 0:  # it was done before
            return
        assert process.returncode == 130
        assert out.startswith(("No strategy", "Lowest mean DAF")) or not out  # the verdict is early
        assert re.fullmatch(rf"(bridgectl: interrupted: {kept} keeps what is done, .*\n)?", err)
        end = time.monotonic() + 20
        while group(process.pid) and time.monotonic() < end:
            time.sleep(0.02)
        assert not group(process.pid)
    finally:
        if process.poll() is None:
            os.killpg(process.pid, signal.SIGKILL)
            process.communicate()


@LINUX
@pytest.mark.parametrize(
    "moment", [libraries_load, workers_start, pytest.param(a_part_is_kept, marks=pytest.mark.slow)]
)
def test_ctrl_c_ends_the_program_and_its_workers_quietly(tmp_path, moment):
    assert_interrupted(tmp_path, moment)


@LINUX
@pytest.mark.slow
def test_ctrl_c_is_quiet_at_every_moment(tmp_path):
    for i in range(8):
        folder = tmp_path / str(i)
        folder.mkdir()
        assert_interrupted(folder, libraries_load, 0.25 * i)
        assert_interrupted(folder, workers_start, 0.1 * i)


@pytest.fixture
def own_signal():
    before = signal.signal(signal.SIGINT, signal.default_int_handler)
    yield
    signal.signal(signal.SIGINT, before)


@pytest.mark.usefixtures("own_signal")
def test_the_program_hears_ctrl_c_until_it_leaves(monkeypatch):
    def run():
        assert signal.getsignal(signal.SIGINT) is signal.default_int_handler
        raise KeyboardInterrupt

    monkeypatch.setattr(bridgectl.cli.main, "main", run)
    assert main() == 130
    assert signal.getsignal(signal.SIGINT) is signal.SIG_IGN


@pytest.mark.usefixtures("own_signal")
def test_a_program_that_was_started_deaf_to_ctrl_c_stays_so(monkeypatch):
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    monkeypatch.setattr(bridgectl.cli.main, "main", lambda: 2)
    assert main() == 2
    assert signal.getsignal(signal.SIGINT) is signal.SIG_IGN


@LINUX
@pytest.mark.usefixtures("own_signal")
def test_ctrl_c_while_workers_start_is_felt_when_all_have_started():
    started = []

    def start():
        with _ctrl_c.deaf_to_ctrl_c():
            signal.raise_signal(signal.SIGINT)
            assert signal.SIGINT in signal.pthread_sigmask(signal.SIG_BLOCK, [])
            started.append("all")

    with pytest.raises(KeyboardInterrupt):
        start()
    assert started
    assert signal.SIGINT not in signal.pthread_sigmask(signal.SIG_BLOCK, [])
    assert signal.getsignal(signal.SIGINT) is signal.default_int_handler


@pytest.mark.usefixtures("own_signal")
def test_a_thread_leaves_ctrl_c_to_the_main_one():
    found = []

    def start():
        with _ctrl_c.deaf_to_ctrl_c():
            found.append(signal.getsignal(signal.SIGINT))

    thread = threading.Thread(target=start)
    thread.start()
    thread.join()
    assert found == [signal.default_int_handler]


def test_of_threads_the_one_that_manages_ended_workers_alone_fails_unheard(monkeypatch):
    heard = []
    monkeypatch.setattr(threading, "excepthook", heard.append)
    _ctrl_c.hear_no_manager()
    _ctrl_c.hear_no_manager()  # once is enough
    for name in (_ctrl_c.MANAGER, "another"):
        thread = threading.Thread(target=lambda: 1 / 0, name=name)
        thread.start()
        thread.join()
    assert [args.thread.name for args in heard] == ["another"]
