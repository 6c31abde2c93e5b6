r"""Sets equations as MathML when the site is built: readers need no script and no network.

Pages write `$...$` within a line and `$$...$$` for an equation of its own. The extension `pymdownx.arithmatex` finds
them and leaves `\(...\)` and `\[...\]` in elements of the class `arithmatex`.
"""

from __future__ import annotations

import re
from html import unescape

from latex2mathml.converter import convert
from mkdocs.config.defaults import MkDocsConfig
from mkdocs.structure.files import Files
from mkdocs.structure.pages import Page

INLINE = re.compile(r'<span class="arithmatex">\\\((.*?)\\\)</span>', re.DOTALL)
DISPLAY = re.compile(r'<div class="arithmatex">\\\[(.*?)\\\]</div>', re.DOTALL)


def on_page_content(html: str, page: Page, config: MkDocsConfig, files: Files) -> str:
    """The page with its equations as MathML."""
    html = DISPLAY.sub(lambda match: f'<div class="equation">{_mathml(match[1], "block")}</div>', html)
    return INLINE.sub(lambda match: _mathml(match[1], "inline"), html)


def _mathml(tex: str, display: str) -> str:
    return str(convert(unescape(tex).strip(), display=display))
