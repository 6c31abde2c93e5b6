"""The interface of an energy that Newton's method minimises."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, Protocol, runtime_checkable

from asterism.equilibrium.arrays import Floats, Ints
from asterism.equilibrium.linear.sparse_pattern import SparsePattern

AnyState = Any  # a configuration; each problem has its own type, and only the problem looks inside


class Problem(Protocol):
    """An energy over states, with its derivatives by the free degrees of freedom (dofs)."""

    @property
    def pattern(self) -> SparsePattern:
        """Sparsity pattern of the last Hessian; another object once the entries have changed."""

    def energy(self, state: AnyState) -> float:
        """Energy; infinite or nan outside its domain."""

    def gradient(self, state: AnyState) -> Floats:
        """Gradient (size,) by the free dofs."""

    def hessian(self, state: AnyState, blend: float) -> Floats:
        """Entries (nnz,) in the pattern: `blend` 0 is the exact Hessian, 1 a positive semidefinite approximation."""

    def support(self, state: AnyState) -> Ints:
        """Free dofs (k,) of an isostatic support: it stops the remaining rigid motions and causes no forces."""

    def path(self, state: AnyState, direction: Floats) -> tuple[Callable[[float], AnyState], float]:
        """Curve of states that leaves `state` in `direction` (size,), and the largest step along it."""


@runtime_checkable
class HasNearNullspace(Protocol):
    """A problem that provides the near nullspace of its Hessian, for multigrid."""

    def near_nullspace(self, state: AnyState) -> tuple[Ints, Floats]:
        """Nodes (size,) and modes (size, k), see `IterativeFactor.set_near_nullspace`."""
