"""A design without a law of its own material: the universal law stands in, and one sentence says how accurate it is."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from asterism.homogenize.errors import ForeignLaw
from asterism.pattern.design.design import Design
from asterism.previews import universal_choice as module
from asterism.previews.law_choice import paper_law, serving_law
from asterism.previews.run import preview
from asterism.previews.session import Preview
from asterism.previews.universal_choice import universal_choice

SIZES = np.array([[7.0, 0.42, 1.1]])
STARS = {"length_mm": 7.0, "thickness_mm": 0.42, "width_mm": 1.1}


def design(**more: Any) -> Design:
    fabric = {"stretch": 1.5, "thickness_mm": 0.9}
    return Design.from_dict({"fabric": fabric, "stars": STARS, "border": {"rings": 1}} | more)


def test_another_material_gets_the_universal_law_and_a_statement() -> None:
    shape = preview(design())
    assert shape.summary["law"]["material"] == "universal" and shape.summary["is_minimum"]
    lines = [line for line in shape.summary["warnings"] if line.startswith("the universal law stands in")]
    assert len(lines) == 1 and "natural curvature" in lines[0] and "asterism calibrate" in lines[0]


def test_the_paper_s_material_keeps_its_own_law() -> None:
    assert serving_law(design(fabric={})) is paper_law()
    assert serving_law(design(fabric={"bending": "none"})) is paper_law()


@pytest.mark.slow
def test_edits_of_a_session_go_from_law_to_law() -> None:
    session = Preview(design(fabric={}))
    for sheet in (design(), design(fabric={}), design(stars=STARS | {"length_mm": 6.5})):
        other = session.update(sheet)
        fresh = preview(sheet)
        assert other.summary["law"] == fresh.summary["law"]
        assert other.summary["energy_n_mm"] == pytest.approx(fresh.summary["energy_n_mm"], rel=1e-6)
    shown = session.design
    with pytest.raises(ForeignLaw):
        session.update(design(fabric={"stretch": 1.5, "thickness_mm": 0.4}))
    assert session.design == shown


def test_a_law_that_does_not_serve_gives_the_reason(monkeypatch: pytest.MonkeyPatch) -> None:
    thin = design(fabric={"stretch": 1.5, "thickness_mm": 0.4})
    choice = universal_choice(thin, SIZES)
    assert choice.law is None
    with pytest.raises(ForeignLaw, match=r"of 0\.8; the universal law does not serve for 7 of 7 stars") as refused:
        serving_law(thin)
    assert refused.value.field == "fabric.thickness_mm"
    assert "for 1 of 1 stars: fabric thickness over spacing is 0.0231" in choice.statement
    assert choice.statement.endswith("asterism simulate needs no law")
    monkeypatch.setattr(module, "MAX_SERVING_ERRORS_PERCENT", {"kappa": 1e-9})
    choice = universal_choice(design(), SIZES)
    assert choice.law is None and "does not serve such fabric and stars: it is off by contraction" in choice.statement


@pytest.mark.parametrize(("outside", "serves"), [(1, True), (2, False), (3, False)])
def test_up_to_a_fifth_of_the_stars_may_lie_outside(outside: int, serves: bool) -> None:
    sizes = np.repeat(SIZES, 8, axis=0)
    sizes[:outside, 0] = 15.5
    choice = universal_choice(design(), sizes)
    assert (choice.law is not None) == serves
    assert (f"for {outside} of 8 stars: arm length over spacing" in choice.statement) != serves


@pytest.mark.slow
def test_a_star_outside_the_universal_law_is_named() -> None:
    long = STARS | {"override": [{"site": [0, 0], "length_mm": 14.5}]}
    warnings = preview(design(stars=long)).summary["warnings"]
    assert any("star" in line and "length_mm = 14.5 is outside the law's" in line for line in warnings)
    assert any(line.startswith("the universal law stands in") for line in warnings)


def test_an_edit_asks_for_the_same_table() -> None:
    first, second = (universal_choice(design(), sizes).law for sizes in (SIZES, SIZES * [1.2, 1.01, 0.99]))
    assert first is not None and second is not None and first.tables[0] is second.tables[0]
