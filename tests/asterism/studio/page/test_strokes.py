"""No stroke is lost, and none is made by accident."""

from __future__ import annotations

from collections.abc import Callable

import pytest

from tests.asterism.studio.browser import StudioPage


@pytest.mark.parametrize(
    ("tool", "places"),
    [
        ("brush", [(0.0, 0.0), (10.0, 5.0)]),
        ("needles", [(5.0, 3.0), (9.0, 4.0)]),
        ("outline", [(50.0, 0.0), (60.0, 3.0)]),
        ("gradient", [(-30.0, 0.0), (20.0, 3.0)]),
    ],
)
def test_escape_calls_a_stroke_off(flat: StudioPage, tool: str, places: list[tuple[float, float]]) -> None:
    flat.open_again("file-even.toml" if tool == "needles" else "file-plain.toml", tool)
    before, design = flat.get("studio.sizes"), flat.get("studio.document.design")
    steps = flat.get("studio.document.can_undo")
    if tool == "outline":
        places = [tuple(flat.get("studio.document.plan.outline_mm[0]")), *places[1:]]
    flat.draw(*places)
    flat.page.wait_for_timeout(150)  # until what was drawn on the way is sent
    assert flat.get("studio.isEditing")
    flat.page.keyboard.press("Escape")
    assert flat.get("studio.sizes") == before
    flat.page.mouse.move(*flat.point((0.0, 0.0)))
    flat.page.mouse.up()
    flat.rest()
    assert flat.get("studio.document.design") == design and flat.get("studio.sizes") == before
    assert flat.get("studio.document.can_undo") == steps


def test_two_fingers_zoom_and_do_not_paint(flat: StudioPage) -> None:
    flat.open_again("file-plain.toml", "brush")
    before, scale = flat.get("studio.sizes"), flat.point((10.0, 0.0))[0] - flat.point((0.0, 0.0))[0]
    touch = flat.page.context.new_cdp_session(flat.page)

    def fingers(kind: str, *places: tuple[float, float]) -> None:
        points = [dict(zip("xy", flat.point(place), strict=True), id=k) for k, place in enumerate(places)]
        touch.send("Input.dispatchTouchEvent", {"type": kind, "touchPoints": points})

    fingers("touchStart", (-5.0, 0.0))
    fingers("touchMove", (-6.0, 0.0))
    flat.page.wait_for_timeout(100)
    fingers("touchStart", (-6.0, 0.0), (5.0, 0.0))
    fingers("touchMove", (-9.0, 0.0), (8.0, 0.0))
    fingers("touchMove", (-12.0, 0.0), (11.0, 0.0))
    fingers("touchEnd")
    flat.rest()
    assert flat.get("studio.sizes") == before
    assert flat.point((10.0, 0.0))[0] - flat.point((0.0, 0.0))[0] > 1.2 * scale


def test_strokes_without_a_connection_follow_when_it_is_there_again(new_flat: Callable[[], StudioPage]) -> None:
    page = new_flat()
    page.open_again("file-plain.toml")
    is_open = [True]
    sockets = page.live_sockets(lambda: is_open[0])
    page.item("tool-brush").click()
    sizes, revision = page.get("studio.sizes"), page.get("studio.revision")
    is_open[0] = False
    sockets[-1].close()
    page.wait("!studio.connected")
    page.drag((0.0, 0.0), (8.0, 5.0))
    drawn = page.get("studio.sizes")
    assert drawn != sizes
    is_open[0] = True
    page.wait(f"studio.connected && studio.revision > {revision}")
    page.rest()
    saved = page.get("studio.sizes")
    assert saved == [pytest.approx(one, abs=0.01) for one in drawn]


def test_a_stroke_on_the_sheet_in_space_paints(shared: StudioPage) -> None:
    page = shared
    page.open_again("file-plain.toml", "brush")
    page.item("view").focus()
    page.page.keyboard.press("2")  # from above
    page.item("view").hover()
    page.page.keyboard.press("d")
    page.fill("target", 5)
    page.fill("strength", 100)
    before = page.get("studio.sizes.map((sizes) => sizes[0])")
    box, at = page.item("view").bounding_box(), page.get("studio.viewOf([0, 0, 12])")
    x, y = box["x"] + at[0], box["y"] + at[1]

    def stroke() -> None:
        page.press((x, y), (x + 3, y))
        page.page.mouse.up()

    page.changed(stroke)
    after = page.get("studio.sizes.map((sizes) => sizes[0])")
    assert abs(after[0] - 5) < 0.2 < abs(before[0] - 5)  # the star in the middle
    assert after[-1] == before[-1]
    camera = page.get("studio.camera")
    page.page.keyboard.press("d")
    page.press((x, y), (x + 60, y))
    page.page.mouse.up()
    assert page.get("studio.camera.turn") != camera["turn"]
    assert page.get("studio.sizes.map((sizes) => sizes[0])") == after


def test_a_pen_that_is_pressed_less_paints_less(flat: StudioPage) -> None:
    flat.open_again("file-plain.toml", "brush")
    pen = flat.page.context.new_cdp_session(flat.page)
    x, y = flat.point((0.0, 0.0))
    before, changes = flat.get("studio.sizes"), []
    for force in (1.0, 0.25):
        for kind in ("mousePressed", "mouseReleased"):
            told = {"type": kind, "x": x, "y": y, "button": "left", "clickCount": 1, "pointerType": "pen"}
            pen.send("Input.dispatchMouseEvent", {**told, "force": force if kind == "mousePressed" else 0.0})
        flat.wait("!studio.isEditing && !studio.isWaiting")
        sizes = flat.get("studio.sizes")
        changes.append(max(abs(now[0] - old[0]) for now, old in zip(sizes, before, strict=True)))
        flat.changed(flat.item("undo").click)
    assert changes[1] == pytest.approx(0.25 * changes[0], rel=0.02) and changes[0] > 0.1
