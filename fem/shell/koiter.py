"""Strains of a Koiter shell and their first and second derivatives, at the quadrature points of all triangles.

`x` takes the printed sheet into space; with `g_a = x_a` (derivatives), `n = g_1 x g_2 / |g_1 x g_2|`,
`a_ab = g_a . g_b` and `b_ab = n . x_ab` the strains are half the change of `a` and the change of `b`,

    e = (E11, E22, 2 E12, K11, K22, 2 K12),    E = (a - a_r)/2,    K = b - b_r,

in printed coordinates, `2 E12` and `2 K12` as engineers write shear. A stress S is the derivative of the energy per
printed area by e. With the dual vectors `g^c`, `G^c_ab = g^c . x_ab` and the second derivatives along the surface
`D_ab f = f_ab - G^c_ab f_c`,

    db_ab  = n . D_ab dx
    d2b_ab = -2 (n . dg_c)(g^c . D_ab dx) - b_ab a^cd (n . dg_c)(n . dg_d)

(Ciarlet 2005, "An introduction to differential geometry", section 4.1 for the first.)
"""

from __future__ import annotations

import numpy as np

from equilibrium.compiled import formula, loop


@formula
def gather_dofs(x, dofs, own):  # type: ignore[no-untyped-def]
    """own (3, m): the dofs of a triangle, of x (N, 3)."""
    for i in range(dofs.shape[0]):
        for c in range(3):
            own[c, i] = x[dofs[i], c]


@formula
def jet_of(table, own, jet):  # type: ignore[no-untyped-def]
    """jet (5, 3): derivatives 1, 2, 11, 22, 12 of the position from the table (5, m) and dofs (3, m)."""
    for a in range(5):
        one = two = three = 0.0
        for i in range(own.shape[1]):
            one += table[a, i] * own[0, i]
            two += table[a, i] * own[1, i]
            three += table[a, i] * own[2, i]
        jet[a, 0], jet[a, 1], jet[a, 2] = one, two, three


@formula
def frame_of(jet, dual, n):  # type: ignore[no-untyped-def]
    """Dual vectors (2, 3) and unit normal (3,); not finite where the tangents are parallel."""
    n[0] = jet[0, 1] * jet[1, 2] - jet[0, 2] * jet[1, 1]
    n[1] = jet[0, 2] * jet[1, 0] - jet[0, 0] * jet[1, 2]
    n[2] = jet[0, 0] * jet[1, 1] - jet[0, 1] * jet[1, 0]
    area = np.sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2])
    a11 = jet[0, 0] * jet[0, 0] + jet[0, 1] * jet[0, 1] + jet[0, 2] * jet[0, 2]
    a22 = jet[1, 0] * jet[1, 0] + jet[1, 1] * jet[1, 1] + jet[1, 2] * jet[1, 2]
    a12 = jet[0, 0] * jet[1, 0] + jet[0, 1] * jet[1, 1] + jet[0, 2] * jet[1, 2]
    square = area * area
    for c in range(3):
        n[c] /= area
        dual[0, c] = (a22 * jet[0, c] - a12 * jet[1, c]) / square
        dual[1, c] = (a11 * jet[1, c] - a12 * jet[0, c]) / square
    return a11, a22, a12


@formula
def dot_3d(a, b):  # type: ignore[no-untyped-def]
    """Of two vectors in space."""
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


@loop
def strains(table, dofs, x, rest, out):  # type: ignore[no-untyped-def]
    """out (T, Q, 6): e of positions x (N, 3); rest (T, Q, 6) is what `(a/2, b)` is at rest, shear as in e."""
    own, jet, dual, n = np.empty((3, dofs.shape[1])), np.empty((5, 3)), np.empty((2, 3)), np.empty(3)
    for t in range(table.shape[0]):
        gather_dofs(x, dofs[t], own)
        for q in range(table.shape[1]):
            jet_of(table[t, q], own, jet)
            a11, a22, a12 = frame_of(jet, dual, n)
            e, r = out[t, q], rest[t, q]
            e[0], e[1], e[2] = 0.5 * a11 - r[0], 0.5 * a22 - r[1], a12 - r[2]
            e[3], e[4], e[5] = dot_3d(n, jet[2]) - r[3], dot_3d(n, jet[3]) - r[4], 2.0 * dot_3d(n, jet[4]) - r[5]


@loop
def strain_changes(table, dofs, x, move, out):  # type: ignore[no-untyped-def]
    """out (T, Q, 6): derivative of e at x along move (N, 3)."""
    own, moves = np.empty((3, dofs.shape[1])), np.empty((3, dofs.shape[1]))
    jet, change, dual, n = np.empty((5, 3)), np.empty((5, 3)), np.empty((2, 3)), np.empty(3)
    for t in range(table.shape[0]):
        gather_dofs(x, dofs[t], own)
        gather_dofs(move, dofs[t], moves)
        for q in range(table.shape[1]):
            jet_of(table[t, q], own, jet)
            jet_of(table[t, q], moves, change)
            frame_of(jet, dual, n)
            e = out[t, q]
            e[0], e[1] = dot_3d(jet[0], change[0]), dot_3d(jet[1], change[1])
            e[2] = dot_3d(jet[0], change[1]) + dot_3d(jet[1], change[0])
            one, two = dot_3d(n, change[0]), dot_3d(n, change[1])
            for k in range(3):
                factor = 2.0 if k == 2 else 1.0
                turned = dot_3d(dual[0], jet[2 + k]) * one + dot_3d(dual[1], jet[2 + k]) * two
                e[3 + k] = factor * (dot_3d(n, change[2 + k]) - turned)


@loop
def forces(table, dofs, weights, x, stress, out):  # type: ignore[no-untyped-def]
    """out (N, 3): derivative by x of the integral of stress (T, Q, 6) by e; added to what is there."""
    m = dofs.shape[1]
    jet, dual, n, pull = np.empty((5, 3)), np.empty((2, 3)), np.empty(3), np.empty((5, 3))
    own, total = np.empty((3, m)), np.empty((3, m))
    for t in range(table.shape[0]):
        gather_dofs(x, dofs[t], own)
        total[:] = 0.0
        for q in range(table.shape[1]):
            basis, s, weight = table[t, q], stress[t, q], weights[t, q]
            jet_of(basis, own, jet)
            frame_of(jet, dual, n)
            w = (weight * s[3], weight * s[4], 2.0 * weight * s[5])
            one = w[0] * dot_3d(dual[0], jet[2]) + w[1] * dot_3d(dual[0], jet[3]) + w[2] * dot_3d(dual[0], jet[4])
            two = w[0] * dot_3d(dual[1], jet[2]) + w[1] * dot_3d(dual[1], jet[3]) + w[2] * dot_3d(dual[1], jet[4])
            for c in range(3):
                pull[0, c] = weight * (s[0] * jet[0, c] + s[2] * jet[1, c]) - one * n[c]
                pull[1, c] = weight * (s[1] * jet[1, c] + s[2] * jet[0, c]) - two * n[c]
                for k in range(3):
                    pull[2 + k, c] = w[k] * n[c]
            b0, b1, b2, b3, b4 = basis[0], basis[1], basis[2], basis[3], basis[4]
            for c in range(3):
                line = total[c]
                p0, p1, p2, p3, p4 = pull[0, c], pull[1, c], pull[2, c], pull[3, c], pull[4, c]
                for i in range(m):
                    line[i] += p0 * b0[i] + p1 * b1[i] + p2 * b2[i] + p3 * b3[i] + p4 * b4[i]
        for i in range(m):
            for c in range(3):
                out[dofs[t, i], c] += total[c, i]
