"""Where work is done: every place is a ``concurrent.futures.Executor``, so that the rest of a sweep knows none of them.

Imports stand inside the functions: a worker process reads this file before its libraries may start threads.
"""

from __future__ import annotations

import os
import signal
import threading
from collections.abc import Callable, Iterator
from concurrent.futures import Executor, Future
from contextlib import contextmanager

from spheredrive.errors import SpheredriveError

# Libraries that start threads of their own read these when they are loaded.
_THREADS = ("NUMBA_NUM_THREADS", "OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS")
# Seconds that a Dask scheduler may take to answer.
PATIENCE = 15


class Workers:
    """An executor, how many pieces it works on at once, and how to get another where it breaks.

    ``lost`` are the exceptions of work whose worker has died, ``gone`` those of a cluster that is not there any more;
    ``fall_together`` says whether all workers are lost with one.
    """

    def __init__(self, make: Callable[[], Executor], count: int, lost: tuple = (), gone: tuple = (), where: str = ""):
        self._make = make
        self.count = count
        self.lost, self.gone, self.where = lost, gone, where
        self.fall_together = not where
        self._executor = make()

    def submit(self, function: Callable, *arguments) -> Future:
        """``function(*arguments)``, done elsewhere."""
        return self._executor.submit(function, *arguments)

    def renew(self) -> None:
        """Another executor in place of a broken one."""
        self.stop()
        self._executor = self._make()

    def stop(self) -> None:
        """Give up what is not done; nothing is waited for."""
        processes = list((getattr(self._executor, "_processes", None) or {}).values())
        self._executor.shutdown(wait=not processes, cancel_futures=True)
        for process in processes:
            process.kill()
        for process in processes:
            process.join()


class _Cluster(Workers):
    """Workers of a Dask cluster, not started here: each piece of work tells them to use one thread a library."""

    def stop(self) -> None:
        # Without waiting, it takes back what is not done.
        self._executor.shutdown(wait=False)

    def submit(self, function: Callable, *arguments) -> Future:
        return super().submit(_single_threaded, function, *arguments)


def _single_threaded(function: Callable, *arguments):
    import sys

    if "numba" in sys.modules:
        sys.modules["numba"].set_num_threads(1)
    else:
        os.environ.update(dict.fromkeys(_THREADS, "1"))
    return function(*arguments)


@contextmanager
def open_workers(count: int | None = None, dask: str | None = None) -> Iterator[Workers]:
    """The workers of a sweep: ``count`` processes (one a core if None), none but a thread of this process for 0, or those of a
    running Dask cluster at the address ``dask``.

    Raises ``SpheredriveError`` where a cluster cannot be reached or has no workers.
    """
    if dask is not None:
        with _dask_workers(dask) as workers:
            yield workers
        return
    workers = _here() if count == 0 else _processes(count or _cores())
    try:
        yield workers
    finally:
        workers.stop()


def _cores() -> int:
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1


def _here() -> Workers:
    from concurrent.futures import ThreadPoolExecutor

    return Workers(lambda: ThreadPoolExecutor(1), 1)


def _processes(count: int) -> Workers:
    import multiprocessing
    from concurrent.futures import ProcessPoolExecutor
    from concurrent.futures.process import BrokenProcessPool

    context = multiprocessing.get_context("spawn")

    def make() -> Executor:
        return ProcessPoolExecutor(count, context, initializer=_settle)

    return Workers(make, count, lost=(BrokenProcessPool,))


def _settle() -> None:
    """In a new worker process: one thread a library, Ctrl-C left to the coordinator, an end with the coordinator's."""
    for name in _THREADS:
        os.environ[name] = "1"
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    threading.Thread(target=_end_with_parent, daemon=True).start()


def _end_with_parent() -> None:
    """A coordinator that is killed tells nobody; its workers must not wait for ever."""
    import multiprocessing

    parent = multiprocessing.parent_process()
    if parent is not None:
        parent.join()
        os._exit(1)


@contextmanager
def _dask_workers(address: str) -> Iterator[Workers]:
    try:
        from distributed import Client
        from distributed.client import FutureCancelledError
        from distributed.scheduler import KilledWorker
    except ImportError:
        raise SpheredriveError('--dask needs Dask: pip install "spheredrive[distributed]"') from None
    from concurrent.futures import CancelledError

    try:
        client = Client(address, timeout=PATIENCE, set_as_default=False)
    except (OSError, ValueError) as error:
        raise SpheredriveError(f"there is no Dask scheduler at {address}: {' '.join(str(error).split())[:200]}") from None
    with client:
        count = sum(client.nthreads().values())
        if not count:
            raise SpheredriveError(f"the Dask scheduler at {address} has no workers; start some with: dask worker {address}")
        workers = _Cluster(client.get_executor, count, (KilledWorker,), (CancelledError, FutureCancelledError), address)
        try:
            yield workers
        finally:
            workers.stop()
