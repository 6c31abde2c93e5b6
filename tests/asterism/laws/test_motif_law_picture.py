"""The picture of the law of a motif: a row over directions, another over sizes that vary, and the cells as dots."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from matplotlib.lines import Line2D

from asterism.homogenize.law.motif_law import MotifLaw
from asterism.laws.law_picture import MOTIF_CHARTS, law_figure
from asterism.pattern.design.design import Design
from tests.homogenize import same_process
from tests.homogenize.motif_laws import LEAST_THICKNESS, learned_law
from tests.homogenize.motifs import grid

VARIED = {"profile": "radial", "from": 0.4, "to": 0.5, "over_mm": 30.0}
ACROSS = {"profile": "linear", "from": 1.1, "to": 1.2, "start_mm": [-30.0, 0.0], "end_mm": [30.0, 0.0]}


def law_of(folder: Path, monkeypatch: pytest.MonkeyPatch, thickness: Any = 0.4, width: Any = 1.2) -> MotifLaw:
    motif, lattice = grid()
    rods = {"motif": motif, "thickness_mm": thickness, "width_mm": width}
    same_process.use(monkeypatch)
    design = Design.from_dict({"rods": rods, "lattice": lattice, "border": {"rectangle_mm": (60, 60)}})
    return learned_law(design, folder)


def curves(law: MotifLaw, chart: int, style: str) -> list[Line2D]:
    return [line for line in law_figure(law).axes[chart].lines if line.get_linestyle() == style]


def test_a_law_of_one_cell_is_drawn_over_directions(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    law = law_of(tmp_path, monkeypatch)
    charts = law_figure(law).axes
    assert [chart.get_title("right") for chart in charts] == list(MOTIF_CHARTS.values())
    assert charts[0].get_legend() is None
    (dots,) = (line for line in charts[1].lines if line.get_marker() == "o")
    tubes = law.samples[0]["sample"]["directions"]
    assert sorted(np.asarray(dots.get_ydata())) == sorted(tube["curvature"] for tube in tubes)
    (curve,) = curves(law, 3, "-")
    stiffness = law.tables[0](np.array([[0.4, 1.2]])).stiffness[0]
    assert np.asarray(curve.get_ydata())[[0, 90]] == pytest.approx([stiffness[0, 0], stiffness[1, 1]])


def test_sizes_that_vary_have_a_row_with_both_principal_axes(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    law = law_of(tmp_path, monkeypatch, VARIED, ACROSS)
    charts = law_figure(law).axes
    assert len(charts) == 2 * len(MOTIF_CHARTS)
    below = charts[len(MOTIF_CHARTS)]
    assert below.get_xlabel() == "thickness, mm"
    labels = [text.get_text() for text in below.get_legend().get_texts()]  # type: ignore[union-attr]
    widths = law.plan.sizes[1].nodes
    assert labels[:2] == [f"width {widths[0]:g} mm, along the smaller stretch", f"width {widths[0]:g} mm, across it"]
    assert len(labels) == 2 * len(widths)


def test_sizes_without_a_law_are_dotted(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    law = law_of(tmp_path, monkeypatch, VARIED | {"from": LEAST_THICKNESS - 0.02})
    charts = law_figure(law).axes
    assert any(line.get_linestyle() == ":" for line in charts[0].lines)
    (solid,) = (line for line in charts[len(MOTIF_CHARTS)].lines if line.get_linestyle() == "-")
    known = np.asarray(solid.get_xdata())[np.isfinite(np.asarray(solid.get_ydata()))]
    assert LEAST_THICKNESS <= known.min() < known.max() == pytest.approx(0.5)
