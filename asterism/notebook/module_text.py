"""One ES module out of many: a notebook takes the widget's code as a single text, without a server for its imports."""

from __future__ import annotations

import json
import posixpath
import re
from collections.abc import Mapping
from functools import cache
from pathlib import Path

PACKAGE = Path(__file__).parents[1]
ENTRY = "notebook/page/widget.js"
# `import ... from "./name.js"` at the beginning of a line; the bindings may take several lines
IMPORT = re.compile(r'^(import\b[^;"]*")(\.{1,2}/[^"]+)(";)', re.MULTILINE)
# marks the name of a module in the text of another one, until its address is known
MARK = "asterism:"
LOADER = """// Each module becomes a blob with an address; a module comes after those that it imports.
const sources = %s;
const addresses = {};
for (const [name, source] of Object.entries(sources)) {
  const text = source.replace(/"%s([^"]+)"/g, (whole, imported) => JSON.stringify(addresses[imported]));
  addresses[name] = URL.createObjectURL(new Blob([text], { type: "text/javascript" }));
}
const entry = await import(addresses[%s]);
for (const address of Object.values(addresses)) URL.revokeObjectURL(address);
export default entry.default;
"""


@cache
def widget_module() -> str:
    """The module of the widget with all modules and styles that it imports; it loads nothing from elsewhere.

    Examples
    --------
    >>> "studio/page/view/view.js" in widget_module()
    True
    """
    files = {
        file.relative_to(PACKAGE).as_posix(): file.read_text(encoding="utf-8")
        for room in ("notebook", "studio")
        for file in (PACKAGE / room / "page").rglob("*")
        if file.suffix in (".js", ".css")
    }
    return module_text(files, ENTRY)


def module_text(files: Mapping[str, str], entry: str) -> str:
    """One module that exports the default export of an entry.

    Parameters
    ----------
    files : texts by path. JavaScript imports by relative paths, at the beginning of a line; a style sheet is imported
        as the text that it holds.
    entry : path of the module to begin with.

    Raises
    ------
    ValueError
        A module imports a file that is not there, or modules import each other in a circle.

    Examples
    --------
    >>> files = {"page/a.js": 'import { b } from "./b.js";\\nexport default b;', "page/b.js": ""}
    >>> text = module_text(files, "page/a.js")
    >>> text.index("page/b.js") < text.index("page/a.js")
    True
    """
    sources: dict[str, str] = {}
    _collect(entry, files, sources, ())
    return LOADER % (json.dumps(sources, indent=1), MARK, json.dumps(entry))


def _collect(name: str, files: Mapping[str, str], sources: dict[str, str], above: tuple[str, ...]) -> None:
    """Add a module after those that it imports."""
    if name in sources:
        return
    if name in above:
        raise ValueError(f"{name} imports itself by way of {', '.join(above[above.index(name) + 1 :]) or name}")
    if name not in files:
        raise ValueError(f"{above[-1] if above else 'the entry'} imports {name}, which is not there")
    text = files[name]
    if name.endswith(".css"):
        sources[name] = f"export default {json.dumps(text)};\n"
        return

    def named(match: re.Match[str]) -> str:
        imported = posixpath.normpath(posixpath.join(posixpath.dirname(name), match[2]))
        _collect(imported, files, sources, (*above, name))
        return f"{match[1]}{MARK}{imported}{match[3]}"

    sources[name] = IMPORT.sub(named, text)
