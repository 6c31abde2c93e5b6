"""Cells that answer at once: smooth functions of the star's sizes in place of an equilibrium."""

from __future__ import annotations

import os
import time
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from asterism.homogenize.campaign.campaign import SolveCell, cell_inputs
from asterism.homogenize.campaign.kept_samples import KeptSamples, code_version
from asterism.homogenize.cell.point_group import tube_angles
from asterism.homogenize.law.plan import CellTask, LawPlan
from asterism.pattern.design.design import Design


@dataclass
class Answer:
    data: dict[str, Any]

    def to_dict(self) -> dict[str, Any]:
        return self.data


def solve_cell(design: Design, edge_mm: float) -> Answer:
    """A sheet that stiffens and curls with longer arms."""
    l, h, w = (float(getattr(design.stars, f"{n}_mm")) for n in ("length", "thickness", "width"))  # type: ignore[arg-type]  # noqa: E741
    s = design.fabric.stretch_xy[0]
    lam = 1 / s + 0.12 * np.tanh(l / 8) ** 2 * w**0.2
    kappa = 0.002 * l**2 / (1 + 0.1 * l**2) * (0.3 / h) ** 2 * w**0.1
    a = 11.5 * np.exp(-0.02 * l)
    membrane = np.array([[a, 0.3 * a, 0], [0.3 * a, a, 0], [0, 0, 0.35 * a]])
    angles = tube_angles(design)
    each = np.ones(len(angles))
    data = {
        "length_mm": l,
        "spacing_mm": design.lattice.spacing_mm,
        "lam": lam,
        "membrane": membrane.tolist(),
        "angles_rad": list(angles),
        "natural_curvature": (kappa * each).tolist(),
        "natural_membrane": [membrane.tolist()] * len(angles),
        "natural_bump_mm": (0.1 * l * each).tolist(),
        "relief": (0.02 * l * np.arange(24.0)).reshape(2, 12).tolist(),
        "natural_hoop": (lam * each).tolist(),
        "natural_axial": (lam * each).tolist(),
        "bending": (0.5 * np.exp(0.1 * l * h) * each).tolist(),
        "sixfold": 0.01 * l,
        "natural_centre_offset_mm": (0.05 * l * each).tolist(),
    }
    return Answer(data)


def curls_more(design: Design, edge_mm: float) -> Answer:
    """Four times the curvature."""
    answer = solve_cell(design, edge_mm)
    answer.data["natural_curvature"] = [4 * kappa for kappa in answer.data["natural_curvature"]]
    return answer


def fails_when_thin(design: Design, edge_mm: float) -> Answer:
    """No equilibrium for long thin arms."""
    if float(design.stars.length_mm) >= 10.0 and design.stars.thickness_mm == 0.2:  # type: ignore[arg-type]
        raise ArithmeticError("tube: still curling at 0.13/mm, the tightest tried")
    return solve_cell(design, edge_mm)


def no() -> Answer:
    raise ArithmeticError("no")


def fails(design: Design, edge_mm: float) -> Answer:
    raise ArithmeticError("no equilibrium\nat all")


def mended() -> bool:
    """Whether what breaks or dies does so no more, in this process and those it starts."""
    return "ASTERISM_FAKE_MENDED" in os.environ


def breaks(design: Design, edge_mm: float) -> Answer:
    if design.stars.length_mm == 10.0 and not mended():
        raise AssertionError("a bug")
    return solve_cell(design, edge_mm)


def dies(design: Design, edge_mm: float) -> Answer:
    if design.stars.length_mm == 5.0 and not mended():
        os._exit(3)
    return solve_cell(design, edge_mm)


def slow(design: Design, edge_mm: float) -> Answer:
    time.sleep(0.2)
    return solve_cell(design, edge_mm)


def matrix(design: Design, edge_mm: float) -> Answer:
    """With sums that would depend on the number of threads."""
    rng = np.random.default_rng(int(1000 * float(design.stars.thickness_mm)))  # type: ignore[arg-type]
    big = rng.random((400, 400))
    answer = solve_cell(design, edge_mm)
    answer.data["sixfold"] = float(np.linalg.norm(big @ big @ big) * 1e-9)
    return answer


def sample_name(plan: LawPlan, task: CellTask, respond: SolveCell | None = None) -> str:
    """Name of the file of a cell's sample."""
    return KeptSamples(Path(), code_version()).name(cell_inputs(plan.cell_design(task), plan.edge_mm, respond))


def files(folder: Path) -> set[str]:
    return {file.name for file in folder.iterdir()}
