"""The inputs and outputs of a component, and their values as Hops writes them.

Hops sends each value as `{"type": name of a .NET type, "data": text in JSON}`, in branches of a tree. Numbers, texts
and points are plain; curves and meshes are objects of openNURBS, which `rhino3dm` reads and writes. Clients without it
send and get curves as lists of points, and meshes as `{"vertices": [...], "faces": [...]}`.
"""

from __future__ import annotations

import json
import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any, Literal

import numpy as np

from asterism.equilibrium.arrays import Floats, Ints
from asterism.equilibrium.errors import Error
from asterism.fitting.target_files import mesh_triangles
from asterism.pattern.drawing.records import DrawingError
from asterism.pattern.drawing.rhino import RHINO_NEEDED, RHINO_UNITS_MM, curve_points

# `Length` and `Place` are numbers and points in the unit of the document
Kind = Literal["Number", "Length", "Integer", "Boolean", "Text", "Place", "Curve", "Mesh"]
# .NET types of values; numbers are System.Double
_NAMES = {"Place": "Rhino.Geometry.Point3d", "Curve": "Rhino.Geometry.PolylineCurve", "Mesh": "Rhino.Geometry.Mesh"}
_NAMES |= {"Integer": "System.Int32", "Text": "System.String"}
MAX_VERTICES = 200_000


class InputError(Error, ValueError):
    """A value that a component cannot use; the message is one line."""


class BadInputs(InputError):
    """The inputs are those of another version of the component: Hops then asks for its description again."""


@dataclass(frozen=True)
class Parameter:
    """An input or an output.

    Attributes
    ----------
    at_least, at_most : number of values of an input; 0 makes it optional.
    default, minimum, maximum : of plain numbers, which do not depend on the unit of the document.
    """

    name: str
    kind: Kind
    description: str
    at_least: int = 1
    at_most: int = 1
    default: float | None = None
    minimum: float | None = None
    maximum: float | None = None

    def as_output(self) -> dict[str, Any]:
        """The description of an output."""
        kind = {"Length": "Number", "Place": "Point"}.get(self.kind, self.kind)
        return {"Name": self.name, "Nickname": self.name, "Description": self.description, "ParamType": kind}

    def as_input(self) -> dict[str, Any]:
        """The description of an input."""
        limits = {"Default": self.default, "Minimum": self.minimum, "Maximum": self.maximum}
        given = {name: value for name, value in limits.items() if value is not None}
        return {**self.as_output(), "AtLeast": self.at_least, "AtMost": self.at_most, "TreeAccess": False, **given}


@dataclass(frozen=True)
class Units:
    """The unit of a document, and the form of curves and meshes in answers.

    Attributes
    ----------
    mm : length of the unit.
    plain : curves and meshes are lists of numbers, not objects of openNURBS.
    """

    mm: float
    plain: bool

    @classmethod
    def of(cls, request: Mapping[str, Any]) -> Units:
        """Those of a request."""
        name = request.get("modelunits", "Millimeters")
        if not isinstance(name, str) or name not in RHINO_UNITS_MM:
            raise InputError(f"modelunits = {str(name)[:40]!r}: must be one of {', '.join(RHINO_UNITS_MM)}")
        return cls(RHINO_UNITS_MM[name], request.get("plain") is True)


def read_inputs(parameters: tuple[Parameter, ...], request: Mapping[str, Any], units: Units) -> dict[str, list[Any]]:
    """The values of a request by the names of the inputs; lengths in mm, defaults filled in. BadInputs for others.

    Raises
    ------
    BadInputs
        The request has other inputs than the component.
    InputError
        A value is wrong; the message names it.
    """
    trees, known = request.get("values"), {parameter.name: parameter for parameter in parameters}
    if not isinstance(trees, list) or not all(isinstance(tree, dict) for tree in trees):
        raise InputError("values: must be a list of inputs")
    names = [tree.get("ParamName") for tree in trees]
    if len(set(map(str, names))) < len(names) or not set(map(str, names)) <= set(known):
        raise BadInputs("the inputs are not those of this version of the component")
    given: dict[str, list[Any]] = {}
    for name, tree in zip(names, (tree.get("InnerTree") for tree in trees), strict=True):
        if not isinstance(tree, dict) or not all(isinstance(branch, list) for branch in tree.values()):
            raise InputError(f"{name}: InnerTree must hold lists of values")
        given[name] = [item for branch in tree.values() for item in branch]
    read: dict[str, list[Any]] = {}
    for name, parameter in known.items():
        items = given.get(name, [])
        if not items and parameter.default is not None:
            read[name] = [parameter.default]
            continue
        if not parameter.at_least <= len(items) <= parameter.at_most:
            few = "a value" if parameter.at_most == 1 else f"{parameter.at_least} to {parameter.at_most} values"
            raise InputError(f"{name}: needs {few}, got {len(items)}")
        read[name] = [_read(parameter, item, units) for item in items]
    return read


def _read(parameter: Parameter, item: Any, units: Units) -> Any:
    name = parameter.name
    data = item.get("data") if isinstance(item, dict) else None
    if not isinstance(data, str):
        raise InputError(f"{name}: a value must have its data as text")
    try:
        value = json.loads(data)
    except (ValueError, RecursionError):
        value = None
    if parameter.kind == "Text":
        return value if isinstance(value, str) else data
    try:
        read = _READERS[parameter.kind](value, units.mm)
    except InputError as error:
        raise InputError(f"{name}: {error}") from None
    low, high = parameter.minimum, parameter.maximum
    if (low is not None and read < low) or (high is not None and read > high):
        raise InputError(f"{name} = {read:g}: must be from {low:g} to {high:g}")
    return read


def _number(value: Any, mm: float = 1.0) -> float:
    if isinstance(value, bool) or not isinstance(value, int | float) or not abs(value) <= 1e9:
        raise InputError("must be a number")
    return mm * float(value)


def _whole(value: Any, mm: float) -> int:
    number = _number(value)
    if not number.is_integer():
        raise InputError("must be a whole number")
    return int(number)


def _flag(value: Any, mm: float) -> bool:
    if not isinstance(value, bool):
        raise InputError("must be true or false")
    return value


def _point(value: Any, mm: float) -> Floats:
    if not isinstance(value, Mapping) or not {"X", "Y", "Z"} <= value.keys():
        raise InputError("must be a point")
    return np.array([_number(value[axis], mm) for axis in "XYZ"])


def _rows(value: Any, length: int, what: str) -> Floats:
    """(n, length) of a list of lists of numbers."""
    is_list = isinstance(value, list) and len(value) <= MAX_VERTICES
    if not is_list or not all(isinstance(row, list) and len(row) == length for row in value):
        raise InputError(f"must be {what}")
    return np.array([[_number(part) for part in row] for row in value], dtype=float).reshape(-1, length)


def _decoded(value: Any, kind: str) -> Any:
    """The geometry of rhino3dm in an object of openNURBS."""
    rhino3dm = _rhino3dm()
    try:
        geometry = rhino3dm.CommonObject.Decode(value)
    except Exception:  # errors of the binding have no common class
        geometry = None
    if not isinstance(geometry, getattr(rhino3dm, kind)):
        raise InputError(f"must be a {kind.lower()}")
    return geometry


def _curve(value: Any, mm: float) -> Floats:
    """(n, 2) mm, points along a curve, seen from above."""
    if isinstance(value, list):
        points = _rows(value, 3, "a curve")[:, :2]
    else:
        try:
            # the straight lines that stand for a curve are at most 0.005 mm from it
            points = curve_points(_decoded(value, "Curve"), 0.005 / mm)
        except DrawingError as error:
            raise InputError(str(error)) from None
    if len(points) < 2:
        raise InputError("must be a curve")
    return mm * points


def _mesh(value: Any, mm: float) -> tuple[Floats, Ints]:
    """Vertices (V, 3) in mm and triangles (T, 3)."""
    if isinstance(value, dict) and "vertices" in value:
        numbers = _rows(value.get("faces"), 3, "a mesh of triangles")
        if (numbers != np.rint(numbers)).any():
            raise InputError("must be a mesh of triangles")
        return mm * _rows(value["vertices"], 3, "a mesh of triangles"), numbers.astype(np.int64)
    vertices, triangles = mesh_triangles(_decoded(value, "Mesh"))
    return mm * vertices, triangles


_READERS: dict[str, Callable[[Any, float], Any]] = {
    "Number": lambda value, mm: _number(value),
    "Length": _number,
    "Integer": _whole,
    "Boolean": _flag,
    "Place": _point,
    "Curve": _curve,
    "Mesh": _mesh,
}


def closed(points: Floats) -> Floats:
    """(n, 2) corners of a closed curve, the first one not repeated."""
    if len(points) < 4 or math.dist(points[0], points[-1]) > 0.01:
        raise InputError("must be a closed curve")
    return points[:-1]


def write_outputs(parameters: tuple[Parameter, ...], values: Mapping[str, Any], units: Units) -> list[dict[str, Any]]:
    """The trees of an answer; the value of an output is None, a value, a list, or lists for the branches of a tree."""
    trees = []
    for parameter in parameters:
        value = values.get(parameter.name)
        branches = [value] if isinstance(value, list) else [[] if value is None else [value]]
        if isinstance(value, list) and value and all(isinstance(branch, list) for branch in value):
            branches = value
        tree = {
            f"{{{number}}}": [_write(parameter.kind, item, units) for item in branch]
            for number, branch in enumerate(branches)
        }
        trees.append({"ParamName": parameter.name, "InnerTree": tree})
    return trees


def _write(kind: Kind, value: Any, units: Units) -> dict[str, str]:
    scale = 1.0 / units.mm
    name, data = _NAMES.get(kind, "System.Double"), value
    if kind == "Place":
        data = dict(zip("XYZ", (scale * np.asarray(value)).tolist(), strict=True))
    elif kind == "Curve":
        points = (scale * np.asarray(value)).tolist()
        data = points if units.plain else _polyline(points)
    elif kind == "Mesh":
        vertices, faces = (scale * np.asarray(value[0])).tolist(), np.asarray(value[1]).tolist()
        data = {"vertices": vertices, "faces": faces} if units.plain else _rhino_mesh(vertices, faces)
    elif kind == "Length":
        data = scale * value
    return {"type": name, "data": json.dumps(data)}


def _rhino3dm() -> Any:
    try:
        import rhino3dm
    except ImportError:
        raise InputError(f"asterism, for curves and meshes of Rhino, {RHINO_NEEDED}") from None
    return rhino3dm


def _polyline(points: list[list[float]]) -> dict[str, Any]:
    rhino3dm = _rhino3dm()
    line = rhino3dm.Polyline(len(points))
    for point in points:
        line.Add(*point)
    return dict(rhino3dm.PolylineCurve(line).Encode())


def _rhino_mesh(vertices: list[list[float]], faces: list[list[int]]) -> dict[str, Any]:
    mesh = _rhino3dm().Mesh()
    points, corners = mesh.Vertices, mesh.Faces  # each access makes another object
    for vertex in vertices:
        points.Add(*vertex)
    for face in faces:
        corners.AddFace(*face)
    mesh.Normals.ComputeNormals()
    # packing coordinates of double precision would take longer than all the rest
    points.UseDoublePrecisionVertices = False
    return dict(mesh.Encode())
