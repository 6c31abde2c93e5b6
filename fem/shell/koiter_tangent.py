"""Tangent of a Koiter shell: `int [ e'(x; v) : A : e'(x; w) + S : e''(x; v, w) ] dA` with stiffness A and stress S.

Element matrices are added to the pattern of `fem.shell.assembly`. The notation is that of `fem.shell.koiter`.
"""

from __future__ import annotations

import numpy as np

from asterism.equilibrium.compiled import formula, loop
from asterism.fem.shell.koiter import dot_3d, frame_of, gather_dofs, jet_of


@formula
def covariant(basis, jet, dual, bends):  # type: ignore[no-untyped-def]
    """Write the covariant second derivatives D_11, D_22 and 2 D_12 of the basis functions to bends (3, m)."""
    for k in range(3):
        factor = 2.0 if k == 2 else 1.0
        symbol1, symbol2 = dot_3d(dual[0], jet[2 + k]), dot_3d(dual[1], jet[2 + k])
        for i in range(basis.shape[1]):
            bends[k, i] = factor * (basis[2 + k, i] - symbol1 * basis[0, i] - symbol2 * basis[1, i])


@formula
def second_derivative(jet, dual, n, stiffness, stress, weight, h):  # type: ignore[no-untyped-def]
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
            covariant(table[t, q], jet, dual, basis[q, 2:])
            second_derivative(jet, dual, n, stiffness[t, q], stress[t, q], weights[t, q], h)
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
        scatter(element.reshape(m, m, 6), dofs[t], places[t], indptr, data)


@formula
def scatter(element, dofs, places, indptr, data):  # type: ignore[no-untyped-def]
    """Add the lower triangle of an element matrix (m, m, 6) to the data of the pattern of `fem.shell.assembly`.

    Its blocks have rows of component c and columns of component d, for the pairs (c, d) of `second_derivative`.
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
