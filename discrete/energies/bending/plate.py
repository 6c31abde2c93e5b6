"""Plate bending of the fabric: constant curvature on patches of six vertices, with displacements as only unknowns.

With the rest area A of the triangle and the curvature tensor k, the energy of a patch is

    W = c [(1 - nu) tr(k^2) + nu (tr k)^2],    c = A E h^3/(24 (1 - nu^2)).

The three vertices of the triangle and three more (the apexes of the adjacent triangles, see
`discrete.energies.bending.plate_patches`) define one quadratic surface, as in the enhanced basic shell triangle of
Flores and Onate (2005). Its curvature in space is `k = C^-1 b`, with `b_ab = n . x_ab` and the normal n and metric C of
the flat triangle.

Measure of curvature. The fabric is stretched by a third along the arms, so the measure matters. Integration of the
membrane law through a constant thickness gives `C^-1 b`: the tangent stiffness is contracted with C^-1. With b on the
rest metric, a sheet stretched by 1.35 would be 3.3 times stiffer, and a compressed sheet would hardly resist bending.

Derivatives, in an orthonormal frame of the triangle. A vertex moves by u; t is the surface gradient and B the second
covariant derivative of its shape function. Then `db = B (n . u)`, the strain is `eps = sym(t u)`, and
`dk = db - 2 eps k` equals the symmetric `eta = db - eps k - k eps` up to a spin. With the moment `m = dW/dk`, the
variations are `dW = m : eta` and `d2W = 2 c [(1 - nu) eta : eta + nu (tr eta)^2]` plus terms that can be indefinite.
"""

from __future__ import annotations

import numpy as np

from asterism.discrete.energies.bending.plate_patches import patches
from asterism.discrete.energies.elements import Elements
from asterism.discrete.energies.kernel import combine, cross, dot, formula, multiply, point, sweep
from asterism.equilibrium.arrays import Array


@formula
def _frame(q, p):  # type: ignore[no-untyped-def]
    """Orthonormal frame (e1, e2, n) of the flat triangle, and a, b, d of the columns `a e1` and `b e1 + d e2` of F."""
    x0, x1, x2 = point(q, 0), point(q, 1), point(q, 2)
    f1 = combine(1.0, combine(p[2], x0, p[4], x1), p[6], x2)
    f2 = combine(1.0, combine(p[3], x0, p[5], x1), p[7], x2)
    a = np.sqrt(dot(f1, f1))
    e1 = multiply(1.0 / a, f1)
    b = dot(e1, f2)
    across = combine(1.0, f2, -b, e1)
    d = np.sqrt(dot(across, across))
    e2 = multiply(1.0 / d, across)
    return e1, e2, cross(e1, e2), a, b, d


@formula
def _shape_gradient(p, i, a, b, d):  # type: ignore[no-untyped-def]
    """Surface gradient (1/mm) of the shape function of vertex i < 3, in the frame."""
    t1 = p[2 + 2 * i] / a
    return t1, (p[3 + 2 * i] - b * t1) / d


@formula
def _shape_second_derivatives(p, i, a, b, d):  # type: ignore[no-untyped-def]
    """Second derivatives 11, 12, 22 (1/mm^2) of the shape function of vertex i, in the frame."""
    c11, c12, c22 = p[8 + 3 * i], p[9 + 3 * i], p[10 + 3 * i]
    s11 = c11 / (a * a)
    s12 = (c12 - a * b * s11) / (a * d)
    return s11, s12, (c22 - b * b * s11 - 2.0 * b * d * s12) / (d * d)


@formula
def _position_second_derivatives(q, p, a, b, d):  # type: ignore[no-untyped-def]
    """Second derivatives 11, 12, 22 of the position, three vectors, in the frame."""
    x11 = x12 = x22 = (0.0, 0.0, 0.0)
    for i in range(6):
        s11, s12, s22 = _shape_second_derivatives(p, i, a, b, d)
        x = point(q, i)
        x11, x12, x22 = combine(1.0, x11, s11, x), combine(1.0, x12, s12, x), combine(1.0, x22, s22, x)
    return x11, x12, x22


@formula
def _moment(p, k11, k12, k22):  # type: ignore[no-untyped-def]
    """Components 11, 12, 22 of the moment `m = dW/dk = 2 c [(1 - nu) k + nu tr(k) I]`."""
    twist, both = 2.0 * p[0] * (1.0 - p[1]), 2.0 * p[0] * p[1] * (k11 + k22)
    return twist * k11 + both, twist * k12, twist * k22 + both


@formula
def _covariant(p, i, a, b, d, g1, g2):  # type: ignore[no-untyped-def]
    """Surface gradient (2) and second covariant derivative (3) of vertex i; g1, g2 are the in-plane parts of x_ab."""
    s11, s12, s22 = _shape_second_derivatives(p, i, a, b, d)
    if i > 2:
        return 0.0 * s11, 0.0 * s11, s11, s12, s22
    t1, t2 = _shape_gradient(p, i, a, b, d)
    return t1, t2, s11 - g1[0] * t1 - g2[0] * t2, s12 - g1[1] * t1 - g2[1] * t2, s22 - g1[2] * t1 - g2[2] * t2


@formula
def _strain_times_curvature(t1, t2, k11, k12, k22, e1, e2):  # type: ignore[no-untyped-def]
    """Components 11, 12, 22 of `eps k + k eps` and the spin `(k eps - eps k)_12`, as vectors to be multiplied by u."""
    half = combine(0.5 * t2, e1, 0.5 * t1, e2)
    return (
        combine(2.0 * k11 * t1, e1, 2.0 * k12, half),
        combine(1.0, combine(k12 * t1, e1, k12 * t2, e2), k11 + k22, half),
        combine(2.0 * k22 * t2, e2, 2.0 * k12, half),
        combine(1.0, combine(-k12 * t1, e1, k12 * t2, e2), k11 - k22, half),
    )


@formula
def plate_energy(q, p):  # type: ignore[no-untyped-def]
    """Energy of a patch in N mm; p = (c, nu, first derivatives (3 x 2), second derivatives 11, 12, 22 (6 x 3))."""
    _, _, n, a, b, d = _frame(q, p)
    x11, x12, x22 = _position_second_derivatives(q, p, a, b, d)
    k11, k12, k22 = dot(n, x11), dot(n, x12), dot(n, x22)
    m11, m12, m22 = _moment(p, k11, k12, k22)
    return 0.5 * (m11 * k11 + 2.0 * m12 * k12 + m22 * k22)


@formula
def plate_gradient(q, p, g):  # type: ignore[no-untyped-def]
    """`(m : B) n - 2 (m k) t` for every vertex."""
    e1, e2, n, a, b, d = _frame(q, p)
    x11, x12, x22 = _position_second_derivatives(q, p, a, b, d)
    k11, k12, k22 = dot(n, x11), dot(n, x12), dot(n, x22)
    g1, g2 = (dot(e1, x11), dot(e1, x12), dot(e1, x22)), (dot(e2, x11), dot(e2, x12), dot(e2, x22))
    m11, m12, m22 = _moment(p, k11, k12, k22)
    p11, p12, p22 = m11 * k11 + m12 * k12, m11 * k12 + m12 * k22, m12 * k12 + m22 * k22
    for i in range(6):
        t1, t2, b11, b12, b22 = _covariant(p, i, a, b, d, g1, g2)
        lift = m11 * b11 + 2.0 * m12 * b12 + m22 * b22
        u1, u2 = -2.0 * (p11 * t1 + p12 * t2), -2.0 * (p12 * t1 + p22 * t2)
        for r in range(3):
            g[3 * i + r] = lift * n[r] + u1 * e1[r] + u2 * e2[r]


@formula
def plate_hessian(q, p, blend, h):  # type: ignore[no-untyped-def]
    """The quadratic form of eta, plus (1 - blend) times the rest of the second variation.

    The rest is `m : d2b - 4 tr(m eps db) + 8 tr(m k eps^2) - tr(m k d2C) - 4 c (1 - nu) spin^2` with
    `d2b = -2 (t . n)(B . u) - (t . t) k` (products of two displacements) and `d2C = 2 t u . u t`.
    """
    e1, e2, n, a, b, d = _frame(q, p)
    x11, x12, x22 = _position_second_derivatives(q, p, a, b, d)
    k11, k12, k22 = dot(n, x11), dot(n, x12), dot(n, x22)
    g1, g2 = (dot(e1, x11), dot(e1, x12), dot(e1, x22)), (dot(e2, x11), dot(e2, x12), dot(e2, x22))
    m11, m12, m22 = _moment(p, k11, k12, k22)
    p11, p12, p22 = m11 * k11 + m12 * k12, m11 * k12 + m12 * k22, m12 * k12 + m22 * k22
    work = m11 * k11 + 2.0 * m12 * k12 + m22 * k22
    rest = 1.0 - blend
    turning = -4.0 * rest * p[0] * (1.0 - p[1])
    for i in range(6):
        ti1, ti2, bi11, bi12, bi22 = _covariant(p, i, a, b, d, g1, g2)
        si11, si12, si22, wi = _strain_times_curvature(ti1, ti2, k11, k12, k22, e1, e2)
        lift_i = m11 * bi11 + 2.0 * m12 * bi12 + m22 * bi22
        # symmetric part of B m
        qi11, qi22 = bi11 * m11 + bi12 * m12, bi12 * m12 + bi22 * m22
        qi12 = 0.5 * (bi11 * m12 + bi12 * m22 + bi12 * m11 + bi22 * m12)
        for j in range(i + 1):
            tj1, tj2, bj11, bj12, bj22 = _covariant(p, j, a, b, d, g1, g2)
            sj11, sj12, sj22, wj = _strain_times_curvature(tj1, tj2, k11, k12, k22, e1, e2)
            mj11, mj12, mj22 = _moment(p, bj11, bj12, bj22)
            lift_j = m11 * bj11 + 2.0 * m12 * bj12 + m22 * bj22
            qj11, qj22 = bj11 * m11 + bj12 * m12, bj12 * m12 + bj22 * m22
            qj12 = 0.5 * (bj11 * m12 + bj12 * m22 + bj12 * m11 + bj22 * m12)
            # n n^T: the quadratic form of db, and the rotation of the normal
            normal = bi11 * mj11 + 2.0 * bi12 * mj12 + bi22 * mj22 - rest * work * (ti1 * tj1 + ti2 * tj2)
            # in-plane vectors times n^T, and n times in-plane vectors, from the rest
            left = combine(
                -rest * (lift_j * ti1 + 2.0 * (qi11 * tj1 + qi12 * tj2)),
                e1,
                -rest * (lift_j * ti2 + 2.0 * (qi12 * tj1 + qi22 * tj2)),
                e2,
            )
            right = combine(
                -rest * (lift_i * tj1 + 2.0 * (qj11 * ti1 + qj12 * ti2)),
                e1,
                -rest * (lift_i * tj2 + 2.0 * (qj12 * ti1 + qj22 * ti2)),
                e2,
            )
            # from the quadratic form: db of one vertex, eps k + k eps of the other
            mi11, mi12, mi22 = _moment(p, bi11, bi12, bi22)
            left = combine(1.0, left, -1.0, _contract(mi11, mi12, mi22, sj11, sj12, sj22))
            right = combine(1.0, right, -1.0, _contract(mj11, mj12, mj22, si11, si12, si22))
            for r in range(3):
                for c in range(3):
                    h[3 * i + r, 3 * j + c] = normal * n[r] * n[c] + n[r] * left[c] + right[r] * n[c]
            if i < 3:
                # only the vertices of the triangle strain it
                metric = -2.0 * rest * (p11 * ti1 * tj1 + p12 * (ti1 * tj2 + ti2 * tj1) + p22 * ti2 * tj2)
                hi, hj = combine(0.5 * ti2, e1, 0.5 * ti1, e2), combine(0.5 * tj2, e1, 0.5 * tj1, e2)
                # rows of m k eps of vertex i, contracted with eps of vertex j
                a11 = combine(p11 * ti1, e1, p12, hi)
                a12 = combine(p11, hi, p12 * ti2, e2)
                a21 = combine(p12 * ti1, e1, p22, hi)
                a22 = combine(p12, hi, p22 * ti2, e2)
                across = combine(1.0, a12, 1.0, a21)
                for r in range(3):
                    m_j = _moment(p, sj11[0], sj12[0], sj22[0]), _moment(p, sj11[1], sj12[1], sj22[1])
                    m_j2 = _moment(p, sj11[2], sj12[2], sj22[2])
                    columns = (m_j[0], m_j[1], m_j2)
                    for c in range(3):
                        square = si11[r] * columns[c][0] + 2.0 * si12[r] * columns[c][1] + si22[r] * columns[c][2]
                        strain = a11[r] * tj1 * e1[c] + across[r] * hj[c] + a22[r] * tj2 * e2[c]
                        h[3 * i + r, 3 * j + c] += square + 8.0 * rest * strain + turning * wi[r] * wj[c]
                    h[3 * i + r, 3 * j + r] += metric


@formula
def _contract(m11, m12, m22, s11, s12, s22):  # type: ignore[no-untyped-def]
    """`m : s` for a symmetric tensor s of vectors."""
    return combine(1.0, combine(m11, s11, 2.0 * m12, s12), m22, s22)


class Plate(Elements):
    """Plate bending of the fabric, one patch for each triangle.

    Parameters
    ----------
    triangles : (T, 3) vertices, counterclockwise.
    printed : (V, 2) mm; any affine image of the rest shape gives the same curvatures.
    thickness, modulus, poisson : mm, MPa, 1.
    area_ratio : rest area over printed area.
    surrounding : (R, 3) triangles next to these, whose vertices belong to patches; they have no energy.

    Raises
    ------
    MeshError
        A triangle has too few vertices around it, see `plate_patches.patches`.

    Examples
    --------
    A paraboloid of curvature 0.001/mm has the energy `D (1 + nu) k^2` per area; here D = 8 N mm, A = sqrt(3) mm^2:

    >>> h = 3.0**0.5
    >>> points = np.array([[0, 0], [2, 0], [1, h], [3, h], [-1, h], [1, -h]])
    >>> triangles = np.array([[0, 1, 2], [1, 3, 2], [2, 4, 0], [0, 5, 1]])
    >>> plate = Plate(triangles[:1], points, 1.0, 96.0, 0.0, surrounding=triangles[1:])
    >>> sheet = np.column_stack([points, 0.0005 * (points**2).sum(axis=1)])
    >>> round(float(plate.energies(sheet.ravel())[0] / (8.0 * h * 0.001**2)), 3)
    1.0
    """

    formulas = (plate_energy, plate_gradient, plate_hessian)
    sweep = staticmethod(sweep(18, 18, *formulas))

    def __init__(
        self,
        triangles: Array,
        printed: Array,
        thickness: float,
        modulus: float,
        poisson: float,
        area_ratio: float = 1.0,
        surrounding: Array | None = None,
    ) -> None:
        patch = patches(triangles, printed, surrounding)
        stiffness = modulus * thickness**3 / (24.0 * (1.0 - poisson**2))
        self._printed = stiffness * patch.area
        count = len(triangles)
        params = np.column_stack(
            [self._printed, np.full(count, poisson), patch.first.reshape(count, 6), patch.second.reshape(count, 18)]
        )
        dofs = (3 * patch.vertices[:, :, None] + np.arange(3)).reshape(count, 18)
        super().__init__(dofs, dofs, params)
        self.set_rest_area(area_ratio)

    def set_rest_area(self, area_ratio: float) -> None:
        """Set the rest area over the printed area, the same for all patches."""
        self.params[:, 0] = area_ratio * self._printed
