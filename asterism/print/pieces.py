"""Arms and drawn rods as pieces of one height, for solids, drawings and scripts, and the terraces of their plastic."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np
import shapely
from shapely.geometry.base import BaseGeometry

from asterism.equilibrium.arrays import Floats
from asterism.pattern.design.rounding import Rounding
from asterism.pattern.layout.layout import Layout
from asterism.pattern.rods.graph import Rod
from asterism.print.solid import GRID_MM, Terrace, nested_terraces


@dataclass(frozen=True)
class Piece:
    """A part of a rod with one height: an arm, from the centre of its star outwards, or a drawn rod.

    Attributes
    ----------
    number : of the rod in the layout's graph.
    points : (n, 2) mm, polyline of the middle line.
    width : (n,) mm at the points, linear between them.
    height_mm : printed height.
    round_ends : whether the beginning and the end are round, because the rod meets others there.
    side : face of the fabric that carries it: 1 above, -1 below.
    """

    number: int
    points: Floats
    width: Floats
    height_mm: float
    round_ends: tuple[bool, bool]
    side: int = 1

    @property
    def region(self) -> BaseGeometry:
        """The printed area in printed coordinates, mm: a strip of this width with round corners.

        >>> piece = Piece(0, np.array([[0.0, 0.0], [10.0, 0.0]]), np.array([1.0, 2.0]), 0.3, (False, False))
        >>> piece.region.area
        15.0
        """
        return shapely.union_all(self.parts)

    @property
    def parts(self) -> list[BaseGeometry]:
        """A quadrilateral for each straight part of the middle line, then the discs at its round points."""
        along = np.diff(self.points, axis=0)
        along /= np.linalg.norm(along, axis=1, keepdims=True)
        aside = np.column_stack([-along[:, 1], along[:, 0]])
        begin, end = (0.5 * width[:, None] * aside for width in (self.width[:-1], self.width[1:]))
        a, b = self.points[:-1], self.points[1:]
        corners = np.stack([a - begin, b - end, b + end, a + begin], axis=1)
        is_round = np.ones(len(self.points), dtype=bool)
        is_round[[0, -1]] = self.round_ends
        discs = shapely.buffer(shapely.points(self.points[is_round]), self.width[is_round] / 2, quad_segs=8)
        return [*shapely.polygons(corners), *discs]


def pieces(plan: Layout, rounding: Rounding) -> tuple[list[Piece], list[Piece]]:
    """The pieces of all arms and of all drawn rods, rod by rod from start to end.

    A rod of varying thickness is printed in steps of one layer. An arm is round at the centre of its star, where arms
    that the border cuts away leave a gap, and has a straight end.
    """
    degree = [len(ends) for ends in plan.graph.ends_at]
    arms, drawn = list[Piece](), list[Piece]()
    for number, rod in enumerate(plan.graph.rods):
        if number < len(plan.arm_star):
            arms += _pieces(number, rod, rounding, (True, False))
        else:
            drawn += _pieces(number, rod, rounding, (degree[rod.start] > 1, degree[rod.end] > 1))
    return arms, drawn


def height_steps(thickness: Floats, rounding: Rounding) -> tuple[Floats, Floats]:
    """Heights along a straight part of a rod, each with its begin and end as fractions of its length."""
    first, last = (float(h) for h in thickness)
    if first == last:
        return np.array([first]), np.array([0.0, 1.0])
    low, high = np.sort(rounding.layers(thickness))
    # a layer begins halfway between two heights; the height of a cut tip may lie between layers
    layers = np.arange(np.floor(low), np.ceil(high)) + 0.5
    changes = (rounding.height(layers) - first) / (last - first)
    ends = np.unique(np.clip([0.0, *changes, 1.0], 0.0, 1.0))
    middles = (ends[:-1] + ends[1:]) / 2
    return rounding.thickness(first + middles * (last - first)), ends


def _pieces(number: int, rod: Rod, rounding: Rounding, round_ends: tuple[bool, bool]) -> Iterator[Piece]:
    heights: list[float] = []
    runs: list[list[float]] = []
    known = rod.arc_lengths / rod.length
    for k in range(len(known) - 1):
        step_heights, ends = height_steps(rod.thickness[k : k + 2], rounding)
        places = known[k] + ends * (known[k + 1] - known[k])
        for height, begin, end in zip(step_heights, places, places[1:], strict=False):
            if heights and heights[-1] == height:
                runs[-1].append(float(end))
            else:
                heights.append(float(height))
                runs.append([float(begin), float(end)])
    for k, (height, run) in enumerate(zip(heights, runs, strict=True)):
        points, width = (rod.at(values, np.array(run)) for values in (rod.points, rod.width))
        ends_here = round_ends[0] and k == 0, round_ends[1] and k == len(runs) - 1
        yield Piece(number, points, width, height, ends_here, rod.side)


def plastic_terraces(arms: Sequence[Piece], drawn: Sequence[Piece]) -> tuple[Terrace, ...]:
    """Terraces of all arms and drawn rods in printed coordinates; overlapping pieces are united."""
    regions = [(piece.height_mm, piece.region) for piece in drawn]
    regions += [(piece.height_mm, part) for piece in arms for part in piece.parts]
    return nested_terraces(regions) if regions else ()


def cutting_lines(plan: Layout, drawn: Sequence[Piece]) -> tuple[Floats, ...]:
    """Closed lines (n, 2) mm to cut along, the outline first: the far edges of printed rims, or border and holes."""
    sheet = shapely.Polygon(plan.outline, plan.holes)
    rims = {rod for rim in (plan.rim, *plan.hole_rims) for rod in rim}
    if not rims:
        return (plan.outline, *plan.holes)
    with_rims = shapely.union_all([sheet, *(piece.region for piece in drawn if piece.number in rims)])
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
    # half width below which a piece of the cut line is removed, over the width of a line
    thin = 0.1 * rounding.line_mm
    wide = clear.buffer(-thin, join_style="mitre").buffer(thin, join_style="mitre", mitre_limit=5)
    return Terrace(rounding.first_layer_mm, shapely.set_precision(wide, GRID_MM))
