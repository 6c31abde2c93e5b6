"""A client that plays Hops: it asks, reads and refuses as `RemoteDefinition` of Hops does, written from its source."""

from __future__ import annotations

import json
from collections.abc import Sequence
from typing import Any
from urllib.parse import urlsplit

import numpy as np
import pytest

# .NET types of the values that Hops sends for a parameter, by its `ParamType`
SENT_TYPES = {
    "Number": "System.Double",
    "Integer": "System.Int32",
    "Boolean": "System.Boolean",
    "Text": "System.String",
}
SPACING_MM = 17.320508


def hexagon(rings: int, unit_mm: float = 1.0, rounded: int = 12) -> np.ndarray:
    """(7, 3) corners of a sheet with rings of stars, the first one repeated."""
    angles = np.radians(30 + 60 * np.arange(7))
    corners = SPACING_MM * (rings + 0.866) * np.column_stack([np.cos(angles), np.sin(angles), 0 * angles])
    return (corners / unit_mm).round(rounded)


def bowl(size_mm: float = 90.0, count: int = 12, height_mm: float = 10.0) -> tuple[np.ndarray, np.ndarray]:
    """A shallow surface of quadrangles."""
    x, y = np.meshgrid(*2 * [np.linspace(-size_mm / 2, size_mm / 2, count)])
    z = height_mm * (1 - (2 * x / size_mm) ** 2 - (2 * y / size_mm) ** 2)
    n = np.arange(count**2).reshape(count, count)
    faces = np.stack([n[:-1, :-1], n[:-1, 1:], n[1:, 1:], n[1:, :-1]], axis=-1).reshape(-1, 4)
    return np.stack([x, y, z], axis=-1).reshape(-1, 3), faces


class HopsError(Exception):
    """What the component shows in red."""


class Hops:
    """One component on the canvas.

    Parameters
    ----------
    http : sends requests, such as a `TestClient`.
    address : of the component.
    """

    def __init__(
        self, http: Any, address: str, units: str = "Millimeters", headers: dict[str, str] | None = None
    ) -> None:
        self.rhino: Any = pytest.importorskip("rhino3dm")
        self._http, self._address, self._units, self._headers = http, address, units, headers or {}
        answer = http.get(address)
        assert "json" in answer.headers["content-type"].lower()
        described = answer.json()
        assert described["Description"] and "xmlns" in described["Icon"]
        self.inputs = {entry["Name"]: entry for entry in described["Inputs"]}
        self.outputs = [entry["Name"] for entry in described["Outputs"]]
        self.warnings: list[str] = []

    def request(self, values: dict[str, Any]) -> dict[str, Any]:
        """The text that Hops posts, with its defaults, as an object."""
        trees = []
        for name, entry in self.inputs.items():
            given = values.get(name, entry.get("Default"))
            items = [] if given is None else given if isinstance(given, list) else [given]
            tree = {"0": [self._sent(entry["ParamType"], item) for item in items]} if items else {}
            trees.append({"ParamName": name, "InnerTree": tree})
        assert set(values) <= set(self.inputs), values
        return {
            **{"absolutetolerance": 0.01, "angletolerance": 1.0, "modelunits": self._units, "dataversion": 8},
            **{"algo": None, "pointer": urlsplit(self._address).path[1:], "filename": None, "cachesolve": False},
            **{"recursionlevel": 0, "values": trees, "warnings": [], "errors": []},
        }

    def solve(self, **values: Any) -> dict[str, Any]:
        """The outputs by name: a value, a list, or a list of branches, as Hops sets them."""
        parts = urlsplit(self._address)
        root = f"http://{parts.netloc}/solve"
        answer = self._http.post(root, json=self.request(values), headers=self._headers)
        schema = answer.json()
        self.warnings = schema["warnings"]
        assert not (schema["values"] and len(schema["values"]) != len(self.outputs)), "Hops would rebuild the component"
        if schema["errors"]:
            raise HopsError(f"{answer.status_code}: {'; '.join(schema['errors'])}")
        assert answer.status_code == 200 and [tree["ParamName"] for tree in schema["values"]] == self.outputs
        return {tree["ParamName"]: self._set(tree["InnerTree"]) for tree in schema["values"]}

    def _set(self, tree: dict[str, list[dict[str, str]]]) -> Any:
        paths = [[int(token) for token in path.strip("{}").split(";") if token.strip()] for path in tree]
        assert all(paths)
        branches = [[self._goo(item) for item in branch] for branch in tree.values()]
        everything = [item for branch in branches for item in branch]
        if len(everything) == 1:
            return everything[0]
        return everything if len(branches) == 1 else branches

    def _goo(self, item: dict[str, str]) -> Any:
        data = item["data"].strip('"')
        if item["type"] in ("System.Double", "System.Int32"):
            return float(data)
        if item["type"] == "System.String":
            return json.loads(item["data"])
        if item["type"] == "Rhino.Geometry.Point3d":
            return np.array([json.loads(data)[axis] for axis in "XYZ"])
        assert item["type"] in ("Rhino.Geometry.Mesh", "Rhino.Geometry.PolylineCurve")
        geometry = self.rhino.CommonObject.Decode(json.loads(data))
        assert geometry.IsValid and f"Rhino.Geometry.{type(geometry).__name__}" == item["type"]
        return geometry

    def _sent(self, kind: str, value: Any) -> dict[str, str]:
        if kind in SENT_TYPES:
            return {"type": SENT_TYPES[kind], "data": json.dumps(value)}
        if kind == "Point":
            place = dict(zip("XYZ", map(float, value), strict=True))
            return {"type": "Rhino.Geometry.Point3d", "data": json.dumps(place)}
        geometry = self.mesh(*value) if kind == "Mesh" else self.curve(value)
        return {"type": f"Rhino.Geometry.{type(geometry).__name__}", "data": json.dumps(geometry.Encode())}

    def curve(self, points: Any) -> Any:
        """A curve of Rhino: as given, or through points."""
        if isinstance(points, self.rhino.Curve):
            return points
        line = self.rhino.Polyline(len(points))
        for point in np.asarray(points).tolist():
            line.Add(*point)
        return self.rhino.PolylineCurve(line)

    def mesh(self, vertices: Sequence[Any], faces: Sequence[Any]) -> Any:
        """A mesh of Rhino."""
        mesh = self.rhino.Mesh()
        for vertex in np.asarray(vertices).tolist():
            mesh.Vertices.Add(*vertex)
        for face in np.asarray(faces).tolist():
            mesh.Faces.AddFace(*face)
        return mesh


def places(mesh: Any) -> np.ndarray:
    """(V, 3) vertices of a mesh of Rhino."""
    return np.array([[point.X, point.Y, point.Z] for point in mesh.Vertices])
