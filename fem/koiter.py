"""Strains of a Koiter shell and their first and second derivatives, at the quadrature points of all triangles.

`x` takes the printed sheet into space; with `g_a = x_a` (derivatives), `n = g_1 x g_2 / |g_1 x g_2|`,
`a_ab = g_a . g_b` and `b_ab = n . x_ab` the strains are half the change of `a` and the change of `b`,

    e = (E11, E22, 2 E12, K11, K22, 2 K12),    E = (a - a_r)/2,    K = b - b_r,

in printed coordinates, `2 E12` and `2 K12` as engineers write shear. A stress S is the derivative of the energy per
printed area by e. With the dual vectors `g^c` and `G^c_ab = g^c . x_ab`,

    db_ab  = n . (dx_ab - G^c_ab dg_c)
    d2b_ab = -2 (n . dg_c)(g^c . dx_ab) + 2 (n . dg_d)(g^d . dg_c) G^c_ab - b_ab a^cd (n . dg_c)(n . dg_d)

(Ciarlet 2005, "An introduction to differential geometry", section 4.1 for the first.)
"""

from __future__ import annotations

import numpy as np

from equilibrium.compiled import formula, loop


@formula
def jet_of(table, x, dofs, jet):  # type: ignore[no-untyped-def]
    """jet (5, 3): derivatives 1, 2, 11, 22, 12 of the position from the table (5, m) and dofs x (N, 3)."""
    for a in range(5):
        for c in range(3):
            jet[a, c] = 0.0
    for i in range(dofs.shape[0]):
        for c in range(3):
            value = x[dofs[i], c]
            for a in range(5):
                jet[a, c] += table[a, i] * value


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
def dot(a, b):  # type: ignore[no-untyped-def]
    """Of two vectors in space."""
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


@formula
def strain_rows(jet, dual, n, rows):  # type: ignore[no-untyped-def]
    """rows (6, 15): derivatives of e by the jet, its components running fastest."""
    rows[:] = 0.0
    for c in range(3):
        rows[0, c] = jet[0, c]
        rows[1, 3 + c] = jet[1, c]
        rows[2, c] = jet[1, c]
        rows[2, 3 + c] = jet[0, c]
    for k in range(3):
        factor = 2.0 if k == 2 else 1.0
        one, two = dot(dual[0], jet[2 + k]), dot(dual[1], jet[2 + k])
        for c in range(3):
            rows[3 + k, 6 + 3 * k + c] = factor * n[c]
            rows[3 + k, c] = -factor * one * n[c]
            rows[3 + k, 3 + c] = -factor * two * n[c]


@formula
def add_geometric(jet, dual, n, stress, weight, h):  # type: ignore[no-untyped-def]
    """Add weight times the sum of stress (6,) by second derivatives of e to h (15, 15)."""
    w = (stress[3], stress[4], 2.0 * stress[5])
    membrane = ((stress[0], stress[2]), (stress[2], stress[1]))
    bend = w[0] * dot(n, jet[2]) + w[1] * dot(n, jet[3]) + w[2] * dot(n, jet[4])
    for a in range(2):
        turn_a = w[0] * dot(dual[a], jet[2]) + w[1] * dot(dual[a], jet[3]) + w[2] * dot(dual[a], jet[4])
        for b in range(2):
            turn_b = w[0] * dot(dual[b], jet[2]) + w[1] * dot(dual[b], jet[3]) + w[2] * dot(dual[b], jet[4])
            both = bend * dot(dual[a], dual[b])
            for c in range(3):
                h[3 * a + c, 3 * b + c] += weight * membrane[a][b]
                for d in range(3):
                    h[3 * a + c, 3 * b + d] += weight * (
                        turn_b * n[c] * dual[a, d] + turn_a * dual[b, c] * n[d] - both * n[c] * n[d]
                    )
        for k in range(3):
            for c in range(3):
                for d in range(3):
                    value = weight * w[k] * n[c] * dual[a, d]
                    h[3 * a + c, 6 + 3 * k + d] -= value
                    h[6 + 3 * k + d, 3 * a + c] -= value


@loop
def strains(table, dofs, x, rest, out):  # type: ignore[no-untyped-def]
    """out (T, Q, 6): e of positions x (N, 3); rest (T, Q, 6) is what `(a/2, b)` is at rest, shear as in e."""
    jet, dual, n = np.empty((5, 3)), np.empty((2, 3)), np.empty(3)
    for t in range(table.shape[0]):
        for q in range(table.shape[1]):
            jet_of(table[t, q], x, dofs[t], jet)
            a11, a22, a12 = frame_of(jet, dual, n)
            e, r = out[t, q], rest[t, q]
            e[0], e[1], e[2] = 0.5 * a11 - r[0], 0.5 * a22 - r[1], a12 - r[2]
            e[3], e[4], e[5] = dot(n, jet[2]) - r[3], dot(n, jet[3]) - r[4], 2.0 * dot(n, jet[4]) - r[5]


@loop
def strain_changes(table, dofs, x, move, out):  # type: ignore[no-untyped-def]
    """out (T, Q, 6): derivative of e at x along move (N, 3)."""
    jet, change, dual, n, rows = np.empty((5, 3)), np.empty((5, 3)), np.empty((2, 3)), np.empty(3), np.empty((6, 15))
    for t in range(table.shape[0]):
        for q in range(table.shape[1]):
            jet_of(table[t, q], x, dofs[t], jet)
            jet_of(table[t, q], move, dofs[t], change)
            frame_of(jet, dual, n)
            strain_rows(jet, dual, n, rows)
            for k in range(6):
                out[t, q, k] = 0.0
                for a in range(5):
                    for c in range(3):
                        out[t, q, k] += rows[k, 3 * a + c] * change[a, c]


@loop
def forces(table, dofs, weights, x, stress, out):  # type: ignore[no-untyped-def]
    """out (N, 3): derivative by x of the integral of stress (T, Q, 6) by e; added to what is there."""
    m = dofs.shape[1]
    jet, dual, n, rows, pull = np.empty((5, 3)), np.empty((2, 3)), np.empty(3), np.empty((6, 15)), np.empty(15)
    own = np.empty((3, m))
    for t in range(table.shape[0]):
        own[:] = 0.0
        for q in range(table.shape[1]):
            basis = table[t, q]
            jet_of(basis, x, dofs[t], jet)
            frame_of(jet, dual, n)
            strain_rows(jet, dual, n, rows)
            for i in range(15):
                pull[i] = 0.0
                for k in range(6):
                    pull[i] += weights[t, q] * stress[t, q, k] * rows[k, i]
            b0, b1, b2, b3, b4 = basis[0], basis[1], basis[2], basis[3], basis[4]
            for c in range(3):
                line = own[c]
                p0, p1, p2, p3, p4 = pull[c], pull[3 + c], pull[6 + c], pull[9 + c], pull[12 + c]
                for i in range(m):
                    line[i] += p0 * b0[i] + p1 * b1[i] + p2 * b2[i] + p3 * b3[i] + p4 * b4[i]
        for i in range(m):
            for c in range(3):
                out[dofs[t, i], c] += own[c, i]


@loop
def tangent(table, dofs, weights, x, stiffness, stress, places, indptr, data):  # type: ignore[no-untyped-def]
    """Add to data (nnz,) the integral of `B' A B` and of stress by the second derivatives of e.

    stiffness A (T, Q, 6, 6), B the derivatives of e; places (T, m (m + 1)/2) as in `fem.assembly`.
    """
    m = dofs.shape[1]
    jet, dual, n = np.empty((5, 3)), np.empty((2, 3)), np.empty(3)
    rows, scaled, h = np.empty((6, 15)), np.empty((6, 15)), np.empty((15, 15))
    right, element = np.empty((15, 3 * m)), np.empty((3 * m, 3 * m))
    for t in range(table.shape[0]):
        element[:] = 0.0
        for q in range(table.shape[1]):
            basis = table[t, q]
            jet_of(basis, x, dofs[t], jet)
            frame_of(jet, dual, n)
            strain_rows(jet, dual, n, rows)
            for k in range(6):
                for i in range(15):
                    value = 0.0
                    for j in range(6):
                        value += stiffness[t, q, k, j] * rows[j, i]
                    scaled[k, i] = weights[t, q] * value
            for i in range(15):
                for j in range(15):
                    value = 0.0
                    for k in range(6):
                        value += rows[k, i] * scaled[k, j]
                    h[i, j] = value
            add_geometric(jet, dual, n, stress[t, q], weights[t, q], h)
            for i in range(15):
                for j in range(m):
                    for d in range(3):
                        value = 0.0
                        for b in range(5):
                            value += h[i, 3 * b + d] * basis[b, j]
                        right[i, 3 * j + d] = value
            for i in range(m):
                b0, b1, b2, b3, b4 = basis[0, i], basis[1, i], basis[2, i], basis[3, i], basis[4, i]
                for c in range(3):
                    line = element[3 * i + c]
                    r0, r1, r2, r3, r4 = right[c], right[3 + c], right[6 + c], right[9 + c], right[12 + c]
                    for k in range(3 * i + 3):
                        line[k] += b0 * r0[k] + b1 * r1[k] + b2 * r2[k] + b3 * r3[k] + b4 * r4[k]
        scatter(element, dofs[t], places[t], indptr, data)


@formula
def scatter(element, dofs, places, indptr, data):  # type: ignore[no-untyped-def]
    """Add the lower triangle of an element matrix (3 m, 3 m) to the data of the pattern of `fem.assembly`."""
    pair = 0
    for i in range(dofs.shape[0]):
        for j in range(i + 1):
            place = places[pair]
            pair += 1
            low = min(dofs[i], dofs[j])
            for c in range(3):
                for d in range(3):
                    value = element[3 * i + c, 3 * j + d]
                    if place == 0:  # a dof with itself: rows below the diagonal only
                        if c >= d:
                            data[indptr[3 * low + d] + c - d] += value
                    elif dofs[i] > dofs[j]:
                        data[indptr[3 * low + d] + 3 * place - d + c] += value
                    else:
                        data[indptr[3 * low + c] + 3 * place - c + d] += value
