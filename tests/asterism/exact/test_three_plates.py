"""Sheets with the bending stiffness of three plates have the shape of the hinges; those with one plate have not."""

from __future__ import annotations

import pytest

from benchmarks.three_plates import compared


@pytest.mark.slow
def test_three_plates_are_the_papers_hinges() -> None:
    row = compared("7 stars, free", 2.0)
    assert row["minima"]
    assert row["three plates"] < 2.0 < row["one plate"]
