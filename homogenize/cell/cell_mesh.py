"""The mesh of a design's unit cell, with the symmetry of star and lattice: aligned if that fits, free otherwise."""

from __future__ import annotations

import numpy as np

from asterism.discrete.energies.bending.fabric_bending import FABRIC_BENDING
from asterism.equilibrium.arrays import Floats
from asterism.homogenize.cell.aligned_cell_mesh import aligned_cell_mesh
from asterism.homogenize.cell.free_cell_mesh import NEIGHBOUR_STEPS, free_cell_mesh
from asterism.homogenize.cell.periodic_mesh import TOUCHING_TOLERANCE, PeriodicMesh
from asterism.homogenize.cell.point_group import GRADED_OFF_LINES, aligned_lines, arm_directions, point_group
from asterism.pattern.design.design import Design
from asterism.pattern.design.errors import MeshError
from asterism.pattern.rods.arms import check_clear

# a star and its neighbours, as numbers of lattice vectors
_STARS = np.vstack([[[0, 0]], NEIGHBOUR_STEPS])


def cell_mesh(design: Design, edge_mm: float, repeat: tuple[int, int] = (1, 1)) -> PeriodicMesh:
    """Mesh of `repeat` cells of the design's star; see `aligned_cell_mesh` and `free_cell_mesh`.

    It is graded if the design's mesh is and all arms lie on lattice lines.

    Raises
    ------
    ValueError
        The stars of the design differ.
    DesignError, MeshError
        Arms overlap, arms off the lattice lines would print as one, no mesh follows the arms, or the design asks for
        a graded mesh and arms do not lie on lattice lines.
    """
    lattice, vectors = design.lattice, np.asarray(design.lattice.vectors)
    length, surrounded = star_size(design, "length_mm"), FABRIC_BENDING[design.fabric.bending].needs_neighbours
    on_lines = aligned_lines(lattice)
    if on_lines is not None:
        directions = on_lines if length else on_lines[:0]
        lengths = np.full(len(directions), length)
        return aligned_cell_mesh(vectors, directions, lengths, edge_mm, repeat, surrounded, bool(design.graded_meshes))
    if design.mesh.graded:
        raise MeshError(GRADED_OFF_LINES)
    free = arm_directions(lattice) if length else np.empty((0, 2))
    if length > lattice.spacing_mm * (1.0 + TOUCHING_TOLERANCE):
        raise MeshError(f"arms of {length:g} mm are longer than the spacing, {lattice.spacing_mm:g} mm")
    _check_clear(vectors, free, length, star_size(design, "width_mm"))
    return free_cell_mesh(vectors, free, length, edge_mm, repeat, surrounded, point_group(lattice))


def star_size(design: Design, name: str) -> float:
    """A size of the stars as printed, mm.

    Raises
    ------
    ValueError
        The size varies over the sheet.
    """
    stars = design.required_stars
    value = getattr(stars, name)
    if name == "length_mm" and isinstance(stars.length_fraction, int | float):
        value = stars.length_fraction * design.lattice.spacing_mm
    if not isinstance(value, int | float):
        raise ValueError(f"stars.{name} must be a number: all stars of a unit cell are equal")
    for number, change in enumerate(stars.override):
        if change.remove or getattr(change, name) is not None:
            raise ValueError(f"stars.override[{number}] must not change a star: all stars of a unit cell are equal")
    if stars.rounding is not None and name != "length_mm":
        rounded = stars.rounding.thickness if name == "thickness_mm" else stars.rounding.width
        value = rounded(np.asarray(value))
    return float(value)


def _check_clear(vectors: Floats, directions: Floats, length: float, width: float) -> None:
    """Raise DesignError, as for a sheet, if arms of different stars cross or print as one."""
    centres = np.repeat(_STARS @ vectors, len(directions), axis=0)
    tips = centres + length * np.tile(directions, (len(_STARS), 1))
    star = np.repeat(np.arange(len(_STARS)), len(directions))
    if len(star):
        check_clear(
            centres, tips, star, np.full((len(star), 2), width), TOUCHING_TOLERANCE * float(np.linalg.norm(vectors[0]))
        )
