"""The law that a design names, and the law of the mesh of an exact shape."""

from __future__ import annotations

from pathlib import Path

import pytest

from asterism.homogenize.errors import LawError, UnreadableLaw
from asterism.homogenize.law.law_file import PAPER_LAW
from asterism.pattern import gallery
from asterism.pattern.design.design import Design
from asterism.pattern.layout.build import layout
from asterism.previews.law_choice import LIMIT, law_of, law_of_exact_mesh, law_on_mesh, paper_law


def test_a_file_is_read_again_only_after_a_change(tmp_path: Path) -> None:
    file = tmp_path / "own.npz"
    design = Design.from_dict({"stars": {"length_mm": 8.0}, "border": {"rings": 1}, "material": {"law": str(file)}})
    with pytest.raises(UnreadableLaw, match=r"own\.npz: cannot be read: No such file"):
        law_of(design)
    file.write_bytes(PAPER_LAW.read_bytes())
    law = law_of(design)
    assert law_of(design) is law
    file.write_bytes(b"damaged")
    with pytest.raises(LawError, match=r"own\.npz: is not a law, or damaged"):
        law_of(design)
    file.write_bytes(PAPER_LAW.read_bytes())
    assert law_of(design) is not law


TUBE = gallery.load("tube")
PLAN = layout(TUBE)


def test_the_default_mesh_of_a_design_has_its_law() -> None:
    law = law_of_exact_mesh(paper_law(), TUBE, PLAN)
    assert law.edge_mm == TUBE.mesh.edge_mm == 2.0
    assert law_on_mesh(paper_law(), TUBE, PLAN, 1.15) is paper_law()  # its own cells


def test_a_finer_mesh_lets_the_tube_curl_less() -> None:
    laws = [law_on_mesh(paper_law(), TUBE, PLAN, edge) for edge in (2.0, 1.15, 0.7, 0.48, LIMIT)]
    kappa = [float(law.at(1.35)(10.0, 0.4, 1.2).value["kappa"][0]) for law in laws]
    assert kappa == sorted(kappa, reverse=True)


def test_stars_without_cells_of_other_edges_keep_the_law() -> None:
    thick = TUBE.model_copy(update={"stars": TUBE.required_stars.model_copy(update={"thickness_mm": 0.6})})
    assert law_of_exact_mesh(paper_law(), thick, layout(thick)) is paper_law()
    with pytest.raises(LawError, match="no cells with edges of 2 mm for 37 of 37 stars"):
        law_on_mesh(paper_law(), thick, layout(thick), 2.0)
    with pytest.raises(LawError, match="no limit for 37 of 37 stars"):
        law_on_mesh(paper_law(), thick, layout(thick), LIMIT)
