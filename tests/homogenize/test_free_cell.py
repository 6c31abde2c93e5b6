"""Cells on free meshes, beside the checks of `cell/test_cell.py`; both meshes of a star against each other."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from scipy.linalg import block_diag

from asterism.homogenize.cell.flat_cell import FlatCell, relax_flat_cell
from asterism.homogenize.cell.natural_curvature import trace_tubes
from asterism.homogenize.cell.sample import solve_cell
from asterism.homogenize.cell.unit_cell import UnitCell
from asterism.pattern.design.design import Design
from asterism.pattern.design.lattice import DEFAULT_SPACING_MM
from tests.homogenize.cells import EDGE, design, shaken
from tests.homogenize.linear_cell import effective_stiffness
from tests.homogenize.stability import cell_stability, unfolded_hessian


def test_elements_with_two_images_of_one_point() -> None:
    """On the coarsest meshes; the Hessian against that of the unfolded points, folded by a matrix."""
    cell = UnitCell(design(7.0, 0.4, lattice={"arms": 5, "orientation_deg": 7}, fabric={"bending": "consistent"}), 6.5)
    torus, rods = cell.mesh, len(cell.edges)
    assert any(len(np.unique(row)) < len(row) for part in cell.parts.values() for row in part.dofs)
    cell.set_release(0.6)
    cell.set_flat()
    state = shaken(cell, cell.printed_state(), 0.1)
    fold = np.zeros((len(torus.base), torus.n_base + 2))
    fold[np.arange(len(torus.base)), torus.base] = 1.0
    fold[:, torus.n_base :] = torus.image
    fold = block_diag(np.kron(fold, np.eye(3)), np.eye(rods))
    whole = (fold.T @ unfolded_hessian(cell, state).toarray() @ fold)[np.ix_(cell.free, cell.free)]
    found = cell.pattern.full(cell.hessian(state, 0.0)).toarray()
    np.testing.assert_allclose(found, whole, atol=1e-11 * np.abs(whole).max())


@pytest.mark.slow
@pytest.mark.parametrize("lattice", [{"arms": 5}, {"arms": 8, "kind": "square"}, {"orientation_deg": 20}])
def test_without_arms_it_is_the_fabric(lattice: dict[str, Any]) -> None:
    """Also next to the points where arms would be: those of short ones stay in the mesh."""
    bare = solve_cell(design(0.0, lattice=lattice), EDGE, (0.0, 0.5))
    np.testing.assert_allclose(bare.rest_metric, 1.35**-2 * np.eye(2), atol=1e-9)
    assert bare.lam == pytest.approx(1.0 / 1.35, abs=1e-8)
    np.testing.assert_array_equal(bare.natural_curvature, 0.0)
    short = relax_flat_cell(UnitCell(design(1.0, 0.2, lattice=lattice), EDGE)).stretch
    assert 0.0 < short - bare.lam < 0.01


@pytest.mark.slow
@pytest.mark.parametrize(("length", "lattice"), [(7.0, {"arms": 5}), (6.0, {"arms": 8, "kind": "square"}),
                                                 (10.0, {"orientation_deg": 10})])  # fmt: skip
def test_stars_in_any_direction_have_equilibria(length: float, lattice: dict[str, Any]) -> None:
    """A flat one, a stable natural tube, curled with the plastic outside, and a stiffness."""
    cell = UnitCell(design(length, 0.4, lattice=lattice), EDGE)
    flat = relax_flat_cell(cell)
    assert 1.0 / 1.35 < flat.stretch < 1.0
    assert flat.bump[0] > 0.0
    natural = trace_tubes(cell, flat, 0.2).natural
    assert natural is not None and natural.curvature > 0.0
    cell.set_tube(natural.curvature, 0.2)
    eigenvalues = cell_stability(cell, natural.state)
    assert eigenvalues.cell > 0.0 and eigenvalues.supercell > 0.0
    stiffness = effective_stiffness(cell, flat).stiffness
    assert np.linalg.eigvalsh(stiffness[:3, :3])[0] > 0.0


@pytest.mark.parametrize("thickness", [pytest.param(0.4, marks=pytest.mark.slow), 0.6])
def test_free_and_aligned_meshes_agree(monkeypatch: pytest.MonkeyPatch, thickness: float) -> None:
    """Three-armed stars, edges of 1.92 mm: within what another mesh makes of it."""
    star = design(10.0, thickness)
    aligned = solve_cell(star, 1.92, (0.0, np.pi / 6))
    monkeypatch.setattr("asterism.homogenize.cell.unit_cell.aligned_lines", lambda lattice: None)
    free = solve_cell(star, 1.92, (0.0, np.pi / 6))
    assert free.lam == pytest.approx(aligned.lam, rel=2e-3)
    np.testing.assert_allclose(free.natural_curvature, aligned.natural_curvature, rtol=0.04)
    np.testing.assert_allclose(free.bending, aligned.bending, rtol=0.06)


COARSE_EDGE = 5.0


def flat(size: float, stiff: float) -> FlatCell:
    """Of a cell with `size` times the paper's lengths and `stiff` times its moduli."""
    data = {
        "fabric": {"thickness_mm": 0.8 * size, "modulus_mpa": 7.1875 * stiff},
        "lattice": {"spacing_mm": size * float(DEFAULT_SPACING_MM)},
        "stars": {"length_mm": 8.5 * size, "thickness_mm": 0.3 * size, "width_mm": 1.2 * size},
        "border": {"rings": 0, "tip_margin_mm": 0.5 * size},
    }
    return relax_flat_cell(UnitCell(Design.from_dict(data), COARSE_EDGE * size))


@pytest.mark.slow
@pytest.mark.parametrize("size, stiff", [(8.0, 1.0), (1.0, 1e4), (0.3, 1e-3)])
def test_a_cell_of_every_size_and_stiffness_is_the_paper_s(size: float, stiff: float) -> None:
    one, other = flat(1.0, 1.0), flat(size, stiff)
    assert one.bump[0] > 0.0
    assert other.bump == pytest.approx(size * one.bump, rel=1e-6)
    assert other.energy == pytest.approx(stiff * size * one.energy, rel=1e-8)
    np.testing.assert_allclose(other.deformation, one.deformation, atol=1e-8)
    assert abs(other.iterations - one.iterations) <= 2
