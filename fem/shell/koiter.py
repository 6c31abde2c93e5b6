"""Strains of a Koiter shell and the forces of a stress, at the quadrature points of all triangles.

Let x map the printed sheet into space, with tangents `g_a = x_,a` and normal `n = g_1 x g_2/|g_1 x g_2|`. The first and
second fundamental forms are `a_ab = g_a . g_b` and `b_ab = n . x_,ab`. The strains are

    e = (E11, E22, 2 E12, K11, K22, 2 K12),    E = (a - a_r)/2,    K = b - b_r,

in printed coordinates, with engineering shears 2 E12 and 2 K12. The stress `S = dW/de` belongs to the energy W per
printed area. The weak form of equilibrium is `int S : e'(x; v) dA = loads(v)` for all admissible v, with

    dE_ab  = (g_a . v_,b + g_b . v_,a)/2
    db_ab  = n . D_ab v,                      D_ab v = v_,ab - G^c_ab v_,c,    G^c_ab = g^c . x_,ab
    d2b_ab = -2 (n . v_,c)(g^c . D_ab v) - b_ab a^cd (n . v_,c)(n . v_,d)

and the dual vectors g^c (Ciarlet 2005, "An introduction to differential geometry", section 4.1, for the first two).

Arrays: a table (T, Q, 5, m) has the derivatives 1, 2, 11, 22, 12 of the basis functions; dofs are (T, m).
"""

from __future__ import annotations

import numpy as np

from asterism.equilibrium.compiled import formula, loop, sum_formula


@formula
def gather_dofs(x, dofs, local):  # type: ignore[no-untyped-def]
    """Write the rows `dofs` (m,) of x (N, 3) to local (3, m)."""
    for i in range(dofs.shape[0]):
        for c in range(3):
            local[c, i] = x[dofs[i], c]


@sum_formula
def jet_of(table, local, jet):  # type: ignore[no-untyped-def]
    """Write the derivatives 1, 2, 11, 22, 12 of the position to jet (5, 3), from table (5, m) and local (3, m)."""
    for a in range(5):
        x1 = x2 = x3 = 0.0
        for i in range(local.shape[1]):
            x1 += table[a, i] * local[0, i]
            x2 += table[a, i] * local[1, i]
            x3 += table[a, i] * local[2, i]
        jet[a, 0], jet[a, 1], jet[a, 2] = x1, x2, x3


@formula
def frame_of(jet, dual, n):  # type: ignore[no-untyped-def]
    """Write the dual vectors (2, 3) and the unit normal n (3,); return a11, a22, a12. Parallel tangents give nan."""
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
    """a . b."""
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


@loop
def strains(table, dofs, x, rest, out):  # type: ignore[no-untyped-def]
    """Write the strains e of positions x (N, 3) to out (T, Q, 6).

    `rest` (T, Q, 6) holds `(a_r/2, b_r)` in the components of e.
    """
    local, jet, dual, n = np.empty((3, dofs.shape[1])), np.empty((5, 3)), np.empty((2, 3)), np.empty(3)
    for t in range(table.shape[0]):
        gather_dofs(x, dofs[t], local)
        for q in range(table.shape[1]):
            jet_of(table[t, q], local, jet)
            a11, a22, a12 = frame_of(jet, dual, n)
            e, r = out[t, q], rest[t, q]
            e[0], e[1], e[2] = 0.5 * a11 - r[0], 0.5 * a22 - r[1], a12 - r[2]
            e[3], e[4], e[5] = dot_3d(n, jet[2]) - r[3], dot_3d(n, jet[3]) - r[4], 2.0 * dot_3d(n, jet[4]) - r[5]


@loop
def strain_changes(table, dofs, x, move, out):  # type: ignore[no-untyped-def]
    """Write the derivative of e at x (N, 3) along `move` (N, 3) to out (T, Q, 6)."""
    local, moves = np.empty((3, dofs.shape[1])), np.empty((3, dofs.shape[1]))
    jet, change, dual, n = np.empty((5, 3)), np.empty((5, 3)), np.empty((2, 3)), np.empty(3)
    for t in range(table.shape[0]):
        gather_dofs(x, dofs[t], local)
        gather_dofs(move, dofs[t], moves)
        for q in range(table.shape[1]):
            jet_of(table[t, q], local, jet)
            jet_of(table[t, q], moves, change)
            frame_of(jet, dual, n)
            e = out[t, q]
            e[0], e[1] = dot_3d(jet[0], change[0]), dot_3d(jet[1], change[1])
            e[2] = dot_3d(jet[0], change[1]) + dot_3d(jet[1], change[0])
            rise1, rise2 = dot_3d(n, change[0]), dot_3d(n, change[1])
            for k in range(3):
                factor = 2.0 if k == 2 else 1.0
                rotation = dot_3d(dual[0], jet[2 + k]) * rise1 + dot_3d(dual[1], jet[2 + k]) * rise2
                e[3 + k] = factor * (dot_3d(n, change[2 + k]) - rotation)


@loop
def forces(table, dofs, weights, x, stress, out):  # type: ignore[no-untyped-def]
    """Add the forces `int S : e'(x)` of a stress (T, Q, 6) to out (N, 3)."""
    m = dofs.shape[1]
    jet, dual, n, pull = np.empty((5, 3)), np.empty((2, 3)), np.empty(3), np.empty((5, 3))
    local, total = np.empty((3, m)), np.empty((3, m))
    for t in range(table.shape[0]):
        gather_dofs(x, dofs[t], local)
        total[:] = 0.0
        for q in range(table.shape[1]):
            basis, s, weight = table[t, q], stress[t, q], weights[t, q]
            jet_of(basis, local, jet)
            frame_of(jet, dual, n)
            w = (weight * s[3], weight * s[4], 2.0 * weight * s[5])
            lift1 = w[0] * dot_3d(dual[0], jet[2]) + w[1] * dot_3d(dual[0], jet[3]) + w[2] * dot_3d(dual[0], jet[4])
            lift2 = w[0] * dot_3d(dual[1], jet[2]) + w[1] * dot_3d(dual[1], jet[3]) + w[2] * dot_3d(dual[1], jet[4])
            for c in range(3):
                pull[0, c] = weight * (s[0] * jet[0, c] + s[2] * jet[1, c]) - lift1 * n[c]
                pull[1, c] = weight * (s[1] * jet[1, c] + s[2] * jet[0, c]) - lift2 * n[c]
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
