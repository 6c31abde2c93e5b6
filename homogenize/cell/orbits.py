"""Free mesh points that come in orbits of a cell's point group."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.spatial import cKDTree

from asterism.equilibrium.arrays import Bools, Floats, Ints
from asterism.homogenize.cell.periodic_delaunay import CELLS_AROUND

# of an edge: images of one point, and places that a symmetric mesh maps onto each other
ORBIT_TOLERANCE = 1e-6
# a point in general position, as parts of the lattice vectors; its neighbourhood is one fundamental domain
_GENERIC = np.array([0.2137, 0.0911])


def home(places: Floats, vectors: Floats) -> Floats:
    """(n, 2) mm, the images of places that lie in the cell."""
    return np.asarray(places - np.floor(places @ np.linalg.inv(vectors) + 1e-9) @ vectors)


def nearest_image(offsets: Floats, vectors: Floats) -> Floats:
    """(..., 2) mm, the shortest of the vectors that differ from an offset (..., 2) by lattice vectors."""
    rounded = offsets - np.rint(offsets @ np.linalg.inv(vectors)) @ vectors
    every = rounded[..., None, :] + CELLS_AROUND @ vectors
    nearest = np.linalg.norm(every, axis=-1).argmin(axis=-1)
    return np.asarray(np.take_along_axis(every, nearest[..., None, None], axis=-2)[..., 0, :])


@dataclass(frozen=True)
class Orbits:
    """Points of a cell, orbit by orbit.

    Attributes
    ----------
    seeds : (n, 2) mm, one point of each orbit.
    points : (N, 2) mm, in the cell.
    orbit : (N,) number of the orbit of each point.
    element : (N,) element of the group that takes the seed to the point.
    """

    seeds: Floats
    points: Floats
    orbit: Ints
    element: Ints

    @classmethod
    def of(cls, seeds: Floats, group: Floats, vectors: Floats, edge_mm: float) -> Orbits:
        """The orbits of seeds (n, 2); a seed that some elements keep has a smaller orbit."""
        every = home(np.einsum("gij,nj->ngi", group, seeds).reshape(-1, 2), vectors).reshape(len(seeds), len(group), 2)
        apart = np.linalg.norm(nearest_image(every[:, :, None] - every[:, None], vectors), axis=-1)
        is_copy = (np.tril(apart < ORBIT_TOLERANCE * edge_mm, -1)).any(axis=2)
        orbit, element = np.nonzero(~is_copy)
        return cls(seeds, every[orbit, element], orbit, element)

    def moved(self, points: Floats, group: Floats, vectors: Floats) -> Floats:
        """(n, 2) mm, new seeds from new places (N, 2) of all points: the mean over each orbit.

        A seed with a smaller orbit lies at the centre of a rotation and stays.
        """
        back = np.einsum("nji,nj->ni", group[self.element], points)  # inverse is the transpose
        step = nearest_image(back - self.seeds[self.orbit], vectors)
        count = np.bincount(self.orbit, minlength=len(self.seeds))
        mean = np.column_stack([np.bincount(self.orbit, one, len(self.seeds)) for one in step.T]) / count[:, None]
        return np.where((count == len(group))[:, None], self.seeds + mean, self.seeds)

    def gathered(self, distance: Floats, vectors: Floats) -> Floats:
        """(n, 2) mm, seeds; one that is closer than a distance (n,) to its images moves to the middle of them."""
        step = nearest_image(self.points - self.seeds[self.orbit], vectors)
        near = np.linalg.norm(step, axis=1) < distance[self.orbit]
        count = np.bincount(self.orbit[near], minlength=len(self.seeds))
        total = np.column_stack([np.bincount(self.orbit[near], one[near], len(self.seeds)) for one in step.T])
        return np.asarray(self.seeds + total / np.maximum(count, 1)[:, None])


def in_one_domain(places: Floats, group: Floats, vectors: Floats) -> Bools:
    """(n,) whether places (n, 2) lie in one fundamental domain of the group."""
    images = np.einsum("gij,j->gi", group, _GENERIC @ vectors)
    apart = np.linalg.norm(nearest_image(places[:, None] - images, vectors), axis=-1)
    return np.asarray(apart.argmin(axis=1) == 0)


def is_symmetric(places: Floats, group: Floats, vectors: Floats, edge_mm: float) -> bool:
    """Whether the group maps a set of places (n, 2) onto itself, up to lattice vectors."""
    copies = (home(places, vectors) + (CELLS_AROUND @ vectors)[:, None]).reshape(-1, 2)
    tree = cKDTree(copies)
    moved = home(np.einsum("gij,nj->gni", group[1:], places).reshape(-1, 2), vectors)
    return bool(len(moved) == 0 or tree.query(moved)[0].max() < ORBIT_TOLERANCE * edge_mm)
