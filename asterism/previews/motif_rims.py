"""The rims of a motif's sheet: bare fabric beyond the rods, and the work of its tension.

**Bare fabric.** In an endless pattern no place is farther from a rod than a certain reach: half the distance of
parallel lines. A rim is as wide as that, or narrower, wherever the outline cuts the pattern; it belongs to the motif,
as the fabric between rods does. Beyond, the fabric is bare; this is averaged over the neighbourhood, since the shell's
mesh is coarse.

**Gaussian modulus.** In a flat sheet the fabric is in tension, and its rods are in compression. Gaussian curvature K
does the work `-phi K` on these forces. Airy's stress function phi vanishes at the rim, and so does its slope.
From a side inwards, fabric of the tension N along the side raises phi to `N w^2/2` at the first rod, at the distance w.
The rods then balance the fabric midway to the next rod, if their distance is d. So the mean of phi over a cell beside
the side is

    Phi = N (mean of w^2/2 - d^2/12),

which is `N d^2/24` if the outline cuts the pattern midway between rods. The shell itself has the part `N s^2/2` of bare
fabric of the width s (`asterism.previews.motif_sheet`), which is taken off. At sides along which no rods run,
Phi is zero in the mean. Smeared rods need carry no other forces between the sides; so phi there is taken as the mean of
the sides' values, weighted by length over distance. The rim of a hole is a rim like the outer one. At each, phi is
free up to a constant, whose work on K is one on the geodesic curvature of the rim (Gauss and Bonnet). A hole smaller
than a cell of the lattice has no rim along which rods could run: there phi continues as in the sheet around.

Phi may exceed the bending stiffness. The membrane then keeps the sheet stable, because Gaussian curvature stretches it.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import shapely
from scipy.ndimage import gaussian_filter, map_coordinates

from asterism.equilibrium.arrays import Floats
from asterism.pattern.design.design import Design
from asterism.pattern.geometry.planar import distance_to_segment, polygon_area
from asterism.pattern.layout.layout import Layout
from asterism.pattern.layout.sheet_edges import SheetEdges
from asterism.pattern.rods.curves import polyline

# points along each lattice vector at which the endless pattern is sampled
SAMPLES = 40
# copies of the motif on each side of a cell
COPIES = 2
# points of the grid along the longer side of a sheet, at most
MAX_GRID = 600
# relative: places at the reach but for rounding belong to the pattern
REACH_TOLERANCE = 1e-3


def reach_mm(design: Design) -> float:
    """Largest distance of a place of the endless pattern from its nearest rod.

    Examples
    --------
    >>> lines = Design.from_dict({
    ...     "rods": {"motif": [{"line_mm": [(0, 0), (5, 0)]}]}, "lattice": {"kind": "square", "spacing_mm": 5.0},
    ...     "border": {"rectangle_mm": (40, 40)},
    ... })
    >>> reach_mm(lines)
    2.5
    """
    vectors = np.asarray(design.lattice.vectors)
    steps = np.arange(-COPIES, COPIES + 1)
    shifts = np.stack(np.meshgrid(steps, steps, indexing="ij"), axis=-1).reshape(-1, 2) @ vectors
    lines = [polyline(line, design.required_rods.curve_mm) for line in design.required_rods.motif]
    drawn = shapely.MultiLineString([line + shift for shift in shifts for line in lines])
    parts = np.arange(SAMPLES) / SAMPLES
    places = np.stack(np.meshgrid(parts, parts, indexing="ij"), axis=-1).reshape(-1, 2) @ vectors
    return float(shapely.distance(drawn, shapely.points(places)).max())


def small_holes(layout: Layout) -> list[int]:
    """Numbers of the holes that are smaller than a cell of the lattice."""
    cell = abs(float(np.linalg.det(layout.lattice_vectors)))
    return [k for k, ring in enumerate(layout.edges.rings[1:]) if -polygon_area(ring) < cell]


def holes_within_cells(layout: Layout, tip_margin_mm: float) -> list[int]:
    """Numbers of the holes that are smaller than a cell of the lattice and cut off rods."""
    ends = shapely.multipoints(np.concatenate([rod.points[[0, -1]] for rod in layout.graph.rods]))
    reach = (1.0 + REACH_TOLERANCE) * tip_margin_mm
    return [k for k in small_holes(layout) if shapely.distance(shapely.Polygon(layout.holes[k]), ends) <= reach]


def bare_share(layout: Layout, reach: float, smoothing: float, points: Floats) -> Floats:
    """(n,) from 0 in the pattern to 1 on bare fabric, at printed points (n, 2) mm.

    Parameters
    ----------
    reach : mm, from `reach_mm`; places farther from all rods are bare.
    smoothing : mm, standard deviation of the Gaussian over which that is averaged on the sheet.
    """
    low, high = layout.outline.min(axis=0), layout.outline.max(axis=0)
    step = max(min(reach / 5.0, 0.5 * smoothing), float((high - low).max()) / MAX_GRID)
    x, y = (np.arange(a - 0.5 * step, b + step, step) for a, b in zip(low, high, strict=True))
    grid = np.stack(np.meshgrid(x, y, indexing="ij"), axis=-1)
    on_sheet = layout.is_on_sheet(grid.reshape(-1, 2)).reshape(grid.shape[:2])
    drawn = shapely.MultiLineString([rod.points for rod in layout.graph.rods])
    shapely.prepare(drawn)  # unlike distances, this question uses it
    is_bare = np.zeros(on_sheet.shape)
    is_bare[on_sheet] = ~shapely.dwithin(drawn, shapely.points(grid[on_sheet]), (1.0 + REACH_TOLERANCE) * reach)
    if not is_bare.any():
        return np.zeros(len(points))
    bare, whole = (gaussian_filter(each, smoothing / step, mode="constant") for each in (is_bare, on_sheet * 1.0))
    share = np.divide(bare, whole, out=np.zeros_like(bare), where=whole > 1e-9)
    at = (points - [x[0], y[0]]) / step
    return np.clip(map_coordinates(share, at.T, order=1, mode="nearest"), 0.0, 1.0)


# distance of the places of a side at which rims are measured, in spacings of the lattice
SAMPLE_SPACINGS = 0.05
# how far inwards rods are looked for, in their mean distances
REACH_DISTANCES = 3.0
# of the places of a side: with fewer places that have a rod inwards, rods end at this side and lie along no part of it
MIN_MET_SHARE = 0.8


@dataclass(frozen=True)
class Rims:
    """The sides of a sheet.

    Attributes
    ----------
    start, end : (B, 2) mm, of each side of the outline, and of holes that are larger than a cell.
    along : (B, 2) unit vectors along them.
    moment_mm2 : (B,) Phi over N.
    """

    start: Floats
    end: Floats
    along: Floats
    moment_mm2: Floats

    def gaussian(self, tension: Floats, points: Floats) -> Floats:
        """(n,) N mm, the Gaussian modulus -phi at printed points (n, 2) mm.

        Parameters
        ----------
        tension : (n, 3) N/mm, of the fabric in the flat sheet, components 11, 22, 12, in printed coordinates.
        """
        x, y = self.along.T
        across = np.stack([x * x, y * y, 2.0 * x * y])  # of the tension along each side
        length = np.linalg.norm(self.end - self.start, axis=1)
        away = distance_to_segment(points[:, None], self.start, self.end)
        weight = length / np.maximum(away, 1e-3 * length.max())
        return -np.asarray((weight * (tension @ across) * self.moment_mm2).sum(axis=1) / weight.sum(axis=1))


def rims_of(design: Design, layout: Layout, reach: float) -> Rims:
    """The sides of the sheet of a motif.

    Parameters
    ----------
    reach : mm, from `reach_mm`.

    Examples
    --------
    Lines 5 mm apart, of which the outermost are 4 mm from two sides and end at the others:

    >>> from asterism.pattern.layout.build import layout
    >>> lines = Design.from_dict({
    ...     "rods": {"motif": [{"line_mm": [(0, 0), (5, 0)]}]}, "lattice": {"kind": "square", "spacing_mm": 5.0},
    ...     "border": {"rectangle_mm": (40, 38)},
    ... })
    >>> rims_of(lines, layout(lines), 2.5).moment_mm2.round(2).tolist()
    [4.79, 0.0, 4.79, 0.0]
    """
    small = small_holes(layout)
    edges = SheetEdges(tuple(ring for k, ring in enumerate(layout.edges.rings) if k - 1 not in small))
    start, end = edges.start, edges.end
    length = np.linalg.norm(end - start, axis=1)
    along = (end - start) / length[:, None]
    inwards = np.column_stack([-along[:, 1], along[:, 0]])
    spacing = design.lattice.spacing_mm
    rods = shapely.STRtree([shapely.LineString(rod.points) for rod in layout.graph.rods])
    moment = np.zeros(len(start))
    for side, normal in enumerate(inwards):
        distance = _distance_along(design, normal)
        if not np.isfinite(distance):
            continue
        count = max(int(np.ceil(length[side] / (SAMPLE_SPACINGS * spacing))), 2)
        places = start[side] + (np.arange(count) + 0.5)[:, None] / count * (end - start)[side]
        width = to_first_rod(places, normal, rods, REACH_DISTANCES * distance)
        met = np.isfinite(width)
        if met.mean() < MIN_MET_SHARE:
            continue
        square = float((width[met] ** 2).mean())
        away = rods.query_nearest(shapely.points(places), all_matches=False, return_distance=True)[1]
        bare = np.maximum(away - reach, 0.0)
        moment[side] = 0.5 * (square - float((bare**2).mean())) - distance**2 / 12.0
    return Rims(start, end, along, _mean_along(edges, moment, spacing))


def _mean_along(edges: SheetEdges, moment: Floats, width: float) -> Floats:
    """(B,) mean of the moments (B,) of sides whose middles are within a width (mm) along the rim: of curved rims."""
    length = np.linalg.norm(edges.end - edges.start, axis=1)
    mean = np.empty_like(moment)
    for ring in range(len(edges.rings)):
        its = edges.numbers(ring)
        middle = np.cumsum(length[its]) - 0.5 * length[its]
        gap = np.abs(middle[:, None] - middle)
        weight = length[its] * (np.minimum(gap, length[its].sum() - gap) <= 0.5 * width)
        mean[its] = weight @ moment[its] / weight.sum(axis=1)
    return mean


def _distance_along(design: Design, direction: Floats) -> float:
    """mm, mean distance of the rods of the endless pattern along a line of a direction (2,)."""
    area = abs(float(np.linalg.det(np.asarray(design.lattice.vectors))))
    rods = design.required_rods
    crossed = sum(
        float(np.abs(np.diff(polyline(line, rods.curve_mm), axis=0) @ [-direction[1], direction[0]]).sum())
        for line in rods.motif
    )
    return area / crossed if crossed > 0.0 else np.inf


def to_first_rod(places: Floats, direction: Floats, rods: shapely.STRtree, most: float) -> Floats:
    """(n,) mm, distance from places (n, 2) to the first rod along a direction (2,); inf without one within `most`."""
    rays = shapely.linestrings(np.stack([places, places + most * direction], axis=1))
    ray, rod = rods.query(rays, predicate="intersects")
    hits = shapely.intersection(rays[ray], rods.geometries[rod])
    first = np.full(len(places), np.inf)
    np.minimum.at(first, ray, shapely.distance(hits, shapely.points(places[ray])))
    return first
