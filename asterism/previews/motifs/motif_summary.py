"""The summary of the preview of a motif, and its warnings."""

from __future__ import annotations

from collections.abc import Iterator

from scipy.spatial import cKDTree

from asterism.fem.search.relax import is_collapsing
from asterism.pattern.layout.roll_axis import roll_axis_from_normals
from asterism.pattern.mesh.mesh import Mesh
from asterism.previews.common_warnings import form_warnings, shape_warnings, side_warnings, support_warnings
from asterism.previews.motifs.motif_cover import holes_within_cells
from asterism.previews.state import AnyPreviewState
from asterism.previews.summary import common_numbers, count_crossings
from asterism.previews.uncertainty.error_estimate import ErrorEstimate
from asterism.results.records.preview import PreviewRecord
from asterism.shape.shape import Shape

# largest Gaussian modulus over the one at which bending becomes indefinite without a warning
MAX_RIM_SHARE = 1.5


def motif_summary(
    state: AnyPreviewState, shape: Shape, mesh: Mesh, estimate: ErrorEstimate, seconds: dict[str, float]
) -> PreviewRecord:
    """The record of the preview of a motif. Keys that it shares with other records have the same meaning.

    Parameters
    ----------
    mesh : mesh of the shape.
    """
    layout, law, values = state.layout, state.law, state.values
    nearest = cKDTree(shape.printed).query(layout.sample_points)[1]
    axis = roll_axis_from_normals(layout, shape.point_fields["normal"][nearest])
    crossings = count_crossings(shape)
    numbers = common_numbers(state, shape, mesh, estimate, axis, seconds) | {
        "rods_total": len(layout.graph.rods),
        "law": {
            "material": law.plan.design.name,
            "stretch": float(state.design.fabric.stretch_xy[0]),
            "edge_mm": law.edge_mm,
            "made_by": law.made.get("command"),
            "graded": False,
        },
        "law_in_range": not values.outside,
        "stars_outside_law": [],
        "stars_tight": [],
        "stars_uneven": [],
        "smoothing_mm": 0.0,
        "self_intersections": crossings,
        "warnings": list(_warnings(state, estimate, axis, crossings, shape.height_mm)),
    }
    return PreviewRecord.from_json(numbers)


def _warnings(
    state: AnyPreviewState, estimate: ErrorEstimate, axis_deg: float | None, crossings: int, height_mm: float
) -> Iterator[str]:
    """One line each, in the order of their causes: motif, supports, equilibrium, other forms, shape."""
    values = state.values
    if values.outside:
        share = 100.0 * len(values.outside) / values.places
        yield (
            f"{share:.0f} % of the rods are outside the law's range, such as {values.outside[0]}; the preview "
            "takes the nearest size in the range"
        )
    collapses = is_collapsing(state.shell, state.equilibrium)
    if collapses:
        yield (
            "not an equilibrium: at wide rims the tension of the fabric bends the preview more than its rods resist; "
            "make the rods thicker or wider, or use the exact model: asterism simulate"
        )
    elif state.sheet.gaussian_share(values) > MAX_RIM_SHARE:
        yield (
            "the tension of the fabric at wide rims bends the sheet as much as its rods do, which the preview "
            "describes roughly; check with the exact model"
        )
    if cut := holes_within_cells(state.layout, state.design.border.tip_margin_mm):
        which = f"hole {cut[0]} is" if len(cut) == 1 else f"hole {cut[0]} and {len(cut) - 1} more are"
        yield (
            f"{which} smaller than a cell of the motif, with rods cut off there, which the preview describes roughly "
            "and its estimated error leaves out; check with the exact model"
        )
    yield from support_warnings(state, estimate, height_mm)
    yield from side_warnings(state)
    if not collapses:
        yield from form_warnings(state, estimate)
    yield from shape_warnings(state, axis_deg, crossings)
