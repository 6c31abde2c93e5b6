"""Laws of motifs from real cells: left-out sizes, turned drawings, and stars written as rods."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from asterism.homogenize.campaign.fit_law import motif_tensors
from asterism.homogenize.cell.flat_cell import relax_flat_cell
from asterism.homogenize.cell.motif_responses import motif_responses
from asterism.homogenize.cell.natural_curvature import trace_tubes
from asterism.homogenize.cell.point_group import ALL_ANGLES_RAD
from asterism.homogenize.cell.unit_cell import UnitCell
from asterism.homogenize.errors import ForeignLaw
from asterism.homogenize.law.motif_law import MotifLaw, tensor_errors
from asterism.homogenize.law.tensor_forms import TO_VOIGT, SheetTensors
from asterism.pattern.design.design import Design
from tests.homogenize import same_process
from tests.homogenize.cells import design as star_design
from tests.homogenize.law.test_tensor_forms import turned
from tests.homogenize.motif_laws import learned_law
from tests.homogenize.motifs import Pattern, diamonds, grid, motif_design, parallel, stars

THICKNESS = {"profile": "radial", "from": 0.5, "to": 0.4, "over_mm": 30.0}


def law_of(design: Design, folder: Path, monkeypatch: pytest.MonkeyPatch) -> MotifLaw:
    same_process.use(monkeypatch)
    return learned_law(design, folder, None)


def tensors_at(law: MotifLaw, design: Design, points: np.ndarray) -> SheetTensors:
    values = law.evaluate_at(design, points)
    return SheetTensors(values.metric, values.stiffness, values.curvature)


def turned_pattern(pattern: Pattern, angle: float) -> Pattern:
    turn = np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])
    motif, lattice = pattern
    lines = [{"line_mm": [tuple(map(float, turn @ point)) for point in line["line_mm"]]} for line in motif]
    vectors = [tuple(map(float, turn @ vector)) for vector in lattice["vectors_mm"]]
    return lines, {"kind": "custom", "vectors_mm": vectors}


@pytest.mark.slow
def test_left_out_sizes_are_within_the_stated_errors(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    motif, lattice = parallel()
    rods = {"motif": motif, "thickness_mm": THICKNESS}
    sheet = {"rods": rods, "lattice": lattice, "border": {"rectangle_mm": (60, 60)}, "mesh": {"edge_mm": 2.5}}
    sheet["fabric"] = {"bending": "paper"}
    design = Design.from_dict(sheet)
    law = law_of(design, tmp_path, monkeypatch)
    stated = [each["largest_percent"] for each in law.residuals["1.35"]["held_out"]["errors"].values()]
    for radius in (4.0, 17.0):
        thickness = 0.5 - 0.1 * radius / 30.0
        cell = motif_tensors(motif_responses(motif_design(parallel(), thickness), 2.5).to_dict())
        errors = tensor_errors(tensors_at(law, design, np.array([[radius, 0.0]])), cell)[0]
        assert (errors <= 2.0 * np.array(stated) + 0.01).all(), (errors, stated)
        assert errors.max() < 0.5


@pytest.mark.slow
def test_the_law_of_a_turned_drawing_is_turned(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Up to the mesh; 30 degrees take the directions of the tubes to each other."""
    angle, origin = np.pi / 6, np.zeros((1, 2))
    designs = [motif_design(each) for each in (diamonds(), turned_pattern(diamonds(), angle))]
    plain, other = (
        tensors_at(law_of(each, tmp_path / str(number), monkeypatch), each, origin)
        for number, each in enumerate(designs)
    )
    assert (tensor_errors(other, turned(plain, angle))[0] < [0.05, 1.0, 1.0, 1.0]).all()


@pytest.mark.slow
def test_unequal_stretch_has_a_law(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """With the stretches of x and y exchanged, a square grid has the law turned by 90 degrees, up to its mesh."""
    designs = [motif_design(grid(), 0.5, fabric={"stretch": pair}) for pair in ([1.35, 1.15], [1.15, 1.35])]
    laws = [law_of(each, tmp_path / str(number), monkeypatch) for number, each in enumerate(designs)]
    plain, other = (tensors_at(law, each, np.zeros((1, 2))) for law, each in zip(laws, designs, strict=True))
    assert (tensor_errors(other, turned(plain, np.pi / 2))[0] < [0.01, 0.1, 1.5, 1.0]).all()
    assert abs(plain.curvature[0, 0]) > 1.2 * abs(plain.curvature[0, 1])
    with pytest.raises(ForeignLaw, match=r"fabric.stretch = \[1.15, 1.35\]: the law was made for \[1.35, 1.15\]"):
        laws[0].check(designs[1])


@pytest.mark.slow
def test_stars_written_as_rods_have_the_law_of_stars(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """0.1 % in contraction and 1 % in the mean natural curvature of the star's own cell."""
    design = motif_design(stars(10.0), mesh={"edge_mm": 1.5})
    found = tensors_at(law_of(design, tmp_path, monkeypatch), design, np.zeros((1, 2)))
    cell = UnitCell(star_design(10.0, 0.4), 1.5)
    flat = relax_flat_cell(cell)
    tubes = [tube for angle in ALL_ANGLES_RAD if (tube := trace_tubes(cell, flat, angle).natural) is not None]
    assert len(tubes) == len(ALL_ANGLES_RAD)
    np.testing.assert_allclose(np.sqrt(found.metric[0, :2]), flat.stretch, rtol=1e-3)
    around = np.array(ALL_ANGLES_RAD) + 0.5 * np.pi
    forms = np.stack([np.cos(around) ** 2, np.sin(around) ** 2, np.sin(2.0 * around)], axis=-1)
    bending, curvature = found.stiffness[0, 3:, 3:], -found.curvature[0] * TO_VOIGT
    of_law = (forms @ bending @ curvature) / np.einsum("ai,ij,aj->a", forms, bending, forms)
    printed = [tube.contracted_curvature * tube.hoop**2 for tube in tubes]
    assert of_law.mean() == pytest.approx(np.mean(printed), rel=1e-2)
