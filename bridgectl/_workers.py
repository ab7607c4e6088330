"""Shares of a study in several processes, of this machine or of a cluster.

Without further word they are joblib's own, or those that `joblib.parallel_config` chooses; a
scheduler puts the shares on Dask. One Ctrl-C ends all. Shares are handed out as workers take them,
and those of workers that died are done again.
"""

from __future__ import annotations

import sys
from collections.abc import Callable, Generator, Iterable, Mapping, Sized
from contextlib import closing, suppress
from typing import Any, TypeVar

from bridgectl import _checks as check
from bridgectl import _version
from bridgectl._ctrl_c import deaf_to_ctrl_c, hear_no_manager
from bridgectl._parts import Part, Parts
from bridgectl._progress import track
from bridgectl._shares import Shares, share
from bridgectl._threads import on_one_thread

T = TypeVar("T")


def in_processes(
    work: Callable[..., T],
    jobs: Iterable[tuple[Any, ...]],
    workers: int | None = None,
    scheduler: str | None = None,
) -> Generator[tuple[int, T], None, None]:
    """Do the jobs, as many at once as there are workers; yield what is done, with its index.

    Jobs are arguments of `work`, a function of a module; they may come from a generator, which is
    asked for no more than are soon done. `workers` are processes of this machine: by default one
    for each core, or as many as joblib is configured to take. `scheduler` is the address of a Dask
    scheduler, or "local" for one of this machine; without it, a backend that
    `joblib.parallel_config` chose counts. Close the generator to end the workers.
    """
    backend, n_jobs = _chosen()
    shares = Shares(jobs)
    most = len(jobs) if isinstance(jobs, Sized) else sys.maxsize
    number = check.workers(n_jobs if workers is None else workers, max(most, 1))
    if scheduler is not None or type(backend).__name__ == "DaskDistributedBackend":
        from bridgectl import _dask  # late, as Dask is an extra

        yield from _dask.on_dask(work, shares, number, backend if scheduler is None else scheduler)
    elif number == 1:
        for index, job in shares:
            result = on_one_thread(work)(*job)
            shares.done(index)
            yield index, result
    else:
        yield from _on_joblib(work, shares, number)


def keep_missing(
    parts: Parts, work: Callable[..., Part], jobs: Mapping[tuple[str, str], tuple[Any, ...]],
    title: str, unit: str, workers: int | None, scheduler: str | None, *, progress: bool,
    finish: Callable[[Part], Part] = lambda part: part,
) -> None:  # fmt: skip
    """Do the jobs whose parts are not there, each of a part; keep what `finish` makes of it."""
    todo = [task for task in jobs if task not in parts]
    with closing(in_processes(work, [jobs[task] for task in todo], workers, scheduler)) as found:
        for index, part in track(
            found, title, len(jobs), show=progress, before=len(jobs) - len(todo), unit=unit
        ):
            parts.keep(*todo[index], finish(part))


def check_workers(workers: int | None, scheduler: object = None) -> None:
    """Check what a study is told of its workers."""
    if workers is not None:
        check.integer("workers", workers, at_least=1)
    check_scheduler(scheduler)


def check_scheduler(scheduler: object) -> None:
    """Check an address of a scheduler, as far as that goes without asking it."""
    if scheduler is None:
        return
    if not isinstance(scheduler, str):
        raise TypeError(
            "scheduler must be the address of a Dask scheduler, got "
            f'{type(scheduler).__name__}: type scheduler="tcp://HOST:8786", or "local"'
        )
    from bridgectl import _dask

    _dask.require_address(scheduler)


def _chosen() -> tuple[Any, int | None]:
    """Return the backend that joblib has now, and for how many processes it is configured."""
    if "joblib" not in sys.modules:  # slow to load, and nothing is configured
        return None, None
    import joblib
    from joblib.parallel import get_active_backend

    backend, n_jobs = get_active_backend()
    return backend, None if n_jobs is None else max(1, joblib.effective_n_jobs(n_jobs))


def _on_joblib(
    work: Callable[..., T], shares: Shares, workers: int
) -> Generator[tuple[int, T], None, None]:
    from joblib.externals.loky.process_executor import TerminatedWorkerError

    while True:
        try:
            with closing(_run_on_joblib(work, shares, workers)) as found:
                for index, result in found:
                    shares.done(index)
                    yield index, result
            return
        except TerminatedWorkerError:
            shares.again()


def _run_on_joblib(
    work: Callable[..., T], shares: Shares, workers: int
) -> Generator[tuple[int, T], None, None]:
    import joblib

    # One by one: a batch would keep what is done from being kept.
    parallel = joblib.Parallel(workers, return_as="generator_unordered", batch_size=1)
    found = None
    hear_no_manager()
    try:
        with deaf_to_ctrl_c():
            found = parallel(joblib.delayed(_numbered)(i, work, *job) for i, job in shares)
        for each in found:  # noqa: UP028 - "yield from" would let joblib warn of being ended
            yield each
    finally:
        if found is not None:
            with suppress(KeyboardInterrupt):  # of which joblib says nothing, and ends the workers
                found.throw(KeyboardInterrupt)


def _numbered(index: int, work: Callable[..., T], *job: Any) -> tuple[int, T]:
    return index, share(_version.__version__, work, *job)
