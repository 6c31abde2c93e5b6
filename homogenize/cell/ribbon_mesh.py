"""The mesh of one period of a ribbon: lines of stars between two straight free sides, on the grid of the lattice.

The sides lie along a lattice direction, or across one. Grid point (i, j) lies at `(i A1 + j A2)/k`, and k edges reach
from star to star. Along a lattice direction the period is A1 and the lines of stars are k steps of j apart. Across, it
is `2 A2 - A1`, and the lines are k steps of `2 i + j` apart: half a spacing.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from asterism.equilibrium.arrays import Ints
from asterism.homogenize.cell.aligned_lines import aligned_lines
from asterism.homogenize.cell.image_numbering import ImageNumbering
from asterism.homogenize.cell.periodic_mesh import PeriodicMesh
from asterism.pattern.design.lattice import Lattice
from asterism.pattern.geometry.plane_lattice import GRID_DIRECTIONS


@dataclass(frozen=True)
class RibbonShape:
    """A ribbon on the grid.

    Attributes
    ----------
    across : the sides lie across a lattice direction, not along one.
    lines : of stars, along the sides.
    rim : grid steps from the last lines of stars to the sides.
    steps : k, edges from star to star.
    arm : edges of an arm.
    """

    across: bool
    lines: int
    rim: int
    steps: int
    arm: int

    @property
    def period(self) -> Ints:
        """(2,) grid steps of one period."""
        return np.array([-self.steps, 2 * self.steps] if self.across else [self.steps, 0])

    @property
    def sides(self) -> tuple[int, int]:
        """Numbers of the grid lines of both sides; the first line of stars has the number zero."""
        return -self.rim, (self.lines - 1) * self.steps + self.rim

    def line(self, points: Ints) -> Ints:
        """Number of the grid line of grid points (..., 2)."""
        return np.asarray(2 * points[..., 0] + points[..., 1] if self.across else points[..., 1])

    def period_of(self, points: Ints) -> Ints:
        """Number of the period of grid points (..., 2)."""
        return np.asarray(points[..., 1] // (2 * self.steps) if self.across else points[..., 0] // self.steps)


def ribbon_mesh(lattice: Lattice, shape: RibbonShape) -> PeriodicMesh:
    """Mesh of one period. The second cell vector is none of the ribbon's: it is the width across the period.

    Raises
    ------
    ValueError
        The arms do not lie on lattice lines.
    """
    arms = aligned_lines(lattice)
    if arms is None:
        raise ValueError("a ribbon cell needs arms along lattice lines")
    vectors = np.asarray(lattice.vectors)
    triangles = _triangles(shape)
    own = shape.period_of(_first(triangles)) == 0
    corners = np.unique(triangles[own].reshape(-1, 2), axis=0)
    base = np.unique(corners - shape.period_of(corners)[:, None] * shape.period, axis=0)
    known, numbering = {tuple(point): n for n, point in enumerate(base.tolist())}, ImageNumbering(len(base))

    def number(points: Ints) -> Ints:
        flat = points.reshape(-1, 2)
        period = shape.period_of(flat)
        at = np.array([known[tuple(point)] for point in (flat - period[:, None] * shape.period).tolist()])
        return numbering(at, period, np.zeros_like(period)).reshape(points.shape[:-1])

    stars = _stars(shape)
    rods, owner = [], []
    for star, centre in enumerate(stars):
        for arm in arms:
            path = centre + np.arange(shape.arm + 1)[:, None] * GRID_DIRECTIONS[arm]
            line = shape.line(path)
            rods.append(number(path[(line >= shape.sides[0]) & (line <= shape.sides[1])]))
            owner.append(star)
    elements, hinges, centres = number(triangles[own]), number(_hinges(triangles, shape)), number(stars)
    at, image = numbering.unfolded()
    step = vectors / shape.steps
    along = shape.period @ step
    width = (shape.sides[1] - shape.sides[0]) * (np.linalg.norm(step[0]) * (0.5 if shape.across else np.sqrt(0.75)))
    second = width * np.array([-along[1], along[0]]) / np.linalg.norm(along)
    return PeriodicMesh(
        points=base[at] @ step + image[:, :1] * along,
        base=at,
        image=image,
        triangles=elements,
        around=np.empty((0, 3), dtype=np.int64),
        hinges=hinges,
        rods=tuple(rods),
        arm_star=np.array(owner, dtype=np.int64),
        star_vertices=centres,
        cell_vectors=np.array([along, second]),
        n_base=len(base),
    )


def _triangles(shape: RibbonShape) -> Ints:
    """(T, 3, 2) grid points of the triangles of several periods, counterclockwise."""
    low, high = shape.sides
    reach = np.arange(-8 * shape.steps - abs(high), 8 * shape.steps + abs(high))
    grid = np.stack(np.meshgrid(reach, reach, indexing="ij"), axis=-1).reshape(-1, 2)
    grid = grid[np.abs(shape.period_of(grid)) <= 2]
    every = np.concatenate([_moved(grid, (0, 0), (1, 0), (0, 1)), _moved(grid, (1, 0), (1, 1), (0, 1))])
    if shape.across:  # halves of triangles, where the side cuts a zigzag of the grid
        line = shape.line(grid)
        left, right = grid[line == low], grid[line == high]
        halves = _moved(left, (0, 0), (0, 1), (-1, 2)), _moved(right, (0, 0), (-1, 2), (-1, 1))
        every = np.concatenate([every, *halves])
    line = shape.line(every)
    return np.asarray(every[((line >= low) & (line <= high)).all(axis=1)])


def _moved(points: Ints, *steps: tuple[int, int]) -> Ints:
    """(n, m, 2) grid points (n, 2), moved by m steps."""
    return np.asarray(points[:, None] + np.array(steps))


def _first(groups: Ints) -> Ints:
    """(n, 2) the first grid point, by j and then i, of groups of points (n, m, 2): one choice for all images."""
    rank = groups[..., 1] * (1 << 20) + groups[..., 0]
    return np.asarray(np.take_along_axis(groups, rank.argmin(axis=1)[:, None, None], axis=1)[:, 0])


def _hinges(triangles: Ints, shape: RibbonShape) -> Ints:
    """(H, 4, 2) grid points of the hinges of one period: edge, left apex, right apex."""
    sides: dict[tuple[int, ...], tuple[Ints, Ints, Ints]] = {}
    out = []
    for corner in triangles:
        for a in range(3):
            start, end, apex = corner[a], corner[(a + 1) % 3], corner[(a + 2) % 3]
            other = sides.pop((*end.tolist(), *start.tolist()), None)
            if other is None:
                sides[*start.tolist(), *end.tolist()] = start, end, apex
            else:
                out.append([other[0], other[1], other[2], apex])
    hinges = np.array(out)
    return np.asarray(hinges[shape.period_of(_first(hinges[:, :2])) == 0])


def _stars(shape: RibbonShape) -> Ints:
    """(S, 2) grid points of the stars of one period."""
    reach = 3 * shape.lines + 3
    sites = shape.steps * np.stack(np.meshgrid(*[np.arange(-reach, reach + 1)] * 2, indexing="ij"), -1).reshape(-1, 2)
    line = shape.line(sites)
    return np.asarray(sites[(shape.period_of(sites) == 0) & (line >= 0) & (line <= (shape.lines - 1) * shape.steps)])
