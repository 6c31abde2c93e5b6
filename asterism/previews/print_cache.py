"""The prints of the last previews in this process, for further previews of the same print.

Sweeps, fits and reports preview one print many times. Mesh, elements, supports and the triangles that are shown depend
on the print alone.
"""

from __future__ import annotations

from dataclasses import dataclass

from asterism.pattern.design.design import Design
from asterism.pattern.layout.layout import Layout
from asterism.previews.kinds import serves
from asterism.previews.model import PreviewModel
from asterism.previews.places import ShownSheet
from asterism.previews.print_sheet import MAX_TRIANGLES, PrintSheet
from asterism.previews.state import AnyPreviewState

# prints that are kept: a fine sheet takes about 30 MB
KEPT_PRINTS = 2

_kept: list[KeptPrint] = []


@dataclass(frozen=True, eq=False)
class KeptPrint:
    """A print, without its equilibrium.

    Attributes
    ----------
    sheet : the print with its mesh.
    triangles : number of triangles that was asked for; None for the default.
    shown : triangles to show; None if no shape was asked for.
    """

    sheet: PrintSheet
    triangles: int | None
    shown: ShownSheet | None

    def serves(self, design: Design, plan: Layout, triangles: int | None, model: PreviewModel) -> bool:
        """Whether a preview of a design would have the same mesh, elements and supported places."""
        return (triangles, model) == (self.triangles, self.sheet.model) and serves(self.sheet, design, plan)

    def shown_on(self, sheet: PrintSheet) -> ShownSheet | None:
        """The triangles to show of a sheet of this print; None if they have to be computed."""
        return None if self.shown is None else self.shown.renewed(self.sheet, sheet)


def keep_print(state: AnyPreviewState, triangles: int | None) -> None:
    """Keep the print of a state in place of the one that was used least recently; very fine sheets are not kept."""
    if state.sheet.space.mesh.nelements > MAX_TRIANGLES:
        return
    new = KeptPrint(state.sheet, triangles, state.shown)
    others = [each for each in _kept if not each.serves(state.design, state.layout, triangles, state.model)]
    _kept[:] = [*others, new][-KEPT_PRINTS:]


def kept_print(design: Design, plan: Layout, triangles: int | None, model: PreviewModel) -> KeptPrint | None:
    """The kept print that serves a design; None if there is none."""
    return next((each for each in reversed(_kept) if each.serves(design, plan, triangles, model)), None)


def forget_prints() -> None:
    """Forget all prints, so that the next preview computes everything."""
    _kept.clear()
