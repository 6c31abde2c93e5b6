"""All that is known about a shape at rest, as a message."""

from __future__ import annotations

from collections.abc import Sequence

from asterism.previews.session import Preview
from asterism.results.records.preview import OtherFormRecord
from asterism.results.words import VISIBLE_SAG_MM, PlacedWarning
from asterism.shape.shape import Shape
from asterism.studio.messages import Form, Notice, ShapeSummary, sites_of

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
    "law_in_range",
    "stars_outside_law",
    "side",
    "stars",
    "energy_n_mm",
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
    below = numbers["below_needles_mm"]
    numbers["below_needles_mm"] = below if below is not None and below > VISIBLE_SAG_MM else None
    return ShapeSummary(seq, numbers, tuple(notices), tuple(forms))


def exact_summary(shape: Shape) -> ShapeSummary:
    """The same of an exact shape."""
    numbers = {key: shape.summary.get(key) for key in SUMMARY_KEYS}
    return ShapeSummary(0, numbers, tuple(Notice(str(line)) for line in shape.summary["warnings"]))


def blank_summary(seq: int) -> ShapeSummary:
    """The same of a sheet without stars."""
    numbers = {**dict.fromkeys(SUMMARY_KEYS), "height_mm": 0.0, "is_minimum": True, "stars": 0}
    return ShapeSummary(
        seq,
        numbers,
        (Notice("the sheet has no stars: it is flat fabric, shown as it is when it is released, without pins"),),
    )
