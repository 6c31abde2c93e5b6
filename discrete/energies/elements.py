"""Elements of one kind, evaluated all at once: energies, gradients and Hessians from their formulas."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from asterism.equilibrium.arrays import Array


class Elements:
    """Elements of one kind. A subclass provides the three formulas of its energy and the compiled loop over them.

    Parameters
    ----------
    inputs : (E, m) indices into the packed configuration (positions, then directors) that an element reads.
    dofs : (E, n) indices of the dofs (positions, then twists) by which the energy is differentiated.
    params : (E, p) parameters of each element.
    """

    # energy (q, p), gradient (q, p, g) and Hessian (q, p, blend, h) of one element; the last two write to their last
    # argument.
    formulas: tuple[Callable[..., Any], Callable[..., Any], Callable[..., Any]]
    sweep: Callable[..., None]  # compiled loop over the elements, from `discrete.energies.kernel.sweep`

    def __init__(self, inputs: Array, dofs: Array, params: Array) -> None:
        self.inputs = np.ascontiguousarray(inputs, dtype=np.int32)
        self.dofs = np.ascontiguousarray(dofs, dtype=np.int32)
        self.params = np.ascontiguousarray(params, dtype=float)

    def __len__(self) -> int:
        return len(self.inputs)

    @property
    def dofs_per_element(self) -> int:
        """Number n of dofs of one element."""
        return int(self.dofs.shape[1])

    def energies(self, configuration: Array) -> Array:
        """(E,) N mm, energy of each element in a packed configuration."""
        out = np.empty(len(self))
        self._sweep(configuration, 0, out, _NONE, _NONE)
        return out

    def gradients(self, configuration: Array) -> Array:
        """(E, n) N or N mm, derivatives of each element's energy by its dofs."""
        out = np.zeros((len(self), self.dofs_per_element))
        self._sweep(configuration, 1, _NONE[0], out, _NONE)
        return out

    def hessians(self, configuration: Array, blend: float = 0.0, rows: slice = slice(None)) -> Array:
        """(E, n (n + 1)/2) lower triangles of the element Hessians, row by row, of all elements or a slice of them.

        `blend` is the share of the possibly indefinite terms that is left out: 0 gives the exact Hessian, 1 a positive
        semidefinite one.
        """
        inputs, params = self.inputs[rows], self.params[rows]
        out = np.empty((len(inputs), self.dofs_per_element * (self.dofs_per_element + 1) // 2))
        type(self).sweep(configuration, inputs, params, 2, blend, _NONE[0], _NONE, out)
        return out

    def _sweep(self, configuration: Array, order: int, *out: Array) -> None:
        type(self).sweep(configuration, self.inputs, self.params, order, 0.0, *out)


_NONE = np.empty((1, 1))
