"""The discrete Hessian: exact for quadratics, and plates converge at the orders of the theory."""

import numpy as np
import pytest

from asterism.fem.supports.conditions import EdgeSupport
from tests.fem.lifted import Lifted
from tests.fem.meshes import rectangle
from tests.fem.plates import deflection, height, uniform_load


@pytest.mark.parametrize("degree", [2, 3])
def test_hessian_of_a_quadratic_is_exact_up_to_free_edges(degree: int) -> None:
    space = Lifted(rectangle(4, 4, amount=0.3), degree)
    table = space.tabulate(2)
    x, y = space.nodes.T
    u = np.column_stack([x**2, x * y, 2 * y**2 - x])
    hessian = np.einsum("tqmc,tmr->tqrc", table.hessians, u[table.dofs])
    expected = np.array([[2.0, 0, 0], [0, 0, 1], [0, 4, 0]])
    assert np.allclose(hessian, expected, atol=1e-11)
    assert np.abs(space.penalty() @ u).max() < 1e-11


@pytest.mark.parametrize("degree", [2, 3])
def test_hessian_satisfies_integration_by_parts(degree: int) -> None:
    """int H_11 p = int over the rim of n_1 d_1 u p - int d_1 u d_1 p, for p linear: inner edges drop out."""
    space = Lifted(rectangle(3, 3, amount=0.3), degree)
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


@pytest.mark.parametrize(("degree", "cells", "rate"), [(2, (4, 8, 16), 1.7), (3, (2, 4, 8), 3.5)])
def test_supported_plate_converges(degree: int, cells: tuple[int, ...], rate: float) -> None:
    """Timoshenko: w = 0.00406235 q L^4/D; the deflection converges twice as fast as the curvature: 2 (k - 1)."""
    errors = []
    for n in cells:
        space = Lifted(rectangle(n, n), degree)
        heights = deflection(space, [EdgeSupport(space.mesh.boundary_facets())], uniform_load(space))
        errors.append(abs(height(space, heights, 0.5, 0.5) / 0.00406235 - 1.0))
    assert np.log2(errors[-2] / errors[-1]) > rate


def test_a_wrong_degree_is_refused() -> None:
    with pytest.raises(ValueError, match="degree = 4: must be 2 or 3"):
        Lifted(rectangle(2, 2), 4)
