"""The shapes that the server keeps for pages: meshes in use, and shapes by number."""

from __future__ import annotations

from asterism.studio import frames
from asterism.studio.messages import Form, ShapeSummary
from asterism.studio.pages import Shown, Tab
from tests.asterism.studio.flat_frames import SQUARE, flat_frame, flat_places, unpack
from tests.event_loop import run_coroutine


def test_a_page_gets_a_mesh_before_the_first_shape_on_it_and_again_when_it_may_have_forgotten_it() -> None:
    sent: list[int] = []

    class Socket:
        async def send_bytes(self, frame: bytes) -> None:
            kind, header, _ = unpack(frame)
            number = numbers[header["mesh"]]
            sent.append(-number if kind == frames.MESH else number)

    async def draw(*which: int) -> None:
        for number in which:
            await tab._draw(Socket(), meshes[number - 1], 0)  # type: ignore[arg-type]

    tab, meshes = Tab(1), [flat_frame(1, printed=number * SQUARE) for number in range(1, 8)]
    numbers = {frame.mesh: number for number, frame in enumerate(meshes, 1)}
    run_coroutine(draw(1, 2, 1, *range(3, 8), 1, 2))
    assert sent == [-1, 1, -2, 2, 1, *(sign * number for number in range(3, 8) for sign in (-1, 1)), 1, -2, 2]


def test_a_kept_shape_is_complete_and_is_there_as_long_as_it_is_held() -> None:
    shown = Shown()
    assert shown.keep_shown() is None
    shown.add_frame(flat_frame(1, height=2.0, beside={"before": flat_places(3.0)}), 0, ())
    kept = shown.keep_shown()
    assert kept is not None and shown.kept[kept.number] is kept
    shown.add_frame(flat_frame(1, height=5.0), 1, ())
    _, header, arrays = unpack(kept.packed())
    assert header["stage"] == "equilibrium" and arrays["positions"][:, 2].tolist() == 4 * [2.0]
    assert {"printed", "triangles", "outline", "arm_site"} < arrays.keys() and "before" not in arrays
    del kept
    assert len(shown.kept) == 0


def test_a_form_has_its_shape_until_the_next_summary() -> None:
    shown = Shown()
    summary = ShapeSummary(1, {}, (), (Form(-1, "up", 0.0, True), Form(0, "down", 2.0, False)))
    shown.add_summary(summary, 0)
    shown.add_form(flat_frame(1, height=3.0, form=0))
    here, other = shown.state()["forms"]
    assert here["shape"] is None and shown.kept[other["shape"]].frame.stage == "equilibrium"
    shown.add_summary(summary, 1)
    assert [form["shape"] for form in shown.state()["forms"]] == [None, None]
