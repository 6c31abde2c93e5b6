"""Supports and weight of a design as conditions and loads of the shell."""

from __future__ import annotations

import numpy as np
import scipy.sparse as sp
from skfem import MeshTri

from asterism.equilibrium.arrays import Floats, Ints
from asterism.fem.elements.deformation import affine
from asterism.fem.supports.conditions import Condition, EdgeSupport, PointSupport, vertices_at
from asterism.pattern.design.design import Design
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


def weight(design: Design, layout: Layout, weights: sp.csr_matrix, covered: Floats) -> Floats:
    """(n, 3) weight in N per printed mm^2; zero without gravity.

    Parameters
    ----------
    weights : (n, S) share of each star at n places.
    covered : (S,) mm^2, integral of the share of each star over the sheet, so that the total weight is that of the
        print.
    """
    gravity, fabric, plastic = design.gravity, design.fabric, design.plastic
    if not gravity.on:
        return np.zeros((weights.shape[0], 3))
    # mean of the product of two quantities that change linearly along the arm
    thickness, width = layout.arm_thickness, layout.arm_width
    section = thickness.mean(axis=1) * width.mean(axis=1) + np.diff(thickness)[:, 0] * np.diff(width)[:, 0] / 12.0
    volume = np.bincount(layout.arm_star, section * layout.arm_length, len(layout.centres))
    mass = fabric.printed_mass + 1e-9 * plastic.density_kg_m3 * (weights @ (volume / covered))
    direction = np.asarray(gravity.direction, dtype=float)
    return np.asarray(mass[:, None] * gravity.acceleration_m_s2 * direction / np.linalg.norm(direction))
