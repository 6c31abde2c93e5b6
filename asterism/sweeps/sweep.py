"""The result of a sweep: designs, numbers and small pictures, and its files."""

from __future__ import annotations

import csv
import io
import json
from dataclasses import dataclass
from html import escape
from importlib.resources import files
from pathlib import Path
from typing import Any

import numpy as np

from asterism.equilibrium.arrays import Floats
from asterism.pattern.design.arguments import check_type
from asterism.pattern.design.design import Design
from asterism.pattern.design.entries import with_entries
from asterism.process.version import __version__
from asterism.results.files import SUMMARY_FILE, staged_result
from asterism.results.records.sweep import SweepColumnRecord, SweepParameterRecord, SweepRecord, SweepRowRecord
from asterism.sweeps.parameters import SweepError, SweepParameter
from asterism.sweeps.solve_point import SmallPicture, quantities


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
    style, body, *scripts = (
        (page / name).read_text(encoding="utf-8")
        for name in ("sweep.css", "sweep.html", "data.js", "plot.js", "cards.js", "main.js")
    )
    return (
        '<!DOCTYPE html>\n<html lang="en">\n<head>\n<meta charset="utf-8">\n'
        '<meta name="viewport" content="width=device-width, initial-scale=1">\n'
        f"<title>{escape(sweep.design.name)}: sweep</title>\n<style>\n{style}</style>\n</head>\n<body>\n{body}"
        f'<script id="data" type="application/json">{text}</script>\n<script>\n"use strict";\n'
        + "\n".join(scripts)
        + "</script>\n</body>\n</html>\n"
    )


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
