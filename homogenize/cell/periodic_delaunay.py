"""The Delaunay triangulation of points that repeat with a lattice."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from scipy.spatial import Delaunay

from asterism.equilibrium.arrays import Floats, Ints
from asterism.pattern.design.errors import MeshError
from asterism.pattern.geometry.planar import mean_circumcentres, triangle_angles, triangle_areas

# of the edge: points move by so much, to choose one of several Delaunay triangulations
TIE_BREAK_RATIO = 1e-6
# margin around the cell from which images come, in edges
MARGIN_EDGES = 4.0
# a cell and the eight around it, as numbers of lattice vectors; the cell itself is in the middle
CELLS_AROUND = np.array([[i, j] for i in (-1, 0, 1) for j in (-1, 0, 1)])


@dataclass(frozen=True)
class PeriodicTriangles:
    """One triangle of each class of images, counterclockwise.

    Attributes
    ----------
    points : (N, 2) mm.
    vectors : (2, 2) mm, lattice vectors as rows.
    corner : (T, 3) points.
    image : (T, 3, 2) numbers of lattice vectors to the image of each corner.
    """

    points: Floats
    vectors: Floats
    corner: Ints
    image: Ints

    @cached_property
    def places(self) -> Floats:
        """(3 T, 2) mm, all corners."""
        return self.points[self.corner.ravel()] + self.image.reshape(-1, 2) @ self.vectors

    @cached_property
    def areas(self) -> Floats:
        """(T,) mm^2."""
        return triangle_areas(self.places, self._alone)

    @cached_property
    def angles(self) -> Floats:
        """(T, 3) degrees."""
        return triangle_angles(self.places, self._alone)

    @cached_property
    def circumcentres(self) -> Floats:
        """(T, 2) mm."""
        return mean_circumcentres(self.places, self._alone)[::3]

    @property
    def _alone(self) -> Ints:
        return np.arange(3 * len(self.corner)).reshape(-1, 3)

    def smoothed(self) -> Floats:
        """(N, 2) mm, mean circumcentre at each point (see `pattern.geometry.planar.mean_circumcentres`)."""
        centre = np.repeat(self.circumcentres, 3, axis=0) - self.image.reshape(-1, 2) @ self.vectors
        at, weight = self.corner.ravel(), np.repeat(self.areas, 3)
        total = np.bincount(at, weight, len(self.points))
        return np.column_stack([np.bincount(at, weight * x, len(self.points)) / total for x in centre.T])

    def edges(self) -> tuple[Ints, Ints]:
        """(3 T,) names of the edges 0-1, 1-2 and 2-0 of all triangles, and of the reversed edges.

        Raises
        ------
        MeshError
            The triangles do not close to a torus: some edge lacks a triangle on one side.
        """
        a, b = self.corner, np.roll(self.corner, -1, axis=1)
        step = np.roll(self.image, -1, axis=1) - self.image
        there, back = self.name(a, b, step).ravel(), self.name(b, a, -step).ravel()
        if len(np.unique(there)) < len(there) or not np.isin(back, there).all():
            raise MeshError("the triangles do not close to a torus")
        return there, back

    def name(self, a: Ints, b: Ints, step: Ints) -> Ints:
        """Names of edges from point a to the image `step` (..., 2) of point b."""
        return np.asarray(((a * len(self.points) + b) * 9 + step[..., 0] + 4) * 9 + step[..., 1] + 4)


def periodic_delaunay(
    points: Floats, vectors: Floats, edge_mm: float, group: Floats | None = None
) -> PeriodicTriangles:
    """Delaunay triangles of the points (N, 2) of one cell; N is at least 3.

    Of several Delaunay triangulations the result depends on the numbers of the points only. With a point group of more
    than one element it is a symmetric one, wherever that is possible.

    Parameters
    ----------
    group : (G, 2, 2) rotations and reflections about the origin that map the points and the lattice onto themselves.

    Raises
    ------
    MeshError
        The points leave a hole of several edges.
    """
    inverse = np.linalg.inv(vectors)
    if group is None or len(group) == 1:
        tie = TIE_BREAK_RATIO * edge_mm * np.random.default_rng(0).normal(size=points.shape)
    else:
        tie = TIE_BREAK_RATIO * edge_mm * _symmetric_field(points, vectors, group)
    base = np.tile(np.arange(len(points)), len(CELLS_AROUND))
    image = np.repeat(CELLS_AROUND, len(points), axis=0)
    copies = points[base] + image @ vectors
    margin = MARGIN_EDGES * edge_mm * np.linalg.norm(inverse, axis=0)
    near = (np.abs(copies @ inverse - 0.5) < 0.5 + margin).all(axis=1)
    base, image, copies = base[near], image[near], copies[near]
    simplices = Delaunay(copies + tie[base]).simplices
    turned = triangle_areas(copies, simplices) < 0.0
    simplices[turned] = simplices[turned][:, ::-1]
    # of the images of a triangle, that whose first corner is a base point; first by number, then by image
    order = (base * 3 + image[:, 0] + 1) * 3 + image[:, 1] + 1
    first = simplices[np.arange(len(simplices)), order[simplices].argmin(axis=1)]
    own = simplices[(image[first] == 0).all(axis=1)]
    triangles = PeriodicTriangles(points, vectors, base[own], image[own])
    area = abs(np.linalg.det(vectors))
    if not (len(own) == 2 * len(points) and abs(triangles.areas.sum() - area) < 1e-9 * area):
        raise MeshError("the points of the cell leave a hole")
    return triangles


def _symmetric_field(points: Floats, vectors: Floats, group: Floats) -> Floats:
    """(N, 2) an irregular vector field that the lattice and the group map onto itself, at points (N, 2)."""
    fraction = np.einsum("gij,nj->gni", group, points) @ np.linalg.inv(vectors)
    phase = 2.0 * np.pi * fraction @ np.array([[3, 5, 7], [7, -4, 2]])
    waves = np.sin(phase + np.array([0.3, 1.7, 4.1]))
    field = waves @ np.random.default_rng(0).normal(size=(3, 2)) @ vectors / np.linalg.norm(vectors[0])
    return np.asarray(np.einsum("gji,gnj->ni", group, field))
