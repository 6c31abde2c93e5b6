"""One ES module out of many: order, names, styles, and what is refused."""

from __future__ import annotations

import json
import re

from asterism.notebook.widget import ENTRY, MARK, PACKAGE, module_text, widget_module


def sources(text: str) -> dict[str, str]:
    """The modules within a module's text, in their order."""
    begin = text.index("{")
    sources: dict[str, str] = json.JSONDecoder().raw_decode(text[begin:])[0]
    return sources


def test_a_module_comes_after_those_that_it_imports_and_once() -> None:
    files = {
        "a/main.js": 'import { b } from "./b.js";\nimport {\n  c,\n  d as e,\n} from "../c.js";\n',
        "a/b.js": 'import { c } from "../c.js";\nexport const b = c;\n',
        "c.js": "export const c = 1;\nexport const d = 2;\n",
    }
    made = sources(module_text(files, "a/main.js"))
    assert list(made) == ["c.js", "a/b.js", "a/main.js"]
    assert re.findall(rf'"{MARK}([^"]+)"', made["a/main.js"]) == ["a/b.js", "c.js"]
    assert made["c.js"] == files["c.js"]


def test_a_style_sheet_is_a_module_with_its_text() -> None:
    style = 'a { content: "\\2013"; }\n'
    made = sources(module_text({"a.js": 'import style from "./a.css";\n', "a.css": style}, "a.js"))
    assert made["a.css"] == f"export default {json.dumps(style)};\n"


def test_the_widget_holds_the_files_of_the_studio_and_no_import_is_left() -> None:
    made = sources(widget_module())
    assert list(made)[-1] == ENTRY and "studio/page/view/shaders.js" in made
    for name, text in made.items():
        original = (PACKAGE / name).read_text(encoding="utf-8")
        if name.endswith(".js"):
            assert text.replace(MARK, "").splitlines()[0] == original.splitlines()[0]
            assert not re.search(r'(?:^|\s)(?:import|from)\s*\(?\s*"(?!asterism:)', text), name
    assert not re.search(r"\b(?:https?|wss?)://", widget_module().replace("http://www.w3.org/", ""))
