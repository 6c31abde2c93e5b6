"""Koiter shells on scikit-fem meshes: elements, energy, supports and loads, search for equilibria.

Find the position x of the sheet, a map of the printed domain into space, that minimises

    Pi(x) = int W(E(x), K(x)) dA - loads(x),    so that    int S : e'(x; v) dA = loads(v)    for all admissible v,

with the strains `e = (E, K)` (`fem.shell.koiter`), the energy density W and its derivative S (`fem.shell.density`).
The input is a set of fields over the printed domain: rest metric, rest curvature, density. Stars do not occur here.

Rooms: `elements` (discretisation and dead loads), `shell` (energy and its derivatives), `supports` (boundary
conditions), `search` (initial guesses, equilibria, response).

Units: mm, N, N mm, rad. Array sizes in docstrings: N scalar dofs, n free unknowns or points, T triangles, Q quadrature
points of a triangle, m basis functions of a triangle. Derivatives come in the order 1, 2, 11, 22, 12.
"""
