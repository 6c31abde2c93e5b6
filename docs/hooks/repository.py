"""Publishes the files of the repository that pages link to: tables of benchmarks, notebooks, the list of changes.

Pages link to them by their place in the repository, so that the links also work where the repository is read.
The site holds such a file under `repository/`; links are rewritten when the site is built.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from pathlib import Path
from posixpath import dirname, join, normpath, relpath

from mkdocs.config.defaults import MkDocsConfig
from mkdocs.structure.files import File, Files
from mkdocs.structure.pages import Page

ROOT = Path(__file__).parents[2]
SHELF = "repository"
LINK = re.compile(r"\]\((?!\w+:|#)([^)#\s]+)(#[^)\s]*)?\)")


def _place(uri: str) -> str:
    """Where a page of the site lies in the repository."""
    return uri.removeprefix(f"{SHELF}/") if uri.startswith(f"{SHELF}/") else f"docs/{uri}"


def _uri(place: str) -> str:
    """Where a file of the repository lies in the site."""
    return place.removeprefix("docs/") if place.startswith("docs/") else f"{SHELF}/{place}"


def _linked(place: str) -> Iterator[str]:
    """Files of the repository that a page links to."""
    for link, _ in LINK.findall((ROOT / place).read_text(encoding="utf-8")):
        yield normpath(join(dirname(place), link))


def on_files(files: Files, config: MkDocsConfig) -> Files:
    """Add all linked files that lie outside docs/, and those that these link to."""
    waiting = [_place(file.src_uri) for file in files.documentation_pages()]
    seen = set(waiting)
    while waiting:
        for place in _linked(waiting.pop()):
            if place in seen or place.startswith("docs/") or not (ROOT / place).is_file():
                continue
            seen.add(place)
            files.append(File.generated(config, _uri(place), abs_src_path=str(ROOT / place)))
            if place.endswith(".md"):
                waiting.append(place)
    return files


def on_page_markdown(markdown: str, page: Page, config: MkDocsConfig, files: Files) -> str:
    """Links as the site has them."""
    here = page.file.src_uri

    def rewritten(match: re.Match[str]) -> str:
        place = normpath(join(dirname(_place(here)), match[1]))
        return f"]({relpath(_uri(place), dirname(here) or '.')}{match[2] or ''})"

    return LINK.sub(rewritten, markdown)
