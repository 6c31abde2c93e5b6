"""The shape of a preview on the mesh that shows it, for every kind of pattern."""

from __future__ import annotations

import numpy as np

from asterism.equilibrium.arrays import Ints
from asterism.pattern.mesh.mesh import Mesh
from asterism.pattern.mesh.meshing import mesh_layout
from asterism.previews.places import Places
from asterism.previews.print_sheet import PrintSheet
from asterism.shape.shape import Shape
from asterism.shape.surface_fields import cell_fields


def mesh_to_show(sheet: PrintSheet, max_edge: float) -> Mesh:
    """The mesh of a preview's shape, with rods along its edges: the design's, or a coarser one if that is fine enough.

    Parameters
    ----------
    max_edge : the edge length is that of the design, but at least so many spacings.
    """
    design = sheet.design
    edge = max(design.mesh.edge_mm, max_edge * design.lattice.spacing_mm)
    return mesh_layout(sheet.layout, edge, design.mesh.kind, design.mesh.seed, draft=True)


def shape_on_mesh(
    sheet: PrintSheet, mesh: Mesh, places: Places, star: Ints, rod_fields: dict[str, np.ndarray]
) -> Shape:
    """The shape with bumps, without a summary.

    The field `bump_mm` holds the vectors from the smooth surface to the shape. Normals, curvatures and strains are
    those of the smooth surface.

    Parameters
    ----------
    star : (V,) number of the star of each vertex, -1 elsewhere.
    rod_fields : fields of the rod edges.
    """
    return Shape(
        printed=mesh.points,
        positions=places.bumpy,
        triangles=mesh.triangles,
        star=star,
        rods=mesh.rods,
        star_vertices=mesh.star_vertices,
        point_fields={
            "bump_mm": places.bumps,
            "normal": places.surface.normals,
            "mean_curvature_per_mm": places.surface.mean_curvature,
            "gaussian_curvature_per_mm2": places.surface.gaussian_curvature,
        },
        cell_fields=cell_fields(mesh.points, places.smooth, mesh.triangles, sheet.design.fabric.stretch_xy),
        rod_fields=rod_fields,
        held=bool(sheet.layout.pins),
        plan=sheet.layout,
    )
