"""The workers that solve the cells of a campaign: processes of this machine, or a Dask cluster.

Both are context managers that yield a function `submit_all`. It takes a function and a list of arguments, and yields
(number, result) as the results arrive.
"""

from __future__ import annotations

import asyncio
import concurrent.futures
import importlib
import logging
import os
import pickle
import queue
import signal
import subprocess
import sys
import threading
import time
from collections.abc import Callable, Iterator, Sequence
from contextlib import AbstractContextManager, contextmanager, suppress
from dataclasses import dataclass
from typing import Any, Protocol

from asterism.equilibrium.threads import one_blas_thread
from asterism.homogenize.errors import AddressError, CampaignError

Arrivals = Iterator[tuple[int, Any]]
SubmitAll = Callable[[Callable[..., Any], Sequence[tuple[Any, ...]]], Arrivals]
# time without any worker, after which a campaign gives up its cluster
MAX_WAIT_FOR_WORKERS_S = 30.0
# for the answer of a scheduler
MAX_WAIT_FOR_SCHEDULER_S = 10.0
# One thread in each process: as many processes as cores are faster than threads in any of them, and sums have the same
# order for any number of workers. Without the last entry, MKL chooses its code by the address of an array.
WORKER_ENVIRONMENT = {
    **{f"{of}_NUM_THREADS": "1" for of in ("OMP", "OPENBLAS", "MKL", "NUMBA")},
    "VECLIB_MAXIMUM_THREADS": "1",
    "MKL_CBWR": "AUTO,STRICT",
}


class Finished(Protocol):
    """One of many computations: what it is, for messages, and why it has no answer."""

    @property
    def label(self) -> str: ...

    @property
    def failed(self) -> str | None: ...


@dataclass(frozen=True)
class CampaignProgress:
    """State of a running campaign of cells, or of designs."""

    # done, total, failed: numbers of them.
    done: int
    total: int
    failed: int
    seconds_left: float | None  # estimate; None before the first one is solved
    last: Finished | None  # the last one; None at the beginning


def default_jobs() -> int:
    """One process per core that this process may use."""
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1


def workers_for(count: int, jobs: int, dask: str | None, few: int = 0) -> AbstractContextManager[SubmitAll]:
    """Those that compute so many; a few are computed here, before a process would have begun."""
    if count and dask is not None:
        return dask_workers(dask)
    return local_workers(min(jobs, count)) if count > few else this_process()


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
    """Processes of this machine, which start afresh and share nothing with this process.

    They import neither the script that runs here nor its state, so that scripts without a main guard may use them, and
    processes of the studio, which may have no children of Python's own kind. Raises `CampaignError` if a process has
    ended, or a result cannot be had from it; raised by the loop over the results.
    """
    paths = os.pathsep.join(map(os.path.abspath, sys.path))
    environment = {**os.environ, **WORKER_ENVIRONMENT, "PYTHONPATH": paths}
    command = [sys.executable, "-c", f"from {__name__} import serve; serve()"]
    processes: list[subprocess.Popen[bytes]] = []
    arrivals: queue.SimpleQueue[tuple[int, Any, str | None] | None] = queue.SimpleQueue()

    def submit_all(function: Callable[..., Any], arguments: Sequence[tuple[Any, ...]]) -> Arrivals:
        waiting: queue.SimpleQueue[tuple[int, tuple[Any, ...]]] = queue.SimpleQueue()
        for each in enumerate(arguments):
            waiting.put(each)

        def feed(process: subprocess.Popen[bytes]) -> None:
            assert process.stdin is not None and process.stdout is not None
            try:
                while True:
                    number, own = waiting.get_nowait()
                    pickle.dump(pickle.dumps((function, own)), process.stdin)
                    process.stdin.flush()
                    arrivals.put((number, *pickle.load(process.stdout)))
            except queue.Empty:
                pass
            except (EOFError, OSError, ValueError, pickle.UnpicklingError):
                arrivals.put(None)

        for process in processes:
            threading.Thread(target=feed, args=(process,), daemon=True).start()
        for _ in arguments:
            if (arrival := arrivals.get()) is None:
                raise CampaignError(
                    "a worker process has ended (out of memory?); finished samples are kept, fewer --jobs need less"
                )
            number, answer, problem = arrival
            if problem is not None:
                raise CampaignError(f"a worker process has no answer: {problem}")
            yield number, answer

    try:
        for _ in range(jobs):
            pipe = subprocess.PIPE
            processes.append(subprocess.Popen(command, stdin=pipe, stdout=pipe, env=environment))
        yield submit_all
    finally:
        for process in processes:  # in the middle of their cells, after an error
            process.kill()
            process.wait()


def serve() -> None:
    """The body of a process of `local_workers`. It ends with its parent, which answers Ctrl-C."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    answers = os.fdopen(os.dup(sys.stdout.fileno()), "wb")
    os.dup2(sys.stderr.fileno(), sys.stdout.fileno())  # what a cell prints is no answer
    tasks: queue.SimpleQueue[bytes] = queue.SimpleQueue()

    def read() -> None:
        try:
            while True:
                tasks.put(pickle.load(sys.stdin.buffer))
        except (EOFError, OSError):
            os._exit(1)

    threading.Thread(target=read, daemon=True).start()
    while True:
        try:
            function, arguments = pickle.loads(tasks.get())
            answer = pickle.dumps((function(*arguments), None))
        except Exception as error:
            answer = pickle.dumps((None, f"{type(error).__name__}: {error}"))
        answers.write(answer)
        answers.flush()


@contextmanager
def dask_workers(address: str) -> Iterator[SubmitAll]:
    """The workers of a running Dask cluster, on which the same version of asterism is installed.

    Raises `AddressError` if the package distributed is missing, no scheduler answers at the address, or it has no
    workers. Raises `CampaignError` if the workers have ended; raised by the loop over the results.
    """
    try:
        distributed: Any = importlib.import_module("distributed")
        comm: Any = importlib.import_module("distributed.comm")
    except ImportError:
        raise AddressError("--dask: needs the package distributed: pip install 'asterism-fabric[dask]'") from None

    # a lost connection would be a traceback among the lines of progress
    logging.getLogger("distributed.client").setLevel(logging.CRITICAL)

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
                    time.sleep(0.05)
            except (distributed.KilledWorker, distributed.CancelledError, comm.CommClosedError) as error:
                raise CampaignError(f"the workers are gone ({type(error).__name__})") from None
            finally:
                with suppress(Exception):
                    client.cancel(futures)

        yield submit_all
