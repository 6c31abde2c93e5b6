"""A triangle mesh of the printed sheet whose edges follow every arm."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float, Int

from asterism.pattern.design.errors import MeshError
from asterism.pattern.geometry.planar import is_in_sorted, polygon_area, triangle_angles, triangle_areas
from asterism.pattern.layout.layout import Layout

MAX_EXACT_TRIANGLES = 2_000_000


@dataclass(frozen=True)
class Mesh:
    """Triangles of the sheet and the paths of the arms on it, in print coordinates (mm)."""

    points: Float[np.ndarray, "V 2"]  # (V, 2) mm, every one used by a triangle
    triangles: Int[np.ndarray, "T 3"]  # (T, 3) counterclockwise
    # one array a rod (in the order of the layout's graph): vertices from its start, of an arm the star's centre, to its
    # end; consecutive ones are edges of triangles.
    rods: tuple[Int[np.ndarray, " _"], ...]
    star_vertices: Int[np.ndarray, " S"]  # (S,) the vertex at each star's centre
    border_vertices: Int[np.ndarray, " n"]  # (n,) vertices on the outline, counterclockwise
    # one array a pin set of the layout. For points: in their order. For edges: every mesh vertex on them.
    pin_vertices: tuple[Int[np.ndarray, " _"], ...]
    kind: str  # "aligned" or "delaunay"
    # for each hole of the layout the vertices on its edge, in their order.
    hole_vertices: tuple[Int[np.ndarray, " _"], ...] = ()


def check_edge(layout: Layout, edge_mm: float) -> None:
    """Refuse an edge that is not a positive length, or that makes more triangles than memory holds."""
    if not (np.isfinite(edge_mm) and edge_mm > 0):
        raise MeshError(f"the mesh edge must be positive, got {edge_mm}")
    # equilateral triangles
    expected = abs(polygon_area(layout.outline)) / (np.sqrt(3) / 4 * float(edge_mm) ** 2)
    if not expected <= MAX_EXACT_TRIANGLES:
        count = f"about {expected:.2g} triangles, more than {MAX_EXACT_TRIANGLES}"
        raise MeshError(f"edges of {edge_mm:g} mm make {count}: use longer ones")


def checked(mesh: Mesh, layout: Layout, smallest_angle_deg: float) -> Mesh:
    """The mesh itself, if its triangles fill the sheet, are not too flat, and their edges follow the arms.

    Raises `MeshError`; the message names the condition that fails, and the place or the angle.
    """
    areas = triangle_areas(mesh.points, mesh.triangles)
    # of a sheet with a rim, the outline of the mesh has chords of its curves
    total = polygon_area(mesh.points[mesh.border_vertices] if layout.rim else layout.outline)
    total -= sum(abs(polygon_area(mesh.points[hole])) for hole in mesh.hole_vertices)
    if areas.min() <= 0 or abs(areas.sum() - total) > 1e-6 * total:
        raise MeshError("the mesh does not fill the sheet without overlaps")
    angle = float(triangle_angles(mesh.points, mesh.triangles).min())
    if angle < smallest_angle_deg:
        raise MeshError(f"the mesh has an angle of {angle:.1f} degrees, below {smallest_angle_deg:g}")
    n, t = len(mesh.points), mesh.triangles.T.astype(np.int64)
    edges = np.concatenate([n * np.minimum(t[k], t[k - 1]) + np.maximum(t[k], t[k - 1]) for k in range(3)])
    path = np.concatenate([np.zeros(0, dtype=np.int64), *mesh.rods])
    arm = np.repeat(np.arange(len(mesh.rods)), [len(rod) for rod in mesh.rods])
    rods = np.column_stack([path[:-1], path[1:]])[arm[1:] == arm[:-1]]
    off = ~is_in_sorted(np.sort(rods, axis=1) @ [n, 1], np.sort(edges))
    if off.any():
        x, y = mesh.points[rods[np.argmax(off), 0]]
        raise MeshError(f"the arm at ({x:.2f}, {y:.2f}) mm is not on edges of the mesh")
    return mesh
