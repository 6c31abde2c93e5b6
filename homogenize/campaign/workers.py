"""The workers that solve the cells of a campaign: processes of this machine, or a Dask cluster.

Both are context managers that yield a function `submit_all`. It takes a function and a list of arguments, and yields
(number, result) as the results arrive.
"""

from __future__ import annotations

import asyncio
import concurrent.futures
import importlib
import multiprocessing
import os
import signal
import threading
import time
from collections.abc import Callable, Generator, Iterator, Mapping, Sequence
from concurrent.futures.process import BrokenProcessPool
from contextlib import AbstractContextManager, contextmanager, suppress
from typing import Any

from asterism.equilibrium.threads import one_blas_thread
from asterism.homogenize.campaign.kept_samples import KeptSamples, Outcome
from asterism.homogenize.errors import AddressError, CampaignError

Arrivals = Iterator[tuple[int, Any]]
SubmitAll = Callable[[Callable[..., Any], Sequence[tuple[Any, ...]]], Arrivals]
# between two looks at a cluster
POLL_INTERVAL_S = 0.05
# time without any worker, after which a campaign gives up its cluster
MAX_WAIT_FOR_WORKERS_S = 30.0
# for the answer of a scheduler
MAX_WAIT_FOR_SCHEDULER_S = 10.0
# One thread in each process: as many processes as cores are faster than threads in any of them, and sums have the same
# order for any number of workers. Without the last entry, MKL chooses its code by the address of an array.
WORKER_ENVIRONMENT = {
    "OMP_NUM_THREADS": "1",
    "OPENBLAS_NUM_THREADS": "1",
    "MKL_NUM_THREADS": "1",
    "VECLIB_MAXIMUM_THREADS": "1",
    "NUMBA_NUM_THREADS": "1",
    "MKL_CBWR": "AUTO,STRICT",
}
# so many cells are solved in this process
FEW_CELLS = 3
Cell = tuple[Mapping[str, Any], tuple[Any, ...]]


def default_jobs() -> int:
    """One process per core that this process may use."""
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1


@contextmanager
def this_process() -> Iterator[SubmitAll]:
    """One after the other, without another process."""

    def submit_all(function: Callable[..., Any], arguments: Sequence[tuple[Any, ...]]) -> Arrivals:
        for number, args in enumerate(arguments):
            with one_blas_thread():
                answer = function(*args)
            yield number, answer

    yield submit_all


@contextmanager
def local_workers(jobs: int) -> Iterator[SubmitAll]:
    """Processes of this machine. Each starts afresh and shares nothing with this process.

    Raises
    ------
    CampaignError
        A process has ended; raised by the loop over the results.
    """
    with _environment(WORKER_ENVIRONMENT):
        context = multiprocessing.get_context("spawn")
        pool = concurrent.futures.ProcessPoolExecutor(jobs, context, _begin)
        answered: list[int] = []

        def submit_all(function: Callable[..., Any], arguments: Sequence[tuple[Any, ...]]) -> Arrivals:
            number = {pool.submit(function, *args): n for n, args in enumerate(arguments)}
            for future in concurrent.futures.as_completed(number):
                answer = number[future], future.result()
                answered.append(number[future])
                yield answer

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
    """The workers of a running Dask cluster, on which the same version of asterism is installed.

    Raises
    ------
    AddressError
        The package distributed is missing, no scheduler answers at the address, or it has no workers.
    CampaignError
        The workers have ended; raised by the loop over the results.
    """
    try:
        distributed: Any = importlib.import_module("distributed")
        comm: Any = importlib.import_module("distributed.comm")
    except ImportError:
        raise AddressError("--dask: needs the package distributed: pip install 'asterism-fabric[dask]'") from None

    async def check_scheduler() -> None:
        connection = await comm.connect(address, timeout=MAX_WAIT_FOR_SCHEDULER_S)
        await connection.close()

    try:
        # A client without a scheduler keeps trying and complains at the end of the program, so this checks first. The
        # check has a thread of its own, because the thread of a notebook has an event loop already.
        with concurrent.futures.ThreadPoolExecutor(1) as thread:
            thread.submit(asyncio.run, check_scheduler()).result()
        client = distributed.Client(address, timeout=MAX_WAIT_FOR_SCHEDULER_S, set_as_default=False)
    except (OSError, ValueError, TimeoutError) as error:
        hint = "; an address is written tcp://HOST:PORT" if isinstance(error, ValueError) else ""
        raise AddressError(f"--dask: no scheduler answers at {address!r}{hint}") from None
    with client:
        if not client.scheduler_info()["workers"]:
            raise AddressError(f"--dask: the scheduler at {address!r} has no workers")

        def submit_all(function: Callable[..., Any], arguments: Sequence[tuple[Any, ...]]) -> Arrivals:
            futures = [client.submit(function, *args, pure=False) for args in arguments]
            number = {future.key: n for n, future in enumerate(futures)}
            try:
                # with results: asking a lost worker for its result later would wait for ever
                arrivals = distributed.as_completed(futures, loop=client.loop, with_results=True)
                last_seen = time.monotonic()
                while not arrivals.is_empty():
                    if arrivals.has_ready():
                        for future, result in arrivals.next_batch(block=False):
                            if isinstance(result, distributed.CancelledError):
                                raise CampaignError("the scheduler is gone; finished samples are kept")
                            yield number[future.key], result
                        last_seen = time.monotonic()
                    elif client.scheduler_info()["workers"]:
                        last_seen = time.monotonic()
                    elif time.monotonic() > last_seen + MAX_WAIT_FOR_WORKERS_S:
                        raise CampaignError("the workers are gone; finished samples are kept")
                    time.sleep(POLL_INTERVAL_S)
            except (distributed.KilledWorker, distributed.CancelledError, comm.CommClosedError) as error:
                raise CampaignError(f"the workers are gone ({type(error).__name__})") from None
            finally:
                with suppress(Exception):
                    client.cancel(futures)

        yield submit_all


def _begin() -> None:
    """First call in a new worker: it ignores Ctrl-C, which its parent answers, and ends with its parent."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    threading.Thread(target=_follow_parent, daemon=True).start()


def _follow_parent() -> None:
    parent = multiprocessing.parent_process()
    if parent is not None:
        parent.join()
        os._exit(1)


def _end(pool: concurrent.futures.ProcessPoolExecutor) -> None:
    """End the workers in the middle of their cells. Executors have no function for this before Python 3.14."""
    for process in list((getattr(pool, "_processes", None) or {}).values()):
        process.terminate()


@contextmanager
def _environment(values: dict[str, str]) -> Iterator[None]:
    """Environment variables for the processes that start within the block."""
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


def solve_missing(
    kept: KeptSamples,
    function: Callable[..., Outcome],
    cells: Sequence[Cell],
    jobs: int,
    dask: str | None,
    begin: Callable[[], None],
) -> Generator[tuple[int, Outcome, float], None, None]:
    """Solve cells, and yield their numbers and outcomes as they are kept, with an estimate of the seconds left.

    The workers end with the generator: close it (`contextlib.closing`), also after an interruption.

    Parameters
    ----------
    function : solves a cell. Other processes must be able to import it.
    cells : for each the inputs that its file is named by, and the arguments of the function.
    jobs : number of processes on this machine; 0 for this process alone.
    dask : address of a Dask scheduler, whose workers take the place of these processes.
    begin : called when the workers are there, and at once if there is no cell.

    Raises
    ------
    CampaignError, AddressError
        See `homogenize.campaign.workers`.
    """
    if not cells:
        begin()
        return
    start, processes = time.perf_counter(), min(jobs, len(cells))
    workers: AbstractContextManager[SubmitAll]
    if dask is not None:
        workers = dask_workers(dask)
    else:  # a few cells are done before a process has begun
        workers = local_workers(processes) if processes and len(cells) > FEW_CELLS else this_process()
    with workers as submit_all:
        begin()
        arrivals = submit_all(function, [arguments for _, arguments in cells])
        for count, (number, outcome) in enumerate(arrivals, 1):
            left = (time.perf_counter() - start) / count * (len(cells) - count)
            yield number, kept.write(cells[number][0], outcome), left
