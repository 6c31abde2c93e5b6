"""A browser, one studio for all tests of the page, and pages of it."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import pytest

from tests.asterism.studio.browser import VIEWPORT, StudioPage, running_studio

NEEDLES = """
name = "canopy"
[stars]
length_mm = 7.0
[border]
rings = 2
[[pins]]
points_mm = [[43.0, 24.8], [-43.0, 24.8], [-43.0, -24.8], [43.0, -24.8]]
target_mm = [[31.0, 18.0, 0.0], [-31.0, 18.0, 0.0], [-31.0, -18.0, 0.0], [31.0, -18.0, 0.0]]
"""


@pytest.fixture(scope="package")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    made = tmp_path_factory.mktemp("studio")
    (made / "canopy.toml").write_text(NEEDLES, encoding="utf-8")
    return made


@pytest.fixture(scope="package")
def address(browser: Any, folder: Path) -> Iterator[str]:
    with running_studio(folder) as url:
        yield url


@pytest.fixture
def new_page(browser: Any, address: str) -> Iterator[Callable[[], StudioPage]]:
    """Makes pages; afterwards none may have complained."""
    with pages_of(browser, address) as make:
        yield make


@pytest.fixture
def page(new_page: Callable[[], StudioPage]) -> StudioPage:
    return new_page()


@pytest.fixture(scope="module")
def shared(browser: Any, address: str) -> Iterator[StudioPage]:
    """One page for the tests of a module, which open the design that they need."""
    with pages_of(browser, address) as make:
        yield make()


@contextmanager
def pages_of(browser: Any, address: str) -> Iterator[Callable[[], StudioPage]]:
    context = browser.new_context(viewport=VIEWPORT, reduced_motion="reduce")
    pages: list[StudioPage] = []

    def make() -> StudioPage:
        pages.append(StudioPage(context.new_page(), address))
        return pages[-1]

    yield make
    context.close()
    assert [complaint for page in pages for complaint in page.complaints] == []
