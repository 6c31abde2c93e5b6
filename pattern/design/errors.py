"""Errors in designs: one line with the file, the field, its value and what is allowed."""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path
from typing import Any

from pydantic import ValidationError

from asterism.equilibrium.errors import Error, one_line

_NOTHING: Any = object()
_MAX_VALUE_CHARACTERS = 60
MUST_BE_A_LIST = "must be a list"
MUST_BE_WHOLE = "must be a whole number"
NEEDS_STARS_ALONE = "previews and laws need [stars] alone; asterism simulate computes drawn rods"


class DesignError(Error, ValueError):
    """A design that cannot be read or printed. Its message is one line.

    Parameters
    ----------
    field : dotted, e.g. `stars.length_mm` or `pins[0].scale`; empty for the file as a whole.
    allowed : what is allowed, or what is wrong.
    value : the value in the design; optional.
    file : file of the design; optional.
    stars : numbers of the stars that the error is about.
    place_mm : printed place (2,) that the error is about; None if it has none.

    >>> str(DesignError("mesh.edge_mm", "must be at most 17.3", 40.0, "dome.toml"))
    'dome.toml: mesh.edge_mm = 40.0: must be at most 17.3'
    """

    def __init__(
        self,
        field: str,
        allowed: str,
        value: Any = _NOTHING,
        file: str | Path | None = None,
        stars: Iterable[int] = (),
        place_mm: Iterable[float] | None = None,
    ):
        self.field, self.allowed, self.value, self.file = field, allowed, value, file
        self.stars = tuple(int(star) for star in stars)
        self.place_mm = None if place_mm is None else tuple(float(part) for part in place_mm)
        place = field if value is _NOTHING else f"{field} = {_short(value)}" if field else _short(value)
        super().__init__(one_line(": ".join(part for part in (str(file or ""), place, allowed) if part)))

    def within(self, file: str | Path) -> DesignError:
        """The same error with the name of its file."""
        return type(self)(self.field, self.allowed, self.value, file, self.stars, self.place_mm)


class BlankSheetError(DesignError):
    """A sheet without a single arm to print; `asterism.shape.shape.blank_sheet` has its shape."""


def from_validation(error: ValidationError, file: str | Path | None = None, table: str = "") -> DesignError:
    """The first of pydantic's errors as a `DesignError`; `table` is the table of the file that was read."""
    first = error.errors(include_url=False)[0]
    context = first.get("ctx", {})
    field = _dotted((table, *first["loc"]) if table else first["loc"])
    if first["type"] == "missing":
        return DesignError(field, "is missing", file=file)
    if isinstance(cause := context.get("error"), DesignError):
        inner = ".".join(part for part in (field, cause.field) if part)
        return DesignError(inner, cause.allowed, cause.value, file, cause.stars, cause.place_mm)
    value, allowed = first["input"], _allowed(first["type"], context, first["msg"])
    if allowed == MUST_BE_A_LIST and isinstance(value, dict) and field in ("pins", "stars.override", "border.holes"):
        allowed += f"; a table in it begins with [[{field}]]"
    return DesignError(field, allowed, value, file)


_TEXTS = {
    "must be a number": ("float_type", "float_parsing"),
    MUST_BE_WHOLE: ("int_type", "int_from_float", "int_parsing", "int_parsing_size"),
    "must be true or false": ("bool_type", "bool_parsing"),
    "must be a text": ("string_type",),
    "must be a finite number": ("finite_number",),
    "must be at least {ge:g}": ("greater_than_equal",),
    "must be greater than {gt:g}": ("greater_than",),
    "must be at most {le:g}": ("less_than_equal",),
    "must be less than {lt:g}": ("less_than",),
    "must be {expected}": ("literal_error",),
    "must have at most {max_length} characters": ("string_too_long",),
    "must have at least {min_length} characters": ("string_too_short",),
    "must have at least {min_length} entries": ("too_short",),
    "must have at most {max_length} entries": ("too_long",),
    MUST_BE_A_LIST: ("tuple_type", "list_type"),
    "must be a table of keys and values": ("model_type", "dict_type", "model_attributes_type"),
}
_TEXT_OF = {kind: text for text, kinds in _TEXTS.items() for kind in kinds}


def _allowed(kind: str, context: dict[str, Any], message: str) -> str:
    allowed = _TEXT_OF[kind].format(**context) if kind in _TEXT_OF else message.removeprefix("Value error, ")
    # a comma in every number makes two of it
    if kind == "too_long" and context.get("actual_length") == 2 * context["max_length"]:
        allowed += "; decimals have a point"
    return allowed


def _dotted(location: tuple[int | str, ...]) -> str:
    """`stars.override[2].at_mm`; branches of a union (written `kind:name`) are left out."""
    field = ""
    for part in location:
        if isinstance(part, int):
            field += f"[{part}]"
        elif ":" not in part:
            field += f".{part}" if field else part
    return field


def _short(value: Any) -> str:
    try:
        text = repr(value)
    except (ValueError, RecursionError):  # integers of thousands of digits, recursive lists
        text = f"a {type(value).__name__}"
    return text if len(text) <= _MAX_VALUE_CHARACTERS else f"{text[: _MAX_VALUE_CHARACTERS - 3]}..."


class MeshError(Error, ValueError):
    """The layout cannot be meshed as asked; the message is one line."""


def check_type(given: Any, kind: type, hint: str) -> None:
    """Raise `TypeError` unless `given` is of the type `kind`; `hint` names where one comes from."""
    if not isinstance(given, kind):
        raise TypeError(f"a {kind.__name__} is needed, not {type(given).__name__}: {hint}")
