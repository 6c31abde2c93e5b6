"""The law of a preview to which none is given: the design's, the paper's, or the universal law."""

from __future__ import annotations

from asterism.previews.default_law import law_of
from homogenize.law.law import Law
from pattern.design.design import Design
from pattern.layout.layout import Layout


def serving_law(design: Design, plan: Layout | None = None) -> Law:
    """The law that a design names, or else the paper's, or else the universal law if that serves for its stars.

    Otherwise it is the paper's law, which refuses the design.

    Parameters
    ----------
    plan : layout of the design; computed if it is needed.

    Raises
    ------
    LawError
        The file that the design names is not a law.
    """
    law = law_of(design)
    if design.law_file is not None or law.fits(design):
        return law
    # most previews do without, and start sooner
    from asterism.previews.universal_choice import sizes_of_stars, universal_choice

    return universal_choice(design, sizes_of_stars(design, plan)).law or law
