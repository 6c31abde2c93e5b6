"""The sheet of a design: that of one of the last prints in this process, with another pattern, or a new one.

Sweeps, fits and reports preview one print many times. Mesh, elements, supports and the triangles that are shown depend
on the print alone.
"""

from __future__ import annotations

from typing import Any

from asterism.homogenize.law.motif_law import MotifLaw
from asterism.homogenize.law.plan import without_law
from asterism.homogenize.law.star_law import StarLaw
from asterism.pattern.design.arguments import check_type
from asterism.pattern.design.design import Design
from asterism.pattern.layout.build import layout
from asterism.pattern.layout.layout import Layout
from asterism.previews.model import PreviewModel
from asterism.previews.print_sheet import MAX_TRIANGLES, PrintSheet
from asterism.previews.sheet import sheet_of

# prints that are kept: a fine sheet takes about 30 MB
KEPT_PRINTS = 2

_kept: list[PrintSheet] = []


def preview_layout(design: Design) -> Layout:
    """The layout of a design that has a preview.

    Raises
    ------
    DesignError
        The design cannot be printed; or its lines have no law, which is found before anything is computed.
    TypeError
        `design` is not a `Design`.
    """
    check_type(design, Design, "load_design reads one from a file")
    if design.rods is not None and (refused := without_law(design)) is not None:
        raise refused
    return layout(design)


def sheet_for(design: Design, plan: Layout, law: Any, triangles: int | None, model: PreviewModel) -> PrintSheet:
    """The sheet of a design with its layout and law, on the mesh of a kept print if one serves.

    Parameters
    ----------
    triangles : approximate number of triangles of the shell's mesh; None for the default.

    Raises
    ------
    MeshError
        The outline cannot be meshed.
    TypeError
        The law is not one of such a pattern.
    """
    if design.rods is None:
        check_type(law, StarLaw, "load_law reads one from a file")
    else:
        check_type(law, MotifLaw, "load_law reads the law of a motif from its file")
    if (kept := kept_print(design, plan, triangles, model)) is not None:
        return kept.with_pattern(design, plan, law)
    if design.rods is None:
        return sheet_of(design, plan, law, triangles, model)
    from asterism.previews.motifs.motif_sheet import motif_sheet_of  # designs of stars do without it

    return motif_sheet_of(design, plan, law, triangles, model)


def keep_print(sheet: PrintSheet) -> None:
    """Keep the print of a sheet in place of the one that was used least recently; very fine sheets are not kept."""
    if sheet.space.mesh.nelements <= MAX_TRIANGLES:
        same = kept_print(sheet.design, sheet.layout, sheet.asked_triangles, sheet.model)
        _kept[:] = [*(each for each in _kept if each is not same), sheet][-KEPT_PRINTS:]


def kept_print(design: Design, plan: Layout, triangles: int | None, model: PreviewModel) -> PrintSheet | None:
    """The kept sheet with the mesh, elements and supported places that a preview of a design would have, or None."""
    for sheet in reversed(_kept):
        if (triangles, model) == (sheet.asked_triangles, sheet.model) and sheet.is_same_print(design, plan):
            return sheet
    return None


def forget_prints() -> None:
    """Forget all prints, so that the next preview computes everything."""
    _kept.clear()
