"""The mesh of a design's cell: on lattice lines where all arms lie on them, free otherwise."""

from __future__ import annotations

import numpy as np

from discrete.energies.bending.registry import FABRIC_BENDING
from homogenize.cell.aligned_cell_mesh import aligned_cell_mesh
from homogenize.cell.free_cell_mesh import NEIGHBOUR_STEPS, free_cell_mesh
from homogenize.cell.periodic_mesh import TOUCHING_TOLERANCE, PeriodicMesh
from pattern.design.design import Design
from pattern.design.errors import MeshError
from pattern.design.lattice import Lattice
from pattern.geometry.arrays import Floats, Ints
from pattern.geometry.plane_lattice import GRID_DIRECTIONS
from pattern.rods.arms import check_clear

# a star, and those around whose arms may touch its own, by lattice vectors
_STARS = np.vstack([[[0, 0]], NEIGHBOUR_STEPS])


def cell_mesh(
    design: Design, edge_mm: float, repeat: tuple[int, int] = (1, 1), segments: int | None = None
) -> PeriodicMesh:
    """Mesh of `repeat` cells of the design's star; see `torus_mesh` and `free_torus`.

    Raises
    ------
    ValueError
        Stars are not equal.
    DesignError, MeshError
        Their arms overlap, or would print as one where they do not lie on lattice lines; or no mesh follows them.
    """
    lattice, vectors = design.lattice, np.asarray(design.lattice.vectors)
    length, surrounded = star_size(design, "length_mm"), FABRIC_BENDING[design.fabric.bending].needs_neighbours
    on_lines = lattice_lines(lattice)
    if on_lines is not None:
        directions = on_lines if length else on_lines[:0]
        lengths = np.full(len(directions), length)
        return aligned_cell_mesh(vectors, directions, lengths, edge_mm, repeat, segments, surrounded)
    free = _directions(lattice) if length else np.empty((0, 2))
    if length > lattice.spacing_mm * (1.0 + TOUCHING_TOLERANCE):
        raise MeshError(f"arms of {length:g} mm are longer than the spacing, {lattice.spacing_mm:g} mm")
    _check_clear(vectors, free, length, star_size(design, "width_mm"))
    return free_cell_mesh(vectors, free, length, edge_mm, repeat, segments, surrounded)


def lattice_lines(lattice: Lattice) -> Ints | None:
    """(arms,) the lines, numbers in `GRID_DIRECTIONS`, that the arms lie on; None unless all lie on one."""
    along = GRID_DIRECTIONS @ np.asarray(lattice.vectors)
    along = along / np.linalg.norm(along, axis=1, keepdims=True)
    match = np.asarray(lattice.arm_directions) @ along.T
    return match.argmax(axis=1) if (match.max(axis=1) > 1.0 - 1e-9).all() else None


def star_size(design: Design, name: str) -> float:
    """A size of the stars, which must be a number, mm, as it is printed."""
    stars = design.stars
    value = getattr(stars, name)
    if name == "length_mm" and isinstance(stars.length_fraction, int | float):
        value = stars.length_fraction * design.lattice.spacing_mm
    if not isinstance(value, int | float):
        raise ValueError(f"stars.{name} must be a number in a cell: all its stars are equal")
    for number, change in enumerate(stars.override):
        if change.remove or getattr(change, name) is not None:
            raise ValueError(f"stars.override[{number}] must not change a star in a cell: all its stars are equal")
    if stars.rounding is not None and name != "length_mm":
        rounded = stars.rounding.thickness if name == "thickness_mm" else stars.rounding.width
        value = rounded(np.asarray(value))
    return float(value)


def _directions(lattice: Lattice) -> Floats:
    """(arms, 2) unit vectors: the same, digit by digit, for a star that is turned onto itself."""
    sector = 360.0 / lattice.arms
    turn = round(lattice.orientation_deg % sector, 9) % sector
    angle = np.radians(turn - 90.0 + sector * np.arange(lattice.arms))
    return np.column_stack([np.cos(angle), np.sin(angle)])


def _check_clear(vectors: Floats, directions: Floats, length: float, width: float) -> None:
    """Refuse what a sheet refuses too: arms of different stars that cross or print as one."""
    centres = np.repeat(_STARS @ vectors, len(directions), axis=0)
    tips = centres + length * np.tile(directions, (len(_STARS), 1))
    star = np.repeat(np.arange(len(_STARS)), len(directions))
    if len(star):
        check_clear(
            centres, tips, star, np.full((len(star), 2), width), TOUCHING_TOLERANCE * float(np.linalg.norm(vectors[0]))
        )
