"""The studio's page in a real browser: every test waits for a state of the page, none for a time."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import pytest

import asterism
from tests.asterism.studio.browser import StudioPage


def saved_height(page: StudioPage) -> float:
    """Height (mm) of the exact shape that the preview of the saved file leads to; the page shows it too."""
    page.item("save").click()
    page.wait("studio.document.saved")
    design = asterism.load_design(Path(page.get("studio.document.path")).expanduser())
    page.wait("studio.badge.kind === 'exact'")
    return float(asterism.simulate(design, near=asterism.preview(design)).height_mm)


@pytest.mark.slow
def test_painting_changes_the_shape_as_the_saved_file_and_undo_brings_the_sizes_back(page: StudioPage) -> None:
    page.open("gallery-dome")
    page.summarised()
    sizes, height = page.get("studio.sizes"), page.get("studio.height")
    page.item("target").fill("5")
    page.item("target").press("Enter")
    page.drag((-20, 0), (0, 5), (20, 0))
    page.summarised()
    assert page.get("studio.sizes") != sizes
    assert abs(page.get("studio.height") - height) > 0.1
    height = saved_height(page)
    assert page.get("studio.height") == pytest.approx(height, rel=1e-4)

    page.item("undo").click()
    page.wait("studio.document.can_redo")
    page.rest()
    assert page.get("studio.sizes") == sizes


@pytest.mark.slow
def test_a_verification_is_cancelled_or_says_the_distance_and_whether_the_design_has_changed(page: StudioPage) -> None:
    page.open("gallery-star")
    page.wait("studio.badge.kind === 'exact'")
    height = page.get("studio.height")
    page.item("verify").click()
    page.click_when("document.querySelector('[data-testid=cancel]')", "cancel")
    page.wait("document.querySelector('[data-testid=verify-panel]')")
    assert page.get("studio.height") == height and page.get("studio.badge.kind") == "exact"
    page.item("verify-panel").click()
    page.wait("studio.isBeside && document.querySelector('[data-testid=verified]')")
    is_old = "document.querySelector('[data-testid=verification]').textContent.includes('has changed since')"
    page.item("save").click()
    page.wait("studio.document.saved")
    assert not page.get(is_old)
    page.drag((0, 0), (4, 4))
    page.wait(is_old)
    page.item("undo").click()
    page.wait(f"!{is_old}")


@pytest.mark.slow
def test_the_export_of_a_settled_sheet_is_of_the_exact_shape_and_can_be_downloaded(page: StudioPage) -> None:
    page.open("gallery-star")
    page.wait("studio.badge.kind === 'exact'")
    words = page.get("studio.badge.words")
    page.item("export").click()
    page.item("export-go").click()
    page.wait("document.querySelectorAll('[data-testid=export-result] a').length > 5")
    assert f"The shape: {words}" in page.item("export-result").inner_text()
    link = page.page.locator("[data-testid=export-result] a", has_text="print.3mf")
    with page.page.expect_download() as download:
        link.click()
    assert Path(download.value.path()).stat().st_size > 1000


@pytest.mark.slow
def test_reload_and_a_second_tab_show_the_same_state(new_page: Callable[[], StudioPage]) -> None:
    first = new_page()
    first.open_again("file-even.toml")
    first.changed(lambda: first.drag((0, 0), (10, 10)))
    second = new_page()
    second.rest()
    assert second.get("studio.sizes") == first.get("studio.sizes")
    second.changed(lambda: second.item("undo").click())
    first.wait("studio.document.can_redo")
    assert first.get("studio.sizes") == second.get("studio.sizes")
    first.page.reload()
    first.wait("window.studio && studio.connected")
    first.rest()
    assert first.get("studio.sizes") == second.get("studio.sizes")


@pytest.mark.slow
def test_stars_are_changed_by_keyboard_alone(page: StudioPage) -> None:
    page.open("gallery-dome")
    before = page.get("studio.sizes")
    page.page.locator("#plan-canvas").focus()
    press = page.page.keyboard.press
    press("v")
    press("ArrowRight")  # to the star in the middle
    press("ArrowUp")
    press("Enter")
    assert len(page.get("studio.selection")) == 1
    press("-")
    page.rest()
    after = page.get("studio.sizes")
    changed = [star for star, (old, new) in enumerate(zip(before, after, strict=True)) if old != new]
    assert len(changed) == 1
    assert after[changed[0]][0] < before[changed[0]][0]
    press("Control+z")
    page.wait("studio.document.can_redo")
    page.rest()
    assert page.get("studio.sizes") == before
