"""The page by keyboard alone: needles, corners and the table of stars; the focus stays where the person is."""

from __future__ import annotations

import numpy as np
import pytest

from tests.asterism.studio.browser import StudioPage

pytestmark = pytest.mark.slow

SPACING_MM = np.sqrt(300.0)  # of the stars of the dome
FOCUSED = "document.activeElement.dataset.testid"


def test_a_needle_is_set_at_a_star_and_its_fields_are_left_by_tab(shared: StudioPage) -> None:
    shared.open("file-canopy.toml")
    press = shared.page.keyboard.press
    shared.page.locator("#plan-canvas").focus()
    press("n")
    press("ArrowRight")  # to the star in the middle
    shared.changed(lambda: press("Enter"))
    points = "studio.document.design.pins.flatMap((table) => table.points_mm)"
    assert shared.get(points)[4:] == [[0.0, 0.0]]
    shared.item("needle-at-x").focus()
    shared.item("needle-at-x").fill("3")
    shared.changed(lambda: press("Tab"))
    assert shared.get(FOCUSED) == "needle-at-y"
    assert shared.get(points)[4] == [3.0, 0.0]


def test_corners_are_typed_added_and_removed(shared: StudioPage) -> None:
    shared.open("gallery-dome")
    press = shared.page.keyboard.press
    shared.page.locator("#plan-canvas").focus()
    press("o")
    corners = shared.get("studio.document.plan.outline_mm")
    shared.item("corner-0-x").focus()
    shared.item("corner-0-x").fill(str(round(corners[0][0] - 4, 2)))
    shared.changed(lambda: press("Tab"))
    assert shared.get(FOCUSED) == "corner-0-y"
    shared.item("corner-0-y").fill(str(round(corners[0][1] - 2, 2)))
    shared.changed(lambda: press("Tab"))
    moved = shared.get("studio.document.plan.outline_mm")[0]
    assert moved == pytest.approx([corners[0][0] - 4, corners[0][1] - 2], abs=0.01)
    shared.page.locator("#plan-canvas").focus()
    shared.changed(lambda: press("Insert"))
    assert len(shared.get("studio.document.plan.outline_mm")) == len(corners) + 1
    shared.changed(lambda: press("Delete"))
    assert len(shared.get("studio.document.plan.outline_mm")) == len(corners)


def test_the_table_of_stars_is_filled_from_field_to_field(shared: StudioPage) -> None:
    shared.open("gallery-dome")
    press = shared.page.keyboard.press
    shared.page.locator("#plan-canvas").focus()
    press("t")
    shared.item("star-0-length").focus()
    shared.item("star-0-length").fill("6")
    shared.changed(lambda: press("Tab"))
    assert shared.get(FOCUSED) == "star-0-thickness"
    shared.item("star-0-thickness").fill("0.9")
    shared.changed(lambda: press("Tab"))
    assert shared.get(FOCUSED) == "star-0-width"
    assert shared.get("studio.sizes[0]")[:2] == pytest.approx([6.0, 0.9])
    press("Escape")
    shared.wait("!document.querySelector('dialog[open]')")
    for keys, name in (("Control+s", "saved"), ("Control+e", "export")):
        shared.page.locator("#plan-canvas").focus()
        press(keys)
        if name == "saved":
            shared.wait("studio.document.saved")
        else:
            shared.wait("document.querySelector('dialog[open]')")
            press("Escape")
            shared.wait("!document.querySelector('dialog[open]')")


def test_every_control_that_tab_reaches_shows_the_focus(shared: StudioPage) -> None:
    shared.open("gallery-dome")
    shared.page.locator("#plan-canvas").focus()
    shared.page.keyboard.press("b")
    shared.page.locator("#top input").focus()
    seen: list[str] = []
    for _ in range(80):
        shared.page.keyboard.press("Tab")
        name, is_shown = shared.get(
            """(() => {
                const one = document.activeElement;
                const style = getComputedStyle(one);
                const around = getComputedStyle(one.parentElement);
                const isShown = [style.outlineStyle, style.boxShadow, around.boxShadow].some((one) => one !== "none");
                return [one.dataset.testid ?? one.id ?? one.tagName, isShown];
            })()"""
        )
        assert is_shown or name == "", name
        seen.append(name)
    for name in ("save", "export", "verify", "tool-needles", "plan", "view", "named-view", "target"):
        assert name in seen, name


def test_the_brush_the_gradient_and_the_ruler_work_at_the_star_of_the_keyboard(shared: StudioPage) -> None:
    shared.open("gallery-dome")
    press = shared.page.keyboard.press
    shared.page.locator("#plan-canvas").focus()
    press("b")
    press("ArrowRight")  # to the star in the middle
    before = shared.get("studio.sizes")
    shared.changed(lambda: press("Enter"))
    assert shared.get("studio.sizes") != before and shared.get("studio.document.can_undo")
    press("r")
    press("Enter")
    press("ArrowRight")
    press("Enter")
    assert shared.get("studio.measured")["printed"] == pytest.approx(np.sqrt(3.0) * SPACING_MM)
    press("g")
    press("Enter")
    press("ArrowRight")
    shared.changed(lambda: press("Enter"))
    profile = shared.get("studio.document.design.stars.length_mm")
    assert profile["centre_mm"] == pytest.approx([np.sqrt(3.0) * SPACING_MM, 0.0], abs=0.05)
    assert profile["over_mm"] == pytest.approx(SPACING_MM, abs=0.05)
