"""Correction of supported sides of round outlines.

The shell is supported along the sides of its coarse mesh. One side of the mesh may replace several short sides of the
design, and sides with small angles between them are supported as a smooth curve. Therefore a round outline misses its
supports by some tenths of a millimetre. The sheet shown is moved to its supports: fully at the outline, and less with
the distance from it.
"""

from __future__ import annotations

import numpy as np

from asterism.equilibrium.arrays import Floats
from asterism.fem.supports.conditions import EdgeSupport
from asterism.pattern.geometry.planar import STRAIGHT_TURN_RAD, distance_to_outline, nearest_segment, turning_angles
from asterism.previews.print_sheet import PrintSheet

# a corner of the design within this distance of the outline of the mesh, in spacings, is on that outline
MAX_OUTLINE_GAP_SPACINGS = 1e-6


class SupportedEdge:
    """Moves printed points (n, 2) mm near supported sides of a sheet to the places of the supports."""

    def __init__(self, sheet: PrintSheet, points: Floats) -> None:
        plan, width = sheet.layout, sheet.model.supported_rim_width
        held = plan.supported_edges
        start, end = plan.edges.start[held], plan.edges.end[held]
        self._count, self._moved = len(points), np.empty(0, dtype=np.int64)
        if width == 0.0 or not len(held) or not _is_round(sheet, start):
            return
        side = nearest_segment(points, start, end)
        foot = _feet(points, start[side], end[side])
        away = np.linalg.norm(points - foot, axis=1) / (width * plan.spacing_mm)
        self._moved = np.flatnonzero(away < 1.0)
        foot, edge, away = foot[self._moved], held[side[self._moved]], away[self._moved]
        self._feet = sheet.space.locate(foot).value
        self._places, fixed = np.zeros((2, len(foot), 3))
        for pin in plan.pins:
            its = np.isin(edge, pin.edges)
            self._places[its], fixed[its] = pin.places(foot[its]), pin.fixed
        self._share = fixed * (1.0 - away)[:, None]

    def __call__(self, x: Floats) -> Floats:
        """(n, 3) mm, moves of the points for the degrees of freedom x (N, 3) of the shell."""
        out = np.zeros((self._count, 3))
        if len(self._moved):
            out[self._moved] = self._share * (self._places - self._feet @ x)
        return out


def _is_round(sheet: PrintSheet, start: Floats) -> bool:
    """Whether the shell misses the supported sides, which begin at points (s, 2): they are curved or replaced."""
    rings = sheet.mesh.rings
    turn = np.abs(np.concatenate([turning_angles(ring) for ring in rings]))
    if ((turn > STRAIGHT_TURN_RAD) & (turn <= np.radians(EdgeSupport.corner_deg))).any():
        return True
    away = np.min([distance_to_outline(start, ring) for ring in rings], axis=0)
    return bool((away > MAX_OUTLINE_GAP_SPACINGS * sheet.layout.spacing_mm).any())


def _feet(points: Floats, start: Floats, end: Floats) -> Floats:
    """(n, 2) nearest point on a segment to each point; each point has its own segment."""
    along = end - start
    part = np.einsum("ni,ni->n", points - start, along) / np.einsum("ni,ni->n", along, along)
    return np.asarray(start + np.clip(part, 0.0, 1.0)[:, None] * along)
