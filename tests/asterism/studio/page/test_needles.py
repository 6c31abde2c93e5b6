"""Needles on the page: placed, lifted in the view, drawn together, sliding, removed."""

from __future__ import annotations

import math

import numpy as np
import pytest

from tests.asterism.studio.browser import StudioPage


def canopy(page: StudioPage) -> StudioPage:
    page.open_again("file-canopy.toml", "needles")
    return page


@pytest.fixture
def page(flat: StudioPage) -> StudioPage:
    return canopy(flat)


def table(page: StudioPage) -> dict[str, list[list[float]]]:
    pins: dict[str, list[list[float]]] = page.get("studio.document.design.pins[0]")
    return pins


def test_four_clicks_on_a_free_sheet_carry_it(flat: StudioPage) -> None:
    flat.open_again("file-even.toml", "needles")
    corners = flat.get("studio.document.plan.outline_mm")
    for k in (0, 2, 3, 5):
        flat.changed(lambda k=k: flat.page.mouse.click(*flat.point(corners[k])))  # type: ignore[misc]
    pins = table(flat)
    assert len(pins["points_mm"]) == len(pins["target_mm"]) == 4
    assert pins["points_mm"][1] == pytest.approx(corners[2], abs=0.01)
    assert pins["target_mm"][1] == pytest.approx([value / 1.35 for value in corners[2]] + [0], abs=0.01)


def test_needles_are_drawn_together_by_one_number_and_slide_along_themselves(page: StudioPage) -> None:
    page.item("support-0").click()
    before = table(page)
    page.changed(lambda: page.fill("support-spread", 0.6))
    factor = 0.6 / math.sqrt((31**2 + 18**2) / (43**2 + 24.8**2))
    expected = [[factor * x, factor * y, z] for x, y, z in before["target_mm"]]
    assert np.allclose(table(page)["target_mm"], expected, atol=0.01)
    assert page.item("support-spread").input_value() == "0.6"
    page.changed(lambda: page.item("support-slide").select_option("z"))
    assert page.get("studio.document.design.pins[0].slide") == "z"
    assert "rises freely" in page.item("support-0").inner_text()
    page.changed(lambda: page.item("support-slide").select_option(""))
    assert page.get("typeof studio.document.design.pins[0].slide") == "undefined"


def test_a_needle_is_duplicated_moved_and_removed_and_the_sheet_freed(page: StudioPage) -> None:
    before = table(page)
    page.page.mouse.click(*page.point(before["points_mm"][0]))
    page.changed(page.item("duplicate-needle").click)
    after = table(page)
    assert after["points_mm"][:-1] == before["points_mm"]
    assert after["points_mm"][-1] == pytest.approx([0.75 * value for value in before["points_mm"][0]], abs=0.01)
    assert after["target_mm"][-1][2] == before["target_mm"][0][2]
    page.page.get_by_text("Needle 5").wait_for()  # the copy is chosen
    page.changed(page.item("undo").click)
    assert table(page) == before
    page.changed(lambda: page.drag((43.0, 24.8), (36.0, 20.0)))
    assert table(page)["points_mm"][0] == pytest.approx([36.0, 20.0], abs=1.0)
    page.page.mouse.click(*page.point(table(page)["points_mm"][0]))
    page.changed(lambda: page.item("remove-needle").click())
    assert len(table(page)["points_mm"]) == 3
    page.changed(lambda: page.item("free-sheet").click())
    assert not page.get("studio.document.design.pins")


def test_a_group_is_split_and_its_needles_are_lifted_alone_and_together(flat: StudioPage) -> None:
    flat.open_again("file-even.toml", "needles")
    flat.changed(lambda: flat.item("hold-corners").click())
    flat.page.evaluate("document.getElementById('plan-canvas').focus()")
    flat.changed(lambda: flat.page.keyboard.press("PageUp"))  # the whole group, which is chosen
    assert flat.get("studio.document.design.pins[0].offset_mm") == [0, 0, 1]
    flat.changed(lambda: flat.item("split-support").click())
    before = table(flat)
    assert len(before["points_mm"]) == 6 and {z for _, _, z in before["target_mm"]} == {1}
    flat.changed(lambda: flat.fill("needle-target-z", 12))
    assert [z for _, _, z in table(flat)["target_mm"]] == [12, 1, 1, 1, 1, 1]
    flat.page.mouse.click(*flat.point(before["points_mm"][1]))
    flat.page.keyboard.down("Control")
    flat.page.mouse.click(*flat.point(before["points_mm"][2]))
    flat.page.keyboard.up("Control")
    flat.changed(lambda: flat.fill("several-height", 5))
    assert [z for _, _, z in table(flat)["target_mm"]] == [12, 5, 5, 1, 1, 1]


def test_needles_follow_another_stretch_by_one_button(page: StudioPage) -> None:
    before = table(page)["target_mm"]
    page.item("tab-sheet").click()
    assert not page.item("follow-stretch").count()
    page.fill("stretch", 1.5)
    page.wait(
        "studio.document.design.fabric?.stretch === 1.5 && document.querySelector('[data-testid=needles-follow]')"
    )
    assert table(page)["target_mm"] == before and "1.35" in page.item("needles-follow").inner_text()
    revision = page.get("studio.revision")
    page.item("follow-stretch").click()
    page.wait(f"studio.revision !== {revision} && !studio.isWaiting")
    assert not page.item("follow-stretch").count()
    expected = [[1.35 / 1.5 * x, 1.35 / 1.5 * y, z] for x, y, z in before]
    assert np.allclose(table(page)["target_mm"], expected, atol=0.01)


def test_a_sheet_that_is_too_large_for_the_printer_is_told_while_it_is_drawn(page: StudioPage) -> None:
    assert not page.item("too-large").count()
    page.item("tool-outline").click()
    x, y = page.get("studio.document.plan.outline_mm")[0]
    page.draw((x, y), (x + 4.0, y + 260.0))
    page.wait("document.querySelector('[data-testid=too-large]')")  # the button is still down
    page.page.keyboard.press("Escape")
    page.page.mouse.up()
    page.wait("!document.querySelector('[data-testid=too-large]')")


def test_needles_are_lifted_in_the_view_alone_and_together(shared: StudioPage) -> None:
    page, mouse = canopy(shared), shared.page.mouse
    page.page.evaluate("studio.draw()")  # the first picture places the camera
    page.page.evaluate("document.getElementById('view-canvas').focus()")
    box = page.item("view").bounding_box()

    def head(number: int) -> tuple[float, float]:
        x, y, z = table(page)["target_mm"][number]
        at = page.get(f"studio.viewOf([{x}, {y}, {z + 3.4}])")
        return box["x"] + at[0], box["y"] + at[1]

    def lift(number: int) -> None:
        x, y = head(number)
        mouse.move(x, y)
        assert page.get("document.getElementById('view-canvas').style.cursor") == "ns-resize"
        mouse.down()
        mouse.move(x, y - 60, steps=5)
        mouse.up()

    page.changed(lambda: lift(0))
    assert table(page)["target_mm"][0][2] > 5
    assert table(page)["target_mm"][0][:2] == [31, 18]
    assert page.item("needle-target-z").input_value() == str(table(page)["target_mm"][0][2])
    page.changed(page.item("undo").click)

    page.page.keyboard.press("Escape")
    page.page.keyboard.down("Control")
    for number in (0, 3):
        mouse.click(*head(number))
    page.page.keyboard.up("Control")
    page.item("several-height").wait_for()
    page.changed(lambda: lift(3))
    heights = [target[2] for target in table(page)["target_mm"]]
    assert heights[0] == heights[3] > 5 and heights[1] == heights[2] == 0
