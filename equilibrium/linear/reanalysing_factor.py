"""A factorisation for a problem whose sparsity pattern changes."""

from __future__ import annotations

from typing import Protocol

from asterism.equilibrium.arrays import Floats
from asterism.equilibrium.errors import BackendError
from asterism.equilibrium.linear.backends import make_factor
from asterism.equilibrium.linear.sparse_pattern import SparsePattern


class HasPattern(Protocol):
    """A problem that replaces its `pattern` by another object whenever the entries change."""

    @property
    def pattern(self) -> SparsePattern:
        """Sparsity pattern of the present Hessian."""


class ReanalysingFactor:
    """A `Factor` that analyses the problem's sparsity pattern again after each change, and only then.

    Parameters
    ----------
    problem : its `pattern` is that of the next matrix.
    backend : a factorisation, see `equilibrium.linear.backends`.

    Raises
    ------
    BackendError
        The backend is multigrid: its coarse level cannot follow a changing pattern.
    """

    def __init__(self, problem: HasPattern, backend: str = "auto") -> None:
        if backend == "amg":
            raise BackendError("backend: 'amg' does not work with contact; use auto, pardiso, cholmod or superlu")
        self._problem, self._backend = problem, backend
        self._pattern = problem.pattern
        self._factor = make_factor(self._pattern, backend)
        self.name = self._factor.name

    def factorise(self, data: Floats) -> bool:
        """As in `Factor`, for entries (nnz,) in the present pattern of the problem."""
        if self._problem.pattern is not self._pattern:
            self._factor.close()
            self._pattern = self._problem.pattern
            self._factor = make_factor(self._pattern, self._backend)
        return self._factor.factorise(data)

    def solve(self, b: Floats) -> Floats:
        """As in `Factor`."""
        return self._factor.solve(b)

    def close(self) -> None:
        """As in `Factor`."""
        self._factor.close()
