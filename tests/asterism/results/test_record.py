"""Records: every key is documented, and every record survives its JSON file."""

from __future__ import annotations

import json
import math
from importlib import import_module
from pkgutil import iter_modules
from types import UnionType
from typing import Any, ClassVar, Union, get_args, get_origin

import pytest

from asterism.results import records
from asterism.results.record import ABSENT, Record, is_record, key, keys_of, misfit, value_types
from asterism.results.records.exact import ExactRecord
from asterism.results.records.shape import PreviewRecord
from asterism.shape.shape import shape_record

MODULES = [import_module(f"{records.__name__}.{each.name}") for each in iter_modules(records.__path__)]
RECORDS = list(
    dict.fromkeys(
        kind for module in MODULES for kind in vars(module).values() if is_record(kind) and kind is not Record
    )
)


def example(kind: Any) -> Any:
    """A value of a type, without its optional parts."""
    if get_origin(kind) in (Union, UnionType):
        return example(get_args(kind)[0])
    if is_record(kind):
        return kind.from_json({name: example(each) for name, each in value_types(kind).items()})
    if get_origin(kind) is list:
        return [example(get_args(kind)[0])]
    if get_origin(kind) is dict:
        return {"name": example(get_args(kind)[1])}
    return {str: "text", int: 3, float: 0.1, bool: True}.get(kind)


@pytest.mark.parametrize("kind", RECORDS, ids=lambda kind: kind.__name__)
def test_a_record_survives_its_file(kind: type[Record]) -> None:
    record = example(kind)
    again = kind.from_json(json.loads(json.dumps(record.to_json(), allow_nan=False)))
    assert again == record
    assert {name: type(value) for name, value in vars(again).items()} == {n: type(v) for n, v in vars(record).items()}
    assert set(again) == set(keys_of(kind)) and set(kind.rows) <= set(again)
    json.dumps(dict(again))  # entries are plain data
    assert all(meaning.endswith((".", ")")) for meaning in keys_of(kind).values())


class Inner(Record):
    size_mm: float = key("Size.")


class Outer(Record):
    last = ("text",)
    text: str = key("A text.")
    inner: Inner | None = key("A record.")
    more: dict[str, list[Inner]] = key("Records.", default=ABSENT)
    count: int = key("A number.")
    rows: ClassVar = {"count": ("count", "{count} of {text}")}


def test_files_of_other_versions_are_read() -> None:
    """Keys may be missing or unknown, and values of another kind."""
    record = Outer.from_json({"inner": {"size_mm": 2.0}, "more": {"a": [{"size_mm": 1.0}, 7]}, "unknown": [1]})
    assert record.inner is not None and record.inner.size_mm == 2.0
    assert record.more["a"][0].size_mm == 1.0 and record["more"] == {"a": [{"size_mm": 1.0}, 7]}
    assert record["unknown"] == [1] and list(record) == ["inner", "more", "unknown"]
    assert "count" not in record and record.get("count") is None and not hasattr(record, "count")
    assert record.table() == {}
    assert Outer.from_json({"inner": 3}).inner == 3


def test_a_record_is_changed_in_a_copy() -> None:
    record = Outer(text="all", inner=None, count=3)
    assert "more" not in record and list(record) == ["inner", "count", "text"]
    assert record.table() == {"count": "3 of all"} and (record | {"count": None}).table() == {"count": "-"}
    changed = record | {"inner": {"size_mm": 1.0}}
    assert changed.inner == Inner(size_mm=1.0) and record.inner is None
    with pytest.raises(AttributeError):
        record.count = 4  # type: ignore[misc]


def test_numbers_that_json_lacks_become_null_which_fits_numbers_and_what_may_be_missing() -> None:
    assert Inner(size_mm=float("nan")).to_json() == {"size_mm": None}
    assert math.isnan(Inner.from_json({"size_mm": None}).size_mm)
    assert misfit(Outer.from_json({"text": "a", "inner": None, "more": {"a": [{"size_mm": None}]}})) == ""
    assert misfit(Outer.from_json({"text": None})) == "text" and misfit(Outer.from_json({"count": None})) == "count"


def test_the_model_decides_on_the_record_of_a_shape() -> None:
    assert isinstance(shape_record({"model": "preview"}), PreviewRecord)
    assert isinstance(shape_record({"model": "exact"}), ExactRecord) and isinstance(shape_record({}), ExactRecord)
