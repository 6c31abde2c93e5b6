"""Rotations and mirrors that may map a drawing onto itself, and the check whether they do."""

from __future__ import annotations

import numpy as np
import shapely

from asterism.equilibrium.arrays import Floats
from asterism.pattern.layout.layout import Layout
from asterism.pattern.rods.graph import Rod, RodGraph

# highest order of a rotation that is looked for; a circle has all of them
MAX_ROTATION_ORDER = 12
# a moment below this part of its largest possible value is zero
ZERO_MOMENT = 1e-4
# inner points of a rod at which it is compared; a point every this many of its points for long curves
MIN_ROD_SAMPLES = 7
# relative difference of sections that are equal: those of curves are evaluated at slightly different places
SAME_SECTION = 1e-3


def candidate_turns(graph: RodGraph, centre: Floats) -> list[Floats]:
    """Orthogonal matrices (2, 2) of all motions about a centre that can map the rods onto themselves.

    The identity is the first.

    Notes
    -----
    A rotation by an angle a multiplies the moment `m_k`, the integral of `(x + iy)^k` over the rods, by `exp(ika)`, and
    a mirror about an axis at b conjugates it and multiplies by `exp(2ikb)`. The first moment that is not zero allows k
    rotations and k axes.

    Examples
    --------
    >>> square = np.array([[1.0, 1.0], [-1.0, 1.0], [-1.0, -1.0], [1.0, -1.0], [1.0, 1.0]])
    >>> rod = Rod(square, 0, 0, np.full(5, 0.3), np.full(5, 1.2))
    >>> len(candidate_turns(RodGraph(square[:1], (rod,)), np.zeros(2)))
    8
    """
    ends = np.concatenate([np.stack([rod.points[:-1], rod.points[1:]], axis=1) for rod in graph.rods]) - centre
    length = np.linalg.norm(ends[:, 1] - ends[:, 0], axis=1)
    # Gauss points of the straight pieces
    parts, weights = np.polynomial.legendre.leggauss(MAX_ROTATION_ORDER // 2 + 1)
    places = (1 - parts[:, None, None]) / 2 * ends[:, 0] + (1 + parts[:, None, None]) / 2 * ends[:, 1]
    z, share = places[..., 0] + 1j * places[..., 1], weights[:, None] / 2 * length
    z = z / np.abs(z).max()
    moments = [(share * z**k).sum() / (share * np.abs(z) ** k).sum() for k in range(1, MAX_ROTATION_ORDER + 1)]
    order = next((k for k, m in enumerate(moments, 1) if abs(m) > ZERO_MOMENT), MAX_ROTATION_ORDER)
    axis = np.angle(moments[order - 1]) / order if abs(moments[order - 1]) > ZERO_MOMENT else 0.0
    turns = [_rotation(2 * np.pi * k / order) for k in range(order)]
    return turns + [_rotation(2 * (axis + np.pi * k / order)) @ np.diag([1.0, -1.0]) for k in range(order)]


class DrawingImages:
    """Checks whether motions map a drawing onto itself.

    Parameters
    ----------
    layout : of the drawing.
    tolerance : mm, distance within which lines are equal.
    """

    def __init__(self, layout: Layout, tolerance: float) -> None:
        self._layout, self._tolerance = layout, tolerance
        self._border = shapely.LinearRing(layout.outline)
        self._on_border = shapely.get_coordinates(shapely.segmentize(self._border, layout.spacing_mm))
        rods = layout.graph.rods
        self._parts = [_inner_parts(rod) for rod in rods]
        self._points = np.concatenate([rod.at(rod.points, parts) for rod, parts in zip(rods, self._parts, strict=True)])
        self._lines = np.array([shapely.LineString(rod.points) for rod in rods])
        self._tree = shapely.STRtree(self._lines)
        sections = {(rod.kappa_bar, *np.unique(np.stack([rod.thickness, rod.width]), axis=1).ravel()) for rod in rods}
        self._has_one_section = len(sections) == 1 and len(next(iter(sections))) == 1 + len(_SIZES)

    def are_equal(self, turn: Floats, shift: Floats) -> bool:
        """Whether `p -> turn p + shift` maps outline, holes and rods of equal sections onto each other."""
        moved_border = shapely.points(self._on_border @ turn.T + shift)
        if (shapely.distance(self._border, moved_border) > self._tolerance).any():
            return False
        if not maps_holes(self._layout, turn, shift, self._tolerance):
            return False
        moved = shapely.points(self._points @ turn.T + shift)
        image = self._tree.nearest(moved)
        if (shapely.distance(self._lines[image], moved) > self._tolerance).any():
            return False
        if self._has_one_section:
            return True
        along = shapely.line_locate_point(self._lines[image], moved)
        rods, ends = self._layout.graph.rods, np.cumsum([len(parts) for parts in self._parts])[:-1]
        groups = zip(rods, self._parts, np.split(image, ends), np.split(along, ends), strict=True)
        for rod, parts, images, places in groups:
            for number in np.unique(images):
                here, other = images == number, rods[number]
                if not _same_sections(rod, parts[here], other, places[here] / other.length):
                    return False
        return True


def maps_holes(layout: Layout, turn: Floats, shift: Floats, tolerance: float) -> bool:
    """Whether the motion `p -> turn p + shift` maps the holes onto holes, each edge within `tolerance` (mm)."""
    rings = [shapely.LinearRing(hole) for hole in layout.holes]
    for ring in rings:
        at = shapely.get_coordinates(shapely.segmentize(ring, layout.spacing_mm))
        moved = shapely.points(at @ turn.T + shift)
        if not any((shapely.distance(other, moved) <= tolerance).all() for other in rings):
            return False
    return True


def _same_sections(first: Rod, parts: Floats, second: Rod, other_parts: Floats) -> bool:
    if first.kappa_bar != second.kappa_bar:
        return False
    pairs = [(first.at(getattr(first, key), parts), second.at(getattr(second, key), other_parts)) for key in _SIZES]
    return all((np.abs(one - two) <= SAME_SECTION * one).all() for one, two in pairs)


_SIZES = ("thickness", "width")


def _inner_parts(rod: Rod) -> Floats:
    """(n,) parts of the length of a rod, without its ends."""
    return (np.arange(max(MIN_ROD_SAMPLES, len(rod.points))) + 0.5) / max(MIN_ROD_SAMPLES, len(rod.points))


def _rotation(angle: float) -> Floats:
    c, s = np.cos(angle), np.sin(angle)
    return np.array([[c, -s], [s, c]])
