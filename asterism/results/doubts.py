"""Reasons for which a certified result is still not reliable: `--strict` makes them exit status 1."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any


def doubts(summary: Mapping[str, Any]) -> list[str]:
    """The reasons in the summary of a preview, an exact shape or a verification, each once.

    >>> doubts({"model": "preview", "stars": 7, "stars_outside_law": ["star 0"] * 7, "self_intersections": 3})
    ['all 7 stars are outside the law', 'the sheet passes through itself (3 pairs of triangles)']
    """
    parts = (summary, *(summary[name] for name in ("preview", "exact") if isinstance(summary.get(name), Mapping)))
    return list(dict.fromkeys(line for part in parts for line in _of_shape(part)))


def _of_shape(summary: Mapping[str, Any]) -> Iterator[str]:
    stars, outside = summary.get("stars"), summary.get("stars_outside_law", ())
    if stars and isinstance(stars, int) and len(outside) >= stars:
        yield f"all {stars} stars are outside the law" if stars > 1 else "the star is outside the law"
    if pairs := summary.get("self_intersections"):
        yield f"the sheet passes through itself ({pairs} pairs of triangles)"
