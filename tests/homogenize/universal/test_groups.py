"""Cells with equal dimensionless groups have equal dimensionless responses, whatever their material is."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from asterism.equilibrium.arrays import Floats
from asterism.homogenize.cell.sample import solve_cell
from asterism.homogenize.universal.groups import GROUP_KEYS, GROUPS, arm_curl, coordinates_of_groups, star_groups
from asterism.pattern.design.design import Design
from asterism.pattern.design.lattice import DEFAULT_SPACING_MM

PAPER: dict[str, Any] = {
    "fabric": {"stretch": 1.4},
    "stars": {"length_mm": 8.66, "thickness_mm": 0.4, "width_mm": 1.2},
    "border": {"rings": 1},
}
KNIT: dict[str, Any] = {
    "fabric": {"stretch": 1.7, "thickness_mm": 0.7, "modulus_mpa": 0.3},
    "plastic": {"modulus_ratio": 9000.0, "rest_curvature": "timoshenko", "kappa_bar_per_mm": 0.004},
    "lattice": {"spacing_mm": 14.0},
    "stars": {"length_mm": 5.25, "thickness_mm": 0.3, "width_mm": 1.0},
    "border": {"rings": 1},
}
ANGLES = (0.0, np.pi / 6)


def groups_of(design: Design, edge_mm: float) -> Floats:
    stars = design.required_stars
    sizes = np.array([[stars.length_mm, stars.thickness_mm, stars.width_mm]], dtype=float)
    return np.asarray(star_groups(design.fabric, design.plastic, design.lattice.spacing_mm, edge_mm, sizes)[0])


def reference_cell(groups: Floats) -> tuple[Design, float]:
    """A design and a mesh edge (mm) whose cell has these groups (G,)."""
    arm, stretch, bending, _, fabric, aspect, thickness, edge = map(float, groups)
    d = float(DEFAULT_SPACING_MM)
    h2, h = fabric * d, thickness * d
    width = aspect * h
    design = {
        "fabric": {"stretch": stretch, "thickness_mm": h2},
        "plastic": {
            "modulus_ratio": 12.0 * bending * h2 * d**3 / (width * h**3),
            "rest_curvature": "none",
            "kappa_bar_per_mm": float(arm_curl(groups)) / d,
        },
        "lattice": {"spacing_mm": d},
        "stars": {"length_mm": arm * d, "thickness_mm": h, "width_mm": width},
        "border": {"rectangle_mm": [3.0 * d, 3.0 * d]},
    }
    return Design.from_dict(design), edge * d


def dimensionless(design: Design, edge_mm: float) -> dict[str, Any]:
    sample: Any = solve_cell(design, edge_mm, ANGLES)
    d, force = design.lattice.spacing_mm, design.fabric.modulus_mpa * design.fabric.thickness_mm
    assert sample.failed is None
    return {
        "lam": sample.lam,
        "hoop": sample.natural_hoop,
        "axial": sample.natural_axial,
        "curl": sample.natural_curvature * d,
        "bending": sample.bending / (force * d**2),
        "sixfold": sample.sixfold / (force * d**3),
        "membrane": sample.natural_membrane / force,
        "offset": sample.natural_centre_offset_mm / d,
        "flat corrugation": sample.relief[0] / d,
        "corrugation per curvature": sample.relief[1] / d**2,
    }


@pytest.mark.slow
@pytest.mark.parametrize("data", [PAPER, KNIT])
def test_the_reference_cell_has_the_answer_of_every_cell_with_its_groups(data: dict[str, Any]) -> None:
    own = Design.from_dict(data)
    edge = own.lattice.spacing_mm / 8
    groups = groups_of(own, edge)
    reference, reference_edge = reference_cell(groups)
    np.testing.assert_allclose(groups_of(reference, reference_edge), groups, rtol=1e-12)
    theirs = dimensionless(own, edge)
    ours = dimensionless(reference, reference_edge)
    assert theirs["curl"].min() > 0.05
    for name, value in ours.items():
        np.testing.assert_allclose(value, theirs[name], rtol=2e-4, atol=2e-6, err_msg=name)


@pytest.mark.slow
@pytest.mark.parametrize("key, strong", [("thickness", False), ("aspect", False), ("bending", True), ("couple", True)])
def test_which_groups_are_weak(key: str, strong: bool) -> None:
    """A fifth more of a weak group changes natural curvature and stiffness by less than two percent."""
    design = Design.from_dict(PAPER)
    groups = groups_of(design, design.lattice.spacing_mm / 8)
    changed = groups.copy()
    changed[GROUP_KEYS.index(key)] *= 1.2
    answers = []
    for each in (groups, changed):
        cell, edge = reference_cell(each)
        answers.append(dimensionless(cell, edge))
    change = [abs(answers[1][name].mean() / answers[0][name].mean() - 1.0) for name in ("curl", "bending")]
    assert (max(change) > 0.05) if strong else (0.0 < max(change) < 0.02)


def test_the_formula_of_the_paper_gives_a_couple_of_the_geometry_alone() -> None:
    design = Design.from_dict(PAPER)
    assert groups_of(design, 2.0)[GROUP_KEYS.index("couple")] == pytest.approx(1.2 * 1.2 / (2 * 300.0), rel=1e-9)


def test_coordinates_run_over_the_limits() -> None:
    ends = np.array([[group.limits[end] for group in GROUPS] for end in (0, 1)])
    np.testing.assert_allclose(coordinates_of_groups(ends), [[0.0] * len(GROUPS), [1.0] * len(GROUPS)], atol=1e-12)
    middle = np.array(
        [np.sqrt(np.prod(group.limits)) if group.logarithmic else np.mean(group.limits) for group in GROUPS]
    )
    np.testing.assert_allclose(coordinates_of_groups(middle[None]), 0.5, atol=1e-12)
