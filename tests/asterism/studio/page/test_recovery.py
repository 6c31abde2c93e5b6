"""What goes wrong and comes back: an engine that ends, a connection that breaks, a file that changes on disk."""

from __future__ import annotations

import os
import signal
import subprocess
from contextlib import suppress
from pathlib import Path
from typing import Any

from asterism.pattern import gallery
from tests.asterism.studio.browser import VIEWPORT, StudioPage, studio_process
from tests.asterism.studio.page.conftest import SEVEN, WITHOUT_VIEW

# controls of the page under a message
COVERED = """() => {
    const boxOf = (element) => element.getBoundingClientRect();
    const isUnder = (a, b) => a.left < b.right && b.left < a.right && a.top < b.bottom && b.top < a.bottom;
    const boxes = [...document.querySelectorAll(".toast")].map(boxOf);
    return [...document.querySelectorAll("button, input, select")]
        .filter((control) => !control.closest("#toasts") && control.getClientRects().length)
        .filter((control) => boxes.some((box) => isUnder(box, boxOf(control))))
        .map((control) => control.textContent || control.dataset.testid);
}"""
BLOCKED = "WebSocket = class extends WebSocket { constructor(url) { super(String(url).replace('/live', '/no')); } }"
BROKEN = "[stars]\nlength_mm = -1\n"


def children(parent: int) -> list[int]:
    """Numbers of the processes that a process started."""
    listed = subprocess.run(["ps", "-A", "-o", "pid=,ppid="], capture_output=True, text=True, check=True).stdout
    return [int(pid) for pid, owner in (line.split() for line in listed.splitlines()) if int(owner) == parent]


def test_an_engine_that_ends_is_replaced_and_the_end_of_the_studio_is_told(browser: Any, tmp_path: Path) -> None:
    (tmp_path / "seven.toml").write_text(SEVEN, encoding="utf-8")
    made = browser.new_page(viewport=VIEWPORT)
    made.add_init_script(WITHOUT_VIEW)
    with studio_process(tmp_path) as (process, url):
        page = StudioPage(made, url)
        page.open("file-seven.toml")
        page.summarised()
        height = page.get("studio.height")
        for child in children(process.pid):
            with suppress(ProcessLookupError):  # it has ended by itself
                os.kill(child, signal.SIGKILL)
        page.wait("studio.engine !== 'ready'")
        page.drag((0, 0), (5, 5))
        page.summarised()
        assert page.get("studio.height") != height
        page.item("undo").click()
        page.wait(f"studio.isSummarised && Math.abs(studio.height - {height}) < 1e-6")
    page.wait("!studio.connected")
    page.page.locator(".toast.bad", has_text="start it again").wait_for()
    made.close()


def test_a_file_that_changes_on_disk_is_followed_and_former_states_are_pictures(flat: StudioPage, folder: Path) -> None:
    file = folder / "followed.toml"
    file.write_text(SEVEN, "utf-8")
    flat.open("file-followed.toml")
    file.write_text(SEVEN.replace("from = 10.0", "from = 9.0"), "utf-8")
    flat.wait("studio.document.design.stars.length_mm.from === 9")
    flat.rest()
    assert flat.get("studio.document.saved")
    flat.item("history").click()
    flat.wait("document.querySelectorAll('.thumbnail canvas').length === 2")
    assert flat.page.locator(".thumbnail").first.inner_text() == "Changed on disk"
    flat.page.locator(".thumbnail").last.click()
    flat.wait("studio.document.design.stars.length_mm.from === 10")
    flat.page.keyboard.press("Escape")
    file.write_text("[stars", "utf-8")
    flat.wait("document.querySelector('[data-testid=problem]')?.textContent.includes('followed.toml')")


def test_the_offer_of_unsaved_work_covers_no_control(flat: StudioPage, folder: Path) -> None:
    text = gallery.path("leaf").read_text("utf-8")
    (folder / "leaf.toml").write_text(text, "utf-8")
    (folder / ".leaf.autosave.toml").write_text(text.replace('name = "leaf"', 'name = "ivy"'), "utf-8")
    flat.open_without_shape("file-leaf.toml")
    flat.item("tab-shape").click()
    for width, height in ((1024, 768), tuple(VIEWPORT.values())):
        flat.page.set_viewport_size({"width": width, "height": height})
        flat.page.evaluate("new Promise((resolve) => requestAnimationFrame(() => requestAnimationFrame(resolve)))")
        assert flat.item("toast").count() == 1 and flat.page.evaluate(COVERED) == [], width


def test_all_unsaved_work_is_shown_and_brought_back_or_forgotten(flat: StudioPage, folder: Path) -> None:
    (folder / "left.toml").write_text(SEVEN, "utf-8")
    for end, name in (("", "one"), ("-2", "two")):
        (folder / f".left.autosave{end}.toml").write_text(SEVEN.replace('"seven"', f'"{name}"'), "utf-8")
    flat.open("file-left.toml")
    flat.page.get_by_text("See them").click()
    flat.wait("document.querySelectorAll('[data-testid=kept-dialog] canvas').length === 2")
    flat.item("kept-.left.autosave.toml").get_by_text("Forget it").click()
    flat.wait("document.querySelectorAll('[data-testid=kept-dialog] canvas').length === 1")
    flat.item("kept-.left.autosave-2.toml").get_by_text("Bring it back").click()
    flat.wait("studio.document.design.name === 'two' && !studio.document.kept_work.length")
    flat.page.keyboard.press("Escape")
    flat.save()
    assert 'name = "two"' in (folder / "left.toml").read_text("utf-8") and not list(folder.glob(".left.autosave*"))


def test_a_proxy_that_blocks_websockets_is_named(browser: Any, address: str) -> None:
    page = browser.new_page(viewport=VIEWPORT)
    page.add_init_script(BLOCKED)
    page.goto(address)
    page.get_by_text("a proxy or a browser extension blocks it").wait_for(timeout=60_000)
    page.close()


def test_saving_asks_before_it_replaces_a_file_with_a_mistake(flat: StudioPage, folder: Path) -> None:
    file = folder / "roof.toml"
    file.write_text((folder / "canopy.toml").read_text(encoding="utf-8"), encoding="utf-8")
    flat.open("file-roof.toml", "brush")
    flat.changed(lambda: flat.drag((0, 0), (5, 5)))
    file.write_text(BROKEN, encoding="utf-8")
    flat.item("save").click()
    flat.page.get_by_text("Nothing is written yet").wait_for()
    assert file.read_text(encoding="utf-8") == BROKEN
    flat.page.get_by_role("button", name="Keep mine").click()
    flat.wait("studio.document.saved")
    assert "override" in file.read_text(encoding="utf-8")


def test_the_first_page_lists_a_design_put_into_the_folder_while_it_is_shown(flat: StudioPage, folder: Path) -> None:
    flat.open_again("file-even.toml")
    flat.item("open").click()
    (folder / "late.toml").write_text((folder / "canopy.toml").read_text(encoding="utf-8"), encoding="utf-8")
    flat.item("file-late.toml").wait_for(timeout=20_000)
    flat.item("new").focus()
    (folder / "late.toml").unlink()
    flat.item("file-late.toml").wait_for(state="detached", timeout=20_000)
    assert flat.get("document.activeElement.dataset.testid") == "new"
    flat.page.keyboard.press("Escape")
