"""Common ground of the energies: many equal elements, their inputs, dofs and parameters."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import NDArray

from discrete.energies.kernel import HAVE_NUMBA

Array = NDArray[Any]


class Elements:
    """Elements of one kind, evaluated all at once.

    Parameters
    ----------
    inputs : (E, m) indices into the packed configuration (positions, then directors) that one element reads.
    dofs : (E, n) indices of the dofs (positions, then twists) that its derivatives belong to.
    params : (E, p) numbers of each element.
    compiled : use the compiled loop; the plain numpy path otherwise.

    Subclasses give the three formulas and the compiled loop over them.
    """

    formulas: tuple[Callable[..., Any], Callable[..., Any], Callable[..., Any]]
    sweep: Callable[..., None]

    def __init__(self, inputs: Array, dofs: Array, params: Array, compiled: bool = True) -> None:
        self.inputs = np.ascontiguousarray(inputs, dtype=np.int32)
        self.dofs = np.ascontiguousarray(dofs, dtype=np.int32)
        self.params = np.ascontiguousarray(params, dtype=float)
        self.compiled = compiled and HAVE_NUMBA

    def __len__(self) -> int:
        return len(self.inputs)

    @property
    def dofs_per_element(self) -> int:
        """Dofs of one element."""
        return int(self.dofs.shape[1])

    def energies(self, configuration: Array) -> Array:
        """(E,) N mm."""
        if not self._runs_compiled(configuration):
            return np.asarray(self.formulas[0](*self._columns(configuration)))
        out = np.empty(len(self))
        self._sweep(configuration, 0, out, _NONE, _NONE)
        return out

    def gradients(self, configuration: Array) -> Array:
        """(E, n) derivatives of each element's energy by its own dofs."""
        if not self._runs_compiled(configuration):
            g = np.zeros((self.dofs_per_element, len(self)), dtype=configuration.dtype)
            self.formulas[1](*self._columns(configuration), g)
            return np.ascontiguousarray(g.T)
        out = np.zeros((len(self), self.dofs_per_element))
        self._sweep(configuration, 1, _NONE[0], out, _NONE)
        return out

    def hessians(self, configuration: Array, blend: float = 0.0, rows: slice = slice(None)) -> Array:
        """(E, n (n + 1) / 2) lower triangles, row by row, of the element Hessians; of all elements or some rows.

        `blend` takes out that part of what can make them indefinite: 0 is the exact Hessian,
        1 is positive semidefinite.
        """
        inputs, params = self.inputs[rows], self.params[rows]
        if not self._runs_compiled(configuration):
            h = np.zeros((self.dofs_per_element, self.dofs_per_element, len(inputs)), dtype=configuration.dtype)
            self.formulas[2](configuration[inputs.T], params.T, blend, h)
            i, j = np.tril_indices(self.dofs_per_element)
            return np.ascontiguousarray(h[i, j].T)
        out = np.empty((len(inputs), self.dofs_per_element * (self.dofs_per_element + 1) // 2))
        type(self).sweep(configuration, inputs, params, 2, blend, _NONE[0], _NONE, out)
        return out

    def _runs_compiled(self, configuration: Array) -> bool:
        return self.compiled and configuration.dtype == np.float64

    def _columns(self, configuration: Array) -> tuple[Array, Array]:
        return configuration[self.inputs.T], self.params.T

    def _sweep(self, configuration: Array, order: int, *out: Array) -> None:
        type(self).sweep(configuration, self.inputs, self.params, order, 0.0, *out)


_NONE = np.empty((1, 1))
