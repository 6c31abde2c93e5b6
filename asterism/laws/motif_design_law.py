"""The law of a design whose pattern is a motif: from its file, or from cells that are solved now."""

from __future__ import annotations

from pathlib import Path
from shlex import quote

from asterism.homogenize.errors import ForeignLaw, LawError
from asterism.homogenize.law.motif_law import MotifLaw
from asterism.homogenize.law.motif_law_file import load_motif_law
from asterism.laws.design_law import chosen_law_path, design_law_path
from asterism.pattern.design.design import Design
from asterism.pattern.layout.print_layout import print_layout
from asterism.previews.motifs.serving_motif_law import serving_motif_law


def motif_law_for_design(
    design: Design,
    law: Path | None = None,
    file: Path | None = None,
    other: Path | None = None,
) -> MotifLaw:
    """The law in a file, if it fits the design; without a file the design's cells are solved.

    Parameters
    ----------
    law : None for the law that the design names; of designs that name none, the cells are solved.
    file, other : files of the design and of the material that replaces its own; for messages.

    Raises
    ------
    DesignError
        There is no law of such a design.
    LawError
        The file is not the law of a motif, or does not fit, and the message names the command that makes one; or the
        cells have no law, and the message has the reason.
    """
    path = chosen_law_path(design, law)
    if path is None:
        return serving_motif_law(design, print_layout(design))
    own = load_motif_law(path)
    try:
        own.check(design)
    except LawError as error:
        refused = str(error) if file is None else f"{file}: {error}"
        if isinstance(error, ForeignLaw):
            material = f" --material {quote(str(other))}" if other else ""
            refused += f" ({path})"
            if file is not None:
                refused += f"; asterism calibrate {quote(str(file))}{material} makes its law"
                refused += f", for --law {quote(str(design_law_path(file, other)))}"
        raise type(error)(refused, field=error.field) from None
    return own
