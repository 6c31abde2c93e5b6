"""Weights of places in a fit on the page: painted, erased, undone, saved, drawn in both colour schemes, and fitted."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from tests.asterism.studio.browser import StudioPage
from tests.asterism.studio.page.test_fit import FIT_PATIENCE_S
from tests.asterism.studio.page.test_view import cap

pytestmark = pytest.mark.slow

# share of the plan's pixels within a few steps of a colour of the style
SHARE = """(name) => {
    const canvas = document.getElementById("plan-canvas");
    const { data } = canvas.getContext("2d").getImageData(0, 0, canvas.width, canvas.height);
    const style = getComputedStyle(document.documentElement);
    const hex = (name) => style.getPropertyValue(`--${name}`).trim();
    const part = (name) => [1, 3, 5].map((at) => parseInt(hex(name).slice(at, at + 2), 16));
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


def test_a_stroke_is_drawn_undone_erased_and_saved(shared: StudioPage, folder: Path) -> None:
    shared.open("gallery-dome")
    sizes = shared.get("studio.sizes")
    shared.page.locator("#plan-canvas").focus()
    paint(shared, 20, (0.0, 0.0), (5.0, 0.0))
    weights = shared.get("studio.weights")
    assert max(weights) > 15 and min(weights) == 1 and shared.get("studio.sizes") == sizes
    for theme in ("light", "dark"):
        if shared.get("getComputedStyle(document.documentElement).colorScheme.trim()") != theme:
            shared.item("theme").click()
        shared.page.mouse.move(5, 5)
        shared.page.evaluate("new Promise((resolve) => requestAnimationFrame(() => requestAnimationFrame(resolve)))")
        assert shared.page.evaluate(SHARE, "weight") > 0.002
    shared.item("theme").click()

    shared.changed(lambda: shared.item("undo").click())
    assert set(shared.get("studio.weights")) == {1}
    shared.changed(lambda: shared.item("redo").click())
    assert shared.get("studio.weights") == weights

    shared.item("save").click()
    shared.wait("studio.document.saved")
    name = Path(shared.get("studio.document.path")).name
    shared.open("gallery-star")
    shared.open(f"file-{name}")
    assert shared.get("studio.weights") == weights

    shared.item("weight-mode-erase").click()
    shared.changed(lambda: shared.drag((0.0, 0.0), (5.0, 0.0)))
    left = shared.get("studio.weights")
    assert left.count(1) > weights.count(1)
    if not shared.item("weight-clear").is_disabled():
        shared.changed(lambda: shared.item("weight-clear").click())
    assert set(shared.get("studio.weights")) == {1}
    assert "fit" not in shared.get("studio.document.design")


def test_a_weight_is_set_and_changed_at_the_star_of_the_keyboard(shared: StudioPage) -> None:
    shared.open("gallery-dome")
    sizes = shared.get("studio.sizes")
    press = shared.page.keyboard.press
    shared.page.locator("#plan-canvas").focus()
    press("w")
    shared.item("weight-mode-paint").click()
    shared.page.locator("#plan-canvas").focus()
    press("ArrowRight")  # to the star in the middle
    shared.changed(lambda: press("+"))
    assert max(shared.get("studio.weights")) == pytest.approx(1.5)
    shared.changed(lambda: press("-"))
    assert set(shared.get("studio.weights")) == {1}
    shared.changed(lambda: press("Enter"))
    assert max(shared.get("studio.weights")) > 1 and shared.get("studio.sizes") == sizes


def test_the_next_fit_has_the_weights_that_were_painted_on_the_sheet(page: StudioPage, tmp_path: Path) -> None:
    page.open("gallery-dome")
    page.load_target(cap(tmp_path / "cap.stl"))
    page.item("fit-go").click()
    page.wait("document.querySelector('[data-testid=fit-numbers]')", FIT_PATIENCE_S)
    page.rest()
    sites = page.get("studio.document.plan.sites")
    page.item("fit-weights").click()
    page.page.locator("#plan-canvas").focus()
    paint(page, 16, (20.0, 0.0), (21.0, 0.0))
    painted = np.array(page.get("studio.weights"))
    page.item("weight-fit").click()
    revision = page.get("studio.revision")
    page.item("fit-go").click()
    page.wait(f"studio.revision > {revision} && document.querySelector('[data-testid=fit-numbers]')", FIT_PATIENCE_S)
    page.rest()
    # the same outline and lattice, and the weights at the same stars
    assert [site["site"] for site in page.get("studio.document.plan.sites")] == [site["site"] for site in sites]
    kept = np.array(page.get("studio.weights"))
    assert np.corrcoef(np.log(kept), np.log(painted))[0, 1] > 0.95
    assert kept.max() == pytest.approx(painted.max(), rel=0.1)
