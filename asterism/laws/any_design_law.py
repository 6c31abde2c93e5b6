"""The law of a design of any kind: of its stars, or of the motif of its drawn rods."""

from __future__ import annotations

from pathlib import Path

from asterism.homogenize.errors import ForeignLaw
from asterism.homogenize.law.any_law import AnyLaw
from asterism.homogenize.law.motif_law_file import is_motif_law
from asterism.laws.design_law import chosen_law_path, law_for_design
from asterism.pattern.design.design import Design


def any_law_for_design(design: Design, law: Path | None, file: Path, other: Path | None = None) -> AnyLaw | None:
    """The law of a preview, as `law_for_design`; None for a motif whose cells the preview solves by itself.

    Raises
    ------
    LawError
        The file is not a law, or the law does not fit; the message names the command that makes one.
    """
    path = chosen_law_path(design, law)
    if design.rods is None:
        return law_for_design(design, law, file, other)
    if path is None:
        return None
    if path.is_file() and not is_motif_law(path):
        raise ForeignLaw(f"{file}: {path}: is a law of stars, not of the motif of drawn rods", field="rods.motif")
    from asterism.laws.motif_design_law import motif_law_for_design  # it loads the exact model, for cells of motifs

    return motif_law_for_design(design, law, file, other)
