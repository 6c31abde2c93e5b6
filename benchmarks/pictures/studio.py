"""Pictures of the studio's page, whose states are reached as a person reaches them, in a real browser.

A state waits for what it shows, never for a time.
"""

from __future__ import annotations

import os
import tempfile
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from io import BytesIO
from pathlib import Path

from PIL import Image
from playwright.sync_api import sync_playwright

from benchmarks.report import PICTURES
from tests.asterism.studio.browser import ARGUMENTS, VIEWPORT, StudioPage, browser_path, studio_process

STROKE = ((-24.0, -8.0), (-8.0, 10.0), (6.0, 14.0), (20.0, 8.0))  # of the brush, in printed mm
VERIFY_S = 600.0
# the tutorial's sheet
WIDTH_MM, HEIGHT_MM, SPREAD, LIFT_MM, LONG_MM = 120, 100, 0.75, 30, 10
TUTORIAL_STROKE = ((-26.0, -4.0), (0.0, 4.0), (26.0, -2.0))


@contextmanager
def opened() -> Iterator[StudioPage]:
    """The first page of a studio that serves an empty folder."""
    with tempfile.TemporaryDirectory() as room, sync_playwright() as driver:
        folder = Path(room) / "canopy"
        folder.mkdir()
        os.environ["HOME"] = room  # the pictures name no folder of this machine
        browser = driver.chromium.launch(executable_path=browser_path(), args=list(ARGUMENTS))
        with studio_process(folder) as (_, url):
            page = StudioPage(browser.new_context(viewport=VIEWPORT, reduced_motion="reduce").new_page(), url)
            page.wait("document.querySelector('[data-testid=gallery-dome]')")
            page.wait("[...document.querySelectorAll('#start img')].every((image) => image.complete)")
            yield page
            complaints = page.complaints[:1]
            browser.close()
    if complaints:
        raise SystemExit(complaints[0])


def take(page: StudioPage, name: str) -> None:
    """docs/pictures/NAME.webp, which takes a tenth of the room of PNG."""
    page.get("studio.draw?.()")  # with all light and pixels, as after a while at rest
    page.get("new Promise((drawn) => requestAnimationFrame(() => requestAnimationFrame(drawn)))")
    image = Image.open(BytesIO(page.page.screenshot())).convert("RGB")
    image.save(PICTURES / f"{name}.webp", quality=78, method=6)
    print(name, flush=True)


def studio(*names: str) -> None:
    """studio-NAME-light.webp and studio-NAME-dark.webp."""
    for name in names or STATES:
        with opened() as page:
            STATES[name](page)
            for scheme in ("light", "dark"):
                page.page.emulate_media(color_scheme=scheme, reduced_motion="reduce")
                take(page, f"studio-{name}-{scheme}")


def _dome(page: StudioPage) -> None:
    page.open("gallery-dome")
    page.summarised()
    page.wait("studio.badge.kind === 'exact'")


def _brush(page: StudioPage) -> None:
    """A stroke that has not ended: the ring of the brush, painted stars, the sheet following."""
    page.open("gallery-dome")
    page.item("target").fill("5")
    page.item("target").press("Enter")
    page.page.select_option("[data-testid=plan-colour]", "length")
    page.drag(*STROKE[:2])
    page.rest()
    shown = page.get("studio.shownRevision")
    page.page.mouse.move(*page.point(STROKE[1]))
    page.page.mouse.down()
    for place in STROKE[2:]:
        page.page.mouse.move(*page.point(place), steps=4)
    page.wait(f"studio.shownRevision > {shown} && studio.stage === 'equilibrium'")


def _warning(page: StudioPage) -> None:
    page.open("gallery-tube")
    page.wait("studio.isSummarised && studio.state.warnings.length > 0")
    page.item("warnings").click()
    page.page.locator("[data-testid=warning-list] button").first.click()


STATES: dict[str, Callable[[StudioPage], None]] = {"dome": _dome, "brush": _brush, "warning": _warning}


def tutorial() -> None:
    """canopy-1-start.webp and so on, and the numbers that the tutorial names."""
    with opened() as page:
        for name in _steps(page):
            take(page, f"canopy-{name}")
            numbers = page.get("studio.state.numbers")
            known = ("stars", "height_mm", "extent_mm", "expected_rms_percent")
            print({key: numbers[key] for key in known if key in numbers}, flush=True)
        print(page.page.inner_text("[data-testid=verification]").replace("\n", " "))
        print(page.page.inner_text("[data-testid=export-result]"))


def _steps(page: StudioPage) -> Iterator[str]:
    """Each step of the tutorial; the name of the picture that shows what appears."""
    x, y = WIDTH_MM / 2, HEIGHT_MM / 2
    corners = [(-x, -y), (x, -y), (x, y), (-x, y)]

    def enter(item: str, value: object) -> None:
        page.item(item).fill(str(value))
        page.item(item).press("Enter")

    yield "1-start"
    page.item("new").click()
    page.wait("studio.opened > 0")
    enter("name", "canopy")
    page.wait("studio.document.name === 'canopy' && studio.document.saved")
    page.summarised()
    yield "2-sheet"

    page.item("tool-outline").click()
    page.item("shape-rectangle").click()
    enter("shape-width", WIDTH_MM)
    enter("shape-height", HEIGHT_MM)
    page.wait("studio.document.plan.outline_mm.length === 4")
    page.summarised()
    page.item("fit-view").click()
    yield "3-outline"

    page.item("tool-needles").click()
    for corner in corners:
        page.page.mouse.click(*page.point(corner))
        page.rest()
    enter("support-spread", SPREAD)
    page.summarised()
    page.item("fit-view").click()
    yield "4-needles"

    for corner in corners[::2]:
        page.page.mouse.click(*page.point(corner))
        enter("needle-target-z", LIFT_MM)
        page.summarised()
    page.item("fit-view").click()
    yield "5-lifted"

    page.item("tool-brush").click()
    enter("target", LONG_MM)
    page.page.select_option("[data-testid=plan-colour]", "length")
    page.drag(*TUTORIAL_STROKE)
    page.drag(*TUTORIAL_STROKE[::-1])
    page.summarised()
    yield "6-brush"

    page.item("verify").click()
    page.wait("/ [1-9]\\d %/.test(document.querySelector('[data-testid=job]').textContent)", VERIFY_S)
    yield "7-verifying"

    page.wait("studio.isBeside && document.querySelector('[data-testid=verified]')", VERIFY_S)
    page.item("shown-distance").click()
    yield "8-verified"

    page.item("save").click()
    page.wait("studio.document.saved")
    page.item("export").click()
    page.item("export-go").click()
    page.wait("document.querySelectorAll('[data-testid=export-result] a').length > 5", VERIFY_S)
    yield "9-export"
