"""Pictures of the tutorial "A canopy in ten minutes": its steps, done in a real browser as the page describes them.

python -m benchmarks.studio_tutorial [FOLDER]    (default: docs/pictures)

Writes canopy-1-start.webp and so on. A step waits for what it shows, never for a time. At the end the numbers that the
tutorial names are printed.
"""

from __future__ import annotations

import os
import sys
import tempfile
from collections.abc import Iterator
from pathlib import Path

from playwright.sync_api import sync_playwright

from benchmarks.small_pictures import write_small
from benchmarks.studio_pictures import SIZES, viewport
from tests.asterism.studio.browser import ARGUMENTS, StudioPage, browser_path, running_studio

DOCS = Path(__file__).parents[1] / "docs" / "pictures"
WIDTH_MM, HEIGHT_MM = 120, 100
SPREAD = 0.75
LIFT_MM = 30
LONG_MM = 10
# the stroke over the middle of the sheet, in printed mm
STROKE = ((-26.0, -4.0), (0.0, 4.0), (26.0, -2.0))
# the exact model has done a part of its work
AT_WORK = "(text) => text.includes('exact model') && parseInt(text) >= 10"
VERIFY_S = 600.0


def steps(page: StudioPage) -> Iterator[str]:
    """Each step of the tutorial; the name of the picture that shows what appears."""
    page.wait("document.querySelector('[data-testid=new]')")
    page.wait("[...document.querySelectorAll('#start img')].every((image) => image.complete)")
    yield "1-start"

    page.item("new").click()
    page.wait("studio.opened > 0")
    page.item("name").fill("canopy")
    page.item("name").press("Enter")
    page.wait("studio.document.name === 'canopy' && studio.document.saved")
    page.summarised()
    yield "2-sheet"

    page.item("tool-outline").click()
    page.item("shape-rectangle").click()
    page.item("shape-width").fill(str(WIDTH_MM))
    page.item("shape-width").press("Enter")
    page.item("shape-height").fill(str(HEIGHT_MM))
    page.item("shape-height").press("Enter")
    page.item("use-shape").click()
    page.wait("studio.document.plan.outline_mm.length === 4")
    page.summarised()
    page.item("fit-view").click()
    yield "3-outline"

    page.item("tool-needles").click()
    for corner in corners():
        page.page.mouse.click(*page.point(corner))
        page.rest()
    page.item("support-spread").fill(str(SPREAD))
    page.item("support-spread").press("Enter")
    page.summarised()
    page.item("fit-view").click()
    yield "4-needles"

    for corner in corners()[::2]:
        page.page.mouse.click(*page.point(corner))
        page.item("needle-target-z").fill(str(LIFT_MM))
        page.item("needle-target-z").press("Enter")
        page.summarised()
    page.item("fit-view").click()
    yield "5-lifted"

    page.item("tool-brush").click()
    page.item("target").fill(str(LONG_MM))
    page.item("target").press("Enter")
    page.page.select_option("[data-testid=plan-colour]", "length")
    page.drag(*STROKE)
    page.drag(*STROKE[::-1])
    page.summarised()
    yield "6-brush"

    page.item("verify").click()
    page.wait(f"(({AT_WORK})(document.querySelector('[data-testid=verify-progress]').textContent))", VERIFY_S)
    yield "7-verifying"

    page.wait("studio.comparison && document.querySelector('[data-testid=verified]')", VERIFY_S)
    yield "8-verified"

    page.item("save").click()
    page.wait("studio.document.saved")
    page.item("export").click()
    page.item("export-go").click()
    page.wait("document.querySelectorAll('[data-testid=export-result] a').length > 5", VERIFY_S)
    yield "9-export"


def corners() -> list[tuple[float, float]]:
    """The corners of the rectangle, counterclockwise from the lower left, in printed mm."""
    x, y = WIDTH_MM / 2, HEIGHT_MM / 2
    return [(-x, -y), (x, -y), (x, y), (-x, y)]


def main(folder: Path) -> None:
    folder.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory() as designs, sync_playwright() as driver:
        browser = driver.chromium.launch(executable_path=browser_path(), args=list(ARGUMENTS))
        context = browser.new_context(viewport=viewport(SIZES[0]), color_scheme="light", reduced_motion="reduce")
        made = Path(designs) / "canopy"
        made.mkdir()
        os.environ["HOME"] = designs  # the pictures name no folder of this machine
        with running_studio(made) as url:
            page = StudioPage(context.new_page(), url)
            for name in steps(page):
                page.get("new Promise((drawn) => requestAnimationFrame(() => requestAnimationFrame(drawn)))")
                write_small(page.page.screenshot(), folder / f"canopy-{name}.webp")
                numbers = page.get("studio.state.numbers")
                known = ("stars", "height_mm", "extent_mm", "expected_rms_percent")
                print(name, {key: numbers[key] for key in known if key in numbers}, flush=True)
            print(page.page.inner_text("[data-testid=verification]").replace("\n", " "))
            print(page.page.inner_text("[data-testid=export-result]"))
        if page.complaints:
            raise SystemExit(page.complaints[0])
        browser.close()


if __name__ == "__main__":
    main(Path(sys.argv[1]) if len(sys.argv) > 1 else DOCS)
