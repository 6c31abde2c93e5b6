"""The plastic of a layout as terraces: regions of the plane with their printed heights."""

from __future__ import annotations

from collections.abc import Sequence

import shapely
from shapely.geometry.base import BaseGeometry

from asterism.equilibrium.arrays import Floats
from asterism.pattern.design.rounding import Rounding
from asterism.pattern.layout.layout import Layout
from asterism.print.arm_pieces import ArmPiece
from asterism.print.rod_pieces import RodPiece
from asterism.print.solid import GRID_MM, Terrace, nested_terraces

# half width below which a piece of the cut line is removed, over the width of a line
MIN_CUT_LINE_HALF_WIDTH = 0.1


def plastic_terraces(plan: Layout, arms: Sequence[ArmPiece], rods: Sequence[RodPiece] = ()) -> tuple[Terrace, ...]:
    """Terraces of all stars and drawn rods in printed coordinates; overlapping pieces are united."""
    regions: list[tuple[float, BaseGeometry]] = [(piece.height_mm, piece.region) for piece in rods]
    for strip in arms:
        centre = plan.centres[strip.star]
        regions.append((strip.height_mm, shapely.Polygon(strip.corners(centre))))
        if strip.begin_mm == 0.0:
            # where the border cuts arms away, the remaining arms meet in a round corner
            disc = shapely.Point(centre).buffer(strip.begin_width_mm / 2, quad_segs=8)
            regions.append((strip.height_mm, disc))
    return nested_terraces(regions)


def cutting_lines(plan: Layout, rods: Sequence[RodPiece]) -> tuple[Floats, ...]:
    """Closed lines (n, 2) mm to cut along, the outline first: the far edges of printed rims, or border and holes."""
    sheet = shapely.Polygon(plan.outline, plan.holes)
    rims = {rod - len(plan.arm_star) for rim in (plan.rim, *plan.hole_rims) for rod in rim}
    if not rims:
        return (plan.outline, *plan.holes)
    with_rims = shapely.union_all([sheet, *(piece.region for piece in rods if piece.rod in rims)])
    return tuple(shapely.get_coordinates(ring)[:-1] for ring in shapely.get_rings(with_rims))


def border_terrace(plan: Layout, plastic: Sequence[Terrace], rounding: Rounding) -> Terrace:
    """A printed line to cut along: one line wide, one layer high, outside the border and in holes.

    It is left out beside printed rims.
    """
    sheet = shapely.Polygon(plan.outline, plan.holes)
    around = sheet.buffer(rounding.line_mm, join_style="mitre", mitre_limit=5).difference(sheet)
    # plastic beyond the border must not touch the line
    clear = around.difference(plastic[0].region.buffer(rounding.line_mm))
    # slivers cannot be printed, and would touch the other parts in a point
    thin = MIN_CUT_LINE_HALF_WIDTH * rounding.line_mm
    wide = clear.buffer(-thin, join_style="mitre").buffer(thin, join_style="mitre", mitre_limit=5)
    return Terrace(rounding.first_layer_mm, shapely.set_precision(wide, GRID_MM))
