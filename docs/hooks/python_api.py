"""Lists the public names of `asterism`, for mkdocstrings, on the page that holds a line `<!-- python -->`."""

from __future__ import annotations

from pathlib import Path

from mkdocs.config.defaults import MkDocsConfig
from mkdocs.plugins import event_priority
from mkdocs.structure.files import Files
from mkdocs.structure.pages import Page

MARK = "<!-- python -->"


@event_priority(100)  # before mkdocstrings reads it
def on_config(config: MkDocsConfig) -> MkDocsConfig:
    """Take docstrings from the installation: it has the engines inside `asterism`, the checkout beside it."""
    import asterism

    config.plugins["mkdocstrings"].config.handlers["python"]["paths"] = [str(Path(asterism.__file__).parents[1])]
    return config


def on_page_markdown(markdown: str, page: Page, config: MkDocsConfig, files: Files) -> str:
    """The page with one entry for each public name."""
    if MARK not in markdown:
        return markdown
    import asterism

    # by their public names: some are defined under another one, which would stand in the heading and in the signature
    entries = [f"::: asterism.{name}" for name in asterism.__all__ if not name.startswith("_")]
    return markdown.replace(MARK, "\n\n".join(entries))
