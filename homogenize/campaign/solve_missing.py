"""The cells of a campaign that are missing: solved by workers, and each kept as soon as it is finished."""

from __future__ import annotations

import time
from collections.abc import Callable, Generator, Mapping, Sequence
from contextlib import AbstractContextManager
from typing import Any

from asterism.homogenize.campaign.kept_samples import KeptSamples, Outcome
from asterism.homogenize.campaign.workers import SubmitAll, dask_workers, local_workers

Cell = tuple[Mapping[str, Any], tuple[Any, ...]]


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
    jobs : number of processes on this machine.
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
    workers: AbstractContextManager[SubmitAll] = local_workers(processes) if dask is None else dask_workers(dask)
    with workers as submit_all:
        begin()
        arrivals = submit_all(function, [arguments for _, arguments in cells])
        for count, (number, outcome) in enumerate(arrivals, 1):
            left = (time.perf_counter() - start) / count * (len(cells) - count)
            yield number, kept.write(cells[number][0], outcome), left
