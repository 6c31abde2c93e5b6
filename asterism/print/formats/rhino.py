"""3DM of Rhino: the print and the sheet in space on named layers, in mm."""

from __future__ import annotations

import importlib
from collections.abc import Iterable
from pathlib import Path
from typing import Any

import numpy as np
import shapely

from asterism.equilibrium.arrays import Floats
from asterism.pattern.drawing.rhino import RHINO_NEEDED
from asterism.pattern.geometry.planar import dense_outline
from asterism.print.drawing import CUT, NEEDLES, STARS
from asterism.print.formats.registry import export_format
from asterism.print.job import Job
from asterism.print.needles import HOLE_DIAMETER_MM


@export_format("3DM", ".3dm", "model", package="rhino3dm", hint=RHINO_NEEDED)
def write_rhino(path: Path, job: Job) -> None:
    """Write a job for Rhino; layers without content are left out.

    `print` holds the sheet as it lies on the printer, in the coordinates of the layout: `outline` with the holes of the
    sheet, `plastic` as its edges, `needles` as points. `space` holds the sheet in space, if its shape is known: `sheet`
    as a mesh, `arms` as middle lines of stars and rods, `outline`, `needles` from the base to the sheet. `base` holds
    `drilling`: a circle and a point for each needle. Needles carry their numbers as names.
    """
    model, shape = _Model(importlib.import_module("rhino3dm")), job.seen
    for ring in job.cut:
        model.polyline("print::outline", CUT.colour, _flat(job.placement.points(ring)), closed=True)
    # the lowest layer is the widest
    for polygon in shapely.get_parts(job.pattern[0].region):
        for ring in (polygon.exterior, *polygon.interiors):
            model.polyline("print::plastic", STARS.colour, _flat(shapely.get_coordinates(ring)))
    for needle in job.needles:
        place = _flat(job.placement.points(needle.printed)[None])[0]
        model.point("print::needles", NEEDLES.colour, place, f"needle {needle.number}")
    if shape is not None:
        model.mesh("space::sheet", "#e6dcc4", shape.positions, shape.triangles, job.design.name)
        for rod in shape.rods:
            model.polyline("space::arms", STARS.colour, shape.positions[rod])
        for ring in (job.plan.outline, *job.plan.holes):
            model.polyline("space::outline", CUT.colour, shape.at_edges(dense_outline(ring)), closed=True)
    # holes in the base, and needles from there to the sheet; the base lies at z = 0 if the shape is not known
    drilling = "base::drilling", "#0a7d32"
    for needle in job.needles:
        if needle.place is None:
            continue
        name, centre = f"needle {needle.number}", np.array([*needle.place[:2], 0.0])
        if shape is not None and needle.height_mm is not None:
            upper = shape.at_edges(needle.printed)[0]
            centre[2] = upper[2] - needle.height_mm
            if needle.is_raised:
                model.polyline("space::needles", NEEDLES.colour, np.array([centre, upper]), name=name)
        model.point(*drilling, centre, name)
        model.circle(*drilling, centre, HOLE_DIAMETER_MM / 2, name)
    # version of the file: Rhino 7 and later read it
    if not model.file.Write(str(path), 7):
        raise OSError(f"rhino3dm cannot write {path.name}")


class _Model:
    """A 3DM file that makes its layers when they are first used."""

    def __init__(self, rhino3dm: Any) -> None:
        self._rhino = rhino3dm
        self.file = rhino3dm.File3dm()
        self.file.Settings.ModelUnitSystem = rhino3dm.UnitSystem.Millimeters
        self._layers: dict[str, int] = {}

    def polyline(self, layer: str, colour: str, points: Floats, closed: bool = False, name: str = "") -> None:
        places = np.concatenate([points, points[:1]]) if closed else points
        line = self._rhino.Polyline(len(places))
        for place in places:
            line.Add(*map(float, place))
        self.file.Objects.AddPolyline(line, self._on(layer, colour, name))

    def point(self, layer: str, colour: str, place: Floats, name: str) -> None:
        self.file.Objects.AddPoint(self._rhino.Point3d(*map(float, place)), self._on(layer, colour, name))

    def circle(self, layer: str, colour: str, centre: Floats, radius: float, name: str) -> None:
        circle = self._rhino.Circle(self._rhino.Point3d(*map(float, centre)), radius)
        self.file.Objects.AddCircle(circle, self._on(layer, colour, name))

    def mesh(self, layer: str, colour: str, points: Floats, triangles: Iterable[Any], name: str) -> None:
        mesh = self._rhino.Mesh()
        for point in points:
            mesh.Vertices.Add(*map(float, point))
        for corners in triangles:
            mesh.Faces.AddFace(*map(int, corners))
        mesh.Normals.ComputeNormals()
        self.file.Objects.AddMesh(mesh, self._on(layer, colour, name))

    def _on(self, layer: str, colour: str, name: str) -> Any:
        attributes = self._rhino.ObjectAttributes()
        attributes.LayerIndex = self._layer(layer, colour)
        attributes.Name = name
        return attributes

    def _layer(self, full_name: str, colour: str) -> int:
        """Number of a layer; those above it are made too."""
        if full_name not in self._layers:
            above, _, name = full_name.rpartition("::")
            layer = self._rhino.Layer()
            layer.Name = name
            layer.Color = (*bytes.fromhex(colour[1:]), 255)
            if above:
                layer.ParentLayerId = self.file.Layers[self._layer(above, colour)].Id
            self._layers[full_name] = self.file.Layers.Add(layer)
        return self._layers[full_name]


def _flat(points: Floats) -> Floats:
    """(n, 3) points on the plane z = 0."""
    return np.column_stack([points, np.zeros(len(points))])
