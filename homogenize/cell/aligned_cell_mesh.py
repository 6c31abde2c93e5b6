"""The aligned mesh of a unit cell: a grid that refines the lattice, closed to a torus, with arms on its lines.

The cell is the parallelogram of the lattice vectors A1 and A2, or n x m of them. Grid point (i, j) lies at
`i A1/k + j A2/k`. Indices are taken modulo the cell, and the quotient gives the lattice vectors to the image. Stars sit
at the corners of the single cells. Their arms run along A1, A2 or A2 - A1, in either sense, and may leave the cell.
"""

from __future__ import annotations

import numpy as np

from asterism.equilibrium.arrays import Floats, Ints
from asterism.homogenize.cell.aligned_cell_grid import (
    cell_grading,
    graded_stations,
    grid_displacement,
    link_reach,
    link_stations,
    tips_meet,
)
from asterism.homogenize.cell.image_numbering import ImageNumbering, new_triangles
from asterism.homogenize.cell.periodic_mesh import PeriodicMesh
from asterism.pattern.geometry.plane_lattice import GRID_DIRECTIONS


def aligned_cell_mesh(
    lattice_vectors: Floats,
    directions: Ints,
    lengths: Floats,
    edge_mm: float,
    repeat: tuple[int, int] = (1, 1),
    segments: int | None = None,
    surrounded: bool = False,
    graded: bool = False,
) -> PeriodicMesh:
    """Mesh of `repeat` cells with equal stars.

    Parameters
    ----------
    lattice_vectors : (2, 2) mm, rows, as of `Lattice.vectors`.
    directions : (N,) of the arms, indices into `GRID_DIRECTIONS`.
    lengths : (N,) mm, up to the distance to the next star in that direction.
    edge_mm : of the grid, about.
    segments : edges of every arm but those whose tips meet; the nearest number to its length by default.
    surrounded : with the triangles around, whose points are then unfolded too.
    graded : as many triangles, but finer ones at arms and tips, as in graded sheets (`pattern.mesh.grading`).

    Raises
    ------
    MeshError
        Arms from both ends of a link overlap.
    """
    k = edges_per_spacing(lattice_vectors, directions, lengths, edge_mm)
    n, m = repeat[0] * k, repeat[1] * k
    grading = cell_grading(lattice_vectors, directions, lengths, repeat) if graded and len(directions) else None
    links = link_stations(directions, link_reach(lattice_vectors, directions, lengths), k, segments)
    if grading is not None:
        links = graded_stations(links, GRID_DIRECTIONS[directions] @ lattice_vectors, directions, lengths, grading)
    numbering = _Numbering(n, m)
    i, j = (index.ravel() for index in np.indices((n, m)))
    step = lattice_vectors / k
    moved = np.column_stack([i, j]) @ step + grid_displacement(repeat, k, lattice_vectors, links, grading)

    def at(di: int, dj: int) -> Ints:
        return numbering(i + di, j + dj)

    lower = np.column_stack([at(0, 0), at(1, 0), at(0, 1)])
    upper = np.column_stack([at(1, 0), at(1, 1), at(0, 1)])
    triangles = np.concatenate([lower, upper])
    hinges = np.concatenate(
        [
            np.column_stack([at(0, 0), at(1, 0), at(0, 1), at(1, -1)]),
            np.column_stack([at(0, 0), at(0, 1), at(-1, 1), at(1, 0)]),
            np.column_stack([at(1, 0), at(0, 1), at(0, 0), at(1, 1)]),
        ]
    )
    stars = [(a * k, b * k) for a in range(repeat[0]) for b in range(repeat[1])]
    rods, owner = [], []
    for number, (si, sj) in enumerate(stars):
        for direction in directions:
            along = np.arange(links.segments[direction] + 1)
            di, dj = GRID_DIRECTIONS[direction]
            rods.append(numbering(si + along * di, sj + along * dj))
            owner.append(number)
    centres = np.array([int(numbering(np.array([a]), np.array([b]))[0]) for a, b in stars])
    around: Ints = np.empty((0, 3), dtype=np.int64)
    if surrounded:
        near = [[(-1, 1), (0, 0), (0, 1)], [(1, -1), (1, 0), (0, 0)], [(1, 0), (2, 0), (1, 1)]]
        near.append([(0, 1), (1, 1), (0, 2)])
        around = new_triangles(
            np.concatenate([np.column_stack([at(*step) for step in three]) for three in near]), triangles
        )
    base, image = numbering.unfolded()
    cell = lattice_vectors * np.array(repeat)[:, None]
    return PeriodicMesh(
        points=moved[base] + image @ cell,
        base=base,
        image=image,
        triangles=triangles,
        around=around,
        hinges=hinges,
        rods=tuple(rods),
        arm_star=np.array(owner, dtype=np.int64),
        star_vertices=centres,
        cell_vectors=cell,
        n_base=n * m,
    )


def edges_per_spacing(lattice_vectors: Floats, directions: Ints, lengths: Floats, edge_mm: float) -> int:
    """Grid edges between adjacent stars, an even number if tips meet in the middle; see `aligned_cell_mesh`."""
    wish = float(np.linalg.norm(GRID_DIRECTIONS @ lattice_vectors, axis=1).min()) / edge_mm
    if tips_meet(link_reach(lattice_vectors, directions, lengths)).any():
        return max(4, 2 * round(wish / 2))
    return max(3, round(wish))


class _Numbering:
    """Numbers of unfolded grid points."""

    def __init__(self, n: int, m: int) -> None:
        self._n, self._m = n, m
        self._number = ImageNumbering(n * m)

    def __call__(self, i: Ints, j: Ints) -> Ints:
        i, j = np.asarray(i), np.asarray(j)
        return self._number((i % self._n) * self._m + j % self._m, i // self._n, j // self._m)

    def unfolded(self) -> tuple[Ints, Ints]:
        return self._number.unfolded()
