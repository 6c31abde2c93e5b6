"""Warning of stars that are not on the side that the design asks for."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any

from asterism.results.words import star_numbers


def off_branch(summary: Mapping[str, Any]) -> Iterator[str]:
    """Yield a line if the summary of an exact shape lists such stars."""
    if off := summary["stars_off_branch"]:
        stars = f"{len(off)} of {summary['stars_total']} stars of the exact shape"
        yield f"{stars} are not on the side that the design asks for: {star_numbers(off)}"
