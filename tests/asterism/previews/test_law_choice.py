"""The law that a design names."""

from __future__ import annotations

from pathlib import Path

import pytest

from asterism.homogenize.errors import LawError, UnreadableLaw
from asterism.homogenize.law.law_file import PAPER_LAW
from asterism.pattern.design.design import Design
from asterism.previews.law_choice import law_of


def test_a_file_is_read_again_only_after_a_change(tmp_path: Path) -> None:
    file = tmp_path / "own.npz"
    design = Design.from_dict({"stars": {"length_mm": 8.0}, "border": {"rings": 1}, "material": {"law": str(file)}})
    with pytest.raises(UnreadableLaw, match=r"own\.npz: cannot be read: No such file"):
        law_of(design)
    file.write_bytes(PAPER_LAW.read_bytes())
    law = law_of(design)
    assert law_of(design) is law
    file.write_bytes(b"damaged")
    with pytest.raises(LawError, match=r"own\.npz: is not a law, or damaged"):
        law_of(design)
    file.write_bytes(PAPER_LAW.read_bytes())
    assert law_of(design) is not law
