"""The target surface that a page sends, and the parts that pages show beside the shape."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from starlette.testclient import TestClient

from asterism.studio.frames import TARGET
from asterism.studio.messages import FitTarget, Parts, TargetPose
from asterism.studio.studio import Studio
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
