"""The reference of all keys of all summaries, as Markdown: `python -m asterism.results.reference`."""

from __future__ import annotations

from collections.abc import Iterator
from types import NoneType, UnionType
from typing import Any, Union, get_args, get_origin

from asterism.results.record import Record, is_record, keys_of, value_types
from asterism.results.records.comparison import OutlineComparisonRecord, ScanComparisonRecord
from asterism.results.records.exact import ExactRecord
from asterism.results.records.export import ExportRecord
from asterism.results.records.fit import FitRecord
from asterism.results.records.law import LawRecord
from asterism.results.records.preview import PreviewRecord
from asterism.results.records.strips import StripFitRecord
from asterism.results.records.sweep import SweepRecord
from asterism.results.records.verification import VerificationRecord

# title and introduction of each summary
SUMMARIES: dict[type[Record], tuple[str, str]] = {
    ExactRecord: ("Exact shape", "`summary.json` of `asterism simulate`, and `shape.summary` of `asterism.simulate`."),
    PreviewRecord: ("Preview", "`summary.json` of `asterism preview`, and `shape.summary` of `asterism.preview`."),
    VerificationRecord: (
        "Verification",
        "`summary.json` of `asterism verify`, and `verification.summary` of `asterism.verify`.",
    ),
    ScanComparisonRecord: (
        "Comparison with a scan",
        "`summary.json` of `asterism compare` for a scan in space, and `comparison.summary` of `asterism.compare`.",
    ),
    OutlineComparisonRecord: (
        "Comparison with an outline",
        "`summary.json` of `asterism compare` for an outline from a photograph.",
    ),
    ExportRecord: ("Export", "`export.json` of `asterism export`, and `exported.summary` of `asterism.export`."),
    StripFitRecord: (
        "Fit of strips",
        "The JSON file beside the material of `asterism strips fit`, and `material.summary` of `asterism.fit_strips`.",
    ),
    FitRecord: ("Fit to a target", "`summary.json` of `asterism fit`, and `fit.summary` of `asterism.fit`."),
    SweepRecord: ("Sweep", "`summary.json` of `asterism sweep`, and `sweep.summary` of `asterism.sweep`."),
    LawRecord: ("Law", "`summary.json` of `asterism law show`."),
}
_NAMES = {str: "text", int: "integer", float: "number", bool: "true or false", NoneType: "null", Any: "any"}


def reference() -> str:
    """The whole page. A record that several summaries contain is described at its first place."""
    parts = ["# Keys of all summaries", "Values without a unit are texts, counts or ratios."]
    described = set(SUMMARIES)
    for record, (title, text) in SUMMARIES.items():
        parts += [f"## {title}", text, _table(record)]
        for inner in _inner_records(record):
            if inner not in described:
                described.add(inner)
                parts += [f"### {_name(inner)}", _first_line(inner), _table(inner)]
    return "\n\n".join(parts) + "\n"


def all_records() -> list[type[Record]]:
    """All classes of records, each once."""
    return list(dict.fromkeys(each for record in SUMMARIES for each in (record, *_inner_records(record))))


def _table(record: type[Record]) -> str:
    types = value_types(record)
    lines = ["| key | unit | type | meaning |", "|---|---|---|---|"]
    for name, key in keys_of(record).items():
        kind = _in_words(types[name]) + ("" if key.is_required else ", optional")
        lines.append(f"| `{name}` | {key.unit} | {kind} | {key.meaning} |")
    return "\n".join(lines)


def _inner_records(record: type[Record]) -> Iterator[type[Record]]:
    """The classes of records within a record, at any depth, each once."""
    seen: dict[type[Record], None] = {}

    def visit(kind: Any) -> None:
        if is_record(kind):
            if kind not in seen:
                seen[kind] = None
                for each in value_types(kind).values():
                    visit(each)
        else:
            for each in get_args(kind):
                visit(each)

    for kind in value_types(record).values():
        visit(kind)
    yield from seen


def _in_words(kind: Any) -> str:
    if get_origin(kind) in (Union, UnionType):
        return " or ".join(map(_in_words, get_args(kind)))
    if get_origin(kind) is list:
        return f"list of {_in_words(get_args(kind)[0])}"
    if get_origin(kind) is dict:
        return f"table of {_in_words(get_args(kind)[1])}"
    if not is_record(kind):
        return _NAMES.get(kind, str(kind))
    title = SUMMARIES[kind][0] if kind in SUMMARIES else _name(kind)
    return f"[{title}](#{title.lower().replace(' ', '-')})"


def _name(record: type[Record]) -> str:
    """The name of a class of records in small letters: `path step record`."""
    name = "".join(f" {letter.lower()}" if letter.isupper() else letter for letter in record.__name__)
    return name.strip()


def _first_line(record: type[Record]) -> str:
    return (record.__doc__ or "").strip().split("\n")[0]


if __name__ == "__main__":
    print(reference(), end="")
