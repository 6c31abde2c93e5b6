"""Lists every key of every summary from the typed records, on the page that holds a line `<!-- records -->`."""

from __future__ import annotations

from mkdocs.config.defaults import MkDocsConfig
from mkdocs.structure.files import Files
from mkdocs.structure.pages import Page

MARK = "<!-- records -->"


def on_page_markdown(markdown: str, page: Page, config: MkDocsConfig, files: Files) -> str:
    """The page with a table of keys for each record."""
    if MARK not in markdown:
        return markdown
    from asterism.results.reference import reference

    _, *sections = reference().split("\n## ")
    return markdown.replace(MARK, "## " + "\n## ".join(sections))
