"""Laws of motifs from real cells: left-out sizes, turned drawings, and stars written as rods."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from asterism.homogenize.campaign.fit_law import motif_tensors
from asterism.homogenize.cell.motif_responses import motif_responses
from asterism.homogenize.errors import ForeignLaw
from asterism.homogenize.law.motif_law import MotifLaw, tensor_errors
from asterism.homogenize.law.tensor_forms import SheetTensors
from asterism.pattern.design.design import Design
from tests.homogenize import same_process
from tests.homogenize.law.test_tensor_forms import turned
from tests.homogenize.motif_laws import learned_law
from tests.homogenize.motifs import grid, motif_design, parallel

THICKNESS = {"profile": "radial", "from": 0.5, "to": 0.4, "over_mm": 30.0}


def law_of(design: Design, folder: Path, monkeypatch: pytest.MonkeyPatch) -> MotifLaw:
    same_process.use(monkeypatch)
    return learned_law(design, folder, None)


def tensors_at(law: MotifLaw, design: Design, points: np.ndarray) -> SheetTensors:
    values = law.evaluate_at(design, points)
    return SheetTensors(values.metric, values.stiffness, values.curvature)


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
def test_unequal_stretch_has_a_law(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """With the stretches of x and y exchanged, a square grid has the law turned by 90 degrees, up to its mesh."""
    designs = [motif_design(grid(), 0.5, fabric={"stretch": pair}) for pair in ([1.35, 1.15], [1.15, 1.35])]
    laws = [law_of(each, tmp_path / str(number), monkeypatch) for number, each in enumerate(designs)]
    plain, other = (tensors_at(law, each, np.zeros((1, 2))) for law, each in zip(laws, designs, strict=True))
    assert (tensor_errors(other, turned(plain, np.pi / 2))[0] < [0.01, 0.1, 1.5, 1.0]).all()
    assert abs(plain.curvature[0, 0]) > 1.2 * abs(plain.curvature[0, 1])
    with pytest.raises(ForeignLaw, match=r"fabric.stretch = \[1.15, 1.35\]: the law was made for \[1.35, 1.15\]"):
        laws[0].check(designs[1])
