"""The tube that a rolled sheet is nearest to."""

from __future__ import annotations

import numpy as np
from scipy.optimize import leastsq

from asterism.shape.cell_mean import CellMean
from asterism.shape.shape import Shape
from pattern.geometry.arrays import Floats
from pattern.geometry.normals import vertex_normals

# of the distance to a plane, in which a tube must be closer
BENT = 0.9


def roll_radius(shape: Shape, lattice_vectors: Floats) -> float | None:
    """mm, of the tube nearest to the shape's means over the cells of its stars; None where `tube_radius` has none."""
    stars = shape.star_vertices
    middles = CellMean(shape.printed, shape.weights, lattice_vectors, stars)(shape.positions)
    return tube_radius(middles, vertex_normals(shape.positions, shape.triangles)[stars])


def tube_radius(points: Floats, normals: Floats) -> float | None:
    """mm, of the circular cylinder closest to points (n, 3) mm in the sense of least squares.

    None of fewer than five points, and where a plane is nearly as close.

    Axis, place and radius are free. The search starts from the direction that the unit normals (n, 3) of the sheet are
    most nearly across, and from Kasa's circle through the points as they are seen along it.
    """
    if len(points) < 5:  # through four there are many
        return None
    points = points - points.mean(axis=0)
    directions = np.linalg.svd(normals, full_matrices=False)[2][::-1]
    axis, across = directions[0], directions[1:]
    seen = points @ across.T
    middle = np.linalg.lstsq(np.column_stack([2.0 * seen, np.ones(len(seen))]), (seen**2).sum(axis=1))[0]
    radius = np.sqrt(max(middle[2] + middle[:2] @ middle[:2], 0.0))

    def placed(a: Floats) -> tuple[Floats, Floats]:
        """Each point's place along the axis, over the length of its direction, and across it."""
        along = axis + a[:2] @ across
        places = points - a[2:4] @ across
        height = places @ along / (along @ along)
        return height, places - height[:, None] * along

    def off(a: Floats) -> Floats:
        return np.asarray(np.linalg.norm(placed(a)[1], axis=1) - a[4])

    def slopes(a: Floats) -> Floats:
        height, outwards = placed(a)
        outwards = outwards / np.maximum(np.linalg.norm(outwards, axis=1), 1e-12)[:, None]
        moved = outwards @ across.T
        return np.column_stack([-height[:, None] * moved, -moved, -np.ones(len(points))])

    # Levenberg and Marquardt's method; what `least_squares` does around it takes several times as long
    found, *_ = leastsq(off, [0.0, 0.0, *middle[:2], radius], Dfun=slopes)
    flat = np.linalg.svd(points, compute_uv=False)[2]
    return float(abs(found[4])) if np.linalg.norm(off(found)) < BENT * flat else None
