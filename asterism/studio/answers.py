"""What the processes say of a shape: numbers, warnings and forms, or the error in its place."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from asterism.equilibrium.errors import Error
from asterism.homogenize.errors import LawError
from asterism.pattern.design.design import Design
from asterism.pattern.design.errors import DesignError, MeshError
from asterism.pattern.layout.build import sheet_sites
from asterism.previews.session import Preview, SearchLimitError
from asterism.results.files import OutputError
from asterism.results.records.shape import OtherFormRecord
from asterism.results.words import VISIBLE_SAG_MM, PlacedWarning
from asterism.shape.shape import Shape
from asterism.studio.messages import Form, Notice, ShapeSummary, StudioProblem, mistake_parts, sites_of

UNEXPECTED = "error"


def engine_problem(seq: int, error: Exception, design: Design | None = None) -> StudioProblem:
    """The problem that an error is; the design's lattice sites take the place of the numbers of its stars."""
    kinds: dict[type[Exception], str] = {
        DesignError: "design",
        LawError: "law",
        MeshError: "mesh",
        SearchLimitError: "too long",
        OutputError: "output",
    }
    kind = next((kind for of, kind in kinds.items() if isinstance(error, of)), UNEXPECTED)
    text = str(error) if isinstance(error, Error) else f"{type(error).__name__}: {error}"
    rows = np.empty((0, 2)) if design is None or not getattr(error, "stars", ()) else sheet_sites(design)
    return StudioProblem(seq=seq, kind=kind, text=" ".join(text.split()), **mistake_parts(error, rows))


SUMMARY_KEYS = (
    "expected_rms_percent",
    "expected_height_percent",
    "height_mm",
    "above_needles_mm",
    "below_needles_mm",
    "extent_mm",
    "mesh_error_percent",
    "contraction",
    "roll_radius_mm",
    "is_minimum",
    "side",
)


def rest_summary(seq: int, preview: Preview, shape: Shape, others: Sequence[OtherFormRecord]) -> ShapeSummary:
    """Numbers and warnings of the shape that a preview shows, and its other forms."""
    sites = preview.sheet.layout.sheet_sites
    notices = [
        Notice(str(line), sites_of(sites, line.stars) if isinstance(line, PlacedWarning) else ())
        for line in shape.summary["warnings"]
    ]
    forms = [Form(index, form.start, 100.0 * form.gap, False) for index, form in enumerate(others)]
    if forms:
        # its index among the forms
        forms.insert(0, Form(-1, preview.equilibrium.guess, 0.0, True))
    numbers = {key: shape.summary.get(key) for key in SUMMARY_KEYS}
    if (numbers["below_needles_mm"] or 0.0) <= VISIBLE_SAG_MM:
        numbers["below_needles_mm"] = None
    return ShapeSummary(seq, numbers, tuple(notices), tuple(forms))


def exact_summary(shape: Shape) -> ShapeSummary:
    """The same of an exact shape."""
    numbers = {key: shape.summary.get(key) for key in SUMMARY_KEYS}
    return ShapeSummary(0, numbers, tuple(Notice(str(line)) for line in shape.summary["warnings"]))


def blank_summary(seq: int) -> ShapeSummary:
    """The same of a sheet without stars."""
    numbers = {**dict.fromkeys(SUMMARY_KEYS), "height_mm": 0.0, "is_minimum": True}
    text = "the sheet has no stars: it is flat fabric, shown as it is when it is released, without pins"
    return ShapeSummary(seq, numbers, (Notice(text),))
