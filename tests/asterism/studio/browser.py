"""A studio in a process of its own, and a page of it in a real browser."""

from __future__ import annotations

import os
import re
import signal
import subprocess
import sys
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Any
from urllib.parse import urlsplit

import pytest

from tests.asterism.verification.browser import NAMES, browser

# software drawing, so that a machine without a graphics card behaves as one with it; what is drawn in a plane, and the
# page itself, is drawn by the processor, which takes less time than it takes in place of a graphics card
ARGUMENTS = (
    *("--no-sandbox", "--use-gl=angle", "--use-angle=swiftshader", "--enable-unsafe-swiftshader"),
    *("--disable-accelerated-2d-canvas", "--disable-gpu-rasterization", "--disable-gpu-compositing"),
)
VIEWPORT = {"width": 1280, "height": 720}
PATIENCE_S = 300.0
IS_MEASURED = "studio.targetDistance && studio.targetDistance.version === studio.target?.version"
REST = (
    "studio.document && studio.engine === 'ready' && !studio.isWaiting && studio.shownRevision === studio.revision"
    " && ['equilibrium', 'exact', 'printed'].includes(studio.stage)"
)


def browser_path() -> str:
    """An installed browser; without one the test is skipped, or fails where the run promises one."""
    if (program := browser()) is not None:
        return program
    reason = f"none of the browsers {', '.join(NAMES)} is installed"
    if os.environ.get("ASTERISM_NEEDS_BROWSER") != "1":
        pytest.skip(reason)
    pytest.fail(reason)


@contextmanager
def studio_process(folder: Path) -> Iterator[tuple[subprocess.Popen[str], str]]:
    """A studio that serves a folder, and its address; it is ended by Ctrl-C."""
    command = [sys.executable, "-m", "asterism", "studio", "--no-browser"]
    root = str(Path(__file__).parents[3])
    path = os.pathsep.join(filter(None, (root, os.environ.get("PYTHONPATH"))))
    process = subprocess.Popen(
        command, cwd=folder, stdout=subprocess.PIPE, text=True, env={**os.environ, "PYTHONPATH": path}
    )
    assert process.stdout is not None
    try:
        lines = iter(process.stdout.readline, "")
        yield process, next(match[0] for line in lines if (match := re.search(r"http://\S+", line)))
    finally:
        process.send_signal(signal.SIGINT)
        process.wait(30)
        process.stdout.close()


class StudioPage:
    """A page under test: waits for states, and draws with pointer and keys in printed millimetres.

    Attributes
    ----------
    complaints : errors of the console and of scripts, requests that leave this machine.
    """

    def __init__(self, page: Any, url: str) -> None:
        self.page, self.url = page, url
        self.complaints: list[str] = []
        page.on("console", lambda message: self._console(message))
        page.on("pageerror", lambda error: self.complaints.append(str(error)))
        page.on("request", lambda request: self._request(request.url))
        page.goto(url)
        self.wait("window.studio && studio.connected")

    def _console(self, message: Any) -> None:
        if message.type == "error":
            self.complaints.append(message.text)

    def _request(self, url: str) -> None:
        parts = urlsplit(url)
        if parts.scheme not in ("data", "blob") and parts.hostname != "127.0.0.1":
            self.complaints.append(f"request to {url}")

    def wait(self, condition: str, seconds: float = PATIENCE_S) -> None:
        """Wait until an expression of JavaScript is true."""
        self.page.evaluate(
            f"""async () => {{
                const begun = performance.now();
                while (!({condition})) {{
                    if (performance.now() - begun > {1000 * seconds}) throw new Error({condition!r});
                    await new Promise((resolve) => setTimeout(resolve, 10));
                }}
            }}"""
        )

    def click_when(self, condition: str, name: str, seconds: float = PATIENCE_S) -> None:
        """Click an item as soon as a condition holds, before the page does anything else: work may be over soon."""
        self.wait(f"({condition}) && (document.querySelector('[data-testid={name}]').click(), true)", seconds)

    def live_sockets(self, is_open: Callable[[], bool] = lambda: True) -> list[Any]:
        """Reload with connections that the test can close: those made so far, and none while `is_open` says no."""
        sockets: list[Any] = []

        def pass_on(socket: Any) -> None:
            if not is_open():
                socket.close()
                return
            sockets.append(socket)
            socket.connect_to_server()

        self.page.route_web_socket("**/live", pass_on)
        self.page.reload()
        self.wait("window.studio && studio.connected")
        self.rest()
        return sockets

    def rest(self) -> None:
        """Wait until the newest document's equilibrium is drawn."""
        self.wait(REST)

    def summarised(self) -> None:
        """Wait until the numbers at rest belong to the newest document."""
        self.wait(f"{REST} && studio.isSummarised")

    def get(self, expression: str) -> Any:
        return self.page.evaluate(expression)

    def item(self, name: str) -> Any:
        return self.page.get_by_test_id(name)

    def open(self, name: str, tool: str = "") -> None:
        """Open an example, or a file of the folder, wait for its shape, and take a tool."""
        self.open_without_shape(name)
        self.rest()
        if tool:
            self.item(f"tool-{tool}").click()

    def open_without_shape(self, name: str) -> None:
        """The same for a design that may have no shape."""
        self.wait("studio.document || document.querySelector('[data-testid=new]')")
        opened = self.get("studio.opened")
        if self.get("Boolean(studio.document)"):
            self.item("open").click()
        self.item(name).click()
        self.wait(f"studio.opened > {opened}")

    def open_again(self, name: str, tool: str = "") -> None:
        """Open a file of the folder without the work that tests before have left, and take a tool."""
        self.open(name)
        forget = self.page.get_by_role("button", name="Forget them")
        if forget.count():
            forget.click()
            self.wait("!studio.document.kept_work.length")
        if tool:
            self.item(f"tool-{tool}").click()

    def save(self) -> None:
        """Save the design, and wait until it is saved."""
        self.item("save").click()
        self.wait("studio.document.saved")

    def fill(self, name: str, value: float | str) -> None:
        """Type a value into a field, and press Enter."""
        self.item(name).fill(str(value))
        self.item(name).press("Enter")

    def upload(self, name: str, path: Path) -> None:
        """Choose a file by a button."""
        with self.page.expect_file_chooser() as chooser:
            self.item(name).click()
        chooser.value.set_files(str(path))

    def load_target(self, path: Path) -> None:
        """Load a target in place of that of another test, and wait until it lies on the sheet and is measured."""
        self.item("tab-shape").click()
        if self.get("Boolean(studio.target)"):
            self.item("remove-target").click()
            self.wait("!studio.target")
        self.upload("load-target", path)
        self.wait(f"(!studio.camera || studio.ghost > 0) && studio.target?.is_fitted && {IS_MEASURED}")

    def changed(self, act: Callable[[], Any]) -> None:
        """Do something that changes the document, and wait for the shape."""
        revision = self.get("studio.revision")
        act()
        self.wait(f"studio.revision !== {revision} && !studio.isWaiting")
        self.rest()

    def point(self, at: Sequence[float]) -> tuple[float, float]:
        """Place in the window of a printed place."""
        x, y = self.page.evaluate(
            """(at) => {
                const box = document.getElementById('plan-canvas').getBoundingClientRect();
                const [x, y] = studio.screenOf(at);
                return [box.left + x, box.top + y];
            }""",
            list(at),
        )
        return x, y

    def press(self, start: Sequence[float], *places: Sequence[float]) -> None:
        """Press at a place in the window, and move over others."""
        self.page.mouse.move(*start)
        self.page.mouse.down()
        for place in places:
            self.page.mouse.move(*place, steps=4)

    def draw(self, *places: Sequence[float]) -> None:
        """Press at the first printed place, and move over the others."""
        self.press(*map(self.point, places))

    def drag(self, *places: Sequence[float]) -> None:
        """The same, and let go."""
        self.draw(*places)
        self.page.mouse.up()
