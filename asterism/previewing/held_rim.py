"""Held sides of round outlines.

The shell is held along the sides of its mesh. Those may stand for several short ones of the design, and where they turn
by little they are held as a smooth curve. So a round outline comes out beside where its pins hold it, by some tenths of
a millimetre, and the sheet is moved there: by all of what is missing at the outline, by less with the distance from it.
"""

from __future__ import annotations

import numpy as np

from asterism.previewing.sheet import Sheet
from fem.conditions import HeldEdge
from fem.tabulation import Floats
from pattern.planar import STRAIGHT, distance_to_outline, pieces, turns

REACH = 0.5  # of the spacing: how far from the outline the sheet is moved
NEAR = 1e-6  # of the spacing: sides that are those of the mesh


class HeldRim:
    """Moves printed points (n, 2) near held sides of a sheet to where they are held."""

    def __init__(self, sheet: Sheet, points: Floats) -> None:
        plan = sheet.layout
        sides = [(pin, edge) for pin in plan.pins for edge in pin.edges]
        start = plan.border[[edge for _, edge in sides]]
        self._count, self._moved = len(points), np.empty(0, dtype=np.int64)
        if not sides or not _is_round(sheet, start):
            return
        along = np.roll(plan.border, -1, axis=0)[[edge for _, edge in sides]] - start
        foot, side = _feet(points, start, along)
        distance = np.linalg.norm(points - foot, axis=1)
        self._moved = np.flatnonzero(distance < REACH * plan.spacing_mm)
        foot, side, distance = foot[self._moved], side[self._moved], distance[self._moved]
        self._feet = sheet.space.locate(foot).value
        places = np.zeros((len(foot), 3))
        share = np.zeros((len(foot), 3))
        for number, (pin, _) in enumerate(sides):
            its = side == number
            places[its] = pin.places(foot[its])
            share[its] = pin.fixed
        self._places = places
        self._share = share * (1.0 - distance / (REACH * plan.spacing_mm))[:, None]

    def __call__(self, x: Floats) -> Floats:
        """(n, 3) mm, what positions x (N, 3) of the shell's dofs are moved by."""
        out = np.zeros((self._count, 3))
        if len(self._moved):
            out[self._moved] = self._share * (self._places - self._feet @ x)
        return out


def _is_round(sheet: Sheet, start: Floats) -> bool:
    """Whether the shell is held elsewhere than along sides that begin at some points (s, 2)."""
    turn = np.abs(turns(sheet.outline))
    if ((turn > STRAIGHT) & (turn <= np.radians(HeldEdge.corner_deg))).any():
        return True
    return bool((distance_to_outline(start, sheet.outline) > NEAR * sheet.layout.spacing_mm).any())


def _feet(points: Floats, start: Floats, along: Floats) -> tuple[Floats, Floats]:
    """The nearest point (n, 2) on any of some segments, and that segment's number (n,)."""
    feet, sides = [], []
    square = np.einsum("si,si->s", along, along)
    for some in pieces(points, len(start)):
        part = np.clip(np.einsum("nsi,si->ns", some[:, None] - start, along) / square, 0.0, 1.0)
        every = start + part[..., None] * along
        side = np.linalg.norm(every - some[:, None], axis=-1).argmin(axis=1)
        feet.append(every[np.arange(len(some)), side])
        sides.append(side)
    return np.concatenate(feet), np.concatenate(sides)
