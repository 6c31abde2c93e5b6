"""Orders of convergence on a smooth solution, without corners and curved edges."""

from __future__ import annotations

import numpy as np

from asterism.equilibrium.arrays import Floats
from asterism.fem.elements.argyris import Argyris
from asterism.fem.supports.conditions import EdgeSupport
from asterism.fem.supports.loads import area_load
from tests.fem.meshes import rectangle
from tests.fem.plates import deflection

ORDERS = (6, 4)  # of the deflection and of the second derivatives, for polynomials of degree 5


def _bump(x: Floats) -> tuple[Floats, Floats, Floats, Floats]:
    """`sin^2(pi x)` and its derivatives of order 1, 2 and 4."""
    cosine, pi = np.cos(2.0 * np.pi * x), np.pi
    return 0.5 * (1.0 - cosine), pi * np.sin(2.0 * pi * x), 2.0 * pi**2 * cosine, -8.0 * pi**4 * cosine


def _load(points: Floats) -> Floats:
    """(n, 3) load `lap(lap w)` of the plate deflection `w = sin^2(pi x) sin^2(pi y)`."""
    (x, _, x2, x4), (y, _, y2, y4) = (_bump(points[:, i]) for i in (0, 1))
    return np.column_stack([0.0 * points, x4 * y + 2.0 * x2 * y2 + x * y4])


def _errors(space) -> list[float]:  # type: ignore[no-untyped-def]
    """Rms errors of deflection and second derivatives."""
    rim = EdgeSupport(space.mesh.boundary_facets(), clamped=True)
    heights = deflection(space, [rim], area_load(space, _load)[:, 2])
    table = space.tabulate(12)
    (x, x1, x2, _), (y, y1, y2, _) = (_bump(table.points[..., i]) for i in (0, 1))
    value = np.einsum("tqm,tm->tq", table.values, heights[table.dofs]) - x * y
    second = np.einsum("tqmc,tm->tqc", table.hessians, heights[table.dofs])
    second -= np.stack([x2 * y, x * y2, x1 * y1], axis=-1)
    squares = [value**2, second**2 @ [1.0, 1.0, 2.0]]
    return [float(np.sqrt((table.weights * square).sum())) for square in squares]


def test_clamped_plate_with_a_smooth_deflection() -> None:
    coarse = rectangle(2, 2, amount=0.2)
    errors = np.array([_errors(Argyris(coarse.refined(n))) for n in (1, 2)])
    assert (np.log2(errors[0] / errors[1]) > np.array(ORDERS) - 0.2).all()
