"""The exact model on the unfolded points of a cell, with the hinges of the closed mesh."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from asterism.discrete.energies.bending.fabric_bending import BendingMesh
from asterism.discrete.energies.bending.registry import FABRIC_BENDING, NO_BENDING
from asterism.discrete.model.discrete_model import DiscreteModel
from asterism.equilibrium.arrays import Floats
from asterism.homogenize.cell.cell_mesh import star_size
from asterism.homogenize.cell.periodic_mesh import PeriodicMesh
from asterism.pattern.design.design import Design
from asterism.pattern.layout.layout import Layout
from asterism.pattern.mesh.mesh import Mesh
from asterism.pattern.rods.graph import RodGraph

if TYPE_CHECKING:
    from asterism.pattern.rods.motif_graph import MotifGraph


def unfolded_model(design: Design, torus: PeriodicMesh, motif: MotifGraph | None) -> DiscreteModel:
    """All energies of the design, on the points that the elements of a periodic mesh use.

    Parameters
    ----------
    motif : the rods of one cell; None for stars.

    Raises
    ------
    ValueError
        The stars differ, or gravity is on.
    """
    if design.gravity.on:
        raise ValueError("a cell has no weight: an endless sheet would fall")
    layout = _stars(design, torus) if motif is None else _rods(design, torus, motif)
    none = np.empty(0, dtype=np.int64)
    mesh = Mesh(torus.points, torus.triangles, torus.rods, torus.star_vertices, none, (), "aligned")
    fabric = design.fabric
    unbent = design.model_copy(update={"fabric": fabric.model_copy(update={"bending": NO_BENDING.name})})
    model = DiscreteModel(unbent, layout, mesh)
    model.bending = FABRIC_BENDING[fabric.bending]
    model.parts |= model.bending.build(
        BendingMesh(torus.triangles, torus.points, torus.hinges, torus.around), model.fabric_plate
    )
    model.set_release(1.0)  # the parts that were added are those of the print so far
    return model


def _stars(design: Design, torus: PeriodicMesh) -> Layout:
    tips = torus.points[[rod[-1] for rod in torus.rods]]
    ends = np.ones((len(tips), 2))
    sizes = star_size(design, "thickness_mm") * ends, star_size(design, "width_mm") * ends
    return _layout(design, torus.points[torus.star_vertices], torus, tips, *sizes)


def _rods(design: Design, torus: PeriodicMesh, motif: MotifGraph) -> Layout:
    """Each rod in its unfolded piece. Nodes at which rods end are joints, though their other rods may be images."""
    none = np.empty((0, 2))
    ends = np.array([[path[0], path[-1]] for path in torus.rods])
    vertices, node = np.unique(ends, return_inverse=True)
    at_base = np.bincount(torus.base[ends].ravel(), minlength=torus.n_base)
    rods = tuple(
        replace(
            source, points=source.points + (torus.points[path[0]] - source.points[0]), start=int(start), end=int(end)
        )
        for path, source, (start, end) in zip(
            torus.rods,
            motif.rods * (len(torus.rods) // len(motif.rods)),
            node.reshape(-1, 2),
            strict=True,
        )
    )
    bonded = np.flatnonzero(at_base[torus.base[vertices]] > 1)
    graph = RodGraph(torus.points[vertices], rods, bonded=bonded)
    return replace(_layout(design, none, torus, none, none, none), drawn=graph)


def _layout(
    design: Design, centres: Floats, torus: PeriodicMesh, tips: Floats, thickness: Floats, width: Floats
) -> Layout:
    return Layout(
        outline=np.empty((0, 2)),
        centres=centres,
        arm_star=torus.arm_star,
        arm_tip=tips,
        arm_thickness=thickness,
        arm_width=width,
        neighbours=np.empty((0, 2), dtype=np.int64),
        pins=(),
        lattice_vectors=np.asarray(design.lattice.vectors),
        lattice_origin=np.zeros(2),
    )
