"""The discrete Hessian: exact where it should be, and plates bend at the rates the theory gives."""

import numpy as np
import pytest
import scipy.sparse as sp
from scipy.sparse.linalg import spsolve

from fem.lifted import Lifted
from tests.fem.meshes import jittered


@pytest.mark.parametrize("degree", [2, 3])
def test_hessian_of_a_quadratic_is_exact_up_to_free_edges(degree: int) -> None:
    space = Lifted(jittered(4, amount=0.3), degree)
    table = space.tabulate(2)
    u = space.interpolate(lambda p: np.column_stack([p[:, 0] ** 2, p[:, 0] * p[:, 1], 2 * p[:, 1] ** 2 - p[:, 0]]))
    hessian = np.einsum("tqmc,tmr->tqrc", table.hessians, u[table.dofs])
    expected = np.array([[2.0, 0, 0], [0, 0, 1], [0, 4, 0]])
    assert np.allclose(hessian, expected, atol=1e-11)
    assert np.abs(space.penalty() @ u).max() < 1e-11


@pytest.mark.parametrize("degree", [2, 3])
def test_hessian_weighs_jumps_as_integration_by_parts_does(degree: int) -> None:
    """int H_11 p = int over the rim of n_1 d_1 u p - int d_1 u d_1 p, for p linear: no edge inside is seen."""
    space = Lifted(jittered(3, amount=0.3), degree)
    table = space.tabulate(8)
    u = np.random.default_rng(0).normal(size=space.size)
    x, y = table.points[..., 0], table.points[..., 1]
    gradient = np.einsum("tqma,tm->tqa", table.gradients, u[table.dofs])
    hessian = np.einsum("tqmc,tm->tqc", table.hessians, u[table.dofs])
    weights = table.weights
    boundary = _rim_terms(space, u)
    for axis in (0, 1):
        # p = x_axis in the 11 component: int H_11 p = rim - int d_1 u delta
        p = (x, y)[axis]
        left = np.sum(weights * hessian[..., 0] * p)
        right = boundary[axis] - (np.sum(weights * gradient[..., 0]) if axis == 0 else 0.0)
        assert left == pytest.approx(right, rel=1e-10, abs=1e-10)


def _rim_terms(space: Lifted, u: np.ndarray) -> list[float]:
    """int over the rim of n_1 d_1 u x_axis for both axes, by Gauss points on every outer edge."""
    mesh, total = space.mesh, [0.0, 0.0]
    gauss, share = np.polynomial.legendre.leggauss(5)
    for facet in mesh.boundary_facets():
        a, b = mesh.p[:, mesh.facets[:, facet]].T
        points = a + 0.5 * (gauss[:, None] + 1.0) * (b - a)
        triangle = mesh.f2t[0, facet]
        centre = mesh.p[:, mesh.t[:, triangle]].mean(axis=1)
        normal = np.array([(b - a)[1], -(b - a)[0]])
        normal *= 0.5 * np.sign(normal @ (a - centre))
        dofs, jets = space.jets(np.full(5, triangle), points)
        slope = np.sum(jets[..., 1] * u[dofs], axis=1)
        for axis in (0, 1):
            total[axis] += np.sum(share * normal[0] * slope * points[:, axis])
    return total


def _plate(space: Lifted) -> float:
    """Middle of a unit square plate, D = 1, nu = .3, under q = 1, its rim at height 0."""
    table, nu = space.tabulate(2 * space.degree), 0.3
    law = np.array([[1, nu, 0], [nu, 1, 0], [0, 0, 2 * (1 - nu)]])
    blocks = np.einsum("tq,tqic,cd,tqjd->tij", table.weights, table.hessians, law, table.hessians)
    width = table.dofs.shape[1]
    rows, columns = np.repeat(table.dofs, width, axis=1), np.tile(table.dofs, width)
    matrix = sp.csr_matrix((blocks.ravel(), (rows.ravel(), columns.ravel())), shape=(space.size,) * 2)
    matrix = matrix + space.penalty()
    load = np.zeros(space.size)
    np.add.at(load, table.dofs, np.einsum("tq,tqm->tm", table.weights, table.values))
    inner = np.flatnonzero(np.all((space.nodes > 1e-12) & (space.nodes < 1 - 1e-12), axis=1))
    u = np.zeros(space.size)
    u[inner] = spsolve(matrix[inner][:, inner].tocsc(), load[inner])
    return float((space.locate(np.array([[0.5, 0.5]])).value @ u)[0])


@pytest.mark.parametrize(("degree", "rate"), [(2, 1.7), (3, 3.5)])
def test_supported_plate_converges(degree: int, rate: float) -> None:
    """Timoshenko: w = .00406235 q L^4/D; the middle converges twice as fast as the curvature: 2 (k - 1)."""
    errors = [abs(_plate(Lifted(jittered(n, amount=0.0), degree)) / 0.00406235 - 1) for n in (4, 8, 16)]
    if degree == 3:  # the reference has six digits
        errors = errors[:2]
    assert np.log2(errors[-2] / errors[-1]) > rate


def test_degree_is_named_when_it_is_wrong() -> None:
    with pytest.raises(ValueError, match="degree: 4 is not one of 2, 3"):
        Lifted(jittered(2), 4)
