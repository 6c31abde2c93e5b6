"""Every notebook runs from its first cell to its last, on small settings, and what it shows is a picture or text."""

from __future__ import annotations

import ast
import json
from pathlib import Path
from typing import Any

import pytest
from matplotlib.figure import Figure

NOTEBOOKS = sorted((Path(__file__).parent.parent / "notebooks").glob("*.ipynb"))


@pytest.mark.slow
@pytest.mark.parametrize("path", NOTEBOOKS, ids=[path.stem for path in NOTEBOOKS])
def test_notebook_runs(path: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("ASTERISM_QUICK", "1")
    # pictures of shapes take most of the time otherwise
    monkeypatch.setattr("asterism.draw.render.SUPERSAMPLING", 1)
    cells = json.loads(path.read_text(encoding="utf-8"))["cells"]
    names: dict[str, Any] = {}
    for number, cell in enumerate(cells):
        if cell["cell_type"] == "code":
            shown = _run("".join(cell["source"]), f"{path.name}, cell {number}", names)
            # Jupyter shows figures that pyplot made at the end of the cell; of any other it shows the name of its class
            assert not isinstance(shown, Figure), f"cell {number} ends with a figure, which Jupyter may print as text"
    assert number > 0


def _run(source: str, name: str, names: dict[str, Any]) -> object:
    """Run a cell as Jupyter does; the value of its last line is what would be shown."""
    tree = ast.parse(source)
    last = tree.body.pop() if tree.body and isinstance(tree.body[-1], ast.Expr) else None
    exec(compile(tree, name, "exec"), names)
    return None if last is None else eval(compile(ast.Expression(last.value), name, "eval"), names)
