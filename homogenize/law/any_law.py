"""A law from its file, of stars or of a motif: the kind is in the file."""

from __future__ import annotations

from pathlib import Path
from typing import TypeAlias

from asterism.homogenize.law.law import Law
from asterism.homogenize.law.law_file import law_digest, load_law
from asterism.homogenize.law.motif_law import MotifLaw
from asterism.homogenize.law.motif_law_file import is_motif_law, load_motif_law, motif_law_digest

AnyLaw: TypeAlias = Law | MotifLaw


def load_any_law(path: str | Path) -> AnyLaw:
    """The law in a file.

    Raises
    ------
    LawError, UnreadableLaw
        As of `load_law`.

    Examples
    --------
    >>> from asterism.homogenize.law.law_file import PAPER_LAW
    >>> type(load_any_law(PAPER_LAW)).__name__
    'Law'
    """
    return load_motif_law(path) if is_motif_law(path) else load_law(path)


def any_law_digest(law: AnyLaw) -> str:
    """Hash of a law, which does not depend on where and when it was computed."""
    return motif_law_digest(law) if isinstance(law, MotifLaw) else law_digest(law)
