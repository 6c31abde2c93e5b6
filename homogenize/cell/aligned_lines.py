"""Whether the arms of a lattice lie on the lines of the aligned mesh, and on which; needs no energies."""

from __future__ import annotations

import numpy as np

from asterism.equilibrium.arrays import Ints
from asterism.homogenize.cell.point_group import keeps_grid_lines
from asterism.pattern.design.lattice import Lattice
from asterism.pattern.geometry.plane_lattice import GRID_DIRECTIONS

GRADED_OFF_LINES = "cells have graded meshes only if all arms lie on lattice lines and the grid has their symmetry"


def aligned_lines(lattice: Lattice) -> Ints | None:
    """(arms,) the grid line of each arm, an index into `GRID_DIRECTIONS`; None if the aligned mesh does not fit.

    It fits if all arms lie on such lines, and if the grid has the symmetry of star and lattice. The grid of a square
    lattice has one of its two diagonals only.
    """
    if not keeps_grid_lines(lattice):
        return None
    along = GRID_DIRECTIONS @ np.asarray(lattice.vectors)
    along = along / np.linalg.norm(along, axis=1, keepdims=True)
    match = np.asarray(lattice.arm_directions) @ along.T
    return match.argmax(axis=1) if (match.max(axis=1) > 1.0 - 1e-9).all() else None
