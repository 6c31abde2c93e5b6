"""Change of the shape by rounding: the rounded design compared with the design as drawn."""

from __future__ import annotations

from functools import partial

from asterism.pattern.design.design import Design
from asterism.pattern.layout.free_motions import free_motions
from asterism.pattern.layout.layout import Layout
from asterism.pattern.layout.symmetric_distance import distances_of_images, symmetric_distances
from asterism.pattern.layout.symmetries import symmetries
from asterism.results.records.export import ShapeChangeRecord
from asterism.shape.diameter import diameter
from asterism.shape.off_sheet import off_sheet_mm
from asterism.shape.shape import Shape


def shape_change(drawn: Shape, printed: Shape, design: Design, plan: Layout, model: str) -> ShapeChangeRecord:
    """Compare the shape of the rounded design with that of the design as drawn, both as their supports hold them.

    Parameters
    ----------
    drawn, printed : the shapes before and after rounding.
    design, plan : the design and layout before or after rounding; both have the same stars.
    model : model of both shapes: `exact` or `preview`.
    """
    supports = plan.support_samples
    off_sheet = off_sheet_mm(plan, min(len(drawn.printed), len(printed.printed)))
    free = free_motions(supports, drawn.at(supports.printed, off_sheet), design.gravity.pull)
    same = symmetries(design, plan)
    if plan.drawn is None:
        before, after = drawn.positions[drawn.star_vertices], printed.positions[printed.star_vertices]
        distance = float(symmetric_distances(before, after, same, free).min()) if len(before) > 2 else 0.0
    else:
        at = plan.points_on_rods
        before, after_at = drawn.at(at, off_sheet), partial(printed.at, off_sheet_mm=off_sheet)
        distance = float(distances_of_images(at, before, after_at, same, free).min())
    change = ShapeChangeRecord(
        model=model,
        height_mm=[drawn.height_mm, printed.height_mm],
        extent_mm=[list(drawn.extent_mm), list(printed.extent_mm)],
        star_distance_mm=distance,
        star_distance_percent=100.0 * distance / diameter(drawn.positions),
        are_minima=[bool(shape.summary.get("is_minimum", False)) for shape in (drawn, printed)],
        stars_outside_law=len(
            printed.summary.get("stars_outside_law", ()) or drawn.summary.get("stars_outside_law", ())
        ),
        warnings=list(printed.summary.get("warnings", [])),
    )
    return change.changed(minima=printed.summary["minima"]) if model == "exact" else change
