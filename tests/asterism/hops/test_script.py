"""The script of the page on Grasshopper, as a client of a real server. Classes of Rhino are those of its library."""

from __future__ import annotations

import ast
import re
import sys
import threading
import time
import tomllib
from collections.abc import Iterator
from pathlib import Path
from types import ModuleType, SimpleNamespace
from typing import Any

import numpy as np
import pytest

import asterism
from asterism.hops.components import Work
from asterism.hops.server import application
from asterism.process.local_server import LOOPBACK, bound, host_names, serve
from tests.asterism.hops.client import hexagon, places

PAGE = (Path(__file__).parents[3] / "docs" / "how-to" / "grasshopper.md").read_text(encoding="utf-8")
(SCRIPT,) = re.findall(r"```python\n(.*?)```", PAGE, re.DOTALL)


rhino3dm = pytest.importorskip("rhino3dm")


class Curve(rhino3dm.PolylineCurve):  # type: ignore[misc, name-defined]
    """A curve through points, with a method that Rhino has and its library has not."""

    def __init__(self, points: Any) -> None:
        line = rhino3dm.Polyline(len(points))
        for point in np.asarray(points).tolist():
            line.Add(*point)
        super().__init__(line)

    def ToPolyline(self, tolerance: float, angle: float, least: float, most: float) -> Curve:
        return self


@pytest.fixture
def address(tmp_path: Path) -> Iterator[str]:
    """Where a server of the components listens, with the key `secret`."""
    with bound(LOOPBACK, 0) as listening:
        port = listening.getsockname()[1]
        work = Work(tmp_path)
        app = application(work, host_names(LOOPBACK, port), "secret")
        threading.Thread(target=serve, args=(listening, app), kwargs={"ws": "none"}, daemon=True).start()
        time.sleep(0.2)
        yield f"http://{LOOPBACK}:{port}/solve"


def run(monkeypatch: pytest.MonkeyPatch, address: str, key: str = "secret", **inputs: Any) -> dict[str, Any]:
    """What the script leaves behind in Rhino."""
    doc = SimpleNamespace(ModelUnitSystem="Millimeters", ModelAbsoluteTolerance=0.01, ModelAngleToleranceRadians=0.02)
    rhino: Any = ModuleType("Rhino")
    rhino.Geometry, rhino.RhinoDoc = rhino3dm, SimpleNamespace(ActiveDoc=doc)
    kernel: Any = ModuleType("Grasshopper.Kernel")
    kernel.GH_RuntimeMessageLevel = SimpleNamespace(Warning="orange")
    for name, module in (("Rhino", rhino), ("Grasshopper", ModuleType("Grasshopper")), ("Grasshopper.Kernel", kernel)):
        monkeypatch.setitem(sys.modules, name, module)
    told: list[Any] = []
    ghenv = SimpleNamespace(Component=SimpleNamespace(AddRuntimeMessage=lambda *message: told.append(message)))
    text = SCRIPT.replace("http://127.0.0.1:5017/solve", address).replace('solve", ""', f'solve", "{key}"')
    left = {"needles": None, "targets": None, "ghenv": ghenv, "told": told, **inputs}
    exec(compile(text, "script", "exec"), left)
    return left


def test_the_script_is_short_and_of_the_python_of_rhino():
    assert len([line for line in SCRIPT.splitlines() if line]) <= 65
    nodes = ast.walk(ast.parse(SCRIPT, feature_version=(3, 9)))
    modules = {alias.name.split(".")[0] for node in nodes if isinstance(node, ast.Import) for alias in node.names}
    assert modules <= {"json", "urllib", "Rhino"}


def test_the_script_shows_a_sheet_on_needles_and_its_warnings(monkeypatch: pytest.MonkeyPatch, address: str):
    corners = hexagon(1)[:6:2]
    needles, targets = ([rhino3dm.Point3d(*(scale * corner)) for corner in corners] for scale in (1.0, 0.75))
    left = run(monkeypatch, address, outline=Curve(hexagon(1)), lengths=[7.0], needles=needles, targets=targets)
    shape = asterism.preview(asterism.Design.from_dict(tomllib.loads(left["design"])))
    held = places(left["mesh"])
    np.testing.assert_allclose(held, shape.positions, atol=1e-4)
    assert left["mesh"].Faces.Count == len(shape.triangles) and len(left["arms"]) == 21
    assert left["rim"].PointCount > 20 and left["error"] > 0.0
    assert all(np.linalg.norm(held - 0.75 * corner, axis=1).min() < 0.01 for corner in corners)
    left = run(monkeypatch, address, outline=Curve(hexagon(1)), lengths=[9.5])
    assert any(level == "orange" and "too tightly" in text for level, text in left["told"])


def test_the_script_raises_what_is_wrong(monkeypatch: pytest.MonkeyPatch, address: str):
    with pytest.raises(Exception, match="must be a closed curve"):
        run(monkeypatch, address, outline=Curve(hexagon(1)[:-1]), lengths=[7.0])
    with pytest.raises(Exception, match="the key of the server is missing or wrong"):
        run(monkeypatch, address, key="other", outline=Curve(hexagon(1)), lengths=[7.0])
