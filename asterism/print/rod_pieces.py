"""Drawn rods as pieces of one height, for solids and scripts."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import shapely
from shapely.geometry.base import BaseGeometry

from asterism.equilibrium.arrays import Floats
from asterism.pattern.design.rounding import Rounding
from asterism.pattern.layout.layout import Layout
from asterism.pattern.rods.graph import Rod
from asterism.print.arm_pieces import height_steps

# pieces of a quarter of a circle, of round corners and ends
QUARTER_PIECES = 8


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
    """

    rod: int
    points: Floats
    width: Floats
    height_mm: float
    round_ends: tuple[bool, bool]

    @property
    def region(self) -> BaseGeometry:
        """The printed area in printed coordinates, mm: a strip of this width with round corners.

        Examples
        --------
        >>> piece = RodPiece(0, np.array([[0.0, 0.0], [10.0, 0.0]]), np.array([1.0, 2.0]), 0.3, (False, False))
        >>> piece.region.area
        15.0
        """
        corners = [
            _strip(*ends) for ends in zip(self.points, self.points[1:], self.width, self.width[1:], strict=False)
        ]
        is_round = np.ones(len(self.points), dtype=bool)
        is_round[[0, -1]] = self.round_ends
        discs = shapely.buffer(
            shapely.points(self.points[is_round]), self.width[is_round] / 2, quad_segs=QUARTER_PIECES
        )
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
        )
        for k, (height, run) in enumerate(zip(heights, runs, strict=True))
    ]


def _strip(begin: Floats, end: Floats, begin_width: float, end_width: float) -> Floats:
    """(4, 2) mm, corners of a straight strip, counterclockwise."""
    along = (end - begin) / np.linalg.norm(end - begin)
    side = np.array([-along[1], along[0]])
    a, b = begin_width / 2 * side, end_width / 2 * side
    return np.array([begin - a, end - b, end + b, begin + a])
