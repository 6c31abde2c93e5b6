"""Drawings with groups, blocks and copies at random are read as by a reader that walks the tree."""

from __future__ import annotations

from pathlib import Path

import pytest

from benchmarks.fuzz.nested import difference, write_nested


@pytest.mark.slow
@pytest.mark.parametrize("first", [0, 40])
def test_nested_drawings_are_read_as_trees(first: int, tmp_path: Path) -> None:
    for seed in range(first, first + 40):
        assert difference(write_nested(seed, tmp_path)) == "", seed
