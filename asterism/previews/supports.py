"""Supports of a design as conditions of the shell."""

from __future__ import annotations

import numpy as np
from skfem import MeshTri

from asterism.equilibrium.arrays import Ints
from asterism.fem.elements.deformation import affine
from asterism.fem.supports.conditions import Condition, EdgeSupport, PointSupport, vertices_at
from asterism.pattern.layout.layout import Layout
from asterism.pattern.mesh.sheet_mesh import SheetMesh


def conditions(layout: Layout, sheet: SheetMesh, mesh: MeshTri, step: int) -> list[Condition]:
    """Conditions of the shell from the pins that are active at a step.

    Parameters
    ----------
    layout : with the pins.
    sheet, mesh : the coarse mesh of the sheet, and the same mesh as a `MeshTri`.
    step : step of the release; later pins are not active yet.
    """
    active: list[Condition] = []
    facets = _facets(mesh, sheet.rim)
    for number, pin in enumerate(layout.pins):
        if not pin.is_active(step):
            continue
        directions, name = pin.directions, f"pins[{number}]"
        if len(pin.points):
            active.append(PointSupport(vertices_at(mesh, pin.points), pin.places(pin.points), directions, name))
        if pin.edges:
            placement, shift = affine(*pin.affine_motion), None if pin.curve is None else pin.curve.shift
            its = facets[np.isin(sheet.side, pin.edges)]
            active.append(EdgeSupport(its, placement, directions, shift=shift, name=name))
    return active


def _facets(mesh: MeshTri, pairs: Ints) -> Ints:
    """(R,) numbers of the edges between pairs (R, 2) of points of the mesh."""
    size = mesh.nvertices
    low, high = np.sort(mesh.facets, axis=0)
    codes = low * size + high
    order = np.argsort(codes)
    low, high = np.sort(pairs, axis=1).T
    return np.asarray(order[np.searchsorted(codes[order], low * size + high)])
