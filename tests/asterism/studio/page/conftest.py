"""A browser, one studio for all tests of the page, and pages of it."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import pytest

from asterism.pattern import gallery
from tests.asterism.studio.browser import VIEWPORT, StudioPage, studio_process

# so fine that no exact shape follows without a click: to compute shapes that a test is not about takes most of the time
FINE = "\n[mesh]\nedge_mm = 0.2\n"
CANOPY = """
name = "canopy"
[stars]
length_mm = 7.0
[border]
rings = 2
[[pins]]
points_mm = [[43.0, 24.8], [-43.0, 24.8], [-43.0, -24.8], [43.0, -24.8]]
target_mm = [[31.0, 18.0, 0.0], [-31.0, 18.0, 0.0], [-31.0, -18.0, 0.0], [31.0, -18.0, 0.0]]
"""
# seven stars with a mesh so coarse that the exact shape is there at once
SEVEN = """
name = "seven"
[stars]
length_mm = { profile = "radial", from = 10.0, to = 8.0, over_mm = 17.3 }
thickness_mm = 0.3
[border]
rings = 1
[[pins]]
where = "border"
scale = 0.74
[mesh]
edge_mm = 4.0
"""
EVEN = """
name = "even"
[stars]
length_mm = 8.0
thickness_mm = 0.3
[border]
rings = 3
"""
WITHOUT_VIEW = """const getContext = HTMLCanvasElement.prototype.getContext;
HTMLCanvasElement.prototype.getContext = function (kind, ...options) {
    return kind === "webgl2" ? null : getContext.call(this, kind, ...options);
};"""


def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    for item in items:
        if Path(__file__).parent in item.path.parents:
            item.add_marker(pytest.mark.slow)


@pytest.fixture(scope="package")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    made = tmp_path_factory.mktemp("studio")
    dome = gallery.path("dome").read_text(encoding="utf-8")
    for name, text in (("canopy", CANOPY), ("even", EVEN), ("plain", dome)):
        (made / f"{name}.toml").write_text(text + FINE, encoding="utf-8")
    (made / "seven.toml").write_text(SEVEN, encoding="utf-8")
    return made


@pytest.fixture(scope="package")
def address(browser: Any, folder: Path) -> Iterator[str]:
    with studio_process(folder) as (_, url):
        yield url


@pytest.fixture(scope="module")
def shared(browser: Any, address: str) -> Iterator[StudioPage]:
    """One page for the tests of a module, which open the design that they need."""
    with pages_of(browser, address) as make:
        yield make()


@pytest.fixture(scope="module")
def flat(browser: Any, address: str) -> Iterator[StudioPage]:
    """The same in a browser that cannot draw in space: to draw there takes most of a browser's time."""
    with pages_of(browser, address, WITHOUT_VIEW) as make:
        yield make()


@pytest.fixture
def new_flat(browser: Any, address: str) -> Iterator[Callable[[], StudioPage]]:
    """Makes such pages for one test."""
    with pages_of(browser, address, WITHOUT_VIEW) as make:
        yield make


@contextmanager
def pages_of(browser: Any, address: str, script: str = "") -> Iterator[Callable[[], StudioPage]]:
    """Makes pages of a studio, each with a script that runs before its own."""
    # a quarter of the pixels: to draw them takes most of the time of a page that draws in space
    context = browser.new_context(viewport=VIEWPORT, device_scale_factor=0.5, reduced_motion="reduce")
    context.add_init_script(script)
    pages: list[StudioPage] = []

    def make() -> StudioPage:
        pages.append(StudioPage(context.new_page(), address))
        return pages[-1]

    yield make
    context.close()
    assert [complaint for page in pages for complaint in page.complaints] == []
