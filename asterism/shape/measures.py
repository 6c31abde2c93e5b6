"""Measures of a shape: contraction, height over its needles, and the best-fit circular cylinder of a roll."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
from scipy.spatial import cKDTree

from asterism.equilibrium.arrays import Floats, Ints
from asterism.pattern.geometry.normals import vertex_normals
from asterism.pattern.layout.layout import Layout, off_sheet_mm
from asterism.process.version import __version__
from asterism.shape.cell_mean import CellMean
from asterism.shape.shape import Shape

if TYPE_CHECKING:  # slow to import
    from asterism.discrete.release.equilibrium import Equilibrium
    from asterism.fem.search.relax import ShellEquilibrium


def shape_numbers(
    layout: Layout, shape: Shape, end: Equilibrium | ShellEquilibrium, roll_axis_deg: float | None
) -> dict[str, Any]:
    """The numbers that the summaries of both models have, by their keys; `end` is where the search has ended."""
    above, below = needle_clearance(layout, shape) or (None, None)
    same = ("converged", "is_minimum", "gradient_norm", "iterations", "factorisations", "saddles_left")
    return {name: getattr(end, name) for name in same} | {
        "gradient_tolerance": end.tolerance,
        "energy_n_mm": end.energy,
        "energy_parts_n_mm": end.energies,
        "roll_axis_deg": roll_axis_deg,
        "roll_radius_mm": None if roll_axis_deg is None else _roll_radius(shape, layout),
        "height_mm": shape.height_mm,
        "extent_mm": list(shape.extent_mm),
        "printed_mm": np.ptp(layout.outline, axis=0).tolist(),
        "above_needles_mm": above,
        "below_needles_mm": below,
        "contraction": contraction(layout, shape),
        "vertices": len(shape.printed),
        "triangles": len(shape.triangles),
        "version": __version__,
    }


def contraction(layout: Layout, shape: Shape) -> float | None:
    """Mean distance of neighbouring star centres in space over that in print; None for a single star.

    Of a drawing without stars, the same of neighbouring sites of its lattice: that of its motif, or a square lattice
    with the mean distance of its rods.
    """
    pairs = layout.sample_pairs
    if len(pairs) == 0:
        return None
    printed = layout.sample_points
    at = shape.positions[shape.star_vertices] if layout.has_stars else shape.at(printed, layout.spacing_mm)
    places = at, printed
    in_space, in_print = (np.linalg.norm(centres[pairs[:, 0]] - centres[pairs[:, 1]], axis=1) for centres in places)
    return float(in_space.mean() / in_print.mean())


def sample_vertices(layout: Layout, shape: Shape) -> Ints:
    """(n,) vertices at the star centres, or nearest to the sites of a drawing's lattice."""
    if layout.has_stars:
        return shape.star_vertices
    return np.asarray(cKDTree(shape.printed).query(layout.sample_points)[1])


def _roll_radius(shape: Shape, layout: Layout) -> float | None:
    """Radius in mm of the cylinder that fits the cell means at `sample_vertices`; None as for `tube_radius`."""
    stars = sample_vertices(layout, shape)
    stars = stars if layout.has_stars else np.unique(stars)  # sites may share a vertex
    middles = CellMean(shape.printed, shape.weights, layout.lattice_vectors, stars)(shape.positions)
    return tube_radius(middles, vertex_normals(shape.positions, shape.triangles)[stars])


def tube_radius(points: Floats, normals: Floats) -> float | None:
    """Radius in mm of the circular cylinder that fits points (n, 3) mm best in the sense of least squares.

    None for fewer than five points, and if a plane fits nearly as well.

    Axis, position and radius are free. The initial axis is the direction most nearly perpendicular to the unit normals
    (n, 3). The initial circle is the algebraic fit of Kasa 1976 to the points, projected along this axis.
    """
    if len(points) < 5:  # several cylinders pass through four points
        return None
    from scipy.optimize import leastsq  # slow to import; sheets that are not rolled do without it

    points = points - points.mean(axis=0)
    directions = np.linalg.svd(normals, full_matrices=False)[2][::-1]
    axis, across = directions[0], directions[1:]
    seen = points @ across.T
    middle = np.linalg.lstsq(np.column_stack([2.0 * seen, np.ones(len(seen))]), (seen**2).sum(axis=1))[0]
    radius = np.sqrt(max(middle[2] + middle[:2] @ middle[:2], 0.0))

    def placed(a: Floats) -> tuple[Floats, Floats]:
        """(n,) coordinate of each point along the axis, and (n, 3) its vector from the axis."""
        along = axis + a[:2] @ across
        places = points - a[2:4] @ across
        height = places @ along / (along @ along)
        return height, places - height[:, None] * along

    def residuals(a: Floats) -> Floats:
        return np.asarray(np.linalg.norm(placed(a)[1], axis=1) - a[4])

    def slopes(a: Floats) -> Floats:
        height, outwards = placed(a)
        outwards = outwards / np.maximum(np.linalg.norm(outwards, axis=1), 1e-12)[:, None]
        moved = outwards @ across.T
        return np.column_stack([-height[:, None] * moved, -moved, -np.ones(len(points))])

    # Levenberg-Marquardt; `least_squares` would take several times as long for such a small problem
    cylinder, *_ = leastsq(residuals, [0.0, 0.0, *middle[:2], radius], Dfun=slopes)
    flat = np.linalg.svd(points, compute_uv=False)[2]
    # a cylinder counts as a fit only if its distance to the points is below this part of the distance of the best plane
    return float(abs(cylinder[4])) if np.linalg.norm(residuals(cylinder)) < 0.9 * flat else None


def needle_clearance(layout: Layout, shape: Shape) -> tuple[float, float] | None:
    """The heights (mm) of a sheet over its highest support and below its lowest one; None for a free sheet."""
    printed = layout.support_samples.printed
    if len(printed) == 0:
        return None
    supported, heights = shape.at(printed, off_sheet_mm(layout, len(shape.printed)))[:, 2], shape.positions[:, 2]
    above, below = heights.max() - supported.max(), supported.min() - heights.min()
    return max(float(above), 0.0), max(float(below), 0.0)
