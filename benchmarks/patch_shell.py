"""A patch of equal stars as a shell that has the responses of its cell: what of a patch is the sheet's size alone."""

from __future__ import annotations

import numpy as np
from skfem import MeshTri

from asterism.fem.elements.argyris import Argyris
from asterism.fem.search.relax import relax
from asterism.fem.search.simple_shapes import SimpleShape
from asterism.fem.shell.shell import QUADRATURE_ORDER, Shell
from asterism.homogenize.campaign.sample_rows import sample_quantities
from asterism.homogenize.cell.sample import Sample
from asterism.homogenize.law.law_table import QUANTITY_NAMES
from asterism.pattern.design.design import Design
from asterism.pattern.layout.build import layout
from asterism.pattern.mesh.coarse.sheet_mesh import sheet_mesh
from asterism.previews.fields.sheet_fields import sheet_fields
from asterism.previews.fields.star_cells import StarCells
from asterism.previews.fields.star_values import StarValues

EDGE = 15.0  # mm, of the shell's triangles
AXES = np.radians(15.0 * np.arange(12))


def shell_stars(design: Design, stars: Sample, bare: Sample) -> tuple[np.ndarray, bool]:
    """(S, 3) mm, places of the star centres, and whether the shape is a minimum.

    The rim beyond the stars' cells is bare fabric, as in a preview.
    """
    plan = layout(design)
    count = len(plan.centres)
    ours, fabric = (sample_quantities(sample.to_dict(), sample.stretch) for sample in (stars, bare))
    both = np.vstack([np.tile(ours, (count, 1)), fabric])
    none = np.empty(0)
    of_stars = {name: both[:, q] for q, name in enumerate(QUANTITY_NAMES)}
    alike = np.empty((count + 1, 0))
    values = StarValues(of_stars, none, none, (), (), (), (), none, none, of_stars["kappa"], alike)
    outline = sheet_mesh(plan.outline, EDGE)
    space = Argyris(MeshTri(outline.points.T.copy(), outline.triangles.T.copy()))
    points = space.tabulate(QUADRATURE_ORDER).points
    weights = StarCells(plan, design.lattice).shares(points.reshape(-1, 2))(np.full(count, stars.length_mm))
    shell = Shell(space, sheet_fields(weights, values, points.shape[:2]))
    kappa = float(stars.natural_curvature.mean())
    found = relax(shell, shapes=[SimpleShape("arc", -kappa, angle) for angle in AXES], soft_modes=0)
    at = space.locate(plan.centres)
    slope = (at.gradient @ found.x).reshape(count, 2, 3)
    normal = np.cross(slope[:, 0], slope[:, 1])
    normal /= np.linalg.norm(normal, axis=1, keepdims=True)
    return at.value @ found.x + float(stars.natural_centre_offset_mm.mean()) * normal, found.is_minimum
