"""Errors of the computation as messages for the page."""

from __future__ import annotations

import numpy as np

from asterism.equilibrium.errors import Error
from asterism.homogenize.errors import LawError
from asterism.pattern.design.design import Design
from asterism.pattern.design.errors import DesignError, MeshError
from asterism.pattern.layout.build import sheet_sites
from asterism.previews.session import SearchLimitError
from asterism.results.files import OutputError
from asterism.studio.messages import StudioProblem, mistake_parts

PROBLEM_KINDS: dict[type[Exception], str] = {
    DesignError: "design",
    LawError: "law",
    MeshError: "mesh",
    SearchLimitError: "too long",
    OutputError: "output",
}
UNEXPECTED = "error"


def engine_problem(seq: int, error: Exception, design: Design | None = None) -> StudioProblem:
    """The problem that an error is; the design's lattice sites take the place of the numbers of its stars."""
    kind = next((kind for of, kind in PROBLEM_KINDS.items() if isinstance(error, of)), UNEXPECTED)
    text = str(error) if isinstance(error, Error) else f"{type(error).__name__}: {error}"
    rows = np.empty((0, 2)) if design is None or not getattr(error, "stars", ()) else sheet_sites(design)
    return StudioProblem(seq=seq, kind=kind, text=" ".join(text.split()), **mistake_parts(error, rows))
