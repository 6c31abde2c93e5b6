"""A fit to the target beside the work: progress, the design as one step, and cancelling."""

from __future__ import annotations

from pathlib import Path

import pytest

from tests.asterism.studio.browser import IS_MEASURED, StudioPage
from tests.asterism.studio.page.test_view import cap

# the README's tests open the page in `test_page` only
pytestmark = pytest.mark.slow

FIT_PATIENCE_S = 300.0


def test_a_sheet_is_fitted_to_the_target_and_painted_further(page: StudioPage, tmp_path: Path) -> None:
    page.open("gallery-dome")
    page.load_target(cap(tmp_path / "cap.stl"))
    before = page.get("studio.document.design")
    page.item("fit-go").click()
    progress = "document.querySelector('[data-testid=job]').textContent"
    page.click_when(f"/% of the diameter/.test({progress})", "cancel", FIT_PATIENCE_S)
    page.wait("document.querySelector('[data-testid=fit]').textContent.includes('Cancelled')")
    assert page.get("studio.document.design") == before

    page.item("fit-go").click()
    page.wait("document.querySelector('[data-testid=fit-numbers]')", FIT_PATIENCE_S)
    page.rest()
    page.wait(IS_MEASURED)
    assert page.get("studio.document.design.pins.length") == 1
    assert page.get("studio.targetDistance.rms_mm") < 0.01 * page.get("Math.hypot(...studio.target.size_mm)")
    numbers = page.item("fit-numbers").inner_text()
    assert "of the diameter" in numbers and "Loss by rounding" in numbers
    fitted = page.get("studio.document.design")

    # painting goes on from the fitted sheet, and two steps back is the sheet before
    page.item("tool-brush").click()
    page.changed(lambda: page.drag([0, 0], [4, 0]))
    assert page.get("studio.document.design") != fitted
    page.changed(lambda: page.item("undo").click())
    assert page.get("studio.document.design") == fitted
    page.changed(lambda: page.item("undo").click())
    assert page.get("studio.document.design") == before
