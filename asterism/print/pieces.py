"""Arms and drawn rods as pieces of one height, for solids, drawings and scripts, and the terraces of their plastic."""

from __future__ import annotations

from collections.abc import Sequence
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
class ArmPiece:
    """A straight piece of an arm with one height.

    Attributes
    ----------
    star : number of the star in the layout.
    direction : (2,) unit vector from the centre of the star.
    begin_mm, end_mm : distances of both ends from the centre.
    begin_width_mm, end_width_mm : widths at both ends, linear between them.
    height_mm : printed height.
    """

    star: int
    direction: Floats
    begin_mm: float
    end_mm: float
    begin_width_mm: float
    end_width_mm: float
    height_mm: float

    def corners(self, centre: Floats) -> Floats:
        """(4, 2) mm, corners, counterclockwise."""
        begin, end = centre + self.begin_mm * self.direction, centre + self.end_mm * self.direction
        return _strip(begin, end, self.direction, self.begin_width_mm, self.end_width_mm)


def arm_pieces(plan: Layout, rounding: Rounding) -> list[ArmPiece]:
    """The pieces of all arms, arm by arm from the centre outwards.

    An arm is the strip of the model, from the centre of the star to the tip, with a straight end. An arm of varying
    thickness is printed in steps of one layer.
    """
    result: list[ArmPiece] = []
    along = plan.arm_tip - plan.centres[plan.arm_star]
    for arm, (star, length) in enumerate(zip(plan.arm_star, plan.arm_length, strict=True)):
        heights, ends = height_steps(plan.arm_thickness[arm], rounding)
        widths = np.interp(ends, [0.0, 1.0], plan.arm_width[arm])
        for k, height in enumerate(heights):
            begin, end = ends[k] * length, ends[k + 1] * length
            result.append(ArmPiece(int(star), along[arm] / length, begin, end, widths[k], widths[k + 1], float(height)))
    return result


def height_steps(thickness: Floats, rounding: Rounding) -> tuple[Floats, Floats]:
    """Heights along an arm, each with its begin and end as fractions of the arm's length."""
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


@dataclass(frozen=True)
class RodPiece:
    """A part of a drawn rod with one height.

    Attributes
    ----------
    rod : number among the layout's `drawn_rods`.
    points : (n, 2) mm, polyline of the middle line.
    width : (n,) mm at the points, linear between them.
    height_mm : printed height.
    round_ends : whether the beginning and the end are round, because the rod meets another one there.
    side : face of the fabric that carries it: 1 above, -1 below.
    """

    rod: int
    points: Floats
    width: Floats
    height_mm: float
    round_ends: tuple[bool, bool]
    side: int = 1

    @property
    def region(self) -> BaseGeometry:
        """The printed area in printed coordinates, mm: a strip of this width with round corners.

        Examples
        --------
        >>> piece = RodPiece(0, np.array([[0.0, 0.0], [10.0, 0.0]]), np.array([1.0, 2.0]), 0.3, (False, False))
        >>> piece.region.area
        15.0
        """
        along = np.diff(self.points, axis=0)
        along /= np.linalg.norm(along, axis=1, keepdims=True)
        corners = [*map(_strip, self.points, self.points[1:], along, self.width, self.width[1:])]
        is_round = np.ones(len(self.points), dtype=bool)
        is_round[[0, -1]] = self.round_ends
        discs = shapely.buffer(shapely.points(self.points[is_round]), self.width[is_round] / 2, quad_segs=8)
        return shapely.union_all([*shapely.polygons(np.array(corners)), *discs])


def rod_pieces(plan: Layout, rounding: Rounding) -> list[RodPiece]:
    """The pieces of all drawn rods, rod by rod from start to end.

    A rod of varying thickness is printed in steps of one layer.
    """
    degree = [len(ends) for ends in plan.graph.ends_at]
    return [
        piece
        for number, rod in enumerate(plan.drawn_rods)
        for piece in _pieces(number, rod, rounding, (degree[rod.start] > 1, degree[rod.end] > 1))
    ]


def _pieces(number: int, rod: Rod, rounding: Rounding, round_ends: tuple[bool, bool]) -> list[RodPiece]:
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
    last = len(runs) - 1
    return [
        RodPiece(
            number,
            rod.at(rod.points, np.array(run)),
            rod.at(rod.width, np.array(run)),
            height,
            (round_ends[0] and k == 0, round_ends[1] and k == last),
            rod.side,
        )
        for k, (height, run) in enumerate(zip(heights, runs, strict=True))
    ]


def _strip(begin: Floats, end: Floats, along: Floats, begin_width: float, end_width: float) -> Floats:
    """(4, 2) mm, corners of a straight strip in a unit direction, counterclockwise."""
    side = np.array([-along[1], along[0]])
    a, b = begin_width / 2 * side, end_width / 2 * side
    return np.array([begin - a, end - b, end + b, begin + a])


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
    # half width below which a piece of the cut line is removed, over the width of a line
    thin = 0.1 * rounding.line_mm
    wide = clear.buffer(-thin, join_style="mitre").buffer(thin, join_style="mitre", mitre_limit=5)
    return Terrace(rounding.first_layer_mm, shapely.set_precision(wide, GRID_MM))
