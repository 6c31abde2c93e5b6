"""Stars that are not on the side that the design asks for, in words."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any

from asterism.results.words import star_numbers


def off_branch(summary: Mapping[str, Any]) -> Iterator[str]:
    """A line, if there are such stars in an exact shape, from its summary."""
    if off := summary["stars_off_branch"]:
        stars = f"{len(off)} of {summary['stars_total']} stars of the exact shape"
        yield f"{stars} are not on the side that the design asks for: {star_numbers(off)}"
