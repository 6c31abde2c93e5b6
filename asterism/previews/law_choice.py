"""The law of a preview to which none is given: the design's, the paper's, or the universal law; and its mesh.

Beside an exact shape, the law is that of its mesh, or of an infinitely fine one.
"""

from __future__ import annotations

from functools import cache, lru_cache

from asterism.homogenize.errors import ForeignLaw, LawError
from asterism.homogenize.law.axes import law_coordinates
from asterism.homogenize.law.law import Law
from asterism.homogenize.law.law_file import load_law
from asterism.homogenize.law.mesh_edges import whole_edge
from asterism.pattern.design.design import Design
from asterism.pattern.layout.layout import Layout
from asterism.process.file_identity import file_identity


@cache
def paper_law() -> Law:
    """The law that comes with the package, read once."""
    return load_law()


def law_of(design: Design) -> Law:
    """The law that the section `[material]` of a design names, or else the paper's.

    A file is read again only if it has changed: the designs of a sweep name the same one.

    Raises
    ------
    LawError
        The file is not a law.
    UnreadableLaw
        The file is missing, or cannot be read.
    """
    if design.law_file is None:
        return paper_law()
    try:
        identity = file_identity(design.law_file)
    except OSError:
        return load_law(design.law_file)  # raises the error that names the file
    return _law_in(design.law_file, identity)


@lru_cache(maxsize=4)
def _law_in(path: str, identity: tuple[int, ...]) -> Law:
    return load_law(path)


def serving_law(design: Design, plan: Layout | None = None) -> Law:
    """The law that a design names, or else the paper's, or else the universal law if that serves for its stars.

    Parameters
    ----------
    plan : layout of the design; computed if it is needed.

    Raises
    ------
    ForeignLaw
        No law serves; the message says why neither the paper's nor the universal one does.
    LawError
        The file that the design names is not a law.
    """
    law = law_of(design)
    if design.law_file is not None:
        return law
    try:
        law.check(design)
    except ForeignLaw as error:
        # most previews do without, and start sooner
        from asterism.previews.universal_choice import sizes_of_stars, universal_choice

        choice = universal_choice(design, sizes_of_stars(design, plan))
        if choice.law is None:
            raise ForeignLaw(f"{error}; {choice.statement}", field=error.field) from None
        return choice.law
    except LawError:  # fabrics of this kind have no law, as the preview says
        pass
    return law


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
