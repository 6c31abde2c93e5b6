"""Hinge bending of the fabric, the energy of the paper (Tamstorf and Grinspun 2013, rest angle zero).

`W = c (2 tan(theta/2))^2` with `c = k_B 3 |e|^2/(A1 + A2)` and `k_B = E h^3/(24 (1 - nu^2))`; there is no further
factor 1/2. A positive angle theta folds the two triangles to the side of their normals.

A second coefficient f adds `f (2 tan(theta/2))^4`. This term bounds sharp folds and vanishes on a fine mesh, where the
angles of a smooth sheet go to zero (`fold_coefficients`).

Derivatives. A triangle (x0, x1, p) has the unit normal n, edge direction `t = (x1 - x0)/|e|`, in-plane conormal
`m = n x t`, height h and foot fraction s of its apex. It rotates about the edge by `d(phi) = n . dq/h` with
`dq = dp - (1 - s) dx0 - s dx1`. Differentiating n, h and s gives the second variation. Its unsymmetric part, the
rotation of the edge's frame, cancels between the two triangles.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import cast

import numpy as np

from asterism.discrete.energies.bending.fabric_bending import FABRIC_BENDING, BendingMesh, FabricBending
from asterism.discrete.energies.elements import Elements
from asterism.discrete.energies.kernel import combine, cross, dot, formula, multiply, point, sub, sweep
from asterism.equilibrium.arrays import Array
from asterism.pattern.design.materials import BendingStiffness


@formula
def _triangle_geometry(x0, x1, p):  # type: ignore[no-untyped-def]
    """Unit normal, edge direction, conormal, edge length, height and foot fraction of a triangle."""
    e, d = sub(x1, x0), sub(p, x0)
    normal = cross(e, d)
    length, twice = np.sqrt(dot(e, e)), np.sqrt(dot(normal, normal))
    n, t = multiply(1.0 / twice, normal), multiply(1.0 / length, e)
    return n, t, cross(n, t), length, twice / length, dot(d, t) / length


@formula
def _half_angle_tangent(n_a, n_b, t):  # type: ignore[no-untyped-def]
    """`tan(theta/2)` from the unit normals on both sides of an edge of direction t."""
    return dot(cross(n_b, n_a), t) / (1.0 + dot(n_a, n_b))


@formula
def _energy_derivatives(p, tangent):  # type: ignore[no-untyped-def]
    """`dW/dtheta` and `d2W/dtheta2` from `tan(theta/2)`."""
    square = tangent * tangent
    slope = (1.0 + square) * tangent * (4.0 * p[0] + 32.0 * p[1] * square)
    bend = 2.0 * (1.0 + square) * (p[0] * (1.0 + 3.0 * square) + 8.0 * p[1] * square * (3.0 + 5.0 * square))
    return slope, bend


@formula
def hinge_energy(q, p):  # type: ignore[no-untyped-def]
    """Energy of a hinge in N mm: edge (x0, x1), apex x2 on its left and x3 on its right; p = (c, f)."""
    x0, x1, x2, x3 = point(q, 0), point(q, 1), point(q, 2), point(q, 3)
    n_a, t, _, _, _, _ = _triangle_geometry(x0, x1, x2)
    n_b, _, _, _, _, _ = _triangle_geometry(x1, x0, x3)
    tangent = _half_angle_tangent(n_a, n_b, t)
    square = 4.0 * tangent * tangent
    return square * (p[0] + p[1] * square)


@formula
def hinge_gradient(q, p, g):  # type: ignore[no-untyped-def]
    """`dW/dtheta` times the gradient of theta: normals over heights, distributed by the foot fractions."""
    x0, x1, x2, x3 = point(q, 0), point(q, 1), point(q, 2), point(q, 3)
    n_a, t, _, _, h_a, s_a = _triangle_geometry(x0, x1, x2)
    n_b, _, _, _, h_b, s_b = _triangle_geometry(x1, x0, x3)
    force, _ = _energy_derivatives(p, _half_angle_tangent(n_a, n_b, t))
    for k in range(3):
        a, b = force * n_a[k] / h_a, force * n_b[k] / h_b
        g[k] = -(1.0 - s_a) * a - s_b * b
        g[3 + k] = -s_a * a - (1.0 - s_b) * b
        g[6 + k] = a
        g[9 + k] = b


@formula
def hinge_hessian(q, p, blend, h):  # type: ignore[no-untyped-def]
    """`W'' grad(theta) grad(theta)^T + (1 - blend) W' hess(theta)`; only the second term can be indefinite."""
    x0, x1, x2, x3 = point(q, 0), point(q, 1), point(q, 2), point(q, 3)
    n_a, t, m_a, length, h_a, s_a = _triangle_geometry(x0, x1, x2)
    n_b, t_b, m_b, _, h_b, s_b = _triangle_geometry(x1, x0, x3)
    slope, stiffness = _energy_derivatives(p, _half_angle_tangent(n_a, n_b, t))
    force = (1.0 - blend) * slope
    # weights of the four vertices in dq and de of each triangle; the triangle on the right has the reversed edge
    q_a = (-(1.0 - s_a), -s_a, 1.0, 0.0)
    q_b = (-s_b, -(1.0 - s_b), 0.0, 1.0)
    e = (-1.0, 1.0, 0.0, 0.0)
    slide_a, slide_b = -force / (h_a * length), force / (h_b * length)
    swing_a, swing_b, turn = -force / (h_a * h_a), -force / (h_b * h_b), -0.5 * force / (length * length)
    for i in range(4):
        grad_i = combine(stiffness * q_a[i] / h_a, n_a, stiffness * q_b[i] / h_b, n_b)
        for k in range(i + 1):
            grad_k = combine(q_a[k] / h_a, n_a, q_b[k] / h_b, n_b)
            both = turn * e[i] * e[k]
            # each triangle adds n (x) right + left (x) n
            lift_a, lift_b = swing_a * q_a[i] * q_a[k] + both, swing_b * q_b[i] * q_b[k] + both
            right_a = combine(lift_a, m_a, slide_a * e[i] * q_a[k], t)
            left_a = combine(lift_a, m_a, slide_a * q_a[i] * e[k], t)
            right_b = combine(lift_b, m_b, slide_b * e[i] * q_b[k], t_b)
            left_b = combine(lift_b, m_b, slide_b * q_b[i] * e[k], t_b)
            for r in range(3):
                for c in range(3):
                    h[3 * i + r, 3 * k + c] = (
                        grad_i[r] * grad_k[c]
                        + n_a[r] * right_a[c]
                        + left_a[r] * n_a[c]
                        + n_b[r] * right_b[c]
                        + left_b[r] * n_b[c]
                    )


class Hinges(Elements):
    """Hinges at the interior edges of the fabric.

    Parameters
    ----------
    hinges : (H, 4) vertices: the edge, the apex on its left, and the apex on its right.
    coefficient : (H,) N mm, c.
    fold : (H,) N mm, f.

    Two triangles folded by 90 degrees, `W = c (2 tan(45 deg))^2`:

    >>> fold = np.array([[0, 0, 0], [0, 1, 0], [-1, 0, 0], [0, 0, 1.0]])
    >>> Hinges(np.array([[0, 1, 2, 3]]), 0.5).energies(fold.ravel()).round(6)
    array([2.])
    """

    formulas = (hinge_energy, hinge_gradient, hinge_hessian)
    sweep = staticmethod(sweep(12, 12, *formulas))

    def __init__(self, hinges: Array, coefficient: Array | float, fold: Array | float = 0.0) -> None:
        dofs = (3 * hinges[:, :, None] + np.arange(3)).reshape(len(hinges), 12)
        params = np.column_stack(np.broadcast_arrays(coefficient, fold, hinges[:, 0])[:2])
        super().__init__(dofs, dofs, params)

    @property
    def vertices(self) -> Array:
        """(H, 4) vertices of the hinges."""
        return self.inputs[:, ::3] // 3


def hinge_coefficients(hinges: Array, rest: Array, stiffness: float) -> Array:
    """(H,) N mm, `c = k_B 3 |e|^2/(A1 + A2)` on the rest shape (V, 2) mm; the size of the shape does not matter.

    `stiffness` (N mm) is `6 k_B`, D11 of the plate that equilateral triangles with such hinges bend like.
    """
    x0, x1, x2, x3 = (rest[hinges[:, i]] for i in range(4))
    e, a, b = x1 - x0, x2 - x0, x3 - x0
    areas = 0.5 * (np.abs(e[:, 0] * a[:, 1] - e[:, 1] * a[:, 0]) + np.abs(e[:, 0] * b[:, 1] - e[:, 1] * b[:, 0]))
    return np.asarray(0.5 * stiffness * np.einsum("ij,ij->i", e, e) / areas)


def fold_coefficients(hinges: Array, rest: Array, stiffness: float) -> Array:
    """(H,) N mm, coefficient f of the fold energy beside a plate of this stiffness D11: `D11 |e|^2/(4 (A1 + A2))`.

    The patches of the plate measure heights, so a fold costs about `sin(theta)^2` instead of `(2 tan(theta/2))^2`, and
    its energy would fall again beyond 90 degrees. The difference of the two is `theta^4/2` to leading order. The fold
    energy adds this difference, for hinges as stiff as the plate of a cylinder.
    """
    return 0.5 * hinge_coefficients(hinges, rest, stiffness)


def _build(mesh: BendingMesh, stiffness: BendingStiffness) -> dict[str, Elements]:
    hinges = mesh.hinges
    return {"hinges": Hinges(hinges, hinge_coefficients(hinges, mesh.printed, stiffness.d11))}


def _set_rest(
    parts: Mapping[str, Elements], stiffness: BendingStiffness, area_ratio: float, shape: Array | None
) -> None:
    if shape is not None:
        hinges = cast(Hinges, parts["hinges"])
        hinges.params[:, 0] = hinge_coefficients(hinges.vertices, shape, stiffness.d11)


FABRIC_BENDING["paper"] = FabricBending(("hinges",), _build, _set_rest)
