"""`asterism.sweep`: the shapes of many variants of one design, their numbers and small pictures, and its files."""

from __future__ import annotations

import csv
import io
import json
import pickle
import tempfile
from collections.abc import Callable, Mapping, Sequence
from contextlib import AbstractContextManager, nullcontext
from dataclasses import dataclass
from importlib.resources import files
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np

from asterism.equilibrium.arrays import Floats
from asterism.homogenize.campaign.kept_samples import KeptSamples, Outcome
from asterism.homogenize.campaign.workers import CampaignProgress, Finished, default_jobs, workers_for
from asterism.homogenize.law.law import Law
from asterism.homogenize.law.law_file import law_digest
from asterism.homogenize.law.plan import without_law
from asterism.pattern.design.design import Design
from asterism.pattern.design.entries import with_entries
from asterism.pattern.design.errors import check_type
from asterism.process.version import __version__
from asterism.reports.html import html_page
from asterism.results.files import SUMMARY_FILE, OutputError, staged_result
from asterism.results.records.fit import SweepColumnRecord, SweepParameterRecord, SweepRecord, SweepRowRecord
from asterism.sweeps.parameters import (
    SweepError,
    SweepParameter,
    check_parameters,
    grid,
    latin_hypercube,
    with_whole_ranges,
)
from asterism.sweeps.point import SmallPicture, named_law, quantities, solve_point, sweep_code_version

# values by path, or parameters
Vary = Mapping[str, str | Sequence[Any]] | Sequence[SweepParameter]


@dataclass(frozen=True)
class Sweep:
    """The result of `asterism.sweep`.

    Attributes
    ----------
    design : the design that was varied.
    parameters : what was varied.
    points : all designs in the order of their numbers: `number`, values of the `parameters` by path, values of the
        table's columns as `results`, and why a design has none, its `problem`.
    pictures : small pictures of their shapes; None without a shape.
    exact : the exact model computed the shapes, not the preview.
    seed : seed of the Latin hypercube; None for all combinations.
    law : digest of the law that was given; None for that of the design, or else the paper's.
    """

    design: Design
    parameters: tuple[SweepParameter, ...]
    points: tuple[SweepRowRecord, ...]
    pictures: tuple[SmallPicture | None, ...]
    exact: bool
    seed: int | None = None
    law: str | None = None

    @property
    def failed(self) -> int:
        """Number of designs without a shape."""
        return sum(point.problem is not None for point in self.points)

    @property
    def doubts(self) -> list[str]:
        """Why the table is not reliable, each reason once."""
        shapes = [point.results for point in self.points if point.results is not None]
        without = sum(not results["is_minimum"] for results in shapes)
        doubtful = sum(results["not_reliable"] is not None for results in shapes)
        counts = {"have no shape": self.failed, "have no certified shape": without, "are not reliable": doubtful}
        return [f"{count} of {len(self.points)} designs {what}" for what, count in counts.items() if count]

    def column(self, name: str) -> Floats:
        """(n,) values of a parameter or a column, one for each design; not a number where there is none.

        Raises
        ------
        SweepError
            There is no such column, or its values are texts.
        """
        names = [each.path for each in self.parameters] + [each.name for each in quantities(self.exact)]
        if name not in names:
            raise SweepError(f"{name}: no column of this sweep; there are {', '.join(names)}")
        given = [{**(point.results or {}), **point.parameters}.get(name) for point in self.points]
        try:
            return np.array([np.nan if value is None else value for value in given], dtype=float)
        except (TypeError, ValueError):
            raise SweepError(f"{name}: has values that are not numbers") from None

    def design_of(self, number: int) -> Design:
        """The design with this number, for `save_design`, `preview` or `simulate`.

        Raises
        ------
        SweepError
            There is no such number.
        DesignError
            The design is the reason of its failure.
        """
        if not 1 <= number <= len(self.points):
            raise SweepError(f"{number}: the designs of this sweep have numbers from 1 to {len(self.points)}")
        return Design.from_dict(with_entries(self.design.to_dict(), self.points[number - 1].parameters))

    @property
    def summary(self) -> SweepRecord:
        """The content of summary.json."""
        return SweepRecord(
            model=SweepRecord.model_name,
            by="exact" if self.exact else "preview",
            sampling="grid" if self.seed is None else "latin hypercube",
            seed=self.seed,
            parameters=[
                SweepParameterRecord(
                    path=each.path,
                    listed=list(each.values),
                    limits=None if each.limits is None else list(each.limits),
                )
                for each in self.parameters
            ],
            columns=[
                SweepColumnRecord(name=each.name, unit=each.unit, label=each.label) for each in quantities(self.exact)
            ],
            table_rows=list(self.points),
            law=self.law,
            version=__version__,
            design=self.design.to_dict(),
        )


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

    Raises SweepError: the message names exact shapes as the way.
    """
    if exact or design.rods is None or (refused := without_law(design)) is None:
        return
    if refused.field.split(".")[0] in ("rods", "stars"):
        why = refused.allowed.partition(";")[0]
        raise SweepError(f"{refused.field}: {why}; a sweep computes exact shapes with --exact")


def sweep_parameters(design: Design, vary: Vary) -> tuple[SweepParameter, ...]:
    """The parameters of a sweep, checked against the design.

    Raises SweepError: as `sweep_design`.
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


def sampled(parameters: Sequence[SweepParameter], samples: int | None, seed: int = 0) -> list[dict[str, Any]]:
    """Values of the parameters by path for each design; errors as of `grid` and `latin_hypercube`."""
    return grid(parameters) if samples is None else latin_hypercube(parameters, samples, seed)


SWEEP_PAGE = "sweep.html"


def write_sweep(sweep: Sweep, directory: str | Path) -> list[str]:
    """Write the files of a sweep into a directory; they appear together, or none of them if writing fails.

    Returns
    -------
    Names of the files.

    Raises
    ------
    OutputError
        They cannot be written there.
    """
    check_type(sweep, Sweep, "sweep makes one")
    with staged_result(directory) as folder:
        (folder / "sweep.csv").write_text(sweep_csv(sweep), encoding="utf-8", newline="\n")
        (folder / SWEEP_PAGE).write_text(sweep_page(sweep), encoding="utf-8")
        (folder / SUMMARY_FILE).write_text(sweep.summary.json_text(), encoding="utf-8")
        return sorted(file.name for file in folder.iterdir())


def sweep_csv(sweep: Sweep) -> str:
    """The table: number, parameters, quantities, problem. An unknown value is an empty cell."""
    names = [each.name for each in quantities(sweep.exact)]
    stream = io.StringIO()
    table = csv.writer(stream, lineterminator="\n")
    table.writerow(["number", *(each.path for each in sweep.parameters), *names, "problem"])
    for point in sweep.points:
        values = point.results or {}
        given = [point.parameters[each.path] for each in sweep.parameters]
        table.writerow(map(_cell, [point.number, *given, *(values.get(name) for name in names), point.problem]))
    return stream.getvalue()


def sweep_page(sweep: Sweep) -> str:
    """The page as HTML without references to other files."""
    page = files("asterism.sweeps") / "page"
    summary = sweep.summary.to_json()
    data = {
        "name": sweep.design.name,
        "about": _about(sweep),
        "sampling": summary["sampling"],
        "parameters": summary["parameters"],
        "columns": summary["columns"],
        "rows": [
            row | {"picture": picture} for row, picture in zip(summary["table_rows"], sweep.pictures, strict=True)
        ],
    }
    # a text in the data must not end the script
    text = json.dumps(data, ensure_ascii=False, allow_nan=False).replace("<", "\\u003c")
    colours = files("asterism.studio") / "page" / "colours.css"
    style, body, *scripts = (
        (page / name).read_text(encoding="utf-8")
        for name in ("sweep.css", "sweep.html", "data.js", "plot.js", "cards.js", "main.js")
    )
    parts = [
        f'{body}<script id="data" type="application/json">{text}</script>\n<script>\n"use strict";',
        "\n".join(scripts) + "</script>",
    ]
    return html_page(f"{sweep.design.name}: sweep", parts, "\n" + colours.read_text(encoding="utf-8") + style)


def _about(sweep: Sweep) -> str:
    count = len(sweep.points)
    failed = f", {sweep.failed} without a shape" if sweep.failed else ""
    by = "exact model" if sweep.exact else "preview"
    how = "all combinations" if sweep.seed is None else f"Latin hypercube, seed {sweep.seed}"
    return f"{count} designs by the {by}{failed}; {how} of {', '.join(each.path for each in sweep.parameters)}."


def _cell(value: Any) -> Any:
    if value is None:
        return ""
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, str) and value.startswith(("=", "+", "-", "@")):
        return f"'{value}"  # a text: a spreadsheet would compute it
    return json.dumps(value) if isinstance(value, list | dict) else value
