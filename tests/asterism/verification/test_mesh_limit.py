"""The limit of an infinitely fine mesh by previews, against the exact model on fine meshes."""

from __future__ import annotations

import pytest

from asterism.homogenize.errors import LawError
from asterism.pattern import gallery
from asterism.pattern.layout.build import layout
from asterism.previews.law_choice import paper_law
from asterism.previews.run import preview
from asterism.results.records.exact import ExactRecord
from asterism.verification.mesh_limit import (
    design_and_law,
    has_mesh_limit,
    is_on_exact_mesh,
    mesh_limit,
    with_mesh_limit,
)
from asterism.verification.run import verified_mesh_error

# of the exact tube's radius, mm, by extrapolation: benchmarks/results/convergence.md
RADIUS_IN_THE_LIMIT = 35.06


@pytest.mark.slow
@pytest.mark.parametrize(
    ("edge", "radius", "finest"),
    # mm, exact radius; %, distance of the exact surface from that on edges of 0.48 mm, which is itself about 0.7 % from
    # the limit: benchmarks/results/convergence.md
    [(2.0, 25.02, 3.47), (0.7, 30.81, 0.55)],
)
def test_a_rolled_sheet_has_a_mesh_error_near_that_of_fine_meshes(edge: float, radius: float, finest: float) -> None:
    tube, law = design_and_law(gallery.load("tube"), paper_law(), edge)
    plan = layout(tube)
    shown = preview(tube, law, plan=plan)
    assert is_on_exact_mesh(shown, law, tube)
    limit = mesh_limit(tube, paper_law(), shown, plan)
    assert limit is not None and limit.roll_radius_mm is not None
    grown = radius * limit.roll_radius_mm / shown.summary["roll_radius_mm"]
    assert grown == pytest.approx(RADIUS_IN_THE_LIMIT, rel=0.05)
    error, origin = verified_mesh_error(ExactRecord.from_json({"mesh_error_percent": None}), limit, True)
    assert origin == "law" and error == pytest.approx(finest + 0.7, rel=0.25)


@pytest.mark.slow
def test_stars_without_an_order_have_no_limit() -> None:
    dome = gallery.load("dome")
    shown = with_mesh_limit(preview(dome), dome, paper_law())
    assert shown.summary["mesh_limit"] is None
    with pytest.raises(LawError, match=r"no limit for .* of 37 stars"):
        design_and_law(dome, paper_law(), 0.0)


@pytest.mark.parametrize(("name", "is_known"), [("tube", True), ("dome", False)])
def test_whether_a_verification_has_a_limit_is_known_without_a_preview(name: str, is_known: bool) -> None:
    assert has_mesh_limit(gallery.load(name)) == has_mesh_limit(gallery.load(name), paper_law()) == is_known
