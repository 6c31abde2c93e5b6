"""The parameters of a sweep: entries of a design by their dotted paths, and the values that each of them takes."""

from __future__ import annotations

import json
import math
import re
from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import product
from typing import Any

import numpy as np

from asterism.equilibrium.errors import Error
from asterism.pattern.design.design import Design
from asterism.pattern.design.entries import MAX_STEPS, with_entries
from asterism.pattern.design.errors import MUST_BE_WHOLE, DesignError
from asterism.pattern.design.files import is_deep

# designs of one sweep: the page with their pictures stays below 200 MB
MAX_POINTS = 10_000


class SweepError(Error, ValueError):
    """A parameter of a sweep is wrong; the message is one line with the parameter and what is allowed."""


# digits of equally spaced values: 0.2:0.6:9 gives 0.25, not 0.25000000000000006
VALUE_DIGITS = 12
# values of one parameter
MAX_VALUES = 10_000
GRAMMAR = "PATH=FROM:TO:COUNT or PATH=VALUE,VALUE; with a number of samples also PATH=FROM:TO"


@dataclass(frozen=True)
class SweepParameter:
    """An entry of a design that a sweep varies.

    Attributes
    ----------
    path : dotted path of the entry, such as `stars.thickness_mm` or `pins.0.scale`.
    values : the values, if they are listed.
    limits : the smallest and the largest value of a range, which only a Latin hypercube samples; otherwise None.
    whole : the range holds whole numbers only, because the entry is a count.
    """

    path: str
    values: tuple[Any, ...] = ()
    limits: tuple[float, float] | None = None
    whole: bool = False

    @classmethod
    def from_text(cls, text: str) -> SweepParameter:
        """A parameter from the words of a command line.

        Raises SweepError: the text has another form, or its range is empty.

        Examples
        --------
        >>> SweepParameter.from_text("stars.thickness_mm=0.2:0.6:5").values
        (0.2, 0.3, 0.4, 0.5, 0.6)
        >>> SweepParameter.from_text("border.rings=1:3:3").values
        (1, 2, 3)
        >>> SweepParameter.from_text("pins[0].scale=0.7,0.8")
        SweepParameter(path='pins.0.scale', values=(0.7, 0.8), limits=None, whole=False)
        """
        path, equals, given = text.partition("=")
        if not equals or not path.strip() or not given.strip():
            raise SweepError(f"--vary {text}: must be {GRAMMAR}")
        return cls.from_values(path.strip(), given.strip())

    @classmethod
    def from_values(cls, path: str, given: str | Sequence[Any]) -> SweepParameter:
        """A parameter from its values, or from the part of `from_text` after the equals sign."""
        path = _as_path(path)
        if path.count(".") >= MAX_STEPS:
            raise SweepError(f"{path[:60]}...: must have at most {MAX_STEPS} steps")
        if not isinstance(given, str):
            values = [value.item() if isinstance(value, np.generic) else value for value in given]
            return cls(path, _checked(path, values))
        ends = given.split(":")
        if len(ends) == 1 or given[0] in "[{\"'":
            return cls(path, _checked(path, _listed(path, given)))
        if len(ends) > 3:
            raise SweepError(f"{path}={given}: must be {GRAMMAR}")
        low, high = (_number(path, given, end) for end in ends[:2])
        if len(ends) == 2:
            if not low < high:
                raise SweepError(f"{path}={given}: an empty range, the first number must be below the second")
            return cls(path, limits=(low, high))
        return cls(path, _checked(path, _spaced(path, given, low, high, ends[2])))

    def at(self, part: float) -> Any:
        """The value at a part (0 to 1) of the range, or of the list."""
        if self.limits is None:
            return self.values[min(int(part * len(self.values)), len(self.values) - 1)]
        low, high = self.limits
        if self.whole:  # each number has an equal part of the range
            return min(int(low) + int(part * (high - low + 1)), int(high))
        return float(f"{low + part * (high - low):.{VALUE_DIGITS}g}")


def with_whole_ranges(design: Design, parameters: Sequence[SweepParameter]) -> tuple[SweepParameter, ...]:
    """The parameters; ranges of entries that take whole numbers only are ranges of whole numbers.

    Raises SweepError: such a range begins or ends with a fraction.
    """
    found = []
    for each in parameters:
        if each.limits and _is_count(design, each):
            low, high = each.limits
            if not (float(low).is_integer() and float(high).is_integer()):
                raise SweepError(f"{each.path}={low:g}:{high:g}: must be a range of whole numbers")
            each = replace(each, limits=(int(low), int(high)), whole=True)
        found.append(each)
    return tuple(found)


def _is_count(design: Design, parameter: SweepParameter) -> bool:
    """Whether the entry of a parameter refuses a fraction because it is none."""
    try:
        Design.from_dict(with_entries(design.to_dict(), {parameter.path: 0.5}))
    except DesignError as error:
        return error.allowed == MUST_BE_WHOLE and _as_path(error.field) == parameter.path
    return False


def check_parameters(design: Design, parameters: Sequence[SweepParameter]) -> None:
    """Refuse parameters that the design lacks, and values that an entry can never have.

    Raises SweepError: the message names the parameter, the value and what is allowed.
    """
    paths = [parameter.path for parameter in parameters]
    for path in paths:
        if paths.count(path) > 1:
            raise SweepError(f"{path}: is varied twice")
        if inside := next((other for other in paths if path.startswith(f"{other}.")), None):
            raise SweepError(f"{path}: is a part of {inside}, which is varied too")
    table = design.to_dict()
    for parameter in parameters:
        for value in parameter.limits or parameter.values:
            try:
                Design.from_dict(with_entries(table, {parameter.path: value}))
            except DesignError as error:
                if table.get(section := parameter.path.partition(".")[0]) is None and section in Design.model_fields:
                    given = "rods" if section == "stars" else "stars"
                    has = f"; it has [{given}]" if table.get(given) is not None else ""
                    raise SweepError(f"{parameter.path}: the design has no [{section}]{has}") from None
                # other entries may make the value possible: then its designs fail or not one by one
                field = _as_path(error.field)
                if parameter.path == field or parameter.path.startswith(f"{field}.") or field.startswith(
                    f"{parameter.path}."
                ) or "unknown key" in error.allowed:  # fmt: skip
                    raise SweepError(str(error)) from None


def _as_path(field: str) -> str:
    """`pins.0.scale` for `pins[0].scale`, as messages of designs name it."""
    return re.sub(r"\[(\d+)\]", r".\1", field)


def _number(path: str, given: str, text: str) -> float:
    try:
        number = float(text)
    except ValueError:
        number = np.nan
    if not np.isfinite(number):
        raise SweepError(f"{path}={given}: {text.strip()!r} is not a number; must be {GRAMMAR}")
    return number


def _spaced(path: str, given: str, low: float, high: float, count_text: str) -> list[Any]:
    count = int(count_text) if count_text.strip().isdigit() else 0
    if not 2 <= count <= MAX_VALUES:
        raise SweepError(f"{path}={given}: the third number counts values, it must be from 2 to {MAX_VALUES}")
    if low == high:
        raise SweepError(f"{path}={given}: an empty range")
    values = [float(f"{value:.{VALUE_DIGITS}g}") for value in np.linspace(low, high, count)]
    # whole numbers stay whole: some entries are counts
    is_whole = "." not in given and all(value.is_integer() for value in values)
    return [int(value) for value in values] if is_whole else values


def _listed(path: str, given: str) -> list[Any]:
    """Values that commas separate: numbers, true, false, JSON, or texts."""
    try:
        return list(json.loads(f"[{given}]"))
    except RecursionError:
        raise SweepError(f"{path}: is nested too deeply") from None
    except ValueError:
        values: list[Any] = []
        for text in given.split(","):
            try:
                values.append(json.loads(text))
            except ValueError:
                values.append(text.strip())
        return values


def _checked(path: str, values: Sequence[Any]) -> tuple[Any, ...]:
    if not values:
        raise SweepError(f"{path}: must have a value")
    if len(values) > MAX_VALUES:
        raise SweepError(f"{path}: must have at most {MAX_VALUES} values")
    for number, value in enumerate(values):
        if is_deep(value):
            raise SweepError(f"{path}: value {number + 1} is nested too deeply")
        if value == "":
            raise SweepError(f"{path}: value {number + 1} is empty")
        if value in values[:number]:
            raise SweepError(f"{path}: the value {value!r} is there twice")
    return tuple(values)


def grid(parameters: Sequence[SweepParameter]) -> list[dict[str, Any]]:
    """All combinations, by path; the last parameter varies fastest.

    Raises SweepError: a parameter is a range without a number of values, or there are more than `MAX_POINTS`
    combinations.

    Examples
    --------
    >>> grid([SweepParameter("a", (1, 2)), SweepParameter("b", (3, 4))])
    [{'a': 1, 'b': 3}, {'a': 1, 'b': 4}, {'a': 2, 'b': 3}, {'a': 2, 'b': 4}]
    """
    for each in parameters:
        if each.limits is not None:
            low, high = each.limits
            problem = "a range needs a number of values, FROM:TO:COUNT, or --samples for a Latin hypercube"
            raise SweepError(f"{each.path}={low:g}:{high:g}: {problem}")
    count = math.prod(len(each.values) for each in parameters)
    if count > MAX_POINTS:
        raise SweepError(f"{count} designs: must be at most {MAX_POINTS}; --samples takes some of the combinations")
    return [
        dict(zip((each.path for each in parameters), row, strict=True))
        for row in product(*(p.values for p in parameters))
    ]


def latin_hypercube(parameters: Sequence[SweepParameter], samples: int, seed: int) -> list[dict[str, Any]]:
    """So many designs, spread evenly over each parameter: in each of `samples` equal parts of a range lies one value.

    Reference: McKay, Beckman and Conover, A comparison of three methods for selecting values of input variables in the
    analysis of output from a computer code, 1979.

    Raises SweepError: the number of samples is out of range.
    """
    if not 2 <= samples <= MAX_POINTS:
        raise SweepError(f"--samples {samples}: must be from 2 to {MAX_POINTS}")
    from scipy.stats import qmc  # takes half a second to import

    parts = qmc.LatinHypercube(d=len(parameters), seed=np.random.default_rng(seed)).random(samples)
    return [{each.path: each.at(float(part)) for each, part in zip(parameters, row, strict=True)} for row in parts]
