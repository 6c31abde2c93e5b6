"""Surfaces from 3DM files of Rhino, by `rhino3dm` (the extra `cad`)."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np

from asterism.equilibrium.arrays import Floats, Ints
from asterism.fitting.errors import TargetError
from asterism.pattern.drawing.rhino import open_rhino_model


def read_rhino(path: Path, mm: float | None) -> tuple[Floats, Ints]:
    """The visible surfaces of a 3DM file as triangles.

    Meshes are taken as they are. A surface that is not trimmed is sampled at its parameters; of a trimmed or joined one
    the file must hold the render mesh, as files saved by Rhino do.

    `mm`: length of the unit of the numbers; None for the unit that the file names.

    Returns vertices (V, 3) in mm and triangles (T, 3).

    Raises TargetError: `rhino3dm` is not installed, or the file holds no surface that can be read.
    """
    model = open_rhino_model(path, mm, lambda problem: TargetError(path, problem))
    meshes = [mesh for geometry, _, hidden in model.shown() if not hidden for mesh in _meshes(path, geometry)]
    if not meshes:
        kinds = sorted({type(thing.Geometry).__name__ for thing in model.file.Objects})
        held = f"only {', '.join(kinds)}" if kinds else "nothing"
        raise TargetError(path, f"holds no visible surface or mesh, {held}")
    starts = np.cumsum([0, *(len(vertices) for vertices, _ in meshes)])
    vertices = np.concatenate([vertices for vertices, _ in meshes])
    triangles = np.concatenate([triangles + start for (_, triangles), start in zip(meshes, starts, strict=False)])
    return model.mm * vertices, triangles


def _meshes(path: Path, geometry: Any) -> list[tuple[Floats, Ints]]:
    """The triangles of one object: none for curves, points and the like."""
    import rhino3dm

    if isinstance(geometry, rhino3dm.Mesh):
        return [mesh_triangles(geometry)]
    if isinstance(geometry, rhino3dm.Extrusion):
        geometry = geometry.ToBrep(False)
    if isinstance(geometry, rhino3dm.Brep):
        table: Any = geometry.Faces
        faces = list(table)
        cached = [face.GetMesh(rhino3dm.MeshType.Any) for face in faces]
        if len(faces) == 1 and geometry.IsSurface:
            return [_sampled(faces[0].UnderlyingSurface())]
        if any(mesh is None or len(mesh.Vertices) == 0 for mesh in cached):
            problem = "a trimmed or joined surface without its render mesh: save the file shaded, or mesh it in Rhino"
            raise TargetError(path, f"holds {problem}")
        return [mesh_triangles(mesh) for mesh in cached]
    if isinstance(geometry, rhino3dm.Surface):
        return [_sampled(geometry)]
    return []


def mesh_triangles(mesh: Any) -> tuple[Floats, Ints]:
    """Vertices (V, 3) and triangles (T, 3) of a mesh of Rhino, in its unit."""
    vertices = np.array([[point.X, point.Y, point.Z] for point in mesh.Vertices], dtype=float).reshape(-1, 3)
    faces = mesh.Faces
    corners = np.array([faces[number] for number in range(len(faces))], dtype=np.int64).reshape(-1, 4)
    # a triangle repeats its third corner
    quads = corners[corners[:, 2] != corners[:, 3]]
    return vertices, np.concatenate([corners[:, :3], quads[:, [0, 2, 3]]])


def _sampled(surface: Any) -> tuple[Floats, Ints]:
    """A grid of points on a surface that is not trimmed."""
    values = []
    for direction in (0, 1):
        # points along each parameter: so many for each span between knots
        count = int(np.clip(8 * surface.SpanCount(direction), 60, 200))
        interval = surface.Domain(direction)
        values.append(np.linspace(interval.T0, interval.T1, count))
    points = [surface.PointAt(float(u), float(v)) for u in values[0] for v in values[1]]
    number = np.arange(len(points)).reshape(len(values[0]), -1)
    a, b, c, d = (part.ravel() for part in (number[:-1, :-1], number[1:, :-1], number[1:, 1:], number[:-1, 1:]))
    triangles = np.concatenate([np.column_stack([a, b, c]), np.column_stack([a, c, d])])
    return np.array([[point.X, point.Y, point.Z] for point in points]), triangles
