"""The interface of every factorisation of a sparse symmetric matrix.

A factorisation analyses the sparsity pattern once and keeps this part between matrices. It also reports whether each
matrix is positive definite: a Newton step depends on it, and some solvers accept an indefinite matrix silently.
`equilibrium.linear.backends` lists the implementations.
"""

from __future__ import annotations

from typing import Protocol, runtime_checkable

from asterism.equilibrium.arrays import Floats, Ints


class Factor(Protocol):
    """A factorisation of matrices that share one sparsity pattern."""

    name: str  # name of the backend, as users write it

    def factorise(self, data: Floats) -> bool:
        """Factorise the matrix with the lower-triangle entries `data` (nnz,); False if it is not positive definite."""

    def solve(self, b: Floats) -> Floats:
        """Solution x of A x = b, both (size,) or (size, k).

        Valid for the last matrix that `factorise` accepted, and undefined after a matrix that it refused.
        """

    def close(self) -> None:
        """Free the memory."""


@runtime_checkable
class IterativeFactor(Factor, Protocol):
    """An iterative solver with the interface of a factorisation.

    It needs the near nullspace of the matrix for its coarse level. After `factorise` has accepted a matrix, positive
    definiteness is still unproven: `proves_definite` proves it.
    """

    def set_near_nullspace(self, nodes: Ints, modes: Floats) -> None:
        """Nodes (size,), unknowns with equal numbers stay together; modes (size, k) that A nearly maps to zero."""

    def solve(self, b: Floats, tolerance: float = ...) -> Floats:
        """Solution up to the relative residual `tolerance`.

        Raises `NotPositiveDefiniteError` if the iteration meets a direction of negative curvature.
        """

    def proves_definite(self) -> bool:
        """True if the last matrix is proven positive definite; False if it is indefinite or no proof was found."""

    def product(self, v: Floats) -> Floats:
        """Product (size,) of the last matrix with v (size,)."""

    def precondition(self, b: Floats) -> Floats:
        """Product (size,) of a positive definite approximation of the inverse with b (size,)."""
