"""Strains of a Koiter shell, forces of a stress and their tangent, at the quadrature points of all triangles.

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

The tangent is `int [ e'(x; v) : A : e'(x; w) + S : e''(x; v, w) ] dA` with stiffness A and stress S. Its element
matrices are added to the pattern of `fem.shell.assembly`.
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


@formula
def _covariant(basis, jet, dual, bends):  # type: ignore[no-untyped-def]
    """Write the covariant second derivatives D_11, D_22 and 2 D_12 of the basis functions to bends (3, m)."""
    for k in range(3):
        factor = 2.0 if k == 2 else 1.0
        symbol1, symbol2 = dot_3d(dual[0], jet[2 + k]), dot_3d(dual[1], jet[2 + k])
        for i in range(basis.shape[1]):
            bends[k, i] = factor * (basis[2 + k, i] - symbol1 * basis[0, i] - symbol2 * basis[1, i])


@formula
def _second_derivative(jet, dual, n, stiffness, stress, weight, h):  # type: ignore[no-untyped-def]
    """Write weight times `B' A B + S : e''` to h (5, 5, 6), as a form in v_,1, v_,2, D_11 v, D_22 v and 2 D_12 v.

    The last index counts the pairs of components of the position: 00, 10, 11, 20, 21, 22.
    """
    bend = weight * (
        stress[3] * dot_3d(n, jet[2]) + stress[4] * dot_3d(n, jet[3]) + 2.0 * stress[5] * dot_3d(n, jet[4])
    )
    pair = 0
    for c in range(3):
        for d in range(c + 1):
            part, both = h[:, :, pair], n[c] * n[d]
            for a in range(2):
                for b in range(2):
                    # A times the derivative of e by component c
                    stress1 = stiffness[b, a] * jet[a, c] + stiffness[b, 2] * jet[1 - a, c]
                    stress2 = stiffness[2, a] * jet[a, c] + stiffness[2, 2] * jet[1 - a, c]
                    value = stress1 * jet[b, d] + stress2 * jet[1 - b, d]
                    if c == d:
                        value += stress[a] if a == b else stress[2]
                    part[a, b] = weight * value - bend * dot_3d(dual[a], dual[b]) * both
                for k in range(3):
                    stress1 = stiffness[3 + k, a] * jet[a, c] + stiffness[3 + k, 2] * jet[1 - a, c]
                    stress2 = stiffness[3 + k, a] * jet[a, d] + stiffness[3 + k, 2] * jet[1 - a, d]
                    part[a, 2 + k] = weight * (stress1 * n[d] - stress[3 + k] * n[c] * dual[a, d])
                    part[2 + k, a] = weight * (stress2 * n[c] - stress[3 + k] * n[d] * dual[a, c])
            for k in range(3):
                for j in range(3):
                    part[2 + k, 2 + j] = weight * stiffness[3 + k, 3 + j] * both
            pair += 1


@loop
def tangent(table, dofs, weights, x, stiffness, stress, places, indptr, data):  # type: ignore[no-untyped-def]
    """Add the tangent to data (nnz,), for stiffness A (T, Q, 6, 6) and stress S (T, Q, 6).

    `places` (T, m (m + 1)/2) and `indptr` are those of the pattern of `fem.shell.assembly`.
    """
    points, m = table.shape[1], dofs.shape[1]
    local, jet, dual, n, h = np.empty((3, m)), np.empty((5, 3)), np.empty((2, 3)), np.empty(3), np.empty((5, 5, 6))
    basis, right, element = np.empty((points, 5, m)), np.empty((points, 5, m, 6)), np.empty((m, 6 * m))
    for t in range(table.shape[0]):
        gather_dofs(x, dofs[t], local)
        for q in range(points):
            jet_of(table[t, q], local, jet)
            frame_of(jet, dual, n)
            basis[q, :2] = table[t, q, :2]
            _covariant(table[t, q], jet, dual, basis[q, 2:])
            _second_derivative(jet, dual, n, stiffness[t, q], stress[t, q], weights[t, q], h)
            for a in range(5):
                form, product = h[a], right[q, a]
                for j in range(m):
                    b0, b1, b2, b3, b4 = basis[q, 0, j], basis[q, 1, j], basis[q, 2, j], basis[q, 3, j], basis[q, 4, j]
                    for pair in range(6):
                        product[j, pair] = (
                            b0 * form[0, pair] + b1 * form[1, pair] + b2 * form[2, pair]
                            + b3 * form[3, pair] + b4 * form[4, pair]
                        )  # fmt: skip
        # a third of the work: one dense product for all quadrature points, which BLAS does fastest
        np.dot(basis.reshape(5 * points, m).T, right.reshape(5 * points, 6 * m), element)
        _scatter(element.reshape(m, m, 6), dofs[t], places[t], indptr, data)


@formula
def _scatter(element, dofs, places, indptr, data):  # type: ignore[no-untyped-def]
    """Add the lower triangle of an element matrix (m, m, 6) to the data of the pattern of `fem.shell.assembly`.

    Its blocks have rows of component c and columns of component d, for the pairs (c, d) of `_second_derivative`.
    """
    entry = 0
    for i in range(dofs.shape[0]):
        for j in range(i + 1):
            place, low = places[entry], min(dofs[i], dofs[j])
            entry += 1
            row, column = (i, j) if place == 0 or dofs[i] > dofs[j] else (j, i)
            block, transposed = element[row, column], element[column, row]
            first, second, third = indptr[3 * low], indptr[3 * low + 1], indptr[3 * low + 2]
            if place:
                first, second, third = first + 3 * place, second + 3 * place - 1, third + 3 * place - 2
                data[first] += block[0]
                data[first + 1] += block[1]
                data[first + 2] += block[3]
                data[second] += transposed[1]
                data[second + 1] += block[2]
                data[second + 2] += block[4]
                data[third] += transposed[3]
                data[third + 1] += transposed[4]
                data[third + 2] += block[5]
            else:  # diagonal block: lower triangle only
                data[first] += block[0]
                data[first + 1] += block[1]
                data[first + 2] += block[3]
                data[second] += block[2]
                data[second + 1] += block[4]
                data[third] += block[5]
