"""Shapes on the page: other sides and forms, kept and other designs, pictures, the report."""

from __future__ import annotations

import re
from pathlib import Path

import pytest
from PIL import Image, ImageChops

from asterism.pattern import gallery
from tests.asterism.studio.browser import PATIENCE_S, StudioPage
from tests.asterism.studio.page.conftest import FINE


def open_shape(page: StudioPage, name: str) -> float:
    """Open a design, wait for its summary, and show it; its height (mm)."""
    page.open_again(name)
    page.summarised()
    page.item("tab-shape").click()
    return float(page.get("studio.height"))


def test_a_flip_says_at_once_that_it_searches_and_escape_ends_it(flat: StudioPage) -> None:
    height = open_shape(flat, "file-plain.toml")
    said = flat.get(
        """(() => {
            const part = (name) => document.querySelector(`[data-testid=${name}]`);
            part("flip").focus();
            part("flip").click();
            const hasFocus = document.activeElement === part("stop-search");
            const said = [part("flip").disabled, part("engine").textContent, hasFocus];
            // at once: on a fast machine the search is over before a key of the test comes
            document.activeElement.dispatchEvent(new KeyboardEvent("keydown", { key: "Escape", bubbles: true }));
            return said;
        })()"""
    )
    assert said[0] and "Searching for the other side, Esc cancels" in said[1] and said[2]
    flat.page.locator(".toast", has_text="search was cancelled").wait_for()
    flat.summarised()
    assert flat.item("flip").is_enabled() and not flat.item("stop-search").is_visible()
    assert flat.get("document.activeElement.dataset.testid") == "flip"
    assert flat.get("studio.height") == pytest.approx(height, abs=1e-9)
    assert not flat.get("studio.state.problem")


def test_another_form_is_listed_and_shown(shared: StudioPage, folder: Path) -> None:
    text = gallery.path("fig8-l-increasing").read_text("utf-8")
    (folder / "two-forms.toml").write_text(text + FINE, "utf-8")
    height = open_shape(shared, "file-two-forms.toml")
    forms = shared.get("studio.state.forms")
    assert [form["is_shown"] for form in forms] == [True, False]
    assert "energy +" in shared.item(f"form-{forms[1]['index']}").inner_text()
    shared.wait(f"document.querySelector('[data-testid=form-{forms[1]['index']}] img')?.naturalWidth > 0")
    shared.item(f"beside-form-{forms[1]['index']}").click()
    # side by side with one camera: a drag over one of them turns both
    shared.wait("studio.isTwo && document.querySelector('[data-testid=beside]').clientWidth > 100")
    assert "Another form, energy +" in shared.item("beside-name").inner_text()
    turn, drawn = shared.get("[studio.camera.turn, studio.drawn]")
    box = shared.item("beside").bounding_box()
    x, y = box["x"] + box["width"] / 2, box["y"] + box["height"] / 2
    shared.press((x, y), (x + 60, y))
    shared.page.mouse.up()
    shared.wait(f"studio.camera.turn !== {turn} && studio.drawn > {drawn}")
    shared.item("beside-close").click()
    shared.wait("!studio.isTwo")
    shared.item(f"form-{forms[1]['index']}").click()
    # the form that was shown is the other one
    shared.wait(f"Math.abs(studio.height - {height}) > 1 && studio.state.forms[1]?.energy_percent < 0")
    assert forms[1]["energy_percent"] > 0
    shared.item(f"form-{shared.get('studio.state.forms')[1]['index']}").click()
    shared.wait(f"studio.isSummarised && Math.abs(studio.height - {height}) < 0.1")


def test_designs_are_kept_as_pictures_and_compared(shared: StudioPage) -> None:
    height = open_shape(shared, "file-plain.toml")
    shared.item("keep-A").click()
    shared.wait("document.querySelector('[data-testid=show-A] img')?.naturalWidth > 0")
    shared.item("tool-gradient").click()
    shared.item("gradient-kind-number").click()
    shared.changed(lambda: shared.fill("gradient-number", 5))
    shared.summarised()
    shared.item("tab-shape").click()
    change = height - shared.get("studio.height")
    shared.wait(f"document.querySelector('[data-testid=show-A]').textContent.includes('(+{change:.1f} mm)')")
    shared.item("keep-B").click()
    shared.wait("document.querySelector('[data-testid=show-B] img')?.naturalWidth > 0")
    shared.item("show-A").click()
    shared.wait(f"studio.isSummarised && Math.abs(studio.height - {height}) < 1e-6")
    assert shared.get("studio.document.design.stars.length_mm.profile") == "radial"
    shared.item("history").click()
    shared.page.get_by_text("Star length").first.wait_for()
    words = shared.page.locator(".thumbnail").all_inner_texts()
    assert words[0] == "Design A" and words[-1] == "Opened"
    assert words[1].startswith("Star length") and words[1].endswith("→ 5 mm, 37 stars")
    shared.page.keyboard.press("Escape")
    # a design that was open is a picture away
    shared.open("file-even.toml")
    shared.item("tab-shape").click()
    shared.wait("document.querySelector('[data-testid=\"design-plain.toml\"] img')?.naturalWidth > 0")
    shared.item("design-plain.toml").click()
    shared.wait("studio.document.name === 'plain'")
    shared.item("design-even.toml").wait_for()


def test_a_picture_is_saved_at_a_chosen_size(shared: StudioPage) -> None:
    shared.open_again("file-plain.toml")

    def saved() -> Image.Image:
        with shared.page.expect_download() as download:
            shared.item("picture-go").click()
        return Image.open(Path(download.value.path())).convert("RGB")

    shared.item("tool-select").click()
    shared.page.get_by_role("button", name="All", exact=True).click()
    chosen = shared.get("studio.selection.length")
    shared.item("picture").click()
    shared.item("picture-size").select_option("1920 × 1080")
    red, _, blue = (large := saved()).split()
    assert "Saved as plain.png" in shared.item("toast").last.inner_text()
    assert large.size == (1920, 1080)
    # what is selected is blue on the page only, and stays selected
    assert ImageChops.subtract(blue, red).getextrema()[1] < 40
    assert chosen > 0 and shared.get("studio.selection.length") == chosen
    shared.item("picture").click()
    shared.fill("picture-width", 700)
    shared.fill("picture-height", 420)
    assert shared.item("picture-size").input_value() == "Own size"
    picture = saved()
    darkest, lightest = picture.convert("L").getextrema()
    assert picture.size == (700, 420) and darkest < 60 and lightest == 255  # plastic, and the white ground
    # the colours of the page are not those of a picture
    shared.page.emulate_media(color_scheme="dark")
    shared.item("picture").click()
    shared.fill("picture-width", 700)
    shared.fill("picture-height", 420)
    dark = saved()
    shared.page.emulate_media(color_scheme="light")
    assert ImageChops.difference(picture, dark).convert("L").getextrema()[1] < 40


def test_the_exact_shape_has_a_moving_picture_a_report_and_a_range_of_prints(shared: StudioPage, folder: Path) -> None:
    shared.open("gallery-star")
    shared.wait("studio.badge.kind === 'exact'")
    name = shared.get("studio.document.name")
    shared.item("picture").click()
    shared.item("animate").click()
    shared.page.locator(".toast", has_text="animated picture is written").wait_for(timeout=1000 * PATIENCE_S)
    picture = Image.open(folder / f"{name}-release.gif")
    assert picture.size == (1200, 900) and picture.n_frames == 24  # type: ignore[attr-defined]

    shared.item("report").click()
    shared.wait("document.querySelector('[data-testid=job]').textContent.includes('report')")
    shared.page.locator(".toast", has_text="report is written").wait_for(timeout=1000 * PATIENCE_S)
    assert (folder / f"{name}.pdf").read_bytes().startswith(b"%PDF")

    shared.item("tab-shape").click()
    shared.item("spread-go").click()
    shared.wait("document.querySelector('[data-testid=spread-found]')")
    words = shared.item("spread-found").inner_text()
    low, high = map(float, re.findall(r"([\d.]+) to ([\d.]+) in nine of ten prints", words)[0])
    assert low < shared.get("studio.height") < high and "Range comes from" in words
    assert Image.open(folder / f"{name}-spread.png").size == (1500, 630)
    shared.item("tool-brush").click()
    shared.changed(lambda: shared.drag((0, 0), (3, 3)))
    shared.item("tab-shape").click()
    shared.wait("document.querySelector('[data-testid=spread]')?.textContent.includes('has changed since')")
