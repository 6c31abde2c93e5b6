"""The law of a motif over the sheet of a design: where the motif covers it, and where its fabric is bare.

In an endless pattern no place is farther from a rod than a certain reach: half the distance of parallel lines. A rim is
as wide as that, or narrower, wherever the outline cuts the pattern; it belongs to the motif, as the fabric between rods
does. Beyond, the fabric is bare; this is averaged over the neighbourhood, since the shell's mesh is coarse.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import shapely
from scipy.ndimage import gaussian_filter, map_coordinates

from asterism.equilibrium.arrays import Floats
from asterism.homogenize.law.motif_law import MotifLaw, MotifValues
from asterism.pattern.design.design import Design
from asterism.pattern.design.sizing.profiles import Profile
from asterism.pattern.geometry.planar import polygon_area
from asterism.pattern.layout.layout import Layout
from asterism.pattern.rods.curves import polyline


@dataclass(frozen=True, eq=False)
class MotifFieldValues:
    """The law of a design's motif, evaluated with the sizes that the rods have at each place.

    Attributes
    ----------
    design, law : as given.
    outside : one line for each of the compared places on rods where sizes leave the range of the law. The nearest sizes
        in the range replace them.
    places : number of these compared places.
    """

    design: Design
    law: MotifLaw
    outside: tuple[str, ...]
    places: int

    @classmethod
    def of(cls, design: Design, layout: Layout, law: MotifLaw) -> MotifFieldValues:
        """The values of a design with its layout.

        Raises
        ------
        LawError
            The law is for another material, lattice or motif.
        """
        points = layout.points_on_rods
        return cls(design, law, law.evaluate_at(design, points).outside, len(points))

    def at(self, points: Floats) -> MotifValues:
        """The law at printed points (n, 2) mm."""
        return self.law.evaluate_at(self.design, points)

    @property
    def has_tight_curls(self) -> bool:
        """Whether much of the sheet is not scale-separated: never, since such cells have no law."""
        return False

    @property
    def is_uniform(self) -> bool:
        """Whether all copies of the motif are equal."""
        return not any(isinstance(field, Profile) for field in self.law.plan.sources(self.design))


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
