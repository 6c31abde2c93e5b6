"""The outline of the sheet in printed coordinates."""

from __future__ import annotations

import numpy as np
import shapely

from asterism.equilibrium.arrays import Floats
from asterism.pattern.design.border import MAX_SHEET_MM, Border
from asterism.pattern.design.errors import DesignError
from asterism.pattern.design.lattice import Lattice


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
