"""Studies in several processes and on Dask: the same to the bit, whoever dies meanwhile."""

import os
import re
import signal
import socket
import subprocess
import sys
import threading
import time
from contextlib import closing, contextmanager
from pathlib import Path

import joblib
import numpy as np
import pytest
import shares
from helpers import run_command

import bridgectl as bc
from bridgectl import _dask, _shares
from bridgectl._shares import Shares, WorkersLostError
from bridgectl._workers import in_processes
from bridgectl.dampers import passive, skyhook
from bridgectl.paper import validation
from bridgectl.scoring import run as scoring
from bridgectl.scoring.rows import MEASURES

SEEDS = range(12)
ALONE = {seed: shares.numbers(seed) for seed in SEEDS}
LINUX = pytest.mark.skipif(sys.platform != "linux", reason="looks at processes in /proc")
TWO = [
    "score", "--random", "2", "--strategies", "skyhook,ADD", "--approach", "2", "--speeds", "80",
    "--span", "9", "--modes", "1",
]  # fmt: skip


@contextmanager
def cluster_of(n_workers):
    """A cluster in a process of its own, and its address."""
    with subprocess.Popen(
        [sys.executable, shares.__file__, str(n_workers)],
        stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True,
    ) as process:  # fmt: skip
        try:
            yield process, process.stdout.readline().strip()
        finally:
            try:
                process.communicate("", timeout=30)
            finally:
                process.kill()


@pytest.fixture(scope="module")
def address():
    with cluster_of(2) as (_, address):
        yield address


def done(work, *arguments, workers=2, scheduler=None):
    """Results by seed of the work with those arguments."""
    jobs = ((seed, *arguments) for seed in SEEDS)
    return dict(in_processes(work, jobs, workers, scheduler))


def assert_same(found):
    assert sorted(found) == list(SEEDS)
    for seed, values in found.items():
        np.testing.assert_array_equal(values, ALONE[seed], strict=True)


def children():
    """Living processes that this one started, but for joblib's, which wait for more work."""
    found = []
    for folder in Path("/proc").glob("[0-9]*"):
        try:
            state, parent = (folder / "stat").read_text().rpartition(")")[2].split()[:2]
            command = (folder / "cmdline").read_bytes()
        except (FileNotFoundError, ProcessLookupError):
            continue
        if int(parent) == os.getpid() and state != "Z" and b"spawn_main" in command:
            found.append(command)
    return found


# The same numbers


def test_a_scheduler_gives_the_numbers_of_this_process_to_the_bit(address):
    assert_same(done(shares.numbers, scheduler=address))


@pytest.mark.parametrize("workers", [1, 2, 3])
def test_so_does_any_number_of_processes(workers):
    assert_same(done(shares.numbers, workers=workers))


def test_a_backend_that_joblib_is_told_to_take_counts(address):
    from distributed import Client

    with (
        Client(address, set_as_default=False) as client,
        joblib.parallel_config(backend="dask", client=client),
    ):
        found = done(shares.told, workers=None)
        assert client.status == "running"  # it is the user's
        workers = set(client.run(os.getpid).values())
    assert_same({seed: values for seed, (values, _) in found.items()})
    assert {process for _, process in found.values()} <= workers


def test_as_many_processes_as_joblib_is_told_to_take_are_taken():
    with joblib.parallel_config(n_jobs=1):
        assert {process for _, process in done(shares.told, workers=None).values()} == {os.getpid()}
    with joblib.parallel_config(backend="threading", n_jobs=2):
        assert_same(done(shares.numbers, workers=None))


@pytest.mark.slow
@LINUX
def test_a_scheduler_of_this_machine_is_started_and_ended():
    before = children()
    found = done(shares.told, scheduler="local")
    assert_same({seed: values for seed, (values, _) in found.items()})
    assert os.getpid() not in {process for _, process in found.values()}
    assert children() == before


@pytest.mark.slow
def test_a_score_on_a_scheduler_is_that_of_one_process(address, bridge, truck):
    road = bc.iso8608_profile("A", 35, seed=0, start=-10)
    arguments = [passive(7e3), skyhook(1e3, 30e3)], bridge, truck, [road], [20.0, 25.0]
    alone = bc.score(*arguments, approach=10, workers=1)
    board = bc.score(*arguments, approach=10, scheduler=address)
    for name in MEASURES:
        assert np.array_equal(board.values[name], alone.values[name]), name


@pytest.mark.slow
def test_a_validation_on_a_scheduler_is_that_of_one_process(address):
    alone, there = (
        validation.validate([25.0], [9], [0.0], n_random=20, **where)
        for where in ({"workers": 1}, {"scheduler": address})
    )
    assert repr(there) == repr(alone)
    assert there.light == alone.light
    for case, other in zip(there.cases, alone.cases, strict=True):
        assert np.array_equal(case.dae, other.dae)
        assert np.array_equal(case.simulated, other.simulated)


# Workers die


@pytest.mark.parametrize("scheduler", [None, pytest.param("address", marks=pytest.mark.slow)])
def test_the_share_of_a_worker_that_is_killed_is_done_again(scheduler, request, tmp_path):
    scheduler = scheduler and request.getfixturevalue(scheduler)
    assert_same(done(shares.dies_once, str(tmp_path / "died"), scheduler=scheduler))
    assert (tmp_path / "died").exists()


@pytest.mark.slow
@pytest.mark.parametrize("scheduler", [None, "address"])
def test_workers_that_are_killed_by_their_process_ids_change_no_bit(scheduler, request):
    scheduler = scheduler and request.getfixturevalue(scheduler)
    jobs, found, killed = [(seed % 12, 0.2) for seed in range(36)], {}, set()
    with closing(in_processes(shares.told, jobs, 2, scheduler)) as results:
        for index, (values, process) in results:
            found[index] = values
            if index % 12 == 5 and process not in killed:
                killed.add(process)
                os.kill(process, signal.SIGKILL)
    assert killed
    assert sorted(found) == list(range(36))
    for index, values in found.items():
        np.testing.assert_array_equal(values, ALONE[index % 12])


@pytest.mark.slow
@pytest.mark.parametrize("scheduler", [None, "address"])
def test_a_share_that_kills_every_worker_ends_the_study_with_a_word(scheduler, request):
    scheduler = scheduler and request.getfixturevalue(scheduler)
    with pytest.raises(WorkersLostError, match="workers died 6 times, as they do where memory"):
        done(shares.dies, scheduler=scheduler)


def test_lost_shares_are_taken_first_and_not_without_end():
    jobs = Shares([("a",), ("b",), ("c",)])
    assert [next(jobs), next(jobs)] == [(0, ("a",)), (1, ("b",))]
    jobs.done(0)
    jobs.again()
    assert list(jobs) == [(1, ("b",)), (2, ("c",))]
    jobs.again(2, deaths=4)
    assert list(jobs) == [(2, ("c",))]
    with pytest.raises(WorkersLostError, match="workers died 6 times"):
        jobs.again(2)


@pytest.mark.parametrize("scheduler", [None, pytest.param("address", marks=pytest.mark.slow)])
def test_work_that_fails_fails_with_its_own_error(scheduler, request):
    scheduler = scheduler and request.getfixturevalue(scheduler)
    with pytest.raises(OSError, match="no share") as caught:
        done(shares.fails, scheduler=scheduler)
    assert type(caught.value) is OSError


# Schedulers that are silent, gone, or none


@pytest.mark.slow
def test_a_scheduler_that_does_not_answer_is_told_in_a_line(capsys, monkeypatch):
    monkeypatch.setattr(_dask, "ANSWER", 0.3)
    with socket.socket() as silent:
        silent.bind(("127.0.0.1", 0))
        silent.listen()
        address = f"tcp://127.0.0.1:{silent.getsockname()[1]}"
        status, out, err = run_command(capsys, *TWO, "--scheduler", address)
    assert (status, out) == (2, "")
    assert err == (
        f"bridgectl: error: the scheduler {address} does not answer within 0.3 s: start one with "
        "'dask scheduler', and type its address, or local\n"
    )


@pytest.mark.parametrize(
    ("options", "says"),
    [
        (["--scheduler", "nowhere"], "--scheduler must be the address of a Dask scheduler, got"),
        (["--scheduler", "ftp://host:1"], "type tcp://HOST:8786, or local"),
        (["--scheduler", "tcp://host:1", "--workers", "2"], "a scheduler has its own: leave it"),
    ],
)
@pytest.mark.parametrize("command", [TWO, ["validate"], ["validate", "--dampers"]])
def test_a_mistake_is_one_line_and_status_2(capsys, command, options, says):
    status, out, err = run_command(capsys, *command, *options)
    assert (status, out) == (2, "")
    assert says in err
    assert err.count("\n") == 1


def test_a_scheduler_must_be_text(bridge, truck):
    road = bc.iso8608_profile("A", 35, seed=0, start=-10)
    with pytest.raises(TypeError, match='got int: type scheduler="tcp://HOST:8786", or "local"'):
        bc.score([passive(7e3)], bridge, truck, [road], 25, approach=10, scheduler=8786)


def test_without_dask_the_extra_is_named(capsys, monkeypatch):
    monkeypatch.setitem(sys.modules, "distributed.comm", None)
    status, _, err = run_command(capsys, *TWO, "--scheduler", "local")
    assert status == 2
    assert 'type pip install "bridgectl[dask]", or leave' in err
    with pytest.raises(ModuleNotFoundError, match="scheduler needs Dask"):
        done(shares.numbers, scheduler="local")


@pytest.mark.slow
def test_a_scheduler_without_workers_is_not_waited_for_without_end(monkeypatch):
    monkeypatch.setattr(_dask, "IDLE", 0.5)
    with cluster_of(0) as (_, address), pytest.raises(WorkersLostError, match="has no workers for"):
        done(shares.numbers, scheduler=address)


@LINUX
@pytest.mark.slow
@pytest.mark.parametrize("ending", [signal.SIGKILL, signal.SIGSTOP])
def test_a_scheduler_that_is_gone_leaves_a_file_that_goes_on(capsys, tmp_path, monkeypatch, ending):
    kept, keep = tmp_path / "score.jsonl", scoring.Parts.keep
    monkeypatch.setattr(_dask, "ANSWER", 2.0)
    with cluster_of(1) as (process, address):

        def keep_and_end(*arguments):
            keep(*arguments)
            if kept.read_bytes().count(b"\n") > 1:  # parts that are not finite stay out of it
                process.send_signal(ending)

        monkeypatch.setattr(scoring.Parts, "keep", keep_and_end)
        monkeypatch.setattr(_dask, "LEAST", 2)
        status, out, err = run_command(
            capsys, *TWO, "--scheduler", address, "--resume", kept, "--json"
        )
        process.kill()
    assert (status, out) == (2, "")
    assert re.fullmatch(
        f"bridgectl: error: the scheduler {address} is gone, or does not answer any more; {kept} "
        "keeps what is done, the same command goes on from there\n", err,
    )  # fmt: skip
    assert 1 < len(kept.read_bytes().splitlines()) < 10
    monkeypatch.setattr(scoring.Parts, "keep", keep)
    _, alone, _ = run_command(capsys, *TWO, "--workers", "1", "--json")
    assert run_command(capsys, *TWO, "--workers", "1", "--resume", kept, "--json")[1] == alone


@pytest.mark.slow
def test_a_score_that_is_killed_twice_is_that_of_one_run(capsys, tmp_path):
    kept, told = tmp_path / "score.jsonl", tmp_path / "told"
    command = [sys.executable, "-m", "bridgectl", *TWO, "--resume", str(kept), "--json"]

    def lines():
        return kept.read_bytes().count(b"\n") if kept.exists() else 0

    for where in [("--workers", "2"), ("--scheduler", "local")]:
        before = max(lines(), 1)
        with (
            told.open("w") as out,  # of a pipe, workers that outlive the program keep an end
            subprocess.Popen([*command, *where], stdout=out) as process,
        ):
            while process.poll() is None and lines() <= before:
                time.sleep(0.01)
            process.kill()
    whole = run_command(capsys, *TWO, "--workers", "1", "--json")[1]
    assert run_command(capsys, *TWO, "--resume", kept, "--json")[1] == whole


# Versions, threads and memory


def test_results_of_another_version_are_refused(monkeypatch):
    with pytest.raises(ValueError, match=r"a worker has bridgectl .*, not 9.9, and results of two"):
        _shares.share("9.9", shares.numbers, 1)


def test_threads_of_a_worker_do_their_shares_one_after_the_other():
    inside, most = [], []

    def work(seed):
        inside.append(seed)
        most.append(len(inside))
        time.sleep(0.02)
        inside.pop()

    threads = [
        threading.Thread(target=_shares.share, args=(bc.__version__, work, seed))
        for seed in range(4)
    ]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert most == [1, 1, 1, 1]


@pytest.mark.slow
@pytest.mark.parametrize(("scheduler", "wait"), [(None, 0.05), ("address", 0.0)])
def test_of_many_shares_few_are_made_ahead(scheduler, wait, request):
    """Joblib makes shares as workers take them, so that results must be taken as fast as made."""
    scheduler = scheduler and request.getfixturevalue(scheduler)
    made = []

    def jobs():
        for seed in range(100):
            made.append(seed)
            yield seed % 12, wait

    taken = 0
    with closing(in_processes(shares.told, jobs(), 2, scheduler)) as results:
        for taken, _ in enumerate(results, 1):
            assert len(made) - taken <= 8
    assert taken == 100
