"""A fit to the target beside the work, and weights of places in it: painted, erased, undone, saved and drawn."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from tests.asterism.studio.browser import IS_MEASURED, StudioPage
from tests.asterism.studio.page.test_view import cap

# share of the plan's pixels within a few steps of a colour of the style
SHARE = """(name) => {
    const canvas = document.getElementById("plan-canvas");
    const { data } = canvas.getContext("2d").getImageData(0, 0, canvas.width, canvas.height);
    const style = getComputedStyle(document.documentElement);
    const part = (name) => style.getPropertyValue(`--${name}`).match(/\\d+/g).map(Number);
    const [paper, weight] = [part("paper"), part("weight")];
    const wanted = paper.map((value, k) => value + 0.55 * (weight[k] - value));
    let count = 0;
    for (let at = 0; at < data.length; at += 4) count += wanted.every((value, k) => Math.abs(data[at + k] - value) < 6);
    return count / (data.length / 4);
}"""


def paint(page: StudioPage, weight: float, *places: tuple[float, float]) -> None:
    page.page.keyboard.press("w")
    page.fill("weight", weight)
    page.fill("weight-radius", 14)
    page.fill("weight-strength", 100)
    page.changed(lambda: page.drag(*places))


def test_a_stroke_is_drawn_undone_erased_and_saved(flat: StudioPage, folder: Path) -> None:
    (folder / "weighed.toml").write_text((folder / "plain.toml").read_text("utf-8"), "utf-8")
    flat.open("file-weighed.toml")
    sizes = flat.get("studio.sizes")
    flat.page.locator("#plan-canvas").focus()
    paint(flat, 20, (0.0, 0.0), (5.0, 0.0))
    weights = flat.get("studio.weights")
    assert max(weights) > 15 and min(weights) == 1 and flat.get("studio.sizes") == sizes
    for theme in ("light", "dark"):
        if flat.get("getComputedStyle(document.documentElement).colorScheme.trim()") != theme:
            flat.item("theme").click()
        flat.page.mouse.move(5, 5)
        flat.page.evaluate("new Promise((resolve) => requestAnimationFrame(() => requestAnimationFrame(resolve)))")
        assert flat.page.evaluate(SHARE, "weight") > 0.002
    flat.item("theme").click()

    flat.changed(lambda: flat.item("undo").click())
    assert set(flat.get("studio.weights")) == {1}
    flat.changed(lambda: flat.item("redo").click())
    assert flat.get("studio.weights") == weights

    flat.save()
    flat.open("file-even.toml")
    flat.open("file-weighed.toml")
    assert flat.get("studio.weights") == weights

    flat.item("weight-mode-erase").click()
    flat.changed(lambda: flat.drag((0.0, 0.0), (5.0, 0.0)))
    left = flat.get("studio.weights")
    assert left.count(1) > weights.count(1)
    if not flat.item("weight-clear").is_disabled():
        flat.changed(lambda: flat.item("weight-clear").click())
    assert set(flat.get("studio.weights")) == {1}
    assert "fit" not in flat.get("studio.document.design")


def test_a_weight_is_set_and_changed_at_the_star_of_the_keyboard(flat: StudioPage) -> None:
    flat.open_again("file-plain.toml")
    sizes = flat.get("studio.sizes")
    press = flat.page.keyboard.press
    flat.page.locator("#plan-canvas").focus()
    press("w")
    flat.item("weight-mode-paint").click()
    flat.page.locator("#plan-canvas").focus()
    press("ArrowRight")  # to the star in the middle
    flat.changed(lambda: press("+"))
    assert max(flat.get("studio.weights")) == pytest.approx(1.5)
    flat.changed(lambda: press("-"))
    assert set(flat.get("studio.weights")) == {1}
    flat.changed(lambda: press("Enter"))
    assert max(flat.get("studio.weights")) > 1 and flat.get("studio.sizes") == sizes


def test_a_sheet_is_fitted_to_the_target_and_again_with_weights(flat: StudioPage, tmp_path: Path) -> None:
    page = flat
    page.open_again("file-plain.toml")
    page.load_target(cap(tmp_path / "cap.stl", 30.0))
    before = page.get("studio.document.design")
    page.item("fit-go").click()
    page.wait("document.querySelector('[data-testid=fit]').textContent.includes('Under way')")
    progress = "document.querySelector('[data-testid=job]').textContent"
    page.click_when(f"/% of the diameter/.test({progress})", "cancel")
    page.wait("document.querySelector('[data-testid=fit]').textContent.includes('Cancelled')")
    assert page.get("studio.document.design") == before

    page.item("fit-go").click()
    page.wait("document.querySelector('[data-testid=fit-numbers]')")
    page.rest()
    page.wait(IS_MEASURED)
    assert page.get("studio.document.design.pins.length") == 1
    assert page.get("studio.targetDistance.rms_mm") < 0.01 * page.get("Math.hypot(...studio.target.size_mm)")
    numbers = page.item("fit-numbers").inner_text()
    assert "of the diameter" in numbers and "Added by printable layers and lines" in numbers
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
    page.wait(f"studio.revision > {revision} && document.querySelector('[data-testid=fit-numbers]')")
    page.rest()
    assert [site["site"] for site in page.get("studio.document.plan.sites")] == [site["site"] for site in sites]
    kept = np.array(page.get("studio.weights"))
    assert np.corrcoef(np.log(kept), np.log(painted))[0, 1] > 0.95
    assert kept.max() == pytest.approx(painted.max(), rel=0.1)

    # each fit and each stroke is one step
    for design in (weighed, fitted, before):
        page.changed(lambda: page.item("undo").click())
        assert page.get("studio.document.design") == design
