"""Which cells of the lattice carry a star."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import shapely

from asterism.equilibrium.arrays import Floats, Ints
from asterism.pattern.design.border import Border
from asterism.pattern.design.errors import DesignError
from asterism.pattern.design.lattice import Lattice

MAX_STARS_OF_DESIGN = 5000
# cells in the box around the sheet that may be listed before those outside the outline are dropped
MAX_LISTED_CELLS = 5_000_000


def star_margin_mm(border: Border, lattice: Lattice) -> float:
    """Smallest distance (mm) of a star's centre to the outline of a rectangle or polygon."""
    return lattice.spacing_mm / 2 if border.star_margin_mm is None else border.star_margin_mm


def star_cells(border: Border, lattice: Lattice, corners: Floats, holes: Sequence[Floats] = ()) -> Ints:
    """(n, 2) lattice cells with a star, from the origin outwards, counterclockwise at equal distance.

    Parameters
    ----------
    corners : (B, 2) mm, the outline.
    holes : (n, 2) mm each, edges of the holes.

    Raises
    ------
    DesignError
        The outline has room for more than `MAX_STARS_OF_DESIGN` stars.
    """
    sites = lattice.sites
    if border.rings is not None:
        i, j = sites.cells_within(*_box(corners)).T
        # i + j is the third hexagonal coordinate
        ring = np.max(np.abs([i, j, i + j]), axis=0)
        cells = np.column_stack([i, j])[ring <= border.rings]
    else:
        _check_count(lattice, corners)
        cells = sites.cells_within(*_box(corners))
        margin = star_margin_mm(border, lattice)
        centres = shapely.points(sites.place(cells))
        sheet = shapely.polygons(corners)
        shapely.prepare(sheet)
        inside = shapely.covers(sheet, centres)
        # A star exactly at the margin stays, whatever the rounding error.
        inside[inside] = shapely.distance(sheet.exterior, centres[inside]) >= margin * (1 - 1e-9)
        cells = cells[inside]
    if holes:
        away = shapely.distance(
            shapely.MultiPolygon([shapely.Polygon(hole) for hole in holes]), shapely.points(sites.place(cells))
        )
        cells = cells[away >= star_margin_mm(border, lattice) * (1 - 1e-9)]
    if len(cells) > MAX_STARS_OF_DESIGN:
        raise DesignError("border", f"must hold at most {MAX_STARS_OF_DESIGN} stars, not {len(cells)}")
    x, y = sites.place(cells).T
    distance = np.round(np.hypot(x, y) / lattice.spacing_mm, 6)
    angle = np.round(np.arctan2(y, x), 6) % round(2 * np.pi, 6)  # a star on the x axis comes first, despite rounding
    return np.asarray(cells[np.lexsort((angle, distance))])


def _box(corners: Floats) -> tuple[Floats, Floats]:
    return corners.min(axis=0), corners.max(axis=0)


def _check_count(lattice: Lattice, corners: Floats) -> None:
    """Refuse outlines with far too many cells, before the cells are listed."""
    low, high = _box(corners)
    cell = abs(np.linalg.det(lattice.vectors))
    cells = float(shapely.area(shapely.polygons(corners))) / cell
    if cells > 20 * MAX_STARS_OF_DESIGN or np.prod(high - low) / cell > MAX_LISTED_CELLS:
        raise DesignError("border", f"must hold at most {MAX_STARS_OF_DESIGN} stars, not about {cells:.0f}")
