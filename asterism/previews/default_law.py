"""The law of a preview to which no other is given."""

from __future__ import annotations

from functools import cache, lru_cache

from asterism.homogenize.law.law import Law
from asterism.homogenize.law.law_file import load_law
from asterism.pattern.design.design import Design
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
