"""The studio's page in a real browser: every test waits for a state of the page, none for a time."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import pytest

import asterism
from tests.asterism.studio.browser import StudioPage
from tests.asterism.studio.page.conftest import SEVEN


def test_painting_changes_the_shape_as_the_saved_file_and_undo_brings_the_sizes_back(
    flat: StudioPage, folder: Path
) -> None:
    (folder / "painted.toml").write_text(SEVEN, encoding="utf-8")
    flat.open("file-painted.toml")
    flat.summarised()
    sizes, height = flat.get("studio.sizes"), flat.get("studio.height")
    flat.fill("target", 5)
    flat.drag((-20, 0), (0, 5), (20, 0))
    flat.summarised()
    assert flat.get("studio.sizes") != sizes
    assert abs(flat.get("studio.height") - height) > 0.1
    flat.item("save").click()
    flat.wait("studio.document.saved && studio.badge.kind === 'exact'")
    # the exact shape that the preview of the saved file leads to
    design = asterism.load_design(folder / "painted.toml")
    exact = asterism.simulate(design, near=asterism.preview(design))
    assert flat.get("studio.height") == pytest.approx(exact.height_mm, rel=1e-4)

    flat.item("undo").click()
    flat.wait("studio.document.can_redo")
    flat.rest()
    assert flat.get("studio.sizes") == sizes


def test_a_verification_is_cancelled_or_says_the_distance_and_if_the_design_has_changed(shared: StudioPage) -> None:
    shared.open("gallery-star")
    shared.wait("studio.badge.kind === 'exact'")
    height = shared.get("studio.height")
    shared.item("verify").click()
    shared.click_when("document.querySelector('[data-testid=cancel]')", "cancel")
    shared.wait("document.querySelector('[data-testid=verify-panel]')")
    assert shared.get("studio.height") == height and shared.get("studio.badge.kind") == "exact"
    shared.item("verify-panel").click()
    shared.wait("studio.isBeside && document.querySelector('[data-testid=verified]')")
    is_old = "document.querySelector('[data-testid=verification]').textContent.includes('has changed since')"
    shared.save()
    assert not shared.get(is_old)
    shared.drag((0, 0), (4, 4))
    shared.wait(is_old)
    shared.item("undo").click()
    shared.wait(f"!{is_old}")


def test_the_export_of_a_settled_sheet_is_of_the_exact_shape_and_can_be_downloaded(flat: StudioPage) -> None:
    flat.open("gallery-star")
    flat.wait("studio.badge.kind === 'exact'")
    words = flat.get("studio.badge.words")
    flat.item("export").click()
    assert "TPU 95A" in flat.item("export-dialog").inner_text()
    flat.item("export-preview").set_checked(True)
    flat.item("export-go").click()
    flat.wait("document.querySelectorAll('[data-testid=export-result] a').length > 5")
    assert f"The shape: {words}" in flat.item("export-result").inner_text()
    link = flat.page.locator("[data-testid=export-result] a", has_text="print.3mf")
    with flat.page.expect_download() as download:
        link.click()
    assert Path(download.value.path()).stat().st_size > 1000


def test_reload_and_a_second_tab_show_the_same_state(new_flat: Callable[[], StudioPage]) -> None:
    first = new_flat()
    first.open_again("file-even.toml")
    first.changed(lambda: first.drag((0, 0), (10, 10)))
    second = new_flat()
    second.rest()
    assert second.get("studio.sizes") == first.get("studio.sizes")
    second.changed(lambda: second.item("undo").click())
    first.wait("studio.document.can_redo")
    assert first.get("studio.sizes") == second.get("studio.sizes")
    first.page.reload()
    first.wait("window.studio && studio.connected")
    first.rest()
    assert first.get("studio.sizes") == second.get("studio.sizes")


def test_a_browser_that_cannot_draw_in_space_says_so(flat: StudioPage) -> None:
    flat.open("file-even.toml")
    flat.summarised()
    assert "does not draw in space" in flat.item("no-view").inner_text() and not flat.item("view-colour").count()
