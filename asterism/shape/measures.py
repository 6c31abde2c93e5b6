"""What the summaries of both models say of a sheet: measures of its shape, means over cells, warnings of its design."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING, Any

import numpy as np
from scipy.sparse import coo_array, csr_array, vstack
from scipy.spatial import cKDTree

from asterism.equilibrium.arrays import Floats, Ints
from asterism.pattern.design.design import Design
from asterism.pattern.design.sizing.profiles import GradientProfile
from asterism.pattern.design.stars import SIZE_KEYS
from asterism.pattern.geometry.normals import vertex_normals
from asterism.pattern.layout.free_motions import count_free_tilts
from asterism.pattern.layout.layout import Layout
from asterism.process.version import __version__
from asterism.shape.shape import Shape

if TYPE_CHECKING:
    from asterism.discrete.release.equilibrium import Equilibrium
    from asterism.fem.search.relax import ShellEquilibrium


class CellMean:
    """Means over the lattice cells around the vertices of a mesh, as a sparse matrix.

    The mean removes bumps that repeat from star to star. The outline cuts the cells near it, for both shapes of a
    comparison in the same way.

    Parameters
    ----------
    points : (V, 2) mm, vertices of the printed mesh.
    weights : (V,) mm^2, printed area of each vertex; any other unit gives the same means.
    lattice_vectors : (2, 2) mm, rows.
    at : (k,) vertices whose means are computed; all by default.

    Examples
    --------
    Means along a row of points with a bump at every lattice point; the row's end cuts the last cell:

    >>> row = np.column_stack([np.arange(9.0), np.zeros(9)])
    >>> mean = CellMean(row, np.ones(9), np.diag([2.0, 2.0]))
    >>> bumps = row[:, :1] % 2
    >>> mean(bumps).ravel().round(3).tolist()
    [0.333, 0.5, 0.5, 0.5, 0.5, 0.5, 0.5, 0.5, 0.333]
    >>> mean.serves(row, np.ones(9)), mean.serves(row[:5], np.ones(5))
    (True, False)
    """

    def __init__(self, points: Floats, weights: Floats, lattice_vectors: Floats, at: Ints | None = None) -> None:
        # opposite steps give one pair of parallel borders
        steps = np.array([[1, 0], [0, 1], [1, 1], [1, -1]]) @ lattice_vectors
        lengths = (steps**2).sum(axis=1)
        # each point of the plane is within half the diagonal of a rectangle of these sides from a lattice point
        reach = 0.5 * float(np.linalg.norm(lattice_vectors))
        # a point this near to the border of a cell, relative to the spacing, counts as on the border
        tolerance = 1e-6
        near = tolerance * reach**2
        reach *= 1.0 + tolerance
        tree = cKDTree(points)
        rows = []
        middles = points if at is None else points[at]
        piece = 2000  # points whose neighbourhoods are searched together; limits the memory
        for begin in range(0, len(middles), piece):
            some = middles[begin : begin + piece]
            pairs = cKDTree(some).sparse_distance_matrix(tree, reach, output_type="ndarray")
            i, j = pairs["i"], pairs["j"]
            # how much nearer a point is to the middle of its cell than to that of the cell beyond each pair of borders
            nearer = lengths - 2.0 * np.abs((points[j] - some[i]) @ steps.T)
            inside = (nearer >= -near).all(axis=1)
            i, j, nearer = i[inside], j[inside], nearer[inside]
            # a point on the border between two cells counts by half in each
            part = weights[j] / (1.0 + (nearer <= near).sum(axis=1))
            rows.append(coo_array((part, (i, j)), shape=(len(some), len(points))).tocsr())
        matrix = csr_array(vstack(rows))
        matrix.data /= np.repeat(matrix.sum(axis=1), np.diff(matrix.indptr))
        self._matrix = matrix
        self._printed = points, weights

    def serves(self, points: Floats, weights: Floats) -> bool:
        """Whether these are the vertices (V, 2) mm and areas (V,) of the mesh: then the means serve it, too."""
        return all(map(np.array_equal, self._printed, (points, weights)))

    def __call__(self, values: Floats) -> Floats:
        """(k, m) means of values (V, m) at the vertices."""
        return np.asarray(self._matrix @ values)


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
    supported, heights = shape.at_edges(printed)[:, 2], shape.positions[:, 2]
    above, below = heights.max() - supported.max(), supported.min() - heights.min()
    return max(float(above), 0.0), max(float(below), 0.0)


def pin_warnings(layout: Layout, weighs: bool) -> Iterator[str]:
    """Yield one line for each warning; weight determines how a sheet hangs."""
    yield from held_wide(layout)
    if layout.pins and not weighs and (axes := count_free_tilts(layout)):
        about = "a point" if axes > 1 else "a line"
        yield f"the pins let the sheet turn about {about}: its orientation, and with it its height, is arbitrary"


def held_wide(layout: Layout) -> Iterator[str]:
    """Yield a line if the pins pull the sheet wider than it was printed, often by a scale given in percent."""
    printed, places, _ = layout.support_samples
    held = ~np.isnan(places[:, :2]).any(axis=1)
    if not held.any():
        return
    places = np.nan_to_num(places)  # points that slide along z count with height 0
    in_print, in_space = (np.linalg.norm(points[held] - points[held].mean(axis=0)) for points in (printed, places))
    # size of the supports in space over their size in print, above which a warning appears
    if in_space > 1.05 * in_print > 0.0:
        wide = f"{in_space / in_print:.3g} times as wide as it was printed"
        yield f"the pins hold the sheet {wide}: its fabric is stretched further than on the printer"


def site_warnings(layout: Layout) -> Iterator[str]:
    """Yield a line if entries of `stars.override` are for sites outside of the sheet."""
    if not (count := len(layout.ignored_sites)):
        return
    named = ", ".join(str(site) for site in layout.ignored_sites[:5].tolist())
    more = ", ..." if count > 5 else ""
    entries = "1 entry of stars.override is" if count == 1 else f"{count} entries of stars.override are"
    yield f"{entries} for sites outside of the sheet, and ignored: {named}{more}"


def sizing_warnings(design: Design, layout: Layout) -> Iterator[str]:
    """Yield a line for each profile whose stars all have nearly one of its two end values."""
    if len(layout.centres) < 2:
        return
    for name in ("length_fraction", *SIZE_KEYS):
        profile = getattr(design.stars, name)
        if not isinstance(profile, GradientProfile) or profile.start == profile.end:
            continue
        part = profile.fraction(layout.centres).clip(0.0, 1.0)
        # a profile that spans less than 2 % of the way from `from` to `to` counts as constant
        if part.max() < 0.02 or part.min() > 0.98:
            key, value = ("from", profile.start) if part.max() < 0.02 else ("to", profile.end)
            yield (
                f"stars.{name} varies from {profile.start:g} to {profile.end:g}, but all stars have nearly the value "
                f"of {key}, {value:g}: are the places and distances of the profile in mm?"
            )
