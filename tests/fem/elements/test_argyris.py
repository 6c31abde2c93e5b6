"""Argyris triangles: exact for their polynomials, C1, and well conditioned at any place; which meshes they take."""

from __future__ import annotations

import numpy as np
import pytest
from skfem import MeshTri, MeshTri2

from asterism.equilibrium.arrays import Floats
from asterism.fem.elements.argyris import POWERS, Argyris, checked_mesh, monomials
from tests.fem.meshes import rectangle

ORDERS = np.array([0, 1, 1, 2, 2, 2])
FAR = np.array([1.0e4, -2.0e4])  # mm


def far_sheet() -> MeshTri:
    """260 mm wide, irregular, far from the origin."""
    mesh = MeshTri.init_symmetric().refined(2)
    points = mesh.p.copy()
    inner = mesh.interior_nodes()
    points[:, inner] += np.random.default_rng(0).uniform(-0.04, 0.04, (2, len(inner)))
    return MeshTri(260.0 * points + FAR[:, None], mesh.t)


class Polynomial:
    """A map into space of total degree 5, with its derivatives."""

    def __init__(self, size: float) -> None:
        self.factors = np.random.default_rng(1).standard_normal((3, len(POWERS)))
        self.size = size

    def jet(self, points: Floats) -> Floats:
        """(n, 3, 6)."""
        table = monomials((points - FAR) / self.size - 0.5) / self.size**ORDERS
        return np.einsum("nka,ck->nca", table, self.factors)


def test_polynomials_are_interpolated_exactly() -> None:
    polynomial = Polynomial(260.0)
    element = Argyris(far_sheet())
    x = element.interpolate(lambda p: np.swapaxes(polynomial.jet(p), 1, 2))
    points = FAR + 260.0 * np.random.default_rng(2).uniform(0.0, 1.0, (100, 2))
    at, jet = element.locate(points), polynomial.jet(points)
    assert np.abs(at.value @ x - jet[..., 0]).max() < 1e-11 * np.abs(jet[..., 0]).max()
    assert np.abs(at.jets(x) - np.swapaxes(jet, 1, 2)).max() < 1e-11 * np.abs(jet).max()
    table = element.tabulate(6)
    values = np.einsum("tqm,tmc->tqc", table.values, x[table.dofs])
    assert np.allclose(values, polynomial.jet(table.points.reshape(-1, 2))[..., 0].reshape(values.shape), atol=1e-11)
    assert table.weights.sum() == pytest.approx(260.0**2, rel=1e-13)
    # a point just outside continues the polynomial
    corner = (FAR - 0.5)[None]
    assert np.allclose(element.locate(corner).value @ x, polynomial.jet(corner)[..., 0], atol=1e-11)


def test_gradients_do_not_jump() -> None:
    mesh = far_sheet()
    element = Argyris(mesh)
    x = np.random.default_rng(3).standard_normal(element.size)
    inner = mesh.f2t[1] >= 0
    ends = mesh.p.T[mesh.facets[:, inner]]
    for w in (0.11, 0.5, 0.83):
        points = (1.0 - w) * ends[0] + w * ends[1]
        (one, a), (other, b) = (element.jets(side[inner], points) for side in mesh.f2t)
        left, right = np.einsum("nm,nma->na", x[one], a), np.einsum("nm,nma->na", x[other], b)
        assert np.abs(left - right)[:, :3].max() < 1e-11 * np.abs(left).max()
        assert np.abs(left - right)[:, 3:].max() > 1e-6 * np.abs(left[:, 3:]).max()  # C1, not C2


def test_condition_number_does_not_depend_on_place_or_unit() -> None:
    numbers = [
        np.linalg.cond(Argyris(MeshTri(far_sheet().p * scale, far_sheet().t))._functionals()).max()
        for scale in (1.0, 1e-3, 1e3)
    ]
    assert max(numbers) < 1e4
    assert np.ptp(numbers) < 1e-3 * max(numbers)


def test_a_point_outside_is_refused_with_its_coordinates() -> None:
    element = Argyris(far_sheet())
    with pytest.raises(ValueError, match=r"\(9000, -20000\) is outside"):
        element.locate(np.array([FAR + 1.0, [9000.0, -20000.0]]))


SQUARE = rectangle(2, 2, amount=0.2)
AWAY = np.array([[5.0], [5.0]])


def with_nan() -> MeshTri:
    points = SQUARE.p.copy()
    points[0, 4] = np.nan
    return MeshTri(points, SQUARE.t)


@pytest.mark.parametrize(
    ("mesh", "word"),
    [
        (lambda: MeshTri2.from_mesh(SQUARE), "straight"),
        (lambda: MeshTri(SQUARE.p, np.empty((3, 0), dtype=int)), "no triangles"),
        (with_nan, "not finite"),
        (lambda: MeshTri(np.hstack([SQUARE.p, AWAY]), SQUARE.t), "vertex 9 belongs to no triangle"),
        (lambda: MeshTri(np.array([[0, 1, 2, 0.0], [0, 0, 0, 1.0]]), np.array([[0, 1, 2], [0, 2, 3]]).T), "no area"),
        (lambda: MeshTri(SQUARE.p, np.hstack([SQUARE.t, SQUARE.t[:, :1]])), "more than two"),
        (lambda: MeshTri(np.hstack([SQUARE.p, SQUARE.p + AWAY]), np.hstack([SQUARE.t, SQUARE.t + 9])), "2 pieces"),
    ],
    ids=["curved", "empty", "nan", "unused", "flat", "crowded", "pieces"],
)
def test_invalid_meshes_are_refused(mesh, word: str) -> None:
    with pytest.raises(ValueError, match=f"^mesh: .*{word}"):
        checked_mesh(mesh())
