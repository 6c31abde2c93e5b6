"""The page on COMPAS, Blender and PyVista: its code runs, with stand-ins for programs that are not installed."""

from __future__ import annotations

import importlib
import json
import re
import sys
from pathlib import Path
from typing import Any
from unittest.mock import MagicMock

import pytest

import asterism

PAGE = (Path(__file__).parents[3] / "docs" / "how-to" / "other-programs.md").read_text(encoding="utf-8")
BLOCKS = dict(
    zip(("sheet", "compas", "bpy", "pyvista"), re.findall(r"```python\n(.*?)```", PAGE, re.DOTALL), strict=True)
)


def stand_in(monkeypatch: pytest.MonkeyPatch, *names: str) -> Any:
    """A package in place of one that is not installed; None if it is."""
    try:
        importlib.import_module(names[0])
    except ImportError:
        package = MagicMock()
        for name in names:
            module = package
            for part in name.split(".")[1:]:
                module = getattr(module, part)
            monkeypatch.setitem(sys.modules, name, module)
        return package
    return None


@pytest.fixture(scope="module")
def sheet(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The folder in which the first block of the page has written a sheet."""
    folder = tmp_path_factory.mktemp("sheet")
    with pytest.MonkeyPatch.context() as monkeypatch:
        monkeypatch.chdir(folder)
        exec(BLOCKS["sheet"], {})
    return folder


def test_plain_lists_are_the_shape(sheet: Path):
    shape = asterism.preview(asterism.new("dome"))
    written = json.loads((sheet / "sheet.json").read_text())
    assert written["vertices"] == shape.positions.tolist() and written["faces"] == shape.triangles.tolist()
    assert written["arms"][5] == shape.positions[shape.rods[5]].tolist() and len(written["arms"]) == 111
    assert {type(number) for face in shape.mesh().faces for number in face} == {int}


def test_compas(sheet: Path, monkeypatch: pytest.MonkeyPatch):
    monkeypatch.chdir(sheet)
    package = stand_in(monkeypatch, "compas", "compas.datastructures", "compas.geometry")
    if package is not None:
        package.geometry.Polyline.return_value.length = 1.0
    exec(BLOCKS["compas"], left := {})  # type: ignore[var-annotated]
    if package is not None:
        package.datastructures.Mesh.from_vertices_and_faces.assert_called_once_with(
            left["sheet"]["vertices"], left["sheet"]["faces"]
        )
    assert len(left["arms"]) == 111


def test_blender(sheet: Path, monkeypatch: pytest.MonkeyPatch):
    monkeypatch.chdir(sheet)
    package = stand_in(monkeypatch, "bpy")
    exec(BLOCKS["bpy"], left := {})  # type: ignore[var-annotated]
    if package is not None:
        vertices, edges, faces = left["mesh"].from_pydata.call_args.args
        assert edges == [] and faces == left["sheet"]["faces"]
        assert vertices[7] == pytest.approx([0.001 * x for x in left["sheet"]["vertices"][7]])
        assert left["curves"].splines.new.call_count == 111
        assert package.context.scene.collection.objects.link.call_count == 2


def test_pyvista(sheet: Path, monkeypatch: pytest.MonkeyPatch):
    monkeypatch.chdir(sheet)
    package = stand_in(monkeypatch, "pyvista")
    exec(BLOCKS["pyvista"], {})
    if package is not None:
        vertices, faces = package.PolyData.from_regular_faces.call_args.args
        assert vertices.shape == (1657, 3) and faces.shape == (3174, 3)
        assert package.lines_from_points.call_count == 111
