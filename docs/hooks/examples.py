"""Shows the scripts of `docs/examples` with their pictures, on the page that holds a line `<!-- examples -->`.

The docstring of a script has its heading, a sentence after a colon or a question mark, and the name of a picture.
"""

from __future__ import annotations

import ast
import re
from pathlib import Path

from mkdocs.config.defaults import MkDocsConfig
from mkdocs.structure.files import Files
from mkdocs.structure.pages import Page

MARK = "<!-- examples -->"
SCRIPTS = Path(__file__).parents[1] / "examples"
DOCSTRING = re.compile(r"(?P<heading>[^:?]*\??):? (?P<text>.*)\n\nPicture: (?P<picture>\S+)")


def on_page_markdown(markdown: str, page: Page, config: MkDocsConfig, files: Files) -> str:
    """The page with one section for each script."""
    if MARK not in markdown:
        return markdown
    return markdown.replace(MARK, "\n".join(section(script) for script in sorted(SCRIPTS.glob("*.py"))))


def section(script: Path) -> str:
    """Heading, picture and code of a script."""
    text = script.read_text(encoding="utf-8")
    found = DOCSTRING.fullmatch(ast.get_docstring(ast.parse(text)) or "")
    assert found, f"{script.name} needs a docstring of a heading, a sentence and a picture"
    code = text.split('"""', 2)[2].strip()
    sentence = found["text"][0].upper() + found["text"][1:]
    picture = f'![{found["heading"]}](../pictures/{found["picture"]}){{ width="420" }}'
    return f"## {found['heading']}\n\n{sentence} (`{script.name}`)\n\n{picture}\n\n```python\n{code}\n```\n"
