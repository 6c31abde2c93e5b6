"""Records: the numbers of a result, as typed keys with a meaning.

One definition gives the type of a key, its entry in the JSON file and its line in the reference of all keys. The unit
is in the name of the key (`height_mm`), or in its meaning.
"""

from __future__ import annotations

import json
import math
from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import MISSING, dataclass, field, fields
from functools import cache
from types import UnionType
from typing import Any, ClassVar, Self, Union, dataclass_transform, get_args, get_origin, get_type_hints

# the text of a row of the table on the terminal: a format with names of keys, such as `{height_mm:.2f} mm`, or a
# function of the record. It returns the text, or several rows as texts by label, or None to leave the row out.
Show = str | Callable[[Any], str | Mapping[str, str] | None]
# default of an optional key
ABSENT: Any = object()


def key(meaning: str, *, default: Any = MISSING, default_factory: Any = MISSING) -> Any:
    """Declare a key of a record; its meaning is one sentence or two for the reference.

    With `default=ABSENT` a record may lack the key: it then has neither the attribute nor the entry.
    """
    if default is ABSENT:  # a default would become an attribute of the class, a factory does not
        meaning, default, default_factory = f"{meaning} Optional.", MISSING, lambda: ABSENT
    return field(metadata={"meaning": meaning}, default=default, default_factory=default_factory)


@dataclass_transform(frozen_default=True, kw_only_default=True, eq_default=False, field_specifiers=(key,))
class Record(Mapping[str, Any]):
    """Base of all records: a frozen dataclass that is also a mapping.

    An attribute (`record.law.material`) has the declared type. An entry (`record["law"]["material"]`) is plain data, as
    in the JSON file. A record that was read from a file of another version may lack keys, and it keeps keys that are
    not declared.

    Attributes
    ----------
    model_name : value of the key `model` that marks records of this class in files; empty if they have no such key.
    rows : label and text of the row of a key in the table on the terminal, in the table's order.
    last : keys that come last in the file, such as the long ones.

    Examples
    --------
    >>> class Size(Record):
    ...     rows = {"height_mm": ("height", "{height_mm:.2f} mm")}
    ...     height_mm: float = key("Extent along z.")
    ...     mass_g: float = key("Mass of the plastic.", default=ABSENT)
    >>> size = Size(height_mm=7.0123)
    >>> size.height_mm, size["height_mm"], "mass_g" in size
    (7.0123, 7.0123, False)
    >>> size.table()
    {'height': '7.01 mm'}
    >>> Size.from_json(size.to_json()) == size
    True
    """

    model_name: ClassVar[str] = ""
    rows: ClassVar[Mapping[str, tuple[str, Show]]] = {}
    last: ClassVar[tuple[str, ...]] = ()

    def __init_subclass__(cls) -> None:
        super().__init_subclass__()
        dataclass(frozen=True, kw_only=True, eq=False, repr=False)(cls)

    def __post_init__(self) -> None:
        for name in [name for name, value in vars(self).items() if value is ABSENT]:
            del vars(self)[name]

    @classmethod
    def from_json(cls, data: Mapping[str, Any]) -> Self:
        """The record of a JSON object, of this or another version; entries of nested records become records."""
        record = cls.__new__(cls)
        types = value_types(cls)
        for name, value in data.items():
            vars(record)[name] = _typed(types.get(name), value)
        return record

    def to_json(self) -> dict[str, Any]:
        """Plain data for a JSON file; infinity and not-a-number become null."""
        return {name: _finite(value) for name, value in self.items()}

    def json_text(self) -> str:
        """The text of a JSON file."""
        return json.dumps(self.to_json(), indent=2, allow_nan=False) + "\n"

    def __or__(self, values: Mapping[str, Any]) -> Self:
        """A copy with other values of some keys, or with further keys."""
        return type(self).from_json({**vars(self), **values})

    def table(self, names: Iterable[str] | None = None) -> dict[str, str]:
        """Rows of the table on the terminal: texts by label. Keys that the record lacks have no row.

        `names`: keys whose rows are wanted; by default those of `rows`.
        """
        table: dict[str, str] = {}
        for name in self.rows if names is None else names:
            if name not in self:
                continue
            label, show = self.rows[name]
            if callable(show):
                shown = show(self)
            else:
                shown = "-" if self[name] is None else show.format_map(self)
            if shown is not None:
                table |= shown if isinstance(shown, Mapping) else {label: shown}
        return table

    def __getitem__(self, name: str) -> Any:
        return _plain(vars(self)[name])

    def __iter__(self) -> Iterator[str]:
        here = vars(self)
        declared = [name for name in keys_of(type(self)) if name in here]
        further = [name for name in here if name not in declared]
        yield from (name for name in [*declared, *further] if name not in self.last)
        yield from (name for name in self.last if name in here)

    def __len__(self) -> int:
        return len(vars(self))

    def __repr__(self) -> str:
        return f"{type(self).__name__}({', '.join(f'{name}={value!r}' for name, value in self.items())})"


@cache
def keys_of(record: type[Record]) -> dict[str, str]:
    """The meanings of the declared keys of a class of records, in their order."""
    return {each.name: each.metadata["meaning"] for each in fields(record)}  # type: ignore[arg-type]


@cache
def value_types(record: type[Record]) -> dict[str, Any]:
    """The types of the values of a class of records, by key."""
    return {name: kind for name, kind in get_type_hints(record).items() if name in keys_of(record)}


def is_record(kind: Any) -> bool:
    """Whether a type is a class of records."""
    return isinstance(kind, type) and issubclass(kind, Record)


def misfit(record: Record) -> str:
    """The first key whose value does not have the declared type; empty if all have it, or are missing."""
    types, here = value_types(type(record)), vars(record)
    return next((name for name, kind in types.items() if name in here and not _fits(kind, here[name])), "")


def _fits(kind: Any, value: Any) -> bool:
    origin, inner = get_origin(kind), get_args(kind)
    if kind is Any:
        return True
    if origin in (Union, UnionType):
        return any(_fits(each, value) for each in inner)
    if isinstance(value, Record):
        return is_record(kind) and not misfit(value)
    if origin is list:
        return isinstance(value, list | tuple) and all(_fits(inner[0], each) for each in value)
    if origin is dict:
        return isinstance(value, Mapping) and all(_fits(inner[1], each) for each in value.values())
    if kind in (int, float):
        return isinstance(value, (int, kind)) and not isinstance(value, bool)
    return isinstance(value, kind) if isinstance(kind, type) else True


def _typed(kind: Any, value: Any) -> Any:
    """A value from a file, with records in place of dictionaries; unchanged if it does not have the type.

    Null is not-a-number where a number must be.
    """
    if value is None and kind is float:
        return math.nan
    if value is None or isinstance(value, Record):
        return value
    if get_origin(kind) in (Union, UnionType):
        kinds = [each for each in get_args(kind) if each is not type(None)]
        records = [each for each in kinds if is_record(each)]
        if records and isinstance(value, Mapping):
            named = (each for each in records if each.model_name == value.get("model"))
            return next(named, records[0]).from_json(value)
        return _typed(kinds[0], value)
    if is_record(kind):
        return kind.from_json(value) if isinstance(value, Mapping) else value
    if get_origin(kind) is list and isinstance(value, list | tuple):
        return [_typed(get_args(kind)[0], each) for each in value]
    if get_origin(kind) is dict and isinstance(value, Mapping):
        return {name: _typed(get_args(kind)[1], each) for name, each in value.items()}
    return value


def _plain(value: Any) -> Any:
    """A value with dictionaries in place of records."""
    if isinstance(value, Record):
        return dict(value)
    if isinstance(value, Mapping) and any(isinstance(each, Mapping | list) for each in value.values()):
        return {name: _plain(each) for name, each in value.items()}
    if isinstance(value, list | tuple) and any(isinstance(each, Mapping | list) for each in value):
        return [_plain(each) for each in value]
    return value


def _finite(value: Any) -> Any:
    """Plain data with null in place of infinity and not-a-number, which JSON lacks."""
    if isinstance(value, Mapping):
        return {name: _finite(each) for name, each in value.items()}
    if isinstance(value, list | tuple):
        return [_finite(each) for each in value]
    return None if isinstance(value, float) and not math.isfinite(value) else value
