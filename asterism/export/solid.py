"""Watertight solids that stand on the ground: regions of the plane with a height each, united."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import shapely
from shapely.geometry.base import BaseGeometry

from pattern.layout import Floats, Ints

# corners lie on a grid of a thousandth of a millimetre: single precision, as in STL, keeps them apart
GRID_MM = 1e-3
# joining parts may bring other corners together
_MOST_ROUNDS = 5


@dataclass(frozen=True)
class Solid:
    """A closed surface.

    Attributes
    ----------
    name : what slicers show.
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
class Step:
    """A region of the plane that is filled from the ground to a height.

    Attributes
    ----------
    height_mm : its top.
    region : polygons, mm.
    """

    height_mm: float
    region: BaseGeometry


def terraces(regions: Sequence[tuple[float, BaseGeometry]]) -> tuple[Step, ...]:
    """Regions (height, polygon) that may overlap, as one terrace for each height, the lowest and widest first.

    A terrace covers all that is at least as high, so that each lies within the one before it. All are unions of the
    faces of one subdivision of the plane: where two terraces have a wall in common, they have its corners in common.
    Parts that touch in a point are joined there by a square of a few micrometres: an edge of a solid has two sides.
    """
    heights = np.array([round(height, 6) for height, _ in regions])
    shapes = shapely.set_precision([region for _, region in regions], GRID_MM)
    for _ in range(_MOST_ROUNDS):
        steps = _subdivided(heights, shapes)
        touching = [(step.height_mm, _touching_points(step.region)) for step in steps]
        if not any(len(points) for _, points in touching):
            break
        for height, points in touching:
            bridges = shapely.box(*(points - 2 * GRID_MM).T, *(points + 2 * GRID_MM).T)
            heights = np.concatenate([heights, np.full(len(points), height)])
            shapes = np.concatenate([shapes, shapely.set_precision(bridges, GRID_MM)])
    return steps


def _subdivided(heights: Floats, shapes: np.ndarray) -> tuple[Step, ...]:
    lines = shapely.union_all(shapely.boundary(shapes), grid_size=GRID_MM)
    faces = shapely.get_parts(shapely.polygonize(shapely.get_parts(lines)))
    # a face is as high as the highest region over it
    face, region = shapely.STRtree(shapes).query(shapely.point_on_surface(faces), predicate="intersects")
    top = np.zeros(len(faces))
    np.maximum.at(top, face, heights[region])
    levels = np.unique(top[top > 0])
    return tuple(Step(float(level), shapely.coverage_union_all(faces[top >= level])) for level in levels)


def _touching_points(region: BaseGeometry) -> Floats:
    """(n, 2) corners at which parts of a region, or its holes, touch."""
    rings = shapely.get_rings(region)
    corners = [shapely.get_coordinates(ring)[:-1] for ring in rings]
    points, count = np.unique(np.concatenate([np.empty((0, 2)), *corners]), axis=0, return_counts=True)
    return np.asarray(points[count > 1])


def stack(name: str, steps: Sequence[Step]) -> Solid:
    """The solid under nested terraces.

    Raises
    ------
    ValueError
        There is nothing in the regions.
    """
    import manifold3d  # compiled, and needed by exports only

    prisms = []
    for step in steps:
        rings = [
            np.asarray(ring.coords)[:-1]
            for polygon in shapely.get_parts(step.region)
            if not polygon.is_empty
            for ring in (polygon.exterior, *polygon.interiors)
        ]
        if rings:
            section = manifold3d.CrossSection(rings, manifold3d.FillRule.EvenOdd)
            prisms.append(manifold3d.Manifold.extrude(section, step.height_mm))
    if not prisms:
        raise ValueError(f"{name} has no area")
    body = manifold3d.Manifold.batch_boolean(prisms, manifold3d.OpType.Add)
    mesh = body.to_mesh64()
    # corners that only colour or texture would tell apart are one
    points, index = np.unique(np.asarray(mesh.vert_properties)[:, :3], axis=0, return_inverse=True)
    triangles = index.reshape(-1)[np.asarray(mesh.tri_verts, dtype=np.int64)]
    return Solid(name, points, triangles)
