"""Previews of motifs, with their state kept for edits."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

from asterism.pattern import gallery
from asterism.pattern.design.design import Design
from asterism.pattern.design.errors import DesignError
from asterism.previews import session as preview_session
from asterism.previews.session import Preview, preview
from tests.asterism.previews.laws import plain_law
from tests.asterism.previews.motifs.nets import CROSS, GRADED, net, net_law

PINS = [{"where": "corners"}]


def test_the_plastic_is_outside_and_the_shape_is_certified() -> None:
    design = net()
    shape = Preview(design, net_law(design), triangles=16).shape()
    assert shape.summary.is_minimum and not shape.summary["warnings"]
    assert shape.point_fields["mean_curvature_per_mm"].min() > 0.0
    assert shape.summary["stars"] == 0 and shape.summary["rods_total"] == len(shape.rods)
    assert shape.summary["contraction"] < 1.0


@pytest.mark.slow
def test_a_sheet_that_its_rims_collapse_is_refused_early_and_a_thicker_one_is_not() -> None:
    design = Design.from_dict(gallery.load("diamond-auxetic").to_dict() | {"mesh": {"edge_mm": 2.0}})
    session = Preview(design)
    assert [trial.name for trial in session.equilibrium.trials] == ["arc"]  # not in load steps, which take as long
    (first, *_) = session.shape().summary["warnings"]
    assert first.startswith("not an equilibrium: at wide rims the tension") and first.endswith("asterism simulate")
    thicker = design.to_dict()
    thicker["rods"]["thickness_mm"] = 0.4
    assert Preview(Design.from_dict(thicker)).shape().summary.is_minimum


@pytest.mark.slow
def test_rods_lie_along_the_triangles_with_their_sizes() -> None:
    design = net(GRADED)
    shape = Preview(design, net_law(design)).shape()
    edges = np.sort(shape.rod_edges, axis=1)
    sides = np.sort(shape.triangles[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2), axis=1)
    assert set(map(tuple, edges)) <= set(map(tuple, sides))
    middle = shape.printed[shape.rod_edges].mean(axis=1)[:, 0]
    assert shape.rod_fields["thickness_mm"] == pytest.approx(np.clip(0.45 + 0.0025 * middle, 0.4, 0.5), abs=1e-3)


@pytest.mark.slow
def test_sizes_are_edited_without_new_cells(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("ASTERISM_CELLS", str(tmp_path))
    said: list[str] = []
    design = net()
    law = net_law(design)
    wide = net_law(net(0.41), law, said.append)
    assert len(said) == len(wide.plan.tasks()) - 1
    session = Preview(design, wide, triangles=16)
    stages = [stage.name for stage in session.edit(net(0.44))]
    assert stages == ["linear", "equilibrium"]
    again = Preview(net(0.44), wide, triangles=16)
    assert session.equilibrium.energy == pytest.approx(again.equilibrium.energy, rel=1e-8)
    assert net_law(net(0.44), wide, said.append) is wide and len(said) == len(wide.plan.tasks()) - 1


@pytest.mark.slow
def test_one_session_takes_another_motif_and_stars_after_a_motif(monkeypatch: pytest.MonkeyPatch) -> None:
    def serving(design: Design, plan: object, known: Any, say: Any) -> Any:
        return plain_law() if design.rods is None else net_law(design, known, say)

    monkeypatch.setattr(preview_session, "serving_law", serving)
    session = Preview(net())
    law = session.law
    session.update(net(pins=PINS))
    assert session.law is law
    assert session.update(net(rods={"motif": [CROSS[0]], "thickness_mm": 0.4})).summary.is_minimum
    assert session.law is not law
    session.update(Design.from_dict({"border": {"rings": 1}, "stars": {"length_mm": 9.0, "thickness_mm": 0.3}}))
    assert len(session.sheet.values.sizes) == 7
    session.update(net())
    assert session.sheet.layout.drawn is not None


@pytest.mark.parametrize(
    ("sections", "named"),
    [
        ({"rods": {"draw": [{"line_mm": [(-15, 0), (15, 0)]}]}}, "do not repeat have no law; .*asterism simulate"),
        ({"rods": {"motif": CROSS, "draw": [{"line_mm": [(-15, 1), (15, 1)]}]}}, "rods.draw: must be left out"),
        ({"fabric": {"bending": "none"}}, "fabric.bending"),
    ],
)
def test_patterns_without_a_law_are_refused_in_one_line(sections: dict[str, Any], named: str) -> None:
    with pytest.raises(DesignError, match=named) as raised:
        preview(net(**sections))
    assert "\n" not in str(raised.value)


def test_a_law_of_stars_is_no_law_of_a_motif() -> None:
    with pytest.raises(TypeError, match="load_law reads the law of a motif"):
        Preview(net(), plain_law())
