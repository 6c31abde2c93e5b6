"""The page about a design of drawn rods: with the shape of the exact model, and without one."""

from __future__ import annotations

from pathlib import Path

import pytest

from asterism.exact.simulation import exact_shape
from asterism.pattern.design.design import Design
from asterism.print.job import prepare
from asterism.print.printer import load_plastic, load_printer
from asterism.reports.design_report import design_facts, report
from asterism.reports.write_results import write_results
from tests.asterism.print.measure import pdf_words

CROSS = Design.from_dict(
    {
        "name": "cross",
        "rods": {"draw": [{"line_mm": [(-10, 0), (10, 0)]}, {"line_mm": [(0, -10), (0, 10)], "thickness_mm": 0.5}]},
        "border": {"rectangle_mm": (24.0, 24.0)},
        "mesh": {"edge_mm": 4.0},
    }
)


def test_the_facts_are_those_of_the_rods() -> None:
    job = prepare(CROSS, load_printer("ultimaker2"), load_plastic("tpu95a"))
    facts = design_facts(job, {}, "not known")
    assert "Stars" not in facts
    assert facts["Rods"][:3] == ["4 between nodes, 40 mm in all", "joints: 1", "thickness 0.3 to 0.5, width 1.2 mm"]


@pytest.mark.slow
def test_the_page_shows_the_exact_shape_or_says_why_it_has_no_picture(tmp_path: Path) -> None:
    said: list[str] = []
    assert report(CROSS, tmp_path / "without.pdf", say=said.append).shape is None
    without = "the page has no picture: rods.motif: is missing: lines that do not repeat have no law"
    assert said == [f"{without}; use the exact model: asterism simulate first"]
    write_results(exact_shape(CROSS), tmp_path / "cross")
    written = report(CROSS, tmp_path / "with.pdf", beside=tmp_path / "cross")
    assert written.shape is not None and written.source == "by the exact model"
    words = " ".join(pdf_words(tmp_path / "with.pdf", 0))
    assert "40 mm in all" in words and "Exact, mesh error" in words
