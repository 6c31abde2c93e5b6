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
def covariant(basis, jet, dual, bends):  # type: ignore[no-untyped-def]
    """bends (3, m): second derivatives 11, 22 and twice 12 of the basis functions along the surface."""
    for k in range(3):
        factor = 2.0 if k == 2 else 1.0
        one, two = dot(dual[0], jet[2 + k]), dot(dual[1], jet[2 + k])
        for i in range(basis.shape[1]):
            bends[k, i] = factor * (basis[2 + k, i] - one * basis[0, i] - two * basis[1, i])


@formula
def second_derivative(jet, dual, n, stiffness, stress, weight, h):  # type: ignore[no-untyped-def]
    """h (15, 15): weight times `B' A B` and the stress by second derivatives of e.

    By the components, running fastest, of dx_1, dx_2 and the second derivatives of dx that `covariant` makes.
    """
    pull = np.empty(6)
    bend = stress[3] * dot(n, jet[2]) + stress[4] * dot(n, jet[3]) + 2.0 * stress[5] * dot(n, jet[4])
    for a in range(2):
        for c in range(3):
            for k in range(6):  # A times the derivative of e by this component
                pull[k] = weight * (stiffness[k, a] * jet[a, c] + stiffness[k, 2] * jet[1 - a, c])
            for b in range(2):
                both = weight * bend * dot(dual[a], dual[b])
                for d in range(3):
                    h[3 * a + c, 3 * b + d] = jet[b, d] * pull[b] + jet[1 - b, d] * pull[2] - both * n[c] * n[d]
                h[3 * a + c, 3 * b + c] += weight * (stress[a] if a == b else stress[2])
            for k in range(3):
                for d in range(3):
                    value = pull[3 + k] * n[d] - weight * stress[3 + k] * n[c] * dual[a, d]
                    h[3 * a + c, 6 + 3 * k + d] = h[6 + 3 * k + d, 3 * a + c] = value
    for k in range(3):
        for j in range(3):
            for c in range(3):
                for d in range(3):
                    h[6 + 3 * k + c, 6 + 3 * j + d] = weight * stiffness[3 + k, 3 + j] * n[c] * n[d]


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
    jet, change, dual, n = np.empty((5, 3)), np.empty((5, 3)), np.empty((2, 3)), np.empty(3)
    for t in range(table.shape[0]):
        for q in range(table.shape[1]):
            jet_of(table[t, q], x, dofs[t], jet)
            jet_of(table[t, q], move, dofs[t], change)
            frame_of(jet, dual, n)
            e = out[t, q]
            e[0], e[1] = dot(jet[0], change[0]), dot(jet[1], change[1])
            e[2] = dot(jet[0], change[1]) + dot(jet[1], change[0])
            one, two = dot(n, change[0]), dot(n, change[1])
            for k in range(3):
                factor = 2.0 if k == 2 else 1.0
                turned = dot(dual[0], jet[2 + k]) * one + dot(dual[1], jet[2 + k]) * two
                e[3 + k] = factor * (dot(n, change[2 + k]) - turned)


@loop
def forces(table, dofs, weights, x, stress, out):  # type: ignore[no-untyped-def]
    """out (N, 3): derivative by x of the integral of stress (T, Q, 6) by e; added to what is there."""
    m = dofs.shape[1]
    jet, dual, n, pull = np.empty((5, 3)), np.empty((2, 3)), np.empty(3), np.empty((5, 3))
    own = np.empty((3, m))
    for t in range(table.shape[0]):
        own[:] = 0.0
        for q in range(table.shape[1]):
            basis, s, weight = table[t, q], stress[t, q], weights[t, q]
            jet_of(basis, x, dofs[t], jet)
            frame_of(jet, dual, n)
            w = (weight * s[3], weight * s[4], 2.0 * weight * s[5])
            one = w[0] * dot(dual[0], jet[2]) + w[1] * dot(dual[0], jet[3]) + w[2] * dot(dual[0], jet[4])
            two = w[0] * dot(dual[1], jet[2]) + w[1] * dot(dual[1], jet[3]) + w[2] * dot(dual[1], jet[4])
            for c in range(3):
                pull[0, c] = weight * (s[0] * jet[0, c] + s[2] * jet[1, c]) - one * n[c]
                pull[1, c] = weight * (s[1] * jet[1, c] + s[2] * jet[0, c]) - two * n[c]
                for k in range(3):
                    pull[2 + k, c] = w[k] * n[c]
            b0, b1, b2, b3, b4 = basis[0], basis[1], basis[2], basis[3], basis[4]
            for c in range(3):
                line = own[c]
                p0, p1, p2, p3, p4 = pull[0, c], pull[1, c], pull[2, c], pull[3, c], pull[4, c]
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
    wide = 8 * ((3 * m + 7) // 8)  # whole vectors of the processor: what is beyond 3 m is not used
    jet, dual, n, h = np.empty((5, 3)), np.empty((2, 3)), np.empty(3), np.empty((15, 15))
    basis, right, element = np.empty((5, m)), np.zeros((15, wide)), np.empty((3 * m, wide))
    for t in range(table.shape[0]):
        element[:] = 0.0
        for q in range(table.shape[1]):
            jet_of(table[t, q], x, dofs[t], jet)
            frame_of(jet, dual, n)
            basis[:2] = table[t, q, :2]
            covariant(table[t, q], jet, dual, basis[2:])
            second_derivative(jet, dual, n, stiffness[t, q], stress[t, q], weights[t, q], h)
            for i in range(15):
                for j in range(m):
                    for d in range(3):
                        value = 0.0
                        for b in range(5):
                            value += h[i, 3 * b + d] * basis[b, j]
                        right[i, 3 * j + d] = value
            for i in range(m):
                b0, b1, b2, b3, b4 = basis[0, i], basis[1, i], basis[2, i], basis[3, i], basis[4, i]
                end = 8 * ((3 * i + 10) // 8)
                for c in range(3):
                    line = element[3 * i + c]
                    r0, r1, r2, r3, r4 = right[c], right[3 + c], right[6 + c], right[9 + c], right[12 + c]
                    for k in range(end):
                        line[k] += b0 * r0[k] + b1 * r1[k] + b2 * r2[k] + b3 * r3[k] + b4 * r4[k]
        scatter(element, dofs[t], places[t], indptr, data)


@formula
def scatter(element, dofs, places, indptr, data):  # type: ignore[no-untyped-def]
    """Add the lower triangle of an element matrix (3 m, 3 m) to the data of the pattern of `fem.assembly`."""
    pair = 0
    for i in range(dofs.shape[0]):
        for j in range(i + 1):
            place, low = places[pair], min(dofs[i], dofs[j])
            lower = place == 0 or dofs[i] > dofs[j]
            pair += 1
            for d in range(3):
                start = indptr[3 * low + d] + 3 * place - d
                for c in range(0 if place else d, 3):  # a dof with itself: rows below the diagonal only
                    data[start + c] += element[3 * i + c, 3 * j + d] if lower else element[3 * i + d, 3 * j + c]
