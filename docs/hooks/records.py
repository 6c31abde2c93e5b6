"""Lists every key of every summary from the typed records, on the page that holds a line `<!-- records -->`."""

from __future__ import annotations

import re
from typing import Any, get_args, get_origin

from mkdocs.config.defaults import MkDocsConfig
from mkdocs.structure.files import Files
from mkdocs.structure.pages import Page

MARK = "<!-- records -->"
# by class: the title of a summary, and where it is
SUMMARIES = {
    "ExactRecord": ("Exact shape", "`asterism simulate`, and `shape.summary` of `asterism.simulate`"),
    "PreviewRecord": ("Preview", "`asterism preview`, and `shape.summary` of `asterism.preview`"),
    "VerificationRecord": ("Verification", "`asterism verify`, and `verification.summary` of `asterism.verify`"),
    "ScanComparisonRecord": (
        "Comparison with a scan",
        "`asterism compare` for a scan in space, and `comparison.summary` of `asterism.compare`",
    ),
    "OutlineComparisonRecord": (
        "Comparison with an outline",
        "`asterism compare` for an outline from a photograph, and `comparison.summary` of `asterism.compare`",
    ),
    "ExportRecord": ("Export", "`asterism export` (`export.json`), and `exported.summary` of `asterism.export`"),
    "StripFitRecord": (
        "Fit of strips",
        "`asterism strips fit` (beside the material), and `material.summary` of `asterism.fit_strips`",
    ),
    "FitRecord": ("Fit to a target", "`asterism fit`, and `fit.summary` of `asterism.fit`"),
    "SweepRecord": ("Sweep", "`asterism sweep`, and `sweep.summary` of `asterism.sweep`"),
    "LawRecord": ("Law", "`asterism law show`"),
}


def on_page_markdown(markdown: str, page: Page, config: MkDocsConfig, files: Files) -> str:
    """The page with a table of keys for each record."""
    return markdown.replace(MARK, reference()) if MARK in markdown else markdown


def reference() -> str:
    """A table for each class of records; one that several summaries contain stands at its first place."""
    from asterism.results.record import keys_of, value_types

    parts: list[str] = []
    described: set[type] = set()

    def describe(record: type[Any]) -> None:
        described.add(record)
        if record.__name__ in SUMMARIES:
            title, place = SUMMARIES[record.__name__]
            parts.extend([f"## {title}", f"The summary of {place}."])
        else:
            parts.extend([f"### {_title(record)}", (record.__doc__ or "").strip().split("\n")[0]])
        types = value_types(record)
        lines = [f"| `{name}` | {_in_words(types[name])} | {text} |" for name, text in keys_of(record).items()]
        parts.append("\n".join(["| key | type | meaning |", "|---|---|---|", *lines]))
        for inner in (each for kind in types.values() for each in _records(kind)):
            if inner not in described and inner.__name__ not in SUMMARIES:
                describe(inner)

    for record in _summaries():
        describe(record)
    return "\n\n".join(parts)


def _summaries() -> list[type[Any]]:
    """The classes of the summaries, in the order of the page."""
    from importlib import import_module
    from pkgutil import iter_modules

    from asterism.results import records

    modules = [import_module(f"{records.__name__}.{each.name}") for each in iter_modules(records.__path__)]
    known = {name: kind for module in modules for name, kind in vars(module).items()}
    return [known[name] for name in SUMMARIES]


def _records(kind: Any) -> list[type[Any]]:
    """The classes of records in the type of a key."""
    if not get_args(kind):
        return [kind] if getattr(kind, "__name__", "").endswith("Record") else []
    return [record for each in get_args(kind) for record in _records(each)]


def _in_words(kind: Any) -> str:
    """The type of a key: other records are links to their tables."""
    if not get_args(kind):
        if _records(kind):
            title = SUMMARIES[kind.__name__][0] if kind.__name__ in SUMMARIES else _title(kind)
            return f"[{title}](#{title.lower().replace(' ', '-')})"
        names = {str: "text", int: "integer", float: "number", bool: "true or false", type(None): "null"}
        return names.get(kind, "any")
    if get_origin(kind) is list:
        return f"list of {_in_words(get_args(kind)[0])}"
    if get_origin(kind) is dict:
        return f"table of {_in_words(get_args(kind)[1])}"
    return " or ".join(map(_in_words, get_args(kind)))


def _title(record: type[Any]) -> str:
    """The name of a class of records in small letters: `path step record`."""
    return re.sub("(?<!^)([A-Z])", r" \1", record.__name__).lower()
