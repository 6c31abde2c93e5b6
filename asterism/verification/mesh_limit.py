"""The shape on an infinitely fine mesh by previews: one on the exact mesh beside one in the limit.

Both have the same error but for the mesh. Their distance estimates the mesh error of an exact shape of the same form,
also where its own meshes show none.
"""

from __future__ import annotations

import time
from dataclasses import replace

from asterism.equilibrium.errors import Error
from asterism.homogenize.law.law import Law
from asterism.pattern.design.design import Design
from asterism.pattern.layout.build import layout
from asterism.pattern.layout.layout import Layout
from asterism.pattern.layout.symmetries import symmetries
from asterism.previews.law_choice import LIMIT, has_edge, law_on_mesh, serving_law
from asterism.previews.model import PREVIEW_MODEL
from asterism.previews.run import preview
from asterism.results.records.shape import MeshLimitRecord
from asterism.shape.comparison import Comparison, compare_shapes
from asterism.shape.shape import Shape
from asterism.verification.numbers import alike, axes_apart_deg

# factor of the sixfold term that keeps the gallery's tube at its axis from edges of 1.92 mm to the limit; with the
# term itself the axis turns by 17 deg
AXIS_HOLD = 2.0
# axes of the two previews that are further apart are held
MAX_AXIS_TURN_DEG = 5.0


def mesh_limit(design: Design, law: Law, shown: Shape, plan: Layout) -> MeshLimitRecord | None:
    """What the limit of an infinitely fine mesh would be, beside a preview.

    Parameters
    ----------
    law : with its cells of other edges.
    shown : preview of the design on a mesh of finite edges.
    plan : layout of the design.

    Returns
    -------
    None if the law has no limit for these stars, or if the preview in the limit has another form. The axis of a roll is
    nearly neutral: if it differs, both previews are made again with a sixfold term that holds it.
    """
    begun = time.perf_counter()
    try:
        fine = law_on_mesh(law, design, plan, LIMIT)
        limit = preview(design, fine, plan=plan)
        comparison = compare_shapes(limit, shown, plan, symmetries(design, plan), design.gravity.pull)
        if _has_turned(comparison):
            own = law_on_mesh(law, design, plan, design.mesh.edge_mm)
            model = replace(PREVIEW_MODEL, sixfold_factor=AXIS_HOLD * PREVIEW_MODEL.sixfold_factor)
            held, limit = (preview(design, each, plan=plan, model=model) for each in (own, fine))
            comparison = compare_shapes(limit, held, plan, symmetries(design, plan), design.gravity.pull)
    except (Error, FloatingPointError):
        return None
    if not (limit.summary["is_minimum"] and shown.summary["is_minimum"] and alike(comparison)):
        return None
    (high, own_high), radii = comparison.heights_mm, comparison.roll_radii_mm
    radius = shown.summary.get("roll_radius_mm")
    return MeshLimitRecord(
        height_mm=shown.height_mm * high / own_high if own_high else high,
        roll_radius_mm=None if radii is None or radius is None else radius * radii[0] / radii[1],
        distance_percent=comparison.rms_percent,
        wall_s=time.perf_counter() - begun,
    )


def _has_turned(comparison: Comparison) -> bool:
    """Whether both previews are rolled, about different axes."""
    one, other = comparison.roll_axes_deg
    return one is not None and other is not None and axes_apart_deg(one, other) > MAX_AXIS_TURN_DEG


def has_mesh_limit(design: Design, law: Law | None = None) -> bool:
    """Whether the law has the cells for `mesh_limit`: of the design's edges, and of finer ones that show an order.

    Parameters
    ----------
    law : by default the one that serves the design.
    """
    plan = layout(design)
    try:
        law = law if law is not None else serving_law(design, plan)
        return all(law_on_mesh(law, design, plan, edge_mm) for edge_mm in (design.mesh.edge_mm, LIMIT))
    except Error:
        return False


def design_and_law(design: Design, law: Law, edge_mm: float | None) -> tuple[Design, Law]:
    """A design with meshes of an edge length, and the law for it.

    Parameters
    ----------
    edge_mm : 0 for the limit of an infinitely fine mesh, which leaves the design's mesh as it is; None for no change.

    Raises
    ------
    LawError
        The law has no cells of this edge, or no limit, for the stars of the design.
    """
    if edge_mm is None:
        return design, law
    if edge_mm != LIMIT:
        data = design.to_dict()
        design = Design.from_dict(data | {"mesh": data["mesh"] | {"edge_mm": edge_mm}})
    return design, law_on_mesh(law, design, layout(design), edge_mm)


def with_mesh_limit(shown: Shape, design: Design, law: Law) -> Shape:
    """A preview whose summary has the limit of an infinitely fine mesh (`mesh_limit`).

    Parameters
    ----------
    law : with its cells of other edges.
    """
    limit = mesh_limit(design, law, shown, layout(design))
    return replace(shown, summary=shown.summary | {"mesh_limit": limit})


def is_on_exact_mesh(shown: Shape, law: Law, design: Design) -> bool:
    """Whether a preview was made by this law on meshes of the design's edge length."""
    made = shown.summary.get("law", {}).get("edge_mm")
    return made == law.edge_mm and has_edge(law, design.mesh.edge_mm)
