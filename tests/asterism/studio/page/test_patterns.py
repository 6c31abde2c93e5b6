"""A pattern of rods on the page: drawn, computed exactly, changed and undone."""

from __future__ import annotations

from pathlib import Path

import pytest

from tests.asterism.studio.browser import StudioPage
from tests.asterism.studio.test_patterns import CROSS

# the README's tests open the page in `test_page` only
pytestmark = pytest.mark.slow


def test_a_drawing_rises_by_the_exact_model_and_lies_flat_again_after_an_edit(shared: StudioPage, folder: Path) -> None:
    (folder / "cross.toml").write_text(CROSS, encoding="utf-8")
    shared.open("file-cross.toml")
    shared.wait("studio.state.problem?.kind === 'no preview' && studio.shownRevision === studio.revision")
    assert shared.get("studio.tool") == "gradient"  # tools for stars are not offered
    assert not shared.item("tool-brush").is_visible() and shared.item("stars").inner_text() == "4 rods"
    shared.item("compute").click()
    shared.wait("studio.stage === 'exact'")
    assert shared.get("studio.height") > 1.0 and "certified" in shared.item("verdict").inner_text()
    assert shared.item("engine").inner_text() == "Exact shape"
    shared.item("tab-tool").click()
    shared.item("gradient-number").fill("0.6")
    shared.page.keyboard.press("Enter")
    shared.wait("studio.document.design.rods.thickness_mm === 0.6 && studio.stage === 'equilibrium'")
    assert shared.item("engine").inner_text() == "Shown as printed"
    shared.item("gradient-kind-linear").click()
    shared.wait("studio.document.design.rods.thickness_mm.profile === 'linear'")
    shared.item("undo").click()
    shared.item("undo").click()
    shared.wait("studio.document.design.rods.thickness_mm === 0.4")
