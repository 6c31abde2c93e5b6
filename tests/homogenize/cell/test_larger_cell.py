"""Which motifs have a law of one cell."""

from __future__ import annotations

import numpy as np
import pytest

from asterism.homogenize.cell.flat_cell import relax_flat_cell
from asterism.homogenize.cell.motif_responses import CellComparison, compare_with_larger_cell
from asterism.homogenize.cell.unit_cell import UnitCell
from tests.homogenize.motifs import Pattern, diamonds, grid, honeycomb, motif_design, parallel, stars, waves


def compared(pattern: Pattern) -> CellComparison:
    design = motif_design(pattern)
    return compare_with_larger_cell(design, 2.5, relax_flat_cell(UnitCell(design, 2.5)))


@pytest.mark.slow
@pytest.mark.parametrize("pattern", [parallel(), grid(), diamonds(), waves(), stars()])
def test_lines_grids_waves_and_stars_repeat_cell_by_cell(pattern: Pattern) -> None:
    comparison = compared(pattern)
    assert comparison.reason is None
    assert abs(comparison.excess) < 1e-6
    np.testing.assert_allclose(comparison.larger_stretches, comparison.stretches, atol=1e-5)


@pytest.mark.slow
def test_a_connected_honeycomb_has_no_law_of_one_cell() -> None:
    comparison = compared(honeycomb())
    assert comparison.excess > 0.1 and comparison.reason is not None
    assert comparison.stretches.min() > 0.99 and comparison.larger_stretches.min() < 0.8
    assert comparison.reason is not None
    assert comparison.reason.startswith("the motif has no law of one cell: 2 x 2 cells relax to ")
