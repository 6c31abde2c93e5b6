"""The shapes that the server keeps for pages: meshes in use, and shapes by number."""

from __future__ import annotations

from asterism.studio import frames
from asterism.studio.messages import Form, FormShape, ShapeSummary
from asterism.studio.shown_shape import Shown
from tests.asterism.studio.flat_frames import flat_frame, flat_mesh, flat_part


def test_a_mesh_stays_as_long_as_frames_on_it_come() -> None:
    shown = Shown()
    for number in range(1, 20):
        shown.add_mesh(flat_mesh(number))
        shown.add_frame(flat_frame(1), number, ())
    assert 1 in shown.meshes and 2 not in shown.meshes and len(shown.meshes) == 6


def test_a_kept_shape_is_complete_and_is_there_as_long_as_it_is_held() -> None:
    shown = Shown()
    assert shown.keep_shown() is None
    shown.add_mesh(flat_mesh())
    shown.add_frame(flat_frame(1, height=2.0, before=flat_part(3.0)), 0, ())
    kept = shown.keep_shown()
    assert kept is not None and shown.kept[kept.number] is kept
    shown.add_frame(flat_frame(1, height=5.0), 1, ())
    _, header, arrays = frames.unpack(kept.packed())
    assert header["stage"] == "equilibrium" and arrays["positions"][:, 2].tolist() == 4 * [2.0]
    assert {"printed", "triangles", "outline", "arm_site"} < arrays.keys() and "before" not in arrays
    del kept
    assert len(shown.kept) == 0


def test_a_form_has_its_shape_until_the_next_summary() -> None:
    shown = Shown()
    shown.add_mesh(flat_mesh())
    summary = ShapeSummary(1, {}, (), (Form(-1, "up", 0.0, True), Form(0, "down", 2.0, False)))
    shown.add_summary(summary, 0)
    shown.add_form_shape(FormShape(1, 0, flat_frame(1, height=3.0)))
    here, other = shown.state()["forms"]
    assert here["shape"] is None and shown.kept[other["shape"]].header["stage"] == "equilibrium"
    shown.add_summary(summary, 1)
    assert [form["shape"] for form in shown.state()["forms"]] == [None, None]
