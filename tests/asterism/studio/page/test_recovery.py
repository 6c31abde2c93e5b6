"""What goes wrong and comes back: an engine that ends, a connection that breaks, a file that changes on disk."""

from __future__ import annotations

import os
import signal
import subprocess
from contextlib import suppress
from pathlib import Path
from typing import Any

import pytest

from asterism.pattern import gallery
from tests.asterism.studio.browser import VIEWPORT, StudioPage, studio_process

# the README's tests open the page in `test_page` only
pytestmark = pytest.mark.slow


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


def children(parent: int) -> list[int]:
    """Numbers of the processes that a process started."""
    listed = subprocess.run(["ps", "-A", "-o", "pid=,ppid="], capture_output=True, text=True, check=True).stdout
    return [int(pid) for pid, owner in (line.split() for line in listed.splitlines()) if int(owner) == parent]


def test_an_engine_that_ends_is_replaced_and_the_work_goes_on(browser: Any, tmp_path: Path) -> None:
    with studio_process(tmp_path) as (process, url):
        page = StudioPage(browser.new_page(viewport=VIEWPORT), url)
        page.open("gallery-dome")
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
        page.page.close()


def test_a_broken_connection_is_told_and_taken_up_again(new_page: Any) -> None:
    page = new_page()
    page.open("gallery-dome")
    sockets = page.live_sockets()
    sizes = page.get("studio.sizes")
    sockets[-1].close()
    page.wait("!studio.connected")
    page.wait("studio.connected && studio.document")
    page.rest()
    assert page.get("studio.sizes") == sizes
    page.changed(lambda: page.drag((0, 0), (5, 5)))
    assert page.get("studio.sizes") != sizes


def test_a_studio_that_ends_is_told(browser: Any, tmp_path: Path) -> None:
    with studio_process(tmp_path) as (_, url):
        page = StudioPage(browser.new_page(viewport=VIEWPORT), url)
        page.open("gallery-star")
    page.wait("!studio.connected")
    assert "start it again" in page.item("problem").inner_text()
    page.page.close()


def test_a_file_that_changes_on_disk_is_followed_and_earlier_states_are_pictures(new_page: Any, folder: Path) -> None:
    file = folder / "followed.toml"
    file.write_text('name = "followed"\n[stars]\nlength_mm = 7.0\n[border]\nrings = 1\n', "utf-8")
    page = new_page()
    page.wait("studio.document || document.querySelector('[data-testid=new]')")
    page.open("file-followed.toml")
    file.write_text(file.read_text("utf-8").replace("7.0", "5.0"), "utf-8")
    page.wait("studio.document.design.stars.length_mm === 5")
    page.rest()
    assert page.get("studio.document.saved")
    page.item("history").click()
    page.wait("document.querySelectorAll('.thumbnail canvas').length === 2")
    assert page.page.locator(".thumbnail").first.inner_text() == "Changed on disk"
    page.page.locator(".thumbnail").last.click()
    page.wait("studio.document.design.stars.length_mm === 7")
    page.page.keyboard.press("Escape")
    file.write_text("[stars", "utf-8")
    page.wait("document.querySelector('[data-testid=problem]')?.textContent.includes('followed.toml')")


def test_a_design_that_cannot_be_read_leaves_the_open_one(new_page: Any, folder: Path) -> None:
    file = folder / "spoiled.toml"
    file.write_text('name = "spoiled"\n[stars]\nlength_mm = 7.0\n[border]\nrings = 1\n', "utf-8")
    page = new_page()
    page.open("gallery-dome")
    page.item("open").click()
    page.wait("document.querySelector('[data-testid=\"file-spoiled.toml\"]')")
    file.write_text('name = "spoiled"\n[stars]\nlength_mm = "long"\n[border]\nrings = 1\n', "utf-8")
    page.item("file-spoiled.toml").click()
    # the line goes away after a while
    page.wait("document.querySelector('[data-testid=problem]')?.textContent.includes('length_mm')")
    page.rest()
    assert page.get("studio.document.name").startswith("dome")


@pytest.mark.parametrize(("width", "height"), [(1024, 768), (1280, 720)])
def test_the_offer_of_unsaved_work_covers_no_control(browser: Any, tmp_path: Path, width: int, height: int) -> None:
    text = gallery.path("leaf").read_text("utf-8")
    (tmp_path / "leaf.toml").write_text(text, "utf-8")
    (tmp_path / ".leaf.autosave.toml").write_text(text.replace('name = "leaf"', 'name = "ivy"'), "utf-8")
    with studio_process(tmp_path) as (_, url):
        page = StudioPage(browser.new_page(viewport={"width": width, "height": height}), url)
        page.open_without_shape("file-leaf.toml")
        page.wait("studio.state.engine === 'ready'")
        page.item("tab-shape").click()
        assert page.item("toast").count() == 1 and page.page.evaluate(COVERED) == []
        page.page.close()


def test_all_unsaved_work_is_shown_and_brought_back_or_forgotten(browser: Any, tmp_path: Path) -> None:
    text = gallery.path("star").read_text("utf-8")
    (tmp_path / "star.toml").write_text(text, "utf-8")
    for end, name in (("", "one"), ("-2", "two")):
        (tmp_path / f".star.autosave{end}.toml").write_text(text.replace('name = "star"', f'name = "{name}"'), "utf-8")
    with studio_process(tmp_path) as (_, url):
        page = StudioPage(browser.new_page(viewport=VIEWPORT), url)
        page.open("file-star.toml")
        page.page.get_by_text("See them").click()
        page.wait("document.querySelectorAll('[data-testid=kept-dialog] canvas').length === 2")
        page.item("kept-.star.autosave.toml").get_by_text("Forget it").click()
        page.wait("document.querySelectorAll('[data-testid=kept-dialog] canvas').length === 1")
        page.item("kept-.star.autosave-2.toml").get_by_text("Bring it back").click()
        page.wait("studio.document.design.name === 'two' && !studio.document.kept_work.length")
        page.page.close()
    kept = [file.read_text("utf-8") for file in tmp_path.glob(".star.autosave*.toml")]
    assert len(kept) == 1 and 'name = "two"' in kept[0]  # as unsaved work of this session


def test_a_proxy_that_blocks_websockets_is_named(browser: Any, tmp_path: Path) -> None:
    elsewhere = (
        "WebSocket = class extends WebSocket { constructor(url) { super(String(url).replace('/live', '/no')); } }"
    )
    with studio_process(tmp_path) as (_, url):
        page = browser.new_page(viewport=VIEWPORT)
        page.add_init_script(elsewhere)
        page.goto(url)
        page.get_by_text("a proxy or a browser extension blocks it").wait_for(timeout=60_000)
        page.close()
