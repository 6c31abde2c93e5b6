"""Errors of the computation as messages for the page."""

from __future__ import annotations

from typing import Any

from asterism.previews.watch import SearchLimitError
from asterism.studio.messages import StudioProblem, sites_of
from homogenize.errors import LawError
from pattern.design.design import Design
from pattern.design.errors import DesignError, MeshError
from pattern.layout.build import sheet_sites

PROBLEM_KINDS: dict[type[Exception], str] = {
    DesignError: "design",
    LawError: "law",
    MeshError: "mesh",
    SearchLimitError: "too long",
}
UNEXPECTED = "error"


def engine_problem(seq: int, error: Exception, design: Design | None = None) -> StudioProblem:
    """The problem that an error is; the design's lattice sites take the place of the numbers of its stars."""
    kind = next((kind for of, kind in PROBLEM_KINDS.items() if isinstance(error, of)), UNEXPECTED)
    text = str(error) if kind != UNEXPECTED else f"{type(error).__name__}: {error}"
    stars, place = getattr(error, "stars", ()), getattr(error, "place_mm", None)
    return StudioProblem(
        seq=seq,
        kind=kind,
        text=" ".join(text.split()),
        field=str(getattr(error, "field", "")),
        value=_shown(getattr(error, "value", "")),
        allowed=str(getattr(error, "allowed", "")),
        stars=sites_of(sheet_sites(design), stars) if stars and design is not None else (),
        at_mm=place if place is None else (float(place[0]), float(place[1])),
    )


def _shown(value: Any) -> str:
    return str(value) if isinstance(value, str | int | float | list | tuple) else ""
