"""`asterism.sweep`: the shapes of many variants of one design."""

from __future__ import annotations

import tempfile
import time
from collections.abc import Callable, Mapping, Sequence
from contextlib import AbstractContextManager, nullcontext
from pathlib import Path
from typing import Any, NamedTuple

from asterism.homogenize.campaign.kept_samples import KeptSamples, Outcome
from asterism.homogenize.campaign.workers import (
    CampaignProgress,
    SubmitAll,
    dask_workers,
    default_jobs,
    local_workers,
)
from asterism.homogenize.law.law import Law
from asterism.homogenize.law.law_file import law_digest
from asterism.homogenize.law.plan import without_law
from asterism.pattern.design.arguments import check_type
from asterism.pattern.design.design import Design
from asterism.pattern.design.entries import with_entries
from asterism.results.files import OutputError
from asterism.results.records.sweep import SweepRowRecord
from asterism.sweeps.parameters import (
    SweepError,
    SweepParameter,
    check_parameters,
    grid,
    latin_hypercube,
    with_whole_ranges,
)
from asterism.sweeps.solve_point import SmallPicture, named_law, packed_law, solve_point, sweep_code_version
from asterism.sweeps.sweep import Sweep

# values by path, or parameters
Vary = Mapping[str, str | Sequence[Any]] | Sequence[SweepParameter]


class _Finished(NamedTuple):
    """A design for messages, see `homogenize.campaign.workers.Finished`."""

    label: str
    failed: str | None


def sweep_design(
    design: Design,
    vary: Vary,
    *,
    exact: bool = False,
    samples: int | None = None,
    seed: int = 0,
    folder: str | Path | None = None,
    jobs: int | None = None,
    dask: str | None = None,
    law: Law[Any] | None = None,
    report: Callable[[CampaignProgress], None] | None = None,
) -> Sweep:
    """`asterism.sweep`: compute one design for many values of some of its entries.

    Each design is computed from the start, in a process of its own: the results depend neither on the order nor on the
    number of processes. A design that fails is a point with its reason.

    Parameters
    ----------
    design : the design that is varied.
    vary : values by dotted path, such as `{"stars.thickness_mm": [0.2, 0.3], "pins.0.scale": "0.7:0.8:3"}`. A text is
        a range with a number of values. With `samples` it may be a range without one.
    exact : compute exact shapes, not previews.
    samples : number of designs of a Latin hypercube; by default all combinations are computed.
    seed : of the Latin hypercube.
    folder : keeps finished designs, so that the same call continues an interrupted sweep.
    jobs : number of processes of this machine; one per core by default.
    dask : address of a Dask scheduler, whose workers take the place of these processes.
    law : law of the previews; by default the one that each design names, or else that of the paper's material.
    report : called at the beginning and after each design.

    Raises
    ------
    SweepError
        A parameter is not one of the design's, a value is impossible, there are too many designs, or previews of the
        design are impossible, whatever its sizes.
    CampaignError
        The workers have ended. Finished designs are in `folder`.
    AddressError
        The scheduler does not answer.
    OutputError
        The folder cannot be written to.
    """
    check_type(design, Design, "load_design reads one from a file")
    if law is not None:
        check_type(law, Law, "load_law reads one from a file")
    check_model(design, exact)
    parameters = sweep_parameters(design, vary)
    combinations = sampled(parameters, samples, seed)
    if jobs is not None and jobs < 1:
        raise ValueError(f"jobs = {jobs}: must be at least 1")
    place: AbstractContextManager[Any] = tempfile.TemporaryDirectory() if folder is None else nullcontext(folder)
    with place as kept_in:
        kept = KeptSamples(Path(kept_in), sweep_code_version())
        table = design.to_dict()
        tables = [with_entries(table, values) for values in combinations]
        digest = None if law is None or exact else law_digest(law)
        inputs = [
            {"exact": exact, "law": digest if law is not None or exact else named_law(each), "design": each}
            for each in tables
        ]
        try:
            outcomes = _outcomes(kept, inputs, packed_law(None if exact else law), jobs, dask, combinations, report)
        except OSError as error:
            raise OutputError(f"cannot write {kept.folder}: {(error.strerror or str(error)).lower()}") from None
    points = tuple(_row(number, *pair) for number, pair in enumerate(zip(combinations, outcomes, strict=True), 1))
    pictures = tuple(None if each.sample is None else SmallPicture(**each.sample["picture"]) for each in outcomes)
    return Sweep(design, parameters, points, pictures, exact, None if samples is None else seed, digest)


def check_model(design: Design, exact: bool) -> None:
    """Refuse previews of drawn lines that do not repeat, or that have stars beside them: no value would make one.

    Raises
    ------
    SweepError
        The message names exact shapes as the way.
    """
    if exact or design.rods is None or (refused := without_law(design)) is None:
        return
    if refused.field.split(".")[0] in ("rods", "stars"):
        raise SweepError(
            f"{refused.field}: {refused.allowed.partition(';')[0]}; a sweep computes exact shapes with --exact"
        )


def sweep_parameters(design: Design, vary: Vary) -> tuple[SweepParameter, ...]:
    """The parameters of a sweep, checked against the design.

    Raises
    ------
    SweepError
        As `sweep_design`.
    """
    if not vary:
        raise SweepError("a sweep needs a parameter, such as stars.thickness_mm=0.2:0.6:9")
    if isinstance(vary, Mapping):
        parameters = tuple(SweepParameter.from_values(path, given) for path, given in vary.items())
    else:
        parameters = tuple(vary)
    parameters = with_whole_ranges(design, parameters)
    check_parameters(design, parameters)
    return parameters


def sampled(parameters: Sequence[SweepParameter], samples: int | None, seed: int) -> list[dict[str, Any]]:
    """Values of the parameters by path for each design: all combinations, or a Latin hypercube of so many `samples`.

    Raises
    ------
    SweepError
        As `grid` and `latin_hypercube`.
    """
    return grid(parameters) if samples is None else latin_hypercube(parameters, samples, seed)


def _outcomes(
    kept: KeptSamples,
    inputs: Sequence[dict[str, Any]],
    law: bytes | None,
    jobs: int | None,
    dask: str | None,
    combinations: Sequence[Mapping[str, Any]],
    report: Callable[[CampaignProgress], None] | None,
) -> list[Outcome]:
    """The outcome of each design, from the folder where it is there."""
    outcomes: dict[int, Outcome] = {}
    for number, each in enumerate(inputs):
        if (outcome := kept.read(each)) is not None:
            outcomes[number] = outcome
    missing = [number for number in range(len(inputs)) if number not in outcomes]
    before, start = len(outcomes), time.perf_counter()

    def send_report(left: float | None, last: int | None) -> None:
        if report is not None:
            failed = sum(outcome.failed is not None for outcome in outcomes.values())
            finished = None
            if last is not None:
                which = ", ".join(f"{path} = {value}" for path, value in combinations[last].items())
                finished = _Finished(f"design {last + 1}, {which}", outcomes[last].failed)
            report(CampaignProgress(len(outcomes), len(inputs), failed, left, finished))

    if not missing:
        send_report(None, None)
        return [outcomes[number] for number in range(len(inputs))]
    processes = min(jobs or default_jobs(), len(missing))
    workers: AbstractContextManager[SubmitAll] = local_workers(processes) if dask is None else dask_workers(dask)
    with workers as submit_all:
        send_report(None, None)
        code = sweep_code_version()
        arguments = [(inputs[number]["design"], inputs[number]["exact"], law, code) for number in missing]
        for position, outcome in submit_all(solve_point, arguments):
            number = missing[position]
            outcomes[number] = kept.write(inputs[number], outcome)
            pace = (time.perf_counter() - start) / (len(outcomes) - before)
            send_report(pace * (len(inputs) - len(outcomes)), number)
    return [outcomes[number] for number in range(len(inputs))]


def _row(number: int, values: Mapping[str, Any], outcome: Outcome) -> SweepRowRecord:
    results = None if outcome.sample is None else outcome.sample["values"]
    return SweepRowRecord(number=number, parameters=dict(values), results=results, problem=outcome.failed)
