"""Needles: their places on the print and in space."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np

from asterism.equilibrium.arrays import Floats
from asterism.pattern.geometry.planar import distance_to_outline, distance_to_segment
from asterism.pattern.layout.layout import Layout
from asterism.pattern.layout.sheet_edges import SheetEdges
from asterism.pattern.layout.supports import PinSet
from asterism.pattern.rods.graph import CORNER_DEG
from asterism.shape.shape import Shape

# diameter of the hole for a needle in the base
HOLE_DIAMETER_MM = 1.0


@dataclass(frozen=True)
class Needle:
    """One needle."""

    number: int  # number in all drawings, from 1
    printed: Floats  # (2,) mm, place in printed coordinates
    # (3,) mm, place in space; None if the sheet slides in the plane and its shape is not known. z is not a number if
    # the sheet slides along z and its shape is not known.
    place: Floats | None
    slides: str  # `z` or `plane` if the sheet is free to slide, otherwise empty
    step: int  # step of the design at which the needle is set

    @property
    def height_mm(self) -> float | None:
        """Height of the sheet above the base; None if it is not known."""
        return None if self.place is None or np.isnan(self.place[2]) else float(self.place[2])

    @property
    def is_raised(self) -> bool:
        """Whether the needle holds the sheet above or below the base."""
        # a needle at a lower height holds the sheet on the base
        return self.height_mm is not None and abs(self.height_mm) > 0.05


def needles(plan: Layout, spacing_mm: float, shape: Shape | None = None) -> tuple[Needle, ...]:
    """Needles at all pins of a layout; on supported edges, their corners included, at most `spacing_mm` apart.

    The design gives the places of fixed supports, and `shape` those of sliding ones.
    """
    placed: list[Needle] = []
    for pins in plan.pins:
        along = [_along(line, spacing_mm) for line in _smooth_lines(pins, plan.edges)]
        printed = np.concatenate([pins.points, *along])
        places = _places(pins, printed, shape)
        for k, point in enumerate(printed):
            # adjacent edges share a corner
            if all(np.linalg.norm(point - needle.printed) > 1e-6 for needle in placed):
                place = None if places is None else places[k]
                placed.append(Needle(len(placed) + 1, point, place, pins.slide or "", pins.step))
    if not any(pins.holds_height for pins in plan.pins):
        # the height is free: the lowest needle stands on the base
        low = min((needle.height_mm for needle in placed if needle.height_mm is not None), default=0.0)
        lift = np.array([0.0, 0.0, low])
        placed = [needle if needle.place is None else replace(needle, place=needle.place - lift) for needle in placed]
    return tuple(placed)


def _smooth_lines(pins: PinSet, sheet: SheetEdges) -> list[Floats]:
    """Supported edges as polylines (n, 2) without corners, in the order of their edges."""
    is_corner = np.abs(sheet.turns) > np.radians(CORNER_DEG)
    lines: list[tuple[int, Floats]] = []
    for chain in pins.chains(sheet):
        closed = len(chain) > 2 and chain[0] == chain[-1]
        stops = [k for k, corner in enumerate(chain) if is_corner[corner] or (not closed and k in (0, len(chain) - 1))]
        if closed:  # from its first corner on
            first = stops[0] if stops else 0
            chain = [*chain[first:-1], *chain[: first + 1]]
            stops = [0, *(k for k in range(1, len(chain) - 1) if is_corner[chain[k]]), len(chain) - 1]
        lines += [(chain[a], sheet.start[chain[a : b + 1]]) for a, b in pairwise(stops)]
    return [line for _, line in sorted(lines, key=lambda each: each[0])]


def _along(line: Floats, spacing_mm: float) -> Floats:
    """Equally spaced points (n, 2) on a polyline, with its ends."""
    passed = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(line, axis=0), axis=1))])
    pieces = max(math.ceil(passed[-1] / spacing_mm - 1e-9), 1)
    at = np.arange(pieces + 1) / pieces * passed[-1]
    return np.column_stack([np.interp(at, passed, line[:, axis]) for axis in (0, 1)])


def _places(pins: PinSet, printed: Floats, shape: Shape | None) -> Floats | None:
    """(n, 3) mm, places of printed points in space; z is not a number if unknown; None if x and y are unknown."""
    held = np.array(pins.fixed)
    if held.all():
        return pins.places(printed)
    if shape is None:
        return np.where(held, pins.places(printed), np.nan) if held[:2].all() else None
    return np.where(held, pins.places(printed), shape.at_edges(printed))


def needles_near_edge(plan: Layout, some: Sequence[Needle]) -> list[int]:
    """Numbers of the needles so near to the cut line that the fabric would tear."""
    if not some:
        return []
    printed = np.array([needle.printed for needle in some])
    away = np.min([distance_to_outline(printed, line) for line in (plan.outline, *plan.holes)], axis=0)
    return [needle.number for needle, far in zip(some, away, strict=True) if far < 2.0]


def needles_in_plastic(plan: Layout, some: Sequence[Needle]) -> list[int]:
    """Numbers of the needles that meet an arm or a drawn rod."""
    if not some or not plan.graph.rods:
        return []
    printed = np.array([needle.printed for needle in some])[:, None]
    rods = plan.graph.rods
    begin, end = (np.concatenate([rod.points[part] for rod in rods]) for part in (slice(-1), slice(1, None)))
    width = np.concatenate([np.maximum(rod.width[:-1], rod.width[1:]) for rod in rods])
    near = distance_to_segment(printed, begin, end) < 0.5 * width
    return [needle.number for needle, hit in zip(some, near, strict=True) if hit.any()]
