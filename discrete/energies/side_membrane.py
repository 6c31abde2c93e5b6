"""Membrane energy of the fabric with strains smoothed over the sides of triangles, beside a plate.

Flat triangles of constant strain are too stiff: they strain where a sheet bends in its plane, and at the tips of arms.
As in edge-based smoothed finite elements (Liu, Nguyen-Thoi and Lam 2009, doi 10.1016/j.jsv.2008.08.027), each side
carries a third of both triangles beside it, with the mean of their metrics by area,

    W = (1 - s) (V_1 + V_2)/3 w(C),    C = (A_1 C_1 + A_2 C_2)/(A_1 + A_2),

and the laws w of `discrete.energies.membrane`. Means of metrics, and not of deformation gradients, do not see folds, so
bending costs no membrane energy. Homogeneous stress leaves every vertex in equilibrium, on all meshes.

Flat triangles keep the share s, and the thirds at sides without a second triangle (`flat_share`). Without it a triangle
could collapse at no cost: fine meshes at the tips of arms then find no equilibrium.

Derivatives. With the strain `E = (C - I)/2`, the second Piola-Kirchhoff stress `S = M + a C^-1`, `M = diag(m1, m2)` of
the powers along and across the grain, `a = dw/dL` and `lam' = d2w/dL2`, the variations are `dW = S : dE` and
`d2W = lam' (C^-1 : dE)^2 - 2 a tr(C^-1 dE C^-1 dE) + k1 dE11^2 + k2 dE22^2 + S : d2E`.
"""

from __future__ import annotations

import numpy as np

from asterism.discrete.energies.elements import Elements
from asterism.discrete.energies.kernel import combine, dot, formula, point, sweep
from asterism.discrete.energies.membrane import (
    fibre_derivatives,
    membrane_params,
    negative_stress,
    strain_energy,
    volumetric_derivatives,
)
from asterism.equilibrium.arrays import Array
from asterism.pattern.design.materials import Fabric
from asterism.pattern.geometry.planar import triangle_areas

# s, share of the flat triangles
FLAT_SHARE = 0.2


@formula
def _columns(q, p):  # type: ignore[no-untyped-def]
    """Columns of F of the left and of the right triangle, times the roots of their parts of the area."""
    x0, x1, x2, x3 = point(q, 0), point(q, 1), point(q, 2), point(q, 3)
    f1 = combine(1.0, combine(p[0], x0, p[2], x1), p[4], x2)
    f2 = combine(1.0, combine(p[1], x0, p[3], x1), p[5], x2)
    g1 = combine(1.0, combine(p[12], x0, p[14], x1), p[16], x3)
    g2 = combine(1.0, combine(p[13], x0, p[15], x1), p[17], x3)
    return f1, f2, g1, g2


@formula
def _metric(f1, f2, g1, g2):  # type: ignore[no-untyped-def]
    """Components 11, 12, 22 of C, its determinant, and L = ln J."""
    c11, c12, c22 = dot(f1, f1) + dot(g1, g1), dot(f1, f2) + dot(g1, g2), dot(f2, f2) + dot(g2, g2)
    det = c11 * c22 - c12 * c12
    return c11, c12, c22, det, 0.5 * np.log(det)


@formula
def _shape_gradient(p, i):  # type: ignore[no-untyped-def]
    """Derivatives by x_i of the columns of `_columns`."""
    none = 0.0 * p[0]
    if i == 2:
        return p[4], p[5], none, none
    if i == 3:
        return none, none, p[16], p[17]
    return p[2 * i], p[2 * i + 1], p[12 + 2 * i], p[13 + 2 * i]


@formula
def side_membrane_energy(q, p):  # type: ignore[no-untyped-def]
    """Energy of a side (x0, x1) in N mm, with apex x2 on its left and x3 on its right.

    p = (b0, b1, b2, mu V, alpha V, lam V, beta V, p, q, b0', b1', b3') with the shape gradients b of the left triangle
    and b' of the right one, times the roots of their parts of the area, and the volume V of the side.
    """
    f1, f2, g1, g2 = _columns(q, p)
    c11, _, c22, _, log_j = _metric(f1, f2, g1, g2)
    return strain_energy(p, c11, c22, log_j)


@formula
def side_membrane_gradient(q, p, g):  # type: ignore[no-untyped-def]
    """`F S b_i` of both triangles."""
    f1, f2, g1, g2 = _columns(q, p)
    c11, c12, c22, det, log_j = _metric(f1, f2, g1, g2)
    a, _ = volumetric_derivatives(p, log_j)
    m1, m2, _, _ = fibre_derivatives(p, c11, c22)
    s11, s12, s22 = m1 + a * c22 / det, -a * c12 / det, m2 + a * c11 / det
    left1, left2 = combine(s11, f1, s12, f2), combine(s12, f1, s22, f2)
    right1, right2 = combine(s11, g1, s12, g2), combine(s12, g1, s22, g2)
    for i in range(4):
        l1, l2, r1, r2 = _shape_gradient(p, i)
        force = combine(1.0, combine(l1, left1, l2, left2), 1.0, combine(r1, right1, r2, right2))
        for k in range(3):
            g[3 * i + k] = force[k]


@formula
def _strain_rates(p, i, f1, f2, g1, g2):  # type: ignore[no-untyped-def]
    """Derivatives of E11, 2 E12 and E22 by x_i, three vectors."""
    l1, l2, r1, r2 = _shape_gradient(p, i)
    shear = combine(1.0, combine(l1, f2, l2, f1), 1.0, combine(r1, g2, r2, g1))
    return combine(l1, f1, r1, g1), shear, combine(l2, f2, r2, g2)


@formula
def side_membrane_hessian(q, p, blend, h):  # type: ignore[no-untyped-def]
    """The second variation. Of a negative part of the stress, a positive a and negative k, `blend` is left out."""
    f1, f2, g1, g2 = _columns(q, p)
    c11, c12, c22, det, log_j = _metric(f1, f2, g1, g2)
    a, a_prime = volumetric_derivatives(p, log_j)
    i11, i12, i22 = c22 / det, -c12 / det, c11 / det
    m1, m2, k1, k2 = fibre_derivatives(p, c11, c22)
    s11, s12, s22 = m1 + a * i11, a * i12, m2 + a * i22
    n11, n12, n22 = negative_stress(p, s11, s12, s22)
    s11, s12, s22 = s11 - blend * n11, s12 - blend * n12, s22 - blend * n22
    # stiffness of the law by E11, 2 E12 and E22
    shear = a - blend * np.maximum(a, 0.0)
    both = a_prime - 2.0 * shear
    d11, d12, d13 = both * i11 * i11, both * i11 * i12, a_prime * i11 * i22 - 2.0 * shear * i12 * i12
    d22, d23, d33 = a_prime * i12 * i12 - shear * (i11 * i22 + i12 * i12), both * i12 * i22, both * i22 * i22
    d11, d33 = d11 + k1 - blend * np.minimum(k1, 0.0), d33 + k2 - blend * np.minimum(k2, 0.0)
    for i in range(4):
        l1, l2, r1, r2 = _shape_gradient(p, i)
        e11, e12, e22 = _strain_rates(p, i, f1, f2, g1, g2)
        t11 = combine(1.0, combine(d11, e11, d12, e12), d13, e22)
        t12 = combine(1.0, combine(d12, e11, d22, e12), d23, e22)
        t22 = combine(1.0, combine(d13, e11, d23, e12), d33, e22)
        left1, left2, right1, right2 = (
            s11 * l1 + s12 * l2,
            s12 * l1 + s22 * l2,
            s11 * r1 + s12 * r2,
            s12 * r1 + s22 * r2,
        )
        for k in range(i + 1):
            m1, m2, n1, n2 = _shape_gradient(p, k)
            u11, u12, u22 = _strain_rates(p, k, f1, f2, g1, g2)
            across = left1 * m1 + left2 * m2 + right1 * n1 + right2 * n2
            for r in range(3):
                for c in range(3):
                    h[3 * i + r, 3 * k + c] = t11[r] * u11[c] + t12[r] * u12[c] + t22[r] * u22[c]
                h[3 * i + r, 3 * k + r] += across


class SideMembrane(Elements):
    """Sides of triangles with the mean metric of both.

    Parameters
    ----------
    hinges : (H, 4) vertices: the side, the apex on its left, and the apex on its right.
    rest : (V, 2) mm, the unstretched fabric.
    fabric : as of `discrete.energies.membrane.Membrane`.

    Examples
    --------
    A square of two triangles is bent in its plane, so that its strain is `k y` along x. Flat triangles see a strain of
    opposite signs; their mean is that of the middle of the diagonal, which is zero.

    >>> rest = np.array([[-1, 1], [1, -1], [1, 1], [-1, -1.0]])
    >>> bent = np.column_stack([rest[:, 0] + 1e-3 * rest[:, 0] * rest[:, 1], rest[:, 1], 0.0 * rest[:, 0]])
    >>> side = SideMembrane(np.array([[0, 1, 3, 2]]), rest, Fabric(thickness_mm=1.0, modulus_mpa=7.0, poisson=0.0))
    >>> float(side.energies(bent.ravel())[0]) < 2e-6
    True
    """

    formulas = (side_membrane_energy, side_membrane_gradient, side_membrane_hessian)
    sweep = staticmethod(sweep(12, 12, *formulas))

    def __init__(self, hinges: Array, rest: Array, fabric: Fabric) -> None:
        dofs = (3 * hinges[:, :, None] + np.arange(3)).reshape(len(hinges), 12)
        self._hinges, self._fabric = hinges, fabric
        super().__init__(dofs, dofs, np.empty((len(hinges), 18)))
        self.set_rest(rest)

    def set_rest(self, rest: Array) -> None:
        """Set the unstretched fabric (V, 2) mm."""
        left, right = self._hinges[:, [0, 1, 2]], self._hinges[:, [0, 1, 3]]
        one, other = (membrane_params(corners, rest, self._fabric) for corners in (left, right[:, [1, 0, 2]]))
        area = triangle_areas(rest, left)
        part = area / (area + triangle_areas(rest, right[:, [1, 0, 2]]))
        self.params[:, :6] = np.sqrt(part)[:, None] * one[:, :6]
        self.params[:, 6:10] = (1.0 - FLAT_SHARE) / 3.0 * (one[:, 6:10] + other[:, 6:10])
        self.params[:, 10:12] = one[:, 10:]
        self.params[:, 12:] = np.sqrt(1.0 - part)[:, None] * other[:, [2, 3, 0, 1, 4, 5]]


def flat_share(triangles: Array, closed: bool) -> Array:
    """(T,) share of each flat triangle in its energy.

    Examples
    --------
    >>> flat_share(np.array([[0, 1, 2], [0, 2, 3]]), False).round(3)
    array([0.733, 0.733])
    """
    if closed:
        return np.full(len(triangles), FLAT_SHARE)
    sides = np.sort(np.stack([triangles, np.roll(triangles, -1, axis=1)], axis=2), axis=2).reshape(-1, 2)
    _, number, count = np.unique(sides, axis=0, return_inverse=True, return_counts=True)
    alone = (count[number.ravel()] == 1).reshape(triangles.shape).sum(axis=1)
    return np.asarray(FLAT_SHARE + (1.0 - FLAT_SHARE) * alone / 3.0)
