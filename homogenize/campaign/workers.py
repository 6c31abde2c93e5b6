"""Where the cells of a campaign are solved: processes of this machine, or a Dask cluster.

Either is a context manager that yields a function: it takes a function and a list of arguments, and yields
(number, result) as results arrive.
"""

from __future__ import annotations

import asyncio
import concurrent.futures
import multiprocessing
import os
import signal
import threading
import time
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures.process import BrokenProcessPool
from contextlib import contextmanager, suppress
from typing import Any

from homogenize.errors import AddressError, CampaignError

Arrivals = Iterator[tuple[int, Any]]
SubmitAll = Callable[[Callable[..., Any], Sequence[tuple[Any, ...]]], Arrivals]

# a cluster is looked at so often, and given up after so long without a worker
POLL_INTERVAL_S, MAX_WAIT_FOR_WORKERS_S = 0.05, 30.0
# One thread each: as many processes as cores are quicker than threads in any of them, and sums are taken in the same
# order whatever the number of workers. MKL may otherwise choose its path by where an array happens to lie in memory.
WORKER_ENVIRONMENT = {
    "OMP_NUM_THREADS": "1",
    "OPENBLAS_NUM_THREADS": "1",
    "MKL_NUM_THREADS": "1",
    "VECLIB_MAXIMUM_THREADS": "1",
    "NUMBA_NUM_THREADS": "1",
    "MKL_CBWR": "AUTO,STRICT",
}


@contextmanager
def local_workers(jobs: int) -> Iterator[SubmitAll]:
    """Processes of this machine, started afresh so that they share nothing with this one."""
    with _environment(WORKER_ENVIRONMENT):
        context = multiprocessing.get_context("spawn")
        pool = concurrent.futures.ProcessPoolExecutor(jobs, context, _begin)

        def submit_all(function: Callable[..., Any], arguments: Sequence[tuple[Any, ...]]) -> Arrivals:
            number = {pool.submit(function, *args): n for n, args in enumerate(arguments)}
            for future in concurrent.futures.as_completed(number):
                answer = number[future], future.result()
                answered.append(number[future])
                yield answer

        answered: list[int] = []
        try:
            yield submit_all
        except BrokenProcessPool:
            reason = "a worker process has ended (out of memory?); finished samples are kept, fewer --jobs need less"
            if not answered:
                reason += "; a script must call this under if __name__ == '__main__', as its processes start it again"
            raise CampaignError(reason) from None
        except BaseException:
            _end(pool)
            raise
        finally:
            pool.shutdown(wait=False, cancel_futures=True)


@contextmanager
def dask_workers(address: str) -> Iterator[SubmitAll]:
    """The workers of a running Dask cluster, which must have asterism installed in the same version."""
    try:
        from distributed import CancelledError, Client, KilledWorker, as_completed
        from distributed.comm import CommClosedError, connect
    except ImportError:
        raise AddressError("--dask needs the package distributed: pip install 'asterism[dask]'") from None

    async def knock() -> None:
        comm = await connect(address, timeout=10)
        await comm.close()

    try:
        # a client that finds nobody goes on trying and complains at the end of the program; a notebook has a loop
        # running in this thread, and no room for another
        with concurrent.futures.ThreadPoolExecutor(1) as thread:
            thread.submit(asyncio.run, knock()).result()
        client = Client(address, timeout=10, set_as_default=False)
    except (OSError, ValueError, TimeoutError) as error:
        raise AddressError(f"--dask: no scheduler answers at {address!r} ({type(error).__name__})") from None
    with client:
        if not client.scheduler_info()["workers"]:
            raise AddressError(f"--dask: the scheduler at {address!r} has no workers")

        def submit_all(function: Callable[..., Any], arguments: Sequence[tuple[Any, ...]]) -> Arrivals:
            futures = [client.submit(function, *args, pure=False) for args in arguments]
            number = {future.key: n for n, future in enumerate(futures)}
            try:
                # with their results: those of a worker that has gone would be waited for
                arrivals = as_completed(futures, loop=client.loop, with_results=True)
                last_seen = time.monotonic()
                while not arrivals.is_empty():
                    if arrivals.has_ready():
                        for future, result in arrivals.next_batch(block=False):
                            yield number[future.key], result
                        last_seen = time.monotonic()
                    elif client.scheduler_info()["workers"]:
                        last_seen = time.monotonic()
                    elif (
                        time.monotonic() > last_seen + MAX_WAIT_FOR_WORKERS_S
                    ):  # the cells would wait for new ones for ever
                        raise CampaignError("the workers are gone; finished samples are kept")
                    time.sleep(POLL_INTERVAL_S)
            except (KilledWorker, CancelledError, CommClosedError) as error:
                raise CampaignError(f"the workers are gone ({type(error).__name__})") from None
            finally:
                with suppress(Exception):
                    client.cancel(futures)

        yield submit_all


def _begin() -> None:
    """In a new worker: Ctrl-C is the parent's to answer, and no worker outlives it."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    threading.Thread(target=_follow_parent, daemon=True).start()


def _follow_parent() -> None:
    parent = multiprocessing.parent_process()
    if parent is not None:
        parent.join()
        os._exit(1)


def _end(pool: concurrent.futures.ProcessPoolExecutor) -> None:
    """End the workers in the middle of their cells; before Python 3.14 an executor cannot do that by itself."""
    for process in list((getattr(pool, "_processes", None) or {}).values()):
        process.terminate()


@contextmanager
def _environment(values: dict[str, str]) -> Iterator[None]:
    """Variables that processes started within the block inherit."""
    before = {name: os.environ.get(name) for name in values}
    os.environ.update(values)
    try:
        yield
    finally:
        for name, value in before.items():
            if value is None:
                del os.environ[name]
            else:
                os.environ[name] = value
