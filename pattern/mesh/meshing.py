"""The mesh of a layout: aligned with the lattice wherever that is possible, else constrained Delaunay."""

from __future__ import annotations

from typing import Literal

from asterism.pattern.design.errors import MeshError
from asterism.pattern.layout.layout import Layout
from asterism.pattern.mesh.aligned_mesh import aligned_mesh
from asterism.pattern.mesh.delaunay_mesh import delaunay_mesh
from asterism.pattern.mesh.graded_mesh import graded_mesh
from asterism.pattern.mesh.mesh import Mesh

MeshKind = Literal["auto", "aligned", "delaunay"]


def mesh_layout(
    layout: Layout,
    edge_mm: float,
    kind: MeshKind = "auto",
    seed: int = 0,
    graded: bool | Literal["aligned"] = False,
    draft: bool = False,
) -> Mesh:
    """Mesh the sheet with edges of about `edge_mm`; "auto" prefers the aligned mesh (`seed` is the Delaunay one's).

    `graded`: finer at the arms and their tips, with as many triangles; "aligned" only where the mesh is aligned.
    `draft`: good enough to look at, and faster; triangles may be flatter where features or the outline are close.
    """
    if kind not in ("auto", "aligned", "delaunay"):
        raise MeshError(f"the mesh kind must be auto, aligned or delaunay, got {kind!r}")
    if kind == "aligned" and layout.drawn is not None:
        raise MeshError("mesh.kind = 'aligned': drawn rods have no aligned mesh; delaunay and auto mesh every sheet")
    if kind == "aligned" and layout.holes:
        raise MeshError("mesh.kind = 'aligned': sheets with holes have none; delaunay and auto mesh every sheet")
    mesh = _even_mesh(layout, edge_mm, kind, seed, draft)
    return graded_mesh(mesh, layout, edge_mm) if graded in (True, mesh.kind) else mesh


def _even_mesh(layout: Layout, edge_mm: float, kind: MeshKind, seed: int, draft: bool) -> Mesh:
    if kind != "delaunay" and layout.drawn is None and not layout.holes:
        try:
            return aligned_mesh(layout, edge_mm, draft)
        except MeshError as error:
            if kind == "aligned":
                raise MeshError(f"mesh.kind = 'aligned': {error}; delaunay and auto mesh every sheet") from None
    return delaunay_mesh(layout, edge_mm, seed, draft)
