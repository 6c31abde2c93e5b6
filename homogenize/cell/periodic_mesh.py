"""A periodic triangle mesh of a unit cell, unfolded to the points that its elements use."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from asterism.equilibrium.arrays import Floats, Ints

# of the spacing: ends of arms that are closer are one point
TOUCHING_TOLERANCE = 1e-6


@dataclass(frozen=True)
class PeriodicMesh:
    """A periodic mesh, unfolded: every point that an element uses is an image of a base point.

    Attributes
    ----------
    points : (U, 2) mm of the print; the first `n_base` are the base points.
    base : (U,) base point of each point.
    image : (U, 2) numbers of cell vectors A1 and A2 from the base point to the point.
    triangles : (T, 3) counterclockwise, one of each class of images.
    around : (R, 3) images of triangles around those; none if the elements need no neighbours.
    hinges : (H, 4) edge, left apex, right apex; one of each class.
    rods : paths of vertices along the arms, from the star's centre, each star in one piece; or along the rods of a
        motif, cell by cell, each rod in one piece.
    arm_star : (rods,) star of each arm; empty for a motif.
    star_vertices : (S,) centres of the stars; empty for a motif.
    cell_vectors : (2, 2) mm, rows.
    n_base : V.
    """

    points: Floats
    base: Ints
    image: Ints
    triangles: Ints
    around: Ints
    hinges: Ints
    rods: tuple[Ints, ...]
    arm_star: Ints
    star_vertices: Ints
    cell_vectors: Floats
    n_base: int

    @property
    def area(self) -> float:
        """mm^2 of the printed cell."""
        (a, b), (c, d) = self.cell_vectors
        return float(abs(a * d - b * c))


class ImageNumbering:
    """Numbers of the points that the elements of a periodic mesh use."""

    def __init__(self, n_base: int) -> None:
        self._n_base = n_base
        self._images: dict[tuple[int, int, int], int] = {}

    def __call__(self, point: Ints, first: Ints, second: Ints) -> Ints:
        """(N,) numbers of the images of base points (N,), so many cell vectors A1 and A2 away."""
        out = np.empty(len(point), dtype=np.int64)
        for place, (p, a, b) in enumerate(zip(point, first, second, strict=True)):
            if a == 0 and b == 0:
                out[place] = p
            else:
                key = (int(p), int(a), int(b))
                out[place] = self._images.setdefault(key, self._n_base + len(self._images))
        return out

    def unfolded(self) -> tuple[Ints, Ints]:
        """Base point (U,) and image (U, 2) of all numbered points."""
        own = np.arange(self._n_base)
        images = np.array(list(self._images), dtype=np.int64).reshape(-1, 3)
        base = np.concatenate([own, images[:, 0]])
        return base, np.concatenate([np.zeros((len(own), 2), dtype=np.int64), images[:, 1:]])


def new_triangles(some: Ints, known: Ints) -> Ints:
    """The triangles (n, 3) of `some` that are not among the known ones, each once."""
    every = np.concatenate([known, some])
    first = np.unique(np.sort(every, axis=1), axis=0, return_index=True)[1]
    return every[np.sort(first[first >= len(known)])]
