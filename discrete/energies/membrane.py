"""Membrane energy of the fabric: a hyperelastic membrane on triangles of constant strain, and on their sides.

With the deformation gradient F (3 x 2) by coordinates along and across the grain, `C = F^T F`, `J = sqrt(det C)` and
`L = ln J`, the energy per rest volume is

    W = mu/2 [(C11^r1 - 1)/r1 + (C22^r2 - 1)/r2] - alpha L + lam/2 L^2 + beta/2 (exp(-2 L) - 1).

Neo-Hookean (plane stress): `r1 = r2 = 1`, `alpha = mu`, `beta = 0`, `mu = E/(2 (1 + nu))`, `lam = E nu/(1 - nu^2)`.
Incompressible: `r1 = r2 = 1`, `alpha = lam = 0`, `beta = mu = E/3`, which is `mu/2 (tr C + 1/det C - 3)`.
Orthotropic: `mu = alpha = G`, `lam = Q12`, `r1 = (Q11 - Q12)/(2 G)`, `r2 = (Q22 - Q12)/(2 G)`, so that small strains
have the plane stiffness Q and the shear modulus G. The powers of C11 and C22 are terms of Itskov and Aksel (2004, Int.
J. Solids Struct. 41, 3833); they are convex in F if the exponents are at least 1/2.
All energies go to infinity as a triangle collapses (J -> 0).

**Sides.** Flat triangles of constant strain are too stiff: they strain where a sheet bends in its plane, and at the
tips of arms. Beside a plate, strains are therefore smoothed over the sides of triangles. As in edge-based smoothed
finite elements (Liu, Nguyen-Thoi and Lam 2009, doi 10.1016/j.jsv.2008.08.027), each side carries a third of both
triangles beside it, with the mean of their metrics by area,

    W_side = (1 - s) (V_1 + V_2)/3 W(C),    C = (A_1 C_1 + A_2 C_2)/(A_1 + A_2).

Means of metrics, and not of deformation gradients, do not see folds, so bending costs no membrane energy. Homogeneous
stress leaves every vertex in equilibrium, on all meshes.

Flat triangles keep the share s, and the thirds at sides without a second triangle (`flat_share`). Without it a triangle
could collapse at no cost: fine meshes at the tips of arms then find no equilibrium.

**Derivatives at sides.** With the strain `E = (C - I)/2`, the second Piola-Kirchhoff stress `S = M + a C^-1`,
`M = diag(m1, m2)` of the powers along and across the grain, `a = dW/dL` and `lam' = d2W/dL2`, the variations are
`dW = S : dE` and `d2W = lam' (C^-1 : dE)^2 - 2 a tr(C^-1 dE C^-1 dE) + k1 dE11^2 + k2 dE22^2 + S : d2E`.
"""

from __future__ import annotations

import numpy as np

from asterism.discrete.energies.elements import Elements
from asterism.discrete.energies.kernel import combine, cross, dot, formula, multiply, point, sweep
from asterism.equilibrium.arrays import Array
from asterism.pattern.design.materials import Fabric
from asterism.pattern.geometry.planar import triangle_areas, triangle_gradients


@formula
def invariants(q, p):  # type: ignore[no-untyped-def]
    """Columns f1, f2 of F, components 11, 12, 22 of C, and L = ln J."""
    x0, x1, x2 = point(q, 0), point(q, 1), point(q, 2)
    f1 = combine(1.0, combine(p[0], x0, p[2], x1), p[4], x2)
    f2 = combine(1.0, combine(p[1], x0, p[3], x1), p[5], x2)
    c11, c12, c22 = dot(f1, f1), dot(f1, f2), dot(f2, f2)
    return f1, f2, c11, c12, c22, 0.5 * np.log(c11 * c22 - c12 * c12)


@formula
def volumetric_derivatives(p, log_j):  # type: ignore[no-untyped-def]
    """First and second derivative by L of the terms that depend on J alone."""
    thinning = p[9] * np.exp(-2.0 * log_j)
    return p[8] * log_j - p[7] - thinning, p[8] + 2.0 * thinning


@formula
def fibre_derivatives(p, c11, c22):  # type: ignore[no-untyped-def]
    """Twice the first and four times the second derivatives of the powers by C11 and C22."""
    m1, m2 = p[6] * c11 ** (p[10] - 1.0), p[6] * c22 ** (p[11] - 1.0)
    return m1, m2, 2.0 * (p[10] - 1.0) * m1 / c11, 2.0 * (p[11] - 1.0) * m2 / c22


@formula
def negative_stress(p, s11, s12, s22):  # type: ignore[no-untyped-def]
    """Components 11, 12, 22 of the negative part of a stress: by its eigenvalues, a linear polynomial of the stress."""
    mean, half = 0.5 * (s11 + s22), np.sqrt(0.25 * (s11 - s22) ** 2 + s12 * s12)
    low, high = np.minimum(mean - half, 0.0), np.minimum(mean + half, 0.0)
    slope = (high - low) / (2.0 * half + 1e-30 * (p[6] + half))
    shift = low - slope * (mean - half)
    return slope * s11 + shift, slope * s12, slope * s22 + shift


@formula
def strain_energy(p, c11, c22, log_j):  # type: ignore[no-untyped-def]
    """W times the rest volume V, in N mm; p[6:12] = (mu V, alpha V, lam V, beta V, r1, r2)."""
    return (
        0.5 * p[6] * ((c11 ** p[10] - 1.0) / p[10] + (c22 ** p[11] - 1.0) / p[11])
        - p[7] * log_j
        + 0.5 * p[8] * log_j * log_j
        + 0.5 * p[9] * (np.exp(-2.0 * log_j) - 1.0)
    )


@formula
def membrane_energy(q, p):  # type: ignore[no-untyped-def]
    """Energy of a triangle in N mm; p = (b0, b1, b2, mu V, alpha V, lam V, beta V, r1, r2), b_i shape gradients."""
    _, _, c11, _, c22, log_j = invariants(q, p)
    return strain_energy(p, c11, c22, log_j)


@formula
def membrane_gradient(q, p, g):  # type: ignore[no-untyped-def]
    """`dW/dx_i = V (F M b_i + a G b_i)` with `G = F C^-1`, `a = dW/dL` and `M = diag(m1, m2)` of the powers."""
    f1, f2, c11, c12, c22, log_j = invariants(q, p)
    a, _ = volumetric_derivatives(p, log_j)
    m1, m2, _, _ = fibre_derivatives(p, c11, c22)
    scale = a / (c11 * c22 - c12 * c12)
    # second Piola-Kirchhoff stress M + a C^-1, times the rest volume
    s11, s12, s22 = m1 + scale * c22, -scale * c12, m2 + scale * c11
    p1, p2 = combine(s11, f1, s12, f2), combine(s12, f1, s22, f2)
    for i in range(3):
        for k in range(3):
            g[3 * i + k] = p1[k] * p[2 * i] + p2[k] * p[2 * i + 1]


@formula
def membrane_hessian(q, p, blend, h):  # type: ignore[no-untyped-def]
    """Blocks `(b_i.M b_j) I + lam' g_i g_j^T + a ((g_i.g_j) n n^T - g_j g_i^T)`, `g_i = G b_i`, `lam' = d2W/dL2`, and
    the second derivatives of the powers along the columns of F.

    Three terms can be indefinite: the geometric stiffness along the normal, n n^T times the second Piola-Kirchhoff
    stress (in compression), the in-plane spin (eigenvalue at least `min(m1, m2) + a/J`), and powers with exponents
    below 1. `blend` is the share of their negative eigenvalues that is left out.
    """
    f1, f2, c11, c12, c22, log_j = invariants(q, p)
    a, a_prime = volumetric_derivatives(p, log_j)
    det = c11 * c22 - c12 * c12
    j = np.sqrt(det)
    n = multiply(1.0 / j, cross(f1, f2))
    g1 = combine(c22 / det, f1, -c12 / det, f2)
    g2 = combine(c11 / det, f2, -c12 / det, f1)
    m1, m2, k1, k2 = fibre_derivatives(p, c11, c22)
    k1, k2 = k1 - blend * np.minimum(k1, 0.0), k2 - blend * np.minimum(k2, 0.0)
    n11, n12, n22 = negative_stress(p, m1 + a * c22 / det, -a * c12 / det, m2 + a * c11 / det)
    # polar rotation F U^-1, U = (C + J I)/sqrt(tr C + 2 J), and the spin mode n x R b_i
    root = np.sqrt(c11 + c22 + 2.0 * j)
    u11, u12, u22 = (c11 + j) / root, c12 / root, (c22 + j) / root
    r1 = combine(u22 / j, f1, -u12 / j, f2)
    r2 = combine(u11 / j, f2, -u12 / j, f1)
    spin1, spin2 = cross(n, r1), cross(n, r2)
    spin = -0.5 * blend * np.minimum(np.minimum(m1, m2) + a / j, 0.0)
    for i in range(3):
        bi1, bi2 = p[2 * i], p[2 * i + 1]
        gi = combine(bi1, g1, bi2, g2)
        vi = combine(bi1, spin1, bi2, spin2)
        for k in range(i + 1):
            bk1, bk2 = p[2 * k], p[2 * k + 1]
            gk = combine(bk1, g1, bk2, g2)
            vk = combine(bk1, spin1, bk2, spin2)
            identity = m1 * bi1 * bk1 + m2 * bi2 * bk2
            along, across = k1 * bi1 * bk1, k2 * bi2 * bk2
            lift = bi1 * (n11 * bk1 + n12 * bk2) + bi2 * (n12 * bk1 + n22 * bk2)
            normal = a * dot(gi, gk) - blend * lift
            for r in range(3):
                for c in range(3):
                    h[3 * i + r, 3 * k + c] = (
                        a_prime * gi[r] * gk[c]
                        - a * gk[r] * gi[c]
                        + normal * n[r] * n[c]
                        + spin * vi[r] * vk[c]
                        + along * f1[r] * f1[c]
                        + across * f2[r] * f2[c]
                    )
                h[3 * i + r, 3 * k + r] += identity


class Membrane(Elements):
    """Constant strain triangles of the fabric.

    Parameters
    ----------
    triangles : (T, 3) vertices, counterclockwise.
    rest : (V, 2) mm, the unstretched fabric.
    fabric : its thickness, moduli and grain; its stretch does not matter.
    share : (T,) part of its energy that each triangle keeps, see `discrete.energies.membrane`; all by default.

    A triangle of 0.5 mm^2 and thickness 1 mm, stretched by 1 % in both directions. For small strain the energy is near
    `E/(1 - nu) strain^2` per volume in plane stress:

    >>> rest = np.array([[0, 0], [1, 0], [0, 1.0]])
    >>> fabric = Membrane(np.array([[0, 1, 2]]), rest, Fabric(thickness_mm=1.0, modulus_mpa=7.0, poisson=0.3))
    >>> stretched = np.column_stack([1.01 * rest, np.zeros(3)])
    >>> round(float(fabric.energies(stretched.ravel())[0]), 6), round(0.5 * 7.0 / 0.7 * 0.01**2, 6)
    (0.000497, 0.0005)
    """

    formulas = (membrane_energy, membrane_gradient, membrane_hessian)
    sweep = staticmethod(sweep(9, 9, *formulas))

    def __init__(self, triangles: Array, rest: Array, fabric: Fabric, share: Array | None = None) -> None:
        dofs = (3 * triangles[:, :, None] + np.arange(3)).reshape(len(triangles), 9)
        self._triangles, self._fabric, self._share = triangles, fabric, share
        super().__init__(dofs, dofs, np.empty((len(triangles), 12)))
        self.set_rest(rest)

    def set_rest(self, rest: Array) -> None:
        """Set the unstretched fabric (V, 2) mm."""
        # (T, 12) `membrane_params`, which are the parameters of triangles that keep all of their energy
        self.whole = membrane_params(self._triangles, rest, self._fabric)
        self.params[:] = self.whole
        if self._share is not None:
            self.params[:, 6:10] *= self._share[:, None]


def membrane_params(triangles: Array, rest: Array, fabric: Fabric) -> Array:
    """(T, 12) parameters of `Membrane`; arguments as there.

    Gradients of the three shape functions along and across the grain (1/mm), mu, alpha, lam and beta times the rest
    volume (N mm), and the exponents.
    """
    if fabric.model == "incompressible":
        mu = fabric.modulus / 3.0
        lame = (mu, 0.0, 0.0, mu)
    else:
        mu = fabric.shear_modulus
        lame = (mu, mu, fabric.modulus * fabric.poisson / (1.0 - fabric.poisson**2), 0.0)
    gradients = triangle_gradients(rest @ fabric.axes, triangles).reshape(len(triangles), 6)
    volume = fabric.thickness_mm * triangle_areas(rest, triangles)
    exponents = np.broadcast_to(fabric.exponents, (len(triangles), 2))
    return np.column_stack([gradients, volume[:, None] * np.asarray(lame), exponents])


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

    >>> flat_share(np.array([[0, 1, 2], [0, 2, 3]]), False).round(3)
    array([0.733, 0.733])
    """
    if closed:
        return np.full(len(triangles), FLAT_SHARE)
    sides = np.sort(np.stack([triangles, np.roll(triangles, -1, axis=1)], axis=2), axis=2).reshape(-1, 2)
    _, number, count = np.unique(sides, axis=0, return_inverse=True, return_counts=True)
    alone = (count[number.ravel()] == 1).reshape(triangles.shape).sum(axis=1)
    return np.asarray(FLAT_SHARE + (1.0 - FLAT_SHARE) * alone / 3.0)
