"""The quantities of a sweep's table: numbers of each shape, by the names of its summary."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

from asterism.results.words import doubts

# digits of the numbers in a table: libraries on other machines differ in later ones
TABLE_DIGITS = 6

CellValue = float | int | bool | str | None


@dataclass(frozen=True)
class Quantity:
    """A column of the table.

    Attributes
    ----------
    name : name of the column.
    unit : unit; empty for counts, ratios and texts.
    label : its words on the page.
    of : gives the value from the summary of a shape; None if the summary lacks it.
    """

    name: str
    unit: str
    label: str
    of: Callable[[Mapping[str, Any]], CellValue]


def _key(name: str, unit: str, label: str) -> Quantity:
    return Quantity(name, unit, label, lambda summary: summary.get(name))


def _extent(axis: int, name: str) -> Quantity:
    return Quantity(f"extent_{name}_mm", "mm", f"extent along {name}", lambda summary: summary["extent_mm"][axis])


_SHAPE = (
    _key("height_mm", "mm", "height"),
    _key("above_needles_mm", "mm", "rise over the needles"),
    _key("below_needles_mm", "mm", "depth below the needles"),
    _extent(0, "x"),
    _extent(1, "y"),
    _extent(2, "z"),
    _key("contraction", "", "contraction"),
    _key("roll_radius_mm", "mm", "radius of the roll"),
    _key("roll_axis_deg", "deg", "axis of the roll"),
    _key("energy_n_mm", "N mm", "energy"),
    _key("is_minimum", "", "certified equilibrium"),
    _key("self_intersections", "", "self-intersections"),
)
_PREVIEW = (
    _key("expected_rms_percent", "% of the diameter", "estimated error"),
    _key("expected_height_percent", "% of the height", "estimated error of the height"),
    Quantity("stars_outside_law", "", "stars outside the law", lambda summary: len(summary["stars_outside_law"])),
)
_EXACT = (
    Quantity("minima", "", "minima", lambda summary: len(summary["minima"])),
    _key("stars_up", "", "stars up"),
    _key("smallest_eigenvalue", "N/mm", "smallest eigenvalue"),
    _key("mesh_error_percent", "% of the diameter", "mesh error"),
    _key("mesh_change_percent", "% of the diameter", "change from the coarser mesh"),
)
_WORDS = (
    Quantity("not_reliable", "", "not reliable", lambda summary: "; ".join(doubts(summary)) or None),
    Quantity("warnings", "", "warnings", lambda summary: "; ".join(summary["warnings"]) or None),
)


def quantities(exact: bool) -> tuple[Quantity, ...]:
    """The columns after the parameters, of exact shapes or of previews."""
    return (*_SHAPE, *(_EXACT if exact else _PREVIEW), *_WORDS)


def table_values(summary: Mapping[str, Any], exact: bool) -> dict[str, CellValue]:
    """The values of a shape by column, with `TABLE_DIGITS` digits."""
    return {each.name: _rounded(each.of(summary)) for each in quantities(exact)}


def _rounded(value: CellValue) -> CellValue:
    return float(f"{value:.{TABLE_DIGITS}g}") if isinstance(value, float) else value
