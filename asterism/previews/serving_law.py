"""The law of a preview to which none is given: the design's, the paper's, or the universal law."""

from __future__ import annotations

from asterism.homogenize.errors import ForeignLaw, LawError
from asterism.homogenize.law.law import Law
from asterism.pattern.design.design import Design
from asterism.pattern.layout.layout import Layout
from asterism.previews.default_law import law_of


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
