"""The unit cell of a design's motif as lines of text."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np

from asterism.homogenize.cell.motif_responses import MotifResponses, motif_responses
from asterism.homogenize.cell.rod_bending import completed_by_rods
from asterism.pattern.design.errors import DesignError
from asterism.pattern.layout.load_design import load_design

# of two principal stretches that print as one
EVEN_STRETCH = 5e-5


def motif_cell(file: Path, edge_mm: float | None, say: Callable[[str], None]) -> MotifResponses:
    """The responses of the cell of the motif in a design file.

    Parameters
    ----------
    edge_mm : of the cell's mesh; by default that of the design.

    Raises
    ------
    DesignError
        The design has no motif, or its cell cannot be solved.
    ArithmeticError
        The flat cell has no equilibrium.
    """
    design = load_design(file)
    if design.rods is None:
        raise DesignError("rods", "is missing: the cell of stars has a law, by asterism calibrate")
    try:
        return motif_responses(design, edge_mm or design.usual_edge_mm, say=say)
    except DesignError:
        raise
    except ValueError as error:  # gravity
        raise DesignError("gravity.on", str(error)) from None


def motif_cell_rows(responses: MotifResponses) -> dict[str, str]:
    """Named values of the flat cell, and one row for each direction.

    Stiffnesses are per area of the print; curvatures are those of the contracted sheet.
    """
    sizes, axes = np.linalg.eigh(responses.deformation)
    angle = np.degrees(np.arctan2(axes[1, 0], axes[0, 0])) % 180.0
    along = f"{sizes[0]:.4f} along {angle:.0f} deg, {sizes[1]:.4f} across"
    is_even = np.ptp(sizes) < EVEN_STRETCH
    membrane = responses.linear.stiffness[:3, :3]
    bending = completed_by_rods(responses.linear.stiffness[3:, 3:], responses.rods)
    rows = {
        "cell": f"{responses.vertices} vertices",
        "flat stretches": f"{sizes[0]:.4f} in all directions" if is_even else along,
        "membrane": f"{membrane[0, 0]:.4g} (x), {membrane[1, 1]:.4g} (y), {membrane[2, 2]:.4g} (shear) N/mm",
        "bending, flat": f"{bending[0, 0]:.4g} (x), {bending[1, 1]:.4g} (y), {bending[2, 2]:.4g} (twist) N mm",
        "2 x 2 cells": f"{max(100 * responses.comparison.excess, 0.0):.2f} % less energy than one cell",
    }
    for tube in responses.directions:
        rolled = f"curvature {tube.curvature:.4f}/mm, stretches {tube.hoop:.3f} around and {tube.axial:.3f} along"
        rows[f"around {np.degrees(tube.direction_rad):.0f} deg"] = f"{rolled}, bending {tube.bending:.3g} N mm"
    return rows
