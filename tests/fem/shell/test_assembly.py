"""Assembly and restriction to the free unknowns, against matrices assembled directly."""

from __future__ import annotations

import numpy as np
import scipy.sparse as sp

from asterism.fem.elements.argyris import Argyris
from asterism.fem.shell.assembly import Assembly, MatrixReduction
from tests.fem.meshes import rectangle


def full(pattern, data) -> np.ndarray:  # type: ignore[no-untyped-def]
    low = pattern.lower(data).toarray()
    return low + np.tril(low, -1).T


def test_restriction_is_the_triple_product() -> None:
    element = Argyris(rectangle(2, 2))
    assembly = Assembly(element.tabulate(4), element.size)
    random = np.random.default_rng(1)
    size = 3 * element.size
    free = np.sort(random.choice(size, size - 40, replace=False))
    columns = sp.lil_matrix((size, len(free)))
    columns[free, np.arange(len(free))] = 1.0
    for row in np.setdiff1d(np.arange(size), free)[:30]:  # some depend on others, some are held
        columns[row, random.choice(len(free), 3, replace=False)] = random.standard_normal(3)
    columns = columns.tocsr()
    reduced = MatrixReduction(assembly.pattern, columns)
    data = random.standard_normal(assembly.pattern.nnz)
    exact = columns.T @ full(assembly.pattern, data) @ columns
    assert np.allclose(full(reduced.pattern, reduced(data)), exact)
    assert (np.diff(reduced.pattern.indptr) > 0).all()
    assert (reduced.pattern.indices[reduced.pattern.diagonal] == np.arange(len(free))).all()


def test_without_supports_matrices_are_not_copied() -> None:
    element = Argyris(rectangle(2, 2))
    assembly = Assembly(element.tabulate(4), element.size)
    reduced = MatrixReduction(assembly.pattern, sp.identity(3 * element.size, format="csr"))
    assert reduced.pattern is assembly.pattern
    data = np.ones(assembly.pattern.nnz)
    assert reduced(data) is data
