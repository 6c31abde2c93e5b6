"""The widget, with the module that the page runs. Importing this module needs anywidget."""

from __future__ import annotations

import json
import posixpath
import re
from collections.abc import Callable, Iterator, Mapping
from functools import cache
from pathlib import Path
from typing import Any

import anywidget
import traitlets

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
    """One module that exports the default export of the module `entry`, of texts of files by path.

    JavaScript imports by relative paths, at the beginning of a line; a style sheet is imported as the text that it
    holds.
    """
    sources: dict[str, str] = {}

    def collect(name: str) -> None:
        """Add a module after those that it imports."""
        if name.endswith(".css"):
            sources[name] = f"export default {json.dumps(files[name])};\n"
        if name in sources:
            return

        def named(match: re.Match[str]) -> str:
            imported = posixpath.normpath(posixpath.join(posixpath.dirname(name), match[2]))
            collect(imported)
            return f"{match[1]}{MARK}{imported}{match[3]}"

        sources[name] = IMPORT.sub(named, files[name])

    collect(entry)
    return LOADER % (json.dumps(sources, indent=1), MARK, json.dumps(entry))


class SheetWidget(anywidget.AnyWidget):
    """A sheet in space, as `asterism.show` returns it.

    Attributes
    ----------
    mesh, frame : what is drawn, as binary frames of the studio.
    panel : sliders, figures, warnings and problem.
    request : the last request of the sliders; the page sets it.
    height_px : height of the picture.
    """

    _esm = widget_module()
    mesh = traitlets.Bytes().tag(sync=True)
    frame = traitlets.Bytes().tag(sync=True)
    panel = traitlets.Dict().tag(sync=True)
    request = traitlets.Dict().tag(sync=True)
    height_px = traitlets.Int().tag(sync=True)

    def __init__(
        self,
        traits: Mapping[str, Any],
        height_px: int,
        answer: Callable[[Mapping[str, Any]], Iterator[Mapping[str, Any]]] | None = None,
    ) -> None:
        super().__init__(height_px=height_px, **traits)
        self._answer = answer
        self.observe(self._asked, "request")

    def _asked(self, change: Any) -> None:
        """Answer a request of the page, stage by stage."""
        if self._answer is None:
            return
        for traits in self._answer(change["new"]):
            with self.hold_sync():  # a shape arrives together with its mesh
                for name, value in traits.items():
                    self.set_trait(name, value)
