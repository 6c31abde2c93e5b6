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
from asterism.previews.print_sheet import PrintSheet
from asterism.previews.sheet import Sheet

# prints that are kept, the last one used at the end: a fine sheet takes about 30 MB
KEPT_PRINTS = 2
# sheets with more triangles are not kept
MAX_KEPT_TRIANGLES = Sheet.most_triangles

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
    """The sheet of a design with its layout and law, on the mesh of a kept print if one serves; see `PrintSheet.of`.

    Raises
    ------
    MeshError
        The outline cannot be meshed.
    TypeError
        The law is not one of such a pattern.
    """
    kind: type[PrintSheet] = Sheet
    if design.rods is None:
        check_type(law, StarLaw, "load_law reads one from a file")
    else:
        check_type(law, MotifLaw, "load_law reads the law of a motif from its file")
        from asterism.previews.motifs.motif_sheet import MotifSheet as kind  # designs of stars do without it
    kept = kept_print(design, plan, triangles, model)
    return kind.of(design, plan, law, triangles, model) if kept is None else kept.with_pattern(design, plan, law)


def keep_print(sheet: PrintSheet) -> None:
    """Keep the print of a sheet in place of the one that was used least recently; very fine sheets are not kept."""
    if sheet.space.mesh.nelements <= MAX_KEPT_TRIANGLES:
        same = kept_print(sheet.design, sheet.layout, sheet.asked_triangles, sheet.model)
        _kept[:] = [*(each for each in _kept if each is not same), sheet][-KEPT_PRINTS:]


def kept_print(design: Design, plan: Layout, triangles: int | None, model: PreviewModel) -> PrintSheet | None:
    """The kept sheet with the mesh, elements and supported places that a preview of a design would have, or None."""
    alike = (each for each in reversed(_kept) if (triangles, model) == (each.asked_triangles, each.model))
    return next((each for each in alike if each.is_same_print(design, plan)), None)
