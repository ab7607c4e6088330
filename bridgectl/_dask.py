"""Shares of a study on Dask: a cluster's scheduler, or one of this machine with its own workers.

Not through joblib's backend, which waits without end for shares whose workers died too often, or
whose scheduler is gone.
"""

from __future__ import annotations

import logging
import socket
from collections.abc import Callable, Generator, Iterator
from concurrent.futures import CancelledError
from contextlib import closing, contextmanager
from queue import Empty, SimpleQueue
from time import monotonic
from typing import Any, TypeVar
from uuid import uuid4

from bridgectl import _version
from bridgectl._ctrl_c import deaf_to_ctrl_c
from bridgectl._shares import Shares, WorkersLostError, share

T = TypeVar("T")

EXTRA = "bridgectl[dask]"

LOCAL = "local"
"""What stands for a scheduler of this machine."""

ANSWER = 10.0
"""Time in which a scheduler answers [s]."""

IDLE = 60.0
"""Time that is waited for a worker while there is none [s]: one that died takes some to return."""

DEATHS = 3
"""Workers that a share takes with it until Dask gives it back."""

KEPT = {
    f"distributed.nanny.pre-spawn-environ.MALLOC_{name}_THRESHOLD_": size
    for name, size in (("TRIM", 2**27), ("MMAP", 2**25))
}
"""Free memory [bytes] that workers keep: by Dask's 64 kB, arrays of some MB take longer."""

LOOK = 1.0
"""Time between looks at the scheduler [s]."""

AHEAD, LEAST = 2, 8
"""Shares that are under way for each thread of the workers, and the least: others may join."""


def on_dask(
    work: Callable[..., T], shares: Shares, workers: int, scheduler: Any
) -> Generator[tuple[int, T], None, None]:
    """Do shares on a scheduler: an address, "local" with so many workers, or joblib's backend."""
    if not isinstance(scheduler, str):
        client = scheduler.client
        with closing(_Run(client, client.scheduler.address, work, shares).results()) as found:
            yield from found
        return
    with (
        _connected(scheduler, workers) as client,
        closing(_Run(client, scheduler, work, shares).results()) as found,
    ):
        yield from found


def require_address(scheduler: str) -> None:
    """Check that a scheduler may be at an address, and that Dask is installed."""
    try:
        from distributed.comm import parse_address, parse_host_port
        from distributed.comm.registry import get_backend
    except ImportError:
        raise ModuleNotFoundError(
            f'scheduler needs Dask: type pip install "{EXTRA}", or leave scheduler out'
        ) from None
    if scheduler == LOCAL:
        return
    try:
        protocol, place = parse_address(scheduler)
        get_backend(protocol)
        parse_host_port(place)
    except ValueError:
        raise ValueError(
            f"scheduler must be the address of a Dask scheduler, got {scheduler!r}: type "
            f"tcp://HOST:8786, or {LOCAL}"
        ) from None


@contextmanager
def _connected(scheduler: str, workers: int) -> Iterator[Any]:
    """Connect to a scheduler, or start one, whose log is silent."""
    require_address(scheduler)
    with _quiet(), _local(workers) if scheduler == LOCAL else _remote(scheduler) as client:
        yield client


@contextmanager
def _local(workers: int) -> Iterator[Any]:
    import dask
    from distributed import Client, LocalCluster

    cluster = None
    try:
        with deaf_to_ctrl_c(), dask.config.set(KEPT):
            cluster = LocalCluster(
                n_workers=workers, threads_per_worker=1, memory_limit=None, dashboard_address=":0",
                silence_logs=logging.CRITICAL,
            )  # fmt: skip
        with Client(cluster, set_as_default=False) as client:
            yield client
    finally:
        if cluster is not None:
            cluster.close()


@contextmanager
def _remote(scheduler: str) -> Iterator[Any]:
    from distributed import Client

    try:
        _require_answer(scheduler)
        client = Client(scheduler, timeout=ANSWER, set_as_default=False)
    except OSError:
        raise TimeoutError(
            f"the scheduler {scheduler} does not answer within {ANSWER:g} s: start one with 'dask "
            f"scheduler', and type its address, or {LOCAL}"
        ) from None
    try:
        yield client
    finally:
        client.close(timeout=ANSWER)


def _require_answer(scheduler: str) -> None:
    """Wait for a scheduler's first byte: for what takes connections only, Dask waits forever."""
    from distributed.comm import parse_address, parse_host_port

    protocol, place = parse_address(scheduler)
    with socket.create_connection(parse_host_port(place), timeout=ANSWER) as connection:
        if protocol == "tcp" and not connection.recv(1):
            raise ConnectionResetError


@contextmanager
def _quiet() -> Iterator[None]:
    """Silence Dask's log, which would tell of each connection that is lost."""
    handlers = logging.getLogger("distributed").handlers
    levels = [handler.level for handler in handlers]
    for handler in handlers:
        handler.setLevel(logging.CRITICAL + 1)
    try:
        yield
    finally:
        for handler, level in zip(handlers, levels, strict=True):
            handler.setLevel(level)


class _Run:
    """Shares on a scheduler, no more at once than its workers soon take."""

    def __init__(
        self, client: Any, scheduler: str, work: Callable[..., Any], shares: Shares
    ) -> None:
        self.client, self.scheduler, self.work, self.shares = client, scheduler, work, shares
        self.ended: SimpleQueue[Any] = SimpleQueue()
        self.under_way: dict[str, tuple[int, Any]] = {}
        self.threads, self.looked, self.seen = 0, -LOOK, monotonic()

    def results(self) -> Generator[tuple[int, Any], None, None]:
        """Yield results, with the numbers of their shares, as they come."""
        try:
            while self._hand_out():
                try:
                    future = self.ended.get(timeout=LOOK)
                except Empty:
                    continue
                index, _ = self.under_way.pop(future.key)
                if found := self._taken(future, index):
                    self.shares.done(index)
                    yield index, found[0]
        finally:
            for _, future in self.under_way.values():
                future.release()  # without an answer, which may never come

    def _hand_out(self) -> bool:
        """Submit what workers soon take; return whether anything is left to wait for."""
        with self._heard():
            if monotonic() - self.looked >= LOOK:
                self._look()
            while len(self.under_way) < max(AHEAD * self.threads, LEAST):
                try:
                    index, job = next(self.shares)
                except StopIteration:
                    break
                key = f"bridgectl-{uuid4().hex}"
                future = self.client.submit(
                    share, _version.__version__, self.work, *job, key=key, pure=False
                )
                self._wait_for(future, index)
        return bool(self.under_way)

    def _wait_for(self, future: Any, index: int) -> None:
        self.under_way[future.key] = index, future
        future.add_done_callback(self.ended.put)

    def _taken(self, future: Any, index: int) -> tuple[Any] | None:
        """Fetch a result; none if the share is to be done again."""
        from distributed.scheduler import KilledWorker

        with self._heard():
            if future.status == "error":
                error = future.exception(timeout=ANSWER)
            else:
                try:
                    return (future.result(timeout=ANSWER),)
                except TimeoutError:  # its worker died, and another does it again
                    self._wait_for(future, index)
                    return None
        if isinstance(error, KilledWorker):
            self.shares.again(index, deaths=DEATHS)
            return None
        if isinstance(error, ImportError):
            raise ValueError(
                f"a worker of {self.scheduler} lacks what the work needs ({error}): install the "
                "same everywhere"
            )
        raise error

    def _look(self) -> None:
        """Count the threads of the workers: they come and go."""
        counted = self.client.sync(
            self.client.scheduler.ncores, workers=None, callback_timeout=ANSWER
        )
        self.looked, self.threads = monotonic(), sum(counted.values())
        if self.threads:
            self.seen = self.looked
        elif self.looked - self.seen > IDLE:
            raise WorkersLostError(
                f"the scheduler {self.scheduler} has no workers for {IDLE:g} s: start some with "
                "'dask worker ADDRESS --nthreads 1'"
            )

    @contextmanager
    def _heard(self) -> Iterator[None]:
        """Tell that the scheduler is gone, whatever that breaks."""
        try:
            yield
        except WorkersLostError:
            raise
        except Exception as error:
            if isinstance(error, OSError | CancelledError) or self.client.status != "running":
                raise WorkersLostError(
                    f"the scheduler {self.scheduler} is gone, or does not answer any more"
                ) from None
            raise
