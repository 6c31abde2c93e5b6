"""Pictures of the studio's page in eleven states, small and large, light and dark.

python -m benchmarks.studio_pictures FOLDER [STATE ...]    (with states: these only)

Each state is reached as a person reaches it, in a real browser, and is taken four times: NAME-1280-light.png,
NAME-1280-dark.png, NAME-1920-light.png, NAME-1920-dark.png. A state waits for what it shows, never for a time.
"""

from __future__ import annotations

import os
import sys
import tempfile
from collections.abc import Callable
from pathlib import Path

from playwright.sync_api import sync_playwright

from tests.asterism.studio.browser import ARGUMENTS, StudioPage, browser_path, running_studio

SIZES = ((1280, 720), (1920, 1080))
SCHEMES = ("light", "dark")
CANOPY = """
name = "canopy"
[stars]
length_mm = {profile = "radial", from = 9.0, to = 6.0, over_mm = 50.0}
[border]
rings = 2
[[pins]]
points_mm = [[43.0, 24.8], [-43.0, 24.8], [-43.0, -24.8], [43.0, -24.8]]
scale = 0.7
"""
# brush strokes, in printed mm; the last one is shown before it ends
STROKE = ((-24.0, -8.0), (-8.0, 10.0), (6.0, 14.0), (20.0, 8.0))
# a corner of the dome is drawn inwards
CORNER_MM = (-8.0, -4.0)

Take = Callable[[], None]
State = Callable[[StudioPage, Take], None]


def start(page: StudioPage, take: Take) -> None:
    page.wait("document.querySelector('[data-testid=gallery-dome]')")
    page.wait("[...document.querySelectorAll('#start img')].every((image) => image.complete)")
    take()


def dome(page: StudioPage, take: Take) -> None:
    page.open("gallery-dome")
    page.summarised()
    take()


def brush(page: StudioPage, take: Take) -> None:
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
    take()
    page.page.mouse.up()
    page.rest()


def selection(page: StudioPage, take: Take) -> None:
    page.open("gallery-dome")
    page.item("tool-select").click()
    page.page.mouse.dblclick(*page.point(page.get("studio.document.plan.sites").pop()["at_mm"]))
    page.wait("studio.selection.length > 6")
    page.summarised()
    take()


def needles(page: StudioPage, take: Take) -> None:
    page.open("file-canopy.toml")
    page.item("tool-needles").click()
    page.page.mouse.click(*page.point((43.0, 24.8)))
    page.item("needle-target-z").fill("14")
    page.item("needle-target-z").press("Enter")
    page.wait("studio.document.design.pins[0].target_mm?.[0][2] === 14")
    page.summarised()
    take()
    page.item("undo").click()
    page.wait("studio.document.can_redo")


def outline(page: StudioPage, take: Take) -> None:
    page.open("gallery-dome")
    page.item("tool-outline").click()
    corner = page.get("studio.document.plan.outline_mm")[0]
    page.drag(corner, (corner[0] + CORNER_MM[0], corner[1] + CORNER_MM[1]))
    page.summarised()
    take()


def weights(page: StudioPage, take: Take) -> None:
    """Weights of places in a fit, painted by one stroke."""
    page.open("gallery-dome")
    page.item("tool-weight").click()
    page.fill("weight", 12)
    page.drag(*STROKE)
    page.summarised()
    take()


def warning(page: StudioPage, take: Take) -> None:
    page.open("gallery-tube")
    page.wait("studio.isSummarised && studio.state.warnings.length > 0")
    page.item("warnings").click()
    page.page.locator("[data-testid=warning-list] button").first.click()
    take()


def verifying(page: StudioPage, take: Take) -> None:
    page.open("gallery-dome")
    page.summarised()
    page.item("verify").click()
    page.wait("/^[2-9]\\d %/.test(document.querySelector('[data-testid=verify-progress]').textContent)")
    take()
    page.item("cancel").click()
    page.wait("document.querySelector('[data-testid=verify-panel]')")


def verified(page: StudioPage, take: Take) -> None:
    page.open("gallery-dome")
    page.summarised()
    page.item("verify").click()
    page.wait("studio.comparison && document.querySelector('[data-testid=verified]')", 600)
    take()


def export(page: StudioPage, take: Take) -> None:
    page.open("gallery-dome")
    page.item("export").click()
    page.item("export-go").click()
    page.wait("document.querySelectorAll('[data-testid=export-result] a').length > 5")
    take()
    page.page.keyboard.press("Escape")


STATES: dict[str, State] = {
    state.__name__: state
    for state in (start, dome, brush, selection, needles, outline, weights, warning, verifying, verified, export)
}


def main(folder: Path, names: list[str]) -> None:
    if unknown := [name for name in names if name not in STATES]:
        raise SystemExit(f"no state {unknown[0]}; there are {', '.join(STATES)}")
    folder.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory() as designs, sync_playwright() as driver:
        (Path(designs) / "canopy.toml").write_text(CANOPY, encoding="utf-8")
        browser = driver.chromium.launch(executable_path=browser_path(), args=list(ARGUMENTS))
        os.environ["HOME"] = designs  # the pictures name no folder of this machine
        with running_studio(Path(designs)) as url:
            for name in (name for name in STATES if name in names or not names):
                context = browser.new_context(viewport=viewport(SIZES[0]), reduced_motion="reduce")
                page = StudioPage(context.new_page(), url)
                STATES[name](page, lambda page=page, name=name: take_all(page, folder, name))
                context.close()
                if page.complaints:
                    raise SystemExit(f"{name}: {page.complaints[0]}")
                print(name, flush=True)
        browser.close()


def viewport(size: tuple[int, int]) -> dict[str, int]:
    return {"width": size[0], "height": size[1]}


def take_all(page: StudioPage, folder: Path, name: str) -> None:
    """The present state in every size and scheme; the window is small again afterwards."""
    for size in SIZES:
        page.page.set_viewport_size(viewport(size))
        page.wait(f"innerWidth === {size[0]}")
        for scheme in SCHEMES:
            page.page.emulate_media(color_scheme=scheme, reduced_motion="reduce")
            page.get("new Promise((drawn) => requestAnimationFrame(() => requestAnimationFrame(drawn)))")
            page.page.screenshot(path=folder / f"{name}-{size[0]}-{scheme}.png")
    page.page.set_viewport_size(viewport(SIZES[0]))
    page.page.emulate_media(color_scheme="light", reduced_motion="reduce")


if __name__ == "__main__":
    if len(sys.argv) < 2:
        raise SystemExit(__doc__)
    main(Path(sys.argv[1]), sys.argv[2:])
