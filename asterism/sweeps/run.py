"""`asterism.sweep`: the shapes of many variants of one design."""

from __future__ import annotations

import pickle
import tempfile
from collections.abc import Callable, Mapping, Sequence
from contextlib import AbstractContextManager, nullcontext
from pathlib import Path
from types import SimpleNamespace
from typing import Any

from asterism.homogenize.campaign.kept_samples import KeptSamples, Outcome
from asterism.homogenize.campaign.workers import CampaignProgress, Finished, default_jobs, workers_for
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
from asterism.sweeps.solve_point import named_law, solve_point, sweep_code_version
from asterism.sweeps.sweep import Sweep

# values by path, or parameters
Vary = Mapping[str, str | Sequence[Any]] | Sequence[SweepParameter]


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
        own_law, code = None if law is None or exact else pickle.dumps(law), sweep_code_version()

        def finished(number: int, outcome: Outcome) -> Finished:
            which = ", ".join(f"{path} = {value}" for path, value in combinations[number].items())
            return SimpleNamespace(label=f"design {number + 1}, {which}", failed=outcome.failed)

        try:
            arguments = [(each, exact, own_law, code) for each in tables]
            outcomes = kept.outcomes(
                inputs,
                lambda count: workers_for(count, jobs or default_jobs(), dask),
                solve_point,
                arguments,
                finished,
                report,
            )
        except OSError as error:
            raise OutputError(f"cannot write {kept.folder}: {(error.strerror or str(error)).lower()}") from None
    points = tuple(
        SweepRowRecord(
            number=number,
            parameters=values,
            results=None if outcome.sample is None else outcome.sample["values"],
            problem=outcome.failed,
        )
        for number, (values, outcome) in enumerate(zip(combinations, outcomes, strict=True), 1)
    )
    pictures = tuple(None if each.sample is None else each.sample["picture"] for each in outcomes)
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
        why = refused.allowed.partition(";")[0]
        raise SweepError(f"{refused.field}: {why}; a sweep computes exact shapes with --exact")


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
