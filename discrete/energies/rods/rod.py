"""Stretch, bending and twist of rods (Bergou et al. 2008, 2010).

**Stretch** of an edge with edge vector e and printed length l: `W = EA/2 l (|e|/l - 1)^2`. Each edge counts once, also
where the stencils of a junction share it.

**Bending** about the width and in the plane of the sheet, of two rod edges that meet:

    W = (B_b (k_b - k_b0)^2 + B_n (k_n - k_n0)^2)/L,

with bending stiffnesses `B_b = E w h^3/12`, `B_n = E h w^3/12` and integrated rest curvatures k_b0 (bilayer) and k_n0
(layout).

**Twist** of the same stencil: `W = GJ (m - m0)^2/L`, m the angle between the directors of the edges. The angle is
measured after parallel transport of the first director to the second edge, so states need no history.

**Frame.** A rod edge has a tangent t and one director n, the normal on the plastic side (+z as printed). The direction
of the width is `b = n x t`, so (t, b, n) is right-handed, and reversing the edge (t -> -t) keeps n. A state holds
positions and directors. The dof `theta` of an edge rotates its director about the tangent. Derivatives by positions
carry the directors along by parallel transport (time-parallel frames, Bergou et al. 2010).

**Curvatures.** A stencil has vertices (x0, x1, x2) and the curvature binormal `kb = 2 t0 x t1/(1 + t0 . t1)`. Its
integrated curvatures are `k_b = kb . (b0 + b1)/2` about the width (positive: the tips bend down, away from the plastic
side) and `k_n = kb . (n0 + n1)/2` in the plane of the sheet. `L = l0 + l1` is the printed length of both edges.

In the formulas, te, tf are the tangents of the first and second edge, le, lf their lengths, and `chi = 1 + te . tf`.
"""

from __future__ import annotations

import numpy as np

from asterism.discrete.energies.elements import Elements
from asterism.discrete.energies.kernel import combine, cross, dot, formula, multiply, point, sub, sweep


@formula
def stretch_energy(q, p):  # type: ignore[no-untyped-def]
    """`EA/2 l (|e|/l - 1)^2` in N mm; q = (x0, x1), p = (EA, l)."""
    e = sub(point(q, 1), point(q, 0))
    strain = np.sqrt(dot(e, e)) / p[1] - 1.0
    return 0.5 * p[0] * p[1] * strain * strain


@formula
def stretch_gradient(q, p, g):  # type: ignore[no-untyped-def]
    """Axial force `EA (|e|/l - 1)` along the edge."""
    e = sub(point(q, 1), point(q, 0))
    length = np.sqrt(dot(e, e))
    force = p[0] * (length / p[1] - 1.0) / length
    for k in range(3):
        g[k] = -force * e[k]
        g[3 + k] = force * e[k]


@formula
def stretch_hessian(q, p, blend, h):  # type: ignore[no-untyped-def]
    """Axial stiffness `EA/l` along the edge and geometric stiffness `force/|e|` across it.

    The geometric stiffness is negative in compression; `blend` reduces its negative part to zero.
    """
    e = sub(point(q, 1), point(q, 0))
    length = np.sqrt(dot(e, e))
    t = multiply(1.0 / length, e)
    across = p[0] * (1.0 / p[1] - 1.0 / length)
    across = across - blend * np.minimum(across, 0.0)
    along = p[0] / p[1] - across
    for r in range(3):
        for c in range(3):
            value = along * t[r] * t[c]
            if r == c:
                value = value + across
            h[r, c] = value
            h[3 + r, 3 + c] = value
            h[3 + r, c] = -value


class RodStretch(Elements):
    """Axial stretch of rod edges.

    Parameters
    ----------
    inputs, dofs : (R, 6) coordinates of the two vertices.
    params : (R, 2) axial stiffness EA (N) and printed length l (mm).

    An edge of 10 mm with EA = 100 N, stretched by 1 %, stores `EA/2 l strain^2`:

    >>> edge = np.arange(6)[None]
    >>> rod = RodStretch(edge, edge, np.array([[100.0, 10.0]]))
    >>> rod.energies(np.array([0, 0, 0, 10.1, 0, 0])).round(6)
    array([0.05])
    >>> round(float(rod.gradients(np.array([0, 0, 0, 10.1, 0, 0]))[0, 3]), 6)  # axial force, N
    1.0
    """

    formulas = (stretch_energy, stretch_gradient, stretch_hessian)
    sweep = staticmethod(sweep(6, 6, *formulas))


@formula
def stencil_edges(q):  # type: ignore[no-untyped-def]
    """Tangents and lengths of the two edges of a stencil, and `chi = 1 + te . tf`."""
    e, f = sub(point(q, 1), point(q, 0)), sub(point(q, 2), point(q, 1))
    le, lf = np.sqrt(dot(e, e)), np.sqrt(dot(f, f))
    te, tf = multiply(1.0 / le, e), multiply(1.0 / lf, f)
    return te, tf, le, lf, 1.0 + dot(te, tf)


@formula
def _curvature(te, tf, chi, u0, u1):  # type: ignore[no-untyped-def]
    """Integrated curvature `kb . (u0 + u1)/2` about the directions u0, u1."""
    return dot(cross(te, tf), combine(1.0, u0, 1.0, u1)) / chi


@formula
def bend_energy(q, p):  # type: ignore[no-untyped-def]
    """Energy of a stencil in N mm; p = (B_b/L, B_n/L, k_b0, k_n0, sign0, sign1)."""
    te, tf, _, _, chi = stencil_edges(q)
    n0, n1 = point(q, 3), point(q, 4)
    width = _curvature(te, tf, chi, cross(n0, te), cross(n1, tf)) - p[2]
    plane = _curvature(te, tf, chi, n0, n1) - p[3]
    return p[0] * width * width + p[1] * plane * plane


@formula
def _curvature_gradient(te, tf, le, lf, chi, u0, u1, v0, v1, p, d):  # type: ignore[no-untyped-def]
    """Write the gradient of the curvature about u to d (11,); v is the derivative of u by the twist of its edge."""
    k = _curvature(te, tf, chi, u0, u1)
    tilde_t, tilde_u = combine(1.0 / chi, te, 1.0 / chi, tf), combine(1.0 / chi, u0, 1.0 / chi, u1)
    by_e = combine(-k / le, tilde_t, 1.0 / le, cross(tf, tilde_u))
    by_f = combine(-k / lf, tilde_t, -1.0 / lf, cross(te, tilde_u))
    for i in range(3):
        d[i] = -by_e[i]
        d[3 + i] = by_e[i] - by_f[i]
        d[6 + i] = by_f[i]
    kb = multiply(2.0 / chi, cross(te, tf))
    # where the stencil runs against an edge, its twist has the other sign
    d[9] = 0.5 * p[4] * dot(kb, v0)
    d[10] = 0.5 * p[5] * dot(kb, v1)
    return k


@formula
def bend_gradient(q, p, g):  # type: ignore[no-untyped-def]
    """`2 B/L (k - k0) dk`, summed over both curvatures."""
    te, tf, le, lf, chi = stencil_edges(q)
    n0, n1 = point(q, 3), point(q, 4)
    b0, b1 = cross(n0, te), cross(n1, tf)
    d = np.zeros_like(g)
    k = _curvature_gradient(te, tf, le, lf, chi, b0, b1, n0, n1, p, d)
    for i in range(11):
        g[i] = 2.0 * p[0] * (k - p[2]) * d[i]
    k = _curvature_gradient(te, tf, le, lf, chi, n0, n1, multiply(-1.0, b0), multiply(-1.0, b1), p, d)
    for i in range(11):
        g[i] += 2.0 * p[1] * (k - p[3]) * d[i]


@formula
def _add_blocks(h, r, c, ee, ef, fe, ff):  # type: ignore[no-untyped-def]
    """Add second derivatives by components r and c of `e = x1 - x0` and `f = x2 - x1` to h (lower triangle)."""
    h[r, c] += ee
    h[3 + r, c] += fe - ee
    h[3 + r, 3 + c] += ee - ef - fe + ff
    h[6 + r, c] -= fe
    h[6 + r, 3 + c] += fe - ff
    h[6 + r, 6 + c] += ff


@formula
def _add_curvature_hessian(te, tf, le, lf, chi, u0, u1, v0, v1, p, scale, h):  # type: ignore[no-untyped-def]
    """Add `scale` times the second derivatives of the curvature about u to h (lower triangle)."""
    k = _curvature(te, tf, chi, u0, u1)
    kb = multiply(2.0 / chi, cross(te, tf))
    t, u = combine(1.0 / chi, te, 1.0 / chi, tf), combine(1.0 / chi, u0, 1.0 / chi, u1)
    a, b = cross(tf, u), cross(te, u)
    # antisymmetric matrix of u, [u]x
    spin = ((0.0 * k, -u[2], u[1]), (u[2], 0.0 * k, -u[0]), (-u[1], u[0], 0.0 * k))
    for r in range(3):
        for c in range(3):
            delta = 1.0 if r == c else 0.0
            tt = 2.0 * k * t[r] * t[c]
            ee = (
                tt
                - a[r] * t[c]
                - t[r] * a[c]
                - k / chi * (delta - te[r] * te[c])
                + 0.25 * (kb[r] * u0[c] + u0[r] * kb[c])
            ) * (scale / (le * le))
            ff = (
                tt
                + b[r] * t[c]
                + t[r] * b[c]
                - k / chi * (delta - tf[r] * tf[c])
                + 0.25 * (kb[r] * u1[c] + u1[r] * kb[c])
            ) * (scale / (lf * lf))
            ef = (tt - a[r] * t[c] + t[r] * b[c] - k / chi * (delta + te[r] * tf[c]) - spin[r][c]) * (scale / (le * lf))
            fe = (tt - a[c] * t[r] + t[c] * b[r] - k / chi * (delta + te[c] * tf[r]) - spin[c][r]) * (scale / (le * lf))
            _add_blocks(h, r, c, ee, ef, fe, ff)
    for j in range(2):
        v = v0 if j == 0 else v1
        u_twist = u0 if j == 0 else u1
        weight = scale * p[4 + j]
        by_twist = dot(kb, v)
        by_e = combine(-0.5 * by_twist * weight / le, t, weight / (chi * le), cross(tf, v))
        by_f = combine(-0.5 * by_twist * weight / lf, t, -weight / (chi * lf), cross(te, v))
        for c in range(3):
            h[9 + j, c] -= by_e[c]
            h[9 + j, 3 + c] += by_e[c] - by_f[c]
            h[9 + j, 6 + c] += by_f[c]
        h[9 + j, 9 + j] -= 0.5 * scale * dot(kb, u_twist)


@formula
def bend_hessian(q, p, blend, h):  # type: ignore[no-untyped-def]
    """`2 B/L (dk dk^T + (1 - blend) (k - k0) d2k)` for both curvatures, the symmetric part (Bergou et al. 2010)."""
    te, tf, le, lf, chi = stencil_edges(q)
    n0, n1 = point(q, 3), point(q, 4)
    b0, b1 = cross(n0, te), cross(n1, tf)
    minus0, minus1 = multiply(-1.0, b0), multiply(-1.0, b1)
    d, d_plane = np.zeros_like(h[0]), np.zeros_like(h[0])
    width = _curvature_gradient(te, tf, le, lf, chi, b0, b1, n0, n1, p, d) - p[2]
    plane = _curvature_gradient(te, tf, le, lf, chi, n0, n1, minus0, minus1, p, d_plane) - p[3]
    for i in range(11):
        for j in range(i + 1):
            h[i, j] = 2.0 * (p[0] * d[i] * d[j] + p[1] * d_plane[i] * d_plane[j])
    exact = 2.0 * (1.0 - blend)
    _add_curvature_hessian(te, tf, le, lf, chi, b0, b1, n0, n1, p, exact * p[0] * width, h)
    _add_curvature_hessian(te, tf, le, lf, chi, n0, n1, minus0, minus1, p, exact * p[1] * plane, h)


class RodBend(Elements):
    """Bending of rod stencils.

    Parameters
    ----------
    inputs : (S, 15) coordinates of three vertices and two directors, see `stencil_inputs`.
    dofs : (S, 11) coordinates of three vertices and two twists.
    params : (S, 6) B_b/L and B_n/L (N mm), integrated rest curvatures k_b0 and k_n0 (rad), and the signs of the two
        edges: -1 if the stencil runs against the edge.

    A straight stencil with rest curvature k_b0 = 0.1 rad and B_b/L = 5 N mm; bent by that angle it has no energy:

    >>> params = np.array([[5.0, 50.0, 0.1, 0.0, 1.0, 1.0]])
    >>> rod = RodBend(np.arange(15)[None], np.arange(11)[None], params)
    >>> rod.energies(np.array([0, 0, 0, 1, 0, 0, 2, 0, 0, 0, 0, 1, 0, 0, 1.0])).round(6)
    array([0.05])
    >>> c, s = np.cos(0.05), np.sin(0.05)  # each edge falls by 0.05 rad: both tips down
    >>> bent = np.array([-c, 0, -s, 0, 0, 0, c, 0, -s, -s, 0, c, s, 0, c])
    >>> bool(rod.energies(bent)[0] < 1e-6)
    True
    """

    formulas = (bend_energy, bend_gradient, bend_hessian)
    sweep = staticmethod(sweep(15, 11, *formulas))


@formula
def _twist(te, tf, chi, n0, n1):  # type: ignore[no-untyped-def]
    """Twist angle m: from the first director, transported parallel to the second edge, to the second director."""
    transported = combine(1.0, n0, -dot(n0, tf) / chi, combine(1.0, te, 1.0, tf))
    return 2.0 * np.arctan(dot(cross(transported, n1), tf) / (1.0 + dot(transported, n1)))


@formula
def twist_energy(q, p):  # type: ignore[no-untyped-def]
    """`GJ (m - m0)^2/L` in N mm; p = (GJ/L, sign0, sign1, m0)."""
    te, tf, _, _, chi = stencil_edges(q)
    m = _twist(te, tf, chi, point(q, 3), point(q, 4)) - p[3]
    return p[0] * m * m


@formula
def twist_gradient(q, p, g):  # type: ignore[no-untyped-def]
    """`2 GJ/L (m - m0) dm` with `dm = kb/2 . (de/|e| + df/|f|) - dtheta0 + dtheta1` (Bergou et al. 2010)."""
    te, tf, le, lf, chi = stencil_edges(q)
    moment = 2.0 * p[0] * (_twist(te, tf, chi, point(q, 3), point(q, 4)) - p[3])
    kb = multiply(moment / chi, cross(te, tf))
    for i in range(3):
        g[i] = -kb[i] / le
        g[3 + i] = kb[i] / le - kb[i] / lf
        g[6 + i] = kb[i] / lf
    g[9] = -p[1] * moment
    g[10] = p[2] * moment


@formula
def twist_hessian(q, p, blend, h):  # type: ignore[no-untyped-def]
    """`2 GJ/L (dm dm^T + (1 - blend) (m - m0) d2m)`, the symmetric part (Bergou et al. 2010)."""
    te, tf, le, lf, chi = stencil_edges(q)
    m = _twist(te, tf, chi, point(q, 3), point(q, 4)) - p[3]
    kb = multiply(2.0 / chi, cross(te, tf))
    t = combine(1.0 / chi, te, 1.0 / chi, tf)
    d = np.zeros_like(h[0])
    for i in range(3):
        d[i] = -0.5 * kb[i] / le
        d[3 + i] = 0.5 * kb[i] / le - 0.5 * kb[i] / lf
        d[6 + i] = 0.5 * kb[i] / lf
    d[9] = d[9] - p[1]
    d[10] = d[10] + p[2]
    for i in range(11):
        for j in range(i + 1):
            h[i, j] = 2.0 * p[0] * d[i] * d[j]
    scale = 2.0 * (1.0 - blend) * p[0] * m
    at_e, at_f = combine(1.0, te, 1.0, t), combine(1.0, tf, 1.0, t)
    # antisymmetric matrix of the first tangent, [te]x
    spin = ((0.0 * m, -te[2], te[1]), (te[2], 0.0 * m, -te[0]), (-te[1], te[0], 0.0 * m))
    for r in range(3):
        for c in range(3):
            ee = -0.25 * scale / (le * le) * (kb[r] * at_e[c] + at_e[r] * kb[c])
            ff = -0.25 * scale / (lf * lf) * (kb[r] * at_f[c] + at_f[r] * kb[c])
            ef = 0.5 * scale / (le * lf) * (2.0 / chi * spin[r][c] - kb[r] * t[c])
            fe = 0.5 * scale / (le * lf) * (2.0 / chi * spin[c][r] - kb[c] * t[r])
            _add_blocks(h, r, c, ee, ef, fe, ff)


class RodTwist(Elements):
    """Twist of rod stencils.

    Parameters
    ----------
    inputs : (S, 15) coordinates of three vertices and two directors, see `stencil_inputs`.
    dofs : (S, 11) coordinates of three vertices and two twists.
    params : (S, 4) GJ/L (N mm), the signs of the two edges: -1 if the stencil runs against the edge, and the rest
        twist m0 (rad).

    Two edges in a line, the second director rotated by 0.1 rad, GJ/L = 5 N mm:

    >>> points, directors = [0, 0, 0, 1, 0, 0, 2, 0, 0], [0, 0, 1, 0, -np.sin(0.1), np.cos(0.1)]
    >>> rod = RodTwist(np.arange(15)[None], np.arange(11)[None], np.array([[5.0, 1.0, 1.0, 0.0]]))
    >>> rod.energies(np.array([*points, *directors])).round(6)
    array([0.05])
    """

    formulas = (twist_energy, twist_gradient, twist_hessian)
    sweep = staticmethod(sweep(15, 11, *formulas))
