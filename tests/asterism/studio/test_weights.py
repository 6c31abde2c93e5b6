"""Weights of places in a fit: painted in one gesture, undone, saved, and passed on to the target through the sheet."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from asterism.fitting.target import TargetSurface
from asterism.studio.document import Document
from asterism.studio.messages import Edit
from asterism.studio.requests import RequestError
from asterism.studio.studio import Studio
from asterism.studio.target import Target, sheet_weights
from tests.asterism.studio.conftest import Page


def weights(page: Page) -> dict[tuple[int, int], float]:
    sites = page.until("document")["plan"]["sites"]
    return {tuple(entry["site"]): entry["weight"] for entry in sites if entry["weight"] != 1.0}


def test_a_stroke_is_one_step_of_undo_and_leaves_the_shape(page: Page, studio: Studio) -> None:
    assert weights(page) == {}
    page.until("shape")
    page.send(type="weigh", gesture=1, end=False, sites=[[0, 0]], weights=[2.0])
    page.send(type="weigh", gesture=1, end=True, sites=[[0, 0], [1, 0]], weights=[4.00044, 3.0])
    assert weights(page) == {(0, 0): 4.0, (1, 0): 3.0}
    edits = [edit for edit in studio.engine.link.edits if isinstance(edit, Edit)]  # type: ignore[attr-defined]
    assert all(edit.design == edits[0].design for edit in edits)
    page.send(type="weigh", gesture=2, sites=[[1, 0]], weights=[None])
    assert weights(page) == {(0, 0): 4.0}
    page.send(type="undo")
    assert weights(page) == {(0, 0): 4.0, (1, 0): 3.0}
    page.send(type="undo")
    assert weights(page) == {}
    assert studio.document is not None and studio.document.is_saved


def test_other_weights_are_refused_in_one_line(page: Page, studio: Studio) -> None:
    page.until("document")
    for weights, problem in (
        ([0.0], "fit.weights[0].weight = 0.0"),
        ([101.0], "fit.weights[0].weight = 101.0"),
        ([], "one value for each of the 1 sites"),
        (["much"], "weights"),
    ):
        page.send(type="weigh", gesture=1, sites=[[0, 0]], weights=weights)
        assert problem in page.until("problem")["text"]
    assert studio.document is not None and "fit" not in studio.document.table


def test_each_place_of_the_target_has_the_weight_of_the_nearest_place_of_the_sheet() -> None:
    """Also if the target is shown turned, shifted and in another unit."""
    surface = TargetSurface.of_formula("10*(1 - (r/50)**2)", 80.0)
    in_file = surface.disk.vertices / 10.0 + np.array([3.0, 0.0, 7.0])
    turn = np.array([[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]])
    target = Target("vault.obj", in_file, surface.disk.triangles, "cm", turn, np.array([5.0, -2.0, 1.0]))
    # the sheet lies on the shown target; printed places are a tenth larger
    shown = target.surface.vertices.astype(float)
    printed = 1.1 * (surface.disk.vertices[:, :2])
    document = Document({"stars": {"length_mm": 8.0}, "border": {"rings": 2}}, Path("sheet.toml"))
    assert sheet_weights(document.table, document.layout, (printed, shown), target) is None
    document.weigh([(0, 0), (50, 50)], [9.0, 3.0])
    with pytest.raises(RequestError, match="wait until the sheet is shown"):
        sheet_weights(document.table, document.layout, None, target)
    of_sheet = sheet_weights(document.table, document.layout, (printed, shown), target)
    assert of_sheet is not None
    fitted = TargetSurface.of_triangles(target.surface_of_file.vertices, target.triangles)
    weight = of_sheet.at_vertices(fitted)
    # vertices of this target are those of the file: the cell of the site in the middle, on the print
    radius = np.linalg.norm(printed, axis=1)
    spacing = document.layout.spacing_mm
    assert (weight[radius < 0.49 * spacing] == 9.0).all() and (weight[radius > 0.6 * spacing] == 1.0).all()
    assert 0 < (weight == 9.0).sum() < len(weight)
