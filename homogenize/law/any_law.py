"""A law from its file, of stars or of a motif: the kind is in the file."""

from __future__ import annotations

from pathlib import Path

from homogenize.law.law import Law
from homogenize.law.law_file import load_law
from homogenize.law.motif_law import MotifLaw
from homogenize.law.motif_law_file import is_motif_law, load_motif_law


def load_any_law(path: str | Path) -> Law | MotifLaw:
    """The law in a file.

    Raises
    ------
    LawError, UnreadableLaw
        As of `load_law`.

    Examples
    --------
    >>> from homogenize.law.law_file import PAPER_LAW
    >>> type(load_any_law(PAPER_LAW)).__name__
    'Law'
    """
    return load_motif_law(path) if is_motif_law(path) else load_law(path)
