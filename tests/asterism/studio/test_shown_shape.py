"""The shapes that the server keeps for pages: meshes in use, and shapes by number."""

from __future__ import annotations

import numpy as np

from asterism.studio import frames
from asterism.studio.messages import Form, FormShape, Frame, ShapeSummary, SheetPart, ShownMesh
from asterism.studio.shown_shape import Shown

SQUARE = np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]])
ARMS = np.zeros((0, 2, 3, 3))


def mesh(number: int) -> ShownMesh:
    return ShownMesh(number, SQUARE, np.array([[0, 1, 2], [0, 2, 3]]), np.arange(4), np.empty(0, dtype=np.int64))


def frame(number: int, height: float = 0.0) -> Frame:
    places = np.pad(SQUARE, ((0, 0), (0, 1)), constant_values=height)
    zeros = np.zeros(4)
    before = SheetPart(places, ARMS, ARMS[:, 0], ARMS[:, 0])
    return Frame(1, number, "equilibrium", places, zeros, zeros, ARMS, ARMS[:, 0], ARMS[:, 0], before=before)


def test_a_mesh_stays_as_long_as_frames_on_it_come() -> None:
    shown = Shown()
    for number in range(1, 20):
        shown.add_mesh(mesh(number))
        shown.add_frame(frame(1), number, ())
    assert 1 in shown.meshes and 2 not in shown.meshes and len(shown.meshes) == 6


def test_a_kept_shape_is_complete_and_is_there_as_long_as_it_is_held() -> None:
    shown = Shown()
    assert shown.keep_shown() is None
    shown.add_mesh(mesh(1))
    shown.add_frame(frame(1, 2.0), 0, ())
    kept = shown.keep_shown()
    assert kept is not None and shown.kept[kept.number] is kept
    shown.add_frame(frame(1, 5.0), 1, ())
    _, header, arrays = frames.unpack(kept.packed())
    assert header["stage"] == "equilibrium" and arrays["positions"][:, 2].tolist() == 4 * [2.0]
    assert {"printed", "triangles", "outline", "arm_site"} < arrays.keys() and "before" not in arrays
    del kept
    assert len(shown.kept) == 0


def test_a_form_has_its_shape_until_the_next_summary() -> None:
    shown = Shown()
    shown.add_mesh(mesh(1))
    summary = ShapeSummary(1, {}, (), (Form(-1, "up", 0.0, True), Form(0, "down", 2.0, False)))
    shown.add_summary(summary, 0)
    shown.add_form_shape(FormShape(1, 0, frame(1, 3.0)))
    here, other = shown.state()["forms"]
    assert here["shape"] is None and shown.kept[other["shape"]].header["stage"] == "equilibrium"
    shown.add_summary(summary, 1)
    assert [form["shape"] for form in shown.state()["forms"]] == [None, None]
