"""The page by keyboard alone: needles, corners and the table of stars; the focus stays where the person is."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest

from tests.asterism.studio.browser import StudioPage

SPACING_MM = np.sqrt(300.0)  # of the stars of the dome
FOCUSED = "document.activeElement.dataset.testid"


def at_the_plan(page: StudioPage, name: str) -> Callable[[str], None]:
    """Open a design with the focus on its plan; presses a key."""
    page.open_again(name)
    page.page.locator("#plan-canvas").focus()
    press: Callable[[str], None] = page.page.keyboard.press
    return press


def test_a_needle_is_set_at_a_star_and_its_fields_are_left_by_tab(flat: StudioPage) -> None:
    press = at_the_plan(flat, "file-canopy.toml")
    press("n")
    press("ArrowRight")  # to the star in the middle
    flat.changed(lambda: press("Enter"))
    points = "studio.document.design.pins.flatMap((table) => table.points_mm)"
    assert flat.get(points)[4:] == [[0.0, 0.0]]
    flat.item("needle-at-x").focus()
    flat.item("needle-at-x").fill("3")
    flat.changed(lambda: press("Tab"))
    assert flat.get(FOCUSED) == "needle-at-y"
    assert flat.get(points)[4] == [3.0, 0.0]


def test_corners_are_typed_added_and_removed(flat: StudioPage) -> None:
    press = at_the_plan(flat, "file-plain.toml")
    press("o")
    corners = flat.get("studio.document.plan.outline_mm")
    flat.item("corner-0-x").focus()
    flat.item("corner-0-x").fill(str(round(corners[0][0] - 4, 2)))
    flat.changed(lambda: press("Tab"))
    assert flat.get(FOCUSED) == "corner-0-y"
    flat.item("corner-0-y").fill(str(round(corners[0][1] - 2, 2)))
    flat.changed(lambda: press("Tab"))
    moved = flat.get("studio.document.plan.outline_mm")[0]
    assert moved == pytest.approx([corners[0][0] - 4, corners[0][1] - 2], abs=0.01)
    flat.page.locator("#plan-canvas").focus()
    flat.changed(lambda: press("Insert"))
    assert len(flat.get("studio.document.plan.outline_mm")) == len(corners) + 1
    flat.changed(lambda: press("Delete"))
    assert len(flat.get("studio.document.plan.outline_mm")) == len(corners)


def test_the_table_of_stars_is_filled_from_field_to_field(flat: StudioPage) -> None:
    press = at_the_plan(flat, "file-even.toml")
    press("t")
    flat.item("star-0-length").focus()
    flat.item("star-0-length").fill("6")
    flat.changed(lambda: press("Tab"))
    assert flat.get(FOCUSED) == "star-0-thickness"
    flat.item("star-0-thickness").fill("0.5")
    flat.changed(lambda: press("Tab"))
    assert flat.get(FOCUSED) == "star-0-width"
    assert flat.get("studio.sizes[0]")[:2] == pytest.approx([6.0, 0.5])
    press("Escape")
    flat.wait("!document.querySelector('dialog[open]')")
    flat.page.locator("#plan-canvas").focus()
    press("Control+e")
    flat.wait("document.querySelector('dialog[open]')")
    press("Escape")
    flat.wait("!document.querySelector('dialog[open]')")
    press("Control+s")
    flat.wait("studio.document.saved")


def test_the_brush_the_gradient_and_the_ruler_work_at_the_star_of_the_keyboard(flat: StudioPage) -> None:
    press = at_the_plan(flat, "file-plain.toml")
    press("b")
    press("ArrowRight")  # to the star in the middle
    before = flat.get("studio.sizes")
    flat.changed(lambda: press("Enter"))
    assert flat.get("studio.sizes") != before and flat.get("studio.document.can_undo")
    press("r")
    press("Enter")
    press("ArrowRight")
    press("Enter")
    assert flat.get("studio.measured")["printed"] == pytest.approx(np.sqrt(3.0) * SPACING_MM)
    press("g")
    press("Enter")
    press("ArrowRight")
    flat.changed(lambda: press("Enter"))
    profile = flat.get("studio.document.design.stars.length_mm")
    assert profile["centre_mm"] == pytest.approx([np.sqrt(3.0) * SPACING_MM, 0.0], abs=0.05)
    assert profile["over_mm"] == pytest.approx(SPACING_MM, abs=0.05)


def test_a_star_is_chosen_and_made_smaller(flat: StudioPage) -> None:
    press, before = at_the_plan(flat, "file-plain.toml"), flat.get("studio.sizes")
    press("v")
    press("ArrowRight")  # to the star in the middle
    press("ArrowUp")
    press("Enter")
    assert len(flat.get("studio.selection")) == 1
    flat.changed(lambda: press("-"))
    (change,) = [(old, new) for old, new in zip(before, flat.get("studio.sizes"), strict=True) if old != new]
    assert change[1][0] < change[0][0]
    flat.changed(lambda: press("Control+z"))
    assert flat.get("studio.sizes") == before


def test_every_control_that_tab_reaches_shows_the_focus(shared: StudioPage) -> None:
    shared.open_again("file-plain.toml")
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
