"""The files of a sweep: summary.json, sweep.csv, and sweep.html with the pictures."""

from __future__ import annotations

import csv
import io
import json
from dataclasses import asdict
from html import escape
from importlib.resources import files
from pathlib import Path
from typing import Any

from asterism.pattern.design.arguments import check_type
from asterism.results.files import SUMMARY_FILE, staged_result
from asterism.sweeps.quantities import quantities
from asterism.sweeps.sweep import Sweep

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
            row | {"picture": None if picture is None else asdict(picture)}
            for row, picture in zip(summary["table_rows"], sweep.pictures, strict=True)
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
