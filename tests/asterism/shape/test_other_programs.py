"""The page on COMPAS, Blender and PyVista: its code runs, with stand-ins for the programs."""

from __future__ import annotations

import json
import re
import sys
from pathlib import Path
from unittest.mock import MagicMock

import pytest

import asterism

PAGE = (Path(__file__).parents[3] / "docs" / "how-to" / "other-programs.md").read_text(encoding="utf-8")
BLOCKS = dict(
    zip(("sheet", "compas", "bpy", "pyvista"), re.findall(r"```python\n(.*?)```", PAGE, re.DOTALL), strict=True)
)


PARTS = {"compas": ("compas", "compas.datastructures", "compas.geometry"), "bpy": ("bpy",), "pyvista": ("pyvista",)}


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


@pytest.mark.parametrize("program", PARTS)
def test_each_program_gets_the_whole_sheet(program: str, sheet: Path, monkeypatch: pytest.MonkeyPatch):
    monkeypatch.chdir(sheet)
    package = MagicMock()
    for name in PARTS[program]:
        module = package
        for part in name.split(".")[1:]:
            module = getattr(module, part)
        monkeypatch.setitem(sys.modules, name, module)
    package.geometry.Polyline.return_value.length = 1.0
    exec(BLOCKS[program], left := {})  # type: ignore[var-annotated]
    if program == "compas":
        given = package.datastructures.Mesh.from_vertices_and_faces.call_args.args
        assert given == (left["sheet"]["vertices"], left["sheet"]["faces"]) and len(left["arms"]) == 111
    elif program == "bpy":
        vertices, edges, faces = left["mesh"].from_pydata.call_args.args
        assert edges == [] and faces == left["sheet"]["faces"]
        assert vertices[7] == pytest.approx([0.001 * x for x in left["sheet"]["vertices"][7]])
        assert left["curves"].splines.new.call_count == 111
        assert package.context.scene.collection.objects.link.call_count == 2
    else:
        vertices, faces = package.PolyData.from_regular_faces.call_args.args
        assert vertices.shape == (1657, 3) and faces.shape == (3174, 3)
        assert package.lines_from_points.call_count == 111
