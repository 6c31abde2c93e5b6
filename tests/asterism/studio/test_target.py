"""The target that a page sends, weights of places in a fit to it, and parts that pages show beside the shape."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from starlette.testclient import TestClient

from asterism.fitting.target import TargetSurface
from asterism.studio.document import Document
from asterism.studio.frames import TARGET
from asterism.studio.messages import Edit, FitTarget, Parts, TargetPose
from asterism.studio.requests import RequestError
from asterism.studio.studio import Studio
from asterism.studio.target import Target, sheet_weights
from tests.asterism.fitting.test_load_target import nurbs_vault, rhino_file
from tests.asterism.studio.conftest import LIVE, ORIGIN, TOKEN, Page, upload
from tests.asterism.studio.flat_frames import unpack

# twelve by nine points
GRID = [(float(x), float(y), x * y / 10.0) for y in range(9) for x in range(12)]
CELLS = [(12 * y + x + 1, 12 * y + x + 2, 12 * y + x + 14, 12 * y + x + 13) for y in range(8) for x in range(11)]
ROOF = "".join(f"v {x} {y} {z}\n" for x, y, z in GRID) + "".join(f"f {a} {b} {c} {d}\n" for a, b, c, d in CELLS)


def send_roof(client: TestClient, name: str = "roof.obj") -> dict[str, Any]:
    data: dict[str, Any] = upload(client, "target", name, ROOF.encode()).json()["target"]
    return data


def shown(client: TestClient) -> Any:
    """(V, 3) places of the target as a page gets them."""
    kind, _, arrays = unpack(client.get(f"/{TOKEN}/target").content)
    assert kind == TARGET and arrays["triangles"].shape == (176, 3)
    return arrays["positions"]


def is_done(page: Page) -> None:
    """Wait until the server has answered all that the page has sent."""
    page.send(type="gallery")
    page.until("gallery")


@pytest.mark.slow
def test_a_target_is_kept_in_its_unit_and_pose_until_it_is_removed(client: TestClient, page: Page, studio: Studio):
    page.until("shape")
    assert send_roof(client)["name"] == "roof.obj"
    page.send(type="target", unit="cm")
    is_done(page)
    data = studio.parts.data()
    assert data is not None and data["unit"] == "cm" and data["size_mm"] == [110.0, 80.0, 88.0]
    assert np.asarray(shown(client)).max(axis=0).tolist() == [110.0, 80.0, 88.0]
    page.send(type="target", do="fit")
    is_done(page)
    question = studio.engine.link.edits[-1]  # type: ignore[attr-defined]
    assert isinstance(question, FitTarget)
    late = TargetPose(question.seq - 1, np.eye(3), np.ones(3))
    answer = TargetPose(question.seq, np.diag([-1.0, -1.0, 1.0]), np.array([0.0, 0.0, 7.0]))
    for pose in (late, answer):
        studio.parts.move(pose)
    assert studio.parts.target is not None and studio.parts.target.is_fitted
    assert shown(client)[-1].tolist() == [-110.0, -80.0, 95.0]
    page.send(type="target", do="remove")
    page.until("state", target=None)
    assert client.get(f"/{TOKEN}/target").status_code == 404
    page.send(type="target", do="fit", seq=5)
    assert "send a file first" in page.until("problem", seq=5)["text"]


def test_the_engine_sends_the_sheet_without_bumps_while_a_page_shows_it(client: TestClient, page: Page, studio: Studio):
    asked: list[Any] = studio.engine.link.edits  # type: ignore[attr-defined]
    page.send(type="bumps", shown=False)
    is_done(page)
    assert asked[-1] == Parts(asked[-1].seq, smooth=True)
    with client.websocket_connect(LIVE, headers=ORIGIN) as socket:
        other = Page(socket)
        other.send(type="bumps", shown=False)
        is_done(other)
    page.send(type="bumps", shown=True)
    is_done(page)
    assert asked[-1] == Parts(asked[-1].seq, smooth=False)


@pytest.mark.slow
def test_a_surface_of_rhino_is_a_target_in_mm(client: TestClient, page: Page, studio: Studio, tmp_path: Path):
    rhino3dm = pytest.importorskip("rhino3dm")
    page.until("shape")
    content = rhino_file(tmp_path / "vault.3dm", Surface=nurbs_vault(rhino3dm)).read_bytes()
    data = upload(client, "target", "vault.3dm", content).json()["target"]
    assert data["unit"] == "mm" and data["size_mm"][:2] == pytest.approx([100.0, 100.0])
    answer = upload(client, "target", "vault.3dm", content[:200])
    assert answer.json()["problem"]["text"] == "vault.3dm: cannot be read as 3DM: the file is damaged or cut short"


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
