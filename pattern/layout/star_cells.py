"""Which cells of the lattice carry a star."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import shapely

from asterism.equilibrium.arrays import Floats, Ints
from asterism.pattern.design.border import MAX_SHEET_MM, Border
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


def outline(border: Border, lattice: Lattice) -> Floats:
    """(B, 2) mm, corners of the sheet, counterclockwise.

    Raises
    ------
    DesignError
        The hexagon of `border.rings` does not fit the lattice, or is too large.

    Examples
    --------
    >>> outline(Border(rectangle_mm=(4.0, 2.0)), Lattice()).tolist()
    [[-2.0, -1.0], [2.0, -1.0], [2.0, 1.0], [-2.0, 1.0]]
    """
    if border.rings is not None:
        return _hexagon(border.rings, lattice)
    if border.rectangle_mm is not None:
        return np.asarray(np.array([[-1, -1], [1, -1], [1, 1], [-1, 1]]) * np.asarray(border.rectangle_mm) / 2)
    if border.rods is not None:
        raise DesignError("border.rods", "is an outline for asterism simulate alone", border.rods)
    corners = np.asarray(border.polygon_mm)
    return corners if shapely.is_ccw(shapely.linearrings(corners)) else corners[::-1].copy()


def _hexagon(rings: int, lattice: Lattice) -> Floats:
    """(6, 2) mm, the hexagon around some rings of stars."""
    if lattice.kind != "triangular":
        raise DesignError("border.rings", 'needs lattice.kind = "triangular"', rings)
    if lattice.origin_mm != (0.0, 0.0):
        raise DesignError("lattice.origin_mm", "must be [0, 0] with border.rings", lattice.origin_mm)
    # 15 mm beyond the outermost star's centre for the paper's spacing of 10 sqrt(3) mm
    radius = lattice.spacing_mm * (rings + 1.5 / np.sqrt(3.0))
    if radius > MAX_SHEET_MM:
        raise DesignError("border.rings", f"must make a sheet of at most {MAX_SHEET_MM:g} mm", rings)
    angle = np.radians(30 + 60 * np.arange(6))
    return np.asarray(radius * np.column_stack([np.cos(angle), np.sin(angle)]))
