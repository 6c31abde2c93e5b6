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

    Examples
    --------
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
    """A sheet without a single arm to print; `asterism.shape.blank_sheet` has its shape."""


def from_validation(error: ValidationError, file: str | Path | None = None) -> DesignError:
    """The first of pydantic's errors as a `DesignError`."""
    first = error.errors(include_url=False)[0]
    context = first.get("ctx", {})
    field = _dotted(first["loc"], context.get("key"))
    if first["type"] == "missing":
        return DesignError(field, "is missing", file=file)
    if isinstance(cause := context.get("error"), DesignError):
        inner = ".".join(part for part in (field, cause.field) if part)
        return DesignError(inner, cause.allowed, cause.value, file, cause.stars, cause.place_mm)
    value, allowed = context.get("value", first["input"]), _allowed(first["type"], context, first["msg"])
    if allowed == MUST_BE_A_LIST and isinstance(value, dict) and field in ("pins", "stars.override", "border.holes"):
        allowed += f"; a table in it begins with [[{field}]]"
    return DesignError(field, allowed, value, file)


def _allowed(kind: str, context: dict[str, Any], message: str) -> str:
    match kind:
        case "float_type" | "float_parsing":
            return "must be a number"
        case "int_type" | "int_from_float" | "int_parsing" | "int_parsing_size":
            return MUST_BE_WHOLE
        case "bool_type" | "bool_parsing":
            return "must be true or false"
        case "string_type":
            return "must be a text"
        case "finite_number":
            return "must be a finite number"
        case "greater_than_equal":
            return f"must be at least {context['ge']:g}"
        case "greater_than":
            return f"must be greater than {context['gt']:g}"
        case "less_than_equal":
            return f"must be at most {context['le']:g}"
        case "less_than":
            return f"must be less than {context['lt']:g}"
        case "literal_error":
            return f"must be {context['expected']}"
        case "string_too_long":
            return f"must have at most {context['max_length']} characters"
        case "string_too_short":
            return f"must have at least {context['min_length']} characters"
        case "too_short":
            return f"must have at least {context['min_length']} entries"
        case "too_long":
            # a comma in every number makes two of it
            commas = context.get("actual_length") == 2 * context["max_length"]
            return f"must have at most {context['max_length']} entries" + ("; decimals have a point" if commas else "")
        case "tuple_type" | "list_type":
            return MUST_BE_A_LIST
        case "model_type" | "dict_type" | "model_attributes_type":
            return "must be a table of keys and values"
        case _:
            return message.removeprefix("Value error, ")


def _dotted(location: tuple[int | str, ...], key: str | None) -> str:
    """`stars.override[2].at_mm`; branches of a union (written `kind:name`) are left out."""
    field = ""
    for part in (*location, *([key] if key is not None else [])):
        if isinstance(part, int):
            field += f"[{part}]"
        elif ":" not in part or part == key:
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
