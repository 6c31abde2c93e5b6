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

    A terrace covers all that is at least as high, so that each lies within the one before it.
    """
    heights = sorted({round(height, 6) for height, _ in regions})
    steps: list[Step] = []
    above: BaseGeometry = shapely.Polygon()
    for height in reversed(heights):
        here = [region for h, region in regions if round(h, 6) == height]
        # united first: snapping the parts would move their common edges apart
        above = shapely.set_precision(shapely.union_all([above, *here]), GRID_MM)
        steps.append(Step(height, above))
    return tuple(reversed(steps))


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
