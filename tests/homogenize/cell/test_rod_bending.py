"""The bending of rods in closed form, and the part of a cell's bending that depends on where the cell is cut."""

from __future__ import annotations

import numpy as np
import pytest

from asterism.homogenize.cell.flat_cell import relax_flat_cell
from asterism.homogenize.cell.motif_responses import GAUSSIAN, completed_by_rods, rod_bending
from asterism.homogenize.cell.unit_cell import UnitCell
from tests.homogenize.cell.test_motif_cell import recut
from tests.homogenize.cell.test_motif_closed_forms import stiff
from tests.homogenize.cells import cell_of, relaxed_cell
from tests.homogenize.linear_cell import effective_stiffness
from tests.homogenize.motifs import Pattern, diamonds, parallel


@pytest.mark.slow
@pytest.mark.parametrize("pattern", [parallel(5.0), diamonds()], ids=["lines", "diamonds"])
def test_rods_in_fabric_too_soft_to_count_are_the_linear_cell(pattern: Pattern) -> None:
    """In all entries: the fabric has no tension, so that the cell can be cut anywhere."""
    design = stiff(pattern)
    cell = UnitCell(design, 1.5)
    flat = relax_flat_cell(cell)
    expected = effective_stiffness(cell, flat).stiffness[3:, 3:]
    np.testing.assert_allclose(rod_bending(design, flat.deformation), expected, atol=0.012 * expected.max())


@pytest.mark.slow
@pytest.mark.parametrize("name", ["grid", "diamonds"])
def test_the_work_of_gaussian_curvature_depends_on_the_cut_and_nothing_else_does(name: str) -> None:
    """Rods of a tense cell that stand for images elsewhere: another multiple of det K, the same tubes."""
    cell, flat = relaxed_cell(name)
    mesh = cell.mesh
    points = np.zeros((mesh.n_base, 2), dtype=np.int64)
    rods = np.random.default_rng(2).integers(-2, 3, size=(len(mesh.rods), 2))
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr("asterism.homogenize.cell.free_cell_mesh.motif_cell_mesh", lambda *_: recut(mesh, points, rods))
        other = cell_of(name)
    here, there = (
        effective_stiffness(one, state).stiffness for one, state in ((cell, flat), (other, relax_flat_cell(other)))
    )
    part = there[3:, 3:][0, 1] - here[3:, 3:][0, 1]
    assert abs(part) > here[3, 3]
    changed = np.zeros((6, 6))
    changed[3:, 3:] = part * GAUSSIAN
    np.testing.assert_allclose(there - here, changed, atol=1e-4 * np.abs(here).max())
    alone = rod_bending(cell.design, flat.deformation)
    bending = [completed_by_rods(each[3:, 3:], alone) for each in (here, there)]
    np.testing.assert_allclose(bending[0], bending[1], atol=1e-3 * bending[0].max())
    assert np.linalg.eigvalsh(bending[0])[0] > 0.0
