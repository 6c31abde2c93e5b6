"""The mass of a supported sheet: as an operator, in the pattern of the Hessian, and as a full matrix."""

from __future__ import annotations

import numpy as np
import scipy.sparse as sp

from asterism.fem.elements.argyris import Argyris
from asterism.fem.shell.shell import Shell
from asterism.fem.supports.conditions import EdgeSupport
from tests.fem.hexagons import FIELDS, hexagon


def test_mass_of_a_supported_sheet() -> None:
    mesh = hexagon(1)
    shell = Shell(Argyris(mesh), FIELDS["dome"], [EdgeSupport(mesh.boundary_facets()[:3])])
    table = shell.space.tabulate(shell.order)
    functions = sp.csr_matrix((table.values.size // table.values.shape[2], shell.space.size)).tolil()
    for row, (dofs, values) in enumerate(
        zip(table.dofs.repeat(table.values.shape[1], axis=0), table.values.reshape(-1, 21), strict=True)
    ):
        functions[row, dofs] = values
    scalar = functions.T @ sp.diags_array(table.weights.ravel()) @ functions
    full = shell.reduction.map.T @ sp.kron(scalar, sp.identity(3)) @ shell.reduction.map
    vectors = np.random.default_rng(0).standard_normal((shell.pattern.size, 2))
    right = full @ vectors
    assert np.allclose(shell.mass @ vectors, right, rtol=1e-12, atol=1e-12 * np.abs(right).max())
    assert np.allclose(shell.pattern.product(shell.mass_entries, vectors), right, atol=1e-12 * np.abs(right).max())
