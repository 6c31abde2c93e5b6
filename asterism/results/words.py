"""Numbers, warnings and doubts in words, for tables and reports."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from typing import Any

# a sheet that hangs less below the base of its needles counts as lying on it: about its own thickness
VISIBLE_SAG_MM = 0.5


def table_lines(rows: dict[str, str], column: int = 20) -> list[str]:
    """The rows of a table as lines of text; labels have `column` characters."""
    return [f"  {label:<{column}} {text}" for label, text in rows.items()]


def fixed_point(value: float, digits: int) -> str:
    """A number with so many digits after the point, without a minus before zeros."""
    text = f"{value:.{digits}f}"
    return text.removeprefix("-") if not text.strip("-0.") else text


def star_numbers(stars: Sequence[int]) -> str:
    """The numbers of stars; of many, the first ones."""
    numbers = ", ".join(map(str, stars[:8])) + (", ..." if len(stars) > 8 else "")
    return f"star{'s' if len(stars) > 1 else ''} {numbers}"


def direction(axis_deg: float) -> str:
    """A direction on the print in whole degrees from 0 to 179; 180 deg is the same direction as 0."""
    return str(round(axis_deg) % 180)


def roll(axis_deg: float | None, radius_mm: float | None) -> str:
    """The axis and the radius of a rolled sheet; a dash if the sheet is not rolled.

    >>> roll(30.2, 34.56), roll(30.2, None), roll(None, None)
    ('30 deg, radius 34.6 mm', '30 deg', '-')
    """
    if axis_deg is None:
        return "-"
    return f"{direction(axis_deg)} deg" + ("" if radius_mm is None else f", radius {radius_mm:.1f} mm")


def box_in_words(sizes_mm: Sequence[float]) -> str:
    """The sizes of a box."""
    return " x ".join(f"{size:.1f}" for size in sizes_mm) + " mm"


def height_error(percent: float, height_mm: float) -> str:
    """An error of a height in mm, and in percent unless it is larger than the height.

    >>> height_error(11.3, 7.0), height_error(150.0, 2.0)
    ('0.8 mm (11 %)', '3.0 mm')
    """
    return f"{percent / 100.0 * height_mm:.1f} mm" + (f" ({percent:.0f} %)" if percent <= 100.0 else "")


def distance_error(percent: float, diameter_mm: float | None) -> str:
    """An rms distance in percent of the diameter, and in mm if the diameter is known.

    >>> distance_error(0.81, 152.34), distance_error(0.81, None)
    ('0.8 % of the diameter of 152.3 mm: 1.2 mm', '0.8 % of the diameter')
    """
    text = f"{percent:.1f} % of the diameter"
    return text if diameter_mm is None else f"{text} of {diameter_mm:.1f} mm: {percent / 100.0 * diameter_mm:.1f} mm"


def small_percent(percent: float) -> str:
    """A difference in percent with one digit; below 0.01 % only the bound is stated.

    >>> small_percent(0.3), small_percent(0.0247), small_percent(1e-5)
    ('0.3 %', '0.02 %', 'below 0.01 %')
    """
    text = f"{percent:.1g}"
    return "below 0.01 %" if float(text) < 0.01 else f"{text} %"


def times(ratio: float) -> str:
    """A ratio of two durations; from 10 on as a whole number."""
    return f"{ratio:.0f}" if ratio >= 10.0 else f"{ratio:.2g}"


def needle_names(numbers: Sequence[int]) -> str:
    """The numbers of needles, with ranges.

    >>> needle_names([3]), needle_names([1, 4, 5, 6, 7])
    ('needle 3', 'needles 1, 4 to 7')
    """
    runs: list[list[int]] = []
    for number in sorted(numbers):
        if runs and number == runs[-1][-1] + 1:
            runs[-1].append(number)
        else:
            runs.append([number])
    texts = [f"{run[0]} to {run[-1]}" if len(run) > 2 else ", ".join(map(str, run)) for run in runs]
    return f"needle{'s' if len(numbers) > 1 else ''} {', '.join(texts)}"


def sag_in_words(below_mm: float, error_mm: float | None) -> str:
    """How far a sheet hangs below the base of its needles, with the estimated error if there is one."""
    error = "" if error_mm is None else f", give or take {error_mm:.1f} mm"
    return f"{below_mm:.1f} mm below the base{error}"


def shape_in_words(summary: Mapping[str, Any]) -> str:
    """The state of a shape: of which model it is, and how far it may be from the truth. The worst comes first.

    >>> shape_in_words({"model": "preview", "is_minimum": True, "expected_rms_percent": 1.52})
    'Preview, about 1.5 %'
    >>> shape_in_words({"model": "exact", "is_minimum": True, "mesh_error_percent": 0.7})
    'Exact, mesh error 0.7 %'
    >>> shape_in_words({"model": "exact", "is_minimum": False, "mesh_error_percent": 0.7})
    'Not an equilibrium'
    """
    if not summary.get("is_minimum"):
        return "Not an equilibrium"
    is_preview = summary.get("model") == "preview"
    percent = summary.get("expected_rms_percent" if is_preview else "mesh_error_percent")
    number = "unknown" if percent is None else "below 0.1 %" if percent < 0.05 else f"{percent:.1f} %"
    if is_preview:
        return "Preview" if percent is None else f"Preview, about {number}"
    return f"Exact, mesh error {number}"


def doubts(summary: Mapping[str, Any]) -> list[str]:
    """The reasons in the summary of a preview, an exact shape or a verification, each once.

    >>> doubts({"model": "preview", "stars": 7, "stars_outside_law": ["star 0"] * 7, "self_intersections": 3})
    ['all 7 stars are outside the law', 'the sheet passes through itself (3 crossings)']
    """
    lines = []
    for part in (summary, *(summary[name] for name in ("preview", "exact") if isinstance(summary.get(name), Mapping))):
        stars, outside = part.get("stars"), part.get("stars_outside_law", ())
        if stars and isinstance(stars, int) and len(outside) >= stars:
            lines.append(f"all {stars} stars are outside the law" if stars > 1 else "the star is outside the law")
        if pairs := part.get("self_intersections"):
            lines.append(passing(pairs))
    return list(dict.fromkeys(lines))


def passing(pairs: int) -> str:
    """Warning text for a number of pairs of triangles that pass through each other."""
    return f"the sheet passes through itself ({pairs} crossing{'s' * (pairs > 1)})"


class PlacedWarning(str):
    """The text of a warning, with the stars that it is about.

    `stars`: numbers of the stars.
    """

    stars: tuple[int, ...]

    def __new__(cls, text: str, stars: Iterable[int] = ()) -> PlacedWarning:
        warning = super().__new__(cls, text)
        warning.stars = tuple(int(star) for star in stars)
        return warning
