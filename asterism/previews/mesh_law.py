"""The law of a preview on the mesh of the exact model that it is compared with, and on an infinitely fine one."""

from __future__ import annotations

from asterism.homogenize.errors import LawError
from asterism.homogenize.law.axes import law_coordinates
from asterism.homogenize.law.law import Law
from asterism.homogenize.law.mesh_edges import whole_edge
from asterism.pattern.design.design import Design
from asterism.pattern.layout.layout import Layout

LIMIT = 0.0


def law_on_mesh(law: Law, design: Design, plan: Layout, edge_mm: float) -> Law:
    """The law on meshes of an edge length.

    Parameters
    ----------
    plan : layout of the design.
    edge_mm : 0 for the limit of an infinitely fine mesh.

    Raises
    ------
    LawError
        The law has no cells of this edge for the stars of the design; the message says which edges or stars it covers.
    """
    if has_edge(law, edge_mm):
        return law
    sizes = law_coordinates(plan, design.lattice.arms)
    covered = law.check(design)(*sizes.T).inside
    other = law.at_edge(edge_mm)
    missing = covered & ~other.check(design)(*sizes.T).inside
    if missing.any():
        which = f"{int(missing.sum())} of {len(sizes)} stars"
        if edge_mm == LIMIT:
            raise LawError(f"no limit for {which}: their cells show no order, or cells of other edges are missing")
        raise LawError(f"no cells with edges of {edge_mm:g} mm for {which}", field="mesh.edge_mm")
    return other


def law_of_exact_mesh(law: Law, design: Design, plan: Layout) -> Law:
    """The law on meshes of the design's edge length if it has cells of it, or else the law as it is."""
    try:
        return law_on_mesh(law, design, plan, design.mesh.edge_mm)
    except LawError:
        return law


def has_edge(law: Law, edge_mm: float) -> bool:
    """Whether the law is for meshes of this edge length, rounded to a whole number of edges between two stars."""
    spacing = law.material.lattice.spacing_mm
    return whole_edge(law.edge_mm, spacing) == whole_edge(edge_mm, spacing)
