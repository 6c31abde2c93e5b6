"""The responses of the unit cell of a motif: rest metric, stiffness, and how far the sheet rolls in each direction."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from asterism.equilibrium.arrays import Array
from asterism.homogenize.cell.effective_stiffness import EffectiveStiffness, effective_stiffness
from asterism.homogenize.cell.flat_cell import relax_flat_cell
from asterism.homogenize.cell.larger_cell import CellComparison, compare_with_larger_cell
from asterism.homogenize.cell.natural_curvature import MAX_SEARCHED_CURL, trace_tubes
from asterism.homogenize.cell.rod_bending import rod_bending
from asterism.homogenize.cell.tube_directions import ALL_ANGLES_RAD
from asterism.homogenize.cell.unit_cell import UnitCell
from asterism.pattern.design.design import Design


@dataclass(frozen=True)
class RolledDirection:
    """The natural tube of one direction.

    Attributes
    ----------
    direction_rad : of the printed direction around the tube, from x.
    curvature : 1/mm, one over the mean radius; positive with the plastic outside.
    hoop, axial : stretches around and along the tube. If the sheet hardly curls, those of a tube of small curvature.
    bending : N mm, secant stiffness from the flat cell to the tube, in curvatures of the contracted sheet.
    """

    direction_rad: float
    curvature: float
    hoop: float
    axial: float
    bending: float


@dataclass(frozen=True)
class MotifResponses:
    """One cell of an endless sheet.

    Attributes
    ----------
    deformation : (2, 2) F, symmetric, of the flat relaxed cell; the rest metric is F F.
    linear : stiffness and moment of the flat cell.
    rods : (3, 3) N mm, bending stiffness of the rods alone.
    directions : natural tubes.
    failed : directions (rad from x) without an equilibrium, and why.
    comparison : with 2 x 2 cells.
    spacing_mm : length of the shorter lattice vector.
    vertices : of the mesh.
    """

    deformation: Array
    linear: EffectiveStiffness
    rods: Array
    directions: tuple[RolledDirection, ...]
    failed: tuple[tuple[float, str], ...]
    comparison: CellComparison
    spacing_mm: float
    vertices: int

    @property
    def doubts(self) -> list[str]:
        """Why a sheet may differ from its cell, one line each."""
        doubts = [] if self.comparison.reason is None else [self.comparison.reason]
        curl = max((abs(tube.curvature) * self.spacing_mm for tube in self.directions), default=0.0)
        if curl > MAX_SEARCHED_CURL:
            doubts.append(f"the sheet curls by {curl:.2g} rad within one cell: it is not separated in scale")
        return doubts + [f"direction {np.degrees(angle):.0f} deg: {reason}" for angle, reason in self.failed]


def motif_responses(
    design: Design,
    edge_mm: float,
    angles: tuple[float, ...] = ALL_ANGLES_RAD,
    say: Callable[[str], None] = lambda text: None,
) -> MotifResponses:
    """Solve the unit cell of a design's motif, flat and rolled in several directions, and compare it with 2 x 2 cells.

    Parameters
    ----------
    edge_mm : of the mesh.
    angles : of the tubes, rad from y to the printed direction around the tube.
    say : called with a line of progress.

    Raises
    ------
    ValueError, DesignError, MeshError
        See `UnitCell`.
    ArithmeticError
        The flat cell has no equilibrium.
    """
    cell = UnitCell(design, edge_mm)
    directions: list[RolledDirection] = []
    failed: list[tuple[float, str]] = []
    try:
        say(f"flat cell of {cell.mesh.n_base} vertices")
        flat = relax_flat_cell(cell)[0]
        linear = effective_stiffness(cell, flat)
        for angle in angles:
            around = (angle + 0.5 * np.pi) % np.pi
            say(f"tubes around {np.degrees(around):.0f} deg")
            try:
                branch = trace_tubes(cell, flat, angle)
            except ArithmeticError as error:
                failed.append((around, str(error)))
                continue
            if branch.natural is None:
                tube = branch.tubes[0]
                curvature, bending = branch.slight / tube.hoop, branch.stiffness * tube.hoop**2
            else:
                tube = branch.natural
                curvature = tube.contracted_curvature
                bending = 2.0 * (flat.energy - tube.energy) / curvature**2
            directions.append(RolledDirection(around, curvature, tube.hoop, tube.axial, bending))
    finally:
        cell.close()
    say("2 x 2 cells")
    comparison = compare_with_larger_cell(design, edge_mm)
    ordered = tuple(sorted(directions, key=lambda tube: tube.direction_rad))
    rods = rod_bending(design, flat.deformation)
    return MotifResponses(
        flat.deformation, linear, rods, ordered, tuple(failed), comparison, cell.spacing, cell.mesh.n_base
    )
