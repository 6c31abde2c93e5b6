"""The settings of a job: one frozen dataclass for Python and the studio, from whose fields a command makes its options.

The type of a field may be annotated with the name of its option, such as `"--fabric"`, and with the limits of its
numbers, such as `(0.01, 50.0)`.
"""

from __future__ import annotations

from typing import Annotated, Any, Literal, get_args, get_origin, get_type_hints


def field_types(kind: type) -> dict[str, tuple[Any, list[str], list[tuple[float, float]]]]:
    """Of each field of a settings object its type, the names of its option (none: as the field), and its limits."""
    found = {}
    for field, given in get_type_hints(kind, include_extras=True).items():
        plain, *extra = get_args(given) if get_origin(given) is Annotated else (given,)
        names = [each for each in extra if isinstance(each, str)]
        found[field] = plain, names, [each for each in extra if isinstance(each, tuple)]
    return found


def check_settings(settings: Any) -> None:
    """Raise DesignError, with the name of the option, for a number beyond its limits or a word that is no choice."""
    for field, (plain, names, limits) in field_types(type(settings)).items():
        value, problem = getattr(settings, field), ""
        for low, high in limits:
            if value is not None and not (isinstance(value, int | float) and low <= value <= high):
                problem = f"must be from {low:g} to {high:g}"
        if plain in (int, int | None) and not isinstance(value, int | None):
            problem = "must be a whole number"
        if any(get_origin(one) is tuple for one in (plain, *get_args(plain))) and isinstance(value, str | float | int):
            problem = "must be a tuple"
        if get_origin(plain) is Literal and value not in get_args(plain):
            problem = f"must be {' or '.join(get_args(plain))}"
        if problem:
            from asterism.pattern.design.errors import DesignError

            raise DesignError((names or [f"--{field.replace('_', '-')}"])[0], problem, value)
