"""A fit to the target beside the work: progress, the design as one step, cancelling, and weights."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from tests.asterism.studio.browser import IS_MEASURED, StudioPage
from tests.asterism.studio.page.test_view import cap
from tests.asterism.studio.page.test_weights import paint

# the README's tests open the page in `test_page` only
pytestmark = pytest.mark.slow

FIT_PATIENCE_S = 300.0


def test_a_sheet_is_fitted_to_the_target_and_again_with_weights(page: StudioPage, tmp_path: Path) -> None:
    page.open("file-plain.toml")
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

    # the next fit has the weights that are painted on this sheet, at the same stars
    sites = page.get("studio.document.plan.sites")
    page.item("fit-weights").click()
    page.page.locator("#plan-canvas").focus()
    paint(page, 16, (20.0, 0.0), (21.0, 0.0))
    weighed, painted = page.get("studio.document.design"), np.array(page.get("studio.weights"))
    page.item("weight-fit").click()
    revision = page.get("studio.revision")
    page.item("fit-go").click()
    page.wait(f"studio.revision > {revision} && document.querySelector('[data-testid=fit-numbers]')", FIT_PATIENCE_S)
    page.rest()
    assert [site["site"] for site in page.get("studio.document.plan.sites")] == [site["site"] for site in sites]
    kept = np.array(page.get("studio.weights"))
    assert np.corrcoef(np.log(kept), np.log(painted))[0, 1] > 0.95
    assert kept.max() == pytest.approx(painted.max(), rel=0.1)

    # each fit and each stroke is one step
    for design in (weighed, fitted, before):
        page.changed(lambda: page.item("undo").click())
        assert page.get("studio.document.design") == design
