"""What a picture needs of a shape, and its arms as ribbons of their printed width, on the side that carries them."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any, Protocol, Self

import numpy as np

from asterism.equilibrium.arrays import Floats, Ints
from asterism.pattern.geometry.normals import vertex_normals
from asterism.pattern.layout.layout import Layout


class Drawable(Protocol):
    """A sheet in space with its arms, supports and numbers; attributes as of `asterism.shape.shape.Shape`."""

    @property
    def printed(self) -> np.ndarray: ...
    @property
    def positions(self) -> np.ndarray: ...
    @property
    def triangles(self) -> np.ndarray: ...
    @property
    def rods(self) -> Sequence[np.ndarray]: ...
    @property
    def rod_fields(self) -> Mapping[str, np.ndarray]: ...
    @property
    def summary(self) -> Mapping[str, Any]: ...
    @property
    def held(self) -> bool: ...
    @property
    def layout(self) -> Layout | None: ...
    @property
    def height_mm(self) -> float: ...
    @property
    def extent_mm(self) -> tuple[float, float, float]: ...
    def at(self, printed_points: Floats, off_sheet_mm: float = 0.0) -> Floats: ...
    def aligned(self) -> Self: ...


def ribbons(shape: Drawable) -> tuple[Floats, Floats, Ints]:
    """Build strips of triangles along the arms, tangent to the sheet.

    Returns
    -------
    points : (2 P, 3) mm, first the P points left of the vertices of all arms, then those right of them.
    normals : (2 P, 3) unit normals at these points, away from the fabric.
    triangles : (2 R, 3), two for each of the R rod edges, counterclockwise seen from outside.
    """
    if not shape.rods:
        return np.empty((0, 3)), np.empty((0, 3)), np.empty((0, 3), dtype=np.int64)
    vertices = np.concatenate(shape.rods)
    lengths = np.array([len(path) for path in shape.rods])
    first = np.cumsum(lengths) - lengths
    # each point of a rod but the last begins an edge; edges have the numbers of `shape.rod_edges`
    begins = np.ones(len(vertices), dtype=bool)
    begins[first + lengths - 1] = False
    begin = np.flatnonzero(begins)

    places = shape.positions[vertices]
    normals = vertex_normals(shape.positions, shape.triangles)[vertices]
    edges = places[begin + 1] - places[begin]
    along = np.zeros_like(places)
    along[begin] += edges
    along[begin + 1] += edges
    side = np.cross(normals, along)
    side /= np.maximum(np.linalg.norm(side, axis=1, keepdims=True), 1e-12)
    # width of the arms of a shape without the rod field `width_mm`
    half_width = _at_points(shape, "width_mm", 1.2, begin, len(vertices)) / 2
    below = _at_points(shape, "side", 1.0, begin, len(vertices)) < 0
    normals, side = (np.where(below[:, None], -each, each) for each in (normals, side))
    points = np.concatenate([places + half_width[:, None] * side, places - half_width[:, None] * side])
    left, right = begin, begin + len(vertices)
    triangles = np.concatenate(
        [np.column_stack([left, right, right + 1]), np.column_stack([left, right + 1, left + 1])]
    )
    return points, np.concatenate([normals, normals]), triangles


def _at_points(shape: Drawable, name: str, default: float, begin: Ints, count: int) -> Floats:
    """(P,) a field of the rod edges at the points of the rods: the mean of the adjacent edges."""
    values = np.asarray(shape.rod_fields.get(name, np.full(len(begin), default)), dtype=float)
    ends = np.concatenate([begin, begin + 1])
    total = np.bincount(ends, weights=np.tile(values, 2), minlength=count)
    # a rod of one point has no edge and is not drawn
    return total / np.maximum(np.bincount(ends, minlength=count), 1)
