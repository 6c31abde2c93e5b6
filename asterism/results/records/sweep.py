"""The summary of a sweep."""

from __future__ import annotations

from typing import Any, ClassVar

from asterism.results.record import Record, key


class SweepParameterRecord(Record):
    """A parameter of a sweep."""

    path: str = key("Dotted path of the entry in the design.")
    listed: list[Any] = key("Its listed values; empty for a range.")
    limits: list[float] | None = key("Smallest and largest value of a range; null for listed values.")


class SweepColumnRecord(Record):
    """A column of the table of a sweep."""

    name: str = key("Name of the column.")
    unit: str = key("Unit; empty for counts, ratios and texts.")
    label: str = key("The column in words.")


class SweepRowRecord(Record):
    """One design of a sweep."""

    number: int = key("Number of the design, from 1.")
    parameters: dict[str, Any] = key("Values of the parameters by path.")
    results: dict[str, Any] | None = key("Values of the other columns by name; null for a design without a shape.")
    problem: str | None = key("Why the design has no shape; null if it has one.")


def _failed(record: SweepRecord) -> str:
    count = sum(row.problem is not None for row in record.table_rows)
    return f"{len(record.table_rows)}, of which {count} failed" if count else f"{len(record.table_rows)}"


class SweepRecord(Record):
    """The summary of a sweep."""

    model_name = "sweep"
    rows: ClassVar = {
        "table_rows": ("designs", _failed),
        "sampling": ("sampling", "{sampling}"),
        "by": ("shapes by", "{by}"),
        "parameters": ("parameters", lambda record: ", ".join(each.path for each in record.parameters)),
    }
    last = ("table_rows", "version", "design")

    model: str = key("`sweep`.")
    by: str = key("The model of the shapes: `preview` or `exact`.")
    sampling: str = key("`grid` for all combinations, or `latin hypercube`.")
    seed: int | None = key("Seed of the Latin hypercube; null for a grid.")
    parameters: list[SweepParameterRecord] = key("The parameters.")
    columns: list[SweepColumnRecord] = key("The columns of the table after the number and the parameters.")
    table_rows: list[SweepRowRecord] = key("The designs.")
    law: str | None = key("Digest of the law of the previews; null for exact shapes, and if none was given.")
    version: str = key("Version of asterism.")
    design: dict[str, Any] = key("The design that is varied, with all defaults.")
