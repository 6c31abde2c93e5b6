"""Bending of rods about their width and in the plane of the sheet (Bergou et al. 2010)."""

from __future__ import annotations

import numpy as np

from discrete.energies.elements import Elements
from discrete.energies.kernel import combine, cross, dot, formula, multiply, point, sweep
from discrete.energies.rods.stencil import stencil_edges


@formula
def _curvature(te, tf, chi, u0, u1):  # type: ignore[no-untyped-def]
    """Integrated curvature about the directors u: `kb . (u0 + u1)/2`."""
    return dot(cross(te, tf), combine(1.0, u0, 1.0, u1)) / chi


@formula
def bend_energy(q, p):  # type: ignore[no-untyped-def]
    """`(B_b (k_b - k_b0)^2 + B_n (k_n - k_n0)^2)/L`; p = (B_b/L, B_n/L, k_b0, k_n0, sign0, sign1)."""
    te, tf, _, _, chi = stencil_edges(q)
    n0, n1 = point(q, 3), point(q, 4)
    width = _curvature(te, tf, chi, cross(n0, te), cross(n1, tf)) - p[2]
    plane = _curvature(te, tf, chi, n0, n1) - p[3]
    return p[0] * width * width + p[1] * plane * plane


@formula
def _curvature_slope(te, tf, le, lf, chi, u0, u1, v0, v1, p, d):  # type: ignore[no-untyped-def]
    """Gradient d (11,) of the curvature about u; v is the derivative of u by its edge's twist."""
    k = _curvature(te, tf, chi, u0, u1)
    tilde_t, tilde_u = combine(1.0 / chi, te, 1.0 / chi, tf), combine(1.0 / chi, u0, 1.0 / chi, u1)
    by_e = combine(-k / le, tilde_t, 1.0 / le, cross(tf, tilde_u))
    by_f = combine(-k / lf, tilde_t, -1.0 / lf, cross(te, tilde_u))
    for i in range(3):
        d[i] = -by_e[i]
        d[3 + i] = by_e[i] - by_f[i]
        d[6 + i] = by_f[i]
    kb = multiply(2.0 / chi, cross(te, tf))
    # an edge that the stencil runs through backwards twists the other way
    d[9] = 0.5 * p[4] * dot(kb, v0)
    d[10] = 0.5 * p[5] * dot(kb, v1)
    return k


@formula
def bend_gradient(q, p, g):  # type: ignore[no-untyped-def]
    """Sum over the two curvatures of `2 B/L (k - k0) dk`."""
    te, tf, le, lf, chi = stencil_edges(q)
    n0, n1 = point(q, 3), point(q, 4)
    b0, b1 = cross(n0, te), cross(n1, tf)
    d = np.zeros_like(g)
    k = _curvature_slope(te, tf, le, lf, chi, b0, b1, n0, n1, p, d)
    for i in range(11):
        g[i] = 2.0 * p[0] * (k - p[2]) * d[i]
    k = _curvature_slope(te, tf, le, lf, chi, n0, n1, multiply(-1.0, b0), multiply(-1.0, b1), p, d)
    for i in range(11):
        g[i] += 2.0 * p[1] * (k - p[3]) * d[i]


@formula
def _curvature_bow(te, tf, le, lf, chi, u0, u1, v0, v1, p, scale, h):  # type: ignore[no-untyped-def]
    """Add `scale` times the second derivative of the curvature about u to h (lower triangle)."""
    k = _curvature(te, tf, chi, u0, u1)
    kb = multiply(2.0 / chi, cross(te, tf))
    t, u = combine(1.0 / chi, te, 1.0 / chi, tf), combine(1.0 / chi, u0, 1.0 / chi, u1)
    a, b = cross(tf, u), cross(te, u)
    # antisymmetric matrix of u, [u]x
    spin = ((0.0 * k, -u[2], u[1]), (u[2], 0.0 * k, -u[0]), (-u[1], u[0], 0.0 * k))
    for r in range(3):
        for c in range(3):
            one = 1.0 if r == c else 0.0
            tt = 2.0 * k * t[r] * t[c]
            ee = (
                tt
                - a[r] * t[c]
                - t[r] * a[c]
                - k / chi * (one - te[r] * te[c])
                + 0.25 * (kb[r] * u0[c] + u0[r] * kb[c])
            ) * (scale / (le * le))
            ff = (
                tt
                + b[r] * t[c]
                + t[r] * b[c]
                - k / chi * (one - tf[r] * tf[c])
                + 0.25 * (kb[r] * u1[c] + u1[r] * kb[c])
            ) * (scale / (lf * lf))
            ef = (tt - a[r] * t[c] + t[r] * b[c] - k / chi * (one + te[r] * tf[c]) - spin[r][c]) * (scale / (le * lf))
            fe = (tt - a[c] * t[r] + t[c] * b[r] - k / chi * (one + te[c] * tf[r]) - spin[c][r]) * (scale / (le * lf))
            # x0 enters e with -1, x1 enters e with +1 and f with -1, x2 enters f with +1
            h[r, c] += ee
            h[3 + r, c] += fe - ee
            h[3 + r, 3 + c] += ee - ef - fe + ff
            h[6 + r, c] -= fe
            h[6 + r, 3 + c] += fe - ff
            h[6 + r, 6 + c] += ff
    for j in range(2):
        v = v0 if j == 0 else v1
        u_twist = u0 if j == 0 else u1
        weight = scale * p[4 + j]
        turned = dot(kb, v)
        by_e = combine(-0.5 * turned * weight / le, t, weight / (chi * le), cross(tf, v))
        by_f = combine(-0.5 * turned * weight / lf, t, -weight / (chi * lf), cross(te, v))
        for c in range(3):
            h[9 + j, c] -= by_e[c]
            h[9 + j, 3 + c] += by_e[c] - by_f[c]
            h[9 + j, 6 + c] += by_f[c]
        h[9 + j, 9 + j] -= 0.5 * scale * dot(kb, u_twist)


@formula
def bend_hessian(q, p, blend, h):  # type: ignore[no-untyped-def]
    """`2 B/L (dk dk^T + (1 - blend) (k - k0) d2k)` for both curvatures (symmetric part, Bergou 2010)."""
    te, tf, le, lf, chi = stencil_edges(q)
    n0, n1 = point(q, 3), point(q, 4)
    b0, b1 = cross(n0, te), cross(n1, tf)
    minus0, minus1 = multiply(-1.0, b0), multiply(-1.0, b1)
    d, d_plane = np.zeros_like(h[0]), np.zeros_like(h[0])
    width = _curvature_slope(te, tf, le, lf, chi, b0, b1, n0, n1, p, d) - p[2]
    plane = _curvature_slope(te, tf, le, lf, chi, n0, n1, minus0, minus1, p, d_plane) - p[3]
    for i in range(11):
        for j in range(i + 1):
            h[i, j] = 2.0 * (p[0] * d[i] * d[j] + p[1] * d_plane[i] * d_plane[j])
    keep = 2.0 * (1.0 - blend)
    _curvature_bow(te, tf, le, lf, chi, b0, b1, n0, n1, p, keep * p[0] * width, h)
    _curvature_bow(te, tf, le, lf, chi, n0, n1, minus0, minus1, p, keep * p[1] * plane, h)


class RodBend(Elements):
    """Rod stencils; params (S, 6): B_b/L, B_n/L (N mm), rest curvatures k_b0, k_n0, signs of the two edges."""

    formulas = (bend_energy, bend_gradient, bend_hessian)
    sweep = staticmethod(sweep(15, 11, *formulas))
