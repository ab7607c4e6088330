"""Files that cannot be written: the error names them, and what was there before is still there."""

import os
import resource
import sys
from contextlib import contextmanager

import pytest
from helpers import run_command

import bridgectl as bc
from bridgectl._files import replacing

SCORE = [
    "score", "--approach", "2", "--speeds", "80", "--workers", "1", "--span", "9", "--modes", "1",
    "--strategies", "passive", "--random", "0",
]  # fmt: skip
DAE = ["dae", "--approach", "10", "--speeds", "80"]


@contextmanager
def room_for(size):
    """Stop writing to any file beyond a size [bytes], as a full disk does."""
    soft, hard = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (size, hard))
    try:
        yield
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, (soft, hard))


def save_surface(path):
    bc.ramp_surface(bc.li2006.beam(), bc.li2006.car(), 30.0).save(path)


def save_road(path):
    bc.write_profile(path, bc.utia_road())


@pytest.mark.parametrize(("save", "name"), [(save_surface, "a.npz"), (save_road, "a.csv")])
@pytest.mark.parametrize("before", [None, b"what was there before"])
def test_a_full_disk_is_an_error_of_the_file(tmp_path, save, name, before):
    path = tmp_path / name
    if before is not None:
        path.write_bytes(before)
    with room_for(3000), pytest.raises(OSError, match="File too large") as caught:
        save(path)
    assert caught.value.filename == str(path)
    assert os.listdir(tmp_path) == ([] if before is None else [name])
    assert before is None or path.read_bytes() == before


def test_a_pipe_or_device_is_not_replaced(tmp_path):
    path = tmp_path / "pipe.csv"
    os.mkfifo(path)
    with pytest.raises(OSError, match="No regular file, type another name: ") as caught:
        save_road(path)
    assert caught.value.filename == str(path)
    assert path.is_fifo()


def test_the_text_of_an_error_without_a_number_is_kept(tmp_path):
    """Libraries of pictures raise such errors when the disk is full."""
    path = tmp_path / "figure.png"
    with pytest.raises(OSError, match=r"encoder error -2: .*figure\.png"), replacing(path):
        raise OSError("encoder error -2")


@pytest.mark.quick_cases(1)
@pytest.mark.parametrize("suffix", ["png", "svg", "pdf"])
def test_a_figure_that_does_not_fit_on_the_disk_leaves_no_file(capsys, tmp_path, suffix):
    path = tmp_path / f"road.{suffix}"
    with room_for(3000):
        status, out, err = run_command(capsys, "profile", "--plot", path)
    assert (status, out, err.count("\n")) == (2, "", 1)
    assert err.startswith("bridgectl: error: ")
    assert str(path) in err
    assert not os.listdir(tmp_path)


@pytest.mark.quick_cases(1)
@pytest.mark.parametrize("command", [SCORE, DAE, ["profile"]])
def test_a_figure_that_fails_leaves_the_one_before(capsys, tmp_path, command):
    path = tmp_path / "figure.png"
    path.write_bytes(b"the picture before")
    with room_for(3000):
        status, out, err = run_command(capsys, *command, "--plot", path)
    assert (status, "mean DAF" in out) == (2, command is SCORE)  # whose verdict is told before
    assert err == f"bridgectl: error: [Errno 27] File too large: '{path}'\n"
    assert path.read_bytes() == b"the picture before"
    assert os.listdir(tmp_path) == [path.name]


def test_a_full_disk_under_a_score_names_the_file_that_keeps_it(capsys, tmp_path):
    path = tmp_path / "score.jsonl"
    with room_for(600):
        status, out, err = run_command(capsys, *SCORE, "--resume", path)
    assert (status, out) == (2, "")
    assert err == f"bridgectl: error: [Errno 27] File too large: '{path}'\n"
    assert run_command(capsys, *SCORE, "--resume", path)[0] == 0


@pytest.mark.parametrize("option", ["--resume", "--plot"])
def test_a_pipe_is_no_file_to_go_on_from_or_to_draw_to(capsys, tmp_path, option):
    path = tmp_path / "pipe.png"
    os.mkfifo(path)
    status, out, err = run_command(capsys, *SCORE, option, path)
    assert (status, out) == (2, "")
    assert err == f"bridgectl: error: {option} must name a file, got the pipe or device '{path}'\n"


@pytest.mark.skipif(not os.path.exists("/dev/full"), reason="needs a device that is always full")
@pytest.mark.parametrize("options", [[], ["--json"], ["--help"]])
def test_output_that_cannot_be_written_is_named(capsys, monkeypatch, options):
    with open("/dev/full", "w", encoding="utf-8") as full:
        monkeypatch.setattr(sys, "stdout", full)
        status, _, err = run_command(capsys, "profile", *options)
    assert status == 2
    assert err == "bridgectl: error: [Errno 28] No space left on device: 'standard output'\n"
