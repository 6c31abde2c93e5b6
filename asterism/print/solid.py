"""Watertight solids on the plane z = 0, from regions of the plane with heights."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import shapely
from shapely.geometry.base import BaseGeometry

from asterism.equilibrium.arrays import Floats, Ints

# corners lie on this grid, which single precision (as in STL) resolves
GRID_MM = 1e-3


@dataclass(frozen=True)
class Solid:
    """A closed surface.

    Attributes
    ----------
    name : name in slicers.
    points : (n, 3) mm.
    triangles : (m, 3), counterclockwise from outside.
    """

    name: str
    points: Floats
    triangles: Ints

    @property
    def volume_mm3(self) -> float:
        """Enclosed volume, by the divergence theorem."""
        a, b, c = (self.points[self.triangles[:, k]] for k in range(3))
        return float(np.einsum("ni,ni->", a, np.cross(b, c))) / 6

    @property
    def box(self) -> Floats:
        """(2, 3) mm, lowest and highest corner."""
        return np.array([self.points.min(axis=0), self.points.max(axis=0)])


@dataclass(frozen=True)
class Terrace:
    """A region of the plane, filled from z = 0 to a height.

    Attributes
    ----------
    height_mm : height of the top.
    region : polygons, mm.
    """

    height_mm: float
    region: BaseGeometry

    def stretched(self, factors: tuple[float, float]) -> Terrace:
        """The terrace with its coordinates times factors along x and y."""
        return Terrace(self.height_mm, shapely.transform(self.region, lambda points: points * factors))


def nested_terraces(regions: Sequence[tuple[float, BaseGeometry]]) -> tuple[Terrace, ...]:
    """One terrace for each height from regions (height, polygon) that may overlap; the lowest and widest first.

    A terrace covers all regions that are at least as high, so that terraces are nested. All terraces are unions of the
    faces of one subdivision of the plane: terraces that share a wall share its corners. A square of a few micrometres
    joins parts that touch in a point, because each edge of a solid has two faces.
    """
    heights = np.array([round(height, 6) for height, _ in regions])
    shapes = shapely.set_precision([region for _, region in regions], GRID_MM)
    # rounds of joining parts, which may bring other corners together
    for _ in range(5):
        steps = _subdivided(heights, shapes)
        touching = [(step.height_mm, _touching_points(step.region)) for step in steps]
        if not any(len(points) for _, points in touching):
            break
        for height, points in touching:
            bridges = shapely.box(*(points - 2 * GRID_MM).T, *(points + 2 * GRID_MM).T)
            heights = np.concatenate([heights, np.full(len(points), height)])
            shapes = np.concatenate([shapes, shapely.set_precision(bridges, GRID_MM)])
    return steps


def _subdivided(heights: Floats, shapes: np.ndarray) -> tuple[Terrace, ...]:
    faces, top = _faces(shapely.union_all(shapely.boundary(shapes), grid_size=GRID_MM), heights, shapes)
    levels = np.unique(top)
    return tuple(Terrace(float(level), shapely.coverage_union_all(faces[top >= level])) for level in levels)


def _faces(lines: BaseGeometry, heights: Floats, shapes: np.ndarray) -> tuple[np.ndarray, Floats]:
    """Faces of the subdivision by all boundaries that lie in a region, and the largest height over each."""
    faces = shapely.get_parts(shapely.polygonize(shapely.get_parts(lines)))
    face, shape = shapely.STRtree(shapes).query(shapely.point_on_surface(faces), predicate="intersects")
    top = np.zeros(len(faces))
    np.maximum.at(top, face, heights[shape])
    return faces[top > 0], top[top > 0]


def _touching_points(region: BaseGeometry) -> Floats:
    """(n, 2) mm, corners at which parts of a region, or its holes, touch."""
    rings = shapely.get_rings(shapely.get_parts(region))
    corners = [shapely.get_coordinates(ring)[:-1] for ring in rings]
    points, count = np.unique(np.concatenate([np.empty((0, 2)), *corners]), axis=0, return_counts=True)
    return np.asarray(points[count > 1])


def terraced_solid(name: str, steps: Sequence[Terrace]) -> Solid:
    """The solid under nested terraces.

    Each corner of the plane has points at the heights of all its faces. Walls and roofs use these points only, so that
    they fit together.

    Raises
    ------
    ValueError
        The regions are empty.
    """
    heights = np.array([step.height_mm for step in steps])
    # terraces may have been turned off the grid; their common corners must stay equal
    regions = np.array([step.region for step in steps], dtype=object)
    faces, top = _faces(shapely.union_all(shapely.boundary(regions)), heights, regions)
    if not len(faces):
        raise ValueError(f"{name} has no area")
    pieces, face = shapely.get_parts(shapely.constrained_delaunay_triangles(faces), return_index=True)
    plane = shapely.get_coordinates(shapely.orient_polygons(pieces)).reshape(-1, 4, 2)[:, :3]
    roofs = np.dstack([plane, np.broadcast_to(top[face][:, None], plane.shape[:2])])
    ground = np.dstack([plane, np.zeros(plane.shape[:2])])[:, ::-1]
    corners = np.concatenate([roofs, ground, _walls(shapely.orient_polygons(faces), top)])
    points, index = np.unique(corners.reshape(-1, 3), axis=0, return_inverse=True)
    return Solid(name, points, index.reshape(-1, 3))


def _walls(faces: np.ndarray, top: Floats) -> Floats:
    """(n, 3, 3) mm, triangles of the walls between faces of different heights, and of the outer walls."""
    rings, face = shapely.get_rings(faces, return_index=True)
    coordinates, ring = shapely.get_coordinates(rings, return_index=True)
    corners, corner = np.unique(coordinates, axis=0, return_inverse=True)
    along = ring[:-1] == ring[1:]
    begin, end = corner.reshape(-1)[:-1][along], corner.reshape(-1)[1:][along]
    height = top[face[ring[:-1][along]]]
    # a face lies to the left of its edges; beyond an edge without an opposite edge the height is 0
    other = dict(zip(zip(end.tolist(), begin.tolist(), strict=True), height.tolist(), strict=True))
    walls, levels = [], [{0.0} for _ in corners]
    for a, b, high in zip(begin.tolist(), end.tolist(), height.tolist(), strict=True):
        levels[a].add(high)
        low = other.get((a, b), 0.0)
        if low < high:
            walls.append((a, b, low, high))
    triangles = []
    for a, b, low, high in walls:
        left, right = (sorted(z for z in levels[k] if low <= z <= high) for k in (a, b))
        i = j = 0
        while i + 1 < len(left) or j + 1 < len(right):
            triangle = [(*corners[a], left[i]), (*corners[b], right[j])]
            if i + 1 < len(left) and (j + 1 == len(right) or left[i + 1] <= right[j + 1]):
                i += 1
                triangle.append((*corners[a], left[i]))
            else:
                j += 1
                triangle.append((*corners[b], right[j]))
            triangles.append(triangle)
    return np.array(triangles)
