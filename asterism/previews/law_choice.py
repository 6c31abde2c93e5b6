"""The law of a preview to which none is given: the design's, the paper's, or the universal law."""

from __future__ import annotations

from functools import cache, lru_cache

from asterism.homogenize.errors import ForeignLaw, LawError
from asterism.homogenize.law.law import Law
from asterism.homogenize.law.law_file import load_law
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
