"""Lists the public names of `asterism`, for mkdocstrings, on the page that holds a line `<!-- python -->`."""

from __future__ import annotations

from mkdocs.config.defaults import MkDocsConfig
from mkdocs.structure.files import Files
from mkdocs.structure.pages import Page

MARK = "<!-- python -->"


def on_page_markdown(markdown: str, page: Page, config: MkDocsConfig, files: Files) -> str:
    """The page with one entry for each public name."""
    if MARK not in markdown:
        return markdown
    import asterism

    # by their public names: some are defined under another one, which would stand in the heading and in the signature
    entries = [f"::: asterism.{name}" for name in asterism.__all__ if not name.startswith("_")]
    return markdown.replace(MARK, "\n\n".join(entries))
