"""Second derivatives of a Koiter shell's energy: element matrices, added up in the pattern of `fem.shell.assembly`.

The notation is that of `fem.shell.koiter`.
"""

from __future__ import annotations

import numpy as np

from equilibrium.compiled import formula, loop
from fem.shell.koiter import dot_3d, frame_of, gather_dofs, jet_of


@formula
def covariant(basis, jet, dual, bends):  # type: ignore[no-untyped-def]
    """bends (3, m): second derivatives 11, 22 and twice 12 of the basis functions along the surface."""
    for k in range(3):
        factor = 2.0 if k == 2 else 1.0
        one, two = dot_3d(dual[0], jet[2 + k]), dot_3d(dual[1], jet[2 + k])
        for i in range(basis.shape[1]):
            bends[k, i] = factor * (basis[2 + k, i] - one * basis[0, i] - two * basis[1, i])


@formula
def second_derivative(jet, dual, n, stiffness, stress, weight, h):  # type: ignore[no-untyped-def]
    """h (6, 5, 5): weight times `B' A B` and the stress by second derivatives of e.

    By dx_1, dx_2 and the second derivatives of dx that `covariant` makes, one table for each pair of components of the
    position: 00, 10, 11, 20, 21, 22.
    """
    bend = weight * (
        stress[3] * dot_3d(n, jet[2]) + stress[4] * dot_3d(n, jet[3]) + 2.0 * stress[5] * dot_3d(n, jet[4])
    )
    pair = 0
    for c in range(3):
        for d in range(c + 1):
            part, both = h[pair], n[c] * n[d]
            for a in range(2):
                for b in range(2):
                    # A times the derivative of e by component c, and that by component d
                    one = stiffness[b, a] * jet[a, c] + stiffness[b, 2] * jet[1 - a, c]
                    two = stiffness[2, a] * jet[a, c] + stiffness[2, 2] * jet[1 - a, c]
                    value = one * jet[b, d] + two * jet[1 - b, d]
                    if c == d:
                        value += stress[a] if a == b else stress[2]
                    part[a, b] = weight * value - bend * dot_3d(dual[a], dual[b]) * both
                for k in range(3):
                    one = stiffness[3 + k, a] * jet[a, c] + stiffness[3 + k, 2] * jet[1 - a, c]
                    two = stiffness[3 + k, a] * jet[a, d] + stiffness[3 + k, 2] * jet[1 - a, d]
                    part[a, 2 + k] = weight * (one * n[d] - stress[3 + k] * n[c] * dual[a, d])
                    part[2 + k, a] = weight * (two * n[c] - stress[3 + k] * n[d] * dual[a, c])
            for k in range(3):
                for j in range(3):
                    part[2 + k, 2 + j] = weight * stiffness[3 + k, 3 + j] * both
            pair += 1


@loop
def tangent(table, dofs, weights, x, stiffness, stress, places, indptr, data):  # type: ignore[no-untyped-def]
    """Add to data (nnz,) the integral of `B' A B` and of stress by the second derivatives of e.

    stiffness A (T, Q, 6, 6), B the derivatives of e; places (T, m (m + 1)/2) as in `fem.shell.assembly`.
    """
    points, m = table.shape[1], dofs.shape[1]
    own, jet, dual, n, h = np.empty((3, m)), np.empty((5, 3)), np.empty((2, 3)), np.empty(3), np.empty((6, 5, 5))
    basis, right, element = np.empty((points, 5, m)), np.empty((points, 5, 6, m)), np.empty((m, 6 * m))
    for t in range(table.shape[0]):
        gather_dofs(x, dofs[t], own)
        for q in range(points):
            jet_of(table[t, q], own, jet)
            frame_of(jet, dual, n)
            basis[q, :2] = table[t, q, :2]
            covariant(table[t, q], jet, dual, basis[q, 2:])
            second_derivative(jet, dual, n, stiffness[t, q], stress[t, q], weights[t, q], h)
            b0, b1, b2, b3, b4 = basis[q, 0], basis[q, 1], basis[q, 2], basis[q, 3], basis[q, 4]
            for a in range(5):
                for pair in range(6):
                    line = right[q, a, pair]
                    h0, h1, h2, h3, h4 = h[pair, a, 0], h[pair, a, 1], h[pair, a, 2], h[pair, a, 3], h[pair, a, 4]
                    for j in range(m):
                        line[j] = h0 * b0[j] + h1 * b1[j] + h2 * b2[j] + h3 * b3[j] + h4 * b4[j]
        # one dense product for all quadrature points: half of the work is here, and BLAS does it fastest
        np.dot(basis.reshape(5 * points, m).T, right.reshape(5 * points, 6 * m), element)
        scatter(element.reshape(m, 6, m), dofs[t], places[t], indptr, data)


@formula
def scatter(element, dofs, places, indptr, data):  # type: ignore[no-untyped-def]
    """Add the lower triangle of an element matrix to the data of the pattern of `fem.shell.assembly`.

    element (m, 6, m): rows of component c and columns of component d, for the pairs of `second_derivative`.
    """
    entry = 0
    for i in range(dofs.shape[0]):
        for j in range(i + 1):
            place, low = places[entry], min(dofs[i], dofs[j])
            entry += 1
            row, column = (i, j) if place == 0 or dofs[i] > dofs[j] else (j, i)
            here, turned = element[row, :, column], element[column, :, row]
            first, second, third = indptr[3 * low], indptr[3 * low + 1], indptr[3 * low + 2]
            if place:
                first, second, third = first + 3 * place, second + 3 * place - 1, third + 3 * place - 2
                data[first] += here[0]
                data[first + 1] += here[1]
                data[first + 2] += here[3]
                data[second] += turned[1]
                data[second + 1] += here[2]
                data[second + 2] += here[4]
                data[third] += turned[3]
                data[third + 1] += turned[4]
                data[third + 2] += here[5]
            else:  # a dof with itself: rows below the diagonal only
                data[first] += here[0]
                data[first + 1] += here[1]
                data[first + 2] += here[3]
                data[second] += here[2]
                data[second + 1] += here[4]
                data[third] += here[5]
