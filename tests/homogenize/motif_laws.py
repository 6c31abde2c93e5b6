"""Laws of motifs whose cells are made up, with answers that are smooth functions of the sizes of the rods."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from asterism.homogenize.campaign.campaign import SolveCell, run_campaign
from asterism.homogenize.campaign.design_plan import plan_for_design
from asterism.homogenize.campaign.fit_law import fit_law
from asterism.homogenize.cell.motif_responses import CellComparison, MotifResponses, RolledDirection
from asterism.homogenize.cell.point_group import ALL_ANGLES_RAD
from asterism.homogenize.law.motif_law import MotifLaw
from asterism.pattern.design.design import Design

# mm, of lines below which four cells relax to less energy than one
LEAST_THICKNESS = 0.34


def made_up(design: Design, edge_mm: float) -> MotifResponses:
    """In place of `motif_responses`: a net of rods with the thickness and width of its first line."""
    assert design.rods is not None
    line = design.rods.motif[0]
    thickness, width = float(line.thickness_mm), float(line.width_mm)  # type: ignore[arg-type]
    membrane = 900.0 * thickness * width * np.array([[1.0, 0.1, 0.05], [0.1, 0.6, 0.0], [0.05, 0.0, 0.2]])
    stretch = 1.0 - 0.02 / (thickness * width)
    deformation = np.array([[stretch, 0.01 * width], [0.01 * width, 0.9 * stretch]])
    bending = 150.0 * width * thickness**3
    tubes = tuple(
        RolledDirection(angle, 0.003 / thickness**2 * (1.0 + 0.3 * np.cos(2.0 * angle)), 0.99, 0.95, bending)
        for angle in ALL_ANGLES_RAD
    )
    rods = bending * np.array([[1.0, 0.1, 0.0], [0.1, 1.0, 0.0], [0.0, 0.0, 0.45]])
    larger = 1.0 if thickness >= LEAST_THICKNESS else 0.9
    comparison = CellComparison(1.0, larger, np.array([0.9, 0.95]), np.array([0.7, 0.8]))
    return MotifResponses(deformation, membrane, rods, tubes, (), comparison, 10.0)


def learned_law(design: Design, folder: Path, respond: SolveCell | None = made_up) -> MotifLaw:
    """The law of a design's motif from all cells of its plan."""
    plan = plan_for_design(design)
    law = fit_law(plan, run_campaign(plan, folder, respond=respond))
    assert isinstance(law, MotifLaw)
    return law
