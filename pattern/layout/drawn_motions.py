"""Rotations and mirrors that may map a drawing onto itself, and the check whether they do."""

from __future__ import annotations

import numpy as np
import shapely

from equilibrium.arrays import Floats
from pattern.layout.layout import Layout
from pattern.rods.graph import Rod, RodGraph

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


def maps_drawing(layout: Layout, turn: Floats, shift: Floats, tolerance: float) -> bool:
    """Whether `p -> turn p + shift` maps outline, holes and drawn rods onto themselves within `tolerance` (mm)."""
    graph = layout.graph
    border = shapely.LinearRing(layout.outline)
    if not maps_holes(layout, turn, shift, tolerance):
        return False
    at = shapely.get_coordinates(shapely.segmentize(border, layout.spacing_mm))
    if (shapely.distance(border, shapely.points(at @ turn.T + shift)) > tolerance).any():
        return False
    samples = [_inner_points(rod) for rod in graph.rods]
    owner = np.repeat(np.arange(len(samples)), [len(points) for points in samples])
    moved = shapely.points(np.concatenate(samples) @ turn.T + shift)
    lines = np.array([shapely.LineString(rod.points) for rod in graph.rods])
    image = shapely.STRtree(lines).nearest(moved)
    if (shapely.distance(lines[image], moved) > tolerance).any():
        return False
    along = shapely.line_locate_point(lines[image], moved)
    parts = np.concatenate([_inner_parts(rod) for rod in graph.rods])
    for number, rod in enumerate(graph.rods):
        for other in np.unique(image[owner == number]):
            here = (owner == number) & (image == other)
            if not _same_sections(rod, parts[here], graph.rods[other], along[here] / graph.rods[other].length):
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


def _inner_points(rod: Rod) -> Floats:
    return rod.at(rod.points, _inner_parts(rod))


def _rotation(angle: float) -> Floats:
    c, s = np.cos(angle), np.sin(angle)
    return np.array([[c, -s], [s, c]])
