"""Energies, gradients and Hessians of elements from their formulas on arrays; complex numbers pass through."""

from __future__ import annotations

import numpy as np

from asterism.discrete.energies.elements import Elements
from asterism.equilibrium.arrays import Array


def plain_energies(elements: Elements, configuration: Array) -> Array:
    """As `Elements.energies`."""
    return np.asarray(elements.formulas[0](configuration[elements.inputs.T], elements.params.T))


def plain_gradients(elements: Elements, configuration: Array) -> Array:
    """As `Elements.gradients`."""
    g = np.zeros((elements.dofs_per_element, len(elements)), dtype=configuration.dtype)
    elements.formulas[1](configuration[elements.inputs.T], elements.params.T, g)
    return g.T


def plain_hessians(elements: Elements, configuration: Array, blend: float = 0.0) -> Array:
    """As `Elements.hessians`."""
    n = elements.dofs_per_element
    h = np.zeros((n, n, len(elements)), dtype=configuration.dtype)
    elements.formulas[2](configuration[elements.inputs.T], elements.params.T, blend, h)
    i, j = np.tril_indices(n)
    return h[i, j].T


def full(packed: Array) -> Array:
    """(E, n, n) symmetric matrices of packed lower triangles."""
    n = int(np.sqrt(2 * packed.shape[1]))
    out = np.zeros((len(packed), n, n), dtype=packed.dtype)
    rows, columns = np.tril_indices(n)
    out[:, rows, columns] = out[:, columns, rows] = packed
    return out
