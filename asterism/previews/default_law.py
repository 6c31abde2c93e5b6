"""The law of a preview to which no other is given."""

from __future__ import annotations

from functools import cache

from homogenize.law.law import Law
from homogenize.law.law_file import load_law
from pattern.design.design import Design


@cache
def paper_law() -> Law:
    """The law that comes with the package, read once."""
    return load_law()


def law_of(design: Design) -> Law:
    """The law that the section `[material]` of a design names, or else the paper's.

    Raises
    ------
    LawError
        The file is not a law.
    """
    return paper_law() if design.law_file is None else load_law(design.law_file)
