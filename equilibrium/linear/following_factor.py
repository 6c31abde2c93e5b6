"""A factorisation for a problem whose sparsity pattern changes."""

from __future__ import annotations

from typing import Protocol

from equilibrium.errors import BackendError
from equilibrium.linear.factor import make_factor
from equilibrium.linear.sparse_pattern import Floats, SparsePattern


class HasPattern(Protocol):
    """A problem whose `pattern` is another object once its entries have changed."""

    @property
    def pattern(self) -> SparsePattern: ...


class FollowingFactor:
    """Analyses the problem's pattern anew when it has changed, and only then.

    Parameters
    ----------
    problem : its `pattern` is that of the data to come.
    backend : see `equilibrium.linear.factor`; one that factorises.

    Raises
    ------
    BackendError
        The backend iterates: its coarse level would have to be told about the new entries.
    """

    def __init__(self, problem: HasPattern, backend: str = "auto") -> None:
        if backend == "amg":
            raise BackendError("backend: 'amg' does not work with contact; use auto, pardiso, cholmod or superlu")
        self._problem, self._backend = problem, backend
        self._pattern = problem.pattern
        self._factor = make_factor(self._pattern, backend)
        self.name = self._factor.name

    def factorise(self, data: Floats) -> bool:
        """As in `Factor`, for data in the problem's present pattern."""
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
