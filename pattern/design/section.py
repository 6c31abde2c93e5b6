"""The base of all tables of the design file: known keys only, immutable, strict numbers."""

from __future__ import annotations

import difflib
from typing import Annotated, Any, Literal

import numpy as np
from pydantic import (
    AfterValidator,
    BaseModel,
    BeforeValidator,
    ConfigDict,
    Discriminator,
    Field,
    Strict,
    Tag,
    model_validator,
)
from pydantic_core import PydanticKnownError

from asterism.pattern.design.errors import DesignError

# range of densities; numbers from 0 to the lower bound are most likely in g/cm3
MIN_DENSITY_KG_M3 = 25.0
MAX_DENSITY_KG_M3 = 20_000.0
# larger numbers are mistakes, and their squares may overflow
MAX_NUMBER = 1e12


def is_whole(value: Any) -> bool:
    """Whether it is a whole number, of Python or of an array."""
    return isinstance(value, int | np.integer) and not isinstance(value, bool)


def _from_array(value: Any) -> Any:
    return int(value) if is_whole(value) else value


def _moderate(value: float) -> float:
    if abs(value) <= MAX_NUMBER:
        return value
    raise PydanticKnownError(
        *(("less_than_equal", {"le": MAX_NUMBER}) if value > 0 else ("greater_than_equal", {"ge": -MAX_NUMBER}))
    )


def _printable(text: str) -> str:
    if not text.isprintable():
        raise DesignError("", "must be one line of printable characters", text)
    return text


# strict: neither a bool nor a text passes for a number
Number = Annotated[float, Strict(), AfterValidator(_moderate)]
Whole = Annotated[int, Strict(), BeforeValidator(_from_array)]
Flag = Annotated[bool, Strict()]
Text = Annotated[str, Strict()]
Line = Annotated[Text, AfterValidator(_printable)]
Point = tuple[Number, Number]
Place = tuple[Number, Number, Number]
# face of the fabric on which the plastic is printed
Side = Literal["above", "below"]
# the sign of each in layouts; above by default
FACES: dict[Side | None, int] = {None: 1, "above": 1, "below": -1}


def _density(value: float) -> float:
    if 0 < value < MIN_DENSITY_KG_M3:
        hint = "; is it in g/cm3?" if value * 1000 <= MAX_DENSITY_KG_M3 else ""
        raise DesignError("", f"must be 0, or from {MIN_DENSITY_KG_M3:g} to {MAX_DENSITY_KG_M3:g} kg/m3{hint}", value)
    return value


def within(low: float, high: float, unit: str = "") -> AfterValidator:
    """Refuses a number or a tuple of numbers outside a range, which may be the same to both sides of 0."""

    def check(value: Any) -> Any:
        if not all(low <= each <= high for each in np.ravel(value)):
            limits = f"within {high:g}" if low == -high else f"from {low:g} to {high:g}"
            raise DesignError("", f"must be {limits}{unit}", value)
        return value

    return AfterValidator(check)


MassDensity = Annotated[Number, Field(ge=0, le=MAX_DENSITY_KG_M3), AfterValidator(_density)]


class Section(BaseModel):
    """A table of the design file."""

    model_config = ConfigDict(extra="forbid", frozen=True, allow_inf_nan=False)

    def _check_one_of(self, *names: str) -> None:
        """Refuse a table that has none of these keys, or several."""
        given = [name for name in names if getattr(self, name) is not None]
        if len(given) != 1:
            has = f", but has {' and '.join(given)}" if given else ""
            raise DesignError("", f"must have one of {', '.join(names[:-1])} and {names[-1]}{has}")

    @model_validator(mode="before")
    @classmethod
    def _known_keys_with_lists(cls, data: Any) -> Any:
        """Refuse unknown keys; arrays become lists."""
        if not isinstance(data, dict):
            return data
        known = [field.alias or name for name, field in cls.model_fields.items()]
        for key in data:
            if key not in known:
                near = difflib.get_close_matches(str(key), known, n=1)
                hint = f"did you mean {near[0]}?" if near else f"known here: {', '.join(known)}"
                raise DesignError(str(key), f"unknown key, {hint}", data[key])
        return {key: each.tolist() if isinstance(each, np.ndarray | np.generic) else each for key, each in data.items()}


def _is_list(value: Any) -> str:
    return "entry:many" if isinstance(value, list | tuple) else "entry:one"


# a number, or one for x and one for y
NumberOrPair = Annotated[
    Annotated[Number, Tag("entry:one")] | Annotated[Point, Tag("entry:many")], Discriminator(_is_list)
]
