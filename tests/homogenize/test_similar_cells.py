"""Similar cells have similar answers, found in as many steps: a millimetre is no length of its own, nor an MPa."""

from __future__ import annotations

import numpy as np
import pytest

from asterism.homogenize.cell.flat_cell import FlatCell, relax_flat_cell
from asterism.homogenize.cell.unit_cell import UnitCell
from asterism.pattern.design.design import Design
from asterism.pattern.design.lattice import DEFAULT_SPACING_MM

EDGE = 5.0


def flat(size: float, stiff: float) -> FlatCell:
    """Of a cell with `size` times the paper's lengths and `stiff` times its moduli."""
    data = {
        "fabric": {"thickness_mm": 0.8 * size, "modulus_mpa": 7.1875 * stiff},
        "lattice": {"spacing_mm": size * float(DEFAULT_SPACING_MM)},
        "stars": {"length_mm": 8.5 * size, "thickness_mm": 0.3 * size, "width_mm": 1.2 * size},
        "border": {"rings": 0, "tip_margin_mm": 0.5 * size},
    }
    return relax_flat_cell(UnitCell(Design.from_dict(data), EDGE * size))


@pytest.mark.slow
@pytest.mark.parametrize("size, stiff", [(8.0, 1.0), (1.0, 1e4), (0.3, 1e-3)])
def test_a_cell_of_every_size_and_stiffness_is_the_paper_s(size: float, stiff: float) -> None:
    one, other = flat(1.0, 1.0), flat(size, stiff)
    assert one.bump[0] > 0.0
    assert other.bump == pytest.approx(size * one.bump, rel=1e-6)
    assert other.energy == pytest.approx(stiff * size * one.energy, rel=1e-8)
    np.testing.assert_allclose(other.deformation, one.deformation, atol=1e-8)
    assert abs(other.iterations - one.iterations) <= 2
